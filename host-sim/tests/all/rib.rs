//! Dimensions between two contours: the rib between two pockets, proposed, typed in, corrected from and learned from.

use serde_json::Value;

use crate::workplace::{Workplace, plant};

/// A pocket about a middle, cut along the path of the centre of a cutter of 8 mm.
fn pocket([x, half_x, half_y]: [f64; 3]) -> String {
    let ([a, b], [d, e]) = ([x - half_x + 4.0, x + half_x - 4.0], [4.0 - half_y, half_y - 4.0]);
    format!(
        "G0 X{x} Y{} Z10\nG1 Z-6 F300\nG3 X{} Y{d} I2 J0 F600\nG1 X{}\nG3 X{b} Y{} I0 J2\nG1 Y{}\nG3 X{} Y{e} I-2 J0\n\
         G1 X{}\nG3 X{a} Y{} I0 J-2\nG1 Y{}\nG3 X{} Y{d} I2 J0\nG1 X{}\nG3 X{} Y{} I0 J2\nG0 Z10\n",
        d + 2.0,
        x + 2.0,
        b - 2.0,
        d + 2.0,
        e - 2.0,
        b - 2.0,
        a + 2.0,
        e - 2.0,
        d + 2.0,
        a + 2.0,
        x + 2.0,
        x + 4.0,
        d + 2.0
    )
}

/// Two pockets with a rib of 6 mm between them, from X15 to X21, for somebody who owns no probe.
fn workplace() -> Workplace {
    let program =
        format!("G21 G90 G17\nT2 M6\nS6000 M3\n{}{}M30\n", pocket([0.0, 15.0, 10.0]), pocket([34.0, 13.0, 10.0]));
    let job = "version = 1\nprogram = \"part.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.5\n[tool]\ndiameter_mm = 8.0\n\
        teeth = 4\nhelix_deg = 38.0\n[cut]\naxial_depth_mm = 6.0\n[force]\nmaterial = \"al-6082-t6\"\n[machine]\n\
        stiffness_x_n_per_mm = 1900\nstiffness_y_n_per_mm = 1900\n";
    // Along x it yields three times as much as along y.
    let plant = plant("[[0.0012, 0.0], [0.0, 0.0004]]");
    Workplace::with(&[("part.nc", &program), ("job.toml", job), ("plant.toml", &plant)])
}

/// Places of the walls of both contours as they were cut, `[z, x, y]`, mm.
fn cut(desk: &Workplace, folder: &str) -> Vec<[f64; 3]> {
    let of = |contour: &str| {
        let text = desk.read(&format!("{folder}/contours/{contour}/probed-wall.csv"));
        let row = |line: &str| -> Option<[f64; 3]> {
            let fields: Vec<f64> = line.split(',').filter_map(|field| field.parse().ok()).collect();
            fields.try_into().ok()
        };
        text.lines().filter_map(row).collect::<Vec<_>>()
    };
    [of("contour-1"), of("contour-2")].concat()
}

/// What an instrument without error reads of a dimension of a sheet, mm: between the places of the walls nearest to its line and its
/// height.
fn read(walls: &[[f64; 3]], d: &Value) -> f64 {
    let number = |value: &Value| value.as_f64().expect("a number");
    let along = if d["along"] == "x" { 1 } else { 2 };
    let (z, across) = (number(&d["z_mm"]), number(&d["across_mm"]));
    let at = |near: f64| {
        let off = |p: &&[f64; 3]| {
            let on_wall = (p[along] - near).abs() < 1.0;
            if on_wall { (p[0] - z).hypot(p[3 - along] - across) } else { f64::INFINITY }
        };
        walls.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a wall")[along]
    };
    at(number(&d["walls_mm"][1])) - at(number(&d["walls_mm"][0]))
}

