//! The numbered requirements of the chapters in `spec/`.

use crate::problem::Problem;
use crate::sources::Source;

/// A requirement, as its chapter states it.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    pub id: String,
    /// The chapter's file in `spec/`.
    pub chapter: String,
    pub line: usize,
    /// The sentence, without Markdown's marks.
    pub text: String,
    /// Where and why a person looks, if no test can (EVD-029).
    pub inspection: Option<String>,
}

/// What marks a requirement that a person inspects, up to the parenthesis that closes it.
const INSPECTION: &str = "(by inspection:";

/// The requirements of all chapters, in the order of their ids.
///
/// Implements: EVD-022.
pub fn requirements(chapters: &[Source], problems: &mut Vec<Problem>) -> Vec<Requirement> {
    let mut found: Vec<Requirement> = Vec::new();
    for chapter in chapters {
        for requirement in of_chapter(chapter, problems) {
            let id = &requirement.id;
            if let Some(first) = found.iter().find(|first| first.id == *id) {
                let (file, line) = (&first.chapter, first.line);
                let message = format!("{id} is defined a second time; first in spec/{file}:{line}");
                problems.push(Problem::new(&chapter.path, requirement.line, message));
            } else {
                found.push(requirement);
            }
        }
    }
    found.sort_by(|a, b| a.id.cmp(&b.id));
    found
}

fn of_chapter(chapter: &Source, problems: &mut Vec<Problem>) -> Vec<Requirement> {
    let lines: Vec<&str> = chapter.text.lines().collect();
    let mut found = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let mut refuse =
            |message: String| problems.push(Problem::new(&chapter.path, index + 1, message));
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
        let (sentence, inspection) = split_inspection(&sentence);
        if line.starts_with("- ") && !sentence.contains("MUST") {
            refuse(format!("{id} has no MUST"));
        }
        found.push(Requirement {
            id,
            chapter: chapter.file_name().into(),
            line: index + 1,
            text: without_markdown(&sentence),
            inspection: inspection.map(|reason| without_markdown(&reason)),
        });
    }
    found
}

/// Id and sentence of the requirement that begins on the first of these lines: an item of a list, with the lines
/// indented below it, or a row of a table.
fn definition(lines: &[&str]) -> Option<(String, String)> {
    let (first, below) = lines.split_first()?;
    if let Some(row) = first.strip_prefix("| **") {
        let id = bold_id(first).filter(|id| row.starts_with(id.as_str()))?;
        let cells: Vec<&str> = row.split('|').skip(1).map(str::trim).collect();
        let cells: Vec<&str> = cells.into_iter().filter(|cell| !cell.is_empty()).collect();
        return Some((id, cells.join(" | ")));
    }
    let item = first.strip_prefix("- **")?;
    let id = bold_id(first).filter(|id| item.starts_with(id.as_str()))?;
    let mut sentence = item[id.len()..].strip_prefix("** ")?.trim().to_string();
    for line in below.iter().take_while(|line| line.starts_with("  ")) {
        sentence.push(' ');
        sentence.push_str(line.trim());
    }
    Some((id, sentence))
}

/// The first `**ABC-123**` of a line.
fn bold_id(line: &str) -> Option<String> {
    let ids = line.split("**").skip(1).step_by(2);
    ids.filter(|bold| is_id(bold)).map(String::from).next()
}

/// Whether this is three letters, a hyphen and three digits.
pub fn is_id(text: &str) -> bool {
    let bytes = text.as_bytes();
    bytes.len() == 7
        && bytes[..3].iter().all(u8::is_ascii_uppercase)
        && bytes[3] == b'-'
        && bytes[4..].iter().all(u8::is_ascii_digit)
}

/// The sentence, and what the parenthesis at its end says of an inspection.
///
/// Implements: EVD-029.
fn split_inspection(sentence: &str) -> (String, Option<String>) {
    let marked = sentence
        .rsplit_once(INSPECTION)
        .and_then(|(before, after)| {
            let reason = after.trim_end_matches('.').strip_suffix(')')?;
            Some((before.trim().into(), Some(reason.trim().into())))
        });
    marked.unwrap_or_else(|| (sentence.into(), None))
}

/// The text with links as their words, and without marks of bold and code.
fn without_markdown(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(open) = rest.find('[') {
        let (before, link) = rest.split_at(open);
        let parts = link[1..].split_once("](").and_then(|(words, target)| {
            let (_, after) = target.split_once(')')?;
            (!words.contains(']')).then_some((words, after))
        });
        plain.push_str(before);
        let (words, after) = parts.unwrap_or(("[", &link[1..]));
        plain.push_str(words);
        rest = after;
    }
    plain.push_str(rest);
    plain.replace("**", "").replace('`', "")
}
