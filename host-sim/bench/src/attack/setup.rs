//! An image and settings, drawn at random from all that the checks of both permit.

use truepath_core::geometry::Point;
use truepath_core::image::{
    Binding, CorrectionLimits, FeedLaw, FineOffset, Image, ImageNode, ImageSettings, PathWindow, build, image_bytes,
    peak,
};
use truepath_core::link::DeviceSettings;
use truepath_core::rewrite::{AXES, NO_ACCELERATION_CAP, NO_VELOCITY_CAP, Settings};
use truepath_core::units::{Offset, Position, Real};

use crate::chance::Chance;

/// What a session is about.
#[derive(Clone, Debug)]
pub struct Setup {
    settings: DeviceSettings,
    image: ImageSettings,
    nodes: Vec<ImageNode>,
    /// The image, and the same for another program.
    bytes: [Vec<u8>; 2],
    /// Way per tick at the nominal feed, nm.
    feed_nm: i64,
}

impl Setup {
    /// Draws one.
    ///
    /// # Panics
    /// What is drawn is no image: a mistake in here.
    pub fn draw(chance: &mut Chance) -> Self {
        let tick_hz = [100, 250, 500, 1_000, 1_000, 1_000, 2_000, 4_000, 10_000][chance.below(9) as usize];
        let spacing_nm = [20_000, 100_000, 100_000, 100_000, 300_000, 990_000][chance.below(6) as usize];
        let feed_nm = (spacing_nm / (1 + chance.below(12) as i64)).max(500);
        let closed = chance.one_in(5);
        let points = if closed { circle(chance, spacing_nm) } else { open_path(chance, spacing_nm) };
        let way_nm = spacing_nm * points.len() as i64;
        let tolerance_nm = [way_nm / 40, way_nm / 20, way_nm / 10][chance.below(3) as usize].clamp(1_000, 5_000_000);
        let feed = feed_law(chance, feed_nm, tick_hz);
        let nodes = nodes(chance, &points);
        // What the nodes want is what the clamp permits: it is reached, and where the profile is steep it is pressed against.
        let clamp = peak(nodes.iter().copied(), &feed).max(Offset::from_nm(1));
        let clamp_nm = clamp.nm();
        let velocity_nm = (clamp_nm / (1 + chance.below(60) as i64)).max(1) as u64;
        let acceleration_nm = (velocity_nm / (1 + chance.below(25))).max(1);
        let hz = u64::from(tick_hz);
        let limits = CorrectionLimits {
            clamp,
            warn: Offset::from_nm(clamp_nm / 2),
            slew_nm_per_s: (velocity_nm * hz).clamp(hz, 4_000_000_000) as u32,
            acceleration_nm_per_s2: (acceleration_nm * hz * hz).clamp(hz * hz, 1_000_000_000_000),
        };
        let high_nm = chance.around(50_000_000);
        let window = PathWindow {
            tolerance: Offset::from_nm(tolerance_nm),
            z_low: Position::from_nm(high_nm - chance.below(2) as i64 * chance.below(3_000_000) as i64),
            z_high: Position::from_nm(high_nm),
            gate_height: Offset::from_nm([0, tolerance_nm / 2, 3 * tolerance_nm, 5_000_000][chance.below(4) as usize]),
        };
        let number = |chance: &mut Chance| chance.below(1 << 32) as u32;
        let binding = Binding {
            program_crc: number(chance),
            feature: number(chance),
            pass: number(chance),
            tool: number(chance),
            tool_offset: number(chance),
            setup: number(chance),
        };
        let node_step = Offset::from_nm(spacing_nm);
        let image = ImageSettings { binding, closed, feed, limits, window, node_step };
        let mut settings = device_settings(chance, tick_hz, feed_nm, &limits);
        if chance.one_in(4) {
            // About the part, so near that a correction meets them; the frames of such a session do not move it far.
            settings.rewriter.joint_limits_nm = joints(chance, &points, high_nm, clamp_nm);
        }
        settings.check().expect("settings in their ranges");
        Self::of(settings, image, nodes, feed_nm)
    }

