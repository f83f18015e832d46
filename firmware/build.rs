//! Hands the linker the memory map of the chosen board.
//!
//! The startup code's script says `INCLUDE memory.x`, and lld looks for it in the directory it runs in, the root of the
//! workspace, before it looks anywhere else. There lies the map of the virtual board. Another board therefore gets a
//! copy of that script with its own map in place of the include.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// A board: the feature that chooses it, its images, and its memory map in `boards/` if it is not the default one.
struct Board {
    feature: &'static str,
    bins: &'static [&'static str],
    map: Option<&'static str>,
}

const BOARDS: [Board; 2] = [
    Board { feature: "CARGO_FEATURE_BOARD_VIRTUAL", bins: &["truepath-virtual", "budget"], map: None },
    Board { feature: "CARGO_FEATURE_BOARD_NUCLEO_H743", bins: &["truepath-nucleo-h743"], map: Some("nucleo-h743.x") },
];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=boards");
    println!("cargo:rerun-if-changed=../memory.x");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let boards = PathBuf::from(variable("CARGO_MANIFEST_DIR")).join("boards");
    let out = PathBuf::from(variable("OUT_DIR"));
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-search={}", boards.display());
    // The linker runs in the root when cargo does; this serves whoever builds from elsewhere.
    println!("cargo:rustc-link-search={}", boards.join("../..").display());

    println!("cargo:rustc-link-arg-bin=realtime=-Trealtime.x");
    for Board { bins, map, .. } in BOARDS.into_iter().filter(|board| env::var_os(board.feature).is_some()) {
        let script = match map {
            Some(map) => {
                let script = startup_script().replace("INCLUDE memory.x", &format!("INCLUDE {map}"));
                let script = format!("{script}\nINCLUDE device.x\n");
                fs::write(out.join("board.x"), script).expect("OUT_DIR can be written to");
                "board.x"
            }
            None => {
                let device = "/* Every line of the table is set by the board file. */\n";
                fs::write(out.join("device.x"), device).expect("OUT_DIR can be written to");
                "link.x"
            }
        };
        // `--nmagic`: no alignment of sections to pages, which would not fit the map.
        for bin in bins {
            for argument in [&format!("-T{script}"), "-Tdefmt.x", "-Tstack.x", "--nmagic"] {
                println!("cargo:rustc-link-arg-bin={bin}={argument}");
            }
        }
    }
}

/// The link script in the sources of cortex-m-rt that this build uses.
fn startup_script() -> String {
    let metadata = std::process::Command::new(variable("CARGO"))
        // Only the packages of the board: those of other systems need not be there.
        .args(["metadata", "--format-version=1", "--offline", "--all-features"])
        .args(["--filter-platform", &variable("TARGET")])
        .output()
        .expect("cargo metadata can be started");
    let text = String::from_utf8(metadata.stdout).expect("cargo writes UTF-8");
    let manifest = text
        .split('"')
        .find(|word| word.contains("cortex-m-rt-0.") && word.ends_with("Cargo.toml"))
        .expect("cortex-m-rt is a dependency");
    let script = Path::new(manifest).with_file_name("link.x.in");
    fs::read_to_string(&script).unwrap_or_else(|e| panic!("{}: {e}", script.display()))
}

fn variable(name: &str) -> String {
    env::var(name).unwrap_or_else(|e| panic!("{name}: {e}"))
}
