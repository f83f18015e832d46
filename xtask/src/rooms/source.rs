//! What a source file declares, brings into scope and names.
//!
//! Parsed by `syn`. Paths inside macro calls and attributes are found among their tokens. Items for tests only
//! (`#[cfg(test)]`) are left out: a test may use anything. Links in documentation are not imports.

use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, ExprLit, Item, Lit, Meta, UseTree, Visibility};

/// A module as its source has it.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// Modules in files of their own: name, path given by an attribute.
    pub files: Vec<(String, Option<String>)>,
    /// Modules written in place.
    pub inline: Vec<(String, Source)>,
    /// Other items by name.
    pub items: Vec<String>,
    /// What `use` brings in.
    pub uses: Vec<Use>,
    /// Paths in code.
    pub names: Vec<Name>,
}

/// One leaf of a `use`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Use {
    /// Segments; a leading `::` gives an empty first one.
    pub path: Vec<String>,
    /// The name it has here; `None` of a glob.
    pub binds: Option<String>,
    /// Whether it is visible outside of the module.
    pub public: bool,
    /// Line, from 1.
    pub line: usize,
}

/// A path in code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// Segments; a leading `::` gives an empty first one.
    pub path: Vec<String>,
    /// Line, from 1.
    pub line: usize,
}

/// Reads a file's text.
///
/// # Errors
/// When it is not Rust: line and reason.
pub fn read(text: &str) -> Result<Source, String> {
    let file = syn::parse_file(text).map_err(|e| format!("{}: {e}", e.span().start().line))?;
    Ok(module(&file.items))
}

fn module(items: &[Item]) -> Source {
    let mut source = Source::default();
    items.iter().for_each(|item| source.visit_item(item));
    source
}

impl Source {
    fn add_use(&mut self, tree: &UseTree, prefix: &[String], public: bool) {
        let with = |ident: &syn::Ident| {
            let mut path = prefix.to_vec();
            // `a::{self}` is `a`.
            if ident != "self" || path.is_empty() {
                path.push(ident.to_string());
            }
            path
        };
        let mut add = |path: Vec<String>, binds: Option<String>, line| {
            self.uses.push(Use { path, binds, public, line });
        };
        match tree {
            UseTree::Path(tree) => self.add_use(&tree.tree, &with(&tree.ident), public),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.add_use(tree, prefix, public)),
            UseTree::Glob(glob) => add(prefix.to_vec(), None, glob.star_token.spans[0].start().line),
            UseTree::Name(name) => {
                let path = with(&name.ident);
                let binds = path.last().cloned();
                add(path, binds, name.ident.span().start().line);
            }
            UseTree::Rename(name) => {
                add(with(&name.ident), Some(name.rename.to_string()), name.ident.span().start().line);
            }
        }
    }

    /// Paths among tokens: names joined by `::`, and single names.
    fn add_tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let is = |at: usize, sign: char| matches!(tokens.get(at), Some(TokenTree::Punct(p)) if p.as_char() == sign);
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            match token {
                TokenTree::Group(group) => self.add_tokens(group.stream()),
                // Not a field or a method, not a lifetime.
                TokenTree::Ident(first)
                    if !(at > 0 && (is(at - 1, '.') && !is(at.wrapping_sub(2), '.') || is(at - 1, '\''))) =>
                {
                    let (mut path, line) = (vec![first.to_string()], first.span().start().line);
                    while is(at + 1, ':') && is(at + 2, ':') {
                        let Some(TokenTree::Ident(next)) = tokens.get(at + 3) else { break };
                        path.push(next.to_string());
                        at += 3;
                    }
                    self.names.push(Name { path, line });
                }
                _ => {}
            }
            at += 1;
        }
    }
}

