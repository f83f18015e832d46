//! A history goes in: its job, its parts with their readings, its corrections, what was identified from them.
//!
//! | row | known by |
//! |---|---|
//! | job | what must be the same from part to part |
//! | part | job, number, checksum of its probe file |
//! | measurement | part, and the readings as the job read them |
//! | correction | job, and its values |
//! | history | job, and the bytes of the file |
//!
//! A row that is known stays as it is, so that the same folder may come again, and from two computers at once.

use serde::Serialize;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::nm;
use truepath_job::job::StoreNames;

use crate::backend::Backend;
use crate::clock::now;
use crate::folder::Found;
use crate::names::{known, named, note};
use crate::rows::{FactTexts, HistoryRows, PartRows, json, sha256};
use crate::schema::count;
use crate::value::{Value, values};

/// The version of this program, as corrections and estimates name it.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");
/// Readings that one statement takes.
const READINGS: usize = 64;

/// What the parts were cut on, with and from, and who says so.
#[derive(Clone, Debug, Default)]
pub struct Setup {
    /// Names as the shop has them.
    pub names: StoreNames,
    /// The stick-out of the cutter, nm; 0 where it is not known.
    pub stickout_nm: i64,
    /// How warm the part was that was measured last, °C.
    pub temperature_c: Option<f64>,
    /// The command that puts it in, for the log of events.
    pub by: &'static str,
}

/// What putting one history in has done.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Added {
    /// The number of the history in the store.
    pub history: i64,
    /// The number of its job.
    pub job: i64,
    /// The number of its last part in the order they were cut.
    pub last_part: u32,
    /// Parts that were not in the store before.
    pub new_parts: usize,
    /// Readings that were not.
    pub new_readings: usize,
    /// Whether the store held the history already.
    pub known: bool,
}

/// The rows that a part refers to.
#[derive(Clone, Copy, Debug)]
struct Shop {
    machine: Option<i64>,
    holder: Option<i64>,
    cutter: Option<i64>,
    material: Option<i64>,
}

/// A part of the history as it is in the store.
struct Stored {
    part: i64,
    measurement: i64,
    correction: Option<i64>,
    set_aside: bool,
}

/// Puts a history in; within a transaction.
pub(crate) fn add(on: &mut dyn Backend, found: &Found, setup: &Setup) -> Result<Added, Failure> {
    let rows = HistoryRows::of(&found.history)?;
    // What the rows cannot give back is kept as it is: a file of an older version, or one that a rounding has touched.
    let original =
        if rows.text()? == found.bytes { None } else { Some(String::from_utf8_lossy(&found.bytes).into_owned()) };
    let facts = FactTexts::of(&found.history)?;
    let by = [("hash", facts.hash().into())];
    let more = [
        ("program_crc32", facts.get("program").into()),
        ("feature", facts.get("feature").into()),
        ("pass", facts.get("pass").into()),
        ("facts", (&facts.json).into()),
    ];
    let (job, _) = known(on, "job", &by, &more, true)?;
    let shop = shop(on, &facts, setup)?;
    let mut added = Added { history: 0, job, last_part: 0, new_parts: 0, new_readings: 0, known: false };
    let mut stored = Vec::new();
    for (k, part) in rows.parts.iter().enumerate() {
        let last = k + 1 == rows.parts.len();
        stored.push(add_part(on, (job, part), shop, (last, found.cut_nm, setup), &mut added)?);
        added.last_part = part.number;
    }
    let cut_with = stored.last().and_then(|part| part.correction);
    let next = correction(on, job, &rows.correction)?;
    if cut_with.is_some_and(|cut_with| cut_with != next) {
        let parent = "UPDATE correction SET parent = $1 WHERE id = $2 AND parent IS NULL";
        on.change(parent, &values![cut_with, next])?;
    }
    let by = [("job", job.into()), ("hash", sha256(&found.bytes).into())];
    let more = [
        ("last_number", i64::from(added.last_part).into()),
        ("cut_with", cut_with.into()),
        ("correction", next.into()),
        ("predicted", (&rows.predicted).into()),
        ("sigma", (&rows.sigma).into()),
        ("files", (&rows.files).into()),
        ("original", original.into()),
        ("tool_version", PROGRAM.into()),
        ("stored", now().into()),
    ];
    let (history, new) = known(on, "history", &by, &more, true)?;
    (added.history, added.known) = (history, !new);
    if new {
        for (position, part) in stored.iter().enumerate() {
            let values = values![history, position as i64, part.measurement, part.correction, part.set_aside];
            let insert = "INSERT INTO history_part (history, position, measurement, correction, set_aside) VALUES ($1, $2, $3, $4, $5)";
            on.change(insert, &values)?;
        }
        let part = stored.last().map(|part| part.part);
        note(on, "stored", (part, Some(history)), format!("by truepath {}, part {}", setup.by, added.last_part))?;
        if stored.last().is_some_and(|part| part.set_aside) {
            note(on, "set aside", (part, Some(history)), format!("part {}", added.last_part))?;
        }
    }
    estimate(on, (job, history), found, &stored)?;
    Ok(added)
}

