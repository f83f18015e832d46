//! What a job leaves open: read from the program where it says it, else a stated default.
//!
//! Nothing is filled in unseen: everything that is taken is an [`Assumed`], which every command prints and summaries list.
//! What would make a wrong part when guessed (allowance, ball, teeth) has no default.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use truepath_core::gcode::Dialect;
use truepath_core::job::{Force, ForceModel, Machine};
use truepath_core::units::{Offset, Real};
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::Source;
use truepath_ground::files;

use super::material::MATERIALS;
use crate::post::{Post, ToolNote};

/// A value that the job does not give.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct Assumed {
    /// Its key with the table.
    pub key: &'static str,
    /// The value, as a job writes it.
    pub value: String,
    /// Where it comes from.
    pub why: String,
    /// The line of the program that shows it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
}

impl Assumed {
    /// What is told of it.
    pub fn text(&self) -> String {
        let Self { key, value, why, .. } = self;
        format!("assumed {key} = {value}: {why}")
    }
}

/// Names of the controls a program may be written for.
pub const DIALECTS: [(&str, Dialect); 6] = [
    ("linuxcnc", Dialect::Linuxcnc),
    ("fanuc", Dialect::Fanuc),
    ("haas", Dialect::Haas),
    ("siemens", Dialect::Siemens),
    ("mach", Dialect::Mach),
    ("heidenhain", Dialect::Heidenhain),
];

/// Those of them that write G-code.
pub const WORD_DIALECTS: [(&str, Dialect); 5] = [DIALECTS[0], DIALECTS[1], DIALECTS[2], DIALECTS[3], DIALECTS[4]];

/// Stiffness at the cutter when nothing is said, N/mm: between a router (1,000) and a heavy machining centre (20,000).
pub const USUAL_STIFFNESS: i32 = 4_000;
/// Coefficients when nothing is said, N/mm² and N/mm: the middle of aluminium (600) and steel (2,200).
pub const USUAL_FORCE: [&str; 4] = ["1150", "370", "15", "17"];
/// Helix when nothing is said, degrees: 30 to 45 is what is sold.
pub const USUAL_HELIX: &str = "35";

/// The program of a job, read when something is asked.
pub(super) struct Open {
    path: PathBuf,
    post: OnceCell<Option<Post>>,
}

impl Open {
    pub(super) fn new(program: &Path) -> Self {
        Self { path: program.to_owned(), post: OnceCell::new() }
    }

    /// What the program says; `None` when it cannot be read, which is reported where it is needed.
    pub(super) fn post(&self) -> Option<&Post> {
        let read = || {
            let bytes = files::read(&self.path).ok()?;
            Some(Post::read(&Source::new(self.path.display().to_string(), bytes)))
        };
        self.post.get_or_init(read).as_ref()
    }

    /// Whether there is a program.
    pub(super) fn is_readable(&self) -> bool {
        self.post().is_some()
    }

    /// Whether a comment names a cutter.
    pub(super) fn names_mill(&self) -> bool {
        self.post().is_some_and(|post| !post.mills().is_empty())
    }

    /// The dialect; that of LinuxCNC without any sign, as ever.
    pub(super) fn dialect(&self, assumed: &mut Vec<Assumed>) -> Dialect {
        let Some(control) = self.post().and_then(|post| post.control.clone()) else { return Dialect::default() };
        let (value, why) = (quoted(dialect_name(control.dialect)), sign(&control.why, control.line));
        assumed.push(Assumed { key: "dialect", value, why, line: Some(control.line).filter(|line| *line > 0) });
        control.dialect
    }

    /// `--dialect` of `truepath probe` for the control of the program.
    pub(super) fn probe_control(&self, stated: Option<Dialect>) -> Option<&'static str> {
        match stated {
            Some(Dialect::Linuxcnc) => Some("linuxcnc"),
            Some(Dialect::Fanuc) => Some("fanuc"),
            Some(Dialect::Haas) => Some("haas"),
            Some(_) => None,
            None => self.post()?.control.as_ref()?.probe,
        }
    }

    /// The cutter of a number, or the only one that is named.
    pub(super) fn mill(&self, number: Option<u32>) -> Option<&ToolNote> {
        self.post()?.mill(number)
    }

    /// Coefficients of the material that a comment names, else those between the metals.
    pub(super) fn force(&self, model: Option<ForceModel>, assumed: &mut Vec<Assumed>) -> Force {
        let note = self.post().and_then(|post| post.material.clone());
        let named = note.and_then(|note| MATERIALS.iter().find(|m| m.name == note.name).map(|m| (m, note)));
        let (texts, key, value, why, line) = match named {
            Some((material, note)) => {
                let why = sign(&format!("the comment \"{}\"", note.text), note.line);
                (material.coefficients, "force.material", quoted(material.name), why, Some(note.line))
            }
            None => {
                let why = "between aluminium and steel, known to a factor of two; the points correct it".to_owned();
                (USUAL_FORCE, "force.ktc_n_per_mm2", USUAL_FORCE[0].to_owned(), why, None)
            }
        };
        assumed.push(Assumed { key, value, why, line });
        let [ktc, krc, kte, kre] = texts.map(|text| Decimal::parse(text).map_or(Real::ZERO, Decimal::as_real));
        Force { ktc, krc, kte, kre, model: model.unwrap_or(ForceModel::Auto), stated: false }
    }
}

impl Open {
    /// The comment about a cutter that the job gives the diameter of, and its number where that tells it from others.
    pub(super) fn of_diameter(&self, number: Option<u32>, diameter: Offset) -> Option<(Option<u32>, &ToolNote)> {
        let post = self.post()?;
        let alike = |tool: &&&ToolNote| (tool.diameter() - diameter).abs().nm() * 50 <= diameter.nm();
        let mills = post.mills();
        let own = |tool: &&&ToolNote| number.is_none() || tool.number.is_none() || tool.number == number;
        let found: Vec<&ToolNote> = mills.iter().filter(alike).filter(own).copied().collect();
        let [only] = found[..] else { return None };
        // A number tells the cutter from the others that the program changes to.
        let telling = only.number.filter(|n| post.called.len() > 1 && post.called.contains(n));
        Some((telling, only))
    }
}

impl ToolNote {
    /// Its diameter.
    pub(crate) fn diameter(&self) -> Offset {
        Offset::from_nm((self.diameter_mm * 1e6).round() as i64)
    }
    /// A value that it gives.
    pub(crate) fn assumed(&self, key: &'static str, value: String) -> Assumed {
        Assumed { key, value, why: sign(&format!("the comment \"{}\"", self.text), self.line), line: Some(self.line) }
    }
}

/// A machine of which nothing is said.
pub(super) fn usual_machine(assumed: &mut Vec<Assumed>) -> Machine {
    let why =
        "between a router and a heavy machining centre, known to a factor of two and a half; the points correct it";
    let value = USUAL_STIFFNESS.to_string();
    assumed.push(Assumed { key: "machine.stiffness_x_n_per_mm", value, why: format!("{why}; y the same"), line: None });
    let stiffness = Real::from_int(USUAL_STIFFNESS);
    Machine { stiffness_x: stiffness, stiffness_y: stiffness, stated: false }
}

/// The name of a dialect in a job.
pub fn dialect_name(dialect: Dialect) -> &'static str {
    DIALECTS.iter().find(|(_, d)| *d == dialect).map_or("linuxcnc", |(name, _)| name)
}

/// A text as a job writes it.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

/// A sign with its line.
pub(super) fn sign(why: &str, line: u32) -> String {
    if line == 0 { why.to_owned() } else { format!("line {line} of the program, {why}") }
}
