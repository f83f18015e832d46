//! A program whose contours are cut in several passes: beside them it does the same, and every pass cuts what it has to.

use truepath_core::gcode::{Canon, Coolant, LineRange, Modal, Options, ToolLength};
use truepath_core::geometry::{Curve, Shape};
use truepath_core::units::Position;
use truepath_ground::units::float;

use super::super::feed;
use super::super::grid::Grid;
use super::facts::{Fact, What, facts};

/// Lines that several passes stand on.
#[derive(Clone, Debug)]
pub(in super::super) struct Replaced {
    /// In the original.
    pub(in super::super) original: LineRange,
    /// In the written program.
    pub(in super::super) written: LineRange,
    /// What has to be cut on them, in order.
    pub(in super::super) cuts: Vec<Cut>,
    /// The least height of moves from one pass to the next.
    pub(in super::super) clearance: Position,
    /// Whether the cutter is higher behind them than in the original.
    pub(in super::super) lifted: bool,
    /// Whether compensation by the radius was taken out of them.
    pub(in super::super) centre_path: bool,
    /// Where the cutter is changed, beside what the original does.
    pub(in super::super) changes: Vec<Changed>,
    /// The tool that stays in the spindle behind them until the original changes its own.
    pub(in super::super) mounted: Option<u32>,
}

/// A change of the cutter.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Changed {
    /// Its lines in the written program.
    pub(in super::super) lines: LineRange,
    /// The tool; `None` where it is mounted by hand.
    pub(in super::super) tool: Option<u32>,
    /// Whether its length offset is switched on.
    pub(in super::super) length: bool,
}

/// A move of a pass.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Cut {
    /// The line or arc of the original.
    pub(in super::super) curve: Curve,
    /// Whether it is cut from its end to its start.
    pub(in super::super) reversed: bool,
    /// Its height, nm.
    pub(in super::super) z_nm: i64,
    /// Its feed, as a factor of the programmed one.
    pub(in super::super) factor: f64,
    /// The modes of the original.
    pub(in super::super) modal: Modal,
}

/// Whether both programs do the same beside the replaced lines, and what they have to on them; the error says what differs.
pub(in super::super) fn same_beside(
    original: &[u8],
    written: &[u8],
    replaced: &[Replaced],
    options: Options<'static>,
) -> Result<(), String> {
    let centre_path = replaced.iter().any(|r| r.centre_path);
    let read =
        |text: &[u8]| facts(text, options, centre_path).map_err(|e| format!("line {} cannot be read: {e}", e.line));
    let (old, new) = (read(original)?, read(written)?);
    let (mut a, mut b) = (&old[..], &new[..]);
    let (mut lifted, mut mounted) = (false, None);
    for range in replaced {
        let (beside, inside, rest) = apart(a, range.original);
        let (beside_new, inside_new, rest_new) = apart(b, range.written);
        same(beside, beside_new, (lifted, mounted))?;
        passes(inside, inside_new, range)?;
        for changed in &range.changes {
            let own = new.iter().filter(|fact| changed.lines.contains(fact.line));
            let before = new.iter().take_while(|fact| !changed.lines.contains(fact.line));
            change(before, own.collect(), changed, range.clearance)
                .map_err(|what| format!("{what} of the change of the cutter on line {}", changed.lines.first))?;
        }
        (a, b, lifted, mounted) = (rest, rest_new, range.lifted, range.mounted);
    }
    same(a, b, (lifted, mounted))
}

