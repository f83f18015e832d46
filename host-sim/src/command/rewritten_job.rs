//! The job of a program that was rewritten before it is milled: half an allowance, arcs in corners.

use std::path::Path;

use toml_edit::{Array, DocumentMut, Item, Value, value};
use truepath_core::geometry::Side;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::feature::lines_named;
use truepath_job::pass::Pass;
use truepath_program::Rewritten;

use crate::command::relative::relative;

/// The text of the original job, comments included, about the program `name`, and with another allowance of the pass where one is
/// given, and with its `wall` where the job leaves that to the program; it lies in `folder`, where the files it names are named from.
/// Features are named by their lines in the new program, which has more of them. `said` is its first line.
pub(super) fn job_of(
    pass: &Pass,
    written: &Rewritten,
    (name, folder): (&str, &Path),
    allowance: Option<Offset>,
    wall: Option<Side>,
    said: &str,
) -> Result<String, Failure> {
    let text = String::from_utf8_lossy(pass.job.source().bytes()).into_owned();
    let mut document: DocumentMut =
        text.parse().map_err(|e| Failure::Internal(format!("the job cannot be edited: {e}")))?;
    set(&mut document["program"], name);
    // The program may have said it with the compensation that is no longer in it.
    if let Some(wall) = wall.filter(|_| document.get("wall").is_none()) {
        document["wall"] = value(if wall == Side::Left { "left" } else { "right" });
    }
    let beside = Path::new(pass.job.source().name()).parent().unwrap_or(Path::new(""));
    for (table, key) in [("stock", "probe"), ("stock", "surface"), ("force", "from"), ("tool", "runout_from")] {
        let named = document.get(table).and_then(|table| table.get(key)).and_then(Item::as_str);
        if let Some(file) = named.map(|file| beside.join(file)) {
            set(&mut document[table][key], relative(&folder.join(name), &file)?);
        }
    }
    let chosen = pass.plan.as_ref().and_then(|plan| plan.id.as_deref());
    let mut own_allowance = false;
    if let Some(tables) = document.get_mut("feature").and_then(Item::as_array_of_tables_mut) {
        let places = lines_named(&pass.job, &pass.program)?;
        for ((table, feature), place) in tables.iter_mut().zip(&pass.job.features).zip(places) {
            if let Some(lines) = place.map(|lines| written.lines(lines)) {
                table.remove("blocks");
                table["lines"] = value([lines.first, lines.last].map(i64::from).into_iter().collect::<Array>());
            }
            if let Some(allowance) = allowance.filter(|_| Some(feature.id.as_str()) == chosen) {
                set(&mut table["allowance_mm"], mm(allowance));
                own_allowance = true;
            }
        }
    }
    if let Some(allowance) = allowance.filter(|_| !own_allowance) {
        set(&mut document["stock"]["allowance_mm"], mm(allowance));
    }
    Ok(format!("# {said}\n{document}"))
}

/// Gives a key another value; what stands behind it stays.
fn set(item: &mut Item, new: impl Into<Value>) {
    let mut new = new.into();
    if let Some(old) = item.as_value() {
        *new.decor_mut() = old.decor().clone();
    }
    *item = Item::Value(new);
}
