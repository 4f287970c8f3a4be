//! Files on a disk that fails, and in folders where others are busy.

use super::*;
use palpate_asserts::assert_error;
use std::cell::RefCell;
use std::io::SeekFrom;
use std::os::unix::fs::{PermissionsExt, symlink};

/// A folder of its own, which is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("palpate-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).unwrap();
        Folder(folder)
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// The names in it, in their order.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let names = entries.map(|entry| name(entry).into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).unwrap();
    }
}

fn read(path: &Path) -> Option<String> {
    fs::read_to_string(path).ok()
}

/// The way in which a file gets its name.
type Place = fn(&Path, &Path) -> io::Result<()>;

fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)
}

/// What fails.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// The write, after so many bytes.
    Write(usize),
    Sync,
    Place,
}

/// A file on a disk that fails, which looks before each call.
struct Watched<'a> {
    file: File,
    fault: Fault,
    /// With what was called.
    look: &'a dyn Fn(&File, &'static str),
}

fn failure() -> io::Error {
    ErrorKind::StorageFull.into()
}

impl Read for Watched<'_> {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        unreachable!()
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, _: SeekFrom) -> io::Result<u64> {
        unreachable!()
    }
}

impl Write for Watched<'_> {
    /// At most three bytes at a time.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (self.look)(&self.file, "write");
        let mut count = bytes.len().min(3);
        if let Fault::Write(room) = &mut self.fault {
            count = count.min(*room);
            *room -= count;
        }
        match count {
            0 => Err(failure()),
            count => self.file.write(&bytes[..count]),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Store for Watched<'_> {
    fn set_len(&self, _: u64) -> io::Result<()> {
        unreachable!()
    }

    fn sync_data(&self) -> io::Result<()> {
        (self.look)(&self.file, "sync");
        match self.fault {
            Fault::Sync => Err(failure()),
            _ => Ok(()),
        }
    }

    fn try_lock(&self) -> Result<(), TryLockError> {
        unreachable!()
    }
}

const NEW: &str = "what is new";

// Verifies: CLI-005, CLI-235.
#[test]
fn a_file_is_as_it_was_until_it_is_whole_whatever_fails() {
    let last = NEW.len() - 1;
    for fault in [
        Fault::None,
        Fault::Write(0),
        Fault::Write(last),
        Fault::Sync,
        Fault::Place,
    ] {
        for place in [rename as Place, link] {
            assert_written(fault, None, place, fault == Fault::None);
        }
        let old = Some("old".to_string());
        assert_written(fault, old.clone(), rename, fault == Fault::None);
        assert_written(fault, old, link, false);
    }
}

/// Asserts that the file is written where that `succeeds`, else stays; and is as it was before each call, where a program may be killed.
fn assert_written(fault: Fault, old: Option<String>, place: Place, succeeds: bool) {
    let folder = Folder::new("whole");
    let path = folder.at("out");
    if let Some(old) = &old {
        fs::write(&path, old).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
    }
    let calls = RefCell::new(Vec::new());
    let look = |file: &File, call| {
        calls.borrow_mut().push(call);
        assert_eq!(read(&path), old, "{fault:?}");
        let mode = file.metadata().unwrap().permissions().mode();
        let is_private = old.is_none() || mode & 0o777 == 0o600;
        assert!(is_private, "others may read it: {mode:o}");
    };
    let look = &look;
    let placed = |from: &Path, to: &Path| {
        look(&File::open(from).unwrap(), "place");
        assert_eq!(read(from).unwrap(), NEW);
        match fault {
            Fault::Place => Err(failure()),
            _ => place(from, to),
        }
    };
    let told = replace(
        &path,
        NEW.as_bytes(),
        |file| Watched { file, fault, look },
        placed,
    );
    assert_eq!(told.is_ok(), succeeds, "{fault:?}");
    let left = if succeeds { Some(NEW.to_string()) } else { old };
    assert_eq!(read(&path), left, "{fault:?}");
    let names: &[&str] = if left.is_some() { &["out"] } else { &[] };
    assert_eq!(folder.names(), names, "{fault:?}");
    if let (Err(error), true) = (told, fault != Fault::None) {
        assert_eq!(error.kind(), ErrorKind::StorageFull, "{fault:?}");
    }
    if fault == Fault::None {
        assert_eq!(calls.into_inner()[3..], ["write", "sync", "place"]);
    }
}

