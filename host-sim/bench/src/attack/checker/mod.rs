//! What must hold, judged from what a controller sees.
//!
//! The checker is told what was sent, what came out of the cable, what was answered and when, what became of commands, and
//! mode and drive enable. Where it cannot know something (a frame whose answer was withheld may have been followed or not), it
//! asks for what holds in every case.
//!
//! Rules that are stricter than the contract were tried first. Five of them raise alarms on a servo that keeps the contract;
//! which situations those are is counted ([`SETTLED`]), and `docs/safety.md` says why each is as it should be.

mod arming;
mod limits;
mod link;
mod place;
mod verdict;

use truepath_core::link::DeviceSettings;
use truepath_core::rewrite::{AXES, Flags, Limits, Mode, Output, Reason, Setpoint};

use arming::Arming;
use limits::Bounds;
use link::Link;
use place::Course;
use verdict::{STOPS, Verdict, alarm, hold, is_on};

use super::rule::{Rule, SETTLED};
use super::setup::Setup;
use super::tally::Tally;
use crate::traffic::Command;

/// Rules of what goes out and of place; none where the limits of the image do not go with the rate.
fn bounds(setup: &Setup) -> Option<(Bounds, Course)> {
    let [image, _] = setup.images();
    let settings = setup.settings();
    // The machine's caps count where they are lower.
    let mut limits = image.settings().limits;
    limits.slew_nm_per_s = limits.slew_nm_per_s.min(settings.rewriter.correction_slew_nm_per_s);
    limits.acceleration_nm_per_s2 =
        limits.acceleration_nm_per_s2.min(settings.rewriter.correction_acceleration_nm_per_s2);
    let ramp_ticks = Limits::new(&limits, settings.rewriter.tick_hz).ok()?.ramp_ticks();
    Some((Bounds::new(&limits, settings, ramp_ticks), Course::new(&image, settings, ramp_ticks)))
}

/// The checker of one session.
#[derive(Clone, Debug)]
pub struct Checker {
    settings: DeviceSettings,
    link: Link,
    arming: Arming,
    bounds: Bounds,
    course: Course,
    /// Mode as it was last seen.
    mode: Mode,
    /// Whether `Off` was left by an acknowledgement since the last time the drives were dropped.
    acknowledged: bool,
    answers: u64,
    commands: u64,
    modes: [u64; 6],
    ended: Vec<Reason>,
    settled: [u64; SETTLED.len()],
}

impl Checker {
    /// For a servo that was just reset.
    ///
    /// # Panics
    /// Never: the limits of a set-up fit its settings.
    pub fn new(setup: &Setup) -> Self {
        let (bounds, course) = bounds(setup).expect("limits that go with the rate");
        let settings = *setup.settings();
        Self {
            link: Link::new(&settings),
            arming: Arming::new(setup),
            bounds,
            course,
            settings,
            mode: Mode::Off,
            acknowledged: false,
            answers: 0,
            commands: 0,
            modes: [0; 6],
            ended: vec![],
            settled: [0; SETTLED.len()],
        }
    }

    /// In `Off` the settings became those of a set-up that is otherwise the same. Says whether they go with its images; nothing has
    /// changed if not.
    pub fn configured(&mut self, setup: &Setup) -> bool {
        let Some((bounds, course)) = bounds(setup) else { return false };
        (self.bounds, self.course, self.settings) = (bounds, course, *setup.settings());
        self.link.configured(&self.settings);
        true
    }

    /// A frame goes into the cable.
    pub fn sent(&mut self, packet: &[u8], setpoint: &Setpoint) {
        self.link.sent(packet, setpoint);
    }
    /// Bytes with at most one delimiter, at their end, arrive; `touched`: the cable has changed what they came with.
    pub fn delivered(&mut self, bytes: &[u8], now_us: u64, touched: bool) {
        self.link.delivered(bytes, now_us, touched);
    }
    /// The servo was reset.
    pub fn reset(&mut self) {
        self.link.reset();
        self.dropped();
    }
    /// Another image is in use.
    pub fn image_exchanged(&mut self, to: Option<bool>) {
        self.arming.image_exchanged(to);
    }
    /// Nothing is on any more, and nothing armed.
    fn dropped(&mut self) {
        self.acknowledged = false;
        self.arming.end();
        self.bounds.at_zero();
    }

    /// The timer was called.
    ///
    /// # Errors
    /// The rule that was broken.
    pub fn watched(&mut self, now_us: u64, mode: Mode) -> Verdict {
        self.link.watched(now_us);
        hold(!self.link.is_silent(now_us) || mode == Mode::Off, Rule::Silence, || {
            format!("in {mode} {} us after the last frame that arrived whole", self.link.quiet_us(now_us))
        })
    }

    /// Mode and drive enable as they are seen now.
    ///
    /// # Errors
    /// The rule that was broken.
    pub fn looked(&mut self, mode: Mode, drive_enable: bool) -> Verdict {
        hold(drive_enable == (mode != Mode::Off), Rule::Enable, || format!("in {mode} the enable is {drive_enable}"))?;
        if mode == Mode::Off {
            if self.mode != Mode::Off {
                self.dropped();
            }
        } else {
            hold(self.acknowledged, Rule::Acknowledge, || format!("{mode} without an acknowledgement"))?;
        }
        self.mode = mode;
        Ok(())
    }

