//! Between the interpreter and whoever takes its steps: moves become the moves of the cutter's centre.
//!
//! The end of a move is known when the next one is. Until then everything the program does waits: the move itself,
//! moves of the third axis, feeds, comments, M codes; then all of it goes on in its order. A corner's arc belongs to
//! the block after the corner. After G40 the next move leads straight from where the cutter stands to where the
//! program wants it; with [`StartUp::Next`] that is the next move in the plane.
//!
//! Limit: [`WAITING`] steps between two moves in the plane.

use heapless::Deque;

use super::{CompensationError, Cutter, CutterPath, Piece, Shape, StartUp};
use crate::{Axes, Canon, Modal, Plane, Source};
use truepath_units::geometry::{Curve, Point};

/// How many steps may wait for the end of a move, that move and the next corner included.
pub const WAITING: usize = 24;

/// A step of the program that may have to wait.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waiting<'p> {
    /// What happens.
    pub(crate) canon: Canon,
    /// Where it is written.
    pub(crate) source: Source,
    /// The modes in force.
    pub(crate) modal: Modal,
    /// The text that `source` lies in.
    pub(crate) text: &'p [u8],
}

/// The steps on their way through compensation.
#[derive(Debug, Default)]
pub(crate) struct CompensationStage<'p> {
    path: Option<CutterPath>,
    plane: Plane,
    start_up: StartUp,
    /// Where the cutter was left by G40, until the next move.
    beside: Option<Point>,
    queue: Deque<Waiting<'p>, WAITING>,
    /// How many steps at the front of the queue may go.
    ready: usize,
    /// Whether the front of what is not ready is a move in the plane without its end.
    open: bool,
}

impl<'p> CompensationStage<'p> {
    /// Whether steps pass unchanged.
    pub(crate) const fn is_idle(&self) -> bool {
        self.path.is_none() && self.beside.is_none()
    }

    /// G41 or G42 in a plane.
    pub(crate) fn start(&mut self, cutter: Cutter, plane: Plane, start_up: StartUp) {
        self.path = Some(CutterPath::new(cutter, start_up));
        (self.plane, self.start_up) = (plane, start_up);
    }

    /// G40 or the end of the program: what waits becomes ready.
    ///
    /// # Errors
    /// The cutter cannot reach the end of the last move.
    pub(crate) fn stop(&mut self) -> Result<(), CompensationError> {
        let Some(mut path) = self.path.take() else {
            return Ok(());
        };
        let last = path.finish()?;
        if let Some(piece) = last {
            self.release(piece)?;
            self.beside = Some(piece.to);
        }
        Ok(())
    }

    /// Gives a program place the plane coordinates at which G40 has left the cutter, where no move came since.
    pub(crate) fn name_place_left(&self, at: &mut Axes) {
        if let Some(beside) = self.beside {
            put(at, beside, self.plane);
        }
    }

    /// Takes it that the caller has named that place: the next move begins where it says.
    #[cfg(feature = "klartext")]
    pub(crate) fn forget_place_left(&mut self) {
        self.beside = None;
    }

    /// Takes a step; what may go on afterwards is [`Self::next`].
    ///
    /// # Errors
    /// The cutter cannot follow, or too much waits.
    pub(crate) fn accept(&mut self, mut step: Waiting<'p>) -> Result<(), CompensationError> {
        let Some(mut path) = self.path else {
            if let Some(from) = self.beside {
                self.leave(&mut step.canon, from)?;
            }
            self.push(step)?;
            self.ready = self.queue.len();
            return Ok(());
        };
        let Some(piece) = self.piece(&step.canon)? else {
            self.push(step)?;
            if !self.open {
                self.ready = self.queue.len();
            }
            return Ok(());
        };
        if piece.from == piece.to && piece.shape == Shape::Line {
            if path.is_before_entry() && self.start_up == StartUp::Next {
                // The start-up is that of the first move in the plane.
                self.push(step)?;
                self.ready = self.queue.len();
                return Ok(());
            }
            if path.is_before_entry() {
                let radius = path.cutter().radius;
                return Err(CompensationError::EntryTooShort { length: piece.from.distance(piece.to), radius });
            }
            return self.push(step);
        }
        let done = path.push(piece)?;
        self.path = Some(path);
        if let Some(finished) = done.finished {
            self.release(finished)?;
        }
        if let Some(corner) = done.corner {
            let canon = self.corner(&step.canon, corner)?;
            self.push(Waiting { canon, ..step })?;
            self.ready = self.queue.len();
        }
        self.open = true;
        self.push(step)
    }

