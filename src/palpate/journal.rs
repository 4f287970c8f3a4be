//! A journal: a file of JSON lines that grows while a long job runs, so that a job that was stopped can continue.
//!
//! The first line states the request, each further line one finished part.

use std::fs::{File, TryLockError};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::Serialize;

use crate::refusal::Refusal;

/// An open journal, locked against other processes.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    /// With the length of its whole lines.
    file: Mutex<(File, u64)>,
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
        let read = file.read_until(b'\n', &mut bytes);
        read.map_err(failed("read", path))?;
        let Some((b'\n', text)) = bytes.split_last() else {
            break;
        };
        let in_line = |refusal: Refusal| refusal.at(number).in_file(path.display().to_string());
        let text = std::str::from_utf8(text);
        let text = text.map_err(|_| in_line(Refusal::state("this line is not UTF-8", "")))?;
        take(text).map_err(in_line)?;
        length += bytes.len() as u64;
    }
    Ok(length)
}

impl Journal {
    /// Opens the journal of `request` at `path`, or creates it, and passes each whole line after the first to `take`. The first line of
    /// every journal of this kind begins with `beginning`. A second process that opens the journal is told that `command` writes it.
    ///
    /// # Errors
    /// The file belongs to another request of which a part is finished, or is not such a journal; another process writes it; or `take`
    /// refuses a line.
    ///
    /// Implements: CLI-156, CLI-157.
    pub fn open(
        path: PathBuf,
        request: &impl Serialize,
        beginning: &str,
        command: &str,
        take: impl FnMut(&str) -> Result<(), Refusal>,
    ) -> Result<Journal, Refusal> {
        let refused = |found: String| Refusal::state(found, "").in_file(path.display().to_string());
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let file = options.open(&path).map_err(failed("open", &path))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            let found = format!("another '{command}' is writing this file; wait until it ends");
            return Err(refused(found));
        }
        let request = line(request);
        let mut reader = BufReader::new(&file);
        let mut first = Vec::new();
        let read = reader.read_until(b'\n', &mut first);
        read.map_err(failed("read", &path))?;
        let mut whole = 0;
        if first == request.as_bytes() {
            whole = take_lines(reader, &path, 2, take)? + first.len() as u64;
        } else if !is_only_begun(&first, beginning) || has_line(reader) {
            let found =
                "belongs to a different request or version; finish that run or delete the file";
            return Err(refused(found.into()));
        }
        let begun = if whole == 0 { &*request } else { "" };
        let mut file = (file, whole);
        append(&mut file, begun, File::set_len, File::sync_data).map_err(failed("write", &path))?;
        let file = Mutex::new(file);
        Ok(Journal { path, file })
    }

    /// Appends one finished part as one line, which is on the disk when this returns.
    ///
    /// # Errors
    /// The file cannot be written; what is there of the line is cut off by whoever appends or opens next.
    ///
    /// Implements: CLI-156.
    pub fn append(&self, part: &impl Serialize) -> Result<(), Refusal> {
        let line = line(part);
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let written = append(&mut file, &line, File::set_len, File::sync_data);
        written.map_err(failed("write", &self.path))
    }

    /// Removes the file.
    ///
    /// # Errors
    /// The system does not allow it.
    pub fn remove(self) -> Result<(), Refusal> {
        std::fs::remove_file(&self.path).map_err(failed("remove", &self.path))
    }
}

/// Writes `line` behind the `whole` lines of a file, counted in bytes, over what a write that failed may have left.
fn append<F: Write + Seek>(
    (file, whole): &mut (F, u64),
    line: &str,
    set_len: fn(&F, u64) -> io::Result<()>,
    sync: fn(&F) -> io::Result<()>,
) -> io::Result<()> {
    set_len(file, *whole)?;
    file.seek(SeekFrom::Start(*whole))?;
    file.write_all(line.as_bytes())?;
    sync(file)?;
    *whole += line.len() as u64;
    Ok(())
}

