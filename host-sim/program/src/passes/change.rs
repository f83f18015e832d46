//! The change to another cutter before the passes of a depth, and the change back: written as the program writes its own.
//!
//! | the program | what is written |
//! |---|---|
//! | changes tools (M6) | coolant and spindle off, up as the program goes up to change, T and M6, spindle, the place, G43 with H of the tool, coolant |
//! | changes none | the same with M0 in place of T and M6, and a comment that says what to mount |
//!
//! Changed is once: depths that follow each other with nothing cut between them keep the cutter, and the program's own is mounted
//! again where something is cut with it before the program's next change.

use std::ops::Range;

use truepath_core::gcode::{Canon, Coolant, Event, HostMemory, Interpreter, Options, Spindle, ToolLength};
use truepath_core::units::Position;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::units::float;

use super::super::survey::{Kind, Move};
use super::request::Cutter;
use super::section::{Section, Text};
use crate::codes::P011;

/// What a program does about its tools, and what is in force at a section.
#[derive(Clone, Debug, Default)]
pub(super) struct Customs {
    /// Lines with M6.
    changes: Vec<u32>,
    /// Whether T stands on a line before that of M6.
    apart: bool,
    /// Whether tools have names, not numbers.
    by_name: bool,
    /// Whether numbers of tools have two digits.
    two_digits: bool,
    /// The line with which it goes up to change, as it is written.
    retreat: Option<String>,
    /// The highest place of the program.
    highest: Option<Position>,
}

/// What is in force where a cutter is changed, and what has to be again.
#[derive(Clone, Copy, Debug, Default)]
struct Force {
    tool: Option<u32>,
    selected: Option<u32>,
    length: Option<ToolLength>,
    coolant: Option<Coolant>,
    spindle: Option<Spindle>,
    speed: Option<f64>,
}

/// The lines that change a cutter: words of a line, the way to the start, and comments, in order.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Order {
    /// A line of words.
    Words(String),
    /// A comment.
    Comment(String),
    /// Up to the highest place of the program, where that is higher.
    Up(Option<Position>),
    /// The height is not known behind this.
    Lost,
    /// Rapidly to the place that is next.
    There,
    /// Down to the clearance, with these words before and behind the height.
    Down([String; 2]),
}

/// What becomes of the cutter at a section.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    /// Before its first pass.
    pub(super) before: Option<Change>,
    /// Behind its last one.
    pub(super) behind: Option<Change>,
    /// Tool that the program does not know of while the section is cut, and behind it.
    pub(super) mounted: [Option<u32>; 2],
}

/// A change.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Change {
    pub(super) orders: Vec<Order>,
    /// The tool; `None` where it is mounted by hand.
    pub(super) tool: Option<u32>,
    /// Whether its length offset is switched on.
    pub(super) length: bool,
}

impl Customs {
    /// Of a program.
    pub(super) fn of(text: &Text<'_>, options: Options<'static>) -> Result<Self, Failure> {
        let mut customs = Self::default();
        let moves = text.moves.iter();
        customs.highest = moves.filter(|m| m.is_straight()).filter_map(|m| m.to.z).max();
        let mut named = 0;
        each(text, options, |line, canon| match canon {
            Canon::SelectTool(_) => {
                named = line;
                let digit = text.block(line).word(b'T').and_then(|word| text.source.bytes().get(word.span.start + 1));
                customs.two_digits |= digit == Some(&b'0');
            }
            Canon::ChangeTool(number) => {
                customs.apart |= named != line && named != 0;
                customs.by_name |= number.is_none();
                customs.changes.push(line);
            }
            Canon::Reference { axes: [false, false, true], .. } | Canon::MachineMove { rapid: true, .. }
                if customs.retreat.is_none() =>
            {
                customs.retreat = text.block(line).way_up();
            }
            _ => {}
        })?;
        Ok(customs)
    }