    /// The next step that may go on.
    pub(crate) fn next(&mut self) -> Option<Waiting<'p>> {
        self.ready = self.ready.checked_sub(1)?;
        self.queue.pop_front()
    }

    fn push(&mut self, step: Waiting<'p>) -> Result<(), CompensationError> {
        self.queue.push_back(step).map_err(|_| CompensationError::TooMuchBetween { limit: WAITING })
    }

    /// The end of the open move is known: it gets its ends, what follows it its place.
    fn release(&mut self, piece: Piece) -> Result<(), CompensationError> {
        let plane = self.plane;
        for (i, step) in self.queue.iter_mut().enumerate().skip(self.ready) {
            if i == self.ready && self.open {
                step.canon = moved(step.canon, piece, plane)?;
            } else {
                let here = Piece { from: piece.to, to: piece.to, shape: Shape::Line };
                step.canon = moved(step.canon, here, plane)?;
            }
        }
        self.ready = self.queue.len();
        self.open = false;
        Ok(())
    }

    /// What a step draws in the plane; `None` when it does not move.
    fn piece(&self, canon: &Canon) -> Result<Option<Piece>, CompensationError> {
        let (from, to, shape) = match *canon {
            Canon::Traverse { from, to } | Canon::Feed { from, to } => (from, to, Shape::Line),
            Canon::Arc { from, to, centre, counter_clockwise, turns, .. } if self.plane == Plane::Xy => {
                (from, to, Shape::Arc { centre, counter_clockwise, turns })
            }
            Canon::PlaneArc { plane, from, to, centre, counter_clockwise, turns, .. } if plane == self.plane => {
                (from, to, Shape::Arc { centre, counter_clockwise, turns })
            }
            Canon::Plane(plane) if plane == self.plane => return Ok(None),
            Canon::Arc { .. }
            | Canon::PlaneArc { .. }
            | Canon::Plane(_)
            | Canon::WorkOffset(_)
            | Canon::Shift(_)
            | Canon::ToolLength(_)
            | Canon::ChangeTool(_)
            | Canon::PathControl(_)
            | Canon::Probe { .. }
            | Canon::Tap { .. }
            | Canon::Spline { .. }
            | Canon::MachineMove { .. }
            | Canon::Reference { .. } => return Err(CompensationError::Forbidden),
            _ => return Ok(None),
        };
        let (Some(from), Some(to)) = (in_plane(from, self.plane), in_plane(to, self.plane)) else {
            return Err(CompensationError::PlaceUnknown);
        };
        Ok(Some(Piece { from, to, shape }))
    }

    /// The step that goes round a corner, at the height where the step after it begins.
    fn corner(&self, next: &Canon, corner: Piece) -> Result<Canon, CompensationError> {
        let start = match *next {
            Canon::Traverse { from, .. }
            | Canon::Feed { from, .. }
            | Canon::Arc { from, .. }
            | Canon::PlaneArc { from, .. } => from,
            _ => return Err(CompensationError::Forbidden),
        };
        // A traverse has no way to follow an arc.
        let straight = match *next {
            Canon::Traverse { .. } => Canon::Traverse { from: start, to: start },
            _ => Canon::Feed { from: start, to: start },
        };
        let shape = if matches!(next, Canon::Traverse { .. }) { Shape::Line } else { corner.shape };
        moved(straight, Piece { shape, ..corner }, self.plane)
    }

    /// The first move after G40 begins where the cutter stands.
    fn leave(&mut self, canon: &mut Canon, beside: Point) -> Result<(), CompensationError> {
        // Where the start-up waits for a move in the plane, the end does too.
        if let Canon::Traverse { from, to } | Canon::Feed { from, to } = canon
            && self.start_up == StartUp::Next
            && in_plane(*from, self.plane) == in_plane(*to, self.plane)
        {
            put(from, beside, self.plane);
            put(to, beside, self.plane);
            return Ok(());
        }
        match canon {
            Canon::Traverse { from, .. }
            | Canon::Feed { from, .. }
            | Canon::Probe { from, .. }
            | Canon::Spline { from, .. }
            | Canon::Tap { from, .. } => put(from, beside, self.plane),
            Canon::Arc { .. } | Canon::PlaneArc { .. } => return Err(CompensationError::ExitArc),
            Canon::MachineMove { .. } | Canon::Reference { .. } => {}
            _ => return Ok(()),
        }
        self.beside = None;
        Ok(())
    }
}

/// The two coordinates of a place in a plane.
pub(crate) fn in_plane(at: Axes, plane: Plane) -> Option<Point> {
    let [first, second, _] = plane.axes();
    Some(Point { x: at.get(first)?, y: at.get(second)? })
}

/// Sets them.
pub(crate) fn put(at: &mut Axes, point: Point, plane: Plane) {
    let [first, second, _] = plane.axes();
    at.set(first, Some(point.x));
    at.set(second, Some(point.y));
}

/// A step whose way in the plane is `piece`; anything but a move is left as it is.
pub(crate) fn moved(canon: Canon, piece: Piece, plane: Plane) -> Result<Canon, CompensationError> {
    let (mut from, mut to, traverse) = match canon {
        Canon::Traverse { from, to } => (from, to, true),
        Canon::Feed { from, to } | Canon::Arc { from, to, .. } | Canon::PlaneArc { from, to, .. } => (from, to, false),
        other => return Ok(other),
    };
    put(&mut from, piece.from, plane);
    put(&mut to, piece.to, plane);
    let Shape::Arc { centre, counter_clockwise, turns } = piece.shape else {
        return Ok(if traverse { Canon::Traverse { from, to } } else { Canon::Feed { from, to } });
    };
    let radius = piece.from.distance(centre);
    let curve = Curve::arc(piece.from, piece.to, centre, counter_clockwise)
        .map_err(|_| CompensationError::ArcDistorted { arc: radius, radius })?;
    Ok(match plane {
        Plane::Xy => Canon::Arc { from, to, curve, centre, counter_clockwise, turns },
        _ => Canon::PlaneArc { plane, from, to, curve, centre, counter_clockwise, turns },
    })
}
