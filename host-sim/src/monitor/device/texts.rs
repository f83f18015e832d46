//! The lines of the view of a device.

use std::time::Duration;

use ratatui::text::{Line, Span};
use truepath_core::link::{ResetCause, Slot};
use truepath_core::rewrite::Status;

use super::model::ViewModel;
use crate::monitor::state::Shown;
use crate::monitor::theme::{Theme, Tone};
use crate::monitor::timing;
use crate::monitor::wording::{grouped, short_time, time};

/// The line of keys.
pub const KEYS: &str = "q leave   p pause the curves   c clear the view's history   ? help";

/// What ? shows.
pub const HELP: [&str; 20] = [
    "q, Esc, Ctrl-C   leave          p, space   pause the curves",
    "c   clear the view's history (not the device's counters)",
    "",
    "OFF     nothing goes to the drives",
    "PASS    setpoints pass unchanged",
    "ARMED   unchanged, until the gate of the contour",
    "ACTIVE  corrected       HOLD   corrected, held",
    "RAMP    regular end: the correction goes to zero",
    "FAULT   something is wrong: the correction goes to zero",
    "LOST    the device does not answer",
    "",
    "▲       a counter of trouble that grew in the last 10 s",
    "worst   of the answers of the last 10 s",
    "Setpoints  how far off the period they arrive: mean and standard",
    "        deviation, extremes; time to an answer; since the reset",
    "        (histograms: with 36 lines, or truepath device timing)",
    "node    place along the contour, of the correction image",
    "feed    feed per tooth over the nominal one",
    "X, Y    correction of the axes of the program's X and Y;",
    "        --image FILE marks the clamp of the active image",
];

/// Who is there.
pub fn identity(model: &ViewModel) -> String {
    let Some((info, _)) = &model.identity else { return format!("device at {}", model.port) };
    let up = model.status.map(|s| Duration::from_micros(s.uptime_us));
    let mut text = format!("{}  firmware {}  at {}", info.board, info.firmware, model.port);
    if let Some(up) = up {
        text += &format!("  up {}", time(up));
    }
    match &info.trust {
        Some(trust) if trust.open => text += "  OPEN",
        Some(trust) if trust.keys.is_empty() => text += "  CLOSED",
        _ => {}
    }
    if matches!(info.last_reset, ResetCause::Watchdog | ResetCause::BrownOut) {
        text += &format!("  (last reset: {:?})", info.last_reset);
    }
    text
}

/// The active image and what it belongs to.
pub fn image(model: &ViewModel) -> String {
    let Some(status) = &model.status else { return String::new() };
    let Some(active) = status.active else { return "No image is active".to_owned() };
    let slot = model.identity.as_ref().and_then(|(_, slots)| slots.get(usize::from(active.slot)));
    let bound = match slot {
        Some(Slot::Image { crc, binding: b, .. }) if *crc == active.crc => format!(
            ": program {:08x}  feature {}  pass {}  tool {}  setup {}",
            b.program_crc, b.feature, b.pass, b.tool, b.setup
        ),
        _ => String::new(),
    };
    format!("Image {:08x} in slot {}{bound}", active.crc, active.slot)
}

/// Share of the contour that is done, while a correction is on.
pub fn place_share(model: &ViewModel, now: Duration) -> Option<f64> {
    let sample = model.fresh(now)?;
    if !Shown::of(sample.mode, sample.reason).is_on() {
        return None;
    }
    let along = f64::from(sample.place.node) + f64::from(sample.place.fraction) / f64::from(1u32 << 30);
    let last = f64::from(model.nodes()?.checked_sub(1)?);
    Some((along / last.max(1.0)).clamp(0.0, 1.0))
}

