//! The on-board correction over the configuration link: the image equals that of the host, byte for byte.

use crate::{job_support, wire_support};

use job_support::{Part, Room, corner, made, pocket, short};
use truepath_core::checksum::crc32;
use truepath_core::job::COMPACT_BYTES;
use truepath_core::link::{
    ActiveImage, Ask, ComputeFailure, Computed, Denial, Item, Progress, Reply, ResetCause, Slot, Stage,
};
use truepath_core::rewrite::Mode;
use truepath_fw::flash::{Cut, Moment};
use wire_support::part::straight;
use wire_support::*;

fn send(rig: &mut Rig, part: &Part) {
    let mut compact = [0; COMPACT_BYTES];
    let job = part.job.to_compact(&mut compact).unwrap();
    for (item, bytes) in [(Item::Program, part.program), (Item::Job, job), (Item::Probe, part.probe)] {
        let offset = rig.begin_item(item, bytes, crc32(bytes)).unwrap();
        rig.chunks(offset, bytes, 1_024).unwrap();
        rig.commit().unwrap();
    }
}

fn progress(rig: &mut Rig) -> Progress {
    match rig.ask(Ask::Progress).unwrap() {
        Reply::Progress(progress) => progress,
        other => panic!("{other:?}"),
    }
}

/// Runs what was asked for; says whether there was anything.
fn work(rig: &mut Rig) -> bool {
    let mut room: Box<Room> = Box::default();
    rig.device().compute(&mut room.workspace())
}

fn computed(rig: &mut Rig, part: &Part) -> Result<Computed, ComputeFailure> {
    send(rig, part);
    rig.done(Ask::Compute).unwrap();
    assert!(work(rig));
    let progress = progress(rig);
    assert_eq!(progress.stage, Stage::Ended);
    progress.result.unwrap()
}

#[test]
fn the_image_made_on_the_device_is_that_of_the_host() {
    let mut rig = Rig::with_image(&image_of(straight()));
    for part in [short(), corner(), pocket()] {
        let (_, expected) = made(&part).unwrap();
        let done = computed(&mut rig, &part).unwrap();
        assert_eq!(done, Computed { slot: 1, crc: name(&expected), length: expected.len() as u32 });
        let mut found = vec![0; expected.len()];
        let address = (3 * truepath_fw::flash::SECTOR_BYTES + 64) as u32;
        embedded_storage::nor_flash::ReadNorFlash::read(rig.flash(), address, &mut found).unwrap();
        assert!(found == expected, "byte for byte");
        assert!(matches!(rig.slots()[1], Slot::Image { crc, .. } if crc == done.crc));
    }
    // The image in use is untouched, and the new one can be used.
    assert_eq!(rig.status().active.unwrap().slot, 0);
    let (_, last) = made(&pocket()).unwrap();
    rig.activate(1, name(&last)).unwrap();
    rig.reset(ResetCause::PowerOn);
    assert_eq!(rig.status().active, Some(ActiveImage { slot: 1, crc: name(&last) }));
}

#[test]
fn while_it_computes_setpoints_pass_and_nothing_else_touches_the_buffers() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.enable();
    send(&mut rig, &short());
    rig.done(Ask::Compute).unwrap();
    assert_eq!(progress(&mut rig), Progress { stage: Stage::Job, permille: 0, result: None });
    let image = image_of(straight());
    assert_eq!(rig.arm(1), Err(Denial::Busy));
    assert_eq!(rig.begin(&image), Err(Denial::Busy));
    assert_eq!(rig.activate(0, name(&image)), Err(Denial::Busy));
    assert_eq!(rig.done(Ask::Deactivate), Err(Denial::Busy));
    assert_eq!(rig.done(Ask::Compute), Err(Denial::Busy));
    let out = rig.stay().unwrap();
    assert!(out.forward && out.mode == Mode::Bypass && out.axes == rig.setpoint.axes);
    assert!(work(&mut rig));
    assert!(!work(&mut rig), "once");
    rig.arm(1).unwrap();
}

#[test]
fn without_all_three_items_there_is_nothing_to_compute() {
    let mut rig = Rig::new();
    assert_eq!(rig.done(Ask::Compute), Err(Denial::Missing(Item::Program)));
    send(&mut rig, &short());
    let (program, crc) = (b"other", crc32(b"other"));
    rig.begin_item(Item::Program, program, crc).unwrap();
    assert_eq!(rig.done(Ask::Compute), Err(Denial::Missing(Item::Program)));
    assert!(!work(&mut rig));
    assert_eq!(progress(&mut rig), Progress::default());
}

#[test]
fn a_failure_names_step_code_line_and_column() {
    let mut rig = Rig::new();
    let failed = computed(&mut rig, &Part { program: b"G21 G90\nG0 X0 Y0\nG1 X#\nM30\n", ..short() }).unwrap_err();
    assert_eq!((failed.stage, failed.line), (Stage::Program, 3));
    assert!((1_000..2_000).contains(&failed.code) && failed.column > 0, "{failed:?}");
    let failed = computed(&mut rig, &Part { probe: b"1 2\n", ..short() }).unwrap_err();
    assert_eq!((failed.stage, failed.line, failed.code / 1_000), (Stage::Probe, 1, 2));
    let job = b"no job";
    rig.begin_item(Item::Job, job, crc32(job)).unwrap();
    rig.chunks(0, job, 10).unwrap();
    rig.commit().unwrap();
    rig.done(Ask::Compute).unwrap();
    assert!(work(&mut rig));
    let failed = progress(&mut rig).result.unwrap().unwrap_err();
    assert_eq!(failed, ComputeFailure { stage: Stage::Job, code: 24, line: 0, column: 0 });
    // And the way is free for the next one.
    computed(&mut rig, &short()).unwrap();
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn power_that_fails_while_the_image_is_written_leaves_no_third_image() {
    let old = image_of(straight());
    let mut rig = Rig::with_image(&old);
    let (_, new) = made(&short()).unwrap();
    let first = rig.operations();
    computed(&mut rig, &short()).unwrap();
    let operations = rig.operations() - first;
    let mut missing = 0;
    for after_operations in (0..operations).step_by(3) {
        for moment in [Moment::Before, Moment::Within(1), Moment::After] {
            rig.wipe();
            rig.upload(&old).unwrap();
            rig.activate(0, name(&old)).unwrap();
            send(&mut rig, &short());
            rig.done(Ask::Compute).unwrap();
            rig.cut(Cut { after_operations, moment });
            work(&mut rig);
            rig.reset(ResetCause::BrownOut);
            assert_eq!(rig.status().active, Some(ActiveImage { slot: 0, crc: name(&old) }));
            match rig.slots()[1] {
                Slot::Image { crc, .. } => assert_eq!(crc, name(&new)),
                _ => missing += 1,
            }
        }
    }
    assert!(missing > 0);
}

#[test]
fn a_reset_while_it_computes_gives_everything_back() {
    let mut rig = Rig::with_image(&image_of(straight()));
    send(&mut rig, &short());
    rig.done(Ask::Compute).unwrap();
    rig.reset(ResetCause::Watchdog);
    assert_eq!(progress(&mut rig), Progress::default());
    rig.enable();
    rig.arm(1).unwrap();
    rig.done(Ask::Disarm).unwrap();
    computed(&mut rig, &short()).unwrap();
}
