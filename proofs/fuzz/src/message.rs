//! What a refusal must say.

use palpate::refusal::Refusal;

/// Checks that a message is one line without control characters, which a terminal would obey.
pub fn check_message(message: &str) {
    assert!(!message.is_empty(), "an empty message");
    assert!(
        !message.chars().any(char::is_control),
        "control characters in {message:?}"
    );
}

/// Checks a message about a file: it begins with the file and, if there is one, the line, which is
/// a line of the text.
pub fn check_file_message(refusal: &Refusal, text: &str) {
    let message = refusal.to_string();
    check_message(&message);
    let place = match refusal.line {
        Some(line) => format!("{}:{line}: ", crate::FILE),
        None => format!("{}: ", crate::FILE),
    };
    assert!(
        message.starts_with(&place),
        "{message:?} without {place:?} in front"
    );
    if let Some(line) = refusal.line {
        check_line(line, text);
    }
}

/// The lines of a table, which end in a carriage return alone where there is no line feed.
pub fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.split_terminator(if text.contains('\n') { '\n' } else { '\r' })
}

/// Checks that a line is one of the text, or the one after its end.
pub fn check_line(line: usize, text: &str) {
    let lines = lines(text).count();
    assert!(
        (1..=lines + 1).contains(&line),
        "line {line} of a text of {lines}"
    );
}

/// Checks a message without a file about one of the lines of the text, and gives what it may quote of that.
pub fn check_quoting(refusal: &Refusal, text: &str) -> String {
    check_message(&refusal.to_string());
    let line = refusal.line.expect("a line");
    check_line(line, text);
    let there = text.lines().nth(line - 1).unwrap_or_default();
    let start: String = there.chars().take(80).collect();
    format!("{start:?}")
}
