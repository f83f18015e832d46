//! The calls of a block in the order of the reference.
//!
//! RS274/NGC executes the parts of a block in a fixed order (NIST 6556, table 8); the core keeps to it but for the
//! unit, which it reads first. So what sets modes is gathered until the first move of its block and put in order; moves
//! are printed as they come.

use std::io::{self, Write};

use truepath_core::gcode::{Canon, Event, Line, Modal, RetractLevel, Source, Span, Token, Words, WrittenWord};

use super::call::Calls;
use super::comment::Remark;
use super::options::CanonOptions;

/// What sets modes, with the modes after it.
struct Step {
    canon: Canon,
    modal: Modal,
    rank: u8,
}

/// The state of the text: what the reference knows between blocks.
pub(super) struct Printer<'a, W> {
    calls: Calls<'a, W>,
    /// The block whose calls are gathered: file, line, and how often the program had jumped.
    block: Option<(u16, u32, u32)>,
    steps: Vec<Step>,
    remark: Option<Remark>,
    /// Whether a program's name stands in the block: the reference then shows no comment.
    named: bool,
    /// Distance modes and retract level as last told.
    told: (bool, bool, RetractLevel),
    /// Whether a motion was in force, which G80 ends.
    moving: bool,
    /// Whether the block has a G80 that is still to be told.
    cancels: bool,
}

/// Rank of the distance modes, which are no events.
const DISTANCE_RANK: u8 = 18;

/// The order of the parts of a block.
const fn rank(canon: &Canon) -> u8 {
    match canon {
        Canon::ProgramNumber(_) | Canon::Comment(_) => 0,
        Canon::FeedMode(_) => 1,
        Canon::FeedRate(_) => 2,
        Canon::SpindleSpeed(_) => 3,
        Canon::SelectTool(_) => 4,
        Canon::OtherM(62..=68) => 5,
        Canon::ChangeTool(_) => 6,
        Canon::Spindle(_) => 7,
        Canon::Coolant(_) => 8,
        Canon::OtherM(_) => 9,
        Canon::Dwell(_) => 10,
        Canon::Plane(_) => 11,
        Canon::Units(_) => 12,
        Canon::Compensation { .. } => 13,
        Canon::ToolLength(_) => 14,
        Canon::WorkOffset(_) => 15,
        Canon::PathControl(_) => 16,
        Canon::Shift(_) | Canon::ToolEntry { .. } => 19,
        _ => 20,
    }
}

impl<'a, W: Write> Printer<'a, W> {
    /// With the calls by which the reference begins.
    pub(super) fn new(options: &'a CanonOptions, out: W) -> Self {
        Self {
            calls: Calls::new(options, out),
            block: None,
            steps: Vec::new(),
            remark: None,
            named: false,
            told: (true, false, RetractLevel::Clearance),
            moving: false,
            cancels: false,
        }
    }

    /// Takes one step of the program.
    pub(super) fn event(&mut self, event: &Event<'_>) {
        let source = &event.source;
        let block = (source.file, source.line, source.jumps);
        if self.block != Some(block) {
            self.end_block();
            self.block = Some(block);
            self.calls.lines.set_label(source.number.and_then(|_| label(event.text, source)));
            // Motion ends without a step of its own: perhaps in this block, perhaps in one before.
            let still = event.modal.motion.is_none();
            self.cancels = still && (self.moving || has_g(event.text, source, &[800]));
            self.moving = !still;
        }
        match event.canon {
            Canon::Comment(body) => self.comment(event, *body),
            Canon::ProgramNumber(_) => self.named = true,
            canon @ (Canon::Feed { .. } | Canon::Traverse { .. }) => {
                self.settle();
                self.tell_modes(event.modal);
                self.calls.motion(canon, event.modal);
            }
            canon => {
                // M72 brings the unit back before the feed.
                let restored = matches!(canon, Canon::Units(_)) && !has_g(event.text, source, &[200, 210, 700, 710]);
                let rank = if restored { 1 } else { rank(canon) };
                if rank < 20 {
                    self.steps.push(Step { canon: *canon, modal: *event.modal, rank });
                } else {
                    self.settle();
                    self.tell_modes(event.modal);
                    self.calls.call(canon, event.modal, Some(event));
                }
            }
        }
    }

