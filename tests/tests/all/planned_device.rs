//! A planned part with the coprocessor: the device in process is given the image of every pass and armed for it, in order, while an
//! interpolator follows the program; what it sends to the drives is what the program of the other route commands.

use std::path::Path;

use truepath_bench::{BenchError, Board, BulkBoard, Event, InProcess, configure};
use truepath_core::gcode::program_crc;
use truepath_core::geometry::{Block, Curve, Point, Shape};
use truepath_core::image::Image;
use truepath_core::link::{
    AnswerFrame, Ask, Deframer, DeviceSettings, Framed, Item, MAX_SETPOINT_BYTES, SetpointFrame, unstuff,
};
use truepath_core::process::Aim;
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Mode, Output, Reason, Setpoint};
use truepath_core::units::{Offset, Real};
use truepath_correction::plan::choice::Planner;
use truepath_correction::plan::process::{Cut, Levels};
use truepath_correction::plan::written::{Chosen, WrittenPlan, write};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::feature::Survey;
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

/// Two legs with an inside corner, with leads; armed for one correction as the documentation says.
const CORNER: &str = "%\nG21 G90 G17 G54\nT3 M6\nS4000 M3\nM160 P1\nG0 X12 Y-14 Z20\nG0 Z2\nG1 Z-10 F400\nG1 X0 Y-8 F800\nG1 Y40\n\
    G2 X10 Y50 I10 J0\nG1 X60\nG1 X66 Y44\nG0 Z20\nM30\n%\n";
const JOB: &str = "version = 1\nprogram = \"p.nc\"\ndialect = \"linuxcnc\"\nwall = \"left\"\n[stock]\nallowance_mm = 0.5\n[tool]\n\
    diameter_mm = 12.0\nteeth = 4\nhelix_deg = 35.0\nnumber = 3\n[cut]\naxial_depth_mm = 10.0\n[force]\nmaterial = \"al-7075-t6\"\n\
    model = \"helical\"\n[machine]\nstiffness_x_n_per_mm = 2000\nstiffness_y_n_per_mm = 2000\n[probe]\nball_diameter_mm = 4.0\n\
    format = \"linuxcnc\"\nz_reference = \"centre\"\n";
const PLANT: &str = "ktc_n_per_mm2 = 900\nkrc_n_per_mm2 = 250\nkte_n_per_mm = 12\nkre_n_per_mm = 10\nstiffness_x_n_per_mm = 1700\nstiffness_y_n_per_mm = 2300\n";
/// Millimetres of a corrected path beside its ends in which a correction comes and goes.
const LEADS_MM: f64 = 2.0;

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

fn job(text: &str) -> JobFile {
    shown(JobFile::parse(Source::new("job.toml", text.into()), Path::new("")).map_err(Failure::from))
}

fn measured() -> (Pass, Measurement) {
    let pass = shown(Pass::new(job(JOB), Source::new("p.nc", CORNER.into())));
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let first = shown(virtual_mill::mill(&pass, &machine, None));
    let probe = shown(virtual_mill::probe(&pass, &first, &[15.0, 30.0, 55.0, 80.0, 95.0], &[0.3, 0.5, 0.8], 4.0));
    let measurement = shown(Measurement::read(&pass, &Source::new("probe.txt", probe.into_bytes())));
    (pass, measurement)
}

/// A pass that leaves little, a level of half the depth over it, and the last one the other way at another feed.
fn cuts() -> [Cut; 2] {
    let levels = Levels::Even(2);
    let first = Cut { levels, ..Cut::whole(Aim::Least(Offset::from_um(20))) };
    [first, Cut { reversed: true, feed_percent: 150, ..Cut::whole(Aim::Middle) }]
}

/// The moves of every pass of a written program with its height, nm.
fn passes(plan: &WrittenPlan) -> Vec<(Vec<Block>, i64)> {
    let source = Source::new("written.nc", plan.program.text.clone());
    let survey = Survey::read(&job(JOB), &source).unwrap();
    let on = |lines: &[u32; 2]| {
        let mut runs = survey.runs.iter().filter(|r| (lines[0]..=lines[1]).contains(&r.run.lines.first));
        let run = runs.next().expect("a run");
        assert!(runs.next().is_none());
        (run.blocks(&survey.blocks).to_vec(), run.run.z.expect("a height").nm())
    };
    plan.program.depths.iter().flat_map(|depth| &depth.passes).map(on).collect()
}

/// A device, and the controller that sends it setpoints every millisecond.
struct Machine1kHz {
    board: BulkBoard<InProcess>,
    frame: Frame,
    sequence: u32,
    spindle_millirpm: u32,
}

