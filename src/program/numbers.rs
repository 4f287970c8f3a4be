//! Numbers on the command line, and lists of them: `a,b,c` or `from:to:step`, of positions in mm or of moduli in kPa.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use palpate::decimal::{format_scaled, parse_scaled};
use palpate::fem::Contact;

/// A contact law by its name.
pub fn contact() -> impl TypedValueParser<Value = Contact> {
    const HELP: [(Contact, &str); 2] = [
        (
            Contact::DeformedNormal,
            "Gap between the deformed surface and the probe; force along its normal",
        ),
        (
            Contact::VerticalGap,
            "Height of the probe above the undeformed point; vertical force on the gel",
        ),
    ];
    let names = HELP.map(|(law, help)| PossibleValue::new(law.name()).help(help));
    PossibleValuesParser::new(names).map(|name| {
        let mut laws = HELP.into_iter().map(|(law, _)| law);
        laws.find(|law| law.name() == name).unwrap_or_default()
    })
}

/// The entries of a list, in SI. The parser would take an argument that is declared as a `Vec` entry by entry.
pub type List = Vec<f64>;

/// Most entries that a list may have.
const MOST: i64 = 10_000;
/// Steps are counted in units of 10⁻⁹ of what is written, so that they add up without rounding.
const DECIMALS: i32 = 9;

/// Reads a list of positions in mm; gives metres.
///
/// Implements: CLI-010.
///
/// # Errors
/// A message that names the entry and what would be right.
pub fn positions(text: &str) -> Result<List, String> {
    list(text, -3, "positions", "mm")
}

/// Reads a list of depths of the probe in mm, as [`positions`].
///
/// Implements: CLI-010.
///
/// # Errors
/// As [`positions`]; a depth below 0.
pub fn depths(text: &str) -> Result<List, String> {
    let depths = positions(text)?;
    match depths.first() {
        Some(first) if *first < 0.0 => {
            Err("must be depths of at least 0 in mm; 0 is the undeformed surface".into())
        }
        _ => Ok(depths),
    }
}

/// Reads a list of depths above 0 in mm, one for each pass of a path, in any order.
///
/// Implements: CLI-010.
///
/// # Errors
/// As [`positions`], but for the order; a depth that is not above 0.
pub fn passes(text: &str) -> Result<List, String> {
    let depths = entries(text, -3, "passes", "mm")?;
    match depths.iter().all(|depth| *depth > 0.0) {
        true => Ok(depths),
        false => Err("must be depths above 0 in mm, such as 1,2,3,4".into()),
    }
}

/// Reads a list of lengths above 0 in mm, as [`positions`].
///
/// Implements: CLI-202.
///
/// # Errors
/// As [`positions`]; a length that is not above 0.
pub fn lengths(text: &str) -> Result<List, String> {
    let lengths = list(text, -3, "lengths", "mm")?;
    match lengths.first() {
        Some(first) if *first > 0.0 => Ok(lengths),
        _ => Err(format!("must be {LENGTH}")),
    }
}

/// Reads a list of moduli in kPa; gives pascals.
///
/// Implements: CLI-154.
///
/// # Errors
/// As [`positions`].
pub fn moduli(text: &str) -> Result<List, String> {
    list(text, 3, "moduli", "kPa")
}

const LENGTH: &str = "a length above 0 in mm, such as 2.5";

/// Reads one number and multiplies it by 10^`power`; it must be as `is_right` says, and `must_be` in words.
///
/// Implements: CON-001.
fn number(text: &str, power: i32, is_right: fn(f64) -> bool, must_be: &str) -> Result<f64, String> {
    let number = parse_scaled(text, power).filter(|&number| is_right(number));
    number.ok_or_else(|| format!("must be {must_be}"))
}

/// A number for each of so many: the one, or as many as there are; none where there are others.
pub fn for_each(numbers: &[f64], count: usize) -> Option<Vec<f64>> {
    match numbers {
        [number] => Some(vec![*number; count]),
        numbers => (numbers.len() == count).then(|| numbers.to_vec()),
    }
}

