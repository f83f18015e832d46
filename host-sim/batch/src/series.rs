//! Readings of many parts as deviations at places.

use truepath_ground::length::Unit;

/// Readings this near to each other are of one place, mm along the contour and over the height.
const SAME: [f64; 2] = [1.0, 1.0];

/// A place of the wall that is touched on several parts.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Place {
    /// The contour, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// Along the contour, mm.
    pub s_mm: f64,
    /// Above the cutter's tip, mm.
    pub height_mm: f64,
    /// Direction towards the wall.
    pub normal: [f64; 2],
    /// How far an uncorrected cut would be off there, mm; 0 where it is not known.
    pub deflection_mm: f64,
}

/// What happened before a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Event {
    /// A new cutter was put in.
    Cutter,
    /// Another lot of material.
    Lot,
    /// The machine was set up anew: datum, fixture, probe.
    Setup,
}

/// One reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Where.
    pub place: Place,
    /// Deviation, mm: positive, material left.
    pub error_mm: f64,
}

/// A touched part.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its number in the batch.
    pub number: u32,
    /// What happened before it, on any part since the last touched one.
    pub events: Vec<Event>,
    /// Index of the place and deviation, mm.
    pub readings: Vec<(usize, f64)>,
}

/// A batch as it was touched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Places, in the order in which they were first touched.
    pub places: Vec<Place>,
    /// Parts, in order.
    pub parts: Vec<Part>,
    /// The last part that was milled, where that is another than the last touched one, and what happened before it.
    pub milled: Option<(u32, Vec<Event>)>,
}

impl Series {
    /// Adds the readings of a part.
    pub fn push(&mut self, number: u32, events: Vec<Event>, readings: impl IntoIterator<Item = Reading>) {
        let mut of_part = Vec::new();
        for Reading { place, error_mm } in readings {
            let known = self.places.iter().position(|p| p.is_at(&place));
            let at = known.unwrap_or_else(|| {
                self.places.push(place);
                self.places.len() - 1
            });
            of_part.push((at, error_mm));
        }
        self.parts.push(Part { number, events, readings: of_part });
    }

    /// Deviations at a place: part and mean of its readings there.
    pub fn at(&self, place: usize) -> Vec<(u32, f64)> {
        let of = |part: &Part| {
            let own: Vec<f64> = part.readings.iter().filter(|(at, _)| *at == place).map(|(_, e)| *e).collect();
            (!own.is_empty()).then(|| (part.number, own.iter().sum::<f64>() / own.len() as f64))
        };
        self.parts.iter().filter_map(of).collect()
    }
}

/// Whether the deflection is known at any of the places: without it a level of force looks like a radius.
pub(crate) fn any_is_pushed<'p>(places: impl IntoIterator<Item = &'p Place>) -> bool {
    places.into_iter().any(|place| place.deflection_mm != 0.0)
}

impl Place {
    fn is_at(&self, other: &Self) -> bool {
        self.contour == other.contour
            && (self.s_mm - other.s_mm).abs() < SAME[0]
            && (self.height_mm - other.height_mm).abs() < SAME[1]
    }

    /// In words, lengths in a unit.
    pub fn words(&self, unit: Unit) -> String {
        let of = self.contour.as_ref().map_or_else(String::new, |name| format!("{name}, "));
        let (s, height, name) = (unit.of(self.s_mm), unit.of(self.height_mm), unit.name());
        format!("{of}s = {s:.1} {name}, {height:.1} {name} above the tip")
    }
}
