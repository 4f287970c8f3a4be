//! The record judged at an unknown position of the inclusion, equation (10).

use super::judge::{Misfit, Question, residual};
use super::{Criterion, Record, mm, refused};
use crate::detect::assessment::{ScanAssessment, assess_scan};
use crate::detect::mixture::mixture_theta;
use crate::detect::position::{MaximumLaw, position_bound, slope};
use crate::detect::scan::Scan;
use crate::detect::{
    Decision, DetectError, decide, error_rates, map_threshold, neyman_pearson_miss_threshold,
    posterior,
};
use crate::force::Force;
use crate::force_map::{Hypotheses, SAME_POSITION};
use crate::refusal::Refusal;

/// Steps of a record that differ by less than this share of a step are equal.
///
/// Implements: TRC-030.
pub const UNIFORM: f64 = 1e-6;

/// Most samples of a record to scan: the work grows with their square.
///
/// Implements: TRC-041.
pub const MOST_SAMPLES: usize = 20_000;

/// A signal that is at most this share of its largest at the ends of the maps has died away there.
///
/// Implements: TRC-042.
pub const DIED_AWAY: f64 = 0.1;

/// What a scan says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Location {
    /// Θ_max.
    pub theta_max: f64,
    /// ln of the likelihood ratio of an inclusion at any candidate, all equally probable.
    pub theta_mixture: f64,
    /// γ at the shift of the maximum.
    pub gamma: f64,
    /// The threshold.
    pub eta: f64,
    /// Whether the mixture is compared with η, and not Θ_max.
    pub by_mixture: bool,
    /// Ĥ.
    pub decision: Decision,
    /// Pr(H = 1), by the mixture.
    pub posterior: f64,
    /// The false-alarm rate is at most this.
    pub false_alarm_bound: f64,
    /// The miss rate for an inclusion at the position found is at most this.
    pub miss_bound: f64,
    /// x̂, m.
    pub position: f64,
    /// No unbiased estimate of the position has a smaller standard deviation, m.
    pub position_sd_bound: f64,
    /// The signal at an end of the maps over its largest, both over the noise of their channel: above
    /// [`DIED_AWAY`] the position is drawn to the maps' x = 0, which the bound does not count.
    pub template_edge: f64,
    /// Positions that were tried.
    pub candidates: usize,
    /// How far the record is from either hypothesis.
    pub misfit: Misfit,
}

/// The signal on the grid of the record, and what is left of the record without inclusion.
struct Grid {
    /// Distance of the samples, m.
    spacing: f64,
    /// Position of the first sample, m.
    start: f64,
    /// The shift at which the inclusion lies at the first sample, ≤ 0.
    first_shift: isize,
    template: Force<Vec<f64>>,
    residual: Force<Vec<f64>>,
}

impl Question<'_> {
    /// Searches `record` for the inclusion. The candidates are the positions of the samples.
    ///
    /// # Errors
    /// As [`Question::judge`]; a record whose steps are not equal, that is too long, or shorter than the maps; maps without
    /// x = 0.
    ///
    /// Implements: TRC-034, TRC-035, TRC-036, TRC-037, TRC-038, TRC-039, TRC-040.
    pub fn locate(&self, record: &Record) -> Result<Location, Refusal> {
        let located = || {
            let grid = Grid::new(record, &self.hypotheses, self.depth)?;
            grid.locate(self).map_err(refused)
        };
        located().map_err(|refusal: Refusal| refusal.in_file(record.file()))
    }
}

impl Grid {
    /// The template of the hypotheses, and the residual of the record without inclusion.
    ///
    /// Implements: TRC-030, TRC-031, TRC-032, TRC-033, TRC-041.
    fn new(record: &Record, hypotheses: &Hypotheses<'_>, depth: f64) -> Result<Grid, Refusal> {
        let f0 = record.expected(hypotheses.without(), depth)?;
        let spacing = equal_steps(record)?;
        let signal = hypotheses.signal()?;
        let laterals = signal.laterals();
        let (first, last) = (laterals[0], laterals[laterals.len() - 1]);
        if first > SAME_POSITION || last < -SAME_POSITION {
            return Err(Refusal::state(
                format!("the maps cover {} to {} mm", mm(first), mm(last)),
                "the inclusion's position, 0 mm, among them",
            ));
        }
        let first_sample = libm::ceil((first - SAME_POSITION) / spacing);
        let last_sample = libm::floor((last + SAME_POSITION) / spacing);
        let (template, samples) = (last_sample - first_sample + 1.0, record.positions().len());
        if template > samples as f64 {
            return Err(Refusal::state(
                format!("{samples} samples"),
                format!(
                    "at least the {template} that the maps cover at this spacing: a scan needs a sweep as long as the maps, or maps over fewer lateral positions"
                ),
            ));
        }
        // Both lie between −20 000 and 20 000 now: the template holds j = 0.
        let (first_shift, last_sample) = (first_sample as isize, last_sample as isize);
        let positions: Vec<f64> = (first_shift..=last_sample)
            .map(|j| j as f64 * spacing)
            .collect();
        Ok(Grid {
            spacing,
            start: record.positions()[0],
            first_shift,
            template: signal.sweep(depth, &positions)?,
            residual: residual(record, f0.as_deref()),
        })
    }

