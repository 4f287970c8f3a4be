//! Tables with captions, scopes and units, of any number of columns.

use askama::Template;

/// A table that scrolls inside its own box. All text in it is markup.
#[derive(Template)]
#[template(path = "report/table.html")]
pub struct Table<'a> {
    /// The id of its caption, unique on the page.
    pub id: &'a str,
    /// What it shows, above it; stays in sight where the table scrolls.
    pub caption: &'a str,
    /// How it is set.
    pub layout: Layout,
    /// The head of each column with its class, `""` for none.
    pub head: &'a [(&'a str, &'a str)],
    /// Groups of rows; the first cell of a row heads it.
    pub groups: Vec<Group>,
}

/// How a table is set.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Rows of cells.
    Rows,
    /// Rows of cells close together, for many.
    Dense,
    /// Rows that become blocks on a narrow page, for long text: heads are plain words.
    Stack,
}

impl Layout {
    fn class(self) -> &'static str {
        match self {
            Layout::Rows => "",
            Layout::Dense => "dense",
            Layout::Stack => "stack",
        }
    }
}

/// Rows that belong together.
pub struct Group {
    /// What they have in common; empty for a table of one group.
    pub heading: String,
    /// The rows: cells in the order of the head, the last ones may be missing.
    pub rows: Vec<Vec<String>>,
}

impl Group {
    /// Rows without a heading.
    pub fn plain(rows: Vec<Vec<String>>) -> Vec<Group> {
        vec![Group {
            heading: String::new(),
            rows,
        }]
    }
}

impl Table<'_> {
    /// The table's markup.
    ///
    /// Implements: REP-061.
    pub fn markup(&self) -> String {
        // Writing to a String does not fail.
        self.render().expect("a table of text")
    }
}
