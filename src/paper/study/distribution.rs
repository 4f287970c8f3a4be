//! What is known of an input.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use palpate::refusal::Refusal;
use palpate::stats::normal;

/// The distribution of an input, in the unit of its key.
///
/// ```
/// use palpate_paper::study::Distribution;
///
/// let ratio = Distribution::Uniform { from: 0.48, to: 0.4995 };
/// assert_eq!(ratio.quantile(0.5), 0.5 * (0.48 + 0.4995));
/// let modulus = Distribution::Lognormal { median: 5.0, geometric_sd: 1.1 };
/// assert_eq!(modulus.quantile(0.5), 5.0);
/// ```
///
/// Implements: STU-010.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Distribution {
    /// Any value of a range is as likely as any other.
    Uniform {
        /// The least value.
        from: f64,
        /// The largest value.
        to: f64,
    },
    /// The normal distribution.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation, above 0.
        sd: f64,
    },
    /// The logarithm is normal.
    Lognormal {
        /// The median, above 0.
        median: f64,
        /// The factor of one standard deviation, above 1.
        geometric_sd: f64,
    },
    /// The density rises from the least value to the mode and falls to the largest.
    Triangular {
        /// The least value.
        from: f64,
        /// The likeliest value.
        mode: f64,
        /// The largest value.
        to: f64,
    },
    /// Any of these values is as likely as any other.
    Empirical {
        /// At least two values, in increasing order.
        #[serde(default)]
        values: Vec<f64>,
        /// The CSV file with a column `value` that a study file names instead; `None` once it is read.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        file: Option<PathBuf>,
    },
}

impl Distribution {
    /// Whether there is such a distribution.
    ///
    /// # Errors
    /// The parameter that is out of its range, and what would be right.
    ///
    /// Implements: STU-011.
    pub fn check(&self) -> Result<(), Refusal> {
        use Distribution::{Empirical, Lognormal, Normal, Triangular, Uniform};
        let is_above = |least: f64, value: f64| value > least && value.is_finite();
        // Not finite if an end is not.
        let is_range = |from: f64, to: f64| is_above(0.0, to - from);
        let (key, found, expected) = match *self {
            Uniform { from, to } if !is_range(from, to) => {
                ("uniform.to", to, "a finite number above 'from'")
            }
            Normal { mean, .. } if !mean.is_finite() => ("normal.mean", mean, "a finite number"),
            Normal { sd, .. } if !is_above(0.0, sd) => ("normal.sd", sd, "a finite number above 0"),
            Lognormal { median, .. } if !is_above(0.0, median) => {
                ("lognormal.median", median, "a finite number above 0")
            }
            Lognormal { geometric_sd, .. } if !is_above(1.0, geometric_sd) => {
                let expected = "a finite number above 1";
                ("lognormal.geometric_sd", geometric_sd, expected)
            }
            Triangular { from, mode, to }
                if !(is_range(from, to) && (from..=to).contains(&mode)) =>
            {
                let expected = "from ≤ mode ≤ to and from < to, all finite";
                ("triangular.mode", mode, expected)
            }
            Empirical { ref values, .. } if values.len() < 2 => {
                ("empirical.values", values.len() as f64, "at least 2 values")
            }
            Empirical { ref values, .. }
                if !(values.is_sorted() && values.iter().all(|value| value.is_finite())) =>
            {
                let found = "empirical.values are not finite numbers in increasing order";
                return Err(Refusal::state(found, ""));
            }
            _ => return Ok(()),
        };
        Err(Refusal::value(key, format!("{found:?}"), expected))
    }

