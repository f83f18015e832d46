//! From job, program and measurement to the image, in memory lent by the caller.

use crate::job_support;

use job_support::{Part, Room, corner, made, pocket, short, um};
use truepath_core::cut::WallLaw;
use truepath_core::gcode::{ArcCentres, Dialect, PointlessLength};
use truepath_core::image::{Binding, DEVICE_NODES, Image, image_bytes};
use truepath_core::job::{
    Buffer, Buffers, COMPACT_BYTES, ContourPass, Counts, ForceModel, Job, JobError, LARGEST_NUMBER, LawName, Stage,
    Stickout, Workspace, image,
};
use truepath_core::units::{Offset, Real};

/// Checksums of the images, which hold on every machine and in every build.
const CORNER_CRC: u32 = 0xa561_2e79;
const POCKET_CRC: u32 = 0xb57a_14f9;

#[test]
fn corner_and_pocket_give_the_same_image_on_every_machine() {
    for (part, crc, law) in [(corner(), CORNER_CRC, WallLaw::Mean), (pocket(), POCKET_CRC, WallLaw::Helical)] {
        let (made, bytes) = made(&part).unwrap();
        let image = Image::new_checked(&bytes).unwrap();
        assert_eq!((made.crc, image.crc(), made.wall_law), (crc, crc, law), "{:08x}", made.crc);
        assert_eq!(image.len(), made.nodes as usize);
        assert_eq!((made.outlying, made.set_aside, made.unsettled), (0, 0, 0));
    }
}

#[test]
fn the_summary_says_what_the_points_tell_about_the_machine() {
    // The corner was milled on a machine of 1150 N/mm, 344.31/1147.7 radial: with the 1200 N/mm² stated it seems stiffer,
    // and a little more so because two points leave the radial ratio to what metals have in common, 0.305.
    let (made, _) = made(&corner()).unwrap();
    let expected = Real::ratio(1150 * 12_000, 11_477);
    for stiffness in [made.stiffness_x, made.stiffness_y] {
        assert!((stiffness - expected).abs() < Real::from_int(60), "{stiffness:?}");
    }
    assert_eq!(made.points, 2);
    // 0.29 mm of error become less than a micrometre; the correction is a little larger than the error.
    assert!(made.error_before > um(250) && made.error_after < um(1));
    assert!(made.largest > made.error_before && made.largest < um(400));
}

#[test]
fn progress_goes_through_all_stages_and_never_falls() {
    let part = pocket();
    let mut room: Box<Room> = Box::default();
    let mut out = vec![0; image_bytes(DEVICE_NODES)];
    let mut told: Vec<(Stage, u16)> = Vec::new();
    let tell = &mut |stage, permille| told.push((stage, permille));
    image(&part.job, part.program, part.probe, &mut room.workspace(), &mut out, tell).unwrap();
    assert!(told.windows(2).all(|w| w[0] < w[1]));
    let stages: Vec<Stage> = told.chunk_by(|a, b| a.0 == b.0).map(|c| c[0].0).collect();
    use Stage::{Contacts, Design, Identification, Image, Reading, Sampling};
    assert_eq!(stages, [Reading, Sampling, Contacts, Identification, Design, Image]);
    // The long stages say how far they are.
    for stage in [Identification, Design] {
        let steps = told.iter().filter(|t| t.0 == stage).count();
        assert!((20..=1001).contains(&steps), "{stage:?}: {steps}");
    }
    assert_eq!(told.last(), Some(&(Image, 1000)));
}

#[test]
fn what_the_buffers_held_before_does_not_matter() {
    let mut room: Box<Room> = Box::default();
    let mut out = vec![0; image_bytes(DEVICE_NODES)];
    for (part, crc) in [(pocket(), POCKET_CRC), (corner(), CORNER_CRC), (pocket(), POCKET_CRC)] {
        let workspace = &mut room.workspace();
        let made = image(&part.job, part.program, part.probe, workspace, &mut out, &mut |_, _| ()).unwrap();
        assert_eq!(made.crc, crc);
    }
}

