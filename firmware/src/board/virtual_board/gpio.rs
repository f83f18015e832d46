//! Pins of the CMSDK's port 0 (Arm DDI 0479, "AHB GPIO"): drive enable and fault.
//!
//! The emulator has no model of the port: writes go nowhere. What the pins would do is in the log and in `Status`.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};
use volatile_register::WO;

/// Bit of the drive enable in port 0.
pub const DRIVE_ENABLE: u32 = 0;
/// Bit of the fault output in port 0.
pub const FAULT: u32 = 1;

const BASE: usize = 0x4001_0000;
const OUTPUT_ENABLE_SET: usize = BASE + 0x10;
/// Writes to `BASE + 0x400 + 4 · mask` touch only the bits of the mask, of the lower byte.
const MASKED: usize = BASE + 0x400;

/// An output of port 0, bits 0 to 7.
#[derive(Debug)]
pub struct Output {
    mask: u32,
}

impl Output {
    /// The output of a bit, low.
    pub fn low(bit: u32) -> Self {
        let mut pin = Self { mask: 1 << (bit & 7) };
        // SAFETY: sets one bit of the direction register of the port.
        unsafe { register(OUTPUT_ENABLE_SET).write(pin.mask) };
        let Ok(()) = pin.set_low();
        pin
    }

    fn write(&self, value: u32) {
        // SAFETY: the masked window touches no other bit.
        unsafe { register(MASKED + 4 * self.mask as usize).write(value) };
    }
}

fn register(address: usize) -> &'static WO<u32> {
    // SAFETY: an address within the port's block, and volatile registers may be shared.
    unsafe { &*(address as *const WO<u32>) }
}

impl ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.write(0);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.write(self.mask);
        Ok(())
    }
}
