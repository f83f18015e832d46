//! The page of a plan: choices of time against error, and the unrolled wall of each beside that of the program.
//!
//! One file without scripts, which opens from disk; the wall that is shown follows the row that is picked.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use truepath_correction::plan::choice::{Choice, Plan};
use truepath_correction::plan::process::words;
use truepath_correction::surface::wall::WallMap;
use truepath_ground::diagnostics::Failure;

use truepath_ground::length::Unit;
use truepath_ground::table::table;
use truepath_ground::units::rounded;

const STYLE: &str = include_str!("planned.css");
/// Columns of an unrolled wall at most.
const COLUMNS: usize = 260;
/// Bounds of the classes of colour, as multiples of the tolerance.
const BOUNDS: [f64; 6] = [-1.0, -0.5, -0.2, 0.2, 0.5, 1.0];
const CLASSES: [&str; 7] = [
    "cut deeper than the tolerance",
    "cut deep, more than half of the tolerance",
    "cut deep",
    "within a fifth of the tolerance",
    "material left",
    "material left, more than half of the tolerance",
    "more left than the tolerance",
];

/// A wall with its plan.
#[derive(Clone, Debug)]
pub struct PlannedWall<'a> {
    /// Its name, of several walls of a program.
    pub name: Option<String>,
    /// The plan.
    pub plan: &'a Plan,
}

/// What of a page belongs to one wall: the number of the wall is part of every name.
#[derive(Clone, Copy)]
struct Section<'a> {
    wall: &'a PlannedWall<'a>,
    /// From 1.
    number: usize,
    /// The unit of the program.
    unit: Unit,
}

impl Section<'_> {
    /// Name of a choice, from 1.
    fn choice(&self, k: usize) -> String {
        format!("c{}-{k}", self.number)
    }
    /// The choice that is shown first.
    fn picked(&self) -> usize {
        self.wall.plan.recommended.unwrap_or(self.wall.plan.choices.len()).max(1)
    }
    /// A heading below that of the wall, or of the page where it has one wall.
    fn heading(&self, text: &str) -> Markup {
        html! { @if self.wall.name.is_some() { h3 { (text) } } @else { h2 { (text) } } }
    }
    /// Something that may be wider than a small screen.
    fn scroll(&self, label: &str, content: Markup) -> Markup {
        let of = self.wall.name.as_ref().map_or_else(String::new, |name| format!(" of {name}"));
        html! { div.scroll tabindex="0" role="region" aria-label={ (label) (of) } { (content) } }
    }
    /// A choice in words.
    fn named(&self, k: usize) -> String {
        let of = self.wall.name.as_ref().map_or_else(String::new, |name| format!(" for {name}"));
        format!("Choice {k}{of}")
    }
    /// What the choice picked shows and marks.
    fn rules(&self) -> String {
        let rule = |k: usize| {
            let name = self.choice(k);
            format!(
                "main:has(#{name}:checked) .w{name} {{ display: block; }} main:has(#{name}:checked) .r{name} {{ font-weight: 600; }} "
            )
        };
        (1..=self.wall.plan.choices.len()).map(rule).collect()
    }
}

/// The page of the plans of a program, wall by wall, in its unit.
pub fn planned_page(walls: &[PlannedWall<'_>], program: &str, unit: Unit) -> String {
    let sections: Vec<Section> = walls.iter().zip(1..).map(|(wall, number)| Section { wall, number, unit }).collect();
    let shown: String = sections.iter().map(Section::rules).collect();
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Plan: " (program) }
                style { (PreEscaped(STYLE)) (PreEscaped(shown)) }
            }
            body {
                main {
                    h1 { "Finishing plan: " (program) }
                    @for section in &sections {
                        @if let Some(name) = &section.wall.name { h2.contour { (name) } }
                        (of_wall(section))
                    }
                    p.soft {
                        "Predicted by the machine that was identified from the points; the deviations in the table hold what they leave open and a few percent that a model lacks. "
                        "Noise of the surface, wear, and what the machine does not repeat come on top."
                    }
                }
            }
        }
    }
    .into_string()
}

