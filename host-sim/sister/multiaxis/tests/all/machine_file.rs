//! Machine files: every kind is read, and whatever is wrong is named with its place.

use truepath_ground::diagnostics::Source;
use truepath_multiaxis::Joints;
use truepath_multiaxis::machine::{Coordinates, Counted, Kind, Letter, Machine, Sense, Side};

fn read(text: &str) -> Machine {
    Machine::from_toml(&Source::new("m.toml", text.as_bytes().to_vec())).expect(text)
}

const TRUNNION: &str = "version = 1\nkind = \"table-table\"\n\n[[rotary]]\naxis = \"A\"\n\n[[rotary]]\naxis = \"C\"\n";

#[test]
fn a_small_file_has_defaults() {
    let machine = read(TRUNNION);
    assert_eq!((machine.kind(), machine.coordinates()), (Kind::TableTable, Coordinates::Joints));
    let [a, c] = machine.rotary();
    assert_eq!((a.letter, c.letter, a.side, c.side), (Letter::A, Letter::C, Side::Table, Side::Table));
    assert_eq!((a.point_mm, a.sense, a.limits_deg), ([0.0; 3], Sense::RightHand, None));
    assert_eq!((machine.tool().length_mm, machine.tool().counted), (0.0, Counted::Tip));
    assert!((machine.pole().to_degrees() - 5.0).abs() < 1e-12 && machine.orientation_tolerance().is_none());
}

#[test]
fn a_full_file_says_everything() {
    let machine = read(
        "version = 1\nkind = \"table-head\"\ncoordinates = \"tip\"\npole_deg = 3\norientation_tolerance_deg = 0.5\n\
         [[rotary]]\naxis = \"B\"\non = \"head\"\npoint_mm = [1, -2.5, 140]\nturns = \"left-hand\"\nlimits_deg = [-95, 95]\n\
         [[rotary]]\naxis = \"C\"\non = \"table\"\npoint_mm = [300, 200, 0]\n\
         [tool]\nlength_mm = 85.5\nball_radius_mm = 4\nhelix_deg = 30\ncounts = \"centre\"\n\
         [travel]\nx_mm = [-400, 400]\n",
    );
    assert_eq!((machine.kind(), machine.coordinates()), (Kind::TableHead, Coordinates::Tip));
    // The table comes first, whatever the order in the file.
    let [c, b] = machine.rotary();
    assert_eq!((c.letter, c.side, b.letter, b.side), (Letter::C, Side::Table, Letter::B, Side::Head));
    assert_eq!((b.point_mm, b.sense, b.limits_deg), ([1.0, -2.5, 140.0], Sense::LeftHand, Some([-95.0, 95.0])));
    assert_eq!((machine.place_of(Letter::B), machine.place_of(Letter::A)), (Some(1), None));
    assert_eq!(machine.counted_height_mm(), 4.0);
    let beyond = |xyz, words| machine.beyond(&Joints::from_degrees(xyz, words)).map(|b| b.letter);
    assert_eq!(beyond([0.0; 3], [1e4, 95.0]), None);
    assert_eq!(beyond([401.0, 0.0, 0.0], [0.0, 96.0]), Some('X'));
    assert_eq!(beyond([0.0; 3], [0.0, -95.1]), Some('B'));
}

