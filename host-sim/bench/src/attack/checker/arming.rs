//! Rules of arming: when it may be granted, once for each pass of each part, and what ends it from outside.

use std::collections::HashSet;

use truepath_core::image::Binding;
use truepath_core::link::DeviceSettings;
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Mode, Setpoint};

use super::link::Link;
use super::verdict::{STOPS, Verdict, hold};
use crate::attack::rule::Rule;
use crate::attack::setup::Setup;

/// Armings of a session.
#[derive(Clone, Debug)]
pub(super) struct Arming {
    bindings: [Binding; 2],
    image: Option<bool>,
    spent: HashSet<[u32; 4]>,
    count: u64,
    /// What is armed.
    frame: Option<Frame>,
    /// What was asked for last.
    asked: Option<Frame>,
    image_changed: bool,
    disarmed: bool,
}

impl Arming {
    pub fn new(setup: &Setup) -> Self {
        Self {
            bindings: setup.images().map(|image| image.settings().binding),
            image: Some(false),
            spent: HashSet::new(),
            count: 0,
            frame: None,
            asked: None,
            image_changed: false,
            disarmed: false,
        }
    }

    pub fn image_exchanged(&mut self, to: Option<bool>) {
        // The same image once more changes nothing.
        self.image_changed |= self.image != to;
        self.image = to;
    }
    pub const fn asked(&mut self, request: &ArmRequest) {
        self.asked = Some(request.frame);
    }
    pub const fn disarmed(&mut self) {
        self.disarmed = true;
    }
    pub const fn end(&mut self) {
        self.frame = None;
    }
    pub const fn is_armed(&self) -> bool {
        self.frame.is_some()
    }
    pub const fn count(&self) -> u64 {
        self.count
    }
    /// Machine axes of the program's X and Y by what is armed.
    pub fn plane(&self) -> Option<[usize; 2]> {
        self.frame.as_ref().map(plane)
    }
    /// The same by what was asked for last, granted or not.
    pub fn asked_plane(&self) -> Option<[usize; 2]> {
        self.asked.as_ref().map(plane)
    }
    /// An image that was there again in the same tick has ended nothing.
    pub const fn ticked(&mut self) {
        if self.frame.is_none() {
            self.image_changed = false;
        }
    }

    /// An arming was granted.
    pub fn arm(&mut self, request: &ArmRequest, before: Mode, settings: &DeviceSettings, link: &Link) -> Verdict {
        let must = |holds: bool, what: &str| hold(holds, Rule::Arming, || format!("armed {what}"));
        must(before == Mode::Bypass, "outside of Bypass")?;
        let image = self.image.map(|other| self.bindings[usize::from(other)]);
        must(image == Some(request.binding), "for another image than the one in use")?;
        let frame = &request.frame;
        must(checksum(frame) == frame.crc, "with a damaged frame")?;
        let (c, s) = (i128::from(frame.cosine), i128::from(frame.sine));
        // Sine and cosine of one angle to 2⁻²⁷ of the length, 2⁻²⁶ of its square.
        must((c * c + s * s - (1 << 60)).unsigned_abs() <= 1 << 34, "with a frame that is no rigid motion")?;
        let [x, y, z] = frame.axes.map(|map| map.axis);
        let apart = x != y && y != z && x != z;
        must(apart && [x, y, z].iter().all(|&axis| axis < settings.axes), "on axes that are not sent")?;
        hold(link.may_know_pace(), Rule::Pace, || {
            format!("armed at a pace that is too fast or unknown: {}", link.pace())
        })?;
        let Binding { program_crc, feature, pass, .. } = request.binding;
        let fresh = self.spent.insert([request.part_serial, program_crc, feature, pass]);
        hold(fresh, Rule::Spent, || format!("part {} is armed a second time", request.part_serial))?;
        self.count += 1;
        self.frame = Some(*frame);
        (self.image_changed, self.disarmed) = (false, false);
        Ok(())
    }

    /// What is armed (`following`: on) goes on behind a setpoint.
    pub fn may_go_on(&self, setpoint: &Setpoint, following: bool) -> Verdict {
        let flags = setpoint.flags;
        let stopped =
            |what: &str| format!("{} goes on behind {what}", if following { "a correction" } else { "an arming" });
        hold(!flags.has(STOPS), Rule::Stopped, || stopped(&format!("the flags {:#x}", flags.0)))?;
        hold(!following || flags.has(Flags::DRIVES_ENABLED), Rule::Stopped, || stopped("disabled drives"))?;
        let same = self.frame.is_none_or(|frame| frame.crc == setpoint.frame_crc);
        hold(same, Rule::Stopped, || stopped("another frame"))?;
        hold(!self.disarmed, Rule::Stopped, || stopped("a disarming"))?;
        hold(!self.image_changed, Rule::ImageChanged, || stopped("another image"))
    }
}

fn plane(frame: &Frame) -> [usize; 2] {
    [frame.axes[0].axis, frame.axes[1].axis].map(usize::from)
}

/// CRC-32 (ISO-HDLC) of a frame, bit by bit, over the bytes that `docs/link.md` lists.
fn checksum(frame: &Frame) -> u32 {
    let mut bytes: Vec<u8> = frame.offset_nm.iter().flat_map(|nm| nm.to_le_bytes()).collect();
    bytes.extend(frame.cosine.to_le_bytes());
    bytes.extend(frame.sine.to_le_bytes());
    bytes.extend(frame.axes.iter().flat_map(|map| [map.axis, u8::from(map.reversed)]));
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(crc & 1));
        }
    }
    !crc
}
