//! Programs with several cuts, from the file to the corrected file: the right blocks change and no others.

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use truepath::command::{correct, inspect, simulate};
use truepath_core::image::{DeviceClass, Image, KeyRing, verify};
use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_ground::diagnostics::{Failure, Form, InputError, Source};
use truepath_ground::length::Unit;
use truepath_job::job::{JobFile, Route, Which};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_job::signing::{SignFlags, Signer};
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

const PLANT: &str = "ktc_n_per_mm2 = 700\nkrc_n_per_mm2 = 210\nkte_n_per_mm = 14\nkre_n_per_mm = 14\nstiffness_x_n_per_mm = 1500\nstiffness_y_n_per_mm = 2000\n";

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/features").join(name)
}

/// A job of the folder with lines added and another feature or pass asked for.
fn job(name: &str, more: &str, feature: Option<&str>, pass: Option<u32>) -> Result<Pass, Failure> {
    let text = std::fs::read_to_string(data(name)).unwrap() + more;
    let mut job = JobFile::parse(Source::new(name, text.into_bytes()), &data(""))?;
    job.which.feature = feature.map(str::to_owned);
    job.which.pass = pass;
    Pass::read(job)
}

fn refused(result: Result<Pass, Failure>) -> (InputError, String) {
    match result {
        Err(Failure::Input(error)) => (error.clone(), Failure::Input(error).render(Form::Plain)),
        Err(failure) => panic!("{failure}"),
        Ok(pass) => panic!("accepted: {:?}", pass.core.contour.lines),
    }
}

/// Mills the pass, probes it and corrects by both routes.
fn corrected(pass: &Pass, ball: f64) -> (Pass, CorrectedPass) {
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let milled = virtual_mill::mill(pass, &machine, None).unwrap();
    let length = pass.core.contour.length.nm() as f64 / 1e6;
    let places: Vec<f64> = [0.1, 0.35, 0.6, 0.9].iter().map(|share| share * length).collect();
    let probe = virtual_mill::probe(pass, &milled, &places, &[0.3, 0.8], ball).unwrap();
    let file = Source::new("probe.txt", probe.into_bytes());
    let mut asked = pass.job.clone();
    asked.which.pass = None;
    let (pass, measurement) = Measurement::of_any_depth(Pass::read(asked).unwrap(), &file).unwrap();
    let done = correct_pass(&pass, &measurement, &[], &[Route::Coprocessor, Route::Program], &mut |_| ())
        .unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)));
    (pass, done)
}

/// Lines of the original that are not in the corrected program any more: those outside a longest common subsequence.
fn changed(original: &[u8], corrected: &[u8]) -> Vec<usize> {
    let (old, new) = (String::from_utf8_lossy(original), String::from_utf8_lossy(corrected));
    let (old, new): (Vec<&str>, Vec<&str>) = (old.lines().collect(), new.lines().collect());
    let mut common = vec![vec![0; new.len() + 1]; old.len() + 1];
    for i in (0..old.len()).rev() {
        for j in (0..new.len()).rev() {
            let same = usize::from(old[i] == new[j]) * (common[i + 1][j + 1] + 1);
            common[i][j] = same.max(common[i + 1][j]).max(common[i][j + 1]);
        }
    }
    let (mut i, mut j, mut list) = (0, 0, Vec::new());
    while i < old.len() {
        if j < new.len() && old[i] == new[j] && common[i][j] == common[i + 1][j + 1] + 1 {
            (i, j) = (i + 1, j + 1);
        } else if j < new.len() && common[i][j] == common[i][j + 1] {
            j += 1;
        } else {
            i += 1;
            list.push(i);
        }
    }
    list
}

