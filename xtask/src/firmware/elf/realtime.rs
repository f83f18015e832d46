//! What must not be in the image of the setpoint path.

use super::graph::Graph;
use crate::firmware::image::Image;
use crate::step::Failure;
use crate::toolchain::Toolchain;

const IMAGE: Image = Image { bin: "realtime", features: "proof", for_size: false };
/// The functions that lead into the setpoint path: without them the image proves nothing.
const ROOTS: [&str; 3] = ["realtime_receive", "realtime_frame", "realtime_watch"];

/// Links the setpoint path, which fails when a panic can be reached, and looks for what must not be in it. Returns how
/// many functions and bytes of code there are.
///
/// # Errors
/// A panic is reachable, or the image holds something forbidden.
pub fn check(toolchain: &Toolchain) -> Result<usize, Failure> {
    let elf = IMAGE.build(toolchain).map_err(|failure| match failure {
        Failure::Found(said) => {
            Failure::found(format!("{said}\nan undefined truepath_panic_is_reachable: a panic can be reached"))
        }
        missing @ Failure::Missing(_) => missing,
    })?;
    let graph = Graph::read(&elf)?;
    let names: Vec<&str> = graph.functions.values().map(|f| f.name.as_str()).collect();
    let mut said: Vec<String> =
        ROOTS.iter().filter(|root| !names.contains(*root)).map(|root| format!("{root} is not in the image")).collect();
    said.extend(graph.symbols.keys().filter_map(|symbol| forbidden(symbol).map(|why| format!("{symbol}: {why}"))));
    let calls =
        graph.functions.values().filter(|f| f.indirect).map(|f| format!("{}: calls through a register", f.name));
    said.extend(calls);
    if said.is_empty() { Ok(names.len()) } else { Err(Failure::found(said.join("\n"))) }
}

/// Why a symbol must not be there.
fn forbidden(symbol: &str) -> Option<&'static str> {
    let name = format!("{:#}", rustc_demangle::demangle(symbol));
    let float = |name: &str| {
        let soft = name.strip_prefix("__aeabi_").is_some_and(|rest| rest.starts_with(['d', 'f']));
        soft || name.ends_with("df3") || name.ends_with("sf3") || name.ends_with("df2") || name.ends_with("sf2")
    };
    if name.contains("panicking") || name.contains("panic_fmt") {
        Some("panics")
    } else if name.contains("core::fmt::") {
        Some("formats")
    } else if name.contains("div")
        && (name.starts_with("__aeabi_") || name.starts_with("__u") || name.starts_with("__div"))
        || name.contains("divmod")
    {
        Some("divides")
    } else if float(&name) {
        Some("soft float")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn routines_that_have_no_place_in_the_setpoint_path_are_known_by_name() {
        for symbol in [
            "__aeabi_dmul",
            "__aeabi_fadd",
            "__adddf3",
            "__aeabi_uldivmod",
            "__aeabi_ldivmod",
            "__udivmoddi4",
            "__divdi3",
        ] {
            assert!(forbidden(symbol).is_some(), "{symbol}");
        }
        assert_eq!(forbidden("_ZN4core9panicking5panic17h0123456789abcdefE"), Some("panics"));
        for symbol in [
            "__aeabi_memcpy",
            "__aeabi_llsl",
            "realtime_receive",
            "_RNvNtNtCs4HsFktntVZn_13truepath_wire7rewrite6locate6locate",
        ] {
            assert_eq!(forbidden(symbol), None, "{symbol}");
        }
    }
}