    fn comment(&mut self, event: &Event<'_>, body: Span) {
        // What follows a semicolon is not shown by the reference, and of several comments the last one.
        if event.text.get(body.start.wrapping_sub(1)) != Some(&b';') {
            self.remark = Remark::of(body.of(event.text), event.parameters);
        }
    }

    /// Prints what was gathered of a block, in order.
    #[inline]
    fn settle(&mut self) {
        if self.remark.is_some() || !self.steps.is_empty() {
            self.print_steps();
        }
    }

    fn print_steps(&mut self) {
        match self.remark.take().filter(|_| !self.named) {
            Some(Remark::Call(name, text)) => {
                self.calls.lines.open(name);
                self.calls.lines.push("\"");
                self.calls.lines.push(&text);
                self.calls.lines.push("\"");
                self.calls.lines.close();
            }
            Some(Remark::Bare(text)) => self.calls.lines.bare(text.as_bytes()),
            None => {}
        }
        if self.steps.is_empty() {
            return;
        }
        let mut steps = std::mem::take(&mut self.steps);
        steps.sort_by_key(|step| step.rank);
        for step in &steps {
            if step.rank > DISTANCE_RANK {
                self.tell_modes(&step.modal);
            }
            self.calls.call(&step.canon, &step.modal, None);
        }
        if let Some(last) = steps.last() {
            self.tell_distance(&last.modal);
        }
        steps.clear();
        self.steps = steps;
    }

    fn end_block(&mut self) {
        self.settle();
        self.tell_cancel();
        self.named = false;
    }

    fn tell_cancel(&mut self) {
        if std::mem::take(&mut self.cancels) {
            self.calls.lines.remark("motion mode set to none");
        }
    }

    /// Comments of the reference on modes that are no events.
    fn tell_modes(&mut self, modal: &Modal) {
        self.tell_distance(modal);
        self.tell_cancel();
    }

    #[inline]
    fn tell_distance(&mut self, modal: &Modal) {
        let now = (modal.absolute, modal.absolute_centres, modal.retract);
        if now != self.told {
            self.tell_new_distance(now);
        }
    }

    fn tell_new_distance(&mut self, now: (bool, bool, RetractLevel)) {
        let name = |absolute: bool| if absolute { "absolute" } else { "incremental" };
        if now.0 != self.told.0 {
            self.calls.lines.remark(&format!("distance mode changed to {}", name(now.0)));
        }
        if now.1 != self.told.1 {
            self.calls.lines.remark(&format!("IJK distance mode changed to {}", name(now.1)));
        }
        if now.2 != self.told.2 {
            let level = if now.2 == RetractLevel::Before { "old_z" } else { "r_plane" };
            self.calls.lines.remark(&format!("retract mode set to {level}"));
        }
        self.told = now;
    }

    /// Prints what is left; `whole` when the program was read to its end.
    ///
    /// # Errors
    /// What the writer answered.
    pub(super) fn finish(mut self, whole: bool) -> io::Result<()> {
        if whole {
            self.end_block();
        }
        self.calls.lines.finish()
    }
}

/// Whether one of these G codes (in tenths) stands in a block.
fn has_g(text: &[u8], source: &Source, codes: &[i64]) -> bool {
    let line = Line { number: source.line, start: source.block.start, text: source.block.of(text) };
    Words::new(line).map_while(Result::ok).any(|token| match token {
        Token::Word(WrittenWord { letter: b'G', value: Some(value), .. }) => {
            value.exactly_times(10).is_some_and(|tenths| codes.contains(&tenths))
        }
        _ => false,
    })
}

/// The digits of the N word of a block before its point, as written.
fn label<'t>(text: &'t [u8], source: &Source) -> Option<&'t [u8]> {
    let block = source.block.of(text);
    let start = block.iter().position(|b| b.eq_ignore_ascii_case(&b'N'))? + 1;
    let rest = block.get(start..)?.trim_ascii_start();
    let end = rest.iter().position(|b| !b.is_ascii_digit()).unwrap_or(rest.len());
    rest.get(..end)
}
