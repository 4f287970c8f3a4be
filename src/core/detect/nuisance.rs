//! Θ where the record may also hold signals of unknown amplitude: an offset, a drift, another gain. Records and signals are
//! whitened here: both channels one after the other, each sample over the standard deviation of its noise.
//!
//! These are the matched subspace detectors of Scharf & Friedlander (1994) and Kay (*Detection Theory*, chapters 7 and 9): all is
//! projected onto the complement of the nuisances, so that no amplitude of theirs has an effect.

use super::{Decision, DetectError, ErrorRates};
use crate::stats::error::{
    check_finite, check_length, check_not_negative, check_positive, check_probability,
    check_samples, representable,
};
use crate::stats::{noncentral, normal};

/// A signal of which less than this share is left beside the others is one of them.
///
/// Implements: NUI-001.
pub const DEPENDENT: f64 = 1e-9;

/// An orthonormal basis of signals that may be in any record.
#[derive(Debug, Clone, Copy)]
pub struct Nuisances<'a> {
    /// One vector of the basis after the other.
    basis: &'a [f64],
    samples: usize,
}

/// How many of some signals are independent; only [`Nuisances`] tells, and nobody can take the number of the signals for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rank(usize);

impl Rank {
    /// As a number.
    pub fn get(self) -> usize {
        self.0
    }
}

impl<'a> Nuisances<'a> {
    /// The space that `signals` span: vectors of `samples` numbers, one after the other, none or more, that become the basis.
    ///
    /// # Errors
    /// No samples; a length that is no multiple of them; NaN or infinity.
    ///
    /// Implements: NUI-001, NUI-010.
    pub fn new(signals: &'a mut [f64], samples: usize) -> Result<Nuisances<'a>, DetectError> {
        if samples == 0 {
            return Err(DetectError::Empty { what: "nuisance" });
        }
        let number = signals.len() / samples;
        check_length("nuisance", number * samples, signals.len())?;
        if number > 0 {
            check_samples("nuisance", signals, signals.len())?;
        }
        let mut kept = 0;
        for column in 0..number {
            let (basis, rest) = signals.split_at_mut(kept * samples);
            let signal = &mut rest[(column - kept) * samples..][..samples];
            let known = Nuisances { basis, samples };
            let length = normalise(signal);
            if length > 0.0 && known.project(signal)? > 0.0 {
                normalise(signal);
                signals.copy_within(column * samples..(column + 1) * samples, kept * samples);
                kept += 1;
            }
        }
        let basis = &signals[..kept * samples];
        Ok(Nuisances { basis, samples })
    }

    /// The space of a basis that [`Nuisances::new`] made, of vectors of `samples` numbers.
    pub fn of_basis(basis: &'a [f64], samples: usize) -> Nuisances<'a> {
        Nuisances { basis, samples }
    }

    /// The number of independent signals.
    pub fn rank(&self) -> Rank {
        Rank(self.basis.len() / self.samples)
    }

    /// Takes from a vector what lies in the space, twice: what rounding leaves of a large part the first time goes the second.
    /// The length of the rest, 0 if that is at most [`DEPENDENT`] of what was there.
    ///
    /// # Errors
    /// A vector whose square is beyond the largest number.
    ///
    /// Implements: NUI-004, DET-008.
    pub fn project(&self, vector: &mut [f64]) -> Result<f64, DetectError> {
        let whole = representable("gamma", libm::sqrt(dot(vector, vector)))?;
        self.take(vector);
        self.take(vector);
        let rest = libm::sqrt(dot(vector, vector));
        Ok(if rest > DEPENDENT * whole { rest } else { 0.0 })
    }

    /// Takes from a vector what lies in the space.
    fn take(&self, vector: &mut [f64]) {
        for direction in self.basis.chunks_exact(self.samples) {
            let along = dot(direction, vector);
            for (value, direction) in vector.iter_mut().zip(direction) {
                *value -= along * direction;
            }
        }
    }
}

/// Scales a vector to length 1, if it has one; the length.
fn normalise(vector: &mut [f64]) -> f64 {
    let magnitudes = vector.iter().map(|value| value.abs());
    let largest = magnitudes.fold(0.0, f64::max);
    if largest > 0.0 {
        // First near 1, where squares neither overflow nor underflow.
        vector.iter_mut().for_each(|value| *value /= largest);
        let length = libm::sqrt(dot(vector, vector));
        vector.iter_mut().for_each(|value| *value /= length);
    }
    largest
}

/// Σ ab in independent parts, whose number is fixed, so that registers of any width give the same bits.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    const PARTS: usize = 8;
    let mut parts = [0.0; PARTS];
    let (a, b) = (a.chunks(PARTS), b.chunks(PARTS));
    for (a, b) in a.zip(b) {
        for ((part, a), b) in parts.iter_mut().zip(a).zip(b) {
            *part += a * b;
        }
    }
    parts.iter().sum()
}

/// The detector of a template beside nuisances.
///
/// ```
/// use palpate_core::detect::nuisance::{NoiseLevel, Nuisances, SubspaceDetector};
///
/// // Six samples with an unknown offset, in noise of standard deviation 1.
/// let (mut offset, mut template) = ([1.0; 6], [0.0, 0.0, 3.0, 3.0, 0.0, 0.0]);
/// let detector = SubspaceDetector::new(Nuisances::new(&mut offset, 6)?, &mut template)?;
/// // The mean of the template tells nothing any more: γ² = Σ (Δ − 1)² = 12 is left of 18.
/// assert!((detector.gamma_nominal().powi(2) - 18.0).abs() < 1e-12);
/// assert!((detector.gamma().powi(2) - 12.0).abs() < 1e-12);
/// // The template itself on an offset of 100: θ = γ²/2, and what is left fits.
/// let mut record = [100.0, 100.0, 103.0, 103.0, 100.0, 100.0];
/// let found = detector.statistic(&mut record)?;
/// let test = found.test(NoiseLevel::Known, 0.0)?;
/// assert!((test.theta() - 6.0).abs() < 1e-11 && found.residual < 1e-20);
/// assert_eq!(found.degrees, 4.0);
/// # Ok::<(), palpate_core::detect::DetectError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct SubspaceDetector<'a> {
    nuisances: Nuisances<'a>,
    /// Δ without its part among the nuisances.
    template: &'a [f64],
    gamma: f64,
    gamma_nominal: f64,
}

