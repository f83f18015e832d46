//! What the user of a correction should doubt: points that do not fit, corners, backlash, gouges, uncertainty.

use truepath_core::cut::Loop;
use truepath_core::identify::Parameter;
use truepath_core::probe::Contact;
use truepath_core::units::Offset;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::{float, mm};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_program::Difference;

use crate::correction::{Correction, Identification};
use crate::damped::damped_summary;
use crate::guard::guard_summary;
use crate::misfit::said;
use crate::remarks::{MeasuredPart, Remarks};
use crate::surface::expected::Surface;

/// What the user should doubt, said in a unit.
pub fn model_warnings(
    (pass, unit): (&Pass, Unit),
    measurement: &Measurement,
    identified: &Identification,
    correction: &Correction,
    machine: &Loop,
) -> Vec<String> {
    let name = unit.name();
    let mut out = Vec::new();
    if identified.outlying() > 0 {
        let lines: Vec<String> = identified
            .observations
            .iter()
            .zip(&measurement.contacts)
            .filter(|(o, _)| o.is_outlying())
            .map(|(o, contact)| {
                format!(
                    "{} at s = {:.2} {name} (measured {:.4}, model {:.4} {name})",
                    measurement.name_of(contact.line),
                    unit.of(mm(o.s)),
                    unit.of(mm(o.error)),
                    unit.of(mm(o.predicted))
                )
            })
            .collect();
        out.push(format!("{} points do not fit and were given little weight: {}", lines.len(), lines.join("; ")));
    }
    if correction.passage.unsettled > 0 {
        out.push(format!(
            "the elastic loop did not settle at {} places (worst residual {:.4} {name}): the machine is too soft for this cut",
            correction.passage.unsettled,
            unit.of(mm(correction.passage.worst_residual))
        ));
    }
    if let Some(guard) = guard_summary(machine.path, correction) {
        if !guard.heeded && guard.deepest_mm > guard.max_gouge_mm {
            out.push(format!(
                "max_gouge_mm = {} is not kept: {:.4} {name} are predicted (only law = \"model\" heeds it)",
                guard.max_gouge_mm,
                unit.of(guard.deepest_mm)
            ));
        } else if guard.deepest_with_confidence_mm > guard.max_gouge_mm + 0.001 {
            out.push(format!(
                "max_gouge_mm = {} is not kept with three standard deviations to spare: up to {:.4} {name} may be cut too deep, {:.4} {name} are predicted",
                guard.max_gouge_mm,
                unit.of(guard.deepest_with_confidence_mm),
                unit.of(guard.deepest_mm)
            ));
        }
        if let Some(most) = guard.places.iter().max_by(|a, b| a.moved_mm().total_cmp(&b.moved_mm())) {
            out.push(format!(
                "max_gouge_mm = {} holds the cutter back at {} places, most at s = {:.2} {name}: {} {:.4} {name} towards the wall, {:.4} {name} are allowed",
                guard.max_gouge_mm,
                guard.places.len(),
                unit.of(most.at_s_mm),
                if correction.used_again { "the correction that is used again goes" } else { "the target wants" },
                unit.of(most.wanted_mm),
                unit.of(most.allowed_mm)
            ));
        }
    }
    let far = identified.fit().theta.iter().zip(Parameter::ALL).filter(|(t, _)| float(t.abs()) > 2.5);
    let (values, believed) = (identified.fit().parameters.values(), identified.prior().mean.values());
    for (theta, parameter) in far {
        let [value, prior] = [values, believed].map(|all| float(all[parameter as usize]));
        // What is no length is told in the units of the job's keys.
        let of = if parameter.unit() == "mm" { unit } else { Unit::default() };
        let (value, prior) = (of.of(value), of.of(prior));
        let behind = match parameter.unit() {
            "1" => String::new(),
            "mm" => format!(" {name}"),
            other => format!(" {other}"),
        };
        out.push(format!(
            "{} came out at {value:.4}{behind}, {:.1} standard deviations from the {prior:.4}{behind} of the job: {}; the correction follows the points",
            said(parameter),
            float(theta.abs()),
            cause(parameter)
        ));
    }
    let peak = correction.predicted.iter().map(|p| p.before.mean.abs()).max().unwrap_or_default();
    let sigma = correction.sigma_by_points.iter().copied().max().unwrap_or_default();
    if let Some(damped) = damped_summary(machine.path, correction) {
        out.push(damped.text(unit));
    } else if sigma.nm() * 8 > peak.nm() {
        out.push(format!(
            "the points leave the corrected wall uncertain by {:.4} {name} (one sigma); probe more places, best in the corners",
            unit.of(mm(sigma))
        ));
    }
    if let Some(reversal) = reversal((pass, unit), machine, correction) {
        out.push(reversal);
    }
    out
}

