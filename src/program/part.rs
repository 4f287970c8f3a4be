//! What is finished of a long computation, in a file that grows by a line with each part of it, so that one that was stopped goes on.
//!
//! The first line is what was asked for, each other one a part.

use std::fs::{File, TryLockError};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::Serialize;

use super::CliError;
use palpate::refusal::Refusal;

/// The open file.
#[derive(Debug)]
pub struct Part {
    path: PathBuf,
    file: Mutex<File>,
}

/// A line of JSON.
fn line(document: &impl Serialize) -> String {
    // Keys are strings and a string takes all that is written: nothing here can fail.
    serde_json::to_string(document).unwrap_or_default() + "\n"
}

/// Hands the lines of a file, from where it is read and without their ends, to `take` with their numbers from `first`, but for a last one
/// that was cut off; how many bytes the whole lines have.
///
/// # Errors
/// A file that cannot be read, a line that is no text, and what `take` refuses; with the file and the line.
pub fn take_lines(
    mut file: impl BufRead,
    path: &Path,
    first: usize,
    mut take: impl FnMut(&str) -> Result<(), Refusal>,
) -> Result<u64, CliError> {
    let (mut length, mut bytes) = (0, Vec::new());
    for number in first.. {
        bytes.clear();
        let read = file.read_until(b'\n', &mut bytes);
        read.map_err(CliError::file("read", path))?;
        let Some((b'\n', text)) = bytes.split_last() else {
            break;
        };
        let in_line = |refusal: Refusal| refusal.at(number).in_file(path.display().to_string());
        let text = std::str::from_utf8(text);
        let text = text.map_err(|_| in_line(Refusal::state("no UTF-8", "a line of JSON")))?;
        take(text).map_err(in_line)?;
        length += bytes.len() as u64;
    }
    Ok(length)
}

impl Part {
    /// Opens the file at `path`, or begins it, for a `request` whose line begins with `beginning`; hands each whole line after the first
    /// to `take`. `command` is named to a second one that would write the file.
    ///
    /// # Errors
    /// A file of another request, of which something is finished, or of something else; one that another process writes; what `take`
    /// refuses.
    ///
    /// Implements: CLI-156, CLI-157.
    pub fn open(
        path: PathBuf,
        request: &impl Serialize,
        beginning: &str,
        command: &str,
        take: impl FnMut(&str) -> Result<(), Refusal>,
    ) -> Result<Part, CliError> {
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(CliError::file("open", &path))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            let reason = format!("another '{command}' is at work on it, expected one at a time");
            return Err(CliError::refused(path.display())(reason));
        }
        let request = line(request);
        let mut reader = BufReader::new(&file);
        let mut first = Vec::new();
        let read = reader.read_until(b'\n', &mut first);
        read.map_err(CliError::file("read", &path))?;
        let mut length = 0;
        if first == request.as_bytes() {
            length = take_lines(reader, &path, 2, take)? + first.len() as u64;
        } else if !is_only_begun(&first, beginning) || has_line(reader) {
            let reason = "of another request or version, expected this one: finish that one, or delete the file";
            return Err(CliError::refused(path.display())(reason));
        }
        let begun = file.set_len(length);
        let begun = begun.and_then(|()| file.seek(SeekFrom::End(0)));
        let begun = begun.and_then(|_| match length {
            0 => file.write_all(request.as_bytes()),
            _ => Ok(()),
        });
        begun.map_err(CliError::file("write", &path))?;
        let file = Mutex::new(file);
        Ok(Part { path, file })
    }

    /// Notes a part in one piece; it is on the disk when this returns.
    ///
    /// # Errors
    /// A file that cannot be written; then no part of the line stays.
    ///
    /// Implements: CLI-156.
    pub fn append(&self, part: &impl Serialize) -> Result<(), CliError> {
        let line = line(part);
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let mut write = || {
            let before = file.stream_position()?;
            let written = file
                .write_all(line.as_bytes())
                .and_then(|()| file.sync_data());
            written.inspect_err(|_| {
                // What failed first is told.
                let _ = file.set_len(before);
            })
        };
        write().map_err(CliError::file("write", &self.path))
    }

    /// Removes the file.
    ///
    /// # Errors
    /// If the system does not let it.
    pub fn remove(self) -> Result<(), CliError> {
        std::fs::remove_file(&self.path).map_err(CliError::file("remove", &self.path))
    }
}

/// Whether a file whose first line is this, or the beginning of it, is one of ours.
fn is_only_begun(first: &[u8], beginning: &str) -> bool {
    first.starts_with(beginning.as_bytes()) || beginning.as_bytes().starts_with(first)
}

/// Whether a whole line follows.
fn has_line(mut reader: impl BufRead) -> bool {
    let mut bytes = Vec::new();
    let read = reader.read_until(b'\n', &mut bytes);
    read.is_err() || bytes.ends_with(b"\n")
}
