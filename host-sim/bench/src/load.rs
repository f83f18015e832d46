//! Setpoints while the device is busy with something else: each must be answered, with the same bytes as ever.

use truepath_core::image::Image;
use truepath_core::link::{DeviceSettings, MAX_SETPOINT_BYTES, SetpointFrame};
use truepath_core::rewrite::{Setpoint, SettingsError};

use super::board::{Board, Event};
use super::campaign::tick_us;
use super::error::BenchError;
use super::expect::Expectation;

/// Setpoints with the drives disabled to a device in `Off`, compared answer by answer.
pub struct Load<'a> {
    expectation: Expectation<'a>,
    axes: u8,
    tick_us: u32,
    sequence: u32,
    round_trips_ns: Vec<u64>,
}

impl<'a> Load<'a> {
    /// For a device that has just been reset or has never moved; the image does not matter in `Off`.
    ///
    /// # Errors
    /// The settings do not go with the image.
    pub fn new(settings: DeviceSettings, image: Image<'a>) -> Result<Self, SettingsError> {
        let tick_us = tick_us(&settings);
        let expectation = Expectation::new(settings, image)?;
        Ok(Self { expectation, axes: settings.axes, tick_us, sequence: 0, round_trips_ns: vec![] })
    }

    /// Sends so many setpoints.
    ///
    /// # Errors
    /// An answer is missing or differs.
    pub fn beat(&mut self, board: &mut dyn Board, setpoints: u32) -> Result<(), BenchError> {
        let (mut events, mut expected) = (vec![], vec![]);
        for _ in 0..setpoints {
            self.sequence = self.sequence.wrapping_add(1);
            let axes = [1, -1, 2, -2, 3, -3].map(|k| k * i64::from(self.sequence) * 1_000);
            let setpoint = Setpoint { axes, sequence: self.sequence, ..Setpoint::default() };
            let mut packet = [0; MAX_SETPOINT_BYTES + 2];
            let frame = SetpointFrame { axes: self.axes, setpoint };
            let used = frame.encode_packet(&mut packet).unwrap_or(0);
            self.expectation.time(self.tick_us);
            let answers = self.expectation.bytes(&packet[..used], &mut expected);
            events.push(Event::Time(self.tick_us));
            events.push(Event::Setpoint { bytes: packet[..used].to_vec(), answers });
        }
        let exchange = board.exchange(&events)?;
        if exchange.answers != expected {
            let text = format!("an answer before setpoint {} is missing or another one", self.sequence);
            return Err(BenchError::Differs(text));
        }
        self.round_trips_ns.extend(exchange.round_trips_ns);
        Ok(())
    }

    /// Round trips so far, ns.
    pub fn round_trips_ns(self) -> Vec<u64> {
        self.round_trips_ns
    }
}
