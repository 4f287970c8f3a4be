//! Nonlinear least squares, and what they leave open.

use nalgebra::{DMatrix, DVector};

use crate::refusal::Refusal;
use crate::stats::noncentral::student_point;

/// Steps of the method of Levenberg and Marquardt, and the share of the sum of squares below which one is the last.
const MOST_STEPS: usize = 300;
const SMALLEST_GAIN: f64 = 1e-8;
/// No step is smaller than with this damping.
const LARGEST_DAMPING: f64 = 1e12;
/// A fit that did not end counts if its parameters are nearer to the best ones than this, the square of a share of their deviation.
const FARTHEST: f64 = 0.01;
/// Derivatives are differences over this.
const DIFFERENCE: f64 = 1e-5;

/// An estimate and the ends of its interval.
///
/// Implements: CAL-030.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub estimate: f64,
    /// The ends of the interval that holds the quantity with 95 %.
    pub ends: [f64; 2],
}

impl Interval {
    /// The interval after a change of scale that keeps the order.
    pub fn map(self, scale: impl Fn(f64) -> f64) -> Interval {
        Interval {
            estimate: scale(self.estimate),
            ends: self.ends.map(scale),
        }
    }

    /// Estimate and standard deviation as an interval with these degrees of freedom.
    pub(super) fn of(estimate: f64, sd: f64, degrees: f64) -> Result<Interval, Refusal> {
        let half = sd * student_point(0.025, degrees)?;
        let ends = [estimate - half, estimate + half];
        Ok(Interval { estimate, ends })
    }
}

/// A model at the parameters that fit best.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub parameters: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// What the curvature of the model adds to them in the mean over the noise.
    bias: DVector<f64>,
    /// What the model expects.
    pub expected: Vec<f64>,
    /// Data less model.
    pub residuals: Vec<f64>,
    /// Degrees of freedom of the residuals, as many as if they were independent.
    pub degrees: f64,
    /// The sum of the squares of the residuals.
    pub squares: f64,
}

type Model<'a> = dyn Fn(&[f64]) -> Vec<f64> + 'a;

fn residuals(model: &Model<'_>, data: &[f64], at: &[f64]) -> DVector<f64> {
    let pairs = data.iter().zip(model(at));
    DVector::from_iterator(data.len(), pairs.map(|(data, model)| data - model))
}

/// Derivatives of the model, a column for each parameter.
fn jacobian(model: &Model<'_>, at: &[f64], samples: usize) -> DMatrix<f64> {
    let mut derivatives = DMatrix::zeros(samples, at.len());
    for parameter in 0..at.len() {
        let moved = |by: f64| {
            let mut at = at.to_vec();
            at[parameter] += by;
            model(&at)
        };
        let [up, down] = [moved(DIFFERENCE), moved(-DIFFERENCE)];
        for (sample, (up, down)) in up.iter().zip(down).enumerate() {
            derivatives[(sample, parameter)] = (up - down) / (2.0 * DIFFERENCE);
        }
    }
    derivatives
}

/// The parameters of least squares, by the method of Levenberg and Marquardt from `start`, what they leave of the `data`, and whether the
/// method ended; none where no parameters fit better than others.
///
/// Implements: CAL-010.
fn least_squares(
    model: &Model<'_>,
    data: &[f64],
    start: &[f64],
) -> Option<(Vec<f64>, DVector<f64>, bool)> {
    let mut at = start.to_vec();
    let mut left = residuals(model, data, &at);
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        let derivatives = jacobian(model, &at, data.len());
        let (mut normal, gradient) = (derivatives.tr_mul(&derivatives), derivatives.tr_mul(&left));
        for parameter in 0..at.len() {
            normal[(parameter, parameter)] *= 1.0 + damping;
        }
        let step = normal.cholesky()?.solve(&gradient);
        let pairs = at.iter().zip(step.iter());
        let next: Vec<f64> = pairs.map(|(at, step)| at + step).collect();
        let found = residuals(model, data, &next);
        let (before, after) = (left.norm_squared(), found.norm_squared());
        if after < before {
            (at, left, damping) = (next, found, 0.1 * damping);
            if before - after < SMALLEST_GAIN * before {
                return Some((at, left, true));
            }
        } else {
            // Not a number is no step either.
            damping *= 10.0;
            if damping > LARGEST_DAMPING {
                return Some((at, left, true));
            }
        }
    }
    Some((at, left, false))
}

/// The least sum of squares that a model leaves, from the parameters `start`; infinite where the method finds none.
pub(super) fn least(model: &Model<'_>, data: &[f64], start: &[f64]) -> f64 {
    let found = least_squares(model, data, start);
    found.map_or(f64::INFINITY, |(_, left, _)| left.norm_squared())
}

