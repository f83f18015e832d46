//! The lines of a section: its passes one after the other, in the spelling of the program.
//!
//! Everything is written out, in absolute places: motion, both coordinates, height and feed, so that no pass depends on
//! what was in force before it. Behind the last pass the feed, G91 and the place of the program are there again.

use std::ops::Range;

use truepath_core::gcode::{Modal, Motion};
use truepath_core::geometry::{Shape as CurveShape, Side};
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::Failure;

use super::super::feed::scaled;
use super::super::fit::Shape;
use super::super::line::Block;
use super::super::pen::{Pen, place};
use super::super::survey::Move;
use super::change::{Change, Changes, Order};
use super::request::{Depth, Turn};
use super::section::{Section, Step, Text};
use crate::codes::{P006, P009, P010};

/// The written lines of a section.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines {
    pub(super) text: Vec<Vec<u8>>,
    /// The passes, in the order of cutting.
    pub(super) passes: Vec<PassLines>,
    /// The lines of changes of the cutter, counted from 0.
    pub(super) changes: Vec<(Range<usize>, Change)>,
    /// Whether the cutter stands higher than in the program when the section is over.
    pub(super) lifted: bool,
}

/// The lines of a pass, counted from 0.
#[derive(Clone, Debug)]
pub(super) struct PassLines {
    pub(super) first: usize,
    /// Where the way down begins, above the start of the pass.
    pub(super) down: usize,
    /// Which line each cutting move has become, in the order of the program.
    pub(super) cuts: Vec<usize>,
}

/// Writes a section.
struct Typist<'a> {
    text: Text<'a>,
    section: &'a Section,
    /// How the lines are spelt.
    style: Block<'a>,
    two_digits: bool,
    /// Whether comments begin with `;`.
    semicolon: bool,
    lines: Vec<Vec<u8>>,
    /// The feed that was written last.
    feed: Option<String>,
    wall: Option<Side>,
    /// Where the cutter stands; its height where that is known.
    at: [i64; 2],
    z: Option<Position>,
}

/// Writes the passes of a depth in the place of its section.
pub(super) fn write(
    text: Text<'_>,
    depth: &Depth,
    section: &Section,
    changes: &Changes,
    (two_digits, semicolon): (bool, bool),
) -> Result<Lines, Failure> {
    let mut typist = Typist::new(text, section, (two_digits, semicolon))?;
    typist.front(depth)?;
    let mut lines = Lines::default();
    let ends = typist.ends()?;
    for (k, turn) in depth.turns.iter().enumerate() {
        typist.check_start(depth, k, ends)?;
        let [from, _] = if turn.reversed { [ends[1], ends[0]] } else { ends };
        if let Some(change) = changes.before.as_ref().filter(|_| k == 0) {
            lines.changes.push((typist.change(change, from), change.clone()));
        }
        let first = typist.lines.len();
        typist.comment(&remark(depth, k, &typist.z_text(section.height_of(turn.raise))));
        let elsewhere = k == 0 && !section.keeps_descent && from != ends[0];
        if k > 0 {
            typist.rise(from);
        } else if elsewhere {
            typist.lift_to(section.clearance);
        }
        if k > 0 || elsewhere {
            typist.travel(from);
        }
        let down = typist.lines.len();
        if k > 0 || !section.keeps_descent {
            typist.go_down(section.height_of(turn.raise), elsewhere);
        }
        let cuts = typist.pass(turn, k == 0)?;
        lines.passes.push(PassLines { first, down, cuts });
    }
    lines.lifted = typist.back(changes.behind.as_ref(), &mut lines.changes)?;
    lines.text = typist.lines;
    Ok(lines)
}

fn remark(depth: &Depth, k: usize, z: &str) -> String {
    let turn = depth.turns[k];
    let mut text = format!("TRUEPATH PASS {} OF {}, {z}", k + 1, depth.turns.len());
    if turn.feed != 1.0 {
        text += &format!(", FEED {} PERCENT", (turn.feed * 1000.0).round() / 10.0);
    }
    if turn.reversed {
        text += ", REVERSED";
    }
    text
}

