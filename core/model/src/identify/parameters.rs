//! What is identified, and what is believed about it beforehand.

use crate::cut::{Coefficients, Compliance, ForceTable, Loop, Path, WallLaw};
use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real, exp2, log2};

/// Number of parameters.
pub const COUNT: usize = 11;

/// The parameters, in the order of the fit. The last two are the components of one vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Mean compliance of x and y (with the tangential coefficient at its prior).
    Compliance,
    /// Half the difference of the compliances along x and y.
    ComplianceDifference,
    /// Cross compliance.
    ComplianceCross,
    /// Radial over tangential chip coefficient.
    RadialRatio,
    /// Level of both edge coefficients over what was stated: wear raises them together.
    EdgeLevel,
    /// Radial over tangential edge coefficient.
    EdgeRatio,
    /// Bending of the cutter over the engaged depth.
    Bend,
    /// Size exponent of the chip.
    SizeExponent,
    /// How much smaller than stated the cutter is: worn, measured wrong, or larger by its runout.
    Undersize,
    /// Shift of the datum along x between cut and probe.
    DatumX,
    /// Shift of the datum along y between cut and probe.
    DatumY,
}

impl Parameter {
    /// All, in the order of the fit.
    pub const ALL: [Self; COUNT] = [
        Self::Compliance,
        Self::ComplianceDifference,
        Self::ComplianceCross,
        Self::RadialRatio,
        Self::EdgeLevel,
        Self::EdgeRatio,
        Self::Bend,
        Self::SizeExponent,
        Self::Undersize,
        Self::DatumX,
        Self::DatumY,
    ];

    /// Its name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Compliance => "compliance",
            Self::ComplianceDifference => "compliance_difference",
            Self::ComplianceCross => "compliance_cross",
            Self::RadialRatio => "radial_ratio",
            Self::EdgeLevel => "edge_level",
            Self::EdgeRatio => "edge_ratio",
            Self::Bend => "bend",
            Self::SizeExponent => "size_exponent",
            Self::Undersize => "undersize",
            Self::DatumX => "datum_x",
            Self::DatumY => "datum_y",
        }
    }

    /// Whether it is positive and believed in by factors.
    pub const fn is_factor(self) -> bool {
        matches!(self, Self::Compliance | Self::RadialRatio | Self::EdgeLevel | Self::EdgeRatio)
    }

    /// The unit of its value in reports.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Compliance | Self::ComplianceDifference | Self::ComplianceCross => "um/N",
            Self::RadialRatio | Self::EdgeLevel | Self::EdgeRatio | Self::Bend | Self::SizeExponent => "1",
            Self::Undersize | Self::DatumX | Self::DatumY => "mm",
        }
    }
}

/// A complete set of parameters of machine, cutter and material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameters {
    /// Force coefficients.
    pub coefficients: Coefficients,
    /// Compliance with bending.
    pub compliance: Compliance,
    /// Level of the edge coefficients over those stated (already contained in `coefficients`).
    pub edge_level: Real,
    /// Their ratio, radial over tangential (already contained in `coefficients`).
    pub edge_ratio: Real,
    /// How much farther out than stated the cutter leaves the wall: smaller than stated, or larger (negative) by its runout.
    pub undersize: Offset,
    /// Shift of the probed frame against the cut one.
    pub datum: Vector,
}

/// What is believed before probing: values, and one standard deviation of each.
///
/// Quantities that are positive are believed in by factors: their logarithm is Gaussian, so that half and twice as stiff
/// are equally likely. Difference and cross term of the compliance go with its mean, which they are a share of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Prior {
    /// Expected parameters.
    pub mean: Parameters,
    /// Standard deviations: of the natural logarithm for compliance, radial ratio, edge level and edge ratio, as a share
    /// of the compliance for difference and cross term, in the unit of the value for the others. 0 holds a parameter.
    pub sigma: [Real; COUNT],
}

/// What is known of a ratio of two coefficients of whatever metal: its median, and one standard deviation of its logarithm.
struct Population {
    median: Real,
    spread: Real,
}

/// Radial over tangential chip coefficient: 0.15…0.6 in nearly all published tables (A12 ch. 2; steels, aluminium, titanium).
const RADIAL_RATIO: Population = Population { median: Real::ratio(32, 100), spread: Real::ratio(35, 100) };
/// Radial over tangential edge coefficient: 0.5…2.5; the same sources.
const EDGE_RATIO: Population = Population { median: Real::ratio(115, 100), spread: Real::ratio(40, 100) };
/// One standard deviation of the logarithm of a ratio of two coefficients as a user or a table states them: each of them
/// ±30 % (coefficients of one nominal alloy spread twofold).
const STATED: Real = Real::ratio(40, 100);
/// 1/ln 2
const FRAC_1_LN_2: Real = Real::ratio(1_442_695_041, 1_000_000_000);

