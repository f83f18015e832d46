//! Operations that leave no symbol behind, from the compiler's intermediate representation.
//!
//! Float arithmetic in hardware and 128-bit division (which LLVM expands in place on 32-bit ARM, as a loop of 128
//! turns) call nothing, so the object files do not show them. The optimised intermediate representation of the same
//! compilation does.

use std::collections::BTreeMap;

/// Instructions on floats.
pub const FLOAT: [&str; 13] = [
    "fadd", "fsub", "fmul", "fdiv", "frem", "fneg", "fcmp", "sitofp", "uitofp", "fptosi", "fptoui", "fpext", "fptrunc",
];
/// Instructions on integers, looked for at 128 bits.
const WIDE: [&str; 5] = ["sdiv", "udiv", "srem", "urem", "mul"];

/// The operations of every function, by its symbol: `llvm fadd`, `llvm sdiv i128`.
pub fn operations(representation: &str) -> BTreeMap<&str, Vec<String>> {
    let mut found: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let mut function = "";
    for line in representation.lines() {
        if let Some(definition) = line.strip_prefix("define ") {
            function = symbol(definition).unwrap_or_default();
        }
        // `  %name = opcode flags type operands`
        let Some((_, instruction)) = line.strip_prefix("  ").and_then(|l| l.split_once(" = ")) else { continue };
        let mut words = instruction.split([' ', ',']);
        let Some(opcode) = words.next() else { continue };
        let operation = if FLOAT.contains(&opcode) {
            format!("llvm {opcode}")
        } else if WIDE.contains(&opcode) && words.any(|w| w == "i128") {
            format!("llvm {opcode} i128")
        } else {
            continue;
        };
        found.entry(function).or_default().push(operation);
    }
    found
}

/// `name` of `… @name(…` or `… @"name"(…`.
fn symbol(definition: &str) -> Option<&str> {
    let (_, behind) = definition.split_once('@')?;
    match behind.strip_prefix('"') {
        Some(quoted) => quoted.split('"').next(),
        None => behind.split('(').next(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_and_wide_divisions_are_found_with_their_function() {
        let representation = "\
define internal fastcc void @_ZN1a1bE(ptr %x, i128 %y) unnamed_addr #0 {
start:
  %0 = fmul float %p, %q, !dbg !1
  %1 = sdiv exact i128 %y, 7
  %2 = sdiv i64 %c, %d
  %3 = load float, ptr %x
}
define i32 @\"_ZN1cE\"(i32 %x) {
  %4 = mul nuw nsw i128 %m, %n
  ret i32 0
}
";
        let found = operations(representation);
        assert_eq!(found["_ZN1a1bE"], ["llvm fmul", "llvm sdiv i128"]);
        assert_eq!(found["_ZN1cE"], ["llvm mul i128"]);
        assert_eq!(found.len(), 2);
    }
}
