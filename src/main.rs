//! The `palpate` program: see `palpate --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    palpate::cli::main(std::env::args_os())
}