/// The sheet's file with what is read on walls typed in, but of the dimensions that are left out.
fn typed(desk: &Workplace, plan: &Value, walls: &[[f64; 3]], to: &str, keep: impl Fn(&Value) -> bool) {
    let empty = desk.read("widths.toml");
    let mut tables = empty.split("\n[[dimension]]");
    let mut text = tables.next().expect("a head").to_owned();
    for (d, table) in plan["dimensions"].as_array().expect("dimensions").iter().zip(tables) {
        if keep(d) {
            let value = format!("value_mm = \"{:.3}\"", read(walls, d));
            text += &format!("\n[[dimension]]{}", table.replace("value_mm = \"\"", &value));
        }
    }
    desk.write(to, text);
}

fn is_rib(d: &Value) -> bool {
    d["to_contour"].is_string()
}

/// Largest wall error of a simulation, mm.
fn largest(summary: &Value) -> f64 {
    summary["contours"]
        .as_array()
        .expect("contours")
        .iter()
        .filter_map(|c| c["max_error_mm"].as_f64())
        .fold(0.0, f64::max)
}

#[test]
fn the_sheet_proposes_the_rib_and_the_next_part_is_right_on_both_sides_of_it() {
    let desk = workplace();
    // It reaches neither length of a pocket: along X the rib alone.
    let plan = desk.call("probe job.toml --dimensions --instrument micrometer --reach 25 --points 6 -o widths.html");
    let all = plan["dimensions"].as_array().expect("dimensions");
    let ribs: Vec<&Value> = all.iter().filter(|d| is_rib(d)).collect();
    assert!(!ribs.is_empty() && ribs.len() < all.len(), "{plan}");
    for rib in &ribs {
        assert_eq!([&rib["kind"], &rib["along"]], ["thickness", "x"], "{rib}");
        assert_eq!([&rib["contour"], &rib["to_contour"]], ["contour-1", "contour-2"], "{rib}");
        assert_eq!((rib["walls_mm"][0].as_f64(), rib["nominal_mm"].as_f64()), (Some(15.0), Some(6.0)), "{rib}");
    }
    let own = |d: &&Value| !is_rib(d);
    assert!(all.iter().filter(own).all(|d| d["along"] == "y" && d["contour"].is_string()), "{plan}");
    let sheet = desk.read("widths.html");
    assert!(sheet.contains("contour-1 to contour-2: thickness along X"), "{sheet}");

    let first = desk.call("simulate job.toml --plant plant.toml --probed-wall -o first");
    typed(&desk, &plan, &cut(&desk, "first"), "first.toml", |_| true);
    let done = desk.call("correct job.toml --dimensions first.toml -o out");
    assert_eq!(done["points_outlying"], 0);
    let second = desk.call("simulate job.toml --plant plant.toml --from out -o second");
    let [before, after] = [largest(&first), largest(&second)];
    assert!(before > 0.04 && after < before / 4.0, "{before} became {after}");
}

#[test]
fn learning_from_the_rib_mends_what_widths_along_y_left() {
    let desk = workplace();
    let plan = desk.call("probe job.toml --dimensions --instrument micrometer --reach 25 --points 6 -o widths.html");
    let first = desk.call("simulate job.toml --plant plant.toml --probed-wall -o first");
    typed(&desk, &plan, &cut(&desk, "first"), "first.toml", |d| !is_rib(d));
    desk.call("correct job.toml --dimensions first.toml -o out");
    let second = desk.call("simulate job.toml --plant plant.toml --from out --probed-wall -o second");
    typed(&desk, &plan, &cut(&desk, "second"), "second.toml", |_| true);
    let learned = desk.call("learn job.toml --dimensions second.toml --from out -o next");
    assert_eq!(learned["contours"].as_array().map(Vec::len), Some(2));
    let third = desk.call("simulate job.toml --plant plant.toml --from next -o third");
    let errors = [first, second, third].map(|summary| largest(&summary));
    assert!(errors[1] < errors[0] && errors[2] < errors[1] / 3.0, "{errors:?}");
}
