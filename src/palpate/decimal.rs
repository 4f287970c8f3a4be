//! Decimal numbers between the units that people write (mm, kPa, mN) and SI, without rounding twice.
//!
//! `2.6` mm must become the very `f64` that `0.0026` names. A multiplication by 10⁻³ misses it by a
//! bit now and then, and a division by 1000 cannot be undone: some metres have no `f64` of
//! millimetres. So the power of ten goes into the written number's exponent.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};

/// An SI value that a file writes in another unit, 10^`POWER` of SI. It is read from the digits of the file, not from the number that
/// they round to, and displayed such that it is read back to the bit.
///
/// Implements: PHA-020, CON-002.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaled<const POWER: i32>(pub f64);

/// A length that is written in mm.
pub type Mm = Scaled<-3>;
/// A modulus that is written in kPa.
pub type Kpa = Scaled<3>;
/// A number that is written as it is.
pub type Plain = Scaled<0>;

/// A length in metres.
pub fn mm(metres: f64) -> Mm {
    Scaled(metres)
}

/// A modulus in pascals.
pub fn kpa(pascals: f64) -> Kpa {
    Scaled(pascals)
}

/// A number without a unit, or in the unit of the library.
pub fn plain(number: f64) -> Plain {
    Scaled(number)
}

impl<const POWER: i32> fmt::Display for Scaled<POWER> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format_scaled(self.0, -POWER))
    }
}

impl<'de, const POWER: i32> Deserialize<'de> for Scaled<POWER> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Digits::<POWER>)
    }
}

/// Takes a number from its digits, which come as a newtype.
struct Digits<const POWER: i32>;

impl<'de, const POWER: i32> Visitor<'de> for Digits<POWER> {
    type Value = Scaled<POWER>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a finite decimal number")
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(
        self,
        digits: D,
    ) -> Result<Self::Value, D::Error> {
        let digits = String::deserialize(digits)?;
        let value = parse_scaled(&digits, POWER).map(Scaled);
        value.ok_or_else(|| D::Error::invalid_type(serde::de::Unexpected::Other(&digits), &self))
    }
}

/// The number that `text` writes, times 10^`power`, rounded once to the nearest `f64`.
///
/// `text` is a plain decimal (`34`, `-0.5`, `+1.5e-3`). `None` if it is anything else, `nan`
/// and `inf` included, or if the result is too large for an `f64`.
///
/// Implements: PHA-020, CON-001.
pub fn parse_scaled(text: &str, power: i32) -> Option<f64> {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let exponent = exponent.parse::<i32>().ok()?.checked_add(power)?;
    // With an exponent behind it, no "nan" or "inf" is a number to `str::parse`.
    let value: f64 = format!("{mantissa}e{exponent}").parse().ok()?;
    value.is_finite().then_some(value)
}

/// `value` times 10^`power` in decimal, such that [`parse_scaled`] with `-power` gives `value` back
/// to the bit. A NaN or an infinity is written as Rust writes it.
///
/// Implements: PHA-020.
pub fn format_scaled(value: f64, power: i32) -> String {
    let digits = format!("{value:e}"); // the shortest digits that name `value`, as d.ddde±x
    let Some((mantissa, exponent)) = digits.split_once('e') else {
        return digits;
    };
    let exponent = exponent.parse::<i32>().unwrap_or(0) + power;
    let exact = format!("{mantissa}e{exponent}");
    // Plain notation where it says the same; an f64 in the other unit cannot always.
    let plain = format!("{:?}", exact.parse::<f64>().unwrap_or(f64::NAN));
    match parse_scaled(&plain, -power) {
        Some(back) if back.to_bits() == value.to_bits() => plain,
        _ => exact,
    }
}
