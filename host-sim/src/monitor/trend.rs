//! The picture of the correction of one axis over the last seconds, with its scale.
//!
//! Every column of dots shows the least and the greatest sample that falls into it, so that no peak is lost, and the work
//! of a picture depends on its width alone once the samples are gone through. Nothing is drawn where there are no samples.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::symbols::Marker;
use ratatui::widgets::canvas::{Canvas, Context, Line, Points};

use super::history::{History, SPAN};
use super::theme::Theme;
use super::wording::grouped;

/// Samples farther apart are not joined, s.
const GAP_S: f64 = 0.5;
/// Columns for the figures of the scale.
const GUTTER: u16 = 7;
/// Smallest scale, nm.
const LEAST_NM: u32 = 1_000;

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Trend<'a> {
    /// The samples.
    pub history: &'a History,
    /// 0 for X, 1 for Y.
    pub axis: usize,
    /// The time at the right edge, s.
    pub now_s: f64,
    /// The end of the scale, nm.
    pub scale_nm: u32,
    /// The clamp of the image, when it is known, nm.
    pub clamp_nm: Option<u32>,
    /// Whether the samples are of now.
    pub live: bool,
}

/// The end of a scale that shows a correction, and the clamp where it is near: 1, 2 or 5 times a power of ten µm.
pub fn scale(largest_nm: u32, clamp_nm: Option<u32>) -> u32 {
    let near = clamp_nm.filter(|clamp| u64::from(largest_nm) * 2 > u64::from(*clamp));
    let wanted = largest_nm.max(near.unwrap_or(0)).max(LEAST_NM);
    let mut step = LEAST_NM;
    loop {
        for factor in [1, 2, 5] {
            match step.checked_mul(factor) {
                Some(end) if end >= wanted => return end,
                Some(_) => {}
                None => return u32::MAX,
            }
        }
        step = step.saturating_mul(10);
    }
}

impl Trend<'_> {
    /// Draws it.
    pub fn draw(&self, frame: &mut Frame<'_>, area: Rect, theme: Theme) {
        let [gutter, picture] = if area.width > 3 * GUTTER {
            let left = Rect { width: GUTTER, ..area };
            [left, Rect { x: area.x + GUTTER, width: area.width - GUTTER, ..area }]
        } else {
            [Rect { width: 0, ..area }, area]
        };
        if picture.is_empty() {
            return;
        }
        self.draw_figures(frame, gutter, theme);
        let columns = usize::from(picture.width) * 2;
        let colour = if self.live { theme.curve() } else { theme.axis() };
        let lines = self.lines(columns);
        let scale = f64::from(self.scale_nm);
        // Zero is dotted, the clamp dashed: a curve is neither.
        let across = |y: f64, dots: usize, of: usize| -> Vec<(f64, f64)> {
            (0..columns).filter(|x| x % of < dots).map(|x| (x as f64, y)).collect()
        };
        let canvas = Canvas::default()
            .marker(Marker::Braille)
            .x_bounds([0.0, (columns - 1) as f64])
            .y_bounds([-scale, scale])
            .paint(|context: &mut Context<'_>| {
                context.draw(&Points { coords: &across(0.0, 1, 4), color: theme.axis() });
                if let Some(clamp) = self.clamp_nm.filter(|clamp| *clamp <= self.scale_nm) {
                    for y in [f64::from(clamp), -f64::from(clamp)] {
                        context.draw(&Points { coords: &across(y, 4, 6), color: theme.limit() });
                    }
                }
                context.layer();
                for &[x1, y1, x2, y2] in &lines {
                    context.draw(&Line { x1, y1, x2, y2, color: colour });
                }
            });
        frame.render_widget(canvas, picture);
    }

    /// The ends of the scale and zero, µm; the clamp is named where it is drawn.
    fn draw_figures(&self, frame: &mut Frame<'_>, area: Rect, theme: Theme) {
        if area.is_empty() {
            return;
        }
        let micro = |nm: u32| grouped(u64::from(nm / 1_000));
        let bottom = area.height - 1;
        let mut figures =
            vec![(0, format!("+{}", micro(self.scale_nm))), (bottom, format!("-{}", micro(self.scale_nm)))];
        if area.height > 2 {
            figures.push((area.height / 2, "0".to_owned()));
        }
        if let Some(clamp) = self.clamp_nm.filter(|clamp| *clamp <= self.scale_nm && area.height > 6) {
            let share = (1.0 - f64::from(clamp) / f64::from(self.scale_nm)) / 2.0;
            let row = ((f64::from(area.height) * share) as u16).clamp(1, area.height / 2 - 1);
            figures.push((row, "clamp".to_owned()));
        }
        for (row, text) in figures {
            let place = Rect { y: area.y + row, height: 1, ..area };
            let text = format!("{text:>width$} ", width = usize::from(GUTTER) - 1);
            frame.render_widget(ratatui::text::Line::styled(text, theme.faint()), place);
        }
    }

    /// Lines of the picture: x in columns of dots, y in nm.
    fn lines(&self, columns: usize) -> Vec<[f64; 4]> {
        let start = self.now_s - SPAN.as_secs_f64();
        let mut lines = Vec::new();
        let mut column: Option<Column> = None;
        for point in self.history.points() {
            let x = (point.t_s - start) / SPAN.as_secs_f64() * columns as f64;
            if !(0.0..=columns as f64).contains(&x) {
                continue;
            }
            let (x, y) = (x.floor().min((columns - 1) as f64), f64::from(point.nm[self.axis.min(1)]));
            match &mut column {
                Some(c) if c.x == x => {
                    (c.least, c.most) = (c.least.min(y), c.most.max(y));
                    (c.last, c.t_s) = (y, point.t_s);
                }
                other => {
                    if let Some(before) = other.take() {
                        lines.push([before.x, before.least, before.x, before.most]);
                        if point.t_s - before.t_s < GAP_S {
                            lines.push([before.x, before.last, x, y]);
                        }
                    }
                    *other = Some(Column { x, least: y, most: y, last: y, t_s: point.t_s });
                }
            }
        }
        lines.extend(column.map(|c| [c.x, c.least, c.x, c.most]));
        lines
    }
}

/// A column of dots.
struct Column {
    x: f64,
    least: f64,
    most: f64,
    last: f64,
    t_s: f64,
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use truepath_core::link::TraceSample;

    use super::*;

    #[test]
    fn the_scale_is_a_round_number_that_shows_the_correction_and_a_near_clamp() {
        assert_eq!(scale(0, None), 1_000);
        assert_eq!(scale(1_001, None), 2_000);
        assert_eq!(scale(150_000, None), 200_000);
        assert_eq!(scale(150_000, Some(250_000)), 500_000);
        assert_eq!(scale(50_000, Some(250_000)), 50_000);
        assert_eq!(scale(u32::MAX, Some(u32::MAX)), u32::MAX);
    }

    #[test]
    fn a_single_peak_is_drawn_however_many_samples_share_its_column() {
        let mut history = History::default();
        let peak = |k| TraceSample { correction_nm: [if k == 500 { -7_000 } else { 0 }, 0], ..TraceSample::default() };
        let samples: Vec<TraceSample> = (0..1000).map(peak).collect();
        history.take(Duration::from_secs(10), Duration::from_secs(11), 0, &samples);
        let trend = Trend { history: &history, axis: 0, now_s: 11.0, scale_nm: 10_000, clamp_nm: None, live: true };
        assert!(trend.lines(40).iter().any(|l| l[1] == -7_000.0));
        // Nothing is drawn before the first sample.
        assert!(trend.lines(40).iter().all(|l| l[0] >= 38.0));
    }
}
