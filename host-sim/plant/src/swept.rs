//! What the cutter has already removed: every place it has been, and the arc of the present circumference each of them covers.

use super::arcs::EngagedArcs;
use super::grid::Grid;
use super::stock::Frame;
use super::vector::{Point, dot, norm, squared_distance, sub};

/// Cuts this close behind are the present cut, mm of travel.
const PRESENT_MM: f64 = 0.3;

/// Centres of the cutter so far.
#[derive(Debug, Clone)]
pub(super) struct Swept {
    centres: Vec<Point>,
    travelled: Vec<f64>,
    cells: Grid,
    radius: f64,
    memory: f64,
}

impl Swept {
    pub(super) fn new(radius: f64, memory_mm: Option<f64>) -> Self {
        Self {
            centres: Vec::new(),
            travelled: Vec::new(),
            cells: Grid::new(2.0 * radius),
            radius,
            memory: memory_mm.unwrap_or(f64::INFINITY),
        }
    }

    /// The cutter was at `centre` after `travelled` mm.
    pub(super) fn push(&mut self, centre: Point, travelled: f64) {
        self.cells.push(centre);
        self.centres.push(centre);
        self.travelled.push(travelled);
    }

    /// Earlier places whose circle can meet that of a centre within `slack` of `centre`.
    pub(super) fn near(&self, centre: Point, slack: f64, travelled: f64, found: &mut Vec<u32>) {
        self.cells.near(centre, 2.0 * self.radius + slack, found);
        found.retain(|&k| {
            let ago = travelled - self.travelled[k as usize];
            ago >= PRESENT_MM && ago <= self.memory
        });
    }

    /// Takes what the places `earlier` have removed out of `arcs`.
    ///
    /// A place less than half a radius of travel ago whose circle contains the wall point is passed over: it differs from the
    /// present one only by the change of deflection, and by definition the wall is being made at φ = 0.
    pub(super) fn remove_from(&self, arcs: &mut EngagedArcs, frame: &Frame, travelled: f64, earlier: &[u32]) {
        let Some([first, last]) = arcs.bounds() else {
            return;
        };
        let (start, end, wall) = (frame.at(first), frame.at(last), frame.at(0.0));
        // Touching circles do not cut each other.
        let inside = (self.radius - 1e-9).powi(2);
        for &k in earlier {
            let other = self.centres[k as usize];
            let recent = travelled - self.travelled[k as usize] < 0.5 * self.radius;
            if recent && squared_distance(other, wall) < inside {
                continue;
            }
            // Cheap tests first: the covered arc holds an end of the engagement, or begins and ends inside it.
            let v = sub(other, frame.centre);
            let ahead = dot(v, frame.tangent) > 0.0;
            if !ahead && squared_distance(other, start) >= inside && squared_distance(other, end) >= inside {
                continue;
            }
            let distance = norm(v);
            if distance < 1e-9 || distance >= 2.0 * self.radius {
                continue;
            }
            let middle = frame.immersion(other);
            let half = (0.5 * distance / self.radius).acos();
            arcs.remove(middle - half, middle + half);
        }
    }
}
