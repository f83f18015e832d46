//! What the servo side of truepath.so holds, read from its machine code.
//!
//! From the functions that the servo thread calls, over everything these call: nothing outside the component but copying
//! and comparing memory, so no allocation and no system call; no call through a pointer; no division of integers, whose
//! time would depend on the numbers; floats only in [`CONVERSION`]. From no function of the library, the configuration's
//! included, a panic can be reached but in [`VERIFICATION`], the arithmetic of others. The code in C around it (pins, serial
//! port) is not looked at.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::repository::{program, read};
use crate::step::Failure;

/// What the servo thread calls.
const ROOTS: [&str; 8] = [
    "truepath_pc_feedback",
    "truepath_pc_command",
    "truepath_board_begin",
    "truepath_board_take",
    "truepath_board_finish",
    "truepath_board_room",
    "truepath_board_feedback",
    "truepath_board_not_sent",
];
/// The only module with floats: between HAL's pins and nanometres.
const CONVERSION: &str = "truepath_abi::convert::";
/// What may be called outside.
const OUTSIDE: [&str; 4] = ["memcpy", "memmove", "memset", "memcmp"];
/// What C calls begins so.
const LIBRARY: [&str; 2] = ["truepath_pc_", "truepath_board_"];
/// Called by the handler of panics alone.
const PANIC: &str = "truepath_halt";
/// Where signatures and keys are verified, and nowhere else, there may be panics.
const VERIFICATION: [&str; 2] =
    ["truepath_wire::image::signature::verify", "<truepath_wire::image::signature::PublicKey>::verifying"];

/// What was looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proved {
    /// Functions of the servo side.
    pub functions: usize,
    /// Their instructions.
    pub instructions: usize,
}

/// Checks a component.
///
/// # Errors
/// It holds something forbidden: every place is told.
pub fn check(component: &Path) -> Result<Proved, Failure> {
    let symbols = read(program("nm").arg(component))?;
    let code = read(program("objdump").args(["--disassemble", "--no-show-raw-insn"]).arg(component))?;
    let mut said = Vec::new();
    said.extend(symbols.lines().filter(|line| line.contains("_Unwind_")).map(|line| format!("{line}: unwinds")));
    let functions = functions(&code);
    panics(&functions, &mut said);
    let proved = servo_side(&functions, &mut said);
    if said.is_empty() { Ok(proved) } else { Err(Failure::found(said.join("\n"))) }
}

/// Instructions of each function by its name.
fn functions(code: &str) -> BTreeMap<&str, Vec<&str>> {
    let mut all = BTreeMap::new();
    let mut current: Option<&mut Vec<&str>> = None;
    for line in code.lines() {
        if let Some(name) = line.strip_suffix(">:").and_then(|head| head.split_once('<')).map(|(_, name)| name) {
            current = Some(all.entry(name).or_default());
        } else if let (Some(body), Some((_, instruction))) = (&mut current, line.split_once(":\t")) {
            body.push(instruction.trim());
        }
    }
    all
}

/// Looks for a panic that can be reached from what C calls.
fn panics(functions: &BTreeMap<&str, Vec<&str>>, said: &mut Vec<String>) {
    let is_called = |name: &&str| LIBRARY.iter().any(|library| name.starts_with(library));
    let mut todo: Vec<(&str, &str)> = functions.keys().copied().filter(is_called).map(|name| (name, name)).collect();
    let mut seen = BTreeSet::new();
    while let Some((name, from)) = todo.pop() {
        let readable = format!("{:#}", rustc_demangle::demangle(name));
        if name == PANIC {
            said.push(format!("a panic can be reached through {:#}", rustc_demangle::demangle(from)));
        }
        if !seen.insert(name) || VERIFICATION.contains(&readable.as_str()) {
            continue;
        }
        for instruction in functions.get(name).into_iter().flatten() {
            if let Found::Calls(to) = look(instruction, name) {
                todo.push((to, name));
            }
        }
    }
}

fn servo_side(functions: &BTreeMap<&str, Vec<&str>>, said: &mut Vec<String>) -> Proved {
    let mut todo: Vec<&str> = ROOTS.to_vec();
    let mut seen = BTreeSet::new();
    let mut instructions = 0;
    while let Some(name) = todo.pop() {
        if !seen.insert(name) {
            continue;
        }
        let readable = format!("{:#}", rustc_demangle::demangle(name));
        let Some(body) = functions.get(name) else {
            said.push(format!("{readable} is not in the component"));
            continue;
        };
        instructions += body.len();
        let converts = readable.starts_with(CONVERSION);
        for instruction in body {
            match look(instruction, name) {
                Found::Nothing => {}
                Found::Float if converts => {}
                Found::Calls(to) if OUTSIDE.contains(&to) => {}
                Found::Calls(to) => todo.push(to),
                Found::Float => said.push(format!("{readable}: float: {instruction}")),
                Found::Divides => said.push(format!("{readable}: divides: {instruction}")),
                Found::Pointer => said.push(format!("{readable}: calls through a pointer: {instruction}")),
            }
        }
    }
    Proved { functions: seen.len(), instructions }
}

