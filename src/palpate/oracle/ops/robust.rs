//! The evidence of the robust detector.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::{Refused, Rows, answer};
use crate::detect::coloured::check_symmetric;
use crate::detect::mixture::mixture_theta;
use crate::robust::AMPLITUDE;
use crate::robust::evidence::{Signal, WeightedClass, evidence};
use crate::stats::error::{check_positive, check_samples, in_range};

/// Most modes, classes and signals: each class is factorised up to nine times, and each signal compared with each class.
const MOST: [(&str, usize); 3] = [("record", 200), ("weights", 100), ("sizes", 1000)];

/// ln of the densities of a record in modes without inclusion and with each signal, by classes of disturbance.
///
/// Implements: ORA-011, ORA-020, ROB-031, ROB-032.
pub fn evidence_of(
    [record, noise]: [Vec<f64>; 2],
    (weights, covariances): (&[f64], &Rows),
    (means, sizes, prior): (&Rows, &[f64], &[f64]),
    shape: &Rows,
) -> Result<impl Serialize + use<>, Refused> {
    let modes = record.len();
    for ((name, most), found) in MOST.into_iter().zip([modes, weights.len(), sizes.len()]) {
        if found > most {
            let wrong = format_args!("{name} has {found} entries, but may have at most {most}");
            return Err(Refused::range(wrong));
        }
    }
    check_samples("record", &record, modes)?;
    check_samples("noise", &noise, modes)?;
    check_samples("weights", weights, weights.len())?;
    for (name, values) in [("noise", &noise[..]), ("weights", weights)] {
        for value in values {
            check_positive(name, *value)?;
        }
    }
    let shape = symmetric("shape", &shape.concat("shape", modes, modes)?, modes)?;
    let classes = classes(weights, covariances, modes)?;
    let signals = signals(means, sizes, prior, modes)?;
    let [record, noise] = [record, noise].map(DVector::from_vec);
    let found = evidence([&record], &noise, &classes, &signals, &shape);
    let ([found], _) = found.ok_or_else(|| {
        let wrong = "covariances has a class that is not positive definite beside noise and shape";
        Refused::range(wrong)
    })?;
    let [none, any] = found.totals();
    Ok(answer! {
        without: found.without,
        by_class: found.by_class,
        with: found.with,
        theta: any - none,
        distance: found.distance,
    })
}

/// The classes of their weights, and of their covariances, one below the other.
fn classes(
    weights: &[f64],
    covariances: &Rows,
    modes: usize,
) -> Result<Vec<WeightedClass>, Refused> {
    let rows = covariances.concat("covariances", weights.len() * modes, modes)?;
    let class = |(number, (rows, weight)): (usize, (&[f64], &f64))| {
        let covariance = symmetric(&format!("covariances of class {number}"), rows, modes)?;
        let weight = *weight;
        Ok(WeightedClass { weight, covariance })
    };
    let pairs = rows.chunks_exact(modes * modes).zip(weights);
    pairs.enumerate().map(class).collect()
}

/// The signals of their means, one a row.
fn signals(
    means: &Rows,
    sizes: &[f64],
    prior: &[f64],
    modes: usize,
) -> Result<Vec<Signal>, Refused> {
    check_samples("sizes", sizes, sizes.len())?;
    for size in sizes {
        in_range(*size >= 1e-9, "sizes", *size, "at least 1e-9")?;
    }
    // Whether it is a prior of so many.
    mixture_theta(&vec![0.0; sizes.len()], prior)?;
    let means = means.concat("signals", sizes.len(), modes)?;
    let signals = means.chunks_exact(modes).zip(sizes).zip(prior);
    let signals = signals.map(|((mean, size), prior)| Signal {
        mean: DVector::from_column_slice(mean),
        size: *size,
        amplitude_sd: AMPLITUDE,
        log_prior: libm::log(*prior),
    });
    Ok(signals.collect())
}

/// A symmetric matrix of its rows.
fn symmetric(name: &str, rows: &[f64], order: usize) -> Result<DMatrix<f64>, Refused> {
    check_symmetric(rows, order)
        .map_err(|error| Refused::range(format_args!("{name}: {error}")))?;
    Ok(DMatrix::from_row_slice(order, order, rows))
}
