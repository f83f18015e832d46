//! Further places, given what was measured.

use truepath_core::checksum::crc32;
use truepath_correction::correct::correct_pass;
use truepath_correction::further::{next, next_part};
use truepath_correction::learning::History;
use truepath_correction::verification::{Plan, ProbeDialect, Settings, write};
use truepath_ground::diagnostics::{Form, Source};
use truepath_job::job::Route;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::{Machine, Milled};
use truepath_trial::virtual_mill;

use super::parts::{HELIX, pass};

const PLANT: &str = include_str!("../../../demo/corner-helix/plant.toml");
const HEIGHTS: [f64; 3] = [0.3, 0.6, 0.9];
/// Straight walls, away from the corner at s = 45 … 52.9 mm.
const STRAIGHT: [f64; 4] = [20.0, 30.0, 70.0, 85.0];

/// The virtual machine with its first part on it.
struct Shop {
    pass: Pass,
    machine: Machine,
    milled: Milled,
}

impl Shop {
    fn open() -> Self {
        let machine: Machine = toml::from_str(PLANT).unwrap();
        Self::with_seed(machine.seed)
    }
    fn with_seed(seed: u64) -> Self {
        let (pass, machine) = (pass(HELIX, &[]), Machine { seed, ..toml::from_str(PLANT).unwrap() });
        let milled = virtual_mill::mill(&pass, &machine, None).unwrap();
        Self { pass, machine, milled }
    }
    fn measured(&self, places: &[f64]) -> Measurement {
        let text = virtual_mill::probe(&self.pass, &self.milled, places, &HEIGHTS, 6.0).unwrap();
        Measurement::read(&self.pass, &Source::new("probe.txt", text.into_bytes())).unwrap()
    }
    fn next(&self, places: &[f64], count: u32) -> Plan {
        let settings = Settings { places: count, ..Settings::default() };
        next(&self.pass, &self.measured(places), &settings, &mut |_| ())
            .unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
    }
    /// Largest wall error of the part cut with the correction from these places, mm.
    fn corrected(&self, places: &[f64]) -> f64 {
        let done = correct_pass(&self.pass, &self.measured(places), &[], &[Route::Program], &mut |_| ()).unwrap();
        let text = done.program.unwrap();
        virtual_mill::mill_program(&self.pass, &self.machine, &text).unwrap().score().max_error_mm
    }
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn with_straight_walls_known_the_corner_comes_next_and_touching_it_pays() {
    let shop = Shop::open();
    let plan = shop.next(&STRAIGHT, 2);
    let first = plan.places.iter().find(|p| p.rank == 0).unwrap();
    assert!((42.0..56.0).contains(&first.s_mm), "{first:?}");
    let gain = first.gain.unwrap();
    assert!((40.0..58.0).contains(&gain.worst_s_mm) && gain.worth_it, "{gain:?}");
    assert!(gain.max_sigma_after_mm < 0.6 * gain.max_sigma_before_mm, "{gain:?}");

    // Five draws of the noise, each touched three ways; what each leaves is the median: of nine 0.029, 0.017 and 0.024 mm.
    let further: Vec<f64> = plan.places.iter().map(|p| p.s_mm).collect();
    let straight = [25.0, 77.0];
    assert_eq!(further.len(), straight.len());
    let left = |more: &[f64]| {
        let mut places = [&STRAIGHT, more].concat();
        places.sort_by(f64::total_cmp);
        [1, 2, 3, 4, 5].map(|seed| Shop::with_seed(seed).corrected(&places))
    };
    let all = [left(&[]), left(&further), left(&straight)];
    let [before, corner, straight] = all.map(|mut left| {
        left.sort_by(f64::total_cmp);
        left[2]
    });
    println!("before {before:.4}, corner {corner:.4}, straight {straight:.4} mm, {all:.4?}");
    assert!(corner < 0.6 * before && corner < 0.75 * straight, "{before}: corner {corner}, straight {straight}");
    let better = |than: [f64; 5]| all[1].iter().zip(than).filter(|(corner, other)| *corner < other).count();
    assert!(better(all[0]) == 5 && better(all[2]) >= 4, "{all:?}");
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn on_the_next_part_the_places_are_chosen_from_the_history_and_its_datum_is_open_again() {
    let shop = Shop::open();
    let measurement = shop.measured(&STRAIGHT);
    let done = correct_pass(&shop.pass, &measurement, &[], &[Route::Program], &mut |_| ()).unwrap();
    let history = History::first(&shop.pass, &measurement, &done).unwrap();
    let settings = Settings { places: 2, ..Settings::default() };
    let planned = |points: Option<&Measurement>| next_part(&shop.pass, &history, points, &settings, &mut |_| ());
    let plan = planned(None).unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)));
    let first = plan.places.iter().find(|p| p.rank == 0).unwrap();
    assert!((42.0..56.0).contains(&first.s_mm), "{first:?}");
    let same = shop.next(&STRAIGHT, 2);
    let datum = |plan: &Plan| plan.unknowns.iter().find(|u| u.name == "datum_x").unwrap().remaining;
    assert!(datum(&plan) > datum(&same) - 1e-6, "{} {}", datum(&plan), datum(&same));
    // The points of the first part are not those of the second.
    let refused = planned(Some(&measurement)).expect_err("known points").render(Form::Plain);
    assert!(refused.contains("Q003"), "{refused}");
    // Nor are those of a part that the program itself has cut.
    let other =
        planned(Some(&shop.measured(&[22.0, 33.0, 47.0, 72.0]))).expect_err("no correction").render(Form::Plain);
    assert!(other.contains("Q007"), "{other}");
    // The program names the correction whose part it touches, so that its results are taken for no other part.
    let crc = format!("{:08x}", crc32(done.program.as_deref().unwrap()));
    assert_eq!(plan.correction.map(|crc| format!("{crc:08x}")), Some(crc.clone()));
    for (dialect, line) in [
        (ProbeDialect::Linuxcnc, format!("(LOG,# correction {crc})")),
        (ProbeDialect::Grbl, format!(";VERIFY CORRECTION {crc}")),
        (ProbeDialect::Fanuc, format!("DPRNT[CORRECTION*{}]", crc.to_uppercase())),
        (ProbeDialect::Haas, format!("DPRNT[CORRECTION*{}]", crc.to_uppercase())),
    ] {
        assert!(write(&plan, dialect, "log.txt").unwrap().lines().any(|l| l == line), "{dialect:?}");
        assert!(!write(&same, dialect, "log.txt").unwrap().contains(&crc), "{dialect:?}");
    }
    // Touched once, the second part is touched elsewhere.
    let second = virtual_mill::mill_program(&shop.pass, &shop.machine, done.program.as_deref().unwrap()).unwrap();
    let text = virtual_mill::probe(&shop.pass, &second, &[46.0, 48.5], &HEIGHTS, 6.0).unwrap();
    let points = Measurement::read(&shop.pass, &Source::new("probe-2.txt", text.into_bytes())).unwrap();
    let plan = planned(Some(&points)).unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)));
    assert!(plan.wall_sigma_mm[0] < 0.5 * same.wall_sigma_mm[0], "{:?}", plan.wall_sigma_mm);
    assert!(plan.places.iter().all(|p| (p.s_mm - 46.0).abs() > 1.3 && (p.s_mm - 48.5).abs() > 1.3));
}

