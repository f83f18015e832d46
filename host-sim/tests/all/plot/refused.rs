//! What cannot be drawn is refused with its place, and nothing is left behind.

use std::fs;

use super::{runs, truepath};
use crate::workplace::refused;

fn error(arguments: &str) -> serde_json::Value {
    let out = tempfile::tempdir().unwrap();
    let arguments = arguments.replace("OUT", &out.path().display().to_string());
    let output = truepath(runs(), &format!("--json plot {arguments}"));
    assert_eq!(fs::read_dir(out.path()).unwrap().count(), 0, "{arguments} left something behind");
    let told: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!(output.status.code(), refused(told["error"]["code"].as_str().unwrap()), "{arguments}: {told}");
    told["error"].clone()
}

#[test]
fn a_wrong_wish_is_refused_with_its_code() {
    for (arguments, code) in [
        ("trace core -o OUT/p.pdf", "Z011"),
        ("trace core -o OUT/p", "Z011"),
        ("trace core -o OUT/p.svg --scale 2", "Z011"),
        ("trace core -o OUT/p.svg --width 0", "Z001"),
        ("trace core -o OUT/p.svg --height 9000", "Z001"),
        ("trace core -o OUT/p.svg --height 210", "Z001"),
        ("trace core -o OUT/p.svg --from 200", "Z002"),
        ("trace core -o OUT/p.svg --from 20 --to 10", "Z002"),
        ("trace core -o OUT/p.svg --from nan", "Z002"),
        ("error correct -o OUT/p.svg --magnify 0", "Z003"),
        ("error correct -o OUT/p.svg --magnify -5", "Z003"),
        ("error correct -o OUT/p.svg --magnify inf", "Z003"),
        ("trace core -o OUT/p.png --scale 0", "Z005"),
        ("trace core -o OUT/p.png --scale nan", "Z005"),
        ("trace core -o OUT/p.png --width 8000 --height 8000 --scale 20", "Z005"),
        ("trace correct -o OUT/p.svg", "Z012"),
        ("correction core -o OUT/p.svg", "Z012"),
        ("compare core -o OUT/p.svg", "Z012"),
        ("trace core core core core core core core core -o OUT/p.svg", "Z013"),
        ("trace core --name a --name b -o OUT/p.svg", "Z013"),
        ("trace correct/correction.csv -o OUT/p.svg", "Z006"),
        ("correction core/trace.csv -o OUT/p.svg", "Z006"),
        ("trace correct/summary.json -o OUT/p.svg", "Z006"),
        ("trace nowhere -o OUT/p.svg", "F001"),
        ("trace core --columns colour -o OUT/p.svg", "C001"),
    ] {
        assert_eq!(error(arguments)["code"], code, "{arguments}");
    }
    let title = "x".repeat(201);
    assert_eq!(error(&format!("trace core -o OUT/p.svg --title {title}"))["code"], "Z004");
}

#[test]
fn a_damaged_table_is_named_with_file_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("trace.csv");
    let whole = fs::read_to_string(runs().join("core/trace.csv")).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let with = |at: usize, line: &str| {
        let mut lines = lines.clone();
        lines[at] = line;
        lines.join("\n")
    };
    let head = lines[0];
    let cases = [
        (String::new(), "Z006", 1, 1),
        (format!("{head}\n"), "Z009", 2, 1),
        (format!("{head}\n{}\n", lines[1]), "Z009", 3, 1),
        (with(5, "1,2,3"), "Z006", 6, 1),
        (with(5, "0.4,0,0,1,1,1,wide,1,0,0,0"), "Z007", 6, 15),
        (with(5, "0.4,0,0,1,1,1,1e300,1,0,0,0"), "Z007", 6, 15),
        (with(5, "-1,0,0,1,1,1,1,1,0,0,0"), "Z008", 6, 1),
        (with(0, &head.replace("force_n", "force_lb")), "Z006", 1, 1),
    ];
    for (text, code, line, column) in cases {
        fs::write(&table, text).unwrap();
        let told = error(&format!("trace {} -o OUT/p.svg", table.display()));
        assert_eq!(told["code"], code, "{told}");
        assert_eq!((told["line"].as_u64(), told["column"].as_u64()), (Some(line), Some(column)), "{told}");
        assert!(told["file"].as_str().unwrap().ends_with("trace.csv") && told["help"].is_string());
    }
}

#[test]
fn the_wall_to_scale_needs_the_wall_of_the_same_table() {
    let folder = tempfile::tempdir().unwrap();
    let copy = |from: &str| {
        let name = from.split_once('/').unwrap().1;
        fs::copy(runs().join(from), folder.path().join(name)).unwrap();
    };
    copy("core/trace.csv");
    let draw = || error(&format!("error {} -o OUT/p.svg", folder.path().display()));
    let told = draw();
    assert!(told["code"] == "Z012" && told["message"].as_str().unwrap().contains("wall.csv"), "{told}");
    let wall = fs::read_to_string(runs().join("core/wall.csv")).unwrap();
    let lines: Vec<&str> = wall.lines().collect();
    fs::write(folder.path().join("wall.csv"), lines[..50].join("\n")).unwrap();
    let told = draw();
    assert_eq!((&told["code"], told["line"].as_u64()), (&"Z013".into(), Some(51)), "{told}");
}

#[test]
fn an_existing_picture_is_replaced_only_when_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("p.svg");
    fs::write(&file, "mine").unwrap();
    let draw = |more: &str| truepath(runs(), &format!("plot trace core -o {}{more}", file.display()));
    assert_eq!(draw("").status.code(), Some(1));
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    assert!(draw(" --force").status.success());
    assert!(fs::read_to_string(&file).unwrap().starts_with("<svg"));
}

#[test]
fn letters_a_png_cannot_show_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |name: &str| {
        truepath(runs(), &format!("plot trace core --title 壁Ø20→µm -o {}/{name}", folder.path().display()))
    };
    assert!(String::from_utf8(draw("p.png").stderr).unwrap().contains("missing in the picture: 壁;"));
    assert_eq!(String::from_utf8(draw("p.svg").stderr).unwrap(), "");
}
