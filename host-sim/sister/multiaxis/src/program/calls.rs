//! The plain line of each step of an executed program.

use truepath_core::gcode::{
    Canon, Coolant, Event, FeedMode, Motion, Number, PathControl, Plane, Spindle, ToolLength, Units,
};
use truepath_core::geometry::{Point, Side};
use truepath_core::units::Position;

use super::unroll::{Writer, decimal, length};

/// What cannot be written out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refused(pub(super) &'static str);

impl Writer {
    /// Writes one step.
    pub(super) fn canon(&mut self, event: &Event<'_>) -> Result<(), Refused> {
        let units = event.modal.units;
        let tapping = |m| matches!(m, Motion::Cycle(code) if matches!(code.tenths(), 740 | 840));
        if event.modal.motion.is_some_and(tapping) {
            return Err(Refused("a tapping cycle"));
        }
        let line = match event.canon {
            Canon::ProgramNumber(_) => return Ok(()),
            Canon::Comment(span) => {
                let body = String::from_utf8_lossy(span.of(event.text)).replace(['(', ')', '\r', '\n'], " ");
                format!("({body})")
            }
            Canon::Units(Units::Inches) => "G20".to_owned(),
            Canon::Units(Units::Millimetres) => "G21".to_owned(),
            Canon::Plane(plane) => ["G17", "G18", "G19"][plane_number(plane)].to_owned(),
            Canon::FeedMode(FeedMode::InverseTime) => "G93".to_owned(),
            Canon::FeedMode(FeedMode::PerMinute) => "G94".to_owned(),
            Canon::FeedMode(FeedMode::PerRevolution) => "G95".to_owned(),
            Canon::FeedRate(_) if event.modal.feed_mode == FeedMode::InverseTime => return Ok(()),
            Canon::FeedRate(feed) => {
                let per_mm = 1e6 / units.nanometres() as f64;
                format!("F{}", decimal(real(feed) * per_mm))
            }
            Canon::SpindleSpeed(speed) => format!("S{}", decimal(real(speed))),
            Canon::Spindle(Spindle::Clockwise) => "M3".to_owned(),
            Canon::Spindle(Spindle::CounterClockwise) => "M4".to_owned(),
            Canon::Spindle(Spindle::Stopped) => "M5".to_owned(),
            Canon::SelectTool(tool) => format!("T{tool}"),
            Canon::ChangeTool(_) => "M6".to_owned(),
            Canon::Coolant(Coolant::Mist) => "M7".to_owned(),
            Canon::Coolant(Coolant::Flood) => "M8".to_owned(),
            Canon::Coolant(Coolant::Off) => "M9".to_owned(),
            Canon::ToolLength(ToolLength::Off) => "G49".to_owned(),
            Canon::ToolLength(ToolLength::Table(None)) => "G43".to_owned(),
            Canon::ToolLength(ToolLength::Table(Some(row))) => format!("G43 H{row}"),
            Canon::ToolLength(ToolLength::InProgram) => return Err(Refused("G43.1")),
            Canon::Compensation { wall: None, .. } => "G40".to_owned(),
            Canon::Compensation { wall: Some(side), offset_number } => {
                let code = if side == Side::Right { "G41" } else { "G42" };
                offset_number.map_or_else(|| code.to_owned(), |d| format!("{code} D{d}"))
            }
            Canon::WorkOffset(system) => {
                self.placed = [false; 3];
                work_offset(system)
            }
            Canon::Shift(_) => return Err(Refused("G92, G52 or G10")),
            Canon::ToolEntry { .. } => return Err(Refused("G10")),
            Canon::PathControl(control) => path_control(control, units),
            Canon::Dwell(time) => format!("G4 P{}", decimal(time.value())),
            Canon::Traverse { to, .. } => {
                return self.moved("G0", event, to, "");
            }
            Canon::Feed { to, .. } => {
                return self.moved("G1", event, to, "");
            }
            Canon::Arc { from, to, centre, counter_clockwise, turns, .. } => {
                let Some(start) = from.point() else { return Err(Refused("an arc from an unknown place")) };
                let centre = offsets(centre, start, ['I', 'J'], units);
                return self.moved(arc(counter_clockwise), event, to, &(centre + &full_turns(turns)));
            }
            Canon::PlaneArc { plane, from, to, centre, counter_clockwise, turns, .. } => {
                let [first, second, _] = plane.axes();
                let (Some(x), Some(y)) = (from.get(first), from.get(second)) else {
                    return Err(Refused("an arc from an unknown place"));
                };
                let letters = [first, second].map(|axis| ['I', 'J', 'K'][axis]);
                let centre = offsets(centre, Point { x, y }, letters, units);
                return self.moved(arc(counter_clockwise), event, to, &(centre + &full_turns(turns)));
            }
            Canon::Spline { .. } => return Err(Refused("a spline")),
            Canon::Probe { .. } => return Err(Refused("a probing move")),
            Canon::Tap { .. } => return Err(Refused("rigid tapping")),
            Canon::MachineMove { .. } | Canon::Reference { .. } => return self.verbatim(event),
            Canon::Stop { optional: true } => "M1".to_owned(),
            Canon::Stop { optional: false } => "M0".to_owned(),
            Canon::OtherM(number) => self.other(number)?,
            Canon::End(number) => format!("M{number}"),
        };
        self.push(line.as_bytes());
        Ok(())
    }

