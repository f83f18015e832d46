//! docs/job.md and docs/job.schema.json: every key of a job, from the readers themselves: what they ask for, of which type and range.
//!
//! Jobs that hold every table are read while the keys asked for are noted. Default and meaning stand here; a key without them, and
//! one that no reader asks for any more, fail. `cargo xtask job --write` renews both.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Map, Value, json};
use truepath_ground::diagnostics::Source;
use truepath_ground::document::{Asked, Kind, asked_during};
use truepath_ground::length::in_inches;
use truepath_job::job::JobFile;

/// Tables that do not exclude each other, and those that do in the second and third job.
const JOBS: [&str; 3] = [
    "version = 1\nprogram = \"p.nc\"\n[stock]\nallowance_mm = 0.5\nprobe = \"stock.txt\"\n[tool]\ndiameter_mm = 10\nmeasured_diameter_mm = 10\nteeth = 4\n\
     [cut]\naxial_depth_mm = 5\n[force]\nmaterial = \"steel-40\"\n[machine]\n[probe]\nball_diameter_mm = 6\nformat = \"columns\"\n\
     [correct]\n[feed]\nmin_percent = 50\n[plan]\n[[plan.cutter]]\nnumber = 2\nhelix_deg = 40\n[part]\nlower_mm = -0.1\nupper_mm = 0.1\n[pocket]\n[store]\npath = \"shop.db\"\n\
     [[feature]]\nid = \"a\"\nallowance_mm = 0.4\n",
    "version = 1\nprogram = \"p.nc\"\n[stock]\nsurface = \"s.csv\"\n[tool]\ndiameter_mm = 10\nteeth = 4\n\
     [cut]\naxial_depth_mm = 5\n[force]\nktc_n_per_mm2 = 1\nkrc_n_per_mm2 = 1\nkte_n_per_mm = 1\nkre_n_per_mm = 1\n\
     [machine]\nstiffness_x_n_per_mm = 1000\nstiffness_y_n_per_mm = 1000\n",
    "version = 1\nprogram = \"p.nc\"\n[stock]\nallowance_mm = 0.5\n[tool]\ndiameter_mm = 10\nteeth = 4\n[cut]\naxial_depth_mm = 5\n",
];

