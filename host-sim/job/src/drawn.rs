//! What a path under G41 or G42 is when the job does not say it: the outline of the part, or the path of the cutter's centre.
//!
//! At a control D decides, and D is not in the program. Taken wrongly, the wall is looked for a radius beside the part, and
//! a probe is driven into it. What the program shows, in this order:
//!
//! | sign | then it is |
//! |---|---|
//! | D0, or a comment that speaks of wear | the centre's |
//! | an inside arc tighter than the cutter: no control could follow an outline round it | the centre's |
//! | an entry move shorter than the radius: no control could take the offset along it | the centre's |
//! | an outside arc of the path tighter than the cutter: as a centre's path it would leave no wall | the outline |
//! | an earlier pass beside it at the allowance under one of the two readings, and not under the other | that reading |
//! | sharp outside corners: CAM systems roll the centre round them | the outline |
//! | outside arcs of the cutter's own radius | the centre's |
//!
//! Without a sign the user is asked.

use truepath_core::gcode::{Criteria, Found, KlartextBlock, LineRange, Lines, Role, Statement, Token, Words};
use truepath_core::geometry::{Block, Direction, FACET_TURN_LIMIT, Side};
use truepath_core::job::Compensation;
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

use crate::codes::J027;
use crate::feature::{Survey, comments};
use crate::job::JobFile;

/// What was found out, and what is said of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawn {
    /// The answer.
    pub compensation: Compensation,
    /// The sign.
    pub why: &'static str,
}

/// A path that turns by more than this much of the cutter's radius is not rounded, but meant.
const SAME: Real = Real::ratio(1, 100);

/// Finds out; `None` when the job says it or no finishing cut is compensated.
///
/// # Errors
/// `J027` when nothing shows it, with what the part would measure either way, and whatever is wrong with the program.
pub fn drawn(job: &JobFile, program: &Source) -> Result<Option<Drawn>, InputError> {
    if job.gives("tool.compensation") {
        return Ok(None);
    }
    let survey = Survey::read(job, program)?;
    let radius = Offset::from_nm(job.numbers.tool.diameter.nm() / 2);
    let tool = job.numbers.tool.number;
    let mine = |found: &&Found| {
        let run = &found.run;
        run.wall.is_some() && run.entry > 0 && tool.is_none_or(|tool| run.tool.is_none_or(|t| t == tool))
    };
    let Some(found) = survey.runs.iter().filter(mine).max_by_key(|found| found.run.length) else { return Ok(None) };
    let Some(wall) = found.run.wall else { return Ok(None) };
    let all = found.blocks(&survey.blocks);
    let end = all.len().saturating_sub(found.run.exit);
    let contour = all.get(found.run.entry..end).unwrap_or_default();
    let answer = |compensation, why| Ok(Some(Drawn { compensation, why }));
    let centre = |why| answer(Compensation::Centre, why);
    let outline = |why| answer(Compensation::Radius, why);
    if wear(program) {
        return centre("a comment or D0 says that D holds wear");
    }
    if led_by_control(program, found.run.lines) {
        return outline("APPR, DEP, RND or CHF shape it at the control, as a drawing does and no CAM system");
    }
    let arcs = |inside: bool| contour.iter().filter_map(move |block| towards_wall(block, wall, inside));
    if arcs(true).any(|r| r < radius - radius.scaled(SAME)) {
        return centre("an inside arc is tighter than the cutter, which could not follow it as an outline");
    }
    let entry = found.run.entry.checked_sub(1).and_then(|last| all.get(last)).map(|block| block.curve.length());
    if entry.is_some_and(|length| length < radius - radius.scaled(SAME)) {
        return centre("the entry move is shorter than the cutter's radius");
    }
    if arcs(false).any(|r| r < radius - radius.scaled(SAME)) {
        return outline(
            "an outside arc is tighter than the cutter, which would leave no wall as the path of its centre",
        );
    }
    match [Compensation::Centre, Compensation::Radius].map(|reading| leaves_allowance(job, program, reading)) {
        [true, false] => return centre("the pass before it leaves the allowance beside this path"),
        [false, true] => return outline("the pass before it leaves the allowance a cutter's radius beside this path"),
        _ => {}
    }
    if sharp_corners(contour, wall) {
        return outline("it has sharp outside corners, round which the path of a centre would be rolled");
    }
    if arcs(false).any(|r| r < radius + radius.scaled(SAME)) {
        return centre("it rolls round outside corners with the cutter's own radius");
    }
    let [width, depth] = extent(contour);
    let twice = mm(radius) * 2.0;
    let beside = |sign: f64| format!("{:.3} mm by {:.3} mm", width + sign * twice, depth + sign * twice);
    let sign = if encloses_wall(contour, wall) { -1.0 } else { 1.0 };
    let found_text = format!(
        "lines {}-{} are cut under {}, and the program does not show whether they are the part's outline (the wall measures {}) or the path of the cutter's centre (it measures {})",
        found.run.lines.first,
        found.run.lines.last,
        if wall == Side::Right { "G41" } else { "G42" },
        beside(0.0),
        beside(sign)
    );
    let line = Lines::new(program.bytes()).find(|l| l.number == found.run.lines.first).map(|l| l.span());
    let span = line.map_or(0..0, |span| span.start..span.end());
    let unit = Unit::at(program.bytes(), span.start);
    Err(J027.error(found_text, "compensation in [tool] of the job").told_in(unit).at(program, span))
}

