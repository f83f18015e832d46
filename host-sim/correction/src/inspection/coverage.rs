//! Which parts of the wall lie farther from every touched place than a point speaks for: along the contour, and over its height.
//!
//! Distances are along the contour; on a closed one also across its seam. How far a point speaks for is the user's to say
//! (`part.reach_mm`, `part.reach_height_mm`). Where nothing is said it is the cutter's diameter along the contour, because over
//! that length the engagement, and with it the deflection, changes in a corner; and a quarter of the depth of cut up and
//! down, so that it takes touches near the tip, in the middle and near the top to have the whole height.
//!
//! A helical cutter leaves another wall at every height, so that touches at one height say little about the others. The face
//! is cut into layers, at the heights where the reach of some point begins or ends; in a layer the same points count
//! everywhere, and what they leave open are stretches of the contour.
//!
//! Limits: the heights of points are taken to a hundredth of the depth, so that their number is bounded whatever the file.

use std::collections::BTreeMap;

use truepath_core::units::Offset;
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

/// A stretch of the contour, or of the height of its wall.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Stretch {
    /// Its beginning, mm along the contour, or above the cutter's tip.
    pub from_mm: f64,
    /// Its end.
    pub to_mm: f64,
}

impl Stretch {
    pub(super) fn of((from, to): (Offset, Offset)) -> Self {
        Self { from_mm: mm(from), to_mm: mm(to) }
    }
}

/// A touched place of the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touched {
    /// Arc length of the contour.
    pub s: Offset,
    /// Height above the cutter's tip.
    pub height: Offset,
}

/// The wall that is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Length of the contour.
    pub length: Offset,
    /// Height of the wall: the depth of cut.
    pub depth: Offset,
    /// Whether the contour closes.
    pub closed: bool,
}

/// How far a point speaks for the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Along the contour.
    pub along: Offset,
    /// Up and down.
    pub height: Offset,
}

/// What no point speaks for.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Coverage {
    /// How far a point speaks for, mm along the contour.
    pub reach_mm: f64,
    /// Length of the contour, mm.
    pub length_mm: f64,
    /// Length of the stretches together, mm.
    pub farther_mm: f64,
    /// The stretches that no point speaks for at any height, in the order of the contour.
    pub stretches: Vec<Stretch>,
    /// The same over the height.
    pub face: Face,
}

/// Finds what no point speaks for. The places may come in any order.
pub fn coverage(places: &[Touched], wall: Extent, reach: Reach) -> Coverage {
    let open = left_open(reached(places.iter().map(|p| p.s), wall, reach.along), wall.length);
    Coverage {
        reach_mm: mm(reach.along),
        length_mm: mm(wall.length),
        farther_mm: mm(together(&open)),
        stretches: open.into_iter().map(Stretch::of).collect(),
        face: face(places, wall, reach),
    }
}

/// What places speak for along the contour, in any order; on a closed one also across its seam.
pub(super) fn reached(
    places: impl IntoIterator<Item = Offset>,
    wall: Extent,
    reach: Offset,
) -> impl Iterator<Item = (Offset, Offset)> {
    let turns = [Offset::ZERO, wall.length, -wall.length].into_iter().take(if wall.closed { 3 } else { 1 });
    places.into_iter().flat_map(move |s| turns.clone().map(move |turn| (s + turn - reach, s + turn + reach)))
}

/// What stretches leave open of a length, in its order.
pub(super) fn left_open(
    stretches: impl IntoIterator<Item = (Offset, Offset)>,
    length: Offset,
) -> Vec<(Offset, Offset)> {
    let mut stretches: Vec<(Offset, Offset)> = stretches.into_iter().collect();
    stretches.sort_unstable();
    let mut open = Vec::new();
    let mut until = Offset::ZERO;
    for (from, to) in stretches {
        if from > until && until < length {
            open.push((until, from.min(length)));
        }
        until = until.max(to);
    }
    if until < length {
        open.push((until, length));
    }
    open
}

/// Length of stretches.
pub(super) fn together(stretches: &[(Offset, Offset)]) -> Offset {
    stretches.iter().fold(Offset::ZERO, |sum, (from, to)| sum + (*to - *from))
}

