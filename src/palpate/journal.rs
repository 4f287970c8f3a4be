//! A journal: a file of JSON lines that grows while a long job runs, so that a job that was stopped can continue.
//!
//! The first line states the request, each further line one finished part.

use std::fs::{File, TryLockError};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::Serialize;

use crate::refusal::Refusal;

/// An open journal, locked against other processes.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Mutex<File>,
}

/// The system did not let a file be opened, read, written or removed.
fn failed(action: &str, path: &Path) -> impl FnOnce(io::Error) -> Refusal {
    Refusal::because(format!("{action} {}", path.display()))
}

/// A line of JSON.
pub(crate) fn line(document: &impl Serialize) -> String {
    // Keys are strings and a string takes all that is written: nothing here can fail.
    serde_json::to_string(document).unwrap_or_default() + "\n"
}

/// Passes each line of `file` to `take`, without its end. A last line that was cut off is left out. The first line has the number
/// `first`. Returns the number of bytes of the whole lines.
///
/// # Errors
/// The file cannot be read, a line is not UTF-8, or `take` refuses a line; the error names the file and the line.
pub fn take_lines(
    mut file: impl BufRead,
    path: &Path,
    first: usize,
    mut take: impl FnMut(&str) -> Result<(), Refusal>,
) -> Result<u64, Refusal> {
    let (mut length, mut bytes) = (0, Vec::new());
    for number in first.. {
        bytes.clear();
        let read = file.read_until(b'\n', &mut bytes);
        read.map_err(failed("read", path))?;
        let Some((b'\n', text)) = bytes.split_last() else {
            break;
        };
        let in_line = |refusal: Refusal| refusal.at(number).in_file(path.display().to_string());
        let text = std::str::from_utf8(text);
        let text = text.map_err(|_| in_line(Refusal::state("this line is not UTF-8", "")))?;
        take(text).map_err(in_line)?;
        length += bytes.len() as u64;
    }
    Ok(length)
}

impl Journal {
    /// Opens the journal of `request` at `path`, or creates it, and passes each whole line after the first to `take`. The first line of
    /// every journal of this kind begins with `beginning`. A second process that opens the journal is told that `command` writes it.
    ///
    /// # Errors
    /// The file belongs to another request of which a part is finished, or is not such a journal; another process writes it; or `take`
    /// refuses a line.
    ///
    /// Implements: CLI-156, CLI-157.
    pub fn open(
        path: PathBuf,
        request: &impl Serialize,
        beginning: &str,
        command: &str,
        take: impl FnMut(&str) -> Result<(), Refusal>,
    ) -> Result<Journal, Refusal> {
        let refused = |found: String| Refusal::state(found, "").in_file(path.display().to_string());
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(failed("open", &path))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            let found = format!("another '{command}' is writing this file; wait until it ends");
            return Err(refused(found));
        }
        let request = line(request);
        let mut reader = BufReader::new(&file);
        let mut first = Vec::new();
        let read = reader.read_until(b'\n', &mut first);
        read.map_err(failed("read", &path))?;
        let mut length = 0;
        if first == request.as_bytes() {
            length = take_lines(reader, &path, 2, take)? + first.len() as u64;
        } else if !is_only_begun(&first, beginning) || has_line(reader) {
            let found =
                "belongs to a different request or version; finish that run or delete the file";
            return Err(refused(found.into()));
        }
        let begun = file.set_len(length);
        let begun = begun.and_then(|()| file.seek(SeekFrom::End(0)));
        let begun = begun.and_then(|_| match length {
            0 => file.write_all(request.as_bytes()),
            _ => Ok(()),
        });
        begun.map_err(failed("write", &path))?;
        let file = Mutex::new(file);
        Ok(Journal { path, file })
    }

    /// Appends one finished part as one line, which is on the disk when this returns.
    ///
    /// # Errors
    /// The file cannot be written; then nothing of the line stays in it.
    ///
    /// Implements: CLI-156.
    pub fn append(&self, part: &impl Serialize) -> Result<(), Refusal> {
        let line = line(part);
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let mut write = || {
            let before = file.stream_position()?;
            let written = file
                .write_all(line.as_bytes())
                .and_then(|()| file.sync_data());
            written.inspect_err(|_| {
                // The first error is the one to report.
                let _ = file.set_len(before);
            })
        };
        write().map_err(failed("write", &self.path))
    }

    /// Removes the file.
    ///
    /// # Errors
    /// The system does not allow it.
    pub fn remove(self) -> Result<(), Refusal> {
        std::fs::remove_file(&self.path).map_err(failed("remove", &self.path))
    }
}

/// Whether `first` is the first line, or the beginning of the first line, of a journal of this kind.
fn is_only_begun(first: &[u8], beginning: &str) -> bool {
    first.starts_with(beginning.as_bytes()) || beginning.as_bytes().starts_with(first)
}

/// Whether a whole line follows.
fn has_line(mut reader: impl BufRead) -> bool {
    let mut bytes = Vec::new();
    let read = reader.read_until(b'\n', &mut bytes);
    read.is_err() || bytes.ends_with(b"\n")
}
