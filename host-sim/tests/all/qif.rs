//! QIF 3 results: an inspection written as a document and read again, as dimensions and as points.

use serde_json::Value;

use crate::workplace::Workplace;

/// Two widths, a distance and, in a bore, nothing: what a measuring machine would give of the pocket.
const WIDTHS: &str = "version = 1
[[dimension]]
name = \"length & <more>\"
kind = \"width\"
along = \"x\"
y_mm = 4
z_mm = -6
instrument = \"micrometer\"
value_mm = 69.84
[[dimension]]
name = \"breadth\"
kind = \"width\"
along = \"y\"
x_mm = -3
z_mm = -2
instrument = \"cmm\"
uncertainty_mm = 0.006
value_mm = 49.9
[[dimension]]
name = \"from the face\"
kind = \"distance\"
along = \"x\"
y_mm = 0
face_mm = -50
z_mm = -4
instrument = \"cmm\"
value_mm = 15.08
";

fn errors(told: &Value) -> Vec<f64> {
    told["contacts"].as_array().expect("contacts").iter().filter_map(|c| c["error_mm"].as_f64()).collect()
}

/// The elements of a document in their order, with their paths.
fn paths(document: &str) -> Vec<String> {
    let tree = roxmltree::Document::parse(document).unwrap_or_else(|error| panic!("{error}"));
    let path = |node: roxmltree::Node<'_, '_>| {
        let mut names: Vec<&str> = node.ancestors().map(|node| node.tag_name().name()).collect();
        names.reverse();
        names.join("/")
    };
    tree.root_element().descendants().filter(|node| node.is_element()).map(path).collect()
}

