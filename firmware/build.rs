//! Hands the linker the scripts of the chosen board.

use std::env;
use std::path::PathBuf;

/// Images of a board: the feature that chooses it, and the scripts they are linked with, by themselves and with a loader.
struct Images {
    feature: &'static str,
    bins: &'static [&'static str],
    scripts: &'static [&'static str],
    updatable: &'static [&'static str],
}

const VIRTUAL: &str = "CARGO_FEATURE_BOARD_VIRTUAL";
const NUCLEO_H743: &str = "CARGO_FEATURE_BOARD_NUCLEO_H743";
const UPDATABLE: &str = "CARGO_FEATURE_UPDATABLE";

/// The map of the virtual board lies in the root of the workspace; the HAL of a real part adds the names of its
/// interrupts, `device.x`.
const IMAGES: [Images; 4] = [
    Images {
        feature: VIRTUAL,
        bins: &["truepath-virtual", "budget"],
        scripts: &["memory.x", "alone.x", "startup.x", "stack.x", "defmt.x"],
        updatable: &["memory.x", "program.x", "startup.x", "virtual-entry.x", "stack.x", "defmt.x"],
    },
    Images {
        feature: VIRTUAL,
        bins: &["truepath-virtual-loader"],
        scripts: &[],
        updatable: &["memory.x", "loader.x", "startup.x", "stack.x", "defmt.x"],
    },
    Images {
        feature: NUCLEO_H743,
        bins: &["truepath-nucleo-h743"],
        scripts: &["nucleo-h743.x", "alone.x", "startup.x", "device.x", "stack.x", "defmt.x"],
        updatable: &["nucleo-h743.x", "program.x", "startup.x", "device.x", "stack.x", "defmt.x"],
    },
    Images {
        feature: NUCLEO_H743,
        bins: &["truepath-nucleo-h743-loader"],
        scripts: &[],
        updatable: &["nucleo-h743.x", "loader.x", "startup.x", "device.x", "stack.x", "defmt.x"],
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
    let is_updatable = env::var_os(UPDATABLE).is_some();
    for images in IMAGES.into_iter().filter(|images| env::var_os(images.feature).is_some()) {
        for bin in images.bins {
            for script in if is_updatable { images.updatable } else { images.scripts } {
                println!("cargo:rustc-link-arg-bin={bin}=-T{script}");
            }
            // No alignment of sections to pages, which would not fit the map.
            println!("cargo:rustc-link-arg-bin={bin}=--nmagic");
        }
    }
}
