//! One depth of a contour in its program: where it stands, how the cutter comes to it and leaves it.
//!
//! The cutter comes down where it stands from a known height, cuts lead-in, contour and lead-out at one height, and goes up or
//! on. Spring passes behind it belong to the section as long as nothing else is cut between.

use std::ops::Range;

use truepath_core::gcode::{FeedMode, Line, Plane};
use truepath_core::geometry::Block as Curves;
use truepath_core::units::{Offset, Position};
use truepath_ground::codes::Row;
use truepath_ground::diagnostics::{Failure, InputError, Source};

use super::super::deviation::distance;
use super::super::grid::Grid;
use super::super::line::{Block, Manner};
use super::super::pen::place;
use super::super::survey::{Kind, Move};
use super::request::{Depth, Turn};
use crate::codes::{P004, P006, P007, P009, P010};

/// A move up or down where the cutter stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) rapid: bool,
    pub(super) z: Position,
    /// The move whose feed it has.
    pub(super) like: usize,
}

/// A section of the program; indices are of the moves.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// First and last line that are replaced.
    pub(super) lines: [u32; 2],
    /// The moves they hold.
    pub(super) moves: Range<usize>,
    /// Cutting moves of lead-in, contour and lead-out.
    pub(super) parts: [Vec<usize>; 3],
    /// Height of the contour.
    pub(super) z: Position,
    /// The numbers that the program can write.
    pub(super) grid: Grid,
    /// To which height the cutter comes before it goes down, where that is known.
    pub(super) height: Option<Position>,
    /// At which height it goes from the end of a pass to the start of the next.
    pub(super) clearance: Position,
    /// How it goes down at the start.
    pub(super) descent: Vec<Step>,
    /// How it goes up to the clearance.
    pub(super) ascent: Vec<Step>,
    /// Whether the way down to the first pass stays as it is.
    pub(super) keeps_descent: bool,
    /// Whether the program goes up, or ends, behind the section.
    pub(super) rises: bool,
    /// Whether the control compensates the path by the radius, so that the path of the centre is written.
    pub(super) centre_path: bool,
    /// How far the end of the lead-out is from the contour.
    pub(super) end_free: Offset,
}

impl Section {
    /// The height of a pass so much above the contour, as it can be written.
    pub(super) fn height_of(&self, raise: Offset) -> Position {
        if raise == Offset::ZERO {
            return self.z;
        }
        let steps = self.grid.steps((self.z + raise).nm());
        Position::from_nm(self.grid.nm(steps).round() as i64)
    }
}

/// The text a section is looked for in.
#[derive(Clone, Copy)]
pub(super) struct Text<'a> {
    pub(super) source: &'a Source,
    pub(super) lines: &'a [Line<'a>],
    pub(super) moves: &'a [Move],
}

