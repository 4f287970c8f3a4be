//! Messages: the error of a file, and text that is quoted.

use std::fmt::Display;
use std::path::Path;

use serde_json::Value;

/// A file that is not valid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {message}")]
pub struct Invalid {
    /// Its name.
    pub file: String,
    /// What is wrong, in one line.
    pub message: String,
}

impl Invalid {
    /// The error of a file.
    pub fn new(file: impl Display, message: impl Display) -> Invalid {
        Invalid {
            file: file.to_string(),
            message: message.to_string().chars().map(plain).collect(),
        }
    }
}

/// The text of a file.
pub fn read(path: &Path) -> Result<String, Invalid> {
    std::fs::read_to_string(path).map_err(|error| Invalid::new(path.display(), error))
}

/// Returns the formatted message as an error unless the condition holds.
macro_rules! ensure {
    ($condition:expr, $($message:tt)+) => {
        if !$condition {
            return Err(format!($($message)+));
        }
    };
}
pub(crate) use ensure;

/// A value as text, cut if it is long.
pub fn shortened(value: &Value) -> String {
    cut(&value.to_string())
}

/// A text of at most some 200 characters, without those that control a terminal.
pub fn cut(text: &str) -> String {
    const MOST: usize = 200;
    let mut cut: String = text.chars().take(MOST).map(plain).collect();
    if text.chars().nth(MOST).is_some() {
        cut.push('…');
    }
    cut
}

/// A character, or U+FFFD for one that controls a terminal.
pub fn plain(c: char) -> char {
    if c.is_control() { '\u{fffd}' } else { c }
}

/// Text between tags or quotes of XML and HTML; characters that XML does not have become U+FFFD.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\0'..='\x1f' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            _ => out.push(character),
        }
    }
    out
}
