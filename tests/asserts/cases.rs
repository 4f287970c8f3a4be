//! Cases that are data: files in which a part is a heading `## NAME` and the lines under it. Lines that begin with `#`, and empty ones, are for
//! the reader.

use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The lines of a part of a file in `tests/`, with their numbers.
fn part(file: &str, name: &str) -> Vec<(usize, String)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("tests/{file}: {error}"));
    let heading = format!("## {name}");
    let below = (1..)
        .zip(text.lines())
        .skip_while(|(_, line)| *line != heading);
    let lines = below
        .skip(1)
        .take_while(|(_, line)| !line.starts_with("## "));
    let lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let lines: Vec<_> = lines.map(|(number, line)| (number, line.into())).collect();
    assert!(!lines.is_empty(), "tests/{file} has no part {name:?}");
    lines
}

/// Asserts that each line of a part of a file in `tests/` has the answer that is indented below it: one line, in which `[..]` stands for any text.
/// A line may have `\n`, `\r` and `\t` as in Rust, `<BOM>`, `<ESC>`, and `<EMPTY>` where it would be empty.
///
/// # Panics
/// If an answer is another, with the file and the line of the case.
#[track_caller]
pub fn assert_cases(file: &str, name: &str, mut answer: impl FnMut(&str) -> String) {
    let mut wrong = String::new();
    for case in part(file, name).chunks(2) {
        let [(number, asked), (_, expected)] = case else {
            panic!("tests/{file}: the last case of {name:?} has no answer");
        };
        let expected = expected.strip_prefix("    ");
        let expected = expected.unwrap_or_else(|| panic!("tests/{file}:{number}: no answer below"));
        let found = answer(&unescaped(asked));
        if !line_matches(expected, &found) || found.lines().count() > 1 {
            let _ = write!(
                wrong,
                "\ntests/{file}:{number}: {asked}\n  expected {expected}\n  found    {found}"
            );
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// The numbers of a part of a file in `tests/`, whose rows are lines.
pub fn numbers_of<const N: usize>(file: &str, name: &str) -> Vec<[f64; N]> {
    let lines = part(file, name).into_iter().map(|(_, line)| line);
    crate::numbers(&lines.collect::<Vec<_>>().join("\n"))
}

/// A line without its escapes.
fn unescaped(line: &str) -> String {
    let escapes = "\\n \n|\\r \r|\\t \t|<BOM> \u{feff}|<ESC> \u{1b}|<EMPTY> ";
    let escapes = escapes.split('|').filter_map(|pair| pair.split_once(' '));
    escapes.fold(line.into(), |line: String, (name, meant)| {
        line.replace(name, meant)
    })
}

/// A text after `change`, `old -> new`: the first `old` is now `new`.
///
/// # Panics
/// If the text has no `old`.
pub fn changed(text: &str, change: &str) -> String {
    let (old, new) = change.split_once(" ->").expect(change);
    assert!(text.contains(old), "{old:?}");
    text.replacen(old, new.strip_prefix(' ').unwrap_or(new), 1)
}

/// Whether a line is the wanted one, in which `[..]` stands for any text.
pub fn line_matches(wanted: &str, found: &str) -> bool {
    let Some((head, tail)) = wanted.split_once("[..]") else {
        return wanted == found;
    };
    found.strip_prefix(head).is_some_and(|rest| {
        let mut ends = rest.char_indices().map(|(at, _)| at).chain([rest.len()]);
        ends.any(|at| line_matches(tail, &rest[at..]))
    })
}
