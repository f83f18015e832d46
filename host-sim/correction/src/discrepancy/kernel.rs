//! How much the discrepancy at one place says about that at another.
//!
//! | kind | what it does to the wall | along the contour |
//! |---|---|---|
//! | stock | the allowance larger by a share | Matérn 3/2 |
//! | load | force or compliance larger by a share: a wall that yields | Matérn 3/2, 2.5 cutter radii |
//! | drift | the datum moves while the contour is cut: `−n·d(s)` | Matérn 3/2, a third of the contour |
//! | local | anything, around a place | Matérn 3/2, or the same stretch at much the same engagement |
//! | keyed | anything, wherever the cutter is engaged alike: what one corner taught is known in the next | engagement now and a quarter of the radius before and behind |
//! | level | force larger by a share, on the whole part: wear (a random walk from part to part) and another blank | – |
//! | size | the cutter's size, from part to part (a random walk) | – |
//!
//! The walks are counted back from the newest part, so that the fitted parameters are its own: what is believed of a
//! machine beforehand is no better known of the next part than of this one, and takes nothing away from what this one shows. The
//! next part is expected to be like it, give or take one step. Half of the keyed kind holds whatever the direction of the wall,
//! half only where walls are parallel, because a machine may yield otherwise along another axis.

use truepath_core::cut::Path;
use truepath_ground::hypotenuse::hypot;
use truepath_ground::units::mm;

use super::feature::Feature;

/// Standard deviations of the kinds and the lengths over which they hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// Share of the allowance that differs along the contour.
    pub stock: f64,
    /// Length over which it does, in cutter radii.
    pub stock_reach: f64,
    /// Share of the load that differs along the contour at the same stock.
    pub load: f64,
    /// Drift of the datum, mm.
    pub drift: f64,
    /// Local, mm.
    pub local: f64,
    /// Length over which it holds, in cutter radii.
    pub local_reach: f64,
    /// Keyed, mm.
    pub keyed: f64,
    /// Walk of the level of force from part to part.
    pub wear: f64,
    /// What differs from height to height, mm: it counts as noise.
    pub height: f64,
    /// Factor on the noise of the points.
    pub noise: f64,
}

/// Level of force of one part against another by its blank.
const BLANK: f64 = 0.01;
/// Walk of the cutter's size from part to part, mm.
pub(super) const SIZE: f64 = 0.001;
/// Parts after which a walk goes no farther: cutters are replaced.
const LONGEST: u32 = 100;
/// Engagements nearer than this are alike, rad.
const ALIKE: f64 = 0.15;
/// Length over which a wall yields otherwise, in cutter radii.
const YIELDS_OVER: f64 = 2.5;
/// Share of a contour over which the datum drifts.
const DRIFTS_OVER: f64 = 1.0 / 3.0;

/// Standard deviation from one part to the next of a wall that yields so much, mm, where force and cutter change as little as any
/// kernel allows.
pub fn least_change(deflection_mm: f64) -> f64 {
    hypot(deflection_mm * hypot(Kernel::EVEN.wear, BLANK), SIZE)
}

/// The contours of a part, as far as the kernel must know them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    /// Length, mm.
    pub(super) length: f64,
    /// Whether it ends where it begins.
    pub(super) closed: bool,
    /// Radius of the cutter, mm.
    pub(super) radius: f64,
    /// Allowance, mm.
    pub(super) allowance: f64,
}

impl Extent {
    /// Of a path.
    pub(super) fn of(path: &Path) -> Self {
        let setup = path.setup();
        let (radius, allowance) = (mm(setup.radius), mm(setup.allowance));
        Self { length: mm(path.length()), closed: path.is_closed(), radius, allowance }
    }

    /// Distance of two places along the contour, mm; on a closed one the chord of a circle as long, on which a covariance of
    /// the distance stays one.
    pub(super) fn way(&self, a: f64, b: f64) -> f64 {
        let way = (a - b).abs();
        if !self.closed || self.length <= 0.0 {
            return way;
        }
        let round = self.length / std::f64::consts::PI;
        round * (way.min((self.length - way).abs()) / round).sin()
    }
}

