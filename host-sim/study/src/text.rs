//! The files of a case as its user has them: program and job.

use std::fmt::Write;

use truepath_plant::{Side, Spindle};

use super::contour::Contour;
use super::draw::rounded;
use super::part::Part;
use super::prior::Prior;

/// Z of the cutter's tip in the pass, mm.
pub const TIP_Z_MM: f64 = -15.0;

/// A number as a post-processor writes it.
fn number(value: f64) -> String {
    let text = format!("{:.4}", rounded(value, 1e-4) + 0.0);
    text.trim_end_matches('0').to_owned()
}

/// The program.
pub fn program(part: &Part, title: &str) -> String {
    let (cut, contour) = (&part.cut, &part.contour);
    let spin = if part.spindle == Spindle::Clockwise { "M03" } else { "M04" };
    let mut text = format!(
        "%\nO0001 ({title})\nG00 G90 G49 G40 G17 G21\nG54\nT01 M06 (D{})\nS{} {spin}\nG00 Z10. X{} Y{} M08\nG01 Z{} F{}\n",
        number(2.0 * cut.radius_mm),
        cut.rpm,
        number(contour.start[0]),
        number(contour.start[1]),
        number(TIP_Z_MM),
        number(feed(part, contour, 0)),
    );
    let (mut here, mut last) = (contour.start, f64::NAN);
    for (k, one) in contour.moves.iter().enumerate() {
        let (x, y) = (number(one.to[0]), number(one.to[1]));
        // Writing to a string cannot fail.
        let _ = match one.arc {
            None => write!(text, "G01 X{x} Y{y}"),
            Some((centre, ccw)) => {
                let code = if ccw { "G03" } else { "G02" };
                write!(text, "{code} X{x} Y{y} I{} J{}", number(centre[0]), number(centre[1]))
            }
        };
        let now = feed(part, contour, k);
        if now.to_bits() != last.to_bits() {
            let _ = write!(text, " F{}", number(now));
            last = now;
        }
        text.push('\n');
        here = one.to;
    }
    let _ = write!(text, "G00 Z100. (X{} Y{})\nM09\nM05\nM30\n%\n", number(here[0]), number(here[1]));
    text
}

fn feed(part: &Part, contour: &Contour, k: usize) -> f64 {
    let share = contour.moves.get(k).map_or(1.0, |m| m.feed);
    rounded(part.cut.feed_mm_per_min * share, 1.0)
}

/// The job, touched with a ball of so many millimetres.
pub fn job(part: &Part, prior: &Prior, ball_mm: f64) -> String {
    let cut = &part.cut;
    let wall = if part.contour.side == Side::Right { "right" } else { "left" };
    let [ktc, krc, kte, kre] = prior.coefficients;
    let k = prior.stiffness_n_per_mm;
    format!(
        "version = 1\nprogram = \"program.nc\"\nwall = \"{wall}\"\n\n\
         [stock]\nallowance_mm = {}\n\n\
         [tool]\ndiameter_mm = {}\nteeth = {}\nhelix_deg = {}\n\n\
         [cut]\naxial_depth_mm = {}\n\n\
         [force]\nktc_n_per_mm2 = {ktc}\nkrc_n_per_mm2 = {krc}\nkte_n_per_mm = {kte}\nkre_n_per_mm = {kre}\n\
         model = \"{}\"\n\n\
         [machine]\nstiffness_x_n_per_mm = {k}\nstiffness_y_n_per_mm = {k}\n\n\
         [probe]\nball_diameter_mm = {ball_mm}\nformat = \"linuxcnc\"\nz_reference = \"centre\"\n\n\
         [correct]\nclamp_mm = 1.0\n",
        cut.allowance_mm,
        2.0 * cut.radius_mm,
        cut.teeth,
        cut.helix_deg,
        cut.depth_mm,
        part.model,
    )
}

/// Ball of the probe: the usual 6 mm, smaller for small cutters.
pub fn ball_diameter_mm(part: &Part) -> f64 {
    if part.cut.radius_mm >= 5.0 { 6.0 } else { part.cut.radius_mm }
}
