//! The calls of one block.

use std::io::{self, Write};

use truepath_core::gcode::{
    Axes, Canon, Coolant, Line, Motion, PathControl, Span, Spindle, Token, ToolLength, Units, Words,
};

use super::{Printer, Step, decimal};

/// What the text needs of a block beyond its events: modes that are no events, the N word as written.
#[derive(Default)]
pub(super) struct Codes {
    pub(super) number: Option<String>,
    pub(super) block_delete: bool,
    pub(super) motion: Option<Motion>,
    pub(super) incremental: Option<bool>,
    pub(super) absolute_centres: Option<bool>,
    pub(super) cancels_motion: bool,
    pub(super) feed_per_minute: bool,
}

impl Codes {
    pub(super) fn of(line: Line<'_>, program: &[u8]) -> Self {
        let mut codes = Self::default();
        for token in Words::new(line).map_while(Result::ok) {
            match token {
                Token::BlockDelete { .. } => codes.block_delete = true,
                Token::Word(word) if word.letter == b'N' => codes.number = Some(label(word.span, program)),
                Token::Word(word) if word.letter == b'G' => match word.value.and_then(|v| v.exactly_times(10)) {
                    Some(0) => codes.motion = Some(Motion::Traverse),
                    Some(10) => codes.motion = Some(Motion::Feed),
                    Some(20) => codes.motion = Some(Motion::Arc { counter_clockwise: false }),
                    Some(30) => codes.motion = Some(Motion::Arc { counter_clockwise: true }),
                    Some(800) => codes.cancels_motion = true,
                    Some(940) => codes.feed_per_minute = true,
                    Some(900) => codes.incremental = Some(false),
                    Some(910) => codes.incremental = Some(true),
                    Some(901) => codes.absolute_centres = Some(true),
                    Some(911) => codes.absolute_centres = Some(false),
                    _ => {}
                },
                _ => {}
            }
        }
        codes
    }
}

/// The digits of an N word before its point, as written.
fn label(span: Span, program: &[u8]) -> String {
    let digits = span.of(program).iter().skip(1).filter(|b| !b.is_ascii_whitespace());
    digits.take_while(|b| b.is_ascii_digit()).map(|&b| char::from(b)).collect()
}

const OFF: &str = "0.0000 0.0000 0.0000";

