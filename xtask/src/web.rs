//! The whole tool as one web page: the command line as a module of WebAssembly, in a page that needs no server and no network.
//!
//! `target/web/site` holds what is to be handed on or put on a server. The tests open it from disk in Chromium, run its
//! commands, and compare every file they write with those of the command line, byte for byte.

use std::path::PathBuf;
use std::process::Stdio;

use crate::firmware::linker;
use crate::page;
use crate::repository::{self, Profile, program, run, target};
use crate::step::{Failure, Outcome, Passed};
use crate::toolchain::{Toolchain, WASM};

/// How the module is built; the profiles are in the workspace's `Cargo.toml`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// To be handed on.
    Small,
    /// To be tested: built in less time.
    Tests,
}

impl Build {
    fn profile(self) -> &'static str {
        match self {
            Self::Small => "web",
            Self::Tests => "web-tests",
        }
    }
}

/// Builds the page, and with `tests` tries it.
///
/// # Errors
/// What does not build, a test that fails, a tool that is missing.
pub fn check(build: Build, tests: bool) -> Outcome {
    let module = module(build)?;
    let (tools, folder) = page::tools()?;
    // The example is a part of the demonstration, and the tests hold the page against this program.
    let command_line = repository::truepath(Profile::Dev)?;
    let web = target().join("web");
    let demo = web.join("demo");
    run(program(&command_line).args(["demo", "--force", "--output"]).arg(&demo).stdout(Stdio::null()))?;
    let site = web.join("site/index.html");
    run(tools.node(&folder).args(["node_modules/typescript/bin/tsc", "--noEmit"]))?;
    run(tools.node(&folder).arg("build-tool.mjs").args([&module, &demo.join("corner"), &site]))?;
    if tests {
        let mut test = tools.node(&folder);
        test.args(["--test", "--test-reporter=spec", "tests/tool.test.mjs"]);
        test.env("TRUEPATH_PAGES", &web).env("TRUEPATH_PROGRAM", &command_line).env("CHROMIUM", &tools.browser);
        run(&mut test)?;
    }
    println!("the page of the tool: {}", site.display());
    Ok(Passed::Done)
}

/// Builds the module; its file.
///
/// # Errors
/// What does not build, or a missing compiler.
pub fn module(build: Build) -> Result<PathBuf, Failure> {
    let toolchain = Toolchain::find_for(WASM)?;
    println!("compiler for {WASM}: {} ({})", toolchain.version()?, toolchain.describe());
    // A directory of its own: another compiler would rebuild everything else.
    let directory = target().join("wasm");
    let mut command = toolchain.cargo_with("std,panic_abort");
    command.args([
        "build",
        "--package",
        "truepath-web",
        "--profile",
        build.profile(),
        "--target",
        WASM,
        "--target-dir",
    ]);
    command.arg(&directory);
    linker::provide(&toolchain, &mut command)?;
    run(&mut command)?;
    Ok(directory.join(WASM).join(build.profile()).join("truepath_web.wasm"))
}
