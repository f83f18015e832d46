//! The machine while it executes a program: modes and positions, and the blocks that change them.
//!
//! | file | what |
//! |---|---|
//! | `modes.rs` | the codes of a block in their order of execution |
//! | `rates.rs`, `switches.rs`, `tool.rs`, `saved.rs`, `call.rs` | F and S, M codes, tools, M70 … M73, calls |
//! | `origin.rs`, `stored.rs` | work offsets, G92, G52, G10; the parameters that keep them |
//! | `axes.rs` | axis words → places |
//! | `motion.rs` | which code moves |
//! | `plain.rs` | the commonest blocks, without a look at all codes |
//! | `circle.rs`, `arc.rs` | arcs in the three planes, and where their centres lie |
//! | `corner.rs`, `compensate.rs` | `,R` and `,C`; G40 … G42 |
//! | `home.rs`, `probe.rs` | G28, G30, G53; probing and tapping |
//! | `cycle.rs`, `cycle_words.rs` | canned cycles |
//! | `curve.rs`, `spline.rs` | splines, and their flattening |
//! | `memory.rs` | what codes remember from block to block |
//! | `klartext/` | conversational blocks |
//! | `readout.rs` | parameters that follow the machine |

mod arc;
mod axes;
mod call;
mod circle;
mod compensate;
mod corner;
mod curve;
mod cycle;
mod cycle_words;
mod home;
#[cfg(feature = "klartext")]
mod klartext;
#[cfg(feature = "klartext")]
mod klartext_memory;
mod memory;
mod modes;
mod motion;
mod origin;
mod plain;
mod probe;
mod rates;
mod readout;
mod saved;
mod spline;
mod stored;
mod switches;
mod tool;

use super::block::BlockWords;
use super::compensation::CompensationStage;
use super::corner::CornerStage;
use super::flow::{Next, Sentence};
use super::parameter::Surroundings;
use super::{
    ArcCentres, Axes, Canon, Comment, CommentKind, Event, GcodeError, GcodeErrorKind, Line, Memory, Modal, Motion,
    Options, PointlessLength, Sink, Source, Span, Token, Tool, WarningKind, Warnings, Words,
};

use memory::{CHANGED_TOOLS, CycleMemory, LEVELS, SavedModes, SplineMemory};

use truepath_units::Position;

/// The machine.
pub(super) struct Execution<'p, 's, 'm> {
    pub(super) options: Options<'p>,
    pub(super) modal: Modal,
    pub(super) at: Axes,
    pub(super) units_given: bool,
    /// Whether it matters that a length has no point.
    reads_points: bool,
    /// Whether M99 has ended the main program.
    pub(super) repeats: bool,
    pub(super) program_number: Option<u32>,
    pub(super) end: Option<u32>,
    pub(super) warnings: Warnings,
    corner: &'s mut CornerStage<'p>,
    compensation: &'s mut CompensationStage<'p>,
    memory: &'s mut Memory<'m>,
    text: &'p [u8],
    line: Line<'p>,
    source: Source,
    /// Away only while an event is given to it.
    sink: Option<&'s mut Sink<'s>>,
    /// Whether the present block gives F.
    feed_given: bool,
    cycle: Option<CycleMemory>,
    /// G0 or G1, with which axis words go on behind G80 in dialects that have it so.
    before_cycle: Option<Motion>,
    /// What is known of the centres of arcs beside `modal.absolute_centres`.
    centres: ArcCentres,
    /// The line that is being read.
    reading: u32,
    /// Whether mist and flood are on.
    coolant: (bool, bool),
    /// Where the third axis stood before the first of the cycles that follow each other.
    initial_level: Option<Position>,
    splines: SplineMemory,
    changed_tools: heapless::Vec<Tool, CHANGED_TOOLS>,
    saved: [Option<SavedModes>; LEVELS],
    /// Modes that come back before the next block.
    returning: Option<SavedModes>,
    #[cfg(feature = "klartext")]
    klartext: klartext_memory::KlartextMemory<'p>,
}

impl Surroundings for Execution<'_, '_, '_> {
    fn change<R>(&mut self, how: impl FnOnce(&mut Memory<'_>) -> R) -> R {
        how(self.memory)
    }
    fn reading(&mut self, line: u32) {
        self.reading = line;
    }
    fn level_ended(&mut self, level: u8) {
        self.modes_of_level(level);
    }
}

impl<'p, 's, 'm> Execution<'p, 's, 'm> {
    /// The machine at the start of a program.
    pub(super) fn new(
        options: Options<'p>,
        memory: &'s mut Memory<'m>,
        (corner, compensation): (&'s mut CornerStage<'p>, &'s mut CompensationStage<'p>),
        warnings: Warnings,
        sink: &'s mut Sink<'s>,
    ) -> Self {
        let mut execution = Self {
            options,
            modal: Modal::initial(options.units),
            at: options.start,
            units_given: false,
            reads_points: options.dialect.has_macro_b() || options.decimal == PointlessLength::Least,
            repeats: false,
            program_number: None,
            end: None,
            warnings,
            corner,
            compensation,
            memory,
            text: &[],
            line: Line { number: 1, start: 0, text: &[] },
            source: Source::NONE,
            sink: Some(sink),
            feed_given: false,
            cycle: None,
            before_cycle: None,
            centres: options.arc_centres,
            reading: 1,
            coolant: (false, false),
            initial_level: None,
            splines: SplineMemory::default(),
            changed_tools: heapless::Vec::new(),
            saved: [None; LEVELS],
            returning: None,
            #[cfg(feature = "klartext")]
            klartext: klartext_memory::KlartextMemory::default(),
        };
        execution.modal.absolute_centres = options.arc_centres == ArcCentres::Absolute;
        #[cfg(feature = "klartext")]
        if options.dialect.is_klartext() {
            // Poles are places.
            execution.modal.absolute_centres = true;
            execution.centres = ArcCentres::Absolute;
        }
        execution.load_machine();
        execution
    }

