//! The list of known mistakes.

use std::path::Path;

use super::suite::{Invalid, Suite};

/// A case that may be wrong, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Accepted {
    /// The case.
    pub case: String,
    /// The reason.
    pub reason: String,
}

/// Reads a list: a case and its reason a line; empty lines and what begins with # are passed over.
///
/// # Errors
/// A file that cannot be read; a line without a reason, of a case that does not exist, or of one that stands there twice.
///
/// Implements: ORA-067.
pub fn read_accepted(path: &Path, suite: &Suite) -> Result<Vec<Accepted>, Invalid> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Invalid::new(path.display(), error.to_string()))?;
    let mut list: Vec<Accepted> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let wrong = |message: String| Invalid::new(format!("{}:{number}", path.display()), message);
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let (case, reason) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if reason.is_empty() {
            return Err(wrong(format!(
                "{case} has no reason, expected a case and its reason"
            )));
        }
        if !suite.has(case) {
            return Err(wrong(format!("no case {case:?} in these vectors")));
        }
        if list.iter().any(|accepted| accepted.case == case) {
            return Err(wrong(format!("{case} stands here twice")));
        }
        let (case, reason) = (case.to_string(), reason.trim().to_string());
        list.push(Accepted { case, reason });
    }
    Ok(list)
}