impl<'a> Typist<'a> {
    fn new(text: Text<'a>, section: &'a Section, (two_digits, semicolon): (bool, bool)) -> Result<Self, Failure> {
        let moves = text.moves;
        let run = section.parts.iter().flatten().next().copied().unwrap_or(section.moves.start);
        let before = section.moves.start.checked_sub(1).map(|i| &moves[i]);
        let [first, last] = section.lines;
        let skipped = |line: &u32| text.block(*line).may_be_skipped();
        let count = (first..=last).filter(skipped).count() as u32;
        if count != 0 && count != last - first + 1 {
            let found = "some of the lines along the contour begin with / and some do not";
            return Err(text.refusal(
                P009,
                first,
                [found, "a contour that is cut always, or a / on all lines", P009.remedy],
            ));
        }
        let at =
            place(moves[run].from).ok_or_else(|| Failure::Internal("a contour from an unknown place".to_owned()))?;
        let style = text.block(moves[section.parts[1][0]].line);
        Ok(Self {
            text,
            section,
            two_digits: two_digits || style.two_digits(),
            semicolon,
            style,
            lines: Vec::new(),
            feed: None,
            wall: if section.centre_path { None } else { before.and_then(|m| m.modal.wall) },
            at,
            z: moves[section.moves.start].from.z,
        })
    }

    fn modal(&self) -> Modal {
        Modal { absolute: true, ..self.text.moves[self.section.parts[1][0]].modal }
    }

    fn code(&self, number: u8) -> String {
        if self.two_digits { format!("G{number:02}") } else { format!("G{number}") }
    }

    fn line(&mut self, words: &str) {
        self.lines.push(self.style.alone(words));
    }

    fn comment(&mut self, text: &str) {
        let text = if self.semicolon { format!("; {text}") } else { format!("({text})") };
        self.lines.push(text.into_bytes());
    }

    fn z_text(&self, z: Position) -> String {
        let grid = self.section.grid;
        format!("Z{}", grid.text(grid.steps(z.nm())))
    }

    /// The places at which the run begins and ends.
    fn ends(&self) -> Result<[[i64; 2]; 2], Failure> {
        let all: Vec<usize> = self.section.parts.iter().flatten().copied().collect();
        let first = all.first().and_then(|&i| place(self.text.moves[i].from));
        let last = all.last().and_then(|&i| place(self.text.moves[i].to));
        let ends = first.zip(last).map(|(a, b)| [a, b]);
        ends.ok_or_else(|| Failure::Internal("a contour from an unknown place".to_owned()))
    }

    /// A pass against the programmed direction may come down only where nothing is left to be cut.
    fn check_start(&self, depth: &Depth, k: usize, ends: [[i64; 2]; 2]) -> Result<(), Failure> {
        let turn = &depth.turns[k];
        if !turn.reversed {
            return Ok(());
        }
        self.text.check_reversed(self.section)?;
        let follows = k.checked_sub(1).is_some_and(|k| !depth.turns[k].reversed && depth.turns[k].raise <= turn.raise);
        if follows || ends[0] == ends[1] || self.section.end_free > depth.allowance {
            return Ok(());
        }
        let line = self.text.moves[self.section.parts[1][0]].line;
        let found = format!(
            "pass {} of {} would come down at the end of the contour, where stock is left: there is no lead-out that ends off the wall",
            k + 1,
            depth.turns.len()
        );
        let expected = "a pass in the direction of the program at the same depth before it";
        Err(self.text.refusal(P010, line, [&found, expected, P010.remedy]))
    }

