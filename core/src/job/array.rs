//! The image of a correction: the array with what it belongs to and what it may do.

use super::{Buffer, ContourPass, Identified, JobError};
use crate::correct::Node;
use crate::cut::{Path, Sample};
use crate::geometry::Block;
use crate::image::{
    CorrectionLimits, DEVICE_NODES, FeedLaw, FineOffset, ImageError, ImageNode, ImageSettings, PathWindow, build,
    image_bytes, peak,
};
use crate::units::{Offset, Real};

/// Nodes nearer to each other than this are one: at a sharp inside corner the normal turns on the spot.
const NEAREST: Offset = Offset::from_um(2);
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
/// The widest and the narrowest feed window, percent of the programmed feed, and the steps between them.
const WINDOW: (i64, i64, i64) = (150, 110, 5);

/// An image that was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// Its bytes, from the start of the buffer.
    pub bytes: usize,
    /// Its nodes.
    pub nodes: usize,
    /// Its checksum, which also serves as its name.
    pub crc: u32,
}

/// Brings the chip part of every node to the highest feed of the contour, which becomes the nominal one of the image;
/// `nodes` belong to the contour's own samples.
///
/// # Errors
/// [`JobError::NoFeedWindow`] when a part is beyond what an image can hold.
pub fn to_nominal_feed(
    pass: &ContourPass,
    identified: &Identified,
    path: &Path,
    blocks: &[Block],
    nodes: &mut [Node],
) -> Result<(), JobError> {
    let coefficients = &identified.fit.parameters.coefficients;
    let scale = |feed: Real| coefficients.chip_scale(pass.setup.feed_per_tooth(feed));
    let (_, nominal) = feeds(blocks);
    let at_nominal = scale(nominal);
    let mut ratio = (nominal, Real::ONE);
    for (node, sample) in nodes.iter_mut().zip(path.samples().iter().skip(path.first())) {
        if sample.feed != nominal {
            if sample.feed != ratio.0 {
                ratio = (sample.feed, at_nominal / scale(sample.feed));
            }
            node.chip = node.chip.scaled(ratio.1);
        }
        for part in [node.chip, node.edge] {
            if fine(part.x).is_none() || fine(part.y).is_none() {
                let reach = part.x.abs().max(part.y.abs());
                return Err(JobError::NoFeedWindow { reach, clamp: pass.job.correct.clamp });
            }
        }
    }
    Ok(())
}

/// Makes the image of a correction that [`to_nominal_feed`] has prepared, with the widest feed window in which it stays
/// inside the clamp, up to 150 %.
///
/// # Errors
/// No tool number, a correction beyond the clamp at 110 % of the feed, more nodes than the coprocessor holds, or a buffer too short.
pub fn write_image(
    pass: &ContourPass,
    identified: &Identified,
    path: &Path,
    blocks: &[Block],
    nodes: &[Node],
    out: &mut [u8],
) -> Result<Written, JobError> {
    let samples = path.samples().get(path.first()..).unwrap_or_default();
    let kept = Kept { samples, nodes, last: None };
    let (lowest, nominal) = feeds(blocks);
    let (widest, narrowest, step) = WINDOW;
    let mut percent = widest;
    let settings = loop {
        let settings = settings(pass, identified, lowest / nominal, (nominal, Real::ratio(percent, 100)))?;
        let reach = peak(kept.clone(), &settings.feed);
        if reach <= settings.limits.clamp {
            break settings;
        }
        percent = percent.saturating_sub(step);
        if percent < narrowest {
            return Err(JobError::NoFeedWindow { reach, clamp: settings.limits.clamp });
        }
    };
    let count = kept.clone().count();
    if count > DEVICE_NODES {
        return Err(JobError::TooManyNodes { nodes: count as u32, limit: DEVICE_NODES as u32 });
    }
    let image = build(&settings, kept, out).map_err(|error| match error {
        ImageError::Buffer { needed, found } => JobError::full(Buffer::Image, needed, found),
        error => JobError::Image(error),
    })?;
    Ok(Written { bytes: image_bytes(count), nodes: count, crc: image.crc() })
}

/// The lowest and the highest feed of a contour.
fn feeds(blocks: &[Block]) -> (Real, Real) {
    let feeds = || blocks.iter().map(|b| b.feed);
    (feeds().min().unwrap_or_default(), feeds().max().unwrap_or_default())
}

/// The samples of the contour that become nodes, in the order of travel.
#[derive(Clone)]
struct Kept<'a> {
    samples: &'a [Sample],
    nodes: &'a [Node],
    last: Option<&'a Sample>,
}

impl Iterator for Kept<'_> {
    type Item = ImageNode;

    fn next(&mut self) -> Option<ImageNode> {
        loop {
            let ((sample, samples), (node, nodes)) = (self.samples.split_first()?, self.nodes.split_first()?);
            (self.samples, self.nodes) = (samples, nodes);
            if self.last.is_some_and(|last| last.point.distance(sample.point) < NEAREST) {
                continue;
            }
            self.last = Some(sample);
            let part = |x, y| [fine(x).unwrap_or_default(), fine(y).unwrap_or_default()];
            return Some(ImageNode {
                point: sample.point,
                chip: part(node.chip.x, node.chip.y),
                edge: part(node.edge.x, node.edge.y),
            });
        }
    }
}

/// A component as an image holds it; `None` beyond 8.38 mm.
const fn fine(component: Offset) -> Option<FineOffset> {
    FineOffset::checked_from_offset(component)
}

fn settings(
    pass: &ContourPass,
    identified: &Identified,
    lowest: Real,
    (nominal, highest): (Real, Real),
) -> Result<ImageSettings, JobError> {
    let per_tooth = pass.setup.feed_per_tooth(nominal);
    let per_tooth = FineOffset::checked_from_mm(per_tooth).ok_or(JobError::FeedPerTooth)?;
    let rpm = pass.setup.spindle_rpm * Real::from_int(1000);
    let clamp = pass.job.correct.clamp;
    let z = pass.contour.z;
    Ok(ImageSettings {
        binding: pass.binding()?,
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
