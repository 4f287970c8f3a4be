//! Standard output and files.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::{Error, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use anstream::{AutoStream, ColorChoice};
use anstyle::AnsiColor;
use clap::ValueEnum;
use clap::builder::{PathBufValueParser, TypedValueParser};
use serde::Serialize;
use serde_json::Value;

use super::CliError;
use palpate::fem::arithmetic;
use palpate::file;
use palpate::refusal::one_line;

/// The format of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    Table,
    /// For programs; keys carry the unit.
    Json,
    /// For spreadsheets: a line for each record or pose, or for each value with its key.
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

/// The files of a folder that are wanted, by their names.
pub fn files_in(
    folder: &Path,
    is_wanted: impl Fn(&Path) -> bool,
) -> Result<Vec<PathBuf>, CliError> {
    let entries = folder.read_dir().map_err(CliError::file("read", folder))?;
    let files = entries.map(|entry| Ok(entry?.path()));
    let files = files.collect::<Result<Vec<_>, Error>>();
    let mut files = files.map_err(CliError::file("read", folder))?;
    files.retain(|file| is_wanted(file));
    files.sort();
    Ok(files)
}

/// A field of CSV, in quotes where it needs them.
pub(super) fn quoted(field: &str) -> Cow<'_, str> {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\"")).into()
    } else {
        field.into()
    }
}

/// A line of CSV.
pub fn csv_line(fields: impl IntoIterator<Item = String>) -> String {
    let fields = fields.into_iter().map(|field| quoted(&field).into_owned());
    fields.collect::<Vec<_>>().join(",") + "\n"
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

/// All that the parts of a long job depend on.
#[derive(Debug, Serialize)]
pub struct Job<P> {
    arithmetic: &'static str,
    #[serde(flatten)]
    plan: P,
}

impl<P> Envelope<Job<P>> {
    /// The first line of a job's journal.
    pub fn job(schema: &'static str, plan: P) -> Envelope<Job<P>> {
        let arithmetic = arithmetic();
        Envelope::new(schema, 1, Job { arithmetic, plan })
    }
}

/// Prints text; a reader that closes the pipe (`| head`) is no error.
///
/// Implements: CLI-003, CLI-007.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Whether a write failed because nobody reads the pipe any more.
fn is_closed_pipe(error: &Error) -> bool {
    // Windows has a second error for it, "pipe not connected".
    error.kind() == ErrorKind::BrokenPipe || cfg!(windows) && error.raw_os_error() == Some(233)
}

/// How it went to write to standard output; a reader that closes the pipe is no error.
pub(super) fn printed(written: Result<(), Error>) -> Result<(), CliError> {
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

/// Prints text to standard error, whether or not somebody reads it.
///
/// Implements: CLI-003.
pub(super) fn say(text: impl Display) {
    let _ = write!(std::io::stderr(), "{text}");
}

/// Prints a note to standard error.
///
/// Implements: CLI-224.
pub(super) fn tell(text: &str) {
    if !QUIET.load(Ordering::Relaxed) {
        say(format_args!("palpate: note: {}\n", one_line(text)));
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
    let text = format!("palpate: {marked}warning{marked:#}: {}\n", one_line(text));
    // As in `say`.
    let _ = anstream::stderr().write_all(text.as_bytes());
}

/// Writes a file whole, or leaves it as it was.
///
/// Implements: CLI-005, CLI-007.
pub fn write(path: &Path, text: &str) -> Result<(), CliError> {
    file::write(path, text).map_err(CliError::file("write", path))
}

/// Writes a file whole where none is.
///
/// Implements: CLI-235.
pub fn write_new(path: &Path, text: &str) -> Result<(), CliError> {
    file::write_new(path, text).map_err(CliError::file("write", path))
}

/// The name of a file for a figure.
pub fn svg_file() -> impl TypedValueParser<Value = PathBuf> {
    file_of("svg", "figures are SVG")
}

/// The name of a file; one whose ending is that of another format than its own is refused.
///
/// Implements: CLI-237.
pub fn file_of(format: &'static str, what: &'static str) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| {
        let ending = path.extension();
        let is_of = ending.is_none_or(|ending| ending.eq_ignore_ascii_case(format));
        let wrong = || format!("{what}; choose a name that ends in .{format}");
        is_of.then_some(path).ok_or_else(wrong)
    })
}

/// Reads a text file.
pub fn read(path: &Path) -> Result<String, CliError> {
    file::text(path).map_err(CliError::file("read", path))
}

/// Makes a folder and those above it.
pub fn make_folder(path: &Path) -> Result<(), CliError> {
    std::fs::create_dir_all(path).map_err(CliError::file("make folder", path))
}

#[cfg(test)]
mod tests {
    use super::Format;

    // Verifies: CLI-226.
    #[test]
    fn a_field_of_csv_is_quoted_where_it_needs_it() {
        let answer = serde_json::json!({"a": {"b,c": "d, \"e\""}, "f": ["g", null, 1.5]});
        let expected = "key,value\n\"a.b,c\",\"d, \"\"e\"\"\"\nf[0],g\nf[1],\nf[2],1.5\n";
        assert_eq!(Format::Csv.text(&answer, String::new), expected);
    }
}
