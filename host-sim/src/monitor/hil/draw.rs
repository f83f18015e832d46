//! The picture of a run.

use std::time::Duration;

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Gauge, Sparkline};
use truepath_bench::TRAIL_EVERY;
use truepath_core::rewrite::{Mode, Reason};

use super::model::{Model, RoundTrips};
use crate::monitor::state::Shown;
use crate::monitor::theme::{Theme, Tone};
use crate::monitor::timing;
use crate::monitor::wording::{grouped, rate, short_time, time};

/// Rows of the curve at the least.
const LEAST_CURVE: u16 = 3;

/// How a run is to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// By itself.
    Regular,
    /// With the batch that is under way.
    Stopping,
}

/// Draws the view as it is at `now`, since its start. The more important a line, the farther up it is, so that a small
/// terminal shows what matters.
pub fn draw(
    frame: &mut Frame<'_>,
    model: &Model,
    trips: Option<&RoundTrips>,
    ending: Ending,
    now: Duration,
    theme: Theme,
) {
    let area = frame.area();
    let lines = lines(model, trips, now, theme);
    // Gauge and keys always; the histograms and the curve get what is left, if that is enough to see anything.
    let room = area.height.saturating_sub(2);
    let shown = (lines.len() as u16).min(room);
    let left = room - shown;
    let bars = if model.timing.is_some() { timing::rows(left) } else { 0 };
    let curve = left - bars;
    let heights = [1, shown, bars, if curve >= LEAST_CURVE { curve } else { 0 }, 1].map(Constraint::Length);
    let [top, middle, times, below, last] = Layout::vertical(heights).areas(area);
    gauge(frame, top, model, theme);
    for (row, line) in (0..middle.height).zip(lines) {
        frame.render_widget(line, Rect { y: middle.y + row, height: 1, ..middle });
    }
    if let (Some(timing), true) = (&model.timing, times.height > 0) {
        timing::histograms(frame, times, timing, theme);
    }
    if below.height > 0 {
        curve_of(frame, below, model, theme);
    }
    let keys = match ending {
        Ending::Regular => Line::styled("q stops the run after this batch and reports", theme.faint()),
        Ending::Stopping => Line::styled(
            "stopping after this batch; q again leaves at once, without a report",
            theme.text(Tone::Passing),
        ),
    };
    frame.render_widget(keys, last);
}

fn gauge(frame: &mut Frame<'_>, area: Rect, model: &Model, theme: Theme) {
    let share = (model.done() as f64 / model.count.max(1) as f64).clamp(0.0, 1.0);
    let label = format!("{} of {} setpoints  {:.1} %", grouped(model.done()), grouped(model.count), share * 100.0);
    let gauge = Gauge::default().ratio(share).use_unicode(true).gauge_style(theme.curve()).label(label);
    frame.render_widget(gauge, area);
}

fn lines(model: &Model, trips: Option<&RoundTrips>, now: Duration, theme: Theme) -> Vec<Line<'static>> {
    let mut lines = Vec::new();
    let arrived = match model.since {
        0 => String::new(),
        more => format!(", {} more arrived", grouped(more)),
    };
    let verdict = format!("{} answers compared, all identical{arrived}", grouped(model.answers));
    lines.push(if model.answers > 0 {
        Line::styled(verdict, theme.text(Tone::Good))
    } else {
        Line::styled(format!("no answer compared yet{arrived}"), theme.faint())
    });
    let mean = model.injected.frames as f64 / model.elapsed.as_secs_f64().max(1e-9);
    let speed = rate(model.per_s(now));
    let mean = if model.injected.frames > 0 { format!("; the board alone {}/s", rate(mean)) } else { String::new() };
    lines.push(Line::from(format!("{speed} setpoints/s{mean}; {} so far", time(now))));
    lines.push(state(model, theme));
    let trips = trips.and_then(RoundTrips::four).map_or_else(
        || "round trip: not measured in batches".to_owned(),
        |four| {
            let [min, median, p99, max] = four.map(short_time);
            format!("round trip: min {min}, median {median}, 99 % {p99}, max {max}")
        },
    );
    lines.push(Line::from(trips));
    // Nothing is known of the timing before the first batch.
    if model.answers > 0 {
        lines.push(model.timing.as_ref().map_or_else(|| timing::none(theme), timing::line));
    }
    lines.push(Line::from(format!("{}: {}", model.board, model.stage)));
    lines.push(Line::from(format!(
        "{} parts armed, largest correction {:.1} µm",
        grouped(model.armed),
        model.largest_nm as f64 / 1_000.0
    )));
    let names = ["Off", "Pass", "Armed", "Active", "Hold", "Fault"];
    let modes: Vec<String> =
        names.iter().zip(model.modes).map(|(name, count)| format!("{name} {}", grouped(count))).collect();
    lines.push(Line::from(format!("answers: {}", modes.join(", "))));
    faults(model, theme, &mut lines);
    lines
}

