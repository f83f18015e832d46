//! What runs while nothing else does: batches of the bench link and the on-board correction.

use truepath_core::job::Workspace;

use super::config_task::carry_out;
use super::shared_memory::SharedMemory;
use super::{clock, memory};
use crate::bench;
use crate::board::ServoCell;
use crate::board::config_link::{SharedDesk, work};
use crate::flash::Nor;

/// Never returns. The processor sleeps until the next interrupt, the tick at the latest, when nothing is to be done.
pub fn run(desk: &'static SharedDesk<Nor<'static>>, servo: &'static ServoCell) -> ! {
    let mut shared = SharedMemory::ready();
    let mut workspace = memory::workshop().workspace();
    loop {
        let worked = batch(&mut shared, desk, servo, &mut workspace) || work(desk, servo, &mut workspace);
        if !worked {
            cortex_m::asm::wfi();
        }
    }
}

/// Runs a batch, if there is one.
fn batch(
    shared: &mut SharedMemory,
    desk: &'static SharedDesk<Nor<'static>>,
    servo: &'static ServoCell,
    workspace: &mut Workspace<'_>,
) -> bool {
    let Some(request) = shared.request() else { return false };
    // The configuration task never sleeps with the desk in its hand.
    let Ok(mut desk) = desk.try_lock() else { return false };
    let mut now_us = clock::begin_batch();
    let (input, output) = shared.records();
    let batch = bench::run(&servo, &mut desk, input, output, &mut now_us, Some(workspace));
    clock::end_batch(now_us);
    if batch.overflow || batch.malformed {
        defmt::warn!("batch {=u32}: overflow {=bool}, malformed {=bool}", request, batch.overflow, batch.malformed);
    }
    shared.done(request, batch.written);
    if let Some(restart) = batch.restart {
        carry_out(restart);
    }
    true
}