    /// What becomes of the cutter at each section; they are in the order of the program.
    pub(super) fn plan(
        &self,
        text: &Text<'_>,
        options: Options<'static>,
        sections: &[(&Section, Option<&Cutter>)],
    ) -> Result<Vec<Changes>, Failure> {
        let mut plan: Vec<Changes> = Vec::new();
        for (at, (section, cutter)) in sections.iter().enumerate() {
            let stays = plan.last().and_then(|before| before.mounted[1]);
            let Some(cutter) = cutter else {
                plan.push(Changes::default());
                continue;
            };
            let force = in_force(text, options, section.lines[0])?;
            let before =
                (stays != Some(cutter.number)).then(|| self.change(text, section, &force, cutter)).transpose()?;
            let next = sections.get(at + 1);
            let behind = self.is_needed(text.moves, section, next, cutter.number);
            let own = Cutter {
                number: force.tool.or(cutter.own).unwrap_or(0),
                own: None,
                words: "THE CUTTER OF THE PROGRAM".to_owned(),
            };
            if behind && own.number == 0 && !self.changes.is_empty() {
                let found = "the program does not say which cutter it has along this contour, and goes on with it";
                let help = "write T and M6 at the start of the program, or number under [tool] of the job";
                return Err(text.refusal(P011, section.lines[0], [found, "the number of its tool", help]));
            }
            let behind = behind.then(|| self.change(text, section, &force, &own)).transpose()?;
            let stays = behind.is_none() && !self.is_changed(section, next);
            let unknown = (!self.changes.is_empty()).then_some(cutter.number);
            plan.push(Changes { before, mounted: [unknown, Some(cutter.number).filter(|_| stays)], behind });
        }
        Ok(plan)
    }

    /// Whether the program changes its tool behind a section and before the next.
    fn is_changed(&self, section: &Section, next: Option<&(&Section, Option<&Cutter>)>) -> bool {
        let until = next.map_or(u32::MAX, |(next, _)| next.lines[0]);
        self.changes.iter().any(|line| (section.lines[1]..until).contains(line))
    }

    /// Whether the program goes on with its own cutter behind a section that another one has cut.
    fn is_needed(
        &self,
        moves: &[Move],
        section: &Section,
        next: Option<&(&Section, Option<&Cutter>)>,
        number: u32,
    ) -> bool {
        let change = self.changes.iter().copied().find(|line| *line > section.lines[1]).unwrap_or(u32::MAX);
        let next = next.filter(|(next, _)| next.lines[0] < change);
        let behind: Range<usize> = section.moves.end..next.map_or(moves.len(), |(next, _)| next.moves.start);
        let cuts = |m: &Move| !matches!(m.kind, Kind::Traverse | Kind::Away(_) | Kind::Origin) || m.in_cycle();
        let cut = moves[behind].iter().take_while(|m| m.line < change).any(cuts);
        cut || next.is_some_and(|(_, cutter)| cutter.is_none_or(|cutter| cutter.number != number))
    }

