//! The correction image of a pass: the array of the core with what it belongs to and what it may do.

use truepath_core::correct::Node;
use truepath_core::geometry::{Point, Vector};
use truepath_core::image::{
    Binding, CorrectionLimits, FeedLaw, FineOffset, ImageNode, ImageSettings, PathWindow, build as build_image,
    image_bytes, peak,
};
use truepath_core::units::{Offset, Real};

use crate::correction::Identified;
use crate::diagnostics::{Failure, InputError};
use crate::pass::Pass;
use crate::report::mm;

/// Nodes nearer to each other than this are one: at a sharp inside corner the normal turns on the spot.
const NEAREST: Offset = Offset::from_um(2);
/// Nodes that fit into the memory of the coprocessor.
pub const DEVICE_NODES: usize = 16_384;
/// Fastest change of the correction. A corner that triples the load asks for less than 1 mm/s.
const SLEW_NM_PER_S: u32 = 20_000_000;
/// Fastest change of that.
const ACCELERATION_NM_PER_S2: u64 = 2_000_000_000;
/// How far a setpoint may be from the path: blending of the interpolator, wear, margin.
const PATH_TOLERANCE: Offset = Offset::from_um(500);
/// How far the height of a setpoint may be from that of the pass.
const HEIGHT_TOLERANCE: Offset = Offset::from_um(50);
/// How far above the pass the correction may begin, over the start of the contour.
const GATE_HEIGHT: Offset = Offset::from_um(2_000);

/// Makes the image of a correction, given as the samples of the contour with their nodes and feeds.
///
/// The chip part of every node is brought to the highest feed of the contour, which becomes the nominal one.
///
/// # Errors
/// A correction beyond the clamp somewhere in the feed window, or a contour too large for an image.
pub fn build(
    pass: &Pass,
    identified: &Identified,
    nodes: impl Iterator<Item = (Point, Real, Node)>,
) -> Result<Vec<u8>, Failure> {
    let coefficients = &identified.fit.parameters.coefficients;
    let scale = |feed: Real| coefficients.chip_scale(pass.setup.feed_per_tooth(feed));
    let feeds = || pass.blocks.iter().map(|b| b.feed);
    let (Some(low), Some(nominal)) = (feeds().min(), feeds().max()) else {
        return Err(Failure::Internal("a contour without blocks".to_owned()));
    };
    let mut kept: Vec<ImageNode> = Vec::new();
    for (point, feed, node) in nodes {
        if kept.last().is_some_and(|last| last.point.distance(point) < NEAREST) {
            continue;
        }
        let chip = if feed == nominal { node.chip } else { node.chip.scaled(scale(nominal) / scale(feed)) };
        kept.push(ImageNode { point, chip: fine(pass, chip)?, edge: fine(pass, node.edge)? });
    }
    // The widest feed window in which the correction stays inside the clamp, up to 150 %.
    let mut reach = Offset::ZERO;
    let mut within = None;
    for percent in (110..=150).rev().step_by(5) {
        let settings = settings(pass, identified, low / nominal, (nominal, Real::ratio(percent, 100)))?;
        reach = peak(&kept, &settings.feed);
        if reach <= settings.limits.clamp {
            within = Some(settings);
            break;
        }
    }
    let Some(settings) = within else { return Err(beyond_clamp(pass, reach)) };
    let mut bytes = vec![0; image_bytes(kept.len())];
    build_image(&settings, &kept, &mut bytes).map_err(|e| {
        InputError::new(
            "I001",
            format!("no image can be made: {e}"),
            "",
            "correct in the program instead (route = \"program\")",
        )
        .at(pass.job.source(), pass.job.span("correct"))
    })?;
    Ok(bytes)
}

fn settings(
    pass: &Pass,
    identified: &Identified,
    lowest: Real,
    (nominal, highest): (Real, Real),
) -> Result<ImageSettings, Failure> {
    let per_tooth = pass.setup.feed_per_tooth(nominal);
    let Some(per_tooth) = FineOffset::checked_from_mm(per_tooth) else {
        return Err(Failure::Internal("feed per tooth beyond 8 mm".to_owned()));
    };
    let rpm = pass.setup.spindle_rpm * Real::from_int(1000);
    let clamp = pass.job.correct.clamp;
    let z = pass.contour.z;
    Ok(ImageSettings {
        binding: Binding {
            program_crc: pass.program_crc,
            feature: 1,
            pass: 1,
            tool: pass.contour.tool.unwrap_or(0),
            tool_offset: 0,
            setup: 1,
        },
        closed: pass.contour.closed,
        feed: FeedLaw::new(
            per_tooth,
            pass.setup.teeth.into(),
            rpm.round_to_int().clamp(0, i64::from(u32::MAX)) as u32,
            identified.fit.parameters.coefficients.size_exponent,
            // From half the slowest programmed feed.
            lowest * Real::HALF,
            highest,
        ),
        limits: CorrectionLimits {
            clamp,
            warn: clamp.scaled(Real::ratio(4, 5)),
            slew_nm_per_s: SLEW_NM_PER_S,
            acceleration_nm_per_s2: ACCELERATION_NM_PER_S2,
        },
        window: PathWindow {
            tolerance: PATH_TOLERANCE,
            z_low: z - HEIGHT_TOLERANCE,
            z_high: z + HEIGHT_TOLERANCE,
            gate_height: GATE_HEIGHT,
        },
        node_step: pass.step(),
    })
}

fn fine(pass: &Pass, v: Vector) -> Result<[FineOffset; 2], Failure> {
    match (FineOffset::checked_from_offset(v.x), FineOffset::checked_from_offset(v.y)) {
        (Some(x), Some(y)) => Ok([x, y]),
        _ => Err(beyond_clamp(pass, v.x.abs().max(v.y.abs()))),
    }
}

fn beyond_clamp(pass: &Pass, reach: Offset) -> Failure {
    InputError::new(
        "J018",
        format!(
            "at 110 % of the programmed feed the correction reaches {:.3} mm, beyond clamp_mm = {}",
            mm(reach),
            mm(pass.job.correct.clamp)
        ),
        "a correction that leaves room for a feed override of 110 %",
        crate::correction::clamp_help(reach),
    )
    .at(pass.job.source(), pass.job.span("correct.clamp_mm"))
    .into()
}
