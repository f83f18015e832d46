//! Which messages a change makes.

use std::path::Path;

use serde_json::{Value, json};
use truepath_publish::board::{Board, News, Parts};
use truepath_publish::message::Status;
use truepath_publish::summary::Summary;

use crate::support::batches::summary;

fn parsed(summary: &Value) -> Summary {
    Summary::parse(summary.to_string().as_bytes(), Path::new("summary.json")).expect("a summary")
}

fn board(names: &[&str]) -> Board {
    Board::new("vf2", Status::Online, names.iter().map(|name| (*name).to_owned()))
}

fn value(message: impl serde::Serialize) -> Value {
    serde_json::to_value(message).expect("JSON")
}

fn numbers(news: &News) -> Vec<u32> {
    news.parts.iter().map(|message| message.part.part).collect()
}

/// Parts that drift by two micrometres each.
fn drifting(parts: usize) -> Vec<f64> {
    (0..parts).map(|k| 0.002 * k as f64).collect()
}

#[test]
fn a_state_says_what_the_summary_says_with_its_units() {
    let summary = summary(&drifting(8), 0.03);
    let state = value(board(&["corner"]).take(0, &parsed(&summary), Parts::New, "T").state);
    let last = &summary["states"][7];
    let near = |key: &str, wanted: &Value| {
        let [found, wanted] = [&state[key], wanted].map(|v| v.as_f64().unwrap_or_else(|| panic!("{key}: {state}")));
        assert!((found - wanted).abs() <= 5e-7, "{key}: {found} and {wanted}");
    };
    near("force_level", &last["force_level"]["value"]);
    near("force_level_sigma", &last["force_level"]["sigma"]);
    near("radius_lost_mm", &last["radius_lost_mm"]["value"]);
    near("datum_y_sigma_mm", &last["datum_mm"][1]["sigma"]);
    near("next_in_tolerance", &summary["next_in_tolerance"]);
    near("reading_sigma_mm", &summary["noise_mm"]);
    assert_eq!(state["leaves_at_part"], summary["leaves_at_part"]);
    let leaves = summary["leaves_at_part"].as_u64().expect("it leaves the tolerance");
    assert_eq!(state["parts_left"], json!(leaves - 8 - 1));
    let wanted = json!({"schema": 1, "machine": "vf2", "time": "T", "status": "online", "batch": "corner",
        "software_version": env!("CARGO_PKG_VERSION"), "last_part": 8, "parts_touched": 8,
        "tolerance_lower_mm": -0.03, "tolerance_upper_mm": 0.03});
    for (key, wanted) in wanted.as_object().expect("an object") {
        assert_eq!(&state[key], wanted, "{key}");
    }
    assert_eq!(state["in_control"], json!(summary["alarms"].as_array().is_some_and(Vec::is_empty)));
    assert!(state.get("others").is_none());
}

#[test]
fn a_part_is_told_once_and_again_when_it_is_touched_again() {
    let mut board = board(&["corner"]);
    let mut errors = drifting(3);
    let first = board.take(0, &parsed(&summary(&errors, 0.03)), Parts::Known, "T1");
    assert!(first.parts.is_empty() && first.state.is_some() && first.alarms.is_some());
    assert_eq!(first.last.as_ref().map(|last| last.part.part), Some(3));
    let same = board.take(0, &parsed(&summary(&errors, 0.03)), Parts::New, "T2");
    assert_eq!((same.state, same.alarms, same.parts.len()), (None, None, 0));
    errors.push(0.05);
    let new = board.take(0, &parsed(&summary(&errors, 0.03)), Parts::New, "T3");
    assert_eq!(numbers(&new), [4]);
    let part = value(&new.parts[0]);
    assert_eq!((&part["in_tolerance"], &part["readings"], &part["time"]), (&json!(false), &json!(4), &json!("T3")));
    let worst = part["worst_deviation_mm"].as_f64().expect("a number");
    assert!((0.05..0.0506).contains(&worst), "{part}");
    errors[1] += 0.001;
    assert_eq!(numbers(&board.take(0, &parsed(&summary(&errors, 0.03)), Parts::New, "T4")), [2]);
    // Another table in the same folder: what it has is new.
    let table = [0.001, 0.002];
    assert_eq!(numbers(&board.take(0, &parsed(&summary(&table, 0.03)), Parts::New, "T5")), [1, 2]);
}

