//! Bank 2 of the flash of the STM32H743: eight sectors of 128 KiB, words of 32 bytes that are programmed once.
//!
//! The program lies in bank 1, so an erase of bank 2, up to 4 s (DS12110), stalls neither code nor interrupts. The
//! drivers of the HAL disable interrupts during an erase and write the error flags of the wrong register; this one
//! waits with interrupts on. A word torn by a brown-out fails its ECC when it is read and the bus then faults
//! (RM0433, 4.7.10): [`Bank2`] reads with that fault masked and gives [`FlashError::Ecc`] instead.
//!
//! Registers and sequence: RM0433, 4.3.8 to 4.3.10.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::asm::{dsb, isb};
use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::regs::Sr;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

/// Where bank 2 is read.
const BASE: usize = 0x0810_0000;
/// Bytes of the bank.
const CAPACITY: usize = 1 << 20;
/// Bytes of a sector.
const SECTOR: usize = 128 << 10;
/// Bytes of a flash word.
const WORD: usize = 32;
/// Index of bank 2 in the register block.
const BANK: usize = 1;
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
    /// Beyond the bank.
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

/// Bank 2. One owner at a time: it is made once from the flash peripheral.
#[derive(Debug)]
pub struct Bank2(());

impl Bank2 {
    /// Takes the flash peripheral, so that nobody else writes.
    pub fn new(_flash: embassy_stm32::Peri<'static, embassy_stm32::peripherals::FLASH>) -> Self {
        Self(())
    }

    fn within(offset: u32, length: usize) -> Result<usize, FlashError> {
        let offset = offset as usize;
        match offset.checked_add(length) {
            Some(end) if end <= CAPACITY => Ok(offset),
            _ => Err(FlashError::OutOfBounds),
        }
    }

    /// Runs one operation with the control register open.
    fn unlocked<R>(&mut self, operation: impl FnOnce() -> R) -> R {
        let bank = FLASH.bank(BANK);
        if bank.cr().read().lock() {
            KEYS.iter().for_each(|key| bank.keyr().write_value(*key));
        }
        clear();
        let result = operation();
        bank.cr().modify(|w| w.set_lock(true));
        result
    }
}

/// Clears every error flag: each has a bit of its own in the clear register.
fn clear() {
    FLASH.bank(BANK).ccr().write(|w| {
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
fn finished() -> Result<(), FlashError> {
    let status: Sr = loop {
        let status = FLASH.bank(BANK).sr().read();
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

impl ErrorType for Bank2 {
    type Error = FlashError;
}

impl ReadNorFlash for Bank2 {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let start = Self::within(offset, bytes.len())?;
        clear();
        // A word at a time, so that the fault mask, which holds off every interrupt, is short.
        let mut at = BASE.wrapping_add(start);
        for piece in bytes.chunks_mut(WORD) {
            masked(|| {
                for byte in piece.iter_mut() {
                    // SAFETY: `within` keeps the address inside bank 2, which is always mapped and readable; a failed
                    // ECC faults the bus, which `masked` lets pass.
                    *byte = unsafe { core::ptr::read_volatile(at as *const u8) };
                    at = at.wrapping_add(1);
                }
            });
            if FLASH.bank(BANK).sr().read().dbeccerr() {
                clear();
                return Err(FlashError::Ecc);
            }
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        CAPACITY
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

impl NorFlash for Bank2 {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.checked_sub(from).ok_or(FlashError::OutOfBounds)? as usize;
        let start = Self::within(from, length)?;
        if start % SECTOR != 0 || length % SECTOR != 0 {
            return Err(FlashError::Unaligned);
        }
        self.unlocked(|| {
            let first = start / SECTOR;
            for sector in first..first + length / SECTOR {
                let control = FLASH.bank(BANK).cr();
                control.modify(|w| {
                    w.set_ser(true);
                    w.set_snb(sector as u8);
                    // 32 bits at a time: the supply of the board allows 64, which only an erase would use.
                    w.set_psize(2);
                });
                control.modify(|w| w.set_start(true));
                dsb();
                let result = finished();
                control.modify(|w| w.set_ser(false));
                result?;
            }
            Ok(())
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let start = Self::within(offset, bytes.len())?;
        if start % WORD != 0 || bytes.len() % WORD != 0 {
            return Err(FlashError::Unaligned);
        }
        self.unlocked(|| {
            let mut at = BASE.wrapping_add(start);
            for word in bytes.as_chunks::<WORD>().0 {
                FLASH.bank(BANK).cr().modify(|w| {
                    w.set_pg(true);
                    w.set_psize(2);
                });
                isb();
                dsb();
                for part in word.as_chunks::<4>().0 {
                    // SAFETY: inside bank 2 by `within`, aligned; PG is set, so the write goes to the buffer of one
                    // flash word, which programs itself when the eighth part has come.
                    unsafe { core::ptr::write_volatile(at as *mut u32, u32::from_le_bytes(*part)) };
                    at = at.wrapping_add(4);
                }
                isb();
                dsb();
                let result = finished();
                FLASH.bank(BANK).cr().modify(|w| w.set_pg(false));
                result?;
            }
            Ok(())
        })
    }
}
