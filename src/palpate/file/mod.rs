//! Files that a user names: their text, what serde reads from it, and why it is refused.
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | texts and places; a refusal of serde's in the words of [`Refusal`] |
//! | `toml.rs` | TOML |
//! | `json.rs` | JSON, one row of a matrix a line |
//! | `write.rs` | files that are written |

mod json;
mod toml;
mod write;

use std::fs::File;
use std::io::{self, Error, ErrorKind, Read};
use std::path::Path;

use serde_path_to_error::Path as KeyPath;

pub(crate) use json::{Members, message};
pub use json::{check_schema, from_json, to_json};
pub(crate) use toml::Tree;
pub use toml::from_toml;
pub(crate) use write::Store;
pub use write::{check_writable, write, write_new};

use crate::refusal::{Refusal, did_you_mean};

/// The longest text that is read, bytes: more than a million cycles of playback, recorded.
pub(crate) const LONGEST: u64 = 256 << 20;

/// The byte order mark, with which some editors begin a text.
const MARK: char = '\u{feff}';

/// The text of a file in UTF-8, without a byte order mark, which may be a pipe or a device, but not an endless one.
///
/// Implements: CLI-008.
pub fn text(path: &Path) -> io::Result<String> {
    text_of(File::open(path)?)
}

/// The text of an open file, or of standard input, as [`text`].
///
/// Implements: CLI-008.
pub fn text_of(file: impl Read) -> io::Result<String> {
    let wrong = |message: String| Error::new(ErrorKind::InvalidData, message);
    let mut bytes = Vec::new();
    let length = file.take(LONGEST + 1).read_to_end(&mut bytes)?;
    if length as u64 > LONGEST {
        return Err(wrong(format!("it is longer than {} MiB", LONGEST >> 20)));
    }
    let mut text = String::from_utf8(bytes)
        .map_err(|_| wrong("it is not in UTF-8; save it as UTF-8".into()))?;
    if text.starts_with(MARK) {
        text.drain(..MARK.len_utf8());
    }
    Ok(text)
}

/// What `parse` makes of the text of a file and its name.
///
/// # Errors
/// A file that is no text; whatever `parse` refuses.
pub fn read<T>(
    path: &Path,
    parse: impl FnOnce(&str, &str) -> Result<T, Refusal>,
) -> Result<T, Refusal> {
    let file = path.display().to_string();
    match text(path) {
        Ok(text) => parse(&text, &file),
        Err(error) => Err(Refusal::state(format!("cannot be read: {error}"), "").in_file(file)),
    }
}

/// The line of byte `at` of `text`, from 1.
pub fn line_of(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|&byte| byte == b'\n').count()
}

/// What serde refused at `path` with this message, without its place in the file.
fn refusal(path: &KeyPath, message: &str) -> Refusal {
    let key = match path.to_string() {
        path if path == "." => String::new(),
        path => path,
    };
    let (found, expected) = message.split_once(", expected ").unwrap_or((message, ""));
    let expected = match expected {
        "f64" => "a number",
        "u32" | "u64" | "usize" => "a whole number, at least 0",
        "a sequence" => "a list",
        "a string" => "a text",
        other => other,
    };
    let give = match expected {
        "" => String::new(),
        right => format!("give {right}"),
    };
    let inner = |name: &str| match (&*key, name.trim_end_matches('`')) {
        ("", name) => name.into(),
        (key, name) => format!("{key}.{name}"),
    };
    match found.split_once('`') {
        Some(("missing field ", name)) => Refusal::state(inner(name) + " is missing", ""),
        Some(("duplicate field ", name)) => Refusal::state(inner(name) + " is there twice", ""),
        Some(("unknown field ", _)) => {
            let name = key.rsplit('.').next().unwrap_or_default();
            let similar = did_you_mean(name, expected.split('`').skip(1).step_by(2));
            Refusal::state(format!("{key} is unknown{similar}"), give)
        }
        Some(("unknown variant ", word)) => Refusal::value(key, format!("`{word}"), expected),
        _ if key.is_empty() => Refusal::state(found, give),
        _ if found.starts_with("has ") => Refusal::state(format!("{key} {found}"), give),
        _ => match found.split_once(": ") {
            Some(("invalid type" | "invalid value", value)) => {
                // A number stands in backquotes, behind its kind.
                let value = value.strip_prefix("string ").unwrap_or(value);
                let number = value.split('`').nth(1);
                Refusal::value(key, number.unwrap_or(value), expected)
            }
            _ => Refusal::state(format!("{key}: {found}"), give),
        },
    }
}

#[cfg(test)]
mod tests {
    // Verifies: CLI-008.
    #[test]
    fn a_text_is_in_utf_8_with_or_without_a_mark() {
        let read = |bytes: &[u8]| super::text_of(bytes).map_err(|error| error.to_string());
        assert_eq!(read(b"\xef\xbb\xbf{}"), Ok("{}".into()));
        let other = "it is not in UTF-8; save it as UTF-8";
        assert_eq!(read(b"\xff\xfe{\0}\0"), Err(other.into()));
    }
}
