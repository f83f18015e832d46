//! Batches of both links: records in, records out, in the order in which they happen.
//!
//! The virtual board finds a batch in the memory it shares with the host, the host runs the same batch in process; this
//! is the code for both. The layout of the shared memory and of a record is in `docs/link.md`, "Bench link of the
//! virtual board".
//!
//! While a batch runs, time stands still but for its time records, so the answers do not depend on the machine. After
//! each time record the silence of the setpoint link is looked at. A computation that a record asks for is run before
//! the next record, if a workspace is lent. A request to restart ends the batch; what comes after it is not read.

mod record;

use embedded_storage::nor_flash::NorFlash;
use truepath_core::job::Workspace;

use crate::config_service::{ConfigService, Restart};
use crate::servo::ServoAccess;
pub use record::{Channel, HEAD_BYTES, MOST_BYTES, Record, Records, Writer};

/// What became of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Batch {
    /// Bytes of the input that were read: all of them, unless something else below is set.
    pub consumed: usize,
    /// Bytes of the output.
    pub written: usize,
    /// The device is to be reset.
    pub restart: Option<Restart>,
    /// The output was full: the answers from there on are lost.
    pub overflow: bool,
    /// What follows `consumed` is no record.
    pub malformed: bool,
}

/// Runs a batch.
pub fn run<'a, F: NorFlash>(
    servo: &mut impl ServoAccess<'a>,
    config: &mut ConfigService<'a, F>,
    input: &[u8],
    output: &mut [u8],
    now_us: &mut u64,
    mut workspace: Option<&mut Workspace<'_>>,
) -> Batch {
    let mut records = Records::new(input);
    let mut out = Writer::new(output);
    let mut restart = None;
    for Record { channel, bytes } in records.by_ref() {
        match channel {
            Channel::Setpoint => {
                let now = *now_us;
                let mut send = |answer: &[u8]| out.put(Channel::Setpoint, answer);
                servo.with(|servo| servo.receive(bytes, now, &now, &mut send));
            }
            Channel::Config => {
                restart = config.receive(bytes, *now_us, servo, &mut |answer: &[u8]| out.put(Channel::Config, answer));
                if restart.is_some() {
                    break;
                }
                if let Some(workspace) = workspace.as_deref_mut()
                    && let Some(mut computation) = config.take_computation()
                {
                    computation.run(workspace);
                    config.finish(computation, servo);
                }
            }
            Channel::Time => {
                let by = bytes.first_chunk().map_or(0, |four| u32::from_le_bytes(*four));
                *now_us = now_us.saturating_add(by.into());
                let now = *now_us;
                servo.with(|servo| servo.watch(now));
                config.count_stamps(servo);
                restart = config.trial_is_over(now, servo);
                if restart.is_some() {
                    break;
                }
            }
        }
    }
    let (written, overflow) = out.finish();
    Batch { consumed: records.consumed(), written, restart, overflow, malformed: records.is_malformed() }
}
