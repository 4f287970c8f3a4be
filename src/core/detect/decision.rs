//! Thresholds, the decision, and the rates of error that follow from Θ ~ N(∓γ²/2, γ²), paper
//! equations (8) and (9).

use super::DetectError;
use crate::stats::error::{
    check_finite, check_not_negative, check_positive, check_probability, in_range, representable,
};
use crate::stats::normal::{lower_tail, quantile_of as quantile};

/// Ĥ of equation (9).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
pub enum Decision {
    /// Ĥ = 0: no inclusion.
    NoInclusion,
    /// Ĥ = 1: an inclusion.
    Inclusion,
}

/// The costs C_ij of deciding i when H = j, in any one unit.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Costs {
    /// Deciding 0 when H = 0.
    pub c00: f64,
    /// Deciding 0 when H = 1: a miss.
    pub c01: f64,
    /// Deciding 1 when H = 0: a false alarm.
    pub c10: f64,
    /// Deciding 1 when H = 1.
    pub c11: f64,
}

/// The two probabilities of error at a threshold.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ErrorRates {
    /// Pr(Ĥ = 1 | H = 0).
    pub false_alarm: f64,
    /// Pr(Ĥ = 0 | H = 1).
    pub miss: f64,
}

/// Ĥ = 1 if and only if θ ≥ η, equation (9).
///
/// # Errors
/// θ or η NaN or infinite.
///
/// Implements: DET-005, DET-009, DET-020.
pub fn decide(theta: f64, eta: f64) -> Result<Decision, DetectError> {
    check_finite("theta", theta)?;
    check_finite("eta", eta)?;
    Ok(if theta >= eta {
        Decision::Inclusion
    } else {
        Decision::NoInclusion
    })
}

/// Pr(H = 1 | Θ = θ) for the prior Pr(H = 1).
///
/// # Errors
/// θ not finite; the prior not strictly between 0 and 1.
///
/// Implements: DET-021.
pub fn posterior(theta: f64, prior_h1: f64) -> Result<f64, DetectError> {
    let log_odds = check_finite("theta", theta)? - map_threshold(prior_h1)?;
    // exp of a negative number only: it cannot overflow.
    let small = libm::exp(-log_odds.abs());
    Ok(if log_odds >= 0.0 {
        1.0 / (1.0 + small)
    } else {
        small / (1.0 + small)
    })
}

/// The threshold of the maximum a-posteriori rule, η = ln(P0/P1).
///
/// # Errors
/// The prior not strictly between 0 and 1.
///
/// Implements: DET-022, DET-001.
pub fn map_threshold(prior_h1: f64) -> Result<f64, DetectError> {
    let p = check_probability("prior_h1", prior_h1)?;
    // Near p = ½ the quotient is near 1, where ln keeps no relative accuracy; 1 − 2p is exact
    // there.
    Ok(if p > 0.25 && p < 0.75 {
        libm::log1p((1.0 - 2.0 * p) / p)
    } else if p < 1e-300 {
        // The quotient may overflow; 1 − p is 1.
        -libm::log(p)
    } else {
        libm::log((1.0 - p) / p)
    })
}

/// The threshold of least expected cost, η = ln[P0(C10 − C00)/(P1(C01 − C11))].
///
/// # Errors
/// The prior not strictly between 0 and 1; a cost not finite; an error that costs no more than the
/// right decision.
///
/// Implements: DET-022, DET-001.
pub fn bayes_threshold(prior_h1: f64, costs: Costs) -> Result<f64, DetectError> {
    let Costs { c00, c01, c10, c11 } = costs;
    for (what, cost) in [("c00", c00), ("c01", c01), ("c10", c10), ("c11", c11)] {
        check_finite(what, cost)?;
    }
    let false_alarm = check_positive("c10 - c00", c10 - c00)?;
    let miss = check_positive("c01 - c11", c01 - c11)?;
    if false_alarm == miss {
        return map_threshold(prior_h1);
    }
    let prior = check_probability("prior_h1", prior_h1)?;
    // One logarithm: of a sum of them little may be left. Exponents apart, for the quotient of extreme costs could overflow.
    let [(p0, e0), (p1, e1), (of_false_alarm, e2), (of_miss, e3)] =
        [1.0 - prior, prior, false_alarm, miss].map(libm::frexp);
    let (over, under, exponent) = (p0 * of_false_alarm, p1 * of_miss, e0 + e2 - e1 - e3);
    if exponent.abs() > 1000 {
        return Ok(libm::log(over / under) + f64::from(exponent) * core::f64::consts::LN_2);
    }
    let over = libm::scalbn(over, exponent);
    Ok(if over <= 2.0 * under && under <= 2.0 * over {
        libm::log1p((over - under) / under)
    } else {
        libm::log(over / under)
    })
}

