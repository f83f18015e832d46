//! Stock that is touched before the finishing pass: the program that does it, its results, and the correction over them.

use std::fs;
use std::path::Path;

use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_correction::verification::{Plan, ProbeDialect, STOCK_HEIGHTS, Settings, plan_stock, write};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::levels;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{KnownStock, Pass};
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

macro_rules! demo {
    ($file:literal) => {
        include_str!(concat!("../../../demo/", $file))
    };
}

/// A boss milled round outside, 60 by 40 mm with corners of 4 mm, with the pocket's cutter.
const BOSS: &str = "%\nO0003 (FINISHING A BOSS, CLIMB)\nG00 G90 G49 G40 G17 G21\nG54\nT02 M06\nS3200 M03\nG00 X0. Y25. Z10.\n\
    G01 Z-12. F600.\nG01 X26. Y25.\nG02 X35. Y16. I0. J-9.\nG01 X35. Y-16.\nG02 X26. Y-25. I-9. J0.\nG01 X-26. Y-25.\n\
    G02 X-35. Y-16. I0. J9.\nG01 X-35. Y16.\nG02 X-26. Y25. I9. J0.\nG01 X0. Y25.\nG00 Z100.\nM30\n%\n";

/// A contour, its job and its machine with even stock, and where its finished wall is touched, mm.
struct Contour {
    name: &'static str,
    job: &'static str,
    program: &'static str,
    plant: &'static str,
    places: &'static [f64],
    /// Where a step begins, mm.
    step_mm: f64,
}

const CORNER: Contour = Contour {
    name: "corner",
    job: demo!("corner-helix/job.toml"),
    program: demo!("corner-helix/program.nc"),
    plant: demo!("corner-helix/plant.toml"),
    places: &[12.0, 22.0, 32.0, 42.0, 50.0, 62.0, 76.0, 90.0],
    step_mm: 60.0,
};
const POCKET: Contour = Contour {
    name: "pocket",
    job: demo!("pocket/job.toml"),
    program: demo!("pocket/program.nc"),
    plant: demo!("pocket/plant.toml"),
    places: &[12.0, 29.0, 45.0, 66.0, 92.0, 110.0, 145.0, 180.0],
    step_mm: 90.0,
};
const OUTSIDE: Contour = Contour {
    name: "outside",
    program: BOSS,
    places: &[12.0, 33.0, 55.0, 80.0, 105.0, 135.0, 160.0, 190.0],
    step_mm: 100.0,
    ..POCKET
};

fn source(name: &str, text: &str) -> Source {
    Source::new(name, text.as_bytes().to_vec())
}

/// The machine with more keys in the file of the plant.
fn machine(contour: &Contour, more: &str) -> Machine {
    toml::from_str(&format!("{}\n{more}", contour.plant)).unwrap()
}

/// The pass of a contour, over what a file of touches says of its stock.
fn over(contour: &Contour, stock: Option<&str>) -> Result<Pass, Failure> {
    let folder = tempfile::tempdir().unwrap();
    let mut job = contour.job.to_owned();
    if let Some(stock) = stock {
        fs::write(folder.path().join("stock.txt"), stock).unwrap();
        job = job.replace("[stock]", "[stock]\nprobe = \"stock.txt\"");
    }
    Pass::new(JobFile::parse(source("job.toml", &job), folder.path()).unwrap(), source("program.nc", contour.program))
}

fn planned(pass: &Pass, places: Option<u32>) -> Plan {
    let settings = Settings { heights: Some(STOCK_HEIGHTS), ..Settings::default() };
    plan_stock(std::slice::from_ref(pass), &settings, (places, None)).unwrap()
}

/// What the control prints while it touches the stock of a machine.
fn touched(pass: &Pass, machine: &Machine, dialect: ProbeDialect) -> String {
    let program = write(&planned(pass, None), dialect, "log.txt").unwrap();
    virtual_mill::touch_stock(std::slice::from_ref(pass), machine, &source("stock.nc", &program)).unwrap()
}

/// The largest error, mean over the height, of the part that is cut with the correction of a part touched on its wall; mm.
/// None where its points are taken for those of another datum: one wall with more stock than the other looks like it.
fn left(contour: &Contour, pass: &Pass, machine: &Machine) -> Option<f64> {
    let first = virtual_mill::mill(pass, machine, None).unwrap();
    let ball = pass.job.require_probe().unwrap().ball_diameter.nm() as f64 / 1e6;
    let probe = virtual_mill::probe(pass, &first, contour.places, &[0.15, 0.5, 0.85], ball).unwrap();
    let measurement = Measurement::read(pass, &source("probe.txt", &probe)).unwrap();
    match correct_pass(pass, &measurement, &[], &[Route::Program], &mut |_| ()) {
        Ok(done) => Some(cut(pass, machine, &done)),
        Err(Failure::Input(error)) if error.code() == "Q009" && error.found().contains("the datum is shifted") => None,
        Err(other) => panic!("{other:?}"),
    }
}

