//! UARTs of the CMSDK (Arm DDI 0479, "APB UART"): interrupt-driven reception of packets into a ring, transmission as
//! fast as the part takes it.
//!
//! A packet ends with 0x00; a task that reads is woken when one has ended, not for every byte.
//!
//! The part has one byte of buffer each way. The emulator keeps the host's bytes back until that byte was read, so
//! nothing is lost in it; on the FPGA an overrun would be counted.

use core::convert::Infallible;
use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use core::task::Poll;

use cortex_m::peripheral::NVIC;
use embassy_sync::waitqueue::AtomicWaker;
use embedded_io_async::{ErrorType, Read, Write};
use heapless::spsc::{Consumer, Producer, Queue};
use volatile_register::RW;

use super::clock;
use super::line::Line;

/// Bytes that may wait between the interrupt and its task.
pub const RING: usize = 2048;

const TX_FULL: u32 = 1;
const RX_FULL: u32 = 1 << 1;
const RX_OVERRUN: u32 = 1 << 3;
const TX_ENABLE: u32 = 1;
const RX_ENABLE: u32 = 1 << 1;
const TX_INTERRUPT: u32 = 1 << 2;
const RX_INTERRUPT: u32 = 1 << 3;
/// 25 MHz / 16: the fastest the part can do.
const DIVIDER: u32 = 16;

/// Register block.
#[repr(C)]
struct Registers {
    data: RW<u32>,
    state: RW<u32>,
    control: RW<u32>,
    interrupt: RW<u32>,
    divider: RW<u32>,
}

/// Which UART.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// UART 0.
    Setpoint,
    /// UART 1.
    Config,
    /// UART 3.
    Log,
}

impl Port {
    fn registers(self) -> &'static Registers {
        let base: usize = match self {
            Self::Setpoint => 0x4000_4000,
            Self::Config => 0x4000_5000,
            Self::Log => 0x4000_7000,
        };
        // SAFETY: the block lies there on this board, and volatile registers may be shared.
        unsafe { &*(base as *const Registers) }
    }

    /// Switches transmission on, without interrupts, and gives a way to send bytes at once.
    pub fn enable_transmission(self) {
        let registers = self.registers();
        // SAFETY: plain configuration of the part.
        unsafe {
            registers.divider.write(DIVIDER);
            registers.control.write(TX_ENABLE);
        }
    }

    /// Sends a byte now, or drops it when the part stays busy: for the log, which must never hold anything up.
    pub fn send_or_drop(self, byte: u8) {
        const PATIENCE: u32 = 10_000;
        let registers = self.registers();
        for _ in 0..PATIENCE {
            if registers.state.read() & TX_FULL == 0 {
                // SAFETY: there is room.
                unsafe { registers.data.write(byte.into()) };
                return;
            }
        }
    }
}

/// What the interrupts of a UART and its task share.
pub struct Shared {
    port: Port,
    received: AtomicWaker,
    transmitted: AtomicWaker,
    overruns: AtomicU32,
    /// When the first 0x00 came that the task has not taken yet: the lower half of the time, µs.
    ended_us: AtomicU32,
    ended: AtomicBool,
}

impl Shared {
    /// For a port, nothing received yet.
    pub const fn new(port: Port) -> Self {
        Self {
            port,
            received: AtomicWaker::new(),
            transmitted: AtomicWaker::new(),
            overruns: AtomicU32::new(0),
            ended_us: AtomicU32::new(0),
            ended: AtomicBool::new(false),
        }
    }

    /// Bytes lost because the ring was full or the part overran.
    pub fn overruns(&self) -> u32 {
        self.overruns.load(Ordering::Relaxed)
    }

    /// Makes the UART of this port.
    pub fn open(&'static self, queue: &'static mut Queue<u8, RING>, lines: [Line; 2]) -> (Receiver, Sender, Receiving) {
        let (producer, consumer) = queue.split();
        let registers = self.port.registers();
        // SAFETY: plain configuration; the handlers of both lines exist in `interrupts`.
        unsafe {
            registers.divider.write(DIVIDER);
            registers.control.write(TX_ENABLE | RX_ENABLE | RX_INTERRUPT);
            for line in lines {
                NVIC::unmask(line);
            }
        }
        (Receiver { shared: self, ring: consumer }, Sender { shared: self }, Receiving { shared: self, ring: producer })
    }

