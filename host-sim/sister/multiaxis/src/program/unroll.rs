//! Programs with loops, calls and computed places, written out block by block.
//!
//! The interpreter of the core executes the program; every step it takes becomes one plain line in the order of
//! execution, absolute (G90), in the program's unit. The result is read like any other program. So a program that is
//! steered is measured as it runs, and can be rewritten where its own text cannot.
//!
//! Limits: a step that has no plain line, or depends on what a machine finds (probing), is
//! refused with its line; G10, G92 and G52 are, since offsets belong to the machine; a million blocks more than lines.

use truepath_core::gcode::{
    Axes, Canon, CompensationBy, Coolant, Dialect, Event, FeedMode, GcodeErrorKind, HostMemory, Interpreter, Motion,
    Number, Options, PathControl, Plane, PointlessLength, Program, Spindle, ToolLength, Units,
};
use truepath_core::geometry::{Point, Side};
use truepath_core::units::{Offset, Position, Real};
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::library::Folder;

use super::block::{AXES, Block};
use super::quantity::{Quantity, Scale};
use crate::codes::A012;

/// A program written out.
#[derive(Clone, Debug, Default)]
pub struct Unrolled {
    /// The plain program.
    pub text: Vec<u8>,
    /// The line of the original that each of its lines comes from.
    pub origin: Vec<u32>,
}

/// How the program is read.
#[derive(Clone, Copy, Debug)]
pub struct UnrollOptions {
    /// The control.
    pub dialect: Dialect,
    /// What a length without a point is.
    pub decimal: PointlessLength,
    /// The unit until G20 or G21.
    pub units: Units,
    /// Blocks with `/` are left out.
    pub skip_block_delete: bool,
}

/// Executes a program and writes it out.
///
/// # Errors
/// What the interpreter does not understand, and `A012` for a step that cannot be written out, at its line.
pub fn unroll(source: &Source, options: UnrollOptions) -> Result<Unrolled, InputError> {
    let start = Options {
        units: options.units,
        skip_block_delete: options.skip_block_delete,
        dialect: options.dialect,
        decimal: options.decimal,
        compensation: CompensationBy::Nothing,
        ..Options::default()
    };
    let beside = Folder::beside(std::path::Path::new(source.name()));
    let mut buffers = Box::new(HostMemory::new());
    let program = Program { text: source.bytes(), library: Some(&beside) };
    let mut writer = Writer::new();
    let mut refused = None;
    let run = Interpreter::new(start).run(program, &mut buffers.lend(), &mut |event| {
        if refused.is_none()
            && let Err(why) = writer.event(event)
        {
            refused = Some((why, event.source));
        }
        Ok::<(), GcodeErrorKind>(())
    });
    run.map_err(|error| InputError::of_program(beside.source(error.file).unwrap_or(source), &error))?;
    if let Some((Refused(what), place)) = refused {
        let file = beside.source(place.file).unwrap_or(source);
        let span = place.block.start..place.block.end();
        let found = format!("{what} in a program with loops, calls or computed places");
        return Err(A012.error(found, "moves, modes, feeds and tools").at(file, span));
    }
    Ok(writer.out)
}

