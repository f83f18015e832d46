//! The name of a machine as a level of a topic.

use truepath_ground::diagnostics::InputError;

use crate::codes::Q014;

/// Letters of a name at most.
const MOST: usize = 64;

/// A name that can stand in a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine(String);

/// What is told of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// How the process stands; the broker keeps the last one.
    State,
    /// A part.
    Part,
    /// The alarms that are raised; the broker keeps the last ones.
    Alarm,
}

impl Machine {
    /// Of a text.
    ///
    /// # Errors
    /// `Q014`: `+` and `#` are wildcards, `/` ends a level, and control characters end worse.
    pub fn of(name: &str) -> Result<Self, InputError> {
        let wrong = |found: String| Err(Q014.error(found, "a name without + # / and control characters"));
        if name.trim().is_empty() {
            return wrong("the machine has no name".to_owned());
        }
        if name.chars().count() > MOST {
            return wrong(format!("the name of the machine has more than {MOST} characters"));
        }
        match name.chars().find(|c| matches!(c, '+' | '#' | '/') || c.is_control()) {
            Some(letter) => wrong(format!("`{}` in the name of the machine `{name}`", letter.escape_default())),
            None => Ok(Self(name.to_owned())),
        }
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.0
    }

    /// `truepath/NAME/state` and its like.
    pub fn topic(&self, of: Topic) -> String {
        let last = match of {
            Topic::State => "state",
            Topic::Part => "part",
            Topic::Alarm => "alarm",
        };
        format!("truepath/{}/{last}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_one_level_of_a_topic_or_refused() {
        for name in ["vf2", "Fräse 3", "mill_1-a.b", "$x"] {
            let machine = Machine::of(name).expect(name);
            assert_eq!(machine.topic(Topic::Part), format!("truepath/{name}/part"));
        }
        let long = "m".repeat(65);
        for name in ["", "  ", "a/b", "+", "a#", "a\0b", "a\nb", &long] {
            let refused = Machine::of(name).expect_err(name);
            assert_eq!(refused.code(), "Q014", "{name}");
        }
        assert!(Machine::of("a#b").is_err_and(|error| error.found().contains("`#`")));
    }
}
