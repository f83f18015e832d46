//! Measured lengths of a QIF document: characteristics with a value, the name of their item and the nominal features they are of.

use std::collections::HashMap;
use std::ops::Range;

use roxmltree::Node;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::InputError;

use super::{Qif, child, children, start};

/// Characteristics of the standard that are a length between places.
const LENGTHS: [&str; 9] = [
    "Width",
    "Thickness",
    "Diameter",
    "DistanceBetween",
    "DistanceFrom",
    "Length",
    "Chord",
    "LinearCoordinate",
    "UserDefinedLinear",
];

/// A measured length.
#[derive(Clone, Debug)]
pub(crate) struct Length {
    /// The kind of its characteristic, `Width` of `WidthCharacteristicMeasurement`.
    pub(crate) kind: &'static str,
    /// Name and designator of its item.
    pub(crate) names: Vec<String>,
    /// What was measured, mm.
    pub(crate) value: Decimal,
    /// Its standard uncertainty, where the document says it, mm.
    pub(crate) uncertainty: Option<Decimal>,
    /// Names of the devices it was measured with.
    pub(crate) devices: Vec<String>,
    /// The features of its item.
    pub(crate) features: Vec<Feature>,
    /// Where its value stands.
    pub(crate) span: Range<usize>,
}

/// What a feature is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// A point of a wall.
    Point,
    /// A plane.
    Plane,
    /// A circle, a cylinder, or a part of one.
    Round,
    /// Anything else.
    Other,
}

/// A nominal feature.
#[derive(Clone, Debug)]
pub(crate) struct Feature {
    pub(crate) shape: Shape,
    /// A place of it, of a round one on its axis, mm.
    pub(crate) place: Option<[Decimal; 3]>,
    /// Its normal, out of the material; of a round one its axis.
    pub(crate) normal: Option<[f64; 3]>,
}

impl Qif<'_> {
    /// The lengths of the part that was measured last, in the order of the document.
    ///
    /// # Errors
    /// `M052` for a document without results and for values that are none.
    pub(crate) fn lengths(&self) -> Result<Vec<Length>, InputError> {
        let Some(results) = self.results(|results| measured(results).next().is_some())? else { return Ok(Vec::new()) };
        let ids = self.by_id();
        let named = |node: Node<'_, '_>, key: &str| child(node, key).and_then(|id| ids.get(id.text()?.trim()).copied());
        let mut found = Vec::new();
        for (kind, measurement) in measured(results) {
            let status = child(measurement, "Status").and_then(|status| child(status, "CharacteristicStatusEnum"));
            if matches!(status.and_then(|node| node.text()).map(str::trim), Some("SYSERROR" | "NOT_ANALYZED")) {
                continue;
            }
            let Some(value) = child(measurement, "Value") else { continue };
            let item = named(measurement, "CharacteristicItemId");
            let designator = |item| child(child(item, "CharacteristicDesignator")?, "Designator");
            let names = item.into_iter().flat_map(|item| [child(item, "Name"), designator(item)]);
            let names = names.flatten().filter_map(|node| Some(node.text()?.trim().to_owned())).collect();
            let devices =
                [Some(measurement), item].into_iter().flatten().find_map(|of| child(of, "MeasurementDeviceIds"));
            let devices =
                listed(&ids, devices).filter_map(|device| Some(child(device, "Name")?.text()?.trim().to_owned()));
            let uncertainty = value.attribute("combinedUncertainty").and_then(|text| self.decimal(text.trim()));
            let items = item.and_then(|item| child(item, "FeatureItemIds"));
            let nominals = listed(&ids, items).map(|item| named(item, "FeatureNominalId"));
            let features = nominals.map(|nominal| self.feature(nominal)).collect::<Result<_, _>>()?;
            found.push(Length {
                kind,
                names,
                value: self.length(value)?,
                uncertainty,
                devices: devices.collect(),
                features,
                span: start(value),
            });
        }
        Ok(found)
    }

    fn feature(&self, nominal: Option<Node<'_, '_>>) -> Result<Feature, InputError> {
        let Some(nominal) = nominal else { return Ok(Feature { shape: Shape::Other, place: None, normal: None }) };
        let shape = match nominal.tag_name().name() {
            "PointFeatureNominal" | "EdgePointFeatureNominal" => Shape::Point,
            "PlaneFeatureNominal" => Shape::Plane,
            "CircleFeatureNominal" | "CylinderFeatureNominal" | "CircularArcFeatureNominal" => Shape::Round,
            _ => Shape::Other,
        };
        let axis = child(nominal, "Axis");
        let place = child(nominal, "Location").or_else(|| child(axis?, "AxisPoint"));
        let normal = child(nominal, "Normal").or_else(|| child(axis?, "Direction"));
        let normal = normal.and_then(|node| {
            let numbers: Vec<f64> = node.text()?.split_ascii_whitespace().filter_map(|n| n.parse().ok()).collect();
            <[f64; 3]>::try_from(numbers).ok()
        });
        Ok(Feature { shape, place: place.map(|node| self.triple(node)).transpose()?, normal })
    }
}

/// Measured lengths of a part with their kinds.
fn measured<'t, 'a: 't>(results: Node<'t, 'a>) -> impl Iterator<Item = (&'static str, Node<'t, 'a>)> {
    let all = child(results, "MeasuredCharacteristics").and_then(|all| child(all, "CharacteristicMeasurements"));
    let all = all.into_iter().flat_map(|all| all.children());
    all.filter_map(|node| {
        let kind = node.tag_name().name().strip_suffix("CharacteristicMeasurement")?;
        Some((*LENGTHS.iter().find(|length| **length == kind)?, node))
    })
}

/// What a list of references names.
fn listed<'t, 'a: 't>(
    ids: &'t HashMap<&'t str, Node<'t, 'a>>,
    list: Option<Node<'t, 'a>>,
) -> impl Iterator<Item = Node<'t, 'a>> {
    let all = list.into_iter().flat_map(|list| children(list, "Id"));
    all.filter_map(|id| ids.get(id.text()?.trim()).copied())
}
