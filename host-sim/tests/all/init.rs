//! `truepath init`: the job of a program, and jobs that say hardly more than the program does not.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn shop() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/shop")
}

fn truepath(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).output().expect("the program runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The error of a command that is refused.
fn refused(output: &Output) -> Value {
    let said = text(&output.stderr);
    let last = said.lines().rev().find_map(|line| serde_json::from_str::<Value>(line).ok()?.get("error").cloned());
    let error = last.unwrap_or_else(|| panic!("no error in {said}{}", text(&output.stdout)));
    let code = error["code"].as_str().expect("a code");
    assert_eq!(output.status.code(), crate::workplace::refused(code), "{said}");
    error
}

/// The answer of a command that is not.
fn answer(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap_or(Value::Null)
}

/// A folder with a program of the shop.
fn desk(program: &str) -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    fs::copy(shop().join(program), desk.path().join(program)).expect("a copy");
    desk
}

/// A folder with a program.
fn with_program(program: &str) -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    fs::write(desk.path().join("part.nc"), program).expect("a program");
    desk
}

fn key<'a>(report: &'a Value, name: &str) -> &'a Value {
    let found = report["keys"].as_array().expect("keys").iter().find(|entry| entry["key"] == name);
    found.unwrap_or_else(|| panic!("no {name} in {report}"))
}

#[test]
fn a_program_in_inches_gets_a_job_in_inches_and_is_the_one_in_millimetres() {
    let program = "fusion-haas-inch-cover.nc";
    let desk = desk(program);
    let job = |set: [&str; 2], to: &str| {
        let words = ["--json", "init", program, "--yes", "--set", set[0], "--set", set[1], "-o", to];
        answer(&truepath(&words, desk.path()));
        let text = fs::read_to_string(desk.path().join(to)).expect("a job");
        let read = truepath_ground::diagnostics::Source::new(to, text.clone().into_bytes());
        (text, truepath_job::job::JobFile::parse(read, Path::new("")).expect("a job").numbers)
    };
    let (inches, one) = job(["allowance=0.02in", "probe.ball_diameter_in=0.25"], "inch.toml");
    for line in ["allowance_in = 0.02", "diameter_in = 0.5", "axial_depth_in = 0.375", "ball_diameter_in = 0.25"] {
        assert!(inches.lines().any(|said| said.starts_with(line)), "{line}: {inches}");
    }
    let (_, other) = job(["allowance=0.508", "probe.ball_diameter_mm=6.35"], "mm.toml");
    assert_eq!(one, other);
}

#[test]
fn everything_a_post_says_is_in_the_job_with_the_line_it_stands_on() {
    let desk = desk("fusion-haas-block.nc");
    let said = answer(&truepath(&["--json", "init", "fusion-haas-block.nc", "--yes"], desk.path()));
    let value = |name: &str| key(&said, name)["value"].as_str().expect("a value").to_owned();
    assert_eq!(value("dialect"), "\"haas\"");
    assert_eq!(value("wall"), "\"right\"");
    assert_eq!((value("tool.diameter_mm"), value("tool.number")), ("10".to_owned(), "1".to_owned()));
    assert_eq!(value("cut.axial_depth_mm"), "12");
    assert_eq!(
        (&key(&said, "tool.diameter_mm")["line"], &key(&said, "tool.diameter_mm")["origin"]),
        (&3.into(), &"program".into())
    );
    // What nobody has said is marked, in the report and in the file.
    for name in ["stock.allowance_mm", "tool.teeth", "probe.ball_diameter_mm"] {
        assert_eq!(
            (&key(&said, name)["origin"], &key(&said, name)["check"]),
            (&"default".into(), &true.into()),
            "{name}"
        );
    }
    let file = fs::read_to_string(desk.path().join("job.toml")).expect("a job");
    let line =
        |start: &str| file.lines().find(|l| l.starts_with(start)).unwrap_or_else(|| panic!("no {start}")).to_owned();
    assert!(line("diameter_mm").contains("# line 3: the comment \"T1 D=10. CR=0."), "{file}");
    assert!(line("allowance_mm").contains("please check"), "{file}");
    assert!(line("# stiffness_x_n_per_mm").contains("wide prior"), "{file}");
    // A file that is there stays, unless it may be replaced.
    assert_eq!(refused(&truepath(&["--json", "init", "fusion-haas-block.nc", "--yes"], desk.path()))["code"], "F003");
    assert_eq!(fs::read_to_string(desk.path().join("job.toml")).expect("the same"), file);
    answer(&truepath(&["--json", "init", "fusion-haas-block.nc", "--yes", "--force"], desk.path()));
}