#[test]
fn both_depths_of_a_pocket_are_corrected_and_roughing_and_spring_pass_are_not() {
    for probed in [1, 2] {
        let pass = job("pocket.toml", "", None, Some(probed)).unwrap();
        let (pass, done) = corrected(&pass, 4.0);
        assert_eq!(pass.level(), probed, "the depth follows from the heights of the points");
        let feature = done.summary.feature.unwrap();
        assert_eq!((feature.pass, feature.passes_corrected), (probed, vec![1, 2]));
        let text = done.program.unwrap();
        // The lead-in (70, 85), the contour, the lead-out (80, 95) of both depths, and nothing of lines 1-69 and 96-116.
        let lines = changed(pass.program.bytes(), &text);
        assert!(lines.iter().all(|l| (70..=80).contains(l) || (85..=95).contains(l)), "{lines:?}");
        assert!((71..=79).chain(86..=94).all(|l| lines.contains(&l)), "{lines:?}");
        let (a, b) = (image(&done.image.unwrap()), image(&done.other_images[0].1));
        assert_eq!((a.0, a.1, b.0, b.1), (1, probed, 1, 3 - probed));
        assert_eq!(a.2 - b.2, if probed == 1 { 6_000_000 } else { -6_000_000 });
        assert_eq!(done.other_images.len(), 1);
        if probed == 1 {
            continue;
        }
        // Both depths get the same path.
        let text = String::from_utf8(text).unwrap();
        let section = |from: &str, to: &str| -> Vec<String> {
            let moves = text.lines().skip_while(|l| !l.contains(from)).take_while(|l| !l.contains(to));
            moves.filter(|l| l.contains('X')).map(|l| l.split_once("G").unwrap().1.to_owned()).collect()
        };
        assert_eq!(section("(FINISHING Z-6)", "(FINISHING Z-12)"), section("(FINISHING Z-12)", "(SPRING PASS)"));
    }
}

/// Feature, pass and lowest height of an image.
fn image(bytes: &[u8]) -> (u32, u32, i64) {
    let image = Image::new_checked(bytes).unwrap();
    let settings = &image.header().settings;
    (settings.binding.feature, settings.binding.pass, settings.window.z_low.nm())
}

#[test]
fn what_is_chosen_is_told_with_its_reasons() {
    let pass = job("pocket.toml", "", None, None).unwrap();
    let feature = pass.feature(&[]).unwrap();
    let roles: Vec<&str> = feature.candidates.iter().map(|row| row.role).collect();
    assert_eq!(roles, ["rough", "rough", "semi", "rough", "rough", "semi", "finish", "finish", "spring"]);
    assert_eq!(
        feature.passes.iter().map(|p| (p.pass, p.role)).collect::<Vec<_>>(),
        [(1, "finish"), (2, "finish"), (2, "spring")]
    );
    let text = truepath_job::feature::listing(&feature, Unit::Millimetre);
    assert!(text.contains("by search: the only path of tool 1"), "{text}");
    assert!(text.contains("0.500 mm all along farther from the wall than lines 71-79"), "{text}");
    assert!(pass.warnings.iter().all(|w| !w.contains("leaves")), "{:?}", pass.warnings);
}

#[test]
fn an_allowance_that_the_roughing_does_not_leave_is_told() {
    let text =
        std::fs::read_to_string(data("pocket.toml")).unwrap().replace("allowance_mm = 0.5", "allowance_mm = 0.8");
    let job = JobFile::parse(Source::new("pocket.toml", text.into_bytes()), &data("")).unwrap();
    let pass = Pass::read(job).unwrap();
    let told = "the pass before the finishing one (lines 28-36) leaves 0.5000 mm, the job says allowance_mm = 0.8";
    assert!(pass.warnings.iter().any(|w| **w == *told), "{:?}", pass.warnings);
}

#[test]
fn of_two_tools_the_one_of_the_job_is_corrected() {
    let pass = job("two-tools.toml", "", None, None).unwrap();
    assert_eq!(pass.core.contour.lines.first, 52);
    let (pass, done) = corrected(&pass, 4.0);
    let lines = changed(pass.program.bytes(), &done.program.unwrap());
    assert!(!lines.is_empty() && lines.iter().all(|l| (50..=60).contains(l)), "{lines:?}");
}