/// Keys with their default and their meaning.
const MEANINGS: &[(&str, &str, &str)] = &[
    ("version", "none", "version of this format: 1"),
    ("program", "none", "the program of the part, relative to this file"),
    ("wall", "that of G41 or G42", "side of travel on which the wall lies"),
    (
        "dialect",
        "read from the program, else linuxcnc",
        "the control the program is written for: [dialects](dialects.md)",
    ),
    ("decimal", "calculator", "what X10 without a point is: 10 mm, or 10 of the least unit"),
    ("arc_centres", "by the first arc that closes in one way only", "whether I, J and K are places"),
    ("stock", "", "what lies on the wall before this pass"),
    ("stock.allowance_mm", "none", "an even allowance, below the cutter's diameter"),
    ("stock.surface", "none", "in its place: a table of points of the actual surface, relative to this file"),
    (
        "stock.probe",
        "even stock",
        "with allowance_mm: touches of the stock before this pass, relative to this file: [stock](stock.md)",
    ),
    (
        "stock.roughing_diameter_mm",
        "even stock",
        "with allowance_mm: diameter of the cutter that roughs this part in the same program, whose passes then say what they leave: [stock](stock.md#stock-that-the-programs-own-roughing-leaves)",
    ),
    (
        "stock.roughing_tool",
        "every pass before",
        "number of that cutter, where other cuts before the pass are no roughing",
    ),
    ("tool", "", "the cutter"),
    ("tool.diameter_mm", "that of a comment of the program", "nominal diameter"),
    ("tool.measured_diameter_mm", "diameter_mm", "measured diameter, within 10 % of the nominal one"),
    (
        "tool.runout_mm",
        "0",
        "radial offset of the cutter's axis as it is clamped, half of what a dial indicator swings; the diameter is without it: [runout](forces.md#runout-and-the-wall)",
    ),
    (
        "tool.runout_deg",
        "0, all of it towards a tooth",
        "direction of the offset behind a tooth, against the order in which teeth pass",
    ),
    (
        "tool.parts_cut",
        "0",
        "parts that this cutter had cut before part 1; what [a new one](learning.md#a-new-cutter) will need follows",
    ),
    ("tool.runout_from", "none", "in place of both: a file that `truepath forces` wrote, relative to this file"),
    ("tool.teeth", "those of a comment of the program", "number of teeth"),
    ("tool.helix_deg", "35", "helix angle"),
    (
        "tool.number",
        "T before M6 of the program",
        "its number at the machine; tells it from the other tools of the program",
    ),
    ("tool.offset_number", "0", "number of the tool offset in force, for the coprocessor"),
    (
        "tool.compensation",
        "found out from the program",
        "what the path under G41 or G42 is: that of the centre (D holds wear), or the outline (D holds the radius)",
    ),
    ("tool.stickout_mm", "not modelled", "from the collet to the tip; with material it makes the cutter a cantilever"),
    ("tool.material", "not modelled", "what the cutter is made of"),
    ("tool.flute_length_mm", "the stick-out", "length of the fluted part, for `truepath pocket`"),
    ("tool.shank_diameter_mm", "diameter_mm", "diameter of the shank, for `truepath pocket`"),
    (
        "tool.core_ratio",
        "by the number of teeth",
        "equivalent diameter of the fluted part over diameter_mm, for `truepath pocket`",
    ),
    ("tool.modulus_kn_per_mm2", "that of the material", "Young's modulus, for `truepath pocket`"),
    ("cut", "", "depth and speeds"),
    (
        "cut.axial_depth_mm",
        "from Z 0, or from the level before, down to the contour's Z",
        "how deep the cutter is in the stock",
    ),
    ("cut.spindle_rpm", "S of the program", "spindle speed"),
    ("cut.feed_mm_per_min", "F of the program", "feed along the contour"),
    (
        "force",
        "between aluminium and steel, with a wide prior",
        "cutting force, where the fit to the points begins: measured forces, a material, or the four coefficients",
    ),
    ("force.from", "none", "a file that `truepath forces` wrote, relative to this file: [measured forces](forces.md)"),
    ("force.material", "that of a comment of the program", "a row of the table of materials"),
    ("force.ktc_n_per_mm2", "1150, with a wide prior", "tangential chip coefficient"),
    ("force.krc_n_per_mm2", "370, with a wide prior", "radial chip coefficient"),
    ("force.kte_n_per_mm", "15, with a wide prior", "tangential edge coefficient"),
    ("force.kre_n_per_mm", "17, with a wide prior", "radial edge coefficient"),
    ("force.model", "auto", "which force makes the wall at a height; auto lets the points decide"),
    ("machine", "4000 N/mm, with a wide prior", "the machine at the cutter, where the fit to the points begins"),
    ("machine.stiffness_x_n_per_mm", "4000, with a wide prior", "stiffness along X"),
    ("machine.stiffness_y_n_per_mm", "4000, with a wide prior", "stiffness along Y"),
    ("machine.backlash_x_mm", "0", "backlash of X, for a warning"),
    ("machine.backlash_y_mm", "0", "backlash of Y, for a warning"),
    (
        "machine.repeatability_mm",
        "as parts show, else 0.010",
        "standard deviation of one dimension from part to part: the [floor](learning.md#the-floor) of what is promised",
    ),
    ("probe", "none", "how the part is probed; needed by every command that plans or reads touches"),
    ("probe.ball_diameter_mm", "none", "diameter of the ball: every point is shifted by half of it"),
    ("probe.format", "what the file shows", "format of the probe file: [probe files](probe-formats.md)"),
    ("probe.z_reference", "centre", "whether Z is that of the ball's centre or of its lowest point"),
    ("probe.noise_mm", "0.002", "standard deviation of one reading"),
    (
        "probe.work_offset_mm",
        "the answer to $# in the file",
        "`[x, y, z]`, ±10000: machine position of the work zero, for grbl and columns in machine coordinates",
    ),
    (
        "probe.columns",
        "the header of the file, else x,y,z",
        "names of the columns in their order: x, y, z, nx, ny, hit",
    ),
    ("probe.separator", "auto", "what separates the columns"),
    ("probe.decimal", "auto", "what stands before decimals"),
    ("probe.frame", "work", "coordinates of the columns"),
    ("probe.point", "tip", "ball centre (tip) or touched point (surface)"),
    ("probe.unit", "mm", "unit of the columns"),
    ("correct", "", "how to correct, and how the program is written"),
    ("correct.law", "model", "the law of the correction: [theory](theory.md)"),
    ("correct.clamp_mm", "0.5", "the largest correction; a larger one is refused"),
    ("correct.target", "mean", "what of the wall's error over the height is brought to zero"),
    ("correct.band_mm", "[0, axial_depth_mm]", "`[low, high]`: heights above the tip over which the target is taken"),
    ("correct.max_gouge_mm", "none", "the deepest cut into the wall allowed at any height"),
    ("correct.setup", "1", "number of the clamping, for the coprocessor"),
    ("correct.tolerance_mm", "0.001", "how far the written path may leave the computed one"),
    ("correct.max_arc_radius_mm", "1000", "arcs of a larger radius are written as lines"),
    ("correct.max_kink_deg", "1", "kinks of the written path where the program is smooth stay below this"),
    (
        "correct.discrepancy",
        "cancel",
        "what the points show beside machine and material: [discrepancy](discrepancy.md); ignored by a device that computes",
    ),
    ("correct.route", "program", "where the correction is applied"),
    ("feed", "no F word is changed", "whether and how far feeds may be changed: [feeds](feed.md)"),
    ("feed.min_percent", "none", "lowest feed, percent of the programmed one"),
    ("feed.max_percent", "100", "highest feed"),
    ("feed.keep", "probed", "hold the force below the largest at the probed places"),
    ("feed.max_force_n", "that of keep", "hold the mean force below this"),
    ("plan", "", "what a process of several passes has to keep: [plans](plan.md)"),
    ("plan.max_time_ratio", "3.5", "longest machining time, as a multiple of that of the program's own pass"),
    ("plan.max_cuts", "3", "cuts along the wall"),
    ("plan.max_levels", "4", "levels of a cut"),
    ("plan.min_level_mm", "1", "least depth of a level"),
    ("plan.reverse", "yes", "whether a cut may run against the direction of the program"),
    ("plan.min_percent", "30", "lowest feed, percent of the programmed one"),
    ("plan.max_percent", "200", "highest feed"),
    ("plan.max_feed_mm_per_min", "none", "highest feed of the machine"),
    ("plan.max_force_n", "none", "largest mean force over a revolution"),
    ("plan.max_engagement_deg", "none", "largest engagement angle"),
    (
        "plan.min_chip_mm",
        "none",
        "thinnest chip that still cuts, as the mean along the contour of the thickest of a tooth",
    ),
    (
        "plan.cutter",
        "none",
        "other cutters that the wall may be finished with, one table each: [plans](plan.md#other-cutters)",
    ),
    ("plan.cutter.number", "none", "number of the tool at the machine"),
    ("plan.cutter.diameter_mm", "that of the job", "diameter"),
    ("plan.cutter.teeth", "those of the job", "number of teeth"),
    ("plan.cutter.helix_deg", "none", "helix angle"),
    ("plan.cutter.stiffness_factor", "1", "stiffness of the machine with it, over that with the cutter of the job"),
    ("plan.cutter.stickout_mm", "by the factor", "in its place, where `[tool]` has it too: from the collet to the tip"),
    ("plan.cutter.material", "that of the job", "what it is made of, with stickout_mm"),
    ("part", "", "what the customer is told: [inspection](inspection.md)"),
    ("part.name", "none", "1 to 100 characters on one line, as the five below"),
    ("part.drawing", "none", "drawing"),
    ("part.serial", "none", "serial number; `--serial`"),
    ("part.material_batch", "none", "batch of the material"),
    ("part.customer", "none", "customer"),
    ("part.date", "none", "when it was measured; `--date`"),
    ("part.tolerance_mm", "no judgement", "half the width of the tolerance of the wall; `--tolerance`"),
    ("part.lower_mm", "no judgement", "in its place: the deepest cut allowed"),
    ("part.upper_mm", "no judgement", "with it: the most material left, above lower_mm"),
    ("part.uncertainty_mm", "none", "expanded uncertainty (k = 2) of a deviation"),
    ("part.reach_mm", "the cutter's diameter", "how far along the contour a point speaks for the wall"),
    ("part.reach_height_mm", "a quarter of the depth", "how far up and down it does"),
    ("part.temperature_c", "none", "how warm it was when it was measured, for the store: nothing is computed from it"),
    ("store", "", "the shop store that its parts go into: [store](store.md)"),
    ("store.path", "`TRUEPATH_STORE`, else none", "a file, relative to this one"),
    (
        "store.url",
        "`TRUEPATH_STORE`, else none",
        "in its place: `postgres://user@host/database`; the password comes from PGPASSFILE, `~/.pgpass` or PGPASSWORD",
    ),
    (
        "store.prior",
        "`\"job\"`",
        "where the fit to the points begins: at what this job states of machine and material, or at what other jobs of the store say of them; the points decide, and are fitted without the others where they contradict them",
    ),
    (
        "store.make",
        "none",
        "the make of the machine: those of one make are more alike; 1 to 100 characters on one line, as the seven below",
    ),
    ("store.machine", "none", "the machine"),
    ("store.holder", "none", "the holder of the cutter"),
    ("store.cutter", "none", "the article number of the cutter"),
    (
        "store.cutter_serial",
        "none",
        "the very cutter, engraved on it or its number in the tool crib: what other jobs say of its size is of this one",
    ),
    ("store.material", "`force.material`, else none", "the material"),
    ("store.lot", "part.material_batch", "the lot of the material"),
    ("store.serial", "part.serial", "serial number of the part that is measured"),
    ("pocket", "", "what `truepath pocket` cuts: [pockets](pocket.md)"),
    ("pocket.mode", "wall", "a finishing pass along a wall, or a slot"),
    ("pocket.tolerance_mm", "0.02", "half of the width of the band the walls may lie in"),
    ("pocket.per_section", "profile", "how the stations of a section are shifted"),
    ("feature", "every finishing contour", "cuts of the program by name, one table each: [features](features.md)"),
    ("feature.id", "none", "its name: 1 to 64 letters, digits, `-`, `_` or `.`"),
    ("feature.blocks", "markers in the program", "`[first, last]`: N words, or lines in a program without"),
    ("feature.lines", "markers in the program", "`[first, last]`: line numbers"),
    ("feature.tool", "that of the lines", "number of its tool"),
    ("feature.wall", "that of the job", "side of its wall"),
    ("feature.role", "finish", "what it is for; finishing cuts are corrected"),
    ("feature.allowance_mm", "that of the job", "stock on its wall"),
    ("feature.z_mm", "those of the program", "list of the heights of its passes, ±4000"),
];

