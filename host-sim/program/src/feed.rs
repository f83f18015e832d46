//! F words of a contour whose feed is scheduled.
//!
//! A line on which the feed changes is divided there; the F word stands on the first move it is for and only where the
//! feed in force is another one. Behind the contour, and before anything on it that stands still in the plane, a line
//! with F alone puts back the feed of the program, so that everything else finds the feed it had.
//!
//! Limits: feeds per minute or per revolution, one per line of the program.

use truepath_core::gcode::{FeedMode, Modal, Units};
use truepath_core::units::Real;
use truepath_ground::diagnostics::Failure;

use super::edit::BlockEdit;
use super::survey::Move;
use super::writer::{Scheduled, Writer};
use crate::codes::P006;

/// Parts of an edit at one feed each: first and last sample, percent of the programmed feed.
pub(super) fn spans(edit: &BlockEdit) -> Vec<(usize, usize, u16)> {
    let last = edit.samples.len().saturating_sub(1);
    let starts = edit.feeds.iter().map(|from| (from.sample.min(last), from.percent));
    let mut spans: Vec<(usize, usize, u16)> = Vec::new();
    for (start, percent) in std::iter::once((0, 100)).chain(starts) {
        if let Some(before) = spans.last_mut() {
            before.1 = start;
        }
        spans.retain(|span| span.0 < span.1);
        spans.push((start, last, percent));
    }
    spans
}

/// Decimals of a written feed: a thousandth of usual feeds.
const fn decimals(modal: &Modal) -> usize {
    match (modal.feed_mode, modal.units) {
        (FeedMode::PerRevolution, Units::Millimetres) => 4,
        (FeedMode::PerRevolution, Units::Inches) => 5,
        (_, Units::Millimetres) => 1,
        (_, Units::Inches) => 2,
    }
}

const fn unit(modal: &Modal) -> f64 {
    match modal.units {
        Units::Millimetres => 1.0,
        Units::Inches => 25.4,
    }
}

/// How far a written feed may be from a percentage of the programmed one, in the unit of [`Modal::feed`].
pub(crate) fn rounding(modal: &Modal) -> f64 {
    0.51 * unit(modal) / 10f64.powi(decimals(modal) as i32)
}

fn value(modal: &Modal) -> f64 {
    truepath_ground::units::float(modal.feed.unwrap_or(Real::ZERO)) / unit(modal)
}

/// A number with a point and without idle zeros behind it.
fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    text.trim_end_matches('0').to_owned()
}

/// The value of the F word that puts back the feed of the program; `None` when no F word of six decimals is that feed.
fn programmed(modal: &Modal) -> Option<String> {
    let text = number(value(modal), 6);
    let read: f64 = text.parse().ok()?;
    ((read - value(modal)).abs() < 1e-9).then_some(text)
}

/// The value of the F word of a feed times a factor; `None` when there is no feed, or no F word of six decimals is it.
pub(crate) fn scaled(modal: &Modal, factor: f64) -> Option<String> {
    modal.feed?;
    if factor == 1.0 { programmed(modal) } else { Some(number(value(modal) * factor, decimals(modal))) }
}

impl Writer<'_> {
    /// Refuses a line with several feeds of its own.
    pub(super) fn refuse_several_feeds(&self, cuts: &[Move]) -> Result<(), Failure> {
        let several = cuts.windows(2).find(|pair| pair[0].modal.feed != pair[1].modal.feed);
        several.map_or(Ok(()), |pair| {
            let found = "this line of the contour has several feeds, and its feed is scheduled";
            let help = "write the moves on lines of their own, or remove [feed] from the job";
            Err(self.refusal(P006, pair[0].line, [found, "one feed for each line", help]))
        })
    }

    /// Forgets the scheduled feed when a line between the last one written and `line` has an F word.
    pub(super) fn notice_feeds_before(&mut self, line: u32) {
        let passed = self.feed.as_ref().is_some_and(|f| (f.line + 1..line).any(|l| self.block(l).has_feed()));
        if passed {
            self.feed = None;
        }
    }

    /// The value of the F word that a move at a percentage of its feed needs; `own` is whether its line has one.
    pub(super) fn feed_word(&mut self, step: &Move, percent: u16, own: bool) -> Result<Option<String>, Failure> {
        let (line, modal) = (step.line, step.modal);
        if percent == 100 {
            let differs = self.feed.take().is_some() && !own;
            return if differs { self.programmed_feed(line, &modal).map(Some) } else { Ok(None) };
        }
        let text = number(value(&modal) * f64::from(percent) / 100.0, decimals(&modal));
        let before = self.feed.replace(Scheduled { text: text.clone(), line, modal });
        let stands = !own && before.is_some_and(|before| before.text == text);
        Ok((!stands).then_some(text))
    }

    /// Puts back the feed of the program on a line of its own behind the last one written.
    pub(super) fn restore_feed(&mut self) -> Result<(), Failure> {
        let Some(Scheduled { line, modal, .. }) = self.feed.take() else { return Ok(()) };
        let text = self.programmed_feed(line, &modal)?;
        let word = if self.manner.klartext { format!("L F{}", text.trim_end_matches('.')) } else { format!("F{text}") };
        let text = self.original(line).alone(&word);
        if let Some(parts) = self.replaced.get_mut(&line) {
            parts.push(text);
        }
        Ok(())
    }

    fn programmed_feed(&self, line: u32, modal: &Modal) -> Result<String, Failure> {
        programmed(modal).ok_or_else(|| {
            let found = "the feed of the contour is computed, and has to be put back behind it";
            let help = "write the feed as a number, or remove [feed] from the job";
            self.refusal(P006, line, [found, "a feed of at most six decimals", help])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::edit::FeedFrom;
    use super::*;

    #[test]
    fn the_spans_of_an_edit_cover_its_samples_once() {
        let at = |feeds: &[(usize, u16)]| {
            let feeds = feeds.iter().map(|&(sample, percent)| FeedFrom { sample, percent }).collect();
            spans(&BlockEdit { line: 1, samples: vec![[0; 2]; 11], feeds })
        };
        assert_eq!(at(&[]), [(0, 10, 100)]);
        assert_eq!(at(&[(0, 80), (4, 60)]), [(0, 4, 80), (4, 10, 60)]);
        assert_eq!(at(&[(3, 80)]), [(0, 3, 100), (3, 10, 80)]);
    }

    #[test]
    fn numbers_have_a_point_and_no_idle_zeros() {
        assert_eq!(number(340.0, 1), "340.");
        assert_eq!(number(130.5, 6), "130.5");
    }
}
