//! A program in inches is told about in inches, in words and pictures; files and JSON have millimetres.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

const PROGRAM: &str = "fusion-haas-inch-cover.nc";
const MM_PER_INCH: f64 = 25.4;

struct Desk(tempfile::TempDir);

impl Desk {
    /// A folder with the program, a job and a machine.
    fn new() -> Self {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/shop");
        let desk = Self(tempfile::tempdir().expect("a folder"));
        fs::copy(data.join(PROGRAM), desk.0.path().join("part.nc")).expect("a program");
        fs::copy(data.join("plant.toml"), desk.0.path().join("plant.toml")).expect("a machine");
        desk
    }

    /// What a command says on standard output, which may end with one of these exit codes.
    fn ended(&self, words: &str, codes: &[i32]) -> (String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
        command.args(words.split(' ')).current_dir(self.0.path()).stdin(Stdio::null());
        let done = command.output().expect("the program runs");
        let [said, told] = [done.stdout, done.stderr].map(|bytes| String::from_utf8(bytes).expect("words"));
        assert!(done.status.code().is_some_and(|code| codes.contains(&code)), "{words}: {told}");
        (said, told)
    }

    fn said(&self, words: &str) -> String {
        self.ended(words, &[0]).0
    }

    fn json(&self, file: &str) -> Value {
        serde_json::from_slice(&fs::read(self.0.path().join(file)).expect("a file")).expect("JSON")
    }

    fn text(&self, file: &str) -> String {
        fs::read_to_string(self.0.path().join(file)).expect("a text")
    }
}

/// Whether a text has a length in millimetres or micrometres: not `N/mm`, no key, no name of a file.
fn has_metric(text: &str) -> Option<&str> {
    text.lines().find(|line| {
        line.split([' ', ',', ';', ':', '(', ')']).any(|word| ["mm", "µm", "um", "mm/min"].contains(&word))
    })
}

fn number(of: &Value, keys: &[&str]) -> f64 {
    keys.iter().fold(of, |value, key| &value[key]).as_f64().unwrap_or_else(|| panic!("no {keys:?}"))
}

fn inches(mm: f64, decimals: usize) -> String {
    format!("{:.decimals$}", mm / MM_PER_INCH)
}

