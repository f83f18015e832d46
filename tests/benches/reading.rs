//! How fast programs are read, in one run over the same bytes: the words alone beside the crate `gcode`, and everything
//! (modes, moves, canonical text) beside LinuxCNC's `rs274`.
//!
//! The program is 2.5 MB of what a finishing program consists of: lines, arcs, modal words, block numbers, comments,
//! always the same bytes. Each reader reads it several times; the best counts. Programs that are started (`rs274`, and
//! ours, named by the environment variable `TRUEPATH`) write their text to nowhere, and their start counts. Printed:
//! one line a reader, megabytes a second.

use std::fmt::Write as _;
use std::hint::black_box;
use std::io::Write as _;
use std::process::{Command, Stdio};
use std::time::Instant;

use truepath_core::gcode::{Axes, HostMemory, Interpreter, Lines, Options, Words};

/// How often each reader reads.
const REPEATS: usize = 7;
/// Bytes of the program.
const LENGTH: usize = 2_500_000;

/// The program.
fn program() -> String {
    let mut text = String::from(
        "%\nO1000 (finishing)\nG21 G90 G17 G40 G49 G64 P0.01\nT1 M6\nS6000 M3\nG0 X0 Y0\nZ5.\nG1 Z-2. F300\n",
    );
    let mut chance = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = |below: u64| {
        chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (chance >> 33) % below
    };
    let mut block = 10;
    while text.len() < LENGTH {
        let [x, y] = [next(2_000_000), next(2_000_000)].map(|v| v as f64 / 1e4 - 100.0);
        let written = match next(20) {
            0 => writeln!(text, "N{block} G1 X{x:.4} Y{y:.4} F{}", 200 + next(800)),
            1 => writeln!(text, "(pass {block}, step over 0.5)"),
            2 | 3 => {
                let r = 1.0 + next(9_000) as f64 / 1e3;
                writeln!(text, "X{x:.4} Y{y:.4}\nG3 X{:.4} Y{y:.4} I{r:.4} J0.\nG1 X{x:.4} Y{y:.4}", x + 2.0 * r)
            }
            4 => writeln!(text, "G1 X{x:.4} Y{y:.4} Z-{:.3}", next(5_000) as f64 / 1e3),
            _ => writeln!(text, "X{x:.4} Y{y:.4}"),
        };
        written.expect("memory");
        block += 10;
    }
    text.push_str("X0 Y0\nG0 Z50.\nM30\n%\n");
    text
}

/// Megabytes a second of the best of several readings.
fn best(bytes: usize, mut read: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..REPEATS {
        let start = Instant::now();
        read();
        least = least.min(start.elapsed().as_secs_f64());
    }
    bytes as f64 / 1e6 / least
}

/// The same for a program that is started, when there is one.
fn started(bytes: usize, command: &mut Command) -> Option<f64> {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    if !command.status().is_ok_and(|s| s.success()) {
        return None;
    }
    Some(best(bytes, || {
        black_box(command.status().expect("it was started before"));
    }))
}

fn main() {
    let text = program();
    let bytes = text.len();
    let mut rows: Vec<(&str, Option<f64>)> = Vec::new();

    let mut words = 0usize;
    let ours = best(bytes, || {
        words = Lines::new(text.as_bytes()).flat_map(Words::new).filter(|word| word.is_ok()).count();
    });
    assert!(words > bytes / 12, "{words} words");
    rows.push(("words: truepath-core", Some(ours)));
    let theirs = best(bytes, || gcode::core::parse(black_box(&text), &mut gcode::core::Noop));
    rows.push(("words: gcode 0.7", Some(theirs)));

    let mut memory = Box::new(HostMemory::new());
    let interpreter = Interpreter::new(Options { start: Axes::ORIGIN, ..Options::default() });
    let mut events = 0usize;
    let everything = best(bytes, || {
        events = 0;
        let read = interpreter.run(text.as_bytes(), &mut memory.lend(), &mut |event| {
            black_box(event);
            events += 1;
            Ok(())
        });
        read.expect("a sound program");
    });
    assert!(events > bytes / 40, "{events} steps");
    rows.push(("everything: truepath-core", Some(everything)));

    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    file.write_all(text.as_bytes()).and_then(|()| file.flush()).expect("a temporary file");
    if let Some(binary) = std::env::var_os("TRUEPATH") {
        rows.push((
            "canonical text: truepath canon",
            started(bytes, Command::new(binary).arg("canon").arg(file.path())),
        ));
    }
    rows.push(("canonical text: rs274 -g", started(bytes, Command::new("rs274").arg("-g").arg(file.path()))));

    for (name, rate) in rows {
        match rate {
            Some(rate) => println!("{name}\t{rate:.1}"),
            None => println!("{name}\tnot here"),
        }
    }
}
