//! The sections of a pocket: straight where the engagement is steady, corner where the path turns or the engagement
//! changes.
//!
//! LG03 divides a pocket into linear and corner sections at the borders of the program's blocks. The load of a corner
//! rises before its arc begins and falls before it ends (by 7 mm on a 20 mm cutter), so the borders here lie where the
//! engagement that the program intends leaves that of the straight wall.

use truepath_ground::rows::median;

use super::station::Station;

/// What a section is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The engagement is steady.
    Straight,
    /// The path turns, or the engagement changes on the way to or from a turn.
    Corner,
    /// Around an inside corner without an arc.
    Sharp,
    /// The engagement changes though the path does not turn: on the way into material already cut.
    Change,
}

/// A section: stations `from..to`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// S1, S2 … straight, C1, C2 … corners, E1, E2 … changes of engagement, in the order of the path.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// First station.
    pub from: usize,
    /// Behind the last station.
    pub to: usize,
}

/// Change of engagement that ends a straight section, rad, and as a share of it.
const STEADY_RAD: f64 = 0.2 * std::f64::consts::PI / 180.0;
const STEADY_SHARE: f64 = 0.004;
/// Shorter straight sections belong to what is around them, mm.
const SHORTEST_MM: f64 = 1.0;

/// Divides a path by the engagement that the program intends, rad, one per station.
pub fn sections(stations: &[Station], nominal: &[f64]) -> Vec<Section> {
    let mut kinds = kinds(stations, nominal);
    absorb(stations, &mut kinds);
    let mut found: Vec<Section> = Vec::new();
    for (i, kind) in kinds.iter().enumerate() {
        match found.last_mut() {
            Some(last) if last.kind == *kind && !apart(stations, i) => last.to = i + 1,
            _ => found.push(Section { name: String::new(), kind: *kind, from: i, to: i + 1 }),
        }
    }
    for section in &mut found {
        let turning = |i: usize| stations[i].turns || i > section.from && bent(stations, i);
        if section.kind == Kind::Corner && !(section.from..section.to).any(turning) {
            section.kind = Kind::Change;
        }
    }
    name(&mut found);
    found
}

fn name(sections: &mut [Section]) {
    let mut counts = [0; 3];
    for section in sections {
        let (letter, which) = match section.kind {
            Kind::Straight => ('S', 0),
            Kind::Corner | Kind::Sharp => ('C', 1),
            Kind::Change => ('E', 2),
        };
        counts[which] += 1;
        section.name = format!("{letter}{}", counts[which]);
    }
}

/// Whether the path has another direction at a station than at the one before.
fn bent(stations: &[Station], i: usize) -> bool {
    let (a, b) = (&stations[i - 1], &stations[i]);
    a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1] < 0.9
}

/// Whether the path turns sharply between a station and the one before, with no corner section between them.
fn apart(stations: &[Station], i: usize) -> bool {
    !stations[i].held && !stations[i - 1].turns && !stations[i].turns && bent(stations, i)
}

fn kinds(stations: &[Station], nominal: &[f64]) -> Vec<Kind> {
    let mut kinds = vec![Kind::Corner; stations.len()];
    let mut from = 0;
    while from < stations.len() {
        let block = stations[from].block;
        let to = from + stations[from..].iter().take_while(|s| s.block == block).count();
        let steady = median(&mut nominal[from..to].to_vec());
        for i in from..to {
            let off = (nominal[i] - steady).abs();
            kinds[i] = match (stations[i].held, stations[i].turns) {
                (true, _) => Kind::Sharp,
                (false, true) => Kind::Corner,
                (false, false) if off > STEADY_RAD.max(STEADY_SHARE * steady) => Kind::Corner,
                (false, false) => Kind::Straight,
            };
        }
        from = to;
    }
    kinds
}

/// Very short stretches of a kind become part of the corner they lie in.
fn absorb(stations: &[Station], kinds: &mut [Kind]) {
    let mut from = 0;
    while from < kinds.len() {
        let to = from + kinds[from..].iter().take_while(|k| **k == kinds[from]).count();
        let length = stations[to - 1].s_mm - stations[from].s_mm;
        let between = from > 0 || to < kinds.len();
        if kinds[from] == Kind::Straight && length < SHORTEST_MM && between {
            let kind = if from > 0 { kinds[from - 1] } else { kinds[to] };
            kinds[from..to].fill(kind);
        }
        from = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(blocks: &[(f64, bool)]) -> Vec<Station> {
        let mut stations = Vec::new();
        let mut s = 0.0;
        for (block, (length, turns)) in blocks.iter().enumerate() {
            for k in 0..(length * 10.0) as usize {
                stations.push(Station {
                    s_mm: s + 0.1 * k as f64,
                    point: [0.0; 2],
                    normal: [1.0, 0.0],
                    heading: [0.0, 1.0],
                    block,
                    line: block as u32,
                    feed_mm_per_min: 400.0,
                    turns: *turns,
                    held: false,
                });
            }
            s += length;
        }
        stations
    }

    #[test]
    fn a_corner_begins_where_the_engagement_leaves_that_of_the_wall() {
        let stations = along(&[(40.0, false), (8.0, true), (40.0, false)]);
        // The load rises 7 mm before the arc.
        let nominal: Vec<f64> =
            stations.iter().map(|s| 0.8 + 0.08 * (s.s_mm - 33.0).clamp(0.0, 7.0) * f64::from(s.s_mm < 48.0)).collect();
        let found = sections(&stations, &nominal);
        let names: Vec<&str> = found.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["S1", "C1", "S2"]);
        let border = stations[found[1].from].s_mm;
        assert!((33.0..33.3).contains(&border), "{border}");
        assert_eq!(found[0].to, found[1].from);
        assert_eq!(found[2].to, stations.len());
    }

    #[test]
    fn a_scrap_of_wall_between_two_arcs_belongs_to_the_corner() {
        let stations = along(&[(20.0, false), (5.0, true), (0.5, false), (5.0, true), (20.0, false)]);
        let nominal = vec![0.8; stations.len()];
        let kinds: Vec<Kind> = sections(&stations, &nominal).iter().map(|s| s.kind).collect();
        assert_eq!(kinds, [Kind::Straight, Kind::Corner, Kind::Straight]);
    }
}
