//! A bore in words.

use truepath_bore::setup::FeedAt;

use super::summary::{BoreSummary, Roots};

/// What `truepath bore` prints for people.
pub(super) fn words(s: &BoreSummary) -> String {
    let p = &s.parameters;
    let teeth = if s.teeth == 1 { "1 tooth".to_owned() } else { format!("{} teeth", s.teeth) };
    let at = if s.feed_at == FeedAt::Wall { "wall" } else { "centre" };
    let mut text = format!(
        "bore ⌀{} mm, cutter ⌀{} mm, {teeth}, {}; F{:.3} at the {at}, {:.3} rev/min: {:.5} mm per tooth\n\n",
        2.0 * s.hole_radius_mm,
        2.0 * s.cutter_radius_mm,
        s.direction,
        s.feed_mm_per_min,
        s.rpm.abs(),
        s.feed_per_tooth_mm,
    );
    let mut line = |name: &str, value: f64, what: &str| text += &format!("{name:<9} {value:>11.6} mm  {what}\n");
    line("waviness", s.waviness_mm, "height of the highest crest between marks, unfiltered");
    line("Pt", p.pt, "the same under its ISO name: height of the whole profile");
    line("Wt", p.wt, &format!("waves longer than λc = {} mm only", p.lambda_c_mm));
    line("Rz", p.rz, &format!("roughness shorter than λc, mean of {} sections", p.sections));
    line("Ra", p.ra, "");
    line(
        "RONt",
        p.ront,
        &format!("roundness, least-squares circle, below {} undulations per revolution", p.roundness_upr),
    );
    text += &format!(
        "          MZCI {:.6}, MICI {:.6}, MCCI {:.6} mm; RONp {:.6}, RONv {:.6}, RONq {:.6} mm\n",
        p.ront_mzci, p.ront_mici, p.ront_mcci, p.ronp, p.ronv, p.ronq
    );
    let kind = match p.marks.fall_under {
        "both" => "waviness in part, roughness in part,",
        kind => kind,
    };
    text += &format!(
        "\n{:.2} marks a turn, {:.4} mm apart: {kind} for this λc, which leaves {:.1} % of such a wave in the waviness\n\
         radius of the wall {:.6} to {:.6} mm; height by the formula of second order {:.6} mm\n",
        p.marks.per_revolution,
        p.marks.spacing_mm,
        100.0 * p.marks.share_in_waviness,
        s.smallest_radius_mm,
        s.largest_radius_mm,
        s.cusp_formula_mm
    );
    text += "\nPt over the number of teeth, mm\nteeth        ";
    let row = |cells: Vec<String>| cells.into_iter().map(|c| format!("{c:>10}")).collect::<String>() + "\n";
    let number = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.6}"));
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
            "\nover {} mm of depth the profile turns by {:.4}°; Pt {:.6} to {:.6} mm\n",
            last.z_mm - first.z_mm,
            last.turned_deg - first.turned_deg,
            range.0,
            range.1
        );
    }
    if let Some(w) = &s.wanted {
        text += &format!(
            "\nPt {} mm: F{:.4} at {:.3} rev/min, {:.6} mm per tooth (envelope: {:.9} mm)\n",
            w.wanted_mm,
            w.feed_mm_per_min,
            s.rpm.abs(),
            w.feed_per_tooth_mm,
            w.height_mm
        );
        if let Some(rpm) = w.rpm_at_given_feed {
            text += &format!("or {rpm:.3} rev/min at F{}\n", s.feed_mm_per_min);
        }
    }
    if let Some(roots) = &s.roots {
        text += &listed(roots);
    }
    text
}

fn listed(roots: &Roots) -> String {
    let mut text = format!(
        "\nφ = {}°: {} roots, {} on the ray, {} on the opposite one; the wall is at {:.4} mm\n\
         \x20       τ, s  tooth   radius, mm\n",
        roots.phi_deg,
        roots.list.len(),
        roots.on_ray,
        roots.opposite,
        roots.radius_mm
    );
    for root in &roots.list {
        let kind = match (root.chosen, root.on_ray) {
            (true, _) => "the wall",
            (false, true) => "on the ray",
            (false, false) => "opposite",
        };
        text += &format!("{:>12.6} {:>6} {:>12.6}  {kind}\n", root.tau_s, root.tooth, root.radius_mm);
    }
    text
}
