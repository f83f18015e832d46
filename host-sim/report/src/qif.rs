//! An inspection as a QIF 3 results document (ANSI/DMSC QIF 3.0), for measuring software and quality systems.
//!
//! | of the inspection | in the document |
//! |---|---|
//! | a touched place | a point feature, nominal and measured, with its outward normal |
//! | its wall error, where the part has limits | a point profile characteristic: positive, material left |
//! | a dimension | a width, thickness, diameter or distance between, of the walls it was measured between |
//! | the part | `Product`, and an `ActualComponent` with serial number and lot |
//! | what it was made from | attributes of the results |
//!
//! Order and names of elements follow the schema of QIF 3.0 and the samples that its makers publish. No clock is read: there is no date but the one that the job says, as a
//! text. The identity of the document (`QPId`) follows from its contents, so that equal inspections are equal to the last byte.

use maud::{Markup, PreEscaped, Render, html};
use truepath_core::checksum::crc32;
use truepath_core::probe::Contact;
use truepath_correction::inspection::{Judgement, PointVerdict, State};
use truepath_ground::units::{float, mm};
use truepath_job::dimension::{Axis, Kind, Placed};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

/// A wall of the part and what is said of it.
#[derive(Clone, Copy, Debug)]
pub struct QifWall<'a> {
    /// Its name, where there are several.
    pub name: Option<&'a str>,
    /// The pass that made it.
    pub pass: &'a Pass,
    /// What was measured.
    pub measurement: &'a Measurement,
    /// The verdict on every reading.
    pub judgement: &'a Judgement,
}

const NAMESPACE: &str = "http://qifstandards.org/xsd/qif3";

