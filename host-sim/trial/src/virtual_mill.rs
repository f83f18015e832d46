//! The plant in the service of a pass: nominal path and cut handed over in float, and nothing of the model.

use truepath_core::gcode::Spindle;
use truepath_core::geometry::{Block, Point, Shape, Side};
use truepath_core::job::ZReference;
use truepath_core::rewrite::Flags;
use truepath_core::units::Real;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::units::{float, mm};
use truepath_job::feature::Survey;
use truepath_job::levels;
use truepath_job::pass::{KnownStock, Pass, PathBuffer};
use truepath_plant as plant;
use truepath_plant::{Milled, PlantError};

use crate::codes::{L003, L004};
use crate::probing::{Control, Wall, Xy};
use crate::recorded;
use crate::replay::Placement;
use crate::setpoints::{Frame, Row, Setpoints};

pub(crate) fn coordinates(p: Point) -> [f64; 2] {
    [p.x.nm() as f64 / 1e6, p.y.nm() as f64 / 1e6]
}

pub(crate) fn refused(error: &PlantError) -> Failure {
    L003.error(error.to_string(), "").into()
}

/// The nominal path of a pass for the plant.
fn path(pass: &Pass) -> Result<plant::Path, PlantError> {
    let segments: Vec<plant::Segment> = pass
        .blocks
        .iter()
        .map(|block| {
            let (from, to) = (coordinates(block.curve.start()), coordinates(block.curve.end()));
            match block.curve.shape() {
                Shape::Line => plant::Segment::Line { from, to },
                Shape::Arc { centre, sweep } => {
                    plant::Segment::Arc { from, to, centre: coordinates(centre), ccw: sweep > Real::ZERO }
                }
            }
        })
        .collect();
    let side = match pass.core.setup.wall {
        Side::Left => plant::Side::Left,
        Side::Right => plant::Side::Right,
    };
    plant::Path::new(&segments, side, 0.1)
}

/// The cut of a pass for the plant. Stock that was touched is its stock where the machine says nothing of how that is uneven:
/// otherwise the machine's is the truth, and touches are what is known of it. So is what roughing leaves: the machine mills that as well.
fn cut(pass: &Pass, path: &plant::Path, machine: &plant::Machine) -> Result<plant::Cut, Failure> {
    let surface = match (&pass.surface, &pass.stock) {
        (Some(surface), _) => Some(surface.points().to_vec()),
        (None, Some(KnownStock::Roughed(_))) if machine.has_even_stock() => Some(stock_line(&roughed(pass, machine)?)?),
        (None, Some(_)) if machine.has_even_stock() => Some(stock_line(pass)?),
        (None, _) => None,
    };
    Ok(cut_over(pass, path, surface))
}

/// The cut of a pass for the plant, over a surface or even stock.
fn cut_over(pass: &Pass, path: &plant::Path, surface: Option<Vec<plant::Point>>) -> plant::Cut {
    let setup = &pass.core.setup;
    let first = pass.blocks.first().map_or(0.0, |b| float(b.feed));
    let changes = pass.blocks.windows(2).filter(|w| w[0].feed != w[1].feed);
    plant::Cut {
        radius_mm: mm(setup.radius),
        teeth: setup.teeth.into(),
        helix_deg: float(setup.helix_deg),
        axial_depth_mm: float(setup.axial_depth),
        feed_mm_per_min: first,
        feed_changes: changes
            .map(|w| plant::FeedChange { from_s_mm: mm(w[1].s), feed_mm_per_min: float(w[1].feed) })
            .collect(),
        spindle_rpm: float(setup.spindle_rpm),
        allowance_mm: mm(setup.allowance),
        spindle: match pass.core.contour.spindle {
            Spindle::CounterClockwise => plant::Spindle::CounterClockwise,
            Spindle::Clockwise | Spindle::Stopped => plant::Spindle::Clockwise,
        },
        surface,
        // A path that runs on into itself is cut as if it had no beginning.
        memory_mm: path.runs_on().then_some(3.0),
    }
}

