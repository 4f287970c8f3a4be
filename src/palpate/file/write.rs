//! The one place where files are written: whole, or by a [`crate::journal::Journal`] line after line.

use std::convert::identity;
use std::fs::{self, File, TryLockError};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, Error, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// An open file; each of its calls may fail.
pub(crate) trait Store: Read + Write + Seek {
    fn set_len(&self, length: u64) -> io::Result<()>;
    fn sync_data(&self) -> io::Result<()>;
    fn try_lock(&self) -> Result<(), TryLockError>;
}

impl Store for File {
    fn set_len(&self, length: u64) -> io::Result<()> {
        self.set_len(length)
    }
    fn sync_data(&self) -> io::Result<()> {
        self.sync_data()
    }
    fn try_lock(&self) -> Result<(), TryLockError> {
        self.try_lock()
    }
}

/// Writes a file atomically: if the program or the machine stops, the file is either new and whole or as it was.
///
/// # Errors
/// The system does not allow it; the file is as it was.
///
/// Implements: CLI-005.
pub fn write(path: &Path, text: &str) -> io::Result<()> {
    let rename = |from: &Path, to: &Path| fs::rename(from, to);
    replace(path, text.as_bytes(), identity, rename)
}

/// Writes a file, as [`write()`], where none is.
///
/// # Errors
/// As [`write()`]; or one is there, even if it came there while this one was written.
///
/// Implements: CLI-235.
pub fn write_new(path: &Path, text: &str) -> io::Result<()> {
    replace(path, text.as_bytes(), identity, link)
}

/// Whether [`write()`] could write a file now, which stays as it is. A pipe and a device are left alone.
///
/// # Errors
/// As [`write()`].
///
/// Implements: CLI-005.
pub fn check_writable(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(there) if !there.is_file() && !there.is_dir() => Ok(()),
        _ => replace(path, &[], identity, |_, _| Ok(())),
    }
}

/// Gives a file its name, unless something has it.
fn link(from: &Path, to: &Path) -> io::Result<()> {
    fs::hard_link(from, to).or_else(|_| match to.symlink_metadata() {
        Ok(_) => Err(Error::other("it is there by now; choose another name")),
        // The file system has no links.
        Err(_) => fs::rename(from, to),
    })
}

/// Writes a file, in a `store`, that `place` gives its name when it is whole and on the disk.
///
/// Implements: CLI-005.
fn replace<F: Store>(
    path: &Path,
    text: &[u8],
    store: impl FnOnce(File) -> F,
    place: impl FnOnce(&Path, &Path) -> io::Result<()>,
) -> io::Result<()> {
    let there = match fs::metadata(path) {
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
    fs::metadata(folder)?;
    // The keys of a hash map are random.
    let (name, partial) = partial_file(folder, RandomState::new().build_hasher().finish())?;
    // Before there is anything in it to read.
    let moded = there.map_or(Ok(()), |there| partial.set_permissions(there.permissions()));
    let mut partial = store(partial);
    let written = moded.and_then(|()| partial.write_all(text));
    let synced = written.and_then(|()| partial.sync_data());
    let placed = synced.and_then(|()| place(&name, &target));
    // An error is reported; a file that stays behind is not worth a second message.
    let _ = fs::remove_file(&name);
    placed
}

/// A new file in `folder`.
///
/// # Errors
/// Something of that name is there, whatever it is.
fn partial_file(folder: &Path, number: u64) -> io::Result<(PathBuf, File)> {
    let name = folder.join(format!(".palpate-{number:016x}.partial"));
    File::create_new(&name).map(|file| (name, file))
}

/// The end of a chain of symbolic links to a file that does not exist yet.
fn end_of_links(path: &Path) -> PathBuf {
    let next = fs::read_link(path).ok();
    let next = next.map(|next| path.parent().unwrap_or(path).join(next));
    next.map_or(path.into(), |next| end_of_links(&next))
}

#[cfg(test)]
#[cfg(unix)]
mod tests;
