//! Canonical moves of a program as text, in the format of LinuxCNC's `rs274 -g`.
//!
//! The text can be compared line by line with the reference interpreter, under its own assumptions: axes start at 0,
//! all work offsets and reference points are 0, so machine coordinates are program coordinates less the tool offset.
//! One line a call: running number, N word of the block, `CALL(arguments)`; lengths in the program's unit with four
//! decimals.
//!
//! Limits: what the interpreter of the core does not execute is an error, as everywhere; a zero never carries a minus
//! sign; M codes that are not known are shown as a comment.

mod block;
mod tool_table;

use std::io::{self, Write};

use truepath_core::gcode::{
    Axes, Canon, Event, HostMemory, Interpreter, Line, Lines, Modal, Motion, Options, ProgramSummary, Units,
};

use crate::diagnostics::{InputError, Source};

pub use tool_table::ToolTable;

/// What `rs274` is told besides the program.
#[derive(Clone, Debug, Default)]
pub struct CanonOptions {
    /// Offsets for G43.
    pub tools: ToolTable,
    /// Whether blocks with `/` are skipped.
    pub skip_block_delete: bool,
}

/// Writes the canonical moves of a program; what the writer answers is returned inside.
///
/// # Errors
/// Whatever the interpreter does not understand.
pub fn write_canon(
    source: &Source,
    options: &CanonOptions,
    out: &mut impl Write,
) -> Result<io::Result<ProgramSummary>, InputError> {
    let program = source.bytes();
    let start = Options { start: Axes::ORIGIN, skip_block_delete: options.skip_block_delete, ..Options::default() };
    let mut memory = Box::new(HostMemory::new());
    let mut events: Vec<Step> = Vec::new();
    let summary = Interpreter::new(start)
        .run(program, &mut memory.lend(), &mut |event| {
            events.push(Step::of(event));
            Ok(())
        })
        .map_err(|e| InputError::of_program(source, &e))?;
    Ok(Printer::new(program, options, out).print(&events, summary))
}

/// An event with the line it belongs to.
#[derive(Clone, Copy, Debug)]
struct Step {
    line: u32,
    canon: Canon,
    units: Units,
}

impl Step {
    const fn of(event: &Event<'_>) -> Self {
        let Modal { units, .. } = *event.modal;
        Self { line: event.source.line, canon: event.canon, units }
    }

    /// The order in which RS274/NGC executes the parts of a block (NIST 6556, table 8).
    const fn rank(&self) -> u8 {
        match self.canon {
            Canon::ProgramNumber(_) | Canon::Comment(_) => 0,
            Canon::FeedRate(_) => 1,
            Canon::SpindleSpeed(_) => 2,
            Canon::SelectTool(_) => 3,
            Canon::OtherM(_) => 4,
            Canon::ChangeTool(_) => 5,
            Canon::Spindle(_) => 6,
            Canon::Coolant(_) => 7,
            Canon::Dwell(_) => 8,
            Canon::Plane(_) => 9,
            Canon::Units(_) => 10,
            Canon::Compensation { .. } => 11,
            Canon::ToolLength(_) => 12,
            Canon::WorkOffset(_) => 13,
            Canon::PathControl(_) => 14,
            // Distance modes come here; they are no events.
            Canon::Traverse { .. }
            | Canon::Feed { .. }
            | Canon::Arc { .. }
            | Canon::MachineMove { .. }
            | Canon::Reference { .. } => 16,
            _ => 17,
        }
    }
}

/// Rank of the distance modes.
const DISTANCE_RANK: u8 = 15;

/// The state of the text: running number, place, modes that the events do not carry.
struct Printer<'a, W> {
    program: &'a [u8],
    options: &'a CanonOptions,
    out: &'a mut W,
    number: u32,
    label: String,
    at: [i64; 3],
    offset: [i64; 3],
    units: Units,
    tool: u32,
    incremental: bool,
    absolute_centres: bool,
    motion: Option<Motion>,
    coolant: [bool; 2],
    work_offset: u16,
}

impl<'a, W: Write> Printer<'a, W> {
    fn new(program: &'a [u8], options: &'a CanonOptions, out: &'a mut W) -> Self {
        Self {
            program,
            options,
            out,
            number: 0,
            label: String::new(),
            at: [0; 3],
            offset: [0; 3],
            units: Units::Millimetres,
            tool: 0,
            incremental: false,
            absolute_centres: false,
            motion: None,
            coolant: [false; 2],
            work_offset: 1,
        }
    }