/// A pass over what the machine leaves where it mills the roughing as well: each run beside the contour, over what the paths before it leave.
fn roughed(pass: &Pass, machine: &plant::Machine) -> Result<Pass, Failure> {
    if !pass.is_roughed_by_its_cutter() {
        return Ok(pass.clone());
    }
    let mut told = Vec::new();
    for number in pass.roughing_runs()? {
        // A run that is no contour is taken as it is programmed.
        let Ok(rough) = pass.roughed_by(number) else { continue };
        let path = nominal(&rough)?;
        let milled = plant::mill(&path, &cut_over(&rough, &path, Some(stock_line(&rough)?)), machine, None);
        let errors = milled.map_err(|e| refused(&e))?.mean_errors();
        let mut buffer = PathBuffer::default();
        let sampled = rough.sample(&mut buffer)?;
        let beside = |index: usize| {
            let s_mm = mm(sampled.samples().get(index)?.s);
            errors.get(path.index_at(s_mm)).filter(|error| error.is_finite()).map(|error| (index, *error))
        };
        let contour = sampled.first()..sampled.first() + sampled.count();
        told.push(rough.pushed(&sampled, contour.filter_map(beside)));
    }
    pass.over_pushed(told).map(|(pass, _)| pass)
}

/// The stock of a pass along its contour.
fn stock_line(pass: &Pass) -> Result<Vec<plant::Point>, Failure> {
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let contour = &path.samples()[path.first()..path.first() + path.count()];
    Ok(contour.iter().filter(|sample| sample.on_surface).map(|sample| coordinates(sample.stock)).collect())
}

/// The nominal path and the cut of a pass for the plant.
pub(crate) fn path_and_cut(pass: &Pass, machine: &plant::Machine) -> Result<(plant::Path, plant::Cut), Failure> {
    let path = nominal(pass)?;
    let cut = cut(pass, &path, machine)?;
    Ok((path, cut))
}

/// The nominal path of a pass for the plant.
pub(crate) fn nominal(pass: &Pass) -> Result<plant::Path, Failure> {
    path(pass).map_err(|e| refused(&e))
}

/// Who made a wall.
#[derive(Debug)]
pub enum Made {
    /// One pass, alike at every depth of its feature.
    Pass(Box<Milled>),
    /// All runs of a program.
    Part(Box<plant::Part>),
}

/// Mills a pass along its nominal path, or along commanded centres.
///
/// # Errors
/// What the plant refuses.
pub fn mill(pass: &Pass, machine: &plant::Machine, commanded: Option<&[plant::Point]>) -> Result<Milled, Failure> {
    let (path, cut) = path_and_cut(pass, machine)?;
    plant::mill(&path, &cut, machine, commanded).map_err(|e| refused(&e))
}

/// Mills a pass with a corrected program: along its path and at its feeds.
///
/// # Errors
/// What the plant refuses, and whatever is wrong with the program.
pub fn mill_program(pass: &Pass, machine: &plant::Machine, text: &[u8]) -> Result<Milled, Failure> {
    let blocks = contour(pass, text)?;
    let (path, mut cut) = path_and_cut(pass, machine)?;
    if pass.job.numbers.cut.feed_mm_per_min.is_none() {
        (cut.feed_mm_per_min, cut.feed_changes) = feeds(&path, &blocks);
    }
    plant::mill(&path, &cut, machine, Some(&centres(&blocks))).map_err(|e| refused(&e))
}

/// Mills a pass along the path a controller was recorded on, at the feeds it had there.
///
/// # Errors
/// What the plant refuses, and a recording without such a pass.
pub fn mill_recorded(
    pass: &Pass,
    machine: &plant::Machine,
    setpoints: &Setpoints,
    placement: &Placement,
) -> Result<(Milled, recorded::Facts), Failure> {
    let (path, mut cut) = path_and_cut(pass, machine)?;
    let z_mm = pass.core.contour.z.nm() as f64 / 1e6;
    let found = recorded::cut_path(setpoints, placement, &path, &cut, z_mm)?;
    (cut.feed_mm_per_min, cut.feed_changes) = (found.feed_mm_per_min, found.feed_changes);
    let milled = plant::mill(&path, &cut, machine, Some(&found.centre)).map_err(|e| refused(&e))?;
    Ok((milled, found.facts))
}

