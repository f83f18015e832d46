//! The shifted path of a slot, as the program writer wants it.

use truepath_program::BlockEdit;

use super::station::Station;

/// One list of points per line of the program, from the end of the block before to its own end.
pub fn edits(stations: &[Station], vectors: &[[f64; 2]]) -> Vec<BlockEdit> {
    let nm = |v: f64| (v * 1e6).round() as i64;
    let mut edits: Vec<BlockEdit> = Vec::new();
    for (station, vector) in stations.iter().zip(vectors) {
        let point = [nm(station.point[0] + vector[0]), nm(station.point[1] + vector[1])];
        let before = edits.last().and_then(|edit| edit.samples.last().copied());
        match edits.last_mut() {
            Some(edit) if edit.line == station.line => {
                if before != Some(point) {
                    edit.samples.push(point);
                }
            }
            _ => {
                let mut points: Vec<[i64; 2]> = before.into_iter().filter(|b| *b != point).collect();
                points.push(point);
                edits.push(BlockEdit::new(station.line, points));
            }
        }
    }
    edits
}
