//! A journal: a file of JSON lines that grows while a long job runs, so that a job that was stopped can continue.
//!
//! The first line states the request, each further line one finished part.

use std::fs::{File, TryLockError};
use std::io::{self, BufRead, BufReader, Read, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::Serialize;

use crate::file::{LONGEST, Store};
use crate::refusal::Refusal;

/// An open journal, locked against other processes.
#[derive(Debug)]
pub struct Journal(Mutex<Lines<File>>);

/// The file of a journal.
#[derive(Debug)]
struct Lines<F> {
    path: PathBuf,
    file: F,
    /// The length of its whole lines, bytes.
    whole: u64,
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
        let read = (&mut file).take(LONGEST).read_until(b'\n', &mut bytes);
        let read = read.map_err(failed("read", path))?;
        let in_line = |refusal: Refusal| refusal.at(number).in_file(path.display().to_string());
        let Some((b'\n', text)) = bytes.split_last() else {
            let long = Refusal::state("this line does not end", "delete the file, or give another");
            in_line(long).when(read as u64 == LONGEST)?;
            break;
        };
        let text = std::str::from_utf8(text);
        let text = text.map_err(|_| in_line(Refusal::state("this line is not UTF-8", "")))?;
        take(text).map_err(in_line)?;
        length += bytes.len() as u64;
    }
    Ok(length)
}

impl Journal {
    /// Opens the journal of `request` at `path`, or creates it, and passes each whole line after the first to `take`. The first line of
    /// every journal of this kind begins as the request does up to its first comma: with its schema. A second process that opens the
    /// journal is told that `command` writes it.
    ///
    /// # Errors
    /// The file belongs to another request of which a part is finished, or is not such a journal; another process writes it; or `take`
    /// refuses a line.
    ///
    /// Implements: CLI-156, CLI-157.
    pub fn open(
        path: PathBuf,
        request: &impl Serialize,
        command: &str,
        take: impl FnMut(&str) -> Result<(), Refusal>,
    ) -> Result<Journal, Refusal> {
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let file = options.open(&path).map_err(failed("open", &path))?;
        // A pipe would be read for ever.
        if !file.metadata().map_err(failed("open", &path))?.is_file() {
            return Err(no_journal(command).in_file(path.display().to_string()));
        }
        let lines = Lines::open(file, path, &line(request), command, take)?;
        Ok(Journal(Mutex::new(lines)))
    }

    /// Appends one finished part as one line, which is on the disk when this returns.
    ///
    /// # Errors
    /// The file cannot be written; what is there of the line is cut off by whoever appends or opens next.
    ///
    /// Implements: CLI-156.
    pub fn append(&self, part: &impl Serialize) -> Result<(), Refusal> {
        let line = line(part);
        let mut lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        lines.append(&line)
    }

    /// Removes the file.
    ///
    /// # Errors
    /// The system does not allow it.
    pub fn remove(self) -> Result<(), Refusal> {
        let lines = self.0.into_inner().unwrap_or_else(PoisonError::into_inner);
        std::fs::remove_file(&lines.path).map_err(failed("remove", &lines.path))
    }
}

fn no_journal(command: &str) -> Refusal {
    Refusal::state(
        format_args!("is no journal of '{command}'"),
        "choose another file",
    )
}

impl<F: Store> Lines<F> {
    /// Takes the lines of a file, as [`Journal::open`], and cuts off what is behind them.
    fn open(
        mut file: F,
        path: PathBuf,
        request: &str,
        command: &str,
        take: impl FnMut(&str) -> Result<(), Refusal>,
    ) -> Result<Lines<F>, Refusal> {
        let refused = |found| Refusal::state(found, "").in_file(path.display().to_string());
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            let found = format!("another '{command}' is writing this file; wait until it ends");
            return Err(refused(found));
        }
        let mut reader = BufReader::new(&mut file);
        let mut first = Vec::new();
        // A longer line is not the request.
        let most = 1 + request.len() as u64;
        let read = (&mut reader).take(most).read_until(b'\n', &mut first);
        read.map_err(failed("read", &path))?;
        let mut whole = 0;
        if first == request.as_bytes() {
            whole = take_lines(reader, &path, 2, take)? + first.len() as u64;
        } else if !is_of_kind(&first, request) {
            return Err(no_journal(command).in_file(path.display().to_string()));
        } else {
            if !first.ends_with(b"\n") {
                let rest = reader.skip_until(b'\n');
                rest.map_err(failed("read", &path))?;
            }
            if take_lines(reader, &path, 2, |_| Ok(()))? > 0 {
                let found =
                    "belongs to a different request or version; finish that run or delete the file";
                return Err(refused(found.into()));
            }
        }
        let mut lines = Lines { path, file, whole };
        lines.append(if whole == 0 { request } else { "" })?;
        Ok(lines)
    }

    /// Writes `line` behind the whole lines, over what a write that failed may have left.
    fn append(&mut self, line: &str) -> Result<(), Refusal> {
        let written = put(&mut self.file, self.whole, line);
        written.map_err(failed("write", &self.path))?;
        self.whole += line.len() as u64;
        Ok(())
    }
}

/// Makes a text the end of a file, from byte `at` on; it is on the disk when this returns.
fn put(file: &mut impl Store, at: u64, text: &str) -> io::Result<()> {
    file.set_len(at)?;
    file.seek(SeekFrom::Start(at))?;
    file.write_all(text.as_bytes())?;
    file.sync_data()
}

/// Whether `first` is the first line, or the beginning of the first line, of a journal of the same kind as that of a request.
fn is_of_kind(first: &[u8], request: &str) -> bool {
    let schema = request.split(',').next().unwrap_or(request).as_bytes();
    first.starts_with(schema) || schema.starts_with(first)
}

#[cfg(test)]
mod tests;