/// Mills a pass with another program of the same cut, as a control would run it: of all that the program does at the
/// depth of the pass, what goes along its contour is cut.
///
/// Unlike [`mill_program`] this asks nothing of where the program has its contour: it may be one that a correction gave
/// other lines, leads and blocks.
///
/// # Errors
/// What the plant refuses, whatever is wrong with the program, and one without such a pass.
pub fn mill_executed(pass: &Pass, machine: &plant::Machine, program: &Source) -> Result<Milled, Failure> {
    let survey = Survey::read(&pass.job, program)?;
    let fastest = pass.blocks.iter().map(|b| float(b.feed)).fold(1.0, f64::max);
    // Finer than the shortest block matters: a tick is a tenth of a millimetre.
    let period_ns = (TICK_MM / fastest * 60e9).round() as i64;
    let mut rows = Vec::new();
    for run in &survey.runs {
        let Some(z) = run.run.z.filter(|z| (z.nm() - pass.core.contour.z.nm()).abs() <= SAME_DEPTH_NM) else {
            continue;
        };
        // The ticks go on over the ends of blocks: one that began anew with every block would slow down in short ones.
        let mut next_ns = 0.0;
        for block in run.blocks(&survey.blocks) {
            // What the job says of the feed goes for the corrected program as for its own.
            let feed = pass.job.numbers.cut.feed_mm_per_min.unwrap_or(block.feed);
            let length_ns = mm(block.curve.length()) / float(feed).max(fastest / SLOWEST) * 60e9;
            while next_ns < length_ns {
                let share = Real::from_bits((next_ns / length_ns * 4_294_967_296.0) as i64);
                rows.push(row(block.curve.point(share), z.nm()));
                next_ns += period_ns as f64;
            }
            next_ns -= length_ns;
        }
        // A correction may end a contour short of its nominal end, which a recording has to pass.
        if let [.., before, end] = rows[..] {
            rows.extend((1..=BEYOND_TICKS).map(|k| beyond(before, end, k)));
        }
        // Between two runs the cutter is lifted.
        rows.extend(rows.last().copied().map(|last: Row| Row { position_nm: lifted(last.position_nm), ..last }));
    }
    let setpoints = Setpoints { frame: Frame::Program, start_ns: 0, period_ns, rows };
    mill_recorded(pass, machine, &setpoints, &Placement::default()).map(|(milled, _)| milled)
}

/// A tick of the control at the greatest feed, mm.
const TICK_MM: f64 = 0.05;
/// A block without F, or a thousand times slower than the pass, would hold as many rows as memory has room for.
const SLOWEST: f64 = 1000.0;
/// Depths nearer to each other than this are one, nm.
const SAME_DEPTH_NM: i64 = 20_000;

/// Ticks that a run is drawn out at its end.
const BEYOND_TICKS: i64 = 20;

/// The row `ticks` after the last two, straight on.
const fn beyond(before: Row, end: Row, ticks: i64) -> Row {
    let ([x0, y0, _], [x, y, z]) = (before.position_nm, end.position_nm);
    Row { position_nm: [x + (x - x0) * ticks, y + (y - y0) * ticks, z], ..end }
}

const fn lifted([x, y, z]: [i64; 3]) -> [i64; 3] {
    [x, y, z + 10_000_000]
}

const fn row(point: Point, z_nm: i64) -> Row {
    let flags = Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED);
    Row { position_nm: [point.x.nm(), point.y.nm(), z_nm], spindle_rpm: None, flags, frame_crc: None, disarm: false }
}

/// Touches the walls of a part by executing a probing program beside them, and gives the file that the machine would have
/// written.
///
/// # Errors
/// `L004` for a program that cannot be executed, or that drives the ball into a wall.
pub fn touch(walls: &[(&Pass, &Made)], program: &Source) -> Result<String, Failure> {
    let (mut felt, mut levels) = (Vec::new(), Vec::new());
    for (pass, made) in walls {
        match made {
            Made::Pass(milled) => {
                let tip = pass.core.contour.z.nm() as f64 / 1e6;
                let tips = std::iter::once(0.0).chain(levels::alike(pass)?.into_iter().map(mm));
                let tips = tips.map(|above| tip + above).collect();
                felt.push(plant::Felt::new(milled, tip));
                levels.push(Levels { tips, depth: float(pass.core.setup.axial_depth) });
            }
            // Its wall is known at every depth.
            Made::Part(part) => {
                let [bottom, top] = part.height_mm();
                felt.push(plant::Felt::of_part(part));
                levels.push(Levels { tips: vec![bottom], depth: top - bottom });
            }
        }
    }
    let Some((any, _)) = walls.first() else { return Err(Failure::Internal("no wall to be touched".to_owned())) };
    executed(any, felt, levels, program)
}