/// Stretches named in a sentence at most; the summary holds all of them.
pub(super) const NAMED: usize = 6;

impl Coverage {
    /// What it means for the verdict along the contour, in words; [`Face::words`] has the height.
    pub fn words(&self, unit: Unit) -> String {
        let Self { stretches, .. } = self;
        let [reach, length, farther] = [self.reach_mm, self.length_mm, self.farther_mm].map(|mm| unit.of(mm));
        let name = unit.name();
        if stretches.is_empty() {
            return format!(
                "Every place of the contour ({length:.1} {name}) lies within {reach} {name} of a measured one."
            );
        }
        let named: Vec<String> = stretches
            .iter()
            .take(NAMED)
            .map(|s| format!("{:.1} to {:.1}", unit.of(s.from_mm), unit.of(s.to_mm)))
            .collect();
        let more = stretches.len().saturating_sub(NAMED);
        let more = match more {
            0 => String::new(),
            1 => ", and 1 more stretch".to_owned(),
            more => format!(", and {more} more stretches"),
        };
        format!(
            "{farther:.1} of {length:.1} {name} of the contour lie farther than {reach} {name} from any measured place: s = {} {name}{more}.",
            named.join(", ")
        )
    }
}

/// Parts of the depth that heights are told apart to.
const PARTS: i64 = 100;
/// Heights that lie no farther apart than so many of these parts are told as one.
const ALIKE: i64 = 5;

/// Stretches of the contour.
type Spans = Vec<(Offset, Offset)>;

/// What no point speaks for over the height.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Face {
    /// Height of the wall: the depth of cut, mm.
    pub depth_mm: f64,
    /// How far up and down a point speaks for, mm.
    pub reach_mm: f64,
    /// Heights that were touched, mm above the cutter's tip, lowest first; neighbours are told as one.
    pub touched: Vec<Stretch>,
    /// Share of the face that no point speaks for, %.
    pub open_percent: f64,
    /// Layers with something open, lowest first.
    pub layers: Vec<Layer>,
}

/// Heights at which the same stretches of the contour are open.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Layer {
    /// Lowest height, mm above the cutter's tip.
    pub from_mm: f64,
    /// Highest.
    pub to_mm: f64,
    /// What no point speaks for there, in the order of the contour.
    pub stretches: Vec<Stretch>,
}

/// Finds them. The places may come in any order.
fn face(places: &[Touched], wall: Extent, reach: Reach) -> Face {
    let depth = wall.depth;
    let part = |k: i64| Offset::from_nm((depth.nm() * k + PARTS / 2) / PARTS);
    let mut by_height: BTreeMap<i64, Vec<Offset>> = BTreeMap::new();
    for place in places {
        let height = place.height.clamp(Offset::ZERO, depth).nm();
        by_height.entry((height * PARTS + depth.nm() / 2) / depth.nm().max(1)).or_default().push(place.s);
    }
    // Of each height what is reached, without overlaps: a few stretches, however many points there are.
    let levels: Vec<(Offset, Spans)> = by_height
        .iter()
        .map(|(k, s)| {
            let open = left_open(reached(s.iter().copied(), wall, reach.along), wall.length);
            (part(*k), left_open(open, wall.length))
        })
        .collect();
    let ends = levels.iter().flat_map(|(height, _)| [*height - reach.height, *height + reach.height]);
    let mut edges: Vec<Offset> = ends.map(|edge| edge.clamp(Offset::ZERO, depth)).collect();
    edges.extend([Offset::ZERO, depth]);
    edges.sort_unstable();
    edges.dedup();
    let mut layers: Vec<(Offset, Offset, Spans)> = Vec::new();
    for edge in edges.windows(2) {
        let &[low, high] = edge else { continue };
        let counts = |height: &Offset| *height - reach.height <= low && *height + reach.height >= high;
        let there =
            levels.iter().filter(|(height, _)| counts(height)).flat_map(|(_, stretches)| stretches.iter().copied());
        let open = left_open(there, wall.length);
        match layers.last_mut() {
            Some(below) if below.2 == open => below.1 = high,
            _ => layers.push((low, high, open)),
        }
    }
    let area: f64 = layers.iter().map(|(low, high, open)| mm(*high - *low) * mm(together(open))).sum();
    let whole = mm(depth) * mm(wall.length);
    let layer = |(low, high, open): (Offset, Offset, Spans)| Layer {
        from_mm: mm(low),
        to_mm: mm(high),
        stretches: open.into_iter().map(Stretch::of).collect(),
    };
    let mut touched: Vec<(i64, Stretch)> = Vec::new();
    let mut heights: Vec<Offset> = places.iter().map(|p| p.height).collect();
    heights.sort_unstable();
    for height in heights {
        let k = height.nm() * PARTS / depth.nm().max(1);
        match touched.last_mut() {
            Some((last, stretch)) if k - *last <= ALIKE => (*last, stretch.to_mm) = (k, mm(height)),
            _ => touched.push((k, Stretch::of((height, height)))),
        }
    }
    Face {
        depth_mm: mm(depth),
        reach_mm: mm(reach.height),
        touched: touched.into_iter().map(|(_, stretch)| stretch).collect(),
        open_percent: if whole > 0.0 { (area / whole * 1e4).round() / 1e2 } else { 0.0 },
        layers: layers.into_iter().filter(|(_, _, open)| !open.is_empty()).map(layer).collect(),
    }
}

