//! The calls: what they have set, and those that set modes.

use std::io::Write;

use truepath_core::gcode::{
    Axes, Canon, Coolant, Event, FeedMode, HostMemory, Memory, Modal, NineAxes, PathControl, Plane, ShiftKind, Spindle,
    Units,
};
use truepath_core::geometry::Side;
use truepath_core::units::{Position, Real};

use super::argument::Places;
use super::lines::Lines;
use super::number::MILLION;
use super::options::CanonOptions;

/// Writes calls, and knows what they have set.
pub(super) struct Calls<'a, W> {
    options: &'a CanonOptions,
    pub(super) lines: Lines<W>,
    /// Where the axes stand, nanometres.
    pub(super) at: [i64; 3],
    /// The text of that.
    pub(super) places: Places,
    coolant: [bool; 2],
    work_offset: u16,
}

impl<'a, W: Write> Calls<'a, W> {
    /// With the calls by which the reference begins.
    pub(super) fn new(options: &'a CanonOptions, out: W) -> Self {
        let mut calls = Self {
            options,
            lines: Lines::new(out),
            at: [0; 3],
            places: Places::new(MILLION),
            coolant: [false; 2],
            work_offset: 1,
        };
        calls.begin();
        calls
    }

    /// What the machine was left in.
    fn begin(&mut self) {
        let mut buffers = Box::new(HostMemory::new());
        let mut memory = buffers.lend();
        self.options.parameters.load(&mut memory);
        let system = memory.get(5220).clamp(1.0, 9.0) as u16;
        let (work, rotation) = self.stored_offset(system, &memory);
        let local = if memory.get(5210) > 0.5 { self.stored_axes(5211, &memory) } else { [0; 9] };
        self.work_offset = system;
        self.lines.call("USE_LENGTH_UNITS", "CANON_UNITS_MM");
        self.offset("SET_G5X_OFFSET", Some(system), &work, Units::Millimetres);
        self.offset("SET_G92_OFFSET", None, &local, Units::Millimetres);
        self.rotation(rotation);
        self.lines.call("SET_FEED_REFERENCE", "CANON_XYZ");
        self.lines.call("ON_RESET", "");
    }

    /// A work offset as the parameters hold it, and its rotation.
    fn stored_offset(&self, system: u16, memory: &Memory<'_>) -> (NineAxes, i64) {
        let first = 5201 + 20 * system;
        (self.stored_axes(first, memory), scaled(memory.get(first + 9), MILLION))
    }

    fn stored_axes(&self, first: u16, memory: &Memory<'_>) -> NineAxes {
        let unit = self.options.machine_units.nanometres();
        let mut values: NineAxes = [0; 9];
        for ((value, number), axis) in values.iter_mut().zip(first..).zip(0..) {
            *value = scaled(memory.get(number), if (3..6).contains(&axis) { MILLION } else { unit });
        }
        values
    }

    /// Moves to a place; an axis that is not known stays.
    pub(super) fn go(&mut self, to: Axes) {
        let stays = |at: i64, to: Option<Position>| to.map_or(at, Position::nm);
        let [x, y, z] = self.at;
        self.at = [stays(x, to.x), stays(y, to.y), stays(z, to.z)];
    }

