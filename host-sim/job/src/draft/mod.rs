//! The job that a program asks for: what is read from it, what has a default, and what only the user knows.
//!
//! A draft is made anew with every answer, because answers hang on each other: the contour decides the cutter, the cutter what
//! counts as a roughing pass, that pass the allowance. Its text is a job file whose every line says where its value comes
//! from.
//!
//! | of | where |
//! |---|---|
//! | what a draft holds | `contents` |
//! | one key of the job with its origin | `entry` |
//! | the side of the wall, where no G41 says it | `side` |
//! | the text of the file | `text` |

mod contents;
mod side;
mod text;

use contents::toml_value;
pub use contents::{ContourNote, Draft, Entry, Origin};

use std::collections::BTreeMap;
use std::path::Path;

use truepath_core::gcode::{Criteria, Found, Role};
use truepath_core::geometry::Side;
use truepath_core::job::Compensation;
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::{float, mm, nm};

use crate::drawn::drawn;
use crate::feature::{LARGEST_SEARCH, Survey};
use crate::job::{JobFile, MATERIALS, USUAL_FORCE, USUAL_HELIX, USUAL_STIFFNESS, dialect_name};
use crate::pass::Pass;
use crate::post::{Post, Shape, ToolNote};
use side::{Shown, likely, side};

/// The allowance that most CAM systems leave: a twentieth of the diameter, half a millimetre at most.
fn usual_allowance(diameter: f64) -> f64 {
    ((diameter / 20.0).min(0.5) * 100.0).round() / 100.0
}

/// The largest usual ball with room beside the wall: in the slot of the cutter, and within the depth.
fn usual_ball(diameter: f64, depth: f64) -> f64 {
    let fits = |ball: &f64| *ball <= 0.6 * diameter && ball / 2.0 + 1.5 <= 0.8 * depth;
    [6.0, 4.0, 3.0, 2.0, 1.0].into_iter().find(fits).unwrap_or(1.0)
}

impl Draft {
    /// Makes the draft of a program with what the user has said: values by key of the job, and `contour` by its number.
    ///
    /// # Errors
    /// Whatever is wrong with the program, and answers that the job cannot hold.
    pub fn of(program: &Source, given: &BTreeMap<String, String>) -> Result<Self, Failure> {
        Drafting::new(program, given).draft()
    }

    /// Keys that nobody has said and that have no default.
    pub fn open(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(|entry| entry.origin == Origin::Open)
    }

    /// Whether what is said so far can stand in a job.
    ///
    /// # Errors
    /// What a job cannot hold.
    pub fn check(&self) -> Result<(), Failure> {
        let text = text::bare(&stand_ins(&self.entries), self.unit);
        JobFile::parse(Source::new("the answer", text.into_bytes()), Path::new(""))?;
        Ok(())
    }

    /// The job file; `name` is how it names the program.
    pub fn text(&self, name: &str) -> String {
        text::text(self, name)
    }
}

/// A draft in the making.
struct Drafting<'a> {
    program: &'a Source,
    given: &'a BTreeMap<String, String>,
    post: Post,
    entries: Vec<Entry>,
    warnings: Vec<Remark>,
    facts: Vec<String>,
}

/// A finishing contour with the runs that make it.
struct Candidate {
    note: ContourNote,
    head: Found,
    likely: (Side, &'static str),
    allowance: Option<(f64, u32)>,
}

impl<'a> Drafting<'a> {
    fn new(program: &'a Source, given: &'a BTreeMap<String, String>) -> Self {
        let post = Post::read(program);
        Self { program, given, post, entries: Vec::new(), warnings: Vec::new(), facts: Vec::new() }
    }

