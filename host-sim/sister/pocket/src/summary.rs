//! `summary.json` of `truepath pocket`.

use truepath_core::geometry::Side;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::mm;
use truepath_job::job::{Mode, PerSection, PocketTable};
use truepath_job::pass::{Pass, milling_name};
use truepath_program::Difference;

use super::design::Designed;
use super::machine::Machine;
use super::rows::SectionRow;
use super::section::Kind;
use super::sensitivity::Sensitivity;

/// The cutter as a beam, as it was taken.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct CutterSummary {
    /// Free length, mm.
    pub stickout_mm: f64,
    /// Length of the fluted part, mm.
    pub flute_length_mm: f64,
    /// Diameter of the shank, mm.
    pub shank_diameter_mm: f64,
    /// Equivalent diameter of the fluted part, mm.
    pub equivalent_diameter_mm: f64,
    /// Young's modulus, kN/mm².
    pub modulus_kn_per_mm2: f64,
    /// Deflection of the tip under a load spread over the engaged depth, µm/N.
    pub tip_um_per_n: f64,
    /// The same at the top of the engaged depth.
    pub top_um_per_n: f64,
    /// Machine and spindle along x and y, µm/N; 0 where the job states none.
    pub machine_um_per_n: [f64; 2],
}

/// What was done.
#[derive(Clone, Debug, serde::Serialize)]
pub struct PocketSummary {
    /// Version of this file.
    pub version: u32,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
    /// Wall or slot.
    pub mode: Mode,
    /// Climb or conventional, on the near wall.
    pub milling: &'static str,
    /// Side of travel of the near wall.
    pub near_wall: &'static str,
    /// Length of the path, mm.
    pub length_mm: f64,
    /// Half of the width of the band, mm.
    pub tolerance_mm: f64,
    /// Profile or constant.
    pub per_section: PerSection,
    /// The cutter.
    pub cutter: CutterSummary,
    /// The sections.
    pub sections: Vec<SectionRow>,
    /// Sections that are shifted.
    pub sections_shifted: usize,
    /// Largest error before, of sections that are judged (all but sharp corners), mm.
    pub max_error_before_mm: f64,
    /// Largest error after.
    pub max_error_after_mm: f64,
    /// Largest error after at sharp corners, which no shift follows, mm; 0 without any.
    pub max_error_sharp_mm: f64,
    /// Whether every section is within the band after, sharp corners included.
    pub in_band: bool,
    /// The same with other force coefficients.
    pub sensitivity: Vec<Sensitivity>,
    /// Predicted passes of the cutter that it took.
    pub passes: usize,
    /// CRC-32 of the original program.
    pub program_crc32: String,
    /// The corrected program against its original; null where nothing was shifted.
    pub program: Option<Difference>,
    /// What the user should know.
    pub warnings: Vec<Remark>,
}

/// What there is to tell.
#[derive(Clone, Debug)]
pub struct Told {
    /// Rows of the table.
    pub rows: Vec<SectionRow>,
    /// The compensated pocket.
    pub designed: Designed,
    /// The same with other coefficients.
    pub sensitivity: Vec<Sensitivity>,
}

/// Makes the summary.
pub fn pocket_summary(
    pass: &Pass,
    table: &PocketTable,
    machine: &Machine,
    made: &Told,
    program: Option<Difference>,
    mut warnings: Vec<Remark>,
) -> PocketSummary {
    let judged = || made.rows.iter().filter(|row| row.kind != Kind::Sharp);
    let largest = |value: fn(&SectionRow) -> [f64; 2]| {
        judged().flat_map(value).filter(|v| v.is_finite()).fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    for row in judged().filter(|row| !row.in_band_after) {
        let said = |unit: Unit| format!("{} is not within the band after: {}", row.section, unit.retold(&row.reason));
        warnings.push(pass.unit().remark(said));
    }
    let sharp = made.rows.iter().filter(|row| row.kind == Kind::Sharp);
    let left = |row: &SectionRow| row.error_after_mm.abs().max(row.far_error_after_mm.unwrap_or(0.0).abs());
    let max_error_sharp_mm = sharp.map(left).fold(0.0, f64::max);
    if max_error_sharp_mm > mm(table.tolerance) {
        warnings.push(pass.unit().remark(|unit| {
            let left = unit.of(max_error_sharp_mm);
            format!(
                "{left:.4} {} remain at corners without an arc: give the path an arc there, however small",
                unit.name()
            )
        }));
    }
    let tool = &machine.tool;
    PocketSummary {
        max_error_sharp_mm,
        version: 1,
        unit: pass.unit(),
        mode: table.mode,
        milling: milling_name(pass.core.setup.milling),
        near_wall: if pass.core.setup.wall == Side::Left { "left" } else { "right" },
        length_mm: mm(pass.path_contour().length()),
        tolerance_mm: mm(table.tolerance),
        per_section: table.per_section,
        cutter: CutterSummary {
            stickout_mm: tool.stickout_mm,
            flute_length_mm: tool.flute_length_mm,
            shank_diameter_mm: tool.shank_diameter_mm,
            equivalent_diameter_mm: tool.core_ratio * tool.diameter_mm,
            modulus_kn_per_mm2: tool.modulus_kn_per_mm2,
            tip_um_per_n: 1000.0 * machine.bend_at(0.0),
            top_um_per_n: 1000.0 * machine.bend_at(1.0),
            machine_um_per_n: machine.held_mm_per_n.map(|held| 1000.0 * held),
        },
        sections_shifted: made.designed.shifted.iter().filter(|s| **s).count(),
        max_error_before_mm: largest(|row| [row.error_before_mm, row.far_error_before_mm.unwrap_or(0.0)]),
        max_error_after_mm: largest(|row| [row.error_after_mm, row.far_error_after_mm.unwrap_or(0.0)]),
        in_band: made.rows.iter().all(|row| row.in_band_after),
        sections: made.rows.clone(),
        sensitivity: made.sensitivity.clone(),
        passes: made.designed.passes,
        program_crc32: format!("{:08X}", pass.core.program_crc),
        program,
        warnings,
    }
}
