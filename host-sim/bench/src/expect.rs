//! What the coprocessor has to answer: the host's own endpoint and rewriter, fed with the same bytes.
//!
//! The bytes are those that leave the faulty cable, so damaged, lost, late and repeated frames have to be treated alike
//! on both sides. Every answer of the board is compared with these, byte for byte.

use truepath_core::image::Image;
use truepath_core::link::{Deframer, DeviceSettings, Endpoint, Framed, LinkError, MAX_SETPOINT_BYTES, MAX_STUFFED};
use truepath_core::rewrite::{Mode, Refusal, Rewriter, SettingsError, SpentList, State};

use super::traffic::Command;

/// The host's model of the device. A copy of it is a complete record, from which a run can go on.
#[derive(Clone)]
pub struct Expectation<'a> {
    endpoint: Endpoint,
    rewriter: Rewriter<'a>,
    deframer: Deframer<{ MAX_SETPOINT_BYTES + 1 }>,
    now_us: u64,
}

impl<'a> Expectation<'a> {
    /// A device after a reset.
    ///
    /// # Errors
    /// The settings do not go with the image.
    pub fn new(settings: DeviceSettings, image: Image<'a>) -> Result<Self, SettingsError> {
        let rewriter = Rewriter::new(settings.rewriter, Some(image))?;
        let endpoint = Endpoint::new(settings, SpentList::EMPTY);
        Ok(Self { endpoint, rewriter, deframer: Deframer::new(), now_us: 0 })
    }

    /// Time passes, µs.
    pub fn time(&mut self, us: u32) {
        self.now_us += u64::from(us);
        self.endpoint.watch(&self.rewriter, self.now_us);
    }

    /// Bytes arrive; the answers go to the end of `out`. Gives their number.
    pub fn bytes(&mut self, mut bytes: &[u8], out: &mut Vec<u8>) -> u32 {
        let mut answers = 0;
        while let Some(framed) = self.deframer.feed(&mut bytes) {
            match framed {
                Framed::Overlong => {
                    self.endpoint.damaged(LinkError::Buffer);
                }
                Framed::Packet(packet) => {
                    self.endpoint.packet(&self.rewriter, packet, self.now_us);
                }
            }
            let mut packet = [0; MAX_STUFFED + 2];
            if let Some(used) = self.endpoint.answer_packet(self.now_us, &mut packet) {
                out.extend_from_slice(&packet[..used]);
                answers += 1;
            }
        }
        answers
    }

    /// A command arrives.
    ///
    /// # Errors
    /// What the device has to refuse it with.
    pub fn command(&mut self, command: &Command) -> Result<(), Refusal> {
        match command {
            Command::Acknowledge => self.endpoint.acknowledge(&self.rewriter, self.now_us),
            Command::Arm(request) => self.endpoint.arm(&self.rewriter, request),
            Command::Disarm => self.endpoint.disarm(&self.rewriter),
            Command::Setpoint(_) => Ok(()),
        }
    }

    /// The mode it is in.
    pub fn mode(&self) -> Mode {
        self.endpoint.mode()
    }
    /// Its state.
    pub const fn state(&self) -> &State {
        self.endpoint.state()
    }
    /// Its endpoint.
    pub const fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }
    /// Its rewriter.
    pub const fn rewriter(&self) -> &Rewriter<'a> {
        &self.rewriter
    }
}