/// On the lines of a change of the cutter: one change, or one stop, to the tool that is asked for with its own length; rapid ways alone, above
/// the clearance or where only the machine knows the height; behind it spindle and coolant as they were.
fn change<'f>(
    before: impl Iterator<Item = &'f Fact>,
    own: Vec<&'f Fact>,
    changed: &Changed,
    clearance: Position,
) -> Result<(), &'static str> {
    let (mut coolant, mut turning) = (Coolant::Off, None);
    for fact in before {
        if let What::Other(Canon::Coolant(now)) = fact.what {
            coolant = now;
        }
        turning = Some((fact.modal.spindle, fact.modal.speed));
    }
    let (mut last, mut tools, mut stops, mut lengths) = (coolant, Vec::new(), 0, Vec::new());
    for fact in &own {
        match fact.what {
            What::Comment(_) => {}
            What::Straight { rapid: true, from, to } => {
                let low = |z: Option<Position>| z.is_some_and(|z| z < clearance);
                let begun_low = low(from.z) && !fact.stands_still();
                if begun_low || low(to.z) || (to.z.is_none() && from.z.is_some()) {
                    return Err("the height");
                }
            }
            What::Other(Canon::Coolant(now)) => last = now,
            What::Other(Canon::ChangeTool(tool)) => tools.push(tool),
            What::Other(Canon::Stop { optional: false }) => stops += 1,
            What::Other(Canon::ToolLength(length)) => lengths.push(length),
            What::Other(Canon::Reference { axes: [false, false, true], .. }) => {}
            What::Other(Canon::MachineMove { to, rapid: true }) if to.point().is_none() => {}
            What::Other(Canon::SelectTool(_) | Canon::Spindle(_) | Canon::SpindleSpeed(_)) => {}
            _ => return Err("a step"),
        }
    }
    let behind = own.last().map(|fact| (fact.modal.spindle, fact.modal.speed));
    if last != coolant || behind != turning {
        return Err("spindle or coolant behind");
    }
    let of_tool = |length: &ToolLength| matches!(length, ToolLength::Table(of) if of.is_none() || *of == changed.tool);
    let (asked, by_hand) = (changed.tool.map(Some), changed.tool.is_none());
    if !tools.iter().copied().eq(asked) || lengths.len() != usize::from(changed.length) || !lengths.iter().all(of_tool)
    {
        return Err("tool or length");
    }
    let stopped = by_hand || !changed.length;
    if stops == usize::from(stopped) { Ok(()) } else { Err("the stop") }
}

/// The steps before some lines, on them, and behind.
fn apart(facts: &[Fact], lines: LineRange) -> (&[Fact], &[Fact], &[Fact]) {
    let first = facts.iter().position(|f| lines.contains(f.line)).unwrap_or(facts.len());
    let behind = facts.iter().rposition(|f| lines.contains(f.line)).map_or(first, |last| last + 1);
    (&facts[..first], &facts[first..behind], &facts[behind..])
}

/// Compares steps one by one; `lifted` is whether the first move begins higher than in the original, `mounted` the tool that is in the
/// spindle until the original changes its own.
fn same(old: &[Fact], new: &[Fact], (mut lifted, mut mounted): (bool, Option<u32>)) -> Result<(), String> {
    if old.len() != new.len() {
        return Err(format!("{} steps beside the passes have become {}", old.len(), new.len()));
    }
    for (old, new) in old.iter().zip(new) {
        let equal = old.what == new.what || (lifted && lifted_same(&old.what, &new.what));
        lifted &= !matches!(old.what, What::Straight { .. } | What::Arc { .. } | What::Other(Canon::Reference { .. }));
        if matches!(old.what, What::Other(Canon::ChangeTool(_))) {
            mounted = None;
        }
        let own = |modal: Modal| match mounted {
            Some(tool) if modal.tool == Some(tool) => {
                let selected = if modal.selected == Some(tool) { old.modal.selected } else { modal.selected };
                Modal { tool: old.modal.tool, selected, ..modal }
            }
            _ => modal,
        };
        if !equal || old.modal != own(new.modal) || old.number != new.number || old.block_delete != new.block_delete {
            return Err(format!("a step of line {} has changed (line {} as written)", old.line, new.line));
        }
    }
    Ok(())
}

/// Whether two steps differ in the height alone from which they begin.
fn lifted_same(old: &What, new: &What) -> bool {
    match (old, new) {
        (What::Straight { rapid: a, from, to }, What::Straight { rapid: b, from: other, to: end }) => {
            a == b && to == end && from.point() == other.point()
        }
        (
            What::Other(Canon::Reference { second: a, axes: p, via }),
            What::Other(Canon::Reference { second: b, axes: q, via: other }),
        ) => a == b && p == q && via.x == other.x && via.y == other.y,
        _ => false,
    }
}