    /// What else the replaced lines hold: what is there before the first cut comes before the passes, comments as well.
    fn front(&mut self, depth: &Depth) -> Result<(), Failure> {
        let section = self.section;
        let [first, last] = section.lines;
        let moves = self.text.moves;
        let begin = section.parts.iter().flatten().next().map_or(first, |&i| moves[i].line);
        let in_place = depth.turns.first().is_some_and(|turn| !turn.reversed);
        let relative = moves[section.moves.clone()].iter().any(|m| !m.modal.absolute);
        let before = section.moves.start.checked_sub(1).is_some_and(|i| !moves[i].modal.absolute);
        for line in first..=last {
            let block = self.text.block(line);
            let (now, later) = (block.functions(false), block.functions(true));
            let middle = line > begin && !now.is_empty();
            if middle || (line < last && !later.is_empty()) {
                let word = now.first().or_else(|| later.first()).map(|w| String::from_utf8_lossy(w).into_owned());
                let found = format!("{} stands on the way along the contour", word.unwrap_or_default());
                let expected = "such words before the contour or behind it: its lines are written once for each pass";
                return Err(self.text.refusal(P009, line, [&found, expected, P009.remedy]));
            }
            if !now.is_empty() {
                let words: Vec<String> = now.iter().map(|w| String::from_utf8_lossy(w).into_owned()).collect();
                self.line(&words.join(" "));
            }
            let cut = section.parts.iter().flatten().any(|&i| moves[i].line == line);
            if !(in_place && cut) {
                self.lines.extend(block.comments().map(<[u8]>::to_vec));
            }
        }
        if relative || before {
            let code = self.code(90);
            self.line(&code);
        }
        Ok(())
    }

    /// Up to go to a place: to the clearance, or where the cutter stays to the height from which the program goes down.
    fn rise(&mut self, to: [i64; 2]) {
        self.end_compensation();
        let section = self.section;
        let stays = self.at == to;
        let top = section.height.filter(|h| stays && *h < section.clearance).unwrap_or(section.clearance);
        let steps = &section.ascent;
        for (k, step) in steps.iter().enumerate() {
            let step = Step { z: step.z.min(top), ..*step };
            let goes_on = step.z < top && step.rapid && steps.get(k + 1).is_some_and(|next| next.rapid);
            if !goes_on && self.z.is_none_or(|z| step.z > z) {
                self.step(&step);
            }
        }
    }

    fn lift_to(&mut self, z: Position) {
        if self.z.is_none_or(|now| now < z) {
            self.step(&Step { rapid: true, z, like: self.section.moves.start });
        }
    }

    /// Changes the cutter and goes to a place; the lines on which that is written.
    fn change(&mut self, change: &Change, to: [i64; 2]) -> Range<usize> {
        let first = self.lines.len();
        let height = self.z.filter(|z| *z > self.section.clearance).unwrap_or(self.section.clearance);
        for order in &change.orders {
            match order {
                Order::Words(words) => {
                    let spelt: Vec<String> = words.split(' ').map(|word| self.spelt(word)).collect();
                    self.line(&spelt.join(" "));
                }
                Order::Comment(text) => self.comment(text),
                Order::Up(top) => self.lift_to(top.map_or(height, |top| top.max(height))),
                Order::Lost => self.z = None,
                Order::There => {
                    // Where a changer has left the cutter is not in the program.
                    let mut pen = self.pen();
                    let words = pen.draw(pen.nearest(to), &Shape::Line);
                    let code = self.code(0);
                    self.line(&format!("{code} {words}"));
                    self.at = to;
                }
                Order::Down([front, behind]) => {
                    let words = format!("{}{front} {}{behind}", self.code(0), self.z_text(height));
                    self.line(&words);
                    self.z = Some(height);
                }
            }
        }
        first..self.lines.len()
    }

    /// A code as the program spells its own.
    fn spelt(&self, word: &str) -> String {
        match word.as_bytes() {
            [letter @ (b'G' | b'M'), digit] if self.two_digits => {
                format!("{}0{}", char::from(*letter), char::from(*digit))
            }
            _ => word.to_owned(),
        }
    }

    /// G40 where G41 or G42 goes on behind the contour.
    fn end_compensation(&mut self) {
        if self.wall.take().is_some() {
            self.line("G40");
        }
    }

    fn travel(&mut self, to: [i64; 2]) {
        if to == self.at {
            return;
        }
        let mut pen = self.pen();
        let words = pen.draw(pen.nearest(to), &Shape::Line);
        let code = self.code(0);
        self.line(&format!("{code} {words}"));
        self.at = to;
    }

    fn pen(&self) -> Pen {
        Pen::new(self.at.map(|v| v as f64), &self.modal())
    }