/// Every key that is asked for, once, with the most that is known of its type, in the order of asking.
fn keys() -> Vec<Asked> {
    let mut keys: Vec<Asked> = Vec::new();
    for job in JOBS {
        let source = Source::new("job.toml", job.as_bytes().to_vec());
        let (read, asked) = asked_during(|| JobFile::parse(source, Path::new("")));
        read.unwrap_or_else(|error| panic!("{error}"));
        for key in asked {
            match keys.iter_mut().find(|known| known.path == key.path) {
                None => keys.push(key),
                Some(known) => {
                    // A name is a text, and whatever is asked for is first looked up as anything.
                    let less = matches!(
                        (&known.kind, &key.kind),
                        (Kind::Any, _) | (Kind::Text, Kind::Choice(_)) | (Kind::Number(_), Kind::Whole(_))
                    );
                    if less {
                        known.kind = key.kind;
                    }
                }
            }
        }
    }
    keys
}

/// Type and range in words.
fn words(kind: &Kind) -> (&'static str, String) {
    match kind {
        Kind::Any => ("list", String::new()),
        Kind::Table | Kind::Tables => ("table", String::new()),
        Kind::Text => ("text", String::new()),
        Kind::Number(range) => ("number", range.clone()),
        Kind::Whole(range) => ("whole number", range.clone()),
        Kind::Choice(names) => ("name", names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")),
    }
}

fn page() -> String {
    let mut text = "# The job file\n\n\
        Every key of a job with its range and default, written by `cargo xtask job --write` from what the readers ask for. \
        `truepath init program.nc` writes a job with all that the program says. Every key carries its unit; an unknown key is an \
        error. Every length may be written in inches under a key of its own, `allowance_in` in place of `allowance_mm`, \
        `feed_in_per_min`. Of a program in inches the terminal and the pictures of the commands speak in inches (0.0012 in); files and `--json` \
        have millimetres.\n\n\
        Editors that complete TOML by a schema (Taplo, *Even Better TOML*) take [job.schema.json](job.schema.json): a first line \
        `#:schema PATH/job.schema.json` in the job, or the `include` of a `[[rule]]` in `taplo.toml`.\n\n\
        A key whose default is read from the program or wide is *assumed* where it is left out: every command prints what it took \
        and why, and summaries list it (`assumed`). What would make a wrong part when guessed has no default.\n"
        .to_owned();
    let keys = keys();
    let mut tables: Vec<&str> = vec![""];
    tables.extend(keys.iter().filter(|k| matches!(k.kind, Kind::Table | Kind::Tables)).map(|k| k.path.as_str()));
    for table in tables {
        if table.is_empty() {
            text += "\n## At the top of the file\n\n";
        } else {
            let (default, about) = meaning(table);
            let list = keys.iter().any(|k| k.path == table && k.kind == Kind::Tables);
            let head = if list { format!("[[{table}]]") } else { format!("[{table}]") };
            let default = if default.is_empty() { String::new() } else { format!("; without it: {default}") };
            let _ = write!(text, "\n## `{head}`\n\n{about}{default}\n\n");
        }
        text += "| key | type | range | default | meaning |\n|---|---|---|---|---|\n";
        let inside = |key: &&Asked| {
            let (own, _) = key.path.rsplit_once('.').unwrap_or(("", ""));
            own == table && !matches!(key.kind, Kind::Table | Kind::Tables)
        };
        for key in keys.iter().filter(inside) {
            let (default, about) = meaning(&key.path);
            let (kind, range) = words(&key.kind);
            let name = key.path.rsplit('.').next().unwrap_or_default();
            let _ = writeln!(text, "| `{name}` | {kind} | {range} | {default} | {about} |");
        }
    }
    text
}

/// Default and meaning of a key.
fn meaning(path: &str) -> (&'static str, &'static str) {
    let found = MEANINGS.iter().find(|(key, ..)| *key == path);
    found.map(|(_, default, meaning)| (*default, *meaning)).unwrap_or_else(|| panic!("{path} has no meaning"))
}

/// The bounds of a range in words, over a factor: "0.1 to 100 mm", "above 0, up to 500 mm", "at least 0".
fn bounds(range: &str, factor: f64) -> Map<String, Value> {
    let rounded = |x: f64| (x / factor * 1e6).round() / 1e6;
    let number = |word: Option<&str>| word.and_then(|word| word.trim_matches(',').parse().ok()).map(rounded);
    let words: Vec<&str> = range.split_whitespace().collect();
    let behind =
        |name: &str| number(words.iter().position(|word| *word == name).and_then(|at| words.get(at + 1)).copied());
    let rows =
        [("minimum", number(words.first().copied())), ("exclusiveMinimum", behind("above")), ("maximum", behind("to"))];
    rows.into_iter().filter_map(|(key, value)| Some((key.to_owned(), json!(value?)))).collect()
}

/// What an editor knows of a key.
fn schema_of(key: &Asked, factor: f64) -> Value {
    let of = |name: &str, range: &str| {
        let mut value = bounds(range, factor);
        value.insert("type".to_owned(), json!(name));
        Value::Object(value)
    };
    let mut value = match &key.kind {
        Kind::Any => json!({ "type": "array" }),
        Kind::Text => json!({ "type": "string" }),
        Kind::Number(range) => of("number", range),
        Kind::Whole(range) => of("integer", range),
        Kind::Choice(names) => json!({ "enum": names }),
        Kind::Table => json!({ "type": "object", "additionalProperties": false, "properties": {} }),
        Kind::Tables => json!({
            "type": "array",
            "items": { "type": "object", "additionalProperties": false, "properties": {} },
        }),
    };
    let (default, about) = meaning(&key.path);
    // Of a link its text.
    let mut parts = about.split('[');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.split_once("](").and_then(|(link, behind)| Some((link, behind.split_once(')')?.1))) {
            Some((link, rest)) => text.extend([link, rest]),
            None => text.extend(["[", part]),
        }
    }
    let without = if ["", "none"].contains(&default) { String::new() } else { format!(". Without it: {default}") };
    value["description"] = json!(text + &without);
    value
}

