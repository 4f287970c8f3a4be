//! A sweep against a bank while it is taken: what each sample adds, and when it is enough (`spec/sequential.md`).

use serde::Serialize;

use super::Bank;
use super::neighbours::Neighbours;
use crate::detect::mixture::mixture_theta;
use crate::detect::sequential::{Evidence, Sequential, Wald, memory};
use crate::detect::{Decision, DetectError, posterior};
use crate::force::Force;
use crate::force_map::{ForceTable, Place, Stencil, increasing};
use crate::refusal::Refusal;
use crate::stats::error::{check_positive, check_probability, check_samples, in_range};
use crate::trace::contact::wrong_gain;
use crate::trace::design::{self, depth_slope, difference, single_depth, slope, stacked};
use crate::trace::{Cause, MUCH_LIKELIER, Record, Unknown, refused};

/// −ln of half the rate at which a record that fits is taken for a misfit.
///
/// Implements: SEQ-023.
const MISFIT: f64 = 14.508_657_738_524_219;
/// The largest force over the noise.
const MOST: f64 = 1e50;
/// Offsets and drifts of two channels, gain and depth.
const MOST_COLUMNS: usize = 6;

/// What is known of a sweep that is being taken, and what is asked.
///
/// Implements: SEQ-002.
#[derive(Debug, Clone)]
pub struct WatchQuestion {
    /// What is not known of the sweep; of the standard deviation of the noise nothing may be.
    pub unknown: Vec<Unknown>,
    /// Standard deviation of a sample of either force, N.
    pub noise_sd: Force<f64>,
    /// Whether the sensor was set to zero on the gel, so that its forces say nothing of contact.
    pub is_zeroed: bool,
    /// Pr(H = 1) before the sweep.
    pub prior_h1: f64,
    /// The probability of each of the bank's maps, given an inclusion; none if all are equally probable.
    pub prior: Option<Vec<f64>>,
    /// The rates of false answers.
    pub test: Wald,
}

/// Judges a sweep sample by sample.
#[derive(Debug, Clone)]
pub struct Watcher {
    question: WatchQuestion,
    prior: Vec<f64>,
    points: Vec<[f64; 4]>,
    reference: ForceTable,
    depths: Vec<f64>,
    /// For each depth of the maps, lateral position and channel F_0, ∂F_0/∂d if the depth is unknown, and the signal of each map, over
    /// the noise.
    expected: Vec<Vec<f64>>,
    /// The same at the sample at hand.
    at_sample: Vec<f64>,
    pub(super) found: Sequential<Vec<f64>>,
    /// The same by the normal forces alone, and with the other sign of what the lateral ones have beside those of the reference.
    others: [Sequential<Vec<f64>>; 2],
    neighbours: Neighbours,
    counts: SampleCounts,
    /// Σ F f and Σ f² of the normal forces over the noise.
    contact: [f64; 2],
    answered: Option<(Decision, usize)>,
}

/// How many samples were pushed.
///
/// Implements: SEQ-024.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct SampleCounts {
    /// Samples that count.
    pub samples: usize,
    /// Samples with a missing number.
    pub missing: usize,
    /// Samples outside the bank's lateral positions or depths.
    pub outside: usize,
}

/// What the samples so far say. Serialised, it is an answer of `palpate watch`.
///
/// Implements: SEQ-022, SEQ-024.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchAnswer {
    /// How many samples count, and how many do not.
    #[serde(flatten)]
    pub counts: SampleCounts,
    /// Pr(H = 1 | samples), by the mixture.
    pub posterior_h1: f64,
    /// ln of the likelihood ratio of an inclusion at any point.
    pub theta: f64,
    /// Ĥ, if it is answered.
    pub decision: Option<Decision>,
    /// The number of the sample that answered.
    pub decided_at_sample: Option<usize>,
    /// Why nothing can be answered.
    pub causes: Vec<Cause>,
    /// The likeliest place, once a place has a signal.
    pub likeliest: Option<LikeliestPlace>,
    /// Places with a prior above 0.
    pub places: usize,
    /// Those of them that the path has covered.
    pub covered: usize,
    /// Those where an inclusion is excluded.
    pub excluded: usize,
    /// The positions with a place that is not excluded, m.
    pub open_positions_m: Vec<f64>,
    /// The positions with a place that the path has not covered, m.
    pub uncovered_positions_m: Vec<f64>,
}

