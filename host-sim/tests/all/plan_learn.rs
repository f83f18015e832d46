//! `learn` from a part that a planned program has cut, on a machine that shares no code with it.

use std::fs;
use std::sync::LazyLock;

use serde_json::Value;

use crate::workplace::Workplace;

/// An inside corner, as deep as the cutter is wide.
const CORNER: &str = "G21 G90 G17\nT5 M6\nS2500 M3\nG0 X-6 Y6 Z20\nG1 Z-12 F300\nG1 X0 Y0 F420\nG1 X30\n\
    G3 X40 Y10 I0 J10\nG1 Y36\nG1 X34 Y42\nG0 Z20\nM30\n";
const JOB: &str = "version = 1\nprogram = \"part.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.7\n[tool]\n\
    diameter_mm = 12.0\nteeth = 4\nhelix_deg = 30.0\n[cut]\naxial_depth_mm = 12.0\n[force]\nmaterial = \"al-7075-heavy\"\n\
    [machine]\nstiffness_x_n_per_mm = 1600\nstiffness_y_n_per_mm = 1600\n[probe]\nball_diameter_mm = 2.0\n\
    format = \"linuxcnc-log\"\nz_reference = \"centre\"\n[plan]\nmax_cuts = 2\nmax_levels = 1\n";

/// A machine that the job does not state, with a law of bending, wear and uneven stock of its own; touches have a noise.
fn plant(seed: u32) -> String {
    format!(
        "ktc_n_per_mm2 = 2100\nkrc_n_per_mm2 = 700\nkte_n_per_mm = 30\nkre_n_per_mm = 38\nsize_exponent = 0.26\n\
         compliance_mm_per_n = [[0.00055, 0.00004], [0.00004, 0.00062]]\nbend = 0.2\nbend_law = \"maxwell\"\n\
         edge_wear_per_m = 0.1\nstock_variation_mm = 0.03\nstock_wavelength_mm = 30.0\nprobe_noise_mm = 0.001\nseed = {seed}\n"
    )
}

/// The number of the choice that is written.
static PLAN: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);

/// The first part, the plan, and the second part, cut with it and touched.
static BENCH: LazyLock<Workplace> = LazyLock::new(|| {
    let desk = Workplace::with(&[("part.nc", CORNER), ("job.toml", JOB)]);
    (1..=3).for_each(|part| desk.write(&format!("plant-{part}.toml"), plant(part)));
    let probe = desk.call("probe job.toml --dialect linuxcnc --tolerance 0.01 --points 2 -o verify.nc");
    assert!(probe["heights_why"].as_str().expect("a sentence").contains("axial contact ratios"));
    desk.call("simulate job.toml --plant plant-1.toml --program part.nc --touch verify.nc -o first");
    let plan = desk.call("plan job.toml --probe first/probe.txt --tolerance 0.02");
    let best = plan["choices"].as_array().expect("choices").len();
    PLAN.store(best, std::sync::atomic::Ordering::Relaxed);
    desk.call(&format!("plan job.toml --probe first/probe.txt --tolerance 0.02 --write {best} -o plan"));
    desk.call("probe job.toml --next --points 6 --from plan --dialect linuxcnc -o verify-2.nc");
    desk.call("simulate job.toml --plant plant-2.toml --program plan/planned.nc --touch verify-2.nc -o second");
    desk
});

/// A copy of the bench, to go on from or to spoil.
fn bench() -> Workplace {
    let desk = Workplace::with(&[]);
    for folder in ["", "first", "plan", "second"] {
        let (from, to) = (BENCH.path().join(folder), desk.path().join(folder));
        fs::create_dir_all(&to).expect("a folder");
        for entry in fs::read_dir(from).expect("a folder").map(Result::unwrap) {
            if entry.file_type().expect("a type").is_file() {
                fs::copy(entry.path(), to.join(entry.file_name())).expect("a copy");
            }
        }
    }
    desk
}

fn number(of: &Value, keys: &[&str]) -> f64 {
    let found = keys.iter().fold(of, |value, key| &value[*key]);
    found.as_f64().unwrap_or_else(|| panic!("{keys:?} in {of}"))
}

