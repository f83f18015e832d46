//! Histories that were never measured, as files and as folders.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use truepath_correction::learning::History;
use truepath_ground::diagnostics::{Failure, Form};
use truepath_job::job::StoreNames;
use truepath_store::{Place, Setup, Store};

/// What a work gave, or what it said.
pub fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|failure| panic!("{}", failure.render(Form::Plain)))
}

/// The code that a work is refused with.
pub fn code<T>(result: Result<T, Failure>) -> String {
    match result.err().expect("an error") {
        Failure::Input(error) => error.code().to_owned(),
        other => panic!("{other}"),
    }
}

/// A correction of a few samples.
fn nodes(seed: u64) -> Value {
    let row = |k: u64| (0..40).map(|i| ((seed * 31 + k * 7 + i * i) % 2000) as i64 - 1000).collect::<Vec<_>>();
    json!({ "chip_x": row(1), "chip_y": row(2), "edge_x": row(3), "edge_y": row(4) })
}

/// Part `number` of a job, with so many readings.
fn part(job: u64, number: u64, readings: u64) -> Value {
    let point = |k: u64| {
        let mixed = (job * 1_000_003 + number * 7919 + k * 104_729) % 999_983;
        let mut point = json!({
            "s_mm": (k * 1_234_567 + mixed) as f64 / 1e6,
            // Shares and normals have 32 binary places.
            "height": ((mixed << 12) + 12_345) as f64 / (1u64 << 32) as f64,
            "error_mm": (mixed as f64 - 500_000.0) / 1e6,
            "normal": [0.600_000_000_093_132_3, -0.799_999_999_813_735_5],
        });
        if k % 3 == 1 {
            point["across_s_mm"] = json!((k * 1_234_567 + 7) as f64 / 1e6);
            point["noise_mm"] = json!(0.004_321);
        } else if k % 3 == 2 {
            point["pair"] = json!(k);
        }
        point
    };
    json!({
        "number": number,
        "probe_crc32": format!("{:08x}", job * 4096 + number),
        "noise_mm": 0.002,
        "points": (0..readings).map(point).collect::<Vec<_>>(),
        "correction": if number == 1 { Value::Null } else { nodes(job * 100 + number - 1) },
        "set_aside": number == 4,
    })
}

/// `history.json` after some parts of a job.
pub fn history(job: u64, parts: u64, readings: u64) -> Vec<u8> {
    let facts = [
        ("program", format!("{job:08x}")),
        ("feature", "the only cut".to_owned()),
        ("pass", "1".to_owned()),
        ("tool.diameter_mm", "20".to_owned()),
        ("tool.teeth", "6".to_owned()),
        ("tool.helix_deg", "30".to_owned()),
    ];
    let history = json!({
        "version": 1,
        "facts": facts,
        "parts": (parts.saturating_sub(7).max(1)..=parts).map(|number| part(job, number, readings)).collect::<Vec<_>>(),
        "next": {
            "correction": nodes(job * 100 + parts),
            "predicted_nm": (0..40).map(|k| k * 3 - 60).collect::<Vec<i64>>(),
            "sigma_nm": vec![5i64; 40],
            "files": [{ "name": "corrected.nc", "crc32": format!("{parts:08x}") }],
        },
    });
    let history: History = serde_json::from_value(history).expect("a history");
    history.text().expect("its text")
}

/// A folder as `correct` and `learn` leave it.
pub fn folder(at: &Path, name: &str, history: &[u8]) -> PathBuf {
    let folder = at.join(name);
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("history.json"), history).expect("written");
    fs::write(folder.join("correction.csv"), "s_mm,x_mm\n0.0,1\n125.5,2\n").expect("written");
    let identified =
        r#"{ "identified": { "ktc": { "value": 1150.25, "sigma": 30.5 }, "kte": { "value": 15, "sigma": 2 } } }"#;
    fs::write(folder.join("summary.json"), identified).expect("written");
    folder
}

/// A new store in a file.
pub fn file_in(at: &Path) -> Place {
    let place = Place::File(at.join("shop.db"));
    shown(Store::init(&place, false));
    place
}

/// What the shop calls things.
pub fn setup() -> Setup {
    let text = |text: &str| Some(text.to_owned());
    let names = StoreNames {
        make: text("Haas"),
        machine: text("VF2"),
        holder: text("ER32-1"),
        cutter: text("A20-6"),
        cutter_serial: text("A20-6/17"),
        material: text("42CrMo4"),
        lot: text("L7"),
        serial: None,
    };
    Setup { names, stickout_nm: 60_000_000, temperature_c: Some(21.5), by: "import" }
}
