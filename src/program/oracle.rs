//! `palpate oracle`: questions and answers in JSON lines (`spec/oracle.md`).

use std::io::{stdin, stdout};

use clap::Args;

use super::CliError;
use super::output::printed;
use palpate::oracle::serve;

/// Arguments of `palpate oracle`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  echo '{\"id\":1,\"op\":\"error_rates\",\"args\":{\"gamma\":2,\"eta\":0}}' | palpate oracle\n\
    '{\"id\":1,\"op\":\"capabilities\"}' asks for the names of the ops; spec/oracle.md describes them."
)]
pub struct OracleArguments {}

/// Runs the command.
///
/// Implements: ORA-002, ORA-013.
pub fn oracle(OracleArguments {}: &OracleArguments) -> Result<(), CliError> {
    printed(serve(stdin().lock(), stdout().lock()))
}
