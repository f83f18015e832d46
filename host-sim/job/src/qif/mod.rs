//! Results of measuring machines as QIF 3 documents (ANSI/DMSC QIF 3.0): an XML tree whose parts name each other by `id`.
//!
//! | what | where |
//! |---|---|
//! | the document, its unit, its references | here |
//! | points with coordinates, as a file of columns | `points` |
//! | lengths with their names and features | `lengths` |
//!
//! A document may hold several `MeasurementResults`, one for each part measured: the last one counts, as with every other format.
//! Lengths are in the `LinearUnit` of `FileUnits`, metres where there is none. Documents other than these are not read: a QIF
//! reference into another file, a unit of its own at a value (`linearUnit`).

mod lengths;
mod points;

use std::collections::HashMap;
use std::ops::Range;

use roxmltree::{Document, Node, ParsingOptions};
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::M052;

pub(crate) use lengths::{Feature, Length, Shape};
pub(crate) use points::as_columns;

/// Nodes of the tree that a document may have at most.
const MOST_NODES: u32 = 4_000_000;
const NAMESPACE: &str = "http://qifstandards.org/xsd/qif3";

/// Whether a file is an XML document whose root says that it is QIF, of whichever version.
pub(crate) fn is_qif(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(bytes.get(..bytes.len().min(4096)).unwrap_or_default()).into_owned();
    head.trim_start_matches('\u{feff}').trim_start().starts_with('<') && head.contains("QIFDocument")
}

/// A document.
pub(crate) struct Qif<'a> {
    source: &'a Source,
    tree: Document<'a>,
    unit: Unit,
}

/// How a length becomes millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    /// By a shift of the decimal point, which is exact.
    Shifted(i32),
    Inch,
}

impl<'a> Qif<'a> {
    /// Reads a document.
    ///
    /// # Errors
    /// `M052` for what is no QIF 3 document, with line and column.
    pub(crate) fn read(source: &'a Source) -> Result<Self, InputError> {
        let bytes = source.bytes();
        let refused = |found: String, expected: &str, span| Err(M052.error(found, expected).at(source, span));
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text,
            Err(error) => {
                let at = error.valid_up_to();
                let found = format!("{} holds bytes that are no UTF-8", source.name());
                return refused(found, "a document in UTF-8", at..at + 1);
            }
        };
        let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
        let tree = match Document::parse_with_options(text, options) {
            Ok(tree) => tree,
            Err(error) => {
                let at = error.pos();
                let line = source.line_span(at.row);
                // Columns count characters.
                let before = source.excerpt(line.clone());
                let column = at.col.saturating_sub(1) as usize;
                let at = line.start + before.char_indices().nth(column).map_or(before.len(), |(byte, _)| byte);
                return refused(format!("the XML cannot be read: {error}"), "a well-formed document", at..at + 1);
            }
        };
        let root = tree.root_element();
        let name = root.tag_name();
        if name.name() != "QIFDocument" || name.namespace() != Some(NAMESPACE) {
            let found = format!("the root is {} of {}", name.name(), name.namespace().unwrap_or("no namespace"));
            return refused(found, &format!("QIFDocument of {NAMESPACE}"), start(root));
        }
        let unit = unit(source, root)?;
        Ok(Self { source, tree, unit })
    }

    /// The results of the part that was measured last, and what of the kind asked for is in them.
    ///
    /// # Errors
    /// `M052` for a document without results.
    fn results<'t>(&'t self, holds: impl Fn(Node<'t, 'a>) -> bool) -> Result<Option<Node<'t, 'a>>, InputError> {
        let all =
            child(self.tree.root_element(), "Results").and_then(|results| child(results, "MeasurementResultsSet"));
        let Some(all) = all else {
            let found = format!("{} holds no measurement results", self.source.name());
            let expected = "Results with a MeasurementResultsSet";
            return Err(M052.error(found, expected).at(self.source, start(self.tree.root_element())));
        };
        Ok(children(all, "MeasurementResults").filter(|one| holds(*one)).last())
    }

    /// What has an `id`, by it.
    fn by_id<'t>(&'t self) -> HashMap<&'t str, Node<'t, 'a>> {
        self.tree.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect()
    }

    /// A length, mm.
    ///
    /// # Errors
    /// `M052` for what is no number or in a unit of its own.
    fn length(&self, node: Node<'_, '_>) -> Result<Decimal, InputError> {
        if let Some(unit) = node.attribute("linearUnit") {
            let found = format!("a value in a unit of its own, {unit}");
            return Err(M052.error(found, "values in the LinearUnit of FileUnits").at(self.source, start(node)));
        }
        let text = node.text().unwrap_or_default().trim();
        self.decimal(text).ok_or_else(|| {
            let found = format!("{} is \"{text}\"", node.tag_name().name());
            M052.error(found, "a decimal number").at(self.source, start(node))
        })
    }

    /// Three coordinates, mm.
    ///
    /// # Errors
    /// `M052` for anything else.
    fn triple(&self, node: Node<'_, '_>) -> Result<[Decimal; 3], InputError> {
        let text = node.text().unwrap_or_default();
        let all: Option<Vec<Decimal>> = text.split_ascii_whitespace().map(|number| self.decimal(number)).collect();
        all.and_then(|all| <[Decimal; 3]>::try_from(all).ok()).ok_or_else(|| {
            let found = format!("{} is \"{}\"", node.tag_name().name(), text.trim());
            M052.error(found, "three numbers, X Y Z").at(self.source, start(node))
        })
    }

    fn decimal(&self, text: &str) -> Option<Decimal> {
        // Underscores are for TOML.
        let plain = text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E'));
        let number = Some(text).filter(|_| plain)?;
        match self.unit {
            Unit::Inch => Decimal::parse(number).map(Decimal::of_inches),
            Unit::Shifted(by) => {
                let (digits, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
                let exponent = exponent.parse::<i32>().ok()?.checked_add(by)?;
                Decimal::parse(&format!("{digits}e{exponent}"))
            }
        }
    }
}

