//! From a description and its records to coefficients: everything in turn, and what the records cannot tell.

use std::path::Path;

use truepath_ground::diagnostics::{InputError, Source};
use truepath_job::job::MATERIALS;

use crate::assignment::{self, Assignment};
use crate::codes::{E002, E003, E004, E005, E006, E007, E009};
use crate::cut::Cut;
use crate::description::{Axis, Described, Description, Drive, Evidence, Recording, newton};
use crate::fit::{Along, Fitted, Mean, Measured, average, feeds, fit, fit_every, torque_alone};
use crate::law::Law;
use crate::record::Record;
use crate::revolution::{Level, Parts, Signal, harmonics, level, parts};
use crate::shape::{Shape, Turn, fold, forces, shape};

/// One coefficient of the linear law.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Coefficient {
    /// Its value, N/mm² or N/mm.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// The four coefficients of the job's law, Ktc and Krc (N/mm²), Kte and Kre (N/mm).
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Linear {
    /// Ktc, Krc, Kte, Kre.
    pub coefficients: [Coefficient; 4],
    /// Their correlation, in the same order.
    pub correlation: [[f64; 4]; 4],
    /// Feed per tooth from and to which they were measured, mm.
    pub feeds_mm: [f64; 2],
}

/// A mean against what the laws say.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Compared {
    /// What was measured.
    pub measured: Mean,
    /// The mean of the laws by their evidence.
    pub law: f64,
    /// How far they are apart, standard deviation.
    pub law_sigma: f64,
    /// What the linear law says.
    pub linear: f64,
}

/// One cut with its means.
#[derive(Clone, Debug, serde::Serialize)]
pub struct CutResult {
    /// The file, or `means`.
    pub name: String,
    /// The cut.
    pub cut: Cut,
    /// Whether it was fitted.
    pub fitted: bool,
    /// The means, without what runout adds.
    pub means: Vec<Compared>,
    /// Whole revolutions taken.
    pub revolutions: usize,
    /// From and to, s of the record.
    pub span_s: Option<[f64; 2]>,
    /// Drift along the feed and across, N/s.
    pub drift_n_per_s: Option<[f64; 2]>,
    /// Shares of the fluctuation on harmonics of the teeth, on others of the revolution, and between.
    pub shares: Option<[f64; 3]>,
    /// Signals on the tool, feed and across, above the air.
    #[serde(skip)]
    pub signals: Option<[Signal; 2]>,
    /// The mean revolution.
    #[serde(skip)]
    pub turn: Option<Turn>,
    /// What the shape of a revolution tells.
    pub shape: Option<Shape>,
}

/// What records have told.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Analysis {
    /// How columns were taken, where records were read.
    pub axes: Option<String>,
    /// The cuts.
    pub cuts: Vec<CutResult>,
    /// Pairs of laws, the likeliest first.
    pub laws: Vec<Fitted>,
    /// The job's law.
    pub linear: Linear,
    /// The row of the table of materials whose forces are nearest, and how far they are, percent of the resultant.
    pub nearest: (&'static str, f64),
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// A cut before its axes are known: forces in the order of the columns.
struct Raw<'d> {
    described: &'d Described,
    name: String,
    columns: [String; 2],
    /// By what the columns were multiplied before they became values: the signs that the description gives them.
    signs: [f64; 2],
    values: [f64; 2],
    sigma: [f64; 2],
    levels: Option<[Level; 2]>,
    /// Without what the amplifier makes of air.
    signals: Option<[Signal; 2]>,
    span: Option<[f64; 2]>,
    start_s: f64,
    torque: Option<Mean>,
}

impl Raw<'_> {
    /// The means when the columns are taken so; what repeated cuts differ by, as a share, is in their standard deviations.
    fn measured(&self, assignment: Assignment, repeatability: f64) -> Measured {
        let force = assignment.apply(self.values);
        let sigma = if assignment.swapped { [self.sigma[1], self.sigma[0]] } else { self.sigma };
        let size = force[0].hypot(force[1]);
        let mean = |along, k: usize| {
            let repeated = repeatability * force[k].abs().max(0.25 * size);
            Mean { along, value: force[k], sigma: sigma[k].hypot(repeated).max(1e-6) }
        };
        let means = match self.torque {
            Some(torque) => vec![Mean { sigma: torque.sigma.hypot(repeatability * torque.value.abs()), ..torque }],
            None => vec![mean(Along::Feed, 0), mean(Along::Across, 1)],
        };
        Measured { cut: self.described.cut.clone(), means }
    }

    /// The mean revolution, in the order of the columns.
    fn turn(&self) -> Option<[Vec<f64>; 2]> {
        let (signals, span) = self.signals.as_ref().zip(self.span)?;
        fold(signals.each_ref(), span, self.described.cut.revolution_s())
    }
}

