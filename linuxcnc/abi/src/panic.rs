//! There is no panic: the handler calls a function that does not exist, so a module in which one is reachable is found
//! by the build (`cargo xtask linuxcnc build`), before anything is loaded.

use core::panic::PanicInfo;

unsafe extern "C" {
    fn truepath_a_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: never called, see above.
    unsafe { truepath_a_panic_is_reachable() }
}