/// What a detector with nuisances says about one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubspaceStatistic {
    /// T = Δ⊥ᵀr/γ: normal with standard deviation 1, about 0 without and about γ with the inclusion.
    pub t: f64,
    /// γ = |Δ⊥|, what the nuisances leave of the signal-to-noise ratio.
    pub gamma: f64,
    /// Σ of the squares that neither the nuisances nor the template explain: χ² with [`Self::degrees`] degrees of freedom
    /// under either hypothesis, independent of T.
    pub residual: f64,
    /// Samples less nuisances less one.
    pub degrees: f64,
}

impl<'a> SubspaceDetector<'a> {
    /// The detector of `template`, which becomes Δ⊥.
    ///
    /// # Errors
    /// Another length than that of the nuisances; NaN or infinity; a template that the nuisances explain, to
    /// [`DEPENDENT`]; γ beyond the largest number; fewer samples than nuisances and two.
    ///
    /// Implements: NUI-003, NUI-004, NUI-010.
    pub fn new(
        nuisances: Nuisances<'a>,
        template: &'a mut [f64],
    ) -> Result<SubspaceDetector<'a>, DetectError> {
        check_samples("template", template, nuisances.samples)?;
        let samples = (nuisances.samples - 1).saturating_sub(nuisances.rank().0);
        check_positive("degrees of freedom", samples as f64)?;
        let gamma_nominal = libm::sqrt(dot(template, template));
        let gamma = nuisances.project(template)?;
        if gamma == 0.0 {
            return Err(DetectError::NoSignal);
        }
        Ok(SubspaceDetector {
            nuisances,
            template,
            gamma,
            gamma_nominal,
        })
    }

    /// γ, what the nuisances leave.
    pub fn gamma(&self) -> f64 {
        self.gamma
    }

    /// γ of the same template if every nuisance were known.
    pub fn gamma_nominal(&self) -> f64 {
        self.gamma_nominal
    }

    /// What a whitened signal adds to T.
    pub fn along(&self, signal: &[f64]) -> f64 {
        dot(self.template, signal) / self.gamma
    }

    /// What a whitened residual (F_p − F_0)/s says, which becomes what the nuisances leave of it.
    ///
    /// # Errors
    /// Another length than the template's; NaN or infinity; overflow.
    ///
    /// Implements: NUI-003, NUI-007, NUI-010, NUI-016.
    pub fn statistic(&self, residual: &mut [f64]) -> Result<SubspaceStatistic, DetectError> {
        let samples = self.nuisances.samples;
        check_samples("residual", residual, samples)?;
        self.nuisances.take(residual);
        let t = representable("t", self.along(residual))?;
        let part = t / self.gamma;
        let left = residual.iter().zip(self.template);
        let left = left.map(|(residual, template)| residual - part * template);
        Ok(SubspaceStatistic {
            t,
            gamma: self.gamma,
            residual: representable("residual", left.map(|left| left * left).sum())?,
            degrees: (samples - 1 - self.nuisances.rank().0) as f64,
        })
    }
}

