//! Records from which sources, by which compiler and how the library is built, for `palpate::version`.
//!
//! Nothing of it is a time or a folder of the machine, so that the same sources give the same program. A
//! development build records no commit: it would have to be built again after each one.

use std::env;
use std::path::Path;
use std::process::Command;

/// What the program is made from.
const SOURCES: [&str; 6] = [
    "Cargo.toml",
    "Cargo.lock",
    "src",
    "proofs",
    "spec",
    "vectors",
];

/// The folder of the checkout.
const ROOT: &str = "../..";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let commit = match variable("PROFILE").as_str() {
        "release" => commit(),
        _ => "not recorded: development build".into(),
    };
    record("COMMIT", &commit);
    record("COMPILER", &compiler());
    record("TARGET", &variable("TARGET"));
    record("PROFILE", &variable("PROFILE"));
    record("OPTIMISATION", &variable("OPT_LEVEL"));
    record("FLAGS", &flags(&variable("CARGO_ENCODED_RUSTFLAGS")));
    record("PROCESSOR", &variable("CARGO_CFG_TARGET_FEATURE"));
}

/// A variable that cargo sets; empty if it does not.
fn variable(name: &str) -> String {
    env::var(name).unwrap_or_default()
}

/// Hands a value to the library's `env!`.
fn record(name: &str, value: &str) {
    println!("cargo::rustc-env=PALPATE_BUILD_{name}={value}");
}

/// The commit, followed by ` with changes` if the sources differ from it; `unknown` where nothing tells.
fn commit() -> String {
    // A package that was downloaded says itself from which commit it was made; it may lie in another's repository.
    if let Ok(package) = std::fs::read_to_string(".cargo_vcs_info.json") {
        println!("cargo::rerun-if-changed=.cargo_vcs_info.json");
        let id = package.split("\"sha1\"").nth(1);
        let id = id.and_then(|rest| rest.split('"').nth(1)).map(String::from);
        let packed = package.split_whitespace().collect::<String>();
        return described(id, packed.contains("\"dirty\":true"));
    }
    let is_checkout = env::current_dir().is_ok_and(|folder| folder.ends_with("src/palpate"));
    if !is_checkout || !Path::new(ROOT).join(".git").exists() {
        return described(None, false);
    }
    let watched = ["HEAD", "logs/HEAD"].map(|file| git(&["rev-parse", "--git-path", file]));
    let watched = watched.into_iter().flatten();
    for path in watched.chain(SOURCES.map(String::from)) {
        let path = Path::new(ROOT).join(path);
        // One that does not exist would have the library built anew each time.
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    let status = [&["status", "--porcelain", "--"][..], &SOURCES].concat();
    // Where git cannot tell, nothing is claimed.
    match git(&status) {
        Some(status) => described(git(&["rev-parse", "HEAD"]), !status.is_empty()),
        None => described(None, false),
    }
}

fn described(id: Option<String>, changed: bool) -> String {
    let hexadecimal = |id: &String| id.len() >= 40 && id.chars().all(|c| c.is_ascii_hexdigit());
    match (id.filter(hexadecimal), changed) {
        (Some(id), false) => id,
        (Some(id), true) => format!("{id} with changes"),
        (None, _) => "unknown".into(),
    }
}

/// What git answers here, whatever repository a hook that runs this build belongs to; it writes nothing.
fn git(arguments: &[&str]) -> Option<String> {
    let mut command = Command::new("git");
    for name in ["GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"] {
        command.env_remove(name);
    }
    command.current_dir(ROOT).arg("--no-optional-locks");
    let output = command.args(arguments).output();
    let output = output.ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_string())
}

/// The compiler's version with its own commit and date.
fn compiler() -> String {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).arg("--version").output();
    let version = output.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_string());
    version.unwrap_or_else(|_| "unknown".into())
}

/// The compiler's flags, but for those that rename folders: they name the machine's, and change no instruction.
fn flags(encoded: &str) -> String {
    let mut flags = Vec::new();
    let mut given = encoded.split('\x1f');
    while let Some(flag) = given.next() {
        if flag == "--remap-path-prefix" {
            given.next();
        } else if !flag.starts_with("--remap-path-prefix=") {
            flags.push(flag);
        }
    }
    flags.join(" ").trim().to_string()
}
