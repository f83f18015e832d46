//! What the driver noted: where each scenario lies in the recording, and what was done and said in it.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::step::Failure;

/// Notes of one scenario. Places are sequence numbers of the component.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    pub name: String,
    pub from: u32,
    pub to: u32,
    /// Why the driver gave up in it.
    pub failed: Option<String>,
    /// What LinuxCNC said to the operator.
    pub said: Vec<String>,
    marks: Vec<(String, u32)>,
    values: Value,
}

impl Notes {
    /// The last period before something was done; the end of the scenario when it was not.
    pub fn mark(&self, what: &str) -> u32 {
        self.marks.iter().find(|(name, _)| name == what).map_or(self.to, |&(_, at)| at)
    }

    /// A number that was noted.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.values.get(name)?.as_f64()
    }

    /// A word that was noted.
    pub fn word(&self, name: &str) -> &str {
        self.values.get(name).and_then(Value::as_str).unwrap_or_default()
    }
}

/// Reads the notes of a session.
///
/// # Errors
/// The file is missing or is none.
pub fn read(folder: &Path) -> Result<Vec<Notes>, Failure> {
    let file = folder.join("notes.json");
    let wrong = |why: String| Failure::found(format!("{}: {why}", file.display()));
    let text = fs::read_to_string(&file).map_err(|e| wrong(e.to_string()))?;
    let all: Value = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
    let scenarios = all["scenarios"].as_array().ok_or_else(|| wrong("there are no scenarios in it".into()))?;
    Ok(scenarios.iter().map(of).collect())
}

fn of(entry: &Value) -> Notes {
    let place = |value: &Value| value.as_u64().and_then(|v| u32::try_from(v).ok()).unwrap_or_default();
    let list = |key: &str| entry[key].as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    Notes {
        name: text(&entry["name"]),
        from: place(&entry["from"]),
        to: place(&entry["to"]),
        failed: entry["failed"].as_str().map(str::to_owned),
        said: list("said").iter().map(|m| text(&m["text"])).collect(),
        marks: list("marks").iter().map(|m| (text(&m["what"]), place(&m["at"]))).collect(),
        values: entry["values"].clone(),
    }
}
