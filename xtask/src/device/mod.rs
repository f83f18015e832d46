//! The core as the microcontroller gets it: which crates, which symbols, how large.

mod code;
mod dependencies;
mod operations;
mod rules;

use std::collections::BTreeMap;

use crate::repository::{run, target};
use crate::step::{Failure, Outcome, Passed};
use crate::toolchain::{TARGET, Toolchain};
use code::Code;

/// Builds the core for the microcontroller and checks what is in it.
pub fn check() -> Outcome {
    let toolchain = Toolchain::find()?;
    eprintln!("    {TARGET} by {}", toolchain.describe());
    let crates = dependencies::check()?;
    // A directory of its own: another compiler and other flags would rebuild everything else.
    let directory = target().join("device");
    let representation = directory.join("core.ll");
    let mut build = toolchain.cargo();
    build.args(["rustc", "--package", "truepath-core", "--lib", "--release", "--target", TARGET, "--target-dir"]);
    build.arg(&directory);
    // Code in the library itself, in one piece, instead of bitcode for the linker.
    build.env("CARGO_PROFILE_RELEASE_LTO", "off").env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1");
    build.arg("--").arg(format!("--emit=llvm-ir={}", representation.display()));
    run(&mut build)?;
    let mut code = Code::read(&directory.join(TARGET).join("release/libtruepath_core.rlib"))?;
    let text = std::fs::read_to_string(&representation)
        .map_err(|e| Failure::found(format!("{}: {e}", representation.display())))?;
    code.add_operations(operations::operations(&text))?;
    print!("{}", inventory(&code, crates));
    let said = rules::objections(&code);
    if said.is_empty() { Ok(Passed::Done) } else { Err(Failure::found(said.join("\n"))) }
}

/// Size of the code by module, before the linker removes what a firmware does not use.
fn inventory(code: &Code, crates: usize) -> String {
    let mut modules: BTreeMap<&str, (usize, u64)> = BTreeMap::new();
    for function in code.functions.values() {
        let entry =
            modules.entry(function.module(rules::CRATE).unwrap_or("(generic code of other crates)")).or_default();
        *entry = (entry.0 + 1, entry.1 + function.bytes);
    }
    let mut out = format!("{:<32} {:>9} {:>9}\n", "truepath-core, release", "functions", "bytes");
    for (module, (functions, bytes)) in &modules {
        out += &format!("{module:<32} {functions:>9} {bytes:>9}\n");
    }
    let (functions, bytes) = modules.values().fold((0, 0), |sum, m| (sum.0 + m.0, sum.1 + m.1));
    out += &format!("{:<32} {functions:>9} {bytes:>9}\n", "all");
    let routines: Vec<String> = code.routines().iter().map(|(name, calls)| format!("{name} {calls}")).collect();
    out + &format!(
        "routines of the compiler and 128-bit operations, with the functions that have them: {}\n{crates} crates, all on the list\n",
        routines.join(", ")
    )
}
