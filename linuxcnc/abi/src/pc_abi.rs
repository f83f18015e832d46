//! Route A for C: `truepath.h` declares what is here.
//!
//! The caller keeps the memory: both sides and the mailboxes between them lie in a block of [`PC_WORDS`] 64-bit words,
//! which [`truepath_pc_new`] fills. It gives a pointer to each side; that of the servo is for the servo thread, that of
//! the configuration for one other thread. Both are good until the block is given up, with both threads gone.
//!
//! Pointers must be those of C's own objects, aligned and not null; what lies at them is not trusted beyond that.

use core::mem::{MaybeUninit, align_of, size_of};
use core::sync::atomic::AtomicU32;

use crate::pc::{Config, Inputs, JOINTS, Joints, LEDGER_BYTES, Limits, Mailboxes, Outputs, Servo, open};

/// Words of 64 bits of the block.
pub const PC_WORDS: usize = 2048;

/// What lies in a block.
struct Pc {
    mailboxes: Mailboxes,
    period_ns: AtomicU32,
    servo: MaybeUninit<Servo>,
    config: MaybeUninit<Config>,
}

const _: () = assert!(size_of::<Pc>() <= 8 * PC_WORDS && align_of::<Pc>() <= 8);

/// The block.
#[repr(C, align(8))]
#[derive(Debug)]
pub struct Block {
    words: MaybeUninit<[u64; PC_WORDS]>,
}

impl Block {
    /// An empty one.
    pub const fn new() -> Self {
        Self { words: MaybeUninit::uninit() }
    }
}

impl Default for Block {
    fn default() -> Self {
        Self::new()
    }
}

/// The two sides.
#[repr(C)]
pub struct Sides {
    /// For the servo thread.
    pub servo: *mut Servo,
    /// For the configuration thread.
    pub config: *mut Config,
}

/// Fills a block. `axis_of_joint` is as in [`Joints`]; the ledger is the content of its file, nothing for a new one. 0, or
/// why the ledger cannot be used: 1 damaged, 2 another version. On an error nothing is filled.
///
/// # Safety
/// `ledger_bytes` bytes can be read at `ledger`; the block is used for nothing else as long as a side of it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truepath_pc_new(
    block: *mut Block,
    axis_of_joint: &[u8; JOINTS],
    ledger: *const u8,
    ledger_bytes: usize,
    sides: &mut Sides,
) -> u32 {
    // SAFETY: the caller's promise; a ledger of no bytes may have no address.
    let file = if ledger_bytes == 0 { &[] } else { unsafe { core::slice::from_raw_parts(ledger, ledger_bytes) } };
    let pc = block.cast::<Pc>();
    // SAFETY: the block is large enough and aligned, see the assertion above; nobody else uses it. What is written is
    // borrowed for as long as the sides are, which the caller promises to be as long as the block.
    let (mailboxes, period_ns) = unsafe {
        (&raw mut (*pc).mailboxes).write(Mailboxes::default());
        (&raw mut (*pc).period_ns).write(AtomicU32::new(0));
        (&mut (*pc).mailboxes, &(*pc).period_ns)
    };
    match open(mailboxes, period_ns, Joints(*axis_of_joint), file) {
        Ok((servo, config)) => {
            // SAFETY: as above; these places are not borrowed.
            unsafe {
                sides.servo = (&raw mut (*pc).servo).cast();
                sides.servo.write(servo);
                sides.config = (&raw mut (*pc).config).cast();
                sides.config.write(config);
            }
            0
        }
        Err(error) => error as u32,
    }
}

/// See [`Servo::feedback`].
#[unsafe(no_mangle)]
pub extern "C" fn truepath_pc_feedback(servo: &Servo, measured: &[f64; JOINTS], plain: &mut [f64; JOINTS]) {
    servo.feedback(measured, plain);
}

/// See [`Servo::command`].
#[unsafe(no_mangle)]
pub extern "C" fn truepath_pc_command(servo: &mut Servo, inputs: &Inputs, outputs: &mut Outputs) {
    servo.command(inputs, outputs);
}

/// See [`Config::is_ready`].
#[unsafe(no_mangle)]
pub extern "C" fn truepath_pc_ready(config: &Config) -> u32 {
    config.is_ready().into()
}

/// See [`Config::offer`]; without an address there is no image. 0, or why it is not used. Only with 0 the bytes are lent, until
/// [`truepath_pc_returned`] gives them back.
///
/// # Safety
/// `count` bytes can be read at `image`, and nobody changes them while they are lent.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truepath_pc_offer(
    config: &mut Config,
    limits: &Limits,
    image: *const u8,
    count: usize,
) -> u32 {
    // SAFETY: the caller's promise.
    let image = (!image.is_null()).then(|| unsafe { core::slice::from_raw_parts(image, count) });
    config.offer(limits, image).err().map_or(0, |error| error.code())
}

/// See [`Config::returned`]; null when there is none.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_pc_returned(config: &mut Config) -> *const u8 {
    config.returned().map_or(core::ptr::null(), <[u8]>::as_ptr)
}

/// See [`Config::trust`]. 0, or the number of the line that is no key, or 2³² - 1 if the file has none.
///
/// # Safety
/// `count` bytes can be read at `keys`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truepath_pc_trust(config: &mut Config, keys: *const u8, count: usize) -> u32 {
    // SAFETY: the caller's promise.
    let keys = unsafe { core::slice::from_raw_parts(keys, count) };
    config.trust(keys).err().unwrap_or(0)
}

/// See [`Config::count`].
///
/// # Safety
/// `count` bytes can be read at `image`, and nobody changes them meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truepath_pc_count(
    config: &mut Config,
    image: *const u8,
    count: usize,
    file: &mut [u8; LEDGER_BYTES],
) -> usize {
    // SAFETY: the caller's promise.
    let image = unsafe { core::slice::from_raw_parts(image, count) };
    config.count(image, file)
}

/// See [`Config::spend`].
#[unsafe(no_mangle)]
pub extern "C" fn truepath_pc_spend(config: &mut Config, file: &mut [u8; LEDGER_BYTES]) -> usize {
    config.spend(file)
}

/// See [`Config::written`].
#[unsafe(no_mangle)]
pub extern "C" fn truepath_pc_written(config: &mut Config, done: u32) {
    config.written(done != 0);
}