fn profile(desk: &Workplace, plant: u32, program: &str) -> f64 {
    let arguments = format!("simulate job.toml --plant plant-{plant}.toml --program {program} -o cut --force");
    number(&desk.call(&arguments), &["surface", "profile_mm"])
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn what_the_second_part_shows_is_cancelled_on_the_third() {
    let desk = bench();
    let program = desk.read("verify-2.nc");
    let named = format!("{:08X}", truepath_core::checksum::crc32(desk.read("plan/planned.nc").as_bytes()));
    assert!(program.contains(&named), "the program names the part that it is for");
    let learned = desk.call("learn job.toml --probe second/probe.txt --from plan -o third");
    let [first, second, third] = [(1, "part.nc"), (2, "plan/planned.nc"), (3, "third/planned.nc")]
        .map(|(k, program)| profile(&desk, k, program));
    assert!(second < first / 4.0 && third < 0.9 * second, "{first} became {second}, then {third}");
    let choice = &learned["choices"][0];
    let (mean, sigma) = (number(choice, &["profile_mm"]), number(choice, &["sigma_mm"]));
    assert!((third - mean).abs() < 3.0 * sigma, "{third}, predicted {mean} +- {sigma}");
    assert_eq!(learned["part"].as_u64(), Some(2));
    assert_eq!(learned["set_aside"].as_bool(), Some(false));
    assert!(number(&learned, &["missed_after_mm"]) < number(&learned, &["missed_before_mm"]));
    assert_eq!(desk.read("third/planned.nc"), desk.read("third/part.planned.nc"));

    // Passes may be searched for anew: the choice that is written is one of the table, and a part can follow from there too.
    let searched = desk.call("learn job.toml --probe second/probe.txt --from plan --replan -o searched");
    let (choices, written) = (searched["choices"].as_array().expect("choices"), &searched["written"]);
    let chosen = &choices[written["choice"].as_u64().expect("a number") as usize - 1];
    assert!(number(chosen, &["profile_mm"]) <= mean + 2.0 * sigma, "{chosen}, the same passes promised {mean}");
    assert!(desk.path().join("searched/plan-history.json").exists());

    // And the fourth follows from there.
    desk.call("simulate job.toml --plant plant-3.toml --program third/planned.nc --touch verify-2.nc -o touched");
    let refused = desk.run("learn job.toml --probe touched/probe.txt --from third -o fourth").expect_err("of part 2");
    assert!(refused.contains("M039"), "{refused}");
    desk.call("simulate job.toml --plant plant-3.toml --program third/planned.nc --touch verify.nc -o touched --force");
    let again = desk.call("learn job.toml --probe touched/probe.txt --from third -o fourth");
    assert_eq!(again["part"].as_u64(), Some(3));
    let known = desk.run("learn job.toml --probe touched/probe.txt --from fourth -o fifth").expect_err("known points");
    assert!(known.contains("Q003") && !desk.path().join("fifth").exists(), "{known}");
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn passes_that_the_coprocessor_displaces_are_learned_from_like_those_of_the_program() {
    let desk = bench();
    desk.write("job.toml", format!("dialect = \"linuxcnc\"\n{JOB}"));
    let plan = "plan job.toml --probe first/probe.txt --tolerance 0.02 --route coprocessor";
    let best = PLAN.load(std::sync::atomic::Ordering::Relaxed);
    let armed = desk.call(&format!("{plan} --write {best} -o armed"));
    // The images displace the passes as the program of the other route does, whose part was touched; the points name no program.
    desk.call("simulate job.toml --plant plant-2.toml --program plan/planned.nc --touch verify.nc -o touched");
    let learned = desk.call("learn job.toml --probe touched/probe.txt --from armed -o third");
    let own = desk.call("learn job.toml --probe touched/probe.txt --from plan -o other");
    for key in ["promised_mm", "missed_before_mm", "missed_after_mm"] {
        assert_eq!(learned[key], own[key], "{key}");
    }
    assert_eq!(learned["choices"], own["choices"]);
    let images = |of: &Value| of["written"]["images"].as_array().map(Vec::len);
    assert!(images(&armed).is_some_and(|count| count > 1) && images(&learned) == images(&armed));
    assert!(images(&own).is_none() && desk.read("third/planned.nc").contains("M160 P"));
    let image = |folder: &str| fs::read(desk.path().join(folder).join("planned-1.tpi")).expect("an image");
    assert_ne!(image("third"), image("armed"), "designed anew");
    // The history knows the images as it knows the program.
    let mut changed = image("third");
    changed[40] ^= 1;
    desk.write("third/planned-1.tpi", changed);
    let refused =
        desk.run("learn job.toml --probe touched/probe.txt --from third -o fourth").expect_err("another image");
    assert!(refused.contains("Q004") && refused.contains("planned-1.tpi"), "{refused}");
    let refused = desk.run("learn job.toml --probe touched/probe.txt --from armed --route program -o fourth");
    assert!(refused.expect_err("another route").contains("C001") && !desk.path().join("fourth").exists());
}

#[test]
fn what_cannot_be_learned_from_is_named_and_nothing_is_written() {
    let desk = bench();
    desk.call("simulate job.toml --plant plant-3.toml --program part.nc --touch verify.nc -o plain");
    let refused = |arguments: &str, code: &str| {
        let said = desk.run(&format!("learn job.toml {arguments}")).expect_err(code);
        assert!(said.contains(code), "{arguments}: {said}");
        assert!(!desk.path().join("out").exists(), "{arguments}");
    };
    refused("--probe plain/probe.txt --from plan -o out", "Q007");
    refused("--probe first/probe.txt --from plan -o out", "Q003");
    refused("--probe second/probe.txt --from plan -o plan", "Q005");
    refused("--probe second/probe.txt --from plan --route coprocessor -o out", "C001");
    refused("--probe second/probe.txt --from plan --new-cutter -o out", "C001");
    fs::create_dir(desk.path().join("stray")).expect("a folder");
    desk.write("stray/planned.nc", "");
    refused("--probe second/probe.txt --from stray -o out", "Q001");
    let job = desk.read("job.toml");
    desk.write("job.toml", job.replace("teeth = 4", "teeth = 3"));
    refused("--probe second/probe.txt --from plan -o out", "Q002");
    desk.write("job.toml", &job);
    let history = desk.read("plan/plan-history.json");
    desk.write("plan/plan-history.json", history.replacen("\"noise_mm\":", "\"noise_mm\": ", 1));
    refused("--probe second/probe.txt --from plan -o out", "Q001");
    desk.write("plan/plan-history.json", history);
    desk.write("plan/planned.nc", desk.read("plan/planned.nc") + "\n");
    refused("--probe second/probe.txt --from plan -o out", "Q004");
}
