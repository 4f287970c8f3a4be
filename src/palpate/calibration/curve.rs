//! A recorded force–depth curve.

use std::path::Path;

use crate::csv::{Column, Layout, Rows};
use crate::refusal::Refusal;
use crate::stats::error::check_samples;
use crate::text::extremes;

/// How far the probe went, from any zero; the force; the time, which may be missing.
const COLUMNS: [Column; 3] = [
    &[
        &[("depth_mm", -3), ("depth_m", 0)],
        &[("position_mm", -3), ("position_m", 0)],
    ],
    &[&[("normal_force_n", 0), ("normal_force_mn", -3)]],
    &[&[("time_s", 0), ("time_ms", -3)]],
];
/// The headers that are right, for a person.
const EXPECTED_HEADER: &str = "depth_mm,normal_force_n and time_s if there are times, in any order, or say with --columns what each holds";

/// A curve has at least so many samples.
const LEAST_SAMPLES: usize = 20;
/// Relaxation is looked for in a curve that has at least so many samples at its depth.
const LEAST_HELD: usize = 20;
/// The probe is on its way back when it has left the deepest point by this share of its way there.
const WAY_BACK: f64 = 0.05;

/// What a sensor recorded while the probe went into a gel and stayed there, from above its surface.
///
/// ```
/// use palpate::calibration::Curve;
///
/// // Ten samples of air, ten of a spring, and the way back, which does not count.
/// let depth = |k: usize| 0.1 * f64::from(if k < 20 { k as u32 } else { 40 - k as u32 });
/// let row = |k| format!("{},{}\n", depth(k), f64::max(depth(k) - 1.0, 0.0));
/// let text = "depth_mm,Fz (N)\n".to_string() + &(0..40).map(row).collect::<String>();
/// let curve = Curve::from_csv(&text, "curve.csv", &Default::default())?;
/// assert_eq!(curve.depths().len(), 22);
/// # Ok::<(), palpate::refusal::Refusal>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    file: String,
    times: Option<Vec<f64>>,
    depths: Vec<f64>,
    forces: Vec<f64>,
    notes: Vec<String>,
}

impl Curve {
    /// Reads the curve at `path`, in this layout.
    ///
    /// # Errors
    /// As [`Curve::from_csv`]; a file that cannot be read as UTF-8.
    pub fn read(path: &Path, layout: &Layout) -> Result<Curve, Refusal> {
        crate::file::read(path, |text, file| Curve::from_csv(text, file, layout))
    }

    /// The curve in `text`, the content of `file`, in this layout.
    ///
    /// # Errors
    /// The header does not name depth and force, a row is malformed, and as [`Curve::new`].
    ///
    /// Implements: CAL-001.
    pub fn from_csv(text: &str, file: &str, layout: &Layout) -> Result<Curve, Refusal> {
        let read = || {
            let read = Rows::parse_optional(text, COLUMNS, 2, EXPECTED_HEADER, layout, true)?;
            let (table, [.., has_times]) = read;
            let rows = table.rows.iter();
            let column = |of: usize| rows.clone().map(|(_, row)| row[of]).collect::<Vec<_>>();
            let times = has_times.then(|| column(2));
            let mut curve = Curve::new(file, times.as_deref(), &column(0), &column(1))?;
            curve.notes.splice(0..0, table.notes);
            Ok(curve)
        };
        read().map_err(|refusal: Refusal| Refusal {
            file: file.into(),
            ..refusal
        })
    }