/// How the noise of a record is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseLevel {
    /// Its standard deviation is the one that the record was divided by.
    Known,
    /// The record itself tells it: T is studentised.
    Unknown,
}

/// Which T are of an inclusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// Every T.
    Always,
    /// Those from here on.
    At(f64),
    /// None.
    Never,
}

impl Threshold {
    /// Ĥ for the statistic `t`.
    pub fn decide(self, t: f64) -> Decision {
        match self {
            Threshold::Always => Decision::Inclusion,
            Threshold::At(threshold) if t >= threshold => Decision::Inclusion,
            Threshold::At(_) | Threshold::Never => Decision::NoInclusion,
        }
    }
}

/// T of a record with the law that it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubspaceTest {
    /// T, over the estimate of the noise where its level is unknown.
    pub t: f64,
    /// γ in the same unit.
    pub gamma: f64,
    /// The degrees of freedom of Student's law; none for the normal one.
    pub degrees: Option<f64>,
    /// What a nuisance that is known within bounds may add to T, or take from it, at most.
    pub bias: f64,
}

impl SubspaceStatistic {
    /// The test of this record; `bias` is in the unit of [`SubspaceStatistic::t`].
    ///
    /// # Errors
    /// A bias below 0, or that is not finite; an unknown level of noise where nothing is left to tell it.
    ///
    /// Implements: NUI-008, NUI-007, NUI-014, NUI-016.
    pub fn test(self, level: NoiseLevel, bias: f64) -> Result<SubspaceTest, DetectError> {
        check_not_negative("bias", bias)?;
        let (scale, degrees) = match level {
            NoiseLevel::Known => (1.0, None),
            NoiseLevel::Unknown => (libm::sqrt(self.residual / self.degrees), Some(self.degrees)),
        };
        check_positive("noise of the residual", scale)?;
        let test = SubspaceTest {
            t: representable("t", self.t / scale)?,
            gamma: representable("gamma", self.gamma / scale)?,
            degrees,
            bias: representable("bias", bias / scale)?,
        };
        representable("theta", test.theta())?;
        Ok(test)
    }
}

