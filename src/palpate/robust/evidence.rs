//! The evidence of a record for each hypothesis, averaged over the classes of disturbance.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::detect::coloured::ColouredEvidence;

/// The shape is off by this share of the signal's root mean square.
pub const SHAPE: f64 = 0.15;
/// Different sizes of the shape's error, of which the nearest stands for that of a hypothesis.
const SHAPES: usize = 8;

/// A signal in the modes of all sweeps.
#[derive(Debug, Clone)]
pub struct Signal {
    /// The mean.
    pub mean: DVector<f64>,
    /// The root mean square of its normal part about its mean, N.
    pub size: f64,
    /// The standard deviation of its amplitude, over that of its map.
    pub amplitude_sd: f64,
    /// ln of the prior, given an inclusion.
    pub log_prior: f64,
}

/// A class of disturbance in the modes of all sweeps.
#[derive(Debug, Clone)]
pub struct WeightedClass {
    /// Its prior, over that of the others.
    pub weight: f64,
    /// The covariance of what disturbs, N².
    pub covariance: DMatrix<f64>,
}

/// What a record says of each class under either hypothesis.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// The covariance of each class beside the noise, factorised.
    pub factors: Vec<Cholesky<f64, Dyn>>,
    /// ln of the weight of each class times the density of the record without inclusion.
    pub without: Vec<f64>,
    /// ln of the density of the record with each signal, averaged over the classes.
    pub with: Vec<f64>,
    /// ln of the weight of each class times the density with any signal, with their prior.
    pub by_class: Vec<f64>,
    /// The least Mahalanobis distance squared of the record in the class and hypothesis of the highest density.
    pub distance: f64,
}

impl Evidence {
    /// ln of the density of the record without inclusion, and with any: both averaged over the classes. θ is their difference.
    ///
    /// Implements: ROB-032.
    pub fn totals(&self) -> [f64; 2] {
        [&self.without, &self.by_class]
            .map(|logs| logs.iter().copied().fold(f64::NEG_INFINITY, log_sum))
    }
}

/// A factorised covariance, and the record over it.
struct Factor {
    cholesky: Cholesky<f64, Dyn>,
    white: DVector<f64>,
    log_det: f64,
}

impl Factor {
    fn new(covariance: DMatrix<f64>, record: &DVector<f64>) -> Option<Factor> {
        let cholesky = Cholesky::new(covariance)?;
        let mut white = record.clone();
        cholesky.l_dirty().solve_lower_triangular_mut(&mut white);
        let diagonal = cholesky.l_dirty().diagonal();
        let log_det = diagonal.iter().map(|root| libm::log(*root)).sum();
        Some(Factor {
            cholesky,
            white,
            log_det,
        })
    }

    /// The evidence of the record for a signal of uncertain amplitude.
    fn with(&self, signal: &Signal) -> ColouredEvidence {
        let mut along = signal.mean.clone();
        self.cholesky
            .l_dirty()
            .solve_lower_triangular_mut(&mut along);
        let energy = [self.white.norm_squared(), along.norm_squared()];
        let cross = along.dot(&self.white);
        ColouredEvidence::of_white(self.log_det, energy, cross, signal.amplitude_sd)
    }
}

/// The evidence of `record` by classes of the weights and covariances, beside `signals` with a `shape` of uncertainty; all in modes.
/// None if a covariance is not positive definite.
///
/// Implements: ROB-031, ROB-032.
pub fn evidence(
    record: &DVector<f64>,
    noise: &DVector<f64>,
    classes: &[WeightedClass],
    signals: &[Signal],
    shape: &DMatrix<f64>,
) -> Option<Evidence> {
    let whole: f64 = classes.iter().map(|class| class.weight).sum();
    let (sizes, nearest) = sizes(signals);
    let (mut alone, mut without, mut by_class) = (Vec::new(), Vec::new(), Vec::new());
    let mut with = vec![f64::NEG_INFINITY; signals.len()];
    let mut best = (f64::NEG_INFINITY, f64::INFINITY);
    for class in classes {
        let weight = libm::log(class.weight / whole);
        let covariance = &class.covariance + DMatrix::from_diagonal(noise);
        let none = Factor::new(covariance.clone(), record)?;
        let distance = none.white.norm_squared();
        let density = weight - 0.5 * distance - none.log_det;
        without.push(density);
        if density > best.0 {
            best = (density, distance);
        }
        let factor = |size: &f64| {
            let share = SHAPE * size;
            Factor::new(&covariance + shape * (share * share), record)
        };
        let factors = sizes.iter().map(factor).collect::<Option<Vec<_>>>()?;
        let mut any = f64::NEG_INFINITY;
        for ((signal, of), with) in signals.iter().zip(&nearest).zip(&mut with) {
            let found = factors[*of].with(signal);
            let density = found.with + weight;
            if density > best.0 {
                best = (density, found.distance_with);
            }
            *with = log_sum(*with, density);
            any = log_sum(any, density + signal.log_prior);
        }
        by_class.push(any);
        alone.push(none.cholesky);
    }
    Some(Evidence {
        factors: alone,
        without,
        with,
        by_class,
        distance: best.1,
    })
}

/// Sizes that stand for those of all signals, and which one stands for each.
fn sizes(signals: &[Signal]) -> (Vec<f64>, Vec<usize>) {
    let logs = signals
        .iter()
        .map(|signal| libm::log(signal.size.max(1e-9)));
    let (low, high) = logs.clone().fold((f64::MAX, f64::MIN), |(low, high), log| {
        (low.min(log), high.max(log))
    });
    let step = ((high - low) / (SHAPES - 1) as f64).max(1e-3);
    let nearest: Vec<usize> = logs
        .map(|log| libm::round((log - low) / step) as usize)
        .collect();
    let most = nearest.iter().copied().max().unwrap_or(0);
    let sizes = (0..=most).map(|at| libm::exp(low + step * at as f64));
    (sizes.collect(), nearest)
}

/// ln(eᵃ + eᵇ).
pub fn log_sum(a: f64, b: f64) -> f64 {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    if low == f64::NEG_INFINITY {
        high
    } else {
        high + libm::log1p(libm::exp(low - high))
    }
}
