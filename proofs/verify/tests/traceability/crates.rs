//! Which file belongs to which program of the workspace, and under which module path, as cargo and rustc find it.

use std::collections::BTreeMap;

use crate::rust::modules_of;
use crate::sources::Repository;

/// A library or program that cargo builds.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crate {
    /// Its root file, from the root of the repository.
    pub root: String,
    /// The root as cargo prints it, from the root of its package.
    pub shown: String,
    /// The name of what is built from it.
    pub name: String,
}

/// The crates of the workspace and the module path of each file in them. A file can be in several.
#[derive(Debug, Default)]
pub struct Crates {
    pub all: Vec<Crate>,
    /// For each file, the crates that hold it with its module path in them.
    pub places: BTreeMap<String, Vec<(Crate, Vec<String>)>>,
}

impl Crates {
    pub fn find(repository: &Repository) -> Crates {
        let packages = packages(repository);
        let mut crates = Crates::default();
        for (folder, package) in &packages {
            let others = packages.iter().map(|(other, _)| other.as_str());
            let nested: Vec<&str> = others
                .filter(|other| other.len() > folder.len() && other.starts_with(folder.as_str()))
                .collect();
            for source in &repository.sources {
                let path = source.path.as_str();
                let Some(shown) = path.strip_prefix(folder.as_str()) else {
                    continue;
                };
                if nested.iter().any(|other| path.starts_with(other)) {
                    continue;
                }
                if let Some(name) = crate_name(shown, package) {
                    let (root, shown) = (path.into(), shown.into());
                    crates.all.push(Crate { root, shown, name });
                }
            }
        }
        for krate in crates.all.clone() {
            crates.follow(repository, &krate, &krate.root, Vec::new());
        }
        crates
    }

    /// Notes the file, and those of the modules that it declares.
    fn follow(&mut self, repository: &Repository, krate: &Crate, path: &str, module: Vec<String>) {
        let Some(source) = repository.source(path) else {
            return;
        };
        let places = self.places.entry(path.into()).or_default();
        places.push((krate.clone(), module.clone()));
        for (name, given) in modules_of(&source.text) {
            let candidates = match given {
                Some(file) => vec![format!("{}{file}", folder_of(path))],
                None => {
                    let below = folder_of_modules(path, &krate.root);
                    vec![format!("{below}{name}.rs"), format!("{below}{name}/mod.rs")]
                }
            };
            for candidate in candidates {
                let module = [module.clone(), vec![name.clone()]].concat();
                self.follow(repository, krate, &candidate, module);
            }
        }
    }
}

/// Folder, with `/` at its end unless it is the root, and name of each package of the workspace.
fn packages(repository: &Repository) -> Vec<(String, String)> {
    let manifests = repository.sources.iter();
    manifests
        .filter(|source| source.file_name() == "Cargo.toml")
        .filter_map(|source| {
            let mut lines = source.text.lines();
            let name = lines.find_map(|line| line.strip_prefix("name = \""))?;
            Some((
                folder_of(&source.path).into(),
                name.trim_matches('"').into(),
            ))
        })
        .collect()
}

/// The name of the crate whose root is this file, if it is the root of one by cargo's conventions.
fn crate_name(shown: &str, package: &str) -> Option<String> {
    if matches!(shown, "src/lib.rs" | "src/main.rs") {
        return Some(package.replace('-', "_"));
    }
    let folders = ["tests/", "benches/", "examples/", "src/bin/"];
    let below = folders
        .iter()
        .find_map(|folder| shown.strip_prefix(folder))?;
    let name = below.strip_suffix(".rs")?;
    let name = name.strip_suffix("/main").unwrap_or(name);
    (!name.contains('/')).then(|| name.into())
}

/// The folder of a path with `/` at its end; empty at the root.
fn folder_of(path: &str) -> &str {
    path.rfind('/').map_or("", |slash| &path[..=slash])
}

/// Where the modules lie that a file declares.
fn folder_of_modules(path: &str, root: &str) -> String {
    if path == root || path.ends_with("/mod.rs") {
        folder_of(path).into()
    } else {
        format!("{}/", path.trim_end_matches(".rs"))
    }
}
