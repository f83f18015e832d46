//! The essential lines, for terminals too small for the picture: the more important a line, the smaller it may be.

use std::time::Duration;

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::model::ViewModel;
use super::texts::{faults, flags, place, sample_age};
use crate::monitor::counts::outstanding;
use crate::monitor::state::Shown;
use crate::monitor::theme::{Theme, Tone};
use crate::monitor::wording::{micrometres, time, wrapped};

/// Draws as many lines as there is room for.
pub fn draw(frame: &mut Frame<'_>, model: &ViewModel, now: Duration, theme: Theme) {
    let area = frame.area();
    // The keys go first where there is no room.
    let rows = if area.height < 5 { area.height } else { area.height - 1 };
    for (row, line) in (0..rows).zip(lines(model, now, area.width, theme)) {
        frame.render_widget(line, Rect { y: area.y + row, height: 1, ..area });
    }
    if rows < area.height {
        let keys = Line::styled("q leave  p pause  c clear  ? help", theme.faint());
        frame.render_widget(keys, Rect { y: area.y + rows, height: 1, ..area });
    }
}

fn lines(model: &ViewModel, now: Duration, width: u16, theme: Theme) -> Vec<Line<'static>> {
    let in_lines = |text: &str, tone: Tone| {
        let style = theme.text(tone);
        wrapped(text, width).into_iter().map(move |line| Line::styled(line, style))
    };
    let words = model.words(now);
    let who = Span::styled(format!(" {}", model.port), theme.faint());
    let mut lines = Vec::new();
    match (model.lost_for(now), &words) {
        (Some(since), words) => {
            let word = format!(" {} for {} ", Shown::Lost.word(), time(since));
            lines.push(Line::from(vec![Span::styled(word, theme.block(Tone::Unknown)), who]));
            let before = words.as_ref().map_or("it has never answered", |w| w.shown.word());
            lines.push(Line::from(format!("before: {before}; values are of then")));
            lines.extend(in_lines(model.failure().unwrap_or("no answer"), Tone::Plain));
        }
        (None, Some(words)) => {
            let word = format!("  {}  ", words.shown.word());
            lines.push(Line::from(vec![Span::styled(word, theme.block(words.tone)), who]));
            let meaning = words.why.clone().unwrap_or_else(|| words.goes_out.to_owned());
            lines.extend(in_lines(&meaning, words.tone));
            lines.extend(in_lines(&format!("→ {}", words.advice), Tone::Plain));
        }
        (None, None) => lines.push(Line::from(vec![Span::raw(" ... "), who])),
    }
    let correction = match model.fresh(now) {
        Some(sample) => {
            let [x, y] = sample.correction_nm.map(micrometres);
            format!("X {x}  Y {y} µm")
        }
        None => "X -  Y -  no sample of now".to_owned(),
    };
    lines.push(Line::styled(correction, theme.heading()));
    lines.extend(model.fresh(now).map(|_| Line::from(place(model, now))));
    lines.push(flags(model, now, theme));
    let rows = model.counters(now);
    let tone = if rows.iter().any(|row| row.stands_out()) { Tone::Wrong } else { Tone::Plain };
    lines.push(Line::styled(outstanding(&rows), theme.text(tone)));
    lines.push(sample_age(model, now));
    lines.push(faults(model, now, theme));
    lines
}
