//! Standard output and files.

use std::fmt::Display;
use std::fs::File;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::CliError;
use palpate::refusal::one_line;

/// Prints text; a reader who has gone away (`| head`) is no error.
///
/// Implements: CLI-003, CLI-007.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(CliError::Check(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Says something about a file on standard error that is no error.
pub fn note(file: impl Display, text: &str) {
    eprintln!("palpate: note: {}", one_line(&format!("{file}: {text}")));
}

/// Writes a file so that it is there whole or, if the program is stopped, as it was.
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
    // A folder that is not there is told without the name of the temporary file.
    std::fs::metadata(folder)?;
    let (name, mut partial) = partial_file(folder)?;
    let mut written = partial.write_all(text);
    if let Some(there) = there {
        written = written.and_then(|()| partial.set_permissions(there.permissions()));
    }
    let moved = written.and_then(|()| std::fs::rename(&name, target));
    moved.inspect_err(|_| {
        // What failed is told; a file that stays behind is not worth a second message.
        let _ = std::fs::remove_file(&name);
    })
}

/// A new file in `folder` under a name drawn at random.
fn partial_file(folder: &Path) -> std::io::Result<(PathBuf, File)> {
    loop {
        // The keys of a hash map are random.
        let number = RandomState::new().build_hasher().finish();
        let name = folder.join(format!(".palpate-{number:016x}.partial"));
        match File::create_new(&name) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            made => return Ok((name, made?)),
        }
    }
}

/// Where a chain of symbolic links to a file that is not there yet ends.
fn end_of_links(path: &Path) -> PathBuf {
    let next = std::fs::read_link(path).ok();
    let next = next.map(|next| path.parent().unwrap_or(path).join(next));
    next.map_or(path.into(), |next| end_of_links(&next))
}

/// Reads a text file.
pub fn read(path: &Path) -> Result<String, CliError> {
    palpate::input::read(path).map_err(CliError::file("read", path))
}

/// Makes a folder and those above it.
pub fn make_folder(path: &Path) -> Result<(), CliError> {
    std::fs::create_dir_all(path).map_err(CliError::file("make folder", path))
}
