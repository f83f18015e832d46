//! What the points of one job say, whatever was believed before.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use truepath_core::cut::WallLaw;
use truepath_core::identify::{Prior, prior_weights};
use truepath_core::job;
use truepath_ground::cholesky::Cholesky;
use truepath_ground::units::float;

use super::quantities::{QUANTITIES, Quantities, of, sigmas};

/// A square matrix of the quantities.
pub(super) type Square = [Quantities; QUANTITIES];

/// What the points of a job say of the quantities: a Gaussian whose information matrix need not have full rank, as points may say
/// nothing of some of them. Values are in the order of [`super::Quantity::ALL`] and in their units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Said {
    /// What the job states.
    pub stated: Quantities,
    /// ln of the tangential chip coefficient that it states, N/mm²: the material's share of the yield.
    pub stated_ln_ktc: f64,
    /// One standard deviation of what it states; 0 for what is held, of which the points say nothing.
    pub sigma: Quantities,
    /// The inverse of the covariance.
    pub information: Square,
    /// The information matrix times the difference between what the points say and what the job states.
    pub pull: Quantities,
}

/// Largest standard deviation that a job states of any quantity is far below this, and so is what it states of the quantities themselves
/// (the largest is the logarithm of mm/N times N/mm²).
const LARGEST: f64 = 30.0;

/// What was written before the size of cutters was among the quantities says nothing of it.
fn completed(mut written: Value) -> Value {
    let without_size = QUANTITIES - 1;
    let complete = |list: &mut Value, nothing: Value| {
        if let Some(list) = list.as_array_mut().filter(|list| list.len() == without_size) {
            list.push(nothing);
        }
    };
    for name in ["stated", "sigma", "pull", "information"] {
        let Some(list) = written.get_mut(name) else { continue };
        if name == "information" {
            list.as_array_mut().into_iter().flatten().for_each(|row| complete(row, Value::from(0.0)));
            complete(list, Value::from(vec![0.0; QUANTITIES]));
        } else {
            complete(list, Value::from(0.0));
        }
    }
    written
}

impl Said {
    /// Reads what a summary or a store holds, of this version of the program or an earlier one.
    ///
    /// # Errors
    /// What is no such thing, to be put behind "what the points say".
    pub fn read(written: Value) -> Result<Self, String> {
        let said: Self = serde_json::from_value(completed(written)).map_err(|e| format!("cannot be read: {e}"))?;
        said.check().map(|()| said).map_err(str::to_owned)
    }

    /// Whether it can be what points say: what is read may be damaged or written by another hand, and a prior is made of it.
    fn check(&self) -> Result<(), &'static str> {
        let Self { stated, stated_ln_ktc, sigma, information, pull } = self;
        let within = |values: &[f64], least: f64, largest: f64| values.iter().all(|v| (least..=largest).contains(v));
        if !within(stated, -LARGEST, LARGEST) || !within(&[*stated_ln_ktc], -LARGEST, LARGEST) {
            return Err("states what no job can");
        }
        if !within(sigma, 0.0, LARGEST) {
            return Err("has a standard deviation that no job states");
        }
        // Points that are a thousand million times as sure as the statement are none.
        let surest = 1e9;
        let scaled = |i: usize, j: usize| information[i][j] * sigma[i] * sigma[j];
        let free: Vec<usize> = (0..QUANTITIES).filter(|k| sigma[*k] > 0.0).collect();
        let are_sane = |i: usize| {
            free.iter()
                .all(|j| scaled(i, *j).abs() <= surest && (scaled(i, *j) - scaled(*j, i)).abs() <= 1e-6 * surest.sqrt())
                && (pull[i] * sigma[i]).abs() <= surest
        };
        let is_held = |k: &usize| information[*k].iter().all(|v| *v == 0.0) && pull[*k] == 0.0;
        if !free.iter().all(|k| are_sane(*k)) || !(0..QUANTITIES).filter(|k| sigma[*k] == 0.0).all(|k| is_held(&k)) {
            return Err("is no information matrix");
        }
        // With the statement they make a Gaussian; alone they may say nothing of some quantities.
        let posterior: Vec<Vec<f64>> = free
            .iter()
            .map(|i| free.iter().map(|j| scaled(*i, *j) + if i == j { 1.01 } else { 0.0 }).collect())
            .collect();
        Cholesky::new(&posterior).map(|_| ()).ok_or("has a variance below zero")
    }

    /// Of a fit that began at `identified.prior`, in a job that states another or the same. `None` under the mean law, whose parameters
    /// mean something else, and where the covariance of the fit is none.
    pub fn of(identified: &job::Identified, stated: &Prior) -> Option<Self> {
        if identified.law != WallLaw::Helical {
            return None;
        }
        let (prior, fit) = (&identified.prior, &identified.fit);
        let sigma = prior.sigma.map(float);
        let free: Vec<usize> = (0..QUANTITIES).filter(|k| sigma[*k] > 0.0).collect();
        let covariance: Vec<Vec<f64>> =
            free.iter().map(|i| free.iter().map(|j| float(fit.covariance[*i][*j])).collect()).collect();
        let factor = Cholesky::new(&covariance)?;
        let weights = prior_weights(&fit.theta);
        // In prior standard deviations the belief is the unit matrix, or less where it has long tails.
        let mut information = Square::default();
        let mut pull = Quantities::default();
        for (b, j) in free.iter().enumerate() {
            let mut unit = vec![0.0; free.len()];
            unit[b] = 1.0;
            let column = factor.solve(&unit);
            for (i, all) in free.iter().zip(column) {
                let scale = sigma[*i] * sigma[*j];
                let believed = if i == j { float(weights[*i]) } else { 0.0 };
                information[*i][*j] = (all - believed) / scale;
                pull[*i] += all * float(fit.theta[*j]) / sigma[*i];
            }
        }
        // From where the fit began to what the job states.
        let (began, stated_at) = (of(&prior.mean), of(&stated.mean));
        for i in &free {
            pull[*i] += (0..QUANTITIES).map(|j| information[*i][j] * (began[j] - stated_at[j])).sum::<f64>();
        }
        let stated_ln_ktc = libm::log(float(stated.mean.coefficients.ktc));
        Some(Self { stated: stated_at, stated_ln_ktc, sigma: sigmas(stated), information, pull })
    }
}
