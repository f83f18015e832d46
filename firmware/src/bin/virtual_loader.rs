//! The loader of the virtual board.
#![no_std]
#![no_main]

#[cortex_m_rt::entry]
fn main() -> ! {
    truepath_fw::board::virtual_board::load()
}
