//! A copy of the sources, in which defects are planted.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::list::Defect;

/// The folder of the checkout.
pub const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// A copy of what git tracks, with a target folder of its own.
pub struct Copy {
    /// The folder.
    pub root: PathBuf,
}

impl Copy {
    /// Copies what git tracks below these paths. A file that is there already stays as it is, so that cargo does not compile it anew; one
    /// that git does not know goes.
    pub fn new(name: &str, paths: &[&str]) -> Copy {
        let copy = Copy {
            root: Path::new(env!("CARGO_TARGET_TMPDIR")).join(name),
        };
        let listed = Command::new("git")
            .current_dir(ROOT)
            .args(["ls-files", "-z", "--"])
            .args(paths)
            .output()
            .unwrap();
        let listed = String::from_utf8(listed.stdout).unwrap();
        let mut tracked: BTreeSet<PathBuf> = BTreeSet::new();
        for path in listed.split_terminator('\0') {
            let from = Path::new(ROOT).join(path);
            if let Ok(bytes) = fs::read(&from) {
                copy.write(path, &bytes);
                let to = copy.root.join(path);
                fs::set_permissions(&to, fs::metadata(from).unwrap().permissions()).unwrap();
                tracked.insert(to);
            }
        }
        assert!(!tracked.is_empty(), "git lists no file below {paths:?}");
        remove_others(&copy.root, &tracked);
        copy
    }

    /// Writes a file, unless it is there already.
    pub fn write(&self, path: &str, bytes: &[u8]) {
        let path = self.root.join(path);
        if fs::read(&path).ok().as_deref() != Some(bytes) {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
    }

    /// Writes a file; the one that was put aside if it is the same, for cargo goes by the time of a file.
    pub fn write_or_take(&self, path: &str, text: &str) {
        let aside = self.aside(path);
        match fs::read_to_string(&aside) {
            Ok(known) if known == text => fs::rename(aside, self.root.join(path)).unwrap(),
            _ => self.write(path, text.as_bytes()),
        }
    }

    /// Puts a file aside, and another text in its place.
    pub fn put_aside(&self, path: &str, text: &str) {
        let aside = self.aside(path);
        fs::create_dir_all(aside.parent().unwrap()).unwrap();
        fs::rename(self.root.join(path), aside).unwrap();
        self.write(path, text.as_bytes());
    }

    /// Forgets what was put aside, for cargo has built other texts since.
    pub fn forget(&self) {
        let _ = fs::remove_dir_all(self.aside(""));
    }

    fn aside(&self, path: &str) -> PathBuf {
        self.root.join("target/aside").join(path)
    }

    /// The text of a file.
    pub fn read(&self, path: &str) -> String {
        fs::read_to_string(self.root.join(path)).unwrap()
    }

    /// What is found while a defect is in its file.
    pub fn with<T>(&self, defect: &Defect, find: impl FnOnce() -> T) -> T {
        let sound = self.read(&defect.file);
        self.write(&defect.file, defect.planted(&sound).as_bytes());
        let found = find();
        self.write(&defect.file, sound.as_bytes());
        found
    }
}

/// Removes the files below a folder that are not among these, but for what was built.
fn remove_others(folder: &Path, kept: &BTreeSet<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true if path.ends_with("target") => {}
            true => remove_others(&path, kept),
            false if kept.contains(&path) => {}
            false => fs::remove_file(path).unwrap(),
        }
    }
}
