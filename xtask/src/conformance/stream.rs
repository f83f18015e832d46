//! Canonical calls as text, and two lists of them compared.
//!
//! Calls that place the tool or say what its numbers mean are motion; comments, tools, spindle and coolant are not.
//! Numbers are equal when they differ by no more than one unit of the fourth decimal: both sides round there.

/// The largest difference of two numbers that count as equal.
const TOLERANCE: f64 = 1.0001e-4;

/// One call: name and arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call<'a> {
    /// `STRAIGHT_FEED`.
    pub name: &'a str,
    /// What stands between the parentheses.
    pub arguments: &'a str,
}

impl<'a> Call<'a> {
    /// From a line of output, running number and N word before it; `None` for what a program printed itself.
    fn read(line: &'a str) -> Option<Self> {
        let rest = line.trim_start().split_once(char::is_whitespace)?.1;
        let rest = rest.trim_start().split_once(char::is_whitespace)?.1.trim_start();
        let (name, arguments) = rest.split_once('(')?;
        let capital = name.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_');
        let numbered = line.trim_start().starts_with(|c: char| c.is_ascii_digit());
        (capital && numbered).then(|| Self { name, arguments: arguments.strip_suffix(')').unwrap_or(arguments) })
    }

    /// Whether it places the tool or changes what the numbers of later calls mean.
    fn is_motion(&self) -> bool {
        const MOTION: [&str; 17] = [
            "STRAIGHT_TRAVERSE",
            "STRAIGHT_FEED",
            "STRAIGHT_PROBE",
            "ARC_FEED",
            "NURBS_FEED",
            "NURBS_G5_FEED",
            "RIGID_TAP",
            "DWELL",
            "SET_FEED_RATE",
            "SET_FEED_MODE",
            "SELECT_PLANE",
            "USE_LENGTH_UNITS",
            "SET_G5X_OFFSET",
            "SET_G92_OFFSET",
            "SET_XY_ROTATION",
            "USE_TOOL_LENGTH_OFFSET",
            "START_SPEED_FEED_SYNC",
        ];
        MOTION.contains(&self.name)
    }

    fn agrees(&self, other: &Self) -> bool {
        let numbers = |text: &'a str| text.split([',', ' ']).map(str::trim).filter(|t| !t.is_empty());
        let mut theirs = other.arguments.split([',', ' ']).map(str::trim).filter(|t| !t.is_empty());
        self.name == other.name
            && numbers(self.arguments).all(|a| theirs.next().is_some_and(|b| equal(a, b)))
            && theirs.next().is_none()
    }
}

fn equal(a: &str, b: &str) -> bool {
    a == b || matches!((a.parse::<f64>(), b.parse::<f64>()), (Ok(a), Ok(b)) if (a - b).abs() <= TOLERANCE)
}

/// The calls of an output, those of motion only when asked.
pub fn calls(text: &str, motion: bool) -> Vec<Call<'_>> {
    text.lines().filter_map(Call::read).filter(|c| !motion || c.is_motion()).collect()
}

/// Where two lists part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Calls that agree before it.
    pub after: usize,
    /// The reference's call, or its end.
    pub theirs: String,
    /// Ours.
    pub ours: String,
}

/// The first call that differs; with `prefix`, theirs may end before ours.
pub fn difference(theirs: &[Call<'_>], ours: &[Call<'_>], prefix: bool) -> Option<Difference> {
    let agreeing = theirs.iter().zip(ours).take_while(|(a, b)| a.agrees(b)).count();
    let (their, our) = (theirs.get(agreeing), ours.get(agreeing));
    if their.is_none() && (our.is_none() || prefix) {
        return None;
    }
    let show = |call: Option<&Call<'_>>| call.map_or("(end)".to_owned(), |c| format!("{}({})", c.name, c.arguments));
    Some(Difference { after: agreeing, theirs: show(their), ours: show(our) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_agree_to_the_last_printed_digit() {
        let a = calls("    7 N10    STRAIGHT_FEED(1.0000, -0.0000)\n", true);
        let b = calls("    9 N.....  STRAIGHT_FEED(1.0001, 0.0000)\n", true);
        let c = calls("    9 N..... STRAIGHT_FEED(1.0002, 0.0000)\n", true);
        assert_eq!(difference(&a, &b, false), None);
        assert!(difference(&a, &c, false).is_some());
    }

    #[test]
    fn comments_and_what_a_program_prints_are_no_motion() {
        let text = " hello (world)\n    1 N..... COMMENT(\"x\")\n    2 N..... DWELL(1.0000)\n";
        assert_eq!(calls(text, true).len(), 1);
        assert_eq!(calls(text, false).len(), 2);
    }

    #[test]
    fn a_missing_call_is_a_difference_but_for_a_stopped_reference() {
        let long = calls("1 N1 DWELL(1)\n2 N1 DWELL(2)\n", true);
        assert_eq!(difference(&long, &long[..1], true).map(|d| d.ours), Some("(end)".to_owned()));
        assert_eq!(difference(&long[..1], &long, true), None);
        assert!(difference(&long[..1], &long, false).is_some());
    }
}
