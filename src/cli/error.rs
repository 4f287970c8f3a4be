//! What the program says when it cannot do what it was asked to, and with which exit code.

use crate::fem::FemError;
use crate::psychophysics::PsychophysicsError;
use crate::refusal::{Refusal, one_line};

/// Why a command failed. Its message is one line.
///
/// Implements: CLI-002, CLI-003.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The command line cannot be understood.
    #[error("{0}")]
    Usage(String),
    /// A phantom, a force map, a trace or a table of answers is not valid, or they do not fit one another.
    #[error("{0}")]
    Refused(#[from] Refusal),
    /// Counts and maps do not fit.
    #[error("{0}")]
    Psychophysics(#[from] PsychophysicsError),
    /// A map can not be played, or a device not be used.
    #[error("{0}")]
    Playback(String),
    /// A check of the statistics battery failed.
    #[error("{0}")]
    Check(String),
    /// The solver refused the phantom, the mesh or a pose, or failed.
    #[error("phantom {phantom}: {error}")]
    Fem {
        /// Which phantom.
        phantom: String,
        /// What was wrong.
        error: FemError,
    },
    /// The report refused the study.
    #[error("report: {0}")]
    Report(Refusal),
    /// A file could not be written or read.
    #[error("{action} {path}: {error}")]
    File {
        /// `read` or `write`.
        action: &'static str,
        /// Which file.
        path: String,
        /// What the system said.
        error: std::io::Error,
    },
    /// Standard output could not be written.
    #[error("standard output: {0}")]
    Output(std::io::Error),
}

impl CliError {
    /// The first line of what the argument parser has to say.
    pub(crate) fn usage(error: &clap::Error) -> CliError {
        let text = error.to_string();
        // The parser spreads its message over several lines; usage and hints follow an empty one.
        let line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let mut parts = text.split("\n\n").map(line);
        let message = parts.next().unwrap_or_default();
        // What was probably meant, in the words of the parser.
        let tip = parts.find(|part| part.starts_with("tip: a similar"));
        let tip = tip.map_or(String::new(), |tip| format!(" ({tip})"));
        let message = message.strip_prefix("error: ").unwrap_or(&message);
        if error.kind() == clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
            return CliError::Usage("no command; try 'palpate run' or 'palpate --help'".into());
        }
        // The parser quotes the arguments, without their escape sequences but not without the rest.
        CliError::Usage(one_line(&format!("{message}{tip}; see --help")))
    }

    /// 1 where a computation failed, 2 where the input is to blame.
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::Fem {
                error:
                    FemError::NoConvergence { .. } | FemError::Residual { .. } | FemError::OutOfMemory,
                ..
            } => 1,
            CliError::Report(_) | CliError::Output(_) | CliError::Check(_) => 1,
            _ => 2,
        }
    }
}
