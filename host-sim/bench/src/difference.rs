//! The first difference between board and host, with all that is known of the tick.

use std::fmt;

use truepath_core::rewrite::{Output, Setpoint};

/// Where board and host part, or where an answer breaks a rule.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Answers before it.
    pub tick: u64,
    /// What differs.
    pub what: String,
    /// The setpoint.
    pub setpoint: Option<Setpoint>,
    /// The host's answer.
    pub expected: Option<Output>,
    /// The board's answer.
    pub found: Option<Output>,
    /// The host's state after the tick.
    pub host_state: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "tick {}: {}", self.tick, self.what)?;
        if let Some(setpoint) = &self.setpoint {
            writeln!(f, "  setpoint    {setpoint:?}")?;
        }
        for (name, output) in [("host", &self.expected), ("board", &self.found)] {
            match output {
                Some(output) => writeln!(f, "  {name:<11} {output:?}")?,
                None => writeln!(f, "  {name:<11} no answer")?,
            }
        }
        write!(f, "  host state  {}", self.host_state)
    }
}
