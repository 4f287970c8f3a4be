//! The files that the trace is made from.

use std::fs;
use std::path::Path;

/// A text file of the repository.
#[derive(Debug, Clone)]
pub struct Source {
    /// From the root of the repository, with `/`.
    pub path: String,
    pub text: String,
}

impl Source {
    pub fn file_name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or(&self.path)
    }

    /// What follows the last dot of the name; empty without one.
    pub fn extension(&self) -> &str {
        self.file_name().rsplit_once('.').map_or("", |(_, end)| end)
    }
}

/// Chapters and sources.
#[derive(Debug, Clone, Default)]
pub struct Repository {
    /// The Markdown files of `spec/`.
    pub chapters: Vec<Source>,
    /// Everything else that can hold an annotation, and the manifests.
    pub sources: Vec<Source>,
    /// Paths of the groups of vectors, `vectors/*.json`.
    pub vectors: Vec<String>,
}

/// Endings of the files in which annotations are looked for; scripts such as `tests/same_bits/run` have none.
const EXTENSIONS: [&str; 8] = ["", "g", "js", "md", "py", "rs", "rules", "toml"];

/// Folders at the root without sources of ours.
const LEFT_OUT: [&str; 2] = ["spec", "target"];

impl Repository {
    /// Reads the repository at `root`, in the order of the paths.
    pub fn read(root: &Path) -> Repository {
        let mut repository = Repository::default();
        for path in files(&root.join("spec"), root) {
            if path.ends_with(".md") {
                repository.chapters.push(read(root, path));
            }
        }
        for entry in names(root) {
            let hidden = entry.starts_with('.') && entry != ".ci";
            if hidden || entry.starts_with("target") || LEFT_OUT.contains(&entry.as_str()) {
                continue;
            }
            for path in files(&root.join(entry), root) {
                if path.starts_with("vectors/") && path.ends_with(".json") {
                    repository.vectors.push(path);
                } else {
                    repository.sources.extend(source(root, path));
                }
            }
        }
        repository
    }

    pub fn source(&self, path: &str) -> Option<&Source> {
        self.sources.iter().find(|source| source.path == path)
    }
}

fn source(root: &Path, path: String) -> Option<Source> {
    let empty = Source {
        path,
        text: String::new(),
    };
    let known = EXTENSIONS.contains(&empty.extension());
    let text = fs::read_to_string(root.join(&empty.path)).ok()?;
    known.then_some(Source { text, ..empty })
}

fn read(root: &Path, path: String) -> Source {
    let text = fs::read_to_string(root.join(&path)).expect("a chapter is UTF-8");
    Source { path, text }
}

/// Names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder can be listed");
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
    let mut names: Vec<String> = entries
        .map(|entry| name(entry).to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Paths of all files at and below `path`, from `root`.
fn files(path: &Path, root: &Path) -> Vec<String> {
    if !path.is_dir() {
        let path = path.strip_prefix(root).expect("below the root");
        return vec![path.to_string_lossy().replace('\\', "/")];
    }
    let below = names(path).into_iter();
    below
        .flat_map(|name| files(&path.join(name), root))
        .collect()
}
