//! docs/summary.schema.json: what stands in the `summary.json` of `correct` and `learn`, from the types that are written; what is written
//! is held against it.

use std::path::Path;

use boon::{Compiler, Draft, Schemas};
use schemars::generate::SchemaSettings;
use serde_json::{Value, json};
use truepath_correction::learn::LearnSummary;
use truepath_correction::summary::CorrectSummary;

use crate::workplace::Workplace;

/// The summaries of both commands: one or the other.
fn schema() -> Value {
    let mut made = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let [correct, learn] = [made.subschema_for::<CorrectSummary>(), made.subschema_for::<LearnSummary>()];
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "summary.json of truepath correct and truepath learn",
        "description": "Keys may be added; none is taken away or changes its unit without another `version`.",
        "anyOf": [learn, correct],
        "$defs": made.take_definitions(true),
    })
}

/// What a summary breaks of its part of the schema.
fn objections(of: &str, summary: &Value) -> Option<String> {
    let schema = json!({ "$ref": format!("#/$defs/{of}"), "$defs": schema()["$defs"] });
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.set_default_draft(Draft::V2020_12);
    compiler.add_resource("summary", schema).expect("a schema");
    let compiled = compiler.compile("summary", &mut schemas).expect("a schema");
    schemas.validate(summary, compiled).err().map(|error| error.to_string())
}

#[test]
fn the_schema_of_a_summary_is_what_is_written() {
    let now = serde_json::to_string_pretty(&schema()).expect("numbers and texts") + "\n";
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/summary.schema.json");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&place, now).expect("a file");
        return;
    }
    let written = std::fs::read_to_string(&place).unwrap_or_default();
    assert_eq!(written, now, "docs/summary.schema.json is not up to date: run this test with BLESS=1");
}

#[test]
fn what_correct_and_learn_write_keeps_to_the_schema() {
    let desk = Workplace::demo("corner", &["program.nc", "job.toml", "plant.toml"]);
    let places = [20.0, 32.0, 68.0, 80.0];
    desk.touch(&places, None, "part-1.txt");
    desk.call("correct job.toml --probe part-1.txt -o first");
    desk.touch(&places, Some("first/corrected.nc"), "part-2.txt");
    desk.call("learn job.toml --probe part-2.txt --from first -o second");
    for (name, of) in [("first", "CorrectSummary"), ("second", "LearnSummary")] {
        let summary: Value = serde_json::from_str(&desk.read(&format!("{name}/summary.json"))).expect("JSON");
        assert_eq!(objections(of, &summary), None);
        // It can be broken.
        let mut less = summary.clone();
        less.as_object_mut().expect("an object").remove("max_error_after_mm");
        assert!(objections(of, &less).is_some_and(|said| said.contains("max_error_after_mm")));
        let mut wrong = summary;
        wrong["floor"]["machine_from"] = json!("guess");
        assert!(objections(of, &wrong).is_some());
    }
}
