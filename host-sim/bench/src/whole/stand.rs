//! Devices that are ready for an input: each in a state that took many requests, taken up again from a copy of its flash.

use truepath_core::job::Workspace;
use truepath_core::link::{Ask, CHUNK_BYTES, DeviceSettings, Item, ResetCause};
use truepath_fw::computation::ProgressMeter;
use truepath_fw::config_service::{IMAGE_BYTES, Memory};
use truepath_fw::flash::{BANK_BYTES, FLASH_BYTES};

use super::broken::Breach;
use super::contract::Contract;
use super::device::{Whole, WholeDevice};
use super::flash::{Contents, KeptFlash};
use super::run::Run;
use super::tape::Tape;
use super::things::{RIGHTS, Things};
use crate::attack::{Checker, Setup};
use crate::example::{EXAMPLE_FEED, Example};
use crate::in_process::workspace;

/// Makes what is told everything: the device itself, or one with a mistake.
pub type Make<'m> = &'m dyn for<'a> Fn(WholeDevice, &'a Setup) -> Box<dyn Whole + 'a>;

/// Where an input begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// As it leaves the factory.
    Factory,
    /// Configured, with both images and one of them in use.
    Ready,
    /// The same with a joint limit near the part.
    Limited,
    /// Closed: with the keys of an engineer and an operator, and signed images.
    Closed,
    /// The same with a loader, which takes updates.
    Updatable,
}

const STARTS: [Start; 5] = [Start::Ready, Start::Closed, Start::Limited, Start::Updatable, Start::Factory];

struct Prepared {
    /// Always there but while an input runs.
    flash: Option<KeptFlash>,
    contents: Contents,
    contract: Contract,
    checker: Checker,
}

/// The devices, and what inputs bring to them.
pub struct Stand {
    things: Things,
    prepared: [Prepared; STARTS.len()],
    /// Always there but while an input runs.
    memory: Option<Memory<'static>>,
    workspace: Workspace<'static>,
}

/// The image and the settings that devices have: 6 mm along X, in Y a correction that rises to its clamp at any feed.
pub fn example() -> Setup {
    let Example { settings, mut nodes } = Example::along_x(61, |k| [if k < 20 { 20 } else { 0 }, (k * 25).min(500)]);
    for node in &mut nodes {
        std::mem::swap(&mut node.chip, &mut node.edge);
    }
    Setup::of(DeviceSettings::at_1_khz(), settings, nodes, EXAMPLE_FEED)
}

impl Default for Stand {
    fn default() -> Self {
        Self::new()
    }
}

impl Stand {
    /// With devices as they should be. Their memory stays allocated until the process ends.
    pub fn new() -> Self {
        Self::mistaken(&|setup| setup)
    }

    /// With devices whose set-up is another one than that by which they are judged.
    ///
    /// # Panics
    /// A device refuses what it must not.
    pub fn mistaken(mistake: &dyn Fn(Setup) -> Setup) -> Self {
        let things = Things::of(example(), &mistake(example()));
        let mut lent = Some(memory());
        let prepared = STARTS.map(|start| {
            let (prepared, back) = prepare(start, mistake, &things, lent.take().expect("one after the other"));
            lent = Some(back);
            prepared
        });
        Self { things, prepared, memory: lent, workspace: workspace() }
    }

    /// Tells a device all that an input says.
    ///
    /// # Errors
    /// What it broke first.
    ///
    /// # Panics
    /// The device did.
    pub fn run(&mut self, input: &[u8], make: Make<'_>) -> Result<(), Box<Breach>> {
        let mut tape = Tape(input);
        let begin = tape.byte();
        let Self { things, prepared, memory, workspace } = self;
        let prepared = &mut prepared[usize::from(begin >> 1) % STARTS.len()];
        let (flash, lent) = prepared.flash.take().zip(memory.take()).expect("one input at a time");
        let names = [things.images[0].crc, things.images[things.images.len() / 2].crc];
        let device = WholeDevice::start(flash, lent, begin & 1 == 0, names);
        let mut run = Run::new(
            make(device, &things.setup),
            prepared.checker.clone(),
            prepared.contract.clone(),
            things,
            workspace,
        );
        let mut result = Ok(());
        while result.is_ok() && !tape.is_over() {
            result = run.step(&mut tape);
        }
        let (flash, lent) = run.whole.into_device().into_parts();
        prepared.flash = Some(flash.restored(&prepared.contents));
        *memory = Some(lent);
        result
    }
}

/// A device in a state.
fn prepare(
    start: Start,
    mistake: &dyn Fn(Setup) -> Setup,
    things: &Things,
    memory: Memory<'static>,
) -> (Prepared, Memory<'static>) {
    let setup = if start == Start::Limited {
        things.setup.with_settings(|settings| settings.rewriter.joint_limits_nm[1] = (-1_000_000, 300_000))
    } else {
        things.setup.clone()
    };
    let (mut checker, mut contract) = (Checker::new(&setup), Contract::new());
    // What the device has, which is what it should have unless a mistake is made.
    let settings = *mistake(setup).settings();
    let capacity = if start == Start::Updatable { FLASH_BYTES } else { BANK_BYTES };
    let mut device = WholeDevice::start(KeptFlash::erased(capacity), memory, true, [0; 2]);
    let mut done = |ask: Ask<'_>| device.ask(ask, 0).unwrap_or_else(|denial| panic!("{start:?}: {ask:?}: {denial}"));
    if start != Start::Factory {
        done(Ask::Configure(settings));
        let closed = matches!(start, Start::Closed | Start::Updatable);
        let half = things.images.len() / 2;
        for (slot, image) in [0, half].into_iter().map(|first| first + usize::from(closed)).enumerate() {
            let image = &things.images[image];
            done(Ask::Begin { item: Item::Image, length: image.bytes.len() as u32, crc: image.crc });
            for (k, bytes) in image.bytes.chunks(CHUNK_BYTES).enumerate() {
                done(Ask::Chunk { offset: (k * CHUNK_BYTES) as u32, bytes });
            }
            done(Ask::Commit);
            if slot == 0 {
                done(Ask::Activate { slot: 0, crc: image.crc });
            }
        }
        let active = things.images[usize::from(closed)].crc;
        let keys = if closed { 2 } else { 0 };
        for (key, rights) in RIGHTS.into_iter().enumerate().take(keys) {
            let key = things.public(key);
            done(if rights.firmware {
                Ask::ProvisionFirmware { key, rights }
            } else {
                Ask::ProvisionAs { key, rights }
            });
        }
        contract.begins(things, settings, active, keys);
        checker.image_exchanged(Some(false));
    } else {
        checker.image_exchanged(None);
    }
    device.reset_for(ResetCause::PowerOn, 0);
    let (flash, memory) = device.into_parts();
    let (flash, contents) = flash.contents();
    (Prepared { flash: Some(flash), contents, contract, checker }, memory)
}

fn memory() -> Memory<'static> {
    fn lasting<T: Clone>(value: T, count: usize) -> &'static mut [T] {
        vec![value; count].leak()
    }
    Memory {
        image: lasting(0, IMAGE_BYTES),
        recording: lasting(0, 9_600),
        program: lasting(0, 4_096),
        job: lasting(0, 512),
        probe: lasting(0, 4_096),
        meter: Box::leak(Box::new(ProgressMeter::new())),
    }
}