/// What cannot be written out.
#[derive(Clone, Copy, Debug)]
struct Refused(&'static str);

/// The text on its way.
struct Writer {
    out: Unrolled,
    /// The block of the event.
    block: Block,
    /// A, B, C as written last.
    rotary: [i64; 3],
    /// Which of them a word of G90 has placed: from elsewhere an increment cannot be written as a place.
    placed: [bool; 3],
    /// X, Y, Z as written last, nm.
    linear: [Option<i64>; 3],
    /// Line, jumps and file of the block read last.
    read: Option<(u32, u32, u16)>,
    line: u32,
}

impl Writer {
    fn new() -> Self {
        let mut writer = Self {
            out: Unrolled::default(),
            block: Block::default(),
            rotary: [0; 3],
            placed: [false; 3],
            linear: [None; 3],
            read: None,
            line: 1,
        };
        writer.push(b"G90");
        writer
    }

    fn event(&mut self, event: &Event<'_>) -> Result<(), Refused> {
        // In another file than the program: the last line of the program itself.
        self.line = if event.source.file == 0 { event.source.line } else { self.line };
        let place = (event.source.line, event.source.jumps, event.source.file);
        if self.read.replace(place) != Some(place) {
            let text = event.source.block.of(event.text);
            // A byte order mark and what else the reader has accepted needs no second refusal.
            let _ = self.block.read(event.source.line, text);
        }
        if event.modal.auxiliary[3..] != [0; 3] {
            return Err(Refused("a move of U, V or W"));
        }
        self.canon(event)
    }

    /// Appends a line.
    fn push(&mut self, text: &[u8]) {
        self.out.text.extend_from_slice(text);
        self.out.text.push(b'\n');
        self.out.origin.push(self.line);
    }

    /// Appends a move with the words of the axes that the block names or that change.
    ///
    /// # Errors
    /// An increment of a rotary axis whose place the program has not said.
    fn moved(&mut self, code: &str, event: &Event<'_>, to: Axes, behind: &str) -> Result<(), Refused> {
        for (axis, placed) in self.placed.iter_mut().enumerate() {
            let named = self.block.axis(3 + axis).is_some();
            *placed |= named && event.modal.absolute;
            if named && !*placed {
                return Err(Refused("an increment of a rotary axis whose place has not been said in G90"));
            }
        }
        let mut line = code.to_owned();
        for (axis, letter) in AXES.into_iter().map(char::from).enumerate() {
            let number = if axis < 3 {
                let Some(at) = to.get(axis).map(Position::nm) else { continue };
                let stays = self.linear[axis].replace(at) == Some(at);
                (!stays || self.block.axis(axis).is_some()).then(|| length(at, event.modal.units))
            } else {
                let at = event.modal.auxiliary[axis - 3];
                let stays = std::mem::replace(&mut self.rotary[axis - 3], at) == at;
                let degrees = || Quantity::of_millionths(at).text(Scale::Degrees);
                (!stays || self.block.axis(axis).is_some()).then(degrees)
            };
            if let Some(number) = number {
                line += &format!(" {letter}{number}");
            }
        }
        line += behind;
        if event.modal.feed_mode == FeedMode::InverseTime
            && !code.starts_with("G0")
            && let Some(feed) = event.modal.feed
        {
            line += &format!(" F{}", decimal(real(feed)));
        }
        self.push(line.as_bytes());
        Ok(())
    }

    /// Writes one step.
    fn canon(&mut self, event: &Event<'_>) -> Result<(), Refused> {
        let units = event.modal.units;
        let tapping = |m| matches!(m, Motion::Cycle(code) if matches!(code.tenths(), 740 | 840));
        if event.modal.motion.is_some_and(tapping) {
            return Err(Refused("a tapping cycle"));
        }
        let line = match *event.canon {
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

/// A length in the unit of the words.
fn length(nm: i64, units: Units) -> String {
    Quantity::of_millionths(nm).text(Scale::of_axis(0, units))
}

/// A number with nine significant digits, without an exponent.
fn decimal(value: f64) -> String {
    let whole = value.abs().max(1.0).log10().floor() as usize;
    let text = format!("{value:.*}", 8usize.saturating_sub(whole).max(1));
    let kept = text.trim_end_matches('0');
    if kept.ends_with('.') { format!("{kept}0") } else { kept.to_owned() }
}

fn real(value: Real) -> f64 {
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
            let word = |letter, by: Option<Offset>| {
                by.map_or_else(String::new, |by| format!(" {letter}{}", length(by.nm(), units)))
            };
            format!("G64{}{}", word('P', tolerance), word('Q', merge))
        }
    }
}
