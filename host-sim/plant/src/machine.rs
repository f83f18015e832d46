//! The machine and the material: everything a user cannot know and the probe has to find out.
//!
//! Read from a `PLANT.toml`; every key carries its unit, unknown keys are an error.
//!
//! ```toml
//! ktc_n_per_mm2 = 1000.0            # chip force per chip area, tangential and radial
//! krc_n_per_mm2 = 330.0
//! kte_n_per_mm = 12.0               # edge force per engaged depth
//! kre_n_per_mm = 16.0
//! size_exponent = 0.2               # chip coefficients × (h / 0.05 mm)^(−m)
//! compliance_mm_per_n = [[0.00087, 0.00011], [0.00011, 0.00111]]   # or stiffness_x_n_per_mm and stiffness_y_n_per_mm
//! bend = 0.15                       # compliance × (1 + bend·(1 − z/b)): the tip moves most
//! bend_law = "alike"                # a force moves the cutter alike wherever it attacks; or "maxwell"
//! runout_mm = [0.0, 0.004, -0.002, 0.001]   # radial, one a tooth, in the order in which they pass
//! edge_wear_per_m = 0.05            # edge force grows by this fraction per metre of path
//! stock_variation_mm = 0.05         # largest deviation of the allowance
//! stock_wavelength_mm = 40.0
//! law = "helical"                   # or "mean"
//! probe_noise_mm = 0.002            # standard deviation of a touch
//! force_factor = 1.18               # all cutting forces of this part
//! radius_error_mm = -0.01           # the cutter is that much larger than the program believes
//! drift_mm = [0.012, 0.009]         # how far the datum has moved at the end of the contour
//! seed = 1
//!
//! [stock]                           # UnevenStock
//! seed = 7
//! waves = 0.25
//! wavelength_mm = 40.0
//! step = -0.25
//! step_from_mm = 60.0
//! corner = 0.2
//! level = 0.05
//!
//! [yielding]                        # YieldingWall
//! from_mm = 20.0
//! to_mm = 45.0
//! rise_mm = 5.0
//! compliance_mm_per_n = 0.0002
//!
//! [drives]                          # Drives
//! time_constant_s = 0.008
//! backlash_mm = [0.004, 0.003]
//!
//! [probe]                           # ProbeErrors
//! lobing_mm = 0.003
//! lobing_deg = 15.0
//! wild_mm = 0.2
//! wild_one_in = 24
//! ```

use serde::{Deserialize, Serialize};

use super::drives::Drives;
use super::error::{PlantError, require};
use super::probe_errors::ProbeErrors;
use super::uneven_stock::UnevenStock;
use super::vector::{Point, along, dot};
use super::yielding::YieldingWall;

/// Which force makes the wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WallLaw {
    /// The force at the instant at which a tooth passes the wall at that height.
    #[default]
    Helical,
    /// The mean over a revolution, as in P23.
    Mean,
}

/// How far a force bends the cutter by the height at which it attacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BendLaw {
    /// Alike at every height.
    #[default]
    Alike,
    /// As far as the cutter bends at that height under a force elsewhere, (1 + bend·(1 − z/b)) / (1 + bend/2) of the mean:
    /// Maxwell's reciprocity. A force spread evenly over the depth bends it as under the other law.
    Maxwell,
}

impl BendLaw {
    fn is_usual(&self) -> bool {
        *self == Self::Alike
    }
}