impl Machine1kHz {
    fn new(spindle_rpm: u32) -> Self {
        let mut board = BulkBoard::new(InProcess::start().unwrap());
        configure(&mut board, &DeviceSettings::at_1_khz()).unwrap();
        let frame = Frame::identity().sealed();
        let mut own = Self { board, frame, sequence: 0, spindle_millirpm: spindle_rpm * 1000 };
        own.send(&[[0, 0, 20_000_000]; 100], Flags::default());
        own.board.client().done(Ask::AcknowledgeDrivesDisabled).unwrap();
        own
    }

    /// Sends positions; what came back for each.
    fn send(&mut self, positions: &[[i64; 3]], flags: Flags) -> Vec<Output> {
        let mut events = Vec::new();
        for at in positions {
            self.sequence += 1;
            let setpoint = Setpoint {
                axes: [at[0], at[1], at[2], 0, 0, 0],
                spindle_millirpm: self.spindle_millirpm,
                sequence: self.sequence,
                frame_crc: self.frame.crc,
                flags,
                ..Setpoint::default()
            };
            let mut packet = [0; MAX_SETPOINT_BYTES + 2];
            let used = SetpointFrame { axes: 3, setpoint }.encode_packet(&mut packet).unwrap();
            events.push(Event::Time(1_000));
            events.push(Event::Setpoint { bytes: packet[..used].to_vec(), answers: 1 });
        }
        let answers = self.board.exchange(&events).unwrap().answers;
        let (mut bytes, mut deframer, mut outputs) = (&answers[..], Deframer::<256>::new(), Vec::new());
        while let Some(Framed::Packet(packet)) = deframer.feed(&mut bytes) {
            outputs.push(AnswerFrame::decode(unstuff(packet).unwrap(), 3).unwrap().output);
        }
        assert_eq!(outputs.len(), positions.len());
        outputs
    }

    fn arm(&mut self, image: &Image<'_>, bytes: &[u8], part_serial: u32) -> Result<(), BenchError> {
        let mut client = self.board.client();
        let there = client.upload(Item::Image, bytes, |_| ()).unwrap();
        client.done(Ask::Activate { slot: there.slot, crc: there.crc }).unwrap();
        let binding = image.settings().binding;
        client.done(Ask::Arm(ArmRequest { binding, part_serial, frame: self.frame }))
    }
}

/// Setpoints along a pass: down above its start, along it at its feed, up at its end.
fn setpoints(blocks: &[Block], z: i64) -> Vec<[i64; 3]> {
    let (first, last) = (blocks[0].curve.start(), blocks[blocks.len() - 1].curve.end());
    let down = (0..=1_500).map(|k| [first.x.nm(), first.y.nm(), z + (1_500 - k) * 5_000]);
    let up = (1..=1_500).map(|k| [last.x.nm(), last.y.nm(), z + k * 5_000]);
    let (mut points, mut over) = (down.collect::<Vec<_>>(), 0.0);
    for block in blocks {
        let length = block.curve.length().nm() as f64;
        let step = f64::from(block.feed.round_to_int() as i32) / 60.0 * 1e3;
        while over < length {
            let p = block.curve.point(Real::ratio(over as i64, length as i64));
            points.push([p.x.nm(), p.y.nm(), z]);
            over += step;
        }
        over -= length;
    }
    points.extend(up);
    points
}

fn distance(p: [i64; 3], curve: &Curve) -> f64 {
    let near = |a: Point| (a.x.nm() as f64 - p[0] as f64, a.y.nm() as f64 - p[1] as f64);
    let (s, e) = (near(curve.start()), near(curve.end()));
    let ends = s.0.hypot(s.1).min(e.0.hypot(e.1));
    match curve.shape() {
        Shape::Line => {
            let way = (e.0 - s.0, e.1 - s.1);
            let u = -(s.0 * way.0 + s.1 * way.1) / (way.0 * way.0 + way.1 * way.1);
            if (0.0..=1.0).contains(&u) { (s.0 + u * way.0).hypot(s.1 + u * way.1) } else { ends }
        }
        Shape::Arc { centre, .. } => {
            let c = near(centre);
            let radius = (curve.start().distance(centre).nm() as f64 + curve.end().distance(centre).nm() as f64) / 2.0;
            (c.0.hypot(c.1) - radius).abs()
        }
    }
}

