//! The command line: arguments, dispatch, exit codes.
//!
//! Data goes to standard output or to the files named by `-o`, talk to standard error. `--json` makes both streams readable
//! for machines, `--quiet` leaves data, warnings and errors.
//!
//! | exit code | what |
//! |---|---|
//! | 0 | done |
//! | 1 | what was given is wrong: a file, a value in it, two things that do not go together |
//! | 2 | a wrong command line, or a fault of the program |
//! | 3 | refused by judgement: points that do not fit the job (Q009), a batch that asks for action (Q011) |
//! | 128 + n | ended by signal n: 130 after Ctrl-C |

use std::ffi::OsString;

use clap::{ColorChoice, CommandFactory, FromArgMatches, Parser, Subcommand};
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::interruption;

use crate::command::{
    batch, bore, canon, compare, correct, demo, fillet, forces, image, init, inspect, learn, multiaxis, plan, plot,
    pocket, probe, replay, simulate, split,
};
#[cfg(not(target_family = "wasm"))]
use crate::command::{device, firmware, hil, key, manual, pack, publish, store, study};
use crate::help;
use crate::streams;
use crate::terminal::Terminal;

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
    /// Only data, warnings and errors: no results in words, no notes, no progress.
    #[arg(short, long, global = true)]
    quiet: bool,
    /// Colours in help and errors; `auto` on a terminal that does not set NO_COLOR.
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    color: ColorChoice,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The whole story on a virtual machine: parts milled, probed, corrected, milled again.
    Demo(demo::Options),
    /// The job of a program: reads what it says, asks the rest, writes a commented file.
    Init(init::Options),
    /// One pass as the model predicts it, or as a virtual machine cuts it.
    Simulate(simulate::Options),
    /// The program with which a control touches a milled wall where that tells most.
    Probe(probe::Options),
    /// How accurate a milled wall is, from probe points alone.
    Inspect(inspect::Options),
    /// What every law of correction leaves on the same machine, in one table.
    Compare(compare::Options),
    /// From a probe file to the corrected program or the image for the coprocessor.
    Correct(correct::Options),
    /// Which passes hold a tolerance at every height of the wall, in least time.
    Plan(plan::Options),
    /// From the probe file of a corrected part to the correction of the next one.
    Learn(learn::Options),
    /// One file of a real part's story: job, program, readings, corrections.
    #[cfg(not(target_family = "wasm"))]
    Pack(pack::Options),
    /// The files of such a story as a folder.
    #[cfg(not(target_family = "wasm"))]
    Unpack(pack::UnpackOptions),
    /// The parts of a shop in one place: machines, cutters, readings, corrections.
    #[cfg(not(target_family = "wasm"))]
    Store(store::Options),
    /// State, parts and alarms of batches to a broker of MQTT, and to agents of MTConnect.
    #[cfg(not(target_family = "wasm"))]
    Publish(publish::Options),
    /// For a single part: a program that cuts half of the allowance, to be probed then.
    Split(split::Options),
    /// Many parts of one job: what moves, control charts, capability, alarms.
    Batch(batch::Options),
    /// Small arcs on sharp inside corners, where no correction reaches.
    Fillet(fillet::Options),
    /// A pocket or slot compensated from tool and material data alone, without a probe.
    Pocket(pocket::Options),
    /// Pictures (SVG, PNG) of what the commands wrote.
    Plot(plot::Options),
    /// How well the method does on virtual machines of all kinds, and where it stops working.
    #[cfg(not(target_family = "wasm"))]
    Study(study::Options),
    /// The chord error of a five-axis program, and locations inserted against it.
    Multiaxis(multiaxis::Options),
    /// Recorded setpoints through the device's own code.
    Replay(replay::Options),
    /// A correction image as text; its signature.
    Image(image::Options),
    /// Keys that sign correction images.
    #[cfg(not(target_family = "wasm"))]
    Key(key::Options),
    /// A board under setpoints and faults, compared with the host's own code.
    #[cfg(not(target_family = "wasm"))]
    Hil(hil::Arguments),
    /// A coprocessor over its configuration link.
    #[cfg(not(target_family = "wasm"))]
    Device(device::Options),
    /// Signed updates of a coprocessor's own program.
    #[cfg(not(target_family = "wasm"))]
    Firmware(firmware::Options),
    /// Waviness, roughness and roundness of a bore milled by a circling cutter.
    Bore(bore::Options),
    /// Force coefficients from records of a dynamometer, or of the power of the spindle.
    Forces(forces::Options),
    /// Canonical moves of a program, in the text format of LinuxCNC's `rs274 -g`.
    Canon(canon::Options),
    /// What a shell needs to complete command lines, on standard output.
    #[cfg(not(target_family = "wasm"))]
    Completions(manual::CompletionsOptions),
    /// The manual pages, one of each command.
    #[cfg(not(target_family = "wasm"))]
    Man(manual::ManOptions),
}

