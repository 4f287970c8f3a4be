//! The files that the trace is made from.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The text of each file, by its path from the root of the repository. Of the vectors only the path counts.
pub type Repository = BTreeMap<String, String>;

/// Endings of the files in which annotations are looked for; scripts such as `tests/same_bits/run` have none.
const ENDINGS: [&str; 9] = ["", "g", "js", "md", "py", "rs", "rules", "sbatch", "toml"];

/// Reads the repository at `root`, without hidden folders and what was built.
pub fn read(root: &Path) -> Repository {
    let mut found = Repository::new();
    for entry in fs::read_dir(root).expect("the root can be listed") {
        let entry = entry.expect("the root can be listed");
        let name = entry.file_name().to_string_lossy().into_owned();
        let left_out = name.starts_with('.') && name != ".ci" || name.starts_with("target");
        if !left_out {
            add(&entry.path(), name, &mut found);
        }
    }
    found
}

fn add(file: &Path, path: String, found: &mut Repository) {
    if let Ok(entries) = fs::read_dir(file) {
        for entry in entries.flatten() {
            let name = format!("{path}/{}", entry.file_name().to_string_lossy());
            add(&entry.path(), name, found);
        }
    } else if ENDINGS.contains(&ending(&path))
        && let Ok(text) = fs::read_to_string(file)
    {
        found.insert(path, text);
    } else if path.starts_with("vectors/") && path.ends_with(".json") {
        found.insert(path, String::new());
    }
}

/// What follows the last dot of the file's name; empty without one.
pub fn ending(path: &str) -> &str {
    let name = path.rsplit('/').next().unwrap_or(path);
    name.rsplit_once('.').map_or("", |(_, ending)| ending)
}

/// A program that cargo builds, and the modules in it that lead to a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// Its root file, from the root of the repository.
    pub root: String,
    /// What cargo prints when it runs the tests: the name of the program, and its root from the root of its package.
    pub shown: String,
    pub modules: Vec<String>,
}

/// The program that holds a Rust file, by cargo's and rustc's conventions: a folder `NAME/` holds the modules of `NAME.rs`.
pub fn program(repository: &Repository, path: &str) -> Option<Program> {
    let mut folders = path.match_indices('/').map(|(slash, _)| &path[..=slash]);
    let folder = folders.rfind(|folder| repository.contains_key(&format!("{folder}Cargo.toml")));
    let folder = folder.unwrap_or_default();
    let manifest = repository.get(&format!("{folder}Cargo.toml"))?;
    let package = manifest.lines().find_map(|line| {
        let name = line.strip_prefix("name = \"")?.strip_suffix('"')?;
        Some(name.replace('-', "_"))
    })?;
    let below = path.strip_prefix(folder)?.strip_suffix(".rs")?;
    let (kind, rest) = below.split_once('/')?;
    let first = rest.split('/').next()?;
    let (roots, name) = match kind {
        "src" => (["src/lib".to_string(), "src/main".into()], package.as_str()),
        _ => (
            [format!("{kind}/{first}/main"), format!("{kind}/{first}")],
            first,
        ),
    };
    let rooted = |root: &String| repository.contains_key(&format!("{folder}{root}.rs"));
    let root = if roots.iter().any(|root| root == below) {
        below
    } else {
        roots.iter().find(|root| rooted(root))?
    };
    let modules = match kind {
        _ if root == below => "",
        "src" => rest,
        _ => rest.strip_prefix(first)?.strip_prefix('/')?,
    };
    let modules = modules
        .split('/')
        .filter(|part| !["", "mod"].contains(part));
    Some(Program {
        root: format!("{folder}{root}.rs"),
        shown: format!("{name} {root}.rs"),
        modules: modules.map(String::from).collect(),
    })
}
