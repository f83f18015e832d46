//! `init`: the job of a program, with everything in it that the program says, and the answers to what only the user knows.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, IsTerminal, Write};
use std::path::{Path as FilePath, PathBuf};

use clap::Args;
use truepath_ground::codes::C001;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{Failure, InputError, Source, visible};
use truepath_ground::length::{self, Remark, Unit};
use truepath_ground::output::OutputFile;
use truepath_ground::units::mm;
use truepath_job::codes::J042;
use truepath_job::draft::{ContourNote, Draft, Entry, Origin};
use truepath_job::job::{DIALECTS, FORMATS, JobFile, MATERIALS};
use truepath_job::pass::Pass;

use crate::command::relative::relative;
use crate::streams::write_error;
use crate::terminal::Terminal;

/// What is asked for.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// The program of the part, as the machine runs it.
    pub program: PathBuf,
    /// The job file to write.
    #[arg(short, long, value_name = "FILE", default_value = "job.toml")]
    pub output: PathBuf,
    /// Ask nothing: take the default of everything that has one.
    #[arg(short, long)]
    pub yes: bool,
    /// Say a key: wall, allowance, diameter, teeth, helix, depth, material, stiffness, ball, contour, or any table.key of a
    /// job.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Print what would be asked, and write nothing.
    #[arg(long, conflicts_with = "yes")]
    pub questions: bool,
    /// Replace the file if it exists.
    #[arg(long)]
    pub force: bool,
}

/// Short names of keys.
const SHORT: [(&str, &[&str]); 16] = [
    ("allowance", &["stock.allowance_mm"]),
    ("diameter", &["tool.diameter_mm"]),
    ("teeth", &["tool.teeth"]),
    ("helix", &["tool.helix_deg"]),
    ("compensation", &["tool.compensation"]),
    ("tool", &["tool.number"]),
    ("depth", &["cut.axial_depth_mm"]),
    ("rpm", &["cut.spindle_rpm"]),
    ("feed", &["cut.feed_mm_per_min"]),
    ("material", &["force.material"]),
    ("stiffness", &["machine.stiffness_x_n_per_mm", "machine.stiffness_y_n_per_mm"]),
    ("ball", &["probe.ball_diameter_mm"]),
    ("format", &["probe.format"]),
    ("z_reference", &["probe.z_reference"]),
    ("name", &["part.name"]),
    ("tolerance", &["part.tolerance_mm"]),
];
/// Keys at the top of a job, and the number of the contour.
const TOP: [&str; 5] = ["dialect", "decimal", "arc_centres", "wall", "contour"];

/// What was written.
#[derive(Clone, Debug, serde::Serialize)]
struct Report {
    /// The job file.
    job: PathBuf,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    unit: Unit,
    /// Every key in it, and what was left out, with where it comes from.
    keys: Vec<Entry>,
    /// Finishing contours of the program.
    contours: Vec<ContourNote>,
    /// The one the job is about; null when it is about all.
    contour: Option<u32>,
    /// The contour in words.
    facts: Vec<String>,
    /// The command to go on with.
    next: String,
    /// What the user should know.
    warnings: Vec<Remark>,
}

/// A question.
#[derive(Clone, Debug, serde::Serialize)]
struct Question {
    /// Its short name, for `--set`.
    name: String,
    /// The keys that its answer fills.
    keys: Vec<String>,
    /// What is asked.
    text: String,
    /// The unit of the program, in which it is asked and answered on a terminal.
    #[serde(skip)]
    unit: Unit,
    /// What an empty answer takes; `None` where nothing can be taken.
    proposal: Option<String>,
    /// The words one can answer with, where there are only some.
    choices: Vec<&'static str>,
}

impl Question {
    /// Its text and what an empty answer takes, in the unit of the program.
    fn said(&self) -> (String, String) {
        let usual = self.proposal.as_ref().map(|proposal| proposal.trim_matches('"'));
        let inches = |number: &str| {
            let is_length = self.unit == Unit::Inch && self.keys.iter().any(|key| length::in_inches(key).is_some());
            let mm: f64 = number.parse().ok().filter(|_| is_length)?;
            Some(format!("{:.3}in", self.unit.of(mm)))
        };
        let said = |number: &str| inches(number).unwrap_or_else(|| number.to_owned());
        let mut text = self.unit.keys(&self.text).into_owned();
        if let Some((before, number)) = text.rsplit_once("(usual: ") {
            text = format!("{before}(usual: {})", said(number.trim_end_matches(')')));
        }
        (text, usual.map_or_else(String::new, |usual| format!(" [{}]", said(usual))))
    }