    /// The lines with which a cutter is mounted.
    fn change(&self, text: &Text<'_>, section: &Section, force: &Force, to: &Cutter) -> Result<Change, Failure> {
        let refused =
            |found: &str, expected: &str| Err(text.refusal(P011, section.lines[0], [found, expected, P011.remedy]));
        let by_hand = self.changes.is_empty();
        if self.by_name {
            return refused("the program calls its tools by name", "tools with numbers, T4 M6");
        }
        let tool = |number: u32| if self.two_digits { format!("{number:02}") } else { number.to_string() };
        let length = match force.length {
            _ if by_hand => None,
            None | Some(ToolLength::Off) => None,
            Some(ToolLength::Table(None)) => Some(String::new()),
            Some(ToolLength::Table(Some(own))) if Some(own) == force.tool => Some(format!(" H{}", tool(to.number))),
            Some(ToolLength::Table(Some(own))) => {
                let named = force.tool.map_or_else(|| "a tool without a number".to_owned(), |tool| format!("T{tool}"));
                let found = format!(
                    "the length of {named} stands in H{own}, so that nothing says in which H that of T{} stands",
                    to.number
                );
                return refused(&found, "length offsets with the numbers of their tools");
            }
            Some(ToolLength::InProgram) => {
                return refused(
                    "the length of the tool is a value in the program (G43.1)",
                    "G43 with H, the number of the tool",
                );
            }
        };
        let moves = &text.moves[section.moves.clone()];
        if !section.centre_path && moves.iter().any(|m| m.modal.wall.is_some()) {
            let found = "the control compensates the path with D of the program's cutter (G41, G42)";
            return refused(found, "the path of the cutter's centre");
        }
        let words = |text: &str| Order::Words(text.to_owned());
        let mut orders = vec![Order::Comment(format!("TRUEPATH CUTTER T{}, {}", to.number, to.words))];
        let coolant = force.coolant.filter(|coolant| *coolant != Coolant::Off);
        let spindle = force.spindle.filter(|spindle| *spindle != Spindle::Stopped);
        orders.extend(coolant.map(|_| words("M9")));
        orders.extend(spindle.map(|_| words("M5")));
        match &self.retreat {
            Some(line) => {
                orders.extend([words(line), Order::Lost]);
                orders.extend(line.contains("G91").then(|| words("G90")));
            }
            None => orders.push(Order::Up(self.highest)),
        }
        if by_hand {
            orders.push(Order::Comment(format!("MOUNT T{} WITH ITS TIP WHERE THAT OF THE LAST ONE WAS", to.number)));
            orders.push(words("M0"));
        } else {
            let both = [format!("T{}", tool(to.number)), "M6".to_owned()];
            orders.extend(if self.apart { both.map(Order::Words).to_vec() } else { vec![words(&both.join(" "))] });
            orders.push(Order::Lost);
            if length.is_none() {
                orders.push(Order::Comment(format!("THE PROGRAM HAS NO LENGTH OFFSET: SET Z FOR T{}", to.number)));
                orders.push(words("M0"));
            }
            // What the program has called up for its next change.
            let next = force.selected.filter(|next| force.tool != Some(*next));
            orders.extend(next.map(|next| Order::Words(format!("T{}", tool(next)))));
        }
        if let Some(spindle) = spindle {
            let speed = force.speed.map_or_else(String::new, |speed| format!("S{} ", (speed * 1e6).round() / 1e6));
            orders.push(Order::Words(format!("{speed}M{}", if spindle == Spindle::Clockwise { 3 } else { 4 })));
        }
        orders.push(Order::There);
        let [front, behind] = match &length {
            Some(number) => [" G43", number],
            None => ["", ""],
        };
        orders.push(Order::Down([front.to_owned(), behind.to_owned()]));
        orders.extend(coolant.map(|coolant| words(if coolant == Coolant::Mist { "M7" } else { "M8" })));
        Ok(Change { orders, tool: (!by_hand).then_some(to.number), length: length.is_some() })
    }
}

/// Every step of the program's own lines.
fn each(text: &Text<'_>, options: Options<'static>, mut step: impl FnMut(u32, Canon)) -> Result<(), Failure> {
    let mut memory = Box::new(HostMemory::new());
    let mut sink = |event: &Event<'_>| {
        if event.source.file == 0 {
            step(event.source.line, *event.canon);
        }
        Ok(())
    };
    let run =
        Interpreter::new(options).run_observed(text.source.bytes().into(), &mut memory.lend(), &mut sink, &mut |_| ());
    run.map(|_| ()).map_err(|error| InputError::of_program(text.source, &error).into())
}

/// What is in force before a line.
fn in_force(text: &Text<'_>, options: Options<'static>, before: u32) -> Result<Force, Failure> {
    let (mut force, mut reached) = (Force::default(), false);
    each(text, options, |line, canon| {
        reached |= line >= before;
        match canon {
            _ if reached => {}
            Canon::SelectTool(number) => force.selected = Some(number),
            Canon::ChangeTool(number) => force.tool = number,
            Canon::ToolLength(length) => force.length = Some(length),
            Canon::Coolant(coolant) => force.coolant = Some(coolant),
            Canon::Spindle(spindle) => force.spindle = Some(spindle),
            Canon::SpindleSpeed(speed) => force.speed = Some(float(speed)),
            _ => {}
        }
    })?;
    Ok(force)
}
