//! Memory the device is lent (`boards/nucleo-h743.x`): image and uploads in the AXI SRAM, what DMA touches and the
//! workspace of the on-board correction in the SRAM of domain 2, everything else in the DTCM.

use embassy_stm32::pac::RCC;
use static_cell::ConstStaticCell;
use truepath_core::job::Buffers;
use truepath_core::link::MAX_ANSWER_BYTES;

use crate::computation::ProgressMeter;
use crate::config_service::{IMAGE_BYTES, Memory};

/// Frames of the recorder: one second of three axes at 1 kHz, a twentieth of one at 20 kHz.
const RECORDING_BYTES: usize = 1_000 * 48;
/// Buffer for a program.
const PROGRAM_BYTES: usize = 64 << 10;
/// Buffer for a job.
const JOB_BYTES: usize = 512;
/// Buffer for a probe log.
const PROBE_BYTES: usize = 16 << 10;

/// Buffer of the configuration link in each direction.
const CONFIGURATION_BYTES: usize = 2048;

/// Buffers of the on-board correction: blocks of a contour, samples of a path, states, nodes, probe points: 286 KiB,
/// for a contour of 70 mm and a cutter of up to 20 mm. Longer ones are for the host.
pub type CorrectionBuffers = Buffers<64, 1_256, 804, 700, 48>;

/// Bytes taken from the ring at once; on SPI the longest answer passes through it.
const RECEIVED: usize = 96;

/// What the DMA of the setpoint link reads and writes.
pub struct SetpointBuffers {
    /// Bytes received.
    pub received: [u8; RECEIVED],
    /// Bytes on their way out.
    pub sent: [u8; 3 * (MAX_ANSWER_BYTES + 2)],
}

/// A static in a region that [`wake`] has filled with zeros.
macro_rules! lent {
    ($section:literal, $type:ty, $zero:expr) => {{
        #[unsafe(link_section = $section)]
        static PLACE: ConstStaticCell<$type> = ConstStaticCell::new($zero);
        PLACE.take()
    }};
}

unsafe extern "C" {
    static mut _axi_start: u64;
    static mut _axi_end: u64;
    static mut _d2_start: u64;
    static mut _d2_end: u64;
}

/// Switches the SRAM of domain 2 on and fills both regions with zeros, as the start-up code does with the DTCM.
///
/// # Safety
/// Before anything in the two regions is used.
pub unsafe fn wake() {
    RCC.ahb2enr().modify(|w| {
        w.set_sram1en(true);
        w.set_sram2en(true);
        w.set_sram3en(true);
    });
    cortex_m::asm::dsb();
    // SAFETY: the link script puts the symbols at the ends of the regions, aligned to 32 bytes; nobody uses them yet.
    unsafe {
        for (start, end) in [(&raw mut _axi_start, &raw mut _axi_end), (&raw mut _d2_start, &raw mut _d2_end)] {
            start.write_bytes(0, end.offset_from_unsigned(start));
        }
    }
}

/// The buffers of the links. Called once, after [`wake`].
pub fn lend() -> Memory<'static> {
    static METER: ProgressMeter = ProgressMeter::new();
    Memory {
        image: lent!(".axi.image", [u8; IMAGE_BYTES], [0; IMAGE_BYTES]),
        recording: lent!(".axi.recording", [u8; RECORDING_BYTES], [0; RECORDING_BYTES]),
        program: lent!(".axi.program", [u8; PROGRAM_BYTES], [0; PROGRAM_BYTES]),
        job: lent!(".axi.job", [u8; JOB_BYTES], [0; JOB_BYTES]),
        probe: lent!(".axi.probe", [u8; PROBE_BYTES], [0; PROBE_BYTES]),
        meter: &METER,
    }
}

/// Buffers of the setpoint link. Called once, after [`wake`].
pub fn setpoint_buffers() -> &'static mut SetpointBuffers {
    lent!(
        ".d2.setpoint",
        SetpointBuffers,
        SetpointBuffers { received: [0; RECEIVED], sent: [0; 3 * (MAX_ANSWER_BYTES + 2)] }
    )
}

/// Ring of the reception on the UART. Called once, after [`wake`].
pub fn setpoint_ring() -> &'static mut [u8] {
    lent!(".d2.ring", [u8; 1024], [0; 1024])
}

/// Bytes of the configuration link on their way to the controller and from it; the processor moves them. Called once, after
/// [`wake`].
pub fn configuration_buffers() -> [&'static mut [u8]; 2] {
    [
        lent!(".axi.configuration", [u8; CONFIGURATION_BYTES], [0; CONFIGURATION_BYTES]),
        lent!(".axi.configuration", [u8; CONFIGURATION_BYTES], [0; CONFIGURATION_BYTES]),
    ]
}

/// The buffers of the on-board correction. Called once, after [`wake`].
pub fn correction_buffers() -> &'static mut CorrectionBuffers {
    lent!(".d2.correction", CorrectionBuffers, CorrectionBuffers::new())
}
