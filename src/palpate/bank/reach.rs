//! How deep an inclusion may lie, and how small it may be, to be found (the paper's question at the end of its §5).

use serde::Serialize;

use super::Bank;
use crate::force::Force;
use crate::refusal::Refusal;
use crate::robust::{
    BankHypotheses, Class, GelChanges, RobustDetector, RobustQuestion, RobustSweep,
};
use crate::stats::error::in_range;
use crate::stats::normal;
use crate::trace::design::gammas_along;
use crate::trace::{Record, Unknown};

/// What an inclusion must be found with.
///
/// Implements: BNK-070.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach<'a> {
    /// What may be there.
    pub bank: &'a Bank,
    /// Where the samples are taken: a record of which the forces count for nothing.
    pub sweep: &'a Record,
    /// Standard deviation of a sample's noise, N.
    pub noise_sd: Force<f64>,
    /// Most false alarms of a search over all positions of the bank.
    pub max_false_alarm: f64,
    /// Most misses.
    pub max_miss: f64,
    /// What is not known of the sweep.
    pub unknown: &'a [Unknown],
}

/// What is reached with one diameter and one modulus.
///
/// Implements: BNK-071.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reached {
    /// The diameter, m.
    #[serde(skip)]
    pub diameter: f64,
    /// The Young's modulus, Pa.
    #[serde(skip)]
    pub modulus: f64,
    /// The largest depth with enough γ, m: none if it is not enough at the least depth of the bank.
    #[serde(rename = "largest_depth_m")]
    pub depth: Option<f64>,
    /// Whether it is enough at the greatest depth of the bank too, and the true one is greater.
    #[serde(rename = "is_beyond_bank")]
    pub is_beyond: bool,
    /// γ at each depth of the bank, at the position of the bank that is nearest to 0.
    pub gamma: Vec<f64>,
}

/// γ beside a class of disturbance, at each depth of the bank.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BesideClass {
    /// The name of the class.
    pub class: &'static str,
    /// γ at each depth.
    pub gamma: Vec<f64>,
}

impl Reach<'_> {
    /// The γ that is enough: of a search whose false alarms are bounded by the sum over all points of the bank, in noise of a known
    /// level.
    ///
    /// # Errors
    /// Rates that are not strictly between 0 and 1, or so large that no γ is needed.
    ///
    /// Implements: BNK-070.
    pub fn gamma(&self) -> Result<f64, Refusal> {
        let each = self.max_false_alarm / self.bank.maps().len() as f64;
        let point = |p| normal::quantile(p).map_err(Refusal::from);
        let gamma = -point(each)? - point(self.max_miss)?;
        let range = "less than 1 - max_false_alarm / number of maps";
        in_range(gamma > 0.0, "max_miss", self.max_miss, range)?;
        Ok(gamma)
    }

    /// What is reached with each diameter and modulus, the diameters first.
    ///
    /// # Errors
    /// As [`Reach::gamma`]; a sweep that goes beyond the maps; an unknown depth of a bank whose reference has one depth.
    ///
    /// Implements: BNK-071, BNK-080, BNK-082.
    pub fn reached(&self) -> Result<Vec<Reached>, Refusal> {
        let (enough, middle) = (self.gamma()?, self.middle());
        let (maps, axes) = (self.bank.maps(), self.bank.axes());
        let with = middle.iter().flatten().map(|&map| maps[map].table());
        let gammas = gammas_along(
            (self.sweep, self.bank.depth()),
            self.unknown,
            self.noise_sd,
            self.bank.reference().table(),
            (self.bank.base(), with),
        )?;
        let row = |(maps, gamma): (&Vec<usize>, &[f64])| {
            let [_, _, diameter, modulus] = self.bank.point(maps[0]);
            let depth = deepest(&axes[1], gamma, enough);
            Reached {
                diameter,
                modulus,
                is_beyond: depth == axes[1].last().copied(),
                depth,
                gamma: gamma.to_vec(),
            }
        };
        let rows = middle.iter().zip(gammas.chunks(axes[1].len()));
        Ok(rows.map(row).collect())
    }

    /// The robust detector's question of a sweep in this noise.
    fn question(&self) -> RobustQuestion<'_> {
        RobustQuestion {
            noise_sd: Some(self.noise_sd),
            ..RobustQuestion::default()
        }
    }

    /// The passes of the sweep that the robust detector judges.
    ///
    /// Implements: BNK-082, ROB-080.
    pub fn passes(&self) -> Vec<Record> {
        let question = self.question();
        question.passes(self.sweep, self.bank.reference()).0
    }

    /// γ beside each class of disturbance of the robust detector: for each diameter and modulus, in the order of [`Reach::reached`], the
    /// classes, each with γ at each depth of the bank. `changes` are those of the bank's reference under the [passes](Reach::passes).
    ///
    /// # Errors
    /// Too few samples.
    ///
    /// Implements: BNK-072.
    pub fn beside_classes(
        &self,
        changes: Option<&GelChanges>,
    ) -> Result<Vec<Vec<BesideClass>>, Refusal> {
        let passes = self.passes();
        let sweep = |record| RobustSweep::new(record, self.bank.depth(), changes);
        let sweeps: Vec<_> = passes.iter().map(sweep).collect();
        // The first are those of the maps, by their number: without a prior each of them is possible.
        let signals = BankHypotheses::new(self.bank, None).signals(&sweeps)?;
        let without = self.bank.reference().table();
        let detector = RobustDetector::new(self.question(), without, &sweeps, &signals)?;
        let row = |maps: Vec<usize>| {
            let gammas = maps.iter().map(|&map| detector.gammas(map, self.noise_sd));
            let by_depth: Vec<_> = gammas.collect();
            let classes = by_depth[0].iter().enumerate();
            let at = |class: usize| by_depth.iter().map(|of| of[class].1).collect();
            let of_class = |(class, (of, _)): (usize, &(Class, f64))| BesideClass {
                class: of.name,
                gamma: at(class),
            };
            classes.map(of_class).collect()
        };
        Ok(self.middle().into_iter().map(row).collect())
    }

    /// For each diameter and modulus, the diameters first, the map at each depth, at the position nearest to 0.
    fn middle(&self) -> Vec<Vec<usize>> {
        let axes = self.bank.axes();
        let distance = |at: &usize| axes[0][*at].abs();
        let middle = (0..axes[0].len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let [positions, depths, ..] = axes.each_ref().map(Vec::len);
        let firsts = (0..self.bank.maps().len()).step_by(positions * depths);
        let row = |first: usize| {
            let at = |depth| first + depth * positions + middle.unwrap_or(0);
            (0..depths).map(at).collect()
        };
        firsts.map(row).collect()
    }
}

