//! Recorded sweeps, whole and line by line.

use palpate::refusal::Refusal;
use palpate::trace::{Abscissa, LiveSample, LiveSamples, Motion, Record, Trace};

use crate::map::check_csv;
use crate::message::{check_file_message, check_message};
use crate::{FILE, Outcome, judged};

/// An accepted trace has finite forces, lateral ones or none, at positions that go one way but for jitter unless each has its depth, and is
/// the same when these are written and read again; a refusal names file and line, and quotes what stands there.
pub fn trace_csv(text: &str) -> Outcome {
    let refused = |error: Refusal| {
        assert!(error.line.is_some(), "{error}");
        check_csv(&error, text);
    };
    judged(
        Trace::from_csv(text, FILE),
        |trace| check_trace(trace, text),
        refused,
    )
}

fn check_trace(trace: Trace, text: &str) {
    let motion = match trace.abscissa() {
        Abscissa::Position => None,
        Abscissa::Time => Some(Motion {
            velocity: -0.01,
            start: 0.02,
        }),
    };
    let record = match trace.record(motion) {
        Ok(record) => record,
        // Finite times can make positions that are not.
        Err(error) => {
            assert!(motion.is_some(), "{error}");
            return check_file_message(&error, text);
        }
    };
    let positions = record.positions();
    assert!(!positions.is_empty() && positions.iter().all(|x| x.is_finite()));
    match record.depths() {
        None => assert!(positions[0] <= positions[positions.len() - 1]),
        Some(depths) => {
            assert_eq!(depths.len(), positions.len());
            assert!(depths.iter().all(|depth| depth.is_finite()));
        }
    }
    let forces = record.forces();
    assert_eq!(forces.normal.len(), positions.len());
    let has_lateral = !forces.lateral.is_empty();
    assert!(!has_lateral || forces.lateral.len() == positions.len());
    assert!(
        forces
            .lateral
            .iter()
            .chain(forces.normal)
            .all(|force| force.is_finite())
    );
    let again = Trace::from_csv(&written(&record), FILE).expect("what was written can be read");
    let again = again.record(None).expect("positions");
    assert_eq!(written(&again), written(&record));
}

/// The record as a file; the digits name each number to the bit.
fn written(record: &Record) -> String {
    let forces = record.forces();
    let lateral = |at: usize| forces.lateral.get(at).map(|force| format!(",{force:?}"));
    let head = if forces.lateral.is_empty() {
        ""
    } else {
        ",lateral_force_n"
    };
    let depths = record.depths();
    let depth_head = depths.map_or("", |_| ",depth_m");
    let mut text = format!("position_m,normal_force_n{head}{depth_head}\n");
    for (at, position) in record.positions().iter().enumerate() {
        let lateral = lateral(at).unwrap_or_default();
        let depth = depths.map_or(String::new(), |depths| format!(",{:?}", depths[at]));
        text += &format!("{position:?},{:?}{lateral}{depth}\n", forces.normal[at]);
    }
    text
}

/// Samples that come line by line have numbers that are finite or missing, all of them a depth and a lateral force or none, and are the
/// same when they are written as JSON and read again. A refusal names the line that came last.
pub fn live_lines(text: &str) -> Outcome {
    let mut lines = LiveSamples::new(FILE, Default::default());
    let mut samples = Vec::new();
    for (at, line) in text.lines().enumerate() {
        match lines.sample(line) {
            Ok(sample) => samples.extend(sample),
            Err(error) => {
                check_message(&error.to_string());
                assert_eq!((error.line, &*error.file), (Some(at + 1), FILE));
                return Outcome::Refused;
            }
        }
    }
    let Some(first) = samples.first() else {
        return Outcome::Refused;
    };
    let mut again = LiveSamples::new(FILE, Default::default());
    for sample in &samples {
        assert_eq!(
            (sample.depth.is_some(), sample.lateral.is_some()),
            (first.depth.is_some(), first.lateral.is_some())
        );
        let read = again
            .sample(&as_json(sample))
            .expect("what was written can be read");
        assert_eq!(bits(&read.expect("a sample")), bits(sample));
    }
    Outcome::Accepted
}

/// The names of its numbers in SI units, and the numbers that it has.
fn numbers(sample: &LiveSample) -> [(&'static str, Option<f64>); 4] {
    [
        ("position_m", Some(sample.position)),
        ("depth_m", sample.depth),
        ("lateral_force_n", sample.lateral),
        ("normal_force_n", Some(sample.normal)),
    ]
}

/// The sample as a line of JSON; the digits name each number to the bit, and a missing one is null.
fn as_json(sample: &LiveSample) -> String {
    let there = numbers(sample).into_iter().filter_map(|(name, number)| {
        let number = number?;
        assert!(!number.is_infinite(), "{sample:?}");
        Some(match number.is_nan() {
            true => format!("\"{name}\":null"),
            false => format!("\"{name}\":{number:?}"),
        })
    });
    format!("{{{}}}", there.collect::<Vec<_>>().join(","))
}

/// A sample of which one number is missing is missing as a whole.
fn bits(sample: &LiveSample) -> [Option<u64>; 4] {
    let numbers = numbers(sample);
    let is_missing = numbers
        .iter()
        .any(|(_, number)| number.is_some_and(f64::is_nan));
    numbers.map(|(_, number)| number.map(|number| if is_missing { 0 } else { number.to_bits() }))
}