#[test]
fn an_inspection_of_dimensions_is_written_and_read_again_as_the_same_dimensions() {
    let desk = Workplace::demo("pocket", &["job.toml", "program.nc"]);
    desk.write("widths.toml", WIDTHS);
    let told = desk.call("inspect job.toml --dimensions widths.toml --tolerance 0.1 --serial S-17 --qif part.qif");
    let written = desk.read("part.qif");
    let again =
        desk.call("inspect job.toml --dimensions part.qif --tolerance 0.1 --serial S-17 --qif again.qif -o inspected");
    assert_eq!(errors(&told), errors(&again));
    assert_eq!(errors(&told).len(), 3);
    // Made from another file, all else is the same.
    let of_file = |text: &str| {
        let without = ["QPId", "Readings"];
        text.lines()
            .filter(|line| !without.iter().any(|word| line.contains(word)))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(of_file(&written), of_file(&desk.read("again.qif")));
    assert!(desk.read("inspected/dimensions-raw.toml").contains("value_mm = 69.84"));
    // Or values alone, by name, where a file of dimensions says where they were measured.
    let named = WIDTHS.replace("version = 1", "version = 1\nvalues = \"part.qif\"");
    let named: Vec<&str> = named.lines().filter(|line| !line.starts_with("value_mm")).collect();
    desk.write("named.toml", named.join("\n"));
    assert_eq!(errors(&desk.call("inspect job.toml --dimensions named.toml")), errors(&told));
    desk.write("named.toml", named.join("\n").replace("breadth", "height"));
    let refused = desk.run("inspect job.toml --dimensions named.toml").unwrap_err();
    assert!(refused.contains("M053") && refused.contains("from the face"), "{refused}");

    // Every number of a list, every reference and the largest number are what they say.
    let tree = roxmltree::Document::parse(&written).expect("a document");
    for list in tree.descendants().filter(|node| node.has_attribute("n")) {
        let count = list.children().filter(roxmltree::Node::is_element).count().to_string();
        assert_eq!(list.attribute("n"), Some(count.as_str()), "{}", list.tag_name().name());
    }
    let ids: Vec<&str> = tree.descendants().filter_map(|node| node.attribute("id")).collect();
    let numbers: std::collections::BTreeSet<u32> = ids.iter().filter_map(|id| id.parse().ok()).collect();
    assert_eq!(
        (numbers.len(), numbers.last().copied()),
        (ids.len(), tree.root_element().attribute("idMax").and_then(|n| n.parse().ok()))
    );
    for node in
        tree.descendants().filter(|node| node.tag_name().name().ends_with("Id") && node.tag_name().name() != "QPId")
    {
        assert!(ids.contains(&node.text().unwrap_or_default()), "{}", node.tag_name().name());
    }
    // In the order of the schema.
    let own: Vec<String> = paths(&written);
    let order = [
        "QPId",
        "Header",
        "StandardsDefinitions",
        "FileUnits",
        "MeasurementResources",
        "Product",
        "Features",
        "Characteristics",
        "Results",
    ];
    let top: Vec<&str> =
        own.iter().filter_map(|path| path.strip_prefix("/QIFDocument/")).filter(|rest| !rest.contains('/')).collect();
    assert_eq!(top, order);
    assert!(
        written.contains("<Value combinedUncertainty=\"0.003\">49.9</Value>")
            && written.contains("<SerialNumber>S-17<")
    );
}

#[test]
fn points_of_a_document_are_readings_of_the_surface_in_the_line_where_they_stand() {
    let desk = Workplace::demo("pocket", &["job.toml", "program.nc"]);
    // Touched without a ball: surface points 0.03 mm inside the nominal walls of 70 x 50 mm.
    let rows = "x,y,z\n34.97,0,-6\n-34.97,5,-6\n0,24.97,-3\n3,-24.97,-9\n";
    desk.write("points.csv", rows);
    let command =
        "inspect job.toml --format columns --point surface --probe points.csv --tolerance 0.05 --qif part.qif";
    let told = desk.call(command);
    assert!(errors(&told).iter().all(|error| (error - 0.03).abs() < 1e-6), "{told}");
    let written = desk.read("part.qif");
    assert_eq!(written.matches("<PointProfileCharacteristicMeasurement").count(), 4);
    let again = desk.call("inspect job.toml --probe part.qif");
    assert_eq!(errors(&told), errors(&again));
    let line = again["contacts"][0]["line"].as_u64().expect("a line") as usize;
    assert!(written.lines().nth(line - 1).is_some_and(|line| line.contains("<PointFeatureMeasurement")), "{line}");
    desk.call("correct job.toml --probe part.qif -o out");

    // Taken for inches, most points are off the wall.
    desk.write("inch.qif", written.replace("<Factor>0.001</Factor>", "<Factor>0.0254</Factor>"));
    let refused = desk.run("inspect job.toml --probe inch.qif").unwrap_err();
    assert!(refused.contains("inch.qif") && refused.contains("\"line\""), "{refused}");
}

#[test]
fn a_document_that_cannot_be_used_is_refused_with_its_line_and_column() {
    let desk = Workplace::demo("pocket", &["job.toml", "program.nc"]);
    let head = "<?xml version=\"1.0\"?>\n<QIFDocument xmlns=\"http://qifstandards.org/xsd/qif3\">\n";
    let refused = |name: &str, text: String| -> Value {
        desk.write(name, text);
        let error = desk.run(&format!("inspect job.toml --probe {name}")).unwrap_err();
        serde_json::from_str::<Value>(&error).unwrap_or_else(|_| panic!("{error}"))["error"].clone()
    };
    let place =
        |error: &Value| (error["code"].as_str().map(str::to_owned), error["line"].as_u64(), error["column"].as_u64());
    let is = |code: &str, line, column| (Some(code.to_owned()), Some(line), Some(column));
    assert_eq!(place(&refused("cut.qif", format!("{head}<Results>\n</Wrong>"))), is("M052", 4, 1));
    assert_eq!(place(&refused("none.qif", format!("{head}</QIFDocument>"))), is("M052", 2, 1));
    let old = head.replace("qif3", "qif2");
    assert_eq!(place(&refused("old.qif", format!("{old}</QIFDocument>"))), is("M052", 2, 1));
    let results = |inside: &str| {
        format!(
            "{head}<Results><MeasurementResultsSet n=\"1\"><MeasurementResults id=\"1\">\n{inside}\n</MeasurementResults></MeasurementResultsSet></Results></QIFDocument>"
        )
    };
    assert_eq!(place(&refused("empty.qif", results(""))), is("M053", 2, 1));
    let point = |location: &str| {
        results(&format!(
            "<MeasuredFeatures n=\"1\"><PointFeatureMeasurement id=\"2\"><Location>{location}</Location></PointFeatureMeasurement></MeasuredFeatures>"
        ))
    };
    assert_eq!(place(&refused("two.qif", point("1 2"))), is("M052", 4, 57));
    let unit = "<FileUnits><PrimaryUnits><LinearUnit><UnitConversion><Factor>0.3048</Factor></UnitConversion></LinearUnit></PrimaryUnits></FileUnits>\n";
    assert_eq!(place(&refused("foot.qif", format!("{head}{unit}</QIFDocument>"))), is("M052", 3, 26));
    let centre = "<MeasuredPointSets n=\"1\"><MeasuredPointSet id=\"2\" count=\"1\"><Points>0 0 0</Points><Compensated>false</Compensated></MeasuredPointSet></MeasuredPointSets>";
    assert_eq!(place(&refused("ball.qif", results(centre))), is("M053", 4, 26));
    // Neither entities that grow nor elements without end.
    assert_eq!(
        refused("dtd.qif", format!("<!DOCTYPE QIFDocument [<!ENTITY a \"b\">]>{head}</QIFDocument>"))["code"],
        "M052"
    );
    let deep = "<a>".repeat(100_000);
    assert_eq!(refused("deep.qif", format!("{head}{deep}"))["code"], "M052");
    let lengths = desk.run("inspect job.toml --dimensions empty.qif").unwrap_err();
    assert!(lengths.contains("M053") && lengths.contains("values ="), "{lengths}");
}