/// Rounds in which coefficients and what runout adds to the means settle: each leaves some tenth of what was wrong.
const ROUNDS: usize = 4;
/// How often an error in the coefficients comes back before it is nothing: each time it is a third at most.
const RETURNS: usize = 12;
/// A scatter between harmonics above this share of all is told.
const CHATTER: f64 = 0.15;
/// A share on harmonics that are not of the teeth above which runout is told.
const RUNOUT: f64 = 0.03;
/// The same above which the number of teeth may be another one.
const MISCOUNTED: f64 = 0.9;

impl Analysis {
    /// Reads the records that a description names, and fits.
    ///
    /// # Errors
    /// What is wrong with description or records, with what to do.
    pub fn of(description: &Description) -> Result<Self, InputError> {
        let mut warnings = Vec::new();
        let raw =
            description.cuts.iter().map(|cut| read(cut, description, &mut warnings)).collect::<Result<Vec<_>, _>>()?;
        let (assignment, axes) = assigned(&raw, description, &mut warnings)?;
        let repeatability = description.recording.repeatability;
        let measured: Vec<Measured> = raw.iter().map(|raw| raw.measured(assignment, repeatability)).collect();
        let uses: Vec<bool> = raw.iter().map(|r| r.described.fitted).collect();
        let fitted = |measured: &[Measured]| -> Vec<Measured> {
            measured.iter().zip(&uses).filter(|(_, fitted)| **fitted).map(|(m, _)| m.clone()).collect()
        };
        let untold = || {
            let found = "the cuts do not tell the coefficients apart";
            let expected = "two feeds per tooth at one engagement, or more";
            E009.error(found, expected).in_file(Path::new(description.source.name()))
        };
        let first = linear(&fitted(&measured), &mut Vec::new()).ok_or_else(untold)?;
        let mut cuts: Vec<CutResult> = raw
            .into_iter()
            .map(|raw| result(raw, assignment, (&first, &description.recording), &mut warnings))
            .collect();
        // Where a tooth lifts off the edge does, too: the laws are those of a cutter that runs true. What is taken off follows from
        // the coefficients, which follow from what is left.
        let mut true_running = measured.clone();
        let mut coefficients = first.coefficients;
        for round in 0..ROUNDS {
            if round == ROUNDS / 2 {
                shape_again(&mut cuts, coefficients, description.recording.low_pass_hz);
            }
            true_running = running_true(&measured, &cuts, coefficients.map(|c| c.value));
            let Some(next) = linear(&fitted(&true_running), &mut Vec::new()) else { break };
            coefficients = next.coefficients;
        }
        let next = |values: [f64; 4]| {
            let found = linear(&fitted(&running_true(&measured, &cuts, values)), &mut Vec::new());
            found.map(|linear| linear.coefficients.map(|c| c.value))
        };
        let own = fitted(&true_running);
        let laws = fit_every(&own);
        let linear = linear(&own, &mut warnings).filter(|_| !laws.is_empty()).ok_or_else(untold)?.settled(next);
        let fitted = own;
        let model = linear.model();
        for (cut, own) in cuts.iter_mut().zip(&true_running) {
            let compared = |mean: &Mean| {
                let (law, law_sigma) = average(&laws, &own.cut, mean.along);
                Compared { measured: *mean, law, law_sigma, linear: model.mean(&own.cut, mean.along) }
            };
            cut.means = own.means.iter().map(compared).collect();
        }
        told(&fitted, &laws, &mut warnings);
        let nearest = nearest(&linear, &fitted);
        warnings.dedup();
        Ok(Self { axes, cuts, laws, linear, nearest, warnings })
    }

    /// The largest deviation of a predicted mean, as a share of it; none without predicted cuts.
    pub fn prediction(&self) -> Option<f64> {
        let cuts = self.cuts.iter().filter(|c| !c.fitted).flat_map(|c| &c.means);
        cuts.map(|m| (m.law / m.measured.value - 1.0).abs()).reduce(f64::max)
    }
}