/// What a part needs.
fn needed(part: &Part) -> Counts {
    let mut room: Box<Room> = Box::default();
    let mut workspace = room.workspace();
    let pass = ContourPass::read(&part.job, part.program, &mut workspace.parameters, workspace.blocks).unwrap();
    let contour = ContourPass::path_contour(&workspace.blocks[..pass.contour.blocks]).unwrap();
    let path = pass.sample(&contour, workspace.samples, |_| ()).unwrap();
    Counts::needed(&contour, &path, part.probe.iter().filter(|b| **b == b'\n').count())
}

/// The way to the image in exactly so much memory.
fn within(part: &Part, counts: &Counts, bytes: usize) -> Result<u32, JobError> {
    let mut room: Box<Room> = Box::default();
    let all = room.workspace();
    let mut workspace = Workspace {
        parameters: all.parameters,
        blocks: &mut all.blocks[..counts.blocks],
        samples: &mut all.samples[..counts.samples],
        readings: &mut all.readings[..counts.points],
        contacts: &mut all.contacts[..counts.points],
        observations: &mut all.observations[..counts.points],
        states: &mut all.states[..counts.states],
        displacements: &mut all.displacements[..counts.states],
        profiles: &mut all.profiles[..counts.nodes],
        updates: &mut all.updates[..counts.nodes],
        nodes: &mut all.nodes[..counts.nodes],
        scratch: &mut all.scratch[..counts.nodes],
    };
    let mut out = vec![0; bytes];
    image(&part.job, part.program, part.probe, &mut workspace, &mut out, &mut |_, _| ()).map(|m| m.crc)
}

#[test]
fn exactly_the_memory_needed_is_enough_and_one_less_names_its_buffer() {
    let part = short();
    let counts = needed(&part);
    let (made, _) = made(&part).unwrap();
    let bytes = made.bytes as usize;
    assert_eq!(within(&part, &counts, bytes), Ok(made.crc));

    let code = |counts: Counts, bytes| within(&part, &counts, bytes).unwrap_err();
    let blocks = code(Counts { blocks: counts.blocks - 1, ..counts }, bytes);
    assert!(blocks.to_string().contains(&format!("{}", counts.blocks - 1)), "{blocks}");
    assert!(matches!(blocks, JobError::Program(_)));
    let points = code(Counts { points: counts.points - 1, ..counts }, bytes);
    assert_eq!((points.code(), points.line()), ("M006", Some(2)));
    let full = |error: JobError, expected: Buffer, entries: usize| {
        let JobError::Full { buffer, needed, lent } = error else { panic!("{error}") };
        assert_eq!((buffer, needed as usize, lent as usize), (expected, entries, entries - 1));
        assert!(error.to_string().contains(&entries.to_string()));
    };
    full(code(Counts { samples: counts.samples - 1, ..counts }, bytes), Buffer::Samples, counts.samples);
    full(code(Counts { states: counts.states - 1, ..counts }, bytes), Buffer::States, counts.states);
    full(code(Counts { nodes: counts.nodes - 1, ..counts }, bytes), Buffer::Nodes, counts.nodes);
    full(code(counts, bytes - 1), Buffer::Image, bytes);
}

#[test]
fn a_contour_far_too_long_is_refused_before_it_is_walked_along() {
    let part = Part { program: b"G21 G90 S3000 M3\nT1 M6\nG0 X0 Y0\nG1 Z-4 F300\nG1 X9000\nM30\n", ..short() };
    let Err(JobError::Full { buffer: Buffer::Samples, needed, .. }) = made(&part) else { panic!("not refused") };
    assert!(needed > 110_000);
}

#[test]
fn a_contour_of_more_nodes_than_the_coprocessor_holds_is_refused_when_its_image_is_made() {
    // 260 mm at 0.02 mm: the cutter of 1 mm is sampled every fiftieth of its diameter.
    let mut part = short();
    part.job.tool.diameter = um(1_000);
    part.job.allowance = um(100);
    part.job.cut.axial_depth = um(1_000);
    part.job.correct.band = [Offset::ZERO, um(1_000)];
    part.job.correct.law = LawName::Mirror;
    part.program = b"G21 G90 S30000 M3\nT1 M6\nG0 X0 Y0\nG1 Z-1 F300\nG1 X260\nM30\n";
    part.probe = b"100 0.52 -0.5 0 0 0 0 0 0\n200 0.52 -0.5 0 0 0 0 0 0\n";
    let mut room: Box<Buffers<4, 13_600, 13_200, 13_100, 4>> = Box::default();
    let mut out = vec![0; image_bytes(14_000)];
    let result = image(&part.job, part.program, part.probe, &mut room.workspace(), &mut out, &mut |_, _| ());
    assert_eq!(result, Err(JobError::TooManyNodes { nodes: 13_001, limit: 12_000 }));
}

