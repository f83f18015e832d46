//! The table of counters: value, growth per second, and a mark at those that should not grow and did.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::growth::Count;
use super::theme::{Theme, Tone};
use super::wording::rate;

/// A counter of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// What is counted.
    pub name: &'static str,
    /// How often.
    pub count: Count,
    /// Whether it grows only when something is wrong.
    pub bad: bool,
    /// Whether it is of now.
    pub live: bool,
}

/// Width of a column: name, value, rate, mark.
const COLUMN: u16 = 38;

impl Row {
    /// Whether somebody should look at it.
    pub const fn stands_out(&self) -> bool {
        self.bad && self.live && self.count.grew
    }
    fn line(&self, theme: Theme) -> Line<'static> {
        if !self.live {
            return Line::styled(format!("{:<15}{:>10}", self.name, self.count.value), theme.faint());
        }
        let style = match (self.stands_out(), self.bad && self.count.value > 0) {
            (true, _) => theme.text(Tone::Wrong),
            (_, true) => theme.heading(),
            _ => theme.text(Tone::Plain),
        };
        let mark = if self.stands_out() { " ▲" } else { "  " };
        let per_s = rate(self.count.per_s);
        Line::from(Span::styled(format!("{:<15}{:>10}{per_s:>8}/s{mark}", self.name, self.count.value), style))
    }
}

/// Rows of the table in a width.
pub fn height(rows: usize, width: u16) -> u16 {
    let columns = usize::from((width / COLUMN).max(1));
    rows.div_ceil(columns) as u16
}

/// Draws the table, column by column.
pub fn draw(frame: &mut Frame<'_>, area: Rect, rows: &[Row], theme: Theme) {
    let high = height(rows.len(), area.width).max(1);
    for (index, row) in rows.iter().enumerate() {
        let (x, y) = (index as u16 / high * (COLUMN + 2), index as u16 % high);
        if y < area.height && x < area.width {
            let place = Rect { x: area.x + x, y: area.y + y, width: (area.width - x).min(COLUMN), height: 1 };
            frame.render_widget(row.line(theme), place);
        }
    }
}

/// Those that stand out, in one line.
pub fn outstanding(rows: &[Row]) -> String {
    let found: Vec<String> =
        rows.iter().filter(|row| row.stands_out()).map(|row| format!("{} {} ▲", row.name, row.count.value)).collect();
    if found.is_empty() { "no counter of trouble grows".to_owned() } else { found.join(", ") }
}
