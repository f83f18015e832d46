//! What of job and program must be the same from part to part: the contour and how it is cut.
//!
//! Priors of machine and material may change, and so may the target: every fit and every design starts from them anew.

use serde::{Deserialize, Serialize};
use truepath_core::gcode::program_crc;
use truepath_core::geometry::Side;
use truepath_ground::diagnostics::InputError;
use truepath_ground::units::{float, mm};
use truepath_job::pass::{Pass, milling_name};

use crate::codes::Q002;

/// Facts by the key of the job they come from, with their value as text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Facts(Vec<(String, String)>);

impl Facts {
    /// Of a pass.
    pub fn of(pass: &Pass) -> Self {
        let setup = &pass.core.setup;
        let feature = pass.plan.as_ref().map(|plan| plan.id.clone().unwrap_or_else(|| plan.number.to_string()));
        let feeds: Vec<String> = pass.blocks.iter().map(|b| float(b.feed).to_string()).collect();
        let facts = [
            ("program", format!("{:08x}", program_crc(pass.program.bytes()))),
            ("feature", feature.unwrap_or_else(|| "the only cut".to_owned())),
            ("pass", pass.level().to_string()),
            ("wall", if setup.wall == Side::Left { "left" } else { "right" }.to_owned()),
            ("milling", milling_name(setup.milling).to_owned()),
            ("stock.allowance_mm", mm(setup.allowance).to_string()),
            ("tool.diameter_mm", (2.0 * mm(setup.radius)).to_string()),
            ("tool.teeth", setup.teeth.to_string()),
            ("tool.helix_deg", float(setup.helix_deg).to_string()),
            ("cut.axial_depth_mm", float(setup.axial_depth).to_string()),
            ("cut.spindle_rpm", float(setup.spindle_rpm).to_string()),
            ("cut.feed_mm_per_min", format!("{:08x}", truepath_core::checksum::crc32(feeds.join(" ").as_bytes()))),
            ("feed", if pass.job.feed.is_some() { "scheduled" } else { "as programmed" }.to_owned()),
        ];
        Self(facts.map(|(key, value)| (key.to_owned(), value)).into())
    }

    /// Refuses a pass of which a fact differs.
    ///
    /// # Errors
    /// `Q002` at the key of the job, with both values.
    pub fn agree(&self, pass: &Pass) -> Result<(), InputError> {
        let own = Self::of(pass);
        let differs = own.0.iter().find(|(key, value)| self.get(key) != Some(value));
        let Some((key, value)) = differs else { return Ok(()) };
        let found = match key.as_str() {
            "program" => format!("{} has the CRC-32 {value}", pass.program.name()),
            "cut.feed_mm_per_min" => "the feeds along the contour are others than those of the history".to_owned(),
            key => format!("{key} is {value}"),
        };
        let before = self.get(key).map_or("nothing", String::as_str);
        let expected = format!("{before}, as when the first part of the history was corrected");
        let help = "name the folder that this job was corrected into; after a change of program, tool or cut start again with truepath correct";
        let error = InputError::new(Q002, found, expected, help);
        Err(if pass.job.gives(key) { error.at(pass.job.source(), pass.job.span(key)) } else { error })
    }

    /// The level of the feature that was measured.
    pub fn level(&self) -> Option<u32> {
        self.get("pass")?.parse().ok()
    }

    fn get(&self, key: &str) -> Option<&String> {
        self.0.iter().find(|(k, _)| k == key).map(|(_, value)| value)
    }
}