/// What is told of one wall.
fn of_wall(section: &Section<'_>) -> Markup {
    let (plan, unit) = (section.wall.plan, section.unit);
    let small = unit.small_name();
    html! {
        p.verdict { (verdict(plan, unit)) }
        p.soft {
            "As programmed, one uncorrected pass: " (um(plan.as_programmed.profile_mm, unit)) " " (small) " at the worst place of the wall, mean over the height "
            (um(plan.as_programmed.mean_mm, unit)) " " (small) ", " (format!("{:.2}", plan.minutes)) " min at feed."
        }
        (section.heading("Time against error"))
        (section.scroll("Time against error", front(plan, unit)))
        (section.scroll("Choices", choices(section)))
        (section.heading("The wall, unrolled"))
        (legend(plan, unit))
        figure {
            (section.scroll("The wall as programmed", wall(&plan.map, plan.tolerance_mm, unit)))
            figcaption { "as programmed" }
        }
        @for (k, choice) in plan.choices.iter().enumerate() {
            figure class={ "choice w" (section.choice(k + 1)) } {
                (section.scroll(&format!("The wall of choice {}", k + 1), wall(&choice.map, plan.tolerance_mm, unit)))
                figcaption {
                    "choice " (k + 1) ": " (words(&choice.cuts, unit)) ". What is left, " (choice.surface.worst_words(unit))
                }
            }
        }
    }
}

fn um(mm: f64, unit: Unit) -> String {
    let small = unit.small(mm);
    if mm < 0.09995 || unit == Unit::Inch { format!("{small:.1}") } else { format!("{small:.0}") }
}

fn verdict(plan: &Plan, unit: Unit) -> String {
    let small = unit.small_name();
    let percent = format!("{:.0} %", plan.confidence * 100.0);
    let tolerance = um(plan.tolerance_mm, unit);
    match (plan.recommended.and_then(|k| Some((k, plan.choices.get(k - 1)?))), plan.choices.last()) {
        (Some((k, choice)), _) => format!(
            "Choice {k} holds ±{tolerance} {small} at every height with {percent}, in {:.2} times the time: {}.",
            choice.time_ratio,
            words(&choice.cuts, unit)
        ),
        (None, Some(best)) => {
            let reach = best.surface.profile.profile_mm + 2.0 * best.surface.profile.sigma_mm;
            format!(
                "No process holds ±{tolerance} {small} at every height with {percent}. The best reaches {} {small}.",
                um(reach, unit)
            )
        }
        (None, None) => "No process keeps the limits of the job's [plan].".to_owned(),
    }
}

fn choices(section: &Section<'_>) -> Markup {
    let (plan, unit) = (section.wall.plan, section.unit);
    let small = unit.small_name();
    html! {
        table {
            thead { tr {
                th { "choice" } th { "time" } th { "worst error, " (small) } th { "± 2 sigma" } th { "95 % of it, " (small) } th { "within" } th { "force, N" } th { "passes" }
            } }
            tbody {
                @for (k, choice) in plan.choices.iter().enumerate() {
                    @let holds = choice.within_tolerance >= plan.confidence;
                    tr class={ "r" (section.choice(k + 1)) } {
                        td {
                            label {
                                input type="radio" name={ "choice-" (section.number) } id=(section.choice(k + 1)) checked[k + 1 == section.picked()]
                                    aria-label=(section.named(k + 1));
                                (k + 1) @if plan.recommended == Some(k + 1) { " ★" }
                            }
                        }
                        td { (format!("{:.2} ×", choice.time_ratio)) }
                        td { (um(choice.surface.profile.profile_mm, unit)) }
                        td { (um(2.0 * choice.surface.profile.sigma_mm, unit)) }
                        td { (um(choice.surface.p95_mm, unit)) }
                        td class=(if holds { "yes" } else { "no" }) { (format!("{:.0} %", 100.0 * choice.within_tolerance)) @if holds { " ✓" } @else { " ✗" } }
                        td { (format!("{:.0}", choice.force_n)) }
                        td { label for=(section.choice(k + 1)) { (words(&choice.cuts, unit)) } span.soft { " most of it: " (choice.limited_by) } }
                    }
                }
            }
        }
    }
}

