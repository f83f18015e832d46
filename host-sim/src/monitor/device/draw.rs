//! The picture of a device on a terminal of 60 × 20 and more; smaller ones get the [essential lines](super::compact).

use std::time::Duration;

use ratatui::Frame;
use ratatui::layout::{Alignment, Constraint, Layout, Rect};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Clear, Gauge, Paragraph, Wrap};

use super::compact;
use super::model::ViewModel;
use super::texts::{HELP, KEYS, faults, flags, identity, image, link, place, place_share, timing};
use crate::monitor::counts;
use crate::monitor::state::Shown;
use crate::monitor::theme::{Theme, Tone};
use crate::monitor::timing::histograms;
use crate::monitor::trend::{Trend, scale};
use crate::monitor::wording::{micrometres, time};

/// Smallest terminal for it.
const LEAST: (u16, u16) = (60, 20);
/// Rows of a terminal that has room for the histograms of the timing as well, and rows of those.
const ROOMY: u16 = 36;
const BARS: u16 = 5;
/// Columns of the block with the state.
const BLOCK: u16 = 20;

/// Draws the view as it is at `now`, since its start.
pub fn draw(frame: &mut Frame<'_>, model: &ViewModel, now: Duration, theme: Theme) {
    let area = frame.area();
    if area.width < LEAST.0 || area.height < LEAST.1 {
        compact::draw(frame, model, now, theme);
    } else {
        let rows = model.counters(now);
        let table = counts::height(rows.len(), area.width) + 1;
        // The faults one by one where there is room; their sum is in the table.
        let state_rows = if area.height < 24 { 4 } else { 5 };
        let [fault_rows, timing_rows] = [24, 21].map(|least| u16::from(area.height > least));
        let times = model.timing.as_ref().filter(|_| area.height >= ROOMY);
        let bars = if times.is_some() { BARS } else { 0 };
        let heights = [2, state_rows, 1, 1].map(Constraint::Length);
        let below = [Constraint::Min(3), Constraint::Length(table)].into_iter();
        let below = below.chain([fault_rows, timing_rows, bars, 1, 1].map(Constraint::Length));
        let places = Layout::vertical(heights.into_iter().chain(below)).split(area);
        head(frame, places[0], model, now, theme);
        state(frame, places[1], model, now, theme);
        gauge(frame, places[2], model, now, theme);
        frame.render_widget(flags(model, now, theme), places[3]);
        trends(frame, places[4], model, now, theme);
        let heading = Block::new().borders(Borders::TOP).title(" Counters of the device ").border_style(theme.faint());
        counts::draw(frame, heading.inner(places[5]), &rows, theme);
        frame.render_widget(heading, places[5]);
        if fault_rows > 0 {
            frame.render_widget(faults(model, now, theme), places[6]);
        }
        if timing_rows > 0 {
            frame.render_widget(timing(model, now, theme), places[7]);
        }
        if let Some(times) = times {
            histograms(frame, places[8], times, theme);
        }
        frame.render_widget(link(model, now, theme), places[9]);
        frame.render_widget(Line::styled(KEYS, theme.faint()), places[10]);
    }
    if model.help {
        help(frame, area, theme);
    }
}

/// Who is there, and with which image.
fn head(frame: &mut Frame<'_>, area: Rect, model: &ViewModel, now: Duration, theme: Theme) {
    let mut first = vec![Span::styled(identity(model), theme.heading())];
    if let Some(since) = model.restarted(now) {
        first.push(Span::styled(format!("  RESTARTED {} ago", time(since)), theme.text(Tone::Wrong)));
    }
    frame.render_widget(Paragraph::new(vec![Line::from(first), Line::from(image(model))]), area);
}

