//! Standard output and files.

use std::borrow::Cow;
use std::fmt::Display;
use std::fs::File;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use anstream::{AutoStream, ColorChoice};
use anstyle::AnsiColor;
use clap::ValueEnum;
use serde::Serialize;
use serde_json::Value;

use super::CliError;
use super::platform::is_closed_pipe;
use palpate::refusal::one_line;

/// The format of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    Table,
    /// For programs; keys carry the unit.
    Json,
    /// For spreadsheets: a line for each value, its key and itself.
    Csv,
}

impl Format {
    /// Prints an answer; `table` makes the text for people.
    pub(super) fn print(
        self,
        answer: &impl Serialize,
        table: impl FnOnce() -> String,
    ) -> Result<(), CliError> {
        print(&self.text(answer, table))
    }

    /// An answer as text; `table` makes that for people.
    pub(super) fn text(self, answer: &impl Serialize, table: impl FnOnce() -> String) -> String {
        match self {
            Format::Table => table(),
            // Keys are strings, and nothing else could fail.
            Format::Json => serde_json::to_string_pretty(answer).unwrap_or_default() + "\n",
            Format::Csv => {
                let mut lines = "key,value\n".to_string();
                let answer = serde_json::to_value(answer).unwrap_or_default();
                add_lines("", &answer, &mut lines);
                lines
            }
        }
    }
}

/// Adds a line for each value of an answer; `key` leads to it.
///
/// Implements: CLI-226.
fn add_lines(key: &str, value: &Value, lines: &mut String) {
    match value {
        Value::Object(parts) => parts.iter().for_each(|(name, value)| {
            let point = if key.is_empty() { "" } else { "." };
            add_lines(&format!("{key}{point}{name}"), value, lines);
        }),
        Value::Array(parts) => parts
            .iter()
            .enumerate()
            .for_each(|(at, value)| add_lines(&format!("{key}[{at}]"), value, lines)),
        Value::Null => *lines += &format!("{},\n", quoted(key)),
        Value::String(text) => *lines += &format!("{},{}\n", quoted(key), quoted(text)),
        number => *lines += &format!("{},{number}\n", quoted(key)),
    }
}

/// A field of CSV, in quotes where it needs them.
pub(super) fn quoted(field: &str) -> Cow<'_, str> {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\"")).into()
    } else {
        field.into()
    }
}

/// An answer or a request in JSON, with the name and version of its keys before it.
#[derive(Debug, Serialize)]
pub struct Envelope<A> {
    schema: &'static str,
    schema_version: u32,
    program_version: &'static str,
    #[serde(flatten)]
    answer: A,
}

impl<A> Envelope<A> {
    /// This version's `answer`, an object.
    pub fn new(schema: &'static str, schema_version: u32, answer: A) -> Envelope<A> {
        let program_version = env!("CARGO_PKG_VERSION");
        Envelope {
            schema,
            schema_version,
            program_version,
            answer,
        }
    }
}