impl SubspaceTest {
    /// ln of the likelihood ratio. Where the level is unknown, each likelihood is its mean over all levels, ln s uniform:
    /// θ = (ν + 1)/2 ln [(ν + T²)/(ν + (T − γ)²)]; NaN if these squares overflow.
    ///
    /// Implements: NUI-007.
    pub fn theta(&self) -> f64 {
        let SubspaceTest { t, gamma, .. } = *self;
        match self.degrees {
            None => gamma * (t - 0.5 * gamma),
            Some(nu) => {
                let squares = nu + (t - gamma) * (t - gamma);
                if squares == f64::INFINITY {
                    return f64::NAN;
                }
                let more = gamma * (2.0 * t - gamma) / squares;
                // Near −1, a number has lost what counts.
                let ratio = match more < -0.5 {
                    true => libm::log((nu + t * t) / squares),
                    false => libm::log1p(more),
                };
                0.5 * (nu + 1.0) * ratio
            }
        }
    }

    /// The T from which on θ rises with T: where its level of noise is unknown, a T far below 0 tells of noise alone.
    pub fn least_theta_at(&self) -> f64 {
        match self.degrees {
            None => f64::NEG_INFINITY,
            Some(nu) => 0.5 * self.gamma - libm::sqrt(0.25 * self.gamma * self.gamma + nu),
        }
    }

    /// The T from which on θ is at least `eta`: with an unknown level of the noise and η < 0, it is so again far below 0, where θ goes
    /// back to 0.
    ///
    /// # Errors
    /// η not finite.
    ///
    /// Implements: NUI-012.
    pub fn bayes_threshold(&self, eta: f64) -> Result<Threshold, DetectError> {
        check_finite("eta", eta)?;
        let gamma = self.gamma;
        let Some(nu) = self.degrees else {
            return Ok(Threshold::At(eta / gamma + 0.5 * gamma));
        };
        // ν + T² = c (ν + (T − γ)²), at its root nearest to γ/2.
        let less = libm::expm1(2.0 * eta / (nu + 1.0));
        let c = 1.0 + less;
        let root = c * gamma * gamma - nu * less * less;
        Ok(if root >= 0.0 && c.is_finite() {
            Threshold::At((less * nu + c * gamma * gamma) / (c * gamma + libm::sqrt(root)))
        } else if eta > 0.0 {
            Threshold::Never
        } else {
            Threshold::Always
        })
    }

    /// The least T with at most this rate of false alarms.
    ///
    /// # Errors
    /// A rate that is not strictly between 0 and 1.
    ///
    /// Implements: NUI-013.
    pub fn false_alarm_threshold(&self, max_false_alarm: f64) -> Result<f64, DetectError> {
        Ok(self.bias + self.noise_point(max_false_alarm)?)
    }

    /// The largest T with at most this rate of misses.
    ///
    /// # Errors
    /// A rate that is not strictly between 0 and 1.
    ///
    /// Implements: NUI-013.
    pub fn miss_threshold(&self, max_miss: f64) -> Result<f64, DetectError> {
        Ok(self.gamma - self.bias - self.noise_point(max_miss)?)
    }

    /// At most these rates of error with this threshold.
    ///
    /// # Errors
    /// A threshold that is not finite.
    ///
    /// Implements: NUI-014.
    pub fn rates(&self, threshold: Threshold) -> Result<ErrorRates, DetectError> {
        let [false_alarm, miss] = match threshold {
            Threshold::Never => [0.0, 1.0],
            Threshold::Always => [1.0, 0.0],
            Threshold::At(threshold) => {
                check_finite("threshold", threshold)?;
                [
                    self.noise_above(threshold - self.bias)?,
                    self.noise_above(self.gamma - self.bias - threshold)?,
                ]
            }
        };
        Ok(ErrorRates { false_alarm, miss })
    }

    /// Pr(T − hγ ≥ x).
    fn noise_above(&self, x: f64) -> Result<f64, DetectError> {
        match self.degrees {
            None => normal::upper_tail(x),
            Some(degrees) => Ok(noncentral::student(x, degrees, 0.0)?.upper),
        }
    }

    /// The x that T − hγ reaches with probability `p`.
    fn noise_point(&self, p: f64) -> Result<f64, DetectError> {
        check_probability("rate", p)?;
        match self.degrees {
            None => Ok(-normal::quantile(p)?),
            Some(degrees) => Ok(noncentral::student_point(p, degrees)?),
        }
    }
}

#[cfg(test)]
mod tests;
