//! The packages of the workspace: where each lies, how sources name it, where its module trees begin.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::repository::{cargo, read, root};
use crate::step::Failure;

/// A package of the workspace.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Package {
    /// Its name, `truepath-core`.
    pub name: String,
    /// Its folder, relative to the root.
    pub folder: PathBuf,
    /// The file its library begins with, relative to the root.
    pub library: Option<PathBuf>,
    /// The files its programs begin with.
    pub programs: Vec<PathBuf>,
    /// Its dependencies, dev-dependencies left out: the name in the sources, the package.
    pub dependencies: Vec<(String, String)>,
}

/// The packages of the workspace, by folder.
///
/// # Errors
/// When cargo cannot tell.
pub fn packages() -> Result<Vec<Package>, Failure> {
    // Without dependencies: works with an empty cargo home.
    let said = read(cargo().args(["metadata", "--no-deps", "--format-version=1"]))?;
    let metadata: Value = serde_json::from_str(&said).map_err(|e| Failure::found(format!("cargo metadata: {e}")))?;
    let mut packages: Vec<Package> = list(&metadata["packages"]).iter().filter_map(package).collect();
    packages.sort_by(|a, b| a.folder.cmp(&b.folder));
    if packages.is_empty() { Err(Failure::found("cargo metadata names no package")) } else { Ok(packages) }
}

/// A package as `cargo metadata` describes it.
fn package(said: &Value) -> Option<Package> {
    let mut package = Package {
        name: said["name"].as_str()?.to_owned(),
        folder: relative(Path::new(said["manifest_path"].as_str()?).parent()?),
        ..Package::default()
    };
    for target in list(&said["targets"]) {
        let file = relative(Path::new(target["src_path"].as_str()?));
        let is = |kind: &str| list(&target["kind"]).iter().any(|k| k == kind);
        if is("bin") {
            package.programs.push(file);
        } else if ["lib", "rlib", "staticlib", "cdylib", "proc-macro"].iter().any(|kind| is(kind)) {
            package.library = Some(file);
        }
    }
    let normal = |dependency: &&Value| dependency["kind"].is_null();
    package.dependencies = list(&said["dependencies"]).iter().filter(normal).filter_map(dependency).collect();
    Some(package)
}

fn dependency(said: &Value) -> Option<(String, String)> {
    let name = said["name"].as_str()?;
    let in_sources = said["rename"].as_str().unwrap_or(name).replace('-', "_");
    Some((in_sources, name.to_owned()))
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn relative(path: &Path) -> PathBuf {
    path.strip_prefix(root()).unwrap_or(path).to_owned()
}
