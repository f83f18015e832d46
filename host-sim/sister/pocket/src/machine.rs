//! How far a newton moves the cutter at every height: the cutter as a beam, and what holds it.

use truepath_ground::units::{float, mm};
use truepath_job::job::JobFile;

use super::beam::{Beam, Load};
use super::error::PocketError;
use super::tool::{Tool, core_ratio, modulus};

/// Cutter and machine, for a load spread evenly over the engaged depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// The cutter's dimensions.
    pub tool: Tool,
    /// The cutter as a beam.
    pub beam: Beam,
    /// Compliance of machine and spindle along x and y, mm/N; 0 where the job states none.
    pub held_mm_per_n: [f64; 2],
    /// Engaged depth, mm.
    pub depth_mm: f64,
}

impl Machine {
    /// From a job.
    ///
    /// # Errors
    /// [`PocketError::NoCutter`] without stick-out and tool material.
    pub fn of(job: &JobFile) -> Result<Self, PocketError> {
        let (numbers, shank) = (&job.numbers, &job.shank);
        let cantilever = numbers.tool.cantilever.ok_or(PocketError::NoCutter)?;
        let diameter_mm = mm(numbers.tool.diameter);
        let stickout_mm = mm(cantilever.length);
        let tool = Tool {
            diameter_mm,
            teeth: numbers.tool.teeth,
            stickout_mm,
            flute_length_mm: shank.flute_length.map_or(stickout_mm, mm),
            shank_diameter_mm: shank.diameter.map_or(diameter_mm, mm),
            core_ratio: shank.core_ratio.unwrap_or(core_ratio(numbers.tool.teeth)),
            modulus_kn_per_mm2: shank.modulus_kn_per_mm2.unwrap_or(modulus(cantilever.material)),
        };
        let stated = job.gives("machine.stiffness_x_n_per_mm");
        let held = |stiffness| if stated { 1.0 / float(stiffness) } else { 0.0 };
        Ok(Self {
            tool,
            beam: tool.beam(),
            held_mm_per_n: [held(numbers.machine.stiffness_x), held(numbers.machine.stiffness_y)],
            depth_mm: mm(numbers.cut.axial_depth),
        })
    }

    /// Compliance of the cutter at a height, as a fraction 0 (tip) to 1 (top) of the engaged depth, mm/N.
    pub fn bend_at(&self, fraction: f64) -> f64 {
        self.beam.deflection(fraction * self.depth_mm, Load::Spread(0.0, self.depth_mm))
    }

    /// Compliance along x and y at a height of the engaged depth, mm/N.
    pub fn at(&self, fraction: f64) -> [f64; 2] {
        self.held_mm_per_n.map(|held| held + self.bend_at(fraction))
    }

    /// The mean over the engaged depth, mm/N.
    pub fn mean(&self) -> [f64; 2] {
        let mean = self.beam.mean_over_depth(self.depth_mm);
        self.held_mm_per_n.map(|held| held + mean)
    }
}
