//! Programs with loops, calls and computed places, written out block by block.
//!
//! The interpreter of the core executes the program; every step it takes becomes one plain line in the order of
//! execution, absolute (G90), in the program's unit. The result is read like any other program. So a program that is
//! steered is measured as it runs, and can be rewritten where its own text cannot.
//!
//! Limits: what is not one of the steps of [`calls`](super::calls), or depends on what a machine finds (probing), is
//! refused with its line; G10, G92 and G52 are, since offsets belong to the machine; a million blocks more than lines.

use truepath_core::gcode::{
    Axes, CompensationBy, Dialect, Event, FeedMode, GcodeErrorKind, HostMemory, Interpreter, Options, PointlessLength,
    Program, Units,
};
use truepath_core::units::Position;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::library::Folder;

use super::block::{AXES, Block};
use super::calls::Refused;
use super::quantity::{Quantity, Scale};

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
        let help = "write this part of the program out by hand, or leave it to the control with --partial";
        let span = place.block.start..place.block.end();
        let found = format!("{what} in a program with loops, calls or computed places");
        return Err(InputError::new("A012", found, "moves, modes, feeds and tools", help).at(file, span));
    }
    Ok(writer.out)
}

/// The text on its way.
pub(super) struct Writer {
    out: Unrolled,
    /// The block of the event.
    pub(super) block: Block,
    /// A, B, C as written last.
    rotary: [i64; 3],
    /// Which of them a word of G90 has placed: from elsewhere an increment cannot be written as a place.
    pub(super) placed: [bool; 3],
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
    pub(super) fn push(&mut self, text: &[u8]) {
        self.out.text.extend_from_slice(text);
        self.out.text.push(b'\n');
        self.out.origin.push(self.line);
    }

    /// Appends a move with the words of the axes that the block names or that change.
    ///
    /// # Errors
    /// An increment of a rotary axis whose place the program has not said.
    pub(super) fn moved(&mut self, code: &str, event: &Event<'_>, to: Axes, behind: &str) -> Result<(), Refused> {
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
            line += &format!(" F{}", decimal(feed.bits() as f64 / 4_294_967_296.0));
        }
        self.push(line.as_bytes());
        Ok(())
    }
}

/// A length in the unit of the words.
pub(super) fn length(nm: i64, units: Units) -> String {
    Quantity::of_millionths(nm).text(Scale::of_axis(0, units))
}

/// A number with nine significant digits, without an exponent.
pub(super) fn decimal(value: f64) -> String {
    let whole = value.abs().max(1.0).log10().floor() as usize;
    let text = format!("{value:.*}", 8usize.saturating_sub(whole).max(1));
    let kept = text.trim_end_matches('0');
    if kept.ends_with('.') { format!("{kept}0") } else { kept.to_owned() }
}
