//! The command line: arguments, dispatch, exit codes.
//!
//! Data goes to standard output or to the files named by `-o`, talk to standard error. Exit codes: 0 done, 1 the input
//! is wrong (command line included), 2 a fault of the program. `--json` makes both streams readable for machines.

mod bore;
mod bore_text;
mod canon;
mod compare;
mod correct;
mod demo;
mod device;
mod hil;
mod image;
mod inspect;
mod learn;
mod monitor;
mod multiaxis;
mod placement;
mod plot;
mod pocket;
mod probe;
mod probe_flags;
mod replay;
mod simulate;
mod split;
mod study;
mod terminal;
mod which;

use std::ffi::OsString;
use std::io::{BufWriter, IsTerminal, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError, visible_lines};
use truepath_ground::interruption;

pub use terminal::{Progress, Terminal};

/// Cut contours as if machine and cutter were rigid.
///
/// Mill once, touch the wall in a few places, and get the program or the correction image that cancels the deflection.
#[derive(Debug, Parser)]
#[command(
    name = "truepath",
    version,
    propagate_version = true,
    subcommand_required = true,
    arg_required_else_help = true
)]
struct Arguments {
    /// Print results, warnings and errors as JSON.
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The whole story: parts are milled, probed, corrected and milled again on a virtual machine.
    Demo(demo::Arguments),
    /// One pass as the model predicts it, or as a virtual machine cuts it.
    Simulate(simulate::Arguments),
    /// The program with which a control touches a milled wall where that tells most.
    Probe(probe::Arguments),
    /// How accurate a milled wall is, from probe points alone.
    Inspect(inspect::Arguments),
    /// What every law of correction leaves on the same machine, in one table.
    Compare(compare::Arguments),
    /// From a probe file to the corrected program or the image for the coprocessor.
    Correct(correct::Arguments),
    /// From the probe file of a corrected part to the correction of the next one.
    Learn(learn::Arguments),
    /// For a single part: a program that cuts half of the allowance, to be probed before the second half.
    Split(split::Arguments),
    /// A whole pocket, finishing pass or slot, compensated from tool and material data alone, section by section.
    Pocket(pocket::Arguments),
    /// Pictures (SVG, PNG) of what the commands wrote: traces, correction, wall to scale, laws compared.
    Plot(plot::Arguments),
    /// How well the method does on virtual machines of all kinds, and where it stops working.
    Study(study::Arguments),
    /// The chord error of a five-axis program, and a program in which locations are inserted against it.
    Multiaxis(multiaxis::Arguments),
    /// Recorded setpoints through the device's own code.
    Replay(replay::Arguments),
    /// A correction image as text.
    Image(image::Arguments),
    /// A board under setpoints and faults, every answer compared with the host's own code.
    Hil(hil::Arguments),
    /// A coprocessor over its configuration link.
    Device(device::Arguments),
    /// Waviness, roughness and roundness of a bore milled by a circling cutter.
    Bore(bore::Arguments),
    /// Canonical moves of a program, in the text format of LinuxCNC's `rs274 -g`.
    Canon(canon::Arguments),
}

/// Runs the program.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let json = arguments.iter().any(|a| a == "--json");
    let terminal = Terminal::new(json);
    // Where signals cannot be waited for they end the process as ever, and temporary files stay.
    let _ = interruption::listen();
    let outcome = match Arguments::try_parse_from(&arguments) {
        Ok(arguments) => guarded(|| dispatch(arguments.command, &terminal)),
        Err(error) if error.use_stderr() => Err(usage_error(&error, json)),
        Err(help) => {
            // Help and version are asked for: data, on standard output.
            let printed = help.print().map_err(|e| Failure::Internal(e.to_string()));
            return ExitCode::from(printed.map_or_else(|failure| terminal.fail(&failure), |()| 0));
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => ExitCode::from(terminal.fail(&failure)),
    }
}

fn dispatch(command: Command, terminal: &Terminal) -> Result<(), Failure> {
    match command {
        Command::Demo(arguments) => demo::run(&arguments, terminal),
        Command::Simulate(arguments) => simulate::run(&arguments, terminal),
        Command::Probe(arguments) => probe::run(&arguments, terminal),
        Command::Inspect(arguments) => inspect::run(&arguments, terminal),
        Command::Compare(arguments) => compare::run(&arguments, terminal),
        Command::Correct(arguments) => correct::run(&arguments, terminal),
        Command::Learn(arguments) => learn::run(&arguments, terminal),
        Command::Split(arguments) => split::run(&arguments, terminal),
        Command::Pocket(arguments) => pocket::run(&arguments, terminal),
        Command::Plot(arguments) => plot::run(arguments, terminal),
        Command::Study(arguments) => study::run(&arguments, terminal),
        Command::Multiaxis(arguments) => multiaxis::run(&arguments, terminal),
        Command::Replay(arguments) => replay::run(&arguments, terminal),
        Command::Image(arguments) => image::run(&arguments, terminal),
        Command::Hil(arguments) => hil::run(&arguments, terminal),
        Command::Device(arguments) => device::run(&arguments, terminal),
        Command::Bore(arguments) => bore::run(&arguments, terminal),
        Command::Canon(arguments) => canon::run(&arguments, terminal),
    }
}

/// Turns a panic into an internal error, so that it is reported as one.
fn guarded(work: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        Err(Failure::Internal(text.unwrap_or("a panic without a message").to_owned()))
    })
}

/// A wrong command line. For people clap's own text is the better one.
fn usage_error(error: &clap::Error, json: bool) -> Failure {
    let text = error.render().to_string();
    if !json {
        return Failure::Usage(text);
    }
    let first = text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned();
    InputError::new(C001, first, "a command line as shown by truepath --help", "run truepath --help").into()
}

/// What a command says, for people or as JSON.
fn print(text: &[u8]) -> Result<(), Failure> {
    write_out(visible_lines(&String::from_utf8_lossy(text)).as_bytes())
}

/// Data byte for byte, unless a person looks on.
fn print_data(text: &[u8]) -> Result<(), Failure> {
    if std::io::stdout().is_terminal() { print(text) } else { write_out(text) }
}

/// Standard output that was closed early (`| head`) is not an error.
fn write_out(text: &[u8]) -> Result<(), Failure> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::Internal(error.to_string())),
        _ => Ok(()),
    }
}
