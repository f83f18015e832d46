//! Which programs do not count, by rule.
//!
//! A rule looks at the text of the program or at what the reference says, never at the name of a file.

use super::corpus::Program;
use super::outcome::End;

/// Why a program does not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// G7, G8, G33, G70–G73 of the lathe, G76, G96.
    Lathe,
    /// A parameter of the running machine or of its configuration file.
    MachineParameter,
    /// A subroutine in a file that is not beside the program.
    MissingFile,
    /// A code that a configuration remaps to Python or to a subroutine.
    Remap,
    /// Axes that only a configuration gives the reference.
    Axes,
    /// The reference dies or does not end.
    ReferenceCrashes,
}

impl Rule {
    /// All of them, in the order of the report.
    pub const ALL: [Self; 6] =
        [Self::Lathe, Self::MachineParameter, Self::MissingFile, Self::Remap, Self::Axes, Self::ReferenceCrashes];

    /// Its words in the report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lathe => "lathe codes: G7, G8, G33, G33.1, G70–G72 with Q, G76, G96 in the program",
            Self::MachineParameter => "the reference says that a `#<_hal[…]>` or `#<_ini[…]>` parameter is not defined",
            Self::MissingFile => "the reference looks for a subroutine in a file that is not there",
            Self::Remap => {
                "a code that only the configuration's remaps define: the reference knows no such G, T or cycle"
            }
            Self::Axes => "the reference has no axes U, V, W without a configuration",
            Self::ReferenceCrashes => "the reference dies or is not done in time",
        }
    }

    /// The first rule that a program falls under.
    pub fn of(program: &Program, theirs: &End) -> Option<Self> {
        match theirs {
            End::Crashed(_) => return Some(Self::ReferenceCrashes),
            End::Refused { message, .. } => {
                let says = |text: &str| message.contains(text);
                if says("_hal[") || says("_ini[") {
                    return Some(Self::MachineParameter);
                }
                if says("EOF in file") || says("Unable to open file") {
                    return Some(Self::MissingFile);
                }
                if ["'u'", "'v'", "'w'"].iter().any(|axis| says("Bad character") && says(axis)) {
                    return Some(Self::Axes);
                }
                let remapped = String::from_utf8_lossy(&program.text).to_ascii_lowercase().contains("remap");
                if remapped && (says("Unknown g code") || says("requires a Q word")) {
                    return Some(Self::Remap);
                }
            }
            End::Accepted => {}
        }
        [&program.text, &program.called].iter().any(|text| has_lathe_code(text)).then_some(Self::Lathe)
    }
}

/// Whether a lathe's code stands outside the comments.
fn has_lathe_code(text: &[u8]) -> bool {
    const CODES: [&str; 6] = ["7", "8", "33", "33.1", "76", "96"];
    const WITH_Q: [&str; 6] = ["70", "71", "71.1", "71.2", "72", "72.1"];
    let text = String::from_utf8_lossy(text).to_ascii_lowercase();
    text.lines().any(|line| {
        let mut block: String = line.split(';').next().unwrap_or_default().to_owned();
        while let (Some(open), Some(close)) = (block.find('('), block.find(')')) {
            if open > close {
                break;
            }
            block.replace_range(open..=close, "");
        }
        let block: String = block.chars().filter(|c| !c.is_ascii_whitespace()).collect();
        // A letter before the g belongs to a name.
        let starts = block.match_indices('g').filter(|(at, _)| {
            let before = block[..*at].chars().next_back();
            before.is_none_or(|c| !c.is_ascii_alphabetic() && !"<_".contains(c))
        });
        starts.into_iter().any(|(at, _)| {
            let number: String = block[at + 1..].chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect();
            let number = number.trim_start_matches('0');
            CODES.contains(&number) || (WITH_Q.contains(&number) && block.contains('q'))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lathe_codes_are_seen_in_blocks_only() {
        assert!(has_lathe_code(b"G0 X1\nN5 g 7 6 P1\n"));
        assert!(has_lathe_code(b"G07\n"));
        assert!(!has_lathe_code(b"(G76)\nG17 G80 ; G76\no<g76base> call\n"));
        assert!(!has_lathe_code(b"G73 Q1 X1\nG70\n"));
    }
}
