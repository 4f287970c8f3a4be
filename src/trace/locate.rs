//! The record judged at an unknown position of the inclusion, equation (10).

use super::design::{Design, Series, blocked, difference, squares, stacked, whitened};
use super::fit::{Cause, Fit};
use super::judge::{Criterion, Question};
use super::{Record, mm, refused};
use crate::detect::mixture::mixture_theta;
use crate::detect::nuisance::{NoiseLevel, Nuisances, SubspaceDetector, SubspaceTest};
use crate::detect::{Decision, DetectError, map_threshold, posterior};
use crate::force::Force;
use crate::force_map::{ForceTable, SAME_POSITION};
use crate::refusal::Refusal;
use crate::stats::error::check_probability;

/// Most positions of the inclusion that are tried.
///
/// Implements: TRC-032.
pub const MOST_CANDIDATES: usize = 401;

/// A signal that is at most this share of its largest at the ends of the maps has died away there.
///
/// Implements: TRC-042.
pub const DIED_AWAY: f64 = 0.1;

/// What a scan says.
#[derive(Debug, Clone, PartialEq)]
pub struct Location {
    /// Ĥ; none if the record cannot be judged.
    pub decision: Option<Decision>,
    /// Why not, the likeliest cause first.
    pub causes: Vec<Cause>,
    /// T with its law at the position of the maximum.
    pub test: SubspaceTest,
    /// Θ_max.
    pub theta_max: f64,
    /// ln of the likelihood ratio of an inclusion at any candidate, all equally probable.
    pub theta_mixture: f64,
    /// The threshold of Θ_max, or of the mixture.
    pub eta: f64,
    /// Whether the mixture is compared with η, and not Θ_max.
    pub by_mixture: bool,
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
    /// γ at the maximum of all samples if nothing but the position were unknown and the noise white.
    pub gamma_nominal: f64,
    /// How well the record fits with the inclusion there.
    pub fit: Fit,
}

/// The signal of the maps, wherever the inclusion is.
struct Shape<'a> {
    signal: ForceTable,
    depth: f64,
    positions: &'a [f64],
    noise_sd: Force<f64>,
}

/// One position of the inclusion, and the test for it.
struct Candidate {
    position: f64,
    test: SubspaceTest,
}

