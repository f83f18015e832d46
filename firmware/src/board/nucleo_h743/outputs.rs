//! Drive enable and fault: PE11 with the green lamp PB0, PE9 with the red lamp PB14.

use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::pac::{GPIOB, GPIOE};
use embassy_stm32::{Peri, peripherals};

use crate::board::outputs::Outputs;
use crate::stm32h743::{DRIVE_ENABLE, FAULT};

/// Drive enable and fault: on port E the outputs, on port B their lamps.
const PINS: [[usize; 2]; 2] = [
    [DRIVE_ENABLE[0].number as usize, FAULT[0].number as usize],
    [DRIVE_ENABLE[1].number as usize, FAULT[1].number as usize],
];

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
    const {
        assert!(
            DRIVE_ENABLE[0].port == 'E' && FAULT[0].port == 'E' && DRIVE_ENABLE[1].port == 'B' && FAULT[1].port == 'B'
        );
    }
    for (port, [enable, fault]) in [GPIOE, GPIOB].into_iter().zip(PINS) {
        port.bsrr().write(|w| {
            w.set_br(enable, true);
            w.set_bs(fault, true);
        });
    }
}