/// The unit of a document.
fn unit(source: &Source, root: Node<'_, '_>) -> Result<Unit, InputError> {
    let linear = ["FileUnits", "PrimaryUnits", "LinearUnit"].iter().try_fold(root, |node, name| child(node, name));
    let Some(linear) = linear else { return Ok(Unit::Shifted(3)) };
    let Some(conversion) = child(linear, "UnitConversion") else { return Ok(Unit::Shifted(3)) };
    let factor = child(conversion, "Factor").and_then(|factor| factor.text()).unwrap_or("1").trim();
    let offset = child(conversion, "Offset").and_then(|offset| offset.text()).unwrap_or("0").trim();
    let known = match (factor.parse::<f64>(), offset.parse::<f64>()) {
        (Ok(factor), Ok(0.0)) if factor > 0.0 => {
            let shift = (factor.log10().round() as i32).clamp(-9, 9);
            let is = |expected: f64| (factor / expected - 1.0).abs() < 1e-9;
            match () {
                () if is(10f64.powi(shift)) => Some(Unit::Shifted(shift + 3)),
                () if is(0.0254) => Some(Unit::Inch),
                () => None,
            }
        }
        _ => None,
    };
    known.ok_or_else(|| {
        let found = format!("a unit of {factor} metres");
        M052.error(found, "millimetres, 0.001, another power of ten of a metre, or inches, 0.0254")
            .at(source, start(linear))
    })
}

/// A child element by its name.
fn child<'t, 'a>(node: Node<'t, 'a>, name: &str) -> Option<Node<'t, 'a>> {
    node.children().find(|child| child.tag_name().name() == name)
}

fn children<'t, 'a: 't>(node: Node<'t, 'a>, name: &'t str) -> impl Iterator<Item = Node<'t, 'a>> {
    node.children().filter(move |child| child.tag_name().name() == name)
}

/// The start of an element, which is what an error points at.
fn start(node: Node<'_, '_>) -> Range<usize> {
    let from = node.range().start;
    from..from + 1 + node.tag_name().name().len()
}
