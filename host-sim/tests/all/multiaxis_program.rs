//! `truepath multiaxis` with programs as controls and people write them: what stays, what is refused, what is told.

use crate::multiaxis_support::{HEADS, TRUNNION, feeds};
use crate::workplace::truepath;
use tempfile::TempDir;

/// A move that errs by more than 5 µm, whatever stands around it.
const START: &str = "G21 G90 G94\nG0 X0 Y0 Z0 A0 C0\n";

struct Case(TempDir);

impl Case {
    fn new(program: impl AsRef<[u8]>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("m.toml"), TRUNNION.toml()).unwrap();
        std::fs::write(folder.path().join("in.nc"), program).unwrap();
        Self(folder)
    }
    fn run(&self, options: &[&str]) -> std::process::Output {
        let mut arguments = vec!["multiaxis", "in.nc", "--machine", "m.toml"];
        if !options.contains(&"--tolerance") {
            arguments.extend(["--tolerance", "0.005"]);
        }
        arguments.extend(["-o", "out.nc", "--force"]);
        arguments.extend(options);
        truepath(self.0.path(), &arguments)
    }
    /// The rewritten program.
    fn text(&self, options: &[&str]) -> String {
        let output = self.run(options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read_to_string(self.0.path().join("out.nc")).unwrap()
    }
    fn warnings(&self, options: &[&str]) -> String {
        let output = self.run(options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stderr).unwrap()
    }
    /// The error: its code, line and column.
    fn refusal(&self, options: &[&str]) -> (String, Option<u64>, Option<u64>) {
        let options = [options, &["--json"]].concat();
        let output = self.run(&options);
        assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stdout));
        assert!(!self.0.path().join("out.nc").exists(), "nothing is written");
        let error: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
        let error = &error["error"];
        assert!(error["help"].as_str().is_some_and(|help| !help.is_empty()));
        (error["code"].as_str().unwrap().to_owned(), error["line"].as_u64(), error["column"].as_u64())
    }
}

fn code(code: &str, line: u64, column: u64) -> (String, Option<u64>, Option<u64>) {
    (code.to_owned(), Some(line), Some(column))
}

#[test]
fn only_the_lines_of_divided_moves_change() {
    let program = "%\r\n(a part)\r\n:100\r\nN1 G21 G90\r\n N2 g0 x0 y0 z0 a0 c0 ; to the start\r\n\
                   N3 G1 Z-1. F500\r\nN4 X40. Y1. C20. M8 (the cut)\r\nN5 A0.001\r\nM9\r\nM30\r\n%\r\n";
    let text = Case::new(program).text(&[]);
    let (before, after): (Vec<&str>, Vec<&str>) = (program.split("\r\n").collect(), text.split("\r\n").collect());
    assert!(!text.replace("\r\n", "").contains(['\r', '\n']), "the line ends stay");
    assert_eq!(after[..6], before[..6]);
    let inserted = after.len() - before.len();
    assert!(inserted > 3);
    assert_eq!(after[6 + inserted + 1..], before[7..]);
    let first = after[6];
    assert!(first.starts_with("N4 X") && first.ends_with("M8 (the cut)"), "{first}");
    assert!(after[7].ends_with(&format!("(LINE 7 IN {} PIECES)", inserted + 1)), "{}", after[7]);
    assert!(
        after[6 + inserted].contains("X40.0 Y1.0") && after[6 + inserted].contains("C20.0"),
        "{}",
        after[6 + inserted]
    );
    assert_eq!(text.matches("M8").count(), 1);
}

#[test]
fn lower_case_no_blanks_and_no_last_line_end_stay_as_they_are() {
    let program = "g21g90g0x0y0z0a0c0\ng1x40y1c20f500";
    let text = Case::new(program).text(&[]);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.len() > 3 && !text.ends_with('\n'));
    assert!(lines[1].starts_with("g1x") && lines[1].ends_with("f500"), "{}", lines[1]);
    assert!(lines.last().unwrap().starts_with("x40.0y1.0"), "{text}");
    assert_eq!(feeds(&text).last().unwrap().to, [40.0, 1.0, 0.0, 0.0, 0.0, 20.0]);
}