impl<W: Write> Printer<'_, W> {
    pub(super) fn step(&mut self, step: &Step) -> io::Result<()> {
        match step.canon {
            Canon::ProgramNumber(_) => Ok(()),
            Canon::Comment(body) => self.comment(body),
            Canon::Units(units) => {
                self.units = units;
                let name = if units == Units::Inches { "INCHES" } else { "MM" };
                self.call(&format!("USE_LENGTH_UNITS(CANON_UNITS_{name})"))
            }
            Canon::Plane(_) => self.call("SELECT_PLANE(CANON_PLANE_XY)"),
            Canon::FeedRate(feed) => {
                let per_unit = step.units.nanometres() as f64 / 1e6;
                self.call(&format!("SET_FEED_RATE({})", decimal(real(feed) / per_unit)))
            }
            Canon::SpindleSpeed(speed) => self.call(&format!("SET_SPINDLE_SPEED(0, {})", decimal(real(speed)))),
            Canon::Spindle(spindle) => self.call(match spindle {
                Spindle::Clockwise => "START_SPINDLE_CLOCKWISE(0)",
                Spindle::CounterClockwise => "START_SPINDLE_COUNTERCLOCKWISE(0)",
                Spindle::Stopped => "STOP_SPINDLE_TURNING(0)",
            }),
            Canon::SelectTool(tool) => {
                self.tool = tool;
                self.call(&format!("SELECT_TOOL({tool})"))
            }
            Canon::ChangeTool(tool) => {
                self.call("START_CHANGE()")?;
                self.call("STOP_SPINDLE_TURNING(0)")?;
                self.call(&format!("CHANGE_TOOL({})", self.options.tools.row(tool.unwrap_or(0))))
            }
            Canon::Coolant(coolant) => self.coolant(coolant),
            Canon::ToolLength(length) => self.tool_length(length),
            Canon::Compensation { wall, .. } => {
                let state = match wall {
                    None => "off",
                    Some(truepath_core::geometry::Side::Right) => "on left",
                    Some(truepath_core::geometry::Side::Left) => "on right",
                };
                self.call(&format!("COMMENT(\"interpreter: cutter radius compensation {state}\")"))
            }
            Canon::WorkOffset(system) => self.work_offset(system),
            Canon::PathControl(control) => self.path_control(control),
            Canon::Dwell(time) => self.call(&format!("DWELL({})", decimal(real(time.real())))),
            Canon::Traverse { to, .. } => {
                self.go(to);
                self.straight(true)
            }
            Canon::Feed { to, .. } => {
                self.go(to);
                self.straight(false)
            }
            Canon::Arc { to, centre, counter_clockwise, .. } => {
                self.go(to);
                let [x, y, z] = self.at.map(|nm| self.length(nm));
                let [i, j] = [centre.x.nm(), centre.y.nm()].map(|nm| self.length(nm));
                let turn = if counter_clockwise { 1 } else { -1 };
                self.call(&format!("ARC_FEED({x}, {y}, {i}, {j}, {turn}, {z}, 0.0000, 0.0000, 0.0000)"))
            }
            Canon::MachineMove { to, rapid } => {
                self.go(to);
                for (axis, named) in [to.x, to.y, to.z].into_iter().enumerate() {
                    if named.is_some() {
                        self.at[axis] -= self.offset[axis];
                    }
                }
                self.straight(rapid)
            }
            Canon::Reference { axes, via, .. } => {
                self.go(via);
                self.straight(true)?;
                for ((at, offset), moves) in self.at.iter_mut().zip(self.offset).zip(axes) {
                    *at = if moves { -offset } else { *at };
                }
                self.straight(true)
            }
            Canon::Stop { optional } => self.call(if optional { "OPTIONAL_PROGRAM_STOP()" } else { "PROGRAM_STOP()" }),
            Canon::OtherM(number) => self.call(&format!("COMMENT(\"truepath: M{number} is not executed\")")),
            Canon::End(number) => self.end(number == 30),
            _ => self.call("COMMENT(\"truepath: not shown\")"),
        }
    }

    fn go(&mut self, to: Axes) {
        for (at, to) in self.at.iter_mut().zip([to.x, to.y, to.z]) {
            *at = to.map_or(*at, |p| p.nm());
        }
    }

    fn comment(&mut self, body: Span) -> io::Result<()> {
        // What follows a semicolon is not shown by the reference.
        if self.program.get(body.start.wrapping_sub(1)) == Some(&b';') {
            return Ok(());
        }
        let text = String::from_utf8_lossy(body.of(self.program)).into_owned();
        match text.split_once(',') {
            Some((kind, message)) if ["MSG", "DEBUG"].iter().any(|k| kind.trim().eq_ignore_ascii_case(k)) => {
                self.call(&format!("MESSAGE(\"{message}\")"))
            }
            _ => self.call(&format!("COMMENT(\"{}\")", text.trim_start())),
        }
    }

    fn coolant(&mut self, coolant: Coolant) -> io::Result<()> {
        match coolant {
            Coolant::Mist => {
                self.coolant[0] = true;
                self.call("MIST_ON()")
            }
            Coolant::Flood => {
                self.coolant[1] = true;
                self.call("FLOOD_ON()")
            }
            Coolant::Off => {
                self.coolant = [false; 2];
                self.call("MIST_OFF()")?;
                self.call("FLOOD_OFF()")
            }
        }
    }

    fn tool_length(&mut self, length: ToolLength) -> io::Result<()> {
        let offset = match length {
            ToolLength::Off => [0; 3],
            ToolLength::Table(tool) => self.options.tools.offset(tool.unwrap_or(self.tool)).unwrap_or_default(),
            // The core refuses to move from a place it does not know; the values themselves are no part of an event.
            ToolLength::InProgram => return self.call("COMMENT(\"truepath: tool offset from the program (G43.1)\")"),
        };
        for ((at, before), now) in self.at.iter_mut().zip(self.offset).zip(offset) {
            *at += before - now;
        }
        self.offset = offset;
        let [x, y, z] = offset.map(|nm| self.length(nm));
        self.call(&format!("USE_TOOL_LENGTH_OFFSET({x} {y} {z}, {OFF}, {OFF})"))
    }

    fn work_offset(&mut self, system: u16) -> io::Result<()> {
        if system == std::mem::replace(&mut self.work_offset, system) {
            return self.call("COMMENT(\"interpreter: continuing to use same coordinate system\")");
        }
        self.call(&format!("SET_G5X_OFFSET({system}, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)"))?;
        self.call("SET_G92_OFFSET(0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)")?;
        self.call("SET_XY_ROTATION(0.0000)")
    }

    fn path_control(&mut self, control: PathControl) -> io::Result<()> {
        match control {
            PathControl::Exact => self.call("SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)"),
            PathControl::ExactStop => self.call("SET_MOTION_CONTROL_MODE(CANON_EXACT_STOP)"),
            PathControl::Blend { tolerance, merge } => {
                let unit = self.units.nanometres() as f64;
                let tolerance = tolerance.map_or(0.0, |t| t.nm() as f64 / unit);
                // Without Q short lines are merged within P.
                let merge = merge.map_or(tolerance, |q| q.nm() as f64 / unit);
                self.call(&format!("SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, {tolerance:.6})"))?;
                self.call(&format!("SET_NAIVECAM_TOLERANCE({})", decimal(merge)))
            }
        }
    }

    fn end(&mut self, pallet: bool) -> io::Result<()> {
        self.call("SET_G5X_OFFSET(1, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)")?;
        self.call("SET_XY_ROTATION(0.0000)")?;
        self.call("SET_FEED_MODE(0, 0)")?;
        self.call("SET_FEED_RATE(0.0000)")?;
        self.call("STOP_SPINDLE_TURNING(0)")?;
        self.call("SET_SPINDLE_MODE(0 0.0000)")?;
        for (on, name) in self.coolant.into_iter().zip(["MIST_OFF()", "FLOOD_OFF()"]) {
            if on {
                self.call(name)?;
            }
        }
        if pallet {
            self.call("PALLET_SHUTTLE()")?;
        }
        self.call("PROGRAM_END()")?;
        self.reset_label();
        self.call("ON_RESET()")?;
        self.call("ON_RESET()")
    }
}

fn real(value: truepath_core::units::Real) -> f64 {
    value.bits() as f64 / 4_294_967_296.0
}
