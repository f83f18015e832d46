//! Mutants woven into a source, all of them at once: each is a branch that its number chooses when the program runs.
//!
//! `a + b` becomes `(if crate::mutant::chosen() == 7 { (a) - (b) } else { a + b })`: an operator that is changed keeps its operands.
//! Left out is what is computed while compiling (constants, patterns, lengths) and what has no form as an expression.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use proc_macro2::Span;
use quote::ToTokens as _;
use syn::spanned::Spanned as _;
use syn::visit::{self, Visit};
use syn::{Arm, BinOp, Block, Expr, ExprBinary, ExprRepeat, ExprStruct, ExprUnary, Pat, Signature};

use super::mutant::Mutant;

/// Put at the beginning of a library: what a `const fn` needs to be one thing while compiling and another when it runs.
pub const FEATURES: &str = "#![feature(core_intrinsics, const_eval_select)] #![allow(internal_features)] ";

/// Put at the end of a library: which mutant is chosen, by the environment; 0 is none.
pub const CHOICE: &str = r#"
mod mutant {
    extern crate std;
    const fn none() -> usize {
        0
    }
    fn number() -> usize {
        static NUMBER: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
        *NUMBER.get_or_init(|| std::env::var("MUTANT").ok().and_then(|number| number.parse().ok()).unwrap_or(0))
    }
    pub(crate) const fn chosen() -> usize {
        core::intrinsics::const_eval_select((), none, number)
    }
}
"#;

/// A source with mutants in it.
#[derive(Debug)]
pub struct Woven {
    /// Its text.
    pub text: String,
    /// The mutants in it, by number.
    pub held: BTreeMap<usize, Held>,
}

/// Where a mutant is in the woven text, in bytes.
#[derive(Clone, Debug)]
pub struct Held {
    /// What was put in for it.
    own: Range<usize>,
    /// All of the expression.
    whole: Range<usize>,
    /// Whether it is in a `const fn`, which as part of a constant stays as it was.
    pub constant: bool,
}

impl Woven {
    /// The mutants that an error of the compiler is about: those whose own text it names, else those around a place that it names,
    /// else those within one.
    pub fn blamed(&self, error: &[Range<usize>]) -> BTreeSet<usize> {
        type Way = fn(&Held, &Range<usize>) -> bool;
        fn holds(a: &Range<usize>, b: &Range<usize>) -> bool {
            a.start <= b.start && b.end <= a.end
        }
        let ways: [Way; 3] = [
            |held, said| holds(&held.own, said),
            |held, said| holds(&held.whole, said),
            |held, said| holds(said, &held.own),
        ];
        let those = |way: Way| {
            let named = self.held.iter().filter(|(_, held)| error.iter().any(|said| way(held, said)));
            named.map(|(number, _)| *number).collect::<BTreeSet<_>>()
        };
        ways.into_iter().map(those).find(|blamed| !blamed.is_empty()).unwrap_or_default()
    }
}

/// Weaves numbered mutants of a file into its text.
///
/// # Errors
/// When the text is not Rust.
pub fn weave<'a>(text: &str, mutants: impl IntoIterator<Item = (usize, &'a Mutant)>) -> Result<Woven, String> {
    let file = syn::parse_file(text).map_err(|e| format!("{}: {e}", e.span().start().line))?;
    let mut loom = Loom::default();
    for (number, mutant) in mutants {
        let place = (mutant.genre.as_str(), mutant.place);
        loom.open.entry(place).or_default().push((number, &mutant.replacement));
    }
    loom.visit_file(&file);
    Ok(cut(text, &loom.splices))
}

/// Text put before and after a part of a source.
#[derive(Debug)]
struct Splice {
    number: usize,
    part: Range<usize>,
    before: String,
    after: &'static str,
    constant: bool,
}

/// Puts all splices into a text; where one begins or ends with another, the longer is around the shorter.
fn cut(text: &str, splices: &[Splice]) -> Woven {
    let begin = |s: &Splice| (s.part.start, 1, usize::MAX - s.part.end, s.number);
    let end = |s: &Splice| (s.part.end, 0, usize::MAX - s.part.start, usize::MAX - s.number);
    let begins = splices.iter().map(|s| (begin(s), s, true));
    let ends = splices.iter().filter(|s| !s.after.is_empty()).map(|s| (end(s), s, false));
    let mut marks: Vec<_> = begins.chain(ends).collect();
    marks.sort_by_key(|(key, ..)| *key);
    let (mut woven, mut done) = (Woven { text: String::new(), held: BTreeMap::new() }, 0);
    for ((at, ..), splice, begins) in marks {
        woven.text.push_str(&text[done..at]);
        done = at;
        let from = woven.text.len();
        woven.text.push_str(if begins { &splice.before } else { splice.after });
        let to = woven.text.len();
        let held = Held { own: from..to, whole: from..to, constant: splice.constant };
        woven.held.entry(splice.number).or_insert(held).whole.end = to;
    }
    woven.text.push_str(&text[done..]);
    woven
}