    /// The value below which the input lies with the probability `p`, strictly between 0 and 1.
    ///
    /// Implements: STU-010.
    pub fn quantile(&self, p: f64) -> f64 {
        // Defined for each such p.
        let deviate = || normal::quantile(p).unwrap_or(f64::NAN);
        match self {
            Distribution::Uniform { from, to } => from + p * (to - from),
            Distribution::Normal { mean, sd } => mean + sd * deviate(),
            Distribution::Lognormal {
                median,
                geometric_sd,
            } => median * libm::exp(libm::log(*geometric_sd) * deviate()),
            Distribution::Triangular { from, mode, to } => {
                let (rise, fall) = (mode - from, to - mode);
                let width = rise + fall;
                if p * width < rise {
                    from + libm::sqrt(p * width * rise)
                } else {
                    to - libm::sqrt((1.0 - p) * width * fall)
                }
            }
            Distribution::Empirical { values, .. } => {
                let place = (p * values.len() as f64) as usize;
                values[place.min(values.len() - 1)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use statrs::distribution::{ContinuousCDF, LogNormal, Normal, Triangular, Uniform};

    use super::*;
    use palpate_asserts::assert_near;

    /// A distribution as a study's file states it.
    fn of(toml: &str) -> Distribution {
        toml::from_str(toml).unwrap()
    }

    // Verifies: STU-010.
    #[test]
    fn quantiles_are_those_of_another_library() {
        let other = |distribution: &Distribution, p: f64| match *distribution {
            Distribution::Uniform { from, to } => Uniform::new(from, to).unwrap().inverse_cdf(p),
            Distribution::Normal { mean, sd } => Normal::new(mean, sd).unwrap().inverse_cdf(p),
            Distribution::Lognormal {
                median,
                geometric_sd,
            } => {
                let law = LogNormal::new(median.ln(), geometric_sd.ln());
                law.unwrap().inverse_cdf(p)
            }
            Distribution::Triangular { from, mode, to } => {
                Triangular::new(from, to, mode).unwrap().inverse_cdf(p)
            }
            Distribution::Empirical { .. } => unreachable!(),
        };
        let cases = "
            uniform = { from = -2, to = 3 }
            normal = { mean = 4, sd = 0.5 }
            lognormal = { median = 5, geometric_sd = 1.3 }
            triangular = { from = 1, mode = 1.5, to = 4 }
            triangular = { from = 1, mode = 1, to = 4 }
            triangular = { from = 1, mode = 4, to = 4 }";
        for distribution in cases.trim().lines().map(of) {
            assert_eq!(distribution.check(), Ok(()));
            for p in [1e-6, 0.025, 0.1, 1.0 / 6.0, 0.3, 0.5, 0.9, 0.975, 0.999] {
                let (found, other) = (distribution.quantile(p), other(&distribution, p));
                // Theirs is found by an erf with some eleven right digits, or by bisection.
                assert_near(found, other, 1e-8 * (1.0 + other.abs()));
            }
        }
    }

    // Verifies: STU-010.
    #[test]
    fn each_value_of_an_empirical_distribution_has_the_same_share() {
        let distribution = of("empirical = { values = [1, 2, 2, 7] }");
        let found = [0.01, 0.24, 0.26, 0.74, 0.76, 0.99].map(|p| distribution.quantile(p));
        assert_eq!(found, [1.0, 1.0, 2.0, 2.0, 7.0, 7.0]);
    }

    // Verifies: STU-011.
    #[test]
    fn distributions_that_do_not_exist_are_refused_with_the_parameter() {
        let cases = "
            uniform = { from = 1, to = 1 } => uniform.to = 1.0
            uniform = { from = nan, to = 1 } => uniform.to
            uniform = { from = -1.7e308, to = 1.7e308 } => uniform.to
            normal = { mean = nan, sd = 1 } => normal.mean = NaN
            normal = { mean = 0, sd = 0 } => normal.sd = 0.0
            lognormal = { median = 0, geometric_sd = 2 } => lognormal.median
            lognormal = { median = 1, geometric_sd = 1 } => lognormal.geometric_sd
            triangular = { from = 0, mode = 2, to = 1 } => triangular.mode = 2.0
            triangular = { from = 1, mode = 1, to = 1 } => triangular.mode
            empirical = { values = [1] } => empirical.values = 1.0
            empirical = { values = [2, 1] } => empirical.values
            empirical = { values = [1, nan] } => empirical.values";
        for (distribution, key) in cases.lines().filter_map(|case| case.split_once(" => ")) {
            let error = of(distribution).check().unwrap_err().to_string();
            assert!(error.starts_with(key), "{error}");
        }
    }
}