#[test]
fn a_feature_is_named_by_blocks_lines_or_markers() {
    let by_lines = "[[feature]]\nid = \"boss\"\nblocks = [20, 31]\ntool = 1\n[[feature]]\nid = \"pocket\"\nlines = [49, 60]\ntool = 2\nz_mm = [-5.0]\n";
    let pass = job("two-tools.toml", by_lines, None, None).unwrap();
    // Only the pocket is cut with the cutter of the job.
    assert_eq!((pass.core.contour.lines.first, pass.core.binding().unwrap().feature), (52, 2));
    let pass = job("markers.toml", "", Some("pocket"), None).unwrap();
    assert_eq!((pass.core.contour.lines.first, pass.core.binding().unwrap().feature), (55, 2));
    let pass = job("markers.toml", "", Some("boss"), None).unwrap();
    assert_eq!((pass.core.contour.lines.first, pass.core.binding().unwrap().feature), (24, 1));
    let with_markers =
        "[[feature]]\nid = \"pocket\"\nallowance_mm = 0.3\n[[feature]]\nid = \"boss\"\nrole = \"semi\"\n";
    let pass = job("markers.toml", with_markers, None, None).unwrap();
    assert_eq!((pass.core.setup.allowance.nm(), pass.core.binding().unwrap().feature), (300_000, 1));
    // The pocket has N words: blocks are those.
    let numbered = "[[feature]]\nid = \"deep\"\nblocks = [390, 445]\n";
    let pass = job("pocket.toml", numbered, None, None).unwrap();
    assert_eq!((pass.core.contour.lines.first, pass.core.contour.blocks), (85, 11), "as named, leads included");
}

#[test]
fn a_pocket_with_an_island_is_ambiguous_until_one_is_named() {
    let (error, shown) = refused(job("island.toml", "", None, None));
    assert_eq!((error.code(), error.line_column()), ("G071", Some((36, 1))));
    for part in ["2 finishing contours", "lines 23-31", "lines 36-44", "tool 1", "Z -8", "271.416 mm", "[[feature]]"] {
        assert!(shown.contains(part), "{part} is missing in\n{shown}");
    }
    assert!(!shown.lines().any(|line| line.contains("23-31") && line.contains("36-44")), "one a line:\n{shown}");
    let pass = job("island.toml", "[[feature]]\nid = \"wall\"\nblocks = [20, 31]\n", None, None).unwrap();
    let (pass, done) = corrected(&pass, 4.0);
    let lines = changed(pass.program.bytes(), &done.program.unwrap());
    assert!(!lines.is_empty() && lines.iter().all(|l| (21..=31).contains(l)), "{lines:?}");
}

#[test]
fn every_wrong_feature_has_its_code_and_remedy() {
    let named = |body: &str| format!("[[feature]]\nid = \"a\"\n{body}\n");
    let twice = named("lines = [49, 60]") + &named("lines = [20, 31]");
    let both = named("lines = [49, 60]") + "[[feature]]\nid = \"b\"\nlines = [49, 60]\n";
    let rough = named("lines = [49, 60]\nrole = \"rough\"");
    let cases: [(&str, String, Option<&str>, &str, &str); 14] = [
        ("markers.toml", String::new(), None, "N001", "boss"),
        ("two-tools.toml", both, None, "N001", "one at a time"),
        ("two-tools.toml", String::new(), Some("x"), "N002", "leave --feature out"),
        ("markers.toml", String::new(), Some("x"), "N002", "one of boss, pocket"),
        ("two-tools.toml", twice, None, "J008", "given twice"),
        ("two-tools.toml", named(""), None, "N007", "(TRUEPATH BEGIN a)"),
        ("markers.toml", named("lines = [49, 60]"), None, "N007", "one of a"),
        ("two-tools.toml", named("lines = [49, 600]"), None, "N008", "lines 1 to"),
        ("pocket.toml", named("blocks = [390, 446]"), None, "N008", "has no block N446"),
        (
            "two-tools.toml",
            named("lines = [49, 60]\nz_mm = [-5.0, -9.0]"),
            None,
            "N009",
            "at -5, -9, the program has them at -5",
        ),
        ("island.toml", named("lines = [20, 44]"), None, "N010", "2 finishing contours in the feature \"a\""),
        ("two-tools.toml", rough, None, "N011", "not a finishing cut"),
        ("two-tools.toml", named("lines = [20, 31]"), None, "N011", "no cut of tool 2, only of 1"),
        ("two-tools.toml", named("lines = [49, 60]\ntool = 3"), None, "J008", "cut with tool 3"),
    ];
    for (name, more, feature, code, part) in cases {
        let (error, shown) = refused(job(name, &more, feature, None));
        assert_eq!(error.code(), code, "{name} {more}\n{shown}");
        assert!(shown.contains(part), "{part} is missing in\n{shown}");
    }
    let (error, _) = refused(job("pocket.toml", "", None, Some(3)));
    assert_eq!(error.code(), "N012");
}

