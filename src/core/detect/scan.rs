//! Where the inclusion is: Θ for every position of a template within a record, paper equation (10).

use super::noise::WhiteNoise;
use super::{DetectError, Force};
use crate::stats::error::{check_length, in_range, representable};
use core::ops::{Range, RangeInclusive};

/// A template of M samples a channel that may begin at any sample of a record of N.
///
/// A *shift* k puts template sample 0 on record sample k. At −(M−1) ≤ k < 0 and N−M < k ≤ N−1 a
/// part of the template falls off the record: what was not observed adds neither to Y nor to b, so
/// Θ(k) is the log-likelihood ratio of what was.
#[derive(Debug, Clone, Copy)]
pub struct Scan<'a> {
    template: Force<&'a [f64]>,
    noise: Force<WhiteNoise>,
    samples: usize,
}

/// The largest Θ of a scan.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanMaximum {
    /// Θ_max.
    pub theta: f64,
    /// γ at the shift of the maximum.
    pub gamma: f64,
    /// The shift of the maximum, the first of several equal ones.
    pub shift: isize,
    /// The vertex of the parabola through the maximum and its two neighbours, in samples: the shift
    /// without the grid. It is the shift itself at the ends of the scan.
    pub refined_shift: f64,
}

impl<'a> Scan<'a> {
    /// A scan of records of `samples` = N a channel for `template` (M ≤ N a channel, N), in noise
    /// of standard deviation `noise_sd` a sample (N).
    ///
    /// # Errors
    /// An empty or non-finite template, one that is longer than the record, or whose channels
    /// differ in length; `noise_sd` not positive and finite.
    ///
    /// Implements: DET-005, DET-050.
    pub fn new(
        samples: usize,
        template: Force<&'a [f64]>,
        noise_sd: Force<f64>,
    ) -> Result<Self, DetectError> {
        let length = template.lateral.len();
        template.check("template_x", "template_y", length)?;
        check_length("template_x", samples.min(length), length)?;
        let noise = WhiteNoise::new(noise_sd)?;
        Ok(Self {
            template,
            noise,
            samples,
        })
    }

    /// The shifts at which at least one sample overlaps, −(M−1) … N−1.
    ///
    /// Implements: DET-050.
    pub fn shifts(&self) -> RangeInclusive<isize> {
        1 - self.template.lateral.len() as isize..=self.samples as isize - 1
    }

    /// The shifts at which the whole template lies in the record, 0 … N−M.
    ///
    /// Implements: DET-050.
    pub fn full_shifts(&self) -> RangeInclusive<isize> {
        0..=(self.samples - self.template.lateral.len()) as isize
    }

    /// Θ(k) for the shifts `first`, `first` + 1, …, as many as `theta` holds.
    ///
    /// # Errors
    /// Lengths other than N; NaN or infinity; overflow; a shift without overlap.
    ///
    /// Implements: DET-005, DET-050, DET-052, ERR-002, ERR-003.
    pub fn theta(
        &self,
        residual: Force<&[f64]>,
        first: isize,
        theta: &mut [f64],
    ) -> Result<(), DetectError> {
        residual.check("residual_x", "residual_y", self.samples)?;
        self.check_shifts(first, theta.len())?;
        for (shift, theta) in (first..).zip(theta) {
            [*theta, _] = self.point(residual, shift)?;
        }
        Ok(())
    }