/// The Neyman–Pearson threshold with the fewest false alarms among those with a miss rate ≤ β,
/// η = γ²/2 + γΦ⁻¹(β).
///
/// # Errors
/// γ not finite or < 0; β not strictly between 0 and 1; overflow.
///
/// Implements: DET-022, DET-001.
pub fn neyman_pearson_miss_threshold(gamma: f64, max_miss: f64) -> Result<f64, DetectError> {
    check_not_negative("gamma", gamma)?;
    let quantile = quantile("max_miss", max_miss)?;
    representable("eta", gamma * (0.5 * gamma + quantile))
}

/// The Neyman–Pearson threshold with the fewest misses among those with a false-alarm rate ≤ α,
/// η = −γ²/2 + γΦ⁻¹(1−α).
///
/// # Errors
/// γ not finite or < 0; γ = 0, where Θ ≡ 0 and η = 0 would always alarm; α not strictly between 0
/// and 1; overflow.
///
/// Implements: DET-025, DET-001.
pub fn neyman_pearson_false_alarm_threshold(
    gamma: f64,
    max_false_alarm: f64,
) -> Result<f64, DetectError> {
    check_not_negative("gamma", gamma)?;
    let quantile = -quantile("max_false_alarm", max_false_alarm)?;
    if gamma == 0.0 {
        return Err(DetectError::NoSignal);
    }
    representable("eta", gamma * (quantile - 0.5 * gamma))
}

/// P_fa = Φ(−(η + γ²/2)/γ) and P_miss = Φ((η − γ²/2)/γ). With γ = 0, Θ is always 0 and equation (9)
/// decides.
///
/// # Errors
/// γ not finite or < 0; η not finite.
///
/// Implements: DET-026, DET-001.
pub fn error_rates(gamma: f64, eta: f64) -> Result<ErrorRates, DetectError> {
    check_not_negative("gamma", gamma)?;
    check_finite("eta", eta)?;
    if gamma == 0.0 {
        let miss = f64::from(eta > 0.0);
        let false_alarm = 1.0 - miss;
        return Ok(ErrorRates { false_alarm, miss });
    }
    // η/γ ± γ/2 instead of (η ± γ²/2)/γ: γ² may overflow. An infinite η/γ has the right limit.
    let criterion = eta / gamma;
    Ok(ErrorRates {
        false_alarm: lower_tail(-(criterion + 0.5 * gamma)),
        miss: lower_tail(criterion - 0.5 * gamma),
    })
}

/// The receiver operating characteristic (figure 4): P_miss = Φ(Φ⁻¹(1−P_fa) − γ), with its end
/// points (0, 1) and (1, 0).
///
/// # Errors
/// γ not finite or < 0; the false-alarm rate not in [0, 1].
///
/// Implements: DET-027, DET-001.
pub fn roc_miss(gamma: f64, false_alarm: f64) -> Result<f64, DetectError> {
    check_not_negative("gamma", gamma)?;
    let is_right = (0.0..=1.0).contains(&false_alarm);
    in_range(is_right, "false_alarm", false_alarm, "between 0 and 1")?;
    if false_alarm == 0.0 || false_alarm == 1.0 {
        return Ok(1.0 - false_alarm);
    }
    Ok(lower_tail(-quantile("false_alarm", false_alarm)? - gamma))
}

/// The least γ with a false-alarm rate ≤ α and a miss rate ≤ β, Φ⁻¹(1−α) + Φ⁻¹(1−β), or 0 if blind
/// guessing does.
///
/// # Errors
/// α or β not strictly between 0 and 1.
///
/// Implements: DET-027, DET-001.
pub fn required_gamma(max_false_alarm: f64, max_miss: f64) -> Result<f64, DetectError> {
    let sum = quantile("max_false_alarm", max_false_alarm)? + quantile("max_miss", max_miss)?;
    Ok(if sum < 0.0 { -sum } else { 0.0 })
}

/// The probability of the right answer in a two-alternative forced choice (figure 9), Φ(γ/√2), which is also the area under
/// the curve of hits against false alarms.
///
/// # Errors
/// γ not finite or < 0.
///
/// Implements: DET-027, DET-001.
pub fn two_afc(gamma: f64) -> Result<f64, DetectError> {
    check_not_negative("gamma", gamma)?;
    // Φ(γ/√2) = ½ erfc(−γ/2), whose argument is exact.
    Ok(0.5 * libm::erfc(-0.5 * gamma))
}

/// The γ with which a share `p_correct` of forced choices is right, √2 Φ⁻¹(p); negative below one
/// half.
///
/// # Errors
/// The share not strictly between 0 and 1.
///
/// Implements: DET-027, DET-001, ERR-004.
pub fn gamma_from_two_afc(p_correct: f64) -> Result<f64, DetectError> {
    Ok(core::f64::consts::SQRT_2 * quantile("p_correct", p_correct)?)
}
