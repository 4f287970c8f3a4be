//! What a force–depth curve says of a gel: where the probe touched it, its moduli, how it relaxes, and the noise of the sensor
//! (`spec/calibration.md`).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the question, the stages of the fit, the answer |
//! | `curve.rs` | the curve and its file |
//! | `elastic.rs` | the force over depth of a gel that does not relax |
//! | `relaxation.rs` | how the force falls while the probe stands still |
//! | `fit.rs` | least squares, and what they leave open |
//! | `rows.rs` | the answer, for programs and for people |

mod curve;
mod elastic;
mod fit;
mod relaxation;
mod rows;
#[cfg(test)]
mod tests;

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

pub use curve::Curve;
pub use elastic::{Elastic, Gel, Indentation};
pub use fit::Interval;
pub use relaxation::{Relaxation, relaxed};
pub use rows::modulus_row;

use crate::fem::FemError;
use crate::phantom::Phantom;
use crate::refusal::Refusal;
use crate::stats::noncentral::{Tail, chi_square_point};
use crate::text::extremes;
use elastic::stiffened;
use fit::{Fit, criterion, fit, least};

/// What is known before a curve is fitted.
#[derive(Debug, Clone, Copy)]
pub struct CalibrationQuestion<'a> {
    /// The gel and the probe, whose moduli are those that the fit begins with, and where the probe goes down; none for an empirical law.
    pub gel: Option<(&'a Phantom, Indentation<'a>)>,
    /// Where the probe touched the gel, on the depths of the curve, m; none if it is to be estimated.
    pub contact: Option<f64>,
}

/// Why a curve cannot be judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CurveCause {
    /// Offset and drift of the sensor explain it as well.
    NoContact,
    /// Its forces have the opposite sign.
    Sign,
    /// It begins in contact with the gel, or a sensor without drift would say so.
    NoAir,
    /// It differs from the best fit by more than noise and 0.5 % of its forces.
    Misfit,
}

impl CurveCause {
    /// In words, with what to do.
    pub fn in_words(self) -> &'static str {
        match self {
            CurveCause::NoContact => {
                "the force does not rise above offset, drift and noise; press deeper, or remove samples that are far from their neighbours"
            }
            CurveCause::Sign => {
                "the force falls as the probe presses; reverse its sign: a force that pushes the probe up is positive"
            }
            CurveCause::NoAir => {
                "the curve does not begin above the gel; begin it higher, or say where the probe touches"
            }
            CurveCause::Misfit => {
                "the best fit does not describe the curve; look at its figure, press less deep, or check the phantom"
            }
        }
    }
}

/// A fit leaves more than noise if what is not independent from sample to sample is above this share of the forces' range.
const MISFIT: f64 = 0.005;
/// Five standard deviations of that, of white noise, over its variance and the root of the number of samples.
const BY_CHANCE: f64 = 9.0;
/// A force rises above the baseline where the information criterion is better by this.
const CONTACT: f64 = 20.0;
/// The drift is fitted where so many samples are air, with it and without it.
const LEAST_AIR: usize = 10;
/// Contacts, over the depths of a curve, and exponents that are tried first.
const CONTACTS: u32 = 100;
const EXPONENTS: [f64; 3] = [1.0, 1.5, 2.0];
/// Steps towards an end of the contact's interval, from that of a normal law.
const PROFILE_STEPS: usize = 8;
/// A form of relaxation whose criterion is above the least by less than this may be the right one.
const RIVAL: f64 = 6.0;
/// Moduli are found where a further step changes each by less than this share, after at most so many steps.
const SAME_MODULUS: f64 = 0.02;
const MOST_ROUNDS: usize = 8;

/// What a curve says.
#[derive(Debug, Clone)]
pub struct Calibration<'a> {
    /// The curve.
    pub curve: &'a Curve,
    /// Why it cannot be judged, if so.
    pub cause: Option<CurveCause>,
    /// The law of the force over depth.
    pub elastic: Elastic,
    /// How the force relaxes.
    pub relaxation: Relaxation,
    known: Known,
    fit: Option<Fit>,
    /// What else the force may relax by, and the fits of it.
    rivals: Vec<(Relaxation, Fit)>,
    /// That of the contact, once it was asked for: it takes some fits.
    profile: OnceLock<Interval>,
}

