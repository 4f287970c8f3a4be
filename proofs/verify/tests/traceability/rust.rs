//! What stands below an annotation in Rust, read line by line: `cargo fmt` puts every item, attribute and closing brace
//! on a line that begins with it.

/// What an annotation stands above.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// `fn`, `struct`, …; `field` for fields and variants.
    pub kind: &'static str,
    pub name: String,
    /// The attributes between annotation and item.
    pub attributes: Vec<String>,
    /// The type or trait around it, if it is in one.
    pub owner: Option<String>,
    /// The modules around it that are in the same file.
    pub modules: Vec<String>,
}

/// The modules that a file declares with `mod name;`, each with the file that `#[path]` gives it.
pub fn modules_of(text: &str) -> Vec<(String, Option<String>)> {
    let mut found = Vec::new();
    let mut given = None;
    for line in text.lines().map(str::trim) {
        if let Some(path) = line.strip_prefix("#[path = \"") {
            given = path.strip_suffix("\"]").map(String::from);
        } else if let Some((name, "")) = module_name(line).and_then(|rest| rest.split_once(';')) {
            found.push((name.into(), given.take()));
        } else if !line.starts_with("#[") && !line.starts_with("//") {
            given = None;
        }
    }
    found
}

fn module_name(line: &str) -> Option<&str> {
    without_visibility(line).strip_prefix("mod ")
}

/// The item below an annotation whose last line is before `line`, if it is one that can be named: comments and
/// attributes may lie between, an empty line may not.
pub fn item_below(text: &str, line: usize) -> Option<Item> {
    let lines: Vec<&str> = text.lines().collect();
    let mut at = line;
    let mut attributes = Vec::new();
    loop {
        let here = lines.get(at)?.trim();
        if here.starts_with("#[") {
            let mut attribute = here.to_string();
            while !lines.get(at)?.trim_end().ends_with(']') {
                at += 1;
                attribute.push_str(lines.get(at)?.trim());
            }
            attributes.push(attribute);
        } else if !here.starts_with("//") {
            break;
        }
        at += 1;
    }
    let (kind, name) = kind_and_name(lines[at])?;
    let around = blocks_around(&lines[..at], lines[at]);
    let owner = around.iter().rfind(|block| !block.module);
    let modules = around.iter().filter(|block| block.module);
    Some(Item {
        kind,
        name,
        attributes,
        owner: owner.map(|block| block.name.clone()),
        modules: modules.map(|block| block.name.clone()).collect(),
    })
}

const KINDS: [&str; 10] = [
    "fn",
    "struct",
    "enum",
    "trait",
    "type",
    "const",
    "static",
    "mod",
    "macro_rules!",
    "impl",
];

fn kind_and_name(line: &str) -> Option<(&'static str, String)> {
    let public = line.trim().starts_with("pub");
    let mut rest = without_visibility(line.trim());
    for modifier in ["const fn ", "async fn ", "unsafe fn "] {
        if let Some(after) = rest.strip_prefix(modifier) {
            return Some(("fn", identifier(after)?));
        }
    }
    for kind in KINDS {
        let Some(after) = rest.strip_prefix(kind) else {
            continue;
        };
        if kind == "impl" && after.starts_with(['<', ' ']) {
            return Some((kind, owner_name(rest)?));
        }
        if let Some(after) = after.strip_prefix(' ') {
            return Some((kind, identifier(after)?));
        }
    }
    // A field or a variant.
    rest = rest.trim_end();
    let name = identifier(rest)?;
    let after = &rest[name.len()..];
    let field = public && after.starts_with(':') || after.starts_with(": ");
    let variant =
        matches!(after, "," | "" | " {") || after.starts_with(['(']) || after.starts_with(" = ");
    let variant = variant && name.starts_with(|first: char| first.is_ascii_uppercase());
    (field || variant).then_some(("field", name))
}

fn without_visibility(line: &str) -> &str {
    let Some(rest) = line.strip_prefix("pub") else {
        return line;
    };
    let rest = match rest.strip_prefix('(') {
        Some(scope) => scope.split_once(')').map_or(rest, |(_, rest)| rest),
        None => rest,
    };
    rest.strip_prefix(' ').unwrap_or(line)
}

/// A name; `$name` in a macro.
fn identifier(text: &str) -> Option<String> {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '$'));
    let name = &text[..end.unwrap_or(text.len())];
    (!name.is_empty()).then(|| name.into())
}

/// The names that a function `$name` has at the calls of the macro that defines it above `line`: the first argument of each call
/// in the file.
pub fn names_by_macro(text: &str, line: usize) -> Vec<String> {
    let above: Vec<&str> = text.lines().take(line).collect();
    let defined = above
        .iter()
        .rev()
        .find_map(|line| line.strip_prefix("macro_rules! "));
    let Some(name) = defined.and_then(identifier) else {
        return Vec::new();
    };
    let call = format!("\n{name}!");
    text.split(&call)
        .skip(1)
        .filter_map(|call| identifier(call.trim_start_matches(['(', '{', ' ', '\n'])))
        .collect()
}

struct Block {
    indent: usize,
    name: String,
    module: bool,
}

/// The modules, types, traits and impls that are open where `line` comes after `before`.
fn blocks_around(before: &[&str], line: &str) -> Vec<Block> {
    let mut open: Vec<Block> = Vec::new();
    for line in before {
        let indent = indent(line);
        let content = line.trim();
        if content.starts_with(['}', ')']) {
            open.retain(|block| block.indent < indent);
        }
        let name = match kind_and_name(line) {
            Some(("mod" | "struct" | "enum" | "trait" | "impl", name)) => name,
            _ => continue,
        };
        if !content.ends_with([';', '}']) {
            let module = module_name(content).is_some();
            open.retain(|block| block.indent < indent);
            open.push(Block {
                indent,
                name,
                module,
            });
        }
    }
    open.retain(|block| block.indent < indent(line));
    open
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// The type of `impl<…> Trait<…> for path::Type<…> {`.
fn owner_name(header: &str) -> Option<String> {
    let mut rest = header.strip_prefix("impl")?;
    if rest.starts_with('<') {
        let mut depth = 0;
        let end = rest.find(|c: char| {
            depth += i32::from(c == '<') - i32::from(c == '>');
            depth == 0
        })?;
        rest = &rest[end + 1..];
    }
    let of = rest.split_once(" for ").map_or(rest, |(_, of)| of).trim();
    let of = of.trim_start_matches(['&', '[']).trim_start_matches("mut ");
    let path = of.split(['<', ' ', '{', ']', ';']).next()?;
    path.rsplit("::").next().map(String::from)
}