/// Prints text; a reader that closes the pipe (`| head`) is no error.
///
/// Implements: CLI-003, CLI-007.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// How it went to write to standard output; a reader that closes the pipe is no error.
pub(super) fn printed(written: std::io::Result<()>) -> Result<(), CliError> {
    match written {
        Err(error) if !is_closed_pipe(&error) => {
            Err(CliError::Check(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Whether notes and progress are left out.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Leaves out notes and progress from now on, if `quiet`.
///
/// Implements: CLI-224.
pub(super) fn be_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Whether progress is shown: on a terminal, if nobody asked for quiet.
///
/// Implements: CLI-006, CLI-224.
pub(super) fn shows_progress() -> bool {
    !QUIET.load(Ordering::Relaxed) && std::io::stderr().is_terminal()
}

/// Prints a note to standard error.
///
/// Implements: CLI-224.
pub(super) fn tell(text: &str) {
    if !QUIET.load(Ordering::Relaxed) {
        eprintln!("palpate: note: {}", one_line(text));
    }
}

/// Prints a note about a file to standard error.
pub fn note(file: impl Display, text: &str) {
    tell(&format!("{file}: {text}"));
}

/// `text` in colour, if standard output is a terminal that shows it.
///
/// Implements: CLI-225.
pub(super) fn marked(text: &str, color: AnsiColor) -> String {
    let mark = color.on_default().bold();
    // It also asks a Windows console for colours.
    match AutoStream::auto(std::io::stdout()).current_choice() {
        ColorChoice::Never => text.into(),
        _ => format!("{mark}{text}{mark:#}"),
    }
}

/// Prints a warning to standard error.
///
/// Implements: CLI-225.
pub(super) fn warn(text: &str) {
    let marked = AnsiColor::Yellow.on_default().bold();
    anstream::eprintln!("palpate: {marked}warning{marked:#}: {}", one_line(text));
}

/// Writes a file atomically: if the program is stopped, the file is either new and whole or as it was.
///
/// Implements: CLI-005, CLI-007.
pub fn write(path: &Path, text: &str) -> Result<(), CliError> {
    replace(path, text.as_bytes()).map_err(CliError::file("write", path))
}

/// Implements: CLI-005.
fn replace(path: &Path, text: &[u8]) -> std::io::Result<()> {
    let there = match std::fs::metadata(path) {
        Ok(there) => Some(there),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    let target = match &there {
        Some(there) if there.is_file() => path.canonicalize()?,
        Some(_) => return File::options().write(true).open(path)?.write_all(text),
        None => end_of_links(path),
    };
    let folder = target.parent().filter(|folder| *folder != "");
    let folder = folder.unwrap_or(Path::new("."));
    // The error about a missing folder shall not name the temporary file.
    std::fs::metadata(folder)?;
    // The keys of a hash map are random.
    let (name, mut partial) = partial_file(folder, RandomState::new().build_hasher().finish())?;
    let mut written = partial.write_all(text);
    if let Some(there) = there {
        written = written.and_then(|()| partial.set_permissions(there.permissions()));
    }
    let moved = written.and_then(|()| std::fs::rename(&name, target));
    moved.inspect_err(|_| {
        // The error is reported; a file that stays behind is not worth a second message.
        let _ = std::fs::remove_file(&name);
    })
}

/// A new file in `folder`.
///
/// # Errors
/// Something of that name is there, whatever it is.
fn partial_file(folder: &Path, number: u64) -> std::io::Result<(PathBuf, File)> {
    let name = folder.join(format!(".palpate-{number:016x}.partial"));
    File::create_new(&name).map(|file| (name, file))
}

/// The end of a chain of symbolic links to a file that does not exist yet.
fn end_of_links(path: &Path) -> PathBuf {
    let next = std::fs::read_link(path).ok();
    let next = next.map(|next| path.parent().unwrap_or(path).join(next));
    next.map_or(path.into(), |next| end_of_links(&next))
}

/// Reads a text file.
pub fn read(path: &Path) -> Result<String, CliError> {
    palpate::file::text(path).map_err(CliError::file("read", path))
}

/// Makes a folder and those above it.
pub fn make_folder(path: &Path) -> Result<(), CliError> {
    std::fs::create_dir_all(path).map_err(CliError::file("make folder", path))
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    // Verifies: CLI-005.
    #[test]
    fn a_temporary_file_is_new_whatever_was_laid_under_its_name() {
        let folder = std::env::temp_dir().join(format!("palpate-output-{}", std::process::id()));
        make_folder(&folder).unwrap();
        let at = |number: u64| folder.join(format!(".palpate-{number:016x}.partial"));
        // Another's file, a link to a file, and one to what is not there, which a look for the name does not find.
        let [victim, nowhere] = ["victim", "nowhere"].map(|name| folder.join(name));
        std::fs::write(&victim, "untouched").unwrap();
        std::fs::write(at(0), "untouched").unwrap();
        symlink(&victim, at(1)).unwrap();
        symlink(&nowhere, at(2)).unwrap();
        for number in 0..3 {
            let refused = partial_file(&folder, number).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::AlreadyExists, "{number}");
        }
        assert!(!nowhere.exists());
        let (name, mut file) = partial_file(&folder, 3).unwrap();
        file.write_all(b"new").unwrap();
        let read = |path: &Path| std::fs::read_to_string(path).unwrap();
        assert_eq!(
            [read(&victim), read(&at(0)), read(&name)],
            ["untouched", "untouched", "new"]
        );
        std::fs::remove_dir_all(folder).unwrap();
    }
}
