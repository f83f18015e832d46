//! The kernels whose cost is watched, for the benchmarks and for the counter of instructions.
//!
//! A tick of the rewriter and the steps of the cut are measured in the middle of paths of 10, 1,000 and 100,000 equal
//! segments: their cost must not depend on the length. The search for the finishing contours is measured whole, on programs
//! of several shapes and lengths, reading included. Identification and design are measured whole, on the papers'
//! corner and on a pocket; so is the way from program and measurement to the image, as a device goes it by itself.

#[allow(dead_code)]
#[path = "../../model/tests/all/corner/mod.rs"]
mod corner;
#[allow(dead_code)]
#[path = "../../tests/all/job_support/mod.rs"]
mod job_support;
mod part;
#[allow(dead_code)]
#[path = "../../wire/tests/all/rewrite_support/mod.rs"]
mod rewrite_support;
mod search;
mod servo;
mod whole;

use corner::{machine, path, real, setup};
use std::hint::black_box;
use truepath_core::cut::{Compliance, Envelope, ForceTable, Loop, Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::units::{Offset, Real};

/// Something that can be called again and again at the same cost.
pub type Work = Box<dyn FnMut()>;

/// A named kernel.
pub struct Kernel {
    /// Its name: kernel, then the part.
    pub name: &'static str,
    /// Calls after which its cost is known well.
    #[allow(dead_code, reason = "criterion finds its own number")]
    pub calls: u32,
    /// Whether every change is held against its count: the others take long, and say the same of longer parts.
    #[allow(dead_code, reason = "criterion measures all")]
    pub watched: bool,
    /// Makes everything it needs and returns it.
    pub prepare: fn() -> Work,
}

/// All kernels.
pub const KERNELS: &[Kernel] = &[
    Kernel { name: "tick/10", calls: 6000, watched: false, prepare: || servo::tick(10) },
    Kernel { name: "tick/1000", calls: 6000, watched: true, prepare: || servo::tick(1_000) },
    Kernel { name: "tick/100000", calls: 6000, watched: false, prepare: || servo::tick(100_000) },
    Kernel { name: "engagement/10", calls: 2000, watched: false, prepare: || engagement(10) },
    Kernel { name: "engagement/1000", calls: 2000, watched: true, prepare: || engagement(1_000) },
    Kernel { name: "engagement/100000", calls: 2000, watched: false, prepare: || engagement(100_000) },
    Kernel { name: "elastic/10", calls: 1000, watched: false, prepare: || elastic(10) },
    Kernel { name: "elastic/1000", calls: 1000, watched: true, prepare: || elastic(1_000) },
    Kernel { name: "elastic/100000", calls: 1000, watched: false, prepare: || elastic(100_000) },
    Kernel { name: "wall/10", calls: 1000, watched: false, prepare: || wall(10) },
    Kernel { name: "wall/1000", calls: 1000, watched: true, prepare: || wall(1_000) },
    Kernel { name: "wall/100000", calls: 1000, watched: false, prepare: || wall(100_000) },
    Kernel {
        name: "search/pocketing-10000",
        calls: 1,
        watched: true,
        prepare: || search::work(search::pocketing(10_000)),
    },
    Kernel {
        name: "search/pocketing-100000",
        calls: 1,
        watched: false,
        prepare: || search::work(search::pocketing(100_000)),
    },
    Kernel { name: "search/depths-10000", calls: 1, watched: true, prepare: || search::work(search::depths(10_000)) },
    Kernel {
        name: "search/depths-100000",
        calls: 1,
        watched: false,
        prepare: || search::work(search::depths(100_000)),
    },
    Kernel { name: "search/contours-2000", calls: 1, watched: true, prepare: || search::work(search::contours(2_000)) },
    Kernel {
        name: "search/contours-20000",
        calls: 1,
        watched: false,
        prepare: || search::work(search::contours(20_000)),
    },
    Kernel {
        name: "search/adaptive-10000",
        calls: 1,
        watched: true,
        prepare: || search::work(search::adaptive(10_000)),
    },
    Kernel {
        name: "search/adaptive-100000",
        calls: 1,
        watched: false,
        prepare: || search::work(search::adaptive(100_000)),
    },
    Kernel { name: "identify/corner", calls: 1, watched: false, prepare: || whole::identify(whole::corner()) },
    Kernel { name: "identify/pocket", calls: 1, watched: true, prepare: || whole::identify(whole::pocket()) },
    Kernel { name: "design/corner", calls: 1, watched: false, prepare: || whole::design(whole::corner()) },
    Kernel { name: "design/pocket", calls: 1, watched: true, prepare: || whole::design(whole::pocket()) },
    Kernel { name: "on-board/corner", calls: 1, watched: false, prepare: || whole::image(job_support::corner()) },
    Kernel { name: "on-board/pocket", calls: 1, watched: true, prepare: || whole::image(job_support::pocket()) },
];

/// Samples of one period of the wave, and their distance.
const WINDOW: usize = 100;
const STEP_UM: i64 = 200;

/// A leaked machine on a wave and the samples of the period in its middle.
fn on_a_wave(segments: usize) -> (&'static Loop<'static>, std::ops::Range<usize>) {
    let path: &'static Path = Box::leak(Box::new(path(&part::wave(segments), &setup(WallLaw::Helical), STEP_UM)));
    let table = Box::leak(Box::new(ForceTable::new(Real::ZERO)));
    let machine = machine(path, table, Compliance::from_stiffness(real(1150.0), real(1150.0)));
    let whole_periods = (segments / 10 / 2) as i64;
    let start = path.index_at(Offset::from_um(20_000 * whole_periods));
    (Box::leak(Box::new(machine)), start..start + WINDOW)
}

/// Calls a step on the samples of a range in turn.
fn in_turn(range: std::ops::Range<usize>, mut step: impl FnMut(usize) + 'static) -> Work {
    let mut at = range.clone();
    Box::new(move || {
        let index = at.next().unwrap_or_else(|| {
            at = range.start + 1..range.end;
            range.start
        });
        step(black_box(index));
    })
}

/// The engagement angle at one sample.
fn engagement(segments: usize) -> Work {
    let (machine, range) = on_a_wave(segments);
    let displaced = Vector { x: Offset::from_um(30), y: Offset::from_um(-80) };
    in_turn(range, move |index| {
        let frame = machine.path.frame(index, displaced).unwrap();
        black_box(machine.path.engagement(index, displaced, &frame));
    })
}

/// The elastic loop at one sample, started from the sample before.
fn elastic(segments: usize) -> Work {
    let (machine, range) = on_a_wave(segments);
    let feed = machine.path.setup().feed_per_tooth(machine.path.samples()[range.start].feed);
    let chip_scale = machine.coefficients.chip_scale(feed);
    let mut guess = Vector::ZERO;
    in_turn(range, move |index| {
        let (state, _) = machine.settle(index, Vector::ZERO, guess, chip_scale);
        guess = black_box(state).displacement;
    })
}

/// The wall error beside one sample at one height.
fn wall(segments: usize) -> Work {
    let (machine, range) = on_a_wave(segments);
    let margin = WINDOW / 2;
    let from = range.start.saturating_sub(margin);
    let mut states = vec![State::REST; WINDOW + 2 * margin];
    machine.run(from, &mut states, |_| Vector::ZERO);
    let mut displacements = vec![Vector::ZERO; states.len()];
    Envelope::displace(machine, &states, Real::HALF, &mut displacements);
    let envelope = Envelope::new(machine.path, from, displacements.leak());
    in_turn(range, move |index| {
        black_box(envelope.error(index, index));
    })
}
