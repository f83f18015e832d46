//! The help: commands by what one wants to do, and examples.

use std::fmt::Write as _;

use clap::Command;

/// What one wants to do, and the commands for it.
const GROUPS: [(&str, &[&str]); 7] = [
    ("See it", &["demo"]),
    ("Correct a part", &["init", "probe", "inspect", "correct", "learn", "plan", "split", "fillet", "batch"]),
    ("Look closer", &["simulate", "compare", "plot", "canon", "forces"]),
    ("Keep and share", &["store", "publish", "pack", "unpack", "study"]),
    ("Coprocessor", &["image", "key", "replay", "hil", "device", "firmware"]),
    ("Without a probe, other processes", &["pocket", "bore", "multiaxis"]),
    ("This program", &["completions", "man", "help"]),
];

/// Command lines of each command, and what they do.
const EXAMPLES: [(&str, &[(&str, &str)]); 31] = [
    ("demo", &[("truepath demo", "three parts, reports and programs in out/demo")]),
    (
        "init",
        &[
            ("truepath init part.nc", "asks what the program does not say, writes job.toml"),
            ("truepath init part.nc --yes --force", "asks nothing: what is missing is marked in the file"),
        ],
    ),
    (
        "simulate",
        &[
            ("truepath simulate job.toml -o out", "the pass as the model predicts it"),
            ("truepath simulate job.toml --plant machine.toml -o out", "as a virtual machine cuts it"),
        ],
    ),
    (
        "probe",
        &[
            ("truepath probe job.toml --dialect haas -o verify.nc", "touches the milled wall"),
            ("truepath probe job.toml --next --probe probe.txt", "names the touch that would tell most"),
            ("truepath probe job.toml --dimensions -o sheet", "a sheet for a calliper instead"),
        ],
    ),
    ("inspect", &[("truepath inspect job.toml --probe probe.txt -o out", "accuracy report of a milled wall")]),
    ("compare", &[("truepath compare job.toml --probe probe.txt -o out", "what each law of correction leaves")]),
    (
        "correct",
        &[
            ("truepath correct job.toml --probe probe.txt -o out", "the corrected program, with its proof"),
            ("truepath correct job.toml --dimensions widths.toml -o out", "from measured widths alone"),
            ("truepath correct job.toml --probe probe.txt --route coprocessor -o out", "an image instead"),
            ("truepath correct job.toml --probe - -o out < probe.txt", "readings from standard input"),
        ],
    ),
    (
        "plan",
        &[
            ("truepath plan job.toml --probe probe.txt --tolerance 0.02", "up to six choices, one recommended"),
            ("truepath plan job.toml --probe probe.txt --tolerance 0.02 --write 2 -o out", "the program of one"),
        ],
    ),
    ("learn", &[("truepath learn job.toml --probe part2.txt --from out -o out3", "the next part, from the last one")]),
    ("pack", &[("truepath pack out -o part.tpk", "job, program, readings and corrections in one file")]),
    (
        "store",
        &[
            ("truepath store init --store shop.db", "a new store in one file"),
            ("truepath store import parts --store shop.db", "every part in and below a folder, each once"),
            ("truepath store status --store postgres://ann@db/shop", "what is in it, on a server of the shop"),
            ("truepath store export job.toml --store shop.db -o out", "history.json again, byte for byte"),
            ("truepath learn job.toml --probe part2.txt --from out -o out3 --store shop.db", "the part goes in"),
        ],
    ),
    (
        "publish",
        &[
            ("truepath publish batch --machine vf2 --mqtt mqtt://127.0.0.1", "what changes in a batch, to a broker"),
            ("truepath publish batch --machine vf2 --mqtt mqtts://ann@broker.shop --ca shop.pem", "encrypted"),
            ("truepath publish batch --machine vf2 --mtconnect 7878", "agents of MTConnect read it"),
            ("truepath publish batch --machine vf2 --mqtt mqtt://127.0.0.1 --once", "everything once, then the end"),
        ],
    ),
    ("unpack", &[("truepath unpack part.tpk -o part", "as a folder again")]),
    ("split", &[("truepath split job.toml -o out", "cuts half of the allowance first")]),
    ("batch", &[("truepath batch job.toml parts.csv --from out -o batch", "many parts: what moves, and when to act")]),
    (
        "fillet",
        &[("truepath fillet job.toml --corner-radius 8 -o out", "corners of 8 mm in place of sharp ones on the path")],
    ),
    ("pocket", &[("truepath pocket job.toml -o out", "section by section, from tool and material data")]),
    ("plot", &[("truepath plot error out -o wall.svg", "the wall to scale, errors enlarged")]),
    ("study", &[("truepath study -o out --seeds 2", "virtual machines of all kinds")]),
    (
        "multiaxis",
        &[("truepath multiaxis part.nc --machine machine.toml --tolerance 0.005 -o out.nc", "proved move by move")],
    ),
    ("replay", &[("truepath replay part.tpi --setpoints in.csv -o out.csv", "setpoints as the device answers them")]),
    (
        "image",
        &[
            ("truepath image part.tpi", "what the image holds"),
            ("truepath image sign part.tpi --key shop.key -o signed.tpi", "signed, to be taken by a device with a key"),
            ("truepath image verify signed.tpi --key shop.key.pub", "whether it is signed with that key"),
        ],
    ),
    (
        "key",
        &[
            ("truepath key new shop.key", "a pair: shop.key and shop.key.pub"),
            ("truepath key show shop.key", "the public key"),
        ],
    ),
    (
        "hil",
        &[("truepath hil part.tpi --board virtual --random 200000 --drop 0.01", "the emulated board, with faults")],
    ),
    (
        "device",
        &[
            ("truepath device --port /dev/ttyACM0 upload part.tpi --activate", "an image onto the board"),
            ("truepath device --port /dev/ttyACM0 monitor", "its state, live"),
            (
                "truepath device --port /dev/ttyACM0 --key shop.key update new.tpf",
                "another firmware, tried and confirmed",
            ),
        ],
    ),
    (
        "firmware",
        &[
            ("truepath firmware sign truepath.bin --board nucleo-h743zi2 --key shop.key -o new.tpf", "an update"),
            ("truepath firmware show new.tpf --key shop.key.pub", "what it is for, and whether it is whole"),
        ],
    ),
    (
        "bore",
        &[("truepath bore --hole-radius 90 --cutter-radius 10 --teeth 3 --feed 480 --rpm 95.5", "the wall it leaves")],
    ),
    ("forces", &[("truepath forces cuts.toml -o out", "coefficients with standard deviations")]),
    (
        "canon",
        &[("truepath canon part.nc", "the moves as text"), ("truepath canon - < part.nc", "from standard input")],
    ),
    ("completions", &[("truepath completions bash > /etc/bash_completion.d/truepath", "for one shell")]),
    ("man", &[("truepath man -o man1", "truepath.1 and one page of each command")]),
];

