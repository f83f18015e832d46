//! Where the plans go, and where they keep off.

use truepath_correction::verification::{KeptOff, Settings, plan};
use truepath_ground::diagnostics::Failure;

use super::parts::{CORNER, HELIX, PARTS, POCKET, pass, planned};
use super::wall::Wall;

#[test]
fn the_ball_keeps_its_margin_from_every_wall_until_the_last_approach() {
    for part in PARTS {
        let pass = pass(part, &[]);
        let (plan, wall) = (planned(&pass, &Settings::default()), Wall::of(&pass, |_| 0.0));
        let ball = plan.ball_mm / 2.0;
        assert_eq!(plan.places.len(), 8);
        for place in &plan.places {
            let (from, to) = (plan.stand_off(place), plan.search_end(place));
            assert!(wall.distance(from) > ball + 1.0 - 0.003, "{from:?}");
            // On the way the nearest wall is the place itself: the distance falls as the ball advances.
            for k in 0..=20 {
                let away = ball + plan.settings.clearance * f64::from(20 - k) / 20.0;
                let centre = [place.wall[0] + place.normal[0] * away, place.wall[1] + place.normal[1] * away];
                assert!((wall.distance(centre) - away).abs() < 0.003, "{centre:?}");
            }
            assert!((to[0] - from[0]).hypot(to[1] - from[1]) - plan.settings.clearance - 1.0 < 1e-9);
        }
    }
}

#[test]
fn the_ball_stays_above_the_floor_and_inside_the_engaged_depth() {
    for (change, lift) in [("z_reference = \"centre\"", 0.0), ("z_reference = \"tip\"", 2.0)] {
        let pass = pass(POCKET, &[("z_reference = \"centre\"", change)]);
        let plan = planned(&pass, &Settings { heights: Some(5), ..Settings::default() });
        let heights = &plan.places[0].heights;
        assert_eq!(heights.len(), 5);
        for height in heights {
            let centre = height.z_mm + lift;
            assert!(centre - 2.0 >= -12.0 + 0.5 - 1e-9 && centre <= -1.2 + 1e-9, "{centre}");
            assert!((height.fraction * 12.0 - (centre + 12.0)).abs() < 1e-9);
        }
        assert!(heights.is_sorted_by(|a, b| a.z_mm > b.z_mm), "from the highest down");
    }
}

#[test]
fn leads_ends_sharp_corners_and_jumps_of_the_load_are_kept_off() {
    let plan_of = |part, changes: &[(&str, &str)]| planned(&pass(part, changes), &Settings::default());
    let corner = plan_of(CORNER, &[]);
    assert!(corner.kept_off[&KeptOff::End] > 0 && corner.kept_off[&KeptOff::Unsteady] > 0);
    assert!(corner.places.iter().all(|p| p.s_mm > 13.0 - 0.01 && p.s_mm < 103.9 - 13.0));
    // The papers' load rises from 7 mm before the arc to its start (s = 45 mm).
    assert!(corner.places.iter().all(|p| !(40.5..44.8).contains(&p.s_mm)), "{:?}", corner.places);

    // Leads of quarter circles in the free pocket, and 5 mm milled twice.
    let lead_in = (
        "G00 X0. Y-20. Z10. M08\nG01 Z-12. F600.\n",
        "G00 X-12. Y-8. Z10. M08\nG01 Z-12. F600.\nG03 X0. Y-20. I12. J0.\n",
    );
    let lead_out = ("G01 X0. Y-20.\nG00 Z100.", "G01 X5. Y-20.\nG03 X17. Y-8. I0. J12.\nG00 Z100.");
    let with_leads = plan_of(POCKET, &[lead_in, lead_out]);
    let on_wall = |p: &[f64; 2]| (p[0].abs() - 35.0).abs().min((p[1].abs() - 25.0).abs()) < 2.7;
    assert!(with_leads.places.iter().all(|p| on_wall(&p.wall)), "{:?}", with_leads.places);
    // 5 mm milled twice, and radius of cutter and ball to both sides.
    let marked = |p: &[f64; 2]| p[1] < -24.9 && p[0] > -7.0 && p[0] < 12.0;
    assert!(!with_leads.places.iter().any(|p| marked(&p.wall)), "{:?}", with_leads.places);
    // The leads of 18.8 mm on either side are no part of the contour.
    assert!((1..2 * 18).contains(&with_leads.kept_off[&KeptOff::End]), "{:?}", with_leads.kept_off);

    // The corner as two lines.
    let sharp = ("G01 X34. Y35. F250.\nG03 X39. Y30. I5. J0 F150.", "G01 X34. Y30. F250.");
    let sharp = plan_of(CORNER, &[sharp]);
    assert!(sharp.kept_off[&KeptOff::SharpCorner] > 0);
    assert!(sharp.places.iter().all(|p| (p.wall[0] - 24.0).hypot(p.wall[1] - 20.0) > 10.0));
}

