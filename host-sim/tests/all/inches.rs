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
    assert!(said.ends_with("  truepath correct job.toml --dimensions dims.toml -o DIR\n"), "{said}");
    assert_eq!(has_metric(&said), None);
    let sheet = desk.text("dims.html");
    assert!(sheet.contains("<th>read in</th>") && sheet.contains(", ± 0.0010 in with k = 2") && !sheet.contains(" mm"));

    // The file is typed into in inches, and what is wrong with it is said in them.
    let table = desk.text("dims.toml");
    assert!(
        table.contains("nominal 3.0000 in\n") && !table.contains("_mm") && table.contains("\nvalue_in = \"\"\n"),
        "{table}"
    );
    let first = table.split("\n\n").take(2).collect::<Vec<_>>().join("\n\n");
    let refused = |file: &str| {
        fs::write(desk.0.path().join("typed.toml"), file).expect("a file");
        let (_, told) = desk.ended("correct job.toml --dimensions typed.toml -o typed", &[1]);
        assert_eq!(has_metric(&told), None);
        told
    };
    assert!(refused(&first).contains("value_in of 1 is empty"));
    let value = |value: &str| first.replace("value_in = \"\"", &format!("value_in = {value}"));
    let told = refused(&value("26.67"));
    assert!(told.contains("1 is 26.67 in; expected within 0.079 in of 1.0500 in (Y-1.0500 to Y0.0000)"), "{told}");
    assert!(told.contains("it looks like millimetres: write value_mm"), "{told}");
    let moved = |key: &str, put: &str| {
        let line = |line: &str| if line.starts_with(key) { format!("{key} = {put}") } else { line.to_owned() };
        value("1.049").lines().map(line).collect::<Vec<_>>().join("\n")
    };
    assert!(refused(&moved("z_in", "0.5")).contains("expected z_in from -0.4 to 0 in"));
    let told = refused(&moved("x_in", "30"));
    assert!(told.contains("it reaches from X-0.8000 to X3.0000"), "{told}");
    fs::write(desk.0.path().join("typed.toml"), value("1.049")).expect("a file");
    desk.ended("inspect job.toml --dimensions typed.toml --tolerance 0.001in -o typed", &[0]);

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
    desk.said("plot error cut --from 1in --to 63.5mm --inch -o said.svg");
    assert!(desk.text("said.svg") == error, "a unit says what a number is of");
    let (_, told) = desk.ended("plot error cut --inch --from 60 --to 80 -o none.svg", &[1]);
    assert!(told.contains("the stretch from 60 to 80 in holds nothing of the contour"), "{told}");
}

/// An open contour with an inside and an outside arc.
const ARCS: &str = "%\nO0042 (BRACKET)\n(T2 D=0.75 4 FLUTE END MILL)\nG20 G17 G90 G94 G40 G49 G80\nT2 M6\nS1200 M3\nG54\nG0 X-1.2 Y0.9\nG43 Z1. H2\nG0 Z0.1\n\
    G1 Z-0.4 F10.\nG1 X-0.5 Y0.9 F14.\nG1 X2.\nG3 X2.6 Y1.5 I0. J0.6\nG1 Y3.2\nG2 X3. Y3.6 I0.4 J0.\nG1 X4.2\nG0 Z1.\nM5\nM30\n%\n";

/// The warnings in the data of a page.
fn warnings_of(page: &str) -> Vec<Value> {
    let data = page.split_once("id=\"truepath-data\">").expect("data").1.split_once("</script>").expect("an end").0;
    let data: Value = serde_json::from_str(data).expect("JSON");
    data["warnings"].as_array().expect("warnings").clone()
}

