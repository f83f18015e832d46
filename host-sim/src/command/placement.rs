//! Where the program stands in the machine, on the command line.

use clap::Args;
use truepath_core::units::Real;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_trial::codes::R003;
use truepath_trial::replay::Placement;
use truepath_trial::setpoints::{Frame, Setpoints};

/// The frame of the program, as it was sent with the arming.
#[derive(Clone, Debug, Default, Args)]
pub struct PlacementOptions {
    /// Machine coordinates of the program's origin, needed for `# frame = machine`.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = lengths)]
    pub origin_mm: Option<[i64; 3]>,
    /// Turn of the program in the machine's XY plane, counter-clockwise.
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, value_parser = angle)]
    pub rotation_deg: Option<Real>,
    /// Cosine of that turn in units of 2⁻³⁰, as it was sent with the arming.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, requires = "sine", conflicts_with = "rotation_deg")]
    pub cosine: Option<i32>,
    /// Sine of that turn.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, requires = "cosine")]
    pub sine: Option<i32>,
}

impl PlacementOptions {
    /// For a file of setpoints: machine coordinates mean nothing without an origin, program coordinates nothing with one.
    ///
    /// # Errors
    /// `R003` when frame and options do not go together.
    pub fn of(&self, setpoints: &Setpoints, source: &Source) -> Result<Placement, InputError> {
        let given = self.origin_mm.is_some() || self.rotation_deg.is_some() || self.cosine.is_some();
        let (found, expected, help) = match (setpoints.frame, self.origin_mm) {
            (Frame::Program, _) if !given => return Ok(Placement::default()),
            (Frame::Machine, Some(origin_nm)) => {
                return Ok(match (self.cosine, self.sine) {
                    (Some(cosine), Some(sine)) => Placement { origin_nm, cosine, sine },
                    _ => Placement::turned(origin_nm, self.rotation_deg.unwrap_or_default()),
                });
            }
            (Frame::Program, _) => (
                "the setpoints are in program coordinates, but --origin-mm, --rotation-deg or --cosine is given",
                "one or the other",
                "leave the options out, or say # frame = machine in the file",
            ),
            (Frame::Machine, None) => (
                "the setpoints are in machine coordinates, but --origin-mm is not given",
                "the place of the program's origin",
                "add --origin-mm X,Y,Z: the work offset with the tool's length",
            ),
        };
        Err(InputError::new(R003, found, expected, help).at(source, 0..1))
    }
}

fn lengths(text: &str) -> Result<[i64; 3], String> {
    let lengths: Option<Vec<i64>> = text.split(',').map(|t| Some(Decimal::parse(t.trim())?.as_mm().nm())).collect();
    lengths
        .and_then(|l| <[i64; 3]>::try_from(l).ok())
        .ok_or_else(|| "three lengths in mm, like 120.5,-80,-310".to_owned())
}

fn angle(text: &str) -> Result<Real, String> {
    let angle = Decimal::parse(text.trim()).map(Decimal::as_real).filter(|a| a.abs() <= Real::from_int(360));
    angle.ok_or_else(|| "an angle from -360 to 360 degrees".to_owned())
}
