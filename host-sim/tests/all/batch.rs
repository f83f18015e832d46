//! `batch` on parts that a virtual machine has milled, and tables that say something else.

use std::fs;
use std::path::{Path, PathBuf};

use truepath::command::batch::{self, Options};
use truepath::command::correct;
use truepath_batch::batch::{Alarm, Cause};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_ground::length::Unit;
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_trial::virtual_mill;

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

/// Where the walls are touched, mm.
const PLACES: [f64; 8] = [12.0, 22.0, 32.0, 42.0, 47.0, 62.0, 76.0, 90.0];

/// The helical corner of the demonstration with its correction, and the touches of parts by their force and seed.
fn shop(folder: &Path, forces: &[f64]) -> Vec<String> {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("demo/corner-helix");
    for file in ["job.toml", "program.nc"] {
        fs::copy(demo.join(file), folder.join(file)).unwrap();
    }
    let plant = fs::read_to_string(demo.join("plant.toml")).unwrap();
    let machine = |force: f64, seed: usize| {
        let mut machine: truepath_plant::Machine = toml::from_str(&plant).unwrap();
        (machine.force_factor, machine.seed) = (force, seed as u64);
        machine
    };
    let pass = Pass::read(JobFile::read(&folder.join("job.toml")).unwrap()).unwrap();
    let touched =
        |milled: &truepath_plant::Milled| virtual_mill::probe(&pass, milled, &PLACES, &[0.3, 0.5, 0.7], 6.0).unwrap();
    let first = touched(&virtual_mill::mill(&pass, &machine(1.0, 1), None).unwrap());
    fs::write(folder.join("first.txt"), first).unwrap();
    let options = correct::Options {
        job: folder.join("job.toml"),
        probe: Some(folder.join("first.txt")),
        output: folder.join("out"),
        ..correct::Options::default()
    };
    shown(correct::run(&options, &mut |_| ()));
    let corrected = Source::read(&folder.join("out/corrected.nc")).unwrap();
    let mut names = Vec::new();
    for (k, force) in forces.iter().enumerate() {
        let made = virtual_mill::mill_program(&pass, &machine(*force, k + 2), corrected.bytes()).unwrap();
        let name = format!("part-{}.txt", k + 1);
        fs::write(folder.join(&name), touched(&made)).unwrap();
        names.push(name);
    }
    names
}

fn options(folder: &Path, table: &str) -> Options {
    fs::write(folder.join("parts.csv"), table).unwrap();
    Options {
        job: folder.join("job.toml"),
        parts: folder.join("parts.csv"),
        from: Some(folder.join("out")),
        output: folder.join("batch"),
        ahead: 5,
        force: true,
        ..Options::default()
    }
}

#[test]
fn a_harder_lot_is_noticed_on_its_first_part_and_a_told_one_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let forces = [1.0, 1.003, 1.006, 1.009, 1.012, 1.015, 1.018, 1.021, 1.15];
    let names = shop(folder.path(), &forces);
    let table = |event: &str| {
        let mut text = "part,probe,event\n# the first shift\n".to_owned();
        for (k, name) in names.iter().enumerate() {
            text += &format!("{},{name},{}\n", k + 1, if k == 8 { event } else { "" });
        }
        text
    };
    let report = shown(batch::run(&options(folder.path(), &table(""))));
    println!("{:?} {:?}", report.words, report.batch.states.last());
    let [Alarm::Step { part: 9, cause: Cause::ForceLevel, change }] = &report.batch.alarms[..] else {
        panic!("{:?}", report.batch.alarms)
    };
    assert!((change.value - 0.13).abs() < 0.04, "{change:?}");
    let before = &report.batch.states[7].force_level;
    assert!((before.value - 0.021).abs() < 3.0 * before.sigma, "{before:?}");
    let told = shown(batch::run(&options(folder.path(), &table("lot"))));
    assert!(told.batch.alarms.is_empty(), "{:?}", told.batch.alarms);
    let page = fs::read_to_string(folder.path().join("batch/batch.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.matches("<svg").count() == 2 && page.contains("new lot"));
    assert!(page.contains("<title>Force level, radius and datum over the parts</title>"));
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("batch/summary.json")).unwrap()).unwrap();
    assert_eq!((summary["touched"].as_u64(), summary["states"].as_array().map(Vec::len)), (Some(9), Some(9)));
    // What is published of it is what was written.
    let stepped = shown(batch::run(&options(folder.path(), &table(""))));
    let file = folder.path().join("batch/summary.json");
    let read = truepath_publish::summary::Summary::parse(&fs::read(&file).unwrap(), &file).unwrap();
    let words = |alarms: &[Alarm]| alarms.iter().map(|alarm| alarm.words(Unit::Millimetre)).collect::<Vec<_>>();
    assert_eq!((words(&read.alarms), &read.next), (words(&stepped.batch.alarms), &stepped.next));
    assert!(read.next.as_ref().is_some_and(|next| next.contains("another lot")) && read.is_pushed());
    let worst = |state: &truepath_batch::batch::State| state.worst.as_ref().map(|worst| worst.error_mm);
    let last = read.states.last().and_then(worst).unwrap();
    assert!(stepped.batch.places.iter().all(|place| place.deviations_mm[8].1.abs() <= last.abs() + 1e-9), "{last}");
}

