//! The public items of a crate and their documentation, from its sources.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use syn::{Attribute, Expr, ImplItem, Item, Lit, Meta, TraitItem, Type, UseTree, Visibility};

/// What an item is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A struct, enum, union or trait.
    Type,
    /// A free function, or an exported macro.
    Function,
    /// A function of a type or of a trait.
    Method,
}

/// An item that a user of the crate can name.
#[derive(Debug, Clone)]
pub struct PublicItem {
    /// Its path as a user writes it, without the crate.
    pub path: String,
    pub name: String,
    pub kind: Kind,
    /// Its documentation.
    pub documentation: String,
    /// For a method that of its type or trait, and of the block that it stands in.
    pub type_documentation: String,
}

/// The items of each module by the module's path, `["detect", "scan"]`.
pub struct Crate {
    modules: BTreeMap<Vec<String>, Vec<Item>>,
}

impl Crate {
    /// Reads the modules of the library whose `lib.rs` is in `folder`.
    pub fn read(folder: &Path) -> Crate {
        let mut sources = Crate {
            modules: BTreeMap::new(),
        };
        sources.read_module(&folder.join("lib.rs"), folder, Vec::new());
        sources
    }

    /// The crate whose root is `text`, with all its modules in it.
    pub fn of_text(text: &str) -> Crate {
        let mut sources = Crate {
            modules: BTreeMap::new(),
        };
        let root = syn::parse_file(text).unwrap_or_else(|error| panic!("{error}"));
        sources.add_module(root.items, Path::new(""), Vec::new());
        sources
    }

    /// Reads the module at `path` in `file`; `folder` holds the files of the modules in it.
    fn read_module(&mut self, file: &Path, folder: &Path, path: Vec<String>) {
        let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{file:?}: {error}"));
        let items = syn::parse_file(&text).unwrap_or_else(|error| panic!("{file:?}: {error}"));
        self.add_module(items.items, folder, path);
    }

    fn add_module(&mut self, items: Vec<Item>, folder: &Path, path: Vec<String>) {
        for item in &items {
            let Item::Mod(module) = item else { continue };
            if is_test(&module.attrs) {
                continue;
            }
            let name = module.ident.to_string();
            let inner = [path.clone(), vec![name.clone()]].concat();
            let inner_folder = folder.join(&name);
            match &module.content {
                Some((_, items)) => self.add_module(items.clone(), &inner_folder, inner),
                None => {
                    let beside = folder.join(format!("{name}.rs"));
                    let inside = inner_folder.join("mod.rs");
                    let file = if beside.exists() { beside } else { inside };
                    self.read_module(&file, &inner_folder, inner);
                }
            }
        }
        self.modules.insert(path, items);
    }

    /// All public items, by following `pub mod` and `pub use` from the root.
    pub fn public_items(&self) -> Vec<PublicItem> {
        let mut found = Vec::new();
        self.walk(&[], &[], &mut found);
        found
    }

    /// The public items of `module`, which a user knows as `public`.
    fn walk(&self, module: &[String], public: &[String], found: &mut Vec<PublicItem>) {
        for item in &self.modules[module] {
            match item {
                Item::Mod(inner)
                    if is_public(&inner.vis)
                        && !is_test(&inner.attrs)
                        && !is_hidden(&inner.attrs) =>
                {
                    let name = inner.ident.to_string();
                    self.walk(&joined(module, &name), &joined(public, &name), found);
                }
                Item::Use(uses) if is_public(&uses.vis) => {
                    for (target, name) in leaves(&uses.tree, Vec::new()) {
                        self.re_export(module, &target, &name, public, found);
                    }
                }
                item => self.add(module, item, None, public, found),
            }
        }
    }

    /// What `pub use target as name` in `module` makes public.
    ///
    /// Implements: DOC-012.
    fn re_export(
        &self,
        module: &[String],
        target: &[String],
        name: &str,
        public: &[String],
        found: &mut Vec<PublicItem>,
    ) {
        let Some(target) = self.absolute(module, target) else {
            return; // of another crate
        };
        if name == "*" {
            return self.walk(&target, public, found);
        }
        if self.modules.contains_key(&target) {
            return self.walk(&target, &joined(public, name), found);
        }
        let Some((last, home)) = target.split_last() else {
            return;
        };
        for item in &self.modules[home] {
            if name_of(item).as_deref() == Some(last) {
                self.add(home, item, Some(name), public, found);
            } else if let Item::Use(uses) = item {
                // A re-export of a re-export.
                for (inner, inner_name) in leaves(&uses.tree, Vec::new()) {
                    if &inner_name == last {
                        self.re_export(home, &inner, name, public, found);
                    }
                }
            }
        }
    }

    /// The path from the root for `target` as `module` writes it; `None` in another crate.
    fn absolute(&self, module: &[String], target: &[String]) -> Option<Vec<String>> {
        let mut base = module.to_vec();
        let mut rest = target;
        while let Some((first, others)) = rest.split_first() {
            match first.as_str() {
                "crate" => base.clear(),
                "self" => {}
                "super" => drop(base.pop()),
                _ => break,
            }
            rest = others;
        }
        let path = [base, rest.to_vec()].concat();
        let home = &path[..path.len().saturating_sub(1)];
        (self.modules.contains_key(&path) || self.modules.contains_key(home)).then_some(path)
    }

