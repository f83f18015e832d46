//! Any bytes as a five-axis program or a machine file: refused with a code, or a program whose moves keep to the
//! tolerance, so that a second pass changes nothing. The first byte chooses machine, meaning of XYZ, rule and dialect.
#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use truepath_ground::diagnostics::Source;
use truepath_multiaxis::machine::Coordinates;
use truepath_multiaxis::program::{CentrePoint, Digits, Outcome, PassError, Reading, Report, Settings, Sinks, Splitter, UnrollOptions, run, unroll};
use truepath_multiaxis::{Joints, Machine, Rule, chord_error};
use truepath_core::gcode::{Dialect, PointlessLength, Units};

/// A trunnion and a fork head.
static MACHINES: LazyLock<[Machine; 2]> = LazyLock::new(|| {
    [include_str!("../../examples/multiaxis/trunnion.toml"), include_str!("../../examples/multiaxis/fork-head.toml")]
        .map(|text| Machine::from_toml(&Source::new("machine.toml", text.into())).expect("a machine"))
});

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, text)) = bytes.split_first() else { return };
    if choice == b'#' {
        return machine(bytes);
    }
    let head = choice & 1 != 0;
    let settings = Settings {
        reading: Reading {
            dialect: if choice & 2 != 0 { Dialect::Fanuc } else { Dialect::Linuxcnc },
            decimal: PointlessLength::Calculator,
            rotary: if head { [true, true, false] } else { [true, false, true] },
            one_tool: head,
            skip_block_delete: choice & 4 != 0,
        },
        units: Units::Millimetres,
        coordinates: if choice & 8 != 0 { Coordinates::Tip } else { Coordinates::Joints },
        centre_point: CentrePoint::Ends,
        splitter: Splitter {
            machine: &MACHINES[usize::from(head)],
            tolerance: 0.01,
            rule: if choice & 16 != 0 { Rule::Midpoint } else { Rule::Fewest },
            max_pieces: 200,
            digits: Digits::default(),
        },
        normal: None,
    };
    match pass(text, &settings) {
        Some((first, written)) => {
            let (second, again) = pass(&written, &settings).expect("what is written is read");
            assert!(second.inserted == 0 && second.left.count == first.left.count && again == written);
        }
        None => {
            let options = UnrollOptions {
                dialect: settings.reading.dialect,
                decimal: settings.reading.decimal,
                units: settings.units,
                skip_block_delete: settings.reading.skip_block_delete,
            };
            let _ = unroll(&Source::new("fuzz.nc", text.to_vec()), options);
        }
    }
});

/// A pass: the report and the text; `None` when the program is refused, or steered.
fn pass(text: &[u8], settings: &Settings<'_>) -> Option<(Report, Vec<u8>)> {
    let mut out = Vec::new();
    let sinks = Sinks { text: &mut out, row: &mut |_| Ok(()), progress: &mut |_| () };
    match run(text, "fuzz.nc", settings, None, sinks) {
        Ok(Outcome::Done(report)) => Some((*report, out)),
        Ok(Outcome::Steered(_)) => None,
        Err(PassError::Input(error)) => {
            assert!(error.code().len() == 4 && error.line_column().is_some());
            None
        }
        Err(PassError::Read(error) | PassError::Write(error)) => panic!("memory cannot fail: {error}"),
    }
}

/// A machine of any file turns and comes back.
fn machine(bytes: &[u8]) {
    match Machine::from_toml(&Source::new("machine.toml", bytes.to_vec())) {
        Ok(machine) => {
            let joints = |xyz, rotary| Joints { xyz, rotary };
            let (from, to) = (joints([1.0, 2.0, 3.0], [0.1, 0.2]), joints([4.0, -5.0, 6.0], [0.3, -0.4]));
            let error = chord_error(&machine, &from, &to);
            assert!(error.exact <= error.bound && error.bound.is_finite());
        }
        Err(error) => assert!(error.code().len() == 4 && !error.found().is_empty()),
    }
}