/// Rows of machine, holder, cutter and material.
fn shop(on: &mut dyn Backend, facts: &FactTexts, setup: &Setup) -> Result<Shop, Failure> {
    let StoreNames { make, machine, holder, cutter, material, lot, cutter_serial: _, serial: _ } = &setup.names;
    let cutter = match cutter {
        None => None,
        Some(article) => {
            let by = [
                ("article", article.into()),
                ("diameter_nm", nm(facts.number("tool.diameter_mm")).nm().into()),
                ("teeth", (facts.number("tool.teeth") as i64).into()),
                ("helix_deg", facts.number("tool.helix_deg").into()),
                ("stickout_nm", setup.stickout_nm.into()),
            ];
            Some(known(on, "cutter", &by, &[("cut_nm", 0.into())], true)?.0)
        }
    };
    let material = match (material, lot) {
        (None, None) => None,
        (name, lot) => {
            let text = |text: &Option<String>| Value::from(text.as_deref().unwrap_or_default());
            Some(known(on, "material", &[("name", text(name)), ("lot", text(lot))], &[], true)?.0)
        }
    };
    let machine = named(on, "machine", machine.as_ref())?;
    if let (Some(machine), Some(make)) = (machine, make) {
        on.change("UPDATE machine SET make = $1 WHERE id = $2 AND make IS NULL", &values![make, machine])?;
    }
    Ok(Shop { machine, holder: named(on, "holder", holder.as_ref())?, cutter, material })
}

/// The number of a correction.
fn correction(on: &mut dyn Backend, job: i64, nodes: &String) -> Result<i64, Failure> {
    let by = [("job", job.into()), ("hash", sha256(nodes.as_bytes()).into())];
    Ok(known(on, "correction", &by, &[("tool_version", PROGRAM.into()), ("nodes", nodes.into())], false)?.0)
}

/// A part with its readings. `last` is the one that was measured now: only it has the serial number, and what is said of it is
/// noted although it is known.
fn add_part(
    on: &mut dyn Backend,
    (job, part): (i64, &PartRows),
    shop: Shop,
    (last, cut_nm, setup): (bool, i64, &Setup),
    added: &mut Added,
) -> Result<Stored, Failure> {
    let cut_with = part.correction.as_ref().map(|nodes| correction(on, job, nodes)).transpose()?;
    let serial = setup.names.serial.as_ref().filter(|_| last);
    let very_cutter = setup.names.cutter_serial.as_ref();
    let temperature_c = setup.temperature_c.filter(|_| last);
    let by =
        [("job", job.into()), ("number", i64::from(part.number).into()), ("probe_crc32", (&part.probe_crc32).into())];
    let more = [
        ("correction", cut_with.into()),
        ("serial", serial.into()),
        ("machine", shop.machine.into()),
        ("holder", shop.holder.into()),
        ("cutter", shop.cutter.into()),
        ("cutter_serial", very_cutter.into()),
        ("material", shop.material.into()),
        ("cut_nm", cut_nm.into()),
        ("temperature_c", temperature_c.into()),
        ("stored", now().into()),
    ];
    let (id, new) = known(on, "part", &by, &more, true)?;
    let cut = "UPDATE cutter SET cut_nm = cut_nm + $1 WHERE id = $2";
    if new {
        added.new_parts += 1;
        on.change(cut, &values![cut_nm, shop.cutter])?;
    } else if last {
        // It may have come before without its names.
        let unnamed = on.rows("SELECT cut_nm FROM part WHERE id = $1 AND cutter IS NULL", &values![id])?;
        if let (Some(row), Some(cutter)) = (unnamed.first(), shop.cutter) {
            on.change(cut, &values![row.integer(0)?, cutter])?;
        }
        let say = "UPDATE part SET serial = COALESCE(serial, $1), machine = COALESCE(machine, $2), holder = COALESCE(holder, $3), \
                   cutter = COALESCE(cutter, $4), material = COALESCE(material, $5), cutter_serial = COALESCE(cutter_serial, $6), \
                   temperature_c = COALESCE(temperature_c, $7) WHERE id = $8";
        let values =
            values![serial, shop.machine, shop.holder, shop.cutter, shop.material, very_cutter, temperature_c, id];
        on.change(say, &values)?;
    }
    let by = [("part", id.into()), ("hash", part.hash().into())];
    let more = [("sigma_nm", part.sigma_nm.into()), ("readings", (part.readings.len() as i64).into())];
    let (measurement, new) = known(on, "measurement", &by, &more, false)?;
    if new {
        readings(on, measurement, part)?;
        added.new_readings += part.readings.len();
        count(on, "reading", part.readings.len() as i64)?;
    }
    Ok(Stored { part: id, measurement, correction: cut_with, set_aside: part.set_aside })
}

