//! The families of cases: each is a distribution over geometry, cut, machine, beliefs and probe places.
//!
//! The numbers of a case are drawn from the ranges written in the family's function; what is not said there comes from the
//! general ranges of [`super::part`], [`super::machine`], [`super::prior`] and [`super::places`]. The families are fixed: their ranges
//! say what is milled in workshops, not what the method does well.

mod closed;
mod corners;
mod curves;
mod cutters;

use super::draw::Draw;
use super::part::Part;

/// A family of cases.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Its name in case ids and on the command line.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Draws a part.
    pub draw: fn(&mut Draw) -> Part,
}

/// All families, in the order of the tables.
pub const FAMILIES: &[Family] = &[
    Family { name: "corner-papers", title: "corner of the 2018 and 2023 papers, mean law", draw: corners::papers_mean },
    Family { name: "corner-papers-helix", title: "the same corner, helical", draw: corners::papers_helix },
    Family {
        name: "corner-mean-auto",
        title: "mean-law machine that the job does not know of",
        draw: corners::mean_auto,
    },
    Family { name: "corner-far", title: "inside corner between sloped walls, far from the origin", draw: corners::far },
    Family { name: "corner-wide", title: "inside corner of 25 to 60 degrees", draw: corners::wide },
    Family { name: "corner-sharp", title: "inside corner of 110 to 140 degrees", draw: corners::acute },
    Family { name: "corners-two", title: "three walls with two inside corners", draw: corners::two },
    Family { name: "outside-conventional", title: "outside corner, conventional", draw: corners::outside_conventional },
    Family { name: "outside-climb", title: "two outside corners, climb", draw: corners::outside_climb },
    Family { name: "wall-straight", title: "one long sloped wall", draw: corners::wall },
    Family { name: "pocket-climb", title: "rectangular pocket, climb", draw: closed::pocket_climb },
    Family {
        name: "pocket-conventional",
        title: "rectangular pocket, conventional",
        draw: closed::pocket_conventional,
    },
    Family {
        name: "pocket-tight",
        title: "pocket whose corner path has a radius of 1 to 3 mm",
        draw: closed::pocket_tight,
    },
    Family { name: "pocket-l", title: "L-shaped pocket: inside corners and an outside one", draw: closed::pocket_l },
    Family { name: "pocket-slot", title: "long pocket with round ends", draw: closed::slot },
    Family { name: "boss", title: "rectangular boss, climb or conventional", draw: closed::boss },
    Family { name: "bore", title: "bore along a full circle", draw: closed::bore },
    Family { name: "boss-round", title: "round boss along a full circle", draw: closed::boss_round },
    Family { name: "wave", title: "open wavy wall in short lines", draw: curves::wave },
    Family { name: "corner-in-lines", title: "inside corner in short lines", draw: curves::corner_in_lines },
    Family { name: "ellipse", title: "elliptic pocket in hundreds of short lines", draw: curves::ellipse },
    Family { name: "s-two-teeth", title: "tangent S of two arcs, two teeth", draw: curves::s_two_teeth },
    Family { name: "s-arcs", title: "tangent S of two arcs, three to six teeth", draw: curves::s_arcs },
    Family { name: "profile", title: "tangent lines and arcs, inside and outside by turns", draw: curves::profile },
    Family { name: "soft-cross", title: "soft machine with strong cross compliance", draw: cutters::soft_cross },
    Family { name: "slender", title: "slender two-flute cutter in aluminium", draw: cutters::slender },
    Family { name: "helix-high", title: "four flutes, 45 degrees", draw: cutters::helix_high },
    Family { name: "helix-low", title: "helix of 5 to 15 degrees", draw: cutters::helix_low },
    Family { name: "allowance-high", title: "an allowance of 0.3 to 0.5 cutter radii", draw: cutters::allowance_high },
    Family { name: "left-hand", title: "left-hand cutter (M4), wall on either side", draw: cutters::left_hand },
    Family { name: "feeds", title: "several feeds along the contour", draw: cutters::feeds },
    Family { name: "finishing", title: "light finishing cut in steel", draw: cutters::finishing },
];

/// The family of a name.
pub fn family(name: &str) -> Option<&'static Family> {
    FAMILIES.iter().find(|family| family.name == name)
}
