//! The jobs of a shop, and what they let expect of another one.

use std::collections::BTreeMap;

use truepath_core::identify::Prior;
use truepath_ground::cholesky::Cholesky;
use truepath_ground::units::float;

use super::quantities::{CUTTERS_MM, QUANTITIES, Quantities, Quantity, narrowed, of, sigmas};
use super::said::{Said, Square};

/// Where a job is cut and from what; empty where it is not known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Setting {
    /// The make of the machine, as alike as its user thinks.
    pub make: String,
    /// The machine.
    pub machine: String,
    /// What is mounted in it: holder, cutter and stick-out.
    pub mounting: String,
    /// The material.
    pub material: String,
    /// The lot of the material.
    pub lot: String,
    /// The very cutter, with the size that is stated of it: ground again, it is another one.
    pub cutter: String,
}

/// A job that was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Where it was cut and from what.
    pub setting: Setting,
    /// What its points say.
    pub said: Said,
}

/// The jobs of a shop.
#[derive(Clone, Debug, Default)]
pub struct Shop {
    /// They, in any order.
    pub members: Vec<Member>,
}

/// Of what a user does not know of a machine, the share (of the variance) that is alike in a shop, in a make, that which is the
/// machine's, and that which is the mounting's.
const OF_MACHINE: [f64; 4] = [0.15, 0.3, 0.4, 0.15];
/// Of what is not known of a material, the share that is alike in a shop, and that which is the material's.
const OF_MATERIAL: [f64; 2] = [0.3, 0.7];
/// The machine's share of what is not known of the yield; the rest is the material's.
const MACHINE_OF_YIELD: f64 = 0.7;
/// What scatters from job to job on one machine in one material, one standard deviation: wear, lots, clamping, and what the model lacks.
/// A cutter wears, and runs out otherwise each time it is clamped.
const SCATTER: Quantities = [0.10, 0.03, 0.02, 0.08, 0.20, 0.12, 0.03, 0.03, 0.004];
/// What of this is a very cutter by itself, one standard deviation: how far it is worn, its edges above all.
const OF_CUTTER: Quantities = [0.05, 0.0, 0.0, 0.0, 0.12, 0.0, 0.0, 0.0, 0.0];
/// What of it is a lot of the material by itself, one standard deviation: another one cuts some per cent harder.
const OF_LOT: Quantities = [0.05, 0.0, 0.0, 0.04, 0.10, 0.06, 0.0, 0.015, 0.0];

