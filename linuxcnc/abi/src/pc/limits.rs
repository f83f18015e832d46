//! The machine's limits, from the parameters of the component, as settings of a rewriter.

use truepath_core::errors::number;
use truepath_core::image::{ImageError, SignatureError};
use truepath_core::rewrite::{AXES, NO_ACCELERATION_CAP, Settings, SettingsError};

use super::pins::JOINTS;
use crate::convert::{ceil_nm, floor_nm};

/// Limits of the joints in machine units; laid out as in `truepath.h`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Least position.
    pub least: [f64; JOINTS],
    /// Greatest position.
    pub greatest: [f64; JOINTS],
    /// Velocity left to the correction, per second.
    pub velocity: [f64; JOINTS],
    /// Acceleration left to the correction, per second squared.
    pub acceleration: [f64; JOINTS],
    /// Nanometres of a machine unit.
    pub nm_per_unit: f64,
}

/// Axis of each joint: 0…5 for X, Y, Z, A, B, C, anything else for none. X and Y may have two joints, as of a gantry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Joints(pub [u8; JOINTS]);

/// Why an image is not used. Numbers stay the same from version to version; those below 32 are the digits of [`ImageError::code`]
/// and [`SignatureError::code`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfferError {
    /// The bytes are no image.
    Image(ImageError),
    /// A limit of the joint is missing, or not a length.
    Limits {
        /// The joint.
        joint: usize,
    },
    /// Limits or period do not go with a rewriter or the image.
    Settings(SettingsError),
    /// The image before is not yet taken.
    Busy,
    /// There are keys, and it is not signed with one of them for LinuxCNC, or is older than one that was in use.
    Untrusted(SignatureError),
    /// The ledger does not remember its counter: it could not be written.
    NotRemembered,
}

impl OfferError {
    /// Its number.
    pub const fn code(self) -> u32 {
        match self {
            Self::Image(error) => number(error.code()) as u32,
            Self::Limits { joint } => (joint as u32).saturating_add(32),
            Self::Settings(_) => 40,
            Self::Busy => 41,
            Self::Untrusted(error) => number(error.code()) as u32,
            Self::NotRemembered => 42,
        }
    }
}

impl Joints {
    /// The axis of a joint.
    pub(crate) fn axis(&self, joint: usize) -> Option<usize> {
        self.0.get(joint).map(|&axis| usize::from(axis)).filter(|&axis| axis < AXES)
    }
}

impl Limits {
    /// Settings for a period. All joints of an axis count; of speed and acceleration, those of X and Y, which alone are
    /// corrected.
    ///
    /// # Errors
    /// [`OfferError::Limits`]: the least position is not below the greatest, or nothing is left to the correction.
    pub(crate) fn settings(&self, joints: &Joints, period_ns: u32) -> Result<Settings, OfferError> {
        let half = period_ns >> 1;
        let tick_hz = 1_000_000_000u32.saturating_add(half).checked_div(period_ns).unwrap_or(0);
        // A load input that is not connected says that the cutter cuts.
        let mut settings = Settings { require_spindle_load: true, ..Settings::at_rate(tick_hz) };
        for joint in 0..JOINTS {
            if let Some(axis) = joints.axis(joint) {
                self.narrow(&mut settings, joint, axis).ok_or(OfferError::Limits { joint })?;
            }
        }
        Ok(settings)
    }

    /// The settings with the limits of one joint.
    fn narrow(&self, settings: &mut Settings, joint: usize, axis: usize) -> Option<()> {
        let unit = self.nm_per_unit;
        let least = ceil_nm(*self.least.get(joint)?, unit)?;
        let greatest = floor_nm(*self.greatest.get(joint)?, unit)?;
        let (low, high) = settings.joint_limits_nm.get_mut(axis)?;
        (*low, *high) = ((*low).max(least), (*high).min(greatest));
        let corrected = axis < 2;
        let velocity = floor_nm(*self.velocity.get(joint)?, unit).filter(|&v| v > 0 || !corrected)?;
        let acceleration = floor_nm(*self.acceleration.get(joint)?, unit).filter(|&a| a > 0 || !corrected)?;
        if corrected {
            let velocity = u32::try_from(velocity).unwrap_or(u32::MAX);
            let acceleration = u64::try_from(acceleration).unwrap_or(NO_ACCELERATION_CAP);
            settings.correction_slew_nm_per_s = settings.correction_slew_nm_per_s.min(velocity);
            settings.correction_acceleration_nm_per_s2 = settings.correction_acceleration_nm_per_s2.min(acceleration);
        }
        (*low < *high).then_some(())
    }
}
