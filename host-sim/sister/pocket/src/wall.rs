//! A finishing pass along one wall, as the core predicts it: engagement from geometry, force, elastic loop, envelope.
//!
//! The core's compliance grows linearly towards the tip. The beam's is nearly linear over the engaged depth; it enters
//! with its exact mean and the rise from the top to the tip, so that the mean over the height, at which a correction
//! aims, is that of the beam.

use truepath_core::correct::{Design, Law, Profile, profile};
use truepath_core::cut::{Coefficients, Compliance, ForceTable, Loop, Path, State};
use truepath_core::geometry::Vector;
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::error::PocketError;
use super::machine::Machine;
use super::process::{Cutting, Process, Walls};
use super::station::{Station, components, coordinates, is_arc};

/// A finishing pass.
#[derive(Debug)]
pub struct Wall<'a> {
    path: &'a Path<'a>,
    stations: Vec<Station>,
    nominal: Vec<f64>,
    compliance: Compliance,
    coefficients: Coefficients,
    table: ForceTable,
    wanted: Design,
}

/// Number of the core nearest to a float; the machine's numbers are far within its range.
pub(super) fn real(v: f64) -> Real {
    Real::from_bits((v * 4_294_967_296.0).round() as i64)
}

fn vector([x, y]: [f64; 2]) -> Vector {
    let nm = |v: f64| Offset::from_nm((v * 1e6).round() as i64);
    Vector { x: nm(x), y: nm(y) }
}

/// Cutter and machine as the core takes them.
fn compliance(machine: &Machine) -> Compliance {
    let rise = machine.bend_at(0.0) - machine.bend_at(1.0);
    // At the top of the engaged depth, so that the mean over it is exact.
    let [x, y] = machine.mean().map(|mean| 1000.0 * (mean - 0.5 * rise));
    let mean = 0.5 * (x + y);
    Compliance {
        mean: real(mean),
        difference: real(0.5 * (x - y)),
        bend: real(1000.0 * rise / mean),
        ..Compliance::default()
    }
}

/// The finishing pass of a job along its sampled path.
///
/// # Errors
/// A cutter that is not described.
pub fn finishing<'a>(pass: &Pass, path: &'a Path<'a>) -> Result<Wall<'a>, PocketError> {
    let machine = Machine::of(&pass.job)?;
    let blocks: Vec<(bool, u32)> = pass.blocks.iter().map(|block| (is_arc(block), block.line)).collect();
    let wanted = pass.job.numbers.design(Law::Model);
    Ok(Wall::new(path, &blocks, pass.core.coefficients(), &machine, wanted))
}

impl<'a> Wall<'a> {
    /// Along a sampled path; `is_arc` and `line` of its blocks by index.
    ///
    /// # Errors
    /// As [`Process::cut`].
    pub fn new(
        path: &'a Path<'a>,
        blocks: &[(bool, u32)],
        coefficients: Coefficients,
        machine: &Machine,
        wanted: Design,
    ) -> Self {
        let samples = &path.samples()[path.first()..path.first() + path.count()];
        let stations = samples
            .iter()
            .map(|sample| {
                let block = sample.block as usize;
                let (turns, line) = blocks.get(block).copied().unwrap_or_default();
                Station {
                    s_mm: mm(sample.s),
                    point: coordinates(sample.point),
                    normal: components(sample.normal),
                    heading: components(path.setup().wall.heading(sample.normal)),
                    block,
                    line,
                    feed_mm_per_min: float(sample.feed),
                    turns,
                    held: sample.near_corner,
                }
            })
            .collect();
        let table = ForceTable::new(coefficients.size_exponent);
        let mut wall =
            Self { path, stations, nominal: Vec::new(), compliance: compliance(machine), coefficients, table, wanted };
        let rigid = wall.machine(0.0);
        let engaged = |i: usize| float(rigid.nominal(path.first() + i, Real::ZERO).engaged);
        wall.nominal = (0..path.count()).map(engaged).collect();
        wall
    }

    fn machine(&self, force: f64) -> Loop<'_> {
        let times = |k: Real| k * real(force);
        let k = &self.coefficients;
        let coefficients =
            Coefficients { ktc: times(k.ktc), krc: times(k.krc), kte: times(k.kte), kre: times(k.kre), ..*k };
        Loop { path: self.path, table: &self.table, coefficients, compliance: self.compliance, undersize: Offset::ZERO }
    }
}

impl Process for Wall<'_> {
    fn stations(&self) -> &[Station] {
        &self.stations
    }

    fn nominal(&self) -> &[f64] {
        &self.nominal
    }

    fn limit_mm(&self) -> f64 {
        mm(self.path.setup().allowance)
    }

    fn intended_mm(&self, station: usize) -> f64 {
        let feed = self.path.setup().feed_per_tooth(real(self.stations[station].feed_mm_per_min));
        let state = self.machine(1.0).nominal(self.path.first() + station, self.coefficients.chip_scale(feed));
        let normal = self.stations[station].normal;
        mm(state.displacement.x) * normal[0] + mm(state.displacement.y) * normal[1]
    }

    fn cut(&self, shifts: &[[f64; 2]], force: f64) -> Result<Vec<Cutting>, PocketError> {
        let machine = self.machine(force);
        let path = self.path;
        let working = path.working();
        let mut states = vec![State::REST; working.len()];
        let nodes: Vec<truepath_core::correct::Node> = shifts
            .iter()
            .map(|shift| truepath_core::correct::Node { chip: Vector::ZERO, edge: vector(*shift) })
            .collect();
        let commanded = |i: usize| truepath_core::correct::commanded(path, &nodes, i);
        let passage = machine.run(working.start, &mut states, commanded);
        if passage.unsettled as usize > working.len() / 50 + 4 {
            return Err(PocketError::Unsettled {
                places: passage.unsettled as usize,
                worst_mm: mm(passage.worst_residual),
            });
        }
        let mut displacements = vec![Vector::ZERO; working.len()];
        let mut profiles = vec![Profile::default(); path.count()];
        profile(&machine, &states, self.wanted.band, &mut displacements, &mut profiles);
        let (bend, mean_factor) = (float(self.compliance.bend), float(self.compliance.mean_factor()));
        let skipped = path.first() - working.start;
        Ok(states[skipped..]
            .iter()
            .zip(&profiles)
            .zip(&self.stations)
            .map(|((state, profile), station)| {
                let (n, t) = machine.mean_force(state);
                let [dx, dy] = [mm(state.displacement.x), mm(state.displacement.y)];
                let known = |v: f64| if profile.on_wall { v } else { f64::NAN };
                Cutting {
                    engaged_rad: float(state.engaged),
                    force_n: [float(n), float(t)],
                    deflection_mm: dx * station.normal[0] + dy * station.normal[1],
                    tip_mm: dx.hypot(dy) * (1.0 + bend) / mean_factor,
                    walls: Walls { near: known(mm(profile.aim(self.wanted.target, None))), far: f64::NAN },
                    height_mm: known(mm(profile.highest.max(profile.tip)) - mm(profile.lowest)),
                }
            })
            .collect())
    }
}
