//! Stock that the roughing of the same program leaves: the virtual machine mills the roughing pass and then the wall, the correction
//! knows the program alone.

use std::path::Path;

use truepath_correction::correct::correct_pass;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{KnownStock, Pass, PathBuffer};
use truepath_job::surface::Surface;
use truepath_plant::{Machine, judged_levels};
use truepath_trial::virtual_mill;

const JOB: &str = include_str!("../../../demo/corner-helix/job.toml");
const PLANT: &str = include_str!("../../../demo/corner-helix/plant.toml");
/// Where the finished wall is touched, mm.
const PLACES: [f64; 8] = [12.0, 22.0, 32.0, 42.0, 50.0, 62.0, 76.0, 90.0];

const HEAD: &str = "O0001\nG00 G90 G49 G40 G17 G21\nG54\nT01 M06\nS1500 M03\nG00 Z10. X46. Y85.\n";
/// Six millimetres beside the next, in full material.
const FIRST: &str = "G00 X43. Y80.\nG01 Z-15. F400.\nG01 X43. Y40.\nG03 X44. Y39. I1. J0.\nG01 X90. Y39.\nG00 Z10.\n";
/// Three millimetres before the wall, with a rounder corner than that of the wall.
const ROUGH: &str = "G00 X37. Y80.\nG01 Z-15. F400.\nG01 X37. Y38.\nG03 X42. Y33. I5. J0.\nG01 X90. Y33.\nG00 Z10.\n";
const FINISH: &str =
    "G00 X34. Y80.\nG01 Z-15. F400.\nG01 X34. Y35.\nG03 X39. Y30. I5. J0.\nG01 X90. Y30.\nG00 Z100.\nM30\n";

fn pass(job: &str, runs: &[&str]) -> Result<Pass, Failure> {
    let source = |name: &str, text: &str| Source::new(name, text.as_bytes().to_vec());
    let job = JobFile::parse(source("job.toml", job), Path::new(""))?;
    Pass::new(job, source("program.nc", &format!("{HEAD}{}", runs.concat())))
}

fn job(stock: &str) -> String {
    JOB.replace("allowance_mm = 3.0", &format!("allowance_mm = 3.0\n{stock}"))
}

fn machine() -> Machine {
    toml::from_str(PLANT).unwrap()
}

/// The finishing pass over what the machine leaves of the roughing pass.
fn truth() -> Pass {
    let six = job("").replace("allowance_mm = 3.0", "allowance_mm = 6.0");
    let rough = virtual_mill::mill(&pass(&six, &[ROUGH, "M30\n"]).unwrap(), &machine(), None).unwrap();
    let surface = Surface::new(rough.surface(&judged_levels())).unwrap();
    pass(&job(""), &[FINISH]).unwrap().over(surface).unwrap()
}

/// Largest errors before and after, mean over the height, of the part of the machine, corrected by what a pass knows of it, mm.
fn left(known: &Pass, truth: &Pass) -> Result<[f64; 2], String> {
    let first = virtual_mill::mill(truth, &machine(), None).unwrap();
    let probe = virtual_mill::probe(truth, &first, &PLACES, &[0.15, 0.5, 0.85], 6.0).unwrap();
    let measurement = Measurement::read(known, &Source::new("probe.txt", probe.into_bytes())).unwrap();
    let done = match correct_pass(known, &measurement, &[], &[Route::Program], &mut |_| ()) {
        Ok(done) => done,
        Err(Failure::Input(error)) => return Err(format!("{}: {}", error.code(), error.found())),
        Err(other) => panic!("{other:?}"),
    };
    println!("{:?}", done.summary.warnings);
    let corrected = Source::new("corrected.nc", done.program.unwrap());
    let second = virtual_mill::mill_executed(truth, &machine(), &corrected).unwrap();
    Ok([first.score().max_error_mm, second.score().max_error_mm])
}

#[test]
fn what_a_rounder_corner_of_roughing_leaves_is_that_of_its_circle() {
    let known = pass(&job("roughing_diameter_mm = 20.0"), &[FIRST, ROUGH, FINISH]).unwrap();
    let Some(KnownStock::Roughed(stock)) = &known.stock else { panic!("{:?}", known.stock) };
    println!("{:?}", stock.facts);
    // On the diagonal: the wall of 15 mm about (39, 35), the circle of 15 mm about (42, 38).
    let corner = 15.0 - (15.0 - 3.0 * 2f64.sqrt());
    assert!(
        (stock.facts.least_mm - 3.0).abs() < 1e-4 && (stock.facts.most_mm - corner).abs() < 2e-3,
        "{:?}",
        stock.facts
    );
}

