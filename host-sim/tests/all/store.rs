//! The shop store at the command line: what `correct` and `learn` wrote goes in once and comes out byte for byte; with a store
//! that is missing everything else is done as without one.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

use crate::workplace::{Workplace, text};

/// Where a part is touched, mm along the contour.
const PLACES: [f64; 4] = [20.0, 32.0, 68.0, 80.0];

/// The helical corner of the demonstration with the probe file of its first part.
fn desk() -> Workplace {
    let desk = Workplace::demo("corner-helix", &["program.nc", "job.toml", "plant.toml"]);
    desk.touch(&PLACES, None, "part-1.txt");
    desk
}

/// Runs the program with `TRUEPATH_STORE`.
fn with_store(desk: &Workplace, store: &str, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
    command.args(arguments.split(' ')).env("TRUEPATH_STORE", store).current_dir(desk.path()).output().expect("it runs")
}

fn same(desk: &Workplace, one: &str, other: &str) -> bool {
    let read = |name: &str| fs::read(desk.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    read(one) == read(other)
}

/// The files of two folders, byte for byte.
fn same_folders(one: &Path, other: &Path) {
    let names = |folder: &Path| {
        let mut names: Vec<_> =
            fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("one").file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(names(one), names(other));
    for name in names(one) {
        assert!(fs::read(one.join(&name)).ok() == fs::read(other.join(&name)).ok(), "{}", name.display());
    }
}

#[test]
fn parts_go_into_a_store_and_come_out_as_they_were() {
    let desk = desk();
    desk.call("correct job.toml --probe part-1.txt -o first");
    assert!(desk.run("store status").expect_err("no store is named").contains("O007"));
    assert!(desk.run("store status --store shop.db").expect_err("none there").contains("O002"));
    assert_eq!(desk.call("store init --store shop.db")["schema_version"], 3);
    let imported = desk.call("store import . --store shop.db --machine VF2 --cutter A20");
    assert_eq!((&imported["new_parts"], &imported["known"]), (&1.into(), &0.into()));
    let again = desk.call("store import first . --store shop.db");
    assert_eq!((&again["new_parts"], &again["new_readings"], &again["known"]), (&0.into(), &0.into(), &1.into()));
    let status = desk.call("store status --check --store shop.db");
    let counts =
        ["machines", "cutters", "jobs", "parts", "readings", "histories"].map(|key| status[key].as_u64().expect(key));
    assert_eq!(counts, [1, 1, 1, 1, 12, 1], "{status}");
    assert_eq!((&status["schema_version"], &status["last_parts"][0]["machine"]), (&3.into(), &"VF2".into()));

    // The next part goes in by itself; what is written is what is written without a store.
    desk.touch(&PLACES, Some("first/corrected.nc"), "part-2.txt");
    desk.call("learn job.toml --probe part-2.txt --from first -o plain");
    let learn = "learn job.toml --probe part-2.txt --from first -o second";
    let kept = with_store(&desk, "shop.db", learn);
    let said = text(&kept.stderr);
    assert!(kept.status.success() && said.contains("part 2 is in the store shop.db, as history 2"), "{said}");
    same_folders(&desk.path().join("plain"), &desk.path().join("second"));
    let status = desk.call("store status --check --store shop.db");
    assert_eq!((&status["parts"], &status["readings"]), (&2.into(), &24.into()));

    // The rows give both back, that of the job is the newer.
    let store = backup(&desk);
    for (what, out, of) in [("1", "out-1", "first"), ("2", "out-2", "second"), ("job.toml", "out-job", "second")] {
        desk.call(&format!("store export {what} -o {out} --store {store}"));
        assert!(same(&desk, &format!("{out}/history.json"), &format!("{of}/history.json")), "{what}");
    }
    assert!(desk.run("store export 3 -o none --store shop.db").expect_err("no such history").contains("O006"));
    // What came out is gone on from as from the folder itself.
    fs::copy(desk.path().join("first/corrected.nc"), desk.path().join("out-1/corrected.nc")).expect("a copy");
    desk.call("learn job.toml --probe part-2.txt --from out-1 -o again");
    assert!(same(&desk, "again/history.json", "second/history.json"));
}

/// A backup as docs/store.md says: the file itself, while nobody writes.
fn backup(desk: &Workplace) -> &'static str {
    fs::copy(desk.path().join("shop.db"), desk.path().join("backup.db")).expect("a copy");
    "backup.db"
}

#[test]
fn without_its_store_a_command_does_its_work_and_says_how_the_part_comes_in_later() {
    let desk = desk();
    desk.call("correct job.toml --probe part-1.txt -o plain");
    for (k, store) in ["missing.db", "plant.toml", "postgres://ann@127.0.0.1:1/shop"].into_iter().enumerate() {
        let kept = with_store(&desk, store, &format!("correct job.toml --probe part-1.txt -o out-{k}"));
        let said = text(&kept.stderr);
        assert_eq!(kept.status.code(), Some(0), "{said}");
        let later = format!("truepath store import out-{k} takes it later");
        assert!(said.contains("warning: the part is not in the store") && said.contains(&later), "{said}");
        same_folders(&desk.path().join("plain"), &desk.path().join(format!("out-{k}")));
    }
    assert!(!desk.path().join("missing.db").exists(), "only init makes a store");
}

#[test]
fn a_job_names_its_store_and_never_a_password() {
    let desk = desk();
    let job = desk.read("job.toml");
    let own = "[store]\npath = \"shop.db\"\nmachine = \"VF2\"\nmaterial = \"42CrMo4\"\n[part]\nserial = \"17\"\nmaterial_batch = \"L7\"\ntemperature_c = 21.5\n";
    desk.write("job.toml", format!("{job}\n{own}"));
    desk.call("store init --store shop.db");
    desk.call("correct job.toml --probe part-1.txt -o out");
    let status = desk.call("store status --store shop.db");
    let last = &status["last_parts"][0];
    assert_eq!((&last["serial"], &last["machine"], &status["materials"]), (&"17".into(), &"VF2".into(), &1.into()));
    assert_eq!(last["temperature_c"], 21.5);
    desk.call("store export job.toml -o copy");
    assert!(same(&desk, "copy/history.json", "out/history.json"));

    for url in ["postgres://ann:secret@db/shop", "postgres://db/shop?password=secret"] {
        desk.write("job.toml", format!("{job}\n[store]\nurl = \"{url}\"\n"));
        let said = desk.run("correct job.toml --probe part-1.txt -o none").expect_err("a password");
        assert!(said.contains("J045") && said.contains("PGPASSFILE") && !said.contains("secret"), "{said}");
    }
    for (wrong, code) in
        [("path = \"a\"\nurl = \"postgres://h/d\"", "J008"), ("url = \"mysql://h\"", "J006"), ("pth = \"a\"", "J003")]
    {
        desk.write("job.toml", format!("{job}\n[store]\n{wrong}\n"));
        assert!(desk.run("correct job.toml --probe part-1.txt -o none").expect_err(wrong).contains(code), "{wrong}");
    }
}

/// The largest error of the wall that a corrected program of the job leaves, mean over the height, mm.
fn left_mm(desk: &Workplace, corrected: &str) -> f64 {
    let machine: Machine = toml::from_str(&desk.read("plant.toml")).expect("a machine");
    let pass = Pass::read(JobFile::read(&desk.path().join("job.toml")).expect("a job")).expect("a pass");
    let commanded = virtual_mill::commanded(&pass, desk.read(corrected).as_bytes()).expect("a program");
    virtual_mill::mill(&pass, &machine, Some(&commanded)).expect("milled").judge().score.max_error_mm
}

#[test]
fn what_a_machine_has_shown_on_one_job_is_worth_something_on_the_next() {
    let desk = desk();
    let (job, program) = (desk.read("job.toml"), desk.read("program.nc"));
    let own = |more: &str| {
        format!(
            "{job}\n[store]\npath = \"shop.db\"\nmachine = \"VF2\"\ncutter = \"A20\"\nmaterial = \"42CrMo4\"\n{more}\n"
        )
    };
    desk.write("job.toml", own("prior = \"shop\""));
    desk.call("store init --store shop.db");
    let first = desk.call("correct job.toml --probe part-1.txt -o first");
    assert!(first["warnings"].to_string().contains("knows nothing of this machine"), "{}", first["warnings"]);
    // Another job of the same machine, touched on one of its walls only.
    desk.write("program.nc", program.replacen('%', "%\n(another part)", 1));
    desk.touch(&[20.0, 28.0], None, "few.txt");
    let shop = desk.call("correct job.toml --probe few.txt -o shop");
    let began = "the fit begins at what 1 other parts of the store shop.db say";
    assert!(shop["warnings"].to_string().contains(began), "{}", shop["warnings"]);
    // Where to touch it follows from what is left open.
    let open = |more: &str| {
        let plan = desk.call(&format!("probe job.toml --dialect linuxcnc -o touch.ngc --points 4 --force{more}"));
        (plan["wall_sigma_before_mm"].as_f64().expect("a number"), plan["warnings"].to_string())
    };
    let ((open_to_shop, said), (_, away)) = (open(""), open(" --store missing.db"));
    assert!(said.contains(began) && away.contains("the store does not answer"), "{said} {away}");
    // So it is after those touches, on the part that the correction cuts, and with passes that are planned.
    let next = |more: &str| {
        let plan = desk.call(&format!("probe job.toml --next {more}"));
        (plan["wall_sigma_before_mm"].as_f64().expect("a number"), plan["warnings"].to_string())
    };
    let further = ["--probe few.txt", "--from shop"].map(next);
    let planned = desk.call("plan job.toml --probe few.txt --tolerance 0.05");
    for said in further.iter().map(|(_, said)| said).chain([&planned["warnings"].to_string()]) {
        assert!(said.contains(began), "{said}");
    }
    // A pack holds where the fit began: the store is not asked when the correction is made again.
    fs::create_dir(desk.path().join("kept")).expect("a folder");
    for file in ["job.toml", "program.nc", "few.txt", "shop"] {
        fs::rename(desk.path().join(file), desk.path().join("kept").join(file)).expect("moved");
    }
    let pack = desk.call("pack kept -o part.tpk");
    assert_eq!(pack["again"]["same"], true, "{}", pack["again"]);
    for file in ["job.toml", "program.nc", "few.txt", "shop"] {
        fs::rename(desk.path().join("kept").join(file), desk.path().join(file)).expect("moved");
    }
    desk.write("job.toml", own(""));
    let (further_alone, _) = next("--probe few.txt");
    assert!(further[0].0 < 0.9 * further_alone, "{} {further_alone}", further[0].0);
    let (open_alone, said) = open("");
    assert!(open_to_shop < 0.5 * open_alone && !said.contains("store"), "{open_to_shop} {open_alone} {said}");
    let alone = desk.call("correct job.toml --probe few.txt -o alone");
    assert!(!alone["warnings"].to_string().contains("the store"), "{}", alone["warnings"]);
    let sigma = |summary: &serde_json::Value| summary["identified"]["compliance"]["sigma"].as_f64().expect("a number");
    assert!(sigma(&shop) < 0.8 * sigma(&alone), "{} {}", sigma(&shop), sigma(&alone));
    let [with, without] = ["shop", "alone"].map(|folder| left_mm(&desk, &format!("{folder}/corrected.nc")));
    assert!(with < 0.5 * without, "{with} {without}");

    // A third job, of a machine that gives way a quarter as far: wrongly named.
    let stiff = "compliance_mm_per_n = [[0.0002, 0.00002], [0.00002, 0.00026]]";
    let plant = desk.read("plant.toml");
    let plant: String =
        plant.lines().map(|l| if l.starts_with("compliance") { stiff } else { l }).collect::<Vec<_>>().join("\n");
    desk.write("plant.toml", plant);
    desk.write("program.nc", program.replacen('%', "%\n(a third part)", 1));
    desk.touch(&PLACES, None, "third.txt");
    desk.call("correct job.toml --probe third.txt -o third-alone");
    desk.write("job.toml", own("prior = \"shop\""));
    let third = desk.call("correct job.toml --probe third.txt -o third");
    let contradicted = "contradict what other jobs of the shop say, most of all about how far the machine gives way";
    assert!(third["warnings"].to_string().contains(contradicted), "{}", third["warnings"]);
    assert!(same(&desk, "third/correction.csv", "third-alone/correction.csv"));

    // A store that does not answer keeps nobody waiting.
    let away = desk.call("correct job.toml --probe third.txt -o away --store missing.db");
    assert!(away["warnings"].to_string().contains("the store does not answer"), "{}", away["warnings"]);
    assert!(same(&desk, "away/correction.csv", "third-alone/correction.csv"));
}