#[test]
fn a_program_in_inches_is_told_about_in_inches_and_files_stay_in_millimetres() {
    let desk = Desk::new();
    let job = desk.said("init part.nc --yes --set allowance=0.02in --set probe.ball_diameter_in=0.25 --set material=al-7075-t6 --set stiffness=2500 --set part.tolerance_in=0.0015 -o job.toml");
    for told in [
        "stock.allowance_in           0.02 ",
        "tool.diameter_in             0.5 ",
        "cut.axial_depth_in           0.375 ",
        "down to Z -0.375 of line 18",
        "contour: lines 18-26, Z -0.375, 15.1416 in, closed, S6100, F40 in/min",
    ] {
        assert!(job.contains(told), "{told}: {job}");
    }

    // The table of touches has the numbers of the program that makes them.
    let plan = desk.said("probe job.toml -o probe.nc");
    assert!(plan.starts_with(" point      s in       X in       Y in       Z in\n"), "{plan}");
    let touches: Value = serde_json::from_str(&desk.said("--json probe job.toml -o again.nc")).expect("JSON");
    let first = &touches["points"][0];
    let row = plan.lines().find(|line| line.starts_with("     1 ")).expect("the first touch");
    assert!(row.contains(&format!("{:>10}", inches(number(first, &["x_mm"]), 5))), "{row}");
    let program = desk.text("probe.nc");
    assert!(program.contains("G20") && program.contains("WALL RADIUS 0.3750 IN"), "{program}");
    assert_eq!(has_metric(&plan), None);

    let cut = desk.said("simulate job.toml --plant plant.toml --touch probe.nc -o first");
    let summary = desk.json("first/summary.json");
    let largest = inches(number(&summary, &["max_error_mm"]), 5);
    assert!(cut.contains(&format!("largest wall error {largest} in (rms ")), "{cut}");
    assert_eq!(has_metric(&cut), None);

    let inspected = desk.said("inspect job.toml --probe first/probe.txt -o inspected");
    let summary = desk.json("inspected/summary.json");
    assert!(inspected.contains(&format!("largest {}, smallest", inches(number(&summary, &["max_error_mm"]), 5))));
    assert!(inspected.contains("are outside ±0.0015 in, the worst +"), "{inspected}");
    assert!(summary["verdict"]["text"].as_str().is_some_and(|text| text.contains("±0.0381 mm")), "{summary}");
    assert_eq!(has_metric(&inspected), None);

    let (corrected, warned) = desk.ended("correct job.toml --probe first/probe.txt -o corrected", &[0]);
    let summary = desk.json("corrected/summary.json");
    let before = inches(number(&summary, &["max_error_before_mm"]), 5);
    let fall = corrected.lines().find(|line| line.starts_with("largest wall error, by the model ")).expect("a line");
    assert!(fall.contains(&format!(" {before} -> ")), "{fall}");
    assert!(corrected.contains("  datum_x ") && corrected.contains(" in   "), "{corrected}");
    assert!(corrected.contains("um/N"), "what is no length keeps its unit: {corrected}");
    assert_eq!((has_metric(&corrected), has_metric(&warned)), (None, None));

    desk.said("simulate job.toml --plant plant.toml --touch probe.nc --from corrected -o second");
    let (learned, warned) = desk.ended("learn job.toml --probe second/probe.txt --from corrected -o learned", &[0]);
    assert!(learned.contains("measured in") && learned.contains("Will be 0.00"), "{learned}");
    assert_eq!((has_metric(&learned), has_metric(&warned)), (None, None));

    fs::write(desk.0.path().join("parts.csv"), "part,probe,event\n1,first/probe.txt,\n2,second/probe.txt,\n")
        .expect("a table");
    let (batch, warned) = desk.ended("batch job.toml parts.csv -o batch", &[0, 3]);
    assert!(batch.contains(" in ") && batch.contains(" in above the tip"), "{batch}");
    assert_eq!((has_metric(&batch), has_metric(&warned)), (None, None));
    assert!(desk.text("batch/summary.json").contains("µm"), "its words in the file are as its figures");

    let (planned, _) = desk.ended("plan job.toml --feature contour-2 --probe first/probe.txt --tolerance 0.05", &[0]);
    assert!(
        planned.contains("wanted: 0.00197 in at every height") && planned.contains("ratio    in, 2 sigma     in"),
        "{planned}"
    );
    assert_eq!(has_metric(&planned), None);
    let split = desk.said("split job.toml --feature contour-1 -o split");
    assert!(split.contains("the contour 0.0100 in away from the wall"), "{split}");
}

/// Written in a hurry: no blanks, lower case, G20 in the middle of a block, points without digits before them.
const SLOVENLY: &str = "%\nO2207 (bracket, 1/2 em)\nn10 g90 g17 g40 g80 g49\nn20 t2 m6 (1/2 END MILL 4FL)\nn30 s5200 m3 g20 g54\nn40 g0x-.8y-.8\ng43 h2 z1.\nz.1\ng1z-.4f20.\n\
    g1x-.25 f45.\n y2.25\nx3.25y2.25\ny-.25\nx-.8\ng0 z1.\nm5\nm30\n%\n";