impl Linear {
    /// The same with the uncertainty that comes from taking off what runout adds, which follows from the coefficients: an error in them
    /// comes back as `next` makes of it, again and again.
    fn settled(self, next: impl Fn([f64; 4]) -> Option<[f64; 4]>) -> Self {
        type Square = [[f64; 4]; 4];
        let of = |entry: &dyn Fn(usize, usize) -> f64| -> Square {
            std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k)))
        };
        let times = |a: &Square, b: &Square| of(&|i, k| (0..4).map(|j| a[i][j] * b[j][k]).sum());
        let (values, sigma) = (self.coefficients.map(|c| c.value), self.coefficients.map(|c| c.sigma));
        let moved = |k: usize| next(std::array::from_fn(|j| values[j] + if j == k { sigma[k] } else { 0.0 }));
        let (Some(base), [Some(a), Some(b), Some(c), Some(d)]) = (next(values), [0, 1, 2, 3].map(moved)) else {
            return self;
        };
        let found = [a, b, c, d];
        let back = of(&|i, k| if sigma[k] > 0.0 { (found[k][i] - base[i]) / sigma[k] } else { 0.0 });
        let mut all = of(&|i, k| f64::from(u8::from(i == k)));
        for _ in 0..RETURNS {
            let again = times(&back, &all);
            all = of(&|i, k| f64::from(u8::from(i == k)) + again[i][k]);
        }
        let fit = of(&|i, k| self.correlation[i][k] * sigma[i] * sigma[k]);
        let whole = times(&times(&all, &fit), &of(&|i, k| all[k][i]));
        let spread: [f64; 4] = std::array::from_fn(|k| whole[k][k].max(0.0).sqrt());
        let correlation = of(&|i, k| {
            let both = spread[i] * spread[k];
            if both > 0.0 { whole[i][k] / both } else { self.correlation[i][k] }
        });
        let coefficients = std::array::from_fn(|k| Coefficient { value: values[k], sigma: spread[k] });
        Self { coefficients, correlation, ..self }
    }

    /// As a model.
    pub fn model(&self) -> crate::fit::Model {
        let [ktc, krc, kte, kre] = self.coefficients.map(|c| c.value);
        crate::fit::Model { laws: [Law::Edge; 2], unknowns: vec![ktc, kte, krc, kre] }
    }
}

