//! Wrong data stop, honest data do not: parts of the study, milled by the plant, with everything wrong in turn.

use std::fmt::Write as _;
use std::path::{Path as FilePath, PathBuf};

use truepath_correction::correction::identify;
use truepath_correction::misfit::{Cause, Misfit, judged};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_study::case::Case;
use truepath_study::draw::Draw;
use truepath_study::families::FAMILIES;
use truepath_trial::virtual_mill;

/// A part, milled by a worn cutter and touched.
struct Shop {
    case: Case,
    touched: String,
}

/// What became of points.
#[derive(Debug)]
enum Outcome {
    Passed,
    /// Refused by code when job or file were read.
    Refused(String),
    Stopped(Box<Misfit>),
}

/// The largest undersize of a worn cutter, mm.
const WORN_MM: f64 = 0.03;

fn source(name: &str, text: &str) -> Source {
    Source::new(name, text.as_bytes().to_vec())
}

impl Shop {
    /// `None` where the case has no wall at its places.
    fn new(family: &str, seed: u64) -> Option<Self> {
        let case = Case::draw(&format!("{family}/{seed}").parse().unwrap()).unwrap();
        let undersize = Draw::new(&format!("{family}/worn"), seed).between(0.0, WORN_MM);
        let mut machine = case.machine.clone();
        machine.runout_mm.resize(case.pass.core.setup.teeth.into(), 0.0);
        for tooth in &mut machine.runout_mm {
            *tooth -= undersize;
        }
        let milled = virtual_mill::mill(&case.pass, &machine, None).unwrap();
        let touched = case.probe(1, &milled, &case.places_mm).ok()?;
        Some(Self { case, touched })
    }

    /// A case as the study has it.
    fn of_study(id: &str) -> Self {
        let case = Case::draw(&id.parse().unwrap()).unwrap();
        let touched = case.probe(1, &case.first, &case.places_mm).unwrap();
        Self { case, touched }
    }

    fn outcome(&self, job: &str, touched: &str) -> Outcome {
        let refused = |failure: Failure| match failure {
            Failure::Input(error) => Outcome::Refused(error.code().to_owned()),
            failure => panic!("{failure}"),
        };
        let pass = JobFile::parse(source("job.toml", job), FilePath::new("")).map_err(Failure::from);
        let pass = pass.and_then(|job| Pass::new(job, source("program.nc", &self.case.program)));
        let pass = match pass {
            Ok(pass) => pass,
            Err(failure) => return refused(failure),
        };
        let measurement = match Measurement::read(&pass, &source("probe.txt", touched)) {
            Ok(measurement) => measurement.taken_as_is(true),
            Err(failure) => return refused(failure),
        };
        let mut buffer = PathBuffer::default();
        let path = match pass.sample(&mut buffer) {
            Ok(path) => path,
            Err(failure) => return refused(failure),
        };
        let found = identify(&pass, &path, &measurement, |_| ()).unwrap();
        judged(&pass, &measurement, &found.core, &found.observations)
            .map_or(Outcome::Passed, |misfit| Outcome::Stopped(Box::new(misfit)))
    }

    fn honest(&self) -> Outcome {
        self.outcome(&self.case.job, &self.touched)
    }

    fn wrong(&self, wrong: Wrong) -> Outcome {
        self.outcome(&wrong.job(&self.case.job), &wrong.points(&self.touched))
    }

    /// The points with up to two of twelve, one of six, that met something else.
    fn with_wild_touches(&self, seed: u64) -> String {
        let count = self.touched.lines().count();
        let mut chance = Draw::new("wild", seed);
        let wild: Vec<(usize, [f64; 2])> = (0..(count / 6).min(2))
            .map(|_| {
                let at = chance.between(0.0, count as f64) as usize;
                (at, [chance.between(-0.8, 0.8), chance.between(-0.8, 0.8)])
            })
            .collect();
        moved(&self.touched, |k, [x, y, z]| {
            let off = wild.iter().find(|(at, _)| *at == k).map_or([0.0; 2], |(_, off)| *off);
            [x + off[0], y + off[1], z]
        })
    }
}

