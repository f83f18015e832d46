//! How regularly setpoints arrive at a device and how fast they are answered: a line, and histograms.
//!
//! Bins are those of [`TIMING_EDGES_NS`], wider from one to the next as on a scale of logarithms; the earliest is at the
//! left end. A bin that holds anything has an eighth of a letter at least, so that a single late frame is seen.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Sparkline};
use truepath_core::link::{Spread, TIMING_BINS, TIMING_EDGES_NS, Timing};

use super::theme::Theme;

/// Columns of a bin.
const BIN: usize = 2;
/// Columns of the arrivals, early and late, and of the answers.
const WIDTHS: [u16; 2] = [(2 * TIMING_BINS * BIN) as u16, (TIMING_BINS * BIN) as u16];
/// Columns between them.
const GAP: u16 = 2;
/// Rows of the histograms, and the rows from which they get more: a title, the bars, the scale.
const ROWS: [(u16, u16); 2] = [(10, 5), (3, 3)];

/// Rows of the histograms where there are so many for all that is not text.
pub fn rows(free: u16) -> u16 {
    ROWS.into_iter().find(|(least, _)| *least <= free).map_or(0, |(_, rows)| rows)
}

/// Mean, standard deviation and extremes, µs.
pub fn line(timing: &Timing) -> Line<'static> {
    let Timing { arrivals, answers, .. } = timing;
    let us = |ns: i32| f64::from(ns) / 1e3;
    let deviation = |spread: &Spread| f64::from(spread.deviation_ns) / 1e3;
    Line::from(format!(
        "Setpoints: {:+.1} ± {:.1} µs ({:+.1} … {:+.1}); answers {:.1} ± {:.1} µs (worst {:.1})",
        us(arrivals.mean_ns),
        deviation(arrivals),
        us(arrivals.least_ns),
        us(arrivals.greatest_ns),
        us(answers.mean_ns),
        deviation(answers),
        us(answers.greatest_ns)
    ))
}

/// The line of a firmware that has no [`Timing`].
pub fn none(theme: Theme) -> Line<'static> {
    Line::styled("Setpoints: this firmware does not time them", theme.faint())
}

/// Draws the histograms: arrivals, and answers beside them; of both what there is room for.
pub fn histograms(frame: &mut Frame<'_>, area: Rect, timing: &Timing, theme: Theme) {
    let [left, right] = Layout::horizontal(WIDTHS.map(Constraint::Length)).spacing(GAP).areas(area);
    let whole = [WIDTHS[0], WIDTHS[0] + GAP + WIDTHS[1]].map(|width| width <= area.width);
    let marks: Vec<(usize, String)> = marks().collect();
    if whole[0] {
        let bins: Vec<u32> = timing.early.iter().rev().chain(&timing.late).copied().collect();
        let middle = TIMING_BINS * BIN;
        // Those of 1 µs would touch that of 0.
        let early = marks.iter().skip(1).rev().map(|(column, text)| (middle - column, format!("-{text}")));
        let late = marks.iter().skip(1).map(|(column, text)| (middle + column, text.clone()));
        let marks: Vec<_> = early.chain([(middle, "0".to_owned())]).chain(late).collect();
        let title = format!(" µs off the period of {:.3} µs ", f64::from(timing.period_ns) / 1e3);
        histogram(frame, left, &title, &bins, &marks, theme);
    }
    if whole[1] {
        histogram(frame, right, " µs to the answer ", &timing.taken, &marks, theme);
    }
}

/// The powers of ten among the edges of the bins: columns from where a histogram begins, and µs.
fn marks() -> impl Iterator<Item = (usize, String)> {
    let decades = [1, 10, 100, 1_000];
    let us = TIMING_EDGES_NS.iter().map(|ns| ns / 1_000).enumerate();
    us.filter(move |(_, us)| decades.contains(us)).map(|(bin, us)| ((bin + 1) * BIN, us.to_string()))
}

/// A title, the bars, and the scale under them: the first column of a mark is the first behind that edge.
fn histogram(frame: &mut Frame<'_>, area: Rect, title: &str, bins: &[u32], marks: &[(usize, String)], theme: Theme) {
    let block = Block::new().borders(Borders::TOP).border_style(theme.faint());
    let block = block.title(Span::styled(title.to_owned(), theme.heading()));
    let [bars, below] = Layout::vertical([Constraint::Fill(1), Constraint::Length(1)]).areas(block.inner(area));
    frame.render_widget(block, area);
    let most = u64::from(bins.iter().copied().max().unwrap_or(0)).max(1);
    let top = 8 * u64::from(bars.height);
    let eighths = bins.iter().map(|&count| (u64::from(count) * top).div_ceil(most));
    let columns: Vec<u64> = eighths.flat_map(|height| [height; BIN]).collect();
    frame.render_widget(Sparkline::default().data(columns).max(top.max(1)).style(theme.curve()), bars);
    for (column, text) in marks {
        // A mark that would not end within the picture ends with it.
        let width = text.chars().count() as u16;
        let x = (*column as u16).min(area.width.saturating_sub(width));
        let place = Rect { x: below.x + x, width: width.min(below.width), ..below };
        frame.render_widget(Line::styled(text.clone(), theme.faint()), place);
    }
}

#[cfg(test)]
mod tests {
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;
    use crate::monitor::pictures::text;

    fn picture(timing: &Timing, width: u16, height: u16) -> Vec<String> {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        let draw = |frame: &mut Frame<'_>| histograms(frame, frame.area(), timing, Theme { colour: false });
        terminal.draw(draw).unwrap();
        text(terminal.backend().buffer()).lines().map(str::to_owned).collect()
    }

    /// The first column of every bar.
    fn bars(row: &str) -> Vec<usize> {
        let letters: Vec<char> = row.chars().collect();
        (0..letters.len()).step_by(BIN).filter(|&column| letters[column] != ' ').collect()
    }

    #[test]
    fn a_bar_stands_behind_the_mark_of_its_edge_and_a_single_frame_is_seen() {
        let mut timing = Timing { period_ns: 1_000_000, ..Timing::default() };
        (timing.early[0], timing.early[4], timing.late[4], timing.late[10]) = (1_000_000, 1, 1, 1);
        timing.taken[7] = 1;
        let shown = picture(&timing, 80, 3);
        // The middle is at 22; 10 µs is the edge before the fifth bin, 100 µs that before the eighth.
        assert_eq!(bars(&shown[1]), [12, 20, 30, 42, 46 + 14]);
        let marks: Vec<char> = shown[2].chars().collect();
        let at = |column: usize, text: &str| marks[column..].iter().take(text.len()).collect::<String>() == text;
        assert!(at(14, "-10 ") && at(22, "0 ") && at(30, "10 ") && at(40, "1000") && at(46 + 14, "100 "), "{shown:?}");
        assert!(shown[1].starts_with("            ▁▁      ██"), "{shown:?}");
    }

    #[test]
    fn a_histogram_is_whole_or_not_there() {
        let timing = crate::monitor::pictures::timing();
        let titles = |width| picture(&timing, width, 3).first().map_or(0, |title| title.matches(" the ").count());
        assert_eq!([43, 44, 67, 68, 200].map(titles), [0, 1, 1, 2, 2]);
    }
}