#[test]
fn wrong_markers_are_told_with_their_place() {
    let folder = TempDir::new().unwrap();
    let text = std::fs::read_to_string(data("markers.nc")).unwrap();
    let cases = [
        ("(TRUEPATH END)\n", "", "N003", 50),
        ("(TRUEPATH BEGIN boss)\n", "", "N004", 32),
        ("; TRUEPATH END pocket\n", "", "N005", 51),
        ("BEGIN pocket", "BEGIN boss", "N006", 51),
        ("END pocket", "END boss", "N004", 64),
    ];
    std::fs::copy(data("markers.toml"), folder.path().join("job.toml")).unwrap();
    for (from, to, code, line) in cases {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        std::fs::write(folder.path().join("markers.nc"), text.replace(from, to)).unwrap();
        let (error, shown) =
            refused(JobFile::read(&folder.path().join("job.toml")).map_err(Failure::from).and_then(Pass::read));
        assert_eq!((error.code(), error.line_column().map(|p| p.0)), (code, Some(line)), "{shown}");
    }
}

#[test]
fn every_command_takes_the_feature_and_writes_what_it_chose() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["markers.nc", "markers.toml", "pocket.nc", "pocket.toml"] {
        std::fs::copy(data(name), at(name)).unwrap();
    }
    let which = Which { feature: Some("pocket".to_owned()), pass: None };
    let job = at("markers.toml");
    let options = simulate::Options { job, output: at("simulated"), which, ..simulate::Options::default() };
    let feature = simulate::run(&options).unwrap().feature.unwrap();
    assert_eq!((feature.id.as_deref(), feature.chosen_by), (Some("pocket"), "markers"));
    let without = simulate::Options { which: Which::default(), output: at("never"), ..options };
    assert!(matches!(simulate::run(&without), Err(Failure::Input(error)) if error.code() == "N001"));
    assert!(!at("never").exists());

    let pass = job_of("pocket.toml", Some(2));
    let milled = virtual_mill::mill(&pass, &toml::from_str(PLANT).unwrap(), None).unwrap();
    let probe = virtual_mill::probe(&pass, &milled, &[15.0, 60.0, 95.0, 140.0], &[0.3, 0.8], 4.0).unwrap();
    std::fs::write(at("probe.txt"), probe).unwrap();
    let (job, probe) = (at("pocket.toml"), at("probe.txt"));
    let options = inspect::Options {
        job: job.clone(),
        probe: Some(probe.clone()),
        output: Some(at("inspected")),
        ..inspect::Options::default()
    };
    let summary = inspect::run(&options).unwrap().summary;
    assert_eq!((summary.feature.unwrap().pass, summary.points), (2, 8));
    let signer = Signer::of_seed(&[9; 32]);
    std::fs::write(at("shop.key"), signer.text()).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        std::fs::set_permissions(at("shop.key"), std::fs::Permissions::from_mode(0o600)).unwrap();
    }
    let mut keys = KeyRing::default();
    keys.add(signer.public()).unwrap();
    for (route, files) in [
        (Route::Program, &["corrected.nc", "difference.txt"][..]),
        (Route::Coprocessor, &["correction.tpi", "correction-pass-1.tpi"][..]),
    ] {
        let out = at(files[0]);
        let options = correct::Options {
            job: job.clone(),
            probe: Some(probe.clone()),
            output: out.clone(),
            route: Some(route),
            sign: SignFlags { sign: Some(at("shop.key")), counter: Some(77), ..SignFlags::default() },
            ..correct::Options::default()
        };
        correct::run(&options, &mut |_| ()).unwrap();
        // Every image that is written is signed.
        for name in files.iter().filter(|name| name.ends_with(".tpi")) {
            let bytes = std::fs::read(out.join(name)).unwrap();
            let signed = verify(&bytes, &keys, DeviceClass::Board).unwrap();
            assert_eq!((signed.key, signed.counter), (signer.public().id(), 77), "{name}");
        }
        assert!(files.iter().all(|name| out.join(name).exists()), "{route:?}");
        let summary: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["feature"]["pass"], 2);
        assert_eq!(summary["feature"]["passes_corrected"], serde_json::json!([1, 2]));
        assert_eq!(summary["feature"]["candidates"].as_array().unwrap().len(), 9);
    }
}

