//! Features of crates: the program as `cargo truepath` builds it against the workspace as its tests build it.
//!
//! Where they differ, cargo builds that crate and all above it twice, and a run of all tests takes minutes longer. The remedy is to
//! ask for the feature in the crate at the bottom, or not at all. Limit: crates that procedural macros are made of are only
//! compared as far as `cargo tree` tells.

use std::collections::BTreeSet;

use crate::repository::{cargo, read};
use crate::step::{Failure, Outcome, Passed};

/// Compares them.
pub fn check() -> Outcome {
    let program = tree(&["--package", "truepath", "--edges", "normal,build"])?;
    let tests = tree(&["--workspace", "--edges", "normal,build,dev"])?;
    let found = difference(&program, &tests);
    if found.is_empty() { Ok(Passed::Done) } else { Err(Failure::found(found.join("\n"))) }
}

/// A line for each crate as it is built: `serde v1.0.229|derive,std`.
fn tree(of: &[&str]) -> Result<String, Failure> {
    read(cargo().args(["tree", "--prefix", "none", "--format", "{p}|{f}"]).args(of))
}

/// Crates of the program that the tests build with other features only.
fn difference(program: &str, tests: &str) -> Vec<String> {
    let built = |tree: &str| -> BTreeSet<(String, String)> {
        let crates = tree.lines().filter_map(|line| line.split_once('|'));
        // A crate that was listed before has a mark behind it.
        crates.map(|(name, features)| (name.to_owned(), features.trim_end_matches(" (*)").to_owned())).collect()
    };
    let tests = built(tests);
    let apart = built(program).into_iter().filter(|one| !tests.contains(one));
    let told = apart.map(|(name, features)| {
        let others: Vec<&str> = tests.iter().filter(|(n, _)| *n == name).map(|(_, f)| f.as_str()).collect();
        format!("{name} is built with [{features}] for the program and with [{}] for the tests", others.join("] ["))
    });
    told.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crate_with_other_features_is_named_and_one_that_only_the_tests_have_is_not() {
        let program =
            "truepath v0.1.0 (/there)|\nserde v1.0.229|derive,std\nlibm v0.2.16|arch\nlibm v0.2.16|arch (*)\n";
        let tests =
            "libm v0.2.16|arch\nserde v1.0.229|alloc,derive,std\nproptest v1.12.0|std\ntruepath v0.1.0 (/there)|\n";
        let wanted =
            "serde v1.0.229 is built with [derive,std] for the program and with [alloc,derive,std] for the tests";
        assert_eq!(difference(program, tests), [wanted]);
        assert!(difference(program, &format!("{tests}serde v1.0.229|derive,std\n")).is_empty());
    }
}