pub(super) fn matern(way: f64, reach: f64) -> f64 {
    let x = 3f64.sqrt() * way / reach;
    (1.0 + x) * (-x).exp()
}

fn bell(square: f64) -> f64 {
    (-0.5 * square).exp()
}

/// Two places of one part, with the exponentials that kernels ask for: most ask for the same.
#[derive(Clone, Debug)]
pub(super) struct Pair<'p> {
    a: &'p Feature,
    b: &'p Feature,
    /// The contour that both are on.
    extent: Option<&'p Extent>,
    cosine: f64,
    way: f64,
    /// Reaches with what is known of each; of the reaches that are tried there are no more.
    materns: [Option<(f64, f64)>; 6],
    local: Option<(f64, f64)>,
    engaged_alike: Option<f64>,
    within_drift: Option<f64>,
}

impl<'p> Pair<'p> {
    /// Of two places.
    pub(super) fn of(extents: &'p [Extent], a: &'p Feature, b: &'p Feature) -> Self {
        let extent = extents.get(a.contour).filter(|_| a.contour == b.contour);
        let way = extent.map_or(0.0, |extent| extent.way(a.s, b.s));
        let cosine = a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1];
        Self { a, b, extent, cosine, way, materns: [None; 6], local: None, engaged_alike: None, within_drift: None }
    }

    fn apart(&self, k: usize) -> f64 {
        ((self.a.engaged[k] - self.b.engaged[k]) / ALIKE).powi(2)
    }

    fn matern(&mut self, reach: f64) -> f64 {
        for slot in &mut self.materns {
            match slot {
                Some((known, value)) if *known == reach => return *value,
                Some(_) => (),
                None => return slot.insert((reach, matern(self.way, reach))).1,
            }
        }
        matern(self.way, reach)
    }

    fn near_and_alike(&mut self, reach: f64) -> f64 {
        match self.local {
            Some((known, value)) if known == reach => value,
            _ => {
                let value = bell((self.way / reach).powi(2)) * bell(self.apart(1));
                self.local.insert((reach, value)).1
            }
        }
    }

    fn engaged_alike(&mut self) -> f64 {
        let load = self.apart(0) + self.apart(1) + self.apart(2);
        *self.engaged_alike.get_or_insert_with(|| bell(load))
    }

    /// `reach` is that of the contour.
    fn within_drift(&mut self, reach: f64) -> f64 {
        *self.within_drift.get_or_insert_with(|| matern((self.a.s - self.b.s).abs(), reach))
    }
}

impl Kernel {
    /// Where the search for kernels begins: an even machine, uneven load, an unknown cause.
    pub(super) const STARTS: [Self; 4] = [
        Self::EVEN,
        Self { stock: 0.15, stock_reach: 2.5, ..Self::EVEN },
        Self { stock: 0.15, stock_reach: 6.0, height: 0.008, ..Self::EVEN },
        Self { local: 0.012, local_reach: 2.0, height: 0.008, ..Self::EVEN },
    ];

    /// A machine as the model has it that cuts even stock.
    pub(super) const EVEN: Self = Self {
        stock: 0.0,
        stock_reach: 1.0,
        load: 0.0,
        drift: 0.0,
        local: 0.0,
        local_reach: 0.4,
        keyed: 0.0,
        wear: 0.02,
        height: 0.0,
        noise: 1.0,
    };

    /// Covariance of two places of one and the same part, as far as it repeats on the next, mm².
    pub(super) fn lasting(&self, extents: &[Extent], a: &Feature, b: &Feature) -> f64 {
        self.lasting_of(&mut Pair::of(extents, a, b))
    }

