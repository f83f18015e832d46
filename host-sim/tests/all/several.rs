//! Several finishing contours of one program, from the probing program to the corrected part and the next one.

use serde_json::Value;

use crate::workplace::{Workplace, plant, pocket_job};

/// A pocket and its island, cut with one cutter.
const POCKET_AND_ISLAND: &str = "G21 G90 G17\nT2 M6\nS9000 M3\nG0 X28 Y6 Z10\nG1 Z-7 F300\nG3 X30 Y4 I2 J0 F700\n\
    G1 X50\nG3 X56 Y10 I0 J6\nG1 Y30\nG3 X50 Y36 I-6 J0\nG1 X10\nG3 X4 Y30 I0 J-6\nG1 Y10\nG3 X10 Y4 I6 J0\nG1 X30\n\
    G3 X32 Y6 I0 J2\nG0 Z10\nX28 Y31\nG1 Z-7 F300\nG3 X30 Y29 I2 J0 F700\n\
    G1 X36\nG2 X42 Y23 I0 J-6\nG1 Y17\nG2 X36 Y11 I-6 J0\nG1 X24\nG2 X18 Y17 I0 J6\nG1 Y23\nG2 X24 Y29 I6 J0\nG1 X30\n\
    G3 X32 Y31 I0 J2\nG0 Z10\nM30\n";

/// A folder with a program, its job, and a machine that the job does not state.
fn workplace(program: &str) -> Workplace {
    let plant = plant("[[0.0006, 0.00002], [0.00002, 0.0005]]");
    Workplace::with(&[("part.nc", program), ("job.toml", &pocket_job(7.0, 2300)), ("plant.toml", &plant)])
}

/// Probing program, first part and its points.
fn first_part(desk: &Workplace) -> Value {
    desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first")
}