/// The keys as a JSON schema, for editors that know TOML by one.
fn schema() -> String {
    let mut whole = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Job of Truepath",
        "type": "object",
        "required": ["version", "program"],
        "additionalProperties": false,
        "properties": {},
    });
    for key in keys() {
        let mut place = &mut whole["properties"];
        let (tables, name) = key.path.rsplit_once('.').unwrap_or(("", &key.path));
        for table in tables.split('.').filter(|table| !table.is_empty()) {
            place = &mut place[table];
            place =
                if place["items"].is_object() { &mut place["items"]["properties"] } else { &mut place["properties"] };
        }
        place[name] = schema_of(&key, 1.0);
        if let (Some(inches), Kind::Number(_)) = (in_inches(name), &key.kind) {
            place[inches] = schema_of(&key, 25.4);
        }
    }
    serde_json::to_string_pretty(&whole).expect("numbers and texts") + "\n"
}

/// Compares what is committed, or renews it.
fn compare(name: &str, now: &str) {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&place, now).expect("a file");
        return;
    }
    let written = std::fs::read_to_string(&place).unwrap_or_default();
    assert_eq!(written, now, "docs/{name} is not up to date: cargo xtask job --write");
}

#[test]
fn the_page_of_all_keys_is_what_the_readers_ask_for() {
    let keys = keys();
    for (path, ..) in MEANINGS {
        assert!(keys.iter().any(|key| key.path == *path), "no reader asks for {path}");
    }
    compare("job.md", &page());
}

#[test]
fn the_schema_of_a_job_is_what_the_readers_ask_for() {
    compare("job.schema.json", &schema());
}

#[test]
fn bounds_are_read_from_words() {
    let text = |range: &str, factor: f64| Value::Object(bounds(range, factor)).to_string();
    assert_eq!(text("0.1 to 100 mm", 1.0), r#"{"maximum":100.0,"minimum":0.1}"#);
    assert_eq!(text("above 0, up to 508 mm", 25.4), r#"{"exclusiveMinimum":0.0,"maximum":20.0}"#);
    assert_eq!(text("", 1.0), "{}");
}
