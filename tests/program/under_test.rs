//! The program `palpate`, built for the tests of this package.

use std::process::ExitCode;

fn main() -> ExitCode {
    palpate_program::main(std::env::args_os())
}
