//! Where a fit began that did not begin at its job's statement, to be begun there again.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use truepath_core::cut::Compliance;
use truepath_core::identify::Prior;
use truepath_core::units::{Offset, Real};

use super::quantities::{QUANTITIES, Quantity, Raw, of, sigmas};

/// What was believed of machine, cutter and material in place of what the job states, to the last bit: the store that said so changes
/// with every part, and a correction has to come out again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Belief {
    /// Mean, difference and cross compliance (µm/N), radial chip coefficient (N/mm²), tangential edge coefficient (N/mm), ratio of the edge
    /// coefficients, bending and size exponent in 2⁻³²; undersize, nm.
    values: [i64; QUANTITIES],
    /// One standard deviation of the first parameters of a fit in their order, as its prior has them, in 2⁻³²; 0 for one that is held.
    sigma: [i64; QUANTITIES],
}

impl From<&Prior> for Belief {
    fn from(prior: &Prior) -> Self {
        let Raw { compliance: c, krc, kte, edge_ratio, size_exponent, undersize } = Raw::of(&prior.mean);
        let [mean, difference, cross, krc, kte, edge_ratio, bend, exponent] =
            [c.mean, c.difference, c.cross, krc, kte, edge_ratio, c.bend, size_exponent].map(Real::bits);
        let values = [mean, difference, cross, krc, kte, edge_ratio, bend, exponent, undersize.nm()];
        Self { values, sigma: std::array::from_fn(|k| prior.sigma[k].bits()) }
    }
}

impl Belief {
    /// The prior of a job that states another; `None` for what no shop says of it: a file may be damaged or written by another hand.
    pub fn prior(&self, stated: &Prior) -> Option<Prior> {
        let [mean, difference, cross, krc, kte, edge_ratio, bend, size_exponent, undersize_nm] = self.values;
        let [mean, difference, cross, bend] = [mean, difference, cross, bend].map(Real::from_bits);
        let [krc, kte, edge_ratio, size_exponent] = [krc, kte, edge_ratio, size_exponent].map(Real::from_bits);
        let compliance = Compliance { mean, difference, cross, bend };
        let undersize = Offset::from_nm(undersize_nm);
        if [mean, krc, edge_ratio].into_iter().any(|v| v <= Real::ZERO) || kte < Real::ZERO {
            return None;
        }
        let raw = Raw { compliance, krc, kte, edge_ratio, size_exponent, undersize };
        let mut prior = Prior { mean: raw.put_in(&stated.mean), ..*stated };
        prior.sigma.iter_mut().zip(self.sigma).for_each(|(sigma, bits)| *sigma = Real::from_bits(bits));
        let (found, expected, sigma) = (of(&prior.mean), of(&stated.mean), sigmas(stated));
        let is_said = |quantity: Quantity| {
            let k = quantity as usize;
            let [sure, stated] = [prior.sigma[k], stated.sigma[k]];
            let is_held = stated == Real::ZERO;
            let is_sure = if is_held { sure == stated } else { sure > Real::ZERO && sure < WIDEST };
            is_sure && (found[k] - expected[k]).abs() <= quantity.farthest(sigma[k])
        };
        Quantity::ALL.into_iter().all(is_said).then_some(prior)
    }
}

/// No shop makes anybody less sure than a factor of e⁵.
const WIDEST: Real = Real::from_int(5);

#[cfg(test)]
mod tests {
    use truepath_core::cut::{Coefficients, WallLaw};

    use super::super::quantities::narrowed;
    use super::*;

    fn stated() -> Prior {
        let [ktc, krc, kte, kre] = [800, 240, 12, 14].map(Real::from_int);
        let coefficients = Coefficients { ktc, krc, kte, kre, size_exponent: Real::ZERO };
        let stiffness = Real::from_int(3000);
        Prior::around(coefficients, Compliance::from_stiffness(stiffness, stiffness), WallLaw::Helical)
    }

    /// Every quantity elsewhere, and surer.
    fn elsewhere() -> Prior {
        let (mean, sigma) = (of(&stated().mean), sigmas(&stated()));
        narrowed(
            &stated(),
            &std::array::from_fn(|k| Some([mean[k] + 0.3 * sigma[k], (0.5 + 0.03 * k as f64) * sigma[k]])),
        )
    }

    #[test]
    fn a_belief_comes_back_to_the_last_bit() {
        let prior = elsewhere();
        let written = serde_json::to_string(&Belief::from(&prior)).unwrap();
        let read: Belief = serde_json::from_str(&written).unwrap();
        assert_eq!(read.prior(&stated()), Some(prior));
        assert_eq!(Belief::from(&stated()).prior(&stated()), Some(stated()));
    }

    #[test]
    fn what_no_shop_says_is_not_begun_at() {
        let good = Belief::from(&elsewhere());
        let changed = |of: &[i64; QUANTITIES], at: usize, to: i64| {
            let mut changed = *of;
            changed[at] = to;
            changed
        };
        for at in 0..QUANTITIES {
            for to in [i64::MIN, -1 << 40, i64::MAX] {
                let belief = Belief { values: changed(&good.values, at, to), ..good };
                assert_eq!(belief.prior(&stated()), None, "value {at}: {to}");
            }
            for to in [i64::MIN, -1, 0, i64::MAX] {
                let belief = Belief { sigma: changed(&good.sigma, at, to), ..good };
                assert_eq!(belief.prior(&stated()), None, "sigma {at}: {to}");
            }
        }
    }
}