/// A rectangle round a part, plunged into beside nothing that shows its side.
const PLAIN: &str =
    "G21 G90 G17\nT1 M6\nS4000 M3\nG0 X0 Y0\nG0 Z2\nG1 Z-6 F200\nG1 Y40 F500\nG1 X60\nG1 Y0\nG1 X0\nG0 Z20\nM2\n";

#[test]
fn what_nobody_says_is_asked_by_name_and_nothing_is_written() {
    let desk = with_program(PLAIN);
    let error = refused(&truepath(&["--json", "init", "part.nc"], desk.path()));
    assert_eq!(error["code"], "J042");
    let found = error["found"].as_str().expect("words");
    for name in ["wall", "allowance", "diameter", "teeth", "material", "stiffness", "ball"] {
        assert!(found.contains(&format!("--set {name}=")), "{name} is not asked in {found}");
    }
    // With --yes only what has no default.
    let found = refused(&truepath(&["--json", "init", "part.nc", "--yes"], desk.path()))["found"].to_string();
    assert!(found.contains("--set wall=") && found.contains("--set diameter="), "{found}");
    assert!(!found.contains("--set allowance=") && !found.contains("--set ball="), "{found}");
    assert!(!desk.path().join("job.toml").exists());
    let set =
        ["--set", "wall=right", "--set", "diameter=10", "--set", "material=al-6082-t6", "--set", "stiffness=5000"];
    let said = answer(&truepath(&[&["--json", "init", "part.nc", "--yes"], &set[..]].concat(), desk.path()));
    assert_eq!(key(&said, "machine.stiffness_y_n_per_mm")["value"], "5000");
    assert_eq!(key(&said, "force.material")["value"], "\"al-6082-t6\"");
    let plan = answer(&truepath(&["--json", "probe", "job.toml", "--dialect", "grbl", "-o", "v.nc"], desk.path()));
    assert_eq!(plan["assumed"], Value::Null, "everything is said");
}

#[test]
fn a_wrong_answer_is_refused_with_what_it_may_be() {
    let desk = with_program(PLAIN);
    for (set, code) in [
        ("teeth=40", "J006"),
        ("colour=red", "C001"),
        ("wall", "C001"),
        ("wall=up", "J007"),
        ("tool.colour=red", "J003"),
    ] {
        let set = ["--json", "init", "part.nc", "--yes", "--set", "wall=left", "--set", "diameter=10", "--set", set];
        assert_eq!(refused(&truepath(&set, desk.path()))["code"], code, "{set:?}");
        assert!(!desk.path().join("job.toml").exists());
    }
}

#[test]
fn questions_on_a_terminal_are_answered_there() {
    use portable_pty::{CommandBuilder, PtySize, native_pty_system};
    let desk = desk("fusion-haas-block.nc");
    let pair = native_pty_system().openpty(PtySize { rows: 50, cols: 200, ..PtySize::default() }).expect("a terminal");
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_truepath"));
    command.args(["init", "fusion-haas-block.nc"]);
    command.cwd(desk.path());
    let mut child = pair.slave.spawn_command(command).expect("the program runs");
    drop(pair.slave);
    let mut reader = pair.master.try_clone_reader().expect("what it says");
    let mut writer = pair.master.take_writer().expect("what it is told");
    // Allowance, teeth (a wrong one first), material, stiffness, ball.
    writer.write_all(b"0.4\n99\n4\n\n6000\n\n").expect("answers");
    let mut said = String::new();
    // A terminal whose other end has gone ends with an error on some systems.
    let _ = reader.read_to_string(&mut said);
    assert!(child.wait().expect("its end").success(), "{said}");
    let file = fs::read_to_string(desk.path().join("job.toml")).expect("a job");
    for line in [
        "allowance_mm = 0.4 ",
        "teeth = 4 ",
        "# material",
        "stiffness_x_n_per_mm = 6000 ",
        "stiffness_y_n_per_mm = 6000 ",
        "ball_diameter_mm = 6 ",
    ] {
        assert!(file.lines().any(|l| l.starts_with(line)), "{line} is missing in\n{file}\n{said}");
    }
    assert!(said.contains("tool.teeth"), "{said}");
}

