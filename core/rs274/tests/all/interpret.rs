//! One way into the interpreter for all tests. It is generic over who takes the steps: a copy of it for each test, optimised,
//! made these tests the slowest of the repository to build.

use truepath_rs274::{Event, GcodeError, GcodeErrorKind, Interpreter, Memory, Options, Program, ProgramSummary};

/// As [`Interpreter::run`].
pub fn interpret<'p>(
    options: Options<'p>,
    program: impl Into<Program<'p>>,
    memory: &mut Memory<'_>,
    mut sink: &mut dyn FnMut(&Event<'_>) -> Result<(), GcodeErrorKind>,
) -> Result<ProgramSummary, GcodeError> {
    Interpreter::new(options).run(program.into(), memory, &mut sink)
}