/// What is worth noting in an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Found<'a> {
    Nothing,
    Calls(&'a str),
    Pointer,
    Float,
    Divides,
}

fn look<'a>(instruction: &'a str, function: &str) -> Found<'a> {
    let mnemonic = instruction.split_whitespace().find(|word| !["notrack", "bnd", "lock", "rep"].contains(word));
    let mnemonic = mnemonic.unwrap_or_default();
    if mnemonic.starts_with("call") || mnemonic.starts_with('j') {
        return match target(instruction) {
            Some(to) if to != function => Found::Calls(to),
            None if mnemonic.starts_with("call") => Found::Pointer,
            // Within the function, also by a table.
            _ => Found::Nothing,
        };
    }
    if ["div", "idiv"].iter().any(|division| mnemonic.trim_end_matches(['b', 'w', 'l', 'q']) == *division) {
        return Found::Divides;
    }
    if is_float(mnemonic) { Found::Float } else { Found::Nothing }
}

/// The function that is called or jumped to: `call 5180 <name>`, `call *0x12(%rip) # 15fd0 <memcpy@GLIBC_2.14>`.
fn target(instruction: &str) -> Option<&str> {
    let (_, behind) = instruction.rsplit_once('<')?;
    behind.split(['>', '+', '@']).next()
}

/// Whether it computes with floats, or converts from or to them; moving their bits about is none.
fn is_float(mnemonic: &str) -> bool {
    const OPERATIONS: [&str; 14] =
        ["add", "sub", "mul", "div", "sqrt", "min", "max", "ucomi", "comi", "cmp", "round", "hadd", "dp", "rcp"];
    let plain = mnemonic.strip_prefix('v').unwrap_or(mnemonic);
    if plain.starts_with("cvt") || plain.starts_with('f') && !plain.starts_with("fence") {
        return true;
    }
    let suffix = ["ss", "sd", "ps", "pd"].iter().find_map(|suffix| plain.strip_suffix(suffix));
    suffix.is_some_and(|stem| OPERATIONS.iter().any(|operation| stem.starts_with(operation)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_divisions_and_calls_are_known_and_moves_are_not() {
        for float in ["mulsd", "vaddpd", "cvttsd2si", "cvtsi2sd", "ucomisd", "fldl", "cmpltsd", "sqrtss"] {
            assert!(is_float(float), "{float}");
        }
        for plain in ["movsd", "movaps", "xorps", "movups", "addq", "cmpl", "mulq", "cmovs", "subl", "unpcklpd"] {
            assert!(!is_float(plain), "{plain}");
        }
        for (instruction, expected) in [
            ("call   5180 <other>", Found::Calls("other")),
            ("jmp    5180 <other>", Found::Calls("other")),
            ("jne    5190 <here+0x10>", Found::Nothing),
            ("call   *0xae12(%rip)        # 15fd0 <memcpy@GLIBC_2.14>", Found::Calls("memcpy")),
            ("call   30f0 <memset@plt>", Found::Calls("memset")),
            ("call   *%rax", Found::Pointer),
            ("notrack jmp *%rcx", Found::Nothing),
            ("idivl  0x8(%rax)", Found::Divides),
            ("div    %rcx", Found::Divides),
            ("mov    %rax,%rcx", Found::Nothing),
        ] {
            assert_eq!(look(instruction, "here"), expected, "{instruction}");
        }
    }

    #[test]
    fn a_panic_is_found_from_every_function_of_the_library_but_not_within_the_verification() {
        let code = |caller: &str| {
            format!(
                "0001 <truepath_pc_new>:\n 1:\tcall   2 <{caller}>\n0002 <{caller}>:\n 2:\tjmp    3 <unwrap_failed>\n\
                 0003 <unwrap_failed>:\n 3:\tcall   4 <truepath_halt>\n"
            )
        };
        for (caller, found) in [("check", 1), ("truepath_wire::image::signature::verify", 0)] {
            let mut said = Vec::new();
            panics(&functions(&code(caller)), &mut said);
            assert_eq!(said.len(), found, "{said:?}");
        }
    }

    #[test]
    fn what_is_forbidden_is_found_through_a_call() {
        let code = |inner: &str| {
            let roots: String = ROOTS.iter().map(|root| format!("0000 <{root}>:\n 1:\tcall   9 <inner>\n")).collect();
            format!("{roots}0009 <inner>:\n 9:\t{inner}\n a:\tret\n000b <outside>:\n b:\tmulsd  %xmm0,%xmm1\n")
        };
        let mut said = Vec::new();
        let proved = servo_side(&functions(&code("mov    %rax,%rbx")), &mut said);
        assert_eq!((proved.functions, proved.instructions, said.len()), (9, 10, 0));
        for inner in ["addsd  %xmm0,%xmm1", "call   1 <malloc@plt>", "call   *%rax", "div    %rcx"] {
            let mut said = Vec::new();
            servo_side(&functions(&code(inner)), &mut said);
            assert_eq!(said.len(), 1, "{inner}: {said:?}");
        }
    }
}