    /// One that is not drawn; `feed_nm` is the way per tick at the nominal feed.
    ///
    /// # Panics
    /// It is no image.
    pub fn of(settings: DeviceSettings, image: ImageSettings, nodes: Vec<ImageNode>, feed_nm: i64) -> Self {
        let made = |image: &ImageSettings| {
            let mut bytes = vec![0; image_bytes(nodes.len())];
            build(image, nodes.iter().copied(), &mut bytes).expect("an image within its ranges");
            bytes
        };
        let mut other = image;
        other.binding.program_crc ^= 1;
        let bytes = [made(&image), made(&other)];
        Self { settings, image, nodes, bytes, feed_nm }
    }

    /// The same with other settings of the image: what a servo has that does not keep to its own.
    #[must_use]
    pub fn with_image(&self, change: impl FnOnce(&mut ImageSettings)) -> Self {
        let mut image = self.image;
        change(&mut image);
        Self::of(self.settings, image, self.nodes.clone(), self.feed_nm)
    }
    /// The same with other settings of the device.
    #[must_use]
    pub fn with_settings(&self, change: impl FnOnce(&mut DeviceSettings)) -> Self {
        let mut other = self.clone();
        change(&mut other.settings);
        other
    }
    /// Settings of the device.
    pub const fn settings(&self) -> &DeviceSettings {
        &self.settings
    }
    /// Whether a joint limit is near the part.
    pub fn has_joint_limits(&self) -> bool {
        self.settings.rewriter.joint_limits_nm[0].0 > i64::MIN
    }
    /// The image, and the same for another program.
    ///
    /// # Panics
    /// Never: both were checked when they were made.
    pub fn images(&self) -> [Image<'_>; 2] {
        self.bytes.each_ref().map(|bytes| Image::new_checked(bytes).expect("an image that was checked"))
    }
    /// Their bytes.
    pub const fn bytes(&self) -> &[Vec<u8>; 2] {
        &self.bytes
    }
    /// Way per tick at the nominal feed, nm.
    pub const fn feed_nm(&self) -> i64 {
        self.feed_nm
    }
}

/// The law under which a way per tick is the nominal feed.
fn feed_law(chance: &mut Chance, feed_nm: i64, tick_hz: u32) -> FeedLaw {
    let teeth = 1 + chance.below(8) as u32;
    let spindle_millirpm = (500 + chance.below(30_000) as u32) * 1_000;
    let per_minute = feed_nm * i64::from(tick_hz) * 60;
    let per_tooth = (per_minute * 1_000 / (i64::from(teeth) * i64::from(spindle_millirpm))).clamp(1, 7_000_000);
    let per_tooth = FineOffset::checked_from_offset(Offset::from_nm(per_tooth)).unwrap_or(FineOffset::ZERO);
    let exponent = Real::ratio(chance.below(60) as i64, 100);
    let low = Real::ratio(chance.below(100) as i64, 100);
    FeedLaw::new(per_tooth, teeth, spindle_millirpm, exponent, low, Real::ratio(100 + chance.below(101) as i64, 100))
}

/// Points one spacing apart that turn by less than a right angle and a bit in all, so that the path never comes near itself.
fn open_path(chance: &mut Chance, spacing_nm: i64) -> Vec<[f64; 2]> {
    let count = 12 + chance.below(110);
    let mut heading = chance.below(360) as f64 / 57.3;
    let mut at = [chance.around(100_000_000) as f64, chance.around(100_000_000) as f64];
    // A corner at once, or a bend over all of it, or neither.
    let (corner, bend) = match chance.below(3) {
        0 => (chance.around(100) as f64 / 57.3, 0.0),
        1 => (0.0, chance.around(100) as f64 / 57.3 / count as f64),
        _ => (0.0, 0.0),
    };
    let corner_at = chance.below(count);
    let mut points = vec![at];
    for k in 0..count {
        heading += bend + if k == corner_at { corner } else { 0.0 };
        at = [at[0] + heading.cos() * spacing_nm as f64, at[1] + heading.sin() * spacing_nm as f64];
        points.push(at);
    }
    points
}

/// A round that ends where it starts.
fn circle(chance: &mut Chance, spacing_nm: i64) -> Vec<[f64; 2]> {
    let count = 30 + chance.below(80);
    let step = std::f64::consts::TAU / count as f64;
    let radius = spacing_nm as f64 * 0.98 / step;
    let middle = [chance.around(100_000_000) as f64, chance.around(100_000_000) as f64];
    let place = |k: u64| {
        let angle = (k % count) as f64 * step;
        [middle[0] + radius * angle.cos(), middle[1] + radius * angle.sin()]
    };
    (0..=count).map(place).collect()
}

