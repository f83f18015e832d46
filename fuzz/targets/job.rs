//! Any text as a job file: refused with a place and a remedy, or a job whose compact form reads back as the same job.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use truepath_ground::diagnostics::Source;
use truepath_job::job::JobFile;

fuzz_target!(|bytes: &[u8]| {
    // The compact form comes over the wire.
    if let Ok(job) = truepath_core::job::Job::from_compact(bytes) {
        let mut buffer = [0; truepath_core::job::COMPACT_BYTES];
        let compact = job.to_compact(&mut buffer).expect("room for every job");
        assert_eq!(truepath_core::job::Job::from_compact(compact), Ok(job));
    }
    match JobFile::parse(Source::new("job.toml", bytes.to_vec()), Path::new("")) {
        Ok(job) => {
            let mut buffer = [0; truepath_core::job::COMPACT_BYTES];
            let compact = job.numbers.to_compact(&mut buffer).expect("room for every job");
            assert_eq!(truepath_core::job::Job::from_compact(compact), Ok(job.numbers));
        }
        Err(error) => assert!(error.code().len() == 4 && !error.found().is_empty()),
    }
});