/// Reads a length above 0 in mm; gives metres.
///
/// # Errors
/// As the functions below, a message that says what the number must be.
pub fn length(text: &str) -> Result<f64, String> {
    number(text.trim(), -3, |length| length > 0.0, LENGTH)
}

/// Reads a length of at least 0 in mm; gives metres.
pub fn length_or_zero(text: &str) -> Result<f64, String> {
    let must_be = "a length of at least 0 in mm, such as 0.3";
    number(text, -3, |length| length >= 0.0, must_be)
}

/// Reads a position in mm; gives metres.
pub fn position(text: &str) -> Result<f64, String> {
    number(text, -3, |_| true, "a position in mm, such as 2.5")
}

/// Reads a velocity in mm/s; gives m/s.
pub fn velocity(text: &str) -> Result<f64, String> {
    number(text, -3, |_| true, "a velocity in mm/s, such as -20")
}

/// Reads a force above 0 in N.
pub fn newtons(text: &str) -> Result<f64, String> {
    let must_be = "a force above 0 in N, such as 0.1";
    number(text, 0, |force| force > 0.0, must_be)
}

/// Reads a force of at least 0 in N.
pub fn newtons_or_zero(text: &str) -> Result<f64, String> {
    let must_be = "a force of at least 0 in N, such as 0.1";
    number(text, 0, |force| force >= 0.0, must_be)
}

/// Reads a number of at least 0.
pub fn at_least_0(text: &str) -> Result<f64, String> {
    let must_be = "a number of at least 0, such as 0.5";
    number(text, 0, |value| value >= 0.0, must_be)
}

/// Reads `N` numbers of at least 0, with commas between them.
pub fn several<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers = text.split(',').map(|number| at_least_0(number.trim()));
    let numbers = numbers.collect::<Result<Vec<_>, _>>()?;
    let must_be = format!("must be {N} numbers with commas between them");
    numbers.try_into().map_err(|_: Vec<f64>| must_be)
}

/// Reads a share of at least 0 and below 1.
pub fn share_below_1(text: &str) -> Result<f64, String> {
    let is_right = |share| (0.0..1.0).contains(&share);
    number(text, 0, is_right, "a number of at least 0 and below 1")
}

/// Reads a coefficient of friction.
pub fn friction(text: &str) -> Result<f64, String> {
    let must_be = "a coefficient of friction of at least 0, such as 0.3";
    number(text, 0, |friction| friction >= 0.0, must_be)
}

/// Reads a probability from which something is sure.
pub fn sure_probability(text: &str) -> Result<f64, String> {
    let is_right = |p: f64| p > 0.5 && p < 1.0;
    number(text, 0, is_right, "a probability above 0.5 and below 1")
}

/// Reads a probability strictly between 0 and 1.
pub fn probability(text: &str) -> Result<f64, String> {
    let is_right = |share| share > 0.0 && share < 1.0;
    number(text, 0, is_right, "a probability strictly between 0 and 1")
}

/// Reads a list `of` numbers that increase and are written in a `unit` of 10^`power` SI.
///
/// Implements: CON-001.
fn list(text: &str, power: i32, of: &str, unit: &str) -> Result<List, String> {
    let values = entries(text, power, of, unit)?;
    let Some(pair) = values.windows(2).find(|pair| pair[0] >= pair[1]) else {
        return Ok(values);
    };
    let [before, after] = [pair[0], pair[1]].map(|value| format_scaled(value, -power));
    Err(format!(
        "{after} {unit} after {before} {unit}: {of} must increase"
    ))
}

