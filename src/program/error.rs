//! The errors of the program and their exit codes.

use std::fmt::{self, Display};
use std::io;
use std::path::Path;

use palpate::fem::FemError;
use palpate::refusal::{Refusal, one_line};

/// Why a command failed. Its message is one line.
///
/// Implements: CLI-002, CLI-003.
#[derive(Debug)]
pub enum CliError {
    /// The command line, a file or a device is to blame.
    Usage(String),
    /// A phantom, a force map, a trace or a table of answers is not valid, or they do not belong together.
    Refused(Refusal),
    /// A computation or a check failed.
    Check(String),
    /// A record cannot be judged.
    Unjudged(String),
    /// Forces were written that mean nothing.
    Meaningless(String),
}

/// Returns that the command line, a file or a device is to blame, in the words of a `format!`.
macro_rules! refuse {
    ($($words:tt)*) => {
        return Err($crate::CliError::Usage(format!($($words)*)))
    };
}
pub(crate) use refuse;

impl Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CliError::Usage(message)
            | CliError::Check(message)
            | CliError::Unjudged(message)
            | CliError::Meaningless(message) => f.write_str(&one_line(message)),
            CliError::Refused(refusal) => refusal.fmt(f),
        }
    }
}

impl From<Refusal> for CliError {
    fn from(refusal: Refusal) -> CliError {
        CliError::Refused(refusal)
    }
}

impl CliError {
    /// `what` is to blame, for a reason.
    pub(super) fn refused<E: Display>(what: impl Display) -> impl FnOnce(E) -> CliError {
        move |reason| CliError::Usage(format!("{what}: {reason}"))
    }

    /// The system refused to read, write or make a file.
    pub(super) fn file(action: &str, path: &Path) -> impl FnOnce(io::Error) -> CliError {
        CliError::refused(format!("{action} {}", path.display()))
    }

    /// The solver refused a phantom, the mesh or a pose, or failed.
    pub(super) fn fem(phantom: &str) -> impl Fn(FemError) -> CliError {
        use FemError::{NoConvergence, OutOfMemory, Residual};
        move |error| {
            let message = format!("phantom {phantom}: {error}");
            match error {
                NoConvergence { .. } | Residual { .. } | OutOfMemory => CliError::Check(message),
                _ => CliError::Usage(message),
            }
        }
    }

    /// The first line of the argument parser's message.
    pub(crate) fn usage(error: &clap::Error) -> CliError {
        let text = error.to_string();
        // The parser spreads its message over several lines; usage and hints follow an empty one.
        let line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let mut parts = text.split("\n\n").map(line);
        let message = parts.next().unwrap_or_default();
        // The suggestion of the parser.
        let tip = parts.find(|part| part.starts_with("tip: a similar"));
        let tip = tip.map_or(String::new(), |tip| format!(" ({tip})"));
        let message = message.strip_prefix("error: ").unwrap_or(&message);
        if error.kind() == clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
            let usage = text.split("Usage: ").nth(1).unwrap_or_default();
            let command = usage.split(['<', '[']).next().unwrap_or_default().trim();
            return CliError::Usage(format!("no command; try '{command} --help'"));
        }
        CliError::Usage(format!("{message}{tip}; see --help"))
    }

    /// 1 if a computation failed, 2 if the input is to blame, 3 if a record cannot be judged, 4 if forces mean nothing.
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::Check(_) => 1,
            CliError::Usage(_) | CliError::Refused(_) => 2,
            CliError::Unjudged(_) => 3,
            CliError::Meaningless(_) => 4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: CLI-002.
    #[test]
    fn a_message_is_one_line_whatever_it_quotes() {
        let error = CliError::file("read", Path::new("a\nb.csv"))(io::ErrorKind::NotFound.into());
        assert_eq!(error.to_string(), "read a b.csv: entity not found");
    }
}
