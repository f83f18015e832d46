//! The core as the microcontroller gets it: which crates, which symbols, how large.

mod code;
mod dependencies;
mod operations;
mod rules;

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::repository::{read, target};
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
    let mut build = toolchain.cargo();
    build.args(["build", "--package", "truepath-core", "--lib", "--release", "--target", TARGET, "--target-dir"]);
    build.arg(&directory).args(["--message-format", "json-render-diagnostics"]);
    // The intermediate representation lies beside each library; this adds to the flags of the target.
    build.arg("--config").arg(format!("target.{TARGET}.rustflags=[\"--emit=llvm-ir\"]"));
    // Code in the library itself, in one piece, instead of bitcode for the linker.
    build.env("CARGO_PROFILE_RELEASE_LTO", "off").env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1");
    let built = read(&mut build)?;
    let mut code = Code::default();
    for name in rules::CRATES {
        let files = files(&built, name);
        let library = files.iter().find(|file| file.extension().is_some_and(|e| e == "rlib"));
        let library = library.ok_or_else(|| Failure::found(format!("cargo built no library {name}")))?;
        code.read(library)?;
        let representation = representation(&files)
            .ok_or_else(|| Failure::found(format!("no intermediate representation beside any of {files:?}")))?;
        let text = std::fs::read_to_string(&representation)
            .map_err(|e| Failure::found(format!("{}: {e}", representation.display())))?;
        code.add_operations(operations::operations(&text))?;
    }
    print!("{}", inventory(&code, crates));
    let said = rules::objections(&code);
    if said.is_empty() { Ok(Passed::Done) } else { Err(Failure::found(said.join("\n"))) }
}

/// The files of a library crate, of what cargo says it has built.
fn files(built: &str, name: &str) -> Vec<PathBuf> {
    let said = built.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let own = said.filter(|said| said["reason"] == "compiler-artifact" && said["target"]["name"] == name);
    own.filter_map(|said| {
        let files = said["filenames"].as_array()?.clone();
        Some(files.into_iter().filter_map(|file| file.as_str().map(PathBuf::from)))
    })
    .flatten()
    .collect()
}

/// The intermediate representation: `truepath_wire-0123.ll` beside `libtruepath_wire-0123.rmeta`. The library of the
/// package asked for is named without the hash and lies elsewhere, so each file of the crate is tried.
fn representation(files: &[PathBuf]) -> Option<PathBuf> {
    let beside = files.iter().filter_map(|file| {
        let name = file.file_stem()?.to_str()?;
        Some(file.with_file_name(format!("{}.ll", name.strip_prefix("lib")?)))
    });
    beside.into_iter().find(|file| file.exists())
}

/// Size of the code by module, before the linker removes what a firmware does not use.
fn inventory(code: &Code, crates: usize) -> String {
    let mut modules: BTreeMap<String, (usize, u64)> = BTreeMap::new();
    for function in code.functions.values() {
        let name = match rules::CRATES.iter().find_map(|name| Some((name, function.module(name)?))) {
            Some((name, module)) => format!("{name}::{module}"),
            None => "(generic code of other crates)".to_owned(),
        };
        let entry = modules.entry(name).or_default();
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
