//! What happens to a state between ticks: the controller or the operator acknowledges, arms, disarms, outside the servo
//! cycle; the link ends a correction when too many setpoints are missing, or none come any more.

use serde::{Deserialize, Serialize};

use super::mode::Mode;
use super::refusal::{Identity, Refusal};
use super::spent::Spent;
use super::state::State;
use super::{Frame, Phase, Reason, Rewriter};
use crate::image::Binding;

/// What the controller says it is about to do: the operator's confirmation for one pass of one part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArmRequest {
    /// Program, feature, pass, tool, tool offset, setup; every number must be that of the image.
    pub binding: Binding,
    /// Serial number of the part; serials are to count up. The same pass of the same part cannot be armed twice.
    pub part_serial: u32,
    /// Program coordinates to machine axes.
    pub frame: Frame,
}

impl Rewriter<'_> {
    /// The controller acknowledges that the drives are disabled: `Off` → `Bypass`.
    ///
    /// # Errors
    /// Not in `Off`, or the last setpoint said that the drives are enabled.
    pub fn acknowledge_drives_disabled(&self, state: &mut State) -> Result<(), Refusal> {
        if state.mode != Mode::Off {
            return Err(Refusal::State(state.mode));
        }
        if state.drives_seen_enabled {
            return Err(Refusal::DrivesEnabled);
        }
        // The axes stand where they stand: whatever correction there was went with the drive enable.
        *state = State { mode: Mode::Bypass, reason: state.reason, ..State::remembering(state.spent) };
        Ok(())
    }

    /// Arms the image for one pass of one part: `Bypass` → `Armed`. The pass counts as spent from here on, whether
    /// or not the gate is ever reached.
    ///
    /// # Errors
    /// Not in `Bypass`; no image; a number differs; the frame is damaged or no rigid motion; the pass of this part
    /// was armed before, or a part of the same or a higher serial was, more than 16 armings ago. The state then stays
    /// as it is.
    pub fn arm(&self, state: &mut State, request: &ArmRequest) -> Result<(), Refusal> {
        if state.mode != Mode::Bypass {
            return Err(state.refusal());
        }
        let Some(plan) = &self.plan else {
            return Err(Refusal::NoImage);
        };
        let stored = plan.image.settings().binding;
        let asked = request.binding;
        for (what, image, request) in [
            (Identity::Program, stored.program_crc, asked.program_crc),
            (Identity::Feature, stored.feature, asked.feature),
            (Identity::Pass, stored.pass, asked.pass),
            (Identity::Tool, stored.tool, asked.tool),
            (Identity::ToolOffset, stored.tool_offset, asked.tool_offset),
            (Identity::Setup, stored.setup, asked.setup),
        ] {
            if image != request {
                return Err(Refusal::Identity { what, image, request });
            }
        }
        let mapping = request.frame.mapping(plan.image.header().origin, plan.level)?;
        let pass = Spent {
            part_serial: request.part_serial,
            program_crc: asked.program_crc,
            feature: asked.feature,
            pass: asked.pass,
        };
        if state.is_spent(&pass) {
            return Err(Refusal::PartRepeated { part_serial: request.part_serial });
        }
        let mut next = State {
            mode: Mode::Armed,
            reason: Reason::None,
            phase: Phase::Entry,
            image_crc: plan.image.crc(),
            frame_crc: request.frame.crc,
            mapping: Some(mapping),
            spent: state.spent,
            ..State::default()
        };
        next.spend(pass);
        *state = next;
        Ok(())
    }

    /// Ends an arming: `Armed` → `Bypass` at once; from `Active` and `Hold` the correction ramps out first.
    ///
    /// # Errors
    /// Nothing is armed.
    pub fn disarm(&self, state: &mut State) -> Result<(), Refusal> {
        if !matches!(state.mode, Mode::Armed | Mode::Active | Mode::Hold) || state.is_ending() {
            return Err(state.refusal());
        }
        state.end(Reason::Disarmed);
        Ok(())
    }

    /// `Armed` → `Bypass`, `Active` and `Hold` → `Fault`, from which the correction ramps out with the next ticks.
    /// In other states, and on the way out, nothing happens.
    #[inline]
    pub fn break_off(&self, state: &mut State, reason: Reason) {
        if matches!(state.mode, Mode::Armed | Mode::Active | Mode::Hold) && !state.is_ending() {
            state.end(reason);
        }
    }

    /// Any state → `Off`, whatever correction there was: nothing goes out until the controller acknowledges that the
    /// drives are disabled. A ramp needs setpoints, and there are none; the drives stop by themselves. The passes of
    /// parts that were armed stay spent.
    #[inline]
    pub fn power_off(&self, state: &mut State, reason: Reason) {
        // What the controller last said about its drives is old: it has to say it again.
        *state = State { mode: Mode::Off, reason, drives_seen_enabled: true, ..State::remembering(state.spent) };
    }
}
