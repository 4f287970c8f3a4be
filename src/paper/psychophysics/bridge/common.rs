//! One noise level for all subjects.

use nalgebra::{DMatrix, DVector};

use super::signals::Signal;
use super::{CommonFit, LapseFit, Observations};
use crate::psychophysics::Result;
use crate::psychophysics::choice::{Count, Perceived, best_lapse, deviance, log_likelihood};
use crate::psychophysics::dispersion::Overdispersion;
use crate::psychophysics::rates::{Bounds, CONFIDENCE};
use crate::psychophysics::search::maximum;
use palpate::stats::noncentral::{f_ratio, student_point};

/// Cells of the search for ln(1/σ).
const CELLS: u32 = 24;
/// γ of the strongest signal below which answers are guesses (a share of 0.503), and of the weakest above
/// which they are all right (wrong in 10⁻⁹ of the pairs).
const GAMMAS: [f64; 2] = [0.01, 8.5];
/// A pivot this small, relative to its diagonal, makes a covariance singular.
const SINGULAR: f64 = 1e-12;

/// Signals in N, at least one above 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Signals(pub Vec<f64>);

impl Signals {
    /// What `strength` makes of each signal; `None` if that is 0 for all.
    pub fn new(signals: &[Signal], strength: impl Fn(&Signal) -> f64) -> Option<Signals> {
        let strengths: Vec<f64> = signals.iter().map(strength).collect();
        let is_some = strengths.iter().any(|&strength| strength != 0.0);
        is_some.then_some(Signals(strengths))
    }

    /// What is perceived with noise 1/`sensitivity`, N.
    pub fn perceived(&self, sensitivity: f64) -> Vec<Perceived> {
        let at = |signal: &f64| Perceived::at_gamma(signal * sensitivity);
        self.0.iter().map(at).collect()
    }

    /// The range of ln(1/σ) in which answers say anything.
    pub fn range(&self) -> [f64; 2] {
        let positive = || self.0.iter().copied().filter(|&signal| signal > 0.0);
        let strongest = positive().fold(0.0, f64::max);
        let weakest = positive().fold(strongest, f64::min);
        [
            libm::log(GAMMAS[0] / strongest),
            libm::log(GAMMAS[1] / weakest),
        ]
    }

    /// The most likely ln(1/σ) of `counts`, and its log-likelihood.
    pub fn best(&self, counts: &[Count], lapse: Option<f64>) -> (f64, f64) {
        let value = |log: f64| {
            let perceived = self.perceived(libm::exp(log));
            let lapse = lapse.unwrap_or_else(|| best_lapse(counts, &perceived));
            log_likelihood(counts, &perceived, lapse)
        };
        let [low, high] = self.range();
        maximum(value, low, high, CELLS)
    }

    /// dp/d ln(1/σ) of the probability ½ + ½F of a right answer at each inclusion.
    pub fn slopes(&self, sensitivity: f64) -> Vec<f64> {
        let slope = |signal: &f64| {
            let half = 0.5 * signal * sensitivity;
            // F = erf(γ/2), dF/d ln γ = 2 (γ/2) exp(−γ²/4)/√π.
            half * libm::exp(-half * half) / libm::sqrt(core::f64::consts::PI)
        };
        self.0.iter().map(slope).collect()
    }
}

/// Whether ln(1/σ) is inside its range, not at an end, where no noise level is likelier than all others.
pub fn is_inside([low, high]: [f64; 2], log: f64) -> bool {
    // A cell of the search is far wider than this.
    let margin = 1e-3 * (high - low);
    log > low + margin && log < high - margin
}

/// The noise level that fits the pooled counts best; `None` if there is none.
///
/// Implements: PSY-073, PSY-076.
pub fn common(signals: &Signals, observed: &Observations) -> Result<Option<CommonFit>> {
    let Some((log, fit)) = fit(signals, observed, Some(0.0))? else {
        return Ok(None);
    };
    Ok(Some(CommonFit {
        noise_n: fit.noise_n,
        noise_bounds_n: noise_bounds(signals, observed, log)?,
        predicted: fit.predicted,
        deviance: fit.deviance,
        degrees: fit.degrees,
        p_value_dispersed: fit.p_value_dispersed,
        p_value_clustered: hotelling(signals, observed)?,
        aic: fit.aic,
    }))
}

/// The noise level and share of lapses that fit the pooled counts best; `None` as for [`common`].
///
/// Implements: PSY-073.
pub fn common_with_lapse(signals: &Signals, observed: &Observations) -> Result<Option<LapseFit>> {
    Ok(fit(signals, observed, None)?.map(|(_, fit)| fit))
}