#[test]
fn a_job_of_even_stock_is_told_what_its_roughing_leaves() {
    let told = |job: &str, runs: &[&str]| {
        let warnings = pass(job, runs).unwrap().warnings;
        warnings.into_iter().find(|text| text.contains("its own roughing leaves"))
    };
    let text = told(&job(""), &[FIRST, ROUGH, FINISH]).unwrap();
    assert!(
        text.contains("3.000 to 4.242 mm")
            && text.ends_with("roughing_diameter_mm = 20 in [stock] takes that into account"),
        "{text}"
    );
    assert_eq!(told(&job("roughing_diameter_mm = 20.0"), &[FIRST, ROUGH, FINISH]), None);
    // A parallel path, by another tool that a comment names.
    let parallel = ROUGH.replace("Y38.", "Y35.").replace("X42. Y33. I5.", "X39. Y33. I2.");
    assert_eq!(told(&job(""), &[&parallel, FINISH]), None);
    let other = HEAD.replace("T01 M06", "(T2 D=26. CR=0. - flat end mill)\nT02 M06");
    let text = [
        &other,
        "G00 X40. Y80.\nG01 Z-15. F400.\nG01 X40. Y36.\nG01 X90. Y36.\nG00 Z10.\nT01 M06\nS1500 M03\n",
        FINISH,
    ]
    .concat();
    let mine = job("").replace("[tool]", "[tool]\nnumber = 1");
    let job = JobFile::parse(Source::new("job.toml", mine.into_bytes()), Path::new("")).unwrap();
    let warnings = Pass::new(job, Source::new("program.nc", text.into_bytes())).unwrap().warnings;
    assert!(warnings.iter().any(|w| w.contains("roughing_diameter_mm = 26 and roughing_tool = 2")), "{warnings:?}");
}