    /// Θ_max, its shift k̂ and the refined shift over a range of candidates. A position is x̂ = x₀
    /// + k̂·v·dt.
    ///
    /// ```
    /// use palpate_core::force::Force;
    /// use palpate_core::detect::scan::Scan;
    ///
    /// // Samples every 0.1 mm from x₀ = −0.3 mm on; the template's sample 1 is the inclusion's place.
    /// let template = Force { lateral: &[0.0; 3][..], normal: &[0.25, 0.5, 0.25] };
    /// let scan = Scan::new(7, template, Force { lateral: 0.25, normal: 0.25 })?;
    /// let residual = Force { lateral: &[0.0; 7][..], normal: &[0.0, 0.0, 0.25, 0.5, 0.25, 0.0, 0.0] };
    /// let found = scan.maximum(residual, scan.full_shifts())?;
    /// let position = -0.3 + 0.1 * (found.refined_shift + 1.0);
    /// assert_eq!((found.theta, found.gamma, found.shift), (3.0, 6.0_f64.sqrt(), 2));
    /// assert!(position.abs() < 1e-15);
    /// # Ok::<(), palpate_core::detect::DetectError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Scan::theta`]; a range that is empty.
    ///
    /// Implements: DET-053, DET-054.
    pub fn maximum(
        &self,
        residual: Force<&[f64]>,
        shifts: RangeInclusive<isize>,
    ) -> Result<ScanMaximum, DetectError> {
        residual.check("residual_x", "residual_y", self.samples)?;
        let (first, last) = (*shifts.start(), *shifts.end());
        self.check_shifts(first, 1)?;
        self.check_shifts(last, 1)?;
        let mut best = None;
        for shift in shifts {
            let [theta, gamma] = self.point(residual, shift)?;
            if best.is_none_or(|(_, best, _)| theta > best) {
                best = Some((shift, theta, gamma));
            }
        }
        let (shift, theta, gamma) = best.ok_or(DetectError::Empty { what: "shifts" })?;
        let mut refined_shift = shift as f64;
        if shift != first && shift != last {
            let [before, _] = self.point(residual, shift - 1)?;
            let [after, _] = self.point(residual, shift + 1)?;
            let refined = refined_shift + vertex(before, theta, after);
            refined_shift = representable("refined_shift", refined)?;
        }
        Ok(ScanMaximum {
            theta,
            gamma,
            shift,
            refined_shift,
        })
    }

    /// Checks that `count` shifts from `first` on all overlap the record: others say nothing, and
    /// could be without end.
    fn check_shifts(&self, first: isize, count: usize) -> Result<(), DetectError> {
        let shifts = self.shifts();
        let last = first.saturating_add_unsigned(count.saturating_sub(1));
        let wrong = if shifts.contains(&first) { last } else { first };
        let range = "a shift at which the template overlaps the record";
        in_range(shifts.contains(&wrong), "shift", wrong as f64, range)?;
        Ok(())
    }

    /// Θ(k) and γ(k).
    fn point(&self, residual: Force<&[f64]>, shift: isize) -> Result<[f64; 2], DetectError> {
        let (record, template) = overlap(self.samples, self.template.lateral.len(), shift);
        let template = self.template.map(|samples| &samples[template.clone()]);
        let residual = residual.map(|samples| &samples[record.clone()]);
        let pairs = template.zip(residual).zip(self.noise);
        let energy = pairs.map(|((template, _), noise)| noise.dot(template, template));
        let cross = pairs.map(|((template, residual), noise)| noise.dot(residual, template));
        Ok([self.noise.theta(cross, energy)?, self.noise.gamma(energy)?])
    }
}

/// The samples of the record, and of the template, that meet: half-open ranges of the same length,
/// empty ones if none do.
fn overlap(samples: usize, length: usize, shift: isize) -> (Range<usize>, Range<usize>) {
    let start = shift.max(0).unsigned_abs().min(samples);
    let skipped = shift.min(0).unsigned_abs().min(length);
    let count = (length - skipped).min(samples - start);
    (start..start + count, skipped..skipped + count)
}

/// The abscissa, from −½ to ½, of the top of the parabola through (−1, before), (0, top) and (1,
/// after), where `top` is greater than `before`, because it is the first of the largest.
fn vertex(before: f64, top: f64, after: f64) -> f64 {
    let (left, right) = (top - before, top - after);
    0.5 * (left - right) / (left + right)
}

#[cfg(test)]
mod tests;
