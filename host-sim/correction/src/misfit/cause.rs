//! What may be wrong with points or job, each as a change of what the fit is given.

use truepath_core::cut::Milling;
use truepath_core::identify::{Parameter, Prior};
use truepath_core::job::{self, ZReference};
use truepath_core::probe::{Reading, Setting};
use truepath_core::units::{Position, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{mm, nm};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::look::NEAR_MM;

/// A cause, with what it would have to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// Nothing is wrong.
    Nothing,
    /// The readings are shifted by so much in x and y, mm.
    Datum([f64; 2]),
    /// All points are off by the same, mm: positive, material seems left.
    Level(f64),
    /// The sign of the deviations is reversed.
    Sign,
    /// The spindle turns the other way: climb is conventional.
    Spindle,
    /// Another allowance, mm.
    Allowance(f64),
    /// Another number of teeth.
    Teeth(u8),
    /// Another helix, degrees.
    Helix(u8),
    /// The ball was so much higher than the file says, mm.
    Height(f64),
    /// The sign of X is turned.
    MirroredX,
    /// The sign of Y is turned.
    MirroredY,
    /// X and Y are exchanged.
    Swapped,
    /// One or two touches are of something else: their lines in the file, 0 for none.
    Stray([u32; 2]),
}

/// A fit's input under a cause.
#[derive(Clone, Debug)]
pub(super) struct Altered {
    pub(super) pass: Pass,
    pub(super) readings: Vec<Reading>,
    pub(super) setting: Setting,
    pub(super) turned: bool,
    pub(super) free: Free,
}

/// What a fit lets go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Free {
    Nothing,
    Datum,
    Level,
}

/// One standard deviation of what is let go.
const FREE: Real = Real::HALF;

impl Free {
    /// The prior with it let go.
    pub(super) fn of(self, mut prior: Prior) -> Prior {
        for (sigma, parameter) in prior.sigma.iter_mut().zip(Parameter::ALL) {
            let free = match parameter {
                Parameter::DatumX | Parameter::DatumY => self == Self::Datum,
                Parameter::Undersize => self == Self::Level,
                _ => false,
            };
            if free {
                *sigma = FREE;
            }
        }
        prior
    }
}

impl Cause {
    /// What the fit is given under it.
    pub(super) fn altered(self, pass: &Pass, measurement: &Measurement) -> Result<Altered, Failure> {
        let setting = job::setting(&pass.core).map_err(|error| pass.refused(&error))?;
        // Under every assumption the same readings are looked at: those that would be off the wall as well.
        let setting = Setting { reach: nm(NEAR_MM), ..setting };
        let mut to = Altered {
            pass: pass.clone(),
            readings: measurement.readings.clone(),
            setting,
            turned: false,
            free: Free::Nothing,
        };
        let setup = &mut to.pass.core.setup;
        match self {
            Self::Nothing => {}
            Self::Datum([x, y]) => {
                to.free = Free::Datum;
                to.move_readings(|[a, b, z]| [a - nm(x), b - nm(y), z]);
            }
            Self::Level(_) => to.free = Free::Level,
            Self::Sign => to.turned = true,
            Self::Spindle => {
                setup.milling = match setup.milling {
                    Milling::Climb => Milling::Conventional,
                    Milling::Conventional => Milling::Climb,
                };
            }
            Self::Allowance(mm) => {
                setup.allowance = nm(mm);
                to.pass.surface = None;
            }
            Self::Teeth(teeth) => setup.teeth = teeth,
            Self::Helix(deg) => setup.helix_deg = Real::from_int(deg.into()),
            Self::Height(mm) => to.move_readings(|[x, y, z]| [x, y, z + nm(mm)]),
            Self::MirroredX => to.move_readings(|[x, y, z]| [turned(x), y, z]),
            Self::MirroredY => to.move_readings(|[x, y, z]| [x, turned(y), z]),
            Self::Stray(lines) => to.readings.retain(|r| !lines.contains(&r.line)),
            Self::Swapped => to.move_readings(|[x, y, z]| [y, x, z]),
        }
        Ok(to)
    }

    /// How many numbers it may choose.
    pub(super) const fn freedom(self) -> f64 {
        match self {
            Self::Nothing | Self::Stray(_) => 0.0,
            Self::Datum(_) => 2.0,
            _ => 1.0,
        }
    }

    /// Those that are tried beside a free datum and a free level.
    pub fn others(pass: &Pass, heights: bool) -> Vec<Self> {
        let setup = &pass.core.setup;
        let mut all = vec![Self::Sign, Self::Spindle, Self::MirroredX, Self::MirroredY, Self::Swapped];
        let allowance = mm(setup.allowance);
        let room = 1.9 * mm(setup.radius);
        let times = [1.0 / 25.4, 0.1, 0.2, 1.0 / 3.0, 0.5, 0.7, 1.4, 2.0, 3.0, 5.0, 10.0, 25.4];
        all.extend(times.iter().map(|t| t * allowance).filter(|a| (0.005..room).contains(a)).map(Self::Allowance));
        all.extend((1..=8).filter(|teeth| *teeth != setup.teeth).map(Self::Teeth));
        if heights {
            let stated = truepath_ground::units::float(setup.helix_deg);
            let helices = [0, 10, 20, 30, 38, 45, 55].into_iter();
            all.extend(helices.filter(|deg| (f64::from(*deg) - stated).abs() > 4.0).map(Self::Helix));
            let depth = truepath_ground::units::float(setup.axial_depth);
            let ball = pass.job.numbers.probe.map_or(0.0, |p| mm(p.ball_diameter) / 2.0);
            let tip = pass.job.numbers.probe.is_some_and(|p| p.z_reference == ZReference::Tip);
            let other_end = if tip { -ball } else { ball };
            let shares = [-0.5, -0.25, -0.1, 0.1, 0.25, 0.5].map(|share| share * depth);
            all.extend(std::iter::once(other_end).chain(shares).map(Self::Height));
        }
        all
    }

    /// Values near that of a cause that was tried in steps.
    pub fn nearby(self) -> Vec<Self> {
        match self {
            Self::Allowance(mm) => [0.75, 0.85, 0.93, 1.08, 1.18, 1.33].map(|t| Self::Allowance(t * mm)).to_vec(),
            Self::Height(mm) => [0.6, 0.8, 1.25, 1.5].map(|t| Self::Height(t * mm)).to_vec(),
            Self::Helix(deg) => [-5i16, -2, 2, 5]
                .into_iter()
                .filter_map(|by| u8::try_from(i16::from(deg) + by).ok().filter(|d| *d <= 60))
                .map(Self::Helix)
                .collect(),
            _ => Vec::new(),
        }
    }
}

fn turned(p: Position) -> Position {
    Position::ZERO - (p - Position::ZERO)
}

impl Altered {
    fn move_readings(&mut self, change: impl Fn([Position; 3]) -> [Position; 3]) {
        for reading in &mut self.readings {
            reading.position = change(reading.position);
        }
    }
}
