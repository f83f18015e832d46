//! What became of one program on both sides.

use super::corpus::{Origin, Program};
use super::mend::{Lack, mended};
use super::outcome::{Bench, End, Outcome};
use super::rule::Rule;
use super::stream::{calls, difference};

/// How the two sides compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Every call the same.
    SameText,
    /// The same motion; comments or the order of switches differ.
    SameMotion,
    /// Both accept; motion differs.
    Differs,
    /// The reference refuses, ours accepts.
    OnlyWe,
    /// Ours refuses, the reference accepts.
    OnlyThey,
    /// Both refuse, of the same line.
    BothSameLine,
    /// Both refuse, of different lines.
    BothOtherLine,
    /// The reference dies or does not end.
    TheyCrash,
    /// Ours dies or does not end.
    WeCrash,
}

impl Class {
    /// All of them, in the order of the report.
    pub const ALL: [Self; 9] = [
        Self::SameText,
        Self::SameMotion,
        Self::Differs,
        Self::OnlyWe,
        Self::OnlyThey,
        Self::BothSameLine,
        Self::BothOtherLine,
        Self::TheyCrash,
        Self::WeCrash,
    ];

    /// Its words in the report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SameText => "identical, line for line",
            Self::SameMotion => "identical motion",
            Self::Differs => "differs",
            Self::OnlyWe => "only we accept",
            Self::OnlyThey => "only they accept",
            Self::BothSameLine => "both refuse, same line",
            Self::BothOtherLine => "both refuse, other line",
            Self::TheyCrash => "the reference dies",
            Self::WeCrash => "ours dies",
        }
    }
}

/// The verdict on one program.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Where it comes from.
    pub origin: Origin,
    /// Its name.
    pub name: String,
    /// How the two compare.
    pub class: Class,
    /// Why it does not count, if it does not.
    pub rule: Option<Rule>,
    /// What it lacks, when the reference refuses it for that.
    pub lack: Option<Lack>,
    /// Whether the copy in which that is mended is accepted by the reference, and then whether ours moves alike.
    pub mended: Option<bool>,
    /// Whether ours warned.
    pub warned: bool,
    /// What was said or where they part.
    pub detail: String,
    /// What the reference made of it.
    pub theirs: Outcome,
}

impl Verdict {
    /// Runs both sides on a program.
    pub fn of(program: &Program, bench: &Bench) -> Self {
        let theirs = bench.theirs(&program.file, &program.text);
        let ours = bench.ours(&program.file, &program.text);
        let (class, mut detail) = compare(&theirs, &ours);
        let lack = match &theirs.end {
            End::Refused { message, .. } => Lack::of(message),
            _ => None,
        };
        let rule = Rule::of(program, &theirs.end);
        let mut mended_motion = None;
        if let (Some(lack), None) = (lack, rule) {
            let text = mended(bench, &program.file, &program.text);
            let (theirs, ours) = (bench.theirs(&program.file, &text), bench.ours(&program.file, &text));
            let (mended_class, mended_detail) = compare(&theirs, &ours);
            if theirs.end == End::Accepted {
                let same = matches!(mended_class, Class::SameText | Class::SameMotion);
                mended_motion = Some(same);
                if !same {
                    detail += &format!("; mended: {}: {mended_detail}", mended_class.name());
                }
            } else {
                detail += &format!("; {} mended: {mended_detail}", lack.name());
            }
        }
        Self {
            origin: program.origin,
            name: program.name.clone(),
            class,
            rule,
            lack,
            mended: mended_motion,
            warned: ours.warned,
            detail,
            theirs,
        }
    }

    /// Whether both do the same.
    pub fn is_same(&self) -> bool {
        matches!(self.class, Class::SameText | Class::SameMotion)
    }

    /// Whether the reference accepts it.
    pub fn they_accept(&self) -> bool {
        self.is_same() || matches!(self.class, Class::Differs | Class::OnlyThey)
    }
}

fn compare(theirs: &Outcome, ours: &Outcome) -> (Class, String) {
    match (&theirs.end, &ours.end) {
        (_, End::Crashed(how)) => (Class::WeCrash, how.clone()),
        (End::Crashed(how), _) => (Class::TheyCrash, how.clone()),
        (End::Accepted, End::Accepted) => {
            match difference(&calls(&theirs.text, true), &calls(&ours.text, true), false) {
                Some(d) => (Class::Differs, format!("after {} moves: theirs {}, ours {}", d.after, d.theirs, d.ours)),
                None => match difference(&calls(&theirs.text, false), &calls(&ours.text, false), false) {
                    None => (Class::SameText, String::new()),
                    Some(d) => {
                        (Class::SameMotion, format!("after {} calls: theirs {}, ours {}", d.after, d.theirs, d.ours))
                    }
                },
            }
        }
        (End::Refused { message, line }, End::Accepted) => {
            let parted = difference(&calls(&theirs.text, true), &calls(&ours.text, true), true);
            let before = parted.map_or(String::new(), |d| {
                format!("; before that, after {} moves: theirs {}, ours {}", d.after, d.theirs, d.ours)
            });
            (Class::OnlyWe, format!("theirs: {message} [{line}]{before}"))
        }
        (End::Accepted, End::Refused { message, line }) => (Class::OnlyThey, format!("ours: {message} [{line}]")),
        (End::Refused { message: a, line: at }, End::Refused { message: b, line: our }) => {
            let class = if bare(at) == bare(our) { Class::BothSameLine } else { Class::BothOtherLine };
            (class, format!("theirs: {a} [{at}]; ours: {b} [{our}]"))
        }
    }
}

/// A line without blanks and case.
pub fn bare(line: &str) -> String {
    line.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_lowercase()
}