fn moved(text: &str, change: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> String {
    let mut out = String::new();
    for (k, line) in text.lines().enumerate() {
        let numbers: Vec<f64> = line.split_whitespace().map(|number| number.parse().unwrap()).collect();
        let [x, y, z] = change(k, [numbers[0], numbers[1], numbers[2]]);
        writeln!(out, "{x:.6} {y:.6} {z:.6} 0 0 0 0 0 0").unwrap();
    }
    out
}

/// The job with another value of a key.
fn set(job: &str, key: &str, value: impl Fn(f64) -> f64) -> String {
    let mut out = String::new();
    for line in job.lines() {
        match line.split_once(" = ").filter(|(k, _)| *k == key) {
            Some((_, number)) => {
                let number = value(number.parse().unwrap());
                let decimals = if key == "teeth" { 0 } else { 4 };
                writeln!(out, "{key} = {number:.decimals$}").unwrap();
            }
            None => writeln!(out, "{line}").unwrap(),
        }
    }
    out
}

/// What is wrong.
#[derive(Clone, Copy, Debug)]
enum Wrong {
    Datum(f64),
    Sign,
    Allowance(f64),
    Teeth(f64),
    Helix(f64),
    Side,
    BallBy(f64),
    BallTimes(f64),
    Height(f64),
    Inch,
    Utf16,
    Format,
}

const ALL: [Wrong; 29] = [
    Wrong::Datum(0.05),
    Wrong::Datum(0.1),
    Wrong::Datum(0.2),
    Wrong::Datum(0.5),
    Wrong::Datum(0.9),
    Wrong::Datum(20.0),
    Wrong::Sign,
    Wrong::Allowance(0.1),
    Wrong::Allowance(0.5),
    Wrong::Allowance(2.0),
    Wrong::Allowance(10.0),
    Wrong::Teeth(0.5),
    Wrong::Teeth(2.0),
    Wrong::Helix(0.0),
    Wrong::Helix(2.0),
    Wrong::Side,
    Wrong::BallBy(-0.5),
    Wrong::BallBy(-0.2),
    Wrong::BallBy(-0.1),
    Wrong::BallBy(0.2),
    Wrong::BallBy(0.5),
    Wrong::BallTimes(0.5),
    Wrong::BallTimes(2.0),
    Wrong::Height(0.5),
    Wrong::Height(2.0),
    Wrong::Height(-2.0),
    Wrong::Inch,
    Wrong::Utf16,
    Wrong::Format,
];

impl Wrong {
    fn name(self) -> String {
        match self {
            Self::Datum(mm) => format!("datum shifted by {mm} mm"),
            Self::Sign => "sign of the deviations reversed".to_owned(),
            Self::Allowance(times) => format!("allowance in the job × {times}"),
            Self::Teeth(times) => format!("teeth in the job × {times}"),
            Self::Helix(times) => format!("helix in the job × {times}, at most 60 degrees"),
            Self::Side => "wall on the other side".to_owned(),
            Self::BallBy(mm) => format!("ball diameter in the job {mm:+} mm"),
            Self::BallTimes(times) => format!("ball diameter in the job × {times}"),
            Self::Height(mm) => format!("Z of the points {mm:+} mm"),
            Self::Inch => "points in inches".to_owned(),
            Self::Utf16 => "probe file in UTF-16".to_owned(),
            Self::Format => "probe file of another format".to_owned(),
        }
    }

    fn job(self, job: &str) -> String {
        match self {
            Self::Allowance(times) => set(job, "allowance_mm", |v| v * times),
            Self::Teeth(times) => set(job, "teeth", |v| (v * times).round()),
            Self::Helix(times) => set(job, "helix_deg", |v| (v * times).min(60.0)),
            Self::BallBy(mm) => set(job, "ball_diameter_mm", |v| v + mm),
            Self::BallTimes(times) => set(job, "ball_diameter_mm", |v| v * times),
            Self::Side if job.contains("\"right\"") => job.replace("\"right\"", "\"left\""),
            Self::Side => job.replace("\"left\"", "\"right\""),
            Self::Format => job.replace("format = \"linuxcnc\"", "format = \"grbl\""),
            _ => job.to_owned(),
        }
    }

    fn points(self, text: &str) -> String {
        match self {
            Self::Datum(mm) => moved(text, |_, [x, y, z]| [x + 0.8 * mm, y - 0.6 * mm, z]),
            Self::Height(mm) => moved(text, |_, [x, y, z]| [x, y, z + mm]),
            Self::Inch => moved(text, |_, point| point.map(|v| v / 25.4)),
            _ => text.to_owned(),
        }
    }

    /// Whether a stop names it.
    fn is_named(self, outcome: &Outcome) -> bool {
        match outcome {
            // The file is read as what it is, and the summary says so.
            Outcome::Passed => matches!(self, Self::Format),
            Outcome::Refused(code) => match self {
                Self::Datum(_) => code == "M014",
                Self::Side => code == "M016",
                Self::BallBy(_) | Self::BallTimes(_) => code == "M013",
                Self::Inch => code == "M011",
                Self::Allowance(_) => code == "J003",
                Self::Utf16 => code == "J044",
                _ => false,
            },
            Outcome::Stopped(misfit) => misfit.causes.iter().any(|trial| match (self, trial.cause) {
                (Self::Datum(mm), Cause::Datum([x, y])) => (x - 0.8 * mm).hypot(y + 0.6 * mm) < 0.02 + 0.2 * mm,
                (Self::BallBy(mm), Cause::Level(off)) => (off + 0.5 * mm).abs() < 0.05,
                (Self::Allowance(_), Cause::Allowance(_))
                | (Self::Teeth(_), Cause::Teeth(_))
                | (Self::Helix(_), Cause::Helix(_))
                | (Self::Sign, Cause::Sign)
                | (Self::Side, Cause::Spindle) => true,
                (Self::Height(mm), Cause::Height(by)) => by * mm < 0.0,
                _ => false,
            }),
        }
    }
}

/// With what is wrong in the bytes or in the core's readings, not in numbers of a text.
fn outcome(shop: &Shop, wrong: Wrong) -> Outcome {
    match wrong {
        Wrong::Utf16 => {
            let bytes = shop.touched.encode_utf16().flat_map(u16::to_le_bytes).collect();
            match Measurement::read(&shop.case.pass, &Source::new("probe.txt", bytes)) {
                Err(Failure::Input(error)) => Outcome::Refused(error.code().to_owned()),
                other => panic!("{other:?}"),
            }
        }
        Wrong::Sign => {
            // The walls as far to the other side of their places as they were found: by the contacts themselves.
            let honest = Measurement::read(&shop.case.pass, &source("probe.txt", &shop.touched)).unwrap();
            let turned = moved(&shop.touched, |k, [x, y, z]| {
                let of = honest.contacts.iter().find(|c| c.line as usize == k + 1);
                of.map_or([x, y, z], |c| {
                    let off = 2.0 * truepath_ground::units::mm(c.error);
                    let [nx, ny] = [c.normal.x, c.normal.y].map(truepath_ground::units::float);
                    [x + nx * off, y + ny * off, z]
                })
            });
            shop.outcome(&shop.case.job, &turned)
        }
        wrong => shop.wrong(wrong),
    }
}

#[test]
fn a_datum_half_a_millimetre_off_is_named_and_the_honest_part_passes() {
    let shop = Shop::new("pocket-climb", 1002).unwrap();
    assert!(matches!(shop.honest(), Outcome::Passed));
    for wrong in [Wrong::Datum(0.05), Wrong::Datum(0.5), Wrong::BallBy(0.5)] {
        let outcome = shop.wrong(wrong);
        assert!(wrong.is_named(&outcome), "{wrong:?}: {outcome:?}");
    }
}

#[test]
fn a_cross_compliance_that_the_stated_mean_law_hardly_expects_stops_nothing() {
    // The law of the papers describes a machine by two stiffnesses; this one yields across by a third of its mean.
    let shop = Shop::of_study("corner-papers/100000/chosen");
    assert!(matches!(shop.honest(), Outcome::Passed), "{:?}", shop.honest());
    assert!(matches!(shop.wrong(Wrong::Datum(0.5)), Outcome::Stopped(_)));
}

#[test]
#[ignore = "slow: honest parts that every cause is tried on, half a minute"]
fn what_shops_have_beside_the_model_stops_nothing() {
    // A corner with waves and a step in the stock: two teeth less in the cut there, which a cutter of two teeth explains as well. A
    // boss whose points a larger cutter under the mean law fits a little better than the helical law does.
    for id in ["corner-far/1001/all/chosen", "boss/1001/all"] {
        let shop = Shop::of_study(id);
        assert!(matches!(shop.honest(), Outcome::Passed), "{id}: {:?}", shop.honest());
    }
}

/// Parts with all that shops add that are stopped all the same: uneven stock that no smooth field and no machine explains. Three of 128
/// over four seeds.
const KNOWN: [&str; 3] = ["corner-sharp/1003/all/chosen", "corners-two/1003/all/chosen", "s-arcs/1004/all/chosen"];

/// Honest parts with all that shops add, of these seeds; fails where others are stopped than those that are known.
fn pass_but_for_known(seeds: &[u64]) {
    let ids = seeds.iter().flat_map(|seed| FAMILIES.iter().map(move |f| format!("{}/{seed}/all/chosen", f.name)));
    let (mut honest, mut stopped) = (0, Vec::new());
    for id in ids {
        let Ok(case) = Case::draw(&id.parse().unwrap()) else { continue };
        let Ok(touched) = case.probe(1, &case.first, &case.places_mm) else { continue };
        honest += 1;
        match (Shop { case, touched }).honest() {
            Outcome::Passed => {}
            outcome => {
                println!("{id}: {outcome:?}");
                stopped.push(id);
            }
        }
    }
    let others: Vec<_> = stopped.iter().filter(|id| !KNOWN.contains(&id.as_str())).collect();
    assert!(
        honest > 25 * seeds.len() && others.is_empty(),
        "{honest} honest parts, stopped besides those that are known: {others:?}"
    );
}

#[test]
#[ignore = "slow: honest parts of shops, a minute"]
fn honest_parts_with_all_that_shops_add_pass_but_for_two() {
    pass_but_for_known(&[1003]);
}

#[test]
#[ignore = "campaign: minutes"]
fn campaign_honest_parts_with_all_that_shops_add_pass_but_for_three() {
    pass_but_for_known(&[1003, 1004]);
}

#[test]
fn the_error_names_shift_points_and_the_way_on() {
    let shop = Shop::new("corner-papers-helix", 1002).unwrap();
    let touched = Wrong::Datum(0.5).points(&shop.touched);
    let measurement = Measurement::read(&shop.case.pass, &source("probe.txt", &touched)).unwrap();
    let mut buffer = PathBuffer::default();
    let path = shop.case.pass.sample(&mut buffer).unwrap();
    let Err(Failure::Input(error)) = identify(&shop.case.pass, &path, &measurement, |_| ()) else { panic!("passed") };
    let text = error.to_string();
    assert_eq!(error.code(), "Q009", "{text}");
    assert!(text.contains("when X 0.4") && text.contains("as stated: rms"), "{text}");
    let forced = measurement.taken_as_is(true);
    assert!(identify(&shop.case.pass, &path, &forced, |_| ()).is_ok());
}

#[test]
fn files_in_two_bytes_a_character_and_of_another_format_are_named() {
    let shop = Shop::new("pocket-climb", 1002).unwrap();
    for wrong in [Wrong::Utf16, Wrong::Format, Wrong::Inch, Wrong::Side] {
        let outcome = outcome(&shop, wrong);
        assert!(wrong.is_named(&outcome), "{wrong:?}: {outcome:?}");
    }
}

/// Parts of the table: family, seed, heading.
const PARTS: [(&str, u64, &str); 3] = [
    ("corner-papers-helix", 1002, "inside corner"),
    ("pocket-climb", 1002, "pocket"),
    ("outside-climb", 1002, "outside profile"),
];

#[test]
#[ignore = "slow: 87 wrong data, each with all alternatives, minutes; BLESS=1 renews docs/wrong-data.md"]
fn the_table_of_wrong_data_is_that_of_the_document() {
    let shops: Vec<Shop> = PARTS.iter().map(|(family, seed, _)| Shop::new(family, *seed).unwrap()).collect();
    let mut table = String::from("| wrong |");
    for (_, _, heading) in PARTS {
        write!(table, " {heading} |").unwrap();
    }
    table += "\n|---|---|---|---|\n";
    for wrong in ALL {
        write!(table, "| {} |", wrong.name()).unwrap();
        for shop in &shops {
            let outcome = outcome(shop, wrong);
            let named = wrong.is_named(&outcome);
            let word = match (&outcome, named) {
                (Outcome::Passed, true) => "is read as what it is".to_owned(),
                (Outcome::Passed, false) => "goes on".to_owned(),
                (Outcome::Refused(code), true) => format!("stops, named ({code})"),
                (Outcome::Refused(code), false) => format!("stops ({code})"),
                (Outcome::Stopped(_), true) => "stops, named".to_owned(),
                (Outcome::Stopped(misfit), false) if misfit.causes.is_empty() => "stops, no cause found".to_owned(),
                (Outcome::Stopped(_), false) => "stops, **another cause named**".to_owned(),
            };
            write!(table, " {word} |").unwrap();
        }
        table.push('\n');
    }
    let place = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/wrong-data.md");
    let document = std::fs::read_to_string(&place).unwrap();
    let (from, to) = ("<!-- wrong data begin -->\n", "<!-- wrong data end -->");
    let from = document.find(from).unwrap() + from.len();
    let to = document.find(to).unwrap();
    if std::env::var_os("BLESS").is_some() && document[from..to] != table {
        let renewed = [&document[..from], &table, &document[to..]].concat();
        std::fs::write(&place, renewed).unwrap();
        return;
    }
    assert!(document[from..to] == table, "docs/wrong-data.md (BLESS=1 renews it) has another table:\n{table}");
}

#[test]
#[ignore = "slow: 64 honest parts, each also with wild touches"]
fn honest_parts_pass_and_wild_touches_are_named_where_they_bend_the_fit() {
    // A usual machine of every family and a wild one.
    pass_with_wild_touches(&[1002, 100_001]);
}

#[test]
#[ignore = "campaign: 256 honest parts, each also with wild touches"]
fn campaign_honest_parts_pass_and_wild_touches_are_named_where_they_bend_the_fit() {
    pass_with_wild_touches(&[1002, 1003, 1004, 1005, 100_001, 100_002, 100_003, 100_004]);
}

/// Honest parts of these seeds, as touched and with wild touches.
fn pass_with_wild_touches(seeds: &[u64]) {
    let (mut honest, mut wild, mut named, mut misnamed) = (0, 0, 0, 0);
    let cases: Vec<_> = seeds.iter().flat_map(|seed| FAMILIES.iter().map(move |f| (f.name, *seed))).collect();
    let mut wrong = Vec::new();
    for (family, seed) in cases {
        let Some(shop) = Shop::new(family, seed) else { continue };
        honest += 1;
        if let outcome @ (Outcome::Refused(_) | Outcome::Stopped(_)) = shop.honest() {
            wrong.push(format!("{family}/{seed}: {outcome:?}"));
        }
        if shop.touched.lines().count() < 6 {
            continue;
        }
        wild += 1;
        match shop.outcome(&shop.case.job, &shop.with_wild_touches(seed)) {
            Outcome::Passed => {}
            Outcome::Stopped(misfit) if misfit.causes.iter().all(|t| matches!(t.cause, Cause::Stray(_))) => named += 1,
            outcome => {
                println!("{family}/{seed} with wild touches: {outcome:?}");
                misnamed += 1;
            }
        }
    }
    println!(
        "{honest} honest parts; {wild} with wild touches, {named} of them stopped for these, {misnamed} for others"
    );
    assert!(honest > 25 * seeds.len() && wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(20 * named < wild && 100 * misnamed < wild, "{named} and {misnamed} of {wild}");
}