/// On the replaced lines: the cuts in their order, links at the clearance, ways up and down where the cutter stands, and the
/// functions of the original.
fn passes(original: &[Fact], written: &[Fact], replaced: &Replaced) -> Result<(), String> {
    let functions = |facts: &[Fact]| -> Vec<String> {
        let function = |fact: &Fact| match &fact.what {
            What::Other(Canon::FeedRate(_) | Canon::Compensation { .. }) => None,
            What::Other(canon) => Some(format!("{canon:?}")),
            _ => None,
        };
        facts.iter().filter_map(function).collect()
    };
    let is_change = |fact: &Fact| replaced.changes.iter().any(|change| change.lines.contains(fact.line));
    let written: Vec<Fact> = written.iter().filter(|fact| !is_change(fact)).cloned().collect();
    if functions(original) != functions(&written) {
        return Err(format!(
            "the functions on lines {}-{} have changed",
            replaced.original.first, replaced.original.last
        ));
    }
    let mut wanted = replaced.cuts.iter();
    let lowest = replaced.cuts.iter().map(|cut| cut.z_nm).min();
    for fact in &written {
        let Some((from, to)) = fact.ends() else { continue };
        let fail = |what: &str| format!("{what} of line {} (as written)", fact.line);
        if fact.stands_still() {
            let deep = to.z.is_none_or(|z| Some(z.nm()) < lowest);
            if deep {
                return Err(fail("the depth"));
            }
        } else if let Some(curve) = fact.curve() {
            let cut = wanted.next().ok_or_else(|| fail("a cut too many, that"))?;
            if [from.z, to.z].map(|z| z.map(Position::nm)) != [Some(cut.z_nm); 2] {
                return Err(fail("the height"));
            }
            same_cut(&curve, cut, fact).map_err(fail)?;
        } else if [from.z, to.z].into_iter().any(|z| z.is_none_or(|z| z < replaced.clearance)) {
            return Err(fail("the height of the link"));
        }
    }
    if wanted.next().is_some() { Err("a pass has become shorter".to_owned()) } else { Ok(()) }
}

/// By how much the radius of an arc changes from its start to its end, nm: the circle that is read depends on the end it is
/// given from.
fn spiral(curve: &Curve) -> f64 {
    let Shape::Arc { centre, .. } = curve.shape() else { return 0.0 };
    (curve.start().distance(centre) - curve.end().distance(centre)).nm().abs() as f64
}

fn same_cut(curve: &Curve, cut: &Cut, fact: &Fact) -> Result<(), &'static str> {
    // A step of the program's numbers, and what the rounding of the one before leaves.
    let slack = 2.0 * Grid::of(fact.modal.units).step_nm();
    let (start, end) = if cut.reversed { (curve.end(), curve.start()) } else { (curve.start(), curve.end()) };
    let near =
        |a: truepath_core::geometry::Point, b: truepath_core::geometry::Point| a.distance(b).nm() as f64 <= slack;
    let bend = |curve: &Curve| curve.signed_radius().map_or(0.0, |r| 1e12 / r.nm() as f64);
    let sense = if cut.reversed { -1.0 } else { 1.0 };
    let straight = curve.signed_radius().is_none() == cut.curve.signed_radius().is_none();
    let middle = |curve: &Curve| curve.point(truepath_core::units::Real::HALF);
    if !near(start, cut.curve.start())
        || !near(end, cut.curve.end())
        || !straight
        || bend(curve) * sense * bend(&cut.curve) < 0.0
        || middle(curve).distance(middle(&cut.curve)).nm() as f64 > 4.0 * slack + spiral(&cut.curve)
    {
        return Err("the path");
    }
    let feeds = fact.modal.feed.zip(cut.modal.feed);
    let off = feeds.map(|(written, programmed)| (float(written) - float(programmed) * cut.factor).abs());
    if off.is_none_or(|off| off > if cut.factor == 1.0 { 1e-6 } else { feed::rounding(&fact.modal) }) {
        return Err("the feed");
    }
    let (a, b) = (&fact.modal, &cut.modal);
    let same = (a.units, a.plane, a.feed_mode, a.tool, a.work_offset, a.shifts)
        == (b.units, b.plane, b.feed_mode, b.tool, b.work_offset, b.shifts)
        && (a.speed, a.spindle, a.path, a.auxiliary, a.length_offset)
            == (b.speed, b.spindle, b.path, b.auxiliary, b.length_offset);
    if same { Ok(()) } else { Err("a mode") }
}
