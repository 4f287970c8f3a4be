//! Whether a record holds an inclusion: the matched filter, Θ in white and coloured noise and beside nuisances, and the scan.
//!
//! Implements: CLB-003, CLB-010.

pub use palpate_core::detect::Statistic;
pub use palpate_core::detect::coloured::{ColouredEvidence, ColouredStatistic};
use palpate_core::detect::coloured::{coloured_scratch, evidence_coloured, theta_coloured};
use palpate_core::detect::nuisance::{NoiseLevel, Nuisances, SubspaceDetector};
use palpate_core::detect::scan::Scan;
pub use palpate_core::detect::scan::ScanMaximum;
use palpate_core::detect::{MatchedFilter, theta_of_record};
use palpate_core::force::Force;

use crate::memory::{bytes, check_apart, give, list, list_mut, read};
use crate::{Error, ErrorRates};

/// Samples of the force along a trajectory, N: as many lateral as normal ones.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Series {
    /// The lateral force, N.
    pub lateral: *const f64,
    /// The normal force, N.
    pub normal: *const f64,
    /// The number of samples in each.
    pub samples: usize,
}

impl Series {
    unsafe fn force<'a>(self) -> Result<Force<&'a [f64]>, Error> {
        let Series {
            lateral,
            normal,
            samples,
        } = self;
        // SAFETY: as the crate says.
        let component = |start| unsafe { list(start, samples) };
        Ok(Force::new(component(lateral)?, component(normal)?))
    }
}

/// A lateral and a normal number, such as the standard deviation of the noise of one sample, N.
pub type Components = Force<f64>;

/// What a template and its noise give, before any record.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Filter {
    /// b of each channel.
    pub b: Components,
    /// σ of each channel's output.
    pub sigma: Components,
    /// γ, the signal-to-noise ratio of both channels.
    pub gamma: f64,
}

/// b, σ and γ of a template F_1 − F_0 in white noise.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_matched_filter(
    template: *const Series,
    noise_sd: *const Components,
    filter: *mut Filter,
) -> Error {
    let found = || {
        let (template, noise) = unsafe { (read(template)?.force()?, read(noise_sd)?) };
        let found = MatchedFilter::new(template, noise)?;
        Ok(Filter {
            b: found.b(),
            sigma: found.sigma(),
            gamma: found.gamma(),
        })
    };
    unsafe { give(filter, found) }
}

/// θ, y(0) and γ of a record, from the forces without (`f0`) and with (`f1`) the inclusion, in white noise.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_theta(
    observed: *const Series,
    f0: *const Series,
    f1: *const Series,
    noise_sd: *const Components,
    statistic: *mut Statistic,
) -> Error {
    let found = || {
        let [observed, f0, f1] = [observed, f0, f1].map(|series| unsafe { read(series)?.force() });
        let noise = unsafe { read(noise_sd) }?;
        Ok(theta_of_record(observed?, f0?, f1?, noise)?)
    };
    unsafe { give(statistic, found) }
}

/// The length of the scratch that `palpate_theta_coloured` and `palpate_evidence_coloured` need: n² + 2n.
#[unsafe(no_mangle)]
pub extern "C" fn palpate_coloured_scratch(n: usize) -> usize {
    coloured_scratch(n)
}

/// θ and γ in noise of any covariance over both channels. `residual` and `template` have n numbers, the lateral samples and then
/// the normal ones; `covariance` has n rows of n (N²). `scratch` has n² + 2n, overlaps nothing, and is overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_theta_coloured(
    residual: *const f64,
    template: *const f64,
    covariance: *const f64,
    n: usize,
    scratch: *mut f64,
    scratch_length: usize,
    found: *mut ColouredStatistic,
) -> Error {
    let statistic = || {
        let scratch = (scratch, scratch_length);
        let [residual, template, covariance] =
            unsafe { coloured(residual, template, covariance, n, scratch) }?;
        let scratch = unsafe { list_mut(scratch.0, scratch.1) }?;
        Ok(theta_coloured(residual, template, covariance, scratch)?)
    };
    unsafe { give(found, statistic) }
}

/// ln of the densities of a record without, and with a signal whose amplitude has a standard deviation of `amplitude_sd` about 1. The
/// others are those of `palpate_theta_coloured`; `covariance` holds a class of disturbance, the noise and the signal's uncertain shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_evidence_coloured(
    residual: *const f64,
    template: *const f64,
    covariance: *const f64,
    n: usize,
    amplitude_sd: f64,
    scratch: *mut f64,
    scratch_length: usize,
    found: *mut ColouredEvidence,
) -> Error {
    let evidence = || {
        let scratch = (scratch, scratch_length);
        let [residual, template, covariance] =
            unsafe { coloured(residual, template, covariance, n, scratch) }?;
        let scratch = unsafe { list_mut(scratch.0, scratch.1) }?;
        let sd = amplitude_sd;
        Ok(evidence_coloured(
            residual, template, covariance, sd, scratch,
        )?)
    };
    unsafe { give(found, evidence) }
}