    /// Prints one step. `event` is there for those that come as they are executed.
    pub(super) fn call(&mut self, canon: &Canon, modal: &Modal, event: Option<&Event<'_>>) {
        match *canon {
            Canon::Units(units) => {
                let name = if units == Units::Inches { "INCHES" } else { "MM" };
                self.lines.call("USE_LENGTH_UNITS", &format!("CANON_UNITS_{name}"));
            }
            Canon::Plane(plane) => self.plane(plane),
            Canon::FeedMode(mode) => self.feed_mode(mode),
            // The reference tells the feed of each move instead.
            Canon::FeedRate(_) if modal.feed_mode == FeedMode::InverseTime => {}
            Canon::FeedRate(feed) => self.feed_rate(real(feed) * 1e6 / modal.units.nanometres() as f64),
            Canon::SpindleSpeed(speed) => self.spindle_value("SET_SPINDLE_SPEED", "0, ", real(speed)),
            Canon::Spindle(spindle) => self.lines.call(
                match spindle {
                    Spindle::Clockwise => "START_SPINDLE_CLOCKWISE",
                    Spindle::CounterClockwise => "START_SPINDLE_COUNTERCLOCKWISE",
                    Spindle::Stopped => "STOP_SPINDLE_TURNING",
                },
                "0",
            ),
            Canon::SelectTool(tool) => self.lines.call("SELECT_TOOL", &tool.to_string()),
            Canon::ChangeTool(tool) => {
                self.lines.call("START_CHANGE", "");
                self.lines.call("STOP_SPINDLE_TURNING", "0");
                self.lines.call("CHANGE_TOOL", &self.options.tools.row(tool.unwrap_or(0)).to_string());
            }
            Canon::Coolant(coolant) => self.set_coolant(coolant),
            Canon::ToolLength(_) => self.tool_length(modal),
            Canon::Compensation { wall, .. } => self.lines.remark(match wall {
                None => "cutter radius compensation off",
                // The wall lies on the right of a cutter that runs on its left side.
                Some(Side::Right) => "cutter radius compensation on left",
                Some(Side::Left) => "cutter radius compensation on right",
            }),
            Canon::WorkOffset(system) => self.set_work_offset(system, modal),
            Canon::Shift(ShiftKind::Work) => {
                self.offset("SET_G5X_OFFSET", Some(modal.work_offset), &modal.shifts.work, modal.units);
                self.rotation(modal.shifts.rotation);
            }
            Canon::Shift(ShiftKind::Local) => self.offset("SET_G92_OFFSET", None, &modal.shifts.local, modal.units),
            Canon::PathControl(control) => self.path_control(control, modal),
            Canon::Dwell(time) => {
                self.lines.open("DWELL");
                self.lines.push_real(time.value());
                self.lines.close();
            }
            Canon::Stop { optional: true } => self.lines.call("OPTIONAL_PROGRAM_STOP", ""),
            Canon::Stop { optional: false } => self.lines.call("PROGRAM_STOP", ""),
            Canon::OtherM(number) => self.other(number),
            Canon::End(number) => self.end(number == 30, modal, event),
            Canon::Comment(_) | Canon::ProgramNumber(_) | Canon::ToolEntry { .. } => {}
            _ => self.motion(canon, event.map_or(modal, |e| e.modal)),
        }
    }

    fn plane(&mut self, plane: Plane) {
        let name = match plane {
            Plane::Xy => "XY",
            Plane::Zx => "XZ",
            Plane::Yz => "YZ",
        };
        self.lines.call("SELECT_PLANE", &format!("CANON_PLANE_{name}"));
    }

    fn feed_mode(&mut self, mode: FeedMode) {
        let (name, per_revolution) = match mode {
            FeedMode::PerMinute => ("units per minute", 0),
            FeedMode::InverseTime => ("inverse time", 0),
            FeedMode::PerRevolution => ("units per revolution", 1),
        };
        self.lines.remark(&format!("feed mode set to {name}"));
        self.lines.call("SET_FEED_MODE", &format!("0, {per_revolution}"));
        if mode != FeedMode::InverseTime {
            self.feed_rate(0.0);
        }
    }

    pub(super) fn feed_rate(&mut self, rate: f64) {
        self.lines.open("SET_FEED_RATE");
        self.lines.push_real(rate);
        self.lines.close();
    }

    fn spindle_value(&mut self, name: &str, before: &str, value: f64) {
        self.lines.open(name);
        self.lines.push(before);
        self.lines.push_real(value);
        self.lines.close();
    }

    fn set_coolant(&mut self, coolant: Coolant) {
        match coolant {
            Coolant::Mist => {
                self.coolant[0] = true;
                self.lines.call("MIST_ON", "");
            }
            Coolant::Flood => {
                self.coolant[1] = true;
                self.lines.call("FLOOD_ON", "");
            }
            Coolant::Off => {
                self.coolant = [false; 2];
                self.lines.call("MIST_OFF", "");
                self.lines.call("FLOOD_OFF", "");
            }
        }
    }

    fn tool_length(&mut self, modal: &Modal) {
        let unit = modal.units.nanometres();
        let [x, y, z, a, b, c, u, v, w] = modal.shifts.tool;
        self.lines.open("USE_TOOL_LENGTH_OFFSET");
        self.lines.push_values(&[x, y, z].map(|v| (v, unit)), " ");
        self.lines.push(", ");
        self.lines.push_values(&[a, b, c].map(|v| (v, MILLION)), " ");
        self.lines.push(", ");
        self.lines.push_values(&[u, v, w].map(|v| (v, unit)), " ");
        self.lines.close();
    }