#[test]
fn the_list_ends_where_touching_is_no_longer_worth_it() {
    let shop = Shop::open();
    let many = [20.0, 26.0, 32.0, 37.0, 46.0, 47.5, 50.0, 53.0, 56.0, 60.0, 66.0, 72.0, 78.0, 84.0];
    let plan = shop.next(&many, 6);
    assert_eq!(plan.places.len(), 1, "{:?}", plan.places);
    assert!(!plan.places[0].gain.unwrap().worth_it);
    assert!(plan.warnings.iter().any(|w| w.contains("not worth touching")), "{:?}", plan.warnings);
    // Who asks for so many gets them.
    let all = Settings { places: 2, exactly: true, ..Settings::default() };
    let asked = next(&shop.pass, &shop.measured(&many), &all, &mut |_| ()).unwrap();
    assert_eq!(asked.places.len(), 2, "{:?}", asked.places);
    // Not where the ball was before.
    let far = |p: f64| many.iter().all(|s| (s - p).abs() > 2.0);
    assert!(plan.places.iter().all(|p| far(p.s_mm)), "{:?}", plan.places);
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn where_stock_is_uneven_the_gaps_between_the_touches_come_next() {
    let mut shop = Shop::open();
    shop.machine.stock_variation_mm = 0.4;
    shop.machine.stock_wavelength_mm = 30.0;
    shop.milled = virtual_mill::mill(&shop.pass, &shop.machine, None).unwrap();
    let plan = shop.next(&[12.0, 16.0, 20.0, 46.0, 49.0, 52.0, 56.0, 60.0, 64.0], 3);
    let first = plan.places.iter().find(|p| p.rank == 0).unwrap();
    assert!((23.0..43.0).contains(&first.s_mm) || first.s_mm > 68.0, "{first:?}");
    assert!(first.why.contains("what only this place has"), "{}", first.why);
    let both = plan.places.iter().any(|p| (23.0..43.0).contains(&p.s_mm)) && plan.places.iter().any(|p| p.s_mm > 68.0);
    assert!(both, "{:?}", plan.places);
}
