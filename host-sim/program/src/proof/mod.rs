//! The proof that a corrected program differs from its original in the contour and in nothing else.
//!
//! Both texts are read by the interpreter of the core, without anything the writer knows of its own work, and compared
//! step by step: outside the contour every step with all modes is the same ([`outside`]); along it the path follows
//! the wanted points within the tolerance, in both directions, at the heights and modes of the original and at its feeds
//! or the wanted share of them ([`inside`]); lines not said to be changed keep their bytes ([`bytes`]).
//!
//! Limits: what the interpreter does not tell apart (spaces, order of words) is compared as bytes on untouched lines
//! only.

mod along;
mod beside;
mod bytes;
mod facts;
mod inside;
mod kink;
mod outside;

use std::collections::{BTreeMap, HashSet};

use facts::{Fact, What, facts};
use inside::{Along, EditLines, Terms};
use outside::Bounds;
use truepath_core::gcode::{Lines, Options};

use super::edit::BlockEdit;
use super::stretch::is_near;

pub(super) use beside::{Changed, Cut, Replaced, same_beside};
pub(super) use kink::Kink;

/// What is compared.
pub(super) struct Claim<'a> {
    pub(super) original: &'a [u8],
    pub(super) written: &'a [u8],
    /// How many lines each changed line has become.
    pub(super) touched: &'a BTreeMap<u32, usize>,
    /// The lines of the mark, and the line of the original after which they stand.
    pub(super) head: (u32, &'a [u8]),
    pub(super) edits: &'a [BlockEdit],
    pub(super) program: Options<'static>,
    /// How far the path may leave the wanted points, nm.
    pub(super) tolerance: f64,
    /// One step of the program's coordinates, nm.
    pub(super) step: f64,
    /// Whether cutter compensation was taken out of the contour.
    pub(super) centre_path: bool,
}

/// What was found, counted from the written text.
#[derive(Clone, Debug, Default)]
pub(super) struct Proof {
    /// G1, G2 and G3 along the contour.
    pub(super) lines: usize,
    pub(super) arcs: usize,
    /// The largest distance between written path and wanted points, nm.
    pub(super) deviation_nm: f64,
    /// Kinks in places where the original is smooth.
    pub(super) kinks: Vec<Kink>,
    /// Moves outside the contour that were compared.
    pub(super) moves_outside: usize,
    /// Steps outside the contour that were compared, moves included.
    pub(super) steps_outside: usize,
    /// F words along the contour.
    pub(super) feeds: usize,
}

/// Compares; the error says what has changed that must not.
pub(super) fn prove(claim: &Claim<'_>) -> Result<Proof, String> {
    let klartext = claim.program.dialect.is_klartext();
    bytes::compare(claim.original, claim.written, claim.touched, claim.head, klartext)?;
    let read = |text: &[u8]| {
        facts(text, claim.program, claim.centre_path).map_err(|e| format!("line {} cannot be read: {e}", e.line))
    };
    let mut original = read(claim.original)?;
    if klartext {
        without_ways_from_leads(&mut original, claim.edits);
    }
    let head = claim.head.0 + 1..=claim.head.0 + Lines::new(claim.head.1).count() as u32;
    let written: Vec<Fact> = read(claim.written)?.into_iter().filter(|f| !head.contains(&f.line)).collect();

    let mut along = Along::default();
    let mut proof = Proof::default();
    let mut edits = claim.edits;
    let mut lines = EditLines::of(edits);
    let scheduled = edits.iter().any(|edit| !edit.feeds.is_empty());
    let (mut old, mut new, mut before) = (0, 0, None);
    let mut stretches = 0;
    loop {
        stretches += 1;
        let slack = (2.0 + f64::from(stretches)) * claim.step.max(50.0);
        let begin = original[old..].iter().position(|f| lines.is_cut(f)).map(|at| {
            // What else its line does belongs to it, but for the way of FMAX to a lead.
            let line = original[old + at].line;
            let before = original[old..old + at].iter().rev();
            old + at - before.take_while(|f| f.line == line && !f.travels()).count()
        });
        let until = begin.unwrap_or(original.len());
        let end = begin.map(|at| stretch_end(&original, at, &lines));
        let (mine, rest) = edits.split_at(begin.zip(end).map_or(0, |(a, b)| edits_in(&original[a..b], edits)));
        let ends = begin.zip(end).and_then(|(a, b)| inside::shifts(&original[a..b], mine));
        let bounds = Bounds { before, after: ends.map(|e| e[0]), slack };
        let gap = until - old;
        let steps = written.get(new..new + gap).ok_or("the program has become shorter")?;
        if begin.is_none() && new + gap != written.len() {
            return Err(format!("{} steps follow the contour, {} were written", gap, written.len() - new));
        }
        proof.moves_outside += outside::compare(&original[old..until], steps, &bounds)?;
        proof.steps_outside += gap;
        new += gap;
        let (Some(begin), Some(end)) = (begin, end) else { break };
        let terms = Terms { tolerance: claim.tolerance, slack, scheduled };
        new += inside::compare(&original[begin..end], &written[new..], mine, terms, &mut along)?;
        old = end;
        before = ends.map(|e| e[1]);
        lines.from += mine.len();
        edits = rest;
    }
    if !edits.is_empty() {
        return Err(format!("line {} has not been found", edits[0].line));
    }
    proof.lines = along.lines;
    proof.arcs = along.arcs;
    proof.deviation_nm = along.deviation_nm;
    proof.kinks = along.kinks;
    proof.feeds = along.feeds;
    Ok(proof)
}

/// Whether two programs do the same, step by step with all modes, on whatever lines and under whatever block numbers.
pub(super) fn same_steps(a: &[u8], b: &[u8], options: Options<'static>) -> bool {
    let read = |text| {
        let facts = facts(text, options, false).ok()?;
        let plain = |fact: Fact| match fact.what {
            What::Comment(_) => None,
            what => Some((fact.block_delete, what, fact.modal)),
        };
        Some(facts.into_iter().filter_map(plain).collect::<Vec<_>>())
    };
    read(a).is_some_and(|a| read(b).is_some_and(|b| a == b))
}

/// A conversational lead may lead on behind where its corrected path ends: that is no part of the contour.
fn without_ways_from_leads(facts: &mut [Fact], edits: &[BlockEdit]) {
    for edit in edits {
        let Some(&end) = edit.samples.last() else { continue };
        let near = |fact: &Fact| fact.curve().is_some_and(|c| is_near([c.end().x.nm(), c.end().y.nm()], end));
        let of_line = |fact: &Fact| fact.line == edit.line && fact.curve().is_some();
        if let Some(last) = facts.iter().rposition(|fact| of_line(fact) && near(fact)) {
            facts.iter_mut().skip(last + 1).filter(|fact| of_line(fact)).for_each(|fact| fact.line = 0);
        }
    }
}

/// Where a stretch that begins at `begin` ends: after its last cutting step.
fn stretch_end(facts: &[Fact], begin: usize, lines: &EditLines) -> usize {
    let mut end = begin;
    for (at, fact) in facts.iter().enumerate().skip(begin) {
        if lines.ends_stretch(fact) {
            break;
        }
        if lines.is_cut(fact) {
            end = at + 1;
        }
    }
    end
}

/// How many of the edits are cut in a stretch.
fn edits_in(stretch: &[Fact], edits: &[BlockEdit]) -> usize {
    let cut: HashSet<u32> = stretch.iter().filter(|f| f.curve().is_some()).map(|f| f.line).collect();
    edits.iter().take_while(|e| cut.contains(&e.line)).count()
}

#[cfg(test)]
mod tests;
