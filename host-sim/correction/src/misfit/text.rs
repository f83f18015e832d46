//! What is said of points that do not fit.

use truepath_core::identify::Parameter;
use truepath_core::job::ZReference;
use truepath_ground::diagnostics::InputError;
use truepath_ground::length::Unit;
use truepath_ground::units::{float, mm};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::cause::Cause;
use super::look::Reason;
use super::stop::Misfit;
use super::trial::Trial;
use crate::codes::Q009;

/// Points that are listed at most.
const LISTED: usize = 5;

impl Misfit {
    /// The error, at the worst point.
    pub fn error(&self, pass: &Pass, measurement: &Measurement) -> InputError {
        let found = format!("{}; {}{}", self.what(pass.unit()), self.why(pass, measurement), self.worst(measurement));
        let help = self.causes.first().map_or_else(
            || {
                "measure what is named once more; look whether program, part and file belong together and what the job says of tool, stock and probe".to_owned()
            },
            |trial| trial.cause.help(pass, measurement),
        );
        // A correction takes off nearly the same everywhere.
        let corrected = self.reason == Some(Reason::Level) && self.look.level_mm[0] < 0.0;
        let corrected = if corrected {
            "; a part that was cut with a correction looks like that: learn from it with truepath learn --from its folder"
        } else {
            ""
        };
        let help = format!("{help}{corrected}; --force-data goes on with the points as they are");
        let error = InputError::new(Q009, found, "points of a part that this job has cut", help).by_judgement();
        match self.stated.worst().first() {
            Some(k) => {
                let (file, span) = measurement.place_of(self.stated.lines[*k]);
                error.at(file, span)
            }
            None => error.at(&measurement.source, 0..0),
        }
    }

    /// One sentence, for a warning.
    pub fn sentence(&self, pass: &Pass, measurement: &Measurement) -> String {
        format!(
            "the points do not fit the job: {}; {}{}",
            self.what(pass.unit()),
            self.why(pass, measurement),
            self.worst(measurement)
        )
    }

    fn what(&self, unit: Unit) -> String {
        let name = unit.name();
        match self.reason {
            Some(Reason::Points) => {
                let (unfit, all) = self.look.count();
                format!("{unfit} of {all} points do not fit a machine like the one in the job")
            }
            Some(Reason::Level) => format!(
                "all points are off by {:+.3} {name}, more than a worn cutter leaves or one that runs out takes",
                unit.of(self.look.level_mm[0])
            ),
            Some(Reason::Parameter(parameter, far)) => {
                format!("{} would have to be {far:.0} standard deviations from what the job says", said(parameter))
            }
            None => format!(
                "the points fit the job to {:.4} {name} (rms), and other assumptions far better",
                unit.of(self.stated.score.rms_mm)
            ),
        }
    }

    /// The causes with their figures.
    fn why(&self, pass: &Pass, measurement: &Measurement) -> String {
        let unit = pass.unit();
        let stated = figures(&self.stated, unit);
        if self.causes.is_empty() {
            return format!("none of the causes that were tried explains it (as stated: {stated})");
        }
        let words = |trial: &Trial| format!("{} ({})", trial.cause.words(pass, measurement), figures(trial, unit));
        let each = self.causes.iter().map(words);
        let each: Vec<String> = each.collect();
        format!("they fit {}; as stated: {stated}", each.join(", or alike "))
    }

    /// The worst points, where no cause tells more.
    fn worst(&self, measurement: &Measurement) -> String {
        if !self.causes.is_empty() {
            return String::new();
        }
        let trial = &self.stated;
        let each = trial.worst().into_iter().take(LISTED).map(|k| {
            let o = &trial.observations[k];
            let name = measurement.name_of(trial.lines[k]);
            let (unit, [error, predicted]) = (measurement.unit, [o.error, o.predicted].map(mm));
            let [error, predicted] = [error, predicted].map(|v| unit.of(v));
            format!("{name}: {error:.3} {in_unit} measured, {predicted:.3} {in_unit} expected", in_unit = unit.name())
        });
        let each: Vec<String> = each.collect();
        format!("; worst: {}", each.join(", "))
    }
}

fn figures(trial: &Trial, unit: Unit) -> String {
    let score = &trial.score;
    let (rms, name) = (unit.of(score.rms_mm), unit.name());
    format!("rms {rms:.4} {name}, chi-square {:.0} of {} points", score.cost, score.points)
}

/// A parameter as a machinist says it.
pub(crate) const fn said(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Compliance => "the stiffness of the machine",
        Parameter::ComplianceDifference => "the difference of its stiffness in x and y",
        Parameter::ComplianceCross => "the cross compliance of the machine",
        Parameter::RadialRatio => "the radial force coefficient",
        Parameter::EdgeLevel | Parameter::EdgeRatio => "the edge force coefficients",
        Parameter::Bend => "the bending of the cutter",
        Parameter::SizeExponent => "the chip-size effect",
        Parameter::Undersize => "the size of the cutter",
        Parameter::DatumX | Parameter::DatumY => "the datum",
    }
}

