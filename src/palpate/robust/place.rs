//! A bank's inclusions as hypotheses, and where the inclusion of a record lies.

use super::evidence::log_sum;
use super::{AMPLITUDE, AMPLITUDE_OF_DIAMETERS, RobustAnswer, RobustSignal, RobustSweep};
use crate::bank::{Bank, shares};
use crate::force_map::{ForceMap, SAME_POSITION};
use crate::refusal::Refusal;

/// The prior of two inclusions at one depth, given any, and the least distance between them, m.
const PAIRS: f64 = 0.2;
const APART: f64 = 6e-3;
/// Pairs that stand for all of them.
const MOST_PAIRS: usize = 40;
/// Each end of an interval is passed with this probability.
const TAIL: f64 = 0.025;
/// ln of the evidence that excludes a depth: 1 in 19.
const EXCLUDED: f64 = -2.944_438_979_166_440_3;

/// The hypotheses of a bank: each of its inclusions, and pairs of them.
#[derive(Debug, Clone)]
pub struct BankHypotheses<'a> {
    bank: &'a Bank,
    /// The maps of each hypothesis, one or two, and its prior given an inclusion.
    of: Vec<(Vec<usize>, f64)>,
    /// Whether the sensor was set to zero, so that no depth is without an inclusion: in air the record would be the same.
    pub(super) is_zeroed: bool,
}

/// One parameter of the inclusion, by whole cells of the bank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceInterval {
    /// The posterior mean.
    pub estimate: f64,
    /// The end that it is below with at most 2.5 %; none if that is beyond the bank.
    pub lower: Option<f64>,
    /// The end that it is above with at most 2.5 %; none if that is beyond the bank.
    pub upper: Option<f64>,
}

/// Where the inclusion lies, if there is one, and down to which depth there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustPlace {
    /// In the order of [`crate::bank::Parameter::ALL`]; none for a parameter with one value.
    pub intervals: [Option<PlaceInterval>; 4],
    /// The probability of each value of each parameter, given one inclusion.
    pub marginals: [Vec<f64>; 4],
    /// The probability of two inclusions, given any.
    pub several: f64,
    /// Down to this depth, m, any inclusion of the bank is excluded; none if not even the shallowest is.
    pub none_down_to: Option<f64>,
}

impl PlaceInterval {
    /// Both ends as they are to be `shown`.
    pub fn in_words(&self, shown: impl Fn(f64) -> String) -> String {
        match [self.lower, self.upper].map(|end| end.map(&shown)) {
            [Some(low), Some(high)] => format!("{low} to {high}"),
            [Some(low), None] => format!("from {low}"),
            [None, Some(high)] => format!("up to {high}"),
            [None, None] => "wider than the bank".into(),
        }
    }
}