/// Mutants of one place: number and replacement.
type Numbered<'a> = Vec<(usize, &'a str)>;

/// What the places of a source make of the mutants that are there.
#[derive(Default)]
struct Loom<'a> {
    /// Not met yet, by kind and place.
    open: BTreeMap<(&'a str, (usize, usize)), Numbered<'a>>,
    splices: Vec<Splice>,
    constant: bool,
}

impl<'a> Loom<'a> {
    fn take(&mut self, genre: &'static str, at: Span) -> Numbered<'a> {
        let start = at.start();
        self.open.remove(&(genre, (start.line, start.column + 1))).unwrap_or_default()
    }
    fn splice(&mut self, number: usize, part: Range<usize>, before: String, after: &'static str) {
        self.splices.push(Splice { number, part, before, after, constant: self.constant });
    }
    /// An expression or another in its place.
    fn choose(&mut self, number: usize, original: Span, mutated: &str) {
        let before = format!("(if crate::mutant::chosen() == {number} {{ {mutated} }} else {{ ");
        self.splice(number, original.byte_range(), before, " })");
    }
    fn function(&mut self, signature: &Signature, block: &Block) {
        let outer = std::mem::replace(&mut self.constant, signature.constness.is_some());
        if let Some(first) = block.stmts.first() {
            let braces = &block.brace_token.span;
            let body = braces.open().byte_range().end..braces.close().byte_range().start;
            for (number, value) in self.take("FnValue", first.span()) {
                let before = format!(" if crate::mutant::chosen() == {number} {{ return {value}; }}");
                self.splice(number, body.clone(), before, "");
            }
        }
        visit::visit_block(self, block);
        self.constant = outer;
    }
}

impl<'ast> Visit<'ast> for Loom<'_> {
    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.function(&function.sig, &function.block);
    }
    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.function(&function.sig, &function.block);
    }
    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        if let Some(block) = &function.default {
            self.function(&function.sig, block);
        }
    }
    fn visit_expr_binary(&mut self, binary: &'ast ExprBinary) {
        let [left, right] = [&binary.left, &binary.right].map(|side| side.to_token_stream());
        for (number, operator) in self.take("BinaryOperator", binary.op.span()) {
            // `if let … && …` is no expression.
            if !(matches!(binary.op, BinOp::And(_)) && (binds(&binary.left) || binds(&binary.right))) {
                self.choose(number, binary.span(), &format!("({left}) {operator} ({right})"));
            }
        }
        visit::visit_expr_binary(self, binary);
    }
    fn visit_expr_unary(&mut self, unary: &'ast ExprUnary) {
        for (number, _) in self.take("UnaryOperator", unary.op.span()) {
            self.choose(number, unary.span(), &unary.expr.to_token_stream().to_string());
        }
        visit::visit_expr_unary(self, unary);
    }
    fn visit_arm(&mut self, arm: &'ast Arm) {
        let end = arm.pat.span().byte_range().end;
        for (number, _) in self.take("MatchArm", arm.span()) {
            self.splice(number, end..end, format!(" if crate::mutant::chosen() != {number}"), "");
        }
        if let Pat::Guard(guarded) = &arm.pat {
            for (number, value) in self.take("MatchArmGuard", guarded.guard.span()) {
                if !binds(&guarded.guard) {
                    self.choose(number, guarded.guard.span(), value);
                }
            }
            self.visit_expr(&guarded.guard);
        }
        self.visit_expr(&arm.body);
    }
    fn visit_expr_struct(&mut self, structure: &'ast ExprStruct) {
        for field in structure.rest.iter().flat_map(|_| &structure.fields) {
            let rest = structure.rest.to_token_stream();
            let member = field.member.to_token_stream();
            for (number, _) in self.take("StructField", field.span()) {
                let mutated = format!("({rest}).{member}");
                if field.colon_token.is_some() {
                    self.choose(number, field.expr.span(), &mutated);
                } else {
                    let end = field.span().byte_range().end;
                    let before =
                        format!(": if crate::mutant::chosen() == {number} {{ {mutated} }} else {{ {member} }}");
                    self.splice(number, end..end, before, "");
                }
            }
        }
        visit::visit_expr_struct(self, structure);
    }
    fn visit_expr_repeat(&mut self, repeat: &'ast ExprRepeat) {
        self.visit_expr(&repeat.expr);
    }
    // What is computed while compiling: nothing is chosen there.
    fn visit_pat(&mut self, _: &'ast Pat) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}
    fn visit_variant(&mut self, _: &'ast syn::Variant) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
}

/// Whether an expression binds names for what follows: `let` in a condition.
fn binds(expression: &Expr) -> bool {
    match expression {
        Expr::Let(_) => true,
        Expr::Binary(ExprBinary { left, op: BinOp::And(_), right, .. }) => binds(left) || binds(right),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHOSEN: &str = "crate::mutant::chosen()";

    /// A source whose mutants are given by kind, the text they begin at and what stands there then; they are numbered from 1.
    fn woven(text: &str, mutants: &[(&str, &str, &str)]) -> Woven {
        let mutant = |&(genre, at, replacement): &(&str, &str, &str)| {
            let before = &text[..text.find(at).unwrap()];
            let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
            Mutant {
                place: (before.matches('\n').count() + 1, column),
                genre: genre.into(),
                replacement: replacement.into(),
                ..Mutant::default()
            }
        };
        let mutants: Vec<_> = mutants.iter().map(mutant).collect();
        let woven = weave(text, mutants.iter().enumerate().map(|(i, m)| (i + 1, m))).unwrap();
        syn::parse_file(&woven.text).unwrap();
        woven
    }
    fn text(of: &str, mutants: &[(&str, &str, &str)]) -> String {
        woven(of, mutants).text.replace(CHOSEN, "?")
    }

    #[test]
    fn an_operator_keeps_its_operands_and_mutants_stand_within_each_other() {
        let source = "fn f() -> u8 { a + b * 2 }";
        assert_eq!(
            text(source, &[("BinaryOperator", "+", "-"), ("BinaryOperator", "*", "/"), ("BinaryOperator", "+", "*")]),
            "fn f() -> u8 { (if ? == 1 { (a) - (b * 2) } else { (if ? == 3 { (a) * (b * 2) } else { \
             a + (if ? == 2 { (b) / (2) } else { b * 2 }) }) }) }"
        );
    }

    #[test]
    fn values_of_functions_and_signs_and_assignments() {
        assert_eq!(
            text(
                "fn f(&mut self) {\n self.a += !b; }",
                &[("FnValue", "self.a", "()"), ("BinaryOperator", "+=", "-="), ("UnaryOperator", "!b", "")]
            ),
            "fn f(&mut self) { if ? == 1 { return (); }\n (if ? == 2 { (self . a) -= (! b) } else { self.a += (if ? == 3 { b } else { !b }) }); }"
        );
    }

    #[test]
    fn arms_guards_and_fields() {
        assert_eq!(
            text(
                "fn f() { match a { 1 | 2 => 3, b if b > 4 => 5, _ => 6 } }",
                &[("MatchArm", "1 |", ""), ("MatchArmGuard", "b > 4", "true"),]
            ),
            "fn f() { match a { 1 | 2 if ? != 1 => 3, b if (if ? == 2 { true } else { b > 4 }) => 5, _ => 6 } }"
        );
        assert_eq!(
            text("fn f() { S { a, b: 2, ..S::new() } }", &[("StructField", "a,", ""), ("StructField", "b:", "")]),
            "fn f() { S { a: if ? == 1 { (S :: new ()).a } else { a }, \
             b: (if ? == 2 { (S :: new ()).b } else { 2 }), ..S::new() } }"
        );
    }

    #[test]
    fn what_is_computed_while_compiling_is_left_as_it_is() {
        for source in [
            "const A: u8 = 1 + 2;",
            "static A: u8 = 1 + 2;",
            "fn f() { let a = [0; 1 + 2]; }",
            "fn f(a: [u8; 1 + 2]) {}",
            "enum E { A = 1 + 2 }",
            "fn f() { if let Some(a) = b && a + 2 == 1 {} }",
        ] {
            let operator = if source.contains("&&") { "&&" } else { "+" };
            assert_eq!(text(source, &[("BinaryOperator", operator, "-")]), source);
        }
        let constant = woven("const fn f() -> u8 { 1 + 2 }", &[("BinaryOperator", "+", "-")]);
        assert!(constant.held[&1].constant);
    }

    #[test]
    fn an_error_is_blamed_on_the_text_of_a_mutant_else_on_what_is_around_it() {
        let woven = woven("fn f() { a + b * 2 }", &[("BinaryOperator", "+", "-"), ("BinaryOperator", "*", "/")]);
        let at = |text: &str| {
            let start = woven.text.find(text).unwrap();
            start..start + text.len()
        };
        let blamed = |range: Range<usize>| Vec::from_iter(woven.blamed(&[range]));
        assert_eq!(blamed(at("- (b")), [1]);
        assert_eq!(blamed(at("(b) / (2)")), [2]);
        assert_eq!(blamed(at("a + ")), [1]);
        assert_eq!(blamed(at(&woven.text)), [1, 2]);
        assert!(blamed(0..2).is_empty());
    }
}