impl Cause {
    /// As a condition: "they fit …".
    pub fn words(self, pass: &Pass, measurement: &Measurement) -> String {
        let (unit, name) = (pass.unit(), pass.unit().name());
        match self {
            Self::Nothing => "as stated".to_owned(),
            Self::Datum([x, y]) => {
                let [x, y] = [x, y].map(|v| unit.of(v + 0.0));
                format!("when X {x:.3} and Y {y:.3} {name} are taken off all of them: the datum is shifted by that")
            }
            Self::Level(off) => {
                let why = self.ball(pass).unwrap_or("ball or cutter are not as large as the job says");
                format!("when {:+.3} {name} are taken off all of them: {why}", unit.of(off))
            }
            Self::Sign => "with the sign of all deviations turned".to_owned(),
            Self::Spindle => "when climb and conventional are exchanged: the spindle turned the other way, or the part was cut the other way round".to_owned(),
            Self::Allowance(mm) => format!("with an allowance of about {} {name}", figure(unit.said(mm))),
            Self::Teeth(teeth) => format!("with {teeth} teeth"),
            Self::Helix(deg) => format!("with a helix of about {deg} degrees"),
            Self::Height(mm) => format!("when Z of all of them is raised by about {:.1} {name}", unit.of(mm)),
            Self::Stray(lines) => format!("without {}", listed(lines, measurement)),
            Self::MirroredX => "with the sign of X turned".to_owned(),
            Self::MirroredY => "with the sign of Y turned".to_owned(),
            Self::Swapped => "with X and Y exchanged".to_owned(),
        }
    }

    /// The line to change, or what to measure again.
    pub fn help(self, pass: &Pass, measurement: &Measurement) -> String {
        let allowance = mm(pass.core.setup.allowance);
        match self {
            Self::Nothing => String::new(),
            Self::Datum(_) => "touch the part again in the work offset it was cut in (G54), without unclamping it, and look at X and Y of the origin; where the probe's own offset is wrong, calibrate it".to_owned(),
            Self::Level(off) => {
                let ball = pass.job.numbers.probe.map_or(0.0, |p| mm(p.ball_diameter));
                let diameter = 2.0 * mm(pass.core.setup.radius);
                format!(
                    "measure ball and cutter: ball_diameter_mm = {} in [probe], or diameter_mm = {} in [tool], would fit; or the pass was not cut to its end",
                    figure((ball + 2.0 * off).max(0.0)),
                    figure(diameter - 2.0 * off)
                )
            }
            Self::Sign => "positive is material left: turn the sign of the deviations, or change wall in the job".to_owned(),
            Self::Spindle => "look at M3 and M4 and at the direction of travel in the program, and at wall in the job".to_owned(),
            Self::Allowance(to) if near_ratio(to, allowance, 25.4) || near_ratio(allowance, to, 25.4) => {
                format!("allowance_mm in [stock] is in millimetres, {allowance} looks like another unit: write allowance_mm = {}", figure(to))
            }
            Self::Allowance(to) => format!("measure what this pass takes off the wall and write it as allowance_mm in [stock], {} instead of {allowance}", figure(to)),
            Self::Teeth(teeth) => format!("count the teeth: teeth = {teeth} in [tool] instead of {}", pass.core.setup.teeth),
            Self::Helix(deg) => format!("look at the cutter: helix_deg = {deg} in [tool] instead of {}", float(pass.core.setup.helix_deg)),
            Self::Height(off) => {
                let probe = pass.job.numbers.probe;
                let ball = probe.map_or(0.0, |p| mm(p.ball_diameter) / 2.0);
                let other = if probe.is_some_and(|p| p.z_reference == ZReference::Tip) { "centre" } else { "tip" };
                if (off.abs() - ball).abs() < 0.01 {
                    format!("write z_reference = \"{other}\" in [probe]: Z of the file is that of the ball's {}", if other == "tip" { "lowest point" } else { "centre" })
                } else {
                    "measure the length of the probe again, and look at Z of the origin and at axial_depth_mm".to_owned()
                }
            }
            Self::Stray(lines) => format!("touch {} once more, or take it out of the file: there the probe met a chip or another wall", listed(lines, measurement)),
            Self::MirroredX | Self::MirroredY => "turn the sign of that column, or look how the part lay when it was touched".to_owned(),
            Self::Swapped => "exchange the columns of X and Y, or look how the part lay when it was touched".to_owned(),
        }
    }

    /// What about the ball a level would be.
    fn ball(self, pass: &Pass) -> Option<&'static str> {
        let Self::Level(off) = self else { return None };
        let radius = pass.job.numbers.probe.map_or(0.0, |p| mm(p.ball_diameter) / 2.0);
        let near = |to: f64| (off - to).abs() < 0.02 + 0.02 * radius;
        if radius > 0.0 && near(radius) {
            Some("ball_diameter_mm looks like the radius of the ball")
        } else if radius > 0.0 && near(-radius / 2.0) {
            Some("ball_diameter_mm looks like twice the diameter of the ball")
        } else if radius > 0.0 && near(-radius) {
            Some("the file seems to hold touched points, not ball centres")
        } else {
            None
        }
    }

    /// Whether two causes are the same but for their numbers.
    pub fn is_kind_of(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }
}

/// One or two points by name.
fn listed(lines: [u32; 2], measurement: &Measurement) -> String {
    let each = lines.into_iter().filter(|line| *line > 0).map(|line| measurement.name_of(line));
    each.collect::<Vec<_>>().join(" and ")
}

fn near_ratio(a: f64, b: f64, ratio: f64) -> bool {
    b > 0.0 && (a / b / ratio - 1.0).abs() < 0.1
}

/// Three figures.
fn figure(value: f64) -> String {
    let decimals = if value.abs() >= 10.0 { 2 } else { 3 };
    let text = format!("{value:.decimals$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