    /// Down to a height as the program goes down; with `slowly` never at rapid below the height that the program comes to.
    fn go_down(&mut self, to: Position, slowly: bool) {
        let section = self.section;
        if let Some(height) = section.height.filter(|h| self.z.is_none_or(|z| *h < z) && *h > to) {
            self.step(&Step { rapid: true, z: height, like: section.moves.start });
        }
        let last = Step { rapid: false, z: to, like: section.parts[1][0] };
        for step in section.descent.iter().copied().chain([last]) {
            let step = Step { z: step.z.max(to), rapid: step.rapid && !slowly, ..step };
            if self.z.is_none_or(|z| step.z < z) {
                self.step(&step);
            }
        }
    }

    fn feed_of(&self, step: &Move, factor: f64) -> Result<String, Failure> {
        scaled(&step.modal, factor).ok_or_else(|| {
            let found = "the feed of the contour is computed, and every pass states it";
            self.text.refusal(P006, step.line, [found, "a feed of at most six decimals", P006.remedy])
        })
    }

    fn step(&mut self, step: &Step) {
        let z = self.z_text(step.z);
        let words = if step.rapid {
            format!("{} {z}", self.code(0))
        } else {
            let feed = self.feed_of(&self.text.moves[step.like], 1.0).ok().or_else(|| self.feed.clone());
            self.feed.clone_from(&feed);
            let feed = feed.map_or_else(String::new, |feed| format!(" F{feed}"));
            format!("{} {z}{feed}", self.code(1))
        };
        self.line(&words);
        self.z = Some(step.z);
    }

    /// Writes the cutting moves of a pass and gives the line of each, in the order of the program.
    fn pass(&mut self, turn: &Turn, first: bool) -> Result<Vec<usize>, Failure> {
        let moves = self.text.moves;
        let mut order: Vec<usize> = self.section.parts.iter().flatten().copied().collect();
        let before = if self.section.centre_path {
            vec![None; order.len()]
        } else {
            let earlier = self.section.moves.start.checked_sub(1).and_then(|i| moves[i].modal.wall);
            let walls = order.iter().map(|&i| moves[i].modal.wall);
            std::iter::once(earlier).chain(walls).take(order.len()).collect()
        };
        let mut walls: Vec<Option<Side>> = if turn.reversed {
            before.into_iter().map(|wall| wall.map(opposite)).collect()
        } else if self.section.centre_path {
            before
        } else {
            order.iter().map(|&i| moves[i].modal.wall).collect()
        };
        if turn.reversed {
            order.reverse();
            walls.reverse();
        }
        self.feed = None;
        let mut lines = Vec::new();
        let mut named = None;
        for (&i, wall) in order.iter().zip(walls) {
            let line = moves[i].line;
            let own = first && !turn.reversed && named.replace(line) != Some(line);
            lines.push(self.cut(&moves[i], turn, wall, own)?);
        }
        if turn.reversed {
            lines.reverse();
        }
        Ok(lines)
    }

    /// One cutting move; `own` is whether its line keeps block number and comments.
    fn cut(&mut self, step: &Move, turn: &Turn, wall: Option<Side>, own: bool) -> Result<usize, Failure> {
        let block = self.text.block(step.line);
        if own {
            self.lines.extend(block.comments().map(<[u8]>::to_vec));
        }
        let unknown = || Failure::Internal(format!("line {} does not cut", step.line));
        let curve = step.curve().ok_or_else(unknown)?;
        let [from, to] = [curve.start(), curve.end()].map(|p| [p.x.nm(), p.y.nm()]);
        let (shape, code) = match curve.shape() {
            CurveShape::Line => (Shape::Line, 1),
            CurveShape::Arc { centre, sweep } => {
                let counter_clockwise = (sweep.bits() > 0) != turn.reversed;
                let centre = [centre.x.nm() as f64, centre.y.nm() as f64];
                (Shape::Arc { centre, counter_clockwise }, if counter_clockwise { 3 } else { 2 })
            }
        };
        let mut words = String::new();
        if let Some(number) = block.number().filter(|_| own) {
            words += &format!("{} ", String::from_utf8_lossy(number));
        }
        words += &self.switch(wall);
        words += &self.code(code);
        let mut pen = self.pen();
        let target = if turn.reversed { from } else { to };
        words += &format!(" {}", pen.draw(pen.nearest(target), &shape));
        let feed = self.feed_of(step, turn.feed)?;
        if self.feed.as_ref() != Some(&feed) {
            words += &format!(" F{feed}");
        }
        self.feed = Some(feed);
        self.at = target;
        self.line(&words);
        Ok(self.lines.len() - 1)
    }

