//! What stands below a comment in Rust, by the syntax tree.

use std::ops::RangeInclusive;

use proc_macro2::TokenTree;
use syn::parse::{ParseStream, Parser};
use syn::visit::{self, Visit};
use syn::{Attribute, Ident, Token, Type};

/// An item, field or variant that stands below a comment.
#[derive(Debug, Clone)]
pub struct Item {
    pub name: String,
    /// The type or trait around it, if it is in one.
    pub owner: Option<String>,
    /// The modules around it that are in the same file.
    pub modules: Vec<String>,
    pub is_test: bool,
    pub is_ignored: bool,
    /// From its first attribute or docstring to its name, from 1.
    lines: RangeInclusive<usize>,
}

/// A macro that the file defines.
struct Macro {
    name: String,
    lines: RangeInclusive<usize>,
    makes_tests: bool,
}

/// The items of a file, and its macros with what they are called with first.
#[derive(Default)]
pub struct Items {
    items: Vec<Item>,
    macros: Vec<Macro>,
    calls: Vec<(Ident, Item)>,
    owner: Option<String>,
    modules: Vec<String>,
}

impl Items {
    /// Reads a file.
    ///
    /// # Errors
    /// Line, from 1, and message of a syntax error.
    pub fn of(text: &str) -> Result<Items, (usize, String)> {
        let file = syn::parse_file(text)
            .map_err(|error| (error.span().start().line, format!("not Rust: {error}")))?;
        let mut items = Items::default();
        items.visit_file(&file);
        Ok(items)
    }

    /// The item whose name or attributes begin on this line, from 1; in a macro that makes tests, all tests that it makes.
    pub fn at(&self, line: usize) -> Vec<Item> {
        if let Some(around) = self.macros.iter().find(|known| known.lines.contains(&line)) {
            let calls = self.calls.iter().filter(|(name, _)| *name == around.name);
            let made = calls.map(|(_, item)| Item {
                is_test: around.makes_tests,
                ..item.clone()
            });
            return made.collect();
        }
        let at = self.items.iter().filter(|item| item.lines.contains(&line));
        at.min_by_key(|item| *item.lines.end())
            .cloned()
            .into_iter()
            .collect()
    }

    fn item(&self, attributes: &[Attribute], name: String, line: usize) -> Item {
        let has = |name: &str| {
            attributes
                .iter()
                .any(|attribute| attribute.path().is_ident(name))
        };
        let first = attributes
            .iter()
            .map(|attribute| attribute.pound_token.span.start().line);
        Item {
            name,
            owner: self.owner.clone(),
            modules: self.modules.clone(),
            is_test: has("test"),
            is_ignored: has("ignore"),
            lines: first.min().unwrap_or(line)..=line,
        }
    }

    fn add(&mut self, attributes: &[Attribute], name: &Ident) {
        let item = self.item(attributes, name.to_string(), name.span().start().line);
        self.items.push(item);
    }

    /// Adds the functions that a macro such as `proptest!` is called with.
    fn functions(&mut self, input: ParseStream<'_>) -> syn::Result<()> {
        while !input.is_empty() {
            let is_inner = input.peek(Token![#]) && input.peek2(Token![!]);
            let attributes = if is_inner {
                Vec::new()
            } else {
                Attribute::parse_outer(input)?
            };
            let is_function = input.peek(Token![fn]);
            input.parse::<TokenTree>()?;
            if is_function {
                self.add(&attributes, &input.parse()?);
            }
        }
        Ok(())
    }

    fn within(&mut self, owner: String, visit: impl FnOnce(&mut Items)) {
        let outer = self.owner.replace(owner);
        visit(self);
        self.owner = outer;
    }
}

/// Visits a node that is an item with a name.
macro_rules! named {
    ($($visit:ident $node:ident $($signature:ident)?;)*) => {$(
        fn $visit(&mut self, node: &'a syn::$node) {
            self.add(&node.attrs, &node.$($signature.)?ident);
            visit::$visit(self, node);
        }
    )*};
}

/// Visits a type or trait, to which its parts belong.
macro_rules! owners {
    ($($visit:ident $node:ident;)*) => {$(
        fn $visit(&mut self, node: &'a syn::$node) {
            self.add(&node.attrs, &node.ident);
            self.within(node.ident.to_string(), |items| visit::$visit(items, node));
        }
    )*};
}

impl<'a> Visit<'a> for Items {
    named! {
        visit_item_fn ItemFn sig;
        visit_impl_item_fn ImplItemFn sig;
        visit_trait_item_fn TraitItemFn sig;
        visit_item_const ItemConst;
        visit_item_static ItemStatic;
        visit_item_type ItemType;
        visit_impl_item_const ImplItemConst;
        visit_variant Variant;
    }

    owners! {
        visit_item_struct ItemStruct;
        visit_item_enum ItemEnum;
        visit_item_trait ItemTrait;
    }

    fn visit_field(&mut self, node: &'a syn::Field) {
        if let Some(name) = &node.ident {
            self.add(&node.attrs, name);
        }
        visit::visit_field(self, node);
    }

    fn visit_item_impl(&mut self, node: &'a syn::ItemImpl) {
        let name = implementor(&node.self_ty);
        let item = self.item(&node.attrs, name.clone(), node.impl_token.span.start().line);
        self.items.push(item);
        self.within(name, |items| visit::visit_item_impl(items, node));
    }

    fn visit_item_mod(&mut self, node: &'a syn::ItemMod) {
        self.add(&node.attrs, &node.ident);
        self.modules.push(node.ident.to_string());
        visit::visit_item_mod(self, node);
        self.modules.pop();
    }

    fn visit_item_macro(&mut self, node: &'a syn::ItemMacro) {
        let tokens = &node.mac.tokens;
        let first = tokens.clone().into_iter().next();
        if let Some(name) = &node.ident {
            self.add(&node.attrs, name);
            let lines = node.mac.delimiter.span();
            self.macros.push(Macro {
                name: name.to_string(),
                lines: lines.open().start().line + 1..=lines.close().end().line,
                makes_tests: tokens.to_string().replace(' ', "").contains("#[test]"),
            });
        } else if let (Some(called), Some(TokenTree::Ident(first))) =
            (node.mac.path.get_ident(), first)
        {
            let item = self.item(&[], first.to_string(), first.span().start().line);
            self.calls.push((called.clone(), item));
        }
        if node.ident.is_none() {
            // What is between them follows no rule.
            let _ = (|input: ParseStream<'_>| self.functions(input)).parse2(tokens.clone());
        }
    }
}

/// The name of the type that an `impl` is of.
fn implementor(of: &Type) -> String {
    match of {
        Type::Path(path) => path.path.segments.last().map(|last| last.ident.to_string()),
        Type::Reference(reference) => Some(implementor(&reference.elem)),
        Type::Array(array) => Some(implementor(&array.elem)),
        Type::Slice(slice) => Some(implementor(&slice.elem)),
        _ => None,
    }
    .unwrap_or_default()
}
