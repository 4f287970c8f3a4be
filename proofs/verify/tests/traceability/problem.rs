//! What is wrong, and where.

use std::fmt;

/// A fault of the chapters, of the sources or of the trace.
///
/// Implements: EVD-025.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    file: String,
    line: usize,
    message: String,
}

impl Problem {
    pub fn new(file: &str, line: usize, message: impl Into<String>) -> Problem {
        let (file, message) = (file.into(), message.into());
        Problem {
            file,
            line,
            message,
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "{}:{}: {}", self.file, self.line, self.message)
    }
}

/// All of them, one a line.
pub fn listed(problems: &[Problem]) -> String {
    let lines = problems.iter().map(|problem| format!("\n{problem}"));
    lines.collect()
}
