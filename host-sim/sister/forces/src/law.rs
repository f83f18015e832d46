//! How the force of an edge grows with its chip: the laws a fit chooses among.
//!
//! Linear with an edge force (Altintas, ch. 2), a power of the chip (Kienzle), both together, and a force that saturates, as
//! the radial one does in records of aluminium: it is made at the nose and the flank of the edge, not ahead of it.

use crate::cut::Term;

/// The law of one direction, tangential or radial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// `K·h`: all that one feed can tell.
    Chip,
    /// `K·h + Ke`.
    Edge,
    /// `K·h·(h/0.05)^(−m)`.
    Power,
    /// `K·h₀(1 − exp(−h/h₀))`.
    Saturating,
    /// `K·h·(h/0.05)^(−m) + Ke`.
    EdgePower,
}

/// Laws among which the evidence decides.
pub const LAWS: [Law; 4] = [Law::Edge, Law::Power, Law::Saturating, Law::EdgePower];

impl Law {
    /// Coefficients and, if there is one, the shape behind them.
    pub const fn unknowns(self) -> usize {
        match self {
            Self::Chip => 1,
            Self::Edge | Self::Power | Self::Saturating => 2,
            Self::EdgePower => 3,
        }
    }

    /// Name of every unknown, its unit, a typical size and its range.
    pub const fn of_unknown(self, k: usize) -> (&'static str, &'static str, f64, [f64; 2]) {
        const COEFFICIENT: (&str, &str, f64, [f64; 2]) = ("K", "N/mm²", 500.0, [-1e5, 1e5]);
        const EDGE: (&str, &str, f64, [f64; 2]) = ("Ke", "N/mm", 20.0, [-1e4, 1e4]);
        const EXPONENT: (&str, &str, f64, [f64; 2]) = ("m", "", 0.3, [-0.5, 0.95]);
        const CHIP: (&str, &str, f64, [f64; 2]) = ("h0", "mm", 0.05, [0.002, 2.0]);
        match (self, k) {
            (_, 0) => COEFFICIENT,
            (Self::Power, _) => EXPONENT,
            (Self::Saturating, _) => CHIP,
            (_, 1) => EDGE,
            _ => EXPONENT,
        }
    }

    /// What handbooks let expect of an unknown of direction 0 (tangential) or 1 (radial), with its standard deviation: edge
    /// forces of 5…35 N/mm; exponents of Kienzle of 0.25 for the cutting force of nearly all metals, larger ones for the
    /// radial force; a radial force that saturates within the radius of an edge, some hundredths of a millimetre.
    pub const fn expected(self, k: usize, direction: usize) -> [f64; 2] {
        match (self, k, direction) {
            (_, 0, _) => [800.0, 800.0],
            (Self::Saturating, _, _) => [0.05, 0.04],
            (Self::Power, _, 0) | (Self::EdgePower, 2, 0) => [0.25, 0.1],
            (Self::Power, _, _) | (Self::EdgePower, 2, _) => [0.4, 0.2],
            _ => [18.0, 12.0],
        }
    }

    /// The terms of the force with their coefficients.
    pub fn terms(self, unknowns: &[f64]) -> [(Term, f64); 2] {
        let nothing = (Term::Edge, 0.0);
        match (self, unknowns) {
            (Self::Edge, &[k, e]) => [(Term::Chip, k), (Term::Edge, e)],
            (Self::Power, &[k, m]) => [(Term::Power(m), k), nothing],
            (Self::Saturating, &[k, h0]) => [(Term::Saturating(h0), k), nothing],
            (Self::EdgePower, &[k, e, m]) => [(Term::Power(m), k), (Term::Edge, e)],
            (_, [k, ..]) => [(Term::Chip, *k), nothing],
            (_, []) => [nothing; 2],
        }
    }

    /// Force per unit depth at a chip of `h` mm, N/mm.
    pub fn at(self, unknowns: &[f64], h: f64) -> f64 {
        self.terms(unknowns).into_iter().map(|(term, by)| by * term.at(h)).sum()
    }

    /// Places of the shape where a search begins.
    pub(crate) const fn shapes(self) -> &'static [f64] {
        match self {
            Self::Chip | Self::Edge => &[0.0],
            Self::Power | Self::EdgePower => &[0.3],
            Self::Saturating => &[0.03, 0.2],
        }
    }

    /// The size exponent m; 0 for a law without one.
    pub fn exponent(self, unknowns: &[f64]) -> f64 {
        match (self, unknowns) {
            (Self::Power, &[_, m]) | (Self::EdgePower, &[_, _, m]) => m,
            _ => 0.0,
        }
    }

    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Chip => "chip alone",
            Self::Edge => "linear with edge",
            Self::Power => "power of the chip",
            Self::Saturating => "saturating",
            Self::EdgePower => "power of the chip with edge",
        }
    }
}
