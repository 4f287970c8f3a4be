//! Standard output and files.

use std::io::{ErrorKind, Write};
use std::path::Path;

use super::CliError;

/// Prints text; a reader who has gone away (`| head`) is no error.
///
/// Implements: CLI-004, CLI-007.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError::Output(error)),
        _ => Ok(()),
    }
}

/// Writes a file so that it is there whole or, if the program is stopped, as it was.
///
/// Implements: CLI-005, CLI-007.
pub fn write(path: &Path, text: &str) -> Result<(), CliError> {
    let failed = |error| CliError::File {
        action: "write",
        path: path.display().to_string(),
        error,
    };
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    std::fs::write(&partial, text).map_err(failed)?;
    std::fs::rename(&partial, path).map_err(failed)
}

/// Reads a text file.
pub fn read(path: &Path) -> Result<String, CliError> {
    std::fs::read_to_string(path).map_err(|error| CliError::File {
        action: "read",
        path: path.display().to_string(),
        error,
    })
}

/// Makes a folder and those above it.
pub fn make_folder(path: &Path) -> Result<(), CliError> {
    std::fs::create_dir_all(path).map_err(|error| CliError::File {
        action: "make folder",
        path: path.display().to_string(),
        error,
    })
}