impl Face {
    /// Heights that no point speaks for anywhere along a contour of a length.
    fn untouched(&self, length_mm: f64) -> Vec<Stretch> {
        let whole = |s: &Stretch| s.from_mm <= 0.0 && s.to_mm >= length_mm;
        let all = self.layers.iter().filter(|layer| layer.stretches.iter().any(whole));
        all.map(|layer| Stretch { from_mm: layer.from_mm, to_mm: layer.to_mm }).collect()
    }

    /// What it means for the verdict, in words, for a contour of a length.
    pub fn words(&self, unit: Unit, length_mm: f64) -> String {
        let Self { depth_mm, reach_mm, touched, open_percent, layers } = self;
        let name = unit.name();
        let decimals = if *depth_mm < 3.0 { 2 } else { 1 };
        let told = |mm: f64| format!("{:.decimals$}", unit.of(mm));
        let span = |s: &Stretch| match (told(s.from_mm), told(s.to_mm)) {
            (from, to) if from == to => from,
            (from, to) => format!("{from} to {to}"),
        };
        let listed = |all: &[Stretch]| match all {
            [first, .., last] if all.len() > NAMED => {
                format!("{} ranges between {} and {}", all.len(), told(first.from_mm), told(last.to_mm))
            }
            [some @ .., last] if !some.is_empty() => {
                format!("{} and {}", some.iter().map(span).collect::<Vec<_>>().join(", "), span(last))
            }
            some => some.iter().map(span).collect(),
        };
        let heights = if touched.is_empty() {
            "No height of the wall was touched".to_owned()
        } else {
            format!("Touched at heights of {} {name} above the cutter's tip", listed(touched))
        };
        let all = format!(
            "{heights}; the wall is {} {name} high, and a point speaks for {} {name} up and down",
            told(*depth_mm),
            unit.of(*reach_mm)
        );
        let same_over_all = |l: &Layer| l.from_mm <= 0.0 && l.to_mm >= *depth_mm;
        if !touched.is_empty() && layers.iter().all(same_over_all) && !layers.is_empty() {
            return format!("{all}: where the wall was touched, it was over its whole height.");
        }
        if layers.is_empty() {
            return format!("{all}: no place of the wall lies farther from a measured one.");
        }
        let share = match open_percent.round() {
            0.0 => "less than 1 %".to_owned(),
            100.0 if *open_percent < 100.0 => "more than 99 %".to_owned(),
            percent => format!("{percent} %"),
        };
        let nowhere = self.untouched(length_mm);
        let nowhere = match nowhere.as_slice() {
            [] => String::new(),
            some => format!("nothing is known of the wall at heights of {} {name}, ", listed(some)),
        };
        format!(
            "{all}: {nowhere}{share} of the wall's surface {} farther from every measured place.",
            if nowhere.is_empty() { "lies" } else { "in all lies" }
        )
    }
}

