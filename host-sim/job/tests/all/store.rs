//! What a job says of the shop store.

use std::path::Path;

use truepath_ground::diagnostics::Source;
use truepath_job::job::JobFile;

/// The material that the store is told of a job with some more tables.
fn material(tables: &str) -> Option<String> {
    let text = format!(
        "version = 1\nprogram = \"p.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.5\n[tool]\ndiameter_mm = 10\nteeth = 4\n\
         [cut]\naxial_depth_mm = 5\n{tables}"
    );
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new(""));
    job.unwrap_or_else(|error| panic!("{tables}: {error}")).store.names.material
}

#[test]
fn the_store_is_told_the_material_of_the_force_where_the_job_names_no_other() {
    assert_eq!(material(""), None);
    assert_eq!(material("[force]\nmaterial = \"al-7075-t6\"\n").as_deref(), Some("al-7075-t6"));
    let both = "[force]\nmaterial = \"al-7075-t6\"\n[store]\nmaterial = \"7075, supplier B\"\n";
    assert_eq!(material(both).as_deref(), Some("7075, supplier B"));
    assert_eq!(material("[force]\nmodel = \"helical\"\n[store]\nmachine = \"VF2\"\n"), None);
}