#[test]
fn the_device_armed_for_each_pass_commands_what_the_planned_program_does() {
    let (pass, measurement) = measured();
    let planner = shown(Planner::new(&pass, &measurement, |_| ()));
    let cuts = cuts();
    let chosen = [Chosen { planner: &planner, cuts: &cuts, cutter: None }];
    let by_program = shown(write(&chosen, Route::Program, 1, &mut |_| ()));
    let armed = shown(write(&chosen, Route::Coprocessor, 1, &mut |_| ()));
    assert!(by_program.program.images.is_empty() && armed.program.images.len() == 3);

    let text = String::from_utf8(armed.program.text.clone()).unwrap();
    let arming: Vec<&str> = text.lines().filter(|line| line.starts_with("M160")).collect();
    assert_eq!(arming, ["M160 P1.1", "M160 P1.2", "M160 P1.3"], "{text}");
    assert!(text.contains("(M160 P1, NOW BEFORE EACH PASS)"), "{text}");
    // The cutter stands above the start when a pass is armed: the next move goes down.
    for (k, line) in text.lines().enumerate().filter(|(_, line)| line.starts_with("M160")) {
        let next = text.lines().nth(k + 1).unwrap();
        assert!(next.contains(" Z") && !next.contains('X') && !next.contains('Y'), "{line}: {next}");
    }

    let (nominal, wanted) = (passes(&armed), passes(&by_program));
    let mut machine = Machine1kHz::new(4000);
    let mut largest = 0.0f64;
    for (k, image) in armed.program.images.iter().enumerate() {
        let checked = Image::new_checked(&image.bytes).unwrap();
        let binding = checked.settings().binding;
        assert_eq!((binding.program_crc, binding.pass), (program_crc(&armed.program.text), k as u32 + 1));
        machine.arm(&checked, &image.bytes, 7).unwrap();
        let (blocks, z) = &nominal[k];
        let sent = setpoints(blocks, *z);
        let answers = machine.send(&sent, Flags::DRIVES_ENABLED);
        let active = answers.iter().filter(|o| o.mode == Mode::Active).count();
        let last = answers.last().unwrap();
        assert_eq!((last.mode, last.reason), (Mode::Bypass, Reason::Completed), "pass {}", k + 1);
        assert!(active > sent.len() / 3, "pass {}: {active} of {}", k + 1, sent.len());
        // Beside the leads every place is on the path that the other route writes.
        let (own, other) = (&wanted[k].0, wanted[k].1);
        assert_eq!(other, *z);
        let ends = [checked.node(0), checked.node(checked.len() - 1)];
        let origin = checked.header().origin;
        for output in answers.iter().filter(|o| o.mode == Mode::Active) {
            let at = [output.axes[0], output.axes[1], output.axes[2]];
            let far = ends.iter().all(|end| {
                let [x, y] = [origin.x.nm() + i64::from(end.x), origin.y.nm() + i64::from(end.y)];
                ((at[0] - x) as f64).hypot((at[1] - y) as f64) > LEADS_MM * 1e6
            });
            if far {
                let off = own.iter().map(|block| distance(at, &block.curve)).fold(f64::INFINITY, f64::min);
                largest = largest.max(off);
            }
        }
        let moved = answers.iter().flat_map(|o| o.correction_nm).map(i32::unsigned_abs).max().unwrap();
        assert!(moved > 2_000, "pass {} is hardly moved: {moved} nm", k + 1);
    }
    println!("largest distance from the program route: {largest:.0} nm");
    // A micrometre is the tolerance of the program's lines and arcs, 0.3 um the chord of the image's nodes.
    assert!(largest < 1_500.0, "{largest} nm");

    // The same part is not armed for any of its passes again; the next one is.
    let first = &armed.program.images[0];
    let checked = Image::new_checked(&first.bytes).unwrap();
    assert!(machine.arm(&checked, &first.bytes, 7).is_err());
    machine.arm(&checked, &first.bytes, 8).unwrap();
}

#[test]
fn what_the_contract_of_a_control_forbids_is_refused_by_name() {
    let (pass, measurement) = measured();
    let refused = |pass: &Pass, cuts: &[Cut]| {
        let planner = shown(Planner::new(pass, &measurement, |_| ()));
        let answer = write(&[Chosen { planner: &planner, cuts, cutter: None }], Route::Coprocessor, 1, &mut |_| ());
        let Err(Failure::Input(error)) = answer.map(|_| ()) else { panic!("written") };
        (error.code().to_owned(), error.found().to_owned())
    };
    let with = |job_text: &str, program: &str| shown(Pass::new(job(job_text), Source::new("p.nc", program.into())));
    let haas = with(&JOB.replace("linuxcnc\"\nwall", "haas\"\nwall"), CORNER);
    let (code, found) = refused(&haas, &cuts());
    assert!(code == "P022" && found.contains("haas"), "{found}");
    // A line that arms and does something else is not taken out.
    let busy = with(JOB, &CORNER.replace("M160 P1\n", "M160 P1 M8\n"));
    let (code, found) = refused(&busy, &cuts());
    assert!(code == "P022" && found.contains("M160 P1 M8"), "{found}");
    // The tenths of P are the pass: there are nine.
    let many = [cuts()[0]; 5];
    let (code, found) = refused(&pass, &[&many[..], &cuts()[1..]].concat());
    assert!(code == "P022" && found.contains("more passes than 9"), "{found}");
    // On a ramp there is no place above the start at which to arm.
    let ramp = with(JOB, &CORNER.replace("G1 Z-10 F400\nG1 X0 Y-8 F800", "G1 X0 Y-8 Z-10 F400\nG1 Y-7 F800"));
    assert_eq!(refused(&ramp, &cuts()[1..]).0, "P009");
}
