//! Any bytes as a probe file of any format: refused with its place, or contacts on the wall of a real part. The first
//! byte chooses the format.
#![no_main]

use std::path::Path;
use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use truepath_ground::diagnostics::Source;
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

const FORMATS: [&str; 6] = ["linuxcnc", "linuxcnc-log", "grbl", "inspection", "dprnt", "columns"];

/// The corner of the demonstration, once for every format.
fn passes() -> &'static [Pass] {
    static PASSES: OnceLock<Vec<Pass>> = OnceLock::new();
    PASSES.get_or_init(|| {
        let job = include_str!("../../host-sim/demo/corner/job.toml");
        let program = include_bytes!("../../host-sim/demo/corner/program.nc");
        let pass = |format: &&str| {
            let text = job.replace("format = \"linuxcnc\"", &format!("format = \"{format}\""));
            let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new("")).expect("a job");
            Pass::new(job, Source::new("program.nc", program.to_vec())).expect("a pass")
        };
        FORMATS.iter().map(pass).collect()
    })
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, text)) = bytes.split_first() else { return };
    let passes = passes();
    let pass = &passes[usize::from(choice) % passes.len()];
    if let Ok(measurement) = Measurement::read(pass, &Source::new("probe.txt", text.to_vec())) {
        let length = pass.core.contour.length;
        assert!(!measurement.contacts.is_empty() && measurement.contacts.iter().all(|c| c.s <= length));
    }
});
