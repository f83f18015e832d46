//! The flash of the STM32H743: two banks of eight sectors of 128 KiB, words of 32 bytes that are programmed once.
//!
//! | sectors of [`crate::flash`] | bank | sectors of the bank |
//! |---|---|---|
//! | 0…7: image slots, ledger | 2 | 0…7 |
//! | 8, 9: what the loader remembers | 1 | 6, 7 |
//! | 10…14: the program | 1 | 1…5 |
//!
//! Sector 0 of bank 1 is the loader's own. The program lies in bank 1, so an erase of bank 2, up to 4 s (DS12110), stalls
//! neither code nor interrupts. One of bank 1 stalls both until it is over: the program erases only what the loader remembers,
//! in `Off`, and the watchdog waits meanwhile. The
//! drivers of the HAL disable interrupts during an erase and write the error flags of the wrong register; this one
//! waits with interrupts on. A word torn by a brown-out fails its ECC when it is read and the bus then faults
//! (RM0433, 4.7.10): [`BoardFlash`] reads with that fault masked and gives [`FlashError::Ecc`] instead.
//!
//! Registers and sequence: RM0433, 4.3.8 to 4.3.10.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::asm::{dsb, isb};
use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::regs::Sr;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

use super::watchdog;
use crate::flash::{self, FLASH_BYTES, SECTOR_BYTES, WORD_BYTES};

/// Where bank 1 is read; bank 2 lies behind it.
const BASE: usize = 0x0800_0000;
/// Bytes of a bank.
const BANK_BYTES: usize = 1 << 20;
/// Bytes of a sector.
const SECTOR: usize = SECTOR_BYTES;
/// Bytes of a flash word.
const WORD: usize = WORD_BYTES;
/// Index of bank 1 in the register block, which the program runs from.
const PROGRAM_BANK: usize = 0;
/// Keys that open the control register.
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
/// Bit of the configuration and control register by which priorities −1 and −2 ignore bus faults of data (ARMv7-M
/// B3.2.8).
const BFHFNMIGN: u32 = 1 << 8;

/// What the flash reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// An address is not at the start of a word or sector.
    Unaligned,
    /// Beyond the flash, or beyond what the program may write.
    OutOfBounds,
    /// A sector is write protected.
    Protected,
    /// A word was written twice, or the sequence of writes was broken.
    Sequence,
    /// A word is torn: two bits or more of it are wrong.
    Ecc,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Unaligned => NorFlashErrorKind::NotAligned,
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            _ => NorFlashErrorKind::Other,
        }
    }
}

/// The flash. One owner at a time: it is made once from the flash peripheral.
#[derive(Debug)]
pub struct BoardFlash {
    /// The end of what may be written, and of what there is.
    writable: usize,
    capacity: usize,
}

/// Where a byte lies.
#[derive(Clone, Copy)]
struct Place {
    bank: usize,
    sector: usize,
    address: usize,
}

/// The place of an offset in the order of [`crate::flash`].
const fn place(offset: usize) -> Place {
    let (bank, sector) = match offset / SECTOR {
        sector @ 0..8 => (1, sector),
        sector @ 8..10 => (PROGRAM_BANK, sector - 2),
        sector => (PROGRAM_BANK, sector - 9),
    };
    Place { bank, sector, address: BASE + bank * BANK_BYTES + sector * SECTOR + offset % SECTOR }
}

impl BoardFlash {
    /// Takes the flash peripheral, so that nobody else writes: the program, which does not write to itself. One that starts by itself takes
    /// the sectors of the loader as well.
    pub fn new(_flash: embassy_stm32::Peri<'static, embassy_stm32::peripherals::FLASH>) -> Self {
        if cfg!(feature = "updatable") {
            Self { writable: flash::BANK_BYTES, capacity: FLASH_BYTES }
        } else {
            let end = flash::LEDGER_SECTORS.end() as usize;
            Self { writable: end, capacity: end }
        }
    }
    /// The same for the loader, which writes the program.
    pub fn of_loader(_flash: embassy_stm32::Peri<'static, embassy_stm32::peripherals::FLASH>) -> Self {
        Self { writable: FLASH_BYTES, capacity: FLASH_BYTES }
    }

    fn within(offset: u32, length: usize, end: usize) -> Result<usize, FlashError> {
        let offset = offset as usize;
        match offset.checked_add(length) {
            Some(last) if last <= end => Ok(offset),
            _ => Err(FlashError::OutOfBounds),
        }
    }

    /// Runs one operation with the control register of a bank open.
    fn unlocked<R>(&mut self, bank: usize, operation: impl FnOnce() -> R) -> R {
        let registers = FLASH.bank(bank);
        if registers.cr().read().lock() {
            KEYS.iter().for_each(|key| registers.keyr().write_value(*key));
        }
        clear(bank);
        let result = operation();
        registers.cr().modify(|w| w.set_lock(true));
        result
    }
}