#[cfg(test)]
mod tests_over_the_height {
    use super::*;

    const MM: i64 = 1_000_000;

    fn of(places: &[(i64, i64)], closed: bool) -> Face {
        let at = |&(s, height): &(i64, i64)| Touched {
            s: Offset::from_nm(s * MM),
            height: Offset::from_nm(height * MM / 10),
        };
        let places: Vec<Touched> = places.iter().map(at).collect();
        let wall = Extent { length: Offset::from_nm(100 * MM), depth: Offset::from_nm(12 * MM), closed };
        face(&places, wall, Reach { along: Offset::from_nm(50 * MM), height: Offset::from_nm(3 * MM) })
    }

    /// Height from and to, and the stretches of the contour.
    type Told = (f64, f64, Vec<(f64, f64)>);

    fn layers(face: &Face) -> Vec<Told> {
        let stretches = |l: &Layer| l.stretches.iter().map(|s| (s.from_mm, s.to_mm)).collect();
        face.layers.iter().map(|l| (l.from_mm, l.to_mm, stretches(l))).collect()
    }

    #[test]
    fn one_height_leaves_the_others_open_and_three_leave_nothing() {
        let one = of(&[(50, 60)], false);
        assert_eq!(layers(&one), [(0.0, 3.0, vec![(0.0, 100.0)]), (9.0, 12.0, vec![(0.0, 100.0)])]);
        assert_eq!(one.open_percent, 50.0);
        let said = one.words(Unit::Millimetre, 100.0);
        assert!(
            said.contains("heights of 6.0 mm above")
                && said.contains("heights of 0.0 to 3.0 and 9.0 to 12.0 mm, 50 % of"),
            "{said}"
        );
        let three = of(&[(50, 12), (50, 60), (50, 108)], false);
        assert_eq!((three.layers.len(), three.open_percent), (0, 0.0));
        let said = three.words(Unit::Millimetre, 100.0);
        assert!(
            said.contains("1.2, 6.0 and 10.8 mm")
                && said.ends_with("no place of the wall lies farther from a measured one."),
            "{said}"
        );
    }

    #[test]
    fn a_place_touched_at_fewer_heights_than_others_is_open_at_the_rest() {
        // The left half at three heights, the right one in the middle only.
        let reach = |s| of(&[(0, 12), (0, 60), (0, 108), (s, 60)], false);
        let found = reach(100);
        assert_eq!(layers(&found), [(0.0, 3.0, vec![(50.0, 100.0)]), (9.0, 12.0, vec![(50.0, 100.0)])]);
        assert_eq!(found.open_percent, 25.0);
        assert!(
            found
                .words(Unit::Millimetre, 100.0)
                .ends_with("up and down: 25 % of the wall's surface lies farther from every measured place."),
            "{}",
            found.words(Unit::Millimetre, 100.0)
        );
        // What is open along the contour is not told again.
        let near = of(&[(0, 12), (0, 60), (0, 108)], false);
        assert!(
            near.words(Unit::Millimetre, 100.0).ends_with("where the wall was touched, it was over its whole height."),
            "{}",
            near.words(Unit::Millimetre, 100.0)
        );
        // On a closed contour the touches at the seam speak for both ends.
        assert_eq!(of(&[(0, 12), (0, 60), (0, 108)], true).open_percent, 0.0);
    }