#[test]
fn whatever_is_wrong_is_named_with_its_place() {
    let with = |more: &str| format!("{TRUNNION}{more}");
    let changed = |from: &str, to: &str| TRUNNION.replacen(from, to, 1);
    for (text, code, place, found) in [
        (String::new(), "J004", (1, 1), "version is missing"),
        (changed("version = 1", "version = 2"), "J010", (1, 11), "version is 2"),
        (changed("table-table", "table"), "J007", (2, 8), "kind is \"table\""),
        (changed("kind = \"table-table\"\n", ""), "J004", (1, 1), "kind is missing"),
        (changed("kind", "kimd"), "J004", (2, 1), "kind is missing"),
        (changed("\"C\"", "\"A\""), "J008", (8, 8), "both rotary axes are A"),
        (changed("\"C\"", "\"W\""), "J007", (8, 8), "rotary.axis is \"W\""),
        (changed("[[rotary]]\naxis = \"C\"\n", ""), "J008", (4, 1), "there are 1 tables [[rotary]]"),
        (with("[[rotary]]\naxis = \"B\"\n"), "J008", (4, 1), "there are 3 tables [[rotary]]"),
        (with("on = \"head\"\n"), "J008", (9, 6), "the axis is on the other side than the kind says"),
        (with("point_mm = [0, 0]\n"), "J006", (9, 12), "rotary.point_mm is [0, 0]"),
        (with("point_mm = [0, 0, 1e6]\n"), "J006", (9, 19), "rotary.point_mm is 1e6"),
        (with("point_mm = [0, 0, nan]\n"), "J006", (9, 19), "rotary.point_mm is nan"),
        (with("point_mm = 5\n"), "J005", (9, 12), "rotary.point_mm is an integer"),
        (with("limits_deg = [30, -30]\n"), "J008", (9, 14), "limits_deg goes from 30 down to -30"),
        (with("colour = 1\n"), "J003", (9, 1), "colour is no key of [rotary]"),
        (
            with("[tool]\ncounts = \"centre\"\n"),
            "J008",
            (10, 10),
            "the ball's centre counts, but there is no tool.ball_radius_mm",
        ),
        (with("[tool]\nball_radius_mm = 0\n"), "J006", (10, 18), "tool.ball_radius_mm is 0"),
        (with("[tool]\nhelix_deg = 80\n"), "J006", (10, 13), "tool.helix_deg is 80"),
        (changed("table-table", "table-head"), "J004", (4, 1), "rotary.on is missing"),
        (
            changed("table-table", "table-head")
                .replace("\"A\"", "\"A\"\non = \"head\"")
                .replace("\"C\"", "\"C\"\non = \"head\""),
            "J008",
            (10, 6),
            "both axes are on the same side",
        ),
        (changed("version = 1", "version = 1,"), "J002", (1, 12), ""),
    ] {
        let error = Machine::from_toml(&Source::new("m.toml", text.as_bytes().to_vec())).expect_err(&text);
        assert_eq!((error.code(), error.line_column()), (code, Some(place)), "{text}\n{error}");
        assert!(error.found().starts_with(found), "{error}");
    }
    let error = Machine::from_toml(&Source::new("m.toml", b"version = 1\n\xff".to_vec())).expect_err("a byte");
    assert_eq!((error.code(), error.line_column()), ("J002", Some((2, 1))));
}

/// Bytes changed, removed, doubled: an error or a machine, never a panic; and every error has a code and a help.
#[test]
fn damaged_files_end_in_an_error_or_a_machine() {
    let whole = "version = 1\nkind = \"head-head\"\npole_deg = 3\n[[rotary]]\naxis = \"C\"\npoint_mm = [1, -2.5, 140]\n\
                 limits_deg = [-95, 95]\n[[rotary]]\naxis = \"B\"\nturns = \"left-hand\"\n[tool]\nlength_mm = 85.5\n\
                 ball_radius_mm = 4\ncounts = \"centre\"\n[travel]\nx_mm = [-400, 400]\n";
    let bytes = b"0123456789.-+e_\"[]{}=,#\n\r\t \\'nainfxyABC\xff\x00";
    let mut draw = crate::machines::Draw::new(51);
    let mut machines = 0;
    for _ in 0..3_000 {
        let mut text = whole.as_bytes().to_vec();
        for _ in 0..1 + (draw.unit() * 3.0) as usize {
            let at = (draw.unit() * text.len() as f64) as usize;
            let byte = bytes[(draw.unit() * bytes.len() as f64) as usize];
            match (draw.unit() * 3.0) as usize {
                0 => text[at] = byte,
                1 => drop(text.remove(at)),
                _ => text.insert(at, byte),
            }
        }
        match Machine::from_toml(&Source::new("m.toml", text)) {
            Ok(machine) => {
                machines += 1;
                assert!(machine.forward(&Joints { xyz: [1.0; 3], rotary: [0.5; 2] }).tip.iter().all(|x| x.is_finite()));
            }
            Err(error) => assert!(error.code().starts_with('J') && error.line_column().is_some(), "{error}"),
        }
    }
    assert!((100..2_900).contains(&machines), "{machines}");
}
