//! Counting, situations and their samples, the console.

use core::fmt;

use static_cell::ConstStaticCell;
use truepath_fw::board::virtual_board::clock::Counter;
use truepath_fw::board::virtual_board::uart::Port;

/// Nanoseconds of an instruction under `-icount shift=10`, and of a count of the timer.
const INSTRUCTION_NS: u64 = 1 << 10;
const COUNT_NS: u64 = 40;
/// Samples of a series; more are not needed and not kept.
const SAMPLES: usize = 1_536;

static COUNTER: Counter = Counter::new();

/// Starts the counter.
pub fn start() {
    COUNTER.start();
}

#[inline(never)]
fn call<R>(f: &mut impl FnMut() -> R) -> R {
    f()
}

fn raw<R>(f: &mut impl FnMut() -> R) -> (u32, R) {
    let before = COUNTER.read();
    let result = call(f);
    let after = COUNTER.read();
    let counts = u64::from(after.wrapping_sub(before));
    ((counts * COUNT_NS).div_ceil(INSTRUCTION_NS) as u32, core::hint::black_box(result))
}

/// Instructions of a call and what it gives.
pub fn count<R>(mut f: impl FnMut() -> R) -> (u32, R) {
    let (empty, ()) = raw(&mut || core::hint::black_box(()));
    let (instructions, result) = raw(&mut f);
    (instructions.saturating_sub(empty), result)
}

/// Situations, by what costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Situation {
    /// Nothing is armed.
    Bypass,
    /// Armed, before the gate.
    Armed,
    /// The tick in which the correction begins, and the next.
    Entry,
    /// Nominal feed: 400 mm/min at 1 kHz.
    Feed,
    /// As many segments in a tick as the rewriter may advance.
    Fastest,
    /// Feed hold.
    Hold,
    /// The correction ramps to zero after a fault.
    FaultRamp,
}

impl Situation {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Bypass, Self::Armed, Self::Entry, Self::Feed, Self::Fastest, Self::Hold, Self::FaultRamp];

    /// Its name in the tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bypass => "bypass",
            Self::Armed => "armed",
            Self::Entry => "entry",
            Self::Feed => "feed",
            Self::Fastest => "fastest",
            Self::Hold => "hold",
            Self::FaultRamp => "fault-ramp",
        }
    }
}

/// Samples of one part in one situation.
pub struct Samples {
    values: [u32; SAMPLES],
    used: usize,
}

impl Samples {
    const fn new() -> Self {
        Self { values: [0; SAMPLES], used: 0 }
    }
    /// Adds one while there is room.
    pub fn add(&mut self, value: u32) {
        if let Some(place) = self.values.get_mut(self.used) {
            *place = value;
            self.used += 1;
        }
    }
    /// Least, median and greatest.
    pub fn summary(&mut self) -> Option<(u32, u32, u32)> {
        let values = self.values.get_mut(..self.used)?;
        values.sort_unstable();
        Some((*values.first()?, *values.get(values.len() / 2)?, *values.last()?))
    }
}

/// What is measured in one situation.
pub struct Series {
    /// The rewriter's tick alone.
    pub tick: Samples,
    /// Setpoint frame to setpoint, CRC included.
    pub decode: Samples,
    /// Output to answer frame, CRC included.
    pub encode: Samples,
    /// COBS away from a setpoint packet.
    pub unstuff: Samples,
    /// COBS onto an answer.
    pub stuff: Samples,
    /// Bytes of a packet in, bytes of the answer out, with deframer, endpoint, recorder and trace.
    pub exchange: Samples,
    /// The same for a frame of SPI, without COBS.
    pub spi: Samples,
}

impl Series {
    const fn new() -> Self {
        const EMPTY: Samples = Samples::new();
        Self { tick: EMPTY, decode: EMPTY, encode: EMPTY, unstuff: EMPTY, stuff: EMPTY, exchange: EMPTY, spi: EMPTY }
    }

    /// One for each situation, empty.
    pub fn all() -> &'static mut [Self; Situation::ALL.len()] {
        static ALL: ConstStaticCell<[Series; Situation::ALL.len()]> =
            ConstStaticCell::new([const { Series::new() }; Situation::ALL.len()]);
        // The contours follow each other: the same memory is used again for each.
        static mut PLACE: Option<&'static mut [Series; Situation::ALL.len()]> = None;
        // SAFETY: one thread, no interrupts, and the caller is done with the last one when it asks for the next.
        let place = unsafe { &mut *(&raw mut PLACE) };
        let all = place.get_or_insert_with(|| ALL.take());
        for series in all.iter_mut() {
            series.named_mut().into_iter().for_each(|samples| samples.used = 0);
        }
        all
    }

    fn named_mut(&mut self) -> [&mut Samples; 7] {
        let Self { tick, decode, encode, unstuff, stuff, exchange, spi } = self;
        [tick, decode, encode, unstuff, stuff, exchange, spi]
    }

    /// The parts by name.
    pub fn named(&mut self) -> [(&'static str, &mut Samples); 7] {
        let [tick, decode, encode, unstuff, stuff, exchange, spi] = self.named_mut();
        [
            ("tick", tick),
            ("decode", decode),
            ("encode", encode),
            ("unstuff", unstuff),
            ("stuff", stuff),
            ("exchange", exchange),
            ("spi", spi),
        ]
    }
}

/// Text on UART 0.
pub struct Console(());

impl Console {
    /// Switches the UART on.
    pub fn open() -> Self {
        Port::Setpoint.enable_transmission();
        Port::Log.enable_transmission();
        Self(())
    }
}

impl fmt::Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().for_each(|byte| Port::Setpoint.send_or_drop(byte));
        Ok(())
    }
}
