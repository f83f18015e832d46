//! What is identified, and what is believed about it beforehand.

use crate::cut::{Coefficients, Compliance, WallLaw};
use crate::geometry::Vector;
use crate::units::{Offset, Real};

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
    /// Radial over tangential edge coefficient, over what was stated.
    EdgeRatio,
    /// Bending of the cutter over the engaged depth.
    Bend,
    /// Size exponent of the chip.
    SizeExponent,
    /// Cutter or ball radius: a constant offset of every point.
    Radius,
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
        Self::Radius,
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
            Self::Radius => "radius_offset",
            Self::DatumX => "datum_x",
            Self::DatumY => "datum_y",
        }
    }

    /// The unit of its value in reports.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Compliance | Self::ComplianceDifference | Self::ComplianceCross => "um/N",
            Self::RadialRatio | Self::EdgeLevel | Self::EdgeRatio | Self::Bend | Self::SizeExponent => "1",
            Self::Radius | Self::DatumX | Self::DatumY => "mm",
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
    /// Their ratio, radial over tangential, over that stated (already contained in `coefficients`).
    pub edge_ratio: Real,
    /// Constant offset of the probed wall towards material left: cutter smaller or ball larger than stated.
    pub radius: Offset,
    /// Shift of the probed frame against the cut one.
    pub datum: Vector,
}

/// What is believed before probing: values, and one standard deviation of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Prior {
    /// Expected parameters.
    pub mean: Parameters,
    /// Standard deviations in the unit of [`Prior::value`]; 0 holds a parameter. Those of difference and cross compliance
    /// hold for the expected mean compliance and grow with it.
    pub sigma: [Real; COUNT],
}

impl Prior {
    /// A prior of usual width around what the user stated.
    ///
    /// Widths: a stiffness is rarely known to better than a factor of two and x may differ from y by as much; cross
    /// compliance is a tenth of the direct one; radial ratio ±40 %; edge coefficients ±60 % together (coefficients of
    /// one nominal alloy spread twofold) and ±25 % against each other; size exponent 0.15 ± 0.12 (Kienzle exponents
    /// of steels and aluminium); bending 0.1 ± 0.12. The mean law of P23 is linear in the chip, knows no height and
    /// describes the machine by two stiffnesses: it has neither size exponent nor bending and hardly a cross term.
    pub fn around(coefficients: Coefficients, compliance: Compliance, law: WallLaw) -> Self {
        let helical = law == WallLaw::Helical;
        let or_zero = |v: Real| if helical { v } else { Real::ZERO };
        let percent = |v: i64| Real::ratio(v, 100);
        let size_exponent = or_zero(percent(15));
        let bend = or_zero(compliance.bend.max(percent(10)));
        let mean = Parameters {
            coefficients: Coefficients { size_exponent, ..coefficients },
            compliance: Compliance { bend, ..compliance },
            edge_level: Real::ONE,
            edge_ratio: Real::ONE,
            radius: Offset::ZERO,
            datum: Vector::ZERO,
        };
        let has_edge = coefficients.kte != Real::ZERO || coefficients.kre != Real::ZERO;
        let edge = |v: Real| if has_edge { v } else { Real::ZERO };
        let scale = compliance.mean;
        let sigma = [
            scale * percent(50),
            scale * percent(50),
            scale * percent(if helical { 10 } else { 2 }),
            coefficients.krc / coefficients.ktc * percent(40),
            edge(percent(60)),
            edge(percent(25)),
            or_zero(percent(12)),
            or_zero(percent(12)),
            Real::ratio(2, 1000),
            Real::ratio(15, 10_000),
            Real::ratio(15, 10_000),
        ];
        Self { mean, sigma }
    }

    /// Expected values in the order of the fit.
    pub fn value(&self) -> [Real; COUNT] {
        self.mean.values()
    }

    /// The parameters at `theta` standard deviations from the expected values, kept physical.
    pub fn at(&self, theta: &[Real; COUNT]) -> Parameters {
        let mut values = self.value();
        for ((v, t), s) in values.iter_mut().zip(theta).zip(&self.sigma) {
            *v += *t * *s;
        }
        let [mean, difference, cross, ratio, level, edge_ratio, bend, size, radius, dx, dy] = values;
        let stated = self.mean.coefficients;
        let expected = self.mean.compliance.mean;
        let mean = mean.max(expected * Real::ratio(1, 50));
        // A machine twice as soft is taken to be so in every direction.
        let share = mean / expected;
        let (difference, cross) = (difference * share, cross * share);
        let largest_exponent = Real::HALF;
        let (edge_level, edge_ratio) = (level.max(Real::ZERO), edge_ratio.max(Real::ZERO));
        Parameters {
            coefficients: Coefficients {
                ktc: stated.ktc,
                krc: (ratio * stated.ktc).max(Real::ZERO),
                kte: stated.kte * edge_level,
                kre: stated.kre * edge_level * edge_ratio,
                size_exponent: size.max(Real::ZERO).min(largest_exponent),
            },
            edge_level,
            edge_ratio,
            compliance: positive(mean, difference, cross, bend.max(-Real::HALF)),
            radius: Offset::from_mm(radius),
            datum: Vector { x: Offset::from_mm(dx), y: Offset::from_mm(dy) },
        }
    }
}

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
            self.radius.mm(),
            self.datum.x.mm(),
            self.datum.y.mm(),
        ]
    }
}