    /// An answer for one of its keys: where the key was asked in inches, so is a number without a unit.
    fn answered(&self, key: &str, answer: &str) -> (String, String) {
        let is_bare = answer.parse::<f64>().is_ok();
        match length::in_inches(key).filter(|_| self.unit == Unit::Inch && is_bare) {
            Some(key) => in_millimetres(key, answer),
            None => in_millimetres(key.to_owned(), answer),
        }
    }
}

/// The words that some keys take.
fn choices(name: &str) -> Vec<&'static str> {
    match name {
        "wall" => vec!["left", "right"],
        "compensation" => vec!["centre", "radius"],
        "dialect" => DIALECTS.iter().map(|(name, _)| *name).collect(),
        "format" => FORMATS.iter().map(|(name, _)| *name).collect(),
        "material" => MATERIALS.iter().map(|material| material.name).collect(),
        _ => Vec::new(),
    }
}

/// What `--questions` prints.
#[derive(Clone, Debug, serde::Serialize)]
struct Asked {
    /// Each with the name that `--set` takes and what an empty answer stands for.
    questions: Vec<Question>,
    /// The contour in words.
    facts: Vec<String>,
    /// What the user should know.
    warnings: Vec<Remark>,
}

/// Asks and writes.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    if options.questions {
        let asked = asked(options)?;
        terminal.warn_all(&asked.warnings);
        return terminal.tell(&asked, || format!("to be said:{}\n", listed(&asked.questions)));
    }
    let report = run(options, terminal)?;
    terminal.warn_all(&report.warnings);
    terminal.tell(&report, || words(&report))
}

/// What is still to be asked, after what `--set` says.
fn asked(options: &Options) -> Result<Asked, Failure> {
    let given = given(&options.set)?;
    let draft = Draft::of(&Source::read(&options.program)?, &given)?;
    let bare = |proposal: String| proposal.trim_matches('"').to_owned();
    let questions = questions(&draft, &given).into_iter();
    let questions = questions.map(|q| Question { proposal: q.proposal.map(bare), ..q }).collect();
    Ok(Asked { questions, facts: draft.facts, warnings: draft.warnings })
}

fn run(options: &Options, terminal: &Terminal) -> Result<Report, Failure> {
    // A target that may not be written is refused before anything is asked.
    let mut file = OutputFile::create(&options.output, options.force)?;
    let program = Source::read(&options.program)?;
    let mut given = given(&options.set)?;
    let asks = !options.yes && !terminal.json() && std::io::stdin().is_terminal() && std::io::stderr().is_terminal();
    let draft = if asks {
        answered(&program, &mut given)?
    } else {
        let draft = Draft::of(&program, &given)?;
        let open: Vec<Question> =
            questions(&draft, &given).into_iter().filter(|q| !options.yes || q.proposal.is_none()).collect();
        if !open.is_empty() {
            return Err(unanswered(&open, options.yes).into());
        }
        draft
    };
    let text = draft.text(&relative(&options.output, &options.program)?);
    // What was written has to be a job, and one that its program goes with.
    let folder = options.output.parent().unwrap_or(FilePath::new(""));
    let source = Source::new(options.output.display().to_string(), text.clone().into_bytes());
    let passes = Pass::every(JobFile::parse(source, folder)?)?;
    file.write_all(text.as_bytes()).map_err(|e| InputError::unwritable(&options.output, &e))?;
    file.commit()?;
    let dialect = match draft.probe_control {
        Some(_) => "",
        None => " --dialect haas|fanuc|linuxcnc|grbl",
    };
    // In conversational language no verification program is written: the places are listed.
    let lists = draft.probe_control.is_none() && passes.first().is_some_and(|p| p.job.numbers.dialect.is_klartext());
    let next = match lists {
        true => format!("truepath probe {}", options.output.display()),
        false => format!("truepath probe {}{dialect} -o verify.nc", options.output.display()),
    };
    let Draft { unit, entries, contours, chosen, facts, mut warnings, .. } = draft;
    warnings.extend(options.set.iter().filter_map(|text| doubtful_unit(text, unit)));
    for said in passes.into_iter().flat_map(|pass| pass.warnings) {
        if !said.starts_with("assumed ") && !warnings.contains(&said) {
            warnings.push(said);
        }
    }
    Ok(Report { job: options.output.clone(), unit, keys: entries, contours, contour: chosen, facts, next, warnings })
}

