//! The machine and the material of a case, as the plant has them: everything the model knows of and several things it
//! does not (runout, wear, uneven stock, an unsymmetric compliance, a cutter that is not as large as measured).

use truepath_plant::{BendLaw, Machine, WallLaw};

use super::draw::Draw;
use super::part::{Material, Part};

/// How far machines may be from the usual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// As in the families.
    Usual,
    /// Wider in everything: softer, noisier, worse known.
    Wild,
}

/// A machine, its compliance still to be scaled so that the part comes out as wrong as the case wants.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The machine; the mean of its two compliances is 0.001 mm/N.
    pub machine: Machine,
    /// Largest wall error of the uncorrected part that is aimed at, mm.
    pub error_mm: f64,
}

/// Draws the machine of a part.
pub fn machine(draw: &mut Draw, part: &Part, width: Width) -> Drawn {
    let wild = width == Width::Wild;
    let (low, high) = match part.material {
        Material::Aluminium => (550.0, 1000.0),
        Material::Steel => (1000.0, 2000.0),
        Material::Any => (550.0, 2000.0),
    };
    let ktc = draw.scale(low, high);
    let krc = ktc * draw.between(0.2, 0.45);
    let edges = (draw.between(4.0, 24.0), draw.between(4.0, 30.0));
    let size_exponent = draw.between(0.0, if wild { 0.35 } else { 0.3 });
    let compliance_mm_per_n = compliance(draw, if wild { (0.0, 0.35) } else { part.cross });
    let bend = draw.between(part.bend.0, part.bend.1);
    let runout = draw.between(0.0, 0.006);
    let radius_error = draw.normal(0.002);
    let teeth: Vec<f64> = (0..part.cut.teeth).map(|_| radius_error + draw.between(-runout, runout)).collect();
    let wear = draw.between(0.0, 0.2);
    // Blanks are sawn, cast or roughed: their variation has little to do with the allowance, but thin allowances are
    // left by passes that are even.
    let stock = draw.between(0.0, 0.05) * (part.cut.allowance_mm / 2.0).min(1.0);
    let (low, high) = if wild { (0.02, 0.7) } else { part.error_mm };
    let machine = Machine {
        ktc_n_per_mm2: ktc,
        krc_n_per_mm2: krc,
        kte_n_per_mm: edges.0,
        kre_n_per_mm: edges.1,
        size_exponent,
        compliance_mm_per_n,
        bend,
        bend_law: BendLaw::Alike,
        runout_mm: teeth,
        edge_wear_per_m: wear,
        stock_variation_mm: stock,
        stock_wavelength_mm: draw.between(25.0, 80.0),
        law: part.law,
        probe_noise_mm: draw.between(0.001, if wild { 0.008 } else { 0.005 }),
        seed: draw.seed(),
        ..Machine::rigid()
    };
    let error_mm = draw.scale(low, high).min(0.35 * part.cut.allowance_mm);
    let machine = if part.plain { plain(machine) } else { machine };
    Drawn { machine, error_mm }
}

/// The papers' material on the papers' machine; compliances stay as drawn.
fn plain(machine: Machine) -> Machine {
    Machine {
        kte_n_per_mm: 0.0,
        kre_n_per_mm: 0.0,
        size_exponent: 0.0,
        runout_mm: Vec::new(),
        edge_wear_per_m: 0.0,
        stock_variation_mm: 0.0,
        law: WallLaw::Mean,
        ..machine
    }
}

/// Compliances that differ by up to 2 : 1 in x and y, with a cross term that is not quite the same both ways.
fn compliance(draw: &mut Draw, cross: (f64, f64)) -> [[f64; 2]; 2] {
    let difference = draw.between(-0.33, 0.33);
    let cross = draw.sign() * draw.between(cross.0, cross.1);
    let twist = if cross == 0.0 { 0.0 } else { draw.between(-0.02, 0.02) };
    [[1.0 + difference, cross + twist], [cross - twist, 1.0 - difference]].map(|row| row.map(|c| 1e-3 * c))
}
