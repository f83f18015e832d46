//! The prior: what the user states of machine and material in the job, wrong as in life.
//!
//! Every coefficient is off by a log-normal factor of its own (about ±30 %), the stiffness by up to 2 and equal in x and y;
//! nobody knows cross compliance, bending, the size exponent or the runout. The factors are kept as logarithms, so that
//! the study can make them larger or smaller.

use truepath_plant::Machine;

use super::draw::Draw;
use super::machine::Width;

/// Logarithms of the factors between prior and truth.
#[derive(Clone, Copy, Debug)]
pub struct Mistakes {
    coefficients: [f64; 4],
    stiffness: f64,
}

/// The numbers of the job.
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    /// ktc, krc in N/mm², kte, kre in N/mm.
    pub coefficients: [f64; 4],
    /// Stiffness in x and in y, N/mm.
    pub stiffness_n_per_mm: f64,
}

impl Mistakes {
    /// Mistakes of one user.
    pub fn draw(draw: &mut Draw, width: Width) -> Self {
        let (coefficient, stiffness) = if width == Width::Wild { (0.4, 0.5) } else { (0.26, 0.35) };
        Self {
            coefficients: [(); 4].map(|()| draw.normal(coefficient)),
            stiffness: draw.normal(stiffness).clamp(-2f64.ln(), 2f64.ln()),
        }
    }

    /// What that user states of a machine; `times` scales the mistakes, 0 for none.
    pub fn about(&self, machine: &Machine, times: f64) -> Prior {
        let truth = [machine.ktc_n_per_mm2, machine.krc_n_per_mm2, machine.kte_n_per_mm, machine.kre_n_per_mm];
        let c = &machine.compliance_mm_per_n;
        let stiffness = 2.0 / (c[0][0] + c[1][1]);
        let mut coefficients = truth;
        for (value, mistake) in coefficients.iter_mut().zip(self.coefficients) {
            *value = figures(*value * (mistake * times).exp());
        }
        Prior { coefficients, stiffness_n_per_mm: figures(stiffness * (self.stiffness * times).exp()) }
    }
}

/// Three figures, as people write numbers down.
fn figures(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let step = 10f64.powf(value.abs().log10().floor() - 2.0);
    super::draw::rounded(value, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_mistakes_the_belief_is_the_truth_to_three_figures() {
        let machine = Machine {
            ktc_n_per_mm2: 1234.5,
            kte_n_per_mm: 12.345,
            compliance_mm_per_n: Machine::compliance_of_stiffness(1000.0, 1000.0),
            ..Machine::rigid()
        };
        let mistakes = Mistakes::draw(&mut Draw::new("belief", 1), Width::Usual);
        let prior = mistakes.about(&machine, 0.0);
        assert!((prior.coefficients[0] - 1230.0).abs() < 1e-9);
        assert!((prior.coefficients[2] - 12.3).abs() < 1e-9);
        assert!((prior.stiffness_n_per_mm - 1000.0).abs() < 1e-9);
        assert!((mistakes.about(&machine, 3.0).coefficients[0] / 1234.5).ln().abs() < 3.0 * 0.53);
    }
}