/// The noise level that fits the pooled counts best with this share of lapses, or the best one, and its ln(1/σ).
fn fit(
    signals: &Signals,
    observed: &Observations,
    lapse: Option<f64>,
) -> Result<Option<(f64, LapseFit)>> {
    let (log, value) = signals.best(&observed.pooled, lapse);
    if !is_inside(signals.range(), log) {
        return Ok(None);
    }
    let perceived = signals.perceived(libm::exp(log));
    let parameters = 1 + u32::from(lapse.is_none());
    let lapse = lapse.unwrap_or_else(|| best_lapse(&observed.pooled, &perceived));
    let deviance_of_all = deviance(&observed.pooled, value);
    let degrees = (signals.0.len() as u32).saturating_sub(parameters);
    let p_value = |dispersion: Overdispersion| dispersion.p_value(deviance_of_all, degrees);
    let fit = LapseFit {
        noise_n: libm::exp(-log),
        lapse,
        predicted: perceived.iter().map(|at| at.right(lapse)).collect(),
        deviance: deviance_of_all,
        degrees,
        p_value_dispersed: observed.dispersion.map(p_value).transpose()?.flatten(),
        aic: deviance(observed.subjects.iter().flatten(), value) + 2.0 * f64::from(parameters),
    };
    Ok(Some((log, fit)))
}

/// Whether all subjects have the same share of right answers to an inclusion; the counts are whole numbers, and so are their products.
fn is_shared(observed: &Observations, inclusion: usize) -> bool {
    let mut pairs = observed.subjects.windows(2);
    pairs.all(|pair| {
        let (one, other) = (pair[0][inclusion], pair[1][inclusion]);
        one.right * other.trials() == other.right * one.trials()
    })
}

/// Student's interval of ln σ by the subjects' scores, σ: with U_i the derivative of the log-likelihood of
/// subject i and I the information, the variance is m/(m−1) Σ U_i²/I². `None` where no subject differs from the others.
///
/// Implements: PSY-073.
fn noise_bounds(signals: &Signals, observed: &Observations, log: f64) -> Result<Option<Bounds>> {
    let subjects = observed.subjects.len() as f64;
    if (0..signals.0.len()).all(|inclusion| is_shared(observed, inclusion)) {
        return Ok(None);
    }
    let sensitivity = libm::exp(log);
    let (perceived, slopes) = (signals.perceived(sensitivity), signals.slopes(sensitivity));
    let (mut squares, mut information) = (0.0, 0.0);
    for counts in &observed.subjects {
        let mut score = 0.0;
        for ((count, at), slope) in counts.iter().zip(&perceived).zip(&slopes) {
            let (right, wrong) = (at.right(0.0), at.wrong(0.0));
            if *slope > 0.0 && wrong > 0.0 {
                score += slope * (count.right / right - count.wrong / wrong);
                information += slope * slope * count.trials() / (right * wrong);
            }
        }
        squares += score * score;
    }
    let error = libm::sqrt(subjects / (subjects - 1.0) * squares) / information;
    let reach = libm::exp(student_point(0.5 * (1.0 - CONFIDENCE), subjects - 1.0)? * error);
    let noise = libm::exp(-log);
    let (lower, upper) = (noise / reach, noise * reach);
    Ok((upper.is_finite() && lower > 0.0).then_some(Bounds { lower, upper }))
}

/// The p-value of the smallest T² = m (p̄ − p(σ))ᵀS⁻¹(p̄ − p(σ)) over σ, p̄ and S the mean and covariance of the
/// shares of the m subjects: with q = inclusions − 1 restrictions, (m−q)/(q(m−1)) T² has the F law with q and
/// m − q degrees of freedom. `None` with too few subjects, or if S is singular.
///
/// Implements: PSY-076.
fn hotelling(signals: &Signals, observed: &Observations) -> Result<Option<f64>> {
    let inclusions = signals.0.len();
    let (m, q) = (observed.subjects.len() as f64, inclusions as f64 - 1.0);
    let is_shared = |inclusion| is_shared(observed, inclusion);
    if observed.subjects.len() <= inclusions || (0..inclusions).any(is_shared) {
        return Ok(None);
    }
    let shares = DMatrix::from_fn(observed.subjects.len(), inclusions, |subject, inclusion| {
        let count = observed.subjects[subject][inclusion];
        count.right / count.trials()
    });
    let means = shares.row_mean();
    let rest = DMatrix::from_fn(shares.nrows(), inclusions, |i, j| shares[(i, j)] - means[j]);
    let covariance = rest.transpose() * &rest / (m - 1.0);
    let Some(factor) = covariance.clone().cholesky().map(|factor| factor.l()) else {
        return Ok(None);
    };
    if (0..inclusions).any(|i| factor[(i, i)].powi(2) <= SINGULAR * covariance[(i, i)]) {
        return Ok(None);
    }
    let less_t_squared = |log: f64| {
        let perceived = signals.perceived(libm::exp(log));
        let rest = DVector::from_fn(inclusions, |j, _| means[j] - perceived[j].right(0.0));
        // The diagonal of the factor is above 0.
        let white = factor.solve_lower_triangular(&rest);
        -m * white.map_or(f64::INFINITY, |white| white.norm_squared())
    };
    let [low, high] = signals.range();
    let t_squared = -maximum(less_t_squared, low, high, CELLS).1;
    let ratio = (m - q) / (q * (m - 1.0)) * t_squared;
    Ok(Some(f_ratio(ratio, q, m - q, 0.0)?.upper))
}