/// Machine, cutter and material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MachineFile", into = "MachineFile")]
pub struct Machine {
    /// Tangential chip coefficient, N/mm².
    pub ktc_n_per_mm2: f64,
    /// Radial chip coefficient, N/mm².
    pub krc_n_per_mm2: f64,
    /// Tangential edge coefficient, N/mm.
    pub kte_n_per_mm: f64,
    /// Radial edge coefficient, N/mm.
    pub kre_n_per_mm: f64,
    /// Size exponent m, 0…0.9.
    pub size_exponent: f64,
    /// Displacement of the cutter per force, rows x and y, mm/N; need not be symmetric, need not be diagonal.
    pub compliance_mm_per_n: [[f64; 2]; 2],
    /// Cutter bending: the compliance at height z is multiplied by 1 + bend·(1 − z/b).
    pub bend: f64,
    /// What the height at which a force attacks has to do with it.
    pub bend_law: BendLaw,
    /// Radial runout, mm, one value a tooth in the order in which they pass a place, or empty.
    pub runout_mm: Vec<f64>,
    /// Growth of the edge force per metre of path, 1/m.
    pub edge_wear_per_m: f64,
    /// Largest deviation of the allowance from its nominal value, mm.
    pub stock_variation_mm: f64,
    /// Shortest wavelength of that deviation, mm.
    pub stock_wavelength_mm: f64,
    /// Which force makes the wall.
    pub law: WallLaw,
    /// Standard deviation of one touch of the probe along the normal, mm.
    pub probe_noise_mm: f64,
    /// Seed of the stock's and the probe's chance.
    pub seed: u64,
    /// Factor on all cutting forces of this part: a worn cutter, a harder piece.
    pub force_factor: f64,
    /// How much larger the cutter is than its nominal radius, mm.
    pub radius_error_mm: f64,
    /// How far the datum has moved at the end of the contour, x and y, mm; evenly along it.
    pub drift_mm: Point,
    /// What is uneven about the stock.
    pub stock: UnevenStock,
    /// A stretch of the wall that yields.
    pub yielding: YieldingWall,
    /// What the drives do with the command.
    pub drives: Drives,
    /// What the probe reads wrong besides noise.
    pub probe: ProbeErrors,
}

impl Machine {
    /// Whether nothing is said of how the stock is uneven.
    pub fn has_even_stock(&self) -> bool {
        self.stock.is_even() && self.stock_variation_mm.abs() <= 0.0
    }

    /// A machine that does not yield, cutting material that does not resist. Start of a definition by struct update.
    pub fn rigid() -> Self {
        Self {
            ktc_n_per_mm2: 0.0,
            krc_n_per_mm2: 0.0,
            kte_n_per_mm: 0.0,
            kre_n_per_mm: 0.0,
            size_exponent: 0.0,
            compliance_mm_per_n: [[0.0; 2]; 2],
            bend: 0.0,
            bend_law: BendLaw::Alike,
            runout_mm: Vec::new(),
            edge_wear_per_m: 0.0,
            stock_variation_mm: 0.0,
            stock_wavelength_mm: 40.0,
            law: WallLaw::Helical,
            probe_noise_mm: 0.0,
            seed: 0,
            force_factor: 1.0,
            radius_error_mm: 0.0,
            drift_mm: [0.0; 2],
            stock: UnevenStock::default(),
            yielding: YieldingWall::default(),
            drives: Drives::default(),
            probe: ProbeErrors::default(),
        }
    }

    /// Compliance of two independent axes, from their stiffness in N/mm.
    pub fn compliance_of_stiffness(x_n_per_mm: f64, y_n_per_mm: f64) -> [[f64; 2]; 2] {
        [[1.0 / x_n_per_mm, 0.0], [0.0, 1.0 / y_n_per_mm]]
    }

    /// Checks the ranges; `teeth` is the cutter's.
    ///
    /// # Errors
    /// `OutOfRange` with the key, `RunoutCount`.
    pub fn check(&self, teeth: usize) -> Result<(), PlantError> {
        self.check_ranges()?;
        if !self.runout_mm.is_empty() && self.runout_mm.len() != teeth {
            return Err(PlantError::RunoutCount { found: self.runout_mm.len(), teeth });
        }
        Ok(())
    }

