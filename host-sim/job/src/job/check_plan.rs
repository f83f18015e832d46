//! The `[plan]` table: what a finishing process has to keep that `truepath plan` looks for.

use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::InputError;
use truepath_ground::document::Section;
use truepath_ground::limits::Limits;

/// What the table says. Every key is optional; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanTable {
    /// Longest machining time, as a multiple of that of the program's own pass, 1…20.
    pub max_time_ratio: f64,
    /// The most cuts along the wall, 1…3.
    pub max_cuts: usize,
    /// The most levels of a cut, 1…4.
    pub max_levels: usize,
    /// The least depth of a level, 0.1…100 mm.
    pub min_level_mm: f64,
    /// Whether cuts may run against the direction of the program.
    pub reverse: bool,
    /// Lowest and highest feed, percent of the programmed one, 10…100 and 100…400.
    pub percent: [u16; 2],
    /// The fastest feed, mm/min.
    pub max_feed_mm_per_min: Option<f64>,
    /// The largest mean force over a revolution, N.
    pub max_force_n: Option<f64>,
    /// The largest engagement angle, degrees.
    pub max_engagement_deg: Option<f64>,
    /// The thinnest chip that still cuts, mm.
    pub min_chip_mm: Option<f64>,
}

impl Default for PlanTable {
    fn default() -> Self {
        Self {
            max_time_ratio: 3.5,
            max_cuts: 3,
            max_levels: 4,
            min_level_mm: 1.0,
            reverse: true,
            percent: [30, 200],
            max_feed_mm_per_min: None,
            max_force_n: None,
            max_engagement_deg: None,
            min_chip_mm: None,
        }
    }
}

/// What the table says.
pub(super) fn plan(section: Option<&Section<'_>>) -> Result<PlanTable, InputError> {
    let usual = PlanTable::default();
    let Some(section) = section else { return Ok(usual) };
    let number = |key, limits| Ok::<_, InputError>(section.number(key, limits)?.map(Decimal::as_f64));
    let percents = "write whole percents of the programmed feed";
    let counts = "write a whole number";
    let table = PlanTable {
        max_time_ratio: number("max_time_ratio", Limits::within("1", "20", ""))?.unwrap_or(usual.max_time_ratio),
        max_cuts: section.whole("max_cuts", Limits::within("1", "3", ""), counts)?.unwrap_or(usual.max_cuts),
        max_levels: section.whole("max_levels", Limits::within("1", "4", ""), counts)?.unwrap_or(usual.max_levels),
        min_level_mm: number("min_level_mm", Limits::within("0.1", "100", "mm"))?.unwrap_or(usual.min_level_mm),
        reverse: section.choice("reverse", &[("yes", true), ("no", false)])?.unwrap_or(usual.reverse),
        percent: [
            section.whole("min_percent", Limits::within("10", "100", "%"), percents)?.unwrap_or(usual.percent[0]),
            section.whole("max_percent", Limits::within("100", "400", "%"), percents)?.unwrap_or(usual.percent[1]),
        ],
        max_feed_mm_per_min: number("max_feed_mm_per_min", Limits::within("0.1", "100000", "mm/min"))?,
        max_force_n: number("max_force_n", Limits::above("0", "100000", "N"))?,
        max_engagement_deg: number("max_engagement_deg", Limits::above("0", "180", "deg"))?,
        min_chip_mm: number("min_chip_mm", Limits::above("0", "1", "mm"))?,
    };
    section.close()?;
    Ok(table)
}
