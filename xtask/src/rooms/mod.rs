//! Rooms: crates and modules import one way only.
//!
//! The sources of every package are parsed. At every level of folders the modules beside each other may form no import
//! circle, and between crates the order of the README's diagram holds. Tests may use anything.

mod circle;
mod order;
mod package;
mod source;
mod tree;

use std::fs;
use std::path::Path;

use crate::repository::root;
use crate::step::{Failure, Outcome, Passed};
use tree::Forest;

/// Places named of each step of a circle.
const PLACES: usize = 4;

/// Fails where an import runs up or in a circle; `all` names every place of a circle, `part` limits what is told to
/// lines that hold this text.
pub fn check(all: bool, part: Option<&str>) -> Outcome {
    let text = |file: &Path| fs::read_to_string(root().join(file)).ok();
    let forest = Forest::read(&text, package::packages()?)?;
    let imports = forest.imports();
    let readme = fs::read_to_string(root().join("README.md")).map_err(|e| Failure::found(format!("README.md: {e}")))?;
    let most = if all { usize::MAX } else { PLACES };
    let circles = circle::circles(&imports);
    let mut said = described(&forest, &circles, most);
    let circles = circles.len();
    said.extend(order::objections(&readme, &forest, &imports, most));
    said.retain(|text| part.is_none_or(|part| text.contains(part)));
    println!(
        "{} packages, {} modules, {} imports between them; {circles} circles to cut",
        forest.packages.len(),
        forest.modules.len(),
        imports.len()
    );
    if said.is_empty() { Ok(Passed::Done) } else { Err(Failure::found(format!("\n{}", said.join("\n")))) }
}

/// The circles in words, each with the name of its crate.
fn described(forest: &Forest, circles: &[circle::Circle], most: usize) -> Vec<String> {
    let name = |tree: usize| &forest.packages[forest.trees[tree].package].name;
    circles.iter().map(|circle| circle.describe(name(circle.folder.0), most)).collect()
}

#[cfg(test)]
mod tests {
    //! Small trees made up for the purpose.

    use std::collections::BTreeMap;
    use std::path::PathBuf;

    use super::package::Package;
    use super::*;

    /// A forest of files; a package is made of each `lib.rs`, `FOLDER/src/lib.rs` being that of the crate FOLDER, and
    /// every package depends on all.
    fn forest(files: &[(&str, &str)]) -> Forest {
        let files: BTreeMap<PathBuf, String> = files.iter().map(|(f, t)| (PathBuf::from(f), (*t).to_owned())).collect();
        let libraries: Vec<&PathBuf> = files.keys().filter(|file| file.ends_with("src/lib.rs")).collect();
        let folder = |file: &Path| file.parent().and_then(Path::parent).unwrap().to_owned();
        let name = |file: &Path| folder(file).display().to_string().replace('/', "-");
        let package = |library: &&PathBuf| Package {
            name: name(library),
            folder: folder(library),
            library: Some((*library).clone()),
            programs: Vec::new(),
            dependencies: libraries.iter().map(|file| (name(file).replace('-', "_"), name(file))).collect(),
        };
        let packages = libraries.iter().map(package).collect();
        Forest::read(&|file: &Path| files.get(file).cloned(), packages).unwrap()
    }

    /// The circles of a crate `a`, whose files lie in `a/src`.
    fn circles(files: &[(&str, &str)]) -> Vec<String> {
        let files: Vec<(String, &str)> = files.iter().map(|(file, text)| (format!("a/src/{file}"), *text)).collect();
        let files: Vec<(&str, &str)> = files.iter().map(|(file, text)| (file.as_str(), *text)).collect();
        let forest = forest(&files);
        described(&forest, &circle::circles(&forest.imports()), PLACES)
    }

    /// The first lines of what is said.
    fn heads(said: &[String]) -> Vec<&str> {
        said.iter().filter_map(|text| text.lines().next()).collect()
    }

    #[test]
    fn a_circle_of_two_is_told_with_files_lines_and_paths() {
        let said = circles(&[
            ("lib.rs", "mod b;\nmod c;"),
            ("b.rs", "use crate::c::{X, Y};\npub struct Z;"),
            ("c.rs", "\npub struct X;\nfn f() -> crate::b::Z { todo!() }"),
        ]);
        let wanted = "a: b → c → b\n    b names c in 2 places\n        a/src/b.rs:1  crate::c::X\n        a/src/b.rs:1  \
                      crate::c::Y\n    c names b in 1 place\n        a/src/c.rs:3  crate::b::Z";
        assert_eq!(said, [wanted]);
    }