/// Runs the program; gives its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    // A wrong command line is told as the parts of it that are right ask for.
    let json = arguments.iter().any(|a| a == "--json");
    let colour = asked_colour(&arguments);
    let terminal = Terminal::new(json, false, colour);
    // Where signals cannot be waited for they end the process as ever, and temporary files stay.
    let _ = interruption::listen();
    // Help is asked of commands that are named: the examples of the others would be made for nothing.
    let named = |name: &str| arguments.iter().any(|argument| argument == name);
    let parsed = command_with_examples(named).color(colour).try_get_matches_from(&arguments);
    let outcome = match parsed.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(Arguments { quiet, command, .. }) => {
            let terminal = Terminal::new(json, quiet, colour);
            guarded(|| dispatch(command, &terminal))
        }
        Err(error) if error.use_stderr() => Err(usage_error(&error, json)),
        Err(help) => {
            // Help and version are asked for: data, on standard output.
            #[cfg(target_family = "wasm")]
            let printed = streams::write_out(help.render().to_string().as_bytes());
            #[cfg(not(target_family = "wasm"))]
            let printed = streams::unless_closed(help.print());
            return printed.map_or_else(|failure| terminal.fail(&failure), |()| 0);
        }
    };
    match outcome {
        Ok(()) => 0,
        Err(failure) => terminal.fail(&failure),
    }
}

/// The command line with its help: commands by what one wants to do, examples below each.
pub(crate) fn command() -> clap::Command {
    command_with_examples(|_| true)
}

fn command_with_examples(wanted: impl Fn(&str) -> bool) -> clap::Command {
    let mut command = Arguments::command();
    let template = help::overview(&command);
    for (name, examples) in help::examples(wanted) {
        // Not every build has every command, and one that is not there cannot be changed.
        if command.find_subcommand(name).is_none() {
            continue;
        }
        command = command.mut_subcommand(name, |sub| sub.after_help(examples));
    }
    command.help_template(template)
}

/// The last `--color` of a command line.
fn asked_colour(arguments: &[OsString]) -> ColorChoice {
    let texts = || arguments.iter().map(|argument| argument.to_str().unwrap_or_default());
    let apart = texts().zip(texts().skip(1)).filter(|(name, _)| *name == "--color").map(|(_, value)| value);
    let joined = texts().filter_map(|argument| argument.strip_prefix("--color="));
    apart.chain(joined).last().and_then(|value| value.parse().ok()).unwrap_or_default()
}

fn dispatch(command: Command, terminal: &Terminal) -> Result<(), Failure> {
    match command {
        Command::Demo(options) => demo::main(&options, terminal),
        Command::Init(options) => init::main(&options, terminal),
        Command::Simulate(options) => simulate::main(&options, terminal),
        Command::Probe(options) => probe::main(&options, terminal),
        Command::Inspect(options) => inspect::main(&options, terminal),
        Command::Compare(options) => compare::main(&options, terminal),
        Command::Correct(options) => correct::main(&options, terminal),
        Command::Plan(options) => plan::main(&options, terminal),
        Command::Learn(options) => learn::main(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Pack(options) => pack::main(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Unpack(options) => pack::unpack(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Store(options) => store::main(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Publish(options) => publish::main(&options, terminal),
        Command::Batch(options) => batch::main(&options, terminal),
        Command::Fillet(options) => fillet::main(&options, terminal),
        Command::Split(options) => split::main(&options, terminal),
        Command::Pocket(options) => pocket::main(&options, terminal),
        Command::Plot(options) => plot::main(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Study(options) => study::main(&options, terminal),
        Command::Multiaxis(options) => multiaxis::main(&options, terminal),
        Command::Replay(options) => replay::main(&options, terminal),
        Command::Image(options) => image::main(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Key(options) => key::main(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Hil(arguments) => hil::main(&arguments, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Device(options) => device::main(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Firmware(options) => firmware::main(&options, terminal),
        Command::Bore(options) => bore::main(&options, terminal),
        Command::Forces(options) => forces::main(&options, terminal),
        Command::Canon(options) => canon::main(&options, terminal),
        #[cfg(not(target_family = "wasm"))]
        Command::Completions(options) => manual::completions(&options, self::command()),
        #[cfg(not(target_family = "wasm"))]
        Command::Man(options) => manual::pages(&options, self::command()),
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
