//! Jobs, programs and measurements of the corner and the pocket, and memory to make their images in.

use truepath_core::correct::Target;
use truepath_core::geometry::Side;
use truepath_core::image::{DEVICE_NODES, image_bytes};
use truepath_core::job::{
    Buffers, Compensation, Correct, Cut, Force, ForceModel, Job, JobError, LawName, Machine, Made, Probe, Tool,
    ZReference, image,
};
use truepath_core::probe::Format;
use truepath_core::units::{Offset, Real};

/// Room for the corner and the pocket, and little more.
pub type Room = Buffers<64, 4_096, 3_328, 3_072, 64>;

/// A job with the files that belong to it.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    pub job: Job,
    pub program: &'static [u8],
    pub probe: &'static [u8],
}

pub const fn um(um: i64) -> Offset {
    Offset::from_um(um)
}

/// The corner of Petrakov & Shuplietsov (2018), mean force: host-sim/demo/corner.
pub fn corner() -> Part {
    let job = Job {
        wall: Some(Side::Right),
        allowance: um(3_000),
        tool: Tool {
            diameter: um(20_000),
            measured_diameter: None,
            runout: Offset::ZERO,
            runout_deg: Real::ZERO,
            teeth: 6,
            helix_deg: Real::from_int(30),
            cantilever: None,
            number: None,
            offset_number: 0,
            compensation: Compensation::Centre,
        },
        cut: Cut { axial_depth: um(10_000), spindle_rpm: None, feed_mm_per_min: Some(Real::from_int(400)) },
        force: Force {
            ktc: Real::from_int(1200),
            krc: Real::from_int(345),
            kte: Real::ZERO,
            kre: Real::ZERO,
            model: ForceModel::Mean,
            stated: true,
        },
        machine: Machine { stiffness_x: Real::from_int(880), stiffness_y: Real::from_int(1500), stated: true },
        probe: Some(Probe {
            ball_diameter: um(6_000),
            format: Format::Linuxcnc,
            layout: None,
            work_offset: None,
            z_reference: ZReference::Centre,
            noise: um(2),
        }),
        correct: Correct {
            law: LawName::Model,
            clamp: um(500),
            target: Target::Mean,
            band: [Offset::ZERO, um(10_000)],
            max_gouge: None,
            setup: 1,
        },
        part: None,
        dialect: truepath_core::gcode::Dialect::Linuxcnc,
        decimal: truepath_core::gcode::PointlessLength::Calculator,
        arc_centres: truepath_core::gcode::ArcCentres::Detect,
    };
    let program = include_bytes!("../../../../host-sim/demo/corner/program.nc");
    Part { job, program, probe: include_bytes!("../../data/corner-probe.txt") }
}

/// A finishing pass round a pocket, helical cutter: host-sim/demo/pocket.
pub fn pocket() -> Part {
    let corner = corner().job;
    let job = Job {
        allowance: um(800),
        tool: Tool { diameter: um(10_000), teeth: 4, helix_deg: Real::from_int(38), ..corner.tool },
        cut: Cut { axial_depth: um(12_000), spindle_rpm: None, feed_mm_per_min: None },
        force: Force {
            ktc: Real::from_int(820),
            krc: Real::from_int(230),
            kte: Real::from_int(12),
            kre: Real::from_int(12),
            model: ForceModel::Auto,
            stated: true,
        },
        machine: Machine { stiffness_x: Real::from_int(1900), stiffness_y: Real::from_int(1900), stated: true },
        probe: corner.probe.map(|p| Probe { ball_diameter: um(4_000), ..p }),
        correct: Correct { band: [Offset::ZERO, um(12_000)], ..corner.correct },
        ..corner
    };
    let program = include_bytes!("../../../../host-sim/demo/pocket/program.nc");
    Part { job, program, probe: include_bytes!("../../data/pocket-probe.txt") }
}

/// A short straight wall and a small cutter: the whole way in a moment.
pub fn short() -> Part {
    let corner = corner().job;
    let job = Job {
        allowance: um(500),
        tool: Tool { diameter: um(4_000), teeth: 2, ..corner.tool },
        cut: Cut { axial_depth: um(4_000), spindle_rpm: Some(Real::from_int(3000)), ..corner.cut },
        probe: corner.probe.map(|p| Probe { ball_diameter: um(2_000), ..p }),
        correct: Correct { band: [Offset::ZERO, um(4_000)], ..corner.correct },
        ..corner
    };
    let program = b"G21 G90 G17\nT1 M6\nS3000 M3\nG0 X0 Y0\nG1 Z-4 F300\nG1 X8\nG2 X10 Y-2 I0 J-2\nG0 Z50\nM30\n";
    let probe = b"3.0 -0.97 -2 0 0 0 0 0 0\n6.0 -0.96 -2 0 0 0 0 0 0\n";
    Part { job, program, probe }
}

/// Makes the image of a part in roomy memory.
pub fn made(part: &Part) -> Result<(Made, Vec<u8>), JobError> {
    let mut room: Box<Room> = Box::default();
    let mut out = vec![0; image_bytes(DEVICE_NODES)];
    let made = image(&part.job, part.program, part.probe, &mut room.workspace(), &mut out, &mut |_, _| ())?;
    out.truncate(made.bytes as usize);
    Ok((made, out))
}