/// Fits `model` to `data` by least squares, from the parameters `start`, each of the order of 1; none where no parameters fit better than
/// others.
///
/// Implements: CAL-030, CAL-031.
pub(super) fn fit(model: &Model<'_>, data: &[f64], start: &[f64]) -> Option<Fit> {
    let (at, left, is_ended) = least_squares(model, data, start)?;
    let squares = left.norm_squared();
    let derivatives = jacobian(model, &at, data.len());
    let normal = derivatives.tr_mul(&derivatives).cholesky()?;
    let inverse = normal.inverse();
    let degrees = data.len() as f64 - at.len() as f64;
    let gradient = derivatives.tr_mul(&left);
    let away = gradient.dot(&(&inverse * &gradient)) * degrees / squares;
    let is_near = away < FARTHEST;
    (is_ended || is_near).then_some(())?;
    let residuals: Vec<f64> = left.iter().copied().collect();
    let correlated = correlated(&residuals);
    let (variance, expected) = (correlated * squares / degrees, model(&at));
    let unit = DMatrix::identity(at.len(), at.len());
    let directions = normal.l().tr_solve_lower_triangular(&unit)? * libm::sqrt(variance);
    let curved = curvature(model, &at, &expected, &directions);
    let bias = -&inverse * derivatives.tr_mul(&curved);
    let covariance = inverse * variance;
    let mut numbers = covariance.iter().chain(&bias);
    numbers.all(|value| value.is_finite()).then(|| Fit {
        expected,
        bias,
        parameters: at,
        covariance,
        residuals,
        degrees: f64::max(degrees / correlated, 1.0),
        squares,
    })
}

/// How far the model is in the mean from the model at the mean of parameters that are spread along independent `directions` of one standard
/// deviation each: half its second differences.
///
/// Implements: CAL-036.
fn curvature(
    model: &Model<'_>,
    at: &[f64],
    expected: &[f64],
    directions: &DMatrix<f64>,
) -> DVector<f64> {
    let mut curved = DVector::zeros(expected.len());
    for direction in directions.column_iter() {
        for sign in [1.0, -1.0] {
            let pairs = at.iter().zip(&direction);
            let moved: Vec<f64> = pairs.map(|(at, by)| at + sign * by).collect();
            for ((curved, moved), here) in curved.iter_mut().zip(model(&moved)).zip(expected) {
                *curved += 0.5 * (moved - here);
            }
        }
    }
    curved
}

/// How many samples say as much as one independent one: 1 + 2 Σ ρ over the lags before the first at which residuals are not correlated.
///
/// Implements: CAL-031.
fn correlated(residuals: &[f64]) -> f64 {
    let product = |lag: usize| -> f64 {
        let pairs = residuals.iter().zip(&residuals[lag..]);
        pairs.map(|(a, b)| a * b).sum()
    };
    let all = product(0).max(f64::MIN_POSITIVE);
    // Of independent residuals ρ is above this at one lag in 40.
    let limit = 1.96 / libm::sqrt(residuals.len() as f64);
    let lags = (1..residuals.len() / 4).map(|lag| product(lag) / all);
    1.0 + 2.0 * lags.take_while(|rho| *rho > limit).sum::<f64>()
}

impl Fit {
    /// A quantity that follows from the parameters, less its bias, with its interval.
    ///
    /// Implements: CAL-036.
    pub fn interval(&self, of: impl Fn(&[f64]) -> f64) -> Result<Interval, Refusal> {
        let gradient = jacobian(&|at| vec![of(at)], &self.parameters, 1);
        let variance = (&gradient * &self.covariance * gradient.transpose())[(0, 0)];
        let estimate = of(&self.parameters) - (&gradient * &self.bias)[(0, 0)];
        Interval::of(estimate, libm::sqrt(variance.max(0.0)), self.degrees)
    }

    /// How far a sum of squares is from the least one, over how far it is where the interval of one parameter ends: the root of the ratio.
    ///
    /// # Errors
    /// As [`Interval::of`].
    pub fn over_end(&self, squares: f64) -> Result<f64, Refusal> {
        let point = student_point(0.025, self.degrees)?;
        let more = (squares / self.squares - 1.0).max(0.0);
        Ok(libm::sqrt(more * self.degrees) / point)
    }

    /// The correlation of two parameters.
    pub fn correlation(&self, one: usize, other: usize) -> f64 {
        let of = |a, b| self.covariance[(a, b)];
        of(one, other) / libm::sqrt(of(one, one) * of(other, other))
    }

    /// The information criterion of Schwarz: the lower, the better.
    ///
    /// Implements: CAL-022.
    pub fn criterion(&self) -> f64 {
        criterion(self.squares, self.residuals.len(), self.parameters.len())
    }
}

/// That of a sum of squares, so many samples and so many parameters.
pub(super) fn criterion(squares: f64, samples: usize, parameters: usize) -> f64 {
    let (samples, parameters) = (samples as f64, parameters as f64);
    samples * libm::log(squares / samples) + parameters * libm::log(samples)
}
