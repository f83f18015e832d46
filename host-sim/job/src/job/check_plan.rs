//! The `[plan]` table: what a finishing process has to keep that `truepath plan` looks for, and the cutters it may use.

use truepath_core::cut::ToolMaterial;
use truepath_core::job::{Stickout, Tool};
use truepath_core::units::{Offset, Real};
use truepath_ground::codes::J008;
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

/// Another cutter that a process may be run with, one `[[plan.cutter]]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanCutter {
    /// Its number at the machine, 1…99,999.
    pub number: u32,
    /// Its diameter.
    pub diameter: Offset,
    /// Its teeth, 1…12.
    pub teeth: u8,
    /// Its helix angle, degrees, 0…60.
    pub helix_deg: Real,
    /// What is known of how stiff it is.
    pub stiffness: CutterStiffness,
}

/// How stiff the machine is with another cutter in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutterStiffness {
    /// As a multiple of what it is with that of the job, 0.1…10.
    Factor(f64),
    /// By the stick-outs of both as cantilevers; that of the job is known.
    Stickout(Stickout),
}

/// The most cutters of a job beside its own.
const MOST_CUTTERS: usize = 6;

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

/// What the table says, and the cutters in it; `tool` is that of the job.
pub(super) fn plan(section: Option<&Section<'_>>, tool: &Tool) -> Result<(PlanTable, Vec<PlanCutter>), InputError> {
    let usual = PlanTable::default();
    let Some(section) = section else { return Ok((usual, Vec::new())) };
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
    let mut cutters: Vec<PlanCutter> = Vec::new();
    for own in section.sections_named("cutter", "plan.cutter")? {
        let cutter = cutter(&own, tool)?;
        let number = own.value("number").filter(|_| {
            cutters.len() == MOST_CUTTERS
                || tool.number == Some(cutter.number)
                || cutters.iter().any(|other| other.number == cutter.number)
        });
        if let Some(number) = number {
            let expected =
                format!("up to {MOST_CUTTERS} cutters beside that of the job, each with a number of its own");
            return Err(own.out_of_range(&number, &expected, "remove this table, or correct its number"));
        }
        own.close()?;
        cutters.push(cutter);
    }
    section.close()?;
    Ok((table, cutters))
}

fn cutter(section: &Section<'_>, tool: &Tool) -> Result<PlanCutter, InputError> {
    const NUMBER: &str = "take the number from the tool table of the control";
    let Some(number) = section.whole("number", Limits::within("1", "99999", ""), NUMBER)? else {
        return Err(section.missing("number", "the number of the tool"));
    };
    let diameter = section.number("diameter_mm", Limits::within("0.1", "100", "mm"))?;
    let teeth = section.whole("teeth", Limits::within("1", "12", ""), "count the cutter's teeth")?;
    let helix = section.required_number("helix_deg", Limits::within("0", "60", "degrees"))?;
    let factor = section.number("stiffness_factor", Limits::within("0.1", "10", ""))?.map(Decimal::as_f64);
    let length = section.number("stickout_mm", Limits::above("0", "500", "mm"))?.map(Decimal::as_mm);
    let materials = [("HSS", ToolMaterial::HighSpeedSteel), ("carbide", ToolMaterial::Carbide)];
    let material = section.choice("material", &materials)?;
    let stiffness = match (factor, length, tool.cantilever) {
        (factor, None, _) => CutterStiffness::Factor(factor.unwrap_or(1.0)),
        (None, Some(length), Some(own)) => {
            CutterStiffness::Stickout(Stickout { length, material: material.unwrap_or(own.material) })
        }
        (_, Some(_), own) => {
            let (found, expected, help) = if own.is_none() {
                let found = "the stick-out of this cutter is given, and that of the job's cutter is not";
                (
                    found,
                    "both, or stiffness_factor",
                    "add stickout_mm and material to [tool], or write stiffness_factor",
                )
            } else {
                let found = "stiffness_factor and stickout_mm are both given";
                (found, "one of them", "remove one of the two")
            };
            let place = section.value("stickout_mm");
            return Err(match place {
                Some(value) => section.contradiction(&value, found, expected, help),
                None => InputError::new(J008, found, expected, help),
            });
        }
    };
    Ok(PlanCutter {
        number,
        diameter: diameter.map_or(tool.diameter, Decimal::as_mm),
        teeth: teeth.unwrap_or(tool.teeth),
        helix_deg: helix.as_real(),
        stiffness,
    })
}
