//! What runs while nothing else does: the on-board correction.

use super::flash::Bank2;
use super::memory;
use crate::board::ServoCell;
use crate::board::config_link::{SharedDesk, work};

/// Never returns. The processor sleeps until the next interrupt when nothing is to be done.
pub fn run(desk: &'static SharedDesk<Bank2>, servo: &'static ServoCell) -> ! {
    let mut workspace = memory::workshop().workspace();
    loop {
        if !work(desk, servo, &mut workspace) {
            cortex_m::asm::wfi();
        }
    }
}