/// What is not fitted.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// The contact, m, if it is known.
    contact: Option<f64>,
    /// That the sensor does not drift: too little of the curve is air to tell it from relaxation.
    no_drift: bool,
}

impl Known {
    /// How many parameters come before those of the law.
    fn parameters(self) -> usize {
        usize::from(self.contact.is_none()) + 1 + usize::from(!self.no_drift)
    }
}

/// A curve beside a law and a form of relaxation: the model to fit.
struct CurveModel<'a> {
    curve: &'a Curve,
    known: Known,
    elastic: &'a Elastic,
    relaxation: Relaxation,
}

/// The parameters of a fit by their meaning.
struct Parts<'p> {
    /// m
    contact: f64,
    /// At the first sample, and how much more at the last, N.
    baseline: [f64; 2],
    elastic: &'p [f64],
    relaxation: &'p [f64],
}

impl CurveModel<'_> {
    /// Contact (mm, if it is not known), offset, drift (if it is fitted), law, relaxation.
    fn parts<'p>(&self, parameters: &'p [f64]) -> Parts<'p> {
        let (sensor, rest) = parameters.split_at(self.known.parameters());
        let (elastic, relaxation) = rest.split_at(self.elastic.parameters());
        let offset = usize::from(self.known.contact.is_none());
        Parts {
            contact: self.known.contact.unwrap_or(1e-3 * sensor[0]),
            baseline: [
                sensor[offset],
                sensor.get(offset + 1).copied().unwrap_or(0.0),
            ],
            elastic,
            relaxation,
        }
    }

    /// The forces at the samples, N.
    ///
    /// Implements: CAL-010, CAL-020.
    fn forces(&self, parameters: &[f64]) -> Vec<f64> {
        let parts = self.parts(parameters);
        let curve = self.curve;
        let force = |depth: &f64| {
            let depth = 1e3 * (depth - parts.contact);
            self.elastic.force(depth, parts.elastic)
        };
        let mut forces: Vec<f64> = curve.depths().iter().map(force).collect();
        if let Some(times) = curve.times() {
            let terms = self.relaxation.terms(parts.relaxation);
            forces = relaxed(&terms, times, &forces);
        }
        let [offset, drift] = parts.baseline;
        let pairs = forces.iter_mut().zip(curve.shares());
        pairs.for_each(|(force, share)| *force += offset + drift * share);
        forces
    }

    fn fit(&self, start: &[f64]) -> Option<Fit> {
        fit(&|at| self.forces(at), self.curve.forces(), start)
    }
}

