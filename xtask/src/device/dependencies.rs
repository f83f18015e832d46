//! Which crates the core brings onto the microcontroller: only those listed here, each for its reason.

use crate::repository::{cargo, read};
use crate::step::Failure;
use crate::toolchain::TARGET;

/// Crates that may be part of the core's build for the microcontroller, with the reason.
const ALLOWED: &[(&str, &str)] = &[
    ("truepath-core", "the core itself"),
    ("truepath-model", "the model of the cut, its identification and the design of a correction"),
    ("truepath-rs274", "the reading of programs"),
    ("truepath-units", "fixed-point numbers, geometry, the checksum"),
    ("truepath-wire", "image, rewriter and links"),
    ("fixed", "fixed-point numbers"),
    ("az", "casts between numbers, for fixed"),
    ("bytemuck", "numbers as bytes, for fixed"),
    ("half", "16-bit float conversions that fixed offers and the core does not call"),
    ("zerocopy", "values as bytes, for half"),
    ("cfg-if", "conditional compilation, no code"),
    ("typenum", "numbers as types, for fixed: no code"),
    ("heapless", "bounded buffers without an allocator"),
    ("hash32", "hashing for heapless"),
    ("byteorder", "byte order for hash32"),
    ("stable_deref_trait", "a marker trait, for heapless"),
    ("nom", "parsing of programs and probe files, without its allocator feature"),
    ("memchr", "byte search for nom"),
    ("libm", "functions of expressions in programs, the same bits on every machine"),
    ("crc", "checksums of programs, images and frames"),
    ("crc-catalog", "polynomials for crc"),
    ("cobs", "frames on byte streams"),
    ("thiserror", "error texts of cobs"),
    ("serde", "fields of messages"),
    ("serde_core", "the traits of serde"),
    ("postcard", "messages of the configuration link"),
    ("ed25519-dalek", "signatures of images, outside the servo cycle"),
    ("ed25519", "the bytes of a signature, for ed25519-dalek"),
    ("signature", "the trait of a signature, for ed25519-dalek"),
    ("curve25519-dalek", "the curve, for ed25519-dalek"),
    ("sha2", "SHA-512, for ed25519-dalek"),
    ("digest", "the trait of a hash, for sha2"),
    ("block-buffer", "whole blocks for sha2"),
    ("crypto-common", "traits for digest"),
    ("hybrid-array", "arrays by type, for digest"),
    ("subtle", "comparisons in constant time, for ed25519-dalek"),
];

/// Features that would bring an allocator or the standard library.
const FORBIDDEN_FEATURES: [&str; 2] = ["std", "alloc"];

/// Checks the dependencies; returns how many crates there are.
///
/// # Errors
/// Names every crate that is not on the list and every feature that needs an allocator or the standard library.
pub fn check() -> Result<usize, Failure> {
    let tree = read(cargo().args([
        "tree",
        "--package",
        "truepath-core",
        "--edges",
        "normal,no-proc-macro",
        "--target",
        TARGET,
        "--prefix",
        "none",
        "--no-dedupe",
        "--format",
        "{p}|{f}",
    ]))?;
    let objections = objections(&tree);
    if objections.is_empty() { Ok(crates(&tree).len()) } else { Err(Failure::found(objections.join("\n"))) }
}

/// Name and features of every crate of the tree, once each.
fn crates(tree: &str) -> Vec<(&str, &str)> {
    let mut found: Vec<(&str, &str)> = tree
        .lines()
        .filter_map(|line| {
            let (package, features) = line.split_once('|')?;
            let name = package.split_whitespace().next()?;
            Some((name, features.trim_end_matches(" (*)")))
        })
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

fn objections(tree: &str) -> Vec<String> {
    let mut said = Vec::new();
    if !crates(tree).iter().any(|(name, _)| *name == "truepath-core") {
        said.push("cargo tree did not show truepath-core".to_owned());
    }
    for (name, features) in crates(tree) {
        if !ALLOWED.iter().any(|(allowed, _)| *allowed == name) {
            said.push(format!("{name} is not on the list of crates for the microcontroller"));
        }
        for feature in features.split(',').filter(|f| FORBIDDEN_FEATURES.contains(f)) {
            said.push(format!("{name} is built with its feature `{feature}`"));
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_float_library_an_allocator_and_std_are_named() {
        let tree = "truepath-core v0.1.0 (/x)|\nnom v8.0.0|alloc,std\nmicromath v2.1.0|\n";
        let said = objections(tree);
        assert_eq!(
            said,
            [
                "micromath is not on the list of crates for the microcontroller",
                "nom is built with its feature `alloc`",
                "nom is built with its feature `std`",
            ]
        );
    }

    #[test]
    fn a_tree_without_the_core_is_not_taken_for_a_clean_one() {
        assert_eq!(objections("").len(), 1);
    }

    #[test]
    fn the_core_as_it_stands_brings_only_listed_crates() {
        assert!(check().unwrap() >= 5);
    }
}
