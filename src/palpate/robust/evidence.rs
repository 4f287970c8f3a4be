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

/// The covariance of each class beside the noise, factorised.
pub type Factors = Vec<Cholesky<f64, Dyn>>;

/// What a record says of each class under either hypothesis.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// ln of the weight of each class times the density of the record without inclusion.
    pub without: Vec<f64>,
    /// ln of the density of the record with each signal, averaged over the classes.
    pub with: Vec<f64>,
    /// ln of the weight of each class times the density with any signal, with their prior.
    pub by_class: Vec<f64>,
    /// The highest density in any class and hypothesis, and the least Mahalanobis distance squared of the record there.
    pub best: f64,
    pub distance: f64,
}

impl Evidence {
    fn new(signals: usize) -> Evidence {
        Evidence {
            without: Vec::new(),
            with: vec![f64::NEG_INFINITY; signals],
            by_class: Vec::new(),
            best: f64::NEG_INFINITY,
            distance: f64::INFINITY,
        }
    }

    /// Keeps the distance of the highest density.
    fn weigh(&mut self, density: f64, distance: f64) {
        if density > self.best {
            (self.best, self.distance) = (density, distance);
        }
    }

    /// ln of the density of the record without inclusion, and with any: both averaged over the classes. θ is their difference.
    ///
    /// Implements: ROB-032.
    pub fn totals(&self) -> [f64; 2] {
        [&self.without, &self.by_class]
            .map(|logs| logs.iter().copied().fold(f64::NEG_INFINITY, log_sum))
    }

    /// ln of the density of the record under either hypothesis.
    pub fn total(&self) -> f64 {
        let [none, any] = self.totals();
        log_sum(none, any)
    }
}

/// A factorised covariance, and N records over it.
struct Factor<const N: usize> {
    cholesky: Cholesky<f64, Dyn>,
    white: [DVector<f64>; N],
    log_det: f64,
}

impl<const N: usize> Factor<N> {
    fn new(covariance: DMatrix<f64>, records: [&DVector<f64>; N]) -> Option<Factor<N>> {
        let cholesky = Cholesky::new(covariance)?;
        let white = records.map(|record| whitened(&cholesky, record));
        let diagonal = cholesky.l_dirty().diagonal();
        let log_det = diagonal.iter().map(|root| libm::log(*root)).sum();
        Some(Factor {
            cholesky,
            white,
            log_det,
        })
    }

    /// The evidence of each record for a signal of uncertain amplitude.
    fn with(&self, signal: &Signal) -> [ColouredEvidence; N] {
        let along = whitened(&self.cholesky, &signal.mean);
        self.white.each_ref().map(|white| {
            let energy = [white.norm_squared(), along.norm_squared()];
            let cross = along.dot(white);
            ColouredEvidence::of_white(self.log_det, energy, cross, signal.amplitude_sd)
        })
    }
}

/// L⁻¹ of a vector.
fn whitened(cholesky: &Cholesky<f64, Dyn>, of: &DVector<f64>) -> DVector<f64> {
    let mut white = of.clone();
    cholesky.l_dirty().solve_lower_triangular_mut(&mut white);
    white
}

/// The evidence of each of `records` with the same noise, by classes of the weights and covariances, beside `signals` with a `shape` of
/// uncertainty; all in modes. None if a covariance is not positive definite.
///
/// Implements: ROB-031, ROB-032.
pub fn evidence<const N: usize>(
    records: [&DVector<f64>; N],
    noise: &DVector<f64>,
    classes: &[WeightedClass],
    signals: &[Signal],
    shape: &DMatrix<f64>,
) -> Option<([Evidence; N], Factors)> {
    let whole: f64 = classes.iter().map(|class| class.weight).sum();
    let (sizes, nearest) = sizes(signals);
    let mut all = records.map(|_| Evidence::new(signals.len()));
    let mut alone = Vec::new();
    for class in classes {
        let weight = libm::log(class.weight / whole);
        let covariance = &class.covariance + DMatrix::from_diagonal(noise);
        let none = Factor::new(covariance.clone(), records)?;
        for (found, white) in all.iter_mut().zip(&none.white) {
            let distance = white.norm_squared();
            let density = weight - 0.5 * distance - none.log_det;
            found.without.push(density);
            found.weigh(density, distance);
            found.by_class.push(f64::NEG_INFINITY);
        }
        let factor = |size: &f64| {
            let share = SHAPE * size;
            Factor::new(&covariance + shape * (share * share), records)
        };
        let factors = sizes.iter().map(factor).collect::<Option<Vec<_>>>()?;
        for (at, (signal, of)) in signals.iter().zip(&nearest).enumerate() {
            for (found, with) in all.iter_mut().zip(factors[*of].with(signal)) {
                let density = with.with + weight;
                found.weigh(density, with.distance_with);
                found.with[at] = log_sum(found.with[at], density);
                let any = &mut found.by_class[alone.len()];
                *any = log_sum(*any, density + signal.log_prior);
            }
        }
        alone.push(none.cholesky);
    }
    Some((all, alone))
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