/// Clears every error flag of a bank: each has a bit of its own in the clear register.
fn clear(bank: usize) {
    FLASH.bank(bank).ccr().write(|w| {
        w.set_clr_eop(true);
        w.set_clr_wrperr(true);
        w.set_clr_pgserr(true);
        w.set_clr_strberr(true);
        w.set_clr_incerr(true);
        w.set_clr_operr(true);
        w.set_clr_sneccerr(true);
        w.set_clr_dbeccerr(true);
    });
}

/// Waits for the end of an operation, interrupts on.
fn finished(bank: usize) -> Result<(), FlashError> {
    let status: Sr = loop {
        let status = FLASH.bank(bank).sr().read();
        if !status.bsy() && !status.qw() && !status.wbne() {
            break status;
        }
    };
    if status.wrperr() {
        Err(FlashError::Protected)
    } else if status.pgserr() || status.strberr() || status.incerr() || status.operr() {
        Err(FlashError::Sequence)
    } else {
        Ok(())
    }
}

impl ErrorType for BoardFlash {
    type Error = FlashError;
}

impl ReadNorFlash for BoardFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let mut offset = Self::within(offset, bytes.len(), self.capacity)?;
        // A word at a time, so that the fault mask, which holds off every interrupt, is short.
        let mut rest = bytes;
        while !rest.is_empty() {
            let Place { bank, address, .. } = place(offset);
            let most = rest.len().min(WORD - offset % WORD);
            let (piece, behind) = rest.split_at_mut(most);
            clear(bank);
            masked(|| {
                for (byte, at) in piece.iter_mut().zip(address..) {
                    // SAFETY: `within` keeps the address inside the flash, which is always mapped and readable; a failed
                    // ECC faults the bus, which `masked` lets pass.
                    *byte = unsafe { core::ptr::read_volatile(at as *const u8) };
                }
            });
            if FLASH.bank(bank).sr().read().dbeccerr() {
                clear(bank);
                return Err(FlashError::Ecc);
            }
            offset += piece.len();
            rest = behind;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.capacity
    }
}

/// Runs a read with bus faults ignored: FAULTMASK raises the priority to −1, BFHFNMIGN makes faults of data there
/// harmless.
fn masked(read: impl FnOnce()) {
    // SAFETY: the register is only changed here, one bit, and put back; nothing else runs while FAULTMASK is set.
    unsafe {
        let scb = &*cortex_m::peripheral::SCB::PTR;
        core::arch::asm!("cpsid f", options(nomem, nostack, preserves_flags));
        let before = scb.ccr.read();
        scb.ccr.write(before | BFHFNMIGN);
        dsb();
        isb();
        compiler_fence(Ordering::SeqCst);
        read();
        dsb();
        compiler_fence(Ordering::SeqCst);
        scb.ccr.write(before);
        core::arch::asm!("cpsie f", options(nomem, nostack, preserves_flags));
    }
}

impl NorFlash for BoardFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.checked_sub(from).ok_or(FlashError::OutOfBounds)? as usize;
        let start = Self::within(from, length, self.writable)?;
        if start % SECTOR != 0 || length % SECTOR != 0 {
            return Err(FlashError::Unaligned);
        }
        for offset in (start..start + length).step_by(SECTOR) {
            let Place { bank, sector, .. } = place(offset);
            // Nothing runs while the bank that everything runs from is erased.
            if bank == PROGRAM_BANK {
                watchdog::hold();
            }
            let result = self.unlocked(bank, || {
                let control = FLASH.bank(bank).cr();
                control.modify(|w| {
                    w.set_ser(true);
                    w.set_snb(sector as u8);
                    // 32 bits at a time: the supply of the board allows 64, which only an erase would use.
                    w.set_psize(2);
                });
                control.modify(|w| w.set_start(true));
                dsb();
                let result = finished(bank);
                control.modify(|w| w.set_ser(false));
                result
            });
            if bank == PROGRAM_BANK {
                watchdog::release();
            }
            result?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let start = Self::within(offset, bytes.len(), self.writable)?;
        if start % WORD != 0 || bytes.len() % WORD != 0 {
            return Err(FlashError::Unaligned);
        }
        for (word, offset) in bytes.as_chunks::<WORD>().0.iter().zip((start..).step_by(WORD)) {
            let Place { bank, address, .. } = place(offset);
            self.unlocked(bank, || program(bank, address, word))?;
        }
        Ok(())
    }
}

/// Programs one word, the control register open.
fn program(bank: usize, address: usize, word: &[u8; WORD]) -> Result<(), FlashError> {
    FLASH.bank(bank).cr().modify(|w| {
        w.set_pg(true);
        w.set_psize(2);
    });
    isb();
    dsb();
    for (part, at) in word.as_chunks::<4>().0.iter().zip((address..).step_by(4)) {
        // SAFETY: inside the flash by `within`, aligned; PG is set, so the write goes to the buffer of one flash word,
        // which programs itself when the eighth part has come.
        unsafe { core::ptr::write_volatile(at as *mut u32, u32::from_le_bytes(*part)) };
    }
    isb();
    dsb();
    let result = finished(bank);
    FLASH.bank(bank).cr().modify(|w| w.set_pg(false));
    result
}
