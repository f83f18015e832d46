//! `truepath hil --attack`: random images, settings, controllers and cables against the host's own servo.

use std::fmt::Write;
use std::time::{Duration, Instant};

use serde::Serialize;
use truepath_bench::attack::{Alarm, SETTLED, Tally, attack, host};
use truepath_core::rewrite::Reason;

use crate::streams::Bar;

/// How long it goes on.
#[derive(Clone, Copy, Debug)]
pub enum Length {
    /// At least so many setpoints.
    Setpoints(u64),
    /// So long.
    Time(Duration),
}

/// What came of an attack.
#[derive(Clone, Debug, Serialize)]
pub struct AttackReport {
    /// Seed.
    pub seed: u64,
    /// Images and settings tried.
    pub sessions: u64,
    /// Setpoints sent.
    pub setpoints: u64,
    /// Answers judged.
    pub answers: u64,
    /// Commands judged.
    pub commands: u64,
    /// Parts armed.
    pub armed: u64,
    /// Answers in `Off`, `Bypass`, `Armed`, `Active`, `Hold`, `Fault`.
    pub modes: [u64; 6],
    /// Corrections that ended, by their reason.
    pub ended: Vec<(String, u64)>,
    /// Largest share of the limits of size, speed and acceleration that was used, 1/1000.
    pub used_permille: [u64; 3],
    /// What stricter rules than the contract would have raised, by their words.
    pub settled: Vec<(&'static str, u64)>,
    /// Setpoints per second of real time.
    pub setpoints_per_s: f64,
    /// The rule that was broken, where and how.
    pub alarm: Option<String>,
}

/// Steps of the bar of an attack.
pub const STEPS: u64 = 1_000;

/// Attacks until the length is reached or a rule is broken.
pub fn run(seed: u64, length: Length, bar: &mut Bar) -> AttackReport {
    let start = Instant::now();
    let share = |tally: &Tally| match length {
        Length::Setpoints(count) => tally.setpoints as f64 / count.max(1) as f64,
        Length::Time(time) => start.elapsed().as_secs_f64() / time.as_secs_f64().max(1e-3),
    };
    let mut more = |tally: &Tally| {
        let share = share(tally);
        bar.reached((share.min(1.0) * STEPS as f64) as u64);
        share < 1.0
    };
    let (tally, alarm) = attack(seed, &host, &mut more);
    report(seed, &tally, alarm.as_deref(), start.elapsed())
}

fn report(seed: u64, tally: &Tally, alarm: Option<&Alarm>, elapsed: Duration) -> AttackReport {
    let ended = Reason::ALL.into_iter().map(|reason| (reason.to_string(), tally.ended_by(reason)));
    AttackReport {
        seed,
        sessions: tally.sessions,
        setpoints: tally.setpoints,
        answers: tally.answers,
        commands: tally.commands,
        armed: tally.armed,
        modes: tally.modes,
        ended: ended.filter(|&(_, count)| count > 0).collect(),
        used_permille: tally.used,
        settled: SETTLED.into_iter().zip(tally.settled).collect(),
        setpoints_per_s: tally.setpoints as f64 / elapsed.as_secs_f64().max(1e-9),
        alarm: alarm.map(ToString::to_string),
    }
}

impl AttackReport {
    /// What a person reads.
    pub fn words(&self) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        let Self { sessions, setpoints, answers, commands, armed, .. } = self;
        writeln!(out, "{sessions} sessions with images and settings of their own, seed {}", self.seed)?;
        writeln!(out, "{setpoints} setpoints, {answers} answers and {commands} commands judged, {armed} parts armed")?;
        let [off, bypass, armed, active, hold, fault] = self.modes;
        writeln!(
            out,
            "answers: Off {off}, Bypass {bypass}, Armed {armed}, Active {active}, Hold {hold}, Fault {fault}"
        )?;
        let [size, speed, acceleration] = self.used_permille.map(|share| share as f64 / 1e3);
        writeln!(out, "largest share of the limits: size {size:.3}, speed {speed:.3}, acceleration {acceleration:.3}")?;
        for (reason, count) in &self.ended {
            writeln!(out, "{count:>10} x {reason}")?;
        }
        writeln!(out, "stricter rules would have raised (docs/safety.md says why they are not the contract):")?;
        for (words, count) in &self.settled {
            writeln!(out, "{count:>10} x \"{words}\"")?;
        }
        writeln!(out, "{:.0} setpoints/s", self.setpoints_per_s)?;
        match &self.alarm {
            None => writeln!(out, "no rule was broken"),
            Some(alarm) => writeln!(out, "BROKEN {alarm}"),
        }
    }
}