/// Time against error, with two standard deviations to either side.
fn front(plan: &Plan, unit: Unit) -> Markup {
    const WIDTH: f64 = 720.0;
    const HEIGHT: f64 = 260.0;
    const LEFT: f64 = 56.0;
    const BELOW: f64 = 40.0;
    let top = |c: &Choice| c.surface.profile.profile_mm + 2.0 * c.surface.profile.sigma_mm;
    let most = plan.choices.iter().map(top).fold(1.3 * plan.tolerance_mm, f64::max) * 1.05;
    let last = plan.choices.iter().map(|c| c.time_ratio).fold(1.0, f64::max).ceil();
    let x = |ratio: f64| LEFT + (ratio - 0.5) / (last - 0.25) * (WIDTH - LEFT - 10.0);
    let y = |error: f64| (HEIGHT - BELOW) - error / most * (HEIGHT - BELOW - 12.0);
    let at = |v: f64| format!("{v:.1}");
    // The axis in thousandths of the unit.
    let (top, per_mm) = (1e3 * unit.said(most), 1e3 * unit.said(1.0));
    let step = round_step(top / 5.0);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let ticks = (0..).map(|k| f64::from(k) * step).take_while(|t| *t <= top);
    let axis = if unit == Unit::Inch { "worst error, 0.001 in" } else { "worst error, µm" };
    html! {
        svg viewBox={ "0 0 " (WIDTH) " " (HEIGHT) } role="img" aria-label="Machining time of the choices against their profile error" {
            @for tick in ticks {
                line.axis x1=(LEFT) x2=(WIDTH - 10.0) y1=(at(y(tick / per_mm))) y2=(at(y(tick / per_mm))) {}
                text x=(LEFT - 8.0) y=(at(y(tick / per_mm) + 4.0)) text-anchor="end" { (format!("{tick:.decimals$}")) }
            }
            @for whole in 1..=(last as u32) {
                text x=(at(x(f64::from(whole)))) y=(HEIGHT - BELOW + 18.0) text-anchor="middle" { (whole) " ×" }
            }
            text x=(WIDTH / 2.0) y=(HEIGHT - 4.0) text-anchor="middle" { "time over that of one pass" }
            text x="12" y=(at(HEIGHT / 2.0 - 20.0)) text-anchor="middle" transform={ "rotate(-90 12 " (HEIGHT / 2.0 - 20.0) ")" } { (axis) }
            line.limit x1=(LEFT) x2=(WIDTH - 10.0) y1=(at(y(plan.tolerance_mm))) y2=(at(y(plan.tolerance_mm))) {}
            @for (k, choice) in plan.choices.iter().enumerate() {
                @let (mean, two) = (choice.surface.profile.profile_mm, 2.0 * choice.surface.profile.sigma_mm);
                line.bar x1=(at(x(choice.time_ratio))) x2=(at(x(choice.time_ratio))) y1=(at(y(mean + two))) y2=(at(y((mean - two).max(0.0)))) {}
                circle class=(if plan.recommended == Some(k + 1) { "mark best" } else { "mark" }) cx=(at(x(choice.time_ratio))) cy=(at(y(mean))) r="5" {}
                text x=(at(x(choice.time_ratio) + 9.0)) y=(at(y(mean) - 6.0)) { (k + 1) }
            }
        }
    }
}

/// 1, 2 or 5 times a power of ten, no less than asked for.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.max(1e-9).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= least * 0.999).unwrap_or(power)
}

fn legend(plan: &Plan, unit: Unit) -> Markup {
    let edge = |at: usize| um(plan.tolerance_mm * BOUNDS[at], unit);
    let range = |class: usize| match class {
        0 => format!("below {}", edge(0)),
        6 => format!("above {}", edge(5)),
        k => format!("{} to {}", edge(k - 1), edge(k)),
    };
    html! {
        div.legend {
            @for (class, meaning) in CLASSES.iter().enumerate() {
                span title=(meaning) { svg viewBox="0 0 10 8" aria-hidden="true" { rect class={ "k" (class) } width="10" height="8" {} } " " (range(class)) " " (unit.small_name()) }
            }
        }
    }
}

