//! All defects in one build: each behind a switch at run time, in a copy of the sources alone.
//!
//! Implements: CON-011.

use std::ops::Range;

use syn::visit::{self, Visit};
use syn::{Block, Signature, TypeImplTrait};

use crate::list::{Defect, Entry};

/// The variable of the environment with the number of the defect that is on.
pub const VARIABLE: &str = "PALPATE_PLANTED";

/// What the root of each crate gets. A module of its own, for in a crate without `std` the name is free, in another it is not.
pub const SWITCH: &str = r#"
mod planted_defects {
    extern crate std;
    static NUMBER: std::sync::OnceLock<Option<usize>> = std::sync::OnceLock::new();
    /// Whether the defect of this number is on.
    pub(crate) fn planted(number: usize) -> bool {
        let read = || std::env::var("PALPATE_PLANTED").ok()?.parse().ok();
        *NUMBER.get_or_init(read) == Some(number)
    }
}
#[allow(unused_imports)]
pub(crate) use planted_defects::planted;
"#;

/// A block of statements.
struct Place {
    /// What is between its braces, in bytes.
    inner: Range<usize>,
    /// Whether its statements may stand in both arms of an `if` that runs.
    fits: bool,
}

/// The blocks of a file.
#[derive(Default)]
struct Blocks {
    found: Vec<Place>,
    /// Within a function that the compiler can compute.
    is_const: bool,
    /// The next block is the body of a function that returns a type without a name: two bodies would have two types.
    is_opaque: bool,
}

impl Blocks {
    fn body(&mut self, signature: &Signature, visit: impl FnOnce(&mut Blocks)) {
        let mut output = Opaque(false);
        output.visit_return_type(&signature.output);
        self.is_opaque = output.0;
        let outer = std::mem::replace(&mut self.is_const, signature.constness.is_some());
        visit(self);
        self.is_const = outer;
    }
}

/// Whether a type contains `impl Trait`.
struct Opaque(bool);

impl Visit<'_> for Opaque {
    fn visit_type_impl_trait(&mut self, _: &TypeImplTrait) {
        self.0 = true;
    }
}

impl<'a> Visit<'a> for Blocks {
    fn visit_item_fn(&mut self, node: &'a syn::ItemFn) {
        self.body(&node.sig, |blocks| visit::visit_item_fn(blocks, node));
    }

    fn visit_impl_item_fn(&mut self, node: &'a syn::ImplItemFn) {
        self.body(&node.sig, |blocks| visit::visit_impl_item_fn(blocks, node));
    }

    fn visit_trait_item_fn(&mut self, node: &'a syn::TraitItemFn) {
        self.body(&node.sig, |blocks| visit::visit_trait_item_fn(blocks, node));
    }

    fn visit_block(&mut self, node: &'a Block) {
        let is_opaque = std::mem::take(&mut self.is_opaque);
        let braces = node.brace_token.span;
        self.found.push(Place {
            inner: braces.open().byte_range().end..braces.close().byte_range().start,
            fits: !self.is_const && !is_opaque,
        });
        visit::visit_block(self, node);
    }
}

/// The blocks of a file that hold a defect, each with the numbers of its defects.
struct Switched<'a> {
    sound: &'a str,
    entries: &'a [Entry],
    blocks: Vec<(Range<usize>, Vec<usize>)>,
}

/// A file's text with these defects behind the switch, and those that cannot stand behind it: outside a block, in a constant function, in a
/// body whose type has no name, in a file that is not Rust, or marked so.
pub fn switched(sound: &str, entries: &[Entry], numbers: &[usize]) -> (String, Vec<usize>) {
    let mut blocks = Blocks::default();
    if let Ok(file) = syn::parse_file(sound) {
        blocks.visit_file(&file);
    }
    let mut alone = Vec::new();
    let mut file = Switched {
        sound,
        entries,
        blocks: Vec::new(),
    };
    for &number in numbers {
        let entry = &entries[number];
        let place = entry.defect.place(sound);
        let around =
            |block: &&Place| block.inner.start <= place.start && place.end <= block.inner.end;
        let smallest = blocks.found.iter().filter(around);
        match smallest.min_by_key(|block| block.inner.len()) {
            Some(block) if block.fits && !entry.is_alone => file.add(&block.inner, number),
            _ => alone.push(number),
        }
    }
    // An outer block stands before those in it.
    file.blocks
        .sort_by_key(|(inner, _)| (inner.start, std::cmp::Reverse(inner.end)));
    (file.text(0..sound.len(), 0).0, alone)
}

impl Switched<'_> {
    fn add(&mut self, inner: &Range<usize>, number: usize) {
        match self.blocks.iter_mut().find(|(known, _)| known == inner) {
            Some((_, numbers)) => numbers.push(number),
            None => self.blocks.push((inner.clone(), vec![number])),
        }
    }

    /// A part of the text with the blocks in it, from this one on, behind the switch; and the first block after it.
    fn text(&self, part: Range<usize>, mut next: usize) -> (String, usize) {
        let (mut text, mut at) = (String::new(), part.start);
        while let Some((inner, numbers)) = self.blocks.get(next)
            && inner.end <= part.end
        {
            text += &self.sound[at..inner.start];
            for &number in numbers {
                let with = self.variant(inner, number);
                text += &format!("if crate::planted({number}) {{{with}}} else ");
            }
            let (sound, after) = self.text(inner.clone(), next + 1);
            text += &format!("{{{sound}}}");
            (at, next) = (inner.end, after);
        }
        (text + &self.sound[at..part.end], next)
    }

    /// What is in a block, with a defect.
    fn variant(&self, inner: &Range<usize>, number: usize) -> String {
        let defect = &self.entries[number].defect;
        let place = defect.place(self.sound);
        let [before, after] = [inner.start..place.start, place.end..inner.end];
        [&self.sound[before], &defect.edit[1], &self.sound[after]].concat()
    }
}

#[test]
fn each_defect_stands_behind_its_switch_in_the_smallest_block() {
    let sound = "fn f(x: u8) -> u8 { if x > 1 { x + 2 } else { 3 } }\nconst fn g() -> u8 { 4 }\nfn h() -> impl Fn() { || { 5; } }\n";
    let edits = [
        ["x > 1", "x > 0"],
        ["x + 2", "x"],
        ["x > 1 { x", "x { 1"],
        ["3", "7"],
        ["4", "8"],
        ["||", "move ||"],
        ["5", "9"],
        ["const ", ""],
    ];
    let entries = edits.map(|edit| Entry {
        defect: Defect {
            name: String::new(),
            file: String::new(),
            edit: edit.map(String::from),
            found_by: String::new(),
        },
        class: String::new(),
        is_alone: false,
        is_drawn: false,
    });
    let (text, alone) = switched(sound, &entries, &[0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(alone, [4, 5, 7]);
    let expected = "fn f(x: u8) -> u8 {\
        if crate::planted(0) { if x > 0 { x + 2 } else { 3 } } else \
        if crate::planted(2) { if x { 1 + 2 } else { 3 } } else \
        { if x > 1 {\
        if crate::planted(1) { x } else { x + 2 }} else {\
        if crate::planted(3) { 7 } else { 3 }} }}\n\
        const fn g() -> u8 { 4 }\n\
        fn h() -> impl Fn() { || {if crate::planted(6) { 9; } else { 5; }} }\n";
    assert_eq!(text, expected);
}
