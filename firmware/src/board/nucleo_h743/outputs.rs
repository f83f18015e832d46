//! Drive enable and fault: PE11 with the green lamp PB0, PE9 with the red lamp PB14.

use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::pac::{GPIOB, GPIOE};
use embassy_stm32::{Peri, peripherals};

use crate::board::outputs::Outputs;

/// Both, each with its lamp.
pub type BoardOutputs = Outputs<Output<'static>, 2>;

/// Both low.
pub fn low(
    drive_enable: (Peri<'static, peripherals::PE11>, Peri<'static, peripherals::PB0>),
    fault: (Peri<'static, peripherals::PE9>, Peri<'static, peripherals::PB14>),
) -> BoardOutputs {
    BoardOutputs::new(
        [Output::new(drive_enable.0, Level::Low, Speed::Low), Output::new(drive_enable.1, Level::Low, Speed::Low)],
        [Output::new(fault.0, Level::Low, Speed::Low), Output::new(fault.1, Level::Low, Speed::Low)],
    )
}

/// Drive enable low, fault high, past every driver.
pub fn drop_drives() {
    GPIOE.bsrr().write(|w| {
        w.set_br(11, true);
        w.set_bs(9, true);
    });
    GPIOB.bsrr().write(|w| {
        w.set_br(0, true);
        w.set_bs(14, true);
    });
}
