//! Pictures of what the commands wrote: every kind, the values in them, their files, what is refused.

mod drawing;
mod job;
mod refused;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use resvg::tiny_skia::Pixmap;

use drawing::Drawing;

/// Folders the commands wrote: `demo`, `correct`, `before`, `after` (simulate), `compare`.
fn runs() -> &'static Path {
    static RUNS: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = RUNS.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let run = |arguments: &str| done(&truepath(folder.path(), arguments));
        run("demo -o demo");
        run("correct demo/corner-helix/job.toml --probe demo/corner-helix/probe.txt -o correct");
        run("simulate demo/corner-helix/job.toml -o core");
        run("simulate demo/corner-helix/job.toml --plant demo/corner-helix/plant.toml -o plant");
        run("compare demo/corner/job.toml --probe demo/corner/probe.txt --plant demo/corner/plant.toml -o compare");
        folder
    });
    folder.path()
}

/// Runs the program in a folder with arguments between which there are blanks.
fn truepath(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
    command.current_dir(folder).args(arguments.split(' ')).output().unwrap()
}

fn done(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Draws a picture of the runs and gives it back.
fn plot(arguments: &str, name: &str) -> Vec<u8> {
    let out = tempfile::tempdir().unwrap();
    let file = out.path().join(name);
    done(&truepath(runs(), &format!("plot {arguments} -o {}", file.display())));
    fs::read(file).unwrap()
}

fn drawing(arguments: &str) -> Drawing {
    Drawing::new(&plot(arguments, "p.svg"))
}

/// A column of a table of the runs; not a number where the field is empty.
fn column(table: &str, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(runs().join(table)).unwrap();
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|n| n == name).expect("the column");
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap_or(f64::NAN)).collect()
}

fn extremes(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().filter(|v| v.is_finite()).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)))
}

const BEFORE: &str = "#D55E00";
const AFTER: &str = "#0072B2";
const ALONG_X: &str = "#009E73";
const ALONG_Y: &str = "#CC79A7";

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn every_kind_is_drawn_as_svg_and_as_png_of_the_size_asked_for() {
    for kind in
        ["trace core", "trace core plant", "correction correct", "error correct", "error core plant", "compare compare"]
    {
        let svg = plot(kind, "p.svg");
        let text = String::from_utf8(svg.clone()).unwrap();
        assert!(text.starts_with("<svg width=\"900\"") && text.trim_end().ends_with("</svg>"), "{kind}");
        assert!(text.contains("role=\"img\"") && text.contains("<title>"), "{kind} has no name for a screen reader");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{kind}");
        assert!(svg.len() < 1_000_000, "{kind}: {} bytes", svg.len());
        assert_eq!(svg, plot(kind, "again.svg"), "{kind}: the same twice");

        let png = plot(&format!("{kind} --width 500 --height 700 --scale 1.5"), "p.PNG");
        let image = Pixmap::decode_png(&png).expect("a PNG");
        assert_eq!((image.width(), image.height()), (750, 1050), "{kind}");
        let coloured = |p: &&resvg::tiny_skia::PremultipliedColorU8| p.red().abs_diff(p.blue()) > 60;
        assert!(image.pixels().iter().filter(coloured).count() > 200, "{kind} shows no curve");
    }
    let again = |name| plot("error correct --scale 1", name);
    assert_eq!(again("a.png"), again("b.png"));
}

#[test]
fn the_extremes_of_a_trace_are_those_of_its_table() {
    let drawn = drawing("trace plant --columns error");
    let axes = drawn.axes(0);
    for (table, at) in [("error_mm", 1), ("s_mm", 0)] {
        let (low, high) = extremes(column("plant/trace.csv", table));
        let points = drawn.line(AFTER, axes);
        let (drawn_low, drawn_high) = extremes(points.iter().map(|p| [p.0, p.1][at]));
        let unit = [axes.x.unit(), axes.y.unit()][at];
        assert!(
            (drawn_low - low).abs() <= unit && (drawn_high - high).abs() <= unit,
            "{table}: {drawn_low} {drawn_high}, not {low} {high}"
        );
    }
}

#[test]
fn a_correction_is_drawn_with_its_own_values_and_the_wall_before_and_after() {
    let drawn = drawing("correction correct");
    for (panel, colour, name) in [
        (0, ALONG_X, "dx_mm"),
        (0, ALONG_Y, "dy_mm"),
        (1, BEFORE, "predicted_error_before_mm"),
        (1, AFTER, "predicted_error_after_mm"),
    ] {
        let axes = drawn.axes(panel);
        let (low, high) = extremes(column("correct/correction.csv", name));
        let (drawn_low, drawn_high) = extremes(drawn.line(colour, axes).iter().map(|p| p.1));
        let unit = axes.y.unit();
        assert!(
            (drawn_low - low).abs() <= unit && (drawn_high - high).abs() <= unit,
            "{name}: {drawn_low} {drawn_high}, not {low} {high}"
        );
    }
}