/// State of the board at the last answer that was compared.
fn state(model: &Model, theme: Theme) -> Line<'static> {
    let Some(latest) = &model.latest else { return Line::styled("state: no answer yet", theme.faint()) };
    let shown = Shown::of(latest.mode, latest.reason);
    let reason = match latest.reason {
        Reason::None => String::new(),
        reason => format!(" ({reason})"),
    };
    let place = if latest.mode == Mode::Off { String::new() } else { format!("  node {}", latest.place.node) };
    Line::from(vec![
        Span::raw("state: "),
        Span::styled(format!(" {} ", shown.word()), theme.block(shown.tone())),
        Span::raw(format!("{reason}{place}")),
    ])
}

/// What the cable did, beside what was counted.
fn faults(model: &Model, theme: Theme, lines: &mut Vec<Line<'static>>) {
    let (i, c) = (&model.injected, &model.counters);
    let rows: [(&str, u64, &str, String); 5] = [
        ("lost", i.dropped, "lost", grouped(c.lost.into())),
        ("damaged", i.corrupted, "damaged", grouped(c.damaged.into())),
        ("overtaken", i.reordered, "out of order", grouped(c.out_of_order.into())),
        ("repeated", i.repeated, "repeated", grouped(c.repeated.into())),
        ("pauses", i.pauses, "silences", grouped(c.silences.into())),
    ];
    lines.push(Line::styled("faults of the cable        counted (host; device compared at the end)", theme.heading()));
    for (what, count, seen, number) in rows {
        lines.push(Line::from(format!("{what:<12}{:>12}   {seen:<13}{number:>12}", grouped(count))));
    }
    lines.push(Line::from(format!("jumps {}, late {}", grouped(c.jumps.into()), grouped(c.late.into()))));
    let ended: u64 = c.faults.iter().map(|count| u64::from(*count)).sum();
    let faults = c.by_fault().filter(|&(_, count)| count > 0);
    let reasons: Vec<String> = faults.map(|(reason, count)| format!("{count} x {reason}")).collect();
    let reasons = if reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join("; ")) };
    lines.push(Line::from(format!("corrections ended by faults: {}{reasons}", grouped(ended))));
}

/// Size of the correction over the last answers.
fn curve_of(frame: &mut Frame<'_>, area: Rect, model: &Model, theme: Theme) {
    let width = usize::from(area.width).max(1);
    let shared = model.trail_nm.len().div_ceil(width).max(1);
    let trail: Vec<u32> = model.trail_nm.iter().copied().collect();
    let bars: Vec<u64> = trail.chunks(shared).map(|part| part.iter().copied().max().unwrap_or(0).into()).collect();
    let most = bars.iter().copied().max().unwrap_or(0);
    let answers = trail.len() as u64 * TRAIL_EVERY;
    let title =
        format!(" correction of the last {} answers compared, top {:.1} µm ", grouped(answers), most as f64 / 1_000.0);
    let block =
        Block::new().borders(Borders::TOP).border_style(theme.faint()).title(Span::styled(title, theme.heading()));
    frame.render_widget(Sparkline::default().block(block).data(bars).max(most.max(1)).style(theme.curve()), area);
}
