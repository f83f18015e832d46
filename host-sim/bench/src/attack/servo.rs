//! What is attacked: a servo as a controller meets it, and the host's own.

use truepath_core::image::Image;
use truepath_core::link::{
    AnswerFrame, Deframer, DeviceSettings, Endpoint, Framed, LinkError, MAX_SETPOINT_BYTES, MAX_STUFFED, unstuff,
};
use truepath_core::rewrite::{Mode, Output, Refusal, Rewriter, SpentList};

use super::setup::Setup;
use crate::traffic::Command;

/// A servo under attack.
pub trait Servo {
    /// Bytes with at most one delimiter, at their end, arrive at `now_us`; the servo would be ready to answer `delay_us` later.
    /// Gives the answer that goes out.
    fn receive(&mut self, bytes: &[u8], now_us: u64, delay_us: u32) -> Option<Output>;
    /// The timer.
    fn watch(&mut self, now_us: u64);
    /// A command.
    ///
    /// # Errors
    /// Why it had no effect.
    fn command(&mut self, command: &Command, now_us: u64) -> Result<(), Refusal>;
    /// A reset: what was armed stays spent, everything else begins anew.
    fn reset(&mut self);
    /// The image of the set-up, the other one, or none is in use from now on.
    fn exchange_image(&mut self, to: Option<bool>);
    /// Mode, as `Status` tells it.
    fn mode(&self) -> Mode;
    /// Whether the drive enable is passed on.
    fn drive_enable(&self) -> bool;
}

/// The host's own endpoint and rewriter.
#[derive(Clone)]
pub struct HostServo<'a> {
    settings: DeviceSettings,
    images: [Image<'a>; 2],
    endpoint: Endpoint,
    rewriter: Rewriter<'a>,
    deframer: Deframer<{ MAX_SETPOINT_BYTES + 1 }>,
}

impl<'a> HostServo<'a> {
    /// For a set-up, after a reset.
    pub fn new(setup: &'a Setup) -> Self {
        Self::of(*setup.settings(), setup.images())
    }
    /// For other images and settings than those of a set-up.
    ///
    /// # Panics
    /// They do not go together.
    pub fn of(settings: DeviceSettings, images: [Image<'a>; 2]) -> Self {
        let rewriter = Rewriter::new(settings.rewriter, Some(images[0])).expect("settings that go with the image");
        let endpoint = Endpoint::new(settings, SpentList::EMPTY);
        Self { settings, images, endpoint, rewriter, deframer: Deframer::new() }
    }
    /// The image in use.
    pub fn image(&self) -> Option<&Image<'a>> {
        self.rewriter.image()
    }
    /// Its endpoint.
    pub const fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }
}

impl Servo for HostServo<'_> {
    fn receive(&mut self, mut bytes: &[u8], now_us: u64, delay_us: u32) -> Option<Output> {
        let framed = self.deframer.feed(&mut bytes)?;
        let verdict = match framed {
            Framed::Overlong => self.endpoint.damaged(LinkError::Buffer),
            Framed::Packet(packet) => self.endpoint.packet(&self.rewriter, packet, now_us),
        };
        if !verdict.is_accepted() {
            return None;
        }
        let mut packet = [0; MAX_STUFFED + 2];
        let used = self.endpoint.answer_packet(now_us + u64::from(delay_us), &mut packet)?;
        let raw = unstuff(packet.get_mut(..used.checked_sub(1)?)?)?;
        AnswerFrame::decode(raw, self.settings.axes).ok().map(|frame| frame.output)
    }
    fn watch(&mut self, now_us: u64) {
        self.endpoint.watch(&self.rewriter, now_us);
    }
    fn command(&mut self, command: &Command, now_us: u64) -> Result<(), Refusal> {
        match command {
            Command::Acknowledge => self.endpoint.acknowledge(&self.rewriter, now_us),
            Command::Arm(request) => self.endpoint.arm(&self.rewriter, request),
            Command::Disarm => self.endpoint.disarm(&self.rewriter),
            Command::Setpoint(_) => Ok(()),
        }
    }
    fn reset(&mut self) {
        self.endpoint = Endpoint::new(self.settings, *self.endpoint.state().spent());
        self.deframer = Deframer::new();
    }
    fn exchange_image(&mut self, to: Option<bool>) {
        let image = to.map(|other| self.images[usize::from(other)]);
        self.rewriter = Rewriter::new(self.settings.rewriter, image).expect("limits of the same set-up");
    }
    fn mode(&self) -> Mode {
        self.endpoint.mode()
    }
    fn drive_enable(&self) -> bool {
        self.endpoint.drive_enable()
    }
}

/// Makes what is attacked.
pub type Make<'m> = &'m dyn for<'a> Fn(&'a Setup) -> Box<dyn Servo + 'a>;