    #[test]
    fn imports_one_way_are_no_circle() {
        let said = circles(&[
            ("lib.rs", "mod b;\nmod c;\nmod d;\npub use b::X;"),
            ("b.rs", "pub struct X;"),
            ("c.rs", "use crate::b::X;"),
            ("d.rs", "use crate::{b::X, c};"),
        ]);
        assert_eq!(said, Vec::<String>::new());
    }

    #[test]
    fn a_circle_of_three_is_found_where_no_two_name_each_other() {
        let said = circles(&[
            ("lib.rs", "mod b;\nmod c;\nmod d;"),
            ("b.rs", "use crate::c::C;\npub struct B;"),
            ("c.rs", "use crate::d::D;\npub struct C;"),
            ("d.rs", "use crate::b::B;\npub struct D;"),
        ]);
        assert_eq!(heads(&said), ["a: b → c → d → b"]);
    }

    #[test]
    fn a_circle_in_an_inner_folder_is_found_through_super_and_self() {
        let said = circles(&[
            ("lib.rs", "mod b;"),
            ("b/mod.rs", "mod c;\nmod d;"),
            ("b/c.rs", "use super::d::X; pub struct Y;"),
            ("b/d/mod.rs", "mod e; pub use self::e::X;"),
            ("b/d/e.rs", "pub struct X(super::super::c::Y);"),
        ]);
        assert_eq!(heads(&said), ["a::b: c → d → c"]);
    }

    #[test]
    fn what_a_module_hands_on_leads_to_where_it_comes_from() {
        // c takes X from the root, which has it from b.
        let said = circles(&[
            ("lib.rs", "mod b;\nmod c;\npub use b::{X as W};"),
            ("b.rs", "use super::c::Y;\npub struct X;"),
            ("c.rs", "use crate::W;\npub struct Y;"),
        ]);
        assert_eq!(heads(&said), ["a: b → c → b"]);
    }

    #[test]
    fn a_name_that_is_also_its_modules_leads_into_the_module() {
        for path in ["b::b", "self::b::b"] {
            let root = format!("mod b;\nmod c;\npub use {path};");
            let said = circles(&[
                ("lib.rs", &root),
                ("b.rs", "use super::c::Y;\npub fn b() {}"),
                ("c.rs", "use crate::b;\nfn f() { b() }\npub struct Y;"),
            ]);
            assert_eq!(heads(&said), ["a: b → c → b"], "{path}");
        }
    }

    #[test]
    fn a_glob_leads_to_where_its_names_come_from() {
        let said = circles(&[
            ("lib.rs", "mod b;\nmod c;\nmod p;"),
            ("p.rs", "pub use crate::b::*;"),
            ("b.rs", "use super::c::Y;\npub struct X;"),
            ("c.rs", "use super::p::*;\nfn f(_: X) {}\npub struct Y;"),
        ]);
        assert_eq!(heads(&said), ["a: b → c → b"]);
    }

    #[test]
    fn paths_in_macro_calls_and_attributes_count() {
        let said = circles(&[
            ("lib.rs", "mod b;\nmod c;"),
            ("b.rs", "#[derive(crate::c::D)]\npub struct X;"),
            ("c.rs", "fn f() { println!(\"{}\", crate::b::g()) }"),
        ]);
        assert_eq!(heads(&said), ["a: b → c → b"]);
    }

    #[test]
    fn a_folders_own_file_may_not_use_what_uses_it() {
        let own = "mod c;\npub use c::X;\npub struct Y;\n";
        let part = "use super::Y;\npub struct X;";
        assert_eq!(circles(&[("lib.rs", own), ("c.rs", part)]), Vec::<String>::new());
        let own = own.to_owned() + "fn f() -> X { todo!() }";
        assert_eq!(heads(&circles(&[("lib.rs", &own), ("c.rs", part)])), ["a: lib.rs → c → lib.rs"]);
    }

    #[test]
    fn a_module_written_in_place_is_part_of_its_file() {
        let said = circles(&[("lib.rs", "mod b { pub use super::X; }\nuse b::X as Y;\npub struct X;")]);
        assert_eq!(said, Vec::<String>::new());
    }

