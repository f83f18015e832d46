//! The controls that verification programs are written for.

use truepath_ground::diagnostics::InputError;

use super::plan::Plan;
use super::{fanuc, grbl, haas, linuxcnc};

/// A control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ProbeDialect {
    /// Haas NGC with Renishaw Inspection Plus: results as inspection text through DPRNT.
    Haas,
    /// Fanuc with a probe on the skip signal: G31, results as inspection text through DPRNT.
    Fanuc,
    /// LinuxCNC: G38.3, results in a log of its own.
    Linuxcnc,
    /// grbl and grblHAL: G38.3, results in the console log.
    Grbl,
}

impl ProbeDialect {
    /// `[probe] format` of the file that the program makes.
    pub const fn probe_format(self) -> &'static str {
        match self {
            Self::Haas | Self::Fanuc => "dprnt",
            Self::Linuxcnc => "linuxcnc-log",
            Self::Grbl => "grbl",
        }
    }
}

/// Writes the program of a plan for a control. `log` names the file of results where the program opens one.
///
/// # Errors
/// `V005` when the control has no word for something in the plan.
pub fn write(plan: &Plan, dialect: ProbeDialect, log: &str) -> Result<String, InputError> {
    match dialect {
        ProbeDialect::Haas => haas::write(plan),
        ProbeDialect::Fanuc => fanuc::write(plan),
        ProbeDialect::Linuxcnc => linuxcnc::write(plan, log),
        ProbeDialect::Grbl => grbl::write(plan),
    }
}