    #[test]
    fn the_share_is_that_of_counted_spots_and_no_number_of_points_makes_more_layers_than_hundredths() {
        let mut seed = 7u64;
        let mut next = |below: i64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 33) as i64) % below
        };
        for count in [1, 3, 10] {
            let places: Vec<Touched> = (0..count)
                .map(|_| Touched {
                    s: Offset::from_nm(next(100 * MM)),
                    height: Offset::from_nm(next(101) * 12 * MM / 100),
                })
                .collect();
            let wall =
                Extent { length: Offset::from_nm(100 * MM), depth: Offset::from_nm(12 * MM), closed: count == 3 };
            let reach = Reach { along: Offset::from_nm(9 * MM), height: Offset::from_nm(2 * MM) };
            let found = face(&places, wall, reach);
            let open = (0..200).flat_map(|i| (0..200).map(move |k| (i, k))).filter(|(i, k)| {
                let (s, h) = (Offset::from_nm(i * MM / 2 + MM / 4), Offset::from_nm(k * 12 * MM / 200 + 12 * MM / 400));
                !places.iter().any(|p| {
                    let apart = (p.s - s).abs();
                    let apart = if wall.closed { apart.min(wall.length - apart) } else { apart };
                    apart <= reach.along && (p.height - h).abs() <= reach.height
                })
            });
            let counted = open.count() as f64 / 400.0;
            assert!((found.open_percent - counted).abs() < 1.0, "{count}: {} and {counted}", found.open_percent);
        }
        let many: Vec<(i64, i64)> = (0..5_000).map(|_| (next(100), next(121))).collect();
        assert!(of(&many, false).layers.len() <= 2 * PARTS as usize + 2);
    }

    #[test]
    fn heights_beyond_the_wall_and_a_wall_without_height_are_no_fault() {
        let odd = of(&[(50, -3), (50, 124)], false);
        assert_eq!(odd.touched.len(), 2);
        assert!(odd.open_percent > 40.0 && odd.open_percent < 60.0);
        let wall = Extent { length: Offset::ZERO, depth: Offset::ZERO, closed: true };
        let none = face(
            &[Touched { s: Offset::ZERO, height: Offset::ZERO }],
            wall,
            Reach { along: Offset::ZERO, height: Offset::ZERO },
        );
        assert_eq!((none.layers.len(), none.open_percent), (0, 0.0));
        assert!(of(&[], false).words(Unit::Millimetre, 100.0).starts_with("No height of the wall was touched"));
        assert_eq!(of(&[], false).open_percent, 100.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { along: Offset::from_um(10_000), height: Offset::from_um(10_000) };

    fn um(um: i64) -> Offset {
        Offset::from_um(um)
    }

    fn at(mm: i64) -> Touched {
        Touched { s: um(mm * 1000), height: um(5_000) }
    }

    fn of(places: &[i64], closed: bool) -> Vec<(f64, f64)> {
        let places: Vec<Touched> = places.iter().map(|mm| at(*mm)).collect();
        let found = coverage(&places, Extent { length: um(100_000), depth: um(10_000), closed }, REACH);
        let stretches: Vec<(f64, f64)> = found.stretches.iter().map(|s| (s.from_mm, s.to_mm)).collect();
        let sum: f64 = stretches.iter().map(|(from, to)| to - from).sum();
        assert!((found.farther_mm - sum).abs() < 1e-9);
        stretches
    }

    #[test]
    fn what_lies_beyond_the_reach_of_every_point_is_found_and_nothing_else() {
        assert_eq!(of(&[50, 30, 35], false), [(0.0, 20.0), (60.0, 100.0)]);
        assert_eq!(of(&[10, 30, 50, 70, 90], false), []);
        assert_eq!(of(&[], false), [(0.0, 100.0)]);
        assert_eq!(of(&[0, 100], false), [(10.0, 90.0)]);
    }

    #[test]
    fn on_a_closed_contour_a_point_speaks_across_the_seam() {
        assert_eq!(of(&[2], true), [(12.0, 92.0)]);
        assert_eq!(of(&[98], true), [(8.0, 88.0)]);
        assert_eq!(of(&[2], false), [(12.0, 100.0)]);
    }

    #[test]
    fn the_words_name_a_few_stretches_and_count_the_rest() {
        let far: Vec<Touched> = (0..20).map(|k| at(k * 1000)).collect();
        let found = coverage(&far, Extent { length: um(19_000_000), depth: um(10_000), closed: false }, REACH);
        assert_eq!(found.stretches.len(), 19);
        assert!(
            found.words(Unit::Millimetre).contains("10.0 to 990.0")
                && found.words(Unit::Millimetre).contains("mm, and 13 more stretches."),
            "{}",
            found.words(Unit::Millimetre)
        );
    }
}