fn read<'d>(
    described: &'d Described,
    description: &Description,
    warnings: &mut Vec<String>,
) -> Result<Raw<'d>, InputError> {
    let nothing = Raw {
        described,
        name: "means".to_owned(),
        columns: ["feed_n".to_owned(), "across_n".to_owned()],
        signs: [1.0; 2],
        values: [0.0; 2],
        sigma: [0.0; 2],
        levels: None,
        signals: None,
        span: None,
        start_s: 0.0,
        torque: None,
    };
    let (file, given) = match &described.evidence {
        Evidence::Means(values, sigma) => return Ok(Raw { values: *values, sigma: [*sigma; 2], ..nothing }),
        Evidence::Torque(value, sigma) => {
            let torque = Some(Mean { along: Along::Torque, value: *value, sigma: *sigma });
            return Ok(Raw { torque, ..nothing });
        }
        Evidence::Record(file, given) | Evidence::Spindle(file, _, given, _) => (file, *given),
    };
    let source = truepath_ground::sheet::read_bounded(file)?;
    let record = Record::read(&source)?;
    let recording = &description.recording;
    let rate_hz = recording.rate_hz.or_else(|| record.rate()).ok_or_else(|| {
        E003.error("the record has neither a rate nor a column of time", "a sampling rate").in_file(file)
    })?;
    let period = described.cut.revolution_s();
    let name = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let start_s = record.start_s();
    let cut_short = |length: f64| {
        let found = format!("{name} holds {length:.4} s of the cut, a revolution takes {period:.4} s");
        E005.error(found, "ten revolutions or more").in_file(file)
    };
    if period * rate_hz < 8.0 {
        let found = format!("{name} has {:.1} samples in a revolution", period * rate_hz);
        return Err(E005.error(found, "eight samples a revolution or more").in_file(file));
    }
    let signal =
        |column: usize, by: f64| Signal { samples: record.columns[column].iter().map(|v| by * v).collect(), rate_hz };
    let clipped = |given: [f64; 2], length: f64| [(given[0] - start_s).max(0.0), (given[1] - start_s).min(length)];
    if let Evidence::Spindle(_, column, _, drive) = &described.evidence {
        let at = record.column(column).ok_or_else(|| no_column(&record, column, file))?;
        let unit = record.units[at].as_deref().unwrap_or_default();
        let by = match drive {
            Drive::Power => (if unit == "kW" { 1000.0 } else { 1.0 }) * period / std::f64::consts::TAU,
            Drive::Torque => 1.0,
        };
        let signal = signal(at, by);
        let Parts { cut, air } = powered(&signal, given.map(|g| clipped(g, signal.length_s())), period);
        let level = level(&signal, cut, &air, period).ok_or_else(|| cut_short(cut[1] - cut[0]))?;
        if air.is_empty() {
            warnings
                .push(format!("{name}: no idling of the spindle is in the record; its idle power counts as cutting"));
        }
        let torque = Some(Mean { along: Along::Torque, value: level.value, sigma: level.sigma });
        return Ok(Raw { name, torque, span: Some(cut), start_s, ..nothing });
    }
    let axes = axes(recording, &record, &source, file)?;
    let columns = axes.clone().map(|a| a.column);
    let mut signals = Vec::new();
    for axis in &axes {
        let at = record.column(&axis.column).ok_or_else(|| no_column(&record, &axis.column, file))?;
        let written = record.units[at].as_deref().filter(|u| !u.is_empty());
        let newton = match (recording.newton, written) {
            (Some(newton), _) => newton,
            (None, Some(unit)) => newton(unit).ok_or_else(|| {
                E004.error(format!("the unit of {} is \"{unit}\"", axis.column), "N or kN").in_file(file)
            })?,
            (None, None) => 1.0,
        };
        signals.push(signal(at, axis.sign * recording.on_tool.unwrap_or(1.0) * newton));
    }
    let Ok(signals) = <[Signal; 2]>::try_from(signals) else { return Err(no_column(&record, "", file)) };
    let length = signals[0].length_s();
    let found = parts([&signals[0], &signals[1]], period).ok_or_else(|| cut_short(length))?;
    let cut = given.map_or(found.cut, |g| clipped(g, length));
    let air: Vec<[f64; 2]> = found.air.into_iter().filter(|a| a[1] <= cut[0] || a[0] >= cut[1]).collect();
    let level = |signal: &Signal| level(signal, cut, &air, period).ok_or_else(|| cut_short((cut[1] - cut[0]).max(0.0)));
    let levels = [level(&signals[0])?, level(&signals[1])?];
    if air.is_empty() {
        warnings.push(format!(
            "{name}: no stretch without cutting is in the record: the zero of the amplifier is taken for that of the force"
        ));
    }
    let [first, second] = signals;
    Ok(Raw {
        name,
        columns,
        signs: axes.map(|a| a.sign * recording.on_tool.unwrap_or(1.0)),
        values: [levels[0].value, levels[1].value],
        sigma: [levels[0].sigma, levels[1].sigma],
        levels: Some(levels),
        signals: Some([above_air(first, &levels[0], cut), above_air(second, &levels[1], cut)]),
        span: Some(cut),
        start_s,
        ..nothing
    })
}

/// A signal without the offset and the drift of its amplifier.
fn above_air(signal: Signal, level: &Level, [from, to]: [f64; 2]) -> Signal {
    let Signal { mut samples, rate_hz } = signal;
    let middle = 0.5 * (from + to);
    for (n, v) in samples.iter_mut().enumerate() {
        *v -= level.offset.unwrap_or(0.0) + level.drift_per_s * (n as f64 / rate_hz - middle);
    }
    Signal { samples, rate_hz }
}

/// The part of a signal of the spindle that cuts: what lies above the middle between its ends.
fn powered(signal: &Signal, given: Option<[f64; 2]>, period: f64) -> Parts {
    let means = signal.means(0.0, signal.length_s(), period);
    let (low, high) = means.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    let middle = 0.5 * (low + high);
    let from = means.iter().position(|m| *m > middle).unwrap_or(0);
    let to = means.iter().rposition(|m| *m > middle).map_or(means.len(), |k| k + 1);
    let ends = (to - from) / 20 + 1;
    let span = |from: usize, to: usize| [from as f64 * period, to as f64 * period];
    let idle = high - low > 0.2 * high.abs();
    let cut = given.unwrap_or_else(|| {
        if idle && to > from + 2 * ends { span(from + ends, to - ends) } else { span(0, means.len()) }
    });
    let air =
        if idle { vec![span(0, from.saturating_sub(1)), span(to + 1, means.len().max(to + 1))] } else { Vec::new() };
    Parts { cut, air: air.into_iter().filter(|[a, b]| b - a > 2.0 * period).collect() }
}

