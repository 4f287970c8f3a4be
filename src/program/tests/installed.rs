//! The program as it is installed. The tests of what it does are in `tests/`, beside the other crates' ones; this one has cargo build
//! it, for those that run it beside another program.

use std::process::Command;

#[test]
fn the_program_tells_its_version() {
    let output = Command::new(env!("CARGO_BIN_EXE_palpate"))
        .arg("-V")
        .output()
        .unwrap();
    let version = concat!("palpate ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(String::from_utf8_lossy(&output.stdout), version);
}