/// The readings of a measurement, many with each statement.
fn readings(on: &mut dyn Backend, measurement: i64, part: &PartRows) -> Result<(), Failure> {
    const COLUMNS: usize = 11;
    let mut position = 0i64;
    for some in part.readings.chunks(READINGS) {
        let mut values = Vec::with_capacity(some.len() * COLUMNS);
        for r in some {
            let [x, y] = r.normal;
            values.extend(values![
                measurement,
                position,
                r.place_nm,
                r.height,
                r.error_nm,
                x,
                y,
                r.across_nm,
                r.pair.map(i64::from),
                r.sigma_nm,
                !part.set_aside,
            ]);
            position += 1;
        }
        let row = |k: usize| {
            let places: Vec<String> = (1..=COLUMNS).map(|c| format!("${}", k * COLUMNS + c)).collect();
            format!("({})", places.join(", "))
        };
        let rows: Vec<String> = (0..some.len()).map(row).collect();
        let insert = format!(
            "INSERT INTO reading (measurement, position, place_nm, height, error_nm, normal_x, normal_y, across_nm, pair, sigma_nm, used) VALUES {}",
            rows.join(", ")
        );
        on.change(&insert, &values)?;
    }
    Ok(())
}

/// What was identified, with the measurements it follows from: all of the history that were not set aside.
fn estimate(on: &mut dyn Backend, (job, history): (i64, i64), found: &Found, stored: &[Stored]) -> Result<(), Failure> {
    if found.identified.is_empty() {
        return Ok(());
    }
    let mean: std::collections::BTreeMap<_, _> =
        found.identified.iter().map(|(name, (value, _))| (name, value)).collect();
    // summary.json says standard deviations; what lies beside the diagonal is not known.
    let variance = |(name, (_, sigma)): (&String, &(f64, f64))| {
        let variance = std::collections::BTreeMap::from([(name.clone(), sigma * sigma)]);
        (name.clone(), variance)
    };
    let covariance: std::collections::BTreeMap<_, _> = found.identified.iter().map(variance).collect();
    let (mean, covariance) = (json(&mean)?, json(&covariance)?);
    let used: Vec<&Stored> = stored.iter().filter(|part| !part.set_aside).collect();
    let by = [("job", job.into()), ("hash", sha256(format!("{history}\n{mean}\n{covariance}").as_bytes()).into())];
    let more = [
        ("history", history.into()),
        ("scope", "job".into()),
        ("mean", mean.into()),
        ("covariance", covariance.into()),
        ("parts", (used.len() as i64).into()),
        ("model_version", PROGRAM.into()),
        ("said", found.said.clone().into()),
        ("stored", now().into()),
    ];
    let (estimate, new) = known(on, "estimate", &by, &more, false)?;
    for part in used.iter().filter(|_| new) {
        let insert = "INSERT INTO estimate_measurement (estimate, measurement) VALUES ($1, $2) ON CONFLICT DO NOTHING";
        on.change(insert, &values![estimate, part.measurement])?;
    }
    Ok(())
}