/// What a cutter is smaller or, by its runout, larger than stated, µm: the scale of a distribution with long tails.
const UNDERSIZE_UM: i64 = 2;

impl Population {
    /// The stated ratio and the population, each by its weight: the expected ratio and the spread of its logarithm.
    fn joined(&self, stated: Real) -> (Real, Real) {
        if stated <= Real::ZERO {
            return (self.median, self.spread);
        }
        let weigh = |spread: Real| Real::ONE / (spread * spread);
        let (of_stated, of_all) = (weigh(STATED), weigh(self.spread));
        let sum = of_stated + of_all;
        let logarithm = Real::dot(log2(stated), of_stated / sum, log2(self.median), of_all / sum);
        (exp2(logarithm), (Real::ONE / sum).sqrt())
    }
}

/// Two independent deviations together.
fn joined(a: Real, b: Real) -> Real {
    Real::dot(a, a, b, b).sqrt()
}

/// e to the power `x`.
fn exp(x: Real) -> Real {
    exp2(x * FRAC_1_LN_2)
}

impl Prior {
    /// A prior of usual width around what the user stated.
    ///
    /// Widths: a stiffness is rarely known to better than a factor of 1.6, x differs from y by a third; a cross
    /// compliance is a tenth of the direct one or, on a few machines, much more (long tails, as for the undersize). The
    /// two ratios of coefficients are what was stated joined with what metals have in common; the level of the edge
    /// coefficients is known to a factor of 1.6. Size exponent 0.15 ± 0.1 (Kienzle exponents of steels and aluminium);
    /// bending 0.12 ± 0.1. The mean law of P23 is linear in the chip, knows no height and describes the machine by two
    /// stiffnesses: it has neither size exponent nor bending and hardly a cross term.
    pub fn around(coefficients: Coefficients, compliance: Compliance, law: WallLaw) -> Self {
        let helical = law == WallLaw::Helical;
        let or_zero = |v: Real| if helical { v } else { Real::ZERO };
        let percent = |v: i64| Real::ratio(v, 100);
        let size_exponent = or_zero(percent(15));
        let bend = or_zero(compliance.bend.max(percent(12)));
        let (radial_ratio, radial_spread) = RADIAL_RATIO.joined(coefficients.krc / coefficients.ktc);
        let has_level = coefficients.kte != Real::ZERO || coefficients.kre != Real::ZERO;
        // A ratio to nothing is not a ratio: then the level alone is found.
        let has_ratio = coefficients.kte != Real::ZERO && coefficients.kre != Real::ZERO;
        let (edge_ratio, edge_spread) =
            if has_ratio { EDGE_RATIO.joined(coefficients.kre / coefficients.kte) } else { (Real::ONE, Real::ZERO) };
        let kre = if has_ratio { coefficients.kte * edge_ratio } else { coefficients.kre };
        let mean = Parameters {
            coefficients: Coefficients { krc: coefficients.ktc * radial_ratio, kre, size_exponent, ..coefficients },
            compliance: Compliance { bend, ..compliance },
            edge_level: Real::ONE,
            edge_ratio,
            undersize: Offset::ZERO,
            datum: Vector::ZERO,
        };
        let sigma = [
            percent(50),
            percent(35),
            percent(if helical { 8 } else { 2 }),
            radial_spread,
            if has_level { percent(50) } else { Real::ZERO },
            edge_spread,
            or_zero(percent(10)),
            or_zero(percent(10)),
            Real::ratio(UNDERSIZE_UM, 1000),
            Real::ratio(15, 10_000),
            Real::ratio(15, 10_000),
        ];
        Self { mean, sigma }
    }

    /// The same when the coefficients are those of no known material: their level is known to a factor of 1.7 (tangential
    /// 600 N/mm² of aluminium to 2,200 of steel are two standard deviations about their middle), and their ratios are what
    /// metals have in common.
    #[must_use]
    pub fn without_material(mut self) -> Self {
        let [level, _, _, radial, edge_level, edge_ratio, ..] = &mut self.sigma;
        *level = joined(*level, Real::ratio(53, 100));
        *radial = (*radial).max(RADIAL_RATIO.spread);
        if *edge_level != Real::ZERO {
            *edge_level = Real::ratio(70, 100);
        }
        if *edge_ratio != Real::ZERO {
            *edge_ratio = (*edge_ratio).max(EDGE_RATIO.spread);
        }
        self
    }

