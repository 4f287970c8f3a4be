//! Tables with captions, scopes and units.

use std::fmt::Write;

/// A table that scrolls inside its own box. All text in it is markup.
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
    /// Rows that become blocks on a narrow page, for long text.
    Stack,
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

fn class(class: &str) -> String {
    match class {
        "" => String::new(),
        class => format!(" class=\"{class}\""),
    }
}

impl Table<'_> {
    /// The table's markup.
    ///
    /// Implements: REP-061.
    pub fn markup(&self) -> String {
        let kind = class(match self.layout {
            Layout::Rows => "",
            Layout::Dense => "dense",
            Layout::Stack => "stack",
        });
        let mut markup = format!(
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"{id}\">\n<table{kind}>\n\
             <caption><div id=\"{id}\">{caption}</div></caption>\n<thead><tr>",
            id = self.id,
            caption = self.caption
        );
        for (name, kind) in self.head {
            markup += &format!("<th scope=\"col\"{}>{name}</th>", class(kind));
        }
        markup += "</tr></thead>\n";
        for group in &self.groups {
            markup += "<tbody>\n";
            if !group.heading.is_empty() {
                let width = self.head.len();
                // Writing to a String does not fail.
                let _ = writeln!(
                    markup,
                    "<tr><th scope=\"rowgroup\" colspan=\"{width}\" class=\"group\">{}</th></tr>",
                    group.heading
                );
            }
            for row in &group.rows {
                markup += &self.row(row);
            }
            markup += "</tbody>\n";
        }
        markup + "</table>\n</div>\n"
    }

    fn row(&self, row: &[String]) -> String {
        let mut markup = String::from("<tr>");
        for (k, (cell, (name, kind))) in row.iter().zip(self.head).enumerate() {
            let kind = class(kind);
            markup += &match k {
                0 => format!("<th scope=\"row\"{kind}>{cell}</th>"),
                // Only tables that stack show the name, and their heads are plain words.
                _ if self.layout == Layout::Stack => {
                    format!("<td{kind} data-name=\"{name}\">{cell}</td>")
                }
                _ => format!("<td{kind}>{cell}</td>"),
            };
        }
        markup + "</tr>\n"
    }
}