impl<'a> BankHypotheses<'a> {
    /// Those of `bank` with the `prior` of each map, or all equally probable.
    ///
    /// Implements: ROB-030.
    pub fn new(bank: &'a Bank, prior: Option<&[f64]>) -> BankHypotheses<'a> {
        let maps = bank.maps().len();
        let points: Vec<_> = (0..maps).map(|map| bank.point(map)).collect();
        let is_pair = |a: usize, b: usize| {
            let alike = points[a][1..] == points[b][1..];
            alike && points[b][0] - points[a][0] >= APART - SAME_POSITION
        };
        let own = |map: usize| prior.map_or(1.0 / maps as f64, |prior| prior[map]);
        let of_pair = |&(a, b): &(usize, usize)| own(a) * own(b);
        let all = (0..maps).flat_map(|a| (0..maps).map(move |b| (a, b)));
        let pairs = all.filter(|pair| is_pair(pair.0, pair.1) && of_pair(pair) > 0.0);
        let pairs: Vec<_> = pairs.collect();
        let stride = pairs.len().div_ceil(MOST_PAIRS).max(1);
        let pairs: Vec<_> = pairs.into_iter().step_by(stride).collect();
        let whole: f64 = pairs.iter().map(of_pair).sum();
        let share = if whole > 0.0 { PAIRS } else { 0.0 };
        let singles = (0..maps).map(|map| (vec![map], (1.0 - share) * own(map)));
        let pairs =
            (pairs.iter()).map(|pair| (vec![pair.0, pair.1], share * of_pair(pair) / whole));
        let is_possible = |(_, prior): &(Vec<usize>, f64)| *prior > 0.0;
        BankHypotheses {
            bank,
            of: singles.chain(pairs).filter(is_possible).collect(),
            is_zeroed: false,
        }
    }

    /// What each adds to the forces at the samples of each of the `sweeps`.
    ///
    /// # Errors
    /// Samples outside the bank.
    pub fn signals(&self, sweeps: &[RobustSweep<'_>]) -> Result<Vec<RobustSignal>, Refusal> {
        let at = |sweep: &RobustSweep<'_>| {
            let none = sweep.expected(self.bank.base())?;
            let maps = self.bank.maps().iter();
            let signal = |map: &ForceMap| sweep.signal(map.table(), &none);
            maps.map(signal).collect::<Result<Vec<_>, Refusal>>()
        };
        let of_sweeps = sweeps.iter().map(at).collect::<Result<Vec<_>, _>>()?;
        let sum = |maps: &[usize], signals: &[Vec<f64>]| {
            let sample = |at: usize| maps.iter().map(|&map| signals[map][at]).sum();
            (0..signals[0].len()).map(sample).collect()
        };
        let amplitude_sd = match self.bank.axes()[2].len() {
            1 => AMPLITUDE,
            _ => AMPLITUDE_OF_DIAMETERS,
        };
        let signal = |(maps, prior): &(Vec<usize>, f64)| {
            let of_sweeps = of_sweeps.iter().map(|signals| sum(maps, signals)).collect();
            RobustSignal {
                of_sweeps,
                amplitude_sd,
                prior: *prior,
            }
        };
        Ok(self.of.iter().map(signal).collect())
    }

    /// Where the inclusion lies, by the likelihood ratios of the hypotheses.
    ///
    /// Implements: ROB-041, ROB-042.
    pub fn place(&self, answer: &RobustAnswer) -> RobustPlace {
        let priors: Vec<f64> = self.of.iter().map(|(_, prior)| *prior).collect();
        // Those of one inclusion come first.
        let ones = self.of.iter().filter(|(maps, _)| maps.len() == 1).count();
        let thetas_of_one = &answer.thetas[..ones.min(answer.thetas.len())];
        let of_one = shares(thetas_of_one, &priors);
        let marginals = [0, 1, 2, 3].map(|number: usize| {
            let values = &self.bank.axes()[number];
            let mut along = vec![0.0; values.len()];
            for ((maps, _), share) in self.of.iter().zip(&of_one) {
                let value = self.bank.point(maps[0])[number];
                along[values.partition_point(|of| *of < value)] += share;
            }
            along
        });
        let axis = |number: usize| {
            let values = &self.bank.axes()[number];
            (values.len() > 1).then(|| interval(values, &marginals[number]))
        };
        RobustPlace {
            intervals: [0, 1, 2, 3].map(axis),
            marginals,
            several: shares(&answer.thetas, &priors)
                .iter()
                .skip(ones)
                .sum::<f64>()
                .min(1.0),
            none_down_to: self
                .none_down_to(&answer.thetas)
                .filter(|_| !self.is_zeroed && !answer.is_none_doubtful),
        }
    }

    /// The deepest depth of the bank down to which each depth alone is excluded.
    fn none_down_to(&self, thetas: &[f64]) -> Option<f64> {
        let depths = self.bank.axes()[1].iter();
        let is_excluded = |depth: &f64| {
            let of_depth =
                self.of.iter().zip(thetas).filter(|((maps, _), _)| {
                    maps.len() == 1 && self.bank.point(maps[0])[1] == *depth
                });
            let (mut log, mut prior) = (f64::NEG_INFINITY, 0.0);
            for ((_, own), theta) in of_depth {
                log = log_sum(log, libm::log(*own) + theta);
                prior += own;
            }
            prior > 0.0 && log - libm::log(prior) <= EXCLUDED
        };
        depths.copied().take_while(is_excluded).last()
    }
}

/// The interval of one parameter from the probabilities of its `values`, whose cells end half-way to the next.
fn interval(values: &[f64], shares: &[f64]) -> PlaceInterval {
    let last = values.len() - 1;
    let mut sum = 0.0;
    let up_to: Vec<f64> = (shares.iter())
        .map(|share| {
            sum += share;
            sum
        })
        .collect();
    let first = up_to.iter().position(|sum| *sum > TAIL).unwrap_or(0);
    let end = up_to
        .iter()
        .position(|sum| *sum >= 1.0 - TAIL)
        .unwrap_or(last);
    let pairs = values.iter().zip(shares);
    PlaceInterval {
        estimate: pairs.map(|(value, share)| value * share).sum(),
        lower: (first > 0).then(|| 0.5 * (values[first - 1] + values[first])),
        upper: (end < last).then(|| 0.5 * (values[end] + values[end + 1])),
    }
}
