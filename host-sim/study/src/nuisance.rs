//! Nuisances of shops, added to the machine of a case: what neither program nor job says and no part shows alone.
//!
//! Each is drawn from a stream of numbers of its own, so that the machine beneath, the job and the places are those of the case
//! without it, and a nuisance by itself is of the same kind as among all. By itself it has its full size; among all each is scaled by
//! a share from 0 to 1 of its own. Sizes are those that an outside machine was built with (see `docs/study.md`).
//!
//! Parts: what roughing leaves repeats, and so do drift, yielding stretch, drives and probe. The level of the stock is another for
//! every part, the force changes once, between the first part and the second.

use truepath_plant::{Drives, Machine, ProbeErrors, UnevenStock, YieldingWall};

use super::draw::Draw;

/// A nuisance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Nuisance {
    /// Waves of the stock along the contour.
    StockWave,
    /// A step in the stock.
    StockStep,
    /// More stock in inside corners.
    StockCorner,
    /// Stock that differs from part to part.
    StockLevel,
    /// Force that changes from the first part to the second.
    Wear,
    /// A stretch of the wall that yields.
    Yielding,
    /// Drift of the datum along the contour.
    Drift,
    /// Runout.
    Runout,
    /// Lobes of the probe.
    Lobing,
    /// A wild touch.
    Wild,
    /// Lag and backlash of the drives.
    Lag,
    /// A wrong cutter radius.
    Radius,
    /// All of them.
    All,
}

impl Nuisance {
    /// One at a time, in the order of the tables.
    pub const EACH: [Self; 12] = [
        Self::StockWave,
        Self::StockStep,
        Self::StockCorner,
        Self::StockLevel,
        Self::Wear,
        Self::Yielding,
        Self::Drift,
        Self::Runout,
        Self::Lobing,
        Self::Wild,
        Self::Lag,
        Self::Radius,
    ];

    /// Its name in case ids and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::StockWave => "stock-wave",
            Self::StockStep => "stock-step",
            Self::StockCorner => "stock-corner",
            Self::StockLevel => "stock-level",
            Self::Wear => "wear",
            Self::Yielding => "yielding",
            Self::Drift => "drift",
            Self::Runout => "runout",
            Self::Lobing => "lobing",
            Self::Wild => "wild",
            Self::Lag => "lag",
            Self::Radius => "radius",
            Self::All => "all",
        }
    }

    /// What it is and how large.
    pub const fn title(self) -> &'static str {
        match self {
            Self::StockWave => "stock in waves of ±25 % along the contour",
            Self::StockStep => "a step of 25 % in the stock",
            Self::StockCorner => "20 % more stock in inside corners",
            Self::StockLevel => "stock that differs by up to ±5 % from part to part",
            Self::Wear => "force +18 % from part 1 to part 2, then on",
            Self::Yielding => "a stretch of wall that yields by 20 to 30 %",
            Self::Drift => "drift of 15 µm along the contour",
            Self::Runout => "teeth up to 8 µm out of round",
            Self::Lobing => "probe with lobes of 3 µm",
            Self::Wild => "a wild touch, 0.05 to 0.5 mm off",
            Self::Lag => "drives that lag by 8 ms, backlash of 5 µm",
            Self::Radius => "cutter radius wrong by 20 µm",
            Self::All => "all of them, each with 0 to 100 % of its size",
        }
    }
}

/// The nuisances of a case.
#[derive(Clone, Debug)]
pub struct Nuisances {
    which: Nuisance,
    family: &'static str,
    seed: u64,
    length_mm: f64,
    teeth: usize,
}