/// Of every program of the shop that goes through with a bare job: what is known of it, by the head of the table.
fn programs() -> Vec<std::collections::HashMap<String, String>> {
    let table = fs::read_to_string(shop().join("programs.csv")).expect("the table");
    let mut lines = table.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let row = |line: &str| head.iter().map(|h| (*h).to_owned()).zip(line.split(',').map(str::to_owned)).collect();
    lines.map(row).collect()
}

/// Makes a job of every so many programs of the shop and probes with it: programs that are probed, and those of them that
/// asked for nothing but the allowance. Panics at what went wrong with any of them.
fn jobs_of_the_shop(every: usize) -> (usize, usize) {
    let desk = tempfile::tempdir().expect("a folder");
    let mut wrong = Vec::new();
    let (mut through, mut by_itself) = (0, 0);
    for program in programs().iter().filter(|p| p["expected"] == "through").step_by(every) {
        let name = &program["file"];
        fs::copy(shop().join(name), desk.path().join(name)).expect("a copy");
        let job = format!("{name}.toml");
        let allowance = format!("allowance={}", program["allowance_mm"]);
        let mut set = vec!["--json", "init", name, "--yes", "-o", &job, "--set", &allowance];
        let (diameter, wall) = (format!("diameter={}", program["diameter_mm"]), format!("wall={}", program["wall"]));
        let spindle = program["keys"].split("cut.spindle_rpm = ").nth(1).map(|rpm| format!("rpm={rpm}"));
        let spindle = spindle.unwrap_or_default();
        let first = truepath(&set, desk.path());
        if first.status.success() {
            by_itself += 1;
        } else {
            let found = refused(&first)["found"].to_string();
            let answers = [("--set wall=", &wall), ("--set diameter=", &diameter), ("--set rpm=", &spindle)];
            for (asked, told) in answers {
                if found.contains(asked) {
                    set.extend(["--set", told]);
                }
            }
        }
        let made = if first.status.success() { first } else { truepath(&set, desk.path()) };
        if !made.status.success() {
            // The diameter may show the side, or leave it open.
            set.extend(["--set", &wall]);
        }
        let made = if made.status.success() { made } else { truepath(&set, desk.path()) };
        if !made.status.success() {
            wrong.push(format!("{name}: {}", text(&made.stderr)));
            continue;
        }
        let said = answer(&made);
        let file = fs::read_to_string(desk.path().join(&job)).expect("a job");
        let value = |start: &str| {
            let line = file.lines().find_map(|l| l.strip_prefix(start)?.trim_start().strip_prefix('='));
            line.map(|l| l.split('#').next().unwrap_or_default().trim().trim_matches('"').to_owned())
        };
        if !program["wall"].is_empty() && value("wall").is_some_and(|found| found != program["wall"]) {
            wrong.push(format!("{name}: wall {:?}, {}", value("wall"), key(&said, "wall")["why"]));
        }
        for (start, column) in [("diameter_mm", "diameter_mm"), ("axial_depth_mm", "depth_mm")] {
            let number = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
            let (found, expected) = (value(start).map(|v| number(&v)), number(&program[column]));
            if found.is_some_and(|found| (found - expected).abs() > 1e-6) {
                wrong.push(format!("{name}: {start} {found:?} instead of {expected}"));
            }
        }
        let verify = format!("{name}.verify");
        let probed = truepath(&["--json", "probe", &job, "--dialect", "linuxcnc", "-o", &verify], desk.path());
        match probed.status.success() {
            true => through += 1,
            false => wrong.push(format!("{name}: probe: {}", text(&probed.stderr))),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    (through, by_itself)
}

#[test]
fn init_makes_a_job_of_a_program_of_the_shop_with_which_it_is_probed() {
    let (through, by_itself) = jobs_of_the_shop(8);
    assert!(through >= 4 && by_itself >= 2, "{through} through, {by_itself} without an answer but the allowance");
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn init_makes_a_job_of_every_program_of_the_shop_with_which_it_is_probed() {
    let (through, by_itself) = jobs_of_the_shop(1);
    assert!(through >= 33 && by_itself >= 18, "{through} through, {by_itself} without an answer but the allowance");
}

/// Tool, side and allowance, and the ball of the probe.
const BARE: &str = "version = 1\nprogram = \"part.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.5\n[tool]\ndiameter_mm = 10\nteeth = 3\n[probe]\nball_diameter_mm = 2\n";

/// The plan of touches of a job for a program.
fn probed(program: &str, job: &str) -> Output {
    let desk = with_program(program);
    fs::write(desk.path().join("job.toml"), job).expect("a job");
    truepath(&["--json", "probe", "job.toml", "--dialect", "linuxcnc", "-o", "v.nc"], desk.path())
}

#[test]
fn what_a_bare_job_leaves_open_is_taken_from_the_program_and_said() {
    let plan = answer(&probed(&format!("%\nO01001 (PART)\n{PLAIN}"), BARE));
    let assumed = plan["assumed"].as_array().expect("what was assumed");
    let of =
        |key: &str| assumed.iter().find(|a| a["key"] == key).unwrap_or_else(|| panic!("{key} is not said")).clone();
    assert_eq!((&of("dialect")["value"], &of("dialect")["line"]), (&"\"haas\"".into(), &2.into()));
    assert_eq!(of("cut.axial_depth_mm")["value"], "6");
    assert_eq!(of("force.ktc_n_per_mm2")["value"], "1150");
    assert_eq!(of("machine.stiffness_x_n_per_mm")["value"], "4000");
    assert_eq!(of("tool.helix_deg")["value"], "35");
    let warnings = plan["warnings"].to_string();
    assert!(warnings.contains("assumed cut.axial_depth_mm = 6: from Z 0"), "{warnings}");
}

#[test]
fn the_depth_of_a_level_is_its_step_and_one_that_does_not_show_is_asked() {
    let levels = PLAIN.replace("G0 Z20\n", "G1 Z-10 F200\nG1 Y40 F500\nG1 X60\nG1 Y0\nG1 X0\nG0 Z20\n");
    let depth = |program: &str, job: &str, pass: &str| {
        let desk = with_program(program);
        fs::write(desk.path().join("job.toml"), job).expect("a job");
        let plan = truepath(
            &["--json", "probe", "job.toml", "--pass", pass, "--dialect", "linuxcnc", "-o", "v.nc"],
            desk.path(),
        );
        let plan = answer(&plan);
        let found =
            plan["assumed"].as_array().and_then(|all| all.iter().find(|a| a["key"] == "cut.axial_depth_mm").cloned());
        found.map(|a| a["value"].as_str().unwrap_or_default().to_owned())
    };
    assert_eq!(depth(&levels, BARE, "1").as_deref(), Some("6"));
    assert_eq!(depth(&levels, BARE, "2").as_deref(), Some("4"));
    let stated = BARE.replace("[probe]", "[cut]\naxial_depth_mm = 5.5\n[probe]");
    assert_eq!(depth(&levels, &stated, "2"), None);
    let above = PLAIN.replace("Z-6", "Z3");
    let error = refused(&probed(&above, BARE));
    assert_eq!((&error["code"], &error["line"]), (&"J040".into(), &7.into()), "{error}");
}

#[test]
fn a_cutter_comes_from_a_comment_and_several_are_told_apart_by_the_contour() {
    let without = BARE.replace("diameter_mm = 10\nteeth = 3\n", "");
    let one = PLAIN.replace("T1 M6", "(T1 FRAESER D8 Z4)\nT1 M6");
    let plan = answer(&probed(&one, &without));
    let said = plan["assumed"].to_string();
    assert!(said.contains("tool.diameter_mm") && said.contains("\"8\"") && said.contains("tool.teeth"), "{said}");
    // A drill and a second cutter that only faces nothing: the contour is T2's.
    let two = one.replace("(T1", "(T2 D=16. CR=0. - flat end mill)\n(T3 D=5. - drill)\n(T1");
    let plan = answer(&probed(&two, &without));
    assert!(plan["assumed"].to_string().contains("\"8\""), "{}", plan["assumed"]);
    assert_eq!(refused(&probed(PLAIN, &without))["code"], "J004");
}

#[test]
fn the_ball_has_no_default_and_the_error_says_what_to_write() {
    let without = BARE.replace("[probe]\nball_diameter_mm = 2\n", "");
    let error = refused(&probed(PLAIN, &without));
    assert_eq!(error["code"], "J004");
    assert!(error["help"].as_str().expect("words").contains("ball_diameter_mm"), "{error}");
}

#[test]
fn the_format_of_a_probe_file_shows_itself_and_a_wrong_one_in_the_job_is_named() {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("demo/corner");
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("job/tests/data/probe");
    let job = fs::read_to_string(demo.join("job.toml")).expect("a job");
    let desk = tempfile::tempdir().expect("a folder");
    fs::copy(demo.join("program.nc"), desk.path().join("program.nc")).expect("a program");
    fs::copy(data.join("inspection.txt"), desk.path().join("probe.txt")).expect("a probe file");
    let inspect = |job: &str| {
        fs::write(desk.path().join("job.toml"), job).expect("a job");
        truepath(&["--json", "inspect", "job.toml", "--probe", "probe.txt"], desk.path())
    };
    let without = job.replace("format = \"linuxcnc\"\n", "");
    assert_ne!(without, job);
    let said = answer(&inspect(&without));
    assert_eq!(said["contacts"].as_array().map(Vec::len), Some(5));
    // The job says LinuxCNC's PROBEOPEN; the file is inspection text, and says so.
    let output = inspect(&job);
    assert_eq!(answer(&output)["contacts"].as_array().map(Vec::len), Some(5));
    assert!(text(&output.stderr).contains("correct format there"), "{}", text(&output.stderr));
    let wide: Vec<u8> = "START\r\nG800 N1".encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(desk.path().join("probe.txt"), [&[0xFF, 0xFE], &wide[..]].concat()).expect("a file");
    assert_eq!(refused(&inspect(&without))["code"], "J044");
    fs::write(desk.path().join("probe.txt"), "Punkt 1 an der Wand\n").expect("a file");
    assert_eq!(refused(&inspect(&without))["code"], "J043");
}

#[test]
fn the_questions_can_be_had_without_writing_and_their_answers_make_the_job() {
    let desk = desk("fusion-haas-block.nc");
    let program = "fusion-haas-block.nc";
    let ask = |more: &[&str]| {
        let words = [&["--json", "init", program, "--questions"], more].concat();
        answer(&truepath(&words, desk.path()))["questions"].as_array().expect("questions").clone()
    };
    let open = ask(&[]);
    assert!(!open.is_empty() && !desk.path().join("job.toml").exists());
    let answers: Vec<String> = open
        .iter()
        .filter_map(|q| Some((q["name"].as_str()?, q["proposal"].as_str()?)))
        .filter(|(_, proposal)| *proposal != "unknown")
        .map(|(name, proposal)| format!("{name}={proposal}"))
        .collect();
    assert!(!answers.is_empty(), "{open:?}");
    let set: Vec<&str> = answers.iter().flat_map(|answer| ["--set", answer]).collect();
    // What was said is not asked again.
    let left = ask(&set);
    assert!(left.iter().all(|q| q["proposal"] == "unknown" || q["proposal"].is_null()), "{left:?}");
    // The proposals are what --yes takes.
    answer(&truepath(&["--json", "init", program, "--yes", "-o", "taken.toml"], desk.path()));
    let words = [&["--json", "init", program, "--yes", "-o", "said.toml"], &set[..]].concat();
    answer(&truepath(&words, desk.path()));
    let numbers = |name: &str| {
        let text = fs::read(desk.path().join(name)).expect("a job");
        let read = truepath_ground::diagnostics::Source::new(name, text);
        truepath_job::job::JobFile::parse(read, desk.path()).expect("a job").numbers
    };
    assert_eq!(numbers("taken.toml"), numbers("said.toml"));
}
