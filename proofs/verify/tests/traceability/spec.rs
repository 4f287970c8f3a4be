//! The numbered requirements of the chapters in `spec/`.

use std::collections::BTreeMap;

use palpate_verify::test_run::Requirement;
use pulldown_cmark::{Event, Parser};

use crate::annotations::Problems;
use crate::repository::Repository;

/// A requirement that nothing is traced to yet, and where it is defined.
pub struct Defined {
    pub requirement: Requirement,
    pub path: String,
    pub line: usize,
}

/// The requirements of all chapters, by their ids.
pub fn requirements(repository: &Repository, problems: &mut Problems) -> BTreeMap<String, Defined> {
    let mut found: BTreeMap<String, Defined> = BTreeMap::new();
    let chapters = repository.files.iter();
    for (path, text) in
        chapters.filter(|(path, _)| path.starts_with("spec/") && path.ends_with(".md"))
    {
        let lines: Vec<&str> = text.lines().collect();
        for (index, line) in lines.iter().enumerate() {
            let mut refuse = |message| problems.insert((path.clone(), index + 1, message));
            let Some((id, sentence)) = definition(&lines[index..]) else {
                // The page on the conventions shows what a requirement looks like.
                let shown = line.contains("`**");
                if let Some(id) = bold_id(line).filter(|_| !shown) {
                    refuse(format!(
                        "**{id}** begins neither an item of a list nor a row of a table, so it states no requirement"
                    ));
                }
                continue;
            };
            if line.starts_with("- ") && !sentence.contains("MUST") {
                refuse(format!("{id} has no MUST"));
            }
            if let Some(first) = found.get(&id) {
                let (path, line) = (&first.path, first.line);
                refuse(format!(
                    "{id} is defined a second time; first in {path}:{line}"
                ));
                continue;
            }
            let defined = Defined {
                requirement: Requirement {
                    id: id.clone(),
                    chapter: path.trim_start_matches("spec/").into(),
                    text: without_markdown(&sentence),
                    ..Requirement::default()
                },
                path: path.clone(),
                line: index + 1,
            };
            found.insert(id, defined);
        }
    }
    found
}

/// Id and sentence of the requirement that begins on the first of these lines: an item of a list, with the lines
/// indented below it, or a row of a table.
fn definition(lines: &[&str]) -> Option<(String, String)> {
    let (first, below) = lines.split_first()?;
    let text = first.strip_prefix("| **").or(first.strip_prefix("- **"))?;
    let id = bold_id(first).filter(|id| text.starts_with(id.as_str()))?;
    let text = text[id.len()..].strip_prefix("** ")?;
    if first.starts_with('|') {
        let cells: Vec<&str> = text
            .split('|')
            .map(str::trim)
            .filter(|cell| !cell.is_empty())
            .collect();
        return Some((id, cells.join(" | ")));
    }
    let below = below.iter().take_while(|line| line.starts_with("  "));
    let sentence: Vec<&str> = [text]
        .into_iter()
        .chain(below.copied())
        .map(str::trim)
        .collect();
    Some((id, sentence.join(" ")))
}

/// The first `**ABC-123**` of a line.
fn bold_id(line: &str) -> Option<String> {
    let mut bold = line.split("**").skip(1).step_by(2);
    bold.find(|bold| is_id(bold)).map(String::from)
}

/// Whether this is three letters, a hyphen and three digits.
pub fn is_id(text: &str) -> bool {
    let bytes = text.as_bytes();
    bytes.len() == 7
        && bytes[..3].iter().all(u8::is_ascii_uppercase)
        && bytes[3] == b'-'
        && bytes[4..].iter().all(u8::is_ascii_digit)
}

/// The words, with links as theirs.
fn without_markdown(text: &str) -> String {
    let words = Parser::new(text).filter_map(|event| match event {
        Event::Text(words) | Event::Code(words) | Event::InlineHtml(words) => {
            Some(words.into_string())
        }
        _ => None,
    });
    words.collect()
}