/// A residual and a template of n numbers and their covariance, none of which overlaps the scratch.
unsafe fn coloured<'a>(
    residual: *const f64,
    template: *const f64,
    covariance: *const f64,
    n: usize,
    (scratch, length): (*mut f64, usize),
) -> Result<[&'a [f64]; 3], Error> {
    let square = n.checked_mul(n).ok_or(Error::Length)?;
    check_apart(
        &[bytes(scratch, length)],
        &[
            bytes(residual, n),
            bytes(template, n),
            bytes(covariance, square),
        ],
    )?;
    Ok(unsafe {
        [
            list(residual, n)?,
            list(template, n)?,
            list(covariance, square)?,
        ]
    })
}

/// What a whitened record says beside nuisances.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct NuisanceStatistic {
    /// T, over the estimate of the noise where its level is unknown.
    pub t: f64,
    /// γ in the same unit.
    pub gamma: f64,
    /// γ if every nuisance were known.
    pub gamma_nominal: f64,
    /// Σ of the squares that neither the nuisances nor the template explain.
    pub residual: f64,
    /// θ, the log-likelihood ratio.
    pub theta: f64,
    /// At most these rates of error at the threshold for `eta`.
    pub rates: ErrorRates,
    /// The number of independent nuisances.
    pub rank: usize,
    /// Degrees of freedom of `residual`.
    pub degrees: usize,
}

/// T, γ, θ and rates of error of a whitened record of `samples` numbers beside `count` nuisances, one after the other.
///
/// Each sample is over the standard deviation of its noise. `residual`, `template` and `nuisances` are overwritten and must not
/// overlap. `known_level` is 0 if the record itself tells the level of the noise. `bias` is what a nuisance within bounds may add
/// to T, 0 for none; `eta` the threshold on θ.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_theta_nuisances(
    residual: *mut f64,
    template: *mut f64,
    samples: usize,
    nuisances: *mut f64,
    count: usize,
    known_level: u8,
    bias: f64,
    eta: f64,
    found: *mut NuisanceStatistic,
) -> Error {
    let statistic = || {
        let numbers = samples.checked_mul(count).ok_or(Error::Length)?;
        let written = [
            bytes(residual, samples),
            bytes(template, samples),
            bytes(nuisances, numbers),
        ];
        check_apart(&written, &[])?;
        let (residual, template) =
            unsafe { (list_mut(residual, samples)?, list_mut(template, samples)?) };
        let nuisances = Nuisances::new(unsafe { list_mut(nuisances, numbers) }?, samples)?;
        let detector = SubspaceDetector::new(nuisances, template)?;
        let found = detector.statistic(residual)?;
        let level = if known_level == 0 {
            NoiseLevel::Unknown
        } else {
            NoiseLevel::Known
        };
        let test = found.test(level, bias)?;
        Ok(NuisanceStatistic {
            t: test.t,
            gamma: test.gamma,
            gamma_nominal: detector.gamma_nominal(),
            residual: found.residual,
            theta: test.theta(),
            rates: test.rates(test.bayes_threshold(eta)?)?,
            rank: nuisances.rank().get(),
            degrees: found.degrees as usize,
        })
    };
    unsafe { give(found, statistic) }
}

/// Θ at every shift k = 0 … N − M at which the whole template of M samples lies in the record of N, into `theta`, and the
/// largest. `theta` has `count` = N − M + 1 numbers and overlaps nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_scan(
    residual: *const Series,
    template: *const Series,
    noise_sd: *const Components,
    theta: *mut f64,
    count: usize,
    maximum: *mut ScanMaximum,
) -> Error {
    let found = || {
        let (record, pattern) = unsafe { (read(residual)?, read(template)?) };
        let read_too = [record, pattern].map(|series| {
            [series.lateral, series.normal].map(|start| bytes(start, series.samples))
        });
        check_apart(&[bytes(theta, count)], read_too.as_flattened())?;
        let (residual, template) = unsafe { (record.force()?, pattern.force()?) };
        let noise = unsafe { read(noise_sd) }?;
        let scan = Scan::new(record.samples, template, noise)?;
        if count != scan.full_shifts().count() {
            return Err(Error::Length);
        }
        let thetas = unsafe { list_mut(theta, count) }?;
        // What overflows at any shift is refused here, before Θ is written.
        let maximum = scan.maximum(residual, scan.full_shifts())?;
        scan.theta(residual, 0, thetas)?;
        Ok(maximum)
    };
    unsafe { give(maximum, found) }
}
