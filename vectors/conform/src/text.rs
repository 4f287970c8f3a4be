//! Text that is quoted in messages and pages.

use serde_json::Value;

/// A value as text, cut if it is long.
pub fn shortened(value: &Value) -> String {
    cut(&value.to_string())
}

/// A text of at most some 200 characters, without those that control a terminal.
pub fn cut(text: &str) -> String {
    const MOST: usize = 200;
    let mut cut: String = text.chars().take(MOST).map(plain).collect();
    if text.chars().nth(MOST).is_some() {
        cut.push('…');
    }
    cut
}

/// A character, or U+FFFD for one that controls a terminal.
pub fn plain(c: char) -> char {
    if c.is_control() { '\u{fffd}' } else { c }
}

/// Text between tags or quotes of XML and HTML; characters that XML does not have become U+FFFD.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\0'..='\x1f' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            _ => out.push(character),
        }
    }
    out
}
