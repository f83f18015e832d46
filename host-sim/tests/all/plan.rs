//! `plan`: from the points of one pass to a program of several, cut on a machine that shares no code with the plan.

use serde_json::Value;

use crate::workplace::{Workplace, plant, pocket_job};

/// One pass round a pocket, as deep as the cutter is wide and more.
const POCKET: &str = "G21 G90 G17\nT2 M6\nS9000 M3\nG0 X28 Y6 Z10\nG1 Z-12 F300\nG3 X30 Y4 I2 J0 F700\n\
    G1 X50\nG3 X56 Y10 I0 J6\nG1 Y30\nG3 X50 Y36 I-6 J0\nG1 X10\nG3 X4 Y30 I0 J-6\nG1 Y10\nG3 X10 Y4 I6 J0\nG1 X30\n\
    G3 X32 Y6 I0 J2\nG0 Z10\nM30\n";
const PLAN: &str = "plan job.toml --probe first/probe.txt";

/// Limits that leave a search of few candidates.
const FEW: &str = "[plan]\nmax_cuts = 1\nmax_levels = 1\n";

/// A soft machine that the job does not state, its first part and the points of it.
fn measured() -> Workplace {
    measured_with("")
}

/// The same, with more lines in the job.
fn measured_with(lines: &str) -> Workplace {
    let plant = plant("[[0.0016, 0.00004], [0.00004, 0.0013]]");
    let job = format!("dialect = \"linuxcnc\"\n{}{lines}", pocket_job(12.0, 900));
    let desk = Workplace::with(&[("part.nc", POCKET), ("job.toml", &job), ("plant.toml", &plant)]);
    desk.call("probe job.toml -o verify.nc");
    desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    desk
}

fn number(of: &Value, keys: &[&str]) -> f64 {
    let found = keys.iter().fold(of, |value, key| &value[*key]);
    found.as_f64().unwrap_or_else(|| panic!("{keys:?} in {of}"))
}

