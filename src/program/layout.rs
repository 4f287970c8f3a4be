//! How the CSV files of a laboratory are laid out: `--columns` and `--skip-rows`.

use std::path::Path;

use clap::Args;
use palpate::csv::Layout;
use palpate::file::{from_toml, read};
use palpate::refusal::Refusal;
use serde::Deserialize;

/// The options.
#[derive(Debug, Args)]
pub struct LayoutArguments {
    /// Which column holds what, if its name does not tell: a list such as 'position=Z(mm), normal=-Load*0.5[mN]' of position, time, depth,
    /// normal and lateral, each with a name of the header or a number from 1; or a TOML file with such entries in its table [columns]
    #[arg(long, value_name = "LIST|FILE.toml", allow_hyphen_values = true)]
    pub(super) columns: Option<String>,
    /// Lines to leave out at the start of a file
    #[arg(long, value_name = "N", default_value_t = 0)]
    skip_rows: usize,
}

/// A file with a table of columns.
#[derive(Deserialize)]
struct WithColumns {
    columns: Layout,
}

impl LayoutArguments {
    /// The layout that they state.
    ///
    /// Implements: CLI-174.
    pub fn get(&self) -> Result<Layout, Refusal> {
        let columns = |text: &str, file: &str| -> Result<Layout, Refusal> {
            let table: WithColumns = from_toml(text, file)?;
            Ok(table.columns)
        };
        let mut layout = match self.columns.as_deref() {
            None => Layout::default(),
            Some(file) if file.ends_with(".toml") => read(Path::new(file), columns)?,
            Some(list) => list.parse()?,
        };
        layout.skipped = self.skip_rows;
        Ok(layout)
    }
}
