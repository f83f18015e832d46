//! The table of the sections for the terminal.

use super::rows::SectionRow;

/// One line a section, and the reasons below it.
pub fn sections_text(rows: &[SectionRow]) -> String {
    let slot = rows.iter().any(|row| row.far_error_before_mm.is_some());
    let walls = if slot { "near / far wall, mm" } else { "of the wall, mm" };
    let mut text = format!(
        "section   type      length  engaged       force  deflection  error before      in     shift            error after       in\n\
         \u{20}                      mm  degrees           N          mm  {walls:<17} band   mm               mm                band\n"
    );
    let range = |a: f64, b: f64, digits: usize| {
        let (low, high) = (format!("{a:.digits$}"), format!("{b:.digits$}"));
        if low == high { low } else { format!("{low}…{high}") }
    };
    // Nothing left has no sign.
    let error = |v: f64| format!("{v:+.4}").replace("-0.0000", "+0.0000");
    let errors = |near: f64, far: Option<f64>| match far {
        Some(far) => format!("{} / {}", error(near), error(far)),
        None => error(near),
    };
    let yes = |inside: bool| if inside { "yes" } else { "no" };
    for row in rows {
        let kind = match row.kind {
            super::section::Kind::Straight => "straight",
            super::section::Kind::Corner => "corner",
            super::section::Kind::Sharp => "sharp",
            super::section::Kind::Change => "change",
        };
        let shift = if row.shifted { range(row.shift_min_mm, row.shift_max_mm, 4) } else { "-".to_owned() };
        let line = format!(
            "{:<9} {:<8} {:>7.1}  {:<11} {:>7.1} {:>11.4}  {:<17} {:<6} {:<16} {:<17} {}",
            row.section,
            kind,
            row.length_mm,
            range(row.engaged_min_deg, row.engaged_max_deg, 1),
            row.force_n,
            row.deflection_mm,
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
        text += &format!("{}: {reason}\n", names.join(", "));
    }
    text
}