#[test]
fn what_acts_at_the_end_of_a_move_goes_to_its_last_piece() {
    let text = Case::new(format!("{START}/G9 G1 X40 Y1 C20 F500 M0\nX0 C0\nM2\n")).text(&[]);
    let lines: Vec<&str> = text.lines().collect();
    let last = lines.iter().position(|l| l.contains("M0")).unwrap();
    assert!(lines[last].starts_with('/') && lines[last].contains("X40.0") && lines[last].contains("G9"), "{text}");
    assert!(lines[2..=last].iter().all(|l| l.starts_with('/')), "a line with / is replaced by lines with /");
    assert!(!lines[2].contains("M0") && !lines[2].contains("G9"), "{}", lines[2]);
}

#[test]
fn a_feed_under_inverse_time_is_shared_out_even_when_it_is_a_parameter() {
    let text = Case::new(format!("{START}#1=20\nG93 G1 X40 Y1 C20 F#1\nM2\n")).text(&["--rule", "equal"]);
    let pieces = text.lines().filter(|l| l.contains('X') && !l.starts_with("G0")).count();
    assert!(text.contains(&format!("F[#1*{pieces}.0]")), "{text}");
    let exact = Case::new(format!("{START}G93 G1 X40 Y1 C20 F2.5\nM2\n")).text(&["--rule", "equal"]);
    assert!(exact.contains(&format!("F{:.1}", 2.5 * pieces as f64)), "{exact}");
}

#[test]
fn a_turn_of_the_table_is_linear_in_the_programmed_angle() {
    // 359 → 1 is 358 degrees back, not 2 on.
    let text = Case::new("G21 G90 G0 X60 Y0 Z0 A0 C359\nG1 X60.1 C1 F500\nM2\n").text(&[]);
    let moves = feeds(&text);
    assert!(moves.len() > 100);
    assert!(moves.iter().all(|m| m.to[5] < m.from[5]), "the angle falls all the way");
}

#[test]
fn a_named_place_moves_the_axes_of_the_machine_with_it() {
    let plain = Case::new(format!("{START}G1 X40 Y1 C20 F500\nM2\n")).text(&[]);
    let named = Case::new(format!("{START}G92 X100 C-30\nG1 X140 Y1 C-10 F500\nM2\n")).text(&[]);
    let (plain, named) = (feeds(&plain), feeds(&named));
    assert_eq!(plain.len(), named.len());
    for (a, b) in plain.iter().zip(&named) {
        assert!((b.to[0] - a.to[0] - 100.0).abs() < 2e-4 && (a.to[5] - b.to[5] - 30.0).abs() < 2e-4, "{a:?} {b:?}");
        assert!((b.to[1] - a.to[1]).abs() < 2e-4);
    }
}

#[test]
fn moves_that_cannot_be_checked_are_never_passed_over() {
    for (lines, why) in [
        ("G1 A0 C5 X40 F500", "has not been said"),
        ("G0 X0 Y0 Z0 A0 C0\nG41 D1\nG1 X40 C20 F500", "compensation"),
        ("G0 X0 Y0 Z0 A0 C0\nG68.2 X0 Y0 Z0 I0 J20 K0\nG0 X0 Y0 Z0\nG1 X40 C20 F500", "another meaning"),
        ("G0 X0 Y0 Z0 A0 C0\nG2 X40 I20 J0 C20 F500", "arc"),
        ("G0 X0 Y0 Z0 A0 C0\nG1 X1 C1 F500\nG55 G0 X0 Y0 Z0 A0 C0\nG1 X40 C20", "not those"),
        ("G0 X0 Y0 Z0 A0 C0\nG1 X1 C1 F500\nG10 L2 P1 X5\nG0 X0 Y0 Z0 A0 C0\nG1 X40 C20", "not those"),
        ("G0 X0 Y0 Z0 A0 C0\nG1 G53 X40 C20 F500", "machine coordinates"),
        ("G0 X0 Y0 Z0 A0 C0\nG28\nG1 X40 C20 F500", "has not been said"),
        ("G0 X0 Y0 Z0 A0 C0\nG777 X1\nG1 X40 C20 F500", "has not been said"),
    ] {
        let case = Case::new(format!("G21 G90\n{lines}\nM2\n"));
        assert_eq!(case.refusal(&[]).0, "A009", "{lines}");
        let warnings = case.warnings(&["--partial"]);
        assert!(warnings.contains("left as it is") && warnings.contains(why), "{lines}: {warnings}");
    }
}