/// Fits a curve: first an empirical law, which finds the contact, then the forces of the gel, each with the form of relaxation that the
/// information criterion prefers.
///
/// ```
/// use palpate::calibration::{CalibrationQuestion, Curve, calibrate};
///
/// // A spring of 1 N/mm from 1 mm on, and a sensor that says 0.3 N more.
/// let depths: Vec<f64> = (0..60).map(|k| 5e-5 * f64::from(k)).collect();
/// let noise = |k: usize| 1e-4 * [1.0, -1.0, -1.0, 1.0, 0.5, -0.5][k % 6];
/// let force = |(k, depth): (usize, &f64)| 0.3 + f64::max(1e3 * depth - 1.0, 0.0) + noise(k);
/// let forces: Vec<f64> = depths.iter().enumerate().map(force).collect();
/// let curve = Curve::new("spring", None, &depths, &forces)?;
/// let found = calibrate(&curve, CalibrationQuestion { gel: None, contact: None })?;
/// assert_eq!(found.cause, None);
/// let contact = found.contact()?.unwrap();
/// assert!(contact.ends[0] < 1e-3 && 1e-3 < contact.ends[1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`crate::fem::Model::map`], of the phantom down to the depth of the curve; a layer that it does not have.
///
/// Implements: CAL-010, CAL-011, CAL-012, CAL-013, CAL-021, CAL-022, CAL-041.
pub fn calibrate<'a>(
    curve: &'a Curve,
    question: CalibrationQuestion<'_>,
) -> Result<Calibration<'a>, FemError> {
    let [drifts, still] = [false, true].map(|no_drift| Known {
        contact: question.contact,
        no_drift,
    });
    let way = curve.on_the_way();
    let Some(mut start) = empirical_law(&way, drifts) else {
        let none = (Relaxation::None, None);
        let found = Calibration::new(curve, still, Elastic::Empirical, none);
        let cause = match empirical_law(&way.negated(), drifts) {
            Some(_) => CurveCause::Sign,
            None => CurveCause::NoContact,
        };
        return Ok(found.of_cause(cause));
    };
    let contact = question.contact.unwrap_or(1e-3 * start[0]);
    if curve.air(contact) < LEAST_AIR {
        return both_laws(curve, still, question.gel, &start);
    }
    start.insert(still.parameters(), 0.0);
    let found = both_laws(curve, drifts, question.gel, &start)?;
    if found.cause.is_some() || question.contact.is_some() {
        return Ok(found);
    }
    let Some(start) = empirical_law(&way, still) else {
        return Ok(found);
    };
    let beside = both_laws(curve, still, question.gel, &start)?;
    Ok(if beside.lacks_air() {
        beside.of_cause(CurveCause::NoAir)
    } else {
        found
    })
}

/// The fit of the empirical law, from its parameters `start`, and after it that of the forces of the gel, if there is one.
///
/// Implements: CAL-010.
fn both_laws<'a>(
    curve: &'a Curve,
    known: Known,
    gel: Option<(&Phantom, Indentation<'_>)>,
    start: &[f64],
) -> Result<Calibration<'a>, FemError> {
    let found = best(curve, known, Elastic::Empirical, start);
    match gel {
        Some(gel) if found.cause != Some(CurveCause::NoAir) => {
            // In much noise the empirical law may not end, where that of the gel does.
            let ended = found.fit.as_ref().map(|fit| fit.parameters.clone());
            found.of_gel(gel, ended.as_deref().unwrap_or(start))
        }
        _ => Ok(found),
    }
}

fn check_layers(phantom: &Phantom, layers: &[usize]) -> Result<(), Refusal> {
    let count = phantom.layers().len();
    match layers.iter().find(|layer| **layer >= count) {
        Some(layer) => Err(Refusal::value("layer", layer, format!("below {count}"))),
        None => Ok(()),
    }
}

/// Where a fit of the empirical law to the way into a gel begins, its drift left out: at the best of some contacts and exponents, what is
/// linear fitted. None where no force rises above offset, drift (if there may be one) and noise.
///
/// Implements: CAL-010, CAL-040.
fn empirical_law(curve: &Curve, known: Known) -> Option<Vec<f64>> {
    let [least, most] = extremes(curve.depths().iter().copied())?;
    let scanned = |k: u32| least + (most - least) * f64::from(k) / f64::from(CONTACTS);
    let contacts: Vec<f64> = match known.contact {
        Some(contact) => vec![contact],
        None => (0..CONTACTS).map(scanned).collect(),
    };
    let forces = DVector::from_column_slice(curve.forces());
    // What is linear, and the sum of squares that it leaves.
    let linear = |columns: &DMatrix<f64>| {
        let found = columns.tr_mul(columns).cholesky()?;
        let found = found.solve(&columns.tr_mul(&forces));
        let squares = (&forces - columns * &found).norm_squared();
        Some((found, squares))
    };
    let samples = curve.depths().len();
    let shares: Vec<f64> = curve.shares().collect();
    let baseline = 1 + usize::from(!known.no_drift);
    let flat = DMatrix::from_fn(samples, baseline, |at, column| [1.0, shares[at]][column]);
    let mut best = (f64::INFINITY, None);
    for (at, exponent) in contacts.iter().flat_map(|at| EXPONENTS.map(|p| (at, p))) {
        let law = [0.0, libm::log(exponent), 0.0];
        let shape = curve.depths().iter().map(|depth| 1e3 * (depth - at));
        let shape = shape.map(|depth| Elastic::Empirical.force(depth, &law));
        let mut columns = flat.clone().insert_column(baseline, 0.0);
        columns.set_column(baseline, &DVector::from_iterator(samples, shape));
        let Some((found, squares)) = linear(&columns) else {
            continue;
        };
        let stiffness = found[baseline];
        if stiffness > 0.0 && squares < best.0 {
            let own = known.contact.is_none().then_some(1e3 * at);
            let rest = [found[0], libm::log(stiffness), law[1], law[2]];
            best = (squares, Some(own.into_iter().chain(rest).collect()));
        }
    }
    // The baseline and stiffness, contact and exponent; the baseline alone.
    let [all, alone] = [(best.0, baseline + 3), (linear(&flat)?.1, baseline)]
        .map(|(squares, parameters)| criterion(squares, samples, parameters));
    let rises = all + CONTACT < alone;
    best.1.filter(|_| rises)
}

