//! What the code of the core may do on the microcontroller.
//!
//! The core computes in integers: an operation on floats anywhere in it is a fault, but for the crate that evaluates the
//! expressions of G-code programs ([`FLOAT_CRATE`]), which no setpoint passes. In the servo cycle, that is in
//! [`TICK`] and all it calls, there is besides no division in software (its time would depend on the operands), no
//! 128-bit division or product, no panic and no formatting.

use super::code::{Code, Function};
use super::operations::FLOAT;

/// The crates under the rules, a user before what it uses.
pub const CRATES: [&str; 5] = ["truepath_core", "truepath_model", "truepath_wire", "truepath_rs274", "truepath_units"];
/// The crate whose functions may compute in floating point.
pub const FLOAT_CRATE: &str = "truepath_rs274";
/// The function called in every servo cycle: its crate, its module, its name.
const TICK: (&str, &str, &str) = ("truepath_wire", "rewrite", "tick_into");

/// Whether an entry is an operation on floats: an instruction of the intermediate representation, or a routine of the
/// run-time ABI for ARM (IHI0043, tables 2 to 8).
pub fn is_float(entry: &str) -> bool {
    match (entry.strip_prefix("llvm "), entry.strip_prefix("__aeabi_")) {
        (Some(instruction), _) => FLOAT.contains(&instruction),
        (_, Some(routine)) => {
            routine.starts_with(['d', 'f', 'h'])
                || routine.starts_with("cd")
                || routine.starts_with("cf")
                || ["2d", "2f", "2h"].iter().any(|end| routine.ends_with(end))
        }
        _ => false,
    }
}

/// Whether an entry is a division in software: one of 64 bits is a routine, one of 128 bits a loop in place.
pub fn is_division(entry: &str) -> bool {
    let routines = ["__aeabi_idiv", "__aeabi_uidiv", "__aeabi_ldivmod", "__aeabi_uldivmod", "__divti3", "__udivti3"];
    let in_place = ["llvm sdiv i128", "llvm udiv i128", "llvm srem i128", "llvm urem i128"];
    routines.iter().any(|routine| entry.starts_with(routine)) || in_place.contains(&entry)
}

/// Whether an entry is a 128-bit product: a dozen multiplications in place, for which 64 bits do.
fn is_wide_product(entry: &str) -> bool {
    entry == "llvm mul i128" || entry == "__multi3"
}

/// Whether an entry is the library's panic or its formatting.
pub fn is_panic_or_formatting(entry: &str) -> bool {
    let name = format!("{:#}", rustc_demangle::demangle(entry));
    ["core::panicking", "core::fmt::", "_fail"].iter().any(|part| name.contains(part))
}

/// Whether a function belongs to the module of the servo cycle.
fn in_servo_cycle(function: &Function) -> bool {
    function.module(TICK.0) == Some(TICK.1)
}

fn is_tick(function: &Function) -> bool {
    in_servo_cycle(function) && function.name.ends_with(&format!("::{}", TICK.2))
}

/// Checks the rules; returns what breaks them, one line each.
pub fn objections(code: &Code) -> Vec<String> {
    let mut said = Vec::new();
    let mut object = |what: &str, ways: Vec<Vec<String>>| {
        said.extend(ways.into_iter().map(|way| format!("{what}: {}", way.join(" → "))));
    };
    let direct = |ways: Vec<Vec<String>>| ways.into_iter().filter(|way| way.len() == 2).collect();
    object("operation on floats", direct(code.ways(|f| f.module(FLOAT_CRATE).is_none(), is_float)));
    object("division in the servo cycle", code.ways(is_tick, is_division));
    object("128-bit product in the servo cycle", code.ways(is_tick, is_wide_product));
    object("panic or formatting in the servo cycle", code.ways(is_tick, is_panic_or_formatting));
    let mut functions = code.functions.values();
    if functions.clone().any(in_servo_cycle) && !functions.any(is_tick) {
        said.push(format!("{}::{} is not in the library: the servo cycle was not checked", TICK.1, TICK.2));
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(functions: &[(&str, &[&str])]) -> Code {
        let function = |(name, calls): &(&str, &[&str])| {
            let calls = calls.iter().map(|c| (*c).to_owned()).collect();
            ((*name).to_owned(), Function { name: (*name).to_owned(), bytes: 2, calls })
        };
        Code { functions: functions.iter().map(function).collect() }
    }

    #[test]
    fn operations_on_floats_and_divisions_are_told_from_others() {
        for entry in [
            "__aeabi_dadd",
            "__aeabi_fcmpun",
            "__aeabi_ul2d",
            "__aeabi_f2lz",
            "__aeabi_cdcmple",
            "llvm fmul",
            "llvm sitofp",
        ] {
            assert!(is_float(entry), "{entry}");
        }
        for entry in ["__aeabi_ldivmod", "__aeabi_memcpy4", "__aeabi_lmul", "llvm sdiv i128", "_ZN4core3fmt5write17h0E"]
        {
            assert!(!is_float(entry), "{entry}");
        }
        for entry in ["__aeabi_ldivmod", "__aeabi_uldivmod", "__aeabi_uidivmod", "llvm udiv i128", "__udivti3"] {
            assert!(is_division(entry), "{entry}");
        }
        assert!(!is_division("__aeabi_lmul") && !is_division("llvm mul i128"));
    }

    #[test]
    fn the_servo_cycle_may_not_divide_or_panic_even_in_a_function_it_calls() {
        let said = objections(&code(&[
            (
                "truepath_wire::rewrite::Rewriter::tick_into",
                &["truepath_units::round::ratio", "core::panicking::panic"],
            ),
            ("truepath_wire::rewrite::Rewriter::new", &["llvm sdiv i128"]),
            ("truepath_units::round::ratio", &["__aeabi_ldivmod", "llvm mul i128"]),
            ("truepath_model::correct::design", &["__aeabi_ldivmod"]),
        ]));
        assert_eq!(
            said,
            [
                "division in the servo cycle: truepath_wire::rewrite::Rewriter::tick_into → truepath_units::round::ratio → __aeabi_ldivmod",
                "128-bit product in the servo cycle: truepath_wire::rewrite::Rewriter::tick_into → truepath_units::round::ratio → llvm mul i128",
                "panic or formatting in the servo cycle: truepath_wire::rewrite::Rewriter::tick_into → core::panicking::panic",
            ]
        );
    }

    #[test]
    fn a_float_anywhere_in_the_core_is_named_once_with_its_function() {
        let expressions = "truepath_rs274::expression::evaluate";
        let said = objections(&code(&[("a", &["b"]), ("b", &["llvm fadd"]), (expressions, &["__aeabi_dadd"])]));
        assert_eq!(said, ["operation on floats: b → llvm fadd"]);
    }

    #[test]
    fn a_servo_cycle_that_is_not_in_the_library_is_not_taken_for_a_clean_one() {
        let said = objections(&code(&[("truepath_wire::rewrite::Rewriter::new", &[])]));
        assert_eq!(said, ["rewrite::tick_into is not in the library: the servo cycle was not checked"]);
    }
}
