//! The wall of tables without `wall.csv`, from the job whose path they are of.

use std::fs;
use std::path::Path;

use super::{plot, runs, truepath};

/// A folder of the runs without its wall.csv, in a folder of the same name.
fn without_wall(from: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join(Path::new(from).file_name().unwrap());
    fs::create_dir(&to).unwrap();
    for file in fs::read_dir(runs().join(from)).unwrap().map(Result::unwrap) {
        if file.file_name() != "wall.csv" {
            fs::copy(file.path(), to.join(file.file_name())).unwrap();
        }
    }
    folder
}

#[test]
fn a_job_stands_in_for_the_wall_of_its_tables() {
    for (from, job) in [
        ("correct", "corner-helix"),
        ("core", "corner-helix"),
        ("plant", "corner-helix"),
        ("demo/corner", "corner"),
        ("demo/pocket", "pocket"),
    ] {
        let folder = without_wall(from);
        let name = Path::new(from).file_name().unwrap().to_str().unwrap();
        let table = folder.path().join(name);
        let drawn = plot(&format!("error {} --job demo/{job}/job.toml", table.display()), "p.svg");
        assert!(drawn == plot(&format!("error {from}"), "p.svg"), "{from}: the wall lies elsewhere");
    }
}

#[test]
fn a_table_of_another_job_is_refused_with_the_place_that_differs() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &str| {
        let done = truepath(runs(), &format!("--json plot {arguments} -o {}/p.svg", folder.path().display()));
        assert_eq!(done.status.code(), Some(1), "{arguments}");
        String::from_utf8(done.stderr).unwrap()
    };
    let told = refused("error core --job demo/pocket/job.toml");
    assert!(told.contains("Z013") && told.contains("at s = 0 mm the table has X"), "{told}");
    assert!(told.contains("the path of demo/pocket/job.toml is at X"), "{told}");
    let told = refused("error demo/pocket --job demo/corner/job.toml");
    assert!(told.contains("Z013"), "{told}");
    let told = refused("error core --feature 2");
    assert!(told.contains("Z012") && told.contains("--job"), "{told}");
    let told = refused("error core --job nowhere.toml");
    assert!(told.contains("nowhere.toml"), "{told}");
}

#[test]
fn lines_over_each_other_differ_in_their_dashes_and_keep_their_peaks() {
    // A line of dashes is a thin line with strokes on it: the thin one has every point, the strokes lie on it.
    let text = String::from_utf8(plot("trace core plant --columns error", "p.svg")).unwrap();
    let widths = |colour: &str| {
        let of = |tag: &str| tag.split("stroke-width=\"").nth(1).and_then(|w| w.split('"').next()).map(str::to_owned);
        let lines =
            text.split('<').filter(|t| t.starts_with("polyline") && t.contains(&format!("stroke=\"{colour}\"")));
        let mut widths: Vec<String> = lines.filter_map(of).collect();
        widths.sort();
        widths.dedup();
        widths.len()
    };
    assert!(widths("#D55E00") > widths("#0072B2"), "the first pass has dashes, the second has none");
}