#[test]
fn a_ball_that_does_not_fit_is_refused_with_the_reason() {
    let refused = |part, changes: &[(&str, &str)], settings: Settings| {
        let Err(Failure::Input(error)) = plan(&pass(part, changes), &settings, &mut |_| ()) else { panic!("planned") };
        (error.code().to_owned(), error.to_string())
    };
    let ball = |d| format!("ball_diameter_mm = {d}");
    let (code, text) = refused(POCKET, &[("ball_diameter_mm = 4.0", &ball("22.0"))], Settings::default());
    assert_eq!((code.as_str(), text.contains("as one of 6 mm has")), ("V002", true), "{text}");
    // 8 mm ball, 2 mm clearance: 10 mm, which the cutter of 10 mm has just cleared; 3 mm of clearance have not.
    let wide = |clearance| Settings { clearance, ..Settings::default() };
    let (code, text) = refused(POCKET, &[("ball_diameter_mm = 4.0", &ball("8.0"))], wide(3.0));
    assert_eq!((code.as_str(), text.contains("11 mm")), ("V003", true), "{text}");
    planned(&pass(POCKET, &[("ball_diameter_mm = 4.0", &ball("8.0"))]), &wide(2.0));
    // What the user vouches for is taken, and said.
    let trusted = Settings { clearance: 3.0, free_width: Some(20.0), ..Settings::default() };
    let plan = planned(&pass(POCKET, &[("ball_diameter_mm = 4.0", &ball("8.0"))]), &trusted);
    assert!(plan.warnings.iter().any(|w| w.contains("--free-width")));
    let (code, _) = refused(POCKET, &[], Settings { safe_z: Some(-1.0), ..Settings::default() });
    assert_eq!(code, "V001");
}

#[test]
fn a_tight_corner_whose_load_is_nowhere_steady_is_touched_all_the_same() {
    // An arc of 3 mm of the centre of a cutter of 20 mm: 4.7 mm of its path.
    let tight = [("Y35. F250.", "Y33. F250."), ("G03 X39. Y30. I5.", "G03 X37. Y30. I3.")];
    let plan = planned(&pass(HELIX, &tight), &Settings::default());
    let corner: Vec<_> = plan.places.iter().filter(|place| (46.0..53.0).contains(&place.s_mm)).collect();
    assert!(corner.iter().any(|place| place.what.contains("where the load changes")), "{:?}", plan.places);
}

#[test]
fn a_ball_too_large_for_a_shallow_wall_has_a_smaller_one_named() {
    let wall = |depth: &str, ball: &str| {
        let depth = format!("axial_depth_mm = {depth}");
        pass(
            HELIX,
            &[("axial_depth_mm = 10.0", &depth), ("ball_diameter_mm = 6.0", &format!("ball_diameter_mm = {ball}"))],
        )
    };
    let named = |depth, ball, heights| {
        let settings = Settings { heights, ..Settings::default() };
        let plan = planned(&wall(depth, ball), &settings);
        let said = plan.warnings.iter().any(|w| w.to_string().contains("the rest of it is the model's word"));
        assert_eq!(said, plan.smaller_ball_mm.is_some());
        plan.smaller_ball_mm
    };
    // 60 % of the height, or 40 % where none reaches that, also where there is room for one height only.
    assert_eq!(named("6.0", "6.0", None), Some(1.5));
    assert_eq!(named("4.5", "6.0", None), Some(2.0));
    assert_eq!(named("4.5", "6.0", Some(1)), None, "one was asked for");
    assert_eq!(named("10.0", "6.0", None), None);
    let Err(Failure::Input(error)) = plan(&wall("3.0", "6.0"), &Settings::default(), &mut |_| ()) else {
        panic!("planned")
    };
    assert!(error.to_string().contains("as one of 2 mm has"), "{error}");
}

#[test]
fn in_a_bay_narrower_than_ball_and_stand_off_no_place_is_chosen() {
    // A slot 12 mm wide between two straight walls, milled round with a cutter of 10 mm: 2 mm between the passes.
    let slot = "G21 G90 G17 G54\nT2 M6\nS3200 M3\nG0 X0 Y-1 Z10\nG1 Z-12 F600\nG1 X30\nG3 Y1 J1\nG1 X-30\nG3 Y-1 J-1\nG1 X0\nG0 Z100\nM30\n";
    let part = [POCKET[0], slot];
    let fits = planned(&pass(part, &[]), &Settings::default());
    assert!(!fits.places.is_empty());
    let wide = Settings { clearance: 6.5, free_width: Some(100.0), ..Settings::default() };
    let pass = pass(part, &[]);
    let Err(Failure::Input(error)) = plan(&pass, &wide, &mut |_| ()) else { panic!("planned") };
    assert_eq!(error.code(), "V004");
    assert!(error.to_string().contains("not proved free"), "{error}");
}

#[test]
fn the_touches_leave_less_than_a_tenth_of_the_uncertainty_and_every_place_has_a_reason() {
    for part in [HELIX, POCKET] {
        let plan = planned(&pass(part, &[]), &Settings::default());
        let [before, after] = plan.wall_sigma_mm;
        assert!(after < before / 10.0, "{before} -> {after}");
        let first = plan.places.iter().find(|p| p.rank == 0).unwrap();
        assert!(first.why.contains("stiffness"), "{}", first.why);
        assert!(plan.places.iter().all(|p| !p.why.is_empty() && !p.what.is_empty()));
        // Both axes are looked at.
        assert!(
            plan.places.iter().any(|p| p.normal[0].abs() > 0.9) && plan.places.iter().any(|p| p.normal[1].abs() > 0.9)
        );
    }
}