/// A random effect on the quantities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Effect<'s> {
    MachinesOfShop,
    MaterialsOfShop,
    Make(&'s str),
    /// Of a make, if that has a name; else it is all that the make is as well.
    Machine(&'s str, bool),
    Mounting(&'s str, &'s str),
    Material(&'s str),
    Lot(&'s str, &'s str),
    Cutter(&'s str),
}

impl Effect<'_> {
    /// Its variance in a quantity of which a job states one standard deviation; 0 for one that it does not act on.
    fn variance(self, quantity: Quantity, sigma: f64) -> f64 {
        match (self, quantity) {
            _ if sigma == 0.0 => 0.0,
            (Self::Cutter(_), Quantity::Undersize) => CUTTERS_MM * CUTTERS_MM,
            _ => self.of_scatter(quantity) + self.share(quantity) * sigma * sigma,
        }
    }

    /// Its part of what otherwise scatters from job to job, as a variance.
    fn of_scatter(self, quantity: Quantity) -> f64 {
        match self {
            Self::Lot(..) => OF_LOT[quantity as usize].powi(2),
            Self::Cutter(_) => OF_CUTTER[quantity as usize].powi(2),
            _ => 0.0,
        }
    }

    /// Its share of the variance that a statement has; 0 for a quantity that it does not act on, and for one that is no part of it.
    fn share(self, quantity: Quantity) -> f64 {
        let machine = match quantity {
            Quantity::Yield => MACHINE_OF_YIELD,
            Quantity::Difference | Quantity::Cross | Quantity::Bend => 1.0,
            Quantity::RadialRatio | Quantity::EdgeLevel | Quantity::EdgeRatio | Quantity::SizeExponent => 0.0,
            // The size of a cutter is neither machine's nor material's.
            Quantity::Undersize => return if matches!(self, Self::Cutter(_)) { 1.0 } else { 0.0 },
        };
        match self {
            Self::MachinesOfShop => machine * OF_MACHINE[0],
            Self::Make(_) => machine * OF_MACHINE[1],
            Self::Machine(_, has_make) => machine * (OF_MACHINE[2] + if has_make { 0.0 } else { OF_MACHINE[1] }),
            Self::Mounting(..) => machine * OF_MACHINE[3],
            Self::MaterialsOfShop => (1.0 - machine) * OF_MATERIAL[0],
            Self::Material(_) => (1.0 - machine) * OF_MATERIAL[1],
            Self::Lot(..) | Self::Cutter(_) => 0.0,
        }
    }
}

impl Setting {
    /// The effects on a job that are shared with others. What has no name is like nothing else, and part of its scatter.
    fn effects(&self) -> Vec<Effect<'_>> {
        let mut effects = vec![Effect::MachinesOfShop, Effect::MaterialsOfShop];
        if !self.make.is_empty() {
            effects.push(Effect::Make(&self.make));
        }
        if !self.machine.is_empty() {
            effects.push(Effect::Machine(&self.machine, !self.make.is_empty()));
            if !self.mounting.is_empty() {
                effects.push(Effect::Mounting(&self.machine, &self.mounting));
            }
        }
        if !self.material.is_empty() {
            effects.push(Effect::Material(&self.material));
            if !self.lot.is_empty() {
                effects.push(Effect::Lot(&self.material, &self.lot));
            }
        }
        if !self.cutter.is_empty() {
            effects.push(Effect::Cutter(&self.cutter));
        }
        effects
    }

    /// The variance of a job by itself: its scatter, and all effects that have no name here.
    fn scatter(&self, sigma: &Quantities) -> Quantities {
        let shared = self.effects();
        let own = |quantity: Quantity| {
            let named: f64 = shared.iter().map(|effect| effect.share(quantity)).sum();
            let of_scatter: f64 = shared.iter().map(|effect| effect.of_scatter(quantity)).sum();
            let k = quantity as usize;
            SCATTER[k] * SCATTER[k] - of_scatter + (1.0 - named).max(0.0) * sigma[k] * sigma[k]
        };
        Quantity::ALL.map(own)
    }
}

/// The unknowns of the normal equations: each effect on each quantity it acts on.
#[derive(Default)]
struct Unknowns<'s> {
    numbers: BTreeMap<(Effect<'s>, usize), usize>,
    /// The variance of each, beforehand.
    variances: Vec<f64>,
}

impl<'s> Unknowns<'s> {
    /// The numbers of the unknowns of a job, each with its quantity. New ones are as uncertain as its statement.
    fn of(&mut self, setting: &'s Setting, sigma: &Quantities) -> Vec<(usize, usize)> {
        let mut found = Vec::new();
        for effect in setting.effects() {
            for quantity in Quantity::ALL {
                let k = quantity as usize;
                let variance = effect.variance(quantity, sigma[k]);
                if variance == 0.0 {
                    continue;
                }
                let next = self.variances.len();
                let number = *self.numbers.entry((effect, k)).or_insert(next);
                if number == next {
                    self.variances.push(variance);
                }
                found.push((number, k));
            }
        }
        found
    }
}

impl Shop {
    /// What to expect of a job in a setting that states `stated` under the helical law; `None` where nothing of it is known better than
    /// from the statement alone, and where it would be farther from the statement than any machine is. A cutter that would be of quite
    /// another size than stated is expected as stated, and the rest as the shop knows it.
    ///
    /// The last value is the number of jobs that say so.
    pub fn believed(&self, setting: &Setting, stated: &Prior) -> Option<(Prior, usize)> {
        if self.members.is_empty() {
            return None;
        }
        let setting = &self.with_make(setting);
        let settings: Vec<Setting> = self.members.iter().map(|member| self.with_make(&member.setting)).collect();
        let sigma = sigmas(stated);
        let mut unknowns = Unknowns::default();
        let own = unknowns.of(setting, &sigma);
        let members: Vec<(&Member, Vec<(usize, usize)>)> =
            self.members.iter().zip(&settings).map(|(m, setting)| (m, unknowns.of(setting, &m.said.sigma))).collect();
        let count = unknowns.variances.len();
        let mut matrix: Vec<Vec<f64>> = (0..count).map(|i| vec![0.0; i + 1]).collect();
        let mut right = vec![0.0; count];
        for (i, variance) in unknowns.variances.iter().enumerate() {
            matrix[i][i] = 1.0 / variance;
        }
        let centres = Centres::of(&self.members);
        for (member, numbers) in &members {
            let Said { stated, stated_ln_ktc, .. } = &member.said;
            let (information, pull) = member.scattered(&centres.of_job(&member.setting, stated, *stated_ln_ktc));
            for (i, k) in numbers {
                right[*i] += pull[*k];
                for (j, l) in numbers.iter().filter(|(j, _)| j <= i) {
                    matrix[*i][*j] += information[*k][*l];
                }
            }
        }
        let factor = Cholesky::new(&matrix)?;
        let effects = factor.solve(&right);
        let scatter = setting.scatter(&sigma);
        let at = of(&stated.mean);
        let centre = centres.of_job(setting, &at, libm::log(float(stated.mean.coefficients.ktc)));
        let mut by = [None; QUANTITIES];
        for (k, by) in by.iter_mut().enumerate().filter(|(k, _)| sigma[*k] > 0.0) {
            let mut of_it = vec![0.0; count];
            own.iter().filter(|(_, quantity)| *quantity == k).for_each(|(i, _)| of_it[*i] = 1.0);
            let mean: f64 = centre[k] + of_it.iter().zip(&effects).map(|(one, effect)| one * effect).sum::<f64>();
            let variance: f64 = factor.halfway(&of_it).iter().map(|v| v * v).sum::<f64>() + scatter[k];
            if (mean - at[k]).abs() > Quantity::ALL[k].farthest(sigma[k]) {
                // A cutter of another size says nothing of the machine that it is in.
                if Quantity::ALL[k] == Quantity::Undersize {
                    continue;
                }
                return None;
            }
            let sure = variance.sqrt();
            if sure < NARROWER * sigma[k] || (mean - at[k]).abs() > ELSEWHERE * sure {
                *by = Some([mean, sure]);
            }
        }
        by.iter().any(Option::is_some).then(|| (narrowed(stated, &by), self.members.len()))
    }
}

impl Shop {
    /// A setting with the make of its machine, where any job of that machine says it.
    fn with_make(&self, setting: &Setting) -> Setting {
        let is_its = |other: &&Setting| !other.make.is_empty() && other.machine == setting.machine;
        let known = || self.members.iter().map(|member| &member.setting).find(is_its).map(|other| other.make.clone());
        let is_open = setting.make.is_empty() && !setting.machine.is_empty();
        Setting { make: is_open.then(known).flatten().unwrap_or_else(|| setting.make.clone()), ..setting.clone() }
    }
}

/// A quantity is taken from the shop where its standard deviation is less than this share of the statement's.
const NARROWER: f64 = 0.95;
/// Or where it is so many standard deviations away from what the job states.
const ELSEWHERE: f64 = 2.0;
impl Member {
    /// What a job says of the effects, about a centre: its information with its own scatter beside it, and the pull.
    fn scattered(&self, centre: &Quantities) -> (Square, Quantities) {
        let Said { stated, sigma, information, pull, .. } = &self.said;
        let mut pull = *pull;
        for (pull, row) in pull.iter_mut().zip(information) {
            *pull += row.iter().zip(stated.iter().zip(centre)).map(|(v, (at, centre))| v * (at - centre)).sum::<f64>();
        }
        // (Λ⁻¹ + E)⁻¹ = Λ − Λ(Λ + E⁻¹)⁻¹Λ for a Λ that may be singular; the same for its pull.
        let scatter = self.setting.scatter(sigma);
        let sum: Vec<Vec<f64>> = (0..QUANTITIES)
            .map(|i| (0..QUANTITIES).map(|j| information[i][j] + if i == j { 1.0 / scatter[i] } else { 0.0 }).collect())
            .collect();
        let Some(factor) = Cholesky::new(&sum) else { return Default::default() };
        let column = |right: &Quantities| {
            let solved = factor.solve(right);
            let mut out = *right;
            for (out, row) in out.iter_mut().zip(information) {
                *out -= row.iter().zip(&solved).map(|(v, s)| v * s).sum::<f64>();
            }
            out
        };
        // The matrix is symmetric: its rows are its columns.
        (information.map(|row| column(&row)), column(&pull))
    }
}

/// What is stated of a machine with its mounting, and of a material, on average over the jobs that do; effects are counted from there, so
/// that a job that states something else next time does not change what is known.
#[derive(Default)]
struct Centres<'s> {
    machines: BTreeMap<[&'s str; 2], Mean>,
    materials: BTreeMap<&'s str, Mean>,
}

/// What is stated of both, apart: the tangential chip coefficient is the material's share of the yield.
type Apart = [Quantities; 2];

fn apart(stated: &Quantities, ln_ktc: f64) -> Apart {
    let mut apart = [*stated; 2];
    for quantity in Quantity::ALL {
        let k = quantity as usize;
        match quantity {
            Quantity::Yield => (apart[0][k], apart[1][k]) = (stated[k] - ln_ktc, ln_ktc),
            Quantity::Difference | Quantity::Cross | Quantity::Bend => apart[1][k] = 0.0,
            Quantity::RadialRatio | Quantity::EdgeLevel | Quantity::EdgeRatio | Quantity::SizeExponent => {
                apart[0][k] = 0.0;
            }
            // A cutter is known with its stated size.
            Quantity::Undersize => (apart[0][k], apart[1][k]) = (0.0, 0.0),
        }
    }
    apart
}

/// Sums of what is stated, and how often it is.
#[derive(Clone, Copy, Default)]
struct Mean {
    sum: Quantities,
    count: Quantities,
}

impl Mean {
    fn add(&mut self, values: &Quantities, sigma: &Quantities) {
        for k in (0..QUANTITIES).filter(|k| sigma[*k] > 0.0) {
            self.sum[k] += values[k];
            self.count[k] += 1.0;
        }
    }

    /// The mean of each, or what there is instead.
    fn or(&self, other: &Quantities) -> Quantities {
        let mut values = *other;
        for (k, value) in values.iter_mut().enumerate().filter(|(k, _)| self.count[*k] > 0.0) {
            *value = self.sum[k] / self.count[k];
        }
        values
    }
}

impl<'s> Centres<'s> {
    fn of(members: &'s [Member]) -> Self {
        let mut centres = Self::default();
        for Member { setting: Setting { machine, mounting, material, .. }, said } in members {
            let [of_machine, of_material] = apart(&said.stated, said.stated_ln_ktc);
            if !machine.is_empty() {
                centres.machines.entry([machine, mounting]).or_default().add(&of_machine, &said.sigma);
            }
            if !material.is_empty() {
                centres.materials.entry(material).or_default().add(&of_material, &said.sigma);
            }
        }
        centres
    }

    /// The centre of a job: its own statement where no other has its machine or its material.
    fn of_job(&self, setting: &Setting, stated: &Quantities, ln_ktc: f64) -> Quantities {
        let Setting { machine, mounting, material, .. } = setting;
        let [of_machine, of_material] = apart(stated, ln_ktc);
        let machine = self.machines.get(&[machine.as_str(), mounting]).copied().unwrap_or_default().or(&of_machine);
        let material = self.materials.get(material.as_str()).copied().unwrap_or_default().or(&of_material);
        std::array::from_fn(|k| machine[k] + material[k])
    }
}

#[cfg(test)]
mod tests {
    use truepath_core::cut::{Coefficients, Compliance, WallLaw};
    use truepath_core::units::Real;

    use super::*;

    fn stated(stiffness: i32, ktc: i32) -> Prior {
        let [stiffness, ktc] = [stiffness, ktc].map(Real::from_int);
        let coefficients = Coefficients {
            ktc,
            krc: ktc * Real::ratio(3, 10),
            kte: Real::from_int(12),
            kre: Real::from_int(14),
            size_exponent: Real::ZERO,
        };
        Prior::around(coefficients, Compliance::from_stiffness(stiffness, stiffness), WallLaw::Helical)
    }

    fn setting(machine: &str, material: &str) -> Setting {
        Setting {
            make: "one".to_owned(),
            machine: machine.to_owned(),
            mounting: "short".to_owned(),
            material: material.to_owned(),
            lot: String::new(),
            cutter: String::new(),
        }
    }

    /// A job whose points say how far some quantities are from its statement, each to a standard deviation.
    fn member(machine: &str, material: &str, prior: &Prior, says: &[(Quantity, f64, f64)]) -> Member {
        let mut said = Said {
            stated: of(&prior.mean),
            stated_ln_ktc: libm::log(float(prior.mean.coefficients.ktc)),
            sigma: sigmas(prior),
            information: Square::default(),
            pull: Quantities::default(),
        };
        for (quantity, off, sigma) in says {
            let k = *quantity as usize;
            said.information[k][k] = sigma.powi(-2);
            said.pull[k] = off / (sigma * sigma);
        }
        Member { setting: setting(machine, material), said }
    }

    /// What is expected of a quantity, and how surely.
    fn expected(shop: &Shop, setting: &Setting, prior: &Prior, quantity: Quantity) -> [f64; 2] {
        let prior = shop.believed(setting, prior).map_or(*prior, |(prior, _)| prior);
        [of(&prior.mean)[quantity as usize], sigmas(&prior)[quantity as usize]]
    }

    #[test]
    fn a_shop_without_jobs_and_jobs_that_say_nothing_let_nothing_be_expected() {
        let prior = stated(3000, 1000);
        assert_eq!(Shop::default().believed(&setting("A", "B"), &prior), None);
        let shop = Shop { members: vec![member("A", "B", &prior, &[])] };
        assert_eq!(shop.believed(&setting("A", "B"), &prior), None);
    }

    #[test]
    fn a_machine_and_a_material_that_were_met_apart_are_known_together() {
        let prior = stated(3000, 1000);
        // Machine A is softer by 0.4 in two materials; material X is harder by 0.3 on two machines.
        let says = |off: f64| vec![(Quantity::Yield, off, 0.03)];
        let mut members = Vec::new();
        for (machine, soft) in [("A", 0.4), ("B", 0.0), ("C", -0.2), ("D", 0.1)] {
            for (material, hard) in [("X", 0.3), ("Y", 0.0), ("Z", -0.1)] {
                if (machine, material) != ("A", "X") {
                    members.push(member(machine, material, &prior, &says(soft + hard)));
                }
            }
        }
        let shop = Shop { members };
        let [value, sigma] = expected(&shop, &setting("A", "X"), &prior, Quantity::Yield);
        let off = value - of(&prior.mean)[0];
        assert!((off - 0.7).abs() < 0.12, "{off}");
        assert!(sigma < 0.16, "{sigma}");
        // A machine that nobody has seen is known less, and no better than machines differ.
        let [_, unknown] = expected(&shop, &setting("E", "X"), &prior, Quantity::Yield);
        assert!(unknown > 1.8 * sigma && unknown < 0.5, "{unknown}");
    }

    #[test]
    fn a_lot_is_known_from_the_jobs_of_that_lot() {
        let prior = stated(3000, 1000);
        let of_lot = |lot: &str| Setting { lot: lot.to_owned(), ..setting("A", "X") };
        // Lot 1 is harder by 0.12, the others are not.
        let jobs = [("1", 0.12), ("1", 0.12), ("1", 0.12), ("2", 0.0), ("3", 0.0), ("", 0.0)];
        let job = |(lot, off): (&str, f64)| Member {
            setting: of_lot(lot),
            ..member("A", "X", &prior, &[(Quantity::Yield, off, 0.02)])
        };
        let shop = Shop { members: jobs.map(job).to_vec() };
        let of = |lot: &str| expected(&shop, &of_lot(lot), &prior, Quantity::Yield);
        let ([one, sure], [two, _], [new, unsure], [none, _]) = (of("1"), of("2"), of("4"), of(""));
        assert!(one > new + 0.02 && two < new - 0.005, "{one} {two} {new}");
        assert!(sure < unsure && (new - none).abs() < 1e-9, "{sure} {unsure} {new} {none}");
        // The same number under another material is another lot.
        let elsewhere = Setting { material: "Y".to_owned(), ..of_lot("1") };
        let other = Setting { material: "Y".to_owned(), ..of_lot("9") };
        let [a, b] = [elsewhere, other].map(|setting| expected(&shop, &setting, &prior, Quantity::Yield)[0]);
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }

    #[test]
    fn the_size_of_a_cutter_is_known_from_what_it_cut_elsewhere() {
        let prior = stated(3000, 1000);
        let with = |cutter: &str, machine: &str| Setting { cutter: cutter.to_owned(), ..setting(machine, "X") };
        // Cutter 1 is 14 µm smaller than stated, and worn; 2 is neither; one without a number is as stated.
        let job = |(cutter, machine, small, worn): (&str, &str, f64, f64)| Member {
            setting: with(cutter, machine),
            ..member(machine, "X", &prior, &[(Quantity::Undersize, small, 0.002), (Quantity::EdgeLevel, worn, 0.05)])
        };
        let jobs = [("1", "A", 0.014, 0.2), ("1", "B", 0.014, 0.2), ("2", "A", 0.0, 0.0), ("", "B", 0.0, 0.0)];
        let shop = Shop { members: jobs.map(job).to_vec() };
        let of = |cutter: &str, quantity| expected(&shop, &with(cutter, "C"), &prior, quantity);
        let [small, sure] = of("1", Quantity::Undersize);
        // Clamped anew it may cut by some micrometres more or less.
        assert!((small - 0.012).abs() < 0.002 && sure > 0.004, "{small} {sure}");
        for unknown in ["2", "3", ""] {
            assert_eq!(of(unknown, Quantity::Undersize), [0.0, sigmas(&prior)[Quantity::Undersize as usize]]);
        }
        let edges = |cutter| of(cutter, Quantity::EdgeLevel)[0];
        assert!(edges("1") > edges("3") + 0.02 && edges("3") > edges("2") + 0.005, "{} {}", edges("1"), edges("2"));
        // The fit begins there.
        let (prior, _) = shop.believed(&with("1", "C"), &prior).expect("something is known");
        let undersize = prior.at(&Default::default()).undersize;
        assert!((truepath_ground::units::mm(undersize) - small).abs() < 1e-6);
    }

    #[test]
    fn a_shop_that_says_what_no_machine_can_be_is_not_asked() {
        let prior = stated(3000, 1000);
        let says = |off: f64| {
            let members = vec![member("A", "X", &prior, &[(Quantity::Yield, off, 0.01)])];
            Shop { members }.believed(&setting("A", "X"), &prior)
        };
        let sigma = sigmas(&prior)[Quantity::Yield as usize];
        assert!(says(3.0 * sigma).is_some());
        assert_eq!(says(9.0 * sigma), None);
    }

    #[test]
    fn a_cutter_of_quite_another_size_leaves_what_is_known_of_its_machine() {
        let prior = stated(3000, 1000);
        let in_it = Setting { cutter: "1".to_owned(), ..setting("A", "X") };
        let expected_mm = |small: f64| {
            let says = [(Quantity::Yield, 0.4, 0.02), (Quantity::Undersize, small, 0.001)];
            let jobs = (0..6).map(|_| Member { setting: in_it.clone(), ..member("A", "X", &prior, &says) });
            let shop = Shop { members: jobs.collect() };
            [Quantity::Yield, Quantity::Undersize].map(|quantity| expected(&shop, &in_it, &prior, quantity)[0])
        };
        let level = of(&prior.mean)[Quantity::Yield as usize];
        // Six times what nobody measured is 60 µm; a cutter ground by a tenth is none of those.
        for (small, believed) in [(0.04, true), (0.1, false)] {
            let [yields, size] = expected_mm(small);
            assert!((yields - level - 0.4).abs() < 0.06, "{yields} of a cutter {small} smaller");
            assert_eq!((size - small).abs() < 0.006, believed, "{size} of a cutter {small} smaller");
            assert!(believed || size == 0.0, "{size}");
        }
    }

    #[test]
    fn what_is_stated_does_not_change_what_is_known_of_a_machine() {
        let (soft, stiff) = (stated(3000, 1000), stated(6000, 1000));
        let says = |off: f64| vec![(Quantity::Yield, off, 0.01)];
        let shop = Shop { members: vec![member("A", "X", &soft, &says(0.2)), member("A", "X", &soft, &says(0.2))] };
        let [a, _] = expected(&shop, &setting("A", "X"), &soft, Quantity::Yield);
        let [b, _] = expected(&shop, &setting("A", "X"), &stiff, Quantity::Yield);
        assert!((a - b).abs() < 1e-6, "{a} {b}");
        assert!((a - of(&soft.mean)[0] - 0.2).abs() < 0.02, "{a}");
    }

    #[test]
    fn a_machine_whose_make_nobody_says_is_known_as_well_as_another() {
        let prior = stated(3000, 1000);
        let says = [(Quantity::Difference, 0.3, 0.01)];
        let of = |make: &str| {
            let make = |mut setting: Setting| {
                make.clone_into(&mut setting.make);
                setting
            };
            let mut member = member("A", "X", &prior, &says);
            member.setting = make(member.setting);
            let shop = Shop { members: vec![member] };
            let [named, not] = ["one", ""].map(|other| Setting { make: other.to_owned(), ..setting("A", "X") });
            [expected(&shop, &named, &prior, Quantity::Difference), expected(&shop, &not, &prior, Quantity::Difference)]
        };
        let [[known, sigma], adopted] = of("one");
        assert_eq!(adopted, [known, sigma]);
        let [_, [other, other_sigma]] = of("");
        assert!(
            (known - other).abs() < 1e-6 && (sigma - other_sigma).abs() < 1e-6,
            "{known} {other} {sigma} {other_sigma}"
        );
        assert!((known - 0.3).abs() < 0.02 && sigma < 0.1, "{known} {sigma}");
    }

    #[test]
    fn a_quantity_of_the_material_comes_from_other_machines_and_one_of_the_machine_does_not() {
        let prior = stated(3000, 1000);
        let says = [(Quantity::RadialRatio, 0.3, 0.02), (Quantity::Difference, 0.3, 0.01)];
        let shop = Shop { members: vec![member("A", "X", &prior, &says), member("B", "X", &prior, &says)] };
        let at = of(&prior.mean);
        let [ratio, sigma] = expected(&shop, &setting("C", "X"), &prior, Quantity::RadialRatio);
        assert!((ratio - at[3] - 0.28).abs() < 0.05 && sigma < 0.14, "{ratio} {sigma}");
        let [difference, sigma] = expected(&shop, &setting("C", "X"), &prior, Quantity::Difference);
        assert!(difference - at[1] < 0.2 && sigma > 0.2, "{difference} {sigma}");
        let [difference, sigma] = expected(&shop, &setting("A", "Y"), &prior, Quantity::Difference);
        assert!((difference - at[1] - 0.3).abs() < 0.03 && sigma < 0.15, "{difference} {sigma}");
    }
}