    /// The same of a pair that several kernels are asked about.
    pub(super) fn lasting_of(&self, pair: &mut Pair<'_>) -> f64 {
        let Pair { a, b, cosine, .. } = *pair;
        let mut sum = 0.0;
        if self.keyed > 0.0 {
            sum += self.keyed.powi(2) * pair.engaged_alike() * (0.5 + 0.5 * cosine * cosine);
        }
        let Some(extent) = pair.extent else { return sum };
        if self.stock > 0.0 {
            let size = (self.stock * extent.allowance).powi(2);
            sum += size * (a.stock * b.stock) * pair.matern(self.stock_reach * extent.radius);
        }
        if self.load > 0.0 {
            sum += self.load.powi(2) * (a.load * b.load) * pair.matern(YIELDS_OVER * extent.radius);
        }
        if self.local > 0.0 {
            let reach = self.local_reach * extent.radius;
            let alike = if self.local_reach < 1.0 { pair.near_and_alike(reach) } else { pair.matern(reach) };
            sum += self.local.powi(2) * alike;
        }
        if self.drift > 0.0 {
            sum += self.drift.powi(2) * pair.within_drift(DRIFTS_OVER * extent.length) * cosine;
        }
        sum
    }

    /// The same without what is not of the load: stock, and force or compliance.
    pub(super) const fn of_load(&self) -> Self {
        Self { drift: 0.0, local: 0.0, keyed: 0.0, ..*self }
    }

    /// The same without what is not of two places of one part: [`lasting`](Self::lasting) does not see it.
    pub(super) const fn of_one_part(&self) -> Self {
        let Self { wear, height, noise, .. } = Self::EVEN;
        Self { wear, height, noise, ..*self }
    }

    /// Standard deviation of the level of force of the next part over that of the newest, natural logarithm.
    pub(super) fn next_level(&self) -> f64 {
        hypot(self.wear, BLANK)
    }

    /// Variance of a place from the newest part to the next by the level of force and the size of the cutter, mm².
    pub(super) fn next_step(&self, place: &Feature) -> f64 {
        (place.load * self.next_level()).powi(2) + SIZE.powi(2)
    }

    /// Covariance of a place of one part with the level of force of another over that of the newest, natural logarithm, mm; the parts lie
    /// so many before the next one (1 for the newest).
    pub(super) fn with_level(&self, place: &Feature, parts_ago: [u32; 2]) -> f64 {
        place.load * self.levels(parts_ago)
    }

    /// Covariance of the levels of force of two parts over that of the newest.
    fn levels(&self, parts_ago: [u32; 2]) -> f64 {
        let own = if parts_ago[0] == parts_ago[1] { BLANK.powi(2) } else { 0.0 };
        self.wear.powi(2) * shared(parts_ago) + own
    }

    /// Covariance of two places by the level of force and the size of the cutter on their parts, which lie so many parts
    /// before the next one (1 for the newest), mm².
    pub(super) fn between_parts(&self, a: &Feature, b: &Feature, parts_ago: [u32; 2]) -> f64 {
        (a.load * b.load) * self.levels(parts_ago) + SIZE.powi(2) * shared(parts_ago)
    }
}

/// How many steps of a walk that is counted back from the newest part two parts have in common.
fn shared(parts_ago: [u32; 2]) -> f64 {
    f64::from(parts_ago[0].min(parts_ago[1]).saturating_sub(1).min(LONGEST))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(load: f64) -> Feature {
        Feature { contour: 0, s: 1.0, engaged: [1.0; 3], normal: [1.0, 0.0], load, stock: 0.0 }
    }

    #[test]
    fn the_newest_part_is_known_by_its_own_points_and_the_next_is_a_step_farther() {
        let kernel = Kernel { wear: 0.1, ..Kernel::EVEN };
        let (a, b) = (place(0.2), place(0.3));
        let steps = |parts_ago| (kernel.between_parts(&a, &b, parts_ago) / (0.06 * 0.01)).round() as u32;
        assert_eq!([[1, 1], [1, 5], [2, 2], [3, 5], [500, 600]].map(steps), [0, 0, 1, 2, 100]);
        let next = kernel.next_step(&a);
        assert!((next - (0.04 * (0.01 + BLANK * BLANK) + SIZE * SIZE)).abs() < 1e-12, "{next}");
        assert!((next - least_change(0.2).powi(2)).abs() > 1e-6 && kernel.next_level() > kernel.wear);
    }
}