#[test]
fn an_alarm_keeps_its_key_and_its_beginning_and_is_cleared_by_name() {
    let mut board = board(&["corner"]);
    let mut take =
        |errors: &[f64], now: &str| value(board.take(0, &parsed(&summary(errors, 0.01)), Parts::New, now).alarms);
    let calm = take(&[0.0, 0.001], "T1");
    assert_eq!((&calm["raised"], &calm["cleared"]), (&json!([]), &json!([])));
    let first = take(&[0.0, 0.001, 0.012], "T2");
    let one =
        first["raised"].as_array().and_then(|all| all.iter().find(|one| one["kind"] == "out_of_tolerance")).cloned();
    let one = one.unwrap_or_else(|| panic!("{first}"));
    assert_eq!(
        (&one["key"], &one["level"], &one["since"]),
        (&json!("corner/out_of_tolerance"), &json!("fault"), &json!("T2"))
    );
    assert!(one["text"].as_str().is_some_and(|text| text.starts_with("part 3 is out of tolerance: +12.")), "{one}");
    let second = take(&[0.0, 0.001, 0.012, 0.013], "T3");
    let again = second["raised"].as_array().and_then(|all| all.iter().find(|again| again["key"] == one["key"]));
    assert!(again.is_some_and(|again| again["since"] == "T2" && again["part"] == 4), "{second}");
    let after = take(&[0.0, 0.001], "T4");
    assert_eq!(after["raised"], json!([]));
    let cleared = after["cleared"].as_array().expect("a list");
    assert!(cleared.iter().any(|one| one["key"] == "corner/out_of_tolerance"), "{after}");
}

#[test]
fn of_several_batches_the_one_that_changed_last_is_in_front() {
    let mut board = board(&["corner", "pocket"]);
    board.take(0, &parsed(&summary(&[0.0, 0.02], 0.01)), Parts::New, "T1");
    let state = value(board.take(1, &parsed(&summary(&[0.0, 0.001], 0.01)), Parts::New, "T2").state);
    assert_eq!((&state["batch"], &state["in_control"]), (&json!("pocket"), &json!(true)));
    assert_eq!((&state["others"][0]["batch"], &state["others"][0]["in_control"]), (&json!("corner"), &json!(false)));
    assert!(state["alarms"].as_u64() >= Some(1), "those of both: {state}");
}

/// docs/publish.md names every key that is sent.
#[test]
fn every_key_of_a_message_stands_in_the_document() {
    fn keys(value: &Value, into: &mut Vec<String>) {
        match value {
            Value::Object(all) => all.iter().for_each(|(key, value)| {
                into.push(key.clone());
                keys(value, into);
            }),
            Value::Array(all) => all.iter().for_each(|value| keys(value, into)),
            _ => (),
        }
    }
    let document = include_str!("../../../../docs/publish.md");
    let mut board = board(&["corner", "pocket"]);
    let mut sent = Vec::new();
    for (batch, errors) in [(0, &[0.0, 0.02][..]), (1, &[0.0]), (0, &[0.0])] {
        let News { state, parts, alarms, .. } = board.take(batch, &parsed(&summary(errors, 0.01)), Parts::New, "T");
        let messages = parts.into_iter().map(value).chain(state.map(value)).chain(alarms.map(value));
        messages.for_each(|message| keys(&message, &mut sent));
    }
    assert!(["others", "cleared", "since", "worst_deviation_mm"].iter().all(|key| sent.iter().any(|one| one == key)));
    for key in sent {
        assert!(document.contains(&format!("`{key}`")), "{key}");
    }
}
