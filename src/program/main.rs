//! The `palpate` program: see `palpate --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    palpate_program::main(std::env::args_os())
}
