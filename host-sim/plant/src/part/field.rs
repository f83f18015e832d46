//! What is left on the wall: for every ray and slice the stock along the ray, counted from the nominal wall.
//!
//! A circle of the cutter takes what it covers, if it comes from outside: a hole behind material that stands leaves the surface
//! where it is.

use super::rays::{Rays, UNDERCUT_MM};
use super::slices::Slice;
use crate::allowance::Allowance;
use crate::grid::Grid;
use crate::machine::Machine;
use crate::path::Path;
use crate::setup::Cut;
use crate::vector::{Point, along, cross, dot, squared_distance, sub};

/// Where there is no stock at all, mm.
const NONE_MM: f64 = -1e6;
/// A circle may begin this much behind the surface and still take it, mm.
const CONTIGUOUS_MM: f64 = 1e-6;

/// The stock of a part.
#[derive(Debug, Clone)]
pub(super) struct Field {
    slices: usize,
    /// By ray, then by slice, mm.
    left: Vec<f64>,
    /// The most of every ray, mm.
    most: Vec<f64>,
}

/// The cutter at the instants at which it makes the wall: for every slice from the first that it cuts, a circle for each tooth
/// that is another.
#[derive(Debug, Clone)]
pub(super) struct Circles {
    pub(super) middle: Point,
    pub(super) first_slice: usize,
    pub(super) centres: Vec<Point>,
    /// Of every tooth, mm.
    pub(super) radii: Vec<f64>,
}

impl Field {
    /// The raw stock.
    pub(super) fn new(path: &Path, rays: &Rays, cut: &Cut, machine: &Machine, slices: &[Slice]) -> Self {
        let before = Allowance::new(path, cut, machine);
        let r = cut.radius_mm;
        let centres = Grid::of(r, path.centre.iter().copied());
        let mut near = Vec::new();
        let mut most: Vec<f64> = rays
            .rows
            .iter()
            .map(|row| {
                let allowance = match &cut.surface {
                    Some(surface) => {
                        return crossing(row.ray.foot, row.ray.normal, r, surface).map_or(f64::NAN, |v| r - v);
                    }
                    None => before.at(row.s_mm),
                };
                if row.on_part {
                    return allowance;
                }
                let raw = along(row.ray.foot, row.ray.normal, r - allowance);
                centres.near(raw, r - allowance - UNDERCUT_MM, &mut near);
                if near.is_empty() { allowance } else { NONE_MM }
            })
            .collect();
        continued(&mut most);
        let left = most.iter().flat_map(|m| std::iter::repeat_n(*m, slices.len())).collect();
        Self { slices: slices.len(), left, most }
    }

    /// What is left on a ray, by slices, mm.
    pub(super) fn row(&self, row: usize) -> &[f64] {
        &self.left[row * self.slices..(row + 1) * self.slices]
    }

    /// The most that is left anywhere, mm.
    pub(super) fn most(&self) -> f64 {
        self.most.iter().copied().fold(0.0, f64::max)
    }

    /// Takes away what the circles cover.
    pub(super) fn cut(&mut self, rays: &Rays, circles: &Circles, radius: f64, most: f64, near: &mut Vec<u32>) {
        let teeth = circles.radii.len();
        let off = |c: &Point| squared_distance(*c, circles.middle);
        let spread = circles.centres.iter().map(off).fold(0.0, f64::max).sqrt();
        let largest = circles.radii.iter().copied().fold(radius, f64::max);
        let reach = largest + spread;
        rays.near(circles.middle, reach + most + 0.1, near);
        for &row in near.iter() {
            let row = row as usize;
            let ray = rays.rows[row].ray;
            let exit = |centre: Point, radius: f64| {
                let v = sub(centre, ray.foot);
                let on_ray = dot(v, ray.normal);
                let room = radius * radius - (dot(v, v) - on_ray * on_ray);
                (room > 0.0).then(|| (on_ray - room.sqrt(), on_ray + room.sqrt()))
            };
            // No circle of these reaches farther than this one.
            if exit(circles.middle, reach).is_none_or(|(_, out)| radius - out >= self.most[row]) {
                continue;
            }
            let left = &mut self.left[row * self.slices..(row + 1) * self.slices];
            for (slice, centres) in left[circles.first_slice..].iter_mut().zip(circles.centres.chunks(teeth)) {
                for (&centre, &tooth) in centres.iter().zip(&circles.radii) {
                    if let Some((enters, leaves)) = exit(centre, tooth)
                        && radius - leaves < *slice
                        && enters <= radius - *slice + CONTIGUOUS_MM
                    {
                        *slice = radius - leaves;
                    }
                }
            }
            self.most[row] = left.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        }
    }
}

/// Values beside a ray that meets no surface: those of the nearest that does.
fn continued(values: &mut [f64]) {
    let mut last = f64::NAN;
    for value in values.iter_mut() {
        if value.is_nan() { *value = last } else { last = *value }
    }
    for value in values.iter_mut().rev() {
        if value.is_nan() { *value = last } else { last = *value }
    }
    values.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = NONE_MM);
}

/// Where a ray first meets a surface, from a diameter before the wall to a radius behind it, mm from its foot.
fn crossing(foot: Point, normal: Point, radius: f64, surface: &[Point]) -> Option<f64> {
    let met = surface.windows(2).filter_map(|piece| {
        let (a, d) = (sub(piece[0], foot), sub(piece[1], piece[0]));
        let det = cross(normal, d);
        let (v, u) = (cross(a, d) / det, cross(a, normal) / det);
        (det.abs() > 1e-18 && (0.0..=1.0).contains(&u) && (-radius..=2.0 * radius).contains(&v)).then_some(v)
    });
    met.min_by(f64::total_cmp)
}