    fn print(mut self, events: &[Step], summary: ProgramSummary) -> io::Result<ProgramSummary> {
        self.reset_label();
        for call in [
            "USE_LENGTH_UNITS(CANON_UNITS_MM)",
            "SET_G5X_OFFSET(1, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
            "SET_G92_OFFSET(0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
            "SET_XY_ROTATION(0.0000)",
            "SET_FEED_REFERENCE(CANON_XYZ)",
            "ON_RESET()",
        ] {
            self.call(call)?;
        }
        let mut rest = events;
        for line in Lines::new(self.program).take_while(|l| l.number <= summary.lines) {
            let count = rest.iter().take_while(|step| step.line == line.number).count();
            let (here, after) = rest.split_at(count);
            rest = after;
            self.block(line, here)?;
        }
        self.out.flush()?;
        Ok(summary)
    }

    fn block(&mut self, line: Line<'_>, steps: &[Step]) -> io::Result<()> {
        let codes = block::Codes::of(line, self.program);
        // A skipped block has no events.
        if steps.is_empty() && (codes.block_delete && self.options.skip_block_delete) {
            return Ok(());
        }
        self.set_label(codes.number.as_deref());
        let mut steps = steps.to_vec();
        steps.sort_by_key(Step::rank);
        // Of several comments the reference shows the last one, and none beside the program's name.
        let named = steps.iter().any(|s| matches!(s.canon, Canon::ProgramNumber(_)));
        let last_comment = steps.iter().rposition(|s| matches!(s.canon, Canon::Comment(_))).filter(|_| !named);
        let split = steps.partition_point(|s| s.rank() < DISTANCE_RANK);
        let remarks = steps.partition_point(|s| s.rank() == 0);
        for (index, step) in steps[..split].iter().enumerate() {
            if index == remarks && codes.feed_per_minute {
                self.feed_per_minute()?;
            }
            if !matches!(step.canon, Canon::Comment(_)) || Some(index) == last_comment {
                self.step(step)?;
            }
        }
        if remarks == split && codes.feed_per_minute {
            self.feed_per_minute()?;
        }
        self.distance_modes(&codes)?;
        let moves = steps[split..].iter().any(|s| s.rank() == 16);
        if let Some(motion) = codes.motion {
            self.motion = Some(motion);
            if !moves && matches!(motion, Motion::Traverse | Motion::Feed) {
                self.straight(motion == Motion::Traverse)?;
            }
        }
        steps[split..].iter().try_for_each(|step| self.step(step))
    }

    fn feed_per_minute(&mut self) -> io::Result<()> {
        self.call("COMMENT(\"interpreter: feed mode set to units per minute\")")?;
        self.call("SET_FEED_MODE(0, 0)")?;
        self.call("SET_FEED_RATE(0.0000)")
    }

    fn distance_modes(&mut self, codes: &block::Codes) -> io::Result<()> {
        if let Some(incremental) = codes.incremental
            && incremental != std::mem::replace(&mut self.incremental, incremental)
        {
            let mode = if incremental { "incremental" } else { "absolute" };
            self.call(&format!("COMMENT(\"interpreter: distance mode changed to {mode}\")"))?;
        }
        if let Some(absolute) = codes.absolute_centres
            && absolute != std::mem::replace(&mut self.absolute_centres, absolute)
        {
            let mode = if absolute { "absolute" } else { "incremental" };
            self.call(&format!("COMMENT(\"interpreter: IJK distance mode changed to {mode}\")"))?;
        }
        if codes.cancels_motion {
            self.call("COMMENT(\"interpreter: motion mode set to none\")")?;
        }
        Ok(())
    }

    fn set_label(&mut self, number: Option<&str>) {
        match number {
            Some(number) => self.label = format!("N{number}"),
            None => self.reset_label(),
        }
    }
    fn reset_label(&mut self) {
        self.label = "N.....".to_owned();
    }

    fn call(&mut self, text: &str) -> io::Result<()> {
        self.number += 1;
        writeln!(self.out, "{:5} {:<6} {text}", self.number, self.label)
    }

    /// A length in the program's unit.
    fn length(&self, nm: i64) -> String {
        decimal(nm as f64 / self.units.nanometres() as f64)
    }

    fn straight(&mut self, rapid: bool) -> io::Result<()> {
        let name = if rapid { "STRAIGHT_TRAVERSE" } else { "STRAIGHT_FEED" };
        let [x, y, z] = self.at.map(|nm| self.length(nm));
        self.call(&format!("{name}({x}, {y}, {z}, 0.0000, 0.0000, 0.0000)"))
    }
}

/// Four decimals, no minus sign before a zero.
fn decimal(value: f64) -> String {
    let text = format!("{value:.4}");
    if text == "-0.0000" { "0.0000".to_owned() } else { text }
}
