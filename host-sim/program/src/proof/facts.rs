//! What a program does, step by step, as the proof compares it.

use truepath_core::gcode::{
    Axes, Canon, Decimal, Event, GcodeError, HostMemory, Interpreter, KlartextBlock, Line, Modal, Motion, Options,
};
use truepath_core::geometry::Curve;

/// One step of a program.
#[derive(Clone, Debug)]
pub(super) struct Fact {
    /// Line, counted from 1; 0 for a line of another file.
    pub(super) line: u32,
    /// N.
    pub(super) number: Option<Decimal>,
    /// `/`.
    pub(super) block_delete: bool,
    pub(super) what: What,
    /// The line or arc it cuts along in the plane.
    curve: Option<Curve>,
    /// The modes in force, the motion left out: it may be written on another line.
    pub(super) modal: Modal,
}

/// What the step is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum What {
    /// A comment, with its bytes.
    Comment(Vec<u8>),
    /// G0 or G1.
    Straight { rapid: bool, from: Axes, to: Axes },
    /// G2 or G3.
    Arc { from: Axes, to: Axes, curve: Curve },
    /// Anything else.
    Other(Canon),
}

impl Fact {
    /// Start and end, of a move in program coordinates.
    pub(super) const fn ends(&self) -> Option<(Axes, Axes)> {
        match self.what {
            What::Straight { from, to, .. } | What::Arc { from, to, .. } => Some((from, to)),
            What::Comment(_) | What::Other(_) => None,
        }
    }
    /// Whether it is a straight move between two known points of the plane that are the same.
    pub(super) fn stands_still(&self) -> bool {
        match self.what {
            What::Straight { from, to, .. } => from.point().is_some() && from.point() == to.point(),
            _ => false,
        }
    }
    /// The line or arc it cuts along in the plane.
    pub(super) const fn curve(&self) -> Option<Curve> {
        self.curve
    }
    /// Whether it moves in the plane, to wherever.
    pub(super) fn travels(&self) -> bool {
        match self.what {
            What::Straight { .. } => !self.stands_still(),
            What::Arc { .. } => true,
            What::Comment(_) => false,
            What::Other(canon) => match canon {
                Canon::MachineMove { to, .. } => to.x.is_some() || to.y.is_some(),
                Canon::Reference { axes, .. } => axes[0] || axes[1],
                _ => false,
            },
        }
    }
}

/// All steps of a program; with `centre_path` apart from cutter compensation, which shows in the path of the centre.
pub(super) fn facts(program: &[u8], options: Options, centre_path: bool) -> Result<Vec<Fact>, GcodeError> {
    let mut facts = Vec::new();
    let mut memory = Box::new(HostMemory::new());
    let mut sink = |event: &Event<'_>| {
        let what = match *event.canon {
            // `;` at the end of a line says nothing.
            Canon::Comment(span) if span.len == 0 => return Ok(()),
            // A rounding that has become part of the path stands as a comment.
            Canon::Comment(span) if options.dialect.is_klartext() && is_corner(span.of(event.text)) => return Ok(()),
            Canon::Compensation { .. } if centre_path => return Ok(()),
            Canon::Comment(span) => What::Comment(span.of(event.text).to_vec()),
            Canon::Traverse { from, to } => What::Straight { rapid: true, from, to },
            Canon::Feed { from, to } => What::Straight { rapid: false, from, to },
            Canon::Arc { from, to, curve, .. } => What::Arc { from, to, curve },
            other => What::Other(other),
        };
        let mut modal = Modal { motion: None::<Motion>, ..*event.modal };
        if centre_path {
            modal = Modal { wall: None, radius_offset: None, compensated: false, ..modal };
        }
        let curve = match what {
            What::Arc { curve, .. } => Some(curve),
            What::Straight { rapid: false, from, to } => {
                from.point().zip(to.point()).and_then(|(from, to)| Curve::line(from, to))
            }
            _ => None,
        };
        facts.push(Fact {
            curve,
            line: if event.source.file == 0 { event.source.line } else { 0 },
            number: event.source.number,
            block_delete: event.source.block_delete,
            what,
            modal,
        });
        Ok(())
    };
    Interpreter::new(options).run_observed(program.into(), &mut memory.lend(), &mut sink, &mut |_| ())?;
    Ok(facts)
}

/// Whether a text is the block of a rounding or a chamfer.
fn is_corner(text: &[u8]) -> bool {
    KlartextBlock::of(Line { number: 1, start: 0, text }).is_ok_and(|block| block.statement.is_corner())
}
