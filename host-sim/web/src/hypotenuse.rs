//! `hypot` as the other rooms of the host have it, whose method of that name the library of the target would round otherwise.

/// The hypotenuse, as C has it: the linker takes this one.
#[unsafe(no_mangle)]
pub extern "C" fn hypot(x: f64, y: f64) -> f64 {
    truepath_ground::hypotenuse::hypot(x, y)
}
