//! What stands in the programs, and what never does.

use truepath_correction::verification::{ProbeDialect, Settings, write};

use super::parts::{PARTS, POCKET, pass, planned, pocket_in_inches};

const ALL: [ProbeDialect; 4] = [ProbeDialect::Haas, ProbeDialect::Fanuc, ProbeDialect::Linuxcnc, ProbeDialect::Grbl];

/// The lines that are executed, without comments.
fn code(program: &str) -> impl Iterator<Item = &str> {
    program.lines().map(|l| l.split(['(', ';']).next().unwrap_or_default().trim()).filter(|l| !l.is_empty())
}

#[test]
fn no_program_changes_an_offset_or_turns_the_spindle() {
    for part in PARTS {
        let plan = planned(&pass(part, &[]), &Settings::default());
        for dialect in ALL {
            let program = write(&plan, dialect, "log.txt").unwrap();
            for line in code(&program) {
                let words: Vec<&str> = line.split(' ').collect();
                for forbidden in ["G10", "G92", "G52", "G53", "M3", "M4", "M03", "M04", "S", "G91"] {
                    assert!(!words.contains(&forbidden), "{dialect:?}: {line}");
                }
                let call = words.contains(&"G65");
                assert!(
                    !call || words.iter().all(|w| !w.starts_with(['T', 'S', 'W', 'M', 'H'])),
                    "{dialect:?}: {line}"
                );
                // Nothing is assigned: a # stands in what is printed or compared only.
                assert!(!line.starts_with('#') || line.starts_with("#3000=1"), "{dialect:?}: {line}");
            }
        }
    }
}

#[test]
fn header_and_footer_name_part_unit_ball_and_count() {
    let plan = planned(&pass(POCKET, &[]), &Settings::default());
    let crc = format!("{:08X}", truepath_core::gcode::program_crc(POCKET[1].as_bytes()));
    for dialect in ALL {
        let program = write(&plan, dialect, "log.txt").unwrap();
        assert!(program.contains(&format!("(PART PROGRAM PROGRAM.NC, CRC32 {crc})")), "{program}");
        assert!(program.contains("(POINTS 24, PLACES 8, HEIGHTS 3, BALL 4.000 MM)"));
        assert!(program.lines().any(|l| l.starts_with("G21 G17 G40")) && program.lines().any(|l| l == "G54"));
        let footer = ["(END OF 24)", ";VERIFY END 24"];
        assert!(program.lines().rev().take(9).any(|l| footer.contains(&l)), "{program}");
        assert!(program.is_ascii());
        assert!(program.lines().all(|l| l.len() < 120 && l.matches('(').count() <= 1));
    }
}

#[test]
fn a_probe_in_the_tool_table_is_called_and_else_the_operator_is_asked() {
    let pass = pass(POCKET, &[]);
    let with = planned(&pass, &Settings { probe_tool: Some(20), ..Settings::default() });
    let without = planned(&pass, &Settings::default());
    for dialect in [ProbeDialect::Haas, ProbeDialect::Fanuc, ProbeDialect::Linuxcnc] {
        let called = write(&with, dialect, "log.txt").unwrap();
        assert!(called.contains("T20 M6\n") && called.contains("G43 H20") && !called.contains("\nM0\n"), "{called}");
        let asked = write(&without, dialect, "log.txt").unwrap();
        assert!(asked.contains("\nM0\n") && !asked.contains("M6\n") && !asked.contains("G43"), "{asked}");
        // Safe height before anything else moves.
        let first = code(&asked).find(|l| l.contains(['X', 'Y', 'Z'])).unwrap();
        assert_eq!(first.split(' ').next_back().unwrap().parse_z(), 100.0);
    }
    assert_eq!(write(&with, ProbeDialect::Grbl, "log.txt").unwrap_err().code(), "V005");
}

/// The page of the documentation shows a program of each control as it is written: one place, one height.
/// `BLESS=1 cargo test` renews them.
#[test]
fn the_documentation_shows_the_programs_as_they_are() {
    let page = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/verification.md");
    let mut text = std::fs::read_to_string(&page).unwrap();
    let plan = planned(&pass(POCKET, &[]), &Settings { places: 1, heights: Some(1), ..Settings::default() });
    for dialect in ALL {
        let name = format!("{dialect:?}").to_lowercase();
        let (begin, end) = (format!("<!-- {name} begin -->\n"), format!("<!-- {name} end -->"));
        let from = text.find(&begin).unwrap_or_else(|| panic!("no {begin}")) + begin.len();
        let to = text.find(&end).unwrap_or_else(|| panic!("no {end}"));
        let shown = format!("```text\n{}```\n", write(&plan, dialect, "verify-log.txt").unwrap());
        if std::env::var_os("BLESS").is_some() {
            text.replace_range(from..to, &shown);
            std::fs::write(&page, &text).unwrap();
        } else {
            assert_eq!(&text[from..to], shown, "{name}: BLESS=1 renews it");
        }
    }
}

trait ParseZ {
    fn parse_z(&self) -> f64;
}

impl ParseZ for str {
    fn parse_z(&self) -> f64 {
        self.trim_start_matches('Z').parse().unwrap()
    }
}

#[test]
fn work_offsets_that_a_control_lacks_are_refused() {
    let mut plan = planned(&pass(POCKET, &[("G54\n", "G57\n")]), &Settings::default());
    assert_eq!(plan.program.work_offset, 4);
    for (offset, codes) in [
        (8, [None, None, Some("G59.2"), None]),
        (21, [Some("G154 P12"), Some("G54.1 P12"), None, None]),
        (4, [Some("G57"); 4]),
    ] {
        plan.program.work_offset = offset;
        for (dialect, code) in ALL.into_iter().zip(codes) {
            match (write(&plan, dialect, "log.txt"), code) {
                (Ok(program), Some(code)) => assert!(program.lines().any(|l| l == code), "{dialect:?} {offset}"),
                (Err(error), None) => assert_eq!(error.code(), "V005"),
                (result, _) => panic!("{dialect:?} {offset}: {result:?}"),
            }
        }
    }
}

#[test]
fn an_inch_program_is_probed_in_inches() {
    let inches = pocket_in_inches();
    let inch = planned(&pass([&inches[0], &inches[1]], &[]), &Settings::default());
    let program = write(&inch, ProbeDialect::Linuxcnc, "log.txt").unwrap();
    assert!(
        program.contains("\nG20 G17")
            && program.contains("(LOG,# unit inch)")
            && program.contains("(LOG,# ball 0.15748)")
    );
    assert!(program.contains("G0 Z3.93701\n"), "100 mm");
    let stand_off = inch.stand_off(&inch.places[0]).map(|v| v / 25.4);
    assert!(program.contains(&format!("G0 X{:.5} Y{:.5}\n", stand_off[0], stand_off[1])), "{stand_off:?}");
    assert!(program.contains(" F11.81\n"), "300 mm/min");
}
