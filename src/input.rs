//! Text files that a user names.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The longest text that is read, bytes: more than an hour of playback, recorded.
const LONGEST: u64 = 256 << 20;

/// The text of a file in UTF-8, which may be a pipe or a device, but not an endless one.
///
/// Implements: CLI-008.
pub fn read(path: &Path) -> Result<String> {
    let mut text = String::new();
    let length = File::open(path)?
        .take(LONGEST + 1)
        .read_to_string(&mut text)?;
    if length as u64 > LONGEST {
        let message = format!("it goes on after {} MiB, expected less", LONGEST >> 20);
        return Err(Error::new(ErrorKind::InvalidData, message));
    }
    Ok(text)
}