/// What is likely to have moved a parameter away from the job, and the keys to look at.
const fn cause(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Compliance => {
            "the machine is softer or stiffer, or the cut heavier or lighter, than stiffness_x_n_per_mm and stiffness_y_n_per_mm of [machine], [force] and allowance_mm say"
        }
        Parameter::ComplianceDifference => {
            "X and Y give way in another ratio than stiffness_x_n_per_mm and stiffness_y_n_per_mm of [machine]"
        }
        Parameter::ComplianceCross => {
            "a push along X moves the machine along Y, as a column or table that twists does; a shifted datum looks alike"
        }
        Parameter::RadialRatio => "another material than [force] says, or a worn cutter",
        Parameter::EdgeLevel | Parameter::EdgeRatio => {
            "a worn cutter, or another material than [force] says (kte_n_per_mm, kre_n_per_mm)"
        }
        Parameter::Bend => {
            "the cutter sticks out farther or less than stickout_mm of [tool] says, or is of another material"
        }
        Parameter::SizeExponent => "another material than [force] says, or a chip thinner than the edge is round",
        Parameter::Undersize => {
            "the cutter is worn, ground or runs out: measure it, and write measured_diameter_mm in [tool]"
        }
        Parameter::DatumX | Parameter::DatumY => {
            "the part was touched with another zero than it was cut with: the same clamping and work offset for both"
        }
    }
}

/// What to say of a wall that one pass cannot hold within the tolerance at every height: what leaves it, and what to type.
pub fn beyond_tolerance(pass: &Pass, remarks: &Remarks, after: &Surface) -> Option<Remark> {
    let tolerance = pass.job.part.tolerance?;
    let half = mm(tolerance.upper).min(-mm(tolerance.lower));
    let (expected, twice_sigma) = (after.profile.profile_mm, 2.0 * after.profile.sigma_mm);
    if half <= 0.0 || expected + twice_sigma <= half {
        return None;
    }
    let verb = if expected > half { "cannot hold" } else { "may not hold" };
    let feature = pass.job.which.feature.as_ref().map_or_else(String::new, |id| format!(" --feature {id}"));
    let plan = |probe: &str| {
        let job = pass.job.source().name();
        format!("truepath plan {job} --probe {probe} --tolerance {}{feature}", pass.unit().typed(half))
    };
    let next = match remarks.part {
        MeasuredPart::Uncorrected => {
            format!("passes that hold it at every height: {}", plan(&remarks.measurement.file))
        }
        MeasuredPart::Corrected => {
            format!("passes that hold it, from the points of the part cut without correction: {}", plan("FILE"))
        }
        MeasuredPart::FirstPass => {
            "a part that is made in one piece with more passes would be planned with truepath plan".to_owned()
        }
    };
    Some(pass.unit().remark(|unit| {
        let name = unit.name();
        format!(
            "one corrected pass {verb} {} {name} at every height of the wall: {:.4} ± {:.4} {name} (2 sigma) are expected at the worst place, s = {:.1} {name}, {:.1} {name} above the tip, most of it {}; {next}",
            unit.of(half),
            unit.of(expected),
            unit.of(twice_sigma),
            unit.of(after.s_mm),
            unit.of(after.height_mm),
            after.causes.largest()
        )
    }))
}

