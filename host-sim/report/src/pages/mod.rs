//! `report.html` of the commands: what each of them puts on its page. Everything shown is what the tables and the summary
//! beside the page hold, with the same digits; nothing is computed for the page alone but the passes over the whole
//! contour that the tables hold in part.

mod corrected;
mod demonstrated;
mod expected;
mod inspected;
mod learned;
mod simulated;

use std::path::Path as FilePath;

use truepath_ground::length::{Remark, Said};
use truepath_job::pass::Pass;

use crate::page::{JobFacts, Kind, Outcome, Outlines, Page, Program, subject};

pub use corrected::{Points, corrected};
pub use demonstrated::demonstrated;
pub use inspected::inspected;
pub use learned::learned;
pub use simulated::simulated;

/// File of the page.
pub const REPORT: &str = "report.html";

/// A page of a pass: program, job, stock.
fn of_pass(kind: Kind, title: String, pass: &Pass) -> Page {
    let mut page = Page::new(kind, format!("{title} {}", subject(pass))).told_in(pass.unit());
    page.program = Some(Program::of(pass, None));
    page.job = Some(JobFacts::of(pass));
    page.outlines = Outlines::of(pass);
    page.outcome = Some(Outcome::of(pass));
    page
}

/// A file without its folder, which is nobody's business who receives the page.
fn file(name: &str) -> &FilePath {
    FilePath::new(name.rsplit(['/', '\\']).next().unwrap_or(name))
}

/// Warnings as the page tells them: files without their folders, which are nobody's business who receives the page.
fn page_warnings(pass: &Pass, probe: Option<&str>, warnings: impl Iterator<Item = Remark>) -> Vec<Said> {
    let files = [Some(pass.program.name()), Some(pass.job.source().name()), probe];
    let folder = |name: &str| name.rfind(['/', '\\']).map(|end| name[..=end].to_owned());
    // A folder of one mark ("/") stands in other texts as well.
    let mut folders: Vec<String> = files.into_iter().flatten().filter_map(folder).filter(|f| f.len() > 1).collect();
    // The longest first: one may be the beginning or the end of another.
    folders.sort_unstable_by_key(|folder| std::cmp::Reverse(folder.len()));
    let plain = |text: &str| folders.iter().fold(text.to_owned(), |text, folder| text.replace(folder, ""));
    warnings.map(|said| said.map(plain).into()).collect()
}
