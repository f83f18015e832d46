//! Setpoint in, corrected setpoint out, in the same tick: the only code in the servo cycle.
//!
//! [`Rewriter`] is configuration (settings, image and what follows from them), [`State`] is what changes;
//! [`Rewriter::tick`] takes one setpoint. Called once per interpolator cycle, by the servo task of the device
//! ([`Rewriter::tick_into`]) or by the replay on a PC, with the same bits as result. It holds no float, no division, no 128-bit product, no
//! formatting; its loops are bounded ([`ADVANCE_LIMIT`]).
//!
//! | state | what goes out | leaves it by |
//! |---|---|---|
//! | `Off` | nothing | [`Rewriter::acknowledge_drives_disabled`] → `Bypass` |
//! | `Bypass` | the setpoint | [`Rewriter::arm`] → `Armed` |
//! | `Armed` | the setpoint | gate → `Active`; [`Rewriter::disarm`], stop, tool or frame change → `Bypass` |
//! | `Active` | corrected | end, disarm, M30: ramps out → `Bypass`; feed hold → `Hold`; anything unexpected → `Fault` |
//! | `Hold` | corrected, held | motion → `Active`; as `Active` |
//! | `Fault` | correction ramps to zero | at zero, within [`Limits::ramp_ticks`] → `Bypass` |
//!
//! Arming is one-shot: after any end the next part needs a new arming with another serial number (serials count up, [`SpentList`]), so a repeated
//! program, a spring pass or a restart in the middle runs uncorrected.
//!
//! The correction is looked up in program coordinates, turned to the machine axes, and limited there, axis by axis.
//!
//! ```
//! # use truepath_units::geometry::Point;
//! # use truepath_units::{Offset, Position, Real};
//! # use truepath_wire::image::{
//! #     Binding, CorrectionLimits, FeedLaw, FineOffset, Image, ImageNode, ImageSettings, PathWindow, build, image_bytes,
//! # };
//! #
//! # let fine = |um| FineOffset::checked_from_offset(Offset::from_um(um)).unwrap();
//! # let settings = ImageSettings {
//! #     binding: Binding { program_crc: 0x1234_5678, feature: 1, pass: 1, tool: 3, tool_offset: 3, setup: 1 },
//! #     closed: false,
//! #     // 44 µm a tooth, six teeth, 1500 rpm; the feed may lie between a quarter and one and a half times that.
//! #     feed: FeedLaw::new(fine(44), 6, 1_500_000, Real::ZERO, Real::ratio(1, 4), Real::ratio(3, 2)),
//! #     limits: CorrectionLimits {
//! #         clamp: Offset::from_um(500),
//! #         warn: Offset::from_um(200),
//! #         slew_nm_per_s: 20_000_000,
//! #         acceleration_nm_per_s2: 1_000_000_000,
//! #     },
//! #     window: PathWindow {
//! #         tolerance: Offset::from_um(200),
//! #         z_low: Position::from_nm(-10_000_000),
//! #         z_high: Position::from_nm(-10_000_000),
//! #         gate_height: Offset::from_um(5_000),
//! #     },
//! #     node_step: Offset::from_um(100),
//! # };
//! # // Along X, 0.1 mm apart; everywhere 50 µm in Y.
//! # let nodes: Vec<ImageNode> = (0..=100)
//! #     .map(|i| ImageNode { point: Point::from_nm(i * 100_000, 0), chip: [fine(0), fine(50)], edge: [fine(0), fine(0)] })
//! #     .collect();
//! # let mut bytes = vec![0; image_bytes(nodes.len())];
//! use truepath_wire::rewrite::{ArmRequest, Flags, Frame, Mode, Rewriter, Setpoint, Settings, State};
//!
//! // `nodes` follow 10 mm of X at Z −10 mm and want 50 µm in Y.
//! let image = build(&settings, &nodes, &mut bytes).unwrap();
//! let rewriter = Rewriter::new(Settings::at_1_khz(), Some(image)).unwrap();
//! let mut state = State::default();
//! rewriter.acknowledge_drives_disabled(&mut state).unwrap();
//! let frame = Frame::identity();
//! rewriter.arm(&mut state, &ArmRequest { binding: settings.binding, part_serial: 1, frame }).unwrap();
//!
//! let mut setpoint = Setpoint {
//!     spindle_millirpm: 1_500_000,
//!     frame_crc: frame.crc,
//!     flags: Flags::DRIVES_ENABLED,
//!     ..Setpoint::default()
//! };
//! let mut send = |x, z| {
//!     setpoint.sequence += 1;
//!     setpoint.axes = [x, 0, z, 0, 0, 0];
//!     rewriter.tick(&mut state, &setpoint)
//! };
//! // Down through the gate over the start, then along X at 400 mm/min.
//! for i in 0..=100 {
//!     send(0, -7_000_000 - i * 30_000);
//! }
//! let mut last = send(0, -10_000_000);
//! for i in 1..1_000 {
//!     last = send(i * 6_667, -10_000_000);
//! }
//! assert_eq!(last.mode, Mode::Active);
//! assert!((last.correction_nm[1] - 50_000).abs() < 1_000, "{:?}", last.correction_nm);
//! ```

