//! A history as rows: what each of them is known by, and the history again.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use truepath_core::units::Offset;
use truepath_correction::learning::{Facts, History, Part, Point};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{mm, nm};

/// The SHA-256 of some bytes, in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// JSON of what can always be written.
pub(crate) fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|e| Failure::Internal(format!("JSON: {e}")))
}

/// What JSON of the store says.
pub(crate) fn of_json<T: DeserializeOwned>(text: &str) -> Result<T, Failure> {
    serde_json::from_str(text).map_err(|e| Failure::Internal(format!("JSON of the store: {e}")))
}

/// The facts of a job by their keys.
pub(crate) struct FactTexts {
    pub(crate) json: String,
    pairs: Vec<(String, String)>,
}

impl FactTexts {
    pub(crate) fn of(history: &History) -> Result<Self, Failure> {
        Self::of_facts(&history.facts)
    }

    pub(crate) fn of_facts(facts: &Facts) -> Result<Self, Failure> {
        Self::read(&json(facts)?)
    }

    /// Of a row of the store.
    pub(crate) fn read(json: &str) -> Result<Self, Failure> {
        Ok(Self { json: json.to_owned(), pairs: of_json(json)? })
    }

    /// A fact; empty where there is none.
    pub(crate) fn get(&self, key: &str) -> &str {
        self.pairs.iter().find(|(name, _)| name == key).map_or("", |(_, value)| value)
    }

    /// A fact that is a number; 0 where there is none.
    pub(crate) fn number(&self, key: &str) -> f64 {
        self.get(key).parse().unwrap_or(0.0)
    }

    /// What the job is known by.
    pub(crate) fn hash(&self) -> String {
        sha256(self.json.as_bytes())
    }
}

/// A reading as its row has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reading {
    pub(crate) place_nm: i64,
    pub(crate) height: f64,
    pub(crate) error_nm: i64,
    pub(crate) normal: [f64; 2],
    pub(crate) across_nm: Option<i64>,
    pub(crate) pair: Option<u32>,
    pub(crate) sigma_nm: Option<i64>,
}

impl Reading {
    /// Of a point. Its numbers were exact when they were written; reading the text may have moved the last bit of them, and
    /// the way through the units of the core puts it back.
    fn of(point: &Point, sigma_nm: i64) -> Self {
        let noise = Offset::from_nm(sigma_nm);
        let exact = Point::of(&point.observation(noise), noise);
        Self {
            place_nm: nm(exact.s_mm).nm(),
            height: exact.height,
            error_nm: nm(exact.error_mm).nm(),
            normal: exact.normal,
            across_nm: exact.across_s_mm.map(|across| nm(across).nm()),
            pair: exact.pair,
            sigma_nm: exact.noise_mm.map(|noise| nm(noise).nm()),
        }
    }

    pub(crate) fn point(&self) -> Point {
        Point {
            s_mm: mm_of(self.place_nm),
            height: self.height,
            error_mm: mm_of(self.error_nm),
            normal: self.normal,
            across_s_mm: self.across_nm.map(mm_of),
            pair: self.pair,
            noise_mm: self.sigma_nm.map(mm_of),
        }
    }
}

/// Millimetres of whole nanometres.
pub(crate) fn mm_of(nanometres: i64) -> f64 {
    mm(Offset::from_nm(nanometres))
}

/// A measured part as its rows have it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PartRows {
    pub(crate) number: u32,
    pub(crate) probe_crc32: String,
    pub(crate) sigma_nm: i64,
    pub(crate) readings: Vec<Reading>,
    /// The correction it was cut with, as JSON.
    pub(crate) correction: Option<String>,
    pub(crate) set_aside: bool,
}

impl PartRows {
    pub(crate) fn of(part: &Part) -> Result<Self, Failure> {
        let sigma_nm = nm(part.noise_mm).nm();
        Ok(Self {
            number: part.number,
            probe_crc32: part.probe_crc32.clone(),
            sigma_nm,
            readings: part.points.iter().map(|point| Reading::of(point, sigma_nm)).collect(),
            correction: part.correction.as_ref().map(json).transpose()?,
            set_aside: part.set_aside,
        })
    }

    /// What the measurement is known by beside its part.
    pub(crate) fn hash(&self) -> String {
        let mut bytes = self.sigma_nm.to_le_bytes().to_vec();
        for r in &self.readings {
            for number in [r.place_nm, r.error_nm] {
                bytes.extend(number.to_le_bytes());
            }
            for number in [r.height, r.normal[0], r.normal[1]] {
                bytes.extend(number.to_bits().to_le_bytes());
            }
            for number in [r.across_nm, r.pair.map(i64::from), r.sigma_nm] {
                bytes.push(number.is_some().into());
                bytes.extend(number.unwrap_or(0).to_le_bytes());
            }
        }
        sha256(&bytes)
    }
}

/// What a history says of the next part beside its correction.
#[derive(Clone, Debug, Deserialize)]
struct NextTexts {
    predicted_nm: serde_json::Value,
    sigma_nm: serde_json::Value,
    files: serde_json::Value,
}

/// A history as its rows have it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HistoryRows {
    pub(crate) facts: String,
    pub(crate) parts: Vec<PartRows>,
    pub(crate) correction: String,
    pub(crate) predicted: String,
    pub(crate) sigma: String,
    pub(crate) files: String,
}

impl HistoryRows {
    pub(crate) fn of(history: &History) -> Result<Self, Failure> {
        let next: NextTexts = of_json(&json(&history.next)?)?;
        Ok(Self {
            facts: json(&history.facts)?,
            parts: history.parts.iter().map(PartRows::of).collect::<Result<_, _>>()?,
            correction: json(&history.next.correction)?,
            predicted: json(&next.predicted_nm)?,
            sigma: json(&next.sigma_nm)?,
            files: json(&next.files)?,
        })
    }

    /// The file.
    pub(crate) fn text(&self) -> Result<Vec<u8>, Failure> {
        let value = |text: &str| of_json::<serde_json::Value>(text);
        let part = |part: &PartRows| {
            let points: Vec<Point> = part.readings.iter().map(Reading::point).collect();
            Ok(Part {
                number: part.number,
                probe_crc32: part.probe_crc32.clone(),
                noise_mm: mm_of(part.sigma_nm),
                points,
                correction: part.correction.as_deref().map(of_json).transpose()?,
                set_aside: part.set_aside,
                // A history with new cutters is kept as its file is.
                cutter_from: None,
            })
        };
        let next = serde_json::json!({
            "correction": value(&self.correction)?,
            "predicted_nm": value(&self.predicted)?,
            "sigma_nm": value(&self.sigma)?,
            "files": value(&self.files)?,
        });
        let history = serde_json::json!({
            "version": 1, "facts": value(&self.facts)?, "parts": [], "next": next,
        });
        let mut history: History =
            serde_json::from_value(history).map_err(|e| Failure::Internal(format!("a history of the store: {e}")))?;
        history.parts = self.parts.iter().map(part).collect::<Result<_, Failure>>()?;
        history.text()
    }
}