    fn check_ranges(&self) -> Result<(), PlantError> {
        let not_negative = [
            ("ktc_n_per_mm2", self.ktc_n_per_mm2),
            ("krc_n_per_mm2", self.krc_n_per_mm2),
            ("kte_n_per_mm", self.kte_n_per_mm),
            ("kre_n_per_mm", self.kre_n_per_mm),
            ("edge_wear_per_m", self.edge_wear_per_m),
            ("stock_variation_mm", self.stock_variation_mm),
            ("probe_noise_mm", self.probe_noise_mm),
            ("force_factor", self.force_factor),
        ];
        for (key, value) in not_negative {
            let ok = value >= 0.0 && value.is_finite();
            require(ok, key, value, "a number of at least 0")?;
        }
        let m = self.size_exponent;
        require((0.0..=0.9).contains(&m), "size_exponent", m, "0 to 0.9")?;
        require((-0.5..=5.0).contains(&self.bend), "bend", self.bend, "-0.5 to 5")?;
        let wave = self.stock_wavelength_mm;
        require(wave >= 1.0 && wave.is_finite(), "stock_wavelength_mm", wave, "at least 1 mm")?;
        for &value in self.compliance_mm_per_n.iter().flatten() {
            let ok = value.abs() <= 0.1;
            require(ok, "compliance_mm_per_n", value, "up to 0.1 mm/N")?;
        }
        for &value in &self.runout_mm {
            let ok = value.abs() <= 1.0;
            require(ok, "runout_mm", value, "up to 1 mm")?;
        }
        let large = self.radius_error_mm;
        require(large.abs() <= 1.0, "radius_error_mm", large, "up to 1 mm")?;
        for &value in &self.drift_mm {
            require(value.abs() <= 1.0, "drift_mm", value, "up to 1 mm")?;
        }
        self.stock.check()?;
        self.yielding.check()?;
        self.drives.check()?;
        self.probe.check()
    }

    /// Radius of a tooth that cuts, mm, where the nominal one is `radius_mm`.
    pub(super) fn tooth_radius(&self, radius_mm: f64, tooth: usize) -> f64 {
        radius_mm + (self.radius_error_mm + self.runout_mm.get(tooth).copied().unwrap_or(0.0))
    }

    /// Radius of the longest tooth, mm.
    pub(super) fn longest_radius(&self, radius_mm: f64) -> f64 {
        let teeth = 0..self.runout_mm.len().max(1);
        teeth.map(|tooth| self.tooth_radius(radius_mm, tooth)).fold(f64::MIN, f64::max)
    }

    /// How far the cutter moves at a level of the axial depth (0 tip … 1 top) against its top; nothing moves against the force.
    pub(super) fn reach(&self, level: f64) -> f64 {
        (1.0 + self.bend * (1.0 - level)).max(0.0)
    }

    /// How much a force counts that attacks at a level of the axial depth.
    pub(super) fn attack(&self, level: f64) -> f64 {
        match self.bend_law {
            BendLaw::Alike => 1.0,
            BendLaw::Maxwell => self.reach(level) / (1.0 + 0.5 * self.bend),
        }
    }

    /// Displacement of the cutter against the wall under a force, mm, at a place along the contour whose wall has this normal.
    pub(super) fn deflection(&self, force: Point, s_mm: f64, normal: Point) -> Point {
        let c = &self.compliance_mm_per_n;
        let cutter = [c[0][0] * force[0] + c[0][1] * force[1], c[1][0] * force[0] + c[1][1] * force[1]];
        let wall = self.yielding.at(s_mm);
        if wall > 0.0 { along(cutter, normal, wall * dot(force, normal)) } else { cutter }
    }
}