/// Touches the stock of a part before any of its passes, as [`touch`] does its walls.
///
/// # Errors
/// As [`touch`].
pub fn touch_stock(walls: &[Pass], machine: &plant::Machine, program: &Source) -> Result<String, Failure> {
    let Some(any) = walls.first() else { return Err(Failure::Internal("no stock to be touched".to_owned())) };
    let (mut stocks, mut levels) = (Vec::new(), Vec::new());
    for pass in walls {
        let (path, cut) = path_and_cut(pass, machine)?;
        stocks.push(plant::RawStock::new(&path, &cut, machine));
        let tips = pass.plan.iter().flat_map(|plan| &plan.passes).filter_map(|depth| depth.z);
        let tips: Vec<f64> = tips.chain([pass.core.contour.z]).map(|z| z.nm() as f64 / 1e6).collect();
        let bottom = tips.iter().copied().fold(f64::INFINITY, f64::min);
        let top = tips.iter().copied().fold(f64::NEG_INFINITY, f64::max) + cut.axial_depth_mm;
        levels.push(Levels { tips: vec![bottom], depth: top - bottom });
    }
    executed(any, stocks.iter().map(plant::Felt::of_stock).collect(), levels, program)
}

/// Executes a probing program beside walls.
fn executed(any: &Pass, felt: Vec<plant::Felt<'_>>, levels: Vec<Levels>, program: &Source) -> Result<String, Failure> {
    let probe = any.job.require_probe()?;
    let ball = 0.5 * mm(probe.ball_diameter);
    let centre_above = if probe.z_reference == ZReference::Tip { ball } else { 0.0 };
    let mut beside = Beside { felt, levels, centre_above };
    let text = String::from_utf8_lossy(program.bytes());
    let printed = Control::new(&mut beside, ball).run(&text);
    printed.map(|p| p.file()).map_err(|why| L004.error(why, "").in_file(program.name().as_ref()).into())
}

/// Depths at which a wall was cut alike: each has the wall of the one that was milled, as high above its own tip.
struct Levels {
    /// Z of the tips; the first is that of the depth that was milled.
    tips: Vec<f64>,
    depth: f64,
}

impl Levels {
    /// Z of the same place on the depth that was milled.
    fn milled(&self, z: f64) -> f64 {
        let of = self.tips.iter().find(|tip| (0.0..=self.depth).contains(&(z - *tip)));
        let milled = self.tips.first().copied().unwrap_or_default();
        of.map_or(z, |tip| z - tip + milled)
    }
    fn top(&self) -> f64 {
        self.tips.iter().copied().fold(f64::NEG_INFINITY, f64::max) + self.depth
    }
}

/// Milled walls as the control of a probing program meets them.
struct Beside<'m> {
    felt: Vec<plant::Felt<'m>>,
    /// The depths of each.
    levels: Vec<Levels>,
    /// The ball's centre over what the program calls Z, mm.
    centre_above: f64,
}

impl Wall for Beside<'_> {
    fn top(&self) -> f64 {
        self.levels.iter().map(Levels::top).fold(f64::NEG_INFINITY, f64::max) - self.centre_above
    }
    fn meets(&mut self, z: f64, from: Xy, to: Xy, radius: f64) -> Option<f64> {
        let z = z + self.centre_above;
        if let ([only], [levels]) = (&mut self.felt[..], &self.levels[..]) {
            return only.meets(levels.milled(z), from, to, radius);
        }
        // On which side of a wall a place lies is known beside it only: of several the nearest tells.
        let walls = self.felt.iter_mut().zip(&self.levels);
        let away: Vec<f64> = walls.map(|(felt, levels)| felt.distance_mm(levels.milled(z), from)).collect();
        let nearest = away.iter().copied().fold(f64::INFINITY, f64::min);
        let walls = self.felt.iter_mut().zip(&self.levels).zip(away);
        let met = walls.filter(|((_, levels), _)| z < levels.top()).filter_map(|((felt, levels), away)| {
            let share = felt.meets(levels.milled(z), from, to, radius)?;
            (share > 0.0 || away <= radius.max(nearest)).then_some(share)
        });
        met.min_by(f64::total_cmp)
    }
    fn distance(&mut self, z: f64, point: Xy) -> f64 {
        let z = z + self.centre_above;
        let walls = self.felt.iter_mut().zip(&self.levels);
        walls.map(|(felt, levels)| felt.distance_mm(levels.milled(z), point)).fold(f64::INFINITY, f64::min)
    }
    fn off(&mut self, at: [f64; 3], way: Xy) -> f64 {
        self.felt.first_mut().map_or(0.0, |felt| felt.off_mm(at, way))
    }
}

