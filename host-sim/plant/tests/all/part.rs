//! Several runs over one part.

use truepath_plant::{Equilibrium, Heights, Part, Run, Surface, judged_trim_mm};

use super::*;

/// The nominal path as a run.
fn along(path: &Path, cut: &Cut) -> Run {
    Run::even(path.centre.clone(), 0.0, cut.feed_mm_per_min, cut.spindle_rpm)
}

fn part(path: &Path, cut: &Cut, machine: &Machine) -> Part {
    Part::new(path, cut, machine, &Heights::of(0.0, cut.axial_depth_mm)).expect("a part")
}

/// Largest difference over the judged places of two walls at the middles of the slices.
fn apart(a: &Surface, b: &Surface, trim: f64) -> f64 {
    let at = |surface: &Surface, k: usize, s: f64| {
        let j = surface.s_mm.partition_point(|x| *x < s).clamp(1, surface.s_mm.len() - 1);
        let (s0, s1) = (surface.s_mm[j - 1], surface.s_mm[j]);
        let u = if s1 > s0 { (s - s0) / (s1 - s0) } else { 0.0 };
        surface.errors_mm[k][j - 1] * (1.0 - u) + surface.errors_mm[k][j] * u
    };
    let length = b.s_mm[b.s_mm.len() - 1];
    let mut most = 0.0f64;
    for k in 0..b.errors_mm.len() {
        for s in b.s_mm.iter().filter(|s| **s > trim && **s < length - trim) {
            most = most.max((at(a, k, *s) - at(b, k, *s)).abs());
        }
    }
    most
}

#[test]
fn one_pass_over_even_stock_is_the_pass_of_mill() {
    for (name, machine) in [("p23", p23()), ("hard", Machine { bend: 0.0, ..hard() })] {
        let path = Path::new(&corner(), Side::Right, 0.1).expect("a path");
        let milled = mill(&path, &d20(), &machine, None).expect("milled");
        let one = Surface::of(&milled, 0.0, 30);
        let start = std::time::Instant::now();
        for equilibrium in [Equilibrium::Mean, Equilibrium::Instant] {
            let mut part = part(&path, &d20(), &machine).with(equilibrium);
            assert_eq!(part.cut(&along(&path, &d20())), Ok(1));
            let trim = judged_trim_mm(10.0);
            println!("{name} {equilibrium:?} {:?} {:?}", part.laps(), apart(&part.surface(), &one, trim));
            let (a, b) = (part.surface().score(trim).expect("s"), one.score(trim).expect("s"));
            println!("{:?} {:?} {:?} / {:?} {:?} {:?} {:?}", a.mean_over_height_mm, a.profile_mm, a.p95_mm, b.mean_over_height_mm, b.profile_mm, b.p95_mm, start.elapsed());
        }
    }
}
