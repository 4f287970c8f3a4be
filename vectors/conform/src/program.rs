//! Which program it is that is judged.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::suite::sha256;
use super::verdict::{Program, ProgramFile};

impl Program {
    /// A command that was run: its program, wherever the search path finds it, and those of its arguments that are files.
    ///
    /// Implements: ORA-048.
    pub fn of_command(command: &[OsString], version: String) -> Program {
        let files = command.iter().enumerate().filter_map(|(index, word)| {
            let path = if index == 0 {
                found(Path::new(word))
            } else {
                word.into()
            };
            Some(ProgramFile {
                name: word.to_string_lossy().into_owned(),
                sha256: sum(&path)?,
            })
        });
        Program {
            files: files.collect(),
            command: command
                .iter()
                .map(|word| word.to_string_lossy().into_owned())
                .collect(),
            version,
        }
    }

    /// Answers that were read from a file.
    pub fn of_answers(answers: &Path, version: String) -> Program {
        let name = answers.display().to_string();
        let file = sum(answers).map(|sha256| ProgramFile { name, sha256 });
        Program {
            command: Vec::new(),
            version,
            files: file.into_iter().collect(),
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
        .find(|candidate| candidate.is_file())
        .unwrap_or_else(|| program.into())
}

/// The SHA-256 of a file, if it is one that can be read.
fn sum(path: &Path) -> Option<String> {
    if !path.is_file() {
        return None;
    }
    std::fs::read(path).ok().map(sha256)
}