impl Question<'_> {
    /// Searches `record` for the inclusion.
    ///
    /// # Errors
    /// As [`Question::judge`]; maps without x = 0.
    ///
    /// Implements: TRC-031, TRC-033.
    pub fn locate(&self, record: &Record) -> Result<Location, Refusal> {
        let located = || {
            let mut design = Design::new(self, record)?;
            // First where it probably lies, which does not depend on the level of the noise, so that its signal is not taken for noise.
            let noise_sd = self.noise.sd.unwrap_or(Force::new(1.0, 1.0));
            let mut shape = Shape::new(self, record, noise_sd)?;
            let white = design.whitened(noise_sd);
            let found = self.candidates(&shape, &white, 1, NoiseLevel::Known)?;
            design.template = shape.template(likeliest(&found).position)?;
            if self.noise.sd.is_none() {
                shape.noise_sd = design.noise_sd().map_err(refused)?;
            }
            let white = design.whitened(shape.noise_sd);
            let fit = Fit::new(self, &white, shape.noise_sd).map_err(refused)?;
            let found = self.candidates(&shape, &white, fit.block, self.noise_level(&fit))?;
            self.location(&shape, &white, fit, &found)
        };
        located().map_err(|refusal: Refusal| refusal.in_file(record.file()))
    }

    /// The test for each candidate that the nuisances leave something of.
    ///
    /// Implements: TRC-032.
    fn candidates(
        &self,
        shape: &Shape<'_>,
        white: &Design,
        block: usize,
        level: NoiseLevel,
    ) -> Result<Vec<Candidate>, Refusal> {
        let blocks = white.blocks(block);
        let mut residual = stacked(&blocks.residual);
        let mut signals = blocks.signals(false);
        let nuisances = Nuisances::new(&mut signals, residual.len()).map_err(refused)?;
        let mut test = |position: f64| {
            let mut template = stacked(&blocked(&shape.whitened(position)?, block));
            let mut judged = || {
                let detector = SubspaceDetector::new(nuisances, &mut template)?;
                detector
                    .statistic(&mut residual)?
                    .test(level, blocks.bias(&detector))
            };
            match judged() {
                // What is unknown explains all of it.
                Err(DetectError::NoSignal) => Ok(None),
                test => Ok(Some(Candidate {
                    position,
                    test: test.map_err(refused)?,
                })),
            }
        };
        let found = shape
            .candidates()
            .filter_map(|position| test(position).transpose());
        let found = found.collect::<Result<Vec<_>, Refusal>>()?;
        match found.is_empty() {
            true => Err(refused(DetectError::NoSignal)),
            false => Ok(found),
        }
    }

    /// Implements: TRC-034, TRC-035, TRC-038, TRC-039, TRC-040.
    fn location(
        &self,
        shape: &Shape<'_>,
        white: &Design,
        fit: Fit,
        found: &[Candidate],
    ) -> Result<Location, Refusal> {
        let best = likeliest(found);
        let located = || {
            let theta: Vec<f64> = found
                .iter()
                .map(|candidate| candidate.test.theta())
                .collect();
            let share = 1.0 / found.len() as f64;
            let mixture = mixture_theta(&theta, &vec![share; found.len()])?;
            let eta = self.eta(found)?;
            let by_mixture = self.criterion == Criterion::Map;
            let (statistic, lower) = match by_mixture {
                true => (mixture, eta - libm::log(share)),
                false => (best.test.theta(), eta),
            };
            let causes = fit.causes(&best.test)?;
            let decision = if statistic >= eta {
                Decision::Inclusion
            } else {
                Decision::NoInclusion
            };
            let miss = best.test.rates(best.test.bayes_threshold(lower)?)?.miss;
            Ok((causes, decision, mixture, eta, by_mixture, miss))
        };
        let (causes, decision, theta_mixture, eta, by_mixture, miss_bound) =
            located().map_err(refused)?;
        Ok(Location {
            decision: causes.is_empty().then_some(decision),
            causes,
            test: best.test,
            theta_max: best.test.theta(),
            theta_mixture,
            eta,
            by_mixture,
            posterior: posterior(theta_mixture, self.prior_h1).map_err(refused)?,
            false_alarm_bound: false_alarm_bound(found, eta).map_err(refused)?,
            miss_bound,
            position: refined(found),
            position_sd_bound: shape.position_sd_bound(white, &fit, best)?,
            template_edge: shape.edge()?,
            candidates: found.len(),
            gamma_nominal: libm::sqrt(squares(&stacked(&shape.whitened(best.position)?))),
            fit,
        })
    }

    /// The threshold of Θ_max, or of the mixture for the MAP criterion.
    ///
    /// Implements: TRC-036, TRC-037, TRC-038.
    fn eta(&self, found: &[Candidate]) -> Result<f64, DetectError> {
        match self.criterion {
            Criterion::Map => map_threshold(self.prior_h1),
            // The promise is for an inclusion anywhere: the lowest threshold keeps it.
            Criterion::NeymanPearsonMiss { max_miss } => {
                found.iter().try_fold(f64::INFINITY, |lowest, candidate| {
                    let test = candidate.test;
                    let t = test.miss_threshold(max_miss)?.max(test.least_theta_at());
                    Ok(lowest.min(SubspaceTest { t, ..test }.theta()))
                })
            }
            Criterion::NeymanPearsonFalseAlarm { max_false_alarm } => {
                check_probability("max_false_alarm", max_false_alarm)?;
                let (mut low, mut high) = (-1.0, 1.0);
                while false_alarm_bound(found, low)? <= max_false_alarm {
                    low *= 2.0;
                }
                while false_alarm_bound(found, high)? > max_false_alarm {
                    high *= 2.0;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    match false_alarm_bound(found, middle)? <= max_false_alarm {
                        true => high = middle,
                        false => low = middle,
                    }
                }
                Ok(high)
            }
        }
    }
}

/// Σ_k Pr(Θ_k ≥ η | H = 0), at most 1.
///
/// Implements: TRC-039.
fn false_alarm_bound(found: &[Candidate], eta: f64) -> Result<f64, DetectError> {
    let sum = found.iter().try_fold(0.0, |sum, Candidate { test, .. }| {
        Ok(sum + test.rates(test.bayes_threshold(eta)?)?.false_alarm)
    });
    Ok(f64::min(sum?, 1.0))
}

/// The first candidate of the largest θ; there is at least one.
fn likeliest(found: &[Candidate]) -> &Candidate {
    let theta = |candidate: &Candidate| candidate.test.theta();
    let better = |best, next| {
        if theta(next) > theta(best) {
            next
        } else {
            best
        }
    };
    found.iter().fold(&found[0], better)
}