/// What `--set` says, by the keys of the job.
fn given(set: &[String]) -> Result<BTreeMap<String, String>, InputError> {
    let mut given = BTreeMap::new();
    for text in set {
        let wrong = |found: String, help: String| InputError::new(C001, found, "--set KEY=VALUE", help);
        let Some((key, value)) = text.split_once('=') else {
            let help = "write --set allowance=0.5".to_owned();
            return Err(wrong(format!("--set {text} has no `=`"), help));
        };
        let (key, value) = (key.trim(), value.trim().to_owned());
        if value.is_empty() {
            return Err(wrong(format!("--set {text} says no value"), format!("write --set {key}=VALUE")));
        }
        let keys: Vec<String> = match SHORT.iter().find(|(short, _)| *short == key) {
            Some((_, keys)) => keys.iter().map(|key| (*key).to_owned()).collect(),
            None if key.contains('.') || TOP.contains(&key) => vec![key.to_owned()],
            None => {
                let names: Vec<&str> = SHORT.iter().map(|(short, _)| *short).chain(TOP).collect();
                let help = format!("write one of {}, or a key of a job with its table, tool.teeth", names.join(", "));
                return Err(wrong(format!("--set {text} names no key"), help));
            }
        };
        given.extend(keys.into_iter().map(|key| in_millimetres(key, &value)));
    }
    Ok(given)
}

/// A length that was said in inches (`allowance=0.02in`, `tool.diameter_in=0.5`) in millimetres, as the draft reckons.
fn in_millimetres(key: String, value: &str) -> (String, String) {
    let number = ["inch", "in", "\""].iter().find_map(|unit| value.strip_suffix(unit));
    let (key, number) = match (length::in_millimetres(&key), number.filter(|_| length::in_inches(&key).is_some())) {
        (Some(key), number) => (key, number.or(Some(value))),
        (None, number) => (key, number),
    };
    match number.and_then(|number| Decimal::parse(number.trim())) {
        Some(inches) => (key, mm(inches.of_inches().as_mm()).to_string()),
        None => (key, value.to_owned()),
    }
}

/// A warning of a length without a unit, by a short name, for a program in inches.
fn doubtful_unit(set: &str, unit: Unit) -> Option<Remark> {
    let (name, value) = set.split_once('=').map(|(name, value)| (name.trim(), value.trim()))?;
    let (_, keys) = SHORT.iter().find(|(short, _)| *short == name).filter(|_| unit == Unit::Inch)?;
    let mm: f64 = value.parse().ok().filter(|_| keys.iter().any(|key| length::in_inches(key).is_some()))?;
    let inches = unit.of(mm);
    Some(format!(
        "the program is in inches, and --set {name}={value} says millimetres, {inches} in: {name}={value}in would be inches"
    ).into())
}

/// The short name of a key.
fn short(key: &str) -> String {
    let named = SHORT.iter().find(|(_, keys)| keys.contains(&key));
    named.map_or(key, |(short, _)| *short).to_owned()
}

/// What is still to be asked, in the order of the file.
fn questions(draft: &Draft, given: &BTreeMap<String, String>) -> Vec<Question> {
    let mut list: Vec<Question> = Vec::new();
    if draft.contours.len() > 1 && !given.contains_key("contour") {
        let one = |c: &ContourNote| {
            format!("\n  {}: lines {}-{}, {}", c.number, c.first_line, c.last_line, c.words(draft.unit))
        };
        let rows: String = draft.contours.iter().map(one).collect();
        let text = format!("The program makes {} walls. Which one is this job about?{rows}", draft.contours.len());
        let proposal = Some(draft.chosen.map_or_else(|| "all".to_owned(), |number| number.to_string()));
        list.push(Question {
            name: "contour".to_owned(),
            keys: vec!["contour".to_owned()],
            text,
            unit: draft.unit,
            proposal,
            choices: Vec::new(),
        });
    }
    for entry in &draft.entries {
        let asked = entry.origin == Origin::Open || (entry.origin == Origin::Default && entry.check);
        let left = entry.origin == Origin::Left;
        let name = short(&entry.key);
        if !(asked || left) || list.iter().any(|q| q.name == name) || entry.key == "probe.z_reference" {
            continue;
        }
        let keys = SHORT.iter().find(|(short, _)| *short == name).map(|(_, keys)| *keys);
        let keys = keys.map_or_else(|| vec![entry.key.clone()], |keys| keys.iter().map(|k| (*k).to_owned()).collect());
        let (_, key) = entry.place();
        let proposal = match entry.origin {
            Origin::Open => None,
            Origin::Left => Some("unknown".to_owned()),
            _ => Some(entry.value.clone()),
        };
        let text = match entry.origin {
            Origin::Open => format!("{key}: {} (usual: {})", entry.why, entry.value.trim_matches('"')),
            _ => format!("{key}: {}", entry.why),
        };
        let choices = choices(&name);
        list.push(Question { name, keys, text, unit: draft.unit, proposal, choices });
    }
    list
}