#[test]
fn every_command_tells_of_a_program_with_arcs_in_inches_and_the_page_has_its_warnings_in_both_units() {
    let desk = Desk::new();
    fs::write(desk.0.path().join("part.nc"), ARCS).expect("a program");
    desk.said("init part.nc --yes --set allowance=0.02in --set wall=right --set material=al-6061-t6 --set stiffness=2500 --set tool.stickout_in=2 --set tool.material=carbide -o job.toml");
    desk.said("probe job.toml -o probe.nc");
    desk.said("simulate job.toml --plant plant.toml --touch probe.nc -o first");
    let quiet = |words: &str, codes: &[i32]| {
        let (said, told) = desk.ended(words, codes);
        assert_eq!((has_metric(&said), has_metric(&told)), (None, None), "{words}");
        said + &told
    };

    let told = quiet("correct job.toml --probe first/probe.txt --tolerance 0.0005in -o corrected", &[0]);
    assert!(told.contains("cannot hold 0.0005 in at every height"), "{told}");
    let warned = warnings_of(&desk.text("corrected/report.html"));
    let said = warned.iter().find_map(|said| {
        let [mm, inches] = [0, 1].map(|at| said.get(at).and_then(Value::as_str));
        mm.zip(inches).filter(|(mm, _)| mm.contains("at every height"))
    });
    let (mm, inches) = said.expect("a warning in both units");
    assert!(mm.contains("0.0127 mm at every height") && inches.contains("0.0005 in at every height"), "{mm} {inches}");
    assert_eq!(has_metric(inches), None);
    let summary = desk.json("corrected/summary.json");
    let listed = summary["warnings"].as_array().expect("warnings");
    assert!(
        listed.iter().any(|said| said.as_str().is_some_and(|said| said.replace("first/", "") == inches)),
        "{listed:?}"
    );
    for said in warned {
        let inches = said.as_str().or_else(|| said[1].as_str()).expect("words");
        assert_eq!(has_metric(inches), None);
    }
    assert_eq!(has_metric(&desk.text("corrected/difference.txt")), None);

    quiet("inspect job.toml --probe first/probe.txt -o inspected", &[0]);
    quiet("compare job.toml --probe first/probe.txt --plant plant.toml -o compared", &[0]);
    quiet("split job.toml -o split", &[0]);
    quiet("canon part.nc", &[0]);
    let packed = quiet("pack corrected first job.toml part.nc -o story.tpk", &[0]);
    assert!(packed.contains(" in (mean over the height, 1 sigma), "), "{packed}");
    let planned = quiet("plan job.toml --probe first/probe.txt --tolerance 0.001in -o planned --write 1", &[0]);
    assert!(planned.ends_with("  truepath learn job.toml --probe FILE --from planned -o DIR\n"), "{planned}");
    assert!(planned.contains(", 1 pass\n"), "{planned}");
    let page = desk.text("planned/report.html");
    assert!(page.contains("0.001 in</text>") || page.contains("worst error, 0.001 in"), "{page}");
    assert!(!page.contains("µm") && !page.contains(" mm<"), "{page}");
    let difference = desk.text("planned/difference.txt");
    assert!(difference.contains("became 1 pass:") && difference.contains("Z-0.40000 in,"), "{difference}");
    assert_eq!(has_metric(&difference), None);

    let pocket = quiet("pocket job.toml --tolerance 0.00002in -o pocket", &[0]);
    assert!(pocket.contains("band ±0.00002 in: "), "{pocket}");
    let picture = desk.text("pocket/before-after.svg");
    assert!(picture.contains("wall error (in)") && picture.contains("along the contour (in)"), "{picture}");
    assert!(desk.text("pocket/sections.csv").starts_with("section,"), "tables stay as they are");

    let bore =
        quiet("bore --hole-radius 0.5in --cutter-radius 0.25in --teeth 4 --feed 12in --rpm 3000 --depth 0.5in", &[0]);
    assert!(
        bore.starts_with("bore ⌀1 in, cutter ⌀0.5 in, 4 teeth, conventional; F12.0000 in/min at the centre"),
        "{bore}"
    );

    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/multiaxis");
    let program = fs::read_to_string(examples.join("sine-trunnion.nc")).expect("a program").replace("G21", "G20");
    fs::write(desk.0.path().join("five.nc"), program).expect("a program");
    fs::copy(examples.join("trunnion.toml"), desk.0.path().join("trunnion.toml")).expect("a machine");
    let five = quiet("multiaxis five.nc --machine trunnion.toml --tolerance 0.0005in --report five", &[0]);
    assert!(five.contains("tolerance 0.0005 in\n\nchord error, in "), "{five}");
    assert!(desk.text("five/errors.svg").contains("chord error, in"));
}