    /// What became of a command; `before` is the mode it met.
    ///
    /// # Errors
    /// The rule that was broken.
    pub fn commanded(&mut self, command: &Command, done: bool, before: Mode, now_us: u64) -> Verdict {
        self.commands += 1;
        match command {
            Command::Acknowledge if done => {
                hold(before == Mode::Off && self.link.said_disabled(now_us), Rule::Acknowledge, || {
                    format!("acknowledged in {before} without a setpoint that says that the drives are disabled")
                })?;
                self.acknowledged = true;
                self.bounds.at_zero();
            }
            Command::Arm(request) => {
                self.arming.asked(request);
                if done {
                    self.arming.arm(request, before, &self.settings, &self.link)?;
                    self.course.arm(request.frame);
                }
            }
            Command::Disarm if done => self.arming.disarmed(),
            Command::Acknowledge | Command::Disarm | Command::Setpoint(_) => {}
        }
        Ok(())
    }

    /// What came back for the bytes that arrived last, and when.
    ///
    /// # Errors
    /// The rule that was broken.
    pub fn heard(&mut self, answer: Option<&Output>, at_us: u64) -> Verdict {
        let Some(output) = answer else {
            self.link.unanswered();
            return Ok(());
        };
        self.answers += 1;
        let Some(ticks) = self.link.answered(output, at_us)? else {
            return alarm(Rule::Damaged, "an answer to nothing that was sent");
        };
        let setpoint = ticks.setpoint;
        self.plain(output, &setpoint)?;
        let was_on = is_on(self.mode);
        if output.mode == Mode::Bypass || output.mode == Mode::Off {
            self.finish(output, was_on)?;
        } else {
            hold(self.arming.is_armed(), Rule::Unarmed, || format!("{} without an arming", output.mode))?;
        }
        self.bounds.axes(output, self.arming.plane())?;
        self.bounds.size(output, &setpoint)?;
        let following = matches!(output.mode, Mode::Active | Mode::Hold) && output.reason == Reason::None;
        if following || output.mode == Mode::Armed {
            self.link.may_go_on(&ticks)?;
            self.arming.may_go_on(&setpoint, following)?;
        }
        if is_on(output.mode) {
            self.note(output, &setpoint);
        }
        if following {
            let began = !was_on;
            self.settled[4] += u64::from(self.course.follows(output, &ticks, began)?);
        } else {
            self.course.stops();
        }
        self.bounds.changes(output, &ticks, was_on)?;
        self.arming.ticked();
        self.modes[output.mode as usize] += 1;
        self.mode = output.mode;
        Ok(())
    }

    /// Sum, and no correction where there must be none.
    fn plain(&self, output: &Output, setpoint: &Setpoint) -> Verdict {
        for axis in 0..usize::from(self.settings.axes).min(AXES) {
            let (from, to, added) = (setpoint.axes[axis], output.axes[axis], output.correction_nm[axis]);
            hold(from.checked_add(added.into()) == Some(to), Rule::Sum, || {
                format!("axis {axis}: {to} nm is not {from} + {added} nm")
            })?;
        }
        hold(output.forward == (output.mode != Mode::Off), Rule::Enable, || {
            format!("in {} forward is {}", output.mode, output.forward)
        })?;
        hold(is_on(output.mode) || output.correction_nm == [0; AXES], Rule::Plain, || {
            format!("in {} the correction is {:?} nm", output.mode, output.correction_nm)
        })
    }

    /// Nothing is on any more.
    fn finish(&mut self, output: &Output, was_on: bool) -> Verdict {
        if was_on && output.mode == Mode::Bypass {
            self.bounds.ramped_out(&self.link)?;
        }
        if self.arming.is_armed() && output.reason != Reason::None {
            self.ended.push(output.reason);
        }
        self.arming.end();
        Ok(())
    }

    /// Counts what stricter rules would not permit.
    fn note(&mut self, output: &Output, setpoint: &Setpoint) {
        let outside = |plane: [usize; 2]| (0..AXES).any(|k| output.correction_nm[k] != 0 && !plane.contains(&k));
        self.settled[0] += u64::from(self.arming.asked_plane().is_some_and(outside));
        let active = matches!(output.mode, Mode::Active | Mode::Hold);
        let stopped = setpoint.flags.has(STOPS) || !setpoint.flags.has(Flags::DRIVES_ENABLED);
        self.settled[1] += u64::from(active && (stopped || self.course.is_off_path(setpoint)));
        self.settled[2] += u64::from(self.link.was_touched());
        self.settled[3] += u64::from(active && self.course.is_above_and_away(setpoint));
    }

    /// Adds what the session was to a tally.
    pub fn add_to(&self, tally: &mut Tally) {
        tally.answers += self.answers;
        tally.commands += self.commands;
        tally.armed += self.arming.count();
        for (to, count) in tally.modes.iter_mut().zip(self.modes) {
            *to += count;
        }
        for reason in &self.ended {
            *tally.ended.entry(reason.code()).or_default() += 1;
        }
        for (to, share) in tally.used.iter_mut().zip(self.bounds.used()) {
            *to = (*to).max(share);
        }
        for (to, count) in tally.settled.iter_mut().zip(self.settled) {
            *to += count;
        }
    }
}