    fn draft(mut self) -> Result<Draft, Failure> {
        self.root();
        // The cutter decides what is a lead and what roughing; the contour decides the cutter.
        let said = self.number("tool.diameter_mm").or_else(|| self.guess().map(|tool| tool.diameter_mm));
        let (mut diameter, mut known) = (said.unwrap_or(10.0), said.is_some());
        let (mut candidates, mut several, mut chosen) = (Vec::new(), false, 0);
        for _ in 0..2 {
            (candidates, several) = self.candidates(diameter, known)?;
            chosen = self.choose(&candidates);
            let tool = candidates.get(chosen).and_then(|c| c.note.tool).or_else(|| self.whole("tool.number"));
            let own = self.number("tool.diameter_mm").or_else(|| self.post.mill(tool).map(|tool| tool.diameter_mm));
            match own {
                Some(own) if (own - diameter).abs() > 1e-9 => (diameter, known) = (own, true),
                _ => break,
            }
        }
        let Some(candidate) = candidates.get(chosen) else {
            // Reading the contour says what is missing.
            Pass::new(self.reader(diameter)?, self.program.clone())?;
            return Err(Failure::Internal("a contour without a candidate".to_owned()));
        };
        let shown = self.side_of(candidate, diameter, known)?;
        // One side stands for all walls of a job: others on the other side are a job of their own.
        let mut alike = true;
        for other in &candidates {
            let side = self.side_of(other, diameter, known)?.map(|shown| shown.side);
            alike &= side.is_none() || shown.as_ref().is_some_and(|shown| Some(shown.side) == side);
        }
        if several && !alike {
            self.warnings.push("the walls of the program do not all show the same side: one of them is taken".into());
        }
        self.wall(candidate, shown.as_ref());
        self.stock(candidate, diameter);
        self.tool(candidate);
        self.compensation(candidate)?;
        self.force_and_machine();
        self.fallbacks();
        let alone = self.depth(candidate, several && alike, several)?;
        self.probe(diameter);
        self.others();
        let contours: Vec<ContourNote> = candidates.iter().map(|c| c.note.clone()).collect();
        let probe_control =
            self.job_as_said().and_then(|job| job.probe_control).or_else(|| self.post.control.as_ref()?.probe);
        Ok(Draft {
            unit: self.post.unit.told(),
            entries: self.entries,
            chosen: alone.then_some(candidate.note.number),
            contours,
            facts: self.facts,
            warnings: self.warnings,
            probe_control,
        })
    }

    fn text_of(&self, key: &str) -> Option<&str> {
        self.given.get(key).map(|value| value.trim().trim_matches('"'))
    }
    fn number(&self, key: &str) -> Option<f64> {
        self.text_of(key)?.parse().ok()
    }
    fn whole(&self, key: &str) -> Option<u32> {
        self.text_of(key)?.parse().ok()
    }

    /// Puts a key down: as given, else as it was found.
    fn put(&mut self, key: &str, found: Option<Entry>) {
        if let Some(value) = self.given.get(key) {
            self.entries.push(Entry::given(key, value));
        } else if let Some(found) = found {
            self.entries.push(found);
        }
    }

    fn root(&mut self) {
        self.entries.push(Entry::fixed("version", "1"));
        let name = toml::Value::String(self.program.name().to_owned()).to_string();
        self.entries.push(Entry::fixed("program", &name));
        let dialect = match &self.post.control {
            Some(control) => Entry::read("dialect", &quoted(dialect_name(control.dialect)), &control.why, control.line),
            None => Entry::default("dialect", "\"linuxcnc\"", "nothing in the program shows its control", false),
        };
        self.put("dialect", Some(dialect));
        self.put("decimal", None);
        self.put("arc_centres", None);
    }

    /// The comment about the cutter, before the contour is known.
    fn guess(&self) -> Option<&ToolNote> {
        let number = self.whole("tool.number");
        self.post
            .mill(number)
            .or_else(|| self.post.mills().into_iter().max_by(|a, b| a.diameter_mm.total_cmp(&b.diameter_mm)))
    }

    /// A job with what is known so far.
    fn job(&self, entries: &[Entry]) -> Result<JobFile, Failure> {
        let text = text::bare(entries, self.post.unit.told());
        Ok(JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new(""))?)
    }

