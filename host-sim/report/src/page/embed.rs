//! Data into the page: the file that is written.

use std::io;

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::{CharEscape, CompactFormatter, Formatter};
use truepath_ground::diagnostics::{Failure, visible_lines};

use super::Page;

/// The page, built from `host-sim/page` (`npm run build` there).
const PAGE: &str = include_str!("../../../page/dist/report.html");
/// The one place for the data in it.
const PLACE: &str = r#"<script type="application/json" id="truepath-data">null</script>"#;
/// The same as an opening and a closing tag.
const TAGS: [&str; 2] = [r#"<script type="application/json" id="truepath-data">"#, "</script>"];

/// JSON whose texts show their control characters.
struct Visible;

impl Formatter for Visible {
    fn write_string_fragment<W: ?Sized + io::Write>(&mut self, writer: &mut W, fragment: &str) -> io::Result<()> {
        writer.write_all(visible_lines(fragment).as_bytes())
    }
    fn write_char_escape<W: ?Sized + io::Write>(&mut self, writer: &mut W, escape: CharEscape) -> io::Result<()> {
        let hidden = match escape {
            CharEscape::Backspace => '\x08',
            CharEscape::FormFeed => '\x0c',
            CharEscape::CarriageReturn => '\r',
            CharEscape::AsciiControl(byte) => byte.into(),
            other => return CompactFormatter.write_char_escape(writer, other),
        };
        writer.write_all(visible_lines(hidden.encode_utf8(&mut [0; 4])).as_bytes())
    }
}

/// The page with the data in it. Whatever texts the data hold, none of it is read as markup: no `<` is left in them, and
/// no control character.
///
/// # Errors
/// Internal, when the data cannot be written as JSON.
pub fn render(page: &Page) -> Result<Vec<u8>, Failure> {
    let (before, after) =
        PAGE.split_once(PLACE).ok_or_else(|| Failure::Internal("the page has no place for data".to_owned()))?;
    let failed = |e: &dyn std::fmt::Display| Failure::Internal(format!("JSON: {e}"));
    let mut data = Vec::new();
    page.serialize(&mut Serializer::with_formatter(&mut data, Visible)).map_err(|e| failed(&e))?;
    let data = String::from_utf8(data).map_err(|e| failed(&e))?;
    // In JSON these characters occur within strings only.
    let data = data.replace('<', r"\u003c").replace('\u{2028}', r"\u2028").replace('\u{2029}', r"\u2029");
    Ok([before, TAGS[0], &data, TAGS[1], after].concat().into_bytes())
}

/// The page of several contours.
///
/// # Errors
/// As [`render`].
pub fn render_all(contours: &[(String, Page)]) -> Result<Vec<u8>, Failure> {
    contours.first().map_or_else(|| Err(Failure::Internal("a page of no contour".to_owned())), |(_, page)| render(page))
}

#[cfg(test)]
mod tests {
    use super::{PAGE, PLACE, TAGS, render};
    use crate::page::{Kind, Page};

    fn data(file: &[u8]) -> serde_json::Value {
        let text = std::str::from_utf8(file).unwrap();
        let (_, rest) = text.split_once(TAGS[0]).unwrap();
        serde_json::from_str(rest.split_once(TAGS[1]).unwrap().0).unwrap()
    }

    #[test]
    fn the_built_page_has_exactly_one_place_for_data() {
        assert_eq!(PAGE.matches(PLACE).count(), 1);
        assert_eq!(PAGE.matches(TAGS[0]).count(), 1);
        assert_eq!(PLACE, [TAGS[0], "null", TAGS[1]].concat());
    }

    #[test]
    fn hostile_texts_stay_texts() {
        let texts =
            ["</script><script>alert(1)</script>", "<!--", "<![CDATA[", "a\u{2028}b\u{2029}c", "\"\\u001b\n\t", "&lt;"];
        let shown = texts.map(|text| (text, text)).into_iter();
        let hidden = [("\u{0}\u{8}\u{c}\r", "␀␈␌␍"), ("\u{1b}]0;a\u{7}\u{9b}1m\u{202e}", "␛]0;a␇\u{fffd}1m\u{fffd}")];
        for (text, shown) in shown.chain(hidden) {
            let mut page = Page::new(Kind::Correct, text);
            page.warnings.push(text.to_owned());
            let file = render(&page).unwrap();
            let read = data(&file);
            assert_eq!(read["title"], shown);
            assert_eq!(read["warnings"][0], shown);
            let file = String::from_utf8(file).unwrap();
            assert_eq!(file.matches('<').count(), PAGE.matches('<').count(), "{text}");
            assert!(!file.contains(['\u{2028}', '\u{2029}']) || PAGE.contains(['\u{2028}', '\u{2029}']));
        }
    }

    #[test]
    fn around_the_data_the_page_is_as_built() {
        let file = String::from_utf8(render(&Page::new(Kind::Simulate, "part")).unwrap()).unwrap();
        let (before, after) = PAGE.split_once(PLACE).unwrap();
        assert!(file.starts_with(before) && file.ends_with(after));
    }
}
