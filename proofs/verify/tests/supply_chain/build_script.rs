//! `src/palpate/build.rs`, compiled by itself and run in folders of several kinds.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use super::ROOT;
use super::present::present;

/// The compiled build script.
fn script() -> &'static Path {
    static SCRIPT: OnceLock<PathBuf> = OnceLock::new();
    SCRIPT.get_or_init(|| {
        // Other processes may compile it at the same time: each under its own name.
        let name = format!("build-script-{}", std::process::id());
        let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let status = Command::new("rustc")
            .args(["--edition=2024", "-o"])
            .arg(&program)
            .arg(format!("{ROOT}/src/palpate/build.rs"))
            .status();
        assert!(status.unwrap().success());
        let common = program.with_file_name("build-script");
        fs::rename(&program, &common).unwrap();
        common
    })
}

/// Where the package of the build script lies in the checkout.
const PACKAGE: &str = "src/palpate";

/// An empty folder with a source file and a lock file.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("build-identity")
        .join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join(PACKAGE)).unwrap();
    fs::write(folder.join(PACKAGE).join("lib.rs"), "").unwrap();
    fs::write(folder.join("Cargo.lock"), "").unwrap();
    folder
}

fn git(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new("git")
        .args(["-c", "user.name=test", "-c", "user.email=test@localhost"])
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap().trim().into()
}

/// A folder whose files are all in one commit; and the commit. None where a machine has no git.
fn repository(name: &str) -> Option<(PathBuf, String)> {
    let is_missing = Command::new("git").arg("--version").output().is_err();
    if !present(is_missing.then_some("git")) {
        return None;
    }
    let folder = folder(name);
    git(&folder, &["init", "--quiet"]);
    git(&folder, &["add", "."]);
    git(&folder, &["commit", "--quiet", "--message=all"]);
    let id = git(&folder, &["rev-parse", "HEAD"]);
    Some((folder, id))
}

/// All that the build script of a package prints.
fn output(package: &Path, profile: &str, flags: &str) -> String {
    let output = Command::new(script())
        .current_dir(package)
        .env("PROFILE", profile)
        .env("TARGET", "some-target")
        .env("CARGO_ENCODED_RUSTFLAGS", flags)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// What it records.
fn recorded(package: &Path, profile: &str, flags: &str) -> BTreeMap<String, String> {
    let output = output(package, profile, flags);
    let pairs = output.lines().filter_map(|line| {
        let pair = line.strip_prefix("cargo::rustc-env=PALPATE_BUILD_")?;
        let (name, value) = pair.split_once('=')?;
        Some((name.to_string(), value.to_string()))
    });
    pairs.collect()
}

fn commit(package: &Path) -> String {
    recorded(package, "release", "")["COMMIT"].clone()
}

#[test]
fn a_release_build_records_the_commit_and_whether_sources_differ() {
    let Some((folder, id)) = repository("release") else {
        return;
    };
    let package = folder.join(PACKAGE);
    assert_eq!(commit(&package), id);
    // Not a source of the program.
    fs::write(folder.join("notes.txt"), "").unwrap();
    assert_eq!(commit(&package), id);
    // A new file, a changed one, and one that was only put up for the next commit.
    fs::write(folder.join("src/new.rs"), "").unwrap();
    assert_eq!(commit(&package), format!("{id} with changes"));
    fs::remove_file(folder.join("src/new.rs")).unwrap();
    assert_eq!(commit(&package), id);
    fs::write(folder.join("Cargo.lock"), "changed").unwrap();
    assert_eq!(commit(&package), format!("{id} with changes"));
    git(&folder, &["add", "Cargo.lock"]);
    assert_eq!(commit(&package), format!("{id} with changes"));
    // Cargo runs it again after a commit.
    let watched = output(&package, "release", "");
    for path in ["../../.git/logs/HEAD", "../../src"] {
        let line = format!("cargo::rerun-if-changed={path}\n");
        assert!(watched.contains(&line), "{watched}");
    }
}

#[test]
fn a_development_build_records_no_commit_and_does_not_watch_for_one() {
    let Some((folder, _)) = repository("development") else {
        return;
    };
    let told = output(&folder.join(PACKAGE), "debug", "");
    let development = "PALPATE_BUILD_COMMIT=not recorded: development build\n";
    assert!(told.contains(development), "{told}");
    assert!(!told.contains(".git"), "{told}");
}

#[test]
fn a_package_names_the_commit_that_it_was_made_from() {
    // It lies within the repository of another.
    let Some((outer, _)) = repository("packages") else {
        return;
    };
    let folder = outer.join("vendor/palpate");
    fs::create_dir_all(&folder).unwrap();
    let id = "0123456789abcdef0123456789abcdef01234567";
    let info = folder.join(".cargo_vcs_info.json");
    let clean = "{\n  \"git\": {\n    \"sha1\": \"ID\"\n  },\n  \"path_in_vcs\": \"\"\n}";
    fs::write(&info, clean.replace("ID", id)).unwrap();
    assert_eq!(commit(&folder), id);
    let dirty = "{\"git\": {\"sha1\": \"ID\", \"dirty\": true}}";
    fs::write(&info, dirty.replace("ID", id)).unwrap();
    assert_eq!(commit(&folder), format!("{id} with changes"));
    fs::write(&info, "{}").unwrap();
    assert_eq!(commit(&folder), "unknown");
    // The other repository's commit is not this package's.
    fs::remove_file(&info).unwrap();
    assert_eq!(commit(&folder), "unknown");
    // One without a commit yet.
    let empty = self::folder("empty");
    git(&empty, &["init", "--quiet"]);
    assert_eq!(commit(&empty.join(PACKAGE)), "unknown");
}

#[test]
fn flags_that_rename_folders_are_left_out() {
    let folder = folder("flags");
    let folder = folder.join(PACKAGE);
    let flags = |encoded: &str| recorded(&folder, "release", encoded)["FLAGS"].clone();
    assert_eq!(flags(""), "");
    let given =
        "-C target-cpu=native --remap-path-prefix /home/a=/b --remap-path-prefix=/home/c=/d -g";
    assert_eq!(
        flags(&given.replace(' ', "\x1f")),
        "-C target-cpu=native -g"
    );
    let all = recorded(&folder, "release", "");
    assert!(all["COMPILER"].starts_with("rustc 1."), "{all:?}");
    assert_eq!(all["TARGET"], "some-target");
    for (name, value) in &all {
        assert!(!value.contains('/'), "{name} = {value}");
    }
}