#[test]
fn the_wall_to_scale_is_where_the_tables_say_with_its_error_magnified() {
    let drawn = drawing("error correct --magnify 20");
    let axes = drawn.axes(0);
    let (unit_x, unit_y) = (axes.x.unit(), axes.y.unit());
    assert!((unit_x / unit_y - 1.0).abs() < 0.01, "both axes to the same scale: {unit_x} {unit_y}");
    let places = |name| column("correct/wall.csv", name);
    let error = column("correct/correction.csv", "predicted_error_before_mm");
    for (wall, normal, at) in [("x_mm", "nx", 0), ("y_mm", "ny", 1)] {
        // The error leaves material on the free side, against the normal.
        let milled = places(wall).into_iter().zip(places(normal)).zip(&error).map(|((w, n), e)| w - 20.0 * n * e);
        let (low, high) = extremes(milled);
        let (drawn_low, drawn_high) = extremes(drawn.line(BEFORE, axes).iter().map(|p| [p.0, p.1][at]));
        assert!(
            (drawn_low - low).abs() <= 2.0 * unit_x && (drawn_high - high).abs() <= 2.0 * unit_x,
            "{wall}: {drawn_low} {drawn_high}, not {low} {high}"
        );
    }
    // Every used reading has its mark in the picture to scale and in the diagram below, and one sign in the legend.
    let used = fs::read_to_string(runs().join("correct/points.csv")).unwrap().matches(",used,").count();
    assert_eq!((used, drawn.circles()), (15, 2 * 15 + 1));
}

#[test]
fn a_stretch_is_shown_from_end_to_end_and_nothing_beside_it() {
    let drawn = drawing("trace core plant --columns force,error --from 43.21 --to 52.05");
    let axes = drawn.axes(1);
    let (from, to) = extremes(drawn.line(BEFORE, axes).iter().map(|p| p.0));
    assert!((from - 43.21).abs() <= axes.x.unit() && (to - 52.05).abs() <= axes.x.unit(), "{from} {to}");
    assert_eq!(drawn.texts().filter(|t| *t == "core").count(), 2, "the names are the folders'");
    let named = drawing("trace core plant --columns arc --name model --name machine");
    assert!(named.texts().any(|t| t == "model") && named.texts().any(|t| t == "machine"));
}

#[test]
fn a_long_contour_keeps_its_peak_and_stays_below_a_megabyte() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = "s_mm,x_mm,y_mm,arc_deg,chip_area_mm2,force_n,fx_n,fy_n,dx_mm,dy_mm,error_mm\n".to_owned();
    for k in 0..150_000 {
        let s = f64::from(k) * 0.1;
        let error = if k == 77_777 { 0.9 } else { (s * 3.7).sin() * 0.1 };
        let force = if (1000..1010).contains(&k) { String::new() } else { format!("{:.3}", 100.0 + s.cos()) };
        table += &format!("{s:.1},{s:.1},0,30,1,{force},1,2,{error:.5},0.1,{error:.5}\n");
    }
    fs::write(folder.path().join("trace.csv"), table).unwrap();
    done(&truepath(folder.path(), "plot trace . -o p.svg --name long"));
    let svg = fs::read(folder.path().join("p.svg")).unwrap();
    assert!(svg.len() < 1_000_000, "{} bytes", svg.len());
    let drawn = Drawing::new(&svg);
    let axes = drawn.axes(3);
    let points = drawn.line(AFTER, axes);
    let peak = points.iter().copied().fold((0.0, 0.0), |best, p| if p.1 > best.1 { p } else { best });
    assert!((peak.0 - 7777.7).abs() <= axes.x.unit() && (peak.1 - 0.9).abs() <= axes.y.unit(), "{peak:?}");
}

#[test]
fn the_tables_have_the_columns_that_are_agreed() {
    let first = |table: &str| fs::read_to_string(runs().join(table)).unwrap().lines().next().unwrap().to_owned();
    let trace = "s_mm,x_mm,y_mm,arc_deg,chip_area_mm2,force_n,fx_n,fy_n,dx_mm,dy_mm,error_mm";
    let correction = "s_mm,x_mm,y_mm,dx_mm,dy_mm,predicted_error_before_mm,predicted_error_after_mm,sigma_mm";
    assert_eq!((first("core/trace.csv"), first("plant/trace.csv")), (trace.to_owned(), trace.to_owned()));
    assert_eq!(first("correct/correction.csv"), correction);
    for folder in ["core", "plant", "correct", "demo/corner"] {
        assert_eq!(first(&format!("{folder}/wall.csv")), "s_mm,x_mm,y_mm,nx,ny");
    }
    assert_eq!(column("core/wall.csv", "s_mm"), column("core/trace.csv", "s_mm"));
}

#[test]
fn the_pictures_of_the_documents_are_what_the_program_draws() {
    let docs = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let drawn = [
        ("plot-error.svg", plot("error demo/pocket", "p.svg")),
        ("plot-trace.svg", plot("trace core plant --name model --name machine --columns arc,force,error", "p.svg")),
        ("before-after.svg", fs::read(runs().join("demo/corner/before-after.svg")).unwrap()),
    ];
    for (name, picture) in drawn {
        if std::env::var_os("BLESS").is_some() {
            fs::write(docs.join(name), &picture).unwrap();
        }
        assert!(fs::read(docs.join(name)).unwrap() == picture, "docs/{name} is another picture: BLESS=1 renews it");
    }
}