    fn set_work_offset(&mut self, system: u16, modal: &Modal) {
        if system == std::mem::replace(&mut self.work_offset, system) {
            return self.lines.remark("continuing to use same coordinate system");
        }
        self.offset("SET_G5X_OFFSET", Some(system), &modal.shifts.work, modal.units);
        self.offset("SET_G92_OFFSET", None, &modal.shifts.local, modal.units);
        self.rotation(modal.shifts.rotation);
    }

    /// A call with the number of a coordinate system, when it has one, and six axes.
    fn offset(&mut self, name: &str, system: Option<u16>, offset: &NineAxes, units: Units) {
        let unit = units.nanometres();
        let [x, y, z, a, b, c, ..] = *offset;
        self.lines.open(name);
        if let Some(system) = system {
            self.lines.push_whole(u64::from(system));
            self.lines.push(", ");
        }
        let turning = [a, b, c].map(|v| (v, MILLION));
        self.lines.push_values(&[x, y, z].map(|v| (v, unit)), ", ");
        self.lines.push(", ");
        self.lines.push_values(&turning, ", ");
        self.lines.close();
    }

    fn rotation(&mut self, millionths: i64) {
        self.lines.open("SET_XY_ROTATION");
        self.lines.push_values(&[(millionths, MILLION)], "");
        self.lines.close();
    }

    fn path_control(&mut self, control: PathControl, modal: &Modal) {
        match control {
            PathControl::Exact => self.lines.call("SET_MOTION_CONTROL_MODE", "CANON_EXACT_PATH"),
            PathControl::ExactStop => self.lines.call("SET_MOTION_CONTROL_MODE", "CANON_EXACT_STOP"),
            PathControl::Blend { tolerance, merge } => {
                let unit = modal.units.nanometres() as f64;
                let tolerance = tolerance.map_or(0.0, |t| t.nm() as f64 / unit);
                // Without Q short lines are merged within P.
                let merge = merge.map_or(tolerance, |q| q.nm() as f64 / unit);
                self.lines.call("SET_MOTION_CONTROL_MODE", &format!("CANON_CONTINUOUS, {tolerance:.6}"));
                self.spindle_value("SET_NAIVECAM_TOLERANCE", "", merge);
            }
        }
    }

    /// M codes without words of their own; the arguments of others are not part of an event.
    fn other(&mut self, number: u32) {
        match number {
            48 | 49 => {
                let state = if number == 48 { "ENABLE" } else { "DISABLE" };
                self.lines.call(&format!("{state}_FEED_OVERRIDE"), "");
                self.lines.call(&format!("{state}_SPEED_OVERRIDE"), "0");
            }
            60 => {
                self.lines.call("PALLET_SHUTTLE", "");
                self.lines.call("PROGRAM_STOP", "");
            }
            61..=73 | 50..=53 | 19 => {}
            _ => self.lines.call("COMMENT", &format!("\"truepath: M{number} is not executed\"")),
        }
    }

    /// The end puts G54 and G17 into force.
    fn end(&mut self, pallet: bool, modal: &Modal, event: Option<&Event<'_>>) {
        let first = event.filter(|_| modal.work_offset != 1).map(|e| self.stored_offset(1, e.parameters.memory()));
        let (work, rotation) = first.unwrap_or((modal.shifts.work, modal.shifts.rotation));
        self.offset("SET_G5X_OFFSET", Some(1), &work, modal.units);
        self.rotation(rotation);
        if modal.plane != Plane::Xy {
            self.plane(Plane::Xy);
        }
        self.lines.call("SET_FEED_MODE", "0, 0");
        self.feed_rate(0.0);
        self.lines.call("STOP_SPINDLE_TURNING", "0");
        self.lines.call("SET_SPINDLE_MODE", "0 0.0000");
        for (on, name) in self.coolant.into_iter().zip(["MIST_OFF", "FLOOD_OFF"]) {
            if on {
                self.lines.call(name, "");
            }
        }
        if pallet {
            self.lines.call("PALLET_SHUTTLE", "");
        }
        self.lines.call("PROGRAM_END", "");
        self.lines.set_label(None);
        self.lines.call("ON_RESET", "");
        self.lines.call("ON_RESET", "");
    }
}

/// A parameter in whole numbers.
fn scaled(value: f64, unit: i64) -> i64 {
    (value * unit as f64).round() as i64
}

pub(super) fn real(value: Real) -> f64 {
    value.bits() as f64 / 4_294_967_296.0
}
