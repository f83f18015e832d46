//! Blocks → canonical moves: the modal interpreter.
//!
//! One block at a time, in the order of execution of RS274/NGC (NIST 6556 table 8), not in the order of the text; the
//! one difference is that a unit code acts before the F of its own block, as Fanuc, Haas and grbl do (with a
//! warning). Every word must be used by some code of its block; anything else is an error with its place.
//!
//! Positions are what the program says, in its own coordinates: at the start, and after whatever moves an axis to a
//! place that the program does not name (G28, G53, a new offset, a tool change), they are unknown and stay so until
//! given in G90. With a [`Machine`](super::Machine) in the options they are all known.
//!
//! Limits: lathe codes are refused by name, and so are scaling (G51), rotation by G68, polar coordinates of Fanuc (G16)
//! and modal macros (G66).

use super::compensation::CompensationStage;
use super::corner::CornerStage;
use super::execute::Execution;
use super::flow::{Next, Reader, Sentence};
use super::{GcodeError, Line, Memory, Options, Program, Sink, Source, WarningKind, Warnings, Word};

/// A block that was executed.
#[derive(Clone, Copy, Debug)]
pub struct Executed<'a> {
    /// Where it stands.
    pub source: Source,
    /// Its line.
    pub line: Line<'a>,
    /// Its words but for the N word, with the values of parameters and expressions, in the order of the text.
    pub words: &'a [Word],
    /// Whether it steers the program: a call, a return, a jump.
    pub steers: bool,
}

/// What is known of a program after it was read to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramSummary {
    /// O word.
    pub number: Option<u32>,
    /// The M code that ended it, 2 or 30.
    pub end: Option<u32>,
    /// Lines read, to the end of the program.
    pub lines: u32,
    /// What deserves a look.
    pub warnings: Warnings,
}

/// Reads programs as a machine would.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interpreter<'t> {
    options: Options<'t>,
}

impl<'t> Interpreter<'t> {
    /// With what the program does not say.
    pub const fn new(options: Options<'t>) -> Self {
        Self { options }
    }

    /// Executes a program from its first block to M2, M30 or the last line, and gives each step to `sink`. The
    /// parameters begin as `memory` holds them, and stay there.
    ///
    /// # Errors
    /// The first thing that is not understood, or what `sink` answers, with the place of the block.
    pub fn run<'p>(
        &self,
        program: impl Into<Program<'p>>,
        memory: &mut Memory<'_>,
        sink: &mut Sink<'_>,
    ) -> Result<ProgramSummary, GcodeError>
    where
        't: 'p,
    {
        self.execute(program.into(), memory, sink, None)
    }

    /// The same as [`Self::run`]; every block that is executed is given to `observe`. Statements of control flow and lines that only assign
    /// parameters are none.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_observed<'p>(
        &self,
        program: Program<'p>,
        memory: &mut Memory<'_>,
        sink: &mut Sink<'_>,
        observe: &mut dyn FnMut(&Executed<'_>),
    ) -> Result<ProgramSummary, GcodeError>
    where
        't: 'p,
    {
        self.execute(program, memory, sink, Some(observe))
    }

    fn execute<'p>(
        &self,
        program: Program<'p>,
        memory: &mut Memory<'_>,
        sink: &mut Sink<'_>,
        mut observe: Option<&mut dyn FnMut(&Executed<'_>)>,
    ) -> Result<ProgramSummary, GcodeError>
    where
        't: 'p,
    {
        memory.start(self.options.dialect);
        let mut reader = Reader::new(program, &self.options);
        let mut warnings = Warnings::default();
        reader.frame().warn(&mut warnings);
        let mut sentence = Sentence::new(program.text);
        // Large, and lent so that they are never moved: the stack of a board has room for one of each. Made one by one, as a pair of
        // them is made elsewhere and copied.
        let mut corner = CornerStage::default();
        let mut compensation = CompensationStage::default();
        let stages = (&mut corner, &mut compensation);
        let mut execution = Execution::new(self.options, memory, stages, warnings, sink);
        while reader.next(&mut execution, &mut sentence)? {
            let next = execution.sentence(&sentence)?;
            if let Some(observe) = &mut observe {
                observe(&Executed {
                    source: sentence.source,
                    line: sentence.line,
                    words: &sentence.words,
                    steers: !matches!(next, Next::Continue | Next::End),
                });
            }
            if next != Next::Continue {
                reader.follow(next, &sentence, &mut execution)?;
            }
        }
        if execution.end.is_none() {
            execution.stop_compensation(sentence.line.span())?;
            if !execution.repeats {
                execution.warn_at(WarningKind::EndMissing, &sentence.line, sentence.line.span());
            }
        } else if let Some(line) = reader.text_after_end() {
            execution.warn_at(WarningKind::TextAfterEnd, &line, line.span());
        }
        Ok(ProgramSummary {
            number: execution.program_number,
            end: execution.end,
            lines: sentence.source.line,
            warnings: execution.warnings,
        })
    }
}