/// Whether `first` is the first line, or the beginning of the first line, of a journal of this kind.
fn is_only_begun(first: &[u8], beginning: &str) -> bool {
    first.starts_with(beginning.as_bytes()) || beginning.as_bytes().starts_with(first)
}

/// Whether a whole line follows.
fn has_line(mut reader: impl BufRead) -> bool {
    let mut bytes = Vec::new();
    let read = reader.read_until(b'\n', &mut bytes);
    read.is_err() || bytes.ends_with(b"\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cell::{Cell, RefCell};
    use std::collections::BTreeSet;

    /// A file on a disk that takes so many more bytes, and whose next cut or sync fails if that is asked for.
    struct Disk {
        bytes: RefCell<Vec<u8>>,
        place: usize,
        room: usize,
        fails: Cell<Option<Step>>,
    }

    /// What may fail of an append.
    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Step {
        Cut,
        /// The write, after so many bytes.
        Write(usize),
        Sync,
    }

    impl Disk {
        fn new(bytes: Vec<u8>) -> Disk {
            let (bytes, fails) = (RefCell::new(bytes), Cell::new(None));
            Disk {
                bytes,
                place: 0,
                room: usize::MAX,
                fails,
            }
        }

        fn step(&self, step: Step) -> io::Result<()> {
            match self.fails.get() == Some(step) {
                true => Err(io::ErrorKind::StorageFull.into()),
                false => Ok(()),
            }
        }

        fn set_len(&self, length: u64) -> io::Result<()> {
            self.step(Step::Cut)?;
            self.bytes.borrow_mut().resize(length as usize, 0);
            Ok(())
        }

        fn sync(&self) -> io::Result<()> {
            self.step(Step::Sync)
        }

        /// Appends a line of which the step fails.
        fn append(file: &mut (Disk, u64), line: &str, fails: Option<Step>) -> io::Result<()> {
            file.0.fails.set(fails);
            file.0.room = match fails {
                Some(Step::Write(room)) => room,
                _ => usize::MAX,
            };
            super::append(file, line, Disk::set_len, Disk::sync)
        }

        /// What a process finds that opens the file: its lines, and their length.
        fn found(&self) -> (Vec<usize>, u64) {
            let mut lines = Vec::new();
            let take = |line: &str| {
                let number: usize = line
                    .trim_end_matches('x')
                    .parse()
                    .map_err(|_| Refusal::state(line, ""))?;
                lines.push(number);
                Ok(())
            };
            let bytes = self.bytes.borrow();
            let length = take_lines(&bytes[..], Path::new("f"), 1, take).unwrap();
            (lines, length)
        }
    }

    impl Write for Disk {
        /// At most seven bytes at a time.
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let count = bytes.len().min(7).min(self.room);
            if count == 0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            let (bytes, end) = (&bytes[..count], self.place + count);
            let mut file = self.bytes.borrow_mut();
            let length = file.len().max(end);
            file.resize(length, 0);
            file[self.place..end].copy_from_slice(bytes);
            (self.place, self.room) = (end, self.room - count);
            Ok(count)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Seek for Disk {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            let place = match to {
                SeekFrom::Start(place) => place as i64,
                SeekFrom::Current(by) => self.place as i64 + by,
                SeekFrom::End(by) => self.bytes.borrow().len() as i64 + by,
            };
            self.place = place as usize;
            Ok(place as u64)
        }
    }

    // Verifies: CLI-156, STU-024.
    #[test]
    fn a_line_that_was_half_written_leaves_no_hole_before_the_next() {
        let mut file = (Disk::new(Vec::new()), 0);
        Disk::append(&mut file, "1\n", None).unwrap();
        for fails in [
            Step::Write(0),
            Step::Write(5),
            Step::Write(8),
            Step::Sync,
            Step::Cut,
        ] {
            let told = Disk::append(&mut file, "2xxxxxxx\n", Some(fails));
            assert_eq!(
                told.unwrap_err().kind(),
                io::ErrorKind::StorageFull,
                "{fails:?}"
            );
            assert_eq!(file.1, 2, "{fails:?}");
        }
        Disk::append(&mut file, "3\n", None).unwrap();
        assert_eq!(&file.0.bytes.borrow()[..], b"1\n3\n");
        assert_eq!(file.1, 4);
    }

    // Verifies: CLI-157.
    #[test]
    fn a_line_that_is_refused_has_its_number_in_the_file() {
        let path = std::env::temp_dir().join(format!("palpate-journal-{}", std::process::id()));
        let open = |wrong: &str| {
            Journal::open(path.clone(), &"request", "\"re", "test", |line| {
                Refusal::state("wrong", "").when(line == wrong)
            })
        };
        let journal = open("").unwrap();
        journal.append(&1).unwrap();
        journal.append(&2).unwrap();
        drop(journal);
        for (wrong, number) in [("1", 2), ("2", 3)] {
            let error = open(wrong).unwrap_err().to_string();
            assert_eq!(error, format!("{}:{number}: wrong", path.display()));
        }
        std::fs::remove_file(path).unwrap();
    }

    // Verifies: CLI-157.
    #[test]
    fn lines_are_counted_beyond_16_bits() {
        let text = "1\n".repeat(1 << 16) + "not one\nrest";
        let mut taken = 0;
        let refused = take_lines(text.as_bytes(), Path::new("f"), 2, |line| {
            taken += 1;
            Refusal::state("wrong", "").when(line != "1")
        });
        assert_eq!(
            (refused.unwrap_err().to_string(), taken),
            ("f:65538: wrong".into(), 65_537)
        );
        let whole = take_lines(text.as_bytes(), Path::new("f"), 1, |_| Ok(())).unwrap();
        assert_eq!(whole, 2 * 65_536 + 8);
    }

    fn fault() -> impl Strategy<Value = Option<Step>> {
        let step = prop_oneof![
            Just(Step::Cut),
            (0..40usize).prop_map(Step::Write),
            Just(Step::Sync)
        ];
        prop::option::of(step)
    }

    proptest! {
        #![proptest_config(palpate_asserts::seeded(20_261_125))]

        // A job of 12 parts: every process appends those that it does not find, each once; a disk fails at any step; after any
        // part the process may be killed, and another goes on.
        // Verifies: CLI-156, STU-024.
        #[test]
        fn no_part_is_lost_or_there_twice_whatever_fails(
            faults in prop::collection::vec((fault(), any::<bool>(), 0..30usize), 40)
        ) {
            let mut file = (Disk::new(Vec::new()), 0);
            let mut told = BTreeSet::new();
            let mut faults = faults.into_iter();
            loop {
                let found;
                (found, file.1) = file.0.found();
                let there: BTreeSet<usize> = found.iter().copied().collect();
                prop_assert_eq!(there.len(), found.len(), "twice: {:?}", found);
                // What was told to be written is there; what is there more was whole.
                prop_assert!(there.is_superset(&told), "{:?} {:?}", there, told);
                told = there;
                let left: Vec<usize> = (0..12).filter(|part| !told.contains(part)).collect();
                if left.is_empty() {
                    break;
                }
                for part in left {
                    let (fails, is_killed, length) = faults.next().unwrap_or_default();
                    let line = format!("{part}{}\n", "x".repeat(length));
                    let written = Disk::append(&mut file, &line, fails);
                    let fails = fails.filter(|step| !matches!(step, Step::Write(room) if *room >= line.len()));
                    prop_assert_eq!(written.is_ok(), fails.is_none());
                    if written.is_ok() {
                        told.insert(part);
                    }
                    if is_killed {
                        break;
                    }
                }
            }
        }
    }
}