fn no_column(record: &Record, name: &str, file: &Path) -> InputError {
    E002.error(format!("there is no column \"{name}\""), format!("one of {}", record.names.join(", "))).in_file(file)
}

/// The two columns of the record, as named or as forces are usually called.
fn axes(recording: &Recording, record: &Record, source: &Source, file: &Path) -> Result<[Axis; 2], InputError> {
    if let Some(axes) = &recording.axes {
        return Ok(axes.clone());
    }
    let usual = [["fx", "fy"], ["force_x", "force_y"], ["x", "y"], ["force_0", "force_1"]];
    let found = usual.iter().find(|names| names.iter().all(|n| record.column(n).is_some()));
    let axis = |at: usize| Axis { column: record.names[at].clone(), sign: 1.0 };
    if let Some([x, y]) = found
        && let (Some(x), Some(y)) = (record.column(x), record.column(y))
    {
        return Ok([axis(x), axis(y)]);
    }
    let forces: Vec<usize> = (0..record.names.len()).filter(|k| Some(*k) != record.time).collect();
    match forces.as_slice() {
        [x, y] => Ok([axis(*x), axis(*y)]),
        _ => {
            let found = format!("which of the columns {} are forces is not said", record.names.join(", "));
            let error = InputError::new(E002, found, "two columns", "add feed and across under [record]");
            Err(error.at(source, source.line_span(1)).in_file(file))
        }
    }
}

/// How the columns are to be taken, and in words; refuses what no cut makes.
fn assigned(
    raw: &[Raw],
    description: &Description,
    warnings: &mut Vec<String>,
) -> Result<(Assignment, Option<String>), InputError> {
    let forces: Vec<&Raw> = raw.iter().filter(|r| r.torque.is_none()).collect();
    let Some(first) = forces.first() else { return Ok((Assignment::NAMED, None)) };
    let columns: Vec<(&Cut, [f64; 2])> = forces.iter().map(|r| (&r.described.cut, r.values)).collect();
    let names = [first.columns[0].as_str(), first.columns[1].as_str()];
    if let Some(by) = assignment::wrong_unit(&columns) {
        let sizes: Vec<String> = forces.iter().map(|r| format!("{:.4}", r.values[0].hypot(r.values[1]))).collect();
        let found = format!("mean forces of {} N are not those of a cut this deep at this feed", sizes.join(", "));
        let help = match by {
            by if by > 1.0 => {
                "the record is in kN: add unit = \"kN\" under [record]; or there is no cut in it: look at it, and at from_s and to_s"
            }
            by if by < 1.0 => "the record is in N: add unit = \"N\" under [record]",
            _ => E007.remedy,
        };
        let error = InputError::new(E007, found, "60 to 40,000 N per mm² of chip", help);
        return Err(error.at(&description.source, first.described.place.clone()));
    }
    let possible = assignment::possible(&columns);
    let recording = &description.recording;
    let allowed = |a: &Assignment| match (recording.axes.is_some(), recording.on_tool) {
        (true, Some(_)) => *a == Assignment::NAMED,
        // Which side the forces act on is open: both at once are turned.
        (true, None) => !a.swapped && a.signs[0] == a.signs[1],
        (false, _) => true,
    };
    let words = |a: Assignment| a.words(names, first.signs);
    let every = |of: &[Assignment]| of.iter().map(|a| words(*a)).collect::<Vec<_>>().join("; or ");
    let refused = |found: String, expected: &str, help: String| {
        let error = InputError::new(E006, found, expected, help);
        Err(error.at(&description.source, first.described.place.clone()))
    };
    if let Some((best, left)) = told_by_shape(raw, &possible, recording) {
        if allowed(&best) {
            return Ok((best, Some(words(best))));
        }
        let found = format!(
            "taken as {}, the means could be forces of this cut, but a revolution does not look like one",
            words(Assignment::NAMED)
        );
        let help = format!(
            "the columns are swapped or turned; what fits: {}: {:.0} % of the force over a revolution is explained so",
            words(best),
            100.0 * (1.0 - left)
        );
        return refused(found, "the force over a revolution that the stated engagement makes", help);
    }
    let fitting: Vec<Assignment> = possible.iter().copied().filter(allowed).collect();
    match fitting.as_slice() {
        [] => {
            let [t, r] = assignment::secant(columns[0].0, columns[0].1);
            let found = format!(
                "taken as {}, the tangential force would be {t:.0} and the radial {r:.0} N per mm² of chip",
                words(Assignment::NAMED)
            );
            let help = if possible.is_empty() {
                "no way to name the two columns fits: check the engagement, the direction of milling and the columns"
                    .to_owned()
            } else {
                format!("the columns are swapped or turned; what fits: {}", every(&possible))
            };
            refused(found, "a positive tangential force and a smaller radial one", help)
        }
        [only] => {
            let others: Vec<Assignment> = possible.iter().copied().filter(|a| a != only).collect();
            if !others.is_empty() {
                warnings.push(format!(
                    "whether the columns are named right is not told by these forces: {} would make a cut as well; a record of a \
                     deeper cut or a slot, its revolution visible, tells",
                    every(&others)
                ));
            }
            Ok((*only, Some(words(*only))))
        }
        several => {
            let found = format!("{} ways to name the two columns fit this engagement", several.len());
            refused(found, "feed and across", format!("write one of them under [record]: {}", every(several)))
        }
    }
}

