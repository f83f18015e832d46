//! What is wrong with a probe file or its readings, as the user meets it.

use truepath_core::job::{JobError, REACH};
use truepath_core::probe::{ProbeError, Rejected, Suspicion};
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

use crate::job::JobFile;

/// What is wrong with a probe file.
pub(super) fn of_probe(file: &Source, error: &ProbeError) -> InputError {
    let found = match error.len {
        0 => error.kind.to_string(),
        _ => format!("`{}`: {}", file.excerpt(error.start..error.start + error.len), error.kind),
    };
    let (found, expected) = found.split_once("; ").map_or((found.as_str(), ""), |(a, b)| (a, b));
    let expected = expected.trim_end_matches(" was expected").trim_start_matches("expected ");
    InputError::of_core(error.kind.code(), found, expected, error.kind.help())
        .at(file, error.start..error.start + error.len)
}

/// Readings that do not belong to the wall of the job.
pub(super) fn of_contacts(error: &JobError, job: &JobFile, unit: Unit) -> InputError {
    match error {
        JobError::OffTheWall { suspicion, .. } => {
            let (guess, help) = suspected(*suspicion, unit);
            let found = match suspicion {
                Suspicion::Normals => format!("most readings are on the wall, but {guess}"),
                _ => {
                    let (reach, name) = (unit.of(mm(REACH)), unit.name());
                    format!("most readings are farther than {reach:.0} {name} from the nominal wall; {guess}")
                }
            };
            InputError::of_core(error.code(), found, "readings on the wall of this contour", help)
        }
        JobError::NoContact { reason, tip, .. } => {
            let tip = tip.nm() as f64 / 1e6;
            let [tip, top] = [tip, tip + mm(job.numbers.cut.axial_depth)].map(|z| unit.of(z));
            InputError::of_core(
                error.code(),
                format!("no reading can be used; the first one is {}", why(reason, unit)),
                format!("ball centres between Z {tip} and Z {top} beside the wall"),
                "probe within the engaged depth; check axial_depth_mm and z_reference in the job",
            )
        }
        _ => InputError::of_core(error.code(), error.to_string(), "", "check the probe file"),
    }
}

/// What may be wrong with the readings, and what to do about it.
pub(crate) fn suspected(suspicion: Suspicion, unit: Unit) -> (String, &'static str) {
    let help = match suspicion {
        Suspicion::Inches => {
            "the file is in inches and was read in millimetres: convert it, say so in [probe] (unit of columns), or probe with the program's unit active"
        }
        Suspicion::Millimetres => {
            "the file is in millimetres and was read in inches: convert it, say so in [probe] (unit of columns), or probe with the program's unit active"
        }
        Suspicion::BallTwice => "ball_diameter_mm looks like the ball's radius: it is the diameter, twice as much",
        Suspicion::BallHalf => {
            "ball_diameter_mm looks like twice the ball's diameter: it is the diameter, not its double"
        }
        Suspicion::Surface => {
            "check ball_diameter_mm: it is a diameter, and the file must hold ball centres, not surface points; for columns say point = \"surface\""
        }
        Suspicion::Centre => {
            "the file holds ball centres: for columns say point = \"tip\"; for G801 print the radius as R"
        }
        Suspicion::OtherSide => {
            "change wall in the job (or G41/G42 in the program): it is the side of the finished wall as seen in the direction of travel"
        }
        Suspicion::Swapped => "exchange the columns of X and Y, or check how the part lay when it was probed",
        Suspicion::MirroredX | Suspicion::MirroredY => {
            "turn the sign of that column, or check how the part lay when it was probed"
        }
        Suspicion::Normals => {
            "turn the sign of the normals: they point from the wall to the free side, where the probe comes from"
        }
        Suspicion::Shifted { .. } => {
            "the file must be in the work coordinates of the program (G54): probe with the same work offset, or take machine coordinates with frame = \"machine\" and work_offset_mm"
        }
        Suspicion::Frame => {
            "the file must be in the work coordinates of the program (G54), not in machine coordinates; check also the program named in the job and the side of the wall"
        }
    };
    let words = match suspicion {
        Suspicion::Shifted { by: [x, y] } => format!(
            "they fit when about X {:.1} and Y {:.1} {} are taken off all of them: they are in another frame",
            unit.of(mm(x) + 0.0),
            unit.of(mm(y) + 0.0),
            unit.name()
        ),
        _ => suspicion.to_string(),
    };
    (words, help)
}

/// Why a reading is set aside.
pub fn why(reason: &Rejected, unit: Unit) -> String {
    let name = unit.name();
    match reason {
        Rejected::OffTheWall { distance } if *distance == Offset::MAX => "beyond the ends of the contour".to_owned(),
        Rejected::OffTheWall { distance } => format!("{:.3} {name} from the nominal wall", unit.of(mm(*distance))),
        Rejected::OffHeight { height } => {
            format!("{:.3} {name} above the cutter's tip, outside the engaged depth", unit.of(mm(*height)))
        }
        Rejected::Missed => "a miss: the probe did not touch".to_owned(),
        Rejected::Superseded => "an approach: the next touch is of the same place and counts".to_owned(),
        Rejected::Repeat { of } => format!("the same point as in line {of}"),
        Rejected::Normal { opposite: true } => {
            "its normal in the file points into the wall that is nearest to it".to_owned()
        }
        Rejected::Normal { opposite: false } => {
            "its normal in the file is more than 30 degrees off that of the nearest wall".to_owned()
        }
    }
}

/// The whole line of a reading.
pub(crate) fn line_span(file: &Source, line: u32) -> std::ops::Range<usize> {
    let start = file.span_at(line, 1, 0).start;
    let len = file.bytes()[start..].iter().take_while(|b| !matches!(b, b'\n' | b'\r')).count();
    start..start + len
}
