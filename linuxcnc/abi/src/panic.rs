//! There is no panic but within the verification of a signature, whose arithmetic the compiler cannot see through: the build
//! of the component finds any other (`cargo xtask linuxcnc build`), before anything is loaded. One that happened there all
//! the same ends the work of the configuration thread for good: no image is taken and nothing armed any more, and the servo
//! thread goes on.

use core::panic::PanicInfo;

unsafe extern "C" {
    /// Of the component; `config_thread.h`.
    fn truepath_halt() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: it takes nothing and does not come back.
    unsafe { truepath_halt() }
}
