//! Annotations: comments that name requirements (spec/traceability.md).

use crate::problem::Problem;
use crate::sources::Source;
use crate::spec::is_id;

/// What an annotation says of the requirements that it names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Word {
    /// Served by this code.
    Implements,
    /// Checked by this test.
    Verifies,
    /// Shown for every input in a stated range.
    Proves,
}

impl Word {
    pub const ALL: [Word; 3] = [Word::Implements, Word::Verifies, Word::Proves];

    pub fn text(self) -> &'static str {
        match self {
            Word::Implements => "Implements",
            Word::Verifies => "Verifies",
            Word::Proves => "Proves",
        }
    }
}

/// An annotation and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Annotation {
    pub word: Word,
    pub ids: Vec<String>,
    /// Its first line, from 0.
    pub line: usize,
    /// The line after its last.
    pub end: usize,
}

/// The annotations of a file, in its order.
///
/// Implements: EVD-023.
pub fn annotations(source: &Source, problems: &mut Vec<Problem>) -> Vec<Annotation> {
    let lines: Vec<&str> = source.text.lines().collect();
    let mut found = Vec::new();
    for line in 0..lines.len() {
        match annotation_at(&lines, line, source.extension()) {
            Ok(annotation) => found.extend(annotation),
            Err(message) => problems.push(Problem::new(&source.path, line + 1, message)),
        }
    }
    found
}

/// What a line says as a comment: in Python every line counts, since docstrings have no mark.
fn comment<'a>(line: &'a str, extension: &str) -> Option<&'a str> {
    let line = line.trim();
    let said = match extension {
        "rs" | "js" => {
            let said = line.strip_prefix("//")?;
            said.strip_prefix(['/', '!']).unwrap_or(said)
        }
        "md" => line
            .strip_prefix("<!--")
            .map(|said| said.trim_end_matches("-->"))?,
        "py" => line.trim_start_matches(['#', '"']).trim_end_matches('"'),
        _ => line.strip_prefix('#')?,
    };
    Some(said.trim())
}

fn annotation_at(
    lines: &[&str],
    line: usize,
    extension: &str,
) -> Result<Option<Annotation>, String> {
    let Some(said) = comment(lines[line], extension) else {
        // A page may talk of annotations.
        let found = stray(lines[line]).filter(|_| extension != "md");
        return found.map_or(Ok(None), Err);
    };
    let Some(word) = Word::ALL
        .into_iter()
        .find(|word| said.starts_with(&format!("{}:", word.text())))
    else {
        return stray(said).map_or(Ok(None), Err);
    };
    let mut listed = said[word.text().len() + 1..].trim().to_string();
    let mut end = line + 1;
    while listed.ends_with(',') && end < lines.len() {
        let next = comment(lines[end], extension).unwrap_or_default();
        listed = format!("{listed} {next}");
        end += 1;
    }
    let refused = || {
        format!(
            "{:?} is no annotation, expected \"{}: ABC-001, ABC-002.\"",
            said,
            word.text()
        )
    };
    let (ids, _) = listed.split_once('.').ok_or_else(refused)?;
    let ids: Vec<String> = ids.split(", ").map(String::from).collect();
    if !ids.iter().all(|id| is_id(id)) {
        return Err(refused());
    }
    Ok(Some(Annotation {
        word,
        ids,
        line,
        end,
    }))
}

/// What is wrong with a line that is no annotation but looks like one: the word is misspelt, or it is not at the
/// beginning of a comment.
///
/// Implements: EVD-023.
fn stray(line: &str) -> Option<String> {
    let near = ["implement", "verif", "prove", "proof"];
    let mut said = line.split_whitespace();
    let word = said.next().unwrap_or_default().to_lowercase();
    let id = said.next().and_then(|next| next.get(..7));
    let begins = near.iter().any(|near| word.starts_with(near)) && id.is_some_and(is_id);
    let within = Word::ALL.into_iter().any(|word| {
        let text = format!("{}: ", word.text());
        let after = line.split_once(&text).and_then(|(_, after)| after.get(..7));
        after.is_some_and(is_id)
    });
    (begins || within).then(|| {
        format!(
            "{:?} looks like an annotation, but is none: a comment of its own begins with \"Implements: \", \"Verifies: \" or \"Proves: \"",
            line.trim()
        )
    })
}
