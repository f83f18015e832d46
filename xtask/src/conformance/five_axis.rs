//! LinuxCNC's own five-axis programs through `truepath multiaxis`, and its interpreter over the result.
//!
//! The programs switch the kinematics with M428 and M429, which only the remaps of their configurations know: for the
//! interpreter alone these lines are made comments, in the original and in the result. Both must be accepted, the result
//! with as many feed moves more as points were inserted; and a second run must find nothing to insert.

use std::fs;
use std::path::{Path, PathBuf};

use super::corpus::PACKAGE;
use crate::repository::{program, read, target};
use crate::step::Failure;

/// The programs, with the letter of the axis that carries C.
const PROGRAMS: [(&str, &str); 3] =
    [("demos/boat-xyzac.ngc", "A"), ("demos/boat-xyzbc.ngc", "B"), ("demos/impeller-7bl-xyzac.ngc", "A")];

/// Rewrites and judges every one of them.
///
/// # Errors
/// A program that is not shipped any more, not rewritten, not accepted, or not within the tolerance the second time.
pub fn check() -> Result<(), Failure> {
    let listed = read(program("dpkg").args(["-L", PACKAGE]))?;
    let folder = target().join("conformance/five-axis");
    fs::create_dir_all(&folder).map_err(|e| failed(&folder, &e))?;
    for (name, carrier) in PROGRAMS {
        let Some(shipped) = listed.lines().find(|l| l.ends_with(name)) else {
            return Err(Failure::found(format!("{PACKAGE} ships no {name} any more")));
        };
        one(Path::new(shipped), carrier, &folder)?;
    }
    Ok(())
}

fn one(shipped: &Path, carrier: &str, folder: &Path) -> Result<(), Failure> {
    let machine = folder.join("machine.toml");
    let table =
        |axis: &str| format!("[[rotary]]\naxis = \"{axis}\"\npoint_mm = [0.0, 0.0, -20.0]\nturns = \"left-hand\"\n");
    let text = format!("version = 1\nkind = \"table-table\"\n{}{}", table(carrier), table("C"));
    fs::write(&machine, text).map_err(|e| failed(&machine, &e))?;
    let (first, second) = (folder.join("rewritten.ngc"), folder.join("again.ngc"));
    let inserted = rewrite(shipped, &machine, &first)?;
    if inserted == 0 {
        return Err(Failure::found(format!("{}: nothing is inserted", shipped.display())));
    }
    if rewrite(&first, &machine, &second)? != 0 {
        return Err(Failure::found(format!("{}: a second run inserts points again", shipped.display())));
    }
    let (before, after) = (feeds(shipped, folder)?, feeds(&first, folder)?);
    if after != before + inserted {
        let found = format!("{after} feed moves, not {before} and {inserted}");
        return Err(Failure::found(format!("{}: the interpreter sees {found}", shipped.display())));
    }
    println!("{}: {inserted} points inserted, {after} feed moves accepted", shipped.display());
    Ok(())
}

/// Points that `truepath multiaxis` inserts.
fn rewrite(from: &Path, machine: &Path, to: &Path) -> Result<u64, Failure> {
    let mut command = program(target().join("debug/truepath"));
    command.arg("multiaxis").arg(from).arg("--machine").arg(machine).arg("-o").arg(to);
    let told = read(command.args(["--tolerance", "0.005", "--tcp", "ends", "--force", "--json"]))?;
    let told: serde_json::Value =
        serde_json::from_str(&told).map_err(|e| Failure::found(format!("{}: {e}", from.display())))?;
    told["points_inserted"].as_u64().ok_or_else(|| Failure::found("the summary has no points_inserted"))
}

/// Feed moves the interpreter sees.
fn feeds(path: &Path, folder: &Path) -> Result<u64, Failure> {
    let text = fs::read_to_string(path).map_err(|e| failed(path, &e))?;
    let plain: PathBuf = folder.join("plain.ngc");
    let mended: Vec<&str> = text.lines().map(|l| if l.starts_with("M42") { "(kinematics)" } else { l }).collect();
    fs::write(&plain, mended.join("\n") + "\n").map_err(|e| failed(&plain, &e))?;
    let calls = read(program("rs274").arg("-g").arg(&plain))?;
    Ok(calls.lines().filter(|l| l.contains("STRAIGHT_FEED")).count() as u64)
}

fn failed(path: &Path, error: &std::io::Error) -> Failure {
    Failure::found(format!("{}: {error}", path.display()))
}
