//! The command line, its lists, and decimal numbers.

use std::ffi::OsString;

use palpate::decimal::{format_scaled, parse_scaled};
use palpate_program::arguments::{CommandLine, read};
use palpate_program::numbers::{List, length, positions};

use crate::message::check_message;
use crate::{Outcome, judged};

/// Most positions of a list (CLI-010).
const MOST: usize = 10_000;

/// An accepted list has at most 10 000 finite, increasing positions, is the same when it is written
/// and read again, and has its ends where the text says.
pub fn list(text: &str) -> Outcome {
    match length(text) {
        Ok(length) => assert!(length.is_finite() && length > 0.0),
        Err(error) => check_message(&error),
    }
    let accepted = |positions: List| check_list(&positions, text);
    judged(positions(text), accepted, |error| check_message(&error))
}

fn check_list(positions: &[f64], text: &str) {
    check_positions(positions);
    let written: Vec<String> = positions.iter().map(|&x| format_scaled(x, 3)).collect();
    let again = palpate_program::numbers::positions(&written.join(","));
    let again = again.expect("it was written");
    let bits = |positions: &[f64]| positions.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&again), bits(positions));
    let metres = |text: &str| parse_scaled(text.trim(), -3).expect("it was accepted");
    if let [from, to, step] = text.split(':').collect::<Vec<_>>()[..] {
        assert_eq!(positions[0], metres(from));
        // The last is the largest of the sequence up to `to`.
        let (last, to, step) = (positions[positions.len() - 1], metres(to), metres(step));
        assert!(last <= to && to - last < step * (1.0 + 1e-9), "{last} {to}");
    } else {
        assert_eq!(positions.len(), text.split(',').count());
    }
}

/// Positions are finite and increase, and there are at most 10 000.
pub fn check_positions(positions: &[f64]) {
    assert!((1..=MOST).contains(&positions.len()));
    assert!(positions.iter().all(|x| x.is_finite()));
    assert!(positions.windows(2).all(|pair| pair[0] < pair[1]));
}

/// A number that is accepted is finite, the one that the standard library reads where the unit is 1,
/// and is written such that it reads back to the bit.
///
/// The first byte is the power of ten, from −12 to 12; the rest is the text.
pub fn decimal(bytes: &[u8]) -> Outcome {
    let Some((&first, rest)) = bytes.split_first() else {
        return Outcome::Refused;
    };
    let Ok(text) = std::str::from_utf8(rest) else {
        return Outcome::Refused;
    };
    let power = i32::from(first) % 25 - 12;
    let plain = text
        .bytes()
        .all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
    match parse_scaled(text, power) {
        Some(value) => {
            assert!(plain && value.is_finite(), "{text:?}");
            let written = format_scaled(value, -power);
            let again = parse_scaled(&written, power).map(f64::to_bits);
            assert_eq!(again, Some(value.to_bits()), "{written}");
            if power == 0 {
                let standard = text.parse::<f64>().map(f64::to_bits);
                assert_eq!(standard, Ok(value.to_bits()));
            }
            Outcome::Accepted
        }
        None => {
            let finite = text.parse::<f64>().is_ok_and(f64::is_finite);
            // What the standard library takes is taken, but for exponents beyond i32.
            assert!(
                power != 0 || !plain || !finite || text.len() > 10,
                "{text:?}"
            );
            Outcome::Refused
        }
    }
}

/// A command line that is refused has a message of one line and the exit code 2. Nothing is run.
///
/// The bytes are the arguments, with a NUL between.
pub fn command_line(text: &str) -> Outcome {
    let arguments = text.split('\0').map(OsString::from);
    let asked = read::<CommandLine>(std::iter::once("palpate".into()).chain(arguments));
    let accepted = |asked| match asked {
        Ok(arguments) => assert!(!format!("{arguments:?}").is_empty()),
        Err(text) => assert!(!String::is_empty(&text)),
    };
    judged(asked, accepted, |error| {
        check_message(&error.to_string());
        assert_eq!(error.exit_code(), 2);
    })
}
