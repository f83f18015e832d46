//! truepath.so, the real-time component, and truepath_wall.so, which only the sample machine has.
//!
//! LinuxCNC's `halcompile` turns `linuxcnc/truepath.comp` and `linuxcnc/sim/truepath_wall.comp` into C, its `Makefile.modinc` compiles and links that with the
//! flags of its own modules. All of it happens below the target directory.

use std::fs;
use std::path::{Path, PathBuf};

use super::proof::{self, Proved};
use crate::repository::{cargo, program, read, root, run, succeeds, target};
use crate::step::Failure;

/// Debian's package with what compiles components.
const PACKAGE: &str = "linuxcnc-uspace-dev";

/// What is built, and from what.
pub const MODULES: [(&str, &str); 2] =
    [("truepath.so", "linuxcnc/truepath.comp"), ("truepath_wall.so", "linuxcnc/sim/truepath_wall.comp")];

/// Builds both; gives their folder, in which `make install` puts them among LinuxCNC's modules.
///
/// # Errors
/// LinuxCNC's development package is missing, or something does not compile.
pub fn build() -> Result<PathBuf, Failure> {
    if !can_build() {
        return Err(Failure::Missing(format!(
            "halcompile, which builds components of LinuxCNC, cannot be started. Install it:\n  apt-get install {PACKAGE}"
        )));
    }
    let folder = target().join("linuxcnc");
    fs::create_dir_all(&folder).map_err(|e| written(&folder, &e))?;
    let library = library()?;
    for (_, source) in MODULES {
        let source = root().join(source);
        let c = folder.join(source.with_extension("c").file_name().unwrap_or_default());
        run(program("halcompile").args(["--preprocess", "--outfile"]).arg(&c).arg(&source))?;
    }
    let rules = read(program("halcompile").arg("--print-modinc"))?;
    let makefile = folder.join("Makefile");
    fs::write(&makefile, text(rules.trim(), &library)).map_err(|e| written(&makefile, &e))?;
    run(program("make").arg("--directory").arg(&folder).arg("modules"))?;
    for (made, _) in MODULES {
        let made = folder.join(made);
        let bytes = fs::metadata(&made).map_err(|e| written(&made, &e))?.len();
        println!("{}: {bytes} bytes", made.display());
    }
    let Proved { functions, instructions } = proof::check(&folder.join(MODULES[0].0))?;
    println!(
        "servo side: {functions} functions, {instructions} instructions; no panic, no allocation, no system call, no \
         division, floats only between pins and nanometres"
    );
    Ok(folder)
}

/// Whether LinuxCNC's development package is there.
pub fn can_build() -> bool {
    succeeds(program("halcompile").arg("--print-modinc"))
}

/// The core as a static library: whole-program optimised, position independent, a panic has no handler.
fn library() -> Result<PathBuf, Failure> {
    let mut build = cargo();
    build.args(["rustc", "--profile", "firmware", "--package", "truepath-abi", "--features", "component", "--lib"]);
    build.args(["--crate-type", "staticlib"]);
    run(&mut build)?;
    Ok(target().join("firmware/libtruepath_abi.a"))
}

/// The makefile, with LinuxCNC's own rules.
fn text(rules: &str, library: &Path) -> String {
    let sources = root().join("linuxcnc");
    format!(
        "obj-m += truepath.o truepath_wall.o\n\
         truepath-objs := truepath.o\n\
         truepath_wall-objs := truepath_wall.o\n\
         include {rules}\n\
         EXTRA_CFLAGS += -std=gnu11 -Wall -Wextra -Wno-unused-function -Wno-unused-parameter -I{0} -I{0}/abi\n\
         LDFLAGS += -Wl,--gc-sections -pthread\n\
         truepath.so: {1}\n",
        sources.display(),
        library.display()
    )
}

fn written(path: &Path, error: &std::io::Error) -> Failure {
    Failure::found(format!("{}: {error}", path.display()))
}
