//! The loader of the NUCLEO-H743ZI2.
#![no_std]
#![no_main]

use defmt_rtt as _;

#[cortex_m_rt::entry]
fn main() -> ! {
    truepath_fw::board::nucleo_h743::load()
}
