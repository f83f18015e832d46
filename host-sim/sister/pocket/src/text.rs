//! The table of the sections for the terminal.

use truepath_ground::length::Unit;

use super::rows::SectionRow;

/// One line a section, and the reasons below it.
pub fn sections_text(rows: &[SectionRow], unit: Unit) -> String {
    let name = unit.name();
    // Of both walls of a slot; inches have a decimal more.
    let wide = if unit == Unit::Inch { 19 } else { 17 };
    let slot = rows.iter().any(|row| row.far_error_before_mm.is_some());
    let walls = if slot { format!("near / far wall, {name}") } else { format!("of the wall, {name}") };
    let mut text = format!(
        "section   type      length  engaged       force  deflection  {:<wide$} in     shift            {:<wide$} in\n\
         \u{20}                      {name}  degrees           N          {name}  {walls:<wide$} band   {name}               {name:<wide$}band\n",
        "error before", "error after"
    );
    let range = |low: String, high: String| if low == high { low } else { format!("{low}…{high}") };
    // Nothing left has no sign.
    let error = |mm: f64| {
        let text = format!("{:+.4}", unit.of(mm));
        if text.bytes().any(|digit| matches!(digit, b'1'..=b'9')) { text } else { text.replace('-', "+") }
    };
    let errors = |near: f64, far: Option<f64>| match far {
        Some(far) => format!("{} / {}", error(near), error(far)),
        None => error(near),
    };
    let length = |mm: f64| format!("{:.4}", unit.of(mm));
    let yes = |inside: bool| if inside { "yes" } else { "no" };
    for row in rows {
        let kind = match row.kind {
            super::section::Kind::Straight => "straight",
            super::section::Kind::Corner => "corner",
            super::section::Kind::Sharp => "sharp",
            super::section::Kind::Change => "change",
        };
        let shift =
            if row.shifted { range(length(row.shift_min_mm), length(row.shift_max_mm)) } else { "-".to_owned() };
        let line = format!(
            "{:<9} {:<8} {:>7.1}  {:<11} {:>7.1} {:>11.4}  {:<wide$} {:<6} {:<16} {:<wide$} {}",
            row.section,
            kind,
            unit.of(row.length_mm),
            range(format!("{:.1}", row.engaged_min_deg), format!("{:.1}", row.engaged_max_deg)),
            row.force_n,
            unit.of(row.deflection_mm),
            errors(row.error_before_mm, row.far_error_before_mm),
            yes(row.in_band_before),
            shift,
            errors(row.error_after_mm, row.far_error_after_mm),
            yes(row.in_band_after),
        );
        text += line.trim_end();
        text.push('\n');
    }
    // Sections of one reason stand together.
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for row in rows {
        match reasons.iter_mut().find(|(reason, _)| *reason == row.reason) {
            Some((_, names)) => names.push(&row.section),
            None => reasons.push((&row.reason, vec![&row.section])),
        }
    }
    text.push('\n');
    for (reason, names) in reasons {
        text += &format!("{}: {}\n", names.join(", "), unit.retold(reason));
    }
    text
}
