//! What CAM systems and machinists write at corners: rolled with the cutter's own radius, and the start of a closed
//! contour at several depths, plain, in a loop and in a subprogram. Each program is the smallest that shows it.

use std::fmt::Write;
use std::path::Path;

use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

fn job(diameter: f64, wall: &str, law: &str) -> String {
    format!(
        "version = 1\nprogram = \"program.nc\"\nwall = \"{wall}\"\n[stock]\nallowance_mm = 0.5\n[tool]\n\
         diameter_mm = {diameter}\nteeth = 4\nhelix_deg = 38.0\n[cut]\naxial_depth_mm = 10.0\n[force]\n\
         material = \"al-7075-t6\"\nmodel = \"{law}\"\n[machine]\nstiffness_x_n_per_mm = 1900\n\
         stiffness_y_n_per_mm = 1900\n[probe]\nball_diameter_mm = 4.0\nformat = \"linuxcnc\"\nz_reference = \"centre\"\n"
    )
}

fn pass(job: &str, program: &str) -> Pass {
    let job = JobFile::parse(Source::new("job.toml", job.as_bytes().to_vec()), Path::new("")).unwrap();
    shown(Pass::new(job, Source::new("program.nc", program.as_bytes().to_vec())))
}

fn corrected(pass: &Pass, probe: String) -> CorrectedPass {
    let file = Source::new("probe.txt", probe.into_bytes());
    let measurement = shown(Measurement::read(pass, &file));
    shown(correct_pass(pass, &measurement, &[], &[Route::Program], &mut |_| ()))
}

fn text(done: &CorrectedPass) -> &str {
    std::str::from_utf8(done.program.as_deref().unwrap()).unwrap()
}

/// Machine of the test: not the one the job states.
const PLANT: &str = "ktc_n_per_mm2 = 900\nkrc_n_per_mm2 = 250\nkte_n_per_mm = 10\nkre_n_per_mm = 13\n\
    size_exponent = 0.15\ncompliance_mm_per_n = [[0.0006, 0.00002], [0.00002, 0.0005]]\nbend = 0.1\n\
    probe_noise_mm = 0.001\nseed = 3\n";

/// Two legs of 50 and 100 mm, wall on the right, and what joins them.
fn legs(corner: &str) -> String {
    format!(
        "G21 G90 G17\nT1 M6\nS4000 M3\nG0 X-5 Y-12 Z10\nG1 Z-10 F500\nG1 Y50 F600\n{corner}\nG1 X100\nG0 Z10\nM30\n"
    )
}

fn faceted(lines: u32) -> String {
    (1..=lines).fold(String::new(), |mut text, k| {
        let angle = f64::from(k) / f64::from(lines) * std::f64::consts::FRAC_PI_2;
        let end = if k == lines { "" } else { "\n" };
        write!(text, "G1 X{:.3} Y{:.3}{end}", -5.0 * angle.cos(), 50.0 + 5.0 * angle.sin()).unwrap();
        text
    })
}

#[test]
fn an_outside_corner_rolled_with_the_cutters_own_radius_is_corrected_on_both_legs() {
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let arc = "G2 X0 Y55 I5 J0".to_owned();
    let cases = [
        (10.0, arc.clone(), "helical"),
        (10.0, arc.clone(), "mean"),
        (9.998, arc.clone(), "helical"),
        (10.002, arc.clone(), "helical"),
        (9.98, arc.clone(), "helical"),
        (10.02, arc, "helical"),
        (10.0, faceted(9), "helical"),
        (10.0, faceted(90), "helical"),
    ];
    for (diameter, corner, law) in cases {
        let case = format!("{diameter} mm, {law}, {}", &corner[..15]);
        let pass = pass(&job(diameter, "right", law), &legs(&corner));
        let milled = shown(virtual_mill::mill(&pass, &machine, None));
        // Two places on either leg.
        let places = [25.0, 50.0, 100.0, 140.0];
        let done = corrected(&pass, shown(virtual_mill::probe(&pass, &milled, &places, &[0.1, 0.5, 0.9], 4.0)));
        assert!(done.summary.max_correction_mm < 0.15, "{case}: {}", done.summary.max_correction_mm);
        let path = shown(virtual_mill::commanded(&pass, text(&done).as_bytes()));
        let again = shown(virtual_mill::mill(&pass, &machine, Some(&path)));
        let levels: Vec<f64> = (0..10).map(|k| (f64::from(k) + 0.5) / 10.0).collect();
        // The mean over the height, beside both legs up to a millimetre from the edge, away from the ends.
        let worst = |part: &truepath_plant::Milled| {
            let rows = part.wall_errors(&levels);
            let s = &part.path.s_mm;
            let judged = |s: f64| (8.0..61.0).contains(&s) || (71.0..160.0).contains(&s);
            let mean = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>() / levels.len() as f64;
            (0..s.len()).filter(|i| judged(s[*i])).map(|i| mean(i).abs()).fold(0.0, f64::max)
        };
        let (before, after) = (worst(&milled), worst(&again));
        assert!(before > 0.03 && after < before / 5.0, "{case}: {before} -> {after}");
    }
}

