//! Text files that a user names.

use std::fs::File;
use std::io::{self, Error, ErrorKind, Read};
use std::path::Path;

use serde::de::DeserializeOwned;

use crate::refusal::Refusal;

/// The longest text that is read, bytes: more than an hour of playback, recorded.
const LONGEST: u64 = 256 << 20;

/// The text of a file in UTF-8, which may be a pipe or a device, but not an endless one.
///
/// Implements: CLI-008.
pub fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    let mut file = File::open(path)?.take(LONGEST + 1);
    let length = file.read_to_string(&mut text)?;
    if length as u64 > LONGEST {
        let message = format!("it goes on after {} MiB, expected less", LONGEST >> 20);
        return Err(Error::new(ErrorKind::InvalidData, message));
    }
    Ok(text)
}

/// What `parse` makes of the text of a file and its name.
///
/// # Errors
/// A file that is no text; whatever `parse` refuses.
pub fn parse<T>(
    path: &Path,
    parse: impl FnOnce(&str, &str) -> Result<T, Refusal>,
) -> Result<T, Refusal> {
    let file = path.display().to_string();
    match read(path) {
        Ok(text) => parse(&text, &file),
        Err(error) => Err(Refusal::state(format!("cannot be read: {error}"), "").in_file(file)),
    }
}

/// The line of byte `at` of `text`, from 1.
pub fn line_of(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|&byte| byte == b'\n').count()
}

/// What serde reads from `text`, TOML, the content of `file`.
///
/// # Errors
/// What is wrong, with file, line and key.
pub fn from_toml<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, Refusal> {
    let refused = |key: &str, error: &toml::de::Error| {
        // What the parser has no place for, such as too deep a nesting, it found up to the end.
        let at = error.span().map_or(text.len(), |span| span.start);
        let message = format!("{key}{}", error.message());
        let line = line_of(text, at);
        Refusal::state(message, "").at(line).in_file(file)
    };
    let document = toml::Deserializer::parse(text).map_err(|error| refused("", &error))?;
    serde_path_to_error::deserialize(document).map_err(|error| {
        let key = match error.path().to_string() {
            path if path == "." => String::new(),
            path => path + ": ",
        };
        refused(&key, error.inner())
    })
}