#[test]
fn another_tool_is_refused_where_its_length_counts() {
    let case = Case::new("G21 G90\nT1 M6\nG0 X0 Y0 Z0 A0 B0\nG1 X9 B9 F500\nT2 M6\nG0 X0 Y0 Z0 A0 B0\nG1 X9 B9\nM2\n");
    std::fs::write(case.0.path().join("m.toml"), HEADS.toml()).unwrap();
    assert_eq!(case.refusal(&[]).0, "A009");
    assert!(case.warnings(&["--partial"]).contains("another tool"));
}

#[test]
fn under_full_centre_point_control_there_is_nothing_to_divide_and_that_is_said() {
    for code in ["G43.4 H1", "M428", "G234"] {
        let program = format!("{START}{code}\nG0 X0 Y0 Z0\nG1 X40 Y1 C20 F500\nM2\n");
        let case = Case::new(&program);
        assert_eq!(case.text(&[]), program);
        assert!(case.warnings(&[]).contains("tool centre point control"));
        assert!(case.text(&["--tcp", "ends"]).lines().count() > 10, "{code}");
    }
}

#[test]
fn turning_a_rotary_axis_alone_is_left_as_it_is_where_words_are_joints() {
    let program = format!("{START}G1 C90 F500\nM2\n");
    let case = Case::new(&program);
    assert_eq!(case.text(&[]), program);
    assert!(case.warnings(&[]).contains("rotary axes alone"));
    assert!(case.text(&["--xyz", "tip"]).lines().count() > 10);
}