fn class_of(error: f64, tolerance: f64) -> usize {
    BOUNDS.iter().filter(|bound| error > **bound * tolerance).count()
}

/// Arc length × height; neighbours of one class are one rectangle.
fn wall(map: &WallMap, tolerance: f64, unit: Unit) -> Markup {
    const WIDTH: f64 = 720.0;
    const LEFT: f64 = 46.0;
    const TALL: f64 = 110.0;
    let (Some(first), Some(last)) = (map.s_mm.first(), map.s_mm.last()) else { return html! {} };
    let rows = map.height_mm.len();
    let columns = map.s_mm.len().min(COLUMNS);
    let width = (WIDTH - LEFT - 4.0) / columns as f64;
    let tall = TALL / rows as f64;
    // Of the places that share a column the worst is shown.
    let worst = |column: usize, row: usize| {
        let range = column * map.s_mm.len() / columns..((column + 1) * map.s_mm.len() / columns);
        map.error_mm[range].iter().map(|c| c[row]).fold(0.0f64, |w, e| if e.abs() > w.abs() { e } else { w })
    };
    let mut cells: Vec<(usize, usize, usize, usize)> = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let class = class_of(worst(column, row), tolerance);
            match cells.last_mut() {
                Some((r, _, to, c)) if *r == row && *c == class && *to == column => *to += 1,
                _ => cells.push((row, column, column + 1, class)),
            }
        }
    }
    let height = rows as f64 / (rows as f64 - 0.5) * map.height_mm.last().copied().unwrap_or(0.0);
    html! {
        svg viewBox={ "0 0 " (WIDTH) " " (TALL + 26.0) } role="img" aria-label="Error of the wall over arc length and height" {
            @for (row, from, to, class) in cells {
                rect class={ "k" (class) } x=(format!("{:.1}", LEFT + from as f64 * width)) width=(format!("{:.2}", (to - from) as f64 * width + 0.05))
                    y=(format!("{:.2}", 2.0 + (rows - 1 - row) as f64 * tall)) height=(format!("{:.2}", tall + 0.05)) {}
            }
            rect.frame x=(LEFT) y="2" width=(WIDTH - LEFT - 4.0) height=(TALL) {}
            text x=(LEFT - 6.0) y="13" text-anchor="end" { (format!("{:.0}", unit.of(height))) }
            text x=(LEFT - 6.0) y=(TALL) text-anchor="end" { "0" }
            text x="12" y=(TALL / 2.0) text-anchor="middle" transform={ "rotate(-90 12 " (TALL / 2.0) ")" } { "height, " (unit.name()) }
            text x=(LEFT) y=(TALL + 18.0) { (format!("{:.0}", unit.of(*first))) }
            text x=(WIDTH - 4.0) y=(TALL + 18.0) text-anchor="end" { (format!("{:.0}", unit.of(*last))) " " (unit.name()) }
            text x=((WIDTH + LEFT) / 2.0) y=(TALL + 18.0) text-anchor="middle" { "along the contour" }
        }
    }
}

/// One place of the unrolled wall.
#[derive(serde::Serialize)]
struct MapRow {
    s_mm: f64,
    height_mm: f64,
    error_mm: f64,
}

/// `wall-map.csv`: the wall unrolled as it is predicted, place by place, heights above the tip from the lowest.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn planned_map_csv(map: &WallMap) -> Result<Vec<u8>, Failure> {
    let places = map.s_mm.iter().zip(&map.error_mm);
    table(places.flat_map(|(s, column)| {
        map.height_mm.iter().zip(column).map(|(height, error)| MapRow {
            s_mm: rounded(*s, 3),
            height_mm: rounded(*height, 4),
            error_mm: rounded(*error, 6),
        })
    }))
}