impl Bank {
    /// A sweep over the lateral positions of the bank, of so many evenly spaced samples, or of one at each position.
    ///
    /// # Errors
    /// No samples.
    pub fn sweep(&self, samples: Option<usize>) -> Result<Record, Refusal> {
        let laterals = self.reference().table().laterals();
        let (first, last) = (laterals[0], laterals[laterals.len() - 1]);
        let positions = match samples {
            None => laterals.to_vec(),
            Some(1) => vec![0.5 * (first + last)],
            Some(samples) => {
                let share = |k: usize| k as f64 / (samples - 1) as f64;
                let position = |k: usize| (first + share(k) * (last - first)).min(last);
                (0..samples).map(position).collect()
            }
        };
        Record::planned(&positions, &[])
    }
}

/// Where γ is `enough` between two places, ln γ being linear between them.
fn crossing([from, to]: [f64; 2], gamma: [f64; 2], enough: f64) -> f64 {
    let [before, after] = gamma.map(libm::log);
    from + (libm::log(enough) - before) / (after - before) * (to - from)
}

/// The first of `depths` beyond which `gamma` is less than `enough`, ln γ being linear between them.
pub fn deepest(depths: &[f64], gamma: &[f64], enough: f64) -> Option<f64> {
    let Some(below) = gamma.iter().position(|&found| found < enough) else {
        return depths.last().copied();
    };
    let above = below.checked_sub(1)?;
    let ends = [depths[above], depths[below]];
    Some(crossing(ends, [gamma[above], gamma[below]], enough))
}

/// The smallest diameter that is enough at each depth, as [`Reached::depth`] is the largest depth: for `reached` of one modulus, in the
/// order of their diameters.
///
/// Implements: BNK-071.
pub fn smallest_diameters(bank: &Bank, reached: &[Reached], enough: f64) -> Vec<Option<f64>> {
    let smallest = |depth: usize| {
        let gamma = |number: usize| reached[number].gamma[depth];
        let first = (0..reached.len()).find(|&number| gamma(number) >= enough)?;
        let diameter = reached[first].diameter;
        let before = first.checked_sub(1).filter(|&before| gamma(before) > 0.0);
        Some(before.map_or(diameter, |before| {
            let ends = [reached[before].diameter, diameter];
            crossing(ends, [gamma(before), gamma(first)], enough)
        }))
    };
    (0..bank.axes()[1].len()).map(smallest).collect()
}