/// A place of the bank.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LikeliestPlace {
    /// x of its centre, m.
    pub position_m: f64,
    /// Depth of its highest point, m.
    pub depth_m: f64,
    /// Its diameter, m.
    pub diameter_m: f64,
    /// Its Young's modulus, Pa.
    pub youngs_modulus_pa: f64,
    /// Its probability, given an inclusion of the bank.
    pub probability: f64,
}

/// What the samples so far say of a place, from the least on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Told {
    /// The path has not covered it.
    Uncovered,
    /// An inclusion may be there.
    Open,
    /// An inclusion is excluded.
    Excluded,
}

/// A place of the bank with a prior above 0, and what is known of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WatchedPlace {
    /// x of the centre of the inclusion, m.
    pub position: f64,
    /// Depth of its highest point, m.
    pub depth: f64,
    /// What the samples say of it.
    pub told: Told,
}

impl Watcher {
    /// Before the first sample.
    ///
    /// # Errors
    /// An unknown level of the noise; an unknown depth where the reference has one depth; a standard deviation that is not above 0;
    /// a prior that is none, or of another length.
    ///
    /// Implements: SEQ-002.
    pub fn new(bank: &Bank, question: &WatchQuestion) -> Result<Watcher, Refusal> {
        let found = "the noise of a sweep that is being taken cannot be estimated";
        let remedy = "state its standard deviation, and leave variance out of what is unknown";
        Refusal::state(found, remedy).when(question.unknown.contains(&Unknown::Variance))?;
        let maps = bank.maps().len();
        let prior = question.prior.clone();
        let prior = prior.unwrap_or_else(|| vec![1.0 / maps as f64; maps]);
        let checked = || {
            check_positive("noise_sd_lateral_n", question.noise_sd.lateral)?;
            check_positive("noise_sd_normal_n", question.noise_sd.normal)?;
            check_probability("prior_h1", question.prior_h1)?;
            check_samples("prior", &prior, maps)?;
            mixture_theta(&vec![0.0; maps], &prior)
        };
        checked().map_err(refused)?;
        // Each once.
        let unknown = Unknown::ALL.into_iter();
        let unknown: Vec<_> = unknown.filter(|of| question.unknown.contains(of)).collect();
        let nuisances = columns(&unknown);
        let begun = || {
            let begun = Sequential::new(vec![0.0; memory(maps, nuisances)], maps, nuisances);
            begun.map_err(refused)
        };
        let reference = bank.reference().table().clone();
        let depths = bank.probe_depths().iter();
        let expected = depths.map(|&depth| expected(bank, question, depth));
        let expected = expected.collect::<Result<Vec<_>, _>>()?;
        Ok(Watcher {
            question: WatchQuestion {
                unknown,
                ..question.clone()
            },
            prior,
            points: (0..maps).map(|map| bank.point(map)).collect(),
            at_sample: vec![0.0; expected[0].len() / (2 * reference.laterals().len())],
            reference,
            depths: bank.probe_depths().to_vec(),
            expected,
            found: begun()?,
            others: [begun()?, begun()?],
            neighbours: Neighbours::new(maps),
            counts: SampleCounts::default(),
            contact: [0.0; 2],
            answered: None,
        })
    }

    /// Adds a sample: position (m), depth of its own (m), if it has one, lateral force, unless the sensor has none, and normal force (N). A
    /// NaN is missing.
    ///
    /// # Errors
    /// A number that is infinite or a force that is absurd; of a bank of several depths, no depth; the sample then does not count.
    ///
    /// Implements: SEQ-020, SEQ-024, SEQ-030, SEQ-031.
    pub fn push(
        &mut self,
        x: f64,
        depth: Option<f64>,
        lateral: Option<f64>,
        normal: f64,
    ) -> Result<(), DetectError> {
        let sd = self.question.noise_sd;
        let (lateral, normal) = (lateral.map(|force| force / sd.lateral), normal / sd.normal);
        let numbers = [x, lateral.unwrap_or(0.0), normal, depth.unwrap_or(0.0)];
        let names = [
            "position",
            "lateral force over its noise",
            "normal force over its noise",
            "depth",
        ];
        for (what, number) in names.into_iter().zip(numbers) {
            let is_right = number.is_nan() || number.abs() <= MOST;
            in_range(
                is_right,
                what,
                number,
                "at most 1e50, or NaN where it is missing",
            )?;
        }
        let is_known = depth.is_some() || self.depths.len() == 1;
        let needed =
            "given with each sample (depth_mm), as the bank has several depths of the probe";
        in_range(is_known, "depth", f64::NAN, needed)?;
        if numbers.iter().any(|number| number.is_nan()) {
            self.counts.missing += 1;
            return Ok(());
        }
        let rows = Stencil::of_rows(&self.depths, depth.unwrap_or(self.depths[0]));
        let Some(at) = Place::within(self.reference.laterals(), x).zip(rows) else {
            self.counts.outside += 1;
            return Ok(());
        };
        let own = depth.map_or(Ok(Vec::new()), |depth| self.without(x, depth))?;
        if let Some(lateral) = lateral {
            self.push_row(&at, &own, 0, lateral)?;
        }
        self.push_row(&at, &own, 1, normal)?;
        self.contact[0] += normal * self.at_sample[0];
        self.contact[1] += self.at_sample[0] * self.at_sample[0];
        self.counts.samples += 1;
        self.judge()
    }