/// Corrections along a path: level, rising, or jumping from node to node; chip and edge part.
fn nodes(chance: &mut Chance, points: &[[f64; 2]]) -> Vec<ImageNode> {
    let most = [2_000, 50_000, 200_000, 400_000, 1_500_000][chance.below(5) as usize];
    let fine = |nm: f64| FineOffset::checked_from_offset(Offset::from_nm(nm as i64)).unwrap_or(FineOffset::ZERO);
    let one_axis = chance.one_in(3);
    let wave = |chance: &mut Chance| {
        let height = chance.around(most) as f64 / 2.0;
        let length = 4.0 + chance.below(80) as f64;
        (height, length, chance.below(3))
    };
    let waves = [(); 4].map(|()| wave(chance));
    let value = |part: usize, k: usize| {
        let (height, length, kind) = waves[part];
        let phase = k as f64 / length;
        match kind {
            0 => height,
            1 => height * (phase * std::f64::consts::TAU).sin(),
            _ if phase.fract() < 0.5 => height,
            _ => -height,
        }
    };
    let node = |(k, point): (usize, &[f64; 2])| {
        let second = |nm: f64| if one_axis { FineOffset::ZERO } else { fine(nm) };
        ImageNode {
            point: Point::from_nm(point[0].round() as i64, point[1].round() as i64),
            chip: [fine(value(0, k)), second(value(1, k))],
            edge: [fine(value(2, k)), second(value(3, k))],
        }
    };
    points.iter().enumerate().map(node).collect()
}

fn device_settings(chance: &mut Chance, tick_hz: u32, feed_nm: i64, limits: &CorrectionLimits) -> DeviceSettings {
    let tick_us = 1_000_000u32.div_ceil(tick_hz);
    let max_lost_frames = [0, 1, 2, 2, 2, 3, 5, 16][chance.below(8) as usize];
    let deadline_us = (tick_us / [1, 2, 4][chance.below(3) as usize]).max(10);
    let least = (max_lost_frames + 3) * tick_us + deadline_us;
    let rewriter = Settings {
        tick_hz,
        max_step: Offset::from_nm((feed_nm * (2 + chance.below(20) as i64)).clamp(1, 8_000_000)),
        max_lost_frames,
        hold_after_ticks: 2 + chance.below(30) as u32,
        spindle_stale_ticks: 1 + chance.below(200) as u32,
        fade_ticks: 1 + chance.below(150) as u32,
        feed_smoothing: chance.below(13) as u32,
        require_spindle_load: chance.one_in(4),
        joint_limits_nm: [(i64::MIN, i64::MAX); AXES],
        correction_slew_nm_per_s: if chance.one_in(4) {
            (limits.slew_nm_per_s / 2).max(tick_hz)
        } else {
            NO_VELOCITY_CAP
        },
        correction_acceleration_nm_per_s2: if chance.one_in(4) {
            (limits.acceleration_nm_per_s2 / 2).max(u64::from(tick_hz).pow(2))
        } else {
            NO_ACCELERATION_CAP
        },
    };
    let axes = 3 + chance.below(4) as u8;
    DeviceSettings { rewriter, axes, deadline_us, silence_us: least + chance.below(20) as u32 * tick_us }
}

/// Joint limits for parts that lie where their program says: those of X and Y so near that some setpoints with their
/// correction are beyond them.
fn joints(chance: &mut Chance, points: &[[f64; 2]], high_nm: i64, clamp_nm: i64) -> [(i64, i64); AXES] {
    let mut limits = [(i64::MIN + 1, i64::MAX); AXES];
    for (k, limit) in limits.iter_mut().take(2).enumerate() {
        let of = |pick: fn(f64, f64) -> f64, start| points.iter().map(|p| p[k]).fold(start, pick) as i64;
        let margin = |chance: &mut Chance| clamp_nm * (chance.below(5) as i64) / 4;
        *limit = (of(f64::min, f64::MAX) - margin(chance), of(f64::max, f64::MIN) + margin(chance));
    }
    limits[2] = (high_nm - 100_000_000, high_nm + 100_000_000);
    limits
}
