//! What `cargo package` puts into the package.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::{ROOT, cargo};

/// All Rust files below a folder.
pub fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The crates that are published, the folder of each, and how many files their sources include.
const CRATES: [(&str, &str, usize); 4] = [
    ("palpate-core", "src/core", 0),
    ("palpate", "src/palpate", 3),
    ("palpate-paper", "src/paper", 4),
    ("palpate-program", "src/program", 0),
];

#[test]
fn a_package_has_every_file_that_its_sources_include() {
    for (package, folder, least) in CRATES {
        let listed = cargo(&["package", "--list", "--allow-dirty", "--package", package]);
        let listed: BTreeSet<&str> = listed.lines().collect();
        let root = Path::new(ROOT).join(folder).canonicalize().unwrap();
        let mut files = Vec::new();
        sources(&root, &mut files);
        let mut included = 0;
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            for part in text.split("include_str!(\"").skip(1) {
                let name = part.split('"').next().unwrap();
                let path = file.with_file_name(name).canonicalize().unwrap();
                let path = path.strip_prefix(&root).unwrap().to_str().unwrap();
                assert!(
                    listed.contains(path),
                    "{path}, which {} includes",
                    file.display()
                );
                included += 1;
            }
        }
        assert!(included >= least, "{package}: {included} found");
        for name in ["Cargo.lock", "Cargo.toml", "lib.rs"] {
            assert!(listed.contains(name), "{package}: {name}");
        }
    }
}
