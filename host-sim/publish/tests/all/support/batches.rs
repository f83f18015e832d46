//! Folders as `truepath batch` writes them.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use truepath_batch::batch::{Batch, Request};
use truepath_batch::series::{Place, Reading, Series};

/// The summary of parts 1, 2, …, each off by so much at all of four places, under a symmetrical tolerance, mm.
pub fn summary(errors_mm: &[f64], tolerance_mm: f64) -> Value {
    let mut series = Series::default();
    for (k, error_mm) in errors_mm.iter().enumerate() {
        let reading = |(place, normal): (usize, [f64; 2])| Reading {
            place: Place {
                contour: None,
                s_mm: 10.0 * place as f64,
                height_mm: 5.0,
                normal,
                deflection_mm: 0.1 + 0.02 * place as f64,
            },
            // Half a micrometre that nothing explains.
            error_mm: error_mm + 0.0005 * ((k * 7 + place * 3) % 5) as f64 / 5.0,
        };
        let normals = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        series.push(k as u32 + 1, Vec::new(), normals.into_iter().enumerate().map(reading));
    }
    let request = Request { tolerance_mm: Some([-tolerance_mm, tolerance_mm]), ..Request::default() };
    let batch = Batch::of(&series, &request).expect("a touched part");
    let next = batch.alarms.first().map(|_| "put in a new cutter");
    let mut summary = serde_json::to_value(&batch).expect("numbers and texts");
    summary["next"] = json!(next);
    summary
}

/// Writes it as `truepath batch` does: whole, in place of the one before.
pub fn write(folder: &Path, summary: &Value) {
    fs::create_dir_all(folder).expect("a folder");
    let new = folder.join("summary.json.new");
    fs::write(&new, serde_json::to_vec_pretty(summary).expect("JSON")).expect("written");
    fs::rename(new, folder.join("summary.json")).expect("renamed");
}
