//! A bore in words.

use truepath_bore::setup::FeedAt;
use truepath_ground::length::Unit;

use super::summary::{BoreSummary, Roots};

/// What `truepath bore` prints for people, in a unit.
pub(super) fn words(s: &BoreSummary, unit: Unit) -> String {
    let (p, name) = (&s.parameters, unit.name());
    let teeth = if s.teeth == 1 { "1 tooth".to_owned() } else { format!("{} teeth", s.teeth) };
    let at = if s.feed_at == FeedAt::Wall { "wall" } else { "centre" };
    let mut text = format!(
        "bore ⌀{} {name}, cutter ⌀{} {name}, {teeth}, {}; F{:.3} {name}/min at the {at}, {:.3} rev/min: {:.5} {name} per tooth\n\n",
        unit.of(2.0 * s.hole_radius_mm),
        unit.of(2.0 * s.cutter_radius_mm),
        s.direction,
        unit.of(s.feed_mm_per_min),
        s.rpm.abs(),
        unit.of(s.feed_per_tooth_mm),
    );
    let mut line = |of: &str, mm: f64, what: &str| text += &format!("{of:<9} {:>11.6} {name}  {what}\n", unit.of(mm));
    line("waviness", s.waviness_mm, "height of the highest crest between marks, unfiltered");
    line("Pt", p.pt, "the same under its ISO name: height of the whole profile");
    line("Wt", p.wt, &format!("waves longer than λc = {} {name} only", unit.of(p.lambda_c_mm)));
    line("Rz", p.rz, &format!("roughness shorter than λc, mean of {} sections", p.sections));
    line("Ra", p.ra, "");
    line(
        "RONt",
        p.ront,
        &format!("roundness, least-squares circle, below {} undulations per revolution", p.roundness_upr),
    );
    let [mzci, mici, mcci, peak, valley, rms] =
        [p.ront_mzci, p.ront_mici, p.ront_mcci, p.ronp, p.ronv, p.ronq].map(|mm| unit.of(mm));
    text += &format!(
        "          MZCI {mzci:.6}, MICI {mici:.6}, MCCI {mcci:.6} {name}; RONp {peak:.6}, RONv {valley:.6}, RONq {rms:.6} {name}\n"
    );
    let kind = match p.marks.fall_under {
        "both" => "waviness in part, roughness in part,",
        kind => kind,
    };
    text += &format!(
        "\n{:.2} marks a turn, {:.4} {name} apart: {kind} for this λc, which leaves {:.1} % of such a wave in the waviness\n\
         radius of the wall {:.6} to {:.6} {name}; height by the formula of second order {:.6} {name}\n",
        p.marks.per_revolution,
        unit.of(p.marks.spacing_mm),
        100.0 * p.marks.share_in_waviness,
        unit.of(s.smallest_radius_mm),
        unit.of(s.largest_radius_mm),
        unit.of(s.cusp_formula_mm)
    );
    text += &format!("\nPt over the number of teeth, {name}\nteeth        ");
    let row = |cells: Vec<String>| cells.into_iter().map(|c| format!("{c:>10}")).collect::<String>() + "\n";
    let number = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |mm| format!("{:.6}", unit.of(mm)));
    let shown = || s.on_teeth.iter().filter(|r| r.teeth <= 8 || r.teeth == s.teeth);
    text += &row(shown().map(|r| r.teeth.to_string()).collect());
    text += "conventional ";
    text += &row(shown().map(|r| number(r.conventional_mm)).collect());
    text += "climb        ";
    text += &row(shown().map(|r| number(r.climb_mm)).collect());
    if let Some(exponent) = s.teeth_exponent {
        text += &format!("exponent {exponent:.2}\n");
    }
    if let (Some(first), Some(last)) = (s.levels.first(), s.levels.last()) {
        let range = s.levels.iter().fold((f64::MAX, 0.0f64), |(l, h), v| (l.min(v.height_mm), h.max(v.height_mm)));
        text += &format!(
            "\nover {} {name} of depth the profile turns by {:.4}°; Pt {:.6} to {:.6} {name}\n",
            unit.of(last.z_mm - first.z_mm),
            last.turned_deg - first.turned_deg,
            unit.of(range.0),
            unit.of(range.1)
        );
    }
    if let Some(w) = &s.wanted {
        text += &format!(
            "\nPt {} {name}: F{:.4} {name}/min at {:.3} rev/min, {:.6} {name} per tooth (envelope: {:.9} {name})\n",
            unit.of(w.wanted_mm),
            unit.of(w.feed_mm_per_min),
            s.rpm.abs(),
            unit.of(w.feed_per_tooth_mm),
            unit.of(w.height_mm)
        );
        if let Some(rpm) = w.rpm_at_given_feed {
            text += &format!("or {rpm:.3} rev/min at F{}\n", unit.of(s.feed_mm_per_min));
        }
    }
    if let Some(roots) = &s.roots {
        text += &listed(roots, unit);
    }
    text
}

fn listed(roots: &Roots, unit: Unit) -> String {
    let name = unit.name();
    let mut text = format!(
        "\nφ = {}°: {} roots, {} on the ray, {} on the opposite one; the wall is at {:.4} {name}\n\
         \x20       τ, s  tooth   radius, {name}\n",
        roots.phi_deg,
        roots.list.len(),
        roots.on_ray,
        roots.opposite,
        unit.of(roots.radius_mm)
    );
    for root in &roots.list {
        let kind = match (root.chosen, root.on_ray) {
            (true, _) => "the wall",
            (false, true) => "on the ray",
            (false, false) => "opposite",
        };
        text += &format!("{:>12.6} {:>6} {:>12.6}  {kind}\n", root.tau_s, root.tooth, unit.of(root.radius_mm));
    }
    text
}
