//! What stands below an annotation in Rust, read line by line: `cargo fmt` puts every item, attribute and closing brace
//! on a line that begins with it.

/// What an annotation stands above.
#[derive(Debug, PartialEq)]
pub struct Item {
    /// `fn`, `struct`, …; empty for fields and variants.
    pub kind: &'static str,
    pub name: String,
    pub is_test: bool,
    /// The type or trait around it, if it is in one.
    pub owner: Option<String>,
    /// The modules around it that are in the same file.
    pub modules: Vec<String>,
}

/// The item at line `at`, from 0, or below it: comments and attributes may lie between, an empty line may not.
pub fn item_below(text: &str, mut at: usize) -> Option<Item> {
    let lines: Vec<&str> = text.lines().collect();
    let mut is_test = false;
    loop {
        let here = lines.get(at)?.trim();
        if here.starts_with("#[") {
            is_test |= here == "#[test]";
            while !lines.get(at)?.ends_with(']') {
                at += 1;
            }
        } else if !here.starts_with("//") {
            break;
        }
        at += 1;
    }
    let (kind, name) = declaration(lines[at])?;
    let (mut owner, mut modules) = (None, Vec::new());
    let mut inner = indent(lines[at]);
    for line in lines[..at].iter().rev() {
        // The end of a header that began on a line above.
        let continued =
            line.is_empty() || line.trim_start().starts_with(['{', ')']) || line.trim() == "where";
        if continued || indent(line) >= inner {
            continue;
        }
        inner = indent(line);
        match declaration(line) {
            Some(("mod", name)) => modules.insert(0, name),
            Some(("struct" | "enum" | "trait" | "impl", name)) if owner.is_none() => {
                owner = Some(name)
            }
            _ => {}
        }
    }
    Some(Item {
        kind,
        name,
        is_test,
        owner,
        modules,
    })
}

/// What a function `$name` is called: the first argument of each call of the macro that defines it above line `end`.
pub fn names_by_macro(text: &str, end: usize) -> Vec<String> {
    let above = text.lines().take(end);
    let defined = above.filter_map(|line| line.strip_prefix("macro_rules! "));
    let call = defined.last().and_then(identifier).unwrap_or_default();
    let call = format!("\n{call}!(");
    let calls = text.split(&call).skip(1);
    calls
        .filter_map(|call| identifier(call.trim_start()))
        .collect()
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

const KINDS: &str = "fn struct enum trait type const static mod macro_rules!";

/// Kind and name of what is declared on a line.
fn declaration(line: &str) -> Option<(&'static str, String)> {
    let mut rest = line.trim();
    for modifier in ["pub(crate) ", "pub(super) ", "pub ", "async ", "unsafe "] {
        rest = rest.strip_prefix(modifier).unwrap_or(rest);
    }
    if rest.starts_with("const fn ") {
        rest = &rest["const ".len()..];
    }
    if rest.starts_with("impl<") || rest.starts_with("impl ") {
        return Some(("impl", implementor(rest)?));
    }
    let (word, after) = rest.split_once(' ').unwrap_or((rest, ""));
    if let Some(kind) = KINDS.split(' ').find(|kind| *kind == word) {
        return Some((kind, identifier(after)?));
    }
    let name = identifier(rest)?;
    let after = &rest[name.len()..];
    let variant = name.starts_with(|first: char| first.is_ascii_uppercase())
        && (matches!(after, "" | "," | " {") || after.starts_with('(') || after.starts_with(" = "));
    (variant || after.starts_with(": ")).then_some(("", name))
}

/// A name; `$name` in a macro.
fn identifier(text: &str) -> Option<String> {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '$'));
    let name = &text[..end.unwrap_or(text.len())];
    (!name.is_empty()).then(|| name.into())
}

/// The type of `impl<…> Trait<…> for path::Type<…> {`.
fn implementor(header: &str) -> Option<String> {
    let mut depth = 0;
    // What is in angle brackets, and these, is left out.
    let outside = header.chars().filter(|&c| {
        depth += i32::from(c == '<');
        let keep = depth == 0;
        depth -= i32::from(c == '>');
        keep
    });
    let outside: String = outside.collect();
    let (_, of) = outside
        .split_once(" for ")
        .or(outside.split_once("impl "))?;
    let of = of.trim_start_matches(['&', '[']).trim_start_matches("mut ");
    let path = of.split([' ', '{', ']', ';']).next()?;
    path.rsplit("::").next().map(String::from)
}