/// A finishing pass round a pocket at so many depths, 6 mm each.
fn at_depths(folder: &Path, count: u32) {
    let text = std::fs::read_to_string(data("pocket.nc")).unwrap();
    let between = |from: &str, to: &str| text[text.find(from).unwrap()..text.find(to).unwrap()].to_owned();
    let one = between("N315 ", "(FINISHING Z-12)");
    let depths: String = (1..=count).map(|k| one.replace("Z-6", &format!("Z-{}", 6 * k))).collect();
    let program = between("%", "(ROUGHING Z-6)") + &depths + &text[text.find("N525 ").unwrap()..];
    std::fs::write(folder.join("pocket.nc"), program).unwrap();
}

#[test]
fn every_depth_gets_its_image_however_many_there_are_and_none_of_a_deeper_pocket_stays() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::copy(data("pocket.toml"), at("pocket.toml")).unwrap();
    let (job, probe, out) = (at("pocket.toml"), at("probe.txt"), at("out"));
    let images = || {
        let names = std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| name.starts_with("correction-pass-")).collect();
        names.sort();
        names
    };
    for (depths, force, expected) in [(11, false, 10), (3, true, 2)] {
        at_depths(folder.path(), depths);
        let mut asked = JobFile::read(&job).unwrap();
        asked.which.pass = Some(2);
        let pass = Pass::read(asked).unwrap();
        let milled = virtual_mill::mill(&pass, &toml::from_str(PLANT).unwrap(), None).unwrap();
        let touched = virtual_mill::probe(&pass, &milled, &[15.0, 60.0, 95.0, 140.0], &[0.3, 0.8], 4.0).unwrap();
        std::fs::write(&probe, touched).unwrap();
        if force {
            std::fs::write(out.join("correction-pass-old.tpi"), "the user's").unwrap();
        }
        let options = correct::Options {
            job: job.clone(),
            probe: Some(probe.clone()),
            output: out.clone(),
            force,
            route: Some(Route::Coprocessor),
            ..correct::Options::default()
        };
        correct::run(&options, &mut |_| ()).unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)));
        let mut names: Vec<String> =
            (1..=depths).filter(|k| *k != 2).map(|k| format!("correction-pass-{k}.tpi")).collect();
        names.extend(force.then(|| "correction-pass-old.tpi".to_owned()));
        names.sort();
        assert_eq!((images(), names.len() - usize::from(force)), (names, expected));
    }
}

fn job_of(name: &str, pass: Option<u32>) -> Pass {
    job(name, "", None, pass).unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

#[test]
fn more_runs_than_can_be_compared_are_refused() {
    let line = |k: i32| format!("G0 X0 Y{k} Z2\nG1 Z-5 F100\nG1 X9\nG0 Z2\n");
    let program = format!("G21 G90\nT1 M6\nS900 M3\n{}M30\n", (0..1001).map(line).collect::<String>());
    let text = std::fs::read_to_string(data("pocket.toml")).unwrap();
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new("")).unwrap();
    let (error, shown) = refused(Pass::new(job, Source::new("many.nc", program.into_bytes())));
    assert_eq!(error.code(), "N010");
    assert!(shown.contains("1001 runs of cutting moves") && shown.contains("at most 1000"), "{shown}");
}