impl<'a> Text<'a> {
    pub(super) fn block(&self, line: u32) -> Block<'a> {
        let index = (line as usize).checked_sub(1);
        let text = index.and_then(|i| self.lines.get(i)).copied();
        Block::new(text.unwrap_or(Line { number: line, start: 0, text: &[] }), Manner::default())
    }

    pub(super) fn refusal(&self, row: Row, line: u32, [found, expected, help]: [&str; 3]) -> Failure {
        let index = (line as usize).checked_sub(1);
        let span = index.and_then(|i| self.lines.get(i)).map_or(0..0, |l| l.span().start..l.span().end());
        InputError::new(row, found, expected, help).at(self.source, span).into()
    }

    /// A section that is not as it has to be.
    fn odd(&self, line: u32, found: &str, expected: &str) -> Failure {
        self.refusal(P009, line, [found, expected, P009.remedy])
    }

    /// The cutting moves of some blocks; they must be there once.
    fn cuts_of(&self, blocks: &[Curves]) -> Result<Vec<usize>, Failure> {
        let first = blocks.first().ok_or_else(|| Failure::Internal("a contour without blocks".to_owned()))?;
        let starts = self.moves.iter().enumerate().filter(|(_, m)| m.line == first.line && m.cuts());
        let mut found = starts.filter_map(|(at, _)| self.cuts_from(at, blocks));
        let refuse = |found| {
            let expected = "lines of this file that are executed once";
            self.refusal(P004, first.line, [found, expected, P004.remedy])
        };
        match (found.next(), found.next()) {
            (Some(cuts), None) => Ok(cuts),
            (Some(_), Some(_)) => Err(refuse("this line is executed several times (a loop or a subprogram)")),
            (None, _) => Err(refuse("a line of the contour stands in another file")),
        }
    }

    fn cuts_from(&self, at: usize, blocks: &[Curves]) -> Option<Vec<usize>> {
        let mut cuts = (at..self.moves.len()).filter(|&i| !self.moves[i].stands_still());
        let fits = |m: &Move, block: &Curves| m.line == block.line && m.cuts() && m.curve() == Some(block.curve);
        blocks.iter().map(|block| cuts.next().filter(|&i| fits(&self.moves[i], block))).collect()
    }

    /// The run of cutting moves at one height around some of them: from its first to its last.
    fn run_around(&self, cuts: &[usize]) -> Option<(Range<usize>, Position)> {
        let (&first, &last) = (cuts.first()?, cuts.last()?);
        let z = self.moves[first].to.z?;
        let tool = self.moves[first].modal.tool;
        let level = |i: usize| {
            let m = &self.moves[i];
            let cuts = matches!(m.kind, Kind::Feed | Kind::Arc(..)) && m.from.point().is_some();
            cuts && [m.from.z, m.to.z] == [Some(z); 2] && m.modal.tool == tool
        };
        let before = (0..first).rev().take_while(|&i| level(i)).last().unwrap_or(first);
        let behind = (last + 1..self.moves.len()).take_while(|&i| level(i)).last().unwrap_or(last);
        let cut = |range: Range<usize>| range.into_iter().filter(|&i| self.moves[i].cuts()).collect::<Vec<_>>();
        let all = cut(before..behind + 1);
        (cuts.iter().all(|&i| level(i))).then_some((*all.first()?..*all.last()? + 1, z))
    }

    /// Finds the section of a depth.
    pub(super) fn section(&self, depth: &Depth) -> Result<Section, Failure> {
        let moves = self.moves;
        let contour = self.cuts_of(&depth.contour)?;
        let line = moves[contour[0]].line;
        let (run, z) = self
            .run_around(&contour)
            .ok_or_else(|| self.odd(line, "the contour changes its height", "a contour at one known height"))?;
        let cutting = |range: Range<usize>| range.filter(|&i| moves[i].cuts()).collect::<Vec<_>>();
        let (head, last) = (contour[0], contour[contour.len() - 1]);
        let parts = [cutting(run.start..head), contour, cutting(last + 1..run.end)];
        let length = |part: &[usize]| {
            part.iter().filter_map(|&i| moves[i].curve()).fold(Offset::ZERO, |sum, c| sum + c.length())
        };
        if length(&parts[0]).max(length(&parts[2])) > length(&parts[1]) {
            let found = "the cut that leads to the contour or away from it is longer than the contour";
            return Err(self.odd(line, found, "a contour with leads of its own, cut apart from roughing"));
        }
        let end = self.end(depth, run.end)?;
        let (height, descent, first_down) = self.way_down(run.start, z);
        let as_programmed = |turn: &Turn| !turn.reversed && turn.raise == Offset::ZERO;
        let told = depth.announced || depth.cutter.is_some();
        let plain = !told && depth.turns.first().is_some_and(as_programmed);
        let start = match first_down.filter(|_| !plain) {
            Some(first) => first,
            None if plain => run.start,
            None => {
                let found = "the cutter comes to the contour along a ramp, or at its depth";
                let expected = if depth.cutter.is_some() {
                    "a move down where it stands, before which the cutter can be changed"
                } else if depth.announced {
                    "a move down where it stands, before which the control can be told of the pass"
                } else {
                    "a first pass in the direction and at the depth of the program, or a move down where it stands"
                };
                return Err(self.odd(moves[run.start].line, found, expected));
            }
        };
        let (clearance, ascent, rises) = self.way_up(run.start, end, z, height).ok_or_else(|| {
            let found = "the program names no height above the contour";
            self.odd(line, found, "a move up behind the contour, or a rapid to it at a known height")
        })?;
        let section = Section {
            lines: self.lines_of(start..end)?,
            end_free: self.free(&parts),
            grid: Grid::of(moves[start].modal.units),
            moves: start..end,
            parts,
            z,
            height: height.filter(|h| *h > z),
            clearance,
            descent,
            ascent,
            keeps_descent: plain,
            rises,
            centre_path: moves[start..end].iter().any(|m| m.modal.compensated),
        };
        self.check_modes(&section)?;
        Ok(section)
    }

    /// The first move behind the contour and the spring passes that go with it.
    fn end(&self, depth: &Depth, mut end: usize) -> Result<usize, Failure> {
        for spring in &depth.springs {
            let cuts = self.cuts_of(spring)?;
            let line = self.moves[cuts[0]].line;
            let run = self.run_around(&cuts).map(|(run, _)| run).filter(|run| run.start >= end);
            let alone = run.filter(|run| self.moves[end..run.start].iter().all(|m| !m.cuts() && m.is_straight()));
            end = alone.map(|run| run.end).ok_or_else(|| {
                let found = "a spring pass goes over this wall later, and something is cut between";
                self.odd(line, found, "spring passes right behind the pass that they go over, or none")
            })?;
        }
        Ok(end)
    }

    /// How the cutter comes down to the start of the run: the height it comes to, the moves down from there, and the first
    /// of them.
    fn way_down(&self, run: usize, z: Position) -> (Option<Position>, Vec<Step>, Option<usize>) {
        let moves = self.moves;
        let still = (0..run).rev().take_while(|&i| moves[i].stands_still()).last().unwrap_or(run);
        let mut height = still.checked_sub(1).and_then(|i| moves[i].to.z);
        let (mut steps, mut first) = (Vec::new(), None);
        for (i, m) in moves.iter().enumerate().take(run).skip(still).filter(|(_, m)| m.from.z != m.to.z) {
            let Some(to) = m.to.z else { continue };
            if height.is_none_or(|h| to > h) {
                (height, first) = (Some(to), None);
                steps.clear();
            } else {
                first = first.or(Some(i));
                steps.push(Step { rapid: matches!(m.kind, Kind::Traverse), z: to, like: i });
            }
        }
        if first.is_some() {
            return (height, steps, first);
        }
        // A ramp: from the height that it begins at a later pass goes straight down, where the first one has been.
        let slopes =
            |i: &usize| matches!(moves[*i].kind, Kind::Feed | Kind::Arc(..)) && moves[*i].from.z != moves[*i].to.z;
        let ramp = (0..run).rev().take_while(slopes).last();
        let height = ramp.and_then(|i| moves[i].from.z);
        (height, vec![Step { rapid: false, z, like: ramp.unwrap_or(run) }], None)
    }

    /// The height between passes, how the cutter goes up to it, and whether the program goes up behind the section.
    fn way_up(
        &self,
        run: usize,
        end: usize,
        z: Position,
        height: Option<Position>,
    ) -> Option<(Position, Vec<Step>, bool)> {
        let moves = self.moves;
        let mut steps: Vec<Step> = Vec::new();
        for (i, m) in moves.iter().enumerate().skip(end).take_while(|(_, m)| m.stands_still()) {
            let Some(to) = m.to.z.filter(|to| *to > steps.last().map_or(z, |s| s.z)) else { break };
            steps.push(Step { rapid: matches!(m.kind, Kind::Traverse), z: to, like: i });
        }
        let same = |m: &&Move| {
            let (a, b) = (&m.modal, &moves[run].modal);
            (a.tool, a.work_offset, a.shifts) == (b.tool, b.work_offset, b.shifts)
        };
        let travels = moves[..run].iter().rev().take_while(same).filter(|m| matches!(m.kind, Kind::Traverse));
        // At the end of the moves up it goes to another place, or ends.
        let travels_at = steps.last().map(|s| s.z);
        let highest = || travels.filter(|m| !m.stands_still()).filter_map(|m| m.to.z).max();
        let top = travels_at.or_else(highest).max(height).filter(|top| *top > z)?;
        if steps.last().is_none_or(|s| s.z < top) {
            steps.push(Step { rapid: true, z: top, like: run });
        }
        let least = [height, travels_at].into_iter().flatten().filter(|h| *h > z).fold(top, Position::min);
        let goes_up = |m: &Move| m.modal.absolute && m.stands_still() && m.to.z.is_some_and(|to| to >= least);
        let rises = moves.get(end).is_none_or(|m| goes_up(m) || matches!(m.kind, Kind::Away(_)));
        Some((top, steps, rises))
    }

    /// The lines of the section: those of its moves, which hold nothing else, and of the switch of compensation before.
    fn lines_of(&self, moves: Range<usize>) -> Result<[u32; 2], Failure> {
        let inside = &self.moves[moves.clone()];
        let (mut first, last) = (inside[0].line, inside[inside.len() - 1].line);
        let before = moves.start.checked_sub(1).map(|i| &self.moves[i]);
        let after = before.map_or(0, |m| m.line);
        if inside.iter().any(|m| m.modal.wall.is_some()) && before.is_none_or(|m| m.modal.wall.is_none()) {
            let switch = (after + 1..first).rev().find(|&l| self.block(l).switches_compensation_on());
            first = switch.unwrap_or(first);
        }
        let jumps = inside[0].jumps;
        let own = |m: &Move| m.line >= first && m.line <= last && m.jumps == jumps;
        let others = self.moves[..moves.start].iter().chain(&self.moves[moves.end..]);
        let apart = others.into_iter().all(|m| m.line < first || m.line > last);
        let plain = (first..=last).all(|line| !self.block(line).computes());
        if first == 0 || !inside.iter().all(own) || !apart || !plain {
            let found = "the lines of the contour are executed several times, steer the program or set parameters";
            let expected = "lines of this file that are executed once";
            return Err(self.refusal(P004, inside[0].line, [found, expected, P004.remedy]));
        }
        Ok([first, last])
    }

    /// How far the end of the lead-out is from the contour.
    fn free(&self, parts: &[Vec<usize>; 3]) -> Offset {
        let end = parts[2].last().and_then(|&i| place(self.moves[i].to));
        let curves = parts[1].iter().filter_map(|&i| self.moves[i].curve());
        let least = |end: [i64; 2]| curves.map(|curve| distance(end, &curve)).fold(f64::INFINITY, f64::min);
        end.map(least).filter(|d| d.is_finite()).map_or(Offset::ZERO, |d| Offset::from_nm(d as i64))
    }

    /// Refuses modes under which a pass cannot be written again.
    fn check_modes(&self, section: &Section) -> Result<(), Failure> {
        let inside = &self.moves[section.moves.clone()];
        let first = &inside[0];
        let cuts = || section.parts.iter().flatten().map(|&i| &self.moves[i]);
        if let Some(m) = cuts().find(|m| m.modal.feed_mode == FeedMode::InverseTime || m.modal.feed.is_none()) {
            let found = "the feed of the contour is a time for each whole line (G93), or there is none";
            return Err(self.refusal(P006, m.line, [found, "feed per minute or per revolution", P006.remedy]));
        }
        if let Some(m) = cuts().find(|m| matches!(m.kind, Kind::Arc(_, turns) if turns > 0)) {
            let found = "an arc of the contour makes more than one turn";
            return Err(self.refusal(P006, m.line, [found, "arcs of at most one turn", P006.remedy]));
        }
        let modes = |m: &Move| {
            let modal = m.modal;
            let places = (modal.units, modal.plane, modal.absolute_centres, modal.work_offset, modal.shifts);
            (places, modal.auxiliary, modal.length_offset, modal.feed_mode)
        };
        let changes = inside.iter().find(|m| modes(m) != modes(first) || m.modal.plane != Plane::Xy || m.in_cycle());
        if let Some(m) = changes {
            let found = "a mode changes on the way along the contour (unit, plane, offset, another axis, a cycle)";
            return Err(self.odd(m.line, found, "one set of modes from the way down to the lead-out, in G17"));
        }
        let before = section.moves.start.checked_sub(1).map(|i| &self.moves[i]);
        let behind = self.moves[section.moves.end..].iter().take_while(|m| m.modal.compensated);
        let led = before.is_some_and(|m| m.modal.compensated) || behind.into_iter().any(|m| !m.stands_still());
        if section.centre_path && led {
            let found = "the control compensates the path (G41, G42) before the contour or behind it";
            let expected = "G41 or G42 and G40 on the leads of the contour";
            return Err(self.refusal(P007, first.line, [found, expected, P007.remedy]));
        }
        Ok(())
    }

    /// Refuses a pass against the programmed direction where G41 or G42 cannot be given for it.
    pub(super) fn check_reversed(&self, section: &Section) -> Result<(), Failure> {
        let cuts: Vec<&Move> = section.parts.iter().flatten().map(|&i| &self.moves[i]).collect();
        if section.centre_path || cuts.iter().all(|m| m.modal.wall.is_none()) {
            return Ok(());
        }
        let before = section.moves.start.checked_sub(1).and_then(|i| self.moves[i].modal.wall);
        let switched = |m: &Move, earlier: Option<_>| m.modal.wall != earlier;
        let mut earlier = before;
        let mut ramps = Vec::new();
        for m in &cuts {
            if switched(m, earlier) {
                ramps.push(m);
            }
            earlier = m.modal.wall;
        }
        let straight = ramps.iter().all(|m| matches!(m.kind, Kind::Feed));
        if before.is_some() || earlier.is_some() || ramps.len() != 2 || !straight {
            let found = "G41 or G42 is not switched on and off along straight leads of the contour";
            let expected = "a straight lead-in with G41 or G42 and a straight lead-out with G40";
            return Err(self.refusal(P010, cuts[0].line, [found, expected, P010.remedy]));
        }
        Ok(())
    }
}
