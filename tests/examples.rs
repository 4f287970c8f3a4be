//! Every public item has an example in its documentation (`spec/documentation.md`), found in the sources themselves: the
//! compiler's own lint is unstable, and does not look at what is re-exported from private modules.

#[path = "examples/crate_items.rs"]
mod crate_items;

use std::path::Path;

use crate_items::{Crate, Kind};

/// The lines of the examples in `documentation`: of its blocks of Rust that are compiled and run.
fn examples(documentation: &str) -> Vec<String> {
    let mut examples = Vec::new();
    let mut block: Option<(bool, String)> = None;
    for line in documentation.lines().map(str::trim) {
        match (line.strip_prefix("```"), &mut block) {
            (Some(language), None) => block = Some((is_run(language), String::new())),
            (Some(_), Some((run, text))) => {
                if *run {
                    examples.push(std::mem::take(text));
                }
                block = None;
            }
            (None, Some((_, text))) => *text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    examples
}

/// Does rustdoc compile and run a block with these words after its fence?
fn is_run(language: &str) -> bool {
    let mut words = language.split([',', ' ']).filter(|word| !word.is_empty());
    words.all(|word| word == "rust" || word.starts_with("edition"))
}

/// Does one of `examples` name the method `name`, as `.name(` or `Type::name`?
fn call(examples: &[String], name: &str) -> bool {
    let is_whole =
        |rest: &str| !rest.starts_with(|next: char| next == '_' || next.is_alphanumeric());
    let (called, named) = (format!(".{name}("), format!("::{name}"));
    examples.iter().any(|example| {
        let mut rests = example
            .match_indices(&named)
            .map(|(at, _)| &example[at + named.len()..]);
        example.contains(&called) || rests.any(is_whole)
    })
}

/// Whether an item of `kind` is shown by an example of its own, which asserts something, or of its type.
fn is_shown(kind: Kind, name: &str, documentation: &str, type_documentation: &str) -> bool {
    let asserts = |text: &str| {
        let mut examples = examples(text);
        examples.retain(|example| example.contains("assert"));
        examples
    };
    !asserts(documentation).is_empty()
        || kind == Kind::Method && call(&asserts(type_documentation), name)
}

// Verifies: DOC-010, DOC-011, DOC-012.
#[test]
fn every_public_item_has_an_example() {
    let sources = Crate::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let items = sources.public_items();
    // Not an empty walk: some item of each kind, one of them through a re-export.
    for (path, kind) in [
        ("detect::scan::Scan", Kind::Type),
        ("detect::scan::Scan::maximum", Kind::Method),
        ("detect::required_gamma", Kind::Function),
        ("force_map::ForceTable::sweep", Kind::Method),
        ("hid::HapticDevice", Kind::Type),
    ] {
        let found = items.iter().find(|item| item.path == path);
        assert_eq!(found.map(|item| item.kind), Some(kind), "{path}");
    }
    let without: Vec<&str> = items
        .iter()
        .filter(|item| {
            !is_shown(
                item.kind,
                &item.name,
                &item.documentation,
                &item.type_documentation,
            )
        })
        .map(|item| item.path.as_str())
        .collect();
    assert!(
        without.is_empty(),
        "{} of {} public items have no example that runs and asserts something:\n{}",
        without.len(),
        items.len(),
        without.join("\n")
    );
}

// Verifies: DOC-012.
#[test]
fn what_a_user_can_name_is_found() {
    let sources = Crate::of_text(
        "
        pub mod open {
            mod closed {
                pub struct Shown;
                impl Shown { pub fn new() -> Shown {} fn inner(&self) {} }
                pub struct Hidden;
                impl Hidden { pub fn new() -> Hidden {} }
                pub fn renamed() {}
            }
            pub use closed::{Shown, renamed as named};
            pub use self::other::*;
            mod other { pub trait Device { fn write(&self); } pub(crate) struct Inner; }
            pub use super::far::Far;
            impl Default for Shown { fn default() -> Shown {} }
            pub use std::vec::Vec;
        }
        mod far {
            pub use self::farther::Far;
            mod farther { pub enum Far { Here } }
            impl crate::open::Shown { pub fn elsewhere(&self) {} }
        }
        pub fn free() {}
        fn private() {}
        #[cfg(test)]
        pub mod tests { pub fn helper() {} }
        ",
    );
    let mut found: Vec<String> = sources
        .public_items()
        .into_iter()
        .map(|item| item.path)
        .collect();
    found.sort();
    let expected = [
        "free",
        "open::Device",
        "open::Device::write",
        "open::Far",
        "open::Shown",
        "open::Shown::elsewhere",
        "open::Shown::new",
        "open::named",
    ];
    assert_eq!(found, expected);
}

// Verifies: DOC-010, DOC-011.
#[test]
fn what_counts_as_an_example() {
    let asserted = "Text.\n```\n# use a;\nassert!(a.b(1) == 2);\n```\n";
    for documentation in [
        asserted,
        "```rust\nassert_eq!(1, 1);\n```",
        "```edition2024\nassert!(x);\n```",
    ] {
        assert!(
            is_shown(Kind::Function, "f", documentation, ""),
            "{documentation}"
        );
    }
    for documentation in [
        "assert!(true)",
        "```\nlet x = 1;\n```",
        "```text\nassert!(x)\n```",
        "```ignore\nassert!(x)\n```",
        "```no_run\nassert!(x)\n```",
        "```compile_fail\nassert!(x)\n```",
        "```rust\nlet x = 1;\n```\nassert!",
    ] {
        assert!(
            !is_shown(Kind::Function, "f", documentation, ""),
            "{documentation}"
        );
    }
    // A method, and nothing else, may stand in its type's example, with its whole name.
    assert!(is_shown(Kind::Method, "b", "", asserted));
    assert!(is_shown(
        Kind::Method,
        "new",
        "",
        "```\nassert!(T::new(1).is_ok());\n```"
    ));
    assert!(is_shown(
        Kind::Method,
        "new",
        "",
        "```\nassert!(a.map(T::new));\n```"
    ));
    assert!(!is_shown(
        Kind::Method,
        "ne",
        "",
        "```\nassert!(T::new(1).is_ok());\n```"
    ));
    assert!(!is_shown(Kind::Method, "a", "", asserted));
    assert!(!is_shown(Kind::Method, "ab", "", asserted));
    assert!(!is_shown(Kind::Function, "b", "", asserted));
}
