//! What every reader of palpate must do with any bytes (`spec/fuzzing.md`).
//!
//! | file | the readers of |
//! |---|---|
//! | `phantom.rs` | phantom files |
//! | `config.rs` | the configuration of `palpate run` |
//! | `map.rs` | force maps, JSON and CSV |
//! | `trace.rs` | recorded sweeps |
//! | `counts.rs` | counts of right answers, and the journal of an experiment |
//! | `suite.rs` | vectors |
//! | `oracle.rs` | one line of the oracle |
//! | `hid.rs` | reports of a device, and recordings of a session |
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
pub mod hid;
pub mod map;
mod message;
pub mod oracle;
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
    /// Panics where the property does not hold.
    pub check: fn(&[u8]) -> Outcome,
}

macro_rules! targets {
    ($($module:ident::$name:ident),* $(,)?) => {
        /// All targets.
        ///
        /// Implements: EVD-080.
        pub const TARGETS: &[Target] = &[$(Target {
            name: stringify!($name),
            check: $module::$name,
        }),*];
    };
}
targets!(
    phantom::phantom_toml,
    config::config_toml,
    map::map_json,
    map::map_csv,
    trace::trace_csv,
    counts::counts_csv,
    counts::journal,
    suite::vectors,
    oracle::oracle_line,
    hid::hid_report,
    hid::recording,
    command_line::list,
    command_line::decimal,
    command_line::command_line,
);

/// The name under which texts are read, to be found in every message.
const FILE: &str = "fuzz.txt";

/// The text that a file with these bytes is read as; a file that is not UTF-8 is refused before any
/// reader sees it.
fn text(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes).ok()
}
