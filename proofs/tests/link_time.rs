//! `examples/panic_free.rs` links, and does not if a panic is planted in it.
#![cfg(not(any(kani, fuzzing)))]

use std::process::{Command, Output};

/// Builds the example with full optimisation across crates.
fn build(flags: &[&str]) -> Output {
    // A folder of its own, so as not to wait for who runs this test.
    let target = concat!(env!("CARGO_TARGET_TMPDIR"), "/link_time");
    Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args([
            "rustc",
            "--profile",
            "link-proof",
            "--features",
            "link-proof",
        ])
        .args(["--example", "panic_free", "--target-dir", target, "--"])
        .args(flags)
        .output()
        .unwrap()
}

// Proves: SRV-001, HID-006.
#[test]
#[ignore = "builds in a profile of its own"]
fn no_path_to_a_panic_is_left() {
    let built = build(&[]);
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{said}");

    // The proof can fail: one assertion in the way, and the linker names the function.
    let built = build(&["--cfg", "planted_panic"]);
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(!built.status.success());
    assert!(said.contains("detected panic in function `step`"), "{said}");
}