/// The readings of the walls of a part, and the verdict on it.
pub fn qif(walls: &[QifWall<'_>], state: State) -> String {
    let mut ids = Ids(0);
    let body = document(walls, state, &mut ids);
    let text = |identity: &str| {
        html! {
            QIFDocument xmlns=(NAMESPACE) xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
                xsi:schemaLocation={ (NAMESPACE) " QIFApplications/QIFDocument.xsd" } idMax=(ids.0) versionQIF="3.0.0" {
                (NEXT) QPId { (identity) } (body) (NEXT)
            }
        }
        .into_string()
    };
    let identity = identity(&text(""));
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n", text(&identity))
}

/// Between elements, so that errors can name a line.
const NEXT: PreEscaped<&str> = PreEscaped("\n");

/// Gives every element its own number.
struct Ids(u32);

impl Ids {
    fn next(&mut self) -> u32 {
        self.0 += 1;
        self.0
    }
}

/// A version 8 UUID (RFC 9562) of a text: four CRC-32 of it, each behind another letter.
fn identity(text: &str) -> String {
    let part = |salt: char| crc32(format!("{salt}{text}").as_bytes());
    let [a, b, c, d] = ['a', 'b', 'c', 'd'].map(part);
    let (high, low) = (b >> 16, b & 0x0FFF);
    format!("{a:08x}-{high:04x}-8{low:03x}-{:04x}-{:04x}{d:08x}", c >> 16 & 0x3FFF | 0x8000, c & 0xFFFF)
}

/// A length in millimetres with all its nanometres.
struct Mm(f64);

impl Render for Mm {
    fn render(&self) -> Markup {
        let text = format!("{:.6}", self.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        html! { (if text == "-0" { "0" } else { text }) }
    }
}

/// Numbers of a list.
struct Triple([f64; 3]);

impl Render for Triple {
    fn render(&self) -> Markup {
        let [x, y, z] = self.0.map(Mm);
        html! { (x) " " (y) " " (z) }
    }
}

/// A text as XML holds it: without the characters that it has no way to write, blanks as `xs:token` wants them.
fn plain(text: &str) -> String {
    let none = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    let visible: String = text.chars().map(|c| if none(c) { ' ' } else { c }).collect();
    visible.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Elements that the lists of the document hold.
#[derive(Default)]
struct Lists {
    feature_definitions: Vec<Markup>,
    feature_nominals: Vec<Markup>,
    feature_items: Vec<Markup>,
    features: Vec<Markup>,
    definitions: Vec<Markup>,
    nominals: Vec<Markup>,
    items: Vec<Markup>,
    measurements: Vec<Markup>,
    devices: Vec<(String, u32)>,
}

/// A list with the number of its elements, nothing where there are none.
fn list(name: &str, elements: &[Markup]) -> Markup {
    if elements.is_empty() {
        return html! {};
    }
    let mut text = format!("\n<{name} n=\"{}\">", elements.len());
    elements.iter().for_each(|element| text.extend(["\n", element.0.as_str()]));
    PreEscaped(text + &format!("\n</{name}>"))
}

/// An element whose name is made from parts.
fn element(name: &str, id: Option<u32>, content: Markup) -> Markup {
    let id = id.map_or_else(String::new, |id| format!(" id=\"{id}\""));
    PreEscaped(format!("<{name}{id}>{}</{name}>", content.0))
}

fn document(walls: &[QifWall<'_>], state: State, ids: &mut Ids) -> Markup {
    let Some(first) = walls.first() else { return html! {} };
    let names = &first.pass.job.part.names;
    let part = plain(names.name.as_deref().unwrap_or_else(|| first.pass.program.name()));
    let model = names.drawing.as_deref().map_or_else(|| part.clone(), plain);
    let [standard, product, component, path, actual, results] = [(); 6].map(|()| ids.next());
    let mut lists = Lists::default();
    walls.iter().for_each(|wall| lists.wall(wall, ids));
    let devices: Vec<Markup> = lists
        .devices
        .iter()
        .map(|(name, id)| element("MeasurementDevice", Some(*id), html! { Name { (name) } }))
        .collect();
    let status = match state {
        State::Pass => "PASS",
        State::Fail => "FAIL",
        State::Open => "UNKNOWN",
    };
    let status = html! { InspectionStatusEnum { (status) } };
    let made = made_from(walls);
    html! {
        (NEXT) Header {
            Application { Name { "Truepath " (env!("CARGO_PKG_VERSION")) } }
            Description { "Wall of " (part) ": deviations from the contour of the program, positive where material is left" }
            Scope { "Results" }
        }
        (NEXT) StandardsDefinitions n="1" {
            Standard id=(standard) {
                Organization { StandardsOrganizationEnum { "ISO" } } Designator { "1101" } Year { "2017" }
            }
        }
        (NEXT) FileUnits { PrimaryUnits { LinearUnit {
            SIUnitName { "meter" } UnitName { "mm" } UnitConversion { Factor { "0.001" } }
        } } }
        @if !devices.is_empty() { (NEXT) MeasurementResources { (list("MeasurementDevices", &devices)) } }
        (NEXT) Product {
            PartSet n="1" { Part id=(product) { ModelNumber { (model) } } }
            ComponentSet n="1" { Component id=(component) { Part { Id { (product) } } } }
            AsmPaths n="1" { AsmPath id=(path) { ComponentIds n="1" { Id { (component) } } } }
        }
        (NEXT) Features {
            (list("FeatureDefinitions", &lists.feature_definitions))
            (list("FeatureNominals", &lists.feature_nominals))
            (list("FeatureItems", &lists.feature_items))
        }
        @if !lists.items.is_empty() {
            (NEXT) Characteristics {
                FormalStandardId { (standard) }
                (list("CharacteristicDefinitions", &lists.definitions))
                (list("CharacteristicNominals", &lists.nominals))
                (list("CharacteristicItems", &lists.items))
            }
        }
        (NEXT) Results {
            MeasurementResultsSet n="1" {
                MeasurementResults id=(results) {
                    (list("Attributes", &made))
                    (list("MeasuredFeatures", &lists.features))
                    @if !lists.measurements.is_empty() {
                        MeasuredCharacteristics { (list("CharacteristicMeasurements", &lists.measurements)) }
                    }
                    InspectionStatus { (status) }
                    ActualComponentIds n="1" { Id { (actual) } }
                }
            }
            (NEXT) ActualComponentSets n="1" { ActualComponentSet n="1" { ActualComponent id=(actual) {
                @if let Some(serial) = &names.serial { SerialNumber { (plain(serial)) } }
                Status { (status) }
                @if let Some(lot) = &names.material_batch { Traceability { LotNumber { (plain(lot)) } } }
                AsmPathId { (path) }
            } } }
        }
    }
}

/// What the results were made from, for whoever traces them back.
fn made_from(walls: &[QifWall<'_>]) -> Vec<Markup> {
    let mut all: Vec<(String, String)> = Vec::new();
    for wall in walls {
        let names = &wall.pass.job.part.names;
        let program = &wall.pass.program;
        let mut told = vec![
            ("Program".to_owned(), program.name().to_owned()),
            ("ProgramCRC32".to_owned(), format!("{:08x}", crc32(program.bytes()))),
            ("Readings".to_owned(), wall.measurement.file.clone()),
            ("ReadingsCRC32".to_owned(), format!("{:08x}", wall.measurement.crc)),
        ];
        let said = [("Customer", &names.customer), ("Date", &names.date)];
        told.extend(said.into_iter().filter_map(|(name, text)| Some((name.to_owned(), text.clone()?))));
        for one in told {
            if !all.contains(&one) {
                all.push(one);
            }
        }
    }
    let attribute = |(name, value): &(String, String)| html! { AttributeStr name=(name) value=(plain(value)) {} };
    all.iter().map(attribute).collect()
}

impl Lists {
    fn wall(&mut self, wall: &QifWall<'_>, ids: &mut Ids) {
        let measured = wall.measurement;
        let named = |what: String| wall.name.map_or_else(|| what.clone(), |name| format!("{}: {what}", plain(name)));
        let verdict = |at: usize| wall.judgement.points.get(at).copied();
        let points = measured.contacts.iter().enumerate().filter(|(_, c)| measured.dimension(c.line).is_none());
        let points: Vec<(usize, &Contact)> = points.collect();
        if !points.is_empty() {
            let definition = ids.next();
            self.feature_definitions.push(element("PointFeatureDefinition", Some(definition), html! {}));
            let probe = self.device("touch probe", ids);
            let profile = self.profile(wall.pass, ids);
            for (at, contact) in points {
                let name = named(format!("point {}", measured.number(contact.line)));
                let place = Touched::of(wall.pass, contact);
                let (item, feature) = self.point(definition, &name, &place, true, ids);
                let (Some(profile), Some(feature)) = (profile, feature) else { continue };
                let characteristic = ids.next();
                self.items.push(element(
                    "PointProfileCharacteristicItem",
                    Some(characteristic),
                    html! {
                        Name { "profile of " (name) }
                        FeatureItemIds n="1" { Id { (item) } }
                        MeasurementDeviceIds n="1" { Id { (probe) } }
                        CharacteristicNominalId { (profile) }
                    },
                ));
                self.measurements.push(element(
                    "PointProfileCharacteristicMeasurement",
                    Some(ids.next()),
                    html! {
                        (status(verdict(at)))
                        CharacteristicItemId { (characteristic) }
                        FeatureMeasurementIds n="1" { Id { (feature) } }
                        Value combinedUncertainty=(Mm(mm(measured.noise))) { (Mm(mm(contact.error))) }
                    },
                ));
            }
        }
        for (at, contact) in measured.contacts.iter().enumerate() {
            let Some(placed) = measured.dimension(contact.line) else { continue };
            // A dimension between two contours is one characteristic.
            if measured.is_second_half(contact.line) {
                continue;
            }
            let name = named(plain(&placed.dimension.name));
            self.dimension(wall.pass, placed, &name, verdict(at), ids);
        }
    }

    /// The device of a name.
    fn device(&mut self, name: &str, ids: &mut Ids) -> u32 {
        if let Some((_, id)) = self.devices.iter().find(|(own, _)| own == name) {
            return *id;
        }
        let id = ids.next();
        self.devices.push((name.to_owned(), id));
        id
    }

    /// The profile that the limits of a part are; `None` without limits, since a profile has to have them.
    fn profile(&mut self, pass: &Pass, ids: &mut Ids) -> Option<u32> {
        let tolerance = pass.job.part.tolerance?;
        let (lower, upper) = (mm(tolerance.lower), mm(tolerance.upper));
        let (definition, nominal) = (ids.next(), ids.next());
        self.definitions.push(element(
            "PointProfileCharacteristicDefinition",
            Some(definition),
            html! {
                ToleranceValue { (Mm(upper - lower)) }
                @if tolerance.upper != -tolerance.lower { OuterDisposition { (Mm(upper)) } }
            },
        ));
        self.nominals.push(element(
            "PointProfileCharacteristicNominal",
            Some(nominal),
            html! {
                CharacteristicDefinitionId { (definition) }
            },
        ));
        Some(nominal)
    }

    /// A point feature; returns its item and, where it was measured, its measurement.
    fn point(
        &mut self,
        definition: u32,
        name: &str,
        place: &Touched,
        measured: bool,
        ids: &mut Ids,
    ) -> (u32, Option<u32>) {
        let (nominal, item) = (ids.next(), ids.next());
        self.feature_nominals.push(element(
            "PointFeatureNominal",
            Some(nominal),
            html! {
                FeatureDefinitionId { (definition) }
                Location { (Triple(place.nominal)) }
                Normal { (Triple(place.normal)) }
            },
        ));
        self.feature_items.push(item_of("PointFeatureItem", item, nominal, name));
        let feature = measured.then(|| ids.next());
        if let Some(feature) = feature {
            self.features.push(element(
                "PointFeatureMeasurement",
                Some(feature),
                html! {
                    FeatureItemId { (item) }
                    Location { (Triple(place.actual)) }
                    Normal { (Triple(place.normal)) }
                },
            ));
        }
        (item, feature)
    }

    /// A dimension with the walls that it is between.
    fn dimension(&mut self, pass: &Pass, placed: &Placed, name: &str, verdict: Option<PointVerdict>, ids: &mut Ids) {
        let dimension = &placed.dimension;
        let first = Touched::of(pass, &placed.contact);
        let second =
            placed.across.map(|across| Touched::of(pass, &Contact { height: placed.contact.height, ..across }));
        let kind = match (dimension.kind, dimension.face) {
            (_, Some(_)) | (Kind::Distance, _) => "DistanceBetween",
            (Kind::Width, _) => "Width",
            (Kind::Thickness, _) => "Thickness",
            (Kind::Diameter, _) => "Diameter",
        };
        let features = match (&second, dimension.face) {
            (Some(second), _) if dimension.kind == Kind::Diameter => {
                vec![self.circle(placed, name, &first, second, ids)]
            }
            (Some(second), _) => {
                let definition = ids.next();
                self.feature_definitions.push(element("PointFeatureDefinition", Some(definition), html! {}));
                let mut point = |place: &Touched, which: &str| {
                    self.point(definition, &format!("{name}, {which} wall"), place, false, ids).0
                };
                vec![point(&first, "first"), point(second, "second")]
            }
            (None, face) => {
                let definition = ids.next();
                self.feature_definitions.push(element("PointFeatureDefinition", Some(definition), html! {}));
                let wall = self.point(definition, &format!("{name}, wall"), &first, false, ids).0;
                let plane = self.face(name, dimension.along, face.unwrap_or_default(), &first, ids);
                vec![plane, wall]
            }
        };
        let device = self.device(dimension.instrument.name(), ids);
        let [definition, nominal, item, measurement] = [(); 4].map(|()| ids.next());
        self.definitions.push(element(
            &format!("{kind}CharacteristicDefinition"),
            Some(definition),
            limits(pass, placed),
        ));
        let direction = match dimension.along {
            Axis::X => [1.0, 0.0, 0.0],
            Axis::Y => [0.0, 1.0, 0.0],
        };
        self.nominals.push(element(
            &format!("{kind}CharacteristicNominal"),
            Some(nominal),
            html! {
                CharacteristicDefinitionId { (definition) }
                TargetValue { (Mm(placed.nominal_mm)) }
                @if kind == "DistanceBetween" {
                    AnalysisVector { (Triple(direction)) }
                    AnalysisMode { "ONEDIMENSIONAL" }
                }
            },
        ));
        self.items.push(element(
            &format!("{kind}CharacteristicItem"),
            Some(item),
            html! {
                Name { (name) }
                FeatureItemIds n=(features.len()) { @for feature in &features { Id { (feature) } } }
                MeasurementDeviceIds n="1" { Id { (device) } }
                CharacteristicNominalId { (nominal) }
            },
        ));
        self.measurements.push(element(
            &format!("{kind}CharacteristicMeasurement"),
            Some(measurement),
            html! {
                (status(verdict))
                CharacteristicItemId { (item) }
                Value combinedUncertainty=(Mm(0.5 * mm(dimension.uncertainty))) { (Mm(mm(dimension.value))) }
            },
        ));
    }

    /// The circle that a diameter is of.
    fn circle(&mut self, placed: &Placed, name: &str, first: &Touched, second: &Touched, ids: &mut Ids) -> u32 {
        let [definition, nominal, item] = [(); 3].map(|()| ids.next());
        let across = [0, 1].map(|axis| first.normal[axis] * (second.nominal[axis] - first.nominal[axis]));
        let inside = across[0] + across[1] > 0.0;
        self.feature_definitions.push(element(
            "CircleFeatureDefinition",
            Some(definition),
            html! {
                InternalExternal { (if inside { "INTERNAL" } else { "EXTERNAL" }) }
                Diameter { (Mm(placed.nominal_mm)) }
            },
        ));
        let middle = [0, 1, 2].map(|axis| 0.5 * (first.nominal[axis] + second.nominal[axis]));
        self.feature_nominals.push(element(
            "CircleFeatureNominal",
            Some(nominal),
            html! {
                FeatureDefinitionId { (definition) }
                Location { (Triple(middle)) }
                Normal { (Triple([0.0, 0.0, 1.0])) }
            },
        ));
        self.feature_items.push(item_of("CircleFeatureItem", item, nominal, name));
        item
    }

    /// The face that a distance is from.
    fn face(&mut self, name: &str, along: Axis, face: f64, wall: &Touched, ids: &mut Ids) -> u32 {
        let [definition, nominal, item] = [(); 3].map(|()| ids.next());
        let own = along.of([0, 1]);
        let (mut place, mut normal) = (wall.nominal, [0.0; 3]);
        normal[own] = (face - place[own]).signum();
        place[own] = face;
        self.feature_definitions.push(element("PlaneFeatureDefinition", Some(definition), html! {}));
        self.feature_nominals.push(element(
            "PlaneFeatureNominal",
            Some(nominal),
            html! {
                FeatureDefinitionId { (definition) }
                Location { (Triple(place)) }
                Normal { (Triple(normal)) }
            },
        ));
        self.feature_items.push(item_of("PlaneFeatureItem", item, nominal, &format!("{name}, face")));
        item
    }
}

fn item_of(element_name: &str, item: u32, nominal: u32, name: &str) -> Markup {
    element(
        element_name,
        Some(item),
        html! {
            FeatureNominalId { (nominal) }
            FeatureName { (name) }
            DeterminationMode { Checked { CheckDetails { Measured {} } } }
        },
    )
}

fn status(verdict: Option<PointVerdict>) -> Markup {
    let status = match verdict {
        Some(PointVerdict::Pass) => "PASS",
        Some(PointVerdict::Fail) => "FAIL",
        Some(PointVerdict::Open) => "INDETERMINATE",
        None => "UNDEFINED",
    };
    html! { Status { CharacteristicStatusEnum { (status) } } }
}

/// Limits of a dimension: what those of its walls leave it.
fn limits(pass: &Pass, placed: &Placed) -> Markup {
    let Some(tolerance) = pass.job.part.tolerance else { return html! { NonTolerance { "MEASURED" } } };
    let [a, b] = [tolerance.lower, tolerance.upper].map(|limit| placed.larger_per_error * mm(limit));
    html! { Tolerance { MaxValue { (Mm(a.max(b))) } MinValue { (Mm(a.min(b))) } DefinedAsLimit { "false" } } }
}

/// A place of a wall, mm: where it should be, where it is, and its normal out of the material.
struct Touched {
    nominal: [f64; 3],
    actual: [f64; 3],
    normal: [f64; 3],
}

impl Touched {
    fn of(pass: &Pass, contact: &Contact) -> Self {
        let numbers = &pass.job.numbers;
        let tip = pass.core.contour.z;
        let coordinate =
            |p: truepath_core::units::Position| (p - truepath_core::units::Position::ZERO).nm() as f64 / 1e6;
        let z = coordinate(tip) + float(contact.height) * mm(numbers.cut.axial_depth);
        let actual = [coordinate(contact.point.x), coordinate(contact.point.y), z];
        let normal = [-float(contact.normal.x), -float(contact.normal.y), 0.0];
        let error = mm(contact.error);
        let nominal = [0, 1, 2].map(|axis| actual[axis] - error * normal[axis]);
        Self { nominal, actual, normal }
    }
}