/// What a shape has to leave unexplained for another one to be told from it, over what that one leaves.
const TOLD_APART: f64 = 3.0;

/// Of several possible assignments the one that the shape of a revolution tells, with the share of the fluctuation it leaves
/// unexplained; nothing where no record shows teeth, or several are as good.
fn told_by_shape(raw: &[Raw], possible: &[Assignment], recording: &Recording) -> Option<(Assignment, f64)> {
    let [_, _, ..] = possible else { return None };
    // The thickest chips stand out most.
    let feed = |raw: &&Raw| raw.described.cut.feed_per_tooth_mm;
    let clearest = raw.iter().filter(|r| r.signals.is_some()).max_by(|a, b| feed(a).total_cmp(&feed(b)))?;
    let turn = clearest.turn()?;
    let left = |assignment: Assignment| {
        let fitted = raw.iter().filter(|r| r.described.fitted);
        let means: Vec<Measured> = fitted.map(|r| r.measured(assignment, recording.repeatability)).collect();
        let near = near(linear(&means, &mut Vec::new())?.coefficients);
        let turn = assignment.apply_all(turn.clone());
        let (shape, _) = shape(&clearest.described.cut, &turn, near, recording.low_pass_hz)?;
        shape.believed.then_some(1.0 - shape.explained)
    };
    let mut explained: Vec<(Assignment, f64)> = possible.iter().filter_map(|a| Some((*a, left(*a)?))).collect();
    explained.sort_by(|a, b| a.1.total_cmp(&b.1));
    match explained.as_slice() {
        [best, next, ..] if next.1 < TOLD_APART * best.1 => None,
        [best, ..] => Some(*best),
        [] => None,
    }
}

/// The linear law; edges below zero are held at what handbooks expect.
fn linear(cuts: &[Measured], warnings: &mut Vec<String>) -> Option<Linear> {
    let one_feed = feeds(cuts) < 2;
    let unphysical = |f: &Fitted| f.model.unknowns.iter().any(|v| *v < 0.0);
    let free = if one_feed { None } else { fit(cuts, [Law::Edge; 2], false) };
    let found = match free.filter(|f| !unphysical(f)) {
        Some(found) => found,
        None => {
            if !one_feed {
                warnings.push(
                    "an edge coefficient would be below zero: it was held near those of handbooks, 18 ± 12 N/mm"
                        .to_owned(),
                );
            }
            fit(cuts, [Law::Edge; 2], true)?
        }
    };
    let of = |k: usize| Coefficient { value: found.model.unknowns[k].max(0.0), sigma: found.sigma[k] };
    let order = [0, 2, 1, 3];
    let (coefficients, correlation) = if torque_alone(cuts) {
        let [ktc, kte] = [of(0), of(1)];
        warnings.push(
            "a torque tells nothing of the radial force: Krc = 0.3 ± 0.15 of Ktc and Kre = Kte are taken".to_owned(),
        );
        let krc = Coefficient { value: 0.3 * ktc.value, sigma: 0.15 * ktc.value };
        let mut correlation = [[0.0; 4]; 4];
        (0..4).for_each(|k| correlation[k][k] = 1.0);
        ([ktc, krc, kte, Coefficient { sigma: kte.sigma.max(0.6 * kte.value), ..kte }], correlation)
    } else {
        (order.map(of), order.map(|i| order.map(|j| found.correlation[i][j])))
    };
    let feeds = cuts.iter().map(|c| c.cut.feed_per_tooth_mm);
    let feeds_mm = feeds.fold([f64::MAX, f64::MIN], |[low, high], f| [low.min(f), high.max(f)]);
    Some(Linear { coefficients, correlation, feeds_mm })
}

