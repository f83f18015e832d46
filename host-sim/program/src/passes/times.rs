//! How long a contour takes in several passes.

use truepath_core::gcode::{Axes, FeedMode, GcodeError, LineRange, Options};
use truepath_core::units::Position;
use truepath_ground::units::{float, mm};

use super::super::survey::{Kind, Move, survey};

/// Minutes at feed, by the F words of the program. Rapids are not in them: how fast they are, no program says.
#[derive(Clone, Debug, PartialEq)]
pub struct Times {
    /// The contour of the program, with leads, spring passes, its way down and its way up.
    pub programmed: f64,
    /// Of that the contour alone.
    pub contour: f64,
    /// Of that the ways that stay as they are, before the passes and behind them.
    pub kept: f64,
    /// The passes, in the order of cutting.
    pub passes: Vec<PassTimes>,
}

/// Minutes at feed of one pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassTimes {
    /// Lead-in, contour and lead-out at the programmed feed.
    pub along: f64,
    /// The ways up and down.
    pub beside: f64,
}

impl Times {
    /// Of a contour on some lines of a program, which has become `text`; of every pass there, which is at the programmed feed, its lines
    /// and those of the contour.
    pub(super) fn of(
        (original, text): (&[u8], &[u8]),
        replaced: LineRange,
        passes: &[(LineRange, Vec<u32>)],
        options: Options<'static>,
    ) -> Result<Self, GcodeError> {
        let before = survey(original, options)?;
        let on = |lines: LineRange| move |m: &Move| lines.contains(m.line);
        let first = before.iter().position(on(replaced)).unwrap_or_default();
        let behind = before.iter().rposition(on(replaced)).map_or(first, |last| last + 1);
        let way = |m: &&Move| matches!(m.kind, Kind::Feed | Kind::Arc(..)) && m.from.z != m.to.z;
        let down = before[..first].iter().rev().take_while(way).map(minutes);
        let kept = down.chain(before[behind..].iter().take_while(way).map(minutes)).sum::<f64>();
        let own = before[first..behind].iter().map(minutes).sum::<f64>();

        let after = survey(text, options)?;
        let pass = |(lines, _): &(LineRange, Vec<u32>)| {
            let mut times = PassTimes::default();
            for m in after.iter().filter(|m| lines.contains(m.line)) {
                *if m.cuts() { &mut times.along } else { &mut times.beside } += minutes(m);
            }
            times
        };
        let on_contour = |(_, lines): &(LineRange, Vec<u32>)| -> f64 {
            after.iter().filter(|m| lines.contains(&m.line)).map(minutes).sum()
        };
        let contour = passes.first().map_or(0.0, on_contour);
        Ok(Self { programmed: kept + own, contour, kept, passes: passes.iter().map(pass).collect() })
    }
}

/// Minutes of a move at feed; 0 for any other, and for what is not known of it.
fn minutes(m: &Move) -> f64 {
    let feed = m.modal.feed.map_or(0.0, float);
    let across = match m.kind {
        Kind::Arc(curve, turns) => {
            let turn = curve.signed_radius().map_or(0.0, |radius| std::f64::consts::TAU * mm(radius.abs()));
            mm(curve.length()) + f64::from(turns) * turn
        }
        Kind::Feed => apart(m, |axes| axes.x).hypot(apart(m, |axes| axes.y)),
        _ => return 0.0,
    };
    let length = across.hypot(apart(m, |axes| axes.z));
    let speed = match m.modal.feed_mode {
        FeedMode::PerMinute => feed,
        FeedMode::PerRevolution => feed * m.modal.speed.map_or(0.0, float),
        FeedMode::InverseTime => feed * length,
    };
    if speed > 0.0 { length / speed } else { 0.0 }
}

/// How far a move goes along an axis, mm.
fn apart(m: &Move, axis: impl Fn(&Axes) -> Option<Position>) -> f64 {
    axis(&m.from).zip(axis(&m.to)).map_or(0.0, |(from, to)| (to.nm() - from.nm()).abs() as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use truepath_core::geometry::Block;
    use truepath_core::units::Offset;
    use truepath_ground::diagnostics::Source;

    use super::super::{Depth, Turn, can_repeat};
    use super::*;

    /// Down 15 mm at 300, lead-in of 8 mm at 300, contour of 20 mm at 250, up at rapid.
    const PROGRAM: &str =
        "G21 G90\nM3 S1500\nG0 X0 Y-8 Z10\nG1 Z-5 F300\nG1 X0 Y0\nG1 X20 F250\nG0 Z10\nG0 X50 Y50\nM30\n";

    fn times(turns: &[(i64, bool)]) -> Times {
        let moves = survey(PROGRAM.as_bytes(), Options::default()).expect("readable");
        let contour = moves.iter().find(|m| m.line == 6).and_then(Move::curve).expect("a line");
        let turn = |&(raise, reversed): &(i64, bool)| Turn { raise: Offset::from_um(raise), reversed, feed: 1.0 };
        let depth = Depth {
            contour: vec![Block { curve: contour, line: 6, ..Block::BLANK }],
            springs: Vec::new(),
            allowance: Offset::from_um(500),
            turns: turns.iter().map(turn).collect(),
            announced: false,
            cutter: None,
        };
        let source = Source::new("p.nc", PROGRAM.as_bytes().to_vec());
        let Ok(times) = can_repeat(&source, &depth, Options::default()) else { panic!("refused") };
        times
    }

    #[test]
    fn every_way_at_feed_counts_and_the_kept_way_down_once() {
        let (lead, contour, down) = (8.0 / 300.0, 20.0 / 250.0, 15.0 / 300.0);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        let times = times(&[(0, false), (0, false), (0, true)]);
        close(times.programmed, down + lead + contour);
        close(times.contour, contour);
        close(times.kept, down);
        for (pass, beside) in times.passes.iter().zip([0.0, down, down]) {
            close(pass.along, lead + contour);
            close(pass.beside, beside);
        }
    }

    #[test]
    fn a_raised_first_pass_has_a_way_down_of_its_own() {
        let times = times(&[(2_000, false), (0, false)]);
        assert_eq!(times.kept, 0.0);
        assert!((times.passes[0].beside - 13.0 / 300.0).abs() < 1e-9, "{times:?}");
    }
}