/// Columns of the name of a command, and of a line of the overview.
const COLUMN: usize = 13;

/// The template of the overview: every command below what it is for.
pub fn overview(command: &Command) -> String {
    let mut text = String::from("{about-with-newline}\n{usage-heading} {usage}\n");
    for (group, names) in GROUPS {
        let rows: Vec<_> = names.iter().filter_map(|name| Some((*name, about(command, name)?))).collect();
        if rows.is_empty() {
            continue;
        }
        let _ = writeln!(text, "\n{group}:");
        for (name, about) in rows {
            let _ = writeln!(text, "  {name:<COLUMN$}{about}");
        }
    }
    text + "\nOptions:\n{options}\n\nExamples and all options of a command: truepath COMMAND --help"
}

/// What a command does; none when this build does not have it.
fn about(command: &Command, name: &str) -> Option<String> {
    if name == "help" {
        return Some("This overview, or the help of a command".to_owned());
    }
    Some(command.find_subcommand(name)?.get_about()?.to_string())
}

/// The examples of every command that has some.
pub fn examples(wanted: impl Fn(&str) -> bool) -> impl Iterator<Item = (&'static str, String)> {
    EXAMPLES.into_iter().filter(move |(name, _)| wanted(name)).map(|(name, rows)| {
        let mut text = String::from("Examples:");
        for (line, what) in rows {
            let _ = write!(text, "\n  {line}\n      {what}");
        }
        (name, text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::command;

    #[test]
    fn every_command_stands_in_one_group_and_has_examples_that_are_command_lines() {
        let whole = command();
        for name in whole.get_subcommands().map(Command::get_name) {
            let groups = GROUPS.iter().filter(|(_, names)| names.contains(&name)).count();
            assert_eq!(groups, 1, "{name} in {groups} groups");
            assert!(name == "help" || EXAMPLES.iter().any(|(of, _)| *of == name), "{name} without examples");
        }
        for (line, _) in EXAMPLES.iter().flat_map(|(_, rows)| *rows) {
            let words = line.split(['<', '>']).next().unwrap_or_default().split_whitespace();
            let parsed = command().try_get_matches_from(words);
            assert!(parsed.is_ok(), "{line}: {}", parsed.unwrap_err());
        }
    }

    #[test]
    fn no_line_of_the_overview_is_wider_than_a_hundred_columns() {
        let text = overview(&command());
        let long: Vec<&str> = text.lines().filter(|line| line.chars().count() > 100).collect();
        assert!(long.is_empty(), "{long:#?}");
    }
}