#[test]
fn flags_take_inches_and_what_is_refused_or_doubted_is_said_in_inches() {
    let desk = Desk::new();
    fs::write(desk.0.path().join("part.nc"), SLOVENLY).expect("a program");
    desk.said("init part.nc --yes --set allowance=0.015in --set probe.ball_diameter_in=0.125 --set material=al-7075-t6 --set stiffness=2500 --set wall=right -o job.toml");
    desk.said("probe job.toml --clearance 0.1in -o probe.nc");
    desk.said("simulate job.toml --plant plant.toml --touch probe.nc -o first");

    // The same tolerance in three ways.
    let of = |text: &str, n: u32| {
        desk.ended(&format!("correct job.toml --probe first/probe.txt --tolerance {text} -o c{n}"), &[0]);
        fs::read(desk.0.path().join(format!("c{n}/summary.json"))).expect("a summary")
    };
    let metric = of("0.0127", 1);
    assert!(metric == of("0.0005in", 2) && metric == of("12.7um", 3));
    let (_, told) = desk.ended("correct job.toml --probe first/probe.txt --tolerance 0.5ft -o c4", &[2]);
    assert!(told.contains("--tolerance on the command line is \"0.5ft\"") && told.contains("0.0008in"), "{told}");

    let (said, warned) = desk.ended("correct job.toml --probe first/probe.txt --tolerance 0.0005in -o corrected", &[0]);
    assert!(warned.contains("cannot hold 0.0005 in at every height"), "{warned}");
    assert!(warned.contains("--tolerance 0.0005in") && warned.contains("--corner-radius 0.34in"), "{warned}");
    assert_eq!((has_metric(&said), has_metric(&warned)), (None, None));
    let (_, told) = desk.ended("fillet job.toml --corner-radius 0.2in -o f", &[2]);
    assert!(told.contains("--corner-radius 0.2 in with a cutter of 0.25 in radius"), "{told}");
    let said = desk.said("fillet job.toml --corner-radius 0.34in -o f");
    assert!(said.contains("gets an arc of 0.09 in on the path"), "{said}");
    assert_eq!((has_metric(&said), has_metric(&told)), (None, None));
    let (_, told) = desk.ended("fillet job.toml --corner-radius wide -o g", &[1, 2]);
    assert!(told.contains("20um, 0.02in"), "{told}");

    let said = desk.said("probe job.toml --dimensions --reach 6in --uncertainty 0.001in -o dims");
    assert!(said.contains(" Z in  nominal in\n") && said.contains("  3.0000  "), "{said}");
    assert_eq!(has_metric(&said), None);

    // Touches that are somewhere else: of another datum, of another part, a single one.
    let touches = desk.text("first/probe.txt");
    let moved = |by: f64, only: Option<usize>| -> String {
        let mut count = 0;
        let line = |line: &str| {
            let touch = line.strip_prefix("G801 ").and_then(|rest| rest.split_once('X'));
            let Some((name, (x, rest))) = touch.and_then(|(name, rest)| Some((name, rest.split_once('Y')?))) else {
                return line.to_owned();
            };
            count += 1;
            if only.is_some_and(|only| only != count) {
                return line.to_owned();
            }
            format!("G801 {name}X{:.5} Y{rest}", x.trim().parse::<f64>().expect("a number") + by)
        };
        touches.lines().map(line).map(|line| line + "\n").collect()
    };
    for (name, by, only, words) in [
        ("datum", 0.02, None, "in are taken off all of them: the datum is shifted by that"),
        ("far", 3.0, None, "from the nominal wall"),
        ("one", 0.35, Some(1), "in from the nominal wall"),
    ] {
        let text = moved(by, only);
        assert_ne!(text, touches, "the touches are moved");
        fs::write(desk.0.path().join("moved.txt"), text).expect("touches");
        for command in ["correct", "inspect"] {
            let (said, told) =
                desk.ended(&format!("{command} job.toml --probe moved.txt -o {name}-{command}"), &[0, 1, 2, 3]);
            if command == "correct" {
                assert!(told.contains(words), "{name}: {told}");
            }
            assert_eq!((has_metric(&said), has_metric(&told)), (None, None), "{command} {name}");
        }
    }
}

#[test]
fn pictures_of_a_program_in_inches_are_in_inches() {
    let desk = Desk::new();
    desk.said(
        "init part.nc --yes --set allowance=0.02in --set probe.ball_diameter_in=0.25 --set contour=2 -o job.toml",
    );
    desk.said("simulate job.toml --plant plant.toml -o cut");
    let units = |svg: &str| {
        let of = |name: &str| {
            [format!("along the contour ({name})"), format!("wall error ({name})"), format!("deflection ({name})")]
        };
        ["in", "mm"].map(|name| of(name).iter().all(|text| svg.contains(text.as_str())))
    };
    assert_eq!(units(&desk.text("cut/trace.svg")), [true, false]);
    // A table is in millimetres, and says nothing of the program's unit.
    desk.said("plot trace cut -o mm.svg");
    desk.said("plot trace cut --inch -o inch.svg");
    assert_eq!(units(&desk.text("mm.svg")), [false, true]);
    assert_eq!(units(&desk.text("inch.svg")), [true, false]);
    desk.said("plot error cut --inch --from 1 --to 2.5 -o error.svg");
    let error = desk.text("error.svg");
    assert!(error.contains("X (in)") && error.contains(" in of error, drawn ") && !error.contains("mm"), "{error}");
    let (_, told) = desk.ended("plot error cut --inch --from 60 --to 80 -o none.svg", &[1]);
    assert!(told.contains("the stretch from 60 to 80 in holds nothing of the contour"), "{told}");
}
