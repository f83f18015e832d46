//! The story of a part in one file: packed, unpacked, run again, without names.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::workplace::{Workplace, text, truepath};

/// A part of the demonstration, corrected, cut again, touched and learned from, as a user has it in a folder.
fn story() -> Workplace {
    let desk = Workplace::demo("corner", &["program.nc", "job.toml", "plant.toml"]);
    let job = desk.read("job.toml").replace("\"linuxcnc\"", "\"linuxcnc-log\"");
    desk.write("job.toml", job + "\n[correct]\ndiscrepancy = \"ignore\"\n[part]\nname = \"ACME bracket\"\n");
    desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    desk.call("correct job.toml --probe first/probe.txt -o out");
    desk.call("simulate job.toml --plant plant.toml --program out/corrected.nc --touch verify.nc -o second");
    desk.call("learn job.toml --probe second/probe.txt --from out -o next --new-cutter");
    desk.call("simulate job.toml --plant plant.toml --program next/corrected.nc --touch verify.nc -o third");
    desk
}

fn names(of: &Value) -> Vec<&str> {
    of["files"].as_array().expect("files").iter().filter_map(Value::as_str).collect()
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn the_story_of_three_parts_is_packed_sent_and_made_again_to_the_same_bytes() {
    let desk = story();
    let packed = desk.call("pack . --cut-again third/probe.txt -o story.tpk");
    for name in
        ["job.toml", "program.nc", "out/corrected.nc", "out/probe-raw.txt", "next/history.json", "third/probe.txt"]
    {
        assert!(names(&packed).contains(&name), "{name}: {packed}");
    }
    assert!(!names(&packed).iter().any(|name| name.ends_with(".html")), "pages are made from what is packed");
    // Somewhere else, with nothing but the file.
    let other = Workplace::with(&[]);
    fs::copy(desk.path().join("story.tpk"), other.path().join("story.tpk")).expect("a copy");
    let again = other.call("study --pack story.tpk");
    assert_eq!(again["same"], true, "{again}");
    let corrections = again["corrections"].as_array().expect("corrections");
    assert_eq!(corrections.len(), 2, "{again}");
    for (one, command) in corrections.iter().zip(["correct", "learn"]) {
        let same = one["same"].as_array().expect("names").len();
        assert!(one["command"] == command && same >= 7, "{one}");
    }
    // Both corrected parts, promised and measured.
    let parts = again["parts"].as_array().expect("parts");
    let number = |part: &Value, key: &str| part[key].as_f64().expect("a number");
    assert_eq!(parts.iter().map(|part| number(part, "part")).collect::<Vec<_>>(), [2.0, 3.0]);
    assert!(number(&parts[0], "measured_mm") < 0.2 * number(&parts[0], "before_mm"), "{again}");
    assert!(parts.iter().all(|part| 2.0 * number(part, "within_two_sigma") > number(part, "places")), "{again}");

    let unpacked = other.call("unpack story.tpk -o there");
    assert_eq!(names(&unpacked), names(&packed));
    for name in names(&packed) {
        let [here, there] = [desk.path().join(name), other.path().join("there").join(name)].map(fs::read);
        assert_eq!(here.expect("a file"), there.expect("a file"), "{name}");
    }
    assert!(other.run("unpack story.tpk -o there").expect_err("there already").contains("F003"));
    // Two packs of the same folder are one.
    desk.call("pack . --cut-again third/probe.txt -o again.tpk");
    let [first, second] = ["story.tpk", "again.tpk"].map(|name| fs::read(desk.path().join(name)).expect("a pack"));
    assert_eq!(first, second);

    // What was changed after it was written is told with where.
    let corrected = desk.read("out/corrected.nc").replace("F150", "F151");
    desk.write("out/corrected.nc", corrected);
    desk.write("out/summary.json", desk.read("out/summary.json").replace("\"points_used\": ", "\"points_used\": 1"));
    fs::remove_dir_all(desk.path().join("next")).expect("removed");
    let changed = desk.call("pack out job.toml program.nc -o changed.tpk");
    assert_eq!(changed["again"]["same"], false);
    let differ = &changed["again"]["corrections"][0]["differ"];
    assert!(differ["summary.json"].as_str().is_some_and(|how| how.contains("/points_used 1")), "{changed}");
    assert!(differ["corrected.nc"].as_str().is_some_and(|how| how.contains("from line")), "{changed}");
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn without_names_the_numbers_stay() {
    let desk = story();
    let [named, bare] = ["", " --anonymous"].map(|flag| desk.call(&format!("pack . -o story{}.tpk{flag}", flag.len())));
    desk.call("unpack story12.tpk -o bare");
    assert!(names(&bare).iter().all(|name| !name.contains("out") && !name.contains("next")), "{bare}");
    for name in names(&bare).into_iter().filter(|name| !name.ends_with(".tpi")) {
        let text = desk.read(&format!("bare/{name}"));
        assert!(!text.contains("ACME") && !text.contains(&desk.path().display().to_string()), "{name}");
    }
    let program = desk.read("bare/program.nc");
    assert!(desk.read("program.nc").contains('(') && !program.contains('('), "{program}");
    let promised = |packed: &Value| packed["again"]["corrections"][1]["promised"].clone();
    assert_eq!(promised(&named), promised(&bare));
    assert_eq!((&bare["again"]["same"], &bare["anonymous"]), (&Value::Bool(true), &Value::Bool(true)));
    assert_eq!(named["again"]["parts"], bare["again"]["parts"]);
    // A cutter that only a comment names is missed when the comment is gone.
    desk.write("job.toml", desk.read("job.toml").replace("teeth = 6\n", ""));
    let cutter = "O0001\n(T1 D=20. CR=0. - ZMIN=-15. - 6 FLUTE - FLAT END MILL)";
    desk.write("program.nc", desk.read("program.nc").replace("O0001", cutter));
    fs::remove_dir_all(desk.path().join("next")).expect("removed");
    let (head, behind) = ("# program ", desk.read("first/probe.txt"));
    let lines: String = behind.lines().filter(|line| !line.starts_with(head)).map(|line| format!("{line}\n")).collect();
    desk.write("first/probe.txt", lines);
    desk.call("correct job.toml --probe first/probe.txt -o out --force");
    desk.call("pack . -o named.tpk");
    let refused = desk.run("pack . --anonymous -o none.tpk").expect_err("a comment that is read");
    assert!(refused.contains("J004") && refused.contains("tool.teeth"), "{refused}");
}

#[test]
fn what_is_no_story_is_refused_with_what_to_do() {
    let desk = Workplace::demo("corner", &["program.nc", "job.toml"]);
    let refused = |arguments: &str| desk.run(arguments).expect_err(arguments);
    let said = refused("pack . -o story.tpk");
    assert!(said.contains("U004") && said.contains("no correction"), "{said}");
    assert!(refused("pack none -o story.tpk").contains("F001"));
    desk.write("damaged.tpk", "this is no pack");
    for command in ["unpack damaged.tpk -o there", "study --pack damaged.tpk"] {
        let said = refused(command);
        assert!(said.contains("U001") && said.contains("damaged.tpk"), "{said}");
    }
    assert!(!desk.path().join("there").exists() && !desk.path().join("story.tpk").exists());
    // A job that names a file above what is packed.
    let job = desk.read("job.toml").replace("[stock]\n", "[stock]\nprobe = \"../touched.txt\"\n");
    desk.write("job.toml", job);
    fs::create_dir(desk.path().join("out")).expect("made");
    desk.write("out/summary.json", "{}");
    desk.write("out/correction.csv", "");
    let said = refused("pack . -o story.tpk");
    assert!(said.contains("U005") && said.contains("touched.txt"), "{said}");
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn the_folder_of_the_demonstration_is_made_again_to_the_same_bytes() {
    let desk = Workplace::with(&[]);
    desk.call("demo -o demo");
    for part in ["corner", "corner-helix", "pocket"] {
        let packed = desk.call(&format!("pack demo/{part} -o {part}.tpk"));
        let made = &packed["again"]["corrections"][0];
        assert!(
            packed["again"]["same"] == true && made["same"].as_array().is_some_and(|same| same.len() == 7),
            "{packed}"
        );
    }
}

/// The packs of this repository: those of parts that somebody cut stand beside the first, which a virtual machine cut. A better model
/// may promise otherwise, but not much, and what it promises has to be what was measured.
#[test]
fn every_pack_of_the_repository_is_made_again_and_its_parts_came_out_as_promised() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/stories");
    let packs = fs::read_dir(&folder).expect("the folder").filter_map(|entry| Some(entry.ok()?.path()));
    let packs: Vec<_> = packs.filter(|path| path.extension().is_some_and(|ending| ending == "tpk")).collect();
    assert!(!packs.is_empty());
    for pack in packs {
        let name = pack.display().to_string();
        let done = truepath(&folder, &["--json", "study", "--pack", &name]);
        assert!(done.status.success(), "{name}: {}", text(&done.stderr));
        let again: Value = serde_json::from_slice(&done.stdout).expect("JSON");
        let number = |of: &Value, key: &str| of[key].as_f64().unwrap_or_else(|| panic!("{name}: {key} in {of}"));
        for one in again["corrections"].as_array().expect("corrections") {
            let [then, now] = ["promised_then", "promised"].map(|when| number(&one[when], "profile_mm"));
            assert!((then - now).abs() < 0.1 * then + 0.002, "{name}: {one}");
        }
        let parts = again["parts"].as_array().expect("parts");
        assert!(!parts.is_empty(), "{name}: a story without a part that was cut again shows nothing");
        for part in parts {
            assert!(4.0 * number(part, "within_two_sigma") >= 3.0 * number(part, "places"), "{name}: {part}");
        }
    }
}