    /// The transmission interrupt: there is room again.
    pub fn on_transmitted(&self) {
        let registers = self.port.registers();
        // SAFETY: clears the interrupt and switches it off until somebody waits again.
        unsafe {
            registers.interrupt.write(1);
            registers.control.modify(|c| c & !TX_INTERRUPT);
        }
        self.transmitted.wake();
    }
}

/// The side of the reception interrupt.
pub struct Receiving {
    shared: &'static Shared,
    ring: Producer<'static, u8>,
}

impl Receiving {
    /// The reception interrupt.
    pub fn on_received(&mut self) {
        let registers = self.shared.port.registers();
        let mut lost = 0;
        let mut due = false;
        loop {
            let state = registers.state.read();
            if state & RX_OVERRUN != 0 {
                lost += 1;
                // SAFETY: writing the bit clears it.
                unsafe { registers.state.write(RX_OVERRUN) };
            }
            if state & RX_FULL == 0 {
                break;
            }
            // The interrupt is cleared before the byte is read: the next byte may come at once and must raise it again.
            // SAFETY: writing the bit clears it.
            unsafe { registers.interrupt.write(2) };
            let byte = registers.data.read() as u8;
            // The task is woken for a whole packet, or before the ring is full.
            due |= byte == 0 || self.ring.len() > RING / 2;
            if byte == 0 && !self.shared.ended.load(Ordering::Relaxed) {
                self.shared.ended_us.store(clock::now_us() as u32, Ordering::Relaxed);
                self.shared.ended.store(true, Ordering::Release);
            }
            if self.ring.enqueue(byte).is_err() {
                lost += 1;
            }
        }
        if lost > 0 {
            self.shared.overruns.fetch_add(lost, Ordering::Relaxed);
        }
        if due {
            self.shared.received.wake();
        }
    }
}

/// What a task receives from.
pub struct Receiver {
    shared: &'static Shared,
    ring: Consumer<'static, u8>,
}

impl Receiver {
    /// When the first packet was complete that was taken since this was last asked, µs; now, when none was. Ask after
    /// taking: a packet that becomes complete in between counts as older than it is, never as younger.
    pub fn arrived_us(&mut self) -> u64 {
        let now = clock::now_us();
        if !self.shared.ended.swap(false, Ordering::Acquire) {
            return now;
        }
        now.saturating_sub((now as u32).wrapping_sub(self.shared.ended_us.load(Ordering::Relaxed)).into())
    }

    /// Takes what has arrived, without waiting.
    pub fn take(&mut self, into: &mut [u8]) -> usize {
        let mut taken = 0;
        while let Some(room) = into.get_mut(taken) {
            let Some(byte) = self.ring.dequeue() else { break };
            *room = byte;
            taken += 1;
        }
        taken
    }
}

impl ErrorType for Receiver {
    type Error = Infallible;
}

impl Read for Receiver {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        poll_fn(|context| {
            self.shared.received.register(context.waker());
            match self.take(buffer) {
                0 if !buffer.is_empty() => Poll::Pending,
                taken => Poll::Ready(Ok(taken)),
            }
        })
        .await
    }
}

/// What a task sends through.
pub struct Sender {
    shared: &'static Shared,
}

impl Sender {
    /// Waits until the part takes a byte.
    async fn ready(&self) {
        let registers = self.shared.port.registers();
        let full = || registers.state.read() & TX_FULL != 0;
        poll_fn(|context| {
            self.shared.transmitted.register(context.waker());
            if !full() {
                return Poll::Ready(());
            }
            // SAFETY: asks for the interrupt when there is room.
            unsafe { registers.control.modify(|c| c | TX_INTERRUPT) };
            // It may have become free in between, and then no interrupt comes.
            if full() { Poll::Pending } else { Poll::Ready(()) }
        })
        .await;
    }
}

impl ErrorType for Sender {
    type Error = Infallible;
}

impl Write for Sender {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for byte in bytes {
            self.ready().await;
            // SAFETY: there is room.
            unsafe { self.shared.port.registers().data.write((*byte).into()) };
        }
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        self.ready().await;
        Ok(())
    }
}