    /// The same when nothing is known of the machine: its stiffness at the cutter is known to a factor of 2.5 (routers
    /// 1,000 N/mm, heavy machining centres 20,000).
    #[must_use]
    pub fn without_machine(mut self) -> Self {
        let [level, ..] = &mut self.sigma;
        *level = joined(*level, Real::ratio(75, 100));
        self
    }

    /// One standard deviation in the unit of [`Parameters::values`], about some parameters.
    pub fn deviations(&self, about: &Parameters) -> [Real; COUNT] {
        let mut deviations = self.sigma;
        let values = about.values();
        for ((deviation, parameter), value) in deviations.iter_mut().zip(Parameter::ALL).zip(values) {
            match parameter {
                Parameter::ComplianceDifference | Parameter::ComplianceCross => {
                    *deviation = *deviation * about.compliance.mean;
                }
                _ if parameter.is_factor() => *deviation = *deviation * value,
                _ => {}
            }
        }
        deviations
    }

    /// Expected values in the order of the fit.
    pub fn value(&self) -> [Real; COUNT] {
        self.mean.values()
    }

    /// The parameters at `theta` standard deviations from the expected values, kept physical.
    pub fn at(&self, theta: &[Real; COUNT]) -> Parameters {
        let mut moved = *theta;
        for ((t, s), parameter) in moved.iter_mut().zip(&self.sigma).zip(Parameter::ALL) {
            *t = *t * *s;
            if parameter.is_factor() {
                // No quantity is a thousandfold of what was believed; the fit may ask for it on its way.
                *t = exp((*t).max(-FURTHEST).min(FURTHEST));
            }
        }
        let [mean, difference, cross, radial, level, ratio, bend, size, radius, dx, dy] = moved;
        let (k, c) = (&self.mean.coefficients, &self.mean.compliance);
        let mean = c.mean * mean;
        let largest_exponent = Real::HALF;
        Parameters {
            coefficients: Coefficients {
                ktc: k.ktc,
                krc: k.krc * radial,
                kte: k.kte * level,
                kre: k.kre * level * ratio,
                size_exponent: (k.size_exponent + size).max(Real::ZERO).min(largest_exponent),
            },
            edge_level: self.mean.edge_level * level,
            edge_ratio: self.mean.edge_ratio * ratio,
            compliance: positive(
                mean,
                mean * (c.difference / c.mean + difference),
                mean * (c.cross / c.mean + cross),
                (c.bend + bend).max(-Real::HALF),
            ),
            undersize: self.mean.undersize + Offset::from_mm(radius),
            datum: Vector { x: Offset::from_mm(dx), y: Offset::from_mm(dy) },
        }
    }
}

/// The natural logarithm of the farthest factor from what was believed.
const FURTHEST: Real = Real::from_int(5);

/// A compliance that yields to every force: |difference| and cross term below 95 % of what would make it rigid or
/// negative in some direction.
fn positive(mean: Real, difference: Real, cross: Real, bend: Real) -> Compliance {
    let within = |v: Real, room: Real| v.max(-room).min(room);
    let share = Real::ratio(95, 100);
    let difference = within(difference, mean * share);
    let room = Real::dot(mean, mean, -difference, difference).sqrt() * share;
    Compliance { mean, difference, cross: within(cross, room), bend }
}

impl Parameters {
    /// The machine of these parameters at work on a path. The table is that of their size exponent.
    pub const fn machine<'a>(&self, path: &'a Path<'a>, table: &'a ForceTable) -> Loop<'a> {
        let Self { coefficients, compliance, undersize, .. } = *self;
        Loop { path, table, coefficients, compliance, undersize }
    }

    /// The same where every force is larger by a factor, given by its natural logarithm: the compliance carries the scale of both.
    #[must_use]
    pub fn with_force(mut self, level: Real) -> Self {
        if level != Real::ZERO {
            let factor = exp(level.max(-FURTHEST).min(FURTHEST));
            let Compliance { mean, difference, cross, bend } = self.compliance;
            self.compliance =
                Compliance { mean: mean * factor, difference: difference * factor, cross: cross * factor, bend };
        }
        self
    }

    /// Values in the order of the fit; units by [`Parameter::unit`].
    pub fn values(&self) -> [Real; COUNT] {
        let (k, c) = (&self.coefficients, &self.compliance);
        [
            c.mean,
            c.difference,
            c.cross,
            k.krc / k.ktc,
            self.edge_level,
            self.edge_ratio,
            c.bend,
            k.size_exponent,
            self.undersize.mm(),
            self.datum.x.mm(),
            self.datum.y.mm(),
        ]
    }
}