    fn job_as_said(&self) -> Option<JobFile> {
        self.given.contains_key("dialect").then(|| self.job(&stand_ins(&self.entries)).ok()).flatten()
    }

    /// A job that only reads: cutter and all else are stand-ins.
    fn reader(&self, diameter: f64) -> Result<JobFile, Failure> {
        let mut text = text::bare(&self.entries, self.post.unit.told());
        text += &format!(
            "[stock]\nallowance_mm = {}\n[tool]\ndiameter_mm = {diameter}\nteeth = 1\nhelix_deg = 30\n",
            usual_allowance(diameter).max(0.001)
        );
        if let Some(compensation) = self.given.get("tool.compensation") {
            text += &format!("compensation = {}\n", toml_value(compensation));
        }
        text += "[cut]\naxial_depth_mm = 1\n[force]\nmaterial = \"steel-40\"\n";
        text += "[machine]\nstiffness_x_n_per_mm = 1000\nstiffness_y_n_per_mm = 1000\n";
        Ok(JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new(""))?)
    }

    /// The finishing contours, as the search finds them when the sides that show are known, and whether it finds several. `known`
    /// is whether the diameter is that of the cutter.
    fn candidates(&self, diameter: f64, known: bool) -> Result<(Vec<Candidate>, bool), Failure> {
        let job = self.reader(diameter)?;
        let survey = Survey::read(&job, self.program)?;
        let tool = self.whole("tool.number").or_else(|| self.note_of_diameter());
        let stated = match self.text_of("wall") {
            Some("left") => Some(Side::Left),
            Some("right") => Some(Side::Right),
            _ => None,
        };
        let mut criteria = Criteria { tool, wall: stated, diameter: job.numbers.tool.diameter, named: false };
        let sorted = |criteria: &Criteria| {
            let mut runs = survey.runs.clone();
            if runs.len() <= LARGEST_SEARCH {
                survey.sort(&mut runs, criteria);
            } else {
                runs.iter_mut().for_each(|found| found.role = Role::Finish { contour: found.run.number, level: 1 });
            }
            runs
        };
        let mut runs = sorted(&criteria);
        if stated.is_none() {
            // Most contours of a program have their wall on one side: that of the longest whose side shows.
            let finishing = runs.iter().filter(|f| matches!(f.role, Role::Finish { level: 1, .. }));
            let mut shown: Vec<((bool, Offset), Side)> = finishing
                .filter_map(|f| {
                    side(f, &survey, &self.post, (&criteria, known))
                        .map(|shown| ((f.run.closed, f.run.length), shown.side))
                })
                .collect();
            shown.sort_by_key(|(order, _)| *order);
            criteria.wall = shown.last().map(|(_, side)| *side);
            runs = sorted(&criteria);
        }
        let mut list: Vec<Candidate> = Vec::new();
        for found in &runs {
            let Role::Finish { contour, level } = found.role else { continue };
            let z = found.run.z.map(height);
            let lines = found.run.lines;
            if level > 1 {
                let last = list.iter_mut().find(|c| c.head.role == Role::Finish { contour, level: 1 });
                if let Some(candidate) = last {
                    candidate.note.z_mm.extend(z);
                    candidate.note.first_line = candidate.note.first_line.min(lines.first);
                    candidate.note.last_line = candidate.note.last_line.max(lines.last);
                }
                continue;
            }
            let [before, after] = survey.leads(found);
            let note = ContourNote {
                number: 0,
                first_line: lines.first,
                last_line: lines.last,
                tool: found.run.tool,
                z_mm: z.into_iter().collect(),
                length_mm: mm(found.run.length),
                closed: found.run.closed,
                leads: [before.len(), after.len()],
            };
            let index = runs.iter().position(|f| f.run.number == found.run.number);
            let allowance = runs.iter().rev().find_map(|f| match f.role {
                Role::Rough { nearer, gap, parallel: true } if Some(nearer) == index => {
                    Some((mm(gap), f.run.lines.first))
                }
                _ => None,
            });
            let likely = likely(found.blocks(&survey.blocks), criteria.diameter);
            list.push(Candidate { note, head: *found, likely, allowance });
        }
        let several = list.len() > 1;
        // A move of less than the cutter's width is no wall to correct, unless nothing else is there.
        if list.iter().any(|c| c.note.length_mm > diameter) {
            list.retain(|c| c.note.length_mm > diameter);
        }
        for (number, candidate) in (1..).zip(&mut list) {
            candidate.note.number = number;
        }
        Ok((list, several))
    }

    /// The tool whose comment has the diameter that the user gives.
    fn note_of_diameter(&self) -> Option<u32> {
        let diameter = self.number("tool.diameter_mm")?;
        let mills = self.post.mills();
        let mut alike = mills.iter().filter(|tool| (tool.diameter_mm - diameter).abs() < 0.02 * diameter);
        match (alike.next(), alike.next()) {
            (Some(only), None) => only.number.filter(|n| self.post.called.len() > 1 && self.post.called.contains(n)),
            _ => None,
        }
    }

    /// The index of the contour that is meant: as given, else the longest closed one, else the longest.
    fn choose(&self, candidates: &[Candidate]) -> usize {
        if let Some(number) = self.whole("contour") {
            return (number as usize).saturating_sub(1);
        }
        let order = |c: &&(usize, &Candidate)| (c.1.note.closed, (c.1.note.length_mm * 1e3) as u64);
        let all: Vec<(usize, &Candidate)> = candidates.iter().enumerate().collect();
        all.iter().max_by_key(order).map_or(0, |(index, _)| *index)
    }

    fn side_of(&self, candidate: &Candidate, diameter: f64, known: bool) -> Result<Option<Shown>, Failure> {
        let job = self.reader(diameter)?;
        let survey = Survey::read(&job, self.program)?;
        let criteria =
            Criteria { tool: candidate.note.tool, wall: None, diameter: job.numbers.tool.diameter, named: false };
        Ok(side(&candidate.head, &survey, &self.post, (&criteria, known)))
    }

    fn wall(&mut self, candidate: &Candidate, shown: Option<&Shown>) {
        let entry = match shown {
            // G41 says it at the control too: the job need not.
            Some(_) if candidate.head.run.wall.is_some() => None,
            Some(shown) => {
                let line = shown.line.unwrap_or(0);
                Some(Entry::read("wall", side_text(shown.side), &shown.why, line).doubtful())
            }
            None => {
                let (side, sign) = candidate.likely;
                Some(Entry::open("wall", side_text(side), &format!("the side of travel the wall lies on; {sign}")))
            }
        };
        self.put("wall", entry);
    }

    fn stock(&mut self, candidate: &Candidate, diameter: f64) {
        let entry = match candidate.allowance {
            Some((gap, line)) if gap < diameter => {
                let value = ((gap * 1e4).round() / 1e4).to_string();
                Entry::read("stock.allowance_mm", &value, "what the pass before leaves", line)
            }
            _ => {
                let usual = usual_allowance(diameter).max(0.01);
                // A program in inches has it in thousandths.
                let value = match self.post.unit.told() {
                    Unit::Millimetre => usual,
                    Unit::Inch => mm(nm(0.0254 * (usual / 0.0254).round().max(1.0))),
                };
                let value = value.to_string();
                let why = "stock on the wall before this pass; a twentieth of the diameter is usual";
                Entry::default("stock.allowance_mm", &value, why, true)
            }
        };
        if !self.given.contains_key("stock.surface") {
            self.put("stock.allowance_mm", Some(entry));
        }
    }

    /// The cutter's keys.
    fn tool(&mut self, candidate: &Candidate) {
        let number = self.whole("tool.number").or(candidate.note.tool).filter(|n| *n > 0);
        let note = self.post.mill(number).cloned();
        let said = |key: &str, value: &str, note: &ToolNote| {
            Entry::read(key, value, &format!("the comment \"{}\"", note.text), note.line)
        };
        let given = self.number("tool.diameter_mm");
        // What a comment says of another cutter than the user's counts no more.
        let own = note.filter(|n| given.is_none_or(|d| (d - n.diameter_mm).abs() <= 0.02 * d));
        let number_entry = number.map(|n| {
            Entry::read("tool.number", &n.to_string(), "the tool that cuts the contour", candidate.note.first_line)
        });
        self.put("tool.number", number_entry);
        let diameter = own.as_ref().map_or_else(
            || Entry::open("tool.diameter_mm", "10", "diameter of the cutter, which no comment names"),
            |n| said("tool.diameter_mm", &((n.diameter_mm * 1e6).round() / 1e6).to_string(), n),
        );
        self.put("tool.diameter_mm", Some(diameter));
        self.put("tool.measured_diameter_mm", None);
        let width = given.or_else(|| own.as_ref().map(|n| n.diameter_mm)).unwrap_or(10.0);
        let teeth = own.as_ref().and_then(|n| n.teeth.map(|teeth| said("tool.teeth", &teeth.to_string(), n)));
        let usual = if width < 6.0 {
            "2"
        } else if width < 12.0 {
            "3"
        } else {
            "4"
        };
        let teeth = teeth.unwrap_or_else(|| Entry::default("tool.teeth", usual, "number of teeth; count them", true));
        self.put("tool.teeth", Some(teeth));
        let helix = Entry::default("tool.helix_deg", USUAL_HELIX, "helix angle; 30 to 45 is what is sold", false);
        self.put("tool.helix_deg", Some(helix));
        if let Some(note) = &own {
            let (corner, unit) = (note.corner_mm.unwrap_or(0.0), self.post.unit.told());
            if note.shape == Shape::Ball {
                self.warnings.push(unit.remark(|unit| {
                    let said = "a ball end leaves a wall only above its radius";
                    format!("line {}: {said}, {} {}: touch there", note.line, unit.of(corner), unit.name())
                }));
            } else if corner > 0.0 {
                self.warnings.push(unit.remark(|unit| {
                    let said = "leaves no wall below that height: touch above it";
                    format!("line {}: a corner radius of {} {} {said}", note.line, unit.of(corner), unit.name())
                }));
            }
        }
    }

    /// Outline or path of the centre, where the contour is under G41 or G42.
    fn compensation(&mut self, candidate: &Candidate) -> Result<(), Failure> {
        let entry = if candidate.head.run.wall.is_none() || self.given.contains_key("tool.compensation") {
            None
        } else {
            let job = self.job(&self.complete(candidate))?;
            let line = candidate.note.first_line;
            match drawn(&job, self.program) {
                Ok(Some(drawn)) => {
                    let value = match drawn.compensation {
                        Compensation::Centre => "\"centre\"",
                        Compensation::Radius => "\"radius\"",
                    };
                    Some(Entry::read("tool.compensation", value, drawn.why, line).doubtful())
                }
                Ok(None) => None,
                Err(error) if error.code() == "J027" => {
                    let why = format!("{}: \"radius\" when D holds the cutter's radius", error.found());
                    Some(Entry::open("tool.compensation", "\"radius\"", &why))
                }
                Err(error) => return Err(error.into()),
            }
        };
        self.put("tool.compensation", entry);
        for key in ["tool.offset_number", "tool.stickout_mm", "tool.material"] {
            self.put(key, None);
        }
        Ok(())
    }

    fn force_and_machine(&mut self) {
        const KEYS: [&str; 4] =
            ["force.ktc_n_per_mm2", "force.krc_n_per_mm2", "force.kte_n_per_mm", "force.kre_n_per_mm"];
        let own = KEYS.iter().any(|key| self.given.contains_key(*key));
        let unknown = self.text_of("force.material") == Some("unknown");
        if own || unknown {
            for (key, usual) in KEYS.into_iter().zip(USUAL_FORCE) {
                let why = "between aluminium and steel";
                if !unknown {
                    self.put(key, Some(Entry::default(key, usual, why, true)));
                }
            }
            if unknown {
                let why = "not known: a wide prior between aluminium and steel is taken, and the points correct it";
                self.entries.push(Entry::left("force.material", why));
            }
        } else {
            let names: Vec<&str> = MATERIALS.iter().map(|m| m.name).collect();
            let entry = match &self.post.material {
                Some(note) => Entry::read(
                    "force.material",
                    &quoted(note.name),
                    &format!("the comment \"{}\"", note.text),
                    note.line,
                ),
                None => {
                    let why = format!(
                        "not said: a wide prior between aluminium and steel is taken, and the points correct it; or one of {}",
                        names.join(", ")
                    );
                    Entry::left("force.material", &why)
                }
            };
            self.put("force.material", Some(entry));
        }
        self.put("force.model", None);
        let either = ["machine.stiffness_x_n_per_mm", "machine.stiffness_y_n_per_mm"];
        let stated = either.iter().any(|key| self.given.contains_key(*key));
        for key in either {
            let why = "at the cutter; not said: a wide prior between a router and a heavy machining centre is taken";
            let entry = if stated {
                Entry::default(key, &USUAL_STIFFNESS.to_string(), "as the other axis is stated", true)
            } else {
                Entry::left(key, &format!("{why}, {USUAL_STIFFNESS}"))
            };
            self.put(key, Some(entry));
        }
    }

    /// Nothing yet of what the program may lack: speeds come from the job then.
    fn fallbacks(&mut self) {
        for key in ["cut.spindle_rpm", "cut.feed_mm_per_min"] {
            self.put(key, None);
        }
    }

    /// The depth, and the facts of the contour, or of all where they are taken together; whether only the one is.
    fn depth(&mut self, candidate: &Candidate, together: bool, several: bool) -> Result<bool, Failure> {
        let all = together && self.text_of("contour").is_none_or(|number| number == "all");
        let (passes, alone) = match all.then(|| self.passes(None)) {
            Some(Ok(passes)) => (Ok(passes), false),
            Some(Err(failure)) => {
                if let Failure::Input(error) = &failure {
                    let first = error.found().lines().next().unwrap_or_default().to_owned();
                    self.warnings.push(format!("not all walls of the program can be taken together: {first}").into());
                }
                (self.passes(Some(&candidate.note)), true)
            }
            None => (self.passes(several.then_some(&candidate.note)), several),
        };
        let missing = |code: &str| match code {
            "J040" => Some(("cut.axial_depth_mm", "10", "depth of the cutter in the stock")),
            "J016" => Some(("cut.spindle_rpm", "5000", "spindle speed, rev/min, which the program does not say")),
            "J012" => Some(("cut.feed_mm_per_min", "500", "feed, which the program does not say")),
            _ => None,
        };
        let passes = match passes {
            Ok(passes) => passes,
            Err(Failure::Input(error)) if missing(error.code()).is_some() => {
                if let Some((key, usual, why)) = missing(error.code()) {
                    self.put("cut.axial_depth_mm", None);
                    if !self.given.contains_key(key) {
                        self.entries.push(Entry::open(key, usual, &format!("{why}: {}", error.found())));
                    }
                }
                return Ok(alone);
            }
            Err(failure) => return Err(failure),
        };
        let depths = || passes.iter().filter_map(|p| p.job.assumed.iter().find(|a| a.key == "cut.axial_depth_mm"));
        let first = depths().next();
        let entry = first.map(|first| match depths().all(|other| other.value == first.value) {
            true => Entry::read(first.key, &first.value, &first.why, 0).doubtful(),
            false => Entry::left(first.key, "each contour has its own, from Z 0 or the level before down to its own"),
        });
        self.put("cut.axial_depth_mm", entry);
        self.facts.extend(passes.iter().map(facts));
        Ok(alone)
    }

    /// The contours that the job so far is about.
    fn passes(&self, only: Option<&ContourNote>) -> Result<Vec<Pass>, Failure> {
        let mut text = text::bare(&stand_ins(&self.entries), self.post.unit.told());
        if let Some(depth) = self.given.get("cut.axial_depth_mm") {
            text = text::with_key(&text, "cut", &format!("axial_depth_mm = {depth}"));
        }
        if let Some(contour) = only {
            text += &format!("[[feature]]\nid = \"wall\"\nlines = [{}, {}]\n", contour.first_line, contour.last_line);
        }
        let mut job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new(""))?;
        job.drawn = job.drawn || self.entries.iter().any(|e| e.key == "tool.compensation" && e.origin == Origin::Open);
        Pass::every(job)
    }

    fn probe(&mut self, diameter: f64) {
        let depth = self.entries.iter().find(|e| e.key == "cut.axial_depth_mm").and_then(|e| e.value.parse().ok());
        let ball = usual_ball(diameter, depth.unwrap_or(10.0)).to_string();
        let why = "diameter of the probe's ball: every point is shifted by half of it";
        self.put("probe.ball_diameter_mm", Some(Entry::default("probe.ball_diameter_mm", &ball, why, true)));
        let why =
            "Z of a touch is that of the ball's centre; \"tip\" when the probe's length is set to its lowest point";
        self.put("probe.z_reference", Some(Entry::default("probe.z_reference", "\"centre\"", why, true)));
        self.put("probe.format", None);
    }

    /// What the user gives beside.
    fn others(&mut self) {
        for (key, value) in self.given {
            if key != "contour" && !self.entries.iter().any(|e| e.key == *key) && value != "unknown" {
                self.entries.push(Entry::given(key, value));
            }
        }
    }
}

