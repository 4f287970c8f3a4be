//! What every reader of palpate must do with any bytes (`spec/verification-plan.md`).
//!
//! | file | the readers of |
//! |---|---|
//! | `phantom.rs` | phantom files |
//! | `config.rs` | the configuration of `palpate run` |
//! | `map.rs` | force maps, JSON and CSV |
//! | `trace.rs` | recorded sweeps, whole and line by line |
//! | `path.rs` | paths of the probe |
//! | `curve.rs` | force–depth curves, and statements of columns |
//! | `counts.rs` | counts of right answers, and the journal of an experiment |
//! | `suite.rs` | vectors |
//! | `oracle.rs` | one line of the oracle |
//! | `hid.rs` | reports of a device, alone and in a pipe, and recordings of a session |
//! | `command_line.rs` | the command line, its lists, and decimal numbers |
//! | `random.rs` | cases without a fuzzer |
//!
//! A target takes bytes, panics where a property does not hold, and else tells whether the bytes
//! were accepted, so that a test can see that both answers occur.

// Under a fuzzer every test of the package is built, this one too, and does not link without it.
#[cfg(test)]
use bolero as _;

pub mod command_line;
pub mod config;
pub mod counts;
pub mod curve;
pub mod hid;
pub mod map;
mod message;
pub mod oracle;
pub mod path;
pub mod phantom;
pub mod random;
pub mod suite;
pub mod trace;

/// What a reader did with some bytes; each of the two must occur in a run of a target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It took them.
    Accepted,
    /// It said what is wrong with them.
    Refused,
}

/// What a reader must do with any bytes.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// The name of its test, and of the archive of its corpus.
    pub name: &'static str,
    property: Property,
}

/// Panics where it does not hold.
#[derive(Debug, Clone, Copy)]
enum Property {
    OfBytes(fn(&[u8]) -> Outcome),
    /// A file that is not UTF-8 is refused before any reader sees it.
    OfText(fn(&str) -> Outcome),
}
use Property::{OfBytes, OfText};

/// All targets.
pub const TARGETS: &[Target] = &[
    Target::new("phantom_toml", OfText(phantom::phantom_toml)),
    Target::new("config_toml", OfText(config::config_toml)),
    Target::new("map_json", OfText(map::map_json)),
    Target::new("map_csv", OfText(map::map_csv)),
    Target::new("trace_csv", OfText(trace::trace_csv)),
    Target::new("live_lines", OfText(trace::live_lines)),
    Target::new("path_csv", OfText(path::path_csv)),
    Target::new("curve_csv", OfText(curve::curve_csv)),
    Target::new("counts_csv", OfText(counts::counts_csv)),
    Target::new("journal", OfText(counts::journal)),
    Target::new("vectors", OfText(suite::vectors)),
    Target::new("oracle_line", OfBytes(oracle::oracle_line)),
    Target::new("hid_report", OfBytes(hid::hid_report)),
    Target::new("pipe_reports", OfBytes(hid::pipe_reports)),
    Target::new("recording", OfText(hid::recording)),
    Target::new("list", OfText(command_line::list)),
    Target::new("decimal", OfBytes(command_line::decimal)),
    Target::new("command_line", OfText(command_line::command_line)),
];

impl Target {
    const fn new(name: &'static str, property: Property) -> Target {
        Target { name, property }
    }

    /// What the reader does with some bytes.
    ///
    /// # Panics
    /// Where the property does not hold.
    pub fn check(&self, bytes: &[u8]) -> Outcome {
        match self.property {
            OfBytes(check) => check(bytes),
            OfText(check) => std::str::from_utf8(bytes).map_or(Outcome::Refused, check),
        }
    }
}

/// What a reader did, with a check of what it accepted or of what it says.
fn judged<T, E>(read: Result<T, E>, accepted: impl FnOnce(T), refused: impl FnOnce(E)) -> Outcome {
    match read {
        Ok(value) => {
            accepted(value);
            Outcome::Accepted
        }
        Err(error) => {
            refused(error);
            Outcome::Refused
        }
    }
}

/// The name under which texts are read, to be found in every message.
const FILE: &str = "fuzz.txt";