    /// Executes a block; tells where the program goes on.
    pub(super) fn sentence(&mut self, sentence: &Sentence<'p>) -> Result<Next, GcodeError> {
        self.text = sentence.text;
        self.line = sentence.line;
        self.source = sentence.source;
        if self.plain_block(sentence)? {
            return Ok(Next::Continue);
        }
        if !sentence.is_plain && sentence.line.text.contains(&b'\r') {
            self.warn(WarningKind::ReturnInLine, sentence.line.span());
        }
        #[cfg(feature = "klartext")]
        if self.options.dialect.is_klartext() {
            return self.klartext(sentence);
        }
        self.restore_returning()?;
        let mut block = BlockWords::of(&sentence.words);
        block.gather(sentence, self.options.dialect)?;
        if sentence.has_comments {
            self.comments()?;
        }
        if let Some(span) = sentence.block_delete {
            if self.options.skip_block_delete {
                self.warn(WarningKind::BlockDeleteSkipped, span);
                return Ok(Next::Continue);
            }
            self.warn(WarningKind::BlockDeleteExecuted, span);
        }
        self.execute(&mut block)
    }

    /// Of several comments in a block only the last one speaks, as in LinuxCNC.
    fn comments(&mut self) -> Result<(), GcodeError> {
        let mut last = None;
        for token in Words::new(self.line) {
            let Token::Comment { span, body } = token? else { continue };
            // Behind a semicolon.
            if body.end() == span.end() {
                if let Some((span, body)) = last.take() {
                    self.emit(Canon::Comment(body), span)?;
                }
                self.emit(Canon::Comment(body), span)?;
                continue;
            }
            if body.of(self.text).contains(&b'(') {
                self.warn(WarningKind::CommentInComment, span);
            }
            if let Some((span, body)) = last.replace((span, body))
                && Comment::of(body.of(self.text)).kind == CommentKind::Plain
            {
                self.emit(Canon::Comment(body), span)?;
            }
        }
        match last {
            Some((span, body)) => self.emit(Canon::Comment(body), span),
            None => Ok(()),
        }
    }

    /// Gives one step to the sink; what it answers is an error at `span`.
    pub(super) fn emit(&mut self, canon: Canon, span: Span) -> Result<(), GcodeError> {
        if self.corner.is_waiting() {
            return self.behind_corner(canon, span);
        }
        self.emit_on(canon, span)
    }

    /// Gives one step on, behind the corners.
    fn emit_on(&mut self, canon: Canon, span: Span) -> Result<(), GcodeError> {
        if !self.compensation.is_idle() {
            return self.compensate(canon, span);
        }
        self.show(&canon, span)
    }

    /// Gives the step of a move, which seldom has to wait.
    #[inline]
    fn emit_move(&mut self, canon: Canon, span: Span) -> Result<(), GcodeError> {
        if self.corner.is_waiting() || !self.compensation.is_idle() {
            self.emit(canon, span)
        } else {
            self.show(&canon, span)
        }
    }

    /// Gives one step to the sink now.
    fn show(&mut self, canon: &Canon, span: Span) -> Result<(), GcodeError> {
        let Some(sink) = self.sink.take() else {
            return Ok(());
        };
        let event = Event { canon, source: self.source, modal: &self.modal, text: self.text, parameters: self };
        let answer = sink(&event);
        self.sink = Some(sink);
        answer.map_err(|kind| self.error(kind, span))
    }

    pub(super) fn error(&self, kind: GcodeErrorKind, span: Span) -> GcodeError {
        GcodeError::new(kind, &self.line, span).in_file(self.source.file)
    }

    pub(super) fn warn(&mut self, kind: WarningKind, span: Span) {
        let line = self.line;
        self.warn_at(kind, &line, span);
    }

    /// Notes something about another line than the present one.
    pub(super) fn warn_at(&mut self, kind: WarningKind, line: &Line<'_>, span: Span) {
        self.warnings.note_in(self.source.file, kind, line, span);
    }

    /// The bytes of the block without the blanks around them.
    pub(super) fn block_span(&self) -> Span {
        let text = self.line.text;
        let is_blank = |byte: Option<&u8>| byte.is_none_or(u8::is_ascii_whitespace);
        if !is_blank(text.first()) && !is_blank(text.last()) && !self.options.dialect.is_klartext() {
            return self.line.span();
        }
        let mut behind = text.trim_ascii_start();
        if self.options.dialect.is_klartext() {
            // The block number is no part of it.
            let digits = behind.iter().take_while(|b| b.is_ascii_digit()).count();
            behind = behind.get(digits..).unwrap_or(&[]).trim_ascii_start();
        }
        let lead = text.len().saturating_sub(behind.len());
        Span { start: self.line.start.saturating_add(lead), len: behind.trim_ascii_end().len() }
    }
}
