//! Data into the page: the file that is written.

use std::io;

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::{CharEscape, CompactFormatter, Formatter};
use truepath_ground::diagnostics::{Failure, visible_lines};

use super::Page;
use super::several::Several;

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
    embedded(page)
}

/// The page of several contours of one program, each with its name (`contour-2`, or the id of its feature) and what a page of
/// its own would hold. Of one contour the same bytes as [`render`].
///
/// # Errors
/// Internal, without a contour, with contours of different kinds, and as [`render`].
pub fn render_all(contours: &[(String, Page)]) -> Result<Vec<u8>, Failure> {
    if let [(_, page)] = contours {
        return render(page);
    }
    let several = Several::of(contours)
        .ok_or_else(|| Failure::Internal(format!("a page of {} contours, not of one kind", contours.len())))?;
    embedded(&several)
}

/// The page with such data.
fn embedded(data: &impl Serialize) -> Result<Vec<u8>, Failure> {
    let (before, after) =
        PAGE.split_once(PLACE).ok_or_else(|| Failure::Internal("the page has no place for data".to_owned()))?;
    let failed = |e: &dyn std::fmt::Display| Failure::Internal(format!("JSON: {e}"));
    let mut written = Vec::new();
    data.serialize(&mut Serializer::with_formatter(&mut written, Visible)).map_err(|e| failed(&e))?;
    let data = String::from_utf8(written).map_err(|e| failed(&e))?;
    // In JSON these characters occur within strings only.
    let data = data.replace('<', r"\u003c").replace('\u{2028}', r"\u2028").replace('\u{2029}', r"\u2029");
    Ok([before, TAGS[0], &data, TAGS[1], after].concat().into_bytes())
}

#[cfg(test)]
mod tests {
    use super::{PAGE, PLACE, TAGS, render, render_all};
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
            page.warnings.push(text.into());
            let file = render(&page).unwrap();
            let read = data(&file);
            assert_eq!(read["title"], shown);
            assert_eq!(read["warnings"][0], shown);
            let file = String::from_utf8(file).unwrap();
            assert_eq!(file.matches('<').count(), PAGE.matches('<').count(), "{text}");
            assert!(!file.contains(['\u{2028}', '\u{2029}']) || PAGE.contains(['\u{2028}', '\u{2029}']));
        }
    }

    fn named(kind: Kind, names: &[&str]) -> Vec<(String, Page)> {
        names.iter().map(|name| ((*name).to_owned(), Page::new(kind, format!("Correction of {name}")))).collect()
    }

    #[test]
    fn a_page_of_one_contour_is_the_page_of_that_contour() {
        let [one] = &named(Kind::Correct, &["contour-1"])[..] else { unreachable!() };
        assert_eq!(render_all(std::slice::from_ref(one)).unwrap(), render(&one.1).unwrap());
    }

    #[test]
    fn a_page_of_several_holds_each_as_a_page_of_its_own_would() {
        let contours = named(Kind::Correct, &["contour-1", "<b>", "contour-3"]);
        let file = render_all(&contours).unwrap();
        let read = data(&file);
        assert_eq!((&read["version"], &read["kind"]), (&1.into(), &"correct".into()));
        assert_eq!(read["contours"].as_array().unwrap().len(), 3);
        for (of, (name, page)) in read["contours"].as_array().unwrap().iter().zip(&contours) {
            assert_eq!((&of["name"], &of["page"]), (&name[..].into(), &data(&render(page).unwrap())));
        }
        assert_eq!(String::from_utf8(file).unwrap().matches('<').count(), PAGE.matches('<').count());
    }

    #[test]
    fn a_page_of_several_is_called_by_what_they_share() {
        let mut contours = named(Kind::Correct, &["contour-1", "contour-2"]);
        let title = |contours: &[(String, Page)]| data(&render_all(contours).unwrap())["title"].clone();
        for (_, page) in &mut contours {
            page.program = Some(crate::page::Program { name: "part.nc".into(), crc32: None, chosen: None });
        }
        assert_eq!(title(&contours), "Correction of part.nc");
        for (_, page) in &mut contours {
            page.title = "Correction of Bracket 17".into();
        }
        assert_eq!(title(&contours), "Correction of Bracket 17");
    }

    #[test]
    fn no_contours_and_contours_of_two_kinds_are_no_page() {
        let mut contours = named(Kind::Correct, &["contour-1", "contour-2"]);
        contours[1].1.kind = Kind::Learn;
        for wrong in [&contours[..], &[]] {
            assert!(matches!(render_all(wrong), Err(truepath_ground::diagnostics::Failure::Internal(_))));
        }
    }

    #[test]
    fn around_the_data_the_page_is_as_built() {
        let file = String::from_utf8(render(&Page::new(Kind::Simulate, "part")).unwrap()).unwrap();
        let (before, after) = PAGE.split_once(PLACE).unwrap();
        assert!(file.starts_with(before) && file.ends_with(after));
    }
}
