//! What a refusal must say.

/// Checks that a message is one line without control characters, which a terminal would obey.
///
/// Implements: EVD-082.
pub fn check_message(message: &str) {
    assert!(!message.is_empty(), "an empty message");
    assert!(
        !message.chars().any(char::is_control),
        "control characters in {message:?}"
    );
}

/// Checks a message about a file: it begins with the file and, if there is one, the line, which is
/// a line of the text.
///
/// Implements: EVD-082.
pub fn check_file_message(message: &str, line: Option<usize>, text: &str) {
    check_message(message);
    let place = match line {
        Some(line) => format!("{}:{line}: ", crate::FILE),
        None => format!("{}: ", crate::FILE),
    };
    assert!(
        message.starts_with(&place),
        "{message:?} without {place:?} in front"
    );
    if let Some(line) = line {
        check_line(line, text);
    }
}

/// Checks that a line is one of the text, or the one after its end.
pub fn check_line(line: usize, text: &str) {
    let lines = text.lines().count();
    assert!(
        (1..=lines + 1).contains(&line),
        "line {line} of a text of {lines}"
    );
}