/// Reads a list as [`list`], in any order.
fn entries(text: &str, power: i32, of: &str, unit: &str) -> Result<List, String> {
    let value = |text: &str| {
        let value = parse_scaled(text, power);
        value.ok_or_else(|| format!("{text:?} is not a number in {unit}, such as 2.5"))
    };
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let values = match parts[..] {
        [list] => list.split(',').map(|entry| value(entry.trim())).collect(),
        [from, to, step] => {
            let steps = |text| value(text).and_then(|_| in_steps(text, unit));
            let (first, last, by) = (steps(from)?, steps(to)?, steps(step)?);
            if by <= 0 || last < first {
                let must = "must have from ≤ to and a step above 0";
                return Err(format!("{from}:{to}:{step} {must}"));
            }
            let count = (last - first) / by + 1;
            if count > MOST {
                return Err(format!(
                    "{from}:{to}:{step} has {count} {of}; at most {MOST} are allowed"
                ));
            }
            let entry = |k: i64| value(&format!("{}e-{DECIMALS}", first + k * by));
            (0..count).map(entry).collect()
        }
        _ => Err(format!(
            "{text:?} must have the form a,b,c or from:to:step in {unit}, such as 0:4:0.5"
        )),
    };
    let values: List = values?;
    let count = values.len();
    if count > MOST as usize {
        return Err(format!(
            "{count} {of} are too many; at most {MOST} are allowed"
        ));
    }
    Ok(values)
}

/// A number of `unit` as a number of steps of 10⁻⁹.
fn in_steps(text: &str, unit: &str) -> Result<i64, String> {
    match parse_scaled(text, DECIMALS) {
        // Whole and below 10¹⁵: exact.
        Some(steps) if steps.abs() < 1e15 && steps.fract() == 0.0 => Ok(steps as i64),
        _ => Err(format!(
            "{text:?} must be below 1e6 {unit} and have at most 9 decimal places"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: CLI-010, CLI-154.
    #[test]
    fn lists_are_exact_in_mm_and_kpa() {
        for (text, metres) in [
            ("1, 2.6,4", &[0.001, 0.0026, 0.004][..]),
            ("-0.5", &[-0.0005]),
            // Sums of the step in binary would miss 0.0003 and 0.0006 by a bit.
            ("0:0.6:0.1", &[0.0, 1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4]),
            ("-1:1:1", &[-0.001, 0.0, 0.001]),
            ("0:1:0.6", &[0.0, 0.0006]),
        ] {
            assert_eq!(positions(text), Ok(metres.into()));
        }
        assert_eq!(moduli("44.1,300"), Ok(vec![44_100.0, 300_000.0]));
        assert_eq!(moduli("0.1:0.3:0.1"), Ok(vec![100.0, 200.0, 300.0]));
        let error = moduli("300,44").unwrap_err();
        assert_eq!(error, "44.0 kPa after 300.0 kPa: moduli must increase");
    }

    // Verifies: CLI-010.
    #[test]
    fn depths_are_lists_too_and_those_of_passes_in_any_order() {
        assert_eq!(depths("0:1:0.5"), Ok(vec![0.0, 0.0005, 0.001]));
        let below = "must be depths of at least 0 in mm; 0 is the undeformed surface";
        assert_eq!(depths("-1,2"), Err(below.into()));
        assert_eq!(passes("1:3:1"), Ok(vec![0.001, 0.002, 0.003]));
        assert_eq!(passes("4,4, 2"), Ok(vec![0.004, 0.004, 0.002]));
        for (text, word) in [
            ("0:2:1", "above 0 in mm"),
            ("1,-1", "above 0 in mm"),
            ("1,x", "\"x\""),
            ("3:1:1", "from ≤ to"),
        ] {
            let error = passes(text).unwrap_err();
            assert!(error.contains(word), "{text}: {error}");
        }
    }

    // Verifies: CLI-010.
    #[test]
    fn lists_that_make_no_sense_are_refused_with_the_entry() {
        for (text, word) in [
            ("", "\"\""),
            ("1,,2", "\"\""),
            ("1,x", "\"x\""),
            ("nan", "\"nan\""),
            ("2,1", "1.0 mm after 2.0 mm"),
            ("1,1", "must increase"),
            ("0:1", "from:to:step"),
            ("0:1:0", "step above 0"),
            ("1:0:0.5", "from ≤ to"),
            ("0:1:-0.5", "step above 0"),
            ("0:1:0.00001", "at most 10000"),
            ("0:1e9:1", "below 1e6"),
            ("0:1:0.12345678901", "9 decimal places"),
        ] {
            let error = positions(text).unwrap_err();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
