//! Requests that only read.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{DEVICE_NODES, FORMAT, SEMANTICS};
use truepath_core::link::{
    CHUNK_BYTES, Denial, DeviceStatus, Hello, LINK_VERSION, Progress, Reply, STAMPS_AT_ONCE, Slot, TimingMeter,
};

use super::handler::Handler;
use crate::servo::{STAMPS, ServoAccess};
use crate::slots::SLOT_IMAGE_BYTES;

impl<'a, F: NorFlash> Handler<'a, F> {
    pub fn hello<'s>(&self) -> Hello<'s> {
        let [program_bytes, job_bytes, probe_bytes] = self.capacities;
        Hello {
            link_version: LINK_VERSION,
            semantics: SEMANTICS,
            image_format: FORMAT,
            board: self.board.name,
            firmware: env!("CARGO_PKG_VERSION"),
            axes: self.settings().axes,
            most_nodes: DEVICE_NODES as u32,
            slot_bytes: SLOT_IMAGE_BYTES as u32,
            program_bytes,
            job_bytes,
            probe_bytes,
            boots: self.ledger.now().boots,
            last_reset: self.board.last_reset,
        }
    }

    pub fn status(&self, now_us: u64, servo: &mut impl ServoAccess<'a>) -> DeviceStatus {
        let active = self.active;
        let uptime_us = now_us.saturating_sub(self.started_us);
        servo.with(|servo| DeviceStatus {
            mode: servo.mode(),
            reason: servo.reason(),
            drive_enable: servo.drive_enable(),
            active,
            recording_frozen: servo.recording_frozen(),
            counters: servo.counters(),
            uptime_us,
        })
    }

    pub fn list(&self) -> [Slot; 2] {
        let mut slots = self.slots;
        if let Some(active) = self.active
            && let Some(Slot::Image { active, .. }) = slots.get_mut(usize::from(active.slot))
        {
            *active = true;
        }
        slots
    }

    pub fn recording<'s>(
        &self,
        from: u32,
        servo: &mut impl ServoAccess<'a>,
        scratch: &'s mut [u8; CHUNK_BYTES],
    ) -> Result<Reply<'s>, Denial> {
        let (total, used) = servo.with(|servo| servo.recording(from as usize, scratch));
        let total = total as u32;
        if used == 0 {
            return Err(Denial::NoRecording { total });
        }
        Ok(Reply::Recording { total, from, bytes: scratch.get(..used).unwrap_or(&[]) })
    }

    /// Counts the stamps that the setpoint path has left. Frames go on arriving meanwhile; no more are taken than the ring
    /// holds.
    pub fn count_stamps(&mut self, servo: &mut impl ServoAccess<'a>) {
        for _ in 0..=STAMPS / STAMPS_AT_ONCE {
            let (missed, stamps) = servo.with(|servo| servo.drain_stamps());
            self.timing.take(missed, &stamps);
            if !stamps.is_full() {
                break;
            }
        }
    }
    /// Counts anew, with the settings in force.
    pub fn restart_timing(&mut self, servo: &mut impl ServoAccess<'a>) {
        self.count_stamps(servo);
        self.timing = TimingMeter::new(&self.settings(), self.board.counter_hz);
    }

    pub fn progress(&self) -> Progress {
        if !self.computing {
            return self.progress;
        }
        let (stage, permille) = self.meter.read();
        Progress { stage, permille, result: None }
    }
}
