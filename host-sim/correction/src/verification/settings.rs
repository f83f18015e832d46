//! What the user may choose about a verification program, checked before anything is planned.

use std::ops::RangeInclusive;

use truepath_ground::diagnostics::InputError;
use truepath_ground::length;

use crate::codes::V001;

/// Choices; lengths in millimetres, feeds in mm/min whatever the unit of the program.
#[derive(Clone, Debug, PartialEq, clap::Args)]
pub struct Settings {
    /// Places along the contour; how many are usual depends on what is known.
    #[arg(skip = Settings::default().places)]
    pub places: u32,
    /// Whether further places are that many even where more are not worth touching.
    #[arg(skip = false)]
    pub exactly: bool,
    /// Heights at each place [default: 3; up to 5 where the profile of the wall is asked for or it is taller than one axial
    /// contact ratio].
    #[arg(long, value_name = "N")]
    pub heights: Option<u32>,
    /// Half the width of the tolerance of the wall at every height, mm, or with its unit (0.0005in, 12um), which asks
    /// for its profile; without it that of `[part]`.
    #[arg(long, value_name = "LENGTH", value_parser = length::flag)]
    pub tolerance: Option<f64>,
    /// From the ball's surface to the nominal wall where a touch begins, mm, or with its unit (0.1in).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, default_value_t = Settings::default().clearance)]
    pub clearance: f64,
    /// How far beyond the nominal wall a touch is searched, mm, or with its unit (0.1in).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, default_value_t = Settings::default().overtravel)]
    pub overtravel: f64,
    /// From the ball's lowest point to the floor, mm, or with its unit (0.1in).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, default_value_t = Settings::default().floor_clearance)]
    pub floor_clearance: f64,
    /// Width that is free before the wall, mm, or with its unit (0.1in) [default: the cutter's diameter, which the
    /// pass has cleared].
    #[arg(long, value_name = "LENGTH", value_parser = length::flag)]
    pub free_width: Option<f64>,
    /// Z for moves between places, mm, or with its unit (0.1in) [default: 50 mm above the engaged depth, and no lower
    /// than the part's program moves].
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, allow_negative_numbers = true)]
    pub safe_z: Option<f64>,
    /// Feed of moves that should touch nothing, mm/min.
    #[arg(long, value_name = "MM/MIN", default_value_t = Settings::default().feed_move)]
    pub feed_move: f64,
    /// Feed of the first touch, mm/min.
    #[arg(long, value_name = "MM/MIN", default_value_t = Settings::default().feed_fast)]
    pub feed_fast: f64,
    /// Feed of the second touch, which counts, mm/min.
    #[arg(long, value_name = "MM/MIN", default_value_t = Settings::default().feed_slow)]
    pub feed_slow: f64,
    /// Call the probe as this tool (T, M6, G43 H) instead of stopping for the operator.
    #[arg(long, value_name = "N")]
    pub probe_tool: Option<u32>,
}

/// Heights, where the user does not say how many.
pub(super) const USUAL_HEIGHTS: u32 = 3;

/// What a wall may be off without the ball meeting it before the last approach, mm.
pub(super) const MARGIN: f64 = 1.0;

impl Default for Settings {
    fn default() -> Self {
        Self {
            places: 8,
            exactly: false,
            heights: None,
            tolerance: None,
            clearance: 2.0,
            overtravel: 1.0,
            floor_clearance: 0.5,
            free_width: None,
            safe_z: None,
            feed_move: 1000.0,
            feed_fast: 300.0,
            feed_slow: 50.0,
            probe_tool: None,
        }
    }
}

impl Settings {
    /// Holds every value against its range.
    ///
    /// # Errors
    /// `V001` at the first that is outside.
    pub fn check(&self) -> Result<(), InputError> {
        within("--points", f64::from(self.places), 1.0..=64.0, "")?;
        within("--heights", f64::from(self.heights.unwrap_or(USUAL_HEIGHTS)), 1.0..=9.0, "")?;
        within("--tolerance", self.tolerance.unwrap_or(1.0), 0.0001..=10.0, " mm")?;
        within("--clearance", self.clearance, MARGIN..=50.0, " mm")?;
        within("--overtravel", self.overtravel, 0.1..=5.0, " mm")?;
        within("--floor-clearance", self.floor_clearance, 0.0..=50.0, " mm")?;
        within("--free-width", self.free_width.unwrap_or(1.0), 0.1..=10_000.0, " mm")?;
        within("--safe-z", self.safe_z.unwrap_or(0.0), -4_000.0..=4_000.0, " mm")?;
        within("--feed-move", self.feed_move, 1.0..=10_000.0, " mm/min")?;
        within("--feed-fast", self.feed_fast, 1.0..=2_000.0, " mm/min")?;
        within("--feed-slow", self.feed_slow, 1.0..=500.0, " mm/min")?;
        within("--probe-tool", f64::from(self.probe_tool.unwrap_or(1)), 1.0..=99_999.0, "")?;
        if self.feed_slow > self.feed_fast {
            return Err(InputError::new(
                V001,
                format!("--feed-slow {} is faster than --feed-fast {}", self.feed_slow, self.feed_fast),
                "a second touch no faster than the first",
                "exchange the two, or give both",
            ));
        }
        Ok(())
    }
}

fn within(option: &str, value: f64, range: RangeInclusive<f64>, unit: &str) -> Result<(), InputError> {
    if range.contains(&value) {
        return Ok(());
    }
    let expected = match unit {
        " mm" => length::between(*range.start(), *range.end()),
        _ => format!("{} to {}{unit}", range.start(), range.end()),
    };
    Err(InputError::new(
        V001,
        format!("{option} is {value}{unit}"),
        expected,
        format!("give {option} a value in this range"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_in_range_and_what_is_not_is_named() {
        Settings::default().check().unwrap();
        let refused = |settings: Settings| settings.check().unwrap_err().to_string();
        assert_eq!(refused(Settings { places: 0, ..Settings::default() }), "--points is 0; expected 1 to 64");
        assert_eq!(
            refused(Settings { overtravel: f64::NAN, ..Settings::default() }),
            "--overtravel is NaN mm; expected 0.1 to 5 mm (0.00394 to 0.196 in)"
        );
        assert!(refused(Settings { feed_slow: 400.0, ..Settings::default() }).starts_with("--feed-slow 400 is faster"));
    }
}
