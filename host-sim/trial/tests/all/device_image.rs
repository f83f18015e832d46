//! The image that the device makes of a job in its compact form is the one that `correct --route coprocessor` writes.

use std::path::{Path, PathBuf};

use truepath_core::image::{DEVICE_NODES, Image, image_bytes};
use truepath_core::job::{self, Buffers, JobError};
use truepath_core::units::{Offset, Real};
use truepath_correction::correct::correct_pass;
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::levels;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

/// A part of the demonstration with the file that its probing gives.
struct Part {
    pass: Pass,
    probe: Source,
}

fn source(part: &str, name: &str) -> Source {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "../demo", part, name].iter().collect();
    Source::new(name, std::fs::read(path).unwrap())
}

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

fn probed(name: &str, change: &[(&str, &str)], places_mm: &[f64], levels: &[f64]) -> Part {
    let pass = shown(changed(name, change, source(name, "program.nc")));
    milled(name, pass, places_mm, levels)
}

/// A part of the demonstration with changes in its job, and its program.
fn changed(name: &str, change: &[(&str, &str)], program: Source) -> Result<Pass, Failure> {
    let mut text = String::from_utf8(source(name, "job.toml").bytes().to_vec()).unwrap();
    for (from, to) in change {
        assert!(text.contains(from), "the job has no `{from}`");
        text = text.replace(from, to);
    }
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new("")).unwrap();
    Pass::new(job, program)
}

fn milled(name: &str, pass: Pass, places_mm: &[f64], levels: &[f64]) -> Part {
    let machine: Machine = toml::from_str(str::from_utf8(source(name, "plant.toml").bytes()).unwrap()).unwrap();
    let milled = shown(virtual_mill::mill(&pass, &machine, None));
    let ball_mm = pass.job.require_probe().unwrap().ball_diameter.nm() as f64 / 1e6;
    let text = shown(virtual_mill::probe(&pass, &milled, places_mm, levels, ball_mm));
    Part { pass, probe: Source::new("probe.txt", text.into_bytes()) }
}

/// As the command line does it.
fn on_the_host(part: &Part) -> Result<Vec<u8>, Failure> {
    let measurement = Measurement::read(&part.pass, &part.probe)?;
    // The device fits machine and material alone.
    let mut pass = part.pass.clone();
    pass.job.discrepancy = false;
    let corrected = correct_pass(&pass, &measurement, &[], &[Route::Coprocessor], &mut |_| ())?;
    Ok(corrected.image.expect("the route of the coprocessor"))
}

