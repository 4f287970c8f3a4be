//! The files from which the requirements are traced, and the programs that cargo builds from them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

/// The files of a repository and its programs.
#[derive(Debug, Default)]
pub struct Repository {
    /// The text of each file, by its path from the root. Of the vectors only the path counts.
    pub files: BTreeMap<String, String>,
    /// Each library, program and test program: its root file, and what cargo-nextest calls it.
    pub programs: Vec<(String, String)>,
}

/// Endings of the files in which annotations are looked for; scripts such as `tests/same_bits/run` have none.
const ENDINGS: [&str; 10] = [
    "", "c", "g", "js", "md", "py", "rs", "rules", "sbatch", "toml",
];

/// What follows the last dot of the file's name; empty without one.
pub fn ending(path: &str) -> &str {
    let name = path.rsplit('/').next().unwrap_or(path);
    name.rsplit_once('.').map_or("", |(_, ending)| ending)
}

impl Repository {
    /// Reads the repository at `root`, without hidden folders and what was built.
    pub fn read(root: &Path) -> Repository {
        let mut repository = Repository {
            files: BTreeMap::new(),
            programs: programs(root),
        };
        for entry in fs::read_dir(root).expect("the root can be listed") {
            let entry = entry.expect("the root can be listed");
            let name = entry.file_name().to_string_lossy().into_owned();
            let left_out = name.starts_with('.') && name != ".ci" || name.starts_with("target");
            if !left_out {
                repository.add(&entry.path(), name);
            }
        }
        repository
    }

    fn add(&mut self, file: &Path, path: String) {
        if let Ok(entries) = fs::read_dir(file) {
            for entry in entries.flatten() {
                let name = format!("{path}/{}", entry.file_name().to_string_lossy());
                self.add(&entry.path(), name);
            }
        } else if ENDINGS.contains(&ending(&path))
            && let Ok(text) = fs::read_to_string(file)
        {
            self.files.insert(path, text);
        } else if path.starts_with("vectors/") && path.ends_with(".json") {
            self.files.insert(path, String::new());
        }
    }

    /// What cargo-nextest calls the program that a Rust file belongs to, and the modules in it that lead to the file: a folder
    /// `NAME/` holds the modules of the program `NAME.rs`, the folder of a `main.rs` or `lib.rs` its modules.
    pub fn program<'a>(&'a self, path: &'a str) -> Option<(&'a str, Vec<&'a str>)> {
        let programs = self.programs.iter().filter_map(|(root, id)| {
            let stem = root.strip_suffix(".rs")?;
            let folder = ["main", "lib"]
                .iter()
                .find_map(|name| stem.strip_suffix(name));
            let below = if root == path {
                ""
            } else {
                let below = path.strip_prefix(folder.unwrap_or(stem))?;
                below.strip_suffix(".rs")?
            };
            (folder.is_some() || below.is_empty() || below.starts_with('/'))
                .then_some((below, id.as_str()))
        });
        // The nearest; of a library and a program in one folder, the library.
        let (below, id) = programs.min_by_key(|(below, id)| (below.len(), id.len()))?;
        let modules = below.split('/').filter(|part| !["", "mod"].contains(part));
        Some((id, modules.collect()))
    }
}

/// What cargo says of the workspace.
fn programs(root: &Path) -> Vec<(String, String)> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version=1"])
        .current_dir(root)
        .output()
        .expect("cargo runs this test");
    let metadata: serde_json::Value =
        serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON");
    let root = fs::canonicalize(root).expect("the root exists");
    let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_string();
    let mut programs = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        for target in package["targets"].as_array().into_iter().flatten() {
            let (package, name) = (text(&package["name"]), text(&target["name"]));
            let id = match &*text(&target["kind"][0]) {
                "custom-build" => continue,
                "test" => format!("{package}::{name}"),
                kind @ ("bin" | "example" | "bench") => format!("{package}::{kind}/{name}"),
                _ => package,
            };
            let file = fs::canonicalize(text(&target["src_path"])).expect("a target has a file");
            if let Ok(file) = file.strip_prefix(&root) {
                programs.push((file.to_string_lossy().into_owned(), id));
            }
        }
    }
    programs
}
