//! A strict reader of the little XML that figures use, so that a slip in escaping shows.

/// The names of all elements and the text between tags, or what is wrong.
pub fn read(document: &str) -> Result<(Vec<String>, String), String> {
    let (mut open, mut seen, mut text) = (Vec::new(), Vec::new(), String::new());
    let is_forbidden = |c: char| c.is_control() && c != '\n' || c == '\u{ffff}';
    if document.contains(is_forbidden) {
        return Err("a character that XML cannot hold".into());
    }
    let mut rest = document;
    while let Some((before, after)) = rest.split_once('<') {
        content(before)?;
        text.push_str(before);
        let (tag, after) = after.split_once('>').ok_or("tag without end")?;
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop().as_deref() != Some(name) {
                return Err(format!("</{name}> closes nothing"));
            }
            continue;
        }
        let is_empty = tag.ends_with('/');
        let tag = tag.strip_suffix('/').unwrap_or(tag);
        let (name, attributes) = tag.split_once(' ').unwrap_or((tag, ""));
        if name.is_empty() || !name.chars().all(|c| c.is_ascii_lowercase()) {
            return Err(format!("element {name:?}"));
        }
        self::attributes(attributes)?;
        seen.push(name.to_string());
        if !is_empty {
            open.push(name.to_string());
        }
    }
    content(rest)?;
    if open.is_empty() {
        Ok((seen, text))
    } else {
        Err(format!("{open:?} left open"))
    }
}

fn attributes(mut rest: &str) -> Result<(), String> {
    let mut names = Vec::new();
    while !rest.trim().is_empty() {
        let (name, after) = rest.split_once("=\"").ok_or("attribute without value")?;
        let name = name.trim();
        let valid = |c: char| c.is_ascii_alphanumeric() || c == '-';
        if name.is_empty() || !name.chars().all(valid) || names.contains(&name) {
            return Err(format!("attribute {name:?}"));
        }
        names.push(name);
        let (value, after) = after.split_once('"').ok_or("value without end")?;
        content(value)?;
        rest = after;
    }
    Ok(())
}

/// Text in which every `&` begins an entity that XML knows.
fn content(text: &str) -> Result<(), String> {
    for part in text.split('&').skip(1) {
        let known = ["lt;", "gt;", "amp;", "quot;", "apos;", "#39;"];
        if !known.iter().any(|entity| part.starts_with(entity)) {
            return Err(format!("entity &{part}"));
        }
    }
    if text.contains('>') {
        Err(format!("> in {text:?}"))
    } else {
        Ok(())
    }
}

#[test]
fn the_reader_itself_finds_faults() {
    assert!(read("<a b=\"1\"><c/>&lt;</a>").is_ok());
    for broken in [
        "<a>",
        "<a></b>",
        "<a b=1/>",
        "<a>&x</a>",
        "<a>\u{0}</a>",
        "<a b=\"1\" b=\"1\"/>",
        "<a b=\"&\"/>",
    ] {
        assert!(read(broken).is_err(), "{broken:?}");
    }
}