/// The state, large, and what it means.
fn state(frame: &mut Frame<'_>, area: Rect, model: &ViewModel, now: Duration, theme: Theme) {
    let [left, _, right] =
        Layout::horizontal([Constraint::Length(BLOCK), Constraint::Length(2), Constraint::Fill(1)]).areas(area);
    let words = model.words(now);
    let lost = model.lost_for(now);
    let (word, tone) = match (&words, lost) {
        (_, Some(_)) => (Shown::Lost.word(), Tone::Unknown),
        (Some(words), None) => (words.shown.word(), words.tone),
        (None, None) => ("...", Tone::Plain),
    };
    let spaced: String = word.chars().flat_map(|letter| [letter, ' ']).collect();
    let mut said = vec![Line::from(spaced.trim_end().to_owned())];
    said.extend(lost.map(|since| Line::from(format!("for {}", time(since)))));
    let mut lines = vec![Line::from(""); usize::from(area.height).saturating_sub(said.len()) / 2];
    lines.append(&mut said);
    let block = Paragraph::new(lines).alignment(Alignment::Center).style(theme.block(tone));
    frame.render_widget(block, left);
    frame.render_widget(Paragraph::new(meaning(model, now, theme)).wrap(Wrap { trim: true }), right);
}

/// What goes to the axes, why, what to do.
fn meaning(model: &ViewModel, now: Duration, theme: Theme) -> Vec<Line<'static>> {
    let words = model.words(now);
    if let Some(since) = model.lost_for(now) {
        let why = model.failure().unwrap_or("no answer").to_owned();
        let before = words.map_or_else(
            || "It has never answered here.".to_owned(),
            |words| format!("Last state, {} ago: {}. All values are of then.", time(since), words.shown.word()),
        );
        return vec![
            Line::styled(Shown::Lost.goes_out(), theme.text(Tone::Unknown)),
            Line::from(before),
            Line::from(format!("Trying on: {why}. Check cable, port, power.")),
        ];
    }
    let Some(words) = words else { return vec![Line::from("Asking the device ...")] };
    let mut lines = vec![Line::styled(words.goes_out, theme.heading())];
    lines.extend(words.why.map(|why| Line::styled(why, theme.text(words.tone))));
    let urgent = if words.tone == Tone::Wrong { theme.heading() } else { theme.text(Tone::Plain) };
    lines.push(Line::styled(format!("→ {}", words.advice), urgent));
    lines
}

/// The place along the contour.
fn gauge(frame: &mut Frame<'_>, area: Rect, model: &ViewModel, now: Duration, theme: Theme) {
    let share = place_share(model, now).unwrap_or(0.0);
    let gauge = Gauge::default().ratio(share).use_unicode(true).gauge_style(theme.curve()).label(place(model, now));
    frame.render_widget(gauge, area);
}

/// The corrections of the last seconds.
fn trends(frame: &mut Frame<'_>, area: Rect, model: &ViewModel, now: Duration, theme: Theme) {
    let (history, at, standing) = model.shown(now);
    let clamp_nm = model.clamp_nm();
    let scale_nm = scale(history.largest(), clamp_nm);
    let live = standing.is_none() && model.lost_for(now).is_none();
    let fresh = model.fresh(now);
    let halves = Layout::horizontal([Constraint::Fill(1); 2]).spacing(1).areas::<2>(area);
    for (axis, (name, half)) in ["X", "Y"].into_iter().zip(halves).enumerate() {
        let value = match fresh {
            Some(sample) => format!("{} µm", micrometres(sample.correction_nm[axis])),
            None => "no sample of now".to_owned(),
        };
        let scope = match standing {
            Some(since) => format!("PAUSED {}", time(since)),
            None => "last 20 s".to_owned(),
        };
        let block = Block::new()
            .borders(Borders::TOP)
            .border_style(theme.faint())
            .title(Span::styled(format!(" {name} {value} "), theme.heading()))
            .title(Line::from(format!(" µm, {scope} ")).alignment(Alignment::Right));
        let inside = block.inner(half);
        frame.render_widget(block, half);
        let trend = Trend { history, axis, now_s: at.as_secs_f64(), scale_nm, clamp_nm, live };
        trend.draw(frame, inside, theme);
    }
}

/// What the keys do and the words mean, over the middle of the view.
fn help(frame: &mut Frame<'_>, area: Rect, theme: Theme) {
    let [width, height] = [area.width.min(64), area.height.min(HELP.len() as u16 + 2)];
    let place = Rect { x: (area.width - width) / 2, y: (area.height - height) / 2, width, height };
    let lines: Vec<Line<'_>> = HELP.iter().map(|line| Line::from(*line)).collect();
    let block = Block::bordered().title(Span::styled(" Help ", theme.heading()));
    frame.render_widget(Clear, place);
    frame.render_widget(Paragraph::new(lines).block(block), place);
}
