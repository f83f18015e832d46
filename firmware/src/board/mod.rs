//! Boards: pins, UARTs, clock, flash and watchdog around the same servo and configuration service.
//!
//! A board needs a link (embedded-io-async, in byte streams), a store (embedded-storage's NOR flash) and a
//! [`Clock`](crate::clock::Clock); servo and configuration service know nothing else of it.

pub mod config_link;
pub mod outputs;
pub mod shared_servo;

/// Starts the program whose vectors lie at an address; without one there nothing is ever done.
///
/// # Safety
/// Nothing that runs is needed any more.
pub unsafe fn start_program(vectors: u32) -> ! {
    let vectors = vectors as *const u32;
    // SAFETY: a board's program lies there, or blank flash.
    let (stack, entry) = unsafe { (vectors.read_volatile(), vectors.add(1).read_volatile()) };
    // Blank, or no code of a Cortex-M.
    if stack == u32::MAX || entry == u32::MAX || entry & 1 == 0 {
        loop {
            cortex_m::asm::wfi();
        }
    }
    // SAFETY: the caller is done, and behind it is nobody.
    unsafe {
        (*cortex_m::peripheral::SCB::PTR).vtor.write(vectors as u32);
        cortex_m::asm::dsb();
        cortex_m::asm::bootload(vectors)
    }
}

#[cfg(feature = "board-nucleo-h743")]
pub mod nucleo_h743;
#[cfg(feature = "board-virtual")]
pub mod virtual_board;