fn result(
    raw: Raw,
    assignment: Assignment,
    (linear, recording): (&Linear, &Recording),
    warnings: &mut Vec<String>,
) -> CutResult {
    let cut = raw.described.cut.clone();
    let period = cut.revolution_s();
    let order = |pair: [f64; 2]| assignment.apply(pair);
    let drift = raw.levels.map(|levels| order(levels.map(|l| l.drift_per_s)));
    let rate_hz = raw.signals.as_ref().map_or(0.0, |[first, _]| first.rate_hz);
    let turn = raw.turn().map(|turn| assignment.apply_all(turn));
    let signals = raw
        .signals
        .map(|pair| assignment.apply_all(pair.map(|signal| signal.samples)).map(|samples| Signal { samples, rate_hz }));
    let shares = signals.as_ref().zip(raw.span).and_then(|(signals, span)| {
        let most = (6 * cut.teeth as usize).max(24);
        let each = signals.each_ref().map(|s| harmonics(s, span, period, cut.teeth, most).map(|h| h.shares));
        let [Some(a), Some(b)] = each else { return None };
        let sum = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        let all = sum.iter().sum::<f64>();
        (all > 0.0).then(|| sum.map(|s| s / all))
    });
    let name = &raw.name;
    if let Some([_, other, between]) = shares {
        if between > CHATTER {
            warnings.push(format!(
                "{name}: {:.0} % of the fluctuation is on no harmonic of the spindle: chatter, vibration of the dynamometer, or a \
                 speed other than {} rev/min; of chatter the means hold and the shapes do not, of another speed neither",
                100.0 * between,
                cut.spindle_rpm
            ));
        }
        if other > RUNOUT {
            // A cutter that runs out has some of it by the tooth all the same.
            let miscounted = if other > MISCOUNTED {
                format!(", or it has another number of teeth than {}", cut.teeth)
            } else {
                String::new()
            };
            warnings.push(format!(
                "{name}: {:.0} % of the fluctuation repeats by the revolution and not by the tooth: the cutter runs out{miscounted}",
                100.0 * other
            ));
        }
    }
    if let (Some(levels), Some(span)) = (raw.levels, raw.span) {
        let size = raw.values[0].hypot(raw.values[1]);
        for (level, column) in levels.iter().zip(&raw.columns) {
            let change = level.drift_per_s * (span[1] - span[0]);
            if level.drift_per_s.abs() > 3.0 * level.drift_sigma && change.abs() > 0.02 * size {
                let done =
                    if level.offset.is_some() { "was taken off by the air" } else { "is in the standard deviation" };
                warnings.push(format!("{name}: {column} drifts by {change:.1} N over the cut; it {done}"));
            }
        }
    }
    let near = near(linear.coefficients);
    let shaped = turn.as_ref().and_then(|turn| shape(&cut, turn, near, recording.low_pass_hz));
    if let Some((shape, _)) = &shaped {
        if !shape.believed {
            warnings.push(format!(
                "{name}: the shape of a revolution is not that of the cut ({:.0} % of it explained), as with a dynamometer that \
                 rings: runout and phase are not taken from it",
                100.0 * shape.explained.max(0.0)
            ));
        } else if shape.runout_mm < 2.0 * shape.runout_sigma_mm {
            warnings.push(format!("{name}: no runout is visible above {:.4} mm", 2.0 * shape.runout_sigma_mm));
        }
        if shape.believed && shape.cutting_teeth < cut.teeth as usize {
            warnings.push(format!(
                "{name}: {} of {} teeth cut: the mean law does not hold",
                shape.cutting_teeth, cut.teeth
            ));
        }
    }
    let (shape, drawn) = shaped.unzip();
    let turn = turn.map(|recorded| Turn { recorded, fitted: drawn });
    CutResult {
        turn,
        shape,
        fitted: raw.described.fitted,
        revolutions: raw.span.map_or(0, |[a, b]| ((b - a) / period + 1e-6).floor() as usize),
        span_s: raw.span.map(|s| s.map(|t| t + raw.start_s)),
        drift_n_per_s: drift,
        shares,
        signals,
        means: Vec::new(),
        name: raw.name,
        cut,
    }
}