/// The fit of a law, from the parameters `start` without those of relaxation, with the best form of relaxation.
///
/// Implements: CAL-021, CAL-022.
fn best<'a>(curve: &'a Curve, known: Known, elastic: Elastic, start: &[f64]) -> Calibration<'a> {
    let held = curve.held_seconds();
    let forms = if held.is_some() {
        &Relaxation::ALL[..]
    } else {
        &[Relaxation::None]
    };
    let mut fits: Vec<(Relaxation, Fit)> = Vec::new();
    for &relaxation in forms {
        let model = CurveModel {
            curve,
            known,
            elastic: &elastic,
            relaxation,
        };
        let mut start = start.to_vec();
        start.extend(relaxation.start(held.unwrap_or_default()));
        let fit = model.fit(&start);
        let is_seen = |fit: &Fit| {
            let own = model.parts(&fit.parameters).relaxation;
            let first = fit.parameters.len() - own.len();
            // Of each ln τ.
            let mut variances = (first..fit.parameters.len()).step_by(2);
            relaxation.is_seen(own, curve) && variances.all(|at| fit.covariance[(at, at)] < 1.0)
        };
        fits.extend(fit.filter(is_seen).map(|fit| (relaxation, fit)));
    }
    fits.sort_by(|(_, a), (_, b)| a.criterion().total_cmp(&b.criterion()));
    let mut fits = fits.into_iter();
    let found = match fits.next() {
        Some((relaxation, fit)) => (relaxation, Some(fit)),
        None => (Relaxation::None, None),
    };
    let most = found
        .1
        .as_ref()
        .map_or(0.0, |fit: &Fit| fit.criterion() + RIVAL);
    let mut found = Calibration::new(curve, known, elastic, found);
    found.rivals = fits
        .take_while(|(_, fit)| fit.criterion() <= most)
        .collect();
    found.cause = found.why_not();
    found
}

