//! The runout of a cutter: stated, from a file of measured forces, or none.

use std::path::Path;

use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::{InputError, Source};
use truepath_job::job::JobFile;

/// A job with more keys in `[tool]`, beside the files of `tests/runout`.
fn job(keys: &str) -> Result<JobFile, InputError> {
    let text = format!(
        "version = 1\nprogram = \"p.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.5\n[tool]\ndiameter_mm = 10\nteeth = 4\nhelix_deg = 30\n\
         {keys}\n[cut]\naxial_depth_mm = 5\n"
    );
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/runout"));
    JobFile::parse(Source::new("job.toml", text.into_bytes()), folder)
}

#[test]
fn a_runout_is_stated_or_measured_and_otherwise_nothing() {
    let read = |keys: &str| {
        let tool = job(keys).unwrap_or_else(|error| panic!("{keys}: {error}")).numbers.tool;
        (tool.runout.nm(), tool.runout_deg)
    };
    assert_eq!(read(""), (0, Real::ZERO));
    assert_eq!(read("runout_mm = 0.008"), (8_000, Real::ZERO));
    assert_eq!(read("runout_mm = 0.008\nrunout_deg = 22.5"), (8_000, Real::ratio(225, 10)));
    assert_eq!(read("runout_in = 0.0005"), (12_700, Real::ZERO));
    assert_eq!(read("runout_from = \"forces.toml\""), (6_310, Real::ratio(1725, 100)));
    assert_eq!(job("runout_mm = 0.2").unwrap().numbers.tool.runout, Offset::from_um(200));
}

#[test]
fn a_runout_that_cannot_be_is_refused_with_what_to_do() {
    for (keys, code, said) in [
        ("runout_mm = 0.21", "J006", "0.2"),
        ("runout_mm = -0.01", "J006", "0"),
        ("runout_mm = 0.01\nrunout_deg = 361", "J006", "360"),
        ("runout_deg = 10", "J008", "runout_mm"),
        ("runout_mm = 0.01\nrunout_from = \"forces.toml\"", "J008", "runout_from"),
        ("runout_from = \"none.toml\"", "J001", "truepath forces"),
        ("runout_from = \"true.toml\"", "J004", "offset_mm"),
    ] {
        let refused = job(keys).expect_err(keys);
        let text = refused.to_json().to_string();
        assert_eq!(refused.code(), code, "{keys}: {text}");
        assert!(text.contains(said), "{keys}: {text}");
    }
}
