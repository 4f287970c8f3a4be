//! Records whose samples have depths of their own: the probe may go forward and back, at several depths.

use super::{JITTER, Record};
use crate::force::Force;
use crate::force_map::SAME_POSITION;
use crate::refusal::Refusal;
use crate::text::extremes;

impl Record {
    /// As [`Record::new`], with the depth of each sample (m), in the order of time: the probe may go back and forth.
    ///
    /// ```
    /// use palpate::force::Force;
    /// use palpate::trace::Record;
    ///
    /// // There at 2 mm and back at 3 mm.
    /// let forces = Force::new(&[][..], &[0.5, 0.5, 0.75, 0.75][..]);
    /// let record = Record::along("path", &[-1e-3, 1e-3, 1e-3, -1e-3], &[2e-3, 2e-3, 3e-3, 3e-3], forces)?;
    /// assert_eq!(record.positions()[3], -1e-3);
    /// assert_eq!(record.passes().len(), 2);
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// No sample; lists of different lengths; NaN or infinity.
    ///
    /// Implements: TRC-081, TRC-008.
    pub fn along(
        name: &str,
        positions: &[f64],
        depths: &[f64],
        forces: Force<&[f64]>,
    ) -> Result<Record, Refusal> {
        Record::listed(name, positions, Some(depths), forces)
    }

    /// A record without forces, for what can be found where its samples are (m). `depths` are empty for a sweep at one depth.
    ///
    /// # Errors
    /// As [`Record::along`].
    ///
    /// Implements: BNK-082.
    pub fn planned(positions: &[f64], depths: &[f64]) -> Result<Record, Refusal> {
        let zeros = vec![0.0; positions.len()];
        let forces = Force::new(&zeros[..], &zeros[..]);
        match depths {
            [] => Record::new("sweep", positions, forces),
            depths => Record::along("path", positions, depths, forces),
        }
    }

    /// The depth of each sample, m, if the record has them.
    ///
    /// Implements: TRC-080.
    pub fn depths(&self) -> Option<&[f64]> {
        (!self.depths.is_empty()).then_some(&self.depths)
    }

    /// This record with a standard deviation (m) of the error of each depth that is independent of that of the others.
    ///
    /// # Errors
    /// A record without depths; a standard deviation below 0 or not finite.
    ///
    /// Implements: TRC-086.
    pub fn with_depth_sd(mut self, depth_sd: f64) -> Result<Record, Refusal> {
        let found = "the record has no depths, whose error is stated";
        let missing = Refusal::state(found, "give a column depth_mm, or leave the error out");
        missing.in_file(&*self.file).when(self.depths.is_empty())?;
        let wrong = Refusal::value(
            "depth_sd",
            depth_sd,
            "a finite number of metres, at least 0",
        );
        wrong.when(!(0.0..f64::INFINITY).contains(&depth_sd))?;
        self.depth_sd = depth_sd;
        Ok(self)
    }

    /// The standard deviation of the independent error of each depth, m.
    pub(crate) fn depth_sd(&self) -> f64 {
        self.depth_sd
    }

    /// The same record at other depths, one for each sample, from its own.
    pub(crate) fn moved(&self, to: impl FnMut(&f64) -> f64) -> Record {
        Record {
            depths: self.depths.iter().map(to).collect(),
            ..self.clone()
        }
    }

    /// The passes of the probe: the longest runs of samples that go one way but for jitter, each of which is then as a record of its own,
    /// towards +x. A record without depths is one pass.
    ///
    /// Implements: TRC-083.
    pub fn passes(&self) -> Vec<Record> {
        if self.depths.is_empty() {
            return vec![self.clone()];
        }
        let place = extremes(self.positions.iter().copied()).unwrap_or_default();
        let starts = turns(
            &self.positions,
            JITTER * (place[1] - place[0]) + SAME_POSITION,
        );
        let ends = starts.iter().skip(1).copied().chain([self.positions.len()]);
        let pass = |(start, end): (&usize, usize)| {
            let mut samples: Vec<usize> = (*start..end).collect();
            if self.positions[end - 1] < self.positions[*start] {
                samples.reverse();
            }
            Record {
                place: Some(place),
                ..self.only(&samples)
            }
        };
        starts.iter().zip(ends).map(pass).collect()
    }

    /// The first and the last position of the place that the record is of, m; none if it may have several passes.
    pub fn place(&self) -> Option<[f64; 2]> {
        let own = [self.positions[0], self.positions[self.positions.len() - 1]];
        self.place.or(self.depths.is_empty().then_some(own))
    }

    /// The record of these samples alone.
    pub(super) fn only(&self, samples: &[usize]) -> Record {
        let column = |all: &Vec<f64>| -> Vec<f64> {
            let kept = samples.iter().filter_map(|&sample| all.get(sample));
            kept.copied().collect()
        };
        Record {
            lines: samples.iter().map(|&sample| self.lines[sample]).collect(),
            positions: column(&self.positions),
            depths: column(&self.depths),
            forces: self.forces.as_ref().map(column),
            file: self.file.clone(),
            ..*self
        }
    }
}

/// Where runs of positions (m) begin that go one way, but for steps back of at most `jitter`. The probe turns at its furthest sample; a
/// single sample belongs to the run behind it.
fn turns(positions: &[f64], jitter: f64) -> Vec<usize> {
    let mut starts = vec![0];
    // The furthest samples towards −x and +x since the run began, and which way it goes.
    let (mut furthest, mut way) = ([0, 0], 0.0);
    for (at, &x) in positions.iter().enumerate() {
        let [low, high] = furthest;
        let back = [x - positions[low], positions[high] - x];
        let turned = match way {
            way if way > 0.0 => (back[1] > jitter).then_some(high),
            way if way < 0.0 => (back[0] > jitter).then_some(low),
            _ => None,
        };
        if let Some(turn) = turned {
            if turn > starts[starts.len() - 1] {
                starts.push(turn + 1);
            }
            (furthest, way) = ([at, at], -way);
            continue;
        }
        if way == 0.0 && back[0].max(back[1]) > jitter {
            way = if back[0] > jitter { 1.0 } else { -1.0 };
        }
        furthest = [
            if back[0] <= 0.0 { at } else { low },
            if back[1] <= 0.0 { at } else { high },
        ];
    }
    starts
}