mod command;
mod digest;
mod feed;
mod follow;
mod frame;
mod limit;
mod locate;
mod mode;
mod reason;
mod refusal;
mod setpoint;
mod settings;
mod spent;
mod state;
mod tick;

pub use command::ArmRequest;
pub use digest::Digest;
pub use frame::{AXES, AxisMap, Frame, TURN_BITS, TURN_ONE};
pub use limit::{AxisState, Limits};
pub use locate::{ADVANCE_LIMIT, Place};
pub use mode::Mode;
pub use reason::{Reason, UnknownReason};
pub use refusal::{Identity, Refusal};
pub use setpoint::{Flags, Output, Setpoint, Status};
pub use settings::{NO_ACCELERATION_CAP, NO_VELOCITY_CAP, Setting, Settings, SettingsError};
pub use spent::{SPENT_CAPACITY, SPENT_FLOORS, Spent, SpentList};
pub use state::State;

use crate::image::Image;
use feed::FeedScale;
use state::Phase;

/// Settings and image, and what follows from them. Making one divides and takes roots; it belongs outside the servo
/// cycle, as does changing the image, which is safe at any time but ends an active correction.
#[derive(Clone, Debug)]
pub struct Rewriter<'a> {
    settings: Settings,
    /// Change of the fade factor per tick, 2⁻¹⁶.
    fade_step: i32,
    /// The joint limits of the settings, so far from the ends of the range that no correction can wrap over them.
    joints: [(i64, i64); AXES],
    plan: Option<Plan<'a>>,
}

/// More than any correction.
const FAR_JOINT: i64 = 1 << 32;

/// An image prepared for the tick.
#[derive(Clone, Debug)]
struct Plan<'a> {
    image: Image<'a>,
    limits: Limits,
    feed_scale: FeedScale,
    tolerance_nm: i32,
    tolerance_squared: u64,
    last_segment: u32,
    /// Upper end of the pass, program Z, nm: heights are counted from it.
    level: i64,
    /// Pass window with tolerance, and the top of the gate, from the level, nm.
    z_bottom: i32,
    z_top: i32,
    z_gate: i32,
    warn_nm: u32,
}

impl<'a> Rewriter<'a> {
    /// A rewriter for an image; without one it can only pass setpoints on.
    ///
    /// # Errors
    /// A setting is outside its range, or a limit of the image vanishes at this tick rate.
    pub fn new(settings: Settings, image: Option<Image<'a>>) -> Result<Self, SettingsError> {
        settings.check()?;
        let plan = image.map(|image| Plan::new(image, &settings)).transpose()?;
        let fade_step = 65_536u32.div_ceil(settings.fade_ticks.max(1)) as i32;
        let joints =
            settings.joint_limits_nm.map(|(low, high)| (low.max(i64::MIN + FAR_JOINT), high.min(i64::MAX - FAR_JOINT)));
        Ok(Self { settings, fade_step, joints, plan })
    }

    /// Its settings.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }
    /// Its image.
    pub fn image(&self) -> Option<&Image<'a>> {
        self.plan.as_ref().map(|p| &p.image)
    }
    /// Limits of the correction per tick.
    pub fn limits(&self) -> Option<&Limits> {
        self.plan.as_ref().map(|p| &p.limits)
    }
}

impl<'a> Plan<'a> {
    fn new(image: Image<'a>, machine: &Settings) -> Result<Self, SettingsError> {
        let settings = image.settings();
        let window = settings.window;
        // In range: an image's tolerance is at most 5 mm, its gate 1 m. A pass deeper than 2.1 m ends there.
        let tolerance_nm = window.tolerance.nm() as i32;
        let depth = (window.z_high - window.z_low + window.tolerance).nm().min(i32::MAX.into());
        Ok(Self {
            limits: Limits::new(&machine.capped(&settings.limits), machine.tick_hz)?,
            feed_scale: FeedScale::new(&settings.feed, machine.tick_hz),
            tolerance_nm,
            tolerance_squared: u64::from(tolerance_nm.unsigned_abs()).saturating_pow(2),
            last_segment: image.len().saturating_sub(2) as u32,
            level: window.z_high.nm(),
            z_bottom: (depth as i32).wrapping_neg(),
            z_top: tolerance_nm,
            z_gate: (window.gate_height.nm() as i32).max(tolerance_nm),
            warn_nm: settings.limits.warn.nm().unsigned_abs() as u32,
            image,
        })
    }
}