/// Coefficients with the standard deviations that a shape is held near them by.
fn near(coefficients: [Coefficient; 4]) -> [[f64; 2]; 4] {
    coefficients.map(|c| [c.value, c.sigma.max(0.05 * c.value).max(2.0)])
}

/// Fits the shapes again about better coefficients: those of means that runout has lowered pull the runout down as well.
fn shape_again(cuts: &mut [CutResult], coefficients: [Coefficient; 4], low_pass_hz: Option<f64>) {
    for cut in cuts {
        let (Some(turn), true) = (&mut cut.turn, cut.shape.as_ref().is_some_and(|shape| shape.believed)) else {
            continue;
        };
        if let Some((shape, drawn)) = shape(&cut.cut, &turn.recorded, near(coefficients), low_pass_hz) {
            cut.shape = Some(shape);
            turn.fitted = Some(drawn);
        }
    }
}

/// The means of a cutter that runs true, where the shape of the record shows how this one does not.
fn running_true(measured: &[Measured], cuts: &[CutResult], coefficients: [f64; 4]) -> Vec<Measured> {
    let mut all = measured.to_vec();
    for (own, cut) in all.iter_mut().zip(cuts) {
        let Some(shape) = cut.shape.as_ref().filter(|s| s.believed) else { continue };
        let beyond = lifted(&own.cut, coefficients, shape);
        for mean in &mut own.means {
            mean.value -= beyond[usize::from(mean.along == Along::Across)];
        }
    }
    all
}

/// What runout adds to the means along the feed and across, N: a tooth that lifts off has no edge force.
fn lifted(cut: &Cut, coefficients: [f64; 4], shape: &Shape) -> [f64; 2] {
    let mean = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let with = |runout| forces(cut, coefficients, runout, 0.0).each_ref().map(mean);
    let ([a, b], [c, d]) = (with(shape.parts_mm.map(|p| p[0])), with([0.0; 2]));
    [a - c, b - d]
}

/// What the fit cannot tell.
fn told(cuts: &[Measured], laws: &[Fitted], warnings: &mut Vec<String>) {
    if feeds(cuts) < 2 {
        warnings.push(
            "one feed only: chip and edge force cannot be told apart; the edge is held near 18 ± 12 N/mm. Cut with a second feed"
                .to_owned(),
        );
        return;
    }
    if feeds(cuts) < 4 {
        warnings.push(format!(
            "{} feeds: which law the force follows rests on handbooks as much as on the record",
            feeds(cuts)
        ));
    }
    if let [first, second, ..] = laws
        && second.weight > 0.3 * first.weight
    {
        let pair = |f: &Fitted| format!("{} tangential, {} radial", f.model.laws[0].words(), f.model.laws[1].words());
        warnings.push(format!(
            "the records do not decide between the laws ({}: {:.0} %; {}: {:.0} %): what is said of forces is their mean",
            pair(first),
            100.0 * first.weight,
            pair(second),
            100.0 * second.weight
        ));
    }
    let linear: f64 = laws.iter().filter(|f| f.model.laws == [Law::Edge; 2]).map(|f| f.weight).sum();
    if linear < 0.05 {
        warnings.push(
            "the force is not linear in the chip: the four coefficients hold between the feeds that were measured, with the \
             standard deviation that this leaves"
                .to_owned(),
        );
    }
}

/// The material of the table whose mean forces in the same cuts are nearest.
fn nearest(linear: &Linear, cuts: &[Measured]) -> (&'static str, f64) {
    let model = linear.model();
    let force = |model: &crate::fit::Model, cut: &Cut| [model.mean(cut, Along::Feed), model.mean(cut, Along::Across)];
    let off = |coefficients: [&str; 4]| {
        let [ktc, krc, kte, kre] = coefficients.map(|c| c.parse().unwrap_or(0.0));
        let table = crate::fit::Model { laws: [Law::Edge; 2], unknowns: vec![ktc, kte, krc, kre] };
        let each = cuts.iter().map(|c| {
            let (a, b) = (force(&model, &c.cut), force(&table, &c.cut));
            (a[0] - b[0]).hypot(a[1] - b[1]) / a[0].hypot(a[1])
        });
        100.0 * each.fold(0.0, f64::max)
    };
    let each = MATERIALS.iter().map(|m| (m.name, off(m.coefficients)));
    each.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("", f64::INFINITY))
}