/// Place and feed.
pub fn place(model: &ViewModel, now: Duration) -> String {
    let Some(sample) = model.fresh(now) else { return "no sample of now".to_owned() };
    if !Shown::of(sample.mode, sample.reason).is_on() {
        return "not on the contour".to_owned();
    }
    let of =
        model.nodes().map(|nodes| format!(" of {}", grouped(u64::from(nodes.saturating_sub(1))))).unwrap_or_default();
    let share = place_share(model, now).map(|share| format!("  {:.1} %", share * 100.0)).unwrap_or_default();
    let feed = f64::from(sample.feed_ratio) / 655.36;
    format!("node {}{of}{share}   feed {feed:.0} %", grouped(u64::from(sample.place.node)))
}

/// The flags in words, those of trouble first.
const FLAGS: [(Status, &str, &str); 5] = [
    (Status::SATURATED, "SATURATED", "cut at the clamp: the wall will be off"),
    (Status::JOINT_LIMITED, "JOINT LIMITED", "held back at a joint limit"),
    (Status::WARN, "WARN", "above the warn level"),
    (Status::LAGGING, "LAGGING", "slewing"),
    (Status::FADED, "FADED", "spindle or feed outside its window"),
];

/// The line of flags: the first with its meaning, if there is room for it.
pub fn flags(model: &ViewModel, now: Duration, theme: Theme) -> Line<'static> {
    let Some(flags) = model.flags(now) else { return Line::styled("Flags: -", theme.faint()) };
    let set: Vec<_> = FLAGS.into_iter().filter(|(bit, ..)| flags.has(*bit)).collect();
    let Some((first, ..)) = set.first() else { return Line::from("Flags: none") };
    let tone = if [Status::SATURATED, Status::JOINT_LIMITED].contains(first) { Tone::Wrong } else { Tone::Passing };
    let texts: Vec<String> = match set.as_slice() {
        [(_, word, meaning)] => vec![format!("{word} ({meaning})")],
        [(_, word, meaning), rest @ ..] => std::iter::once(format!("{word} ({meaning})"))
            .chain(rest.iter().map(|(_, word, _)| (*word).to_owned()))
            .collect(),
        [] => vec![],
    };
    Line::from(vec![Span::raw("Flags: "), Span::styled(texts.join(", "), theme.text(tone))])
}

/// Faults that were counted, one by one.
pub fn faults(model: &ViewModel, now: Duration, theme: Theme) -> Line<'static> {
    let (faults, grew) = model.faults(now);
    let tone = if grew && model.lost_for(now).is_none() { Tone::Wrong } else { Tone::Plain };
    let kept = model.status.is_some_and(|status| status.recording_frozen);
    let kept = if kept { "   (frames before the last one: truepath device record)" } else { "" };
    Line::from(vec![Span::styled(format!("Faults: {faults}"), theme.text(tone)), Span::styled(kept, theme.faint())])
}

/// How regularly setpoints arrive, and how fast they are answered.
pub fn timing(model: &ViewModel, now: Duration, theme: Theme) -> Line<'static> {
    let line = model.timing.as_ref().map_or_else(|| timing::none(theme), timing::line);
    if model.lost_for(now).is_some() { line.style(theme.faint()) } else { line }
}

/// How the questions go.
pub fn link(model: &ViewModel, now: Duration, theme: Theme) -> Line<'static> {
    if let Some(since) = model.lost_for(now) {
        return Line::styled(format!("Link: no answer for {}", time(since)), theme.text(Tone::Unknown));
    }
    let us = |time: Duration| short_time(time.as_secs_f64() * 1e6);
    let age = age(model, now);
    let text = format!(
        "Link: answers in {} (worst {}); newest sample {age}, {} dropped",
        us(model.round_trip),
        us(model.worst()),
        model.dropped
    );
    Line::from(text)
}

/// How old the newest sample is.
fn age(model: &ViewModel, now: Duration) -> String {
    model.newest.map_or_else(|| "none yet".to_owned(), |(at, _)| format!("{} old", time(now.saturating_sub(at))))
}

/// The same as a line.
pub fn sample_age(model: &ViewModel, now: Duration) -> Line<'static> {
    Line::from(format!("newest sample {}", age(model, now)))
}