    /// The words that switch compensation, where it changes.
    fn switch(&mut self, wall: Option<Side>) -> String {
        if std::mem::replace(&mut self.wall, wall) == wall {
            return String::new();
        }
        let Some(side) = wall else { return "G40 ".to_owned() };
        let lines = (self.section.lines[0]..=self.section.lines[1]).map(|line| self.text.block(line));
        let offset = lines.filter(Block::switches_compensation_on).find_map(|block| block.offset_word());
        let offset = offset.map_or_else(String::new, |d| format!("{} ", String::from_utf8_lossy(d)));
        format!("G4{} {offset}", if side == Side::Right { 1 } else { 2 })
    }

    /// Behind a rapid: the motion that the next move relies on.
    fn restore_motion(&mut self) -> Result<(), Failure> {
        let Some(next) = self.text.moves.get(self.section.moves.end) else { return Ok(()) };
        let block = self.text.block(next.line);
        let named = next.modal.motion.is_some_and(|motion| block.names(motion));
        match next.motion_before {
            _ if named => Ok(()),
            None | Some(Motion::Traverse) => Ok(()),
            Some(Motion::Feed) => {
                let z = self.z.unwrap_or(self.section.clearance);
                let words = format!("{} {}", self.code(1), self.z_text(z));
                self.line(&words);
                Ok(())
            }
            Some(_) => {
                let found = "the move behind the contour relies on the code of its last line, and the last pass has begun there";
                let expected = "a G code on this line, or a last pass in the direction of the program";
                Err(self.text.refusal(P010, next.line, [found, expected, P010.remedy]))
            }
        }
    }

    /// Puts back place, feed, G91 and what acts behind the contour; whether the cutter stands higher than in the program.
    fn back(&mut self, change: Option<&Change>, changes: &mut Vec<(Range<usize>, Change)>) -> Result<bool, Failure> {
        let (section, moves) = (self.section, self.text.moves);
        let last = &moves[section.moves.end - 1];
        let home = place(last.to).ok_or_else(|| Failure::Internal("a contour to an unknown place".to_owned()))?;
        let mut lifted = false;
        if self.at != home || change.is_some() {
            self.rise(home);
            if let Some(change) = change {
                changes.push((self.change(change, home), change.clone()));
            }
            self.travel(home);
            lifted = section.rises;
            if !lifted && section.end_free == Offset::ZERO {
                let found = "the program goes on at the end of the contour at its depth, where the last pass has begun, or with another cutter";
                let expected = "a move up behind the contour, or a last pass in the direction of the program";
                return Err(self.text.refusal(P010, last.line, [found, expected, P010.remedy]));
            }
            if lifted {
                self.restore_motion()?;
            } else {
                self.go_down(section.z, false);
            }
        }
        if let Some(wall) = last.modal.wall.filter(|_| !section.centre_path)
            && self.wall != Some(wall)
        {
            let words = self.switch(Some(wall));
            self.line(words.trim_end());
        }
        let feed = self.feed_of(last, 1.0)?;
        if self.feed.as_ref() != Some(&feed) {
            self.line(&format!("F{feed}"));
        }
        if !last.modal.absolute {
            let code = self.code(91);
            self.line(&code);
        }
        let behind = self.text.block(section.lines[1]).functions(true);
        if !behind.is_empty() {
            let words: Vec<String> = behind.iter().map(|w| String::from_utf8_lossy(w).into_owned()).collect();
            self.line(&words.join(" "));
        }
        Ok(lifted)
    }
}

const fn opposite(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
    }
}
