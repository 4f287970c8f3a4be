//! Paths of the probe.

use palpate::refusal::Refusal;
use palpate::simulation::Path;

use crate::map::check_csv;
use crate::message::check_file_message;
use crate::{FILE, Outcome, judged};

/// An accepted path has between one sample and a million, whose times do not decrease, at finite places within its extent; a refusal
/// quotes what stands in the line that it names.
pub fn path_csv(text: &str) -> Outcome {
    let refused = |error: Refusal| match error.line {
        Some(_) => check_csv(&error, text),
        None => check_file_message(&error, text),
    };
    judged(Path::from_csv(text, FILE, 10.0), check_path, refused)
}

fn check_path(path: Path) {
    let times = path.samples();
    assert!((1..=1_000_000).contains(&times.len()));
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]));
    let ([low, high], deepest) = path.extent();
    let sweep = path.sweep().expect("a path has samples at finite places");
    let is_within = |x: &f64| (low..=high).contains(x);
    assert!(sweep.positions().iter().all(is_within), "{low} to {high}");
    let depths = sweep.depths().expect("the depths of a path");
    assert!(depths.iter().all(|depth| *depth <= deepest), "{deepest}");
}