#[test]
fn the_virtual_machine_mills_the_roughing_of_a_program_as_well() {
    let known = pass(&job("roughing_diameter_mm = 20.0"), &[FIRST, ROUGH, FINISH]).unwrap();
    let [own, two] = [&known, &truth()].map(|pass| virtual_mill::mill(pass, &machine(), None).unwrap().score());
    println!("{own:?} {two:?}");
    assert!((own.max_error_mm - two.max_error_mm).abs() < 0.01 * two.max_error_mm, "{own:?} {two:?}");
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn roughing_that_the_program_tells_is_worth_what_the_stock_itself_would_be() {
    let truth = truth();
    let told = pass(&job("roughing_diameter_mm = 20.0"), &[FIRST, ROUGH, FINISH]).unwrap();
    let [told, known] = [&told, &truth].map(|pass| left(pass, &truth).unwrap());
    println!("told by the program {told:?}, known {known:?} mm");
    assert!(told[0] > 0.6 && told[1] < 0.06 * told[0] && told[1] < 1.2 * known[1], "{told:?} {known:?}");
    // Three millimetres all along are not what is there, as the job is told: a machine that takes the corner's stock for compliance
    // leaves twice as much.
    let even = left(&pass(&job(""), &[FIRST, ROUGH, FINISH]).unwrap(), &truth).unwrap();
    println!("even stock {even:?} mm");
    assert!(even[1] > 2.0 * told[1] && even[1] < 0.2 * even[0], "{even:?}");
}

#[test]
fn rows_and_levels_of_roughing_are_pushed_where_they_make_the_wall() {
    // Rows to and fro that end before the first wall, at two depths, then a run along the wall at either depth.
    let rows = |z: &str| {
        let row = |k: u32| format!("G01 X{} Y{}.\nG01 X{0} Y{}.\n", [90, 38][k as usize % 2], 39 + 6 * k, 45 + 6 * k);
        format!("G00 X38. Y39.\nG01 Z{z}. F400.\n{}G00 Z10.\n", (0..6).map(row).collect::<String>())
    };
    let rough = |z: &str| ROUGH.replace("Z-15.", &format!("Z{z}."));
    let runs = [rows("-10"), rough("-10"), rows("-15"), rough("-15"), FINISH.to_owned()];
    let runs: Vec<&str> = runs.iter().map(String::as_str).collect();
    let pass = pass(&job("roughing_diameter_mm = 20.0"), &runs).unwrap();
    // The upper levels do not reach the lower edge of the wall.
    let found = pass.roughing_runs().unwrap();
    assert!(found.ends_with(&[4]) && !found.contains(&1) && !found.contains(&2), "{found:?}");
    let rough = pass.roughed_by(4).unwrap();
    assert_eq!(rough.core.setup.axial_depth.bits(), 5 << 32);
    // What is before it are the rows: six millimetres along the second wall, more where they end.
    let mut buffer = PathBuffer::default();
    let path = rough.sample(&mut buffer).unwrap();
    let pushed = rough.pushed(&path, (0..path.samples().len()).map(|index| (index, 0.1)));
    assert!(pushed.number == 4 && pushed.more.len() > 100);
    let (known, change) = pass.over_pushed(vec![pushed]).unwrap();
    let Some(KnownStock::Roughed(stock)) = &known.stock else { panic!("{:?}", known.stock) };
    // Pushed right through the wall: what is left is next to nothing, and no error.
    let through = rough.pushed(&path, (0..path.samples().len()).map(|index| (index, -9.0)));
    let (known, _) = pass.over_pushed(vec![through]).unwrap();
    let Some(KnownStock::Roughed(none)) = &known.stock else { panic!("{:?}", known.stock) };
    assert!(none.facts.least_mm < 0.01 && known.sample(&mut buffer).is_ok(), "{:?}", none.facts);
    assert!((change - 0.1).abs() < 0.02 && stock.facts.pushed_mm.is_some_and(|mm| mm > 0.07), "{:?}", stock.facts);
}

/// A program turned by a quarter about zero and moved.
fn turned(text: &str, [x, y]: [f64; 2]) -> String {
    let number = |word: &str| word[1..].parse::<f64>().unwrap();
    let line = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let value = |letter| words.iter().find(|word| word.starts_with(letter)).map(|word| number(word));
        let turn = |word: &&str| match &word[..1] {
            "X" => format!("X{:.4}", x - value('Y').unwrap()),
            "Y" => format!("Y{:.4}", y + value('X').unwrap()),
            "I" => format!("I{:.4}", -value('J').unwrap()),
            "J" => format!("J{:.4}", value('I').unwrap()),
            _ => (*word).to_owned(),
        };
        words.iter().map(turn).collect::<Vec<_>>().join(" ")
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn what_roughing_leaves_turns_and_moves_with_the_program_to_the_last_bit() {
    let text = [HEAD, FIRST, ROUGH, FINISH].concat();
    let facts = |text: &str| {
        let source = Source::new("program.nc", text.as_bytes().to_vec());
        let job =
            JobFile::parse(Source::new("job.toml", job("roughing_diameter_mm = 20.0").into_bytes()), Path::new(""));
        match Pass::new(job.unwrap(), source).unwrap().stock {
            Some(KnownStock::Roughed(stock)) => {
                [stock.facts.mean_mm, stock.facts.least_mm, stock.facts.most_mm].map(f64::to_bits)
            }
            other => panic!("{other:?}"),
        }
    };
    let here = facts(&text);
    let once = turned(&text, [0.0, 0.0]);
    let twice = turned(&once, [801.1237, -300.0451]);
    assert_eq!([facts(&once), facts(&twice)], [here; 2]);
}

fn refused(stock: &str, runs: &[&str]) -> (String, String) {
    match pass(&job(stock), runs) {
        Err(Failure::Input(error)) => (error.code().to_owned(), error.found().to_owned()),
        other => panic!("{other:?}"),
    }
}

#[test]
fn roughing_that_is_not_there_or_not_what_the_job_says_is_refused() {
    let (code, found) = refused("roughing_diameter_mm = 20.0", &[FINISH]);
    assert!(code == "K008" && found.contains("no cut before lines"), "{code} {found}");
    let (code, found) = refused("roughing_diameter_mm = 20.0\nroughing_tool = 7", &[FIRST, ROUGH, FINISH]);
    assert!(code == "K008" && found.contains("no cut of tool 7 before"), "{code} {found}");
    // A cutter that would have been in the wall.
    let (code, found) = refused("roughing_diameter_mm = 26.2", &[FIRST, ROUGH, FINISH]);
    assert!(code == "K008" && found.contains("leaves nothing on the finished wall beside X"), "{code} {found}");
    // A cutter of two millimetres that far away leaves 21 mm.
    let far = "G00 X46. Y80.\nG01 Z-15. F400.\nG01 X46. Y43.\nG01 X90. Y42.\nG00 Z10.\n";
    let (code, found) = refused("roughing_diameter_mm = 2.0", &[far, FINISH]);
    assert!(code == "K008" && found.contains("more than the cutter"), "{code} {found}");
    let (code, found) = refused("roughing_tool = 1", &[FIRST, ROUGH, FINISH]);
    assert!(code == "J008" && found.contains("without a diameter"), "{code} {found}");
}
