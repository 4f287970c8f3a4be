//! Force–depth curves, and what a user says of the columns of a file.

use palpate::calibration::Curve;
use palpate::csv::Layout;
use palpate::refusal::Refusal;

use crate::map::check_csv;
use crate::message::{check_file_message, check_message};
use crate::{FILE, Outcome, judged};

/// A statement of columns, if the first line begins with `columns `, and a curve. An accepted curve has 20 samples or more, all finite,
/// with times that increase or none, of which the last is deep; it is the same when it is written and read again. A refusal quotes what
/// stands in the line that it names, or in the statement.
pub fn curve_csv(text: &str) -> Outcome {
    let stated = text.strip_prefix("columns ");
    let (columns, text) = stated
        .and_then(|text| text.split_once('\n'))
        .unwrap_or(("", text));
    let layout = match columns {
        "" => Ok(Layout::default()),
        columns => columns.parse::<Layout>(),
    };
    let layout = match layout {
        Ok(layout) => layout,
        Err(error) => {
            check_message(&error.to_string());
            return Outcome::Refused;
        }
    };
    let refused = |error: Refusal| match error.line {
        // What is wrong with the header may be that it lacks a stated column.
        Some(_) if columns.is_empty() => check_csv(&error, text),
        _ => check_file_message(&error, text),
    };
    judged(Curve::from_csv(text, FILE, &layout), check_curve, refused)
}

fn check_curve(curve: Curve) {
    let (depths, forces) = (curve.depths(), curve.forces());
    assert!(depths.len() >= 20 && forces.len() == depths.len());
    assert!(depths.iter().chain(forces).all(|number| number.is_finite()));
    let deepest = depths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(depths[0] < deepest);
    // The way back begins 5 % of the way above the deepest point, so the last sample is in the deeper half.
    assert!(depths[depths.len() - 1] / 2.0 >= depths[0] / 4.0 + deepest / 4.0);
    let times = curve.times().inspect(|times| {
        assert_eq!(times.len(), depths.len());
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    });
    let again = Curve::from_csv(&written(times, depths, forces), FILE, &Layout::default());
    let again = again.expect("what was written can be read");
    let numbers = (curve.times(), curve.depths(), curve.forces());
    assert_eq!((again.times(), again.depths(), again.forces()), numbers);
}

/// The curve as a file; the digits name each number to the bit.
fn written(times: Option<&[f64]>, depths: &[f64], forces: &[f64]) -> String {
    let time = |at: usize| times.map_or(String::new(), |times| format!("{:?},", times[at]));
    let head = if times.is_some() { "time_s," } else { "" };
    let rows = depths.iter().zip(forces).enumerate();
    let rows = rows.map(|(at, (depth, force))| format!("{}{depth:?},{force:?}\n", time(at)));
    format!("{head}depth_m,normal_force_n\n") + &rows.collect::<String>()
}
