//! `palpate completions` and `palpate man` (`spec/command-line.md`).

use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_complete::{Shell, generate};
use clap_mangen::Man;

use super::output::{make_folder, print, write};
use super::{CliError, command};

/// Arguments of `palpate completions`.
#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell that reads them
    shell: Shell,
}

/// Arguments of `palpate man`.
#[derive(Debug, Args)]
pub struct ManArguments {
    /// Output folder for a page of each command [default: the page of palpate on standard output]
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

/// Runs the command.
///
/// Implements: CLI-223.
pub fn completions(arguments: &CompletionsArguments) -> Result<(), CliError> {
    let mut text = Vec::new();
    generate(arguments.shell, &mut command(), "palpate", &mut text);
    print(&String::from_utf8_lossy(&text))
}

/// Runs the command.
///
/// Implements: CLI-223.
pub fn man(arguments: &ManArguments) -> Result<(), CliError> {
    let mut command = command().disable_help_subcommand(true);
    command.build();
    match &arguments.folder {
        None => print(&page(&Man::new(command))),
        Some(folder) => {
            make_folder(folder)?;
            write_pages(&command, folder)
        }
    }
}

/// Writes the page of a command and of those below it.
fn write_pages(command: &Command, folder: &Path) -> Result<(), CliError> {
    let man = Man::new(command.clone());
    let path = folder.join(man.get_filename());
    write(&path, &page(&man))?;
    print(&format!("{}\n", path.display()))?;
    let mut below = command.get_subcommands();
    below.try_for_each(|command| write_pages(command, folder))
}

fn page(man: &Man) -> String {
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = man.render(&mut text);
    String::from_utf8_lossy(&text).into()
}