    fn locate(&self, question: &Question<'_>) -> Result<Location, DetectError> {
        let &Question {
            noise_sd,
            criterion,
            prior_h1,
            ..
        } = question;
        let candidates = self.residual.lateral.len();
        let scan = Scan::new(candidates, self.template.as_deref(), noise_sd)?;
        let (mut gamma, mut angle) = (vec![0.0; candidates], vec![0.0; candidates]);
        let law = MaximumLaw::new(&scan, self.first_shift, &mut gamma, &mut angle)?;
        let eta = threshold(&scan, &law, criterion, prior_h1)?;
        let found: ScanAssessment = assess_scan(&scan, &law, self.residual.as_deref(), eta)?;
        let shift = found.maximum.shift;
        let mut theta = vec![0.0; candidates];
        scan.theta(self.residual.as_deref(), self.first_shift, &mut theta)?;
        let mixture = mixture_theta(&theta, &vec![1.0 / candidates as f64; candidates])?;
        let mut location = Location {
            theta_max: found.maximum.theta,
            theta_mixture: mixture,
            gamma: found.maximum.gamma,
            eta,
            by_mixture: criterion == Criterion::Map,
            decision: found.decision,
            posterior: posterior(mixture, prior_h1)?,
            false_alarm_bound: found.false_alarm_bound,
            miss_bound: found.miss_bound,
            position: self.start
                + (found.maximum.refined_shift - self.first_shift as f64) * self.spacing,
            position_sd_bound: self.position_sd_bound(shift, noise_sd)?,
            template_edge: self.template_edge(noise_sd),
            misfit: Misfit::of(self.residual.as_deref(), noise_sd, found.maximum.theta)?,
            candidates,
        };
        if location.by_mixture {
            location.decision = decide(mixture, eta)?;
            let markov = libm::exp(-eta);
            location.false_alarm_bound = location.false_alarm_bound.min(markov);
            let lower = eta + libm::log(candidates as f64);
            location.miss_bound = error_rates(location.gamma, lower)?.miss;
        }
        Ok(location)
    }

    /// Implements: TRC-042.
    fn template_edge(&self, noise_sd: Force<f64>) -> f64 {
        let parts = self.template.as_deref().zip(noise_sd).map(|(signal, sd)| {
            let largest =
                |samples: &[f64]| samples.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
            let ends = [signal[0], signal[signal.len() - 1]];
            (largest(&ends) / sd, largest(signal) / sd)
        });
        let (ends, all) = (
            parts.lateral.0.max(parts.normal.0),
            parts.lateral.1.max(parts.normal.1),
        );
        if all > 0.0 { ends / all } else { 0.0 }
    }

    /// The Cramér–Rao bound of what the record holds of the template at a shift.
    ///
    /// Implements: TRC-034.
    fn position_sd_bound(&self, shift: isize, noise_sd: Force<f64>) -> Result<f64, DetectError> {
        let samples = 0..self.residual.lateral.len() as isize;
        let seen = |template: &[f64]| {
            let mut slopes = vec![0.0; template.len()];
            slope(template, self.spacing, &mut slopes)?;
            let places = (shift..).zip(slopes);
            let seen = places.filter(|(place, _)| samples.contains(place));
            Ok::<Vec<f64>, DetectError>(seen.map(|(_, slope)| slope).collect())
        };
        let (x, y) = (seen(&self.template.lateral)?, seen(&self.template.normal)?);
        position_bound(Force::new(&x, &y), noise_sd)
    }
}

/// The mean spacing of a record's samples, m, if all are equal.
///
/// Implements: TRC-030, TRC-041.
fn equal_steps(record: &Record) -> Result<f64, Refusal> {
    let positions = record.positions();
    let samples = positions.len();
    if !(2..=MOST_SAMPLES).contains(&samples) {
        let expected = format!("2 to {MOST_SAMPLES} for a scan");
        return Err(Refusal::state(format!("{samples} samples"), expected));
    }
    let start = positions[0];
    let spacing = (positions[samples - 1] - start) / (samples - 1) as f64;
    for (i, (&found, &line)) in positions.iter().zip(&record.lines).enumerate() {
        let expected = start + i as f64 * spacing;
        if (found - expected).abs() > UNIFORM * spacing {
            let expected = format!(
                "{} mm: a scan shifts the template by whole samples, so the steps must be equal within {UNIFORM:e} of a step",
                mm(expected)
            );
            return Err(Refusal::state(format!("position {} mm", mm(found)), expected).at(line));
        }
    }
    Ok(spacing)
}

/// Implements: TRC-036, TRC-037, TRC-038.
fn threshold(
    scan: &Scan<'_>,
    law: &MaximumLaw<'_>,
    criterion: Criterion,
    prior_h1: f64,
) -> Result<f64, DetectError> {
    match criterion {
        Criterion::Map => map_threshold(prior_h1),
        Criterion::NeymanPearsonFalseAlarm { max_false_alarm } => law.threshold(max_false_alarm),
        Criterion::NeymanPearsonMiss { max_miss } => {
            // The promise is for an inclusion anywhere: the lowest threshold keeps it.
            law.shifts().try_fold(f64::INFINITY, |lowest, shift| {
                let eta = neyman_pearson_miss_threshold(scan.gamma(shift)?, max_miss)?;
                Ok(lowest.min(eta))
            })
        }
    }
}
