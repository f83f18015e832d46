//! The measured part of `learn` as it was milled: what the correction it was cut with left along the whole contour.
//!
//! A probe touches a few places. Between them the model of all parts says how the part came out, with what the parts have
//! shown beside the model. Limits: where the part was set aside, the model knows nothing of it.

use truepath_core::correct::{Law, Node};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::pass::{Pass, PathBuffer};

use crate::correct::CorrectedPass;
use crate::correction::{Correction, DesignRequest, evaluate};
use crate::discrepancy::{Along, ByLoad};
use crate::learning::History;
use crate::rows::{CorrectionRow, correction_rows};
use crate::surface::expected::Surface;

/// The measured part, along the contour.
#[derive(Clone, Debug)]
pub struct AsMilled {
    /// The correction it was cut with, and the walls that leaves.
    pub correction: Correction,
    /// Its wall at every height.
    pub surface: Surface,
    /// `milled.csv`: the columns of `correction.csv`, of this part.
    pub rows: Vec<CorrectionRow>,
}

/// Its largest error.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct WholeContour {
    /// Magnitude, mm.
    pub max_mm: f64,
    /// Where it is, mm along the contour.
    pub s_mm: f64,
    /// Standard deviation there, mm.
    pub sigma_mm: f64,
}

impl AsMilled {
    /// Of the part that was cut with the correction of a history, by the machine that was learned from it.
    ///
    /// # Errors
    /// As [`Pass::sample`].
    pub fn of(pass: &Pass, history: &History, done: &CorrectedPass) -> Result<Self, Failure> {
        let mut buffer = PathBuffer::default();
        let path = pass.sample(&mut buffer)?.with_law(done.identified.law());
        let table = done.identified.table();
        let machine = done.identified.machine(&path, &table);
        // The part is there: what the next one will do otherwise does not count.
        let beside = done.beside.clone();
        let beside = Along { repeat: Vec::new(), by_load: ByLoad { level: 0.0, ..beside.by_load }, ..beside };
        let request = DesignRequest { law: Law::Model, beside: &beside, kept: None };
        let nodes = history.next.correction.nodes().unwrap_or_default();
        let correction = evaluate(pass, &machine, &done.identified, &nodes, &request);
        let rows = correction_rows(&machine, &correction);
        let surface = Surface::predicted(&machine, &done.identified, &beside, &nodes);
        Ok(Self { correction, surface, rows })
    }

    /// Whether it was cut with any correction.
    pub fn had_correction(&self) -> bool {
        self.correction.nodes.iter().any(|node| *node != Node::default())
    }

    /// Its largest error.
    pub fn whole_contour(&self) -> WholeContour {
        let target = self.correction.wanted.target;
        let walls = self.correction.predicted.iter().zip(&self.correction.sigma).zip(&self.rows);
        let errors = walls.map(|((wall, sigma), row)| (wall.after.aim(target, None).abs(), *sigma, row.s_mm));
        let largest = errors.max_by_key(|(error, _, _)| *error);
        let (error, sigma, s_mm) = largest.unwrap_or_default();
        WholeContour { max_mm: mm(error), s_mm, sigma_mm: mm(sigma) }
    }
}
