//! Control characters made visible: what stands in a file may be shown, it may not steer the terminal or the reader.

use std::borrow::Cow;

/// One line of text: a line feed in it is made visible as well.
pub fn visible(text: &str) -> Cow<'_, str> {
    shown(text, |c| c != '\t')
}

/// Text of several lines.
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    shown(text, |c| !matches!(c, '\t' | '\n'))
}

/// Control characters become the pictures Unicode has for them, `␛` for escape; those without a picture, and marks that
/// turn the direction of reading, become `U+FFFD`. The number of characters stays.
fn shown(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    let picture = |c: char| match c {
        _ if !hidden(c) => None,
        '\0'..='\x1f' => char::from_u32(0x2400 + u32::from(c)),
        '\x7f' => Some('␡'),
        '\u{80}'..='\u{9f}' | '\u{61c}' | '\u{200e}' | '\u{200f}' => Some(char::REPLACEMENT_CHARACTER),
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => Some(char::REPLACEMENT_CHARACTER),
        _ => None,
    };
    // Bytes first: programs are long and nearly always plain.
    let plain = |b: u8| matches!(b, b' '..=b'~') || b.is_ascii_control() && !hidden(b.into());
    if text.bytes().all(plain) || text.chars().all(|c| picture(c).is_none()) {
        return Cow::Borrowed(text);
    }
    text.chars().map(|c| picture(c).unwrap_or(c)).collect::<String>().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_steers_a_terminal_is_left_and_other_text_stays() {
        let steers = "\0\x07\x08\r\x1b[31mred\x7f\u{9b}31m\u{202e}";
        assert_eq!(visible(steers), "␀␇␈␍␛[31mred␡\u{fffd}31m\u{fffd}");
        assert_eq!((visible("a\nb"), visible_lines("a\nb\r")), ("a␊b".into(), "a\nb␍".into()));
        let plain = "G1\tX1 (µm, Größe, 直径, 🛠)";
        assert!(matches!(visible(plain), Cow::Borrowed(text) if text == plain));
    }
}