/// The keys of `PLANT.toml`.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MachineFile {
    ktc_n_per_mm2: f64,
    krc_n_per_mm2: f64,
    #[serde(default)]
    kte_n_per_mm: f64,
    #[serde(default)]
    kre_n_per_mm: f64,
    #[serde(default)]
    size_exponent: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    compliance_mm_per_n: Option<[[f64; 2]; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stiffness_x_n_per_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stiffness_y_n_per_mm: Option<f64>,
    #[serde(default)]
    bend: f64,
    #[serde(default, skip_serializing_if = "BendLaw::is_usual")]
    bend_law: BendLaw,
    #[serde(default)]
    runout_mm: Vec<f64>,
    #[serde(default)]
    edge_wear_per_m: f64,
    #[serde(default)]
    stock_variation_mm: f64,
    #[serde(default = "default_wavelength")]
    stock_wavelength_mm: f64,
    #[serde(default)]
    law: WallLaw,
    #[serde(default)]
    probe_noise_mm: f64,
    #[serde(default)]
    seed: u64,
    #[serde(default = "one", skip_serializing_if = "is_one")]
    force_factor: f64,
    #[serde(default, skip_serializing_if = "is_zero")]
    radius_error_mm: f64,
    #[serde(default, skip_serializing_if = "stays")]
    drift_mm: Point,
    // Tables come last.
    #[serde(default, skip_serializing_if = "UnevenStock::is_even")]
    stock: UnevenStock,
    #[serde(default, skip_serializing_if = "YieldingWall::is_rigid")]
    yielding: YieldingWall,
    #[serde(default, skip_serializing_if = "Drives::is_exact")]
    drives: Drives,
    #[serde(default, skip_serializing_if = "ProbeErrors::is_none")]
    probe: ProbeErrors,
}

fn one() -> f64 {
    1.0
}

