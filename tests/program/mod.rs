//! The program `palpate` in a folder of its own, as its users run it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The program.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_palpate-under-test");

/// A folder for one test, empty at the start.
pub struct Place(PathBuf);

impl Place {
    pub fn new(test: &str) -> Place {
        // Under cargo-nextest each test is a process, and several may ask for the same folder.
        let process = std::env::var("NEXTEST_TEST_NAME").unwrap_or_default();
        let path = Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join(test)
            .join(process.replace(':', "-"));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("a folder for the test");
        Place(path)
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.at(name), text).expect("a file for the test");
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.at(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The program with the words of `line`.
    pub fn palpate(&self, line: &str) -> Command {
        let mut command = Command::new(PROGRAM);
        command.current_dir(&self.0).args(line.split_whitespace());
        command
    }

    pub fn run(&self, line: &str) -> Output {
        self.palpate(line).output().expect("the program starts")
    }

    /// What it prints when all goes well.
    pub fn succeed(&self, line: &str) -> String {
        let output = self.run(line);
        assert!(output.status.success(), "{line}: {}", text(&output.stderr));
        text(&output.stdout).into()
    }

    /// The one line that it prints, and only that, when the input is to blame (CLI-002, CLI-003).
    pub fn refused(&self, line: &str) -> String {
        let output = self.run(line);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}: {message}");
        assert!(output.stdout.is_empty(), "{line} printed {output:?}");
        let said = message.strip_prefix("palpate: ").expect(message);
        assert_eq!(message.lines().count(), 1, "{line}: {message}");
        said.trim_end().into()
    }

    /// Asserts that each line of `cases`, words and parts of the refusal, is refused with these.
    pub fn refuses(&self, cases: &str, line: impl Fn(&str) -> String) {
        for case in cases.trim().lines().map(str::trim) {
            let (words, parts) = case.split_once(" => ").expect(case);
            has(&self.refused(&line(words)), parts.split(" | "));
        }
    }
}

/// Asserts that a text has these parts.
#[track_caller]
pub fn has(text: &str, parts: impl IntoIterator<Item = impl AsRef<str>>) {
    for part in parts {
        let part = part.as_ref();
        assert!(text.contains(part), "no {part:?} in {text}");
    }
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// Everything below a folder, by its relative path.
pub fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_path_buf();
                files.push((name, fs::read(&path).unwrap()));
            }
        }
    }
    files.sort();
    files
}

/// An ellipse at the left and a polygon at the right, under three layers, with sliding walls.
pub const ASYMMETRIC: &str = r#"
name = "asymmetric"
well = { width_mm = 34, walls = "sliding" }
layer = [
  { name = "skin", thickness_mm = 0.5, youngs_modulus_kpa = 180, poisson_ratio = 0.49 },
  { name = "fat", thickness_mm = 3, youngs_modulus_kpa = 3, poisson_ratio = 0.49 },
  { name = "gel", thickness_mm = 12, youngs_modulus_kpa = 5, poisson_ratio = 0.49 },
]
probe = { radius_mm = 6.5, length_mm = 30 }
[[inclusion]]
centre_x_mm = -5
depth_mm = 4
width_mm = 6
height_mm = 4
angle_deg = 30
youngs_modulus_kpa = 1200
poisson_ratio = 0.49
[[inclusion]]
centre_x_mm = 8
depth_mm = 7
points_mm = [[-2, 0], [2, 0], [2, 3], [-2, 3]]
youngs_modulus_kpa = 50
poisson_ratio = 0.45
"#;
