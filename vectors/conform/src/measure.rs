//! How a program is judged: its precision, what is required of it, and its known mistakes.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::outcome::Class;
use super::profile::Profile;
use super::suite::Suite;
use super::text::{Invalid, ensure, read};

/// The condition for a program to pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Require {
    /// Every answer is right
    Right,
    /// No answer is wrong
    Acceptable,
    /// No answer is wrong in mathematics or range, and each that must hold values does
    Range,
    /// No answer is wrong in mathematics, and each that must hold values does, or is a refusal
    Mathematics,
}

impl Require {
    /// Whether an answer of this class is permitted; of no class if the answer is acceptable.
    ///
    /// Implements: ORA-067.
    pub(super) fn permits(self, class: Option<Class>) -> bool {
        match class {
            None => self >= Require::Acceptable,
            Some(Class::Protocol) => self >= Require::Range,
            Some(Class::Range) => self >= Require::Mathematics,
            Some(Class::Mathematics) => false,
        }
    }
}

/// How a program is judged.
#[derive(Debug, Clone, PartialEq, Serialize, clap::Args)]
pub struct Measure {
    /// Working precision: exact, f64, f32, or a JSON file
    #[arg(long, value_name = "NAME", value_parser = Profile::named, default_value = "exact")]
    pub profile: Profile,
    /// Also counts the cases at the limit of the precision
    #[arg(long)]
    #[serde(rename = "extreme_counts")]
    pub extreme: bool,
    /// Condition for exit code 0
    #[arg(long, value_enum, default_value_t = Require::Right)]
    pub require: Require,
    /// The cases with known mistakes, and the reason of each.
    #[arg(skip)]
    #[serde(skip)]
    pub accepted: BTreeMap<String, String>,
    /// Whether groups or cases were chosen by name: each of their ops must be asked.
    #[arg(skip)]
    #[serde(skip)]
    pub named: bool,
}

impl Measure {
    /// The stated tolerances, and only right answers pass.
    pub fn exact() -> Measure {
        Measure {
            profile: Profile::exact(),
            extreme: false,
            require: Require::Right,
            accepted: BTreeMap::new(),
            named: false,
        }
    }
}

/// Reads a list of known mistakes: a case and its reason per line; empty lines and lines that begin with # are ignored.
///
/// # Errors
/// A file that cannot be read; a line without a reason, with a case that does not exist, or with one that is listed already.
///
/// Implements: ORA-067.
pub fn read_accepted(path: &Path, suite: &Suite) -> Result<BTreeMap<String, String>, Invalid> {
    let text = read(path)?;
    let mut list = BTreeMap::new();
    let mut add = |line: &str| {
        let (case, reason) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        ensure!(!reason.is_empty(), "{case} has no reason after it");
        ensure!(suite.has(case), "no case {case:?} in these vectors");
        let earlier = list.insert(case.to_string(), reason.trim().to_string());
        ensure!(earlier.is_none(), "{case} is listed twice");
        Ok(())
    };
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        if !line.is_empty() && !line.starts_with('#') {
            add(line)
                .map_err(|message| Invalid::new(format!("{}:{number}", path.display()), message))?;
        }
    }
    Ok(list)
}