/// Questions, each as the `--set` that answers it.
fn listed(open: &[Question]) -> String {
    let one = |q: &Question| {
        let (text, usual) = q.said();
        format!("\n  --set {}=…{usual}   {}", q.name, text.replace('\n', "\n    "))
    };
    open.iter().map(one).collect()
}

/// The error of questions that nobody is there to answer.
fn unanswered(open: &[Question], defaults: bool) -> InputError {
    let list = listed(open);
    let found = match defaults {
        true => format!("the program does not show:{list}"),
        false => format!("nobody is at a terminal to answer, and the program does not show:{list}"),
    };
    J042.error(found, "")
}

/// Asks on the terminal until nothing is open.
fn answered(program: &Source, given: &mut BTreeMap<String, String>) -> Result<Draft, Failure> {
    let mut asked: BTreeSet<String> = BTreeSet::new();
    let mut draft = Draft::of(program, given)?;
    loop {
        let next = questions(&draft, given).into_iter().find(|q| !asked.contains(&q.name));
        let Some(question) = next else { return Ok(draft) };
        let Some(answer) = ask(&question)? else {
            asked.insert(question.name);
            continue;
        };
        let mut tried = given.clone();
        tried.extend(question.keys.iter().map(|key| question.answered(key, &answer)));
        // A wrong answer is asked again, with what is wrong about it.
        match Draft::of(program, &tried).and_then(|draft| draft.check().map(|()| draft)) {
            Ok(made) => {
                draft = made;
                *given = tried;
                asked.insert(question.name);
            }
            Err(Failure::Input(error)) => write_error(&format!("{}\n", visible(&error.to_string()))),
            Err(failure) => return Err(failure),
        }
    }
}

/// Asks once; `None` takes the proposal.
fn ask(question: &Question) -> Result<Option<String>, Failure> {
    loop {
        let (text, proposal) = question.said();
        write_error(&format!("{}{proposal}: ", visible_text(&text)));
        let mut answer = String::new();
        let read = std::io::stdin().lock().read_line(&mut answer);
        let length = read.map_err(|e| InputError::unreadable(FilePath::new("the terminal"), &e))?;
        let answer = answer.trim();
        match (answer.is_empty(), &question.proposal) {
            (false, _) => return Ok(Some(answer.to_owned())),
            (true, Some(_)) if length > 0 => return Ok(None),
            // The end of the input answers nothing.
            (true, _) if length == 0 => return Err(unanswered(std::slice::from_ref(question), false).into()),
            (true, _) => write_error("this has no default\n"),
        }
    }
}

fn visible_text(text: &str) -> String {
    text.lines().map(|line| visible(line).into_owned()).collect::<Vec<_>>().join("\n")
}

/// A key with its table, and its value, as they stand in the job.
fn in_file(entry: &Entry, unit: Unit) -> (String, String) {
    let (table, _) = entry.place();
    let (key, value) = entry.in_unit(unit);
    (if table.is_empty() { key } else { format!("{table}.{key}") }, value)
}

fn words(report: &Report) -> String {
    let mut text: String = report.facts.iter().map(|fact| format!("{fact}\n")).collect();
    text.push('\n');
    for entry in &report.keys {
        let (key, value) = in_file(entry, report.unit);
        let value = match entry.origin {
            Origin::Fixed => continue,
            Origin::Left => "-",
            _ => &value,
        };
        text += &format!("{key:<28} {value:<12} {}\n", entry.reason());
    }
    let check: Vec<String> = report
        .keys
        .iter()
        .filter(|e| e.check && e.origin != Origin::Given)
        .map(|e| in_file(e, report.unit).0)
        .collect();
    if !check.is_empty() {
        text += &format!("\nplease check before metal is cut: {}\n", check.join(", "));
    }
    text + &format!("\nwritten to {}; go on with: {}\n", report.job.display(), report.next)
}