#[test]
fn a_table_that_says_something_else_is_refused_at_its_line() {
    let folder = tempfile::tempdir().unwrap();
    shop(folder.path(), &[1.0, 1.0]);
    let refused = |table: &str| match batch::run(&options(folder.path(), table)) {
        Err(Failure::Input(error)) => {
            (error.code().to_owned(), error.line_column().map(|(line, _)| line), error.found().to_owned())
        }
        other => panic!("{other:?}"),
    };
    let cases = [
        ("number,file\n1,part-1.txt\n", Some(1), "number,file"),
        ("part,probe\none,part-1.txt\n", Some(2), "`one`"),
        ("part,probe\n2,part-1.txt\n2,part-2.txt\n", Some(3), "behind part 2"),
        ("part,probe,event\n1,part-1.txt,\n2,part-2.txt,tool\n", Some(3), "`tool`"),
        ("part,probe,event\r\n1,part-1.txt,\r\n# a remark\r\n\r\n2,part-2.txt,tool\r\n", Some(5), "`tool`"),
        ("part,probe,event\n1,,cutter\n", Some(1), "no part"),
    ];
    for (table, line, found) in cases {
        let (code, at, said) = refused(table);
        assert!(code == "Q012" && at == line && said.contains(found), "{table}: {code} {at:?} {said}");
    }
    let (code, _, found) = refused("part,probe\n1,part-77.txt\n");
    assert!(code == "F001" || found.contains("part-77.txt"), "{code} {found}");
    // Nothing is written where something is refused.
    assert!(!folder.path().join("batch/batch.html").exists());
}

/// A wrong table on the command line ends with 1, a batch that asks for action with 3.
#[test]
fn exit_codes_say_whether_to_go_on() {
    let folder = tempfile::tempdir().unwrap();
    shop(folder.path(), &[1.0, 1.0, 1.0]);
    let run = |table: &str, tolerance: &str| {
        let Options { job, parts, output, .. } = options(folder.path(), table);
        let from = folder.path().join("out");
        let words: [PathBuf; 4] = [job, parts, from, output];
        let [job, parts, from, output] = words.map(|path| path.display().to_string());
        let arguments =
            ["truepath", "batch", &job, &parts, "--from", &from, "-o", &output, "--tolerance", tolerance, "--force"];
        truepath::cli::run(arguments.into_iter().map(Into::into))
    };
    let table = "part,probe\n1,part-1.txt\n2,part-2.txt\n3,part-3.txt\n";
    assert_eq!((run(table, "0.5"), run(table, "0.0001"), run("part\n", "0.5")), (0, 3, 1));
    // One part is a batch as well.
    let one = "part,probe\n1,part-1.txt\n";
    assert_eq!((run(one, "0.5"), run(one, "0.0001")), (0, 3));
    let page = fs::read_to_string(folder.path().join("batch/batch.html")).unwrap();
    assert!(page.contains("out of tolerance") && !page.contains("<svg"));
}