#[test]
fn what_is_wrong_with_a_program_or_a_flag_is_said_in_inches() {
    let desk = Desk::new();
    fs::write(desk.0.path().join("part.nc"), ARCS).expect("a program");
    desk.said("init part.nc --yes --set allowance=0.02in --set wall=right -o job.toml");
    for (found, put, words) in [
        ("I0. J0.6", "R0.2", "radius 0.200 in cannot reach an end 0.84853 in away"),
        ("I0. J0.6", "I0. J0.4", "the start of this arc is 0.400 in from its centre but the end 0.63246 in"),
    ] {
        fs::write(desk.0.path().join("part.nc"), ARCS.replace(found, put)).expect("a program");
        let (_, told) = desk.ended("probe job.toml -o probe.nc", &[1]);
        assert!(told.contains(words), "{told}");
        assert_eq!(has_metric(&told), None);
    }
    fs::write(desk.0.path().join("part.nc"), ARCS).expect("a program");
    let (_, told) = desk.ended("probe job.toml --clearance 9in -o probe.nc", &[1]);
    assert!(
        told.contains("50 mm (") && told.contains(" to 1.96 in)"),
        "both units, as the program is not read: {told}"
    );
    let (_, told) = desk.ended("probe job.toml --dimensions --reach 0in -o dims", &[2]);
    assert!(told.contains(" in)"), "{told}");
    for command in
        ["plan job.toml --probe none.txt --tolerance 20in -o p", "inspect job.toml --probe none.txt --tolerance 20in"]
    {
        let (_, told) = desk.ended(command, &[2]);
        assert!(told.contains(" mm (") && told.contains(" in)"), "{told}");
    }
}

/// A pocket finished by a stranger: the comment abbreviates, and an arc shows the side.
const POCKET: &str = "%\nO1207(POCKET FINISH)\n(T4 - 3/8 EM 4 FLUTE CARBIDE)\nG20G17G40G49G80G90\nT4M6\nG0G90G54X0.Y0.S6500M3\nG43H4Z1.\nZ.1\n\
    G1Z-.4F10.\nG1X1.25Y0.F30.\nG1Y.5\nG3X1.Y.75I-.25\nG1X-1.\nG3X-1.25Y.5J-.25\nG1Y-.5\nG3X-1.125Y-.625I.125\nG1X1.125\nG3X1.25Y-.5J.125\nG1Y0.\n\
    G1X0.Y.05\nG0Z1.\nM5\nM30\n%\n";

#[test]
fn init_asks_and_proposes_in_inches_and_doubts_a_length_without_a_unit() {
    let desk = Desk::new();
    fs::write(desk.0.path().join("part.nc"), POCKET).expect("a program");
    let said = desk.said("init part.nc --questions");
    assert!(said.contains("--set allowance=… [0.0190in]   allowance_in: stock on the wall"), "{said}");
    assert!(said.contains("in]   ball_diameter_in: diameter of the probe's ball"), "{said}");
    assert!(!said.contains("diameter of the cutter, which no comment names"), "{said}");
    assert_eq!(has_metric(&said), None);
    let asked: Value = serde_json::from_str(&desk.said("--json init part.nc --questions")).expect("JSON");
    let allowance = asked["questions"].as_array().expect("questions").iter().find(|q| q["name"] == "allowance");
    assert_eq!(allowance.expect("a question")["proposal"], "0.4826", "JSON stays in millimetres");

    let (job, told) = desk.ended("init part.nc --yes --set allowance=0.012 --set ball=0.236in -o typed.toml", &[0]);
    assert!(told.contains("--set allowance=0.012 says millimetres, 0.0004724 in: allowance=0.012in would"), "{told}");
    assert!(
        job.contains("tool.diameter_in             0.375 ") && job.contains("tool.teeth                   4 "),
        "{job}"
    );
    let (job, told) = desk.ended("init part.nc --yes -o job.toml", &[0]);
    assert!(job.contains("stock.allowance_in           0.019 ") && !told.contains("--set"), "{job} {told}");
    assert!(job.contains("round an arc of radius 0.125 in the cutter can leave no wall on the other side"), "{job}");
    assert_eq!(has_metric(&told), None);
    let (_, told) = desk.ended("init part.nc --yes --set allowance=1.5in -o wrong.toml", &[1]);
    assert!(told.contains("stock.allowance_in is 1.5; expected less than the cutter's diameter, 0.3750 in"), "{told}");

    // The places alone, for a machine whose language no program is written in.
    let listed = desk.said("probe job.toml");
    assert!(
        listed.starts_with(" point      s in ") && listed.contains("truepath correct job.toml --probe FILE"),
        "{listed}"
    );
}