impl Nuisances {
    /// Those of a seed of a family, on a contour of that length and a cutter of so many teeth.
    pub fn new(which: Nuisance, (family, seed): (&'static str, u64), length_mm: f64, teeth: usize) -> Self {
        Self { which, family, seed, length_mm, teeth }
    }

    /// The chance of a nuisance and how much of its size it has; `None` where it is not among them.
    fn of(&self, nuisance: Nuisance) -> Option<(Draw, f64)> {
        let mut draw = Draw::new(&format!("{}/nuisance/{}", self.family, nuisance.name()), self.seed);
        let share = draw.between(0.0, 1.0);
        match self.which {
            Nuisance::All => Some((draw, share)),
            which => (which == nuisance).then_some((draw, 1.0)),
        }
    }

    /// The machine while part `number` (1, 2, …) is cut and touched `touches` times.
    pub fn on(&self, machine: &Machine, number: u64, touches: usize) -> Machine {
        let probe = self.probe(number, touches);
        let mut machine = Machine { stock: self.stock(number), drives: self.drives(), probe, ..machine.clone() };
        if let Some((mut draw, share)) = self.of(Nuisance::Wear) {
            // By itself it is wear; among all it may be a new cutter.
            let sign = if self.which == Nuisance::All { draw.sign() } else { 1.0 };
            machine.force_factor = if number > 1 { 1.0 + 0.18 * share * sign } else { 1.0 };
        }
        if let Some((mut draw, share)) = self.of(Nuisance::Yielding) {
            let c = &machine.compliance_mm_per_n;
            let more = share * draw.between(0.2, 0.3);
            let from = draw.between(0.15, 0.6);
            let to = from + draw.between(0.15, 0.3);
            machine.yielding = YieldingWall {
                from_mm: from * self.length_mm,
                to_mm: to * self.length_mm,
                compliance_mm_per_n: more * 0.5 * (c[0][0] + c[1][1]),
                ..YieldingWall::default()
            };
        }
        if let Some((mut draw, share)) = self.of(Nuisance::Drift) {
            let (sin, cos) = draw.between(0.0, std::f64::consts::TAU).sin_cos();
            machine.drift_mm = [0.015 * share * cos, 0.015 * share * sin];
        }
        if let Some((mut draw, share)) = self.of(Nuisance::Runout) {
            machine.runout_mm.resize(self.teeth, 0.0);
            machine.runout_mm.iter_mut().for_each(|tooth| *tooth += share * draw.between(-0.008, 0.008));
        }
        if let Some((mut draw, share)) = self.of(Nuisance::Radius) {
            machine.radius_error_mm = 0.02 * share * draw.sign();
        }
        machine
    }

    fn stock(&self, number: u64) -> UnevenStock {
        let mut stock = UnevenStock::default();
        if let Some((mut draw, share)) = self.of(Nuisance::StockWave) {
            stock.seed = draw.seed();
            stock.waves = 0.25 * share;
            stock.wavelength_mm = draw.between(30.0, 90.0);
        }
        if let Some((mut draw, share)) = self.of(Nuisance::StockStep) {
            stock.step = 0.25 * share * draw.sign();
            stock.step_from_mm = draw.between(0.3, 0.7) * self.length_mm;
        }
        if let Some((_, share)) = self.of(Nuisance::StockCorner) {
            stock.corner = 0.2 * share;
        }
        if let Some((mut draw, share)) = self.of(Nuisance::StockLevel) {
            let level = (0..number).map(|_| draw.between(-0.05, 0.05)).last();
            stock.level = share * level.unwrap_or_default();
        }
        stock
    }

    fn drives(&self) -> Drives {
        self.of(Nuisance::Lag).map_or_else(Drives::default, |(mut draw, share)| Drives {
            time_constant_s: 0.008 * share,
            backlash_mm: [(); 2].map(|()| share * draw.between(0.002, 0.005)),
        })
    }

    fn probe(&self, number: u64, touches: usize) -> ProbeErrors {
        let mut probe = ProbeErrors { wild_one_in: touches.max(1) as u64, ..ProbeErrors::default() };
        if let Some((mut draw, share)) = self.of(Nuisance::Lobing) {
            probe.lobing_mm = 0.003 * share;
            probe.lobing_deg = draw.between(0.0, 120.0);
        }
        if let Some((mut draw, _)) = self.of(Nuisance::Wild) {
            // One in three of several parts; by itself the first one.
            for part in 1..=number {
                let here = draw.chance(1.0 / 3.0) || self.which == Nuisance::Wild && part == 1;
                let off = draw.sign() * draw.scale(0.05, 0.5);
                probe.wild_mm = if here { off } else { 0.0 };
            }
        }
        probe
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(which: Nuisance, seed: u64, number: u64) -> Machine {
        Nuisances::new(which, ("bore", seed), 200.0, 4).on(&Machine::rigid(), number, 15)
    }

    #[test]
    fn a_nuisance_by_itself_changes_only_its_own_and_is_of_the_same_kind_among_all() {
        let all = on(Nuisance::All, 1001, 2);
        let step = on(Nuisance::StockStep, 1001, 2);
        assert!((step.stock.step.abs() - 0.25).abs() < 1e-12 && all.stock.step.abs() < 0.25);
        assert_eq!(step.stock.step_from_mm.to_bits(), all.stock.step_from_mm.to_bits());
        assert_eq!(step.stock.step.signum(), all.stock.step.signum());
        let probe = ProbeErrors { wild_one_in: 15, ..ProbeErrors::default() };
        assert_eq!(step, Machine { stock: step.stock, probe, ..Machine::rigid() });
    }

    #[test]
    fn roughing_repeats_while_level_and_force_change_with_the_part() {
        for seed in 1001..1011 {
            let [one, two, three] = [1, 2, 3].map(|number| on(Nuisance::All, seed, number));
            assert_eq!(one.stock.waves.to_bits(), two.stock.waves.to_bits());
            assert_eq!((one.stock.seed, one.drift_mm, one.yielding), (two.stock.seed, two.drift_mm, two.yielding));
            assert!(one.stock.level != two.stock.level && two.stock.level != three.stock.level);
            assert_eq!(one.force_factor, 1.0);
            assert!(two.force_factor != 1.0 && two.force_factor.to_bits() == three.force_factor.to_bits());
        }
        assert!((on(Nuisance::Wear, 7001, 2).force_factor - 1.18).abs() < 1e-12);
    }

    #[test]
    fn one_part_in_three_has_a_wild_touch() {
        let wild = (100_000..100_600).filter(|seed| on(Nuisance::All, *seed, 1).probe.wild_mm != 0.0).count();
        assert!((150..250).contains(&wild), "{wild} of 600");
        assert!((7001..7101).all(|seed| on(Nuisance::Wild, seed, 1).probe.wild_mm != 0.0));
    }
}
