//! Names of parameters: `#<tool length>` and `#<ToolLength>` are one.

use super::super::ExpressionError;
use super::super::lexical::is_blank;

/// Bytes of a name, blanks left out; a longer one is an error.
const BYTES: usize = 96;

/// A name in lower case without blanks.
pub(in super::super) type Name = heapless::Vec<u8, BYTES>;

/// The name that `<` opens at the start of a text, and the length of the text up to and with `>`.
///
/// # Errors
/// No `>` before the line or a comment (`;`) ends it, or a name too long.
pub(in super::super) fn name(text: &[u8]) -> Result<(Name, usize), ExpressionError> {
    let end = text.iter().position(|&b| b == b'>').ok_or(ExpressionError::NameNotClosed)?;
    let inside = text.get(1..end).unwrap_or(&[]);
    let mut name = Name::new();
    for byte in inside.iter().filter(|b| !is_blank(**b)) {
        if *byte == b';' {
            return Err(ExpressionError::NameNotClosed);
        }
        let limit = BYTES as u8;
        name.push(byte.to_ascii_lowercase()).map_err(|_| ExpressionError::NameTooLong { limit })?;
    }
    if name.is_empty() { Err(ExpressionError::NameEmpty) } else { Ok((name, end.saturating_add(1))) }
}
