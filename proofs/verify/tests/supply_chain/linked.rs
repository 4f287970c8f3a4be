//! What the program takes from the system's libraries.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::ROOT;
use super::package::sources;

/// Functions of the mathematical library whose result is rounded, so that it may differ between libraries.
const ROUNDED: [&str; 27] = [
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "erf",
    "erfc", "exp", "exp2", "expm1", "hypot", "lgamma", "log", "log10", "log1p", "log2", "pow",
    "sin", "sinh", "tan", "tanh", "tgamma",
];

/// What plotters, hdrhistogram and indicatif call.
const OF_OTHERS: [&str; 5] = ["hypotf", "log", "log10", "log2", "pow"];

/// The methods of f32 and f64 that end in such a function.
const METHODS: [&str; 25] = [
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "exp",
    "exp2", "exp_m1", "hypot", "ln", "ln_1p", "log", "log10", "log2", "powf", "sin", "sin_cos",
    "sinh", "tan", "tanh",
];

/// The program, which stands beside this package's; `cargo test --workspace` builds both.
fn palpate() -> PathBuf {
    let program = Path::new(env!("CARGO_BIN_EXE_palpate-verify")).with_file_name("palpate");
    assert!(program.exists(), "first: cargo build -p palpate-program");
    program
}

fn said(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program)
        .args(arguments)
        .arg(palpate())
        .output()
        .unwrap_or_else(|error| panic!("{program}, which comes with every linker: {error}"));
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_program_needs_the_c_library_and_the_unwinder_alone() {
    let told = said("readelf", &["--dynamic", "--wide"]);
    let needed: BTreeSet<&str> = (told.lines())
        .filter(|line| line.contains("(NEEDED)"))
        .map(|line| line.split(['[', ']']).nth(1).unwrap())
        // The loader itself is part of the C library.
        .filter(|name| !name.starts_with("ld-linux"))
        .collect();
    let known = BTreeSet::from(["libc.so.6", "libgcc_s.so.1", "libm.so.6"]);
    assert!(needed.contains("libc.so.6"), "{told}");
    assert!(needed.is_subset(&known), "{needed:?}");
}

#[test]
fn no_rounded_function_of_the_system_is_taken_but_for_figures_and_progress() {
    let told = said("nm", &["--dynamic", "--undefined-only"]);
    let names = told.lines().filter_map(|line| {
        let symbol = line.split_whitespace().last()?;
        symbol.split('@').next()
    });
    let taken: BTreeSet<&str> = names
        .filter(|name| {
            let double = name.strip_suffix('f').unwrap_or(name);
            ROUNDED.contains(name) || ROUNDED.contains(&double)
        })
        .collect();
    assert!(told.contains("memcpy"), "{told}");
    assert!(taken.is_subset(&OF_OTHERS.into()), "{taken:?}");
}

#[test]
fn our_sources_call_none() {
    let mut files = Vec::new();
    // What ships, and the exact solutions, whose figures are the same everywhere.
    for folder in ["src", "proofs/verify/src/fem"] {
        sources(&Path::new(ROOT).join(folder), &mut files);
    }
    let of_tests = |file: &Path| {
        file.iter().any(|part| {
            ["examples", "tests", "tests.rs"]
                .iter()
                .any(|name| part == *name)
        })
    };
    let shipped: Vec<_> = files.iter().filter(|file| !of_tests(file)).collect();
    assert!(shipped.len() > 150, "{} files", shipped.len());
    for file in shipped {
        let text = std::fs::read_to_string(file).unwrap();
        // Modules of tests are the last thing in a file.
        let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for (number, line) in (1..).zip(text.lines()) {
            if line.trim_start().starts_with("//") {
                continue;
            }
            for method in METHODS {
                let called = [
                    format!(".{method}("),
                    format!("f64::{method}"),
                    format!("f32::{method}"),
                ];
                let found = called.iter().any(|call| line.contains(&**call));
                assert!(!found, "{}:{number}: {line}", file.display());
            }
        }
    }
}