/// The workspace of a board with 8 MiB to spare.
type Eight = Buffers<16_384, 20_480, 17_920, 16_384, 256>;
const _: () = assert!(size_of::<Eight>() <= 8 << 20);

#[test]
fn a_contour_of_sixteen_thousand_lines_fits_into_eight_mebibytes() {
    // A round wall of 78.2 mm, milled in lines of 0.03 mm: two of them are one sample.
    let lines = 16_384;
    let mut program = String::from("G21 G90 S3000 M3\nT1 M6\nG0 X78.2 Y0\nG1 Z-4 F300\n");
    for k in 1..=lines {
        let (sine, cosine) = (f64::from(k) / f64::from(lines) * std::f64::consts::TAU).sin_cos();
        program += &format!("G1 X{:.6} Y{:.6}\n", 78.2 * cosine, 78.2 * sine);
    }
    program += "G0 Z50\nM30\n";
    // The ball of 2 mm touches the wall 2 mm outside the path; 0.03 mm are left on it.
    let radius = 78.2 + 2.0 - 1.0 - 0.03;
    let mut probe = String::new();
    for k in 0..256 {
        let (sine, cosine) = (f64::from(k) / 256.0 * std::f64::consts::TAU).sin_cos();
        probe += &format!("{:.6} {:.6} -2 0 0 0 0 0 0\n", radius * cosine, radius * sine);
    }
    let mut part = short();
    part.job.force.model = ForceModel::Mean;
    part.job.correct.law = LawName::Mirror;
    let mut room: Box<Eight> = Box::default();
    let mut out = vec![0; image_bytes(DEVICE_NODES)];
    let workspace = &mut room.workspace();
    let made = image(&part.job, program.as_bytes(), probe.as_bytes(), workspace, &mut out, &mut |_, _| ()).unwrap();
    assert!((8_000..9_000).contains(&made.nodes), "{made:?}");
    assert_eq!((made.points, made.set_aside), (256, 0));
    assert!(made.error_after < um(3), "{made:?}");
}

#[test]
fn a_job_survives_its_compact_form_and_nothing_else_is_one() {
    let mut largest = corner().job;
    largest.wall = None;
    (largest.dialect, largest.decimal) = (Dialect::Mach, PointlessLength::Least);
    largest.arc_centres = ArcCentres::Absolute;
    largest.tool.measured_diameter = Some(um(20_001));
    (largest.tool.runout, largest.tool.runout_deg) = (um(200), Real::from_bits((360 << 32) - 1));
    largest.tool.cantilever =
        Some(Stickout { length: Offset::from_nm(499_999_999), material: truepath_core::cut::ToolMaterial::Carbide });
    largest.cut.spindle_rpm = Some(Real::from_bits(200_000 << 32));
    largest.cut.feed_mm_per_min = Some(Real::from_bits(100_000 << 32));
    largest.force.ktc = Real::from_bits((20_000 << 32) - 1);
    largest.correct.max_gouge = Some(Offset::from_nm(999_999));
    (largest.tool.number, largest.tool.offset_number) = (Some(LARGEST_NUMBER), LARGEST_NUMBER);
    largest.correct.setup = LARGEST_NUMBER;
    for job in [corner().job, pocket().job, short().job, largest] {
        let mut buffer = [0; COMPACT_BYTES];
        let bytes = job.to_compact(&mut buffer).unwrap().to_vec();
        assert!(bytes.len() <= COMPACT_BYTES - 64, "{} bytes", bytes.len());
        assert_eq!(Job::from_compact(&bytes), Ok(job));
        for cut in 0..bytes.len() {
            assert_eq!(Job::from_compact(&bytes[..cut]), Err(JobError::Compact));
        }
        assert_eq!(Job::from_compact(&[&bytes[..], &[0]].concat()), Err(JobError::Compact));
        assert_eq!(job.to_compact(&mut [0; 8]), Err(JobError::Compact));
    }
}