    /// F_0, and ∂F_0/∂d if the depth is unknown, at a pose (m), N and N/m, lateral first: as of a record of it.
    ///
    /// Implements: SEQ-030.
    fn without(&self, x: f64, depth: f64) -> Result<Vec<Vec<f64>>, DetectError> {
        let (table, none) = (&self.reference, Force::new(&[0.0][..], &[0.0][..]));
        let at = || {
            let record = Record::along("-", &[x], &[depth], none)?;
            let mut lists = vec![design::expected(&record, table, depth)?];
            if self.question.unknown.contains(&Unknown::Depth) {
                lists.extend(slope(&record, table, depth, design::expected)?);
            }
            Ok(lists)
        };
        // The pose is within the bank, as has been seen.
        at().map_err(|_: Refusal| DetectError::NoSignal)
    }

    /// Adds the force of one channel, 0 lateral or 1 normal, over its noise.
    ///
    /// Implements: SEQ-002.
    fn push_row(
        &mut self,
        (place, rows): &(Place, Stencil),
        own: &[Vec<f64>],
        channel: usize,
        force: f64,
    ) -> Result<(), DetectError> {
        let length = self.at_sample.len();
        self.at_sample.fill(0.0);
        for (weight, table) in rows.weights.iter().zip(&self.expected[rows.first..]) {
            let list = |entry: usize| &table[(2 * entry + channel) * length..][..length];
            let [a, b] = place.entries.map(list);
            for ((value, a), b) in self.at_sample.iter_mut().zip(a).zip(b) {
                *value += weight * ((1.0 - place.fraction) * a + place.fraction * b);
            }
        }
        let own = own.iter().zip(&mut self.at_sample);
        let sd = self.question.noise_sd.into_array()[channel];
        own.for_each(|(of, value)| *value = of[channel] / sd);
        let (expected, signals) = self.at_sample.split_at(length - self.points.len());
        let unit = 1.0 / sd;
        let (mut nuisances, mut used) = ([0.0; MOST_COLUMNS], 0);
        for &unknown in &self.question.unknown {
            let (at, value) = match unknown {
                Unknown::Offset => (channel, unit),
                Unknown::Drift => (channel, unit * self.counts.samples as f64),
                Unknown::Gain => (0, expected[0]),
                Unknown::Depth | Unknown::Variance => (0, expected[expected.len() - 1]),
            };
            nuisances[used + at] = value;
            used += columns(&[unknown]);
        }
        let (residual, nuisances) = (force - expected[0], &nuisances[..used]);
        let [normal, turned] = &mut self.others;
        if channel == 1 {
            normal.push(residual, nuisances, signals)?;
        }
        let sign = if channel == 0 { -1.0 } else { 1.0 };
        turned.push(sign * residual, nuisances, signals)?;
        self.found.push(residual, nuisances, signals)?;
        self.neighbours.push(channel, self.found.innovation());
        Ok(())
    }

    /// Whether the test is over.
    ///
    /// Implements: SEQ-020, SEQ-023.
    fn judge(&mut self) -> Result<(), DetectError> {
        let best = self.likeliest();
        if self.answered.is_some() || self.causes(best).next().is_some() {
            return Ok(());
        }
        let largest = best.map_or(0.0, |(_, of)| of.theta());
        // The mixture is at most the largest, and takes long.
        let is_there =
            largest >= self.question.test.upper() && self.theta()? >= self.question.test.upper();
        let answer = if is_there {
            Some(Decision::Inclusion)
        } else {
            let mut possible = self.possible();
            let is_none = possible.all(|(_, of)| self.is_excluded(of));
            is_none.then_some(Decision::NoInclusion)
        };
        self.answered = answer.map(|answer| (answer, self.counts.samples));
        Ok(())
    }

