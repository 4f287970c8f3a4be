//! The tests of a copy, built once and run as often as there are defects.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use roxmltree::Document;

use crate::copy::Copy;
use crate::switch::VARIABLE;

/// How cargo-nextest runs them. Whatever hangs has failed; what fails for want of time passes the second time.
const PROFILE: &str = r#"
[profile.ledger]
retries = 1
slow-timeout = { period = "60s", terminate-after = 4 }
status-level = "none"
final-status-level = "none"
[profile.ledger.junit]
path = "junit.xml"
"#;

/// The tests of a copy.
pub struct Suite<'a> {
    copy: &'a Copy,
    target: PathBuf,
}

impl<'a> Suite<'a> {
    /// Those that were built, or will be.
    pub fn new(copy: &'a Copy) -> Suite<'a> {
        let config = ".config/nextest.toml";
        copy.write(config, (copy.read(config) + PROFILE).as_bytes());
        let target = copy.root.join("target");
        let debug = target.join("debug");
        if !debug.exists() {
            fs::create_dir_all(&debug).unwrap();
            // The registry's crates are as they were built beside this test.
            let built = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("debug");
            let folders = [".fingerprint", "build", "deps"].map(|name| built.join(name));
            let mut cp = Command::new("cp");
            let copied = cp.arg("-a").args(folders).arg(debug).status();
            assert!(copied.unwrap().success(), "{cp:?}");
        }
        Suite { copy, target }
    }

    /// Builds them all, and what Python loads.
    ///
    /// # Errors
    /// What the compiler says.
    pub fn build(&self) -> Result<(), String> {
        let list = "nextest list --workspace --message-format json --list-type binaries-only";
        for (arguments, file) in [
            ("metadata --all-features --format-version 1", "metadata"),
            (list, "binaries"),
            ("build -p palpate-python", "python"),
        ] {
            let output = run(&mut self.cargo(arguments), None);
            if !output.status.success() {
                return Err(String::from_utf8_lossy(&output.stderr).into_owned());
            }
            fs::write(self.json(file), output.stdout).unwrap();
        }
        let module = self.target.join("module");
        fs::create_dir_all(&module).unwrap();
        let library = self.target.join("debug/libpalpate_python.so");
        fs::copy(library, module.join("palpate.abi3.so")).unwrap();
        Ok(())
    }

    /// The first test that fails among those of a filter of cargo-nextest, with a defect that is behind the switch.
    pub fn failing(&self, filter: &str, planted: Option<usize>) -> Option<String> {
        let mut command = self.nextest(filter);
        command
            .arg("--binaries-metadata")
            .arg(self.json("binaries"));
        command.arg("--cargo-metadata").arg(self.json("metadata"));
        self.first_failing(&mut command, planted)
    }

    /// The same of one package, whose tests alone are built first.
    pub fn failing_in(&self, package: &str, filter: &str) -> Option<String> {
        self.first_failing(self.nextest(filter).args(["-p", package]), None)
    }

    fn nextest(&self, filter: &str) -> Command {
        let mut command = self.cargo("nextest run --profile ledger --no-tests pass -E");
        // Reading the switch allocates, once.
        command.arg(format!("({filter}) - binary(no_alloc)"));
        command
    }

    /// How many tests the last call ran.
    pub fn ran(&self) -> usize {
        let junit = fs::read_to_string(self.junit()).unwrap();
        let document = Document::parse(&junit).unwrap();
        let tests = document.root_element().attribute("tests");
        tests.expect("their number").parse().unwrap()
    }

    fn junit(&self) -> PathBuf {
        self.target.join("nextest/ledger/junit.xml")
    }

    fn first_failing(&self, command: &mut Command, planted: Option<usize>) -> Option<String> {
        let path = self.junit();
        let _ = fs::remove_file(&path);
        let output = run(command, planted);
        // 100: a test failed.
        match output.status.code() {
            Some(0) => None,
            Some(100) => Some(first_failure(&fs::read_to_string(path).unwrap())),
            _ => panic!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)),
        }
    }

    /// The first test in Python that fails.
    pub fn failing_in_python(&self, planted: Option<usize>) -> Option<String> {
        // What `bindings/python/run` installs.
        let python =
            Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("python/venv/bin/python");
        let mut command = Command::new(python);
        // The other files look at the wheel, which this is not.
        let tests = [
            "bank",
            "calibration",
            "detector",
            "phantom",
            "servo",
            "vectors",
        ];
        command
            .args("-m pytest -x -q -p no:cacheprovider".split(' '))
            .args(tests.map(|name| format!("bindings/python/tests/test_{name}.py")))
            .current_dir(&self.copy.root)
            .env("PYTHONPATH", self.target.join("module"));
        let output = run(&mut command, planted);
        let said = String::from_utf8_lossy(&output.stdout);
        let failed = said.lines().find_map(|line| line.strip_prefix("FAILED "));
        match output.status.code() {
            Some(0) => None,
            Some(1) => Some(failed.expect(&said).split(' ').next().unwrap().to_string()),
            _ => panic!("pytest: {said}{}", String::from_utf8_lossy(&output.stderr)),
        }
    }

    /// Cargo in the copy.
    fn cargo(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO"));
        command
            .args(arguments.split(' '))
            .current_dir(&self.copy.root)
            .env("CARGO_TARGET_DIR", &self.target)
            .env("CARGO_INCREMENTAL", "0")
            .env("INSTA_UPDATE", "no")
            // That of the run which this test is in: 1, for its output is shown.
            .env_remove("NEXTEST_TEST_THREADS");
        command
    }

    /// A file that cargo wrote.
    fn json(&self, name: &str) -> PathBuf {
        self.target.join(name).with_extension("json")
    }
}

/// Runs a command with a defect on.
fn run(command: &mut Command, planted: Option<usize>) -> Output {
    if let Some(number) = planted {
        command.env(VARIABLE, number.to_string());
    }
    command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"))
}

/// Program and name of the first test that failed.
fn first_failure(junit: &str) -> String {
    let document = Document::parse(junit).unwrap();
    let failed = document.descendants().find(|node| {
        let has = |tag: &str| node.children().any(|child| child.has_tag_name(tag));
        node.has_tag_name("testcase") && (has("failure") || has("error"))
    });
    let test = failed.expect("a test that failed");
    let name =
        |node: roxmltree::Node<'_, '_>| node.attribute("name").unwrap_or_default().to_string();
    format!("{} {}", name(test.parent().unwrap()), name(test))
}
