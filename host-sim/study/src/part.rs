//! What is milled in a case: contour, cutter, cut, and the ranges from which its machine is drawn.

use truepath_plant::{Side, Spindle, WallLaw};

use super::contour::Contour;
use super::draw::{Draw, rounded};

/// Kinds of material: ranges of the chip coefficient and of the cutting speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Wrought aluminium: 550–1000 N/mm², 120–350 m/min.
    Aluminium,
    /// Steel: 1000–2000 N/mm², 60–140 m/min.
    Steel,
    /// Either.
    Any,
}

/// A cutter and how it is used.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    /// Cutter radius, mm.
    pub radius_mm: f64,
    /// Teeth.
    pub teeth: usize,
    /// Helix angle, degrees.
    pub helix_deg: f64,
    /// Axial depth, mm.
    pub depth_mm: f64,
    /// Stock on the wall, mm.
    pub allowance_mm: f64,
    /// Spindle speed, rev/min.
    pub rpm: f64,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
}

/// Ranges of a cut.
#[derive(Clone, Debug)]
pub struct CutRange<'a> {
    /// Cutter radii, mm.
    pub radii_mm: &'a [f64],
    /// Numbers of teeth.
    pub teeth: &'a [usize],
    /// Helix angle, degrees.
    pub helix_deg: (f64, f64),
    /// Axial depth as a share of the radius.
    pub depth: (f64, f64),
    /// Allowance as a share of the radius.
    pub allowance: (f64, f64),
    /// Material, for the cutting speed.
    pub material: Material,
}

impl Default for CutRange<'_> {
    fn default() -> Self {
        Self {
            radii_mm: &[5.0, 6.0, 8.0, 10.0],
            teeth: &[3, 4, 4, 6],
            helix_deg: (25.0, 42.0),
            depth: (0.8, 1.8),
            allowance: (0.12, 0.3),
            material: Material::Any,
        }
    }
}

impl CutRange<'_> {
    /// One cut; feed per tooth 0.03…0.1 mm.
    pub fn draw(&self, draw: &mut Draw) -> Cut {
        let radius_mm = draw.one_of(self.radii_mm);
        let teeth = draw.one_of(self.teeth);
        let speed = match self.material {
            Material::Aluminium => draw.scale(120.0, 350.0),
            Material::Steel => draw.scale(60.0, 140.0),
            Material::Any => draw.scale(60.0, 350.0),
        };
        let rpm = rounded(1e3 * speed / (std::f64::consts::TAU * radius_mm), 50.0).max(200.0);
        let per_tooth = draw.scale(0.03, 0.1);
        Cut {
            radius_mm,
            teeth,
            helix_deg: draw.round(self.helix_deg.0, self.helix_deg.1, 1.0),
            depth_mm: draw.round(self.depth.0 * radius_mm, self.depth.1 * radius_mm, 0.5).max(1.0),
            allowance_mm: draw.round(self.allowance.0 * radius_mm, self.allowance.1 * radius_mm, 0.05).max(0.2),
            rpm,
            feed_mm_per_min: rounded(per_tooth * rpm * teeth as f64, 10.0).max(20.0),
        }
    }
}

/// What is milled, and on what kind of machine.
#[derive(Clone, Debug)]
pub struct Part {
    /// The contour.
    pub contour: Contour,
    /// Cutter and cut.
    pub cut: Cut,
    /// Sense of the spindle.
    pub spindle: Spindle,
    /// Material.
    pub material: Material,
    /// Which force makes the wall.
    pub law: WallLaw,
    /// `force.model` of the job.
    pub model: &'static str,
    /// Largest wall error of the uncorrected part that is aimed at, mm; never more than 0.35 of the allowance.
    pub error_mm: (f64, f64),
    /// Machine and material of the papers: no edge force, no size effect, no runout, no wear, even stock.
    pub plain: bool,
    /// Cross compliance as a share of the mean compliance, of either sign.
    pub cross: (f64, f64),
    /// Bending.
    pub bend: (f64, f64),
    /// Probe heights, shares of the depth.
    pub levels: &'static [f64],
    /// Probe places, mm along the contour; chosen by the general rule when there are none.
    pub places_mm: Vec<f64>,
}

impl Part {
    /// A part on a usual machine.
    pub fn new(contour: Contour, cut: Cut) -> Self {
        Self {
            contour,
            cut,
            spindle: Spindle::Clockwise,
            material: Material::Any,
            law: WallLaw::Helical,
            model: "auto",
            error_mm: (0.06, 0.5),
            plain: false,
            cross: (0.0, 0.15),
            bend: (0.0, 0.3),
            levels: &[0.1, 0.5, 0.9],
            places_mm: Vec::new(),
        }
    }
}

/// Side of the wall for climb milling with this spindle.
pub fn climb(spindle: Spindle) -> Side {
    match spindle {
        Spindle::Clockwise => Side::Right,
        Spindle::CounterClockwise => Side::Left,
    }
}

/// Side of the wall for conventional milling with this spindle.
pub fn conventional(spindle: Spindle) -> Side {
    match spindle {
        Spindle::Clockwise => Side::Left,
        Spindle::CounterClockwise => Side::Right,
    }
}

/// A start anywhere within ±1 m.
pub fn anywhere(draw: &mut Draw) -> [f64; 2] {
    [draw.between(-1000.0, 1000.0), draw.between(-1000.0, 1000.0)]
}
