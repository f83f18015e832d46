//! Colours and emphasis of the views.
//!
//! The colours are the nearest of the 256 that terminals share to the palette of M. Okabe and K. Ito, which differ for
//! colour-blind eyes too. With `NO_COLOR` set only bold, dim and reversed are left; every
//! meaning is in letters as well.

use ratatui::style::{Color, Modifier, Style};

/// What something means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// As it should be.
    Good,
    /// Waiting for somebody.
    Waiting,
    /// On the way to another state.
    Passing,
    /// Held.
    Held,
    /// Wrong.
    Wrong,
    /// Unknown.
    Unknown,
    /// Neither good nor bad.
    Plain,
}

/// Colours, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Theme {
    /// Whether there are any.
    pub colour: bool,
}

impl Theme {
    /// As the environment wants it (<https://no-color.org>).
    pub fn of_environment() -> Self {
        Self { colour: std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty()) }
    }

    fn colour(self, tone: Tone) -> Style {
        let index = match tone {
            Tone::Good => 36,
            Tone::Waiting => 220,
            Tone::Passing => 214,
            Tone::Held => 74,
            Tone::Wrong => 166,
            Tone::Unknown => 175,
            Tone::Plain => return Style::new(),
        };
        if self.colour { Style::new().fg(Color::Indexed(index)) } else { Style::new() }
    }
    /// Text with a meaning; what is wrong or unknown is bold.
    pub fn text(self, tone: Tone) -> Style {
        let style = self.colour(tone);
        if matches!(tone, Tone::Wrong | Tone::Unknown) { style.add_modifier(Modifier::BOLD) } else { style }
    }
    /// A block that stands out.
    pub fn block(self, tone: Tone) -> Style {
        let style = Style::new().add_modifier(Modifier::BOLD);
        match self.colour(tone).fg {
            Some(colour) => style.fg(Color::Indexed(16)).bg(colour),
            None => style.add_modifier(Modifier::REVERSED),
        }
    }
    /// Headings.
    pub fn heading(self) -> Style {
        Style::new().add_modifier(Modifier::BOLD)
    }
    /// What is there to be found and not to be read, and values that are old.
    pub fn faint(self) -> Style {
        Style::new().add_modifier(Modifier::DIM)
    }
    /// A curve.
    pub fn curve(self) -> Color {
        if self.colour { Color::Indexed(32) } else { Color::Reset }
    }
    /// A limit beside a curve.
    pub fn limit(self) -> Color {
        if self.colour { Color::Indexed(166) } else { Color::Reset }
    }
    /// The axis of a curve, and curves that are old.
    pub fn axis(self) -> Color {
        if self.colour { Color::Indexed(245) } else { Color::Reset }
    }
}
