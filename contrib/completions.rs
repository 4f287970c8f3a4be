//! Writes shell completions and manual pages of `palpate` into a folder: `cargo run --example completions -- DIR`.

use std::io;
use std::path::{Path, PathBuf};

use clap_complete::{Shell, generate_to};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(folder), None) = (arguments.next().map(PathBuf::from), arguments.next()) else {
        return Err("usage: cargo run --example completions -- DIR".into());
    };
    Ok(write(&folder)?)
}

fn write(folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut command = palpate_program::command();
    for shell in [
        Shell::Bash,
        Shell::Elvish,
        Shell::Fish,
        Shell::PowerShell,
        Shell::Zsh,
    ] {
        generate_to(shell, &mut command, "palpate", folder)?;
    }
    clap_mangen::generate_to(command, folder)
}

// Verifies: CLI-001.
#[test]
fn every_command_has_a_page_and_a_completion() {
    let folder = std::env::temp_dir().join(format!("palpate-completions-{}", std::process::id()));
    write(&folder).unwrap();
    let bash = std::fs::read_to_string(folder.join("palpate.bash")).unwrap();
    for command in palpate_program::command().get_subcommands() {
        let name = command.get_name();
        let page = std::fs::read_to_string(folder.join(format!("palpate-{name}.1"))).unwrap();
        assert!(
            page.contains("SYNOPSIS") && bash.contains(&format!("palpate,{name})")),
            "{name}"
        );
    }
    std::fs::remove_dir_all(folder).unwrap();
}
