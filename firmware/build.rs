//! Hands the linker the scripts of the chosen board.

use std::env;
use std::path::PathBuf;

/// A board: the feature that chooses it, its images, and the scripts they are linked with.
struct Board {
    feature: &'static str,
    bins: &'static [&'static str],
    scripts: &'static [&'static str],
}

/// The map of the virtual board lies in the root of the workspace; the HAL of a real part adds the names of its
/// interrupts, `device.x`.
const BOARDS: [Board; 2] = [
    Board {
        feature: "CARGO_FEATURE_BOARD_VIRTUAL",
        bins: &["truepath-virtual", "budget"],
        scripts: &["memory.x", "startup.x", "stack.x", "defmt.x"],
    },
    Board {
        feature: "CARGO_FEATURE_BOARD_NUCLEO_H743",
        bins: &["truepath-nucleo-h743"],
        scripts: &["nucleo-h743.x", "startup.x", "device.x", "stack.x", "defmt.x"],
    },
];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=boards");
    println!("cargo:rerun-if-changed=../memory.x");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let firmware = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    println!("cargo:rustc-link-search={}", firmware.join("boards").display());
    println!("cargo:rustc-link-search={}", firmware.join("..").display());

    println!("cargo:rustc-link-arg-bin=realtime=-Trealtime.x");
    for Board { bins, scripts, .. } in BOARDS.into_iter().filter(|board| env::var_os(board.feature).is_some()) {
        for bin in bins {
            for script in scripts {
                println!("cargo:rustc-link-arg-bin={bin}=-T{script}");
            }
            // No alignment of sections to pages, which would not fit the map.
            println!("cargo:rustc-link-arg-bin={bin}=--nmagic");
        }
    }
}