    /// The places that may be there by the prior.
    fn possible(&self) -> impl Iterator<Item = (usize, Evidence)> {
        let places = self.found.evidence().enumerate();
        places.filter(|&(place, _)| self.prior[place] > 0.0)
    }

    /// The first possible place of the largest θ that has a signal.
    fn likeliest(&self) -> Option<(usize, Evidence)> {
        let told = self.possible().filter(|(_, of)| of.gamma_squared > 0.0);
        told.reduce(|best, next| {
            if next.1.theta() > best.1.theta() {
                next
            } else {
                best
            }
        })
    }

    /// Implements: SEQ-021.
    fn is_covered(&self, of: Evidence) -> bool {
        of.gamma_squared >= -2.0 * self.question.test.lower()
    }

    /// Whether an inclusion there is excluded, if the sensor touches the gel.
    ///
    /// Implements: SEQ-021.
    pub(super) fn is_excluded(&self, of: Evidence) -> bool {
        self.is_covered(of) && of.theta() <= self.question.test.lower()
    }

    /// Why nothing can be answered.
    ///
    /// Implements: SEQ-023.
    fn causes(&self, likeliest: Option<(usize, Evidence)>) -> impl Iterator<Item = Cause> + use<> {
        let [cross, squares] = self.contact;
        let has_level = !self.question.is_zeroed && squares > 0.0;
        let level = has_level.then(|| cross / squares).and_then(wrong_gain);
        let told = likeliest.map_or(0.0, |(_, of)| of.along * of.along / of.gamma_squared);
        let degrees =
            self.found.rows() as f64 - self.found.rank() as f64 - f64::from(likeliest.is_some());
        let beyond = self.found.residual() - told - degrees;
        let width = 2.0 * libm::sqrt(MISFIT * degrees.max(0.0));
        let is_misfit = degrees > 0.0 && (beyond < -width || beyond > width + 2.0 * MISFIT);
        let is_none = self.possible().all(|(_, of)| self.is_excluded(of));
        // The bounds of either answer are broken: no hypothesis explains the record.
        let upper = self.question.test.upper();
        let is_misfit = is_misfit
            || match self.answered {
                Some((Decision::Inclusion, _)) => is_none,
                Some((Decision::NoInclusion, _)) => {
                    likeliest.is_some_and(|(_, of)| of.theta() >= upper)
                        && self.theta().is_ok_and(|theta| theta >= upper)
                }
                None => false,
            };
        // In air it would be the same, so that an answer that there is nothing does not begin.
        let is_silent = self.question.is_zeroed && !is_misfit && self.answered.is_none() && is_none;
        let is_hidden = is_none && self.others.iter().any(|of| self.is_likely(of));
        let causes = [
            (is_misfit, Cause::Misfit),
            (is_silent, Cause::Zeroed),
            (is_hidden, Cause::Channels),
        ];
        let causes = causes.into_iter().filter(|(is_so, _)| *is_so);
        let mut causes = level
            .into_iter()
            .chain(causes.map(|(_, cause)| cause))
            .peekable();
        let is_coloured = causes.peek().is_none() && self.is_coloured();
        causes.chain(is_coloured.then_some(Cause::Coloured))
    }

    /// Whether correlated noise is much likelier than white noise, without an inclusion and with that of each place.
    ///
    /// Implements: SEQ-023.
    pub(super) fn is_coloured(&self) -> bool {
        let is_so = |place, squares| self.neighbours.theta(place, squares) >= MUCH_LIKELIER;
        let without = self.found.residual();
        is_so(None, without)
            && (self.possible()).all(|(place, of)| is_so(Some(place), without - 2.0 * of.theta()))
    }

    /// Whether an inclusion is much likelier than none by these samples.
    ///
    /// Implements: SEQ-023.
    fn is_likely(&self, by: &Sequential<Vec<f64>>) -> bool {
        self.theta_of(by).is_ok_and(|theta| theta >= MUCH_LIKELIER)
    }

    /// ln of the likelihood ratio of an inclusion at any point.
    fn theta(&self) -> Result<f64, DetectError> {
        self.theta_of(&self.found)
    }

