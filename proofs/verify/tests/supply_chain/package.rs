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

#[test]
fn the_package_has_every_file_that_its_sources_include() {
    let listed = cargo(&["package", "--list", "--allow-dirty"]);
    let listed: BTreeSet<&str> = listed.lines().collect();
    let root = Path::new(ROOT).canonicalize().unwrap();
    let mut files = Vec::new();
    sources(&root.join("src"), &mut files);
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
    assert!(included >= 7, "{included} found");
    for name in "build.rs Cargo.lock LICENSE-MIT LICENSE-APACHE CHANGELOG.md README.md".split(' ') {
        assert!(listed.contains(name), "{name}");
    }
}