/// Minutes at feed of a program of lines and arcs with I and J, by its F words.
fn minutes_at_feed(program: &str) -> f64 {
    let (mut at, mut feed, mut motion, mut minutes) = ([0.0f64; 3], 0.0, 0, 0.0);
    for line in program.lines().filter(|line| !line.starts_with(['(', '%'])) {
        let (mut to, mut centre) = (at, [at[0], at[1]]);
        for word in line.split_whitespace() {
            let (letter, value) = word.split_at(1);
            let value: f64 = value.parse().unwrap_or_else(|_| panic!("{line}"));
            match letter {
                "G" if value <= 3.0 => motion = value as u8,
                "X" => to[0] = value,
                "Y" => to[1] = value,
                "Z" => to[2] = value,
                "I" => centre[0] += value,
                "J" => centre[1] += value,
                "F" => feed = value,
                _ => {}
            }
        }
        let angle = |p: [f64; 3]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let across = match motion {
            0 => 0.0,
            1 => (to[0] - at[0]).hypot(to[1] - at[1]),
            way => {
                let turn = if way == 3 { angle(to) - angle(at) } else { angle(at) - angle(to) };
                turn.rem_euclid(std::f64::consts::TAU) * (at[0] - centre[0]).hypot(at[1] - centre[1])
            }
        };
        if motion > 0 && to != at {
            minutes += across.hypot(to[2] - at[2]) / feed;
        }
        at = to;
    }
    minutes
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn a_planned_program_holds_at_every_height_what_one_pass_does_not() {
    let desk = measured();
    // What one corrected pass is expected to reach is asked for with 95 %: that takes several.
    let job = desk.read("job.toml");
    desk.write("job.toml", format!("{job}{FEW}"));
    let loose = desk.call(&format!("{PLAN} --tolerance 1"));
    desk.write("job.toml", job);
    let one = &loose["choices"][0];
    assert_eq!(loose["recommended"].as_u64(), Some(1), "one pass holds a millimetre");
    let tolerance = number(one, &["profile_mm"]);
    let done = desk.call(&format!("{PLAN} --tolerance {tolerance:.4} --write -o plan"));
    let chosen = done["written"]["choice"].as_u64().expect("a choice") as usize;
    assert!(chosen > 1 && Some(chosen as u64) == done["recommended"].as_u64());
    let choice = &done["choices"][chosen - 1];
    assert!(number(choice, &["within_tolerance"]) >= 0.95);

    let cut = |program: &str, to: &str| {
        desk.call(&format!("simulate job.toml --plant plant.toml --program {program} -o {to}"))
    };
    let before = number(&cut("part.nc", "before"), &["surface", "profile_mm"]);
    let planned = cut("plan/planned.nc", "after");
    let after = number(&planned, &["surface", "profile_mm"]);
    assert!(after < tolerance && after < before / 4.0, "{before} became {after}, {tolerance} was asked");
    let (mean, sigma) = (number(choice, &["profile_mm"]), number(choice, &["sigma_mm"]));
    assert!((after - mean).abs() < 3.0 * sigma, "{after}, predicted {mean} +- {sigma}");
    let within = number(&planned, &["surface", "p95_mm"]);
    let (mean, sigma) = (number(choice, &["p95_mm"]), number(choice, &["p95_sigma_mm"]));
    assert!(
        (within - mean).abs() < 3.0 * sigma && mean < number(choice, &["profile_mm"]),
        "{within}, {mean} +- {sigma}"
    );
    // The time is that of all moves at feed, ways down between the passes as well.
    let [programmed, planned] = [POCKET, &desk.read("plan/planned.nc")].map(minutes_at_feed);
    let near = |told: f64, counted: f64| assert!((told / counted - 1.0).abs() < 0.01, "{told} told, {counted} counted");
    near(number(&done, &["minutes"]), programmed);
    near(number(choice, &["time_ratio"]), planned / programmed);
    assert_eq!(desk.read("plan/planned.nc"), desk.read("plan/part.planned.nc"));
    let page = desk.read("plan/report.html");
    assert!(
        page.contains("holds ±")
            && page.contains("What is left, at s = ")
            && page.matches("<figure").count() == 1 + done["choices"].as_array().unwrap().len()
    );
    assert!(desk.read("plan/wall-map.csv").starts_with("s_mm,height_mm,error_mm\n"));

    // The wall is the same, and so is the program that touches it: it is written beside the plan, and the points say what the map says.
    assert_eq!(done["written"]["verify"].as_str(), Some("plan/verify.nc"));
    let touches = |program: &str| program.lines().filter(|line| !line.contains("CRC")).count();
    assert_eq!(touches(&desk.read("plan/verify.nc")), touches(&desk.read("verify.nc")));
    desk.call("simulate job.toml --plant plant.toml --program plan/planned.nc --touch plan/verify.nc -o touched");
    let seen = desk.call("inspect job.toml --probe touched/probe.txt -o seen");
    assert!(number(&seen, &["summary", "max_error_mm"]) < tolerance + 0.004);
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn limits_of_the_job_are_kept() {
    let desk = measured();
    let job = desk.read("job.toml");
    desk.write(
        "job.toml",
        job + "[plan]\nmax_cuts = 2\nmax_levels = 1\nreverse = \"no\"\nmax_percent = 100\nmax_time_ratio = 2.1\n",
    );
    let plan = desk.call(&format!("{PLAN} --tolerance 0.01"));
    for choice in plan["choices"].as_array().expect("choices") {
        let words = choice["process"].as_str().expect("words");
        assert!(!words.contains("reversed") && !words.contains("levels") && !words.contains("200 %"), "{words}");
        assert!(choice["passes"].as_u64().expect("passes") <= 2 && number(choice, &["time_ratio"]) <= 2.1);
    }
    desk.write("job.toml", desk.read("job.toml") + "max_force_n = 1\n");
    let none = desk.call(&format!("{PLAN} --tolerance 0.01"));
    assert_eq!(none["choices"].as_array().map(Vec::len), Some(0));
    assert!(none["recommended"].is_null());
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_cutter_that_is_pushed_off_by_most_of_its_allowance_is_warned_of() {
    let desk = measured_with(FEW);
    let warned = |plan: &Value| plan["warnings"].to_string().contains("beyond half of it");
    assert!(!warned(&desk.call(&format!("{PLAN} --tolerance 0.05"))));
    desk.write("plant.toml", plant("[[0.011, 0.0002], [0.0002, 0.009]]"));
    desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first --force");
    let plan = desk.call(&format!("{PLAN} --tolerance 0.05 --force-data"));
    assert!(number(&plan, &["as_programmed", "profile_mm"]) > 0.2 && warned(&plan), "{plan}");
}

#[test]
fn where_f_words_are_not_the_feeds_of_the_cut_passes_are_planned_at_these_and_can_be_written() {
    let desk = Workplace::demo("corner-helix", &["program.nc", "job.toml", "plant.toml"]);
    desk.write("job.toml", desk.read("job.toml") + FEW);
    desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    let done = desk.call(&format!("{PLAN} --tolerance 1 --write -o plan"));
    assert!(done["warnings"].to_string().contains("at the feed of the cut"), "{}", done["warnings"]);
    let feeds = |program: &str| -> Vec<f64> {
        let words = program.split_whitespace().filter_map(|word| word.strip_prefix('F'));
        words.filter_map(|value| value.trim_end_matches('.').parse().ok()).collect()
    };
    let (own, planned) = (feeds(&desk.read("program.nc")), feeds(&desk.read("plan/planned.nc")));
    assert!(!planned.is_empty() && planned.iter().all(|feed| own.contains(feed)), "{own:?} became {planned:?}");
    assert!(
        done["choices"]
            .as_array()
            .expect("choices")
            .iter()
            .all(|choice| !choice["process"].to_string().contains("feed"))
    );
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_tolerance_below_what_the_probe_shows_is_told_what_can_be_shown() {
    let desk = measured_with(FEW);
    let warned = |plan: &Value| {
        let warnings = plan["warnings"].as_array().expect("warnings");
        warnings.iter().any(|w| w.as_str().is_some_and(|w| w.contains("less than can be shown")))
    };
    let narrow = desk.call(&format!("{PLAN} --tolerance 0.0005"));
    assert!(narrow["recommended"].is_null() && warned(&narrow), "{}", narrow["warnings"]);
    assert!(!warned(&desk.call(&format!("{PLAN} --tolerance 0.05"))));
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn other_cutters_are_tried_and_one_that_does_not_fit_is_left_out_by_name() {
    let desk = measured();
    let job = desk.read("job.toml");
    let plan = |cutters: &str| {
        desk.write("job.toml", format!("{job}{FEW}{cutters}"));
        desk.run(&format!("{PLAN} --tolerance 0.0001"))
    };
    // The corners of the path have a radius of 6 mm: a cutter 12 mm wider has no room, one twice as stiff bends half as much.
    let list = "[[plan.cutter]]\nnumber = 7\ndiameter_mm = 20\nhelix_deg = 40\n\
        [[plan.cutter]]\nnumber = 8\nhelix_deg = 35\nstiffness_factor = 2\n";
    let done = plan(list).expect("a plan");
    let said = done["warnings"].to_string();
    assert!(said.contains("T7 (diameter 20 mm) is left out") && said.contains("line 8"), "{said}");
    let choices = done["choices"].as_array().expect("choices");
    let with = |cutter: Option<u64>| choices.iter().filter(move |choice| choice["cutter"].as_u64() == cutter);
    assert_eq!(with(Some(7)).count(), 0);
    assert!(with(Some(8)).count() > 0, "the stiffer cutter leaves less: {choices:?}");
    desk.write("job.toml", format!("{job}{FEW}"));
    let own = desk.call(&format!("{PLAN} --tolerance 0.0001"));
    let own = own["choices"].as_array().expect("choices").iter().map(|c| number(c, &["profile_mm"]));
    let best = with(Some(8)).map(|c| number(c, &["profile_mm"])).fold(f64::INFINITY, f64::min);
    assert!(best < own.fold(f64::INFINITY, f64::min), "{best}");

    // The program changes to it before its pass; the coprocessor knows the cutter of the program alone.
    let at = choices.iter().position(|choice| choice["cutter"].as_u64() == Some(8)).expect("a choice") + 1;
    desk.write("job.toml", format!("{job}{FEW}{list}"));
    let write = format!("{PLAN} --tolerance 0.0001 --write {at} -o plan");
    let refused = desk.run(&format!("{write} --route coprocessor")).expect_err("an image of another cutter");
    assert!(refused.contains("K007") && refused.contains("T8"), "{refused}");
    assert!(!desk.path().join("plan").exists());
    desk.call(&write);
    let written = desk.read("plan/planned.nc");
    assert!(written.contains("CUTTER T8") && written.contains("HELIX 35 DEGREES"), "{written}");
    assert!(!desk.path().join("plan/plan-history.json").exists(), "learning knows the cutter of the program");

    for (wrong, code, said) in [
        ("[[plan.cutter]]\nhelix_deg = 40\n", "J004", "cutter.number is missing"),
        ("[[plan.cutter]]\nnumber = 7\nhelix_deg = 70\n", "J006", "0 to 60 degrees"),
        (
            "[[plan.cutter]]\nnumber = 7\nhelix_deg = 30\n[[plan.cutter]]\nnumber = 7\nhelix_deg = 40\n",
            "J006",
            "a number of its own",
        ),
        ("[[plan.cutter]]\nnumber = 7\nhelix_deg = 30\nstickout_mm = 40\n", "J008", "that of the job's cutter is not"),
        ("[[plan.cutter]]\nnumber = 7\nhelix_deg = 30\nlength = 40\n", "J003", "plan.cutter"),
    ] {
        let answer = plan(wrong).expect_err(wrong);
        assert!(answer.contains(code) && answer.contains(said), "{wrong}: {answer}");
    }
}

#[test]
fn what_cannot_be_planned_is_said_and_nothing_is_written() {
    let desk = measured_with(FEW);
    for (arguments, code, said) in [
        ("--tolerance 0", "C001", "0.0001 to 10 mm"),
        ("--tolerance -0.02", "C001", "0.0001 to 10 mm"),
        ("--tolerance NaN", "C001", "0.0001 to 10 mm"),
        ("--tolerance much", "C001", "--tolerance"),
        ("", "J004", "no tolerance to plan for"),
        ("--tolerance 0.02 --confidence 100", "C001", "50 to 99.9 %"),
        ("--tolerance 0.5 --write 17 -o plan", "C001", "the number of a choice, 1 to"),
        ("--tolerance 0.5 --write much -o plan", "C001", "from 1 on"),
        ("--tolerance 0.0001 --write -o plan", "C001", "no choice holds the tolerance"),
    ] {
        let answer = desk.run(format!("{PLAN} {arguments}").trim_end()).expect_err(arguments);
        assert!(answer.contains(code) && answer.contains(said), "{arguments}: {answer}");
        assert!(!desk.path().join("plan").exists(), "{arguments}");
    }
    desk.write("job.toml", desk.read("job.toml").replace("dialect = \"linuxcnc\"", "dialect = \"haas\""));
    let answer = desk.run(&format!("{PLAN} --tolerance 0.5 --route coprocessor --write 1 -o plan")).expect_err("haas");
    assert!(answer.contains("P022") && answer.contains("haas") && !desk.path().join("plan").exists(), "{answer}");
}

/// A pocket at one depth and another at two, with roughing before neither.
fn two_pockets() -> String {
    pockets(&[(0, -8), (80, -8), (80, -16)])
}

/// A program of pockets, each with its place in X and its depth.
fn pockets(each: &[(i32, i32)]) -> String {
    let pocket = |x: i32, z: i32| {
        format!(
            "G0 X{} Y6\nG0 Z2\nG1 Z{z} F300\nG3 X{} Y4 I2 J0 F700\nG1 X{}\nG3 X{} Y10 I0 J6\nG1 Y26\nG3 X{} Y32 I-6 J0\nG1 X{}\n\
             G3 X{} Y26 I0 J-6\nG1 Y10\nG3 X{} Y4 I6 J0\nG1 X{}\nG3 X{} Y6 I0 J2\nG0 Z10\n",
            x + 18,
            x + 20,
            x + 30,
            x + 36,
            x + 30,
            x + 10,
            x + 4,
            x + 10,
            x + 20,
            x + 22
        )
    };
    let all: String = each.iter().map(|(x, z)| pocket(*x, *z)).collect();
    format!("G21 G90 G17\nT2 M6\nS9000 M3\nG0 Z10\n{all}M30\n")
}

/// Two pockets measured, with a search of few candidates.
fn two_measured() -> Workplace {
    measured_pockets(&two_pockets())
}

/// Pockets measured, with the same search.
fn measured_pockets(program: &str) -> Workplace {
    let plant = plant("[[0.0016, 0.00004], [0.00004, 0.0013]]");
    let job = "dialect = \"linuxcnc\"\n".to_owned()
        + &pocket_job(8.0, 900).replace("[tool]\n", "[tool]\nnumber = 2\n")
        + "[plan]\nmax_cuts = 2\nmax_levels = 1\nmax_percent = 100\nreverse = \"no\"\n";
    let desk = Workplace::with(&[("part.nc", program), ("job.toml", &job), ("plant.toml", &plant)]);
    desk.call("probe job.toml -o verify.nc");
    desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    desk
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn every_contour_has_a_plan_and_one_program_holds_them_all() {
    let desk = two_measured();
    let done = desk.call(&format!("{PLAN} --tolerance 0.02 --write 2,1 -o plan"));
    let contours = done["contours"].as_array().expect("contours");
    assert_eq!(contours.iter().map(|one| one["depths"].as_u64()).collect::<Vec<_>>(), [Some(1), Some(2)]);
    let chosen: Vec<_> = done["written"]["contours"].as_array().expect("choices").clone();
    assert_eq!(chosen.iter().map(|one| one["choice"].as_u64()).collect::<Vec<_>>(), [Some(2), Some(1)]);
    // One machine: both pockets have one shape and are expected to come out alike.
    let expected = |k: usize| number(&contours[k]["as_programmed"], &["profile_mm"]);
    assert!((expected(0) - expected(1)).abs() < 0.002, "{} and {}", expected(0), expected(1));
    // Both depths of the second pocket are cut anew, with the passes of its choice each.
    let depths = done["written"]["depths"].as_array().expect("depths");
    let passes = |k: usize, choice: usize| number(&contours[k]["choices"][choice - 1], &["passes"]) as usize;
    let found: Vec<_> = depths.iter().map(|d| (d["wall"].as_u64(), d["passes"].as_array().map(Vec::len))).collect();
    let wanted = [(0, passes(0, 2)), (1, passes(1, 1)), (1, passes(1, 1))];
    let wanted = wanted.map(|(wall, count)| (Some(wall), Some(count)));
    assert_eq!(found, wanted);
    for contour in contours {
        let name = contour["contour"].as_str().expect("a name");
        assert!(desk.read(&format!("plan/contours/{name}/wall-map.csv")).starts_with("s_mm,"));
        assert!(desk.read("plan/report.html").contains(&format!("<h2 class=\"contour\">{name}</h2>")));
    }
    // Every line beside the contours and the ways to them is the program's.
    let (old, new) = (two_pockets(), desk.read("plan/planned.nc"));
    let outside = |line: &&str| !line.contains(['X', 'Y']);
    assert!(old.lines().filter(outside).all(|line| new.lines().any(|other| other == line)), "{new}");
    desk.call("simulate job.toml --plant plant.toml --program plan/planned.nc --touch plan/verify.nc -o touched");
    let seen = desk.call("inspect job.toml --probe touched/probe.txt -o seen");
    let before = desk.call("inspect job.toml --probe first/probe.txt -o before");
    let worst = |of: &Value| number(of, &["summary", "max_error_mm"]).abs();
    assert!(worst(&seen) < 0.5 * worst(&before), "{} became {}", worst(&before), worst(&seen));

    for (write, said) in [("3,1,1", "one for each of the 2 contours"), ("1,99", "contour-2, 1 to"), ("0", "from 1 on")]
    {
        let answer = desk.run(&format!("{PLAN} --tolerance 0.02 --write {write} -o none")).expect_err(write);
        assert!(answer.contains("C001") && answer.contains(said), "{write}: {answer}");
    }
    assert!(!desk.path().join("none").exists());
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn one_machine_is_learned_from_planned_passes_of_several_contours() {
    let desk = measured_pockets(&pockets(&[(0, -8), (80, -8)]));
    desk.call(&format!("{PLAN} --tolerance 0.02 --write 2,3 -o plan"));
    let names = ["contour-1", "contour-2"];
    let program = desk.call("probe job.toml --next --from plan --points 8 -o verify-2.nc")["points"].to_string();
    assert!(names.iter().all(|name| program.contains(name)), "{program}");
    let cut = |program: &str, seed: u32, touch: &str, to: &str| {
        desk.write("plant.toml", desk.read("plant.toml").replace("seed = 3", &format!("seed = {seed}")));
        desk.call(&format!("simulate job.toml --plant plant.toml --program {program} --touch {touch} -o {to}"));
    };
    cut("plan/planned.nc", 4, "verify-2.nc", "second");
    let learned = desk.call("learn job.toml --probe second/probe.txt --from plan -o third");
    let told = learned["contours"].as_array().expect("contours");
    assert_eq!(told.iter().map(|one| one["contour"].as_str()).collect::<Vec<_>>(), names.map(Some));
    for (name, one) in names.iter().zip(told) {
        assert_eq!((one["part"].as_u64(), one["set_aside"].as_bool()), (Some(2), Some(false)));
        let [before, after] = ["missed_before_mm", "missed_after_mm"].map(|key| number(one, &[key]));
        assert!(after < before && after < 0.002, "{before} became {after}");
        assert!(desk.path().join(format!("third/contours/{name}/plan-history.json")).exists());
    }
    // The next program holds both, and what it promises is what it leaves; a part follows from there too.
    let left =
        desk.call("simulate job.toml --plant plant.toml --program third/planned.nc --touch third/verify.nc -o touched");
    for (one, of) in told.iter().zip(left["contours"].as_array().expect("contours")) {
        let [left, promised] = [number(of, &["surface", "profile_mm"]), number(&one["choices"][0], &["profile_mm"])];
        let sigma = number(&one["choices"][0], &["sigma_mm"]);
        assert!((left - promised).abs() < 3.0 * sigma + 0.001, "{left}, {promised} +- {sigma} was promised");
    }
    let again = desk.call("learn job.toml --probe touched/probe.txt --from third --replan -o fourth");
    assert_eq!(again["contours"][1]["part"].as_u64(), Some(3));

    desk.call("probe job.toml --feature contour-1 -o one.nc");
    cut("plan/planned.nc", 4, "one.nc", "half");
    for (probe, with, code) in [("half", "", "Q010"), ("second", " --feature contour-1", "Q001"), ("first", "", "Q003")]
    {
        let learn = format!("learn job.toml --probe {probe}/probe.txt --from plan{with} -o out");
        let said = desk.run(&learn).expect_err(code);
        assert!(said.contains(code) && !desk.path().join("out").exists(), "{said}");
    }
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn the_coprocessor_gets_an_image_for_every_pass_of_every_contour() {
    let desk = two_measured();
    let done = desk.call(&format!("{PLAN} --tolerance 0.02 --route coprocessor --write 2 -o plan"));
    let images = done["written"]["images"].as_array().expect("images");
    let named: Vec<_> = images.iter().map(|i| (i["feature"].as_u64().unwrap(), i["pass"].as_u64().unwrap())).collect();
    let program = desk.read("plan/planned.nc");
    let armed: Vec<String> = named.iter().map(|(feature, pass)| format!("M160 P{feature}.{pass}")).collect();
    assert_eq!(program.lines().filter(|line| line.starts_with("M160")).collect::<Vec<_>>(), armed);
    assert!(named.iter().filter(|(feature, _)| *feature == named[0].0).count() < named.len(), "{named:?}");
    for (k, (feature, pass)) in named.iter().enumerate() {
        let told = desk.call(&format!("image plan/planned-{}.tpi", k + 1));
        let of = |key: &str| told[key].as_u64();
        assert_eq!((of("feature"), of("pass"), of("tool")), (Some(*feature), Some(*pass), Some(2)), "{told}");
    }
    // What the images displace, the program of the other route displaces as well: the next part has images of both contours.
    desk.call(&format!("{PLAN} --tolerance 0.02 --write 2 -o other"));
    desk.call("simulate job.toml --plant plant.toml --program other/planned.nc --touch verify.nc -o second");
    let next = desk.call("learn job.toml --probe second/probe.txt --from plan -o third");
    assert_eq!(next["written"]["images"].as_array().map(Vec::len), Some(named.len()), "{next}");
    // The program is not corrected: it can be measured and planned again, and it is not the one of the other route.
    assert!(!program.contains("TRUEPATH CORRECTED") && desk.read("plan/difference.txt").contains("planned-1.tpi"));
}
