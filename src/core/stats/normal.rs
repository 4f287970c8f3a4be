//! The standard normal law: density φ, distribution Φ, upper tail 1 − Φ, and quantile Φ⁻¹.

use super::NumericError;
use super::compensated::DoubleDouble;
use super::error::{check_finite, check_probability};

/// 1/√2 as a double-double.
const FRAC_1_SQRT_2: DoubleDouble = DoubleDouble {
    high: core::f64::consts::FRAC_1_SQRT_2,
    low: -4.833_646_656_726_457e-17,
};
/// 2/√π.
const FRAC_2_SQRT_PI: f64 = core::f64::consts::FRAC_2_SQRT_PI;
/// 1/√(2π).
const DENSITY_AT_ZERO: f64 = 0.398_942_280_401_432_7;

/// φ(x) = exp(−x²/2)/√(2π).
///
/// # Errors
/// x NaN or infinite.
///
/// Implements: DET-001.
pub fn density(x: f64) -> Result<f64, NumericError> {
    check_finite("x", x).map(unchecked_density)
}

/// Φ(x), the probability of a value of at most x.
///
/// # Errors
/// x NaN or infinite.
///
/// Implements: DET-001.
pub fn cdf(x: f64) -> Result<f64, NumericError> {
    check_finite("x", x).map(lower_tail)
}

/// 1 − Φ(x), without cancellation.
///
/// # Errors
/// x NaN or infinite.
///
/// Implements: DET-001.
pub fn upper_tail(x: f64) -> Result<f64, NumericError> {
    check_finite("x", x).map(|x| lower_tail(-x))
}

/// Φ⁻¹(p), the x with Φ(x) = p.
///
/// M. J. Wichura's algorithm AS 241 (Applied Statistics 37, 1988) and one Newton step on Φ. For an
/// upper tail q ask for −Φ⁻¹(q): 1 − q would be rounded.
///
/// # Errors
/// p not strictly between 0 and 1.
///
/// Implements: DET-001, DET-005.
pub fn quantile(p: f64) -> Result<f64, NumericError> {
    quantile_of("p", p)
}

/// [`quantile`] of an argument called `what`.
pub(crate) fn quantile_of(what: &'static str, p: f64) -> Result<f64, NumericError> {
    check_probability(what, p)?;
    // 1 − p is exact for p ≥ 1/2, so the upper half is the lower one mirrored.
    Ok(if p > 0.5 {
        -lower_quantile(1.0 - p)
    } else {
        lower_quantile(p)
    })
}

fn unchecked_density(x: f64) -> f64 {
    // x² with its rounding error: exp would turn an ulp of x²/2 = 700 into 700 ulps.
    let square = if x.abs() < 1e100 {
        DoubleDouble::product(x, x)
    } else {
        DoubleDouble::new(x.abs(), 0.0)
    };
    DENSITY_AT_ZERO * libm::exp(-0.5 * square.high) * (1.0 - 0.5 * square.low)
}

/// Φ(x) for every x that is no NaN: −∞ gives 0 and ∞ gives 1.
///
/// Φ(x) = ½ erfc(−x/√2). The rounding error δ of −x/√2 changes the far tail by the factor exp(x
/// δ√2), up to 1e-13, so it is put back to first order: erfc(a + δ) = erfc(a) − δ (2/√π) exp(−a²).
pub fn lower_tail(x: f64) -> f64 {
    // Beyond ±40, Φ is 0 or 1 to the last bit, and the product below need not stand infinity.
    if x < -40.0 {
        return 0.0;
    }
    if x > 40.0 {
        return 1.0;
    }
    let scaled = DoubleDouble::product(-x, FRAC_1_SQRT_2.high);
    let argument = scaled.high;
    let rounding = scaled.low - x * FRAC_1_SQRT_2.low;
    0.5 * (libm::erfc(argument) - rounding * FRAC_2_SQRT_PI * libm::exp(-argument * argument))
}

/// Φ⁻¹(p) for 0 < p ≤ ½.
fn lower_quantile(p: f64) -> f64 {
    /// Below it Φ and φ near the subnormal numbers and lose the digits that the step needs.
    const FAR_TAIL: f64 = 1e-306;
    let start = wichura(p);
    if p < FAR_TAIL {
        return start;
    }
    let excess = if p > 0.075 {
        // Near ½ the difference Φ(x) − p would cancel: take both from ½.
        0.5 * libm::erf(start * FRAC_1_SQRT_2.high) - (p - 0.5)
    } else {
        lower_tail(start) - p
    };
    start - excess / unchecked_density(start)
}

/// Algorithm AS 241 (PPND16) for 0 < p ≤ ½: a relative error of about 1e-16 before rounding.
fn wichura(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        return rational(&CENTRE, q, 0.180625 - q * q);
    }
    let r = libm::sqrt(-libm::log(p));
    if r <= 5.0 {
        rational(&TAIL, -1.0, r - 1.6)
    } else {
        rational(&FAR, -1.0, r - 5.0)
    }
}

/// factor · Σ aᵢ xⁱ / Σ bᵢ xⁱ by Horner's rule, for coefficients [aᵢ, bᵢ] from i = 0 on.
fn rational(coefficients: &[[f64; 2]; 8], factor: f64, x: f64) -> f64 {
    let horner = |sums: [f64; 2], ab: &[f64; 2]| [0, 1].map(|k| sums[k] * x + ab[k]);
    let [numerator, denominator] = coefficients.iter().rev().fold([0.0; 2], horner);
    factor * numerator / denominator
}

const CENTRE: [[f64; 2]; 8] = [
    [3.387_132_872_796_366_5, 1.0],
    [1.331_416_678_917_843_8e2, 4.231_333_070_160_091e1],
    [1.971_590_950_306_551_3e3, 6.871_870_074_920_579e2],
    [1.373_169_376_550_946e4, 5.394_196_021_424_751e3],
    [4.592_195_393_154_987e4, 2.121_379_430_158_659_7e4],
    [6.726_577_092_700_87e4, 3.930_789_580_009_271e4],
    [3.343_057_558_358_813e4, 2.872_908_573_572_194_3e4],
    [2.509_080_928_730_122_7e3, 5.226_495_278_852_545e3],
];
const TAIL: [[f64; 2]; 8] = [
    [1.423_437_110_749_683_5, 1.0],
    [4.630_337_846_156_546, 2.053_191_626_637_759],
    [5.769_497_221_460_691, 1.676_384_830_183_803_8],
    [3.647_848_324_763_204_5, 6.897_673_349_851e-1],
    [1.270_458_252_452_368_4, 1.481_039_764_274_800_8e-1],
    [2.417_807_251_774_506e-1, 1.519_866_656_361_645_7e-2],
    [2.272_384_498_926_918_4e-2, 5.475_938_084_995_345e-4],
    [7.745_450_142_783_414e-4, 1.050_750_071_644_416_9e-9],
];
const FAR: [[f64; 2]; 8] = [
    [6.657_904_643_501_103, 1.0],
    [5.463_784_911_164_114, 5.998_322_065_558_88e-1],
    [1.784_826_539_917_291_3, 1.369_298_809_227_358e-1],
    [2.965_605_718_285_048_7e-1, 1.487_536_129_085_061_5e-2],
    [2.653_218_952_657_612_4e-2, 7.868_691_311_456_133e-4],
    [1.242_660_947_388_078_4e-3, 1.846_318_317_510_054_8e-5],
    [2.711_555_568_743_487_6e-5, 1.421_511_758_316_446e-7],
    [2.010_334_399_292_288_1e-7, 2.044_263_103_389_939_8e-15],
];

#[cfg(test)]
mod tests;