fn is_one(value: &f64) -> bool {
    *value == 1.0
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn stays(value: &Point) -> bool {
    *value == [0.0; 2]
}

fn default_wavelength() -> f64 {
    40.0
}

impl TryFrom<MachineFile> for Machine {
    type Error = String;

    fn try_from(file: MachineFile) -> Result<Self, String> {
        let stiffness = (file.stiffness_x_n_per_mm, file.stiffness_y_n_per_mm);
        let compliance_mm_per_n = match (file.compliance_mm_per_n, stiffness) {
            (Some(c), (None, None)) => c,
            (None, (Some(x), Some(y))) if x > 0.0 && y > 0.0 => Self::compliance_of_stiffness(x, y),
            (None, (Some(x), Some(y))) => {
                return Err(format!("stiffness must be more than 0 N/mm, found {x} and {y}"));
            }
            _ => {
                return Err(
                    "give either compliance_mm_per_n or both stiffness_x_n_per_mm and stiffness_y_n_per_mm".into()
                );
            }
        };
        let machine = Self {
            ktc_n_per_mm2: file.ktc_n_per_mm2,
            krc_n_per_mm2: file.krc_n_per_mm2,
            kte_n_per_mm: file.kte_n_per_mm,
            kre_n_per_mm: file.kre_n_per_mm,
            size_exponent: file.size_exponent,
            compliance_mm_per_n,
            bend: file.bend,
            bend_law: file.bend_law,
            runout_mm: file.runout_mm,
            edge_wear_per_m: file.edge_wear_per_m,
            stock_variation_mm: file.stock_variation_mm,
            stock_wavelength_mm: file.stock_wavelength_mm,
            law: file.law,
            probe_noise_mm: file.probe_noise_mm,
            seed: file.seed,
            force_factor: file.force_factor,
            radius_error_mm: file.radius_error_mm,
            drift_mm: file.drift_mm,
            stock: file.stock,
            yielding: file.yielding,
            drives: file.drives,
            probe: file.probe,
        };
        machine.check_ranges().map_err(|e| e.to_string())?;
        Ok(machine)
    }
}

impl From<Machine> for MachineFile {
    fn from(m: Machine) -> Self {
        Self {
            ktc_n_per_mm2: m.ktc_n_per_mm2,
            krc_n_per_mm2: m.krc_n_per_mm2,
            kte_n_per_mm: m.kte_n_per_mm,
            kre_n_per_mm: m.kre_n_per_mm,
            size_exponent: m.size_exponent,
            compliance_mm_per_n: Some(m.compliance_mm_per_n),
            stiffness_x_n_per_mm: None,
            stiffness_y_n_per_mm: None,
            bend: m.bend,
            bend_law: m.bend_law,
            runout_mm: m.runout_mm,
            edge_wear_per_m: m.edge_wear_per_m,
            stock_variation_mm: m.stock_variation_mm,
            stock_wavelength_mm: m.stock_wavelength_mm,
            law: m.law,
            probe_noise_mm: m.probe_noise_mm,
            seed: m.seed,
            force_factor: m.force_factor,
            radius_error_mm: m.radius_error_mm,
            drift_mm: m.drift_mm,
            stock: m.stock,
            yielding: m.yielding,
            drives: m.drives,
            probe: m.probe,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: &str = "ktc_n_per_mm2 = 1000.0\nkrc_n_per_mm2 = 330.0\n";

    fn read(text: &str) -> Result<Machine, String> {
        toml::from_str(text).map_err(|e| e.to_string())
    }

    #[test]
    fn stiffness_and_compliance_are_two_ways_to_say_the_same() {
        let a = read(&format!("{SHORT}stiffness_x_n_per_mm = 1000\nstiffness_y_n_per_mm = 500\n"));
        let b = read(&format!("{SHORT}compliance_mm_per_n = [[0.001, 0], [0, 0.002]]\n"));
        assert_eq!(a.expect("valid"), b.expect("valid"));
    }

    #[test]
    fn a_written_machine_reads_back_as_itself() {
        let machine = Machine {
            ktc_n_per_mm2: 760.0,
            compliance_mm_per_n: [[0.0007, 0.0001], [0.0001, 0.0005]],
            runout_mm: vec![0.0, 0.004],
            law: WallLaw::Mean,
            seed: 7,
            ..Machine::rigid()
        };
        let text = toml::to_string(&machine).expect("writes");
        assert!(!text.contains("force_factor") && !text.contains("\n["), "what is not there is not written: {text}");
        assert_eq!(read(&text), Ok(machine.clone()));
        let uneven = Machine {
            force_factor: 1.18,
            drift_mm: [0.01, -0.005],
            stock: UnevenStock { waves: 0.25, seed: 4, ..UnevenStock::default() },
            yielding: YieldingWall { to_mm: 40.0, compliance_mm_per_n: 1e-4, ..YieldingWall::default() },
            drives: Drives { time_constant_s: 0.005, backlash_mm: [0.004, 0.0] },
            probe: ProbeErrors { wild_mm: 0.2, ..ProbeErrors::default() },
            ..machine
        };
        assert_eq!(read(&toml::to_string(&uneven).expect("writes")), Ok(uneven));
    }

    #[test]
    fn a_nuisance_out_of_its_range_is_an_error_that_names_it() {
        let stiff = "stiffness_x_n_per_mm = 1000\nstiffness_y_n_per_mm = 1000\n";
        for (line, key) in [
            ("force_factor = -1", "force_factor"),
            ("[stock]\nwaves = 1.5", "stock.waves"),
            ("[stock]\nwaves = 0.6\nstep = -0.5", "stock"),
            ("[yielding]\nfrom_mm = 3", "yielding.to_mm"),
            ("[drives]\nbacklash_mm = [0, 2]", "drives.backlash_mm"),
            ("[probe]\nwild_one_in = 0", "probe.wild_one_in"),
            ("[probe]\nlobes = 3", "lobes"),
        ] {
            let error = read(&format!("{SHORT}{stiff}{line}\n")).expect_err(line);
            assert!(error.contains(key), "{line}: {error}");
        }
    }

    #[test]
    fn an_unknown_key_is_an_error_that_names_it() {
        let error = read(&format!("{SHORT}stiffness_x_n_per_mm = 1\nstiffness_y_n_per_mm = 1\nktc = 3\n"));
        assert!(error.expect_err("unknown key").contains("ktc"));
    }

    #[test]
    fn a_machine_without_stiffness_or_with_both_forms_is_an_error() {
        assert!(read(SHORT).expect_err("neither").contains("stiffness_x_n_per_mm"));
        let both = "compliance_mm_per_n = [[0, 0], [0, 0]]\nstiffness_x_n_per_mm = 1\n";
        assert!(read(&format!("{SHORT}{both}")).expect_err("both").contains("either"));
    }
}