    #[test]
    fn who_cuts_the_circles_that_are_told_has_cut_all() {
        let said = circles(&[
            ("lib.rs", "mod b;\nmod c;\nmod d;"),
            ("b.rs", "use crate::{c::C, d::D};\npub struct B;"),
            ("c.rs", "use crate::{b::B, d::D};\npub struct C;"),
            ("d.rs", "use crate::{b::B, c::C};\npub struct D;"),
        ]);
        assert_eq!(heads(&said), ["a: b → c → b", "a: b → d → b", "a: c → d → c"]);
    }

    /// What is said of crates `low`, `one`, `two` and `top` under a diagram.
    fn objections(diagram: &str, low: &str, one: &str) -> Vec<String> {
        let forest = forest(&[
            ("x/low/src/lib.rs", low),
            ("x/low/src/part.rs", "pub struct Y;"),
            ("x/one/src/lib.rs", one),
            ("x/two/src/lib.rs", "pub struct X;"),
            ("top/src/lib.rs", "use x_one::X;"),
        ]);
        let readme = format!("{}\n\n```text\n{diagram}\n```\n", order::HEADING);
        order::objections(&readme, &forest, &forest.imports(), PLACES)
    }

    #[test]
    fn an_import_against_the_order_of_the_crates_is_told_with_its_place() {
        let diagram = "x/    low → one, two\ntop/  what is above";
        assert_eq!(objections(diagram, "pub mod part;", "use x_low::part::Y;\npub struct X;"), Vec::<String>::new());
        let said = objections(diagram, "mod part;\nuse x_two::X;", "use x_two::X;");
        assert_eq!(
            said,
            [
                "README.md: x/low names x/two, which stands behind it in the diagram in 1 place\n    x/low/src/lib.rs:2  x_two::X",
                "README.md: x/one names x/two, which stands beside it in the diagram in 1 place\n    x/one/src/lib.rs:1  x_two::X",
            ]
        );
    }

    #[test]
    fn what_a_crate_hands_on_of_another_counts_as_both() {
        let said = objections("x/ two → one → low\ntop/ above", "mod part;\nuse x_one::Z;", "pub use x_two::X as Z;");
        assert_eq!(said, Vec::<String>::new());
        let said = objections("x/ one → low → two\ntop/ above", "mod part;\nuse x_one::Z;", "pub use x_two::X as Z;");
        assert_eq!(
            heads(&said),
            [
                "README.md: x/one names x/two, which stands behind it in the diagram in 1 place",
                "README.md: x/low names x/two, which stands behind it in the diagram in 1 place",
            ]
        );
    }

    #[test]
    fn a_diagram_that_does_not_fit_the_packages_is_told() {
        let said = objections("x/ low → one → three", "mod part;", "");
        assert_eq!(
            said,
            [
                "README.md: the diagram's “three” is neither a package nor a module in x/",
                "The diagram under “## How it works, and where” is read as the head of xtask/src/rooms/order.rs tells.",
                "README.md: top (top) is in no room of the diagram",
                "README.md: x/two (x-two) is in no room of the diagram",
            ]
        );
        assert_eq!(order::objections("no diagram", &forest(&[]), &[], 1).len(), 1);
    }

    #[test]
    fn folders_in_one_line_are_rooms_and_names_in_braces_share_their_beginning() {
        let said = |diagram: &str| objections(diagram, "mod part;\nuse x_one::Z;", "pub struct Z;");
        assert_eq!(said("x/ {one,two} → low\ntop/ above   docs/ text"), Vec::<String>::new());
        let wanted = "README.md: x/low names x/one, which stands beside it in the diagram in 1 place";
        assert_eq!(heads(&said("x/ {one,two,low} →\ntop/ above")), [wanted]);
    }

    #[test]
    fn modules_of_one_crate_keep_the_order_of_the_diagram_as_well() {
        let readme = format!("{}\n\n```text\na/  b (is first) → c (is (the)\n    second) → d\n```\n", order::HEADING);
        let forest = forest(&[
            ("a/src/lib.rs", "mod b;\nmod c;\nmod d;"),
            ("a/src/b.rs", "use crate::d::D;\npub struct B;"),
            ("a/src/c.rs", "use crate::b::B;\npub struct C;"),
            ("a/src/d.rs", "use crate::c::C;\npub struct D;"),
        ]);
        let said = order::objections(&readme, &forest, &forest.imports(), 1);
        assert_eq!(heads(&said), ["README.md: a/b names a/d, which stands behind it in the diagram in 1 place"]);
    }
}