    /// The curve of forces (N, positive where they push the probe up) at depths (m, growing into the gel, from any zero) and at times
    /// (s), if there are any. `name` stands for a file in messages. Samples from where the probe goes back are left out.
    ///
    /// # Errors
    /// Fewer than 20 samples up to the way back; lists of different lengths; NaN or infinity; times that do not increase; a probe that
    /// does not move.
    ///
    /// Implements: CAL-001, CAL-002.
    pub fn new(
        name: &str,
        times: Option<&[f64]>,
        depths: &[f64],
        forces: &[f64],
    ) -> Result<Curve, Refusal> {
        let read = || {
            let all = depths.len();
            check_samples("depths", depths, all)?;
            check_samples("forces", forces, all)?;
            if let Some(times) = times {
                check_samples("times", times, all)?;
                let next = times.windows(2).position(|pair| pair[1] <= pair[0]);
                if let Some(at) = next {
                    let [before, found] = [times[at], times[at + 1]];
                    let found = format!("time {found:?} s after {before:?} s");
                    return Err(Refusal::state(found, "give times that increase"));
                }
            }
            let [_, most] = extremes(depths.iter().copied()).unwrap_or_default();
            let first = depths.first().copied().unwrap_or(most);
            let deep = most - WAY_BACK * (most - first);
            // The probe comes back for the first time, or not at all.
            let deepest = depths.iter().position(|depth| *depth == most);
            let deepest = deepest.unwrap_or_default();
            let back = depths[deepest..].iter().position(|depth| *depth < deep);
            let kept = back.map_or(all, |back| deepest + back);
            let found = format!("{kept} samples on the way into the gel");
            let few = Refusal::state(found, format!("give at least {LEAST_SAMPLES}"));
            let still = Refusal::state(
                "the probe does not move into the gel",
                "give a curve into the gel, on which the depth grows",
            );
            still.when(all > 0 && most <= first)?;
            few.when(kept < LEAST_SAMPLES)?;
            let mut notes = Vec::new();
            if kept < all {
                let back = all - kept;
                notes.push(format!("samples of the way back are not used: {back}"));
            }
            Ok(Curve {
                file: name.into(),
                times: times.map(|times| times[..kept].to_vec()),
                depths: depths[..kept].to_vec(),
                forces: forces[..kept].to_vec(),
                notes,
            })
        };
        read().map_err(|refusal: Refusal| refusal.in_file(name))
    }

    /// The file that the curve comes from, as its reader named it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Times of the samples, s, if they were recorded.
    pub fn times(&self) -> Option<&[f64]> {
        self.times.as_deref()
    }

    /// How far the probe was at each sample, m.
    pub fn depths(&self) -> &[f64] {
        &self.depths
    }

    /// The force on the probe at each sample, N.
    pub fn forces(&self) -> &[f64] {
        &self.forces
    }

    /// What a person should know of how the curve was read.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The greatest depth, m.
    pub fn deepest(&self) -> f64 {
        self.depths
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// How many samples are air, if the probe touched the gel at `contact`, m.
    pub(super) fn air(&self, contact: f64) -> usize {
        let air = self.depths.iter().filter(|depth| **depth <= contact);
        air.count()
    }

    /// The first sample at which the probe had reached its depth, but for jitter.
    fn reached(&self) -> usize {
        let deep = self.deepest() - 0.01 * (self.deepest() - self.depths[0]);
        let first = self.depths.iter().position(|depth| *depth >= deep);
        first.unwrap_or(0)
    }

    /// The curve up to where the probe had reached its depth.
    pub(super) fn on_the_way(&self) -> Curve {
        let until = (self.reached() + 1).max(LEAST_SAMPLES / 2);
        let cut = |of: &[f64]| of[..until.min(of.len())].to_vec();
        Curve {
            times: self.times.as_deref().map(cut),
            depths: cut(&self.depths),
            forces: cut(&self.forces),
            ..self.clone()
        }
    }

    /// The curve with the opposite sign of its forces.
    pub(super) fn negated(&self) -> Curve {
        let forces = self.forces.iter().map(|force| -force).collect();
        let own = self.clone();
        Curve { forces, ..own }
    }

    /// How long the probe stayed at its depth, s, if long enough that a relaxation can be seen.
    pub(super) fn held_seconds(&self) -> Option<f64> {
        let (times, from) = (self.times.as_ref()?, self.reached());
        let is_held = times.len() - from >= LEAST_HELD;
        is_held.then(|| times[times.len() - 1] - times[from])
    }

    /// Where each sample is between the first and the last, from 0 to 1: by its time, else by its number.
    pub(super) fn shares(&self) -> impl Iterator<Item = f64> {
        let last = self.depths.len() - 1;
        (0..=last).map(move |at| match &self.times {
            Some(times) => (times[at] - times[0]) / (times[last] - times[0]),
            None => at as f64 / last as f64,
        })
    }
}
