//! An image to try things with, which needs no job: a straight pass of a few millimetres along X.

use truepath_core::geometry::Point;
use truepath_core::image::{
    Binding, CorrectionLimits, FeedLaw, FineOffset, ImageNode, ImageSettings, PathWindow, build, image_bytes,
};
use truepath_core::units::{Offset, Position, Real};

/// Z of its pass, nm.
pub const EXAMPLE_PASS: i64 = -10_000_000;
/// Way per tick at its nominal feed and 1 kHz, nm: 400 mm/min.
pub const EXAMPLE_FEED: i64 = 6_667;

/// An image before it is built.
#[derive(Clone, Debug)]
pub struct Example {
    /// What it belongs to and what bounds it.
    pub settings: ImageSettings,
    /// Its path and corrections.
    pub nodes: Vec<ImageNode>,
}

impl Example {
    /// As many nodes, 0.1 mm apart, from the origin on; `chip_um` gives what each corrects in X and Y at the nominal feed, µm.
    pub fn along_x(count: i64, chip_um: impl Fn(i64) -> [i64; 2]) -> Self {
        let node = |k: i64| ImageNode {
            point: Point::from_nm(k * 100_000, 0),
            chip: chip_um(k).map(|um| fine(um * 1_000)),
            edge: [FineOffset::ZERO; 2],
        };
        Self { settings: settings(), nodes: (0..count).map(node).collect() }
    }

    /// The image.
    ///
    /// # Panics
    /// It is none: a correction is larger than its clamp, or a setting that was changed is out of its range.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = vec![0; image_bytes(self.nodes.len())];
        build(&self.settings, self.nodes.iter().copied(), &mut bytes).expect("an image within its ranges");
        bytes
    }
}

fn fine(nm: i64) -> FineOffset {
    FineOffset::checked_from_offset(Offset::from_nm(nm)).unwrap_or(FineOffset::ZERO)
}

fn settings() -> ImageSettings {
    ImageSettings {
        binding: Binding { program_crc: 0x1234_5678, feature: 1, pass: 1, tool: 3, tool_offset: 3, setup: 1 },
        closed: false,
        feed: FeedLaw::new(fine(44_447), 6, 1_500_000, Real::ZERO, Real::ratio(1, 4), Real::ratio(3, 2)),
        limits: CorrectionLimits {
            clamp: Offset::from_um(500),
            warn: Offset::from_um(200),
            slew_nm_per_s: 20_000_000,
            acceleration_nm_per_s2: 1_000_000_000,
        },
        window: PathWindow {
            tolerance: Offset::from_um(200),
            z_low: Position::from_nm(EXAMPLE_PASS),
            z_high: Position::from_nm(EXAMPLE_PASS),
            gate_height: Offset::from_um(5_000),
        },
        node_step: Offset::from_um(100),
    }
}