impl<'a> Calibration<'a> {
    /// What a fit says, if there is one, before it is judged.
    fn new(
        curve: &'a Curve,
        known: Known,
        elastic: Elastic,
        (relaxation, fit): (Relaxation, Option<Fit>),
    ) -> Calibration<'a> {
        Calibration {
            curve,
            cause: None,
            elastic,
            relaxation,
            known,
            fit,
            rivals: Vec::new(),
            profile: OnceLock::new(),
        }
    }

    /// The fit of the forces of a gel, after that of the empirical law, from its parameters `start`.
    ///
    /// Implements: CAL-010, CAL-012.
    fn of_gel(
        &self,
        (phantom, asked): (&Phantom, Indentation<'_>),
        start: &[f64],
    ) -> Result<Calibration<'a>, FemError> {
        check_layers(phantom, asked.layers)?;
        let parts = self.model().parts(start);
        let deepest = self.curve.deepest() - parts.contact;
        let end = 1e3 * deepest;
        let force = Elastic::Empirical.force(end, parts.elastic);
        let sensor = self.known.parameters();
        let (mut phantom, mut begin) = (phantom.clone(), start[..sensor].to_vec());
        let mut before: Option<Calibration<'a>> = None;
        let mut round = 0;
        loop {
            // There is room for a contact that the gel's own law finds earlier.
            let gel = Gel::new(&phantom, asked, 1.05 * deepest + 5e-5);
            if let (Err(error), Some(before)) = (&gel, before)
                && !matches!(error, FemError::OutOfMemory | FemError::Stopped)
            {
                // The steps led to moduli that no gel has.
                return Ok(before.of_cause(CurveCause::Misfit));
            }
            let elastic = Elastic::Gel(Box::new(gel?));
            let moduli = vec![0.0; elastic.parameters()];
            // At first as stiff as the empirical law at the end of the curve.
            let ratio = force / elastic.force(end, &moduli);
            let ratio = if round == 0 { libm::log(ratio) } else { 0.0 };
            begin.truncate(sensor);
            begin.extend(moduli.iter().map(|_| ratio));
            let found = best(self.curve, self.known, elastic, &begin);
            let Some(fit) = &found.fit else {
                return Ok(found);
            };
            begin.clone_from(&fit.parameters);
            let changes = found.model().parts(&begin).elastic;
            // One factor of all moduli needs no second table.
            if asked.layers.is_empty() || changes.iter().all(|of| of.abs() < SAME_MODULUS) {
                return Ok(found);
            }
            round += 1;
            if round == MOST_ROUNDS {
                return Ok(found.of_cause(CurveCause::Misfit));
            }
            let factors: Vec<f64> = changes.iter().map(|change| libm::exp(*change)).collect();
            phantom = match stiffened(&phantom, asked.layers, &factors) {
                Ok(phantom) => phantom,
                Err(_) => return Ok(found.of_cause(CurveCause::Misfit)),
            };
            before = Some(found);
        }
    }

    /// The same, which cannot be judged for a cause.
    fn of_cause(mut self, cause: CurveCause) -> Calibration<'a> {
        self.cause = Some(cause);
        self
    }

    fn model(&self) -> CurveModel<'_> {
        self.model_of(self.relaxation)
    }

    fn model_of(&self, relaxation: Relaxation) -> CurveModel<'_> {
        CurveModel {
            curve: self.curve,
            known: self.known,
            elastic: &self.elastic,
            relaxation,
        }
    }

    /// Why a curve that rises above offset and drift cannot be judged.
    ///
    /// Implements: CAL-040.
    fn why_not(&self) -> Option<CurveCause> {
        let Some(found) = &self.fit else {
            return Some(CurveCause::Misfit);
        };
        let noise = sd_of_steps(&found.residuals);
        let more = found.squares / found.residuals.len() as f64 - noise * noise;
        let [least, most] = extremes(found.expected.iter().copied()).unwrap_or_default();
        let allowed = MISFIT * (most - least);
        let by_chance = BY_CHANCE * noise * noise / libm::sqrt(found.residuals.len() as f64);
        if more > allowed * allowed + by_chance {
            return Some(CurveCause::Misfit);
        }
        let contact = self.model().parts(&found.parameters).contact;
        let is_estimated = self.known.contact.is_none();
        (is_estimated && contact < self.curve.depths()[0]).then_some(CurveCause::NoAir)
    }

    /// Whether a fit without drift describes the curve with less air than shows a drift. One that does not end has none: air would end it.
    ///
    /// Implements: CAL-041.
    fn lacks_air(&self) -> bool {
        let Some(found) = &self.fit else {
            return true;
        };
        let contact = self.model().parts(&found.parameters).contact;
        self.cause != Some(CurveCause::Misfit) && self.curve.air(contact) < LEAST_AIR
    }

    /// The fit, if the curve can be judged.
    fn judged(&self) -> Option<&Fit> {
        self.fit.as_ref().filter(|_| self.cause.is_none())
    }

    /// A quantity of the fit, if the curve can be judged.
    fn interval(&self, of: impl Fn(&Parts<'_>) -> f64) -> Result<Option<Interval>, Refusal> {
        let interval = self
            .judged()
            .map(|fit| fit.interval(|at| of(&self.model().parts(at))));
        interval.transpose()
    }

    /// A quantity that there is whatever the form of relaxation, with an interval that holds those of all forms that may be the right one.
    ///
    /// Implements: CAL-022.
    fn whatever_form(&self, of: impl Fn(&Parts<'_>) -> f64) -> Result<Option<Interval>, Refusal> {
        let Some(own) = self.interval(&of)? else {
            return Ok(None);
        };
        self.beside_rivals(own, of).map(Some)
    }

    /// The interval of a quantity that holds those of the rivals too.
    fn beside_rivals(
        &self,
        own: Interval,
        of: impl Fn(&Parts<'_>) -> f64,
    ) -> Result<Interval, Refusal> {
        self.rivals.iter().try_fold(own, |found, (form, fit)| {
            let model = self.model_of(*form);
            let [low, high] = fit.interval(|at| of(&model.parts(at)))?.ends;
            let ends = [found.ends[0].min(low), found.ends[1].max(high)];
            Ok(Interval { ends, ..found })
        })
    }

    /// Where the probe touched the gel, m, on the depths of the curve; without an interval to speak of if it was known.
    ///
    /// # Errors
    /// Numbers that no interval has.
    pub fn contact(&self) -> Result<Option<Interval>, Refusal> {
        let found = self.interval(|parts| parts.contact)?;
        let (Some(normal), Some(fit), None) = (found, self.judged(), self.known.contact) else {
            return Ok(found);
        };
        if self.profile.get().is_none() {
            let ends = self.profile_ends(normal, fit)?;
            let own = Interval { ends, ..normal };
            let found = self.beside_rivals(own, |parts| parts.contact)?;
            self.profile.get_or_init(|| found);
        }
        Ok(self.profile.get().copied())
    }

    /// The ends of the interval of the contact, m, from that of a normal law.
    ///
    /// Implements: CAL-037.
    fn profile_ends(&self, normal: Interval, fit: &Fit) -> Result<[f64; 2], Refusal> {
        let best = 1e-3 * fit.parameters[0];
        // The root of what a contact beside the best one leaves more, over that at an end.
        let over_end = |contact: f64| {
            let known = Known {
                contact: Some(contact),
                ..self.known
            };
            let model = CurveModel {
                known,
                ..self.model()
            };
            let forces = |at: &[f64]| model.forces(at);
            let left = least(&forces, self.curve.forces(), &fit.parameters[1..]);
            fit.over_end(left)
        };
        let ends = [0, 1].map(|end| -> Result<f64, Refusal> {
            let mut reach = normal.ends[end] - normal.estimate;
            for _ in 0..PROFILE_STEPS {
                // It is about proportional to the distance.
                reach /= over_end(best + reach)?.clamp(0.25, 4.0);
            }
            Ok(best + reach)
        });
        let [first, last] = ends;
        Ok([first?.min(normal.estimate), last?.max(normal.estimate)])
    }

    /// The force of the sensor before the curve, N, and how much more it is at its end.
    ///
    /// # Errors
    /// As [`Calibration::contact`].
    pub fn baseline(&self) -> Result<[Option<Interval>; 2], Refusal> {
        let of = |at: usize| self.whatever_form(|parts| parts.baseline[at]);
        Ok([of(0)?, of(1)?.filter(|_| !self.known.no_drift)])
    }

    /// The modulus over that of [`Gel::phantom`], for each modulus that was asked for; of an empirical law k, p and e^q, d in mm.
    ///
    /// # Errors
    /// As [`Calibration::contact`].
    pub fn law(&self) -> Result<Vec<Interval>, Refusal> {
        let law = |at: usize| self.whatever_form(|parts| parts.elastic[at]);
        let all = (0..self.elastic.parameters()).map(law);
        let all = all
            .collect::<Result<Option<Vec<_>>, _>>()?
            .unwrap_or_default();
        Ok(all.into_iter().map(|of| of.map(libm::exp)).collect())
    }

    /// The standard deviation of the noise of a sample, N.
    ///
    /// # Errors
    /// As [`Calibration::contact`].
    ///
    /// Implements: CAL-031.
    pub fn noise_sd(&self) -> Result<Option<Interval>, Refusal> {
        let Some(fit) = self.judged() else {
            return Ok(None);
        };
        let free = fit.residuals.len() as f64 - fit.parameters.len() as f64;
        let estimate = libm::sqrt(fit.squares / free);
        let end = |tail| -> Result<f64, Refusal> {
            let point = chi_square_point(tail, fit.degrees)?;
            Ok(estimate * libm::sqrt(fit.degrees / point))
        };
        let ends = [end(Tail::Upper(0.025))?, end(Tail::Lower(0.025))?];
        Ok(Some(Interval { estimate, ends }))
    }

    /// τ (s) of each term of a Prony series with its gᵢ, or of a power law with its exponent β.
    ///
    /// # Errors
    /// As [`Calibration::contact`].
    ///
    /// Implements: CAL-030.
    pub fn relaxation_terms(&self) -> Result<Vec<(Interval, Interval)>, Refusal> {
        let terms = match self.relaxation {
            Relaxation::None => 0,
            Relaxation::PowerLaw => 1,
            Relaxation::Prony(terms) => terms,
        };
        let term = |at: usize| {
            let time = self.interval(|parts| parts.relaxation[2 * at])?;
            let weight = self.interval(|parts| match self.relaxation {
                Relaxation::PowerLaw => parts.relaxation[1],
                form => libm::log(form.terms(parts.relaxation)[at][0]),
            })?;
            let pair = time.zip(weight);
            Ok(pair.map(|(time, weight)| (time.map(libm::exp), weight.map(libm::exp))))
        };
        let all = (0..terms)
            .map(term)
            .collect::<Result<Option<Vec<_>>, Refusal>>()?;
        Ok(all.unwrap_or_default())
    }

    /// The fitted force of the gel some seconds after the probe reached its depth, over the greatest; none behind the end of the curve.
    pub fn held_after(&self, seconds: f64) -> Option<f64> {
        let (fit, times) = (self.fit.as_ref()?, self.curve.times()?);
        let [offset, drift] = self.model().parts(&fit.parameters).baseline;
        let pairs = fit.expected.iter().zip(self.curve.shares());
        let forces: Vec<f64> = pairs
            .map(|(force, share)| force - offset - drift * share)
            .collect();
        let most = (0..forces.len()).max_by(|a, b| forces[*a].total_cmp(&forces[*b]))?;
        let after = times
            .iter()
            .position(|time| *time >= times[most] + seconds - 1e-9)?;
        Some(forces[after] / forces[most])
    }

    /// The correlation of the estimates of contact and of the first parameter of the law.
    pub fn correlation(&self) -> Option<f64> {
        let fit = self.fit.as_ref().filter(|_| self.known.contact.is_none())?;
        Some(fit.correlation(0, self.known.parameters()))
    }

    /// The forces at the samples, N, that the fit expects, and what it leaves; none without a fit.
    pub fn expected(&self) -> Option<[&[f64]; 2]> {
        let fit = self.fit.as_ref()?;
        Some([&fit.expected, &fit.residuals])
    }

    /// The standard deviation of what is independent from sample to sample in what the fit leaves, N; 0 without a fit.
    pub fn noise_of_steps(&self) -> f64 {
        self.fit
            .as_ref()
            .map_or(0.0, |fit| sd_of_steps(&fit.residuals))
    }

    /// The name and the modulus, Pa, of each of the layers that were asked for; of all without any. None of an empirical law.
    ///
    /// # Errors
    /// As [`Calibration::contact`].
    pub fn moduli(&self, layers: &[usize]) -> Result<Vec<(String, Interval)>, Refusal> {
        let (Elastic::Gel(gel), factors) = (&self.elastic, self.law()?) else {
            return Ok(Vec::new());
        };
        let all = gel.phantom.layers();
        let numbers = match layers {
            [] => (0..all.len()).collect(),
            layers => layers.to_vec(),
        };
        let modulus = |(at, layer): (usize, usize)| {
            // Without layers there is one factor of all.
            let factor = factors.get(at).or(factors.first())?;
            let (name, own) = (&all[layer].name, all[layer].material.youngs_modulus);
            Some((name.clone(), factor.map(|factor| factor * own)))
        };
        Ok(numbers
            .into_iter()
            .enumerate()
            .filter_map(modulus)
            .collect())
    }

    /// The greatest depth of the curve below the contact, m.
    ///
    /// # Errors
    /// As [`Calibration::contact`].
    pub fn greatest_depth(&self) -> Result<Option<f64>, Refusal> {
        let contact = self.contact()?;
        Ok(contact.map(|of| self.curve.deepest() - of.estimate))
    }

    /// The standard deviation of the depth of a probe that is set by this contact, in percent of the greatest depth; none where the contact
    /// was not estimated.
    ///
    /// # Errors
    /// As [`Calibration::contact`].
    ///
    /// Implements: CAL-035.
    pub fn depth_percent(&self) -> Result<Option<f64>, Refusal> {
        let contact = self.contact()?.filter(|_| self.known.contact.is_none());
        // 95 % of a normal law are within 1.96 standard deviations.
        let sd = contact.map(|of| 0.5 * (of.ends[1] - of.ends[0]) / 1.96);
        let both = sd.zip(self.greatest_depth()?);
        Ok(both.map(|(sd, depth)| 100.0 * sd / depth))
    }
}

/// The moduli of several curves, Pa, as in [`Calibration::moduli`]: the geometric mean, with an interval from how they differ; of one
/// curve its own.
///
/// # Errors
/// As [`Calibration::contact`].
///
/// Implements: CAL-034.
pub fn pooled_moduli(
    found: &[Calibration<'_>],
    layers: &[usize],
) -> Result<Vec<(String, Interval)>, Refusal> {
    let all = found.iter().map(|of| of.moduli(layers));
    let all = all.collect::<Result<Vec<_>, _>>()?;
    let (Some(first), count) = (all.first(), all.len() as f64) else {
        return Ok(Vec::new());
    };
    if all.len() == 1 || all.iter().any(Vec::is_empty) {
        return Ok(first.clone());
    }
    let pooled = |(layer, (name, _)): (usize, &(String, Interval))| {
        let logs: Vec<f64> = all
            .iter()
            .map(|of| libm::log(of[layer].1.estimate))
            .collect();
        let mean = logs.iter().sum::<f64>() / count;
        let squares: f64 = logs.iter().map(|log| (log - mean) * (log - mean)).sum();
        let sd = libm::sqrt(squares / (count - 1.0) / count);
        let interval = Interval::of(mean, sd, count - 1.0)?;
        Ok((name.clone(), interval.map(libm::exp)))
    };
    first.iter().enumerate().map(pooled).collect()
}

/// `phantom` with the moduli that curves have shown, as in [`Calibration::moduli`].
///
/// # Errors
/// A modulus that no phantom has.
///
/// Implements: CAL-013.
pub fn calibrated(
    phantom: &Phantom,
    layers: &[usize],
    moduli: &[(String, Interval)],
) -> Result<Phantom, Refusal> {
    let factor = |(_, modulus): &(String, Interval)| {
        modulus.estimate / phantom.layers()[0].material.youngs_modulus
    };
    match moduli.first().map(factor) {
        Some(factor) if layers.is_empty() => stiffened(phantom, layers, &[factor]),
        _ => phantom.changed(|parts| {
            for (layer, (_, modulus)) in layers.iter().zip(moduli) {
                parts.layers[*layer].material.youngs_modulus = modulus.estimate;
            }
        }),
    }
}

/// The standard deviation of independent noise, from the steps from sample to sample.
fn sd_of_steps(residuals: &[f64]) -> f64 {
    let steps = residuals.windows(2).map(|pair| pair[1] - pair[0]);
    let squares: f64 = steps.map(|step| step * step).sum();
    libm::sqrt(squares / (2.0 * (residuals.len() - 1) as f64))
}
