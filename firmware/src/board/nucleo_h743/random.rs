//! The random number generator (RM0433, "True random number generator"), clocked by HSI48, its reset value.

use embassy_stm32::pac::{RCC, RNG};

/// Words that are looked for at most; one takes some 40 clocks of 48 MHz.
const PATIENCE: u32 = 100_000;

/// 32 bytes; none if the generator reports a fault, does not answer, or repeats itself.
pub fn draw() -> Option<[u8; 32]> {
    RCC.ahb2enr().modify(|w| w.set_rngen(true));
    RNG.cr().write(|w| w.set_rngen(true));
    // The first word after a start is not used.
    let mut last = word()?;
    let mut bytes = [0; 32];
    for place in bytes.as_chunks_mut::<4>().0 {
        let next = word().filter(|&next| next != last)?;
        *place = next.to_le_bytes();
        last = next;
    }
    RNG.cr().write(|w| w.set_rngen(false));
    Some(bytes)
}

fn word() -> Option<u32> {
    for _ in 0..PATIENCE {
        let status = RNG.sr().read();
        if status.seis() || status.ceis() {
            return None;
        }
        if status.drdy() {
            return Some(RNG.dr().read()).filter(|&word| word != 0);
        }
    }
    None
}