// Verifies: CLI-005, CLI-235.
#[test]
fn what_comes_to_the_place_of_a_file_meanwhile_is_not_followed() {
    let plants: [fn(&Folder); 4] = [
        |folder| fs::write(folder.at("out"), "untouched").unwrap(),
        |folder| symlink("victim", folder.at("out")).unwrap(),
        |folder| symlink("nowhere", folder.at("out")).unwrap(),
        |folder| fs::create_dir(folder.at("out")).unwrap(),
    ];
    for (number, plant) in plants.into_iter().enumerate() {
        for is_new in [false, true] {
            let folder = Folder::new("planted");
            fs::write(folder.at("victim"), "untouched").unwrap();
            let place = |from: &Path, to: &Path| {
                plant(&folder);
                if is_new {
                    link(from, to)
                } else {
                    rename(from, to)
                }
            };
            let out = folder.at("out");
            let told = replace(&out, NEW.as_bytes(), identity, place);
            let is_link = out.symlink_metadata().unwrap().is_symlink();
            // A folder cannot be replaced by a file.
            if is_new || number == 3 {
                assert!(told.is_err(), "{number}");
                assert_eq!(is_link, number == 1 || number == 2);
                assert!(read(&out).is_none_or(|text| text == "untouched"));
            } else {
                told.unwrap();
                assert!(!is_link && read(&out).unwrap() == NEW, "{number}");
            }
            assert_eq!(read(&folder.at("victim")).unwrap(), "untouched");
            assert_eq!(folder.names(), ["out", "victim"], "{number} {is_new}");
        }
    }
}

// Verifies: CLI-005, CLI-235.
#[test]
fn a_new_file_takes_the_place_of_none_and_any_other_may() {
    let folder = Folder::new("new");
    let out = folder.at("out");
    write_new(&out, "first").unwrap();
    let there = "it is there by now; choose another name";
    assert_error(write_new(&out, "second"), there);
    assert_eq!(read(&out).unwrap(), "first");
    write(&out, "second").unwrap();
    assert_eq!(read(&out).unwrap(), "second");
    // A link to a file, and one to a file that is not there yet, lead there.
    for name in ["out", "ahead"] {
        let link = folder.at("link");
        symlink(name, &link).unwrap();
        write(&link, "third").unwrap();
        assert!(link.is_symlink());
        assert_eq!(read(&folder.at(name)).unwrap(), "third");
        fs::remove_file(link).unwrap();
    }
    // No file system has links to folders: as on one that has none at all.
    let [from, to] = ["from", "to"].map(|name| folder.at(name));
    fs::create_dir(&from).unwrap();
    assert_error(link(&from, &out), there);
    link(&from, &to).unwrap();
    assert_eq!(folder.names(), ["ahead", "out", "to"]);
}

// Verifies: CLI-005.
#[test]
fn a_temporary_file_is_new_whatever_was_laid_under_its_name() {
    let folder = Folder::new("partial");
    let at = |number: u64| folder.at(&format!(".palpate-{number:016x}.partial"));
    // Another's file, a link to a file, and one to what is not there, which a look for the name does not find.
    let [victim, nowhere] = ["victim", "nowhere"].map(|name| folder.at(name));
    fs::write(&victim, "untouched").unwrap();
    fs::write(at(0), "untouched").unwrap();
    symlink(&victim, at(1)).unwrap();
    symlink(&nowhere, at(2)).unwrap();
    for number in 0..3 {
        let refused = partial_file(&folder.0, number).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::AlreadyExists, "{number}");
    }
    assert!(!nowhere.exists());
    let (name, mut file) = partial_file(&folder.0, 3).unwrap();
    file.write_all(b"new").unwrap();
    assert_eq!(
        [read(&victim), read(&at(0)), read(&name)].map(Option::unwrap),
        ["untouched", "untouched", "new"]
    );
}
