//! Regions of a program that are features: those of the job, those marked, or the whole program.

use std::ops::Range;

use truepath_core::gcode::LineRange;
use truepath_core::geometry::Side;
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::{InputError, Source};

use super::marker::Marked;
use super::place;
use crate::codes::N007;
use crate::job::{FeatureRole, FeatureTable, JobFile};

/// Who says where a feature is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// `[[feature]]`.
    Job,
    /// Comments.
    Markers,
    /// Nobody: the program is searched.
    Search,
}

/// A feature before its passes are known.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// Its place among the features, from 1.
    pub(super) number: u32,
    pub(super) id: Option<String>,
    pub(super) origin: Origin,
    pub(super) role: FeatureRole,
    /// `None` for the whole program.
    pub(super) lines: Option<LineRange>,
    pub(super) tool: Option<u32>,
    pub(super) wall: Option<Side>,
    pub(super) allowance: Option<Offset>,
    pub(super) heights: Option<Vec<Position>>,
    /// Where it is named: the file, and the places of name, tool and heights in it.
    named: Option<(Source, [Range<usize>; 3])>,
}

impl Region {
    /// An error about it, at its name.
    pub(super) fn error(&self, error: InputError) -> InputError {
        self.at(error, 0)
    }
    /// An error about its tool.
    pub(super) fn tool_error(&self, error: InputError) -> InputError {
        self.at(error, 1)
    }
    /// An error about its heights.
    pub(super) fn heights_error(&self, error: InputError) -> InputError {
        self.at(error, 2)
    }
    fn at(&self, error: InputError, which: usize) -> InputError {
        match &self.named {
            Some((source, spans)) => error.at(source, spans[which].clone()),
            None => error,
        }
    }
    /// How it is called in sentences.
    pub(super) fn name(&self) -> String {
        self.id.as_ref().map_or_else(|| "the program".to_owned(), |id| format!("the feature \"{id}\""))
    }
}

/// The features of a program in their order.
pub(super) fn regions(job: &JobFile, program: &Source, marked: &[Marked]) -> Result<Vec<Region>, InputError> {
    if job.features.is_empty() {
        return Ok(if marked.is_empty() { vec![whole(job)] } else { of_markers(program, marked) });
    }
    if let Some(unknown) = marked.iter().find(|m| job.features.iter().all(|f| f.id != m.id)) {
        let found = format!("\"{}\" is marked here, and {} does not know it", unknown.id, job.source().name());
        let known: Vec<&str> = job.features.iter().map(|f| f.id.as_str()).collect();
        let help = "add a [[feature]] of that name to the job, or remove the markers";
        return Err(InputError::new(N007, found, format!("one of {}", known.join(", ")), help)
            .at(program, unknown.span.clone()));
    }
    let region = |(index, table): (usize, &FeatureTable)| {
        let lines = place::lines(job, table, program, marked)?;
        let spans = [table.id_span.clone(), table.tool_span.clone(), table.heights_span.clone()];
        Ok(Region {
            number: index as u32 + 1,
            id: Some(table.id.clone()),
            origin: Origin::Job,
            role: table.role,
            lines: Some(lines),
            tool: table.tool,
            wall: table.wall,
            allowance: table.allowance,
            heights: table.heights.clone(),
            named: Some((job.source().clone(), spans)),
        })
    };
    job.features.iter().enumerate().map(region).collect()
}

/// The whole program, to be searched.
const fn whole(job: &JobFile) -> Region {
    Region {
        number: 1,
        id: None,
        origin: Origin::Search,
        role: FeatureRole::Finish,
        lines: None,
        tool: job.numbers.tool.number,
        wall: None,
        allowance: None,
        heights: None,
        named: None,
    }
}

fn of_markers(program: &Source, marked: &[Marked]) -> Vec<Region> {
    let region = |(index, marked): (usize, &Marked)| Region {
        number: index as u32 + 1,
        id: Some(marked.id.clone()),
        origin: Origin::Markers,
        role: FeatureRole::Finish,
        lines: Some(marked.lines),
        tool: None,
        wall: None,
        allowance: None,
        heights: None,
        named: Some((program.clone(), [marked.span.clone(), marked.span.clone(), marked.span.clone()])),
    };
    marked.iter().enumerate().map(region).collect()
}