    /// Adds `item` of the module `home`, under another `name` if there is one, with its methods.
    fn add(
        &self,
        home: &[String],
        item: &Item,
        name: Option<&str>,
        public: &[String],
        found: &mut Vec<PublicItem>,
    ) {
        let (kind, attributes, visibility) = match item {
            Item::Struct(item) => (Kind::Type, &item.attrs, &item.vis),
            Item::Enum(item) => (Kind::Type, &item.attrs, &item.vis),
            Item::Union(item) => (Kind::Type, &item.attrs, &item.vis),
            Item::Trait(item) => (Kind::Type, &item.attrs, &item.vis),
            Item::Fn(item) => (Kind::Function, &item.attrs, &item.vis),
            _ => return,
        };
        if !is_public(visibility) || is_test(attributes) {
            return;
        }
        let Some(own_name) = name_of(item) else {
            return;
        };
        let path = joined(public, name.unwrap_or(&own_name));
        let documentation = documentation(attributes);
        found.push(PublicItem {
            path: path.join("::"),
            name: own_name.clone(),
            kind,
            documentation: documentation.clone(),
            type_documentation: String::new(),
        });
        let methods = match item {
            Item::Trait(item) => methods_of_trait(&item.items),
            Item::Fn(_) => Vec::new(),
            _ => self.methods(home, &own_name),
        };
        for (name, method, block) in methods {
            found.push(PublicItem {
                path: joined(&path, &name).join("::"),
                name,
                kind: Kind::Method,
                documentation: method,
                type_documentation: format!("{documentation}\n\n{block}"),
            });
        }
    }

    /// Name, documentation and block's documentation of the public methods of the type `name` of the module `home`.
    ///
    /// A block belongs to the type of that name in its own module if there is one, and else to any.
    fn methods(&self, home: &[String], name: &str) -> Vec<(String, String, String)> {
        let mut methods = Vec::new();
        for (module, items) in &self.modules {
            let is_another = module != home
                && items
                    .iter()
                    .any(|item| name_of(item).as_deref() == Some(name));
            for item in items {
                let Item::Impl(block) = item else { continue };
                if block.trait_.is_some()
                    || is_another
                    || type_name(&block.self_ty) != name
                    || is_test(&block.attrs)
                {
                    continue;
                }
                for item in &block.items {
                    if let ImplItem::Fn(method) = item
                        && is_public(&method.vis)
                    {
                        let documentation =
                            (documentation(&method.attrs), documentation(&block.attrs));
                        methods.push((
                            method.sig.ident.to_string(),
                            documentation.0,
                            documentation.1,
                        ));
                    }
                }
            }
        }
        methods
    }
}

fn methods_of_trait(items: &[TraitItem]) -> Vec<(String, String, String)> {
    let method = |item: &TraitItem| match item {
        TraitItem::Fn(method) => Some((
            method.sig.ident.to_string(),
            documentation(&method.attrs),
            String::new(),
        )),
        _ => None,
    };
    items.iter().filter_map(method).collect()
}

fn joined(path: &[String], name: &str) -> Vec<String> {
    [path, &[name.to_string()]].concat()
}

/// The targets that a `use` names, each with the name that it gets.
fn leaves(tree: &UseTree, path: Vec<String>) -> Vec<(Vec<String>, String)> {
    match tree {
        UseTree::Path(tree) => leaves(&tree.tree, joined(&path, &tree.ident.to_string())),
        UseTree::Name(tree) => {
            let name = tree.ident.to_string();
            vec![(joined(&path, &name), name)]
        }
        UseTree::Rename(tree) => vec![(
            joined(&path, &tree.ident.to_string()),
            tree.rename.to_string(),
        )],
        UseTree::Glob(_) => vec![(path, "*".into())],
        UseTree::Group(group) => group
            .items
            .iter()
            .flat_map(|tree| leaves(tree, path.clone()))
            .collect(),
    }
}

/// The name of an item that can be documented and re-exported.
fn name_of(item: &Item) -> Option<String> {
    let identifier = match item {
        Item::Struct(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Union(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        _ => return None,
    };
    Some(identifier.to_string())
}

/// The last name of the path of a type.
fn type_name(of: &Type) -> String {
    let last = match of {
        Type::Path(path) => path
            .path
            .segments
            .last()
            .map(|segment| segment.ident.to_string()),
        _ => None,
    };
    last.unwrap_or_default()
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// Is the item there in tests alone?
fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) => list.path.is_ident("cfg") && list.tokens.to_string() == "test",
        _ => false,
    })
}

/// Whether a module is kept out of the documentation, as what is no part of the interface.
fn is_hidden(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) => list.path.is_ident("doc") && list.tokens.to_string() == "hidden",
        _ => false,
    })
}

/// The text of the `///` or `//!` lines.
fn documentation(attributes: &[Attribute]) -> String {
    let line = |attribute: &Attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(literal) => match &literal.lit {
                Lit::Str(text) => Some(text.value() + "\n"),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    };
    attributes.iter().filter_map(line).collect()
}