impl<'ast> Visit<'ast> for Source {
    fn visit_item(&mut self, item: &'ast Item) {
        let Some((attributes, name)) = described(item) else { return visit::visit_item(self, item) };
        if attributes.iter().any(is_for_tests) {
            return;
        }
        match item {
            Item::Mod(item) => {
                attributes.iter().for_each(|a| self.visit_attribute(a));
                let name = item.ident.to_string();
                match &item.content {
                    Some((_, items)) => self.inline.push((name, module(items))),
                    None => self.files.push((name, attributes.iter().find_map(path_of))),
                }
            }
            Item::Use(item) => {
                let prefix = if item.leading_colon.is_some() { vec![String::new()] } else { Vec::new() };
                self.add_use(&item.tree, &prefix, !matches!(item.vis, Visibility::Inherited));
            }
            _ => {
                self.items.extend(name);
                visit::visit_item(self, item);
            }
        }
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let leading = path.leading_colon.is_some().then(String::new);
        let segments = path.segments.iter().map(|segment| segment.ident.to_string());
        let line = path.segments.first().map_or(0, |segment| segment.ident.span().start().line);
        self.names.push(Name { path: leading.into_iter().chain(segments).collect(), line });
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.visit_path(&call.path);
        self.add_tokens(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        match &attribute.meta {
            Meta::List(list) => self.add_tokens(list.tokens.clone()),
            Meta::NameValue(_) | Meta::Path(_) => {}
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !function.attrs.iter().any(is_for_tests) {
            visit::visit_impl_item_fn(self, function);
        }
    }
}

/// Attributes of an item, and the name it has in its module.
fn described(item: &Item) -> Option<(&[Attribute], Option<String>)> {
    Some(match item {
        Item::Const(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::Enum(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::ExternCrate(item) => (&item.attrs, None),
        Item::Fn(item) => (&item.attrs, Some(item.sig.ident.to_string())),
        Item::ForeignMod(item) => (&item.attrs, None),
        Item::Impl(item) => (&item.attrs, None),
        Item::Macro(item) => (&item.attrs, item.ident.as_ref().map(ToString::to_string)),
        Item::Mod(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::Static(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::Struct(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::Trait(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::TraitAlias(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::Type(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::Union(item) => (&item.attrs, Some(item.ident.to_string())),
        Item::Use(item) => (&item.attrs, None),
        _ => return None,
    })
}

/// `#[test]`, `#[cfg(test)]`, `#[cfg(all(test, …))]`.
fn is_for_tests(attribute: &Attribute) -> bool {
    if attribute.path().is_ident("test") {
        return true;
    }
    let Meta::List(list) = &attribute.meta else { return false };
    let condition = list.tokens.to_token_stream().to_string();
    list.path.is_ident("cfg") && (condition == "test" || condition.starts_with("all (test"))
}

/// The file that `#[path = "…"]` names.
fn path_of(attribute: &Attribute) -> Option<String> {
    let Meta::NameValue(pair) = &attribute.meta else { return None };
    match &pair.value {
        Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) if pair.path.is_ident("path") => Some(text.value()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn used(text: &str) -> Vec<(String, Option<String>, bool)> {
        read(text).unwrap().uses.into_iter().map(|u| (u.path.join("::"), u.binds, u.public)).collect()
    }

    fn named(text: &str) -> Vec<String> {
        read(text).unwrap().names.into_iter().map(|n| n.path.join("::")).collect()
    }

    #[test]
    fn a_tree_of_use_is_taken_apart_into_its_leaves() {
        let bound = |path: &str, binds: &str| (path.to_owned(), Some(binds.to_owned()), false);
        assert_eq!(
            used("use crate::a::{self, b::C as D, e::*};"),
            [bound("crate::a", "a"), bound("crate::a::b::C", "D"), ("crate::a::e".into(), None, false)]
        );
        assert_eq!(used("pub(crate) use super::x;"), [("super::x".into(), Some("x".into()), true)]);
    }

    #[test]
    fn paths_in_code_and_inside_macro_calls_are_found_with_their_lines() {
        let text = "fn f() -> crate::a::B {\n    println!(\"{}\", super::c::d(x.e, 0..super::n::M));\n}";
        let names = read(text).unwrap().names;
        let lines: Vec<(String, usize)> = names.iter().map(|n| (n.path.join("::"), n.line)).collect();
        for wanted in [("crate::a::B", 1), ("super::c::d", 2), ("super::n::M", 2)] {
            assert!(lines.contains(&(wanted.0.to_owned(), wanted.1)), "{lines:?}");
        }
        assert!(!lines.iter().any(|(path, _)| path == "e"), "a field is not a name: {lines:?}");
    }

    #[test]
    fn what_is_there_for_tests_only_and_links_in_documentation_are_not_imports() {
        let text = "/// [`crate::docs::only`]\n#[cfg(test)]\nmod tests { use crate::up::X; }\n#[test]\nfn t() { crate::up::y() }\n\
                    #[cfg(test)]\nuse crate::up::Z;\n#[cfg(all(test, unix))]\nfn u() { crate::up::y() }";
        assert_eq!((named(text), used(text)), (vec![], vec![]));
    }

    #[test]
    fn modules_in_files_and_in_place_are_told_apart() {
        let source = read("mod a;\n#[path = \"other/b.rs\"]\nmod b;\nmod c { pub fn d() {} }").unwrap();
        assert_eq!(source.files, [("a".to_owned(), None), ("b".to_owned(), Some("other/b.rs".to_owned()))]);
        assert_eq!((source.inline[0].0.as_str(), source.inline[0].1.items.as_slice()), ("c", &["d".to_owned()][..]));
    }

    #[test]
    fn a_file_that_is_not_rust_is_refused_with_its_line() {
        assert!(read("fn f() {}\nfn }").unwrap_err().starts_with("2: "));
    }
}