/// As the device does it: from the bytes of job, program and probe file, in memory of a fixed size.
fn on_the_device(part: &Part) -> Result<Vec<u8>, JobError> {
    let job = job::Job::from_compact(&shown(levels::compact(&part.pass)))?;
    let mut memory: Box<Buffers<64, 4_096, 3_328, 3_072, 64>> = Box::default();
    let mut out = vec![0; image_bytes(DEVICE_NODES)];
    let (program, probe) = (part.pass.program.bytes(), part.probe.bytes());
    let made = job::image(&job, program, probe, &mut memory.workspace(), &mut out, &mut |_, _| ())?;
    out.truncate(made.bytes as usize);
    Ok(out)
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn the_image_of_the_device_is_that_of_the_host_byte_for_byte() {
    let heights = [0.1, 0.5, 0.9];
    let pocket = [12.0, 45.0, 92.0, 145.0, 180.0];
    let law = |name: &str| format!("[correct]\nlaw = \"{name}\"\ntarget = \"minimax\"\nmax_gouge_mm = 0.01\n[probe]");
    let two_feeds = [("feed_mm_per_min = 400.0", "# as the program says:")];
    for part in [
        probed("corner", &[], &[30.0, 75.0], &[0.5]),
        probed("corner-helix", &[], &[20.0, 32.0, 49.0, 68.0, 80.0], &heights),
        probed("corner-helix", &two_feeds, &[20.0, 32.0, 49.0, 68.0, 80.0], &heights),
        probed("pocket", &[], &pocket, &heights),
        probed("pocket", &[("[probe]", &law("model"))], &pocket, &heights),
        probed("pocket", &[("[probe]", &law("mirror"))], &pocket, &heights),
        probed("pocket", &[("[probe]", &law("paper"))], &pocket, &heights),
        probed(
            "pocket",
            &[("helix_deg = 38.0", "helix_deg = 38.0\nstickout_mm = 40.0\nmaterial = \"carbide\"")],
            &pocket,
            &heights,
        ),
    ] {
        let (host, device) = (shown(on_the_host(&part)), on_the_device(&part).unwrap());
        assert!(host == device, "{}: images differ", part.pass.program.name());
        assert!(host.len() > 30_000);
    }
}

#[test]
fn host_and_device_refuse_the_same_parts_with_the_same_code() {
    for (change, code) in [
        (("[probe]", "[correct]\nclamp_mm = 0.05\n[probe]"), "J017"),
        (("[probe]", "[correct]\nclamp_mm = 0.34\n[probe]"), "J018"),
    ] {
        let part = probed("corner", &[change], &[30.0, 75.0], &[0.5]);
        let Err(Failure::Input(error)) = on_the_host(&part) else { panic!("{change:?}: not refused") };
        assert_eq!(error.code(), code);
        assert_eq!(on_the_device(&part).unwrap_err().code(), code);
    }
}

#[test]
fn points_at_other_depths_that_are_cut_alike_are_the_same_to_host_and_device() {
    // Three depths of 1.5 mm; the last has another feed.
    let mut program = "G21 G90 G17\nT1 M6\nS4000 M3\n".to_owned();
    for (z, feed) in [(-15, 600), (-30, 600), (-45, 500)] {
        let z = f64::from(z) / 10.0;
        program += &format!("G0 X-20 Y-5 Z10\nG1 Z{z} F300\nG1 X45 F{feed}\nG3 X55 Y5 J10\nG1 Y60\nG0 Z10\n");
    }
    let job = "version = 1\nprogram = \"p.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.5\n[tool]\n\
        diameter_mm = 8.0\nteeth = 4\nhelix_deg = 35.0\n[cut]\naxial_depth_mm = 1.5\n[force]\nktc_n_per_mm2 = 900\n\
        krc_n_per_mm2 = 250\nkte_n_per_mm = 10\nkre_n_per_mm = 13\n[machine]\nstiffness_x_n_per_mm = 900\n\
        stiffness_y_n_per_mm = 900\n[probe]\nball_diameter_mm = 2.0\nformat = \"linuxcnc\"\nz_reference = \"centre\"\n";
    let job = JobFile::parse(Source::new("job.toml", job.as_bytes().to_vec()), Path::new("")).unwrap();
    let pass = shown(Pass::new(job, Source::new("p.nc", (program + "M30\n").into_bytes())));
    let machine: Machine = toml::from_str(str::from_utf8(source("pocket", "plant.toml").bytes()).unwrap()).unwrap();
    let milled = shown(virtual_mill::mill(&pass, &machine, None));
    let text = shown(virtual_mill::probe(&pass, &milled, &[20.0, 40.0, 68.0, 90.0], &[0.2, 0.8], 2.0));
    // Every second reading was taken 1.5 mm deeper, every fourth on the last depth.
    let deeper = |(at, line): (usize, &str)| {
        let mut fields: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let down = [0.0, 1.5, 0.0, 3.0][at % 4];
        fields[2] = format!("{:.6}", fields[2].parse::<f64>().unwrap() - down);
        fields.join(" ") + "\n"
    };
    let probe = Source::new("probe.txt", text.lines().enumerate().map(deeper).collect::<String>().into_bytes());
    let measurement = shown(Measurement::read(&pass, &probe));
    assert_eq!(
        (measurement.contacts.len(), measurement.rejected.len()),
        (6, 2),
        "the last depth is cut at another feed"
    );
    let part = Part { pass, probe };
    assert!(shown(on_the_host(&part)) == on_the_device(&part).unwrap(), "images differ");
}

/// The program of the corner with another tool change.
fn corner_with(tool_change: &str) -> Source {
    let text = String::from_utf8(source("corner", "program.nc").bytes().to_vec()).unwrap();
    assert!(text.contains("T01 M06"));
    Source::new("program.nc", text.replace("T01 M06", tool_change).into_bytes())
}

#[test]
fn an_image_needs_the_number_of_its_tool_from_job_or_program() {
    let teeth = |more: &str| format!("teeth = 6\n{more}");
    let binding = |more: &str, tool_change: &str| {
        let change = teeth(more);
        let pass = shown(changed("corner", &[("teeth = 6", &change)], corner_with(tool_change)));
        let part = milled("corner", pass, &[30.0, 75.0], &[0.5]);
        let (host, device) = (on_the_host(&part), on_the_device(&part));
        match (host, device) {
            (Ok(host), Ok(device)) => {
                assert_eq!(host, device);
                Ok(Image::new_checked(&host).unwrap().settings().binding)
            }
            (Err(failure), Err(error)) => Err((failure.render(Form::Plain), error)),
            (host, device) => panic!("{} {}", host.is_ok(), device.is_ok()),
        }
    };
    assert_eq!(binding("", "T01 M06").unwrap().tool, 1);
    assert_eq!(binding("number = 7\noffset_number = 8", "").map(|b| (b.tool, b.tool_offset)), Ok((7, 8)));
    let (shown, error) = binding("", "").unwrap_err();
    assert_eq!(error, JobError::NoTool);
    assert!(shown.contains("J023") && shown.contains("add number to [tool] of the job"), "{shown}");
    // The program needs no such number to be corrected itself.
    let part = milled("corner", changed("corner", &[], corner_with("")).unwrap(), &[30.0, 75.0], &[0.5]);
    let measurement = Measurement::read(&part.pass, &part.probe).unwrap();
    assert!(correct_pass(&part.pass, &measurement, &[], &[Route::Program], &mut |_| ()).is_ok());
}

#[test]
fn a_job_that_names_another_tool_than_the_program_is_refused_at_its_number() {
    let change = [("teeth = 6", "teeth = 6\nnumber = 7")];
    assert!(changed("corner", &change, corner_with("T07 M06")).is_ok());
    let shown = changed("corner", &change, corner_with("T01 M06")).unwrap_err().render(Form::Plain);
    assert!(shown.contains("J022") && shown.contains("number = 7") && shown.contains("tool 1"), "{shown}");
}

/// A number at the end of its range, as a job file states it, with the next one beyond.
const ENDS: [(&str, &str, &str); 29] = [
    ("allowance_mm = 0.8", "allowance_mm = 0.000001", "allowance_mm = 0"),
    ("allowance_mm = 0.8", "allowance_mm = 9.999999", "allowance_mm = 10"),
    ("diameter_mm = 10.0", "diameter_mm = 100", "diameter_mm = 100.000001"),
    (
        "diameter_mm = 10.0",
        "diameter_mm = 10\nmeasured_diameter_mm = 11",
        "diameter_mm = 10\nmeasured_diameter_mm = 11.000001",
    ),
    (
        "diameter_mm = 10.0",
        "diameter_mm = 10\nmeasured_diameter_mm = 9",
        "diameter_mm = 10\nmeasured_diameter_mm = 8.999999",
    ),
    ("teeth = 4", "teeth = 12", "teeth = 13"),
    ("teeth = 4", "teeth = 1", "teeth = 0"),
    ("teeth = 4", "teeth = 4\nnumber = 1", "teeth = 4\nnumber = 0"),
    ("teeth = 4", "teeth = 4\nnumber = 99999", "teeth = 4\nnumber = 100000"),
    ("teeth = 4", "teeth = 4\noffset_number = 99999", "teeth = 4\noffset_number = 100000"),
    ("[probe]", "[correct]\nsetup = 1\n[probe]", "[correct]\nsetup = 0\n[probe]"),
    ("[probe]", "[correct]\nsetup = 99999\n[probe]", "[correct]\nsetup = 100000\n[probe]"),
    ("helix_deg = 38.0", "helix_deg = 60", "helix_deg = 60.000001"),
    ("helix_deg = 38.0", "helix_deg = 0", "helix_deg = -0.000001"),
    ("axial_depth_mm = 12.0", "axial_depth_mm = 200", "axial_depth_mm = 200.000001"),
    (
        "axial_depth_mm = 12.0",
        "axial_depth_mm = 1\nspindle_rpm = 200000",
        "axial_depth_mm = 1\nspindle_rpm = 200000.001",
    ),
    ("axial_depth_mm = 12.0", "axial_depth_mm = 1\nspindle_rpm = 1", "axial_depth_mm = 1\nspindle_rpm = 0.999"),
    (
        "axial_depth_mm = 12.0",
        "axial_depth_mm = 1\nfeed_mm_per_min = 0.1",
        "axial_depth_mm = 1\nfeed_mm_per_min = 0.0999",
    ),
    (
        "axial_depth_mm = 12.0",
        "axial_depth_mm = 1\nfeed_mm_per_min = 100000",
        "axial_depth_mm = 1\nfeed_mm_per_min = 100001",
    ),
    ("ktc_n_per_mm2 = 820", "ktc_n_per_mm2 = 20000", "ktc_n_per_mm2 = 20000.001"),
    ("ktc_n_per_mm2 = 820", "ktc_n_per_mm2 = 0.000001", "ktc_n_per_mm2 = 0"),
    ("kte_n_per_mm = 12", "kte_n_per_mm = 500", "kte_n_per_mm = 500.001"),
    ("kte_n_per_mm = 12", "kte_n_per_mm = 0", "kte_n_per_mm = -0.001"),
    ("stiffness_x_n_per_mm = 1900", "stiffness_x_n_per_mm = 10", "stiffness_x_n_per_mm = 9.999"),
    ("stiffness_x_n_per_mm = 1900", "stiffness_x_n_per_mm = 1000000", "stiffness_x_n_per_mm = 1000001"),
    ("ball_diameter_mm = 4.0", "ball_diameter_mm = 0.1", "ball_diameter_mm = 0.099999"),
    ("ball_diameter_mm = 4.0", "ball_diameter_mm = 50\nnoise_mm = 0.1", "ball_diameter_mm = 50\nnoise_mm = 0.100001"),
    (
        "[probe]",
        "[correct]\nclamp_mm = 4\nband_mm = [0, 12]\n[probe]",
        "[correct]\nclamp_mm = 4\nband_mm = [0, 12.000001]\n[probe]",
    ),
    ("[probe]", "[correct]\nclamp_mm = 4\nmax_gouge_mm = 1\n[probe]", "[correct]\nclamp_mm = 4.000001\n[probe]"),
];

#[test]
fn the_ranges_of_the_job_file_are_those_of_the_compact_form() {
    let text = String::from_utf8(source("pocket", "job.toml").bytes().to_vec()).unwrap();
    let parse = |text: &str| JobFile::parse(Source::new("job.toml", text.as_bytes().to_vec()), Path::new(""));
    for (key, inside, outside) in ENDS {
        assert!(text.contains(key), "{key}");
        let job = parse(&text.replace(key, inside)).unwrap_or_else(|e| panic!("{inside}: {e}"));
        assert_eq!(job.numbers.check(), Ok(()), "{inside}");
        assert!(parse(&text.replace(key, outside)).is_err(), "{outside}");
    }
    // And what the file would refuse, the compact form refuses as well.
    let within = parse(&text).unwrap().numbers;
    let beyond: [fn(&mut job::Job); 16] = [
        |j| j.allowance = Offset::ZERO,
        |j| j.allowance = j.tool.diameter,
        |j| j.tool.diameter = Offset::from_nm(100_000_001),
        |j| j.tool.teeth = 13,
        |j| j.tool.helix_deg = Real::from_bits((60 << 32) + 1),
        |j| j.cut.axial_depth = Offset::from_nm(200_000_001),
        |j| j.cut.spindle_rpm = Some(Real::from_bits((200_000 << 32) + 1)),
        |j| j.force.ktc = Real::ZERO,
        |j| j.force.kre = Real::from_bits((500 << 32) + 1),
        |j| j.machine.stiffness_y = Real::from_bits((10 << 32) - 1),
        |j| j.correct.clamp = Offset::from_nm(4_000_001),
        |j| j.correct.band[1] = j.cut.axial_depth + Offset::from_nm(1),
        |j| j.tool.number = Some(0),
        |j| j.tool.number = Some(100_000),
        |j| j.tool.offset_number = 100_000,
        |j| j.correct.setup = 0,
    ];
    for change in beyond {
        let mut job = within;
        change(&mut job);
        assert!(matches!(job.check(), Err(JobError::Range { .. })), "{job:?}");
    }
}