fn cut(pass: &Pass, machine: &Machine, done: &CorrectedPass) -> f64 {
    let commanded = virtual_mill::commanded(pass, done.program.as_deref().unwrap()).unwrap();
    virtual_mill::mill(pass, machine, Some(&commanded)).unwrap().score().max_error_mm
}

/// Largest errors over even stock, over uneven stock that nobody knows, and over the same stock touched beforehand, mm.
fn thrice(contour: &Contour, stock: &str) -> (f64, Option<f64>, f64) {
    let even = over(contour, None).unwrap();
    let (smooth, uneven) = (machine(contour, ""), machine(contour, stock));
    let known = over(contour, Some(&touched(&even, &uneven, ProbeDialect::Linuxcnc))).unwrap();
    let unknown = left(contour, &even, &uneven);
    let [even, known] =
        [(&even, &smooth), (&known, &uneven)].map(|(pass, machine)| left(contour, pass, machine).unwrap());
    let what = stock.replace('\n', " ");
    println!("{} {what}: even {even:.4}, unknown {unknown:.4?}, touched {known:.4} mm", contour.name);
    (even, unknown, known)
}

fn waves() -> String {
    "[stock]\nseed = 5\nwaves = 0.25\nwavelength_mm = 60.0".to_owned()
}

fn step(contour: &Contour) -> String {
    format!("[stock]\nstep = 0.25\nstep_from_mm = {}", contour.step_mm)
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn stock_that_was_touched_is_as_good_as_even_stock_in_the_corner() {
    // Nothing else infers the stock, as on the device.
    let job = CORNER.job.replace("[correct]", "[correct]\ndiscrepancy = \"ignore\"");
    let (even, unknown, known) = thrice(&Contour { job: job.leak(), ..CORNER }, &waves());
    let unknown = unknown.unwrap();
    assert!(known < 0.4 * unknown && even > 0.8 * known, "{even} {unknown} {known}");
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn waves_of_three_contours_are_cut_as_if_the_stock_were_even_and_a_step_is_rounded_off() {
    for contour in [&CORNER, &POCKET, &OUTSIDE] {
        let (even, unknown, known) = thrice(contour, &waves());
        let unknown = unknown.unwrap_or(f64::INFINITY);
        // What is inferred may come to the same where even stock is no better.
        let name = contour.name;
        assert!(known <= 1.05 * unknown.max(even) && even > 0.5 * known, "{name}: {even} {unknown} {known}");
        // Between two touches a step is a slope: what it leaves there, nobody has touched.
        let (_, _, known) = thrice(contour, &step(contour));
        let uneven = machine(contour, &step(contour));
        let first = virtual_mill::mill(&over(contour, None).unwrap(), &uneven, None).unwrap().score().max_error_mm;
        assert!(known < first / 5.0, "{name}: {first} {known}");
    }
}

#[test]
fn every_control_finds_the_stock_as_it_is() {
    let pass = over(&POCKET, None).unwrap();
    let uneven = machine(&POCKET, &waves());
    let mut seen = Vec::new();
    for dialect in [ProbeDialect::Linuxcnc, ProbeDialect::Grbl, ProbeDialect::Fanuc, ProbeDialect::Haas] {
        let contour = Contour {
            job: &*Box::leak(
                POCKET
                    .job
                    .replace("format = \"linuxcnc\"", &format!("format = \"{}\"", dialect.probe_format()))
                    .into_boxed_str(),
            ),
            ..POCKET
        };
        let found = over(&contour, Some(&touched(&pass, &uneven, dialect))).unwrap();
        let Some(KnownStock::Touched(stock)) = &found.stock else { panic!("{:?}", found.stock) };
        assert_eq!(stock.facts.places, planned(&pass, None).places.len(), "{dialect:?}");
        assert!(stock.facts.least_mm < 0.68 && stock.facts.most_mm > 0.92, "{:?}", stock.facts);
        seen.push((0..19).map(|k| stock.allowance.at(10.0 * f64::from(k))).collect::<Vec<f64>>());
    }
    for other in &seen[1..] {
        let apart = seen[0].iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.004, "{apart}");
    }
}

#[test]
fn the_places_hold_every_corner_and_stand_clear_of_the_largest_stock() {
    let pass = over(&POCKET, None).unwrap();
    let plan = planned(&pass, None);
    assert_eq!(plan.places.iter().filter(|place| place.what.starts_with("inside corner")).count(), 4);
    // 0.8 mm of stock, 0.4 mm more at most, 2 mm before that, a ball of 4 mm.
    for place in &plan.places {
        let [x, y] = plan.stand_off(place);
        let off = (x.hypot(y) - place.wall[0].hypot(place.wall[1])).abs();
        assert!(off <= 4.4 + 1e-9, "{off}");
    }
    let (clearance, overtravel) = (plan.settings.clearance, plan.settings.overtravel);
    assert!((clearance - 2.4).abs() < 1e-9 && (overtravel - 1.4).abs() < 1e-9);
    let text = write(&plan, ProbeDialect::Haas, "log.txt").unwrap();
    assert!(text.contains("(TOUCHES THE STOCK, BEFORE THE FINISHING PASS"), "{text}");
}

fn refused(contour: &Contour, stock: &str) -> InputError {
    match over(contour, Some(stock)) {
        Err(Failure::Input(error)) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn touches_of_the_finished_wall_too_few_and_those_elsewhere_are_refused_by_name_and_line() {
    let even = over(&CORNER, None).unwrap();
    let machine = machine(&CORNER, "");
    let finished = virtual_mill::mill(&even, &machine, None).unwrap();
    let probe = virtual_mill::probe(&even, &finished, CORNER.places, &[0.5], 6.0).unwrap();
    let error = refused(&CORNER, &probe);
    assert_eq!((error.code(), error.line_column().map(|(line, _)| line)), ("K004", Some(1)), "{error}");
    // Ball centres along the first wall, X = 34 less 3 mm, 40 mm away from it.
    let rows =
        |x: f64, ys: &[f64]| -> String { ys.iter().map(|y| format!("{x:.3} {y:.3} -10 0 0 0 0 0 0\n")).collect() };
    let error = refused(&CORNER, &rows(30.0, &[70.0, 60.0, 50.0]));
    assert_eq!((error.code(), error.line_column().map(|(line, _)| line)), ("K005", Some(3)), "{error}");
    let error = refused(&CORNER, &rows(30.0, &[76.0, 72.0, 68.0, 64.0, 60.0, 56.0]));
    assert!(error.code() == "K005" && error.found().contains("not touched between"), "{error}");
    let error = refused(&CORNER, &rows(-40.0, &[70.0, 60.0, 50.0, 40.0]));
    assert_eq!((error.code(), error.line_column().map(|(line, _)| line)), ("K006", Some(1)), "{error}");
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn the_image_is_made_here_and_the_device_takes_even_stock_only() {
    let even = over(&CORNER, None).unwrap();
    let uneven = machine(&CORNER, &waves());
    let known = over(&CORNER, Some(&touched(&even, &uneven, ProbeDialect::Linuxcnc))).unwrap();
    let first = virtual_mill::mill(&known, &uneven, None).unwrap();
    let probe = virtual_mill::probe(&known, &first, CORNER.places, &[0.15, 0.5, 0.85], 6.0).unwrap();
    let image = |pass: &Pass| {
        let measurement = Measurement::read(pass, &source("probe.txt", &probe)).unwrap();
        correct_pass(pass, &measurement, &[], &[Route::Coprocessor], &mut |_| ()).unwrap().image.unwrap()
    };
    assert!(image(&known) != image(&even));
    assert!(levels::compact(&even).is_ok());
    let Err(Failure::Input(error)) = levels::compact(&known) else { panic!("a device was given touched stock") };
    assert!(error.code() == "J009" && error.found().starts_with("stock.probe"), "{error}");
}

#[test]
fn touches_and_a_surface_exclude_each_other() {
    let job = CORNER.job.replace("allowance_mm = 3.0", "surface = \"s.csv\"\nprobe = \"stock.txt\"");
    let error = JobFile::parse(source("job.toml", &job), Path::new("")).unwrap_err();
    assert!(error.code() == "J008" && error.found().contains("stock.surface"), "{error}");
}

#[test]
fn a_plant_that_says_nothing_of_its_stock_cuts_the_stock_that_was_touched() {
    let even = over(&CORNER, None).unwrap();
    let uneven = machine(&CORNER, &waves());
    let known = over(&CORNER, Some(&touched(&even, &uneven, ProbeDialect::Linuxcnc))).unwrap();
    let [own, as_touched, flat] = [(&even, &uneven), (&known, &machine(&CORNER, "")), (&even, &machine(&CORNER, ""))]
        .map(|(pass, machine)| virtual_mill::mill(pass, machine, None).unwrap().score().max_error_mm);
    assert!((own - as_touched).abs() < 0.1 * (own - flat).abs(), "{own} {as_touched} {flat}");
}