/// How far beyond the length of a block its end is looked for, mm.
const DRIFT_MM: f64 = 2.0;

/// The feed at the start, and where it changes along the nominal path.
fn feeds(path: &plant::Path, blocks: &[Block]) -> (f64, Vec<plant::FeedChange>) {
    let mut at = 0;
    let mut feed = blocks.first().map_or(0.0, |b| float(b.feed));
    let first = feed;
    let mut changes = Vec::new();
    for block in blocks {
        if float(block.feed) != feed {
            feed = float(block.feed);
            changes.push(plant::FeedChange { from_s_mm: path.s_mm[at], feed_mm_per_min: feed });
        }
        // Where the block ends: the path may come near that place again later, so only a stretch onwards is looked at.
        let end = coordinates(block.curve.end());
        let off = |k: &usize| (path.centre[*k][0] - end[0]).hypot(path.centre[*k][1] - end[1]);
        let reach = path.s_mm[at] + 1.1 * mm(block.curve.length()) + DRIFT_MM;
        let stretch = (at..path.s_mm.len()).take_while(|k| path.s_mm[*k] <= reach);
        at = stretch.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(at);
    }
    (first, changes)
}

/// Touches a milled part and writes the file LinuxCNC's PROBEOPEN would.
///
/// # Errors
/// What the plant refuses.
pub fn probe(pass: &Pass, milled: &Milled, places_mm: &[f64], levels: &[f64], ball_mm: f64) -> Result<String, Failure> {
    probe_shifted(pass, milled, places_mm, levels, ball_mm, [0.0; 2])
}

/// The same after the datum has moved by `datum_mm` in x and y since the part was cut: every reading is off by that.
///
/// # Errors
/// What the plant refuses.
pub fn probe_shifted(
    pass: &Pass,
    milled: &Milled,
    places_mm: &[f64],
    levels: &[f64],
    ball_mm: f64,
    datum_mm: plant::Point,
) -> Result<String, Failure> {
    let plan = plant::ProbePlan {
        s_mm: places_mm.to_vec(),
        levels: levels.to_vec(),
        ball_diameter_mm: ball_mm,
        tip_z_mm: pass.core.contour.z.nm() as f64 / 1e6,
    };
    let mut touches = plant::probe(milled, &plan).map_err(|e| refused(&e))?;
    for touch in &mut touches {
        for (place, shift) in touch.ball_centre.iter_mut().zip(datum_mm) {
            *place += shift;
        }
    }
    Ok(plant::probeopen_text(&touches))
}

/// The commanded centres of a corrected program: the contour moves, sampled finely.
///
/// # Errors
/// Whatever is wrong with the program.
pub fn commanded(pass: &Pass, text: &[u8]) -> Result<Vec<plant::Point>, Failure> {
    Ok(centres(&contour(pass, text)?))
}

/// The contour of a corrected program.
fn contour(pass: &Pass, text: &[u8]) -> Result<Vec<Block>, Failure> {
    let source = Source::new(format!("{} (corrected)", pass.program.name()), text.to_vec());
    Ok(truepath_job::pass::read_blocks(&source, pass.job.numbers.program_options())?.0)
}

fn centres(blocks: &[Block]) -> Vec<plant::Point> {
    let mut points = Vec::new();
    for block in blocks {
        let pieces = (mm(block.curve.length()) / 0.02).ceil().max(1.0) as i64;
        let skip = i64::from(!points.is_empty());
        points.extend((skip..=pieces).map(|k| coordinates(block.curve.point(Real::ratio(k, pieces)))));
    }
    points
}
