//! What is told everything: a whole device as those at both of its links meet it, and the device of the firmware.

use std::cell::RefCell;

use embedded_storage::nor_flash::ReadNorFlash;
use truepath_core::image::DeviceClass;
use truepath_core::job::Workspace;
use truepath_core::link::{
    AnswerFrame, Ask, Denial, PACKET_BYTES, Request, ResetCause, Response, decode, encode, unstuff,
};
use truepath_core::rewrite::{Mode, Output, Reason, Refusal};
use truepath_fw::config_service::{Board, Memory, Restart};
use truepath_fw::device::Device;
use truepath_fw::flash::{Cut, FLASH_BYTES};
use truepath_fw::loader::prepare;

use super::flash::KeptFlash;
use crate::attack::Servo;
use crate::traffic::Command;

/// A whole device.
pub trait Whole: Servo {
    /// Bytes with at most one delimiter, at their end, arrive on the configuration link. `answer` gets what goes out, without
    /// its delimiter; gives how many answers that were.
    fn told(&mut self, bytes: &[u8], now_us: u64, answer: &mut Vec<u8>) -> usize;
    /// The restart that was asked for since the last time.
    fn take_restart(&mut self) -> Option<Restart>;
    /// A reset at a time, for a cause. The power is back then, if it had failed.
    fn reset_for(&mut self, cause: ResetCause, now_us: u64);
    /// Axes of a setpoint frame.
    fn axes(&mut self) -> u8;
    /// Lets the power of the flash fail.
    fn cut(&mut self, cut: Cut);
    /// Runs a computation that was asked for.
    fn compute(&mut self, workspace: &mut Workspace<'_>);
    /// The device, for the next input.
    fn into_device(self: Box<Self>) -> WholeDevice;
}

/// The device of the firmware.
pub struct WholeDevice {
    /// Always there but during a reset.
    device: Option<Device<'static, KeptFlash>>,
    restart: Option<Restart>,
    now_us: u64,
    /// Names of the images that are put in use by [`Servo::exchange_image`].
    images: [u32; 2],
}

/// Its number.
pub(super) const ID: [u8; 12] = [7; 12];
/// Its board.
pub(super) const BOARD: &str = "whole";

impl WholeDevice {
    /// Starts one on a flash; `present`: its button is held.
    pub(super) fn start(flash: KeptFlash, memory: Memory<'static>, present: bool, images: [u32; 2]) -> Self {
        let board = Board {
            name: BOARD,
            last_reset: ResetCause::PowerOn,
            class: DeviceClass::Bench,
            present,
            id: ID,
            secret: None,
            counter_hz: 1_000_000,
        };
        let device = Some(Device::start(flash, memory, board, 0));
        Self { device, restart: None, now_us: 0, images }
    }
    /// Flash and memory.
    pub(super) fn into_parts(self) -> (KeptFlash, Memory<'static>) {
        let (flash, memory, _) = self.device.expect("it is not in a reset").into_parts();
        (flash, memory)
    }
    fn device(&self) -> &Device<'static, KeptFlash> {
        self.device.as_ref().expect("it is not in a reset")
    }
    fn device_mut(&mut self) -> &mut Device<'static, KeptFlash> {
        self.device.as_mut().expect("it is not in a reset")
    }
    /// Setpoints that were accepted.
    pub fn accepted(&mut self) -> u64 {
        self.device_mut().servo().counters().accepted.into()
    }
    /// Why the last correction ended.
    pub fn reason(&self) -> Reason {
        self.device().state().reason()
    }

    /// A request from nobody, with an id that no one else uses.
    pub(super) fn ask(&mut self, ask: Ask<'_>, now_us: u64) -> Result<(), Denial> {
        let (mut packet, mut answer) = ([0; PACKET_BYTES], vec![]);
        let used = encode(&Request { id: u16::MAX, ask }, &mut packet).expect("a request has room");
        self.told(&packet[..used], now_us, &mut answer);
        let read: Response<'_> = decode(&mut answer).expect("an answer that can be read");
        read.answer.map(|_| ())
    }
}

impl Servo for WholeDevice {
    fn receive(&mut self, bytes: &[u8], now_us: u64, delay_us: u32) -> Option<Output> {
        let mut answer = None;
        let axes = self.axes();
        self.device_mut().setpoint_bytes_answered(bytes, now_us, &(now_us + u64::from(delay_us)), |bytes| {
            let mut packet = [0; PACKET_BYTES];
            let used = bytes.len().saturating_sub(1);
            packet[..used].copy_from_slice(&bytes[..used]);
            let raw = unstuff(&mut packet[..used]).expect("an answer without its delimiter");
            answer = Some(AnswerFrame::decode(raw, axes).expect("an answer that can be read").output);
        });
        answer
    }
    fn watch(&mut self, now_us: u64) {
        self.now_us = now_us;
        let restart = self.device_mut().watch(now_us);
        self.restart = self.restart.or(restart);
    }
    fn command(&mut self, command: &Command, now_us: u64) -> Result<(), Refusal> {
        let ask = match *command {
            Command::Acknowledge => Ask::AcknowledgeDrivesDisabled,
            Command::Arm(request) => Ask::Arm(request),
            Command::Disarm => Ask::Disarm,
            Command::Setpoint(_) => return Ok(()),
        };
        self.ask(ask, now_us).map_err(|denial| match denial {
            Denial::Refused(refusal) => refusal,
            _ => Refusal::State(self.mode()),
        })
    }
    fn reset(&mut self) {
        self.reset_for(ResetCause::Software, self.now_us);
    }
    /// Only where nothing is armed: elsewhere the device refuses it.
    fn exchange_image(&mut self, to: Option<bool>) {
        let ask = match to {
            Some(other) => Ask::Activate { slot: other.into(), crc: self.images[usize::from(other)] },
            None => Ask::Deactivate,
        };
        let _ = self.ask(ask, self.now_us);
    }
    fn mode(&self) -> Mode {
        self.device().state().mode()
    }
    fn drive_enable(&self) -> bool {
        self.device().drive_enable()
    }
}

impl Whole for WholeDevice {
    fn told(&mut self, bytes: &[u8], now_us: u64, answer: &mut Vec<u8>) -> usize {
        let mut count = 0;
        let restart = self.device_mut().config_bytes(bytes, now_us, |bytes| {
            count += 1;
            answer.clear();
            answer.extend_from_slice(bytes.strip_suffix(&[0]).unwrap_or(bytes));
        });
        self.restart = self.restart.or(restart);
        count
    }
    fn take_restart(&mut self) -> Option<Restart> {
        self.restart.take()
    }
    fn reset_for(&mut self, cause: ResetCause, now_us: u64) {
        let Some(device) = self.device.take() else { return };
        let (mut flash, memory, board) = device.into_parts();
        flash.power_up();
        if flash.capacity() == FLASH_BYTES {
            let shared = RefCell::new(flash);
            prepare(&shared).expect("a loader on a flash with power");
            flash = shared.into_inner();
        }
        self.restart = None;
        self.device = Some(Device::start(flash, memory, Board { last_reset: cause, ..board }, now_us));
    }
    fn axes(&mut self) -> u8 {
        self.device_mut().servo().axes()
    }
    fn cut(&mut self, cut: Cut) {
        self.device_mut().flash().cut(cut);
    }
    fn compute(&mut self, workspace: &mut Workspace<'_>) {
        self.device_mut().compute(workspace);
    }
    fn into_device(self: Box<Self>) -> WholeDevice {
        *self
    }
}
