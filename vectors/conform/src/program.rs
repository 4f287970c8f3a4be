//! The identity of the program that is judged.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::suite::sha256;

/// A file of the program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ProgramFile {
    /// Its name, as it was given.
    pub name: String,
    /// The SHA-256 of its contents.
    pub sha256: String,
}

/// The program that gave the answers.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Program {
    /// The program and its arguments; empty if the answers were read from a file.
    pub command: Vec<String>,
    /// What it calls its version.
    pub version: String,
    /// The files of the command, or the file of answers.
    pub files: Vec<ProgramFile>,
}

impl Program {
    /// A command that was run: its program, wherever the search path finds it, and those of its arguments that are files.
    ///
    /// Implements: ORA-048.
    pub fn of_command(command: &[OsString], version: String) -> Program {
        let text = |word: &OsString| word.to_string_lossy().into_owned();
        let file_of = |(index, word): (usize, &OsString)| match index {
            0 => file(text(word), &found(Path::new(word))),
            _ => file(text(word), Path::new(word)),
        };
        Program {
            command: command.iter().map(text).collect(),
            version,
            files: command.iter().enumerate().filter_map(file_of).collect(),
        }
    }

    /// Answers that were read from a file.
    pub(super) fn of_answers(answers: &Path, version: String) -> Program {
        let files = file(answers.display().to_string(), answers);
        Program {
            command: Vec::new(),
            version,
            files: files.into_iter().collect(),
        }
    }
}

/// The program that a name without a folder stands for.
fn found(program: &Path) -> PathBuf {
    let is_name = program.components().count() == 1;
    let folders = std::env::var_os("PATH").filter(|_| is_name);
    let folders = folders.iter().flat_map(std::env::split_paths);
    let mut candidates = folders.map(|folder| folder.join(program));
    candidates
        .find(|candidate| is_program(candidate))
        .unwrap_or_else(|| program.into())
}

/// Whether the system runs a file; it goes on to the next folder where it does not.
fn is_program(path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let of = path.metadata();
        of.is_ok_and(|of| of.is_file() && of.permissions().mode() & 0o111 != 0)
    }
    #[cfg(not(unix))]
    path.is_file()
}

/// A file with its SHA-256, if it can be read.
fn file(name: String, path: &Path) -> Option<ProgramFile> {
    // Not a device, which may have no end.
    let bytes = path.is_file().then(|| std::fs::read(path).ok())??;
    let sha256 = sha256(bytes);
    Some(ProgramFile { name, sha256 })
}
