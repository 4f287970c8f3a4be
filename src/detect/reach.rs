//! How far detection reaches: the largest depth, the smallest inclusion and the least indentation
//! for a wanted γ, from a table of γ that the caller has computed (paper §5).

use super::DetectError;
use super::error::{check_not_negative, check_samples};

/// Where a monotone γ reaches the wanted value.
///
/// ```
/// use palpate::detect::reach::{Reach, largest_detectable_depth};
///
/// let (depth, gamma) = ([0.0026, 0.0046], [8.0, 6.0]);
/// assert_eq!(largest_detectable_depth(&depth, &gamma, 9.0)?, Reach::Nowhere);
/// assert_eq!(largest_detectable_depth(&depth, &gamma, 5.0)?, Reach::Everywhere);
/// assert_eq!(largest_detectable_depth(&depth, &gamma, 8.0)?, Reach::Limit(0.0026));
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// At no value of the table.
    Nowhere,
    /// At every value of the table: the limit lies outside.
    Everywhere,
    /// Up to (or from) this value of the parameter, m, by linear interpolation of γ.
    Limit(f64),
}

/// The largest depth at which γ is at least `required`; γ falls as depth grows.
///
/// ```
/// use palpate::detect::reach::{Reach, largest_detectable_depth};
///
/// // Half-way between the last two depths γ is 3.
/// let (depth, gamma) = ([0.0026, 0.0046, 0.0066, 0.0086], [9.0, 7.0, 4.0, 2.0]);
/// let reach = largest_detectable_depth(&depth, &gamma, 3.0)?;
/// assert!(matches!(reach, Reach::Limit(depth) if (depth - 0.0076).abs() < 1e-15));
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
///
/// # Errors
/// Fewer than two entries, or unequal lengths; NaN or infinity; depths that do not increase or γ
/// that does not decrease; `required` negative or not finite.
///
/// Implements: DET-090, DET-092.
pub fn largest_detectable_depth(
    depth: &[f64],
    gamma: &[f64],
    required: f64,
) -> Result<Reach, DetectError> {
    check_table(depth, gamma, required)?;
    check_order("gamma", gamma.windows(2).map(|pair| pair[0] > pair[1]))?;
    let entries = gamma.len();
    Ok(reach(
        entries,
        |i| depth[entries - 1 - i],
        |i| gamma[entries - 1 - i],
        required,
    ))
}

/// The smallest size at which γ is at least `required`; γ grows with the size of the inclusion.
///
/// ```
/// use palpate::detect::reach::{Reach, smallest_detectable_inclusion};
///
/// let (diameter, gamma) = ([0.002, 0.004, 0.006], [1.0, 3.0, 5.0]);
/// assert_eq!(smallest_detectable_inclusion(&diameter, &gamma, 3.0)?, Reach::Limit(0.004));
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
///
/// # Errors
/// As [`largest_detectable_depth`], with γ that does not increase.
///
/// Implements: DET-091, DET-092.
pub fn smallest_detectable_inclusion(
    size: &[f64],
    gamma: &[f64],
    required: f64,
) -> Result<Reach, DetectError> {
    increasing(size, gamma, required)
}

/// The least indentation at which γ is at least `required`; γ grows with the indentation.
///
/// ```
/// use palpate::detect::reach::{Reach, indentation_needed};
///
/// let (indentation, gamma) = ([0.001, 0.002, 0.004], [0.5, 1.0, 4.0]);
/// assert_eq!(indentation_needed(&indentation, &gamma, 1.0)?, Reach::Limit(0.002));
/// assert_eq!(indentation_needed(&indentation, &gamma, 4.5)?, Reach::Nowhere);
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
///
/// # Errors
/// As [`smallest_detectable_inclusion`].
///
/// Implements: DET-091, DET-092.
pub fn indentation_needed(
    indentation: &[f64],
    gamma: &[f64],
    required: f64,
) -> Result<Reach, DetectError> {
    increasing(indentation, gamma, required)
}

fn increasing(parameter: &[f64], gamma: &[f64], required: f64) -> Result<Reach, DetectError> {
    check_table(parameter, gamma, required)?;
    check_order("gamma", gamma.windows(2).map(|pair| pair[0] < pair[1]))?;
    Ok(reach(gamma.len(), |i| parameter[i], |i| gamma[i], required))
}

fn check_table(parameter: &[f64], gamma: &[f64], required: f64) -> Result<(), DetectError> {
    check_samples("parameter", parameter, parameter.len())?;
    check_samples("gamma", gamma, parameter.len())?;
    check_not_negative("required", required)?;
    if gamma.len() < 2 {
        return Err(DetectError::LengthMismatch {
            what: "gamma",
            expected: 2,
            found: 1,
        });
    }
    check_order(
        "parameter",
        parameter.windows(2).map(|pair| pair[0] < pair[1]),
    )
}

fn check_order(
    what: &'static str,
    mut in_order: impl Iterator<Item = bool>,
) -> Result<(), DetectError> {
    match in_order.position(|in_order| !in_order) {
        Some(index) => Err(DetectError::NotMonotone {
            what,
            index: index + 1,
        }),
        None => Ok(()),
    }
}

/// The parameter where γ, increasing in i, crosses `required`.
fn reach(
    entries: usize,
    parameter: impl Fn(usize) -> f64,
    gamma: impl Fn(usize) -> f64,
    required: f64,
) -> Reach {
    if gamma(0) > required {
        return Reach::Everywhere;
    }
    match (0..entries).find(|&i| gamma(i) >= required) {
        None => Reach::Nowhere,
        Some(0) => Reach::Limit(parameter(0)),
        Some(i) => {
            let share = (required - gamma(i - 1)) / (gamma(i) - gamma(i - 1));
            // As a weighted mean, which overflows nowhere and hits the table's entries.
            Reach::Limit((1.0 - share) * parameter(i - 1) + share * parameter(i))
        }
    }
}

#[cfg(test)]
mod tests;