#[test]
fn a_program_with_a_loop_is_measured_as_it_runs_and_written_out_on_request() {
    let program = format!(
        "{START}F500\n#<x>=10\no100 while [#<x> LT 45]\nG1 X#<x> Y[#<x>/10] C[#<x>/2]\n#<x>=[#<x>+10]\no100 endwhile\nM2\n"
    );
    let case = Case::new(&program);
    let (found, ..) = case.refusal(&[]);
    assert_eq!(found, "A011");
    assert_eq!(case.text(&["--partial"]), program, "its own text stays");
    let text = case.text(&["--unroll"]);
    let moves = feeds(&text);
    assert!(moves.len() > 8 && !text.contains('#'));
    for x in [10.0, 20.0, 30.0, 40.0] {
        assert!(moves.iter().any(|m| m.to == [x, x / 10.0, 0.0, 0.0, 0.0, x / 2.0]), "{x}\n{text}");
    }
    assert!(text.contains("(LINE 6 IN "), "pieces name the line they come from\n{text}");
    // Within the tolerance it stays as it is.
    let coarse = Case::new(&program);
    let output = coarse.run(&["--tolerance", "50"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(std::fs::read_to_string(coarse.0.path().join("out.nc")).unwrap(), program);
}

#[test]
fn wrong_programs_are_refused_with_their_place() {
    let with = |line: &str| Case::new(format!("{START}{line}\nM2\n"));
    assert_eq!(with("G1 X1 B5 F500").refusal(&[]), code("A003", 3, 7));
    assert_eq!(with("G1 X1 X2 F500").refusal(&[]), code("A002", 3, 7));
    assert_eq!(with("G1 X9999999 C1 F500").refusal(&[]), code("A005", 3, 4));
    assert_eq!(with("G93 G1 X10 C10").refusal(&[]), code("A006", 3, 1));
    assert_eq!(with("G80\nX1").refusal(&[]), code("A004", 4, 1));
    assert_eq!(with("G1 X1 C1 F500\n%\nG1 X40 C20").refusal(&[]), code("A007", 5, 1));
    assert_eq!(with("G1 XNaN C5").refusal(&[]).1, Some(3));
    assert_eq!(with("L X+10 Y+5 R0 FMAX").refusal(&[]).1, Some(3));
    assert_eq!(Case::new("").refusal(&[]).0, "A008");
    assert_eq!(Case::new("%\n\n(nothing)\n%\n").refusal(&[]).0, "A008");
    assert_eq!(Case::new([0u8, 159, 146, 150, 1, 2, 3, 10, 255, 254]).refusal(&[]).1, Some(1));
    assert_eq!(Case::new(vec![b'X'; 10 << 20]).refusal(&[]), code("A001", 1, 1));
    for tolerance in ["0", "-1", "NaN", "inf", "1e9"] {
        assert_eq!(with("G1 X1 C1").refusal(&["--tolerance", tolerance]).0, "A010", "{tolerance}");
    }
    // Nothing in front of a cutting move says how fast: many controls stop there, so it is told.
    assert!(with("G1 X0.001 C0.001").warnings(&[]).contains("before any F"));
}

#[test]
fn wrong_machine_files_are_refused_with_their_place() {
    let case = Case::new(format!("{START}G1 X1 C1 F500\nM2\n"));
    let file = case.0.path().join("m.toml");
    for (text, line) in [
        ("version = 1\nkind = \"hexapod\"\n", 2),
        ("version = 1\nkind = \"table-table\"\n[[rotary]]\naxis = \"A\"\n[[rotary]]\naxis = \"A\"\n", 6),
        (
            "version = 1\nkind = \"table-table\"\n[[rotary]]\naxis = \"A\"\npoint_mm = [0.0, nan, 0.0]\n[[rotary]]\naxis = \"C\"\n",
            5,
        ),
        ("version = 1\nkind = ,\n", 2),
    ] {
        std::fs::write(&file, text).unwrap();
        assert_eq!(case.refusal(&[]).1, Some(line), "{text}");
    }
    std::fs::remove_file(&file).unwrap();
    assert_eq!(case.refusal(&[]).0, "F001");
}

#[test]
fn a_move_that_needs_more_pieces_than_allowed_is_refused() {
    let case = Case::new(format!("{START}G1 X60 C170 F500\nM2\n"));
    assert_eq!(case.refusal(&["--max-pieces", "4"]).0, "A009");
    assert!(case.warnings(&["--max-pieces", "4", "--partial"]).contains("more pieces"));
}

#[test]
fn outputs_are_not_overwritten_and_the_report_has_a_row_for_every_move() {
    let case = Case::new(format!("{START}G1 X40 Y1 C20 F500\nX41 C20.01\nZ5\nM2\n"));
    case.text(&["--report", "r"]);
    let folder = case.0.path();
    let again = ["multiaxis", "in.nc", "--machine", "m.toml", "--tolerance", "0.005", "-o", "out.nc", "--json"];
    let output = truepath(folder, &again);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("F003"));
    let rows = std::fs::read_to_string(folder.join("r/moves.csv")).unwrap();
    let rows: Vec<&str> = rows.lines().collect();
    assert_eq!(rows[0], "line,error_before_mm,pieces,error_after_mm,passage");
    assert!(rows.len() == 3 && rows[1].starts_with("3,") && rows[2].starts_with("4,"), "{rows:?}");
    assert!(std::fs::read_to_string(folder.join("r/errors.svg")).unwrap().contains("tolerance 0.005 mm"));
    let summary: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("r/summary.json")).unwrap()).unwrap();
    assert_eq!((summary["moves"].as_u64(), summary["straight_moves"].as_u64()), (Some(2), Some(1)));
}