#[test]
fn what_job_program_and_measurement_lack_is_named() {
    let part = short();
    let error = |change: &dyn Fn(&mut Part)| {
        let mut part = part;
        change(&mut part);
        made(&part).map(|m| m.0).unwrap_err()
    };
    assert_eq!(error(&|p| p.job.wall = None), JobError::NoWall);
    assert_eq!(error(&|p| p.job.probe = None), JobError::NoProbe);
    assert_eq!(error(&|p| p.program = b"(TRUEPATH CORRECTED)\nG0 X0\n"), JobError::Corrected);
    assert_eq!(error(&|p| p.probe = b"1 2 3\n").code(), "M003");
    assert_eq!(error(&|p| p.probe = b"3 -0.97 40 0 0 0 0 0 0\n").code(), "M015");
    assert_eq!(error(&|p| p.job.wall = Some(truepath_core::geometry::Side::Left)).code(), "M016");
    let mut clamped = corner();
    clamped.job.correct.clamp = um(5);
    assert_eq!(made(&clamped).map(|m| m.0).unwrap_err().code(), "J017");
    let no_speed = |p: &mut Part| {
        p.job.cut.spindle_rpm = None;
        p.program = b"G21 G90\nG0 X0 Y0\nG1 Z-4 F300\nG1 X8\nM30\n";
    };
    assert_eq!(error(&no_speed), JobError::NoSpeed);
    assert_eq!(error(&|p| p.job.tool.number = Some(7)), JobError::ToolsDiffer { job: 7, program: 1 });
    let no_feed = |p: &mut Part| {
        p.job.cut.feed_mm_per_min = None;
        p.program = b"G21 G90 S3000 M3\nG0 X0 Y0\nG0 Z-4\nG1 X8\nM30\n";
    };
    let failed = error(&no_feed);
    assert_eq!((failed.code(), failed.line()), ("J012", Some(4)));
}

/// A short wall whose program changes no tool.
fn without_tool(tool_change: &'static str) -> Part {
    let program = format!("G21 G90 G17\n{tool_change}\nS3000 M3\nG0 X0 Y0\nG1 Z-4 F300\nG1 X8\nG0 Z50\nM30\n");
    Part { program: program.leak().as_bytes(), ..short() }
}

#[test]
fn tool_offset_and_setup_of_an_image_are_those_of_the_job() {
    let binding = |part: &Part| Image::new_checked(&made(part).unwrap().1).unwrap().settings().binding;
    // The program says T1 M6; the job may repeat it, and adds offset and setup.
    let given = binding(&short());
    assert_eq!((given.feature, given.pass, given.tool, given.tool_offset, given.setup), (1, 1, 1, 0, 1));
    let mut part = short();
    (part.job.tool.number, part.job.tool.offset_number, part.job.correct.setup) = (Some(1), 21, 3);
    assert_eq!(binding(&part), Binding { tool_offset: 21, setup: 3, ..given });
    // Without a tool in the program, and with the empty spindle, it is the job's.
    for tool_change in ["(no tool)", "T0 M6", "T4"] {
        let mut part = without_tool(tool_change);
        part.job.tool.number = Some(99_999);
        assert_eq!(binding(&part).tool, 99_999);
    }
}

#[test]
fn without_a_tool_number_there_is_no_image_but_everything_else() {
    for tool_change in ["(no tool)", "T0 M6"] {
        let part = without_tool(tool_change);
        let mut stages = vec![];
        let mut room: Box<Room> = Box::default();
        let mut out = vec![0; image_bytes(DEVICE_NODES)];
        let tell = &mut |stage, _| stages.push(stage);
        let refused = image(&part.job, part.program, part.probe, &mut room.workspace(), &mut out, tell);
        // At once, and not after the work is done.
        assert_eq!((refused, stages.as_slice()), (Err(JobError::NoTool), &[Stage::Reading][..]));
        let mut lent = room.workspace();
        assert!(ContourPass::read(&part.job, part.program, &mut lent.parameters, lent.blocks).is_ok());
    }
}