/// A correction that a part was cut with takes off nearly the same everywhere: the fit finds a cutter that is too large.
pub fn cut_corrected(identified: &Identification, correction: &Correction, unit: Unit) -> Option<String> {
    let peak = correction.predicted.iter().map(|p| p.before.mean.abs()).max().unwrap_or_default();
    let undersize = identified.fit().parameters.undersize;
    let is_far = Parameter::ALL
        .iter()
        .zip(&identified.fit().theta)
        .any(|(parameter, theta)| *parameter == Parameter::Undersize && truepath_ground::units::float(*theta) < -2.5);
    (is_far && undersize.nm() * -4 > peak.nm()).then(|| {
        format!(
            "Q008: the points look like those of a part that was cut with a correction, as if the cutter were {:.3} {} larger in radius: if it was, do not use this correction, which would take the place of that one, but learn from the part with truepath learn --from its folder",
            unit.of(mm(-undersize)),
            unit.name()
        )
    })
}

/// What the points of a pass may be of instead: a wall milled twice, or the first of two passes.
pub fn misread(measured: &Pass, first_pass: bool, contacts: &[Contact]) -> Vec<Remark> {
    let mut out = Vec::new();
    let passes = || measured.plan.iter().flat_map(|plan| &plan.passes);
    let height = passes().find(|p| !p.spring && p.number == measured.level()).and_then(|p| p.z);
    if let Some(spring) = passes().find(|p| p.spring && p.z == height) {
        let said = format!(
            "the spring pass of lines {}-{} goes over the probed wall: the points must have been touched before it. A wall milled twice shows too little of the force, and too little would be corrected",
            spring.lines.first, spring.lines.last
        );
        out.push(said.into());
    }
    let allowance = measured.core.setup.allowance;
    let mut errors: Vec<Offset> = contacts.iter().map(|contact| contact.error).collect();
    errors.sort_unstable();
    // An allowance below 0.1 mm is of the size of ordinary errors.
    if let Some(&median) = errors.get(errors.len() / 2)
        && !first_pass
        && allowance > Offset::from_um(100)
        && median.nm() * 5 > allowance.nm() * 2
    {
        out.push(measured.unit().remark(|unit| {
            format!(
                "the wall stands {:.3} {} off its place, {:.0} % of allowance_mm = {}: if that is the stock a first pass left, give --first-pass with its job; otherwise look at the probe and the origin",
                unit.of(mm(median)),
                unit.name(),
                100.0 * mm(median) / mm(allowance),
                mm(allowance)
            )
        }));
    }
    out
}

/// A kink of the written path beyond the one asked for.
pub fn kinked(difference: &Difference) -> Option<String> {
    let reason = if difference.largest_kink_beyond_path_deg > difference.max_kink_deg {
        "correct.tolerance_mm allows no smoother path"
    } else {
        "the correction itself changes that fast there"
    };
    (difference.largest_kink_deg > difference.max_kink_deg).then(|| {
        format!(
            "corrected.nc:{}: the path turns by {:.2} degrees on the spot (correct.max_kink_deg = {}): {reason}",
            difference.largest_kink_line, difference.largest_kink_deg, difference.max_kink_deg
        )
    })
}

/// Where the correction reverses an axis that the program does not reverse, backlash acts.
fn reversal((pass, unit): (&Pass, Unit), machine: &Loop, correction: &Correction) -> Option<String> {
    let path = machine.path;
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    for axis in 0..2 {
        let backlash = pass.job.backlash[axis];
        if backlash.nm() == 0 {
            continue;
        }
        for (i, pair) in samples.windows(2).enumerate() {
            let nominal = pair[1].point.from(pair[0].point);
            let change = correction.nodes[i + 1].total() - correction.nodes[i].total();
            let (n, c) = if axis == 0 { (nominal.x.nm(), change.x.nm()) } else { (nominal.y.nm(), change.y.nm()) };
            if n.abs() > 1_000 && (n + c).signum() == -n.signum() {
                return Some(format!(
                    "near s = {:.2} {} the correction reverses {} against the program: its backlash of {} {1} acts there",
                    unit.of(mm(pair[0].s)),
                    unit.name(),
                    ["X", "Y"][axis],
                    unit.of(mm(backlash))
                ));
            }
        }
    }
    None
}