/// Ball centres beside a boss of 70 by 50 mm that came out 24 um too large, two heights above `z`.
fn beside_boss(z: f64) -> String {
    let mut text = String::new();
    for up in [1.0, 2.5] {
        let z = z + up;
        for x in [20.0, 40.0, 60.0] {
            writeln!(text, "{x} {:.4} {z} 0 0 0 0 0 0\n{x} {:.4} {z} 0 0 0 0 0 0", 2.976, 57.024).unwrap();
        }
        for y in [20.0, 30.0, 40.0] {
            writeln!(text, "{:.4} {y} {z} 0 0 0 0 0 0\n{:.4} {y} {z} 0 0 0 0 0 0", 2.976, 77.024).unwrap();
        }
    }
    text
}

#[test]
fn a_closed_contour_that_begins_at_a_corner_is_corrected_at_every_depth() {
    let lap = "G1 X80 F600\nG1 Y60\nG1 X0\nG1 Y0\n";
    for end in ["G0 Z10\nM30\n", "G0 Z10\nG91 G28 X0 Z0\nG28 Y0\nM30\n", "G0 Z10\nG91 G28 Z0\nG28 Y0\nG28 X0\nM30\n"] {
        let program = format!(
            "G21 G90 G17\nT1 M6\nS4000 M3\nG0 X0 Y0 Z10\nG1 Z-4 F300\n{lap}G1 Z-8 F300\n{lap}G1 Z-12 F300\n{lap}{end}"
        );
        let job = job(10.0, "left", "auto").replace("axial_depth_mm = 10.0", "axial_depth_mm = 4.0");
        let pass = pass(&job, &program);
        let done = corrected(&pass, beside_boss(-4.0));
        let text = text(&done);
        // Every lap has become longer, and the plunges stay where they are.
        for plunge in ["G1 Z-4 F300", "G1 Z-8 F300", "G1 Z-12 F300"] {
            assert_eq!(text.matches(plunge).count(), 1, "{text}");
        }
        let steps = done.summary.warnings.iter().filter(|w| w.contains("on the spot")).count();
        assert_eq!(steps, 0, "{:?}", done.summary.warnings);
    }
}

#[test]
fn a_contour_in_a_loop_or_a_subprogram_is_written_out_for_every_depth() {
    let lap = "G1 X80 F600\nG1 Y60\nG1 X0\nG1 Y0\n";
    let head = "G21 G90 G17\nT1 M6\nS4000 M3\nG0 X0 Y0 Z10\n";
    let subprogram =
        format!("o1 sub\nG1 Z[-4 * #1] F300\n{lap}o1 endsub\n{head}o1 call [1]\no1 call [2]\nG0 Z10\nM2\n");
    let whole =
        format!("{head}#5 = 1\no2 while [#5 LE 2]\nG1 Z[-4 * #5] F300\n{lap}#5 = [#5 + 1]\no2 endwhile\nG0 Z10\nM2\n");
    for program in [subprogram, whole] {
        let pass = pass(&job(10.0, "left", "auto").replace("axial_depth_mm = 10.0", "axial_depth_mm = 4.0"), &program);
        let done = corrected(&pass, beside_boss(-4.0));
        let text = text(&done);
        assert!(!text.contains("o1") && !text.contains("o2"), "{text}");
        assert!(text.contains("G1 Z-4. F300") && text.contains("G1 Z-8. F300"), "{text}");
        assert!(done.summary.warnings.iter().any(|w| w.contains("written out")), "{:?}", done.summary.warnings);
    }
}

#[test]
fn an_outline_that_begins_and_ends_beyond_its_corner_is_corrected_up_to_the_corner() {
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let program = "G21 G90 G17\nT1 M6\nS4000 M3\nG0 X-5 Y-12 Z10\nG1 Z-10 F500\nG1 Y65 F600\nG1 X85\nG1 Y-5\nG1 X-12\nG0 Z10\nM30\n";
    let pass = pass(&job(10.0, "right", "helical"), program);
    let first = shown(virtual_mill::mill(&pass, &machine, None));
    let places = [30.0, 60.0, 100.0, 140.0, 190.0, 220.0, 270.0, 300.0];
    let probe = shown(virtual_mill::probe(&pass, &first, &places, &[0.2, 0.5, 0.8], 4.0));
    let done = corrected(&pass, probe);
    let second = shown(virtual_mill::mill_program(&pass, &machine, done.program.as_deref().unwrap()));
    let (before, after) = (first.mean_errors(), second.mean_errors());
    // The corner of the part is 12 mm behind the start and 12 mm before the end; the last 4 mm lose their load on the way.
    let length = first.path.length_mm;
    let largest = |errors: &[f64], from: f64, to: f64| {
        let range = first.path.index_at(from)..first.path.index_at(to);
        errors[range].iter().fold(0.0f64, |most, e| most.max(e.abs()))
    };
    // Where the load falls it is known to a sample of the path.
    for (from, to, left) in
        [(13.0, 40.0, 0.1), (length - 40.0, length - 17.0, 0.1), (length - 17.0, length - 13.0, 0.2)]
    {
        let [before, after] = [&before, &after].map(|errors| largest(errors, from, to));
        assert!(before > 0.015 && after < left * before, "{from} to {to} mm: {before} became {after}");
    }
    // A millimetre before the corner more than half of the load is gone.
    let [end, steady] = [length - 13.0, length - 20.0].map(|s| before[first.path.index_at(s)]);
    assert!(end < 0.5 * steady, "{end} of {steady}");
}