/// Largest wall errors of the contours of a simulation, mm.
fn errors(summary: &Value) -> Vec<f64> {
    let contours = summary["contours"].as_array().expect("contours");
    contours.iter().map(|one| one["max_error_mm"].as_f64().expect("an error")).collect()
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn every_contour_is_touched_corrected_together_and_better() {
    let desk = workplace(POCKET_AND_ISLAND);
    let plan = desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    let mut places: Vec<(String, String)> = Vec::new();
    for point in plan["points"].as_array().expect("points") {
        places.push((point["contour"].as_str().expect("a contour").to_owned(), point["s_mm"].to_string()));
    }
    places.dedup();
    for contour in ["contour-1", "contour-2"] {
        assert!(places.iter().filter(|(of, _)| of == contour).count() >= 2, "{contour}: {places:?}");
    }
    let first = desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    let done = desk.call("correct job.toml --probe first/probe.txt -o out");
    let contours = done["contours"].as_array().expect("contours");
    assert_eq!(contours.len(), 2);
    assert_eq!(contours[0]["identified"], contours[1]["identified"], "one machine cut both");
    let used: u64 = contours.iter().map(|one| one["points_used"].as_u64().expect("points")).sum();
    assert_eq!(done["points_used"].as_u64(), Some(used));
    let second = desk.call("simulate job.toml --plant plant.toml --from out --touch verify.nc -o second");
    let (before, after) = (errors(&first), errors(&second));
    assert!(before.iter().zip(&after).all(|(before, after)| *after < 0.25 * before), "{before:?} became {after:?}");
    // Two walls tell more of the machine than one.
    let alone = desk.call("correct job.toml --feature contour-2 --probe first/probe.txt -o alone");
    let sigma = |summary: &Value| summary["identified"]["compliance"]["sigma"].as_f64().expect("a sigma");
    assert!(sigma(&done) < sigma(&alone), "{} {}", sigma(&done), sigma(&alone));

    let learned = desk.call("learn job.toml --probe second/probe.txt --from out -o next");
    assert_eq!(learned["contours"].as_array().expect("contours").len(), 2);
    let third = desk.call("simulate job.toml --plant plant.toml --from next -o third");
    assert!(errors(&third).iter().zip(&before).all(|(after, before)| *after < 0.25 * before), "{third}");
    let report = desk.call("inspect job.toml --probe second/probe.txt --tolerance 0.05 -o inspected");
    assert_eq!(report["summary"]["contours"].as_array().expect("contours").len(), 2);
    assert!(desk.path().join("inspected/contours/contour-2/points.csv").exists());
}

#[test]
fn a_contour_that_nobody_touched_keeps_its_bytes_and_the_part_does_not_pass() {
    let desk = workplace(POCKET_AND_ISLAND);
    first_part(&desk);
    desk.call("probe job.toml --feature contour-1 --dialect linuxcnc -o one.nc");
    desk.call("simulate job.toml --plant plant.toml --touch one.nc -o only");
    let done = desk.call("correct job.toml --probe only/probe.txt -o out");
    let corrected: Vec<bool> =
        done["contours"].as_array().expect("contours").iter().map(|c| c["corrected"] == true).collect();
    assert_eq!(corrected, [true, false]);
    assert!(done["warnings"].to_string().contains("contour-2 (lines 21-29) stays as it is"), "{}", done["warnings"]);
    let (original, written) = (POCKET_AND_ISLAND.to_owned(), desk.read("out/corrected.nc"));
    for line in original.lines().skip(20).take(9) {
        assert!(written.lines().any(|l| l == line), "{line} has changed");
    }
    let report = desk.call("inspect job.toml --probe only/probe.txt --tolerance 1");
    assert_eq!(report["summary"]["verdict"]["state"], "open");
    let said = desk.run("learn job.toml --probe only/probe.txt --from first -o next").expect_err("no history");
    assert!(said.contains("Q001"), "{said}");
    // The next part is touched on one of two corrected contours only.
    desk.call("correct job.toml --probe first/probe.txt -o both");
    desk.call("simulate job.toml --plant plant.toml --from both --touch one.nc -o second");
    let said = desk.run("learn job.toml --probe second/probe.txt --from both -o next").expect_err("not touched");
    assert!(said.contains("Q010") && said.contains("contour-2"), "{said}");
    assert!(!desk.path().join("next").exists());
}

/// What a probe file says after its readings were changed, one by one.
fn changed(log: &str, change: impl Fn(usize, [f64; 2]) -> [f64; 2]) -> String {
    let mut at = 0;
    let line = |line: &str| {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        if fields.len() == 9 && !line.starts_with('#') {
            let place = change(at, [5, 6].map(|k: usize| fields[k].parse().expect("a number")));
            at += 1;
            for (field, value) in fields[5..7].iter_mut().zip(place) {
                *field = format!("{value:.6}");
            }
        }
        fields.join(",") + "\n"
    };
    log.lines().map(line).collect()
}

#[test]
fn a_wild_touch_spoils_nothing_and_a_wrong_unit_is_named() {
    let desk = workplace(POCKET_AND_ISLAND);
    first_part(&desk);
    let log = desk.read("first/probe.txt");
    let count = log.lines().filter(|l| !l.starts_with('#')).count();
    // The last two readings, of the contour with fewest of them, are two millimetres off.
    let wild = changed(&log, |at, [x, y]| if at + 2 >= count { [x + 2.0, y + 2.0] } else { [x, y] });
    desk.write("wild.txt", &wild);
    let done = desk.call("correct job.toml --probe wild.txt -o out");
    assert_eq!(done["points_rejected"].as_u64().unwrap() + done["points_outlying"].as_u64().unwrap(), 2, "{done}");
    desk.write("inch.txt", changed(&log, |_, place| place.map(|v| v / 25.4)));
    let said = desk.run("correct job.toml --probe inch.txt -o never").expect_err("inches");
    assert!(said.contains("M011"), "{said}");
    assert!(!desk.path().join("never").exists());
}

/// The two contours as lines and arcs of whole micrometres, in a frame of one's own.
fn placed(map: impl Fn([i64; 2]) -> [i64; 2], ccw: bool) -> String {
    let um = |v: i64| format!("{}{}.{:03}", if v < 0 { "-" } else { "" }, v.abs() / 1000, v.abs() % 1000);
    let at = |p: [i64; 2]| {
        let [x, y] = map([p[0] * 1000, p[1] * 1000]);
        format!("X{} Y{}", um(x), um(y))
    };
    let by = |d: [i64; 2]| {
        let ([x, y], [x0, y0]) = (map([d[0] * 1000, d[1] * 1000]), map([0, 0]));
        format!("I{} J{}", um(x - x0), um(y - y0))
    };
    let (g2, g3) = if ccw { ("G2", "G3") } else { ("G3", "G2") };
    let mut text = "G21 G90 G17\nT2 M6\nS9000 M3\n".to_owned();
    let mut go = |line: String| text += &(line + "\n");
    go(format!("G0 {} Z10", at([30, 4])));
    go("G1 Z-7 F700".to_owned());
    for (end, arc) in [
        ([50, 4], None),
        ([56, 10], Some([0, 6])),
        ([56, 30], None),
        ([50, 36], Some([-6, 0])),
        ([10, 36], None),
        ([4, 30], Some([0, -6])),
        ([4, 10], None),
        ([10, 4], Some([6, 0])),
        ([30, 4], None),
    ] {
        go(arc.map_or_else(|| format!("G1 {}", at(end)), |c| format!("{g3} {} {}", at(end), by(c))));
    }
    go(format!("G0 Z10\n{}", at([30, 29])));
    go("G1 Z-7 F700".to_owned());
    for (end, arc) in [
        ([36, 29], None),
        ([42, 23], Some([0, -6])),
        ([42, 17], None),
        ([36, 11], Some([-6, 0])),
        ([24, 11], None),
        ([18, 17], Some([0, 6])),
        ([18, 23], None),
        ([24, 29], Some([6, 0])),
        ([30, 29], None),
    ] {
        go(arc.map_or_else(|| format!("G1 {}", at(end)), |c| format!("{g2} {} {}", at(end), by(c))));
    }
    text + "G0 Z10\nM30\n"
}

#[test]
fn together_turned_and_shifted_they_are_corrected_to_the_last_bit_alike() {
    let plain = workplace(&placed(|p| p, true));
    first_part(&plain);
    plain.call("correct job.toml --probe first/probe.txt -o out");
    let log = plain.read("first/probe.txt");
    // A quarter turn about the origin, then a shift; the readings and their nominal places alike.
    let turned = workplace(&placed(|[x, y]| [-y + 7_000, x - 13_000], true));
    let line = |line: &str| {
        let mut f: Vec<String> = line.split(',').map(str::to_owned).collect();
        if f.len() == 9 && !line.starts_with('#') {
            let n = |k: usize| f[k].parse::<f64>().expect("a number");
            let (nx, ny, wx, wy, x, y) = (n(1), n(2), n(3), n(4), n(5), n(6));
            let six = |v: f64| format!("{v:.6}");
            (f[1], f[2]) = (six(-ny), six(nx));
            (f[3], f[4]) = (six(-wy + 7.0), six(wx - 13.0));
            (f[5], f[6]) = (six(-y + 7.0), six(x - 13.0));
        }
        if line.starts_with("# program") { String::new() } else { f.join(",") + "\n" }
    };
    turned.write("probe.txt", log.lines().map(line).collect::<String>());
    turned.call("correct job.toml --probe probe.txt -o out");
    for contour in ["contour-1", "contour-2"] {
        let rows = |desk: &Workplace| -> Vec<Vec<String>> {
            let text = desk.read(&format!("out/contours/{contour}/correction.csv"));
            text.lines().skip(1).map(|l| l.split(',').map(str::to_owned).collect()).collect()
        };
        let (a, b) = (rows(&plain), rows(&turned));
        assert_eq!(a.len(), b.len());
        let negated = |v: &str| match v.strip_prefix('-') {
            Some(rest) => rest.to_owned(),
            None if v.bytes().all(|c| matches!(c, b'0' | b'.')) => v.to_owned(),
            None => format!("-{v}"),
        };
        for (a, b) in a.iter().zip(&b) {
            assert_eq!((&a[0], &negated(&a[4]), &a[3]), (&b[0], &b[3], &b[4]), "{contour}: {a:?} {b:?}");
            assert_eq!(a[5..], b[5..], "{contour}");
        }
    }
}

#[test]
fn cutters_and_roughing_the_other_way_are_asked_about() {
    let two = POCKET_AND_ISLAND.replace("G0 Z10\nX28 Y31", "G0 Z10\nT3 M6\nG0 X28 Y31");
    let desk = workplace(&two);
    let said = desk.run("probe job.toml --dialect linuxcnc -o verify.nc").expect_err("two cutters");
    assert!(said.contains("G071") && said.contains("number in [tool]"), "{said}");
    desk.write("job.toml", pocket_job(7.0, 2300).replace("[tool]", "[tool]\nnumber = 3"));
    let plan = desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    assert!(plan["points"].as_array().expect("points").iter().all(|p| p["line"].as_u64() > Some(19)), "{plan}");

    // A straight wall, roughed against the direction of finishing, half a millimetre before it.
    let legs = "G21 G90 G17\nT1 M6\nS4000 M3\nG0 X-5.5 Y60 Z10\nG1 Z-7 F500\nG1 Y0 F600\nG1 X-5.5 Y-20\nG0 Z10\nX-5 Y-20\n\
        G1 Z-7 F500\nG1 Y60 F600\nG0 Z10\nM30\n";
    let desk = workplace(legs);
    let said = desk.run("probe job.toml --dialect linuxcnc -o verify.nc").expect_err("one may be roughing");
    assert!(said.contains("G071") && said.contains("roughing of the other"), "{said}");
    desk.call("probe job.toml --feature contour-2 --dialect linuxcnc -o verify.nc");
}

#[test]
fn a_contour_that_cannot_be_read_does_not_keep_the_others_from_being_corrected() {
    // The island is cut at a feed per revolution of a spindle that stands.
    let island = POCKET_AND_ISLAND
        .replace("X28 Y31\nG1 Z-7 F300\nG3 X30 Y29 I2 J0 F700", "M5\nX28 Y31\nG1 Z-7 F300\nG3 X30 Y29 I2 J0 F700\nS0");
    let desk = workplace(&island);
    let plan = desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    assert!(plan["warnings"].to_string().contains("contour-2 is left as it is"), "{}", plan["warnings"]);
}
