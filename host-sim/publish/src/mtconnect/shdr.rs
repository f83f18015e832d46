//! The lines of an adapter (SHDR): `time|item|value|item|value`, and of a condition
//! `time|item|level|native code|severity|qualifier|text`.
//!
//! A bar separates, a line feed ends, and both could stand in a text. An agent takes a field in double quotes as one, with
//! `\|` for a bar in it. What it makes of other quotes, backslashes and control characters differs from version to version, so
//! none of them goes out.

/// The most that an agent should have to take for one field.
const LONGEST: usize = 500;

/// A field of one line.
pub fn field(text: &str) -> String {
    let plain = |c: char| match c {
        '"' => '\'',
        '\\' => '/',
        _ if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') => ' ',
        _ => c,
    };
    let clean: String = text.chars().take(LONGEST).map(plain).collect();
    // An agent would take blanks at the ends off, and a field of none for one that is not there.
    let clean = clean.trim();
    if clean.contains('|') { format!("\"{}\"", clean.replace('|', "\\|")) } else { clean.to_owned() }
}

/// A line of values of one time.
pub fn values<'v>(time: &str, values: impl IntoIterator<Item = (&'v str, &'v str)>) -> String {
    let mut line = time.to_owned();
    for (item, value) in values {
        line += &format!("|{item}|{}", field(value));
    }
    line + "\n"
}

/// A line of a condition.
pub fn condition(time: &str, item: &str, level: &str, code: &str, qualifier: &str, text: &str) -> String {
    format!("{time}|{item}|{level}|{}||{qualifier}|{}\n", field(code), field(text))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A line as an agent cuts it: at bars, but for fields in quotes that end before a bar or the end.
    fn cut(line: &str) -> Vec<String> {
        let mut fields = Vec::new();
        let mut rest = line;
        loop {
            let quoted = rest.strip_prefix('"').and_then(|inner| {
                let mut ends = inner.match_indices('"').map(|(at, _)| at);
                let end = ends.find(|at| inner[at + 1..].is_empty() || inner[at + 1..].starts_with('|'))?;
                let whole = inner[..end].replace("\\|", "");
                (!whole.contains('|')).then_some((&inner[..end], &inner[end + 1..]))
            });
            let (taken, behind) = match quoted {
                Some((inner, behind)) => (inner.replace("\\|", "|"), behind),
                None => {
                    let end = rest.find('|').unwrap_or(rest.len());
                    (rest[..end].trim().to_owned(), &rest[end..])
                }
            };
            fields.push(taken);
            match behind.strip_prefix('|') {
                Some(next) => rest = next,
                None => return fields,
            }
        }
    }

    #[test]
    fn the_cut_is_that_of_an_agent() {
        assert_eq!(cut(r#"y|"a\|b\|"|z"#), ["y", "a|b|", "z"]);
        assert_eq!(cut(r#"y|"a\|b"#), ["y", "\"a\\", "b"]);
        assert_eq!(cut("x|y||z|"), ["x", "y", "", "z", ""]);
    }

    #[test]
    fn bars_quotes_and_line_feeds_of_a_text_stay_in_their_field() {
        assert_eq!(field("part 7 | \"corner\"\r\nnext"), "\"part 7 \\| 'corner'  next\"");
        assert_eq!(field(" plain "), "plain");
        assert_eq!(values("T", [("a", "1"), ("b", "x|y")]), "T|a|1|b|\"x\\|y\"\n");
        assert_eq!(condition("T", "c", "FAULT", "k/1", "HIGH", "out"), "T|c|FAULT|k/1||HIGH|out\n");
    }

    proptest! {
        /// Whatever a text holds, the line is one, of as many fields as it has, and the text comes out as far as it can be said.
        #[test]
        fn no_alarm_text_breaks_a_line(text in any::<String>(), bars in "[|\"\\\\\r\n a]{0,12}", code in "[|\"\\\\ab/]{0,8}") {
            for text in [text.clone(), bars.clone(), text + &bars] {
                let line = condition("2026-11-27T18:35:01Z", "alarm", "WARNING", &code, "LOW", &text);
                let inside = line.strip_suffix('\n').unwrap();
                prop_assert!(!inside.contains(char::is_control), "{inside:?}");
                let fields = cut(inside);
                prop_assert_eq!(fields.len(), 7, "{}", inside);
                prop_assert_eq!((fields[2].as_str(), fields[4].as_str(), fields[5].as_str()), ("WARNING", "", "LOW"));
                let said: Vec<char> = fields[6].chars().filter(|c| c.is_alphanumeric() || *c == '|').collect();
                let meant: Vec<char> = text.chars().take(LONGEST).filter(|c| c.is_alphanumeric() || *c == '|').collect();
                prop_assert_eq!(said, meant);
            }
        }
    }
}