/// The vertex of the parabola through θ at the likeliest candidate and its neighbours.
///
/// Implements: TRC-034.
fn refined(found: &[Candidate]) -> f64 {
    let best = likeliest(found).position;
    let around = found.windows(3).find(|around| around[1].position == best);
    let Some([before, at, after]) = around else {
        return best;
    };
    let step = 0.5 * (after.position - before.position);
    let [left, top, right] = [before, at, after].map(|candidate| candidate.test.theta());
    let bend = left - 2.0 * top + right;
    let offset = if bend < 0.0 {
        0.5 * (left - right) / bend
    } else {
        0.0
    };
    best + step * offset.clamp(-0.5, 0.5)
}

impl<'a> Shape<'a> {
    /// # Errors
    /// Maps without x = 0.
    fn new(
        question: &Question<'_>,
        record: &'a Record,
        noise_sd: Force<f64>,
    ) -> Result<Shape<'a>, Refusal> {
        let signal = question.hypotheses.signal()?;
        let [first, last] = ends(signal.laterals());
        if first > SAME_POSITION || last < -SAME_POSITION {
            return Err(Refusal::state(
                format!("the maps cover {} to {} mm", mm(first), mm(last)),
                "the inclusion's position, 0 mm, among them",
            ));
        }
        let (depth, positions) = (question.depth, record.positions());
        Ok(Shape {
            signal,
            depth,
            positions,
            noise_sd,
        })
    }

    /// The positions of the inclusion that are tried: of the samples, or as many as there may be from the first to the last.
    ///
    /// Implements: TRC-032.
    fn candidates(&self) -> impl Iterator<Item = f64> {
        let [first, last] = ends(self.positions);
        let most = self.positions.len().min(MOST_CANDIDATES);
        let step = (last - first) / most.saturating_sub(1).max(1) as f64;
        (0..most).map(move |k| first + k as f64 * step)
    }

    /// The signal of an inclusion at `position` at the samples, N; beyond the maps it is what it is at their end.
    ///
    /// Implements: TRC-031.
    fn template(&self, position: f64) -> Result<Series, Refusal> {
        let [first, last] = ends(self.signal.laterals());
        let from_it = self.positions.iter().map(|x| x - position);
        let reached: Vec<f64> = from_it.map(|x| x.clamp(first, last)).collect();
        self.signal.sweep(self.depth, &reached)
    }

    /// The same over the noise.
    fn whitened(&self, position: f64) -> Result<Series, Refusal> {
        Ok(whitened(&self.template(position)?, self.noise_sd))
    }

    /// The Cramér–Rao bound at a candidate, with the nuisances unknown.
    ///
    /// Implements: TRC-034.
    fn position_sd_bound(&self, white: &Design, fit: &Fit, at: &Candidate) -> Result<f64, Refusal> {
        let [first, last] = ends(self.signal.laterals());
        let step = (last - first) / 1e3;
        let beside = [at.position - step, at.position + step].map(|x| self.whitened(x));
        let [before, after] = beside;
        let rise = difference(after?.as_deref(), before?.as_deref());
        let mut slope = stacked(&blocked(&rise, fit.block));
        let blocks = white.blocks(fit.block);
        let mut signals = blocks.signals(false);
        let nuisances = Nuisances::new(&mut signals, slope.len()).map_err(refused)?;
        let left = nuisances.project(&mut slope) / (2.0 * step);
        let mut template = stacked(&blocked(&self.whitened(at.position)?, fit.block));
        let noise = nuisances.project(&mut template) / at.test.gamma;
        match left > 0.0 {
            true => Ok(noise / left),
            false => Err(refused(DetectError::NoSignal)),
        }
    }

    /// Implements: TRC-042.
    fn edge(&self) -> Result<f64, Refusal> {
        let signal = self.signal.sweep(self.depth, self.signal.laterals())?;
        let signal = whitened(&signal, self.noise_sd);
        let largest = |samples: &[f64]| samples.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        let both = signal.map(|signal| (largest(&ends(&signal)), largest(&signal)));
        let all = both.lateral.1.max(both.normal.1);
        let at_ends = both.lateral.0.max(both.normal.0);
        Ok(if all > 0.0 { at_ends / all } else { 0.0 })
    }
}

/// The first and the last; there is at least one.
fn ends(values: &[f64]) -> [f64; 2] {
    [values[0], values[values.len() - 1]]
}
