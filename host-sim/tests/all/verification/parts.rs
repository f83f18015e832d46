//! The parts that verification programs are planned for.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{LazyLock, Mutex};

use truepath_correction::verification::{Plan, Settings, plan};
use truepath_ground::diagnostics::Source;
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;

pub const CORNER: [&str; 2] =
    [include_str!("../../../demo/corner/job.toml"), include_str!("../../../demo/corner/program.nc")];
pub const HELIX: [&str; 2] =
    [include_str!("../../../demo/corner-helix/job.toml"), include_str!("../../../demo/corner-helix/program.nc")];
pub const POCKET: [&str; 2] =
    [include_str!("../../../demo/pocket/job.toml"), include_str!("../../../demo/pocket/program.nc")];
pub const PARTS: [[&str; 2]; 3] = [CORNER, HELIX, POCKET];

/// A part's pass with changes to job and program: `(text, replacement)`.
pub fn pass([job, program]: [&str; 2], changes: &[(&str, &str)]) -> Pass {
    let (mut job, mut program) = (job.to_owned(), program.to_owned());
    for (from, to) in changes {
        assert!(job.contains(from) || program.contains(from), "neither job nor program holds `{from}`");
        job = job.replace(from, to);
        program = program.replace(from, to);
    }
    let job = JobFile::parse(Source::new("job.toml", job.into_bytes()), Path::new("")).unwrap();
    Pass::new(job, Source::new("program.nc", program.into_bytes())).unwrap()
}

/// The plan of a pass. Those with the usual settings are made once.
pub fn planned(pass: &Pass, settings: &Settings) -> Plan {
    static USUAL: LazyLock<Mutex<HashMap<[Vec<u8>; 2], Plan>>> = LazyLock::new(Mutex::default);
    let planned = || plan(pass, settings, &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    if *settings != Settings::default() {
        return planned();
    }
    let key = [pass.job.source().bytes().to_vec(), pass.program.bytes().to_vec()];
    let known = USUAL.lock().unwrap().get(&key).cloned();
    known.unwrap_or_else(|| {
        let plan = planned();
        USUAL.lock().unwrap().insert(key, plan.clone());
        plan
    })
}

/// The pocket with every length in inches: G20, coordinates divided by 25.4 to six decimals.
pub fn pocket_in_inches() -> [String; 2] {
    let lines = POCKET[1].lines().map(|line| {
        if line.starts_with('O') || line.starts_with('T') || line.starts_with('S') {
            return line.to_owned();
        }
        let words = line.split(' ').map(|word| match word.split_at_checked(1) {
            Some((letter @ ("X" | "Y" | "Z" | "I" | "J" | "F"), number)) => {
                format!("{letter}{:.6}", number.parse::<f64>().unwrap() / 25.4)
            }
            _ => word.replace("G21", "G20"),
        });
        words.collect::<Vec<_>>().join(" ")
    });
    [POCKET[0].to_owned(), lines.collect::<Vec<_>>().join("\n")]
}