    fn theta_of(&self, found: &Sequential<Vec<f64>>) -> Result<f64, DetectError> {
        let theta: Vec<f64> = found.evidence().map(Evidence::theta).collect();
        mixture_theta(&theta, &self.prior)
    }

    /// What the samples so far say of each place that may be there.
    ///
    /// Implements: SEQ-021, SEQ-026.
    pub fn places(&self) -> Vec<WatchedPlace> {
        let is_explained = self.causes(self.likeliest()).next().is_none();
        let may_be_excluded = is_explained && !self.question.is_zeroed;
        let place = |(place, of): (usize, Evidence)| WatchedPlace {
            position: self.points[place][0],
            depth: self.points[place][1],
            told: match (self.is_covered(of), may_be_excluded && self.is_excluded(of)) {
                (false, _) => Told::Uncovered,
                (true, false) => Told::Open,
                (true, true) => Told::Excluded,
            },
        };
        self.possible().map(place).collect()
    }

    /// What the samples so far say.
    ///
    /// # Errors
    /// A result beyond the range of numbers.
    ///
    /// Implements: SEQ-020, SEQ-022, SEQ-023, SEQ-024, SEQ-025.
    pub fn answer(&self) -> Result<WatchAnswer, DetectError> {
        let (best, theta) = (self.likeliest(), self.theta()?);
        let causes: Vec<Cause> = self.causes(best).collect();
        let answered = self.answered.filter(|_| causes.is_empty());
        let places = self.places();
        let count = |least: Told| places.iter().filter(|of| of.told >= least).count();
        let positions = |most: Told| {
            let places = places.iter().filter(|of| of.told <= most);
            increasing(places.map(|of| of.position))
        };
        Ok(WatchAnswer {
            counts: self.counts,
            posterior_h1: posterior(theta, self.question.prior_h1)?,
            theta,
            decision: answered.map(|(decision, _)| decision),
            decided_at_sample: answered.map(|(_, sample)| sample),
            likeliest: best.map(|(place, of)| {
                let [position_m, depth_m, diameter_m, youngs_modulus_pa] = self.points[place];
                // The rounding of a large θ may exceed 1.
                let probability = (self.prior[place] * libm::exp(of.theta() - theta)).min(1.0);
                LikeliestPlace {
                    position_m,
                    depth_m,
                    diameter_m,
                    youngs_modulus_pa,
                    probability,
                }
            }),
            places: places.len(),
            covered: count(Told::Open),
            excluded: count(Told::Excluded),
            open_positions_m: positions(Told::Open),
            uncovered_positions_m: positions(Told::Uncovered),
            causes,
        })
    }
}

/// How many nuisances these are: offset and drift have one for each channel.
fn columns(unknown: &[Unknown]) -> usize {
    let of = |unknown: &Unknown| match unknown {
        Unknown::Offset | Unknown::Drift => 2,
        Unknown::Gain | Unknown::Depth => 1,
        Unknown::Variance => 0,
    };
    unknown.iter().map(of).sum()
}

/// As [`Watcher::expected`], at one depth (m).
fn expected(bank: &Bank, question: &WatchQuestion, depth: f64) -> Result<Vec<f64>, Refusal> {
    let reference = bank.reference().table();
    let (laterals, depths) = (reference.laterals(), reference.depths());
    let of = |map: &ForceTable, depth| map.sweep(depth, laterals).map(stacked);
    let f0 = of(reference, depth)?;
    let mut lists = vec![f0.clone()];
    if question.unknown.contains(&Unknown::Depth) {
        let slope = depth_slope(depths, depth, |depth| of(reference, depth))?;
        lists.push(slope.ok_or_else(single_depth)?);
    }
    for map in bank.maps() {
        lists.push(difference(&of(map.table(), depth)?, &f0));
    }
    let [lateral, normal] = question.noise_sd.into_array();
    let columns = 0..laterals.len();
    let channels =
        columns.flat_map(|column| [(column, lateral), (column + laterals.len(), normal)]);
    let white = channels.flat_map(|(at, sd)| lists.iter().map(move |list| list[at] / sd));
    let white: Vec<f64> = white.collect();
    let units = [1.0 / lateral, 1.0 / normal];
    let mut sizes = white.iter().chain(&units);
    let found = "the forces of the bank are more than 1e50 times the noise";
    let absurd = Refusal::state(found, "state the noise in N");
    absurd.when(sizes.any(|size| size.abs() > MOST))?;
    Ok(white)
}