    /// G28, G30, G53 with the words of their block, which then are the only ones.
    fn verbatim(&mut self, event: &Event<'_>) -> Result<(), Refused> {
        let whole = !self.block.names_axes();
        for (axis, placed) in self.placed.iter_mut().enumerate() {
            *placed &= !whole && self.block.axis(3 + axis).is_none();
        }
        let known = |letter: u8| matches!(letter, b'G' | b'X'..=b'Z' | b'A'..=b'C');
        let mut line = if event.modal.absolute { String::new() } else { "G91".to_owned() };
        for word in &self.block.words {
            let number = word.value.map(|v| decimal(v.value()));
            let Some(number) = number.filter(|_| known(word.letter)) else {
                return Err(Refused("G28, G30 or G53 with a computed place or other words"));
            };
            line += &format!(" {}{number}", char::from(word.letter));
        }
        self.push(line.as_bytes());
        if !event.modal.absolute {
            self.push(b"G90");
        }
        Ok(())
    }

    /// An M code that is passed on, with its P and Q.
    fn other(&self, number: u32) -> Result<String, Refused> {
        let mut line = format!("M{number}");
        for word in self.block.words.iter().filter(|w| matches!(w.letter, b'P' | b'Q' | b'E' | b'L')) {
            let Some(value) = word.value else { return Err(Refused("an M code with a computed word")) };
            line += &format!(" {}{}", char::from(word.letter), decimal(Number::Exact(value).value()));
        }
        Ok(line)
    }
}

fn real(value: truepath_core::units::Real) -> f64 {
    value.bits() as f64 / 4_294_967_296.0
}

const fn plane_number(plane: Plane) -> usize {
    match plane {
        Plane::Xy => 0,
        Plane::Zx => 1,
        Plane::Yz => 2,
    }
}

const fn arc(counter_clockwise: bool) -> &'static str {
    if counter_clockwise { "G3" } else { "G2" }
}

/// The centre from the start.
fn offsets(centre: Point, start: Point, letters: [char; 2], units: Units) -> String {
    let by = |a: Position, b: Position| length(a.nm().saturating_sub(b.nm()), units);
    format!(" {}{} {}{}", letters[0], by(centre.x, start.x), letters[1], by(centre.y, start.y))
}

fn full_turns(turns: u32) -> String {
    if turns == 0 { String::new() } else { format!(" P{}", turns + 1) }
}

fn work_offset(system: u16) -> String {
    match system {
        0..=6 => format!("G{}", 53 + system.max(1)),
        7..=9 => format!("G59.{}", system - 6),
        10..=109 => format!("G54.1 P{}", system - 9),
        _ => format!("G154 P{}", system - 109),
    }
}

fn path_control(control: PathControl, units: Units) -> String {
    match control {
        PathControl::Exact => "G61".to_owned(),
        PathControl::ExactStop => "G61.1".to_owned(),
        PathControl::Blend { tolerance, merge } => {
            let word = |letter, by: Option<truepath_core::units::Offset>| {
                by.map_or_else(String::new, |by| format!(" {letter}{}", length(by.nm(), units)))
            };
            format!("G64{}{}", word('P', tolerance), word('Q', merge))
        }
    }
}
