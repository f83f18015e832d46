//! A probe file → contacts on the wall, and what was set aside.

use truepath_core::identify::Observation;
use truepath_core::probe::{
    Contact, Contacts, Format, LengthUnit, ProbeError, Reading, Rejected, Setting, Suspicion, read, suspect,
};
use truepath_core::units::Offset;

use crate::diagnostics::{Failure, InputError, Source};
use crate::job::{ProbeFormat, ZReference};
use crate::pass::{Pass, length_unit};

/// Readings kept at most.
const LARGEST_FILE: usize = 1 << 20;
/// A reading farther than this from the nominal wall is not of this wall.
const REACH: Offset = Offset::from_um(1_000);

/// What a probe file says about a pass.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Contacts in the order of the contour, then of height.
    pub contacts: Vec<Contact>,
    /// Readings set aside: line and reason.
    pub rejected: Vec<(u32, Rejected)>,
    /// Standard deviation of one reading.
    pub noise: Offset,
}

impl Measurement {
    /// Reads a probe file.
    ///
    /// # Errors
    /// What is wrong with the file, and a wrong unit, frame or ball, named, when most readings are off the wall.
    pub fn read(pass: &Pass, file: &Source) -> Result<Self, Failure> {
        let probe = pass.job.require_probe()?;
        let (format, unit) = match probe.format {
            ProbeFormat::LinuxCnc => (Format::Linuxcnc, length_unit(&pass.contour)),
            ProbeFormat::Columns => (Format::Columns, LengthUnit::Millimetre),
        };
        let most = file.bytes().iter().filter(|b| matches!(b, b'\n' | b'\r')).count() + 1;
        let mut readings = vec![Reading::default(); most.min(LARGEST_FILE)];
        let count = read(file.bytes(), format, unit, &mut readings).map_err(|e| of_probe(file, &e))?;
        readings.truncate(count);
        let setting = Setting {
            ball_radius: Offset::from_nm(probe.ball_diameter.nm() / 2),
            cutter_radius: pass.setup.radius,
            wall: pass.setup.wall,
            tip_z: pass.contour.z,
            axial_depth: pass.job.cut.axial_depth,
            z_is_tip: probe.z_reference == ZReference::Tip,
            reach: REACH,
        };
        let on_wall = Contacts::new(pass.path_contour(), setting);
        if let Some(suspicion) = suspect(&on_wall, &readings) {
            return Err(off_the_wall(file, &on_wall, &readings, suspicion).into());
        }
        let mut contacts = Vec::with_capacity(count);
        let mut rejected = Vec::new();
        for reading in &readings {
            match on_wall.contact(reading) {
                Ok(contact) => contacts.push(contact),
                Err(reason) => rejected.push((reading.line, reason)),
            }
        }
        if contacts.is_empty() {
            return Err(no_contact(pass, file, &rejected).into());
        }
        contacts.sort_by_key(|c| (c.s, c.height, c.line));
        Ok(Self { contacts, rejected, noise: probe.noise })
    }

    /// The contacts as observations for the fit. Those of one place are taken at their common foot, where the elastic
    /// loop is solved once.
    pub fn observations(&self) -> Vec<Observation> {
        let mut place: Option<Offset> = None;
        self.contacts
            .iter()
            .map(|c| {
                let s = place.filter(|p| same_place(*p, c.s)).unwrap_or(c.s);
                place = Some(s);
                Observation::new(s, c.height, c.error, self.noise, c.normal)
            })
            .collect()
    }

    /// One sentence for every reading set aside.
    pub fn remarks(&self, file: &Source) -> Vec<String> {
        self.rejected
            .iter()
            .map(|(line, reason)| format!("{}:{line}: set aside: {}", file.name(), why(reason)))
            .collect()
    }
}

/// Whether two contacts were probed at one place of the contour, at different heights: their feet differ by the error
/// of the wall only.
pub fn same_place(a: Offset, b: Offset) -> bool {
    (b - a).abs() < Offset::from_um(5)
}

fn mm(v: Offset) -> f64 {
    v.nm() as f64 / 1e6
}

fn why(reason: &Rejected) -> String {
    match reason {
        Rejected::OffTheWall { distance } if *distance == Offset::MAX => "beyond the ends of the contour".to_owned(),
        Rejected::OffTheWall { distance } => format!("{:.3} mm from the nominal wall", mm(*distance)),
        Rejected::OffHeight { height } => {
            format!("{:.3} mm above the cutter's tip, outside the engaged depth", mm(*height))
        }
    }
}

fn of_probe(file: &Source, error: &ProbeError) -> Failure {
    let found = match error.len {
        0 => error.kind.to_string(),
        _ => format!("`{}`: {}", file.excerpt(error.start..error.start + error.len), error.kind),
    };
    let (found, expected) = found.split_once("; ").map_or((found.as_str(), ""), |(a, b)| (a, b));
    let expected = expected.trim_end_matches(" was expected").trim_start_matches("expected ");
    InputError::new(error.kind.code(), found, expected, error.kind.help())
        .at(file, error.start..error.start + error.len)
        .into()
}

/// The whole line of a reading.
fn line_span(file: &Source, line: u32) -> std::ops::Range<usize> {
    let start = file.span_at(line, 1, 0).start;
    let len = file.bytes()[start..].iter().take_while(|b| !matches!(b, b'\n' | b'\r')).count();
    start..start + len
}

fn off_the_wall(file: &Source, contacts: &Contacts, readings: &[Reading], why: Suspicion) -> InputError {
    let reach = mm(REACH);
    let first = readings.iter().find(|r| matches!(contacts.contact(r), Err(Rejected::OffTheWall { .. })));
    let span = first.map_or(0..0, |r| line_span(file, r.line));
    let (code, guess, help) = match why {
        Suspicion::Inches => (
            "M011",
            "they fit when read as inches",
            "the file is in inches and the program in millimetres: convert it, or probe with the program's unit active",
        ),
        Suspicion::Millimetres => (
            "M012",
            "they fit when read as millimetres",
            "the file is in millimetres and the program in inches: convert it, or probe with the program's unit active",
        ),
        Suspicion::BallRadius => (
            "M013",
            "they fit with another ball",
            "check ball_diameter_mm: it is a diameter, and the file must hold ball centres, not surface points",
        ),
        Suspicion::OtherSide => (
            "M016",
            "they fit a wall on the other side of travel",
            "change wall in the job (or G41/G42 in the program): it is the side of the finished wall as seen in the direction of travel",
        ),
        Suspicion::Frame => (
            "M014",
            "probably they are in another frame",
            "the file must be in the work coordinates of the program (G54), not in machine coordinates; check also the program named in the job and the side of the wall",
        ),
    };
    let found = format!("most readings are farther than {reach} mm from the nominal wall; {guess}");
    InputError::new(code, found, "readings on the wall of this contour", help).at(file, span)
}

fn no_contact(pass: &Pass, file: &Source, rejected: &[(u32, Rejected)]) -> InputError {
    let (line, reason) = rejected.first().map_or((1, String::new()), |(line, r)| (*line, why(r)));
    let tip = pass.contour.z.nm() as f64 / 1e6;
    let top = tip + mm(pass.job.cut.axial_depth);
    InputError::new(
        "M015",
        format!("no reading can be used; the first one is {reason}"),
        format!("ball centres between Z {tip} and Z {top} beside the wall"),
        "probe within the engaged depth; check axial_depth_mm and z_reference in the job",
    )
    .at(file, line_span(file, line))
}