/// Whether a conversational program leads to the contour or rounds its corners by blocks of their own.
fn led_by_control(program: &Source, lines: LineRange) -> bool {
    let blocks =
        Lines::new(program.bytes()).filter(|line| lines.first <= line.number + 1 && line.number <= lines.last + 1);
    let mut statements = blocks.filter_map(|line| KlartextBlock::of(line).ok()).map(|block| block.statement);
    statements.any(|s| s.is_corner() || matches!(s, Statement::Approach(..) | Statement::Depart(..)))
}

/// Whether D0 or a comment says that D holds wear.
fn wear(program: &Source) -> bool {
    Lines::new(program.bytes()).any(|line| {
        let tokens: Vec<Token> = Words::new(line).map_while(Result::ok).collect();
        let comments = comments(line).iter().any(|(_, body)| {
            let text = String::from_utf8_lossy(body.of(program.bytes())).to_ascii_uppercase();
            text.split(|c: char| !c.is_ascii_alphabetic()).any(|word| word == "WEAR")
        });
        let is = |letter: u8, values: &[i64]| {
            let exactly = |value: truepath_core::gcode::Decimal| value.exactly_times(1);
            tokens.iter().any(|token| {
                matches!(token, Token::Word(w) if w.letter == letter
                    && w.value.and_then(exactly).is_some_and(|v| values.contains(&v)))
            })
        };
        comments || (is(b'G', &[41, 42]) && is(b'D', &[0]))
    })
}

/// The radius of an arc that turns with the wall on its inner side, or with the free side there (an inside corner of the
/// part).
fn towards_wall(block: &Block, wall: Side, inside_corner: bool) -> Option<Offset> {
    let radius = block.curve.signed_radius()?;
    let wall_within = (radius > Offset::ZERO) == (wall == Side::Left);
    (wall_within != inside_corner).then(|| radius.abs())
}

fn joints(contour: &[Block]) -> impl Iterator<Item = (Direction, Direction)> + '_ {
    contour.iter().zip(contour.iter().skip(1)).map(|(a, b)| (a.curve.end_heading(), b.curve.start_heading()))
}

fn sharp_corners(contour: &[Block], wall: Side) -> bool {
    let outside = |turn: Real| (turn > Real::ZERO) == (wall == Side::Left);
    joints(contour).any(|(from, to)| from.dot(to) < FACET_TURN_LIMIT && outside(from.cross(to)))
}

/// Whether the path, all turns together, goes round the wall.
fn encloses_wall(contour: &[Block], wall: Side) -> bool {
    turns_left(contour) == (wall == Side::Left)
}

/// Whether the path, all turns together, turns left.
pub(crate) fn turns_left(contour: &[Block]) -> bool {
    let corners: Real = joints(contour).fold(Real::ZERO, |sum, (from, to)| sum + from.angle_to(to));
    let arcs = contour.iter().fold(Real::ZERO, |sum, block| match block.curve.shape() {
        truepath_core::geometry::Shape::Arc { sweep, .. } => sum + sweep,
        truepath_core::geometry::Shape::Line => sum,
    });
    corners + arcs > Real::ZERO
}

/// Width and depth of a path, mm.
fn extent(contour: &[Block]) -> [f64; 2] {
    let places = contour.iter().flat_map(|b| (0..=4).map(|k| b.curve.point(Real::ratio(k, 4))));
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for place in places {
        for (axis, value) in [place.x, place.y].into_iter().enumerate() {
            let value = value.nm() as f64 / 1e6;
            (low[axis], high[axis]) = (low[axis].min(value), high[axis].max(value));
        }
    }
    [high[0] - low[0], high[1] - low[1]].map(|v| v.max(0.0))
}

/// Whether, read so, an earlier pass lies beside a finishing one at the allowance of the job.
fn leaves_allowance(job: &JobFile, program: &Source, reading: Compensation) -> bool {
    let mut job = job.clone();
    job.numbers.tool.compensation = reading;
    let Ok(survey) = Survey::read(&job, program) else { return false };
    let numbers = &job.numbers;
    let criteria =
        Criteria { tool: numbers.tool.number, wall: numbers.wall, diameter: numbers.tool.diameter, named: false };
    let mut runs = survey.runs.clone();
    survey.sort(&mut runs, &criteria);
    let near = Offset::from_um(20).max(Offset::from_nm(numbers.allowance.nm() / 10));
    runs.iter().any(|found| match found.role {
        Role::Rough { gap, parallel: true, .. } => (gap - numbers.allowance).abs() <= near,
        _ => false,
    })
}
