//! The jobs of the store that let another one be expected.

use std::collections::BTreeSet;

use truepath_correction::learning::Facts;
use truepath_correction::shop::{Member, Said, Setting, Shop};
use truepath_ground::diagnostics::Failure;
use truepath_job::job::StoreNames;

use crate::backend::Backend;
use crate::rows::{FactTexts, mm_of, of_json};
use crate::value::{Row, values};

/// Jobs that are asked, the newest first: more say hardly more.
const MOST: i64 = 200;

/// Where a part is cut and from what, as the shop calls it: what is mounted is holder, cutter and stick-out together. A very cutter is
/// known with its stated diameter: ground again, it is another one.
///
/// # Errors
/// Facts that are no JSON.
pub fn setting(names: &StoreNames, stickout_nm: i64, facts: &Facts) -> Result<Setting, Failure> {
    Ok(with_diameter(names, stickout_nm, FactTexts::of_facts(facts)?.get(DIAMETER)))
}

/// The fact that is the diameter of the cutter.
const DIAMETER: &str = "tool.diameter_mm";

fn with_diameter(names: &StoreNames, stickout_nm: i64, diameter: &str) -> Setting {
    let text = |name: &Option<String>| name.clone().unwrap_or_default();
    let (holder, cutter) = (text(&names.holder), text(&names.cutter));
    let is_known = !holder.is_empty() || !cutter.is_empty();
    let mounting = if is_known { format!("{holder}\n{cutter}\n{}", mm_of(stickout_nm)) } else { String::new() };
    Setting {
        make: text(&names.make),
        machine: text(&names.machine),
        mounting,
        material: text(&names.material),
        lot: text(&names.lot),
        cutter: names.cutter_serial.as_ref().map_or_else(String::new, |cutter| format!("{cutter}\n{diameter}")),
    }
}

/// What the newest measured parts of every other program say that were cut on this machine or make, from this material or with this very
/// cutter, each part once, and the number of the newest estimate among them.
///
/// Those of this program are left out: they may be of the same points.
pub(crate) fn members(on: &mut dyn Backend, facts: &Facts, wanted: &Setting) -> Result<(Shop, Option<i64>), Failure> {
    let facts = FactTexts::of_facts(facts)?;
    let select = "SELECT e.id, e.said, ma.make, ma.name, ho.name, cu.article, cu.stickout_nm, mt.name, mt.lot, p.probe_crc32, p.cutter_serial, j.facts \
         FROM estimate e \
         JOIN job j ON j.id = e.job JOIN history h ON h.id = e.history \
         JOIN history_part hp ON hp.history = h.id AND hp.position = (SELECT max(position) FROM history_part WHERE history = h.id) \
         JOIN measurement me ON me.id = hp.measurement JOIN part p ON p.id = me.part \
         LEFT JOIN machine ma ON ma.id = p.machine LEFT JOIN holder ho ON ho.id = p.holder \
         LEFT JOIN cutter cu ON cu.id = p.cutter LEFT JOIN material mt ON mt.id = p.material \
         WHERE e.said IS NOT NULL AND hp.set_aside = 0 AND j.program_crc32 <> $1 \
         AND (ma.name = $2 OR ma.make = $3 OR mt.name = $4 OR p.cutter_serial = $5) \
         AND NOT EXISTS (SELECT 1 FROM history n WHERE n.job = h.job AND n.cut_with = h.correction AND n.last_number > h.last_number) \
         ORDER BY e.id DESC LIMIT $6";
    let cutter = wanted.cutter.split('\n').next().filter(|name| !name.is_empty());
    let values = values![facts.get("program"), &wanted.machine, &wanted.make, &wanted.material, cutter, MOST];
    let rows = on.rows(select, &values)?;
    let member = |row: &Row| {
        let text = |column| Ok::<_, Failure>(row.some_text(column)?.filter(|text| !text.is_empty()).map(str::to_owned));
        let names = StoreNames {
            make: text(2)?,
            machine: text(3)?,
            holder: text(4)?,
            cutter: text(5)?,
            cutter_serial: text(10)?,
            material: text(7)?,
            lot: text(8)?,
            ..StoreNames::default()
        };
        let said = Said::read(of_json(row.text(1)?)?).map_err(|wrong| {
            let estimate = row.integer(0).unwrap_or_default();
            Failure::Internal(format!("estimate {estimate} of the store is damaged: what the points say {wrong}"))
        })?;
        let facts = FactTexts::read(row.text(11)?)?;
        Ok::<_, Failure>(Member {
            setting: with_diameter(&names, row.some_integer(6)?.unwrap_or(0), facts.get(DIAMETER)),
            said,
        })
    };
    // The walls of one part were fitted together: what one of them says is said by all.
    let mut parts = BTreeSet::new();
    let mut members = Vec::new();
    for row in &rows {
        if parts.insert(row.text(9)?) {
            members.push(member(row)?);
        }
    }
    let newest = rows.first().map(|row| row.integer(0)).transpose()?;
    Ok((Shop { members }, newest))
}
