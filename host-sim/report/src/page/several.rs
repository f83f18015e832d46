//! Several contours of one program on one page.

use serde::Serialize;

use super::{Kind, Page};

/// What is embedded then: the heading, and each contour with all that a page of its own would hold.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Several<'p> {
    version: u32,
    kind: Kind,
    title: String,
    by: &'p str,
    contours: Vec<Named<'p>>,
}

/// A contour by its name.
#[derive(Clone, Copy, Debug, Serialize)]
struct Named<'p> {
    name: &'p str,
    page: &'p Page,
}

impl<'p> Several<'p> {
    /// Of contours by name; `None` without any, or where they are not of one kind.
    pub fn of(contours: &'p [(String, Page)]) -> Option<Self> {
        let (_, first) = contours.first()?;
        let one_kind = contours.iter().all(|(_, page)| page.kind == first.kind);
        one_kind.then(|| Self {
            version: 1,
            kind: first.kind,
            title: title(contours, first),
            by: &first.by,
            contours: contours.iter().map(|(name, page)| Named { name, page }).collect(),
        })
    }
}

/// The heading: that of the contours where they share it (the name of the part), otherwise one with the name of the program.
fn title(contours: &[(String, Page)], first: &Page) -> String {
    if contours.iter().all(|(_, page)| page.title == first.title) {
        return first.title.clone();
    }
    let Some(program) = &first.program else { return first.title.clone() };
    let name = &program.name;
    match first.kind {
        Kind::Simulate => format!("Pass of {name}"),
        Kind::Correct => format!("Correction of {name}"),
        Kind::Learn => format!("{name}: correction of the next part"),
        Kind::Inspect => format!("Inspection report: {name}"),
    }
}
