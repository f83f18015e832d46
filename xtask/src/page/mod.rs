//! The report page: built from its sources as committed, and tried in a browser with pages that the program wrote.
//!
//! `host-sim/page` is a program of its own in TypeScript; what is built from it is committed, so that building Truepath
//! needs no Node.js. This step builds it anew and compares byte for byte, has the program write the pages of
//! [`parts`] and opens them in Chromium. Pictures of all of it lie in `target/page/pictures` afterwards.

mod parts;
mod tools;

use std::fs;
use std::path::{Path, PathBuf};

use crate::repository::{root, run, target};
use crate::step::{Failure, Outcome, Passed};
pub use tools::Tools;

/// The bundled page, relative to its folder.
const BUILT: &str = "dist/report.html";

/// Builds, compares and tries the page; with `write` the committed build and the pictures are renewed instead.
///
/// # Errors
/// A build that differs from the committed one, a test that fails, a tool that is missing.
pub fn check(write: bool) -> Outcome {
    let (tools, folder) = tools()?;
    bundle(&tools, &folder, write)?;
    let pages = parts::write()?;
    let mut tests = tools.node(&folder);
    tests.args(["--test", "--test-reporter=spec", "tests/all.test.mjs"]);
    tests.env("TRUEPATH_PAGES", &pages).env("CHROMIUM", &tools.browser).env("TRUEPATH_PAGES_AS_WRITTEN", "1");
    if write {
        tests.env("TRUEPATH_BLESS", "1");
    }
    run(&mut tests)?;
    println!("pictures of the pages: {}", pages.join("pictures").display());
    Ok(Passed::Done)
}

/// Node.js with the packages of the pages, a browser, and the folder of the pages.
///
/// # Errors
/// [`Failure::Missing`] with what is.
pub fn tools() -> Result<(Tools, PathBuf), Failure> {
    let tools = Tools::find()?;
    let folder = root().join("host-sim/page");
    let npm = ["ci", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"];
    run(tools.npm(&folder).args(npm)).map_err(|_| {
        Failure::Missing(
            "npm ci did not succeed (above): are package-lock.json whole and the registry reachable?".into(),
        )
    })?;
    Ok((tools, folder))
}

/// Builds the page beside the committed one and compares the two.
fn bundle(tools: &Tools, folder: &Path, write: bool) -> Result<(), Failure> {
    let built: PathBuf = target().join("page/report.html");
    run(tools.node(folder).args(["node_modules/typescript/bin/tsc", "--noEmit"]))?;
    run(tools.node(folder).arg("build.mjs").arg(&built))?;
    let bytes = |file: &Path| fs::read(file).map_err(|e| Failure::found(format!("{}: {e}", file.display())));
    let committed = folder.join(BUILT);
    if bytes(&built)? == bytes(&committed)? {
        return Ok(());
    }
    if write {
        fs::copy(&built, &committed).map_err(|e| Failure::found(format!("{}: {e}", committed.display())))?;
        println!("{} renewed", committed.display());
        return Ok(());
    }
    Err(Failure::found(format!(
        "{} is not what its sources give: run `cargo xtask page --write`, look at the page and commit both",
        committed.display()
    )))
}
