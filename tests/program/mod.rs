//! The program `palpate` in a folder of its own, as its users run it.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// The program.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_palpate-under-test");

/// A folder for one test, empty at the start.
pub struct Place(PathBuf);

impl Place {
    pub fn new(test: &str) -> Place {
        // Several tests may ask for the same folder: under cargo-nextest each is a process, else a thread of its name.
        let thread = || {
            std::thread::current()
                .name()
                .unwrap_or_default()
                .to_string()
        };
        let asking = std::env::var("NEXTEST_TEST_NAME").unwrap_or_else(|_| thread());
        let path = Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join(test)
            .join(asking.replace(':', "-"));
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

    /// The program, whose input `pipe` has this text, and what it says; before there is any of it, and after the program looked for its
    /// outputs, `meanwhile` runs.
    pub fn refused_meanwhile(
        &self,
        line: &str,
        [pipe, text]: [&str; 2],
        meanwhile: impl FnOnce(),
    ) -> String {
        let made = Command::new("mkfifo").arg(self.at(pipe)).status().unwrap();
        assert!(made.success());
        let mut command = self.palpate(line);
        let child = command.stderr(Stdio::piped()).spawn().unwrap();
        // Waits until the program opens it.
        let mut input = fs::File::options().write(true).open(self.at(pipe)).unwrap();
        meanwhile();
        input.write_all(text.as_bytes()).unwrap();
        drop(input);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
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

    /// Asserts the refusals of a part of `refused/command_lines.txt`, whose cases `line` makes command lines of.
    #[track_caller]
    pub fn refuses(&self, part: &str, line: impl Fn(&str) -> String) {
        let refused = |words: &str| self.refused(&line(words));
        palpate_asserts::assert_cases("refused/command_lines.txt", part, refused);
    }
}

/// Sends a signal, by the shell's own command: not every system has a program for it.
pub fn send(signal: &str, to: &Child) {
    let line = format!("kill -{signal} {}", to.id());
    assert!(
        Command::new("sh")
            .args(["-c", &line])
            .status()
            .unwrap()
            .success()
    );
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

/// A phantom that is not its own mirror image.
pub const ASYMMETRIC: &str = include_str!("asymmetric.toml");