impl Drafting<'_> {
    /// The entries so far, and stand-ins for what a job cannot be read without.
    fn complete(&self, candidate: &Candidate) -> Vec<Entry> {
        let mut entries = stand_ins(&self.entries);
        if !self.given.contains_key("cut.axial_depth_mm") {
            entries.push(Entry::fixed("cut.axial_depth_mm", "1"));
        }
        if candidate.head.run.wall.is_some() {
            entries.retain(|entry| entry.key != "wall" || entry.origin == Origin::Given);
        }
        entries
    }
}

/// A contour in words.
fn facts(pass: &Pass) -> String {
    let contour = &pass.core.contour;
    let (unit, name) = (pass.unit(), pass.unit().name());
    let feeds = match (float(contour.lowest_feed), float(contour.highest_feed)) {
        (low, high) if low == high => format!("F{}", unit.of(low)),
        (low, high) => format!("F{} to F{}", unit.of(low), unit.of(high)),
    };
    let speed = contour.speed.map_or_else(String::new, |s| format!("S{}, ", float(s)));
    let leads = pass.leads().map(<[_]>::len);
    format!(
        "contour: lines {}-{}, Z {}, {:.3} {name}, {}, {speed}{feeds} {name}/min, leads of {} and {} moves",
        contour.lines.first,
        contour.lines.last,
        unit.of(height(contour.z)),
        unit.of(mm(contour.length)),
        if contour.closed { "closed" } else { "open" },
        leads[0],
        leads[1],
    )
}

/// The entries with defaults in the place of what is open.
fn stand_ins(entries: &[Entry]) -> Vec<Entry> {
    let stand_in = |entry: &Entry| {
        let origin = if entry.origin == Origin::Open { Origin::Default } else { entry.origin };
        Entry { origin, ..entry.clone() }
    };
    entries.iter().map(stand_in).collect()
}

fn height(z: Position) -> f64 {
    z.nm() as f64 / 1e6
}

fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

const fn side_text(side: Side) -> &'static str {
    match side {
        Side::Left => "\"left\"",
        Side::Right => "\"right\"",
    }
}
