//! The law of Θ_max: bounds on its rates of error, its thresholds, and how well a position can be
//! known.

use super::scan::Scan;
use super::{DetectError, Force, MatchedFilter};
use crate::stats::error::{
    check_finite, check_length, check_positive, check_probability, check_samples,
};
use crate::stats::normal::lower_tail;
use crate::stats::tails::halved;
use core::ops::RangeInclusive;

/// What bounds the false alarms of Θ_max over K shifts in a row: γ at each, and the angle between
/// the templates of neighbours. Computed once for a scan, in memory of the caller's.
///
/// ```
/// use palpate::force::Force;
/// use palpate::detect::position::MaximumLaw;
/// use palpate::detect::scan::Scan;
///
/// let template = Force { lateral: &[0.0; 3][..], normal: &[0.125, 0.25, 0.25] };
/// let scan = Scan::new(6, template, Force { lateral: 0.125, normal: 0.125 })?;
/// let (mut gamma, mut angle) = ([0.0; 4], [0.0; 4]);
/// let law = MaximumLaw::new(&scan, 0, &mut gamma, &mut angle)?;
/// assert_eq!(law.shifts(), 0..=3);
/// let eta = law.threshold(0.05)?;
/// assert!(law.false_alarm_bound(eta)? <= 0.05);
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MaximumLaw<'a> {
    /// The first shift.
    first: isize,
    gamma: &'a [f64],
    /// arccos of the correlation of Θ at a shift with Θ at the shift before; unused for the first.
    angle: &'a [f64],
}

impl<'a> MaximumLaw<'a> {
    /// The law for the shifts `first`, `first` + 1, …, as many as `gamma` and `angle` hold.
    ///
    /// # Errors
    /// No shifts; a shift without overlap; buffers of different lengths; overflow.
    ///
    /// Implements: DET-055.
    pub fn new(
        scan: &Scan<'_>,
        first: isize,
        gamma: &'a mut [f64],
        angle: &'a mut [f64],
    ) -> Result<Self, DetectError> {
        check_samples("gamma", gamma, gamma.len())?;
        check_samples("angle", angle, gamma.len())?;
        scan.check_shifts(first, gamma.len())?;
        let mut before = 0.0;
        for ((shift, gamma), angle) in (first..).zip(gamma.iter_mut()).zip(angle.iter_mut()) {
            *gamma = scan.gamma(shift)?;
            let size = before * *gamma;
            // Rounded down, so that the angle and with it the bound are rounded up; where there is no
            // correlation, or none that can be computed, the worst.
            let correlation = if size > 0.0 {
                scan.covariance(shift - 1, shift)? / size - 32.0 * f64::EPSILON
            } else {
                -1.0
            };
            *angle = libm::acos(correlation.clamp(-1.0, 1.0));
            before = *gamma;
        }
        Ok(Self {
            first,
            gamma,
            angle,
        })
    }

    /// The shifts that the law is for.
    pub fn shifts(&self) -> RangeInclusive<isize> {
        self.first..=self.first + (self.gamma.len() as isize - 1)
    }

    /// An upper bound on Pr(Θ_max ≥ η | H = 0): at the first shift or by an upcrossing between two
    /// neighbours, whose probability is bounded in the manner of Rice. `spec/detector.md` derives
    /// it.
    ///
    /// # Errors
    /// η not finite.
    ///
    /// Implements: DET-056, DET-057, ERR-006.
    pub fn false_alarm_bound(&self, eta: f64) -> Result<f64, DetectError> {
        check_finite("eta", eta)?;
        let mut bound = 0.0;
        let mut tail_before = 0.0;
        for (&gamma, &angle) in self.gamma.iter().zip(self.angle) {
            let (tail, peak) = exceedance(gamma, eta);
            // At the first shift nothing has been above η before: the whole tail counts.
            let upcrossing = angle / core::f64::consts::TAU * peak + (tail - tail_before).max(0.0);
            bound += upcrossing.min(tail);
            tail_before = tail;
        }
        // The rounding errors of K sums and of the tails, far below a part in 10⁹.
        Ok((bound * (1.0 + 1e-9)).min(1.0))
    }

    /// A threshold η for Θ_max at which the false-alarm rate is certainly at most
    /// `max_false_alarm`: where the bound is, to about 10 digits of η.
    ///
    /// # Errors
    /// A rate not strictly between 0 and 1; a scan without signal.
    ///
    /// Implements: DET-058.
    pub fn threshold(&self, max_false_alarm: f64) -> Result<f64, DetectError> {
        check_probability("max_false_alarm", max_false_alarm)?;
        let gamma = self.gamma.iter().copied().fold(0.0, f64::max);
        if gamma == 0.0 {
            return Err(DetectError::NoSignal);
        }
        // η/γ = 40 is beyond every tail; below −γ²/2 − 40γ the largest term alone is certain.
        let (low, high) = (-0.5 * gamma * gamma - 40.0 * gamma, 40.0 * gamma);
        check_finite("gamma squared", low)?;
        let is_above = |eta| Ok(self.false_alarm_bound(eta)? > max_false_alarm);
        Ok(halved(100, [low, high], is_above)?[1])
    }
}

/// Pr(Θ ≥ η | H = 0) for one γ, and exp(−u²/2) at the standardised threshold u = η/γ + γ/2.
fn exceedance(gamma: f64, eta: f64) -> (f64, f64) {
    if gamma == 0.0 {
        return if eta > 0.0 { (0.0, 0.0) } else { (1.0, 1.0) };
    }
    let u = eta / gamma + 0.5 * gamma;
    (lower_tail(-u), libm::exp(-0.5 * u * u))
}

/// The Cramér–Rao bound: no unbiased estimate of the position has a smaller standard deviation, in
/// m, than (Σ_c Σ_i (∂Δ/∂x)²/s²)^-½. `slope` is ∂Δ/∂x at each sample, N/m.
///
/// # Errors
/// As [`MatchedFilter::new`]; a template without slope, which says nothing of a position.
///
/// Implements: DET-060.
pub fn position_bound(slope: Force<&[f64]>, noise_sd: Force<f64>) -> Result<f64, DetectError> {
    let information = MatchedFilter::new(slope, noise_sd)?.gamma();
    if information == 0.0 {
        return Err(DetectError::NoSignal);
    }
    Ok(1.0 / information)
}

/// ∂Δ/∂x of a template sampled every `spacing` metres, by central differences, and by one-sided
/// ones at the ends: in error by spacing²/6 of the third derivative.
///
/// # Errors
/// Fewer than two samples, or lengths that differ; NaN or infinity; a spacing not positive and
/// finite.
///
/// Implements: DET-061.
pub fn slope(template: &[f64], spacing: f64, slope: &mut [f64]) -> Result<(), DetectError> {
    check_samples("template", template, slope.len())?;
    check_positive("spacing", spacing)?;
    check_length("template", template.len().max(2), template.len())?;
    let last = template.len() - 1;
    for (i, slope) in slope.iter_mut().enumerate() {
        let (left, right) = (i.saturating_sub(1), (i + 1).min(last));
        let rise = template[right] - template[left];
        *slope = check_finite("slope", rise / ((right - left) as f64 * spacing))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
