//! Texts that errors can point into, and the way from bytes to lines and columns.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use super::visible::{visible, visible_lines};

/// A text that errors can point into: its name as the user wrote it, and its bytes made readable.
///
/// Bytes that are not UTF-8 (comments of old controls) become `U+FFFD`, control characters become visible; a lone
/// carriage return counts as a line end.
#[derive(Clone, Debug)]
pub struct Source(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    name: String,
    bytes: Vec<u8>,
    /// Made when something points into it: a program of 100 MB that is sound needs none.
    text: OnceLock<String>,
}

impl Source {
    /// From bytes already at hand.
    pub fn new(name: impl Into<String>, bytes: Vec<u8>) -> Self {
        Self(Arc::new(Inner { name: name.into(), bytes, text: OnceLock::new() }))
    }

    /// The file's name as the user wrote it.
    pub fn name(&self) -> &str {
        &self.0.name
    }
    /// The bytes as they are on disk.
    pub fn bytes(&self) -> &[u8] {
        &self.0.bytes
    }
    /// The bytes of a span, made readable.
    pub fn excerpt(&self, span: Range<usize>) -> String {
        String::from_utf8_lossy(self.0.bytes.get(span).unwrap_or_default()).into_owned()
    }
    /// The byte span of `length` bytes at a line and a column (bytes), both counted from 1, limited to the text.
    pub fn span_at(&self, line: u32, column: u32, length: u32) -> Range<usize> {
        let lines = line_starts(&self.0.bytes);
        let start = lines.get(line.saturating_sub(1) as usize).copied().unwrap_or(self.0.bytes.len());
        let start = (start + column.saturating_sub(1) as usize).min(self.0.bytes.len());
        start..(start + length as usize).min(self.0.bytes.len())
    }
    /// The place of a whole line, counted from 1, without its end.
    pub fn line_span(&self, line: u32) -> Range<usize> {
        let start = self.span_at(line, 1, 0).start;
        let rest = self.bytes().get(start..).unwrap_or_default();
        let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
        start..start + length
    }
    /// Line and column (characters) of a byte of the file, both counted from 1.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let lines = line_starts(&self.0.bytes);
        let byte = byte.min(self.0.bytes.len());
        let line = lines.partition_point(|&start| start <= byte);
        let start = lines[line - 1];
        (line, readable(&self.0.bytes[start..byte]).chars().count() + 1)
    }
    /// The same span in the readable text.
    pub(super) fn readable_span(&self, span: &Range<usize>) -> Range<usize> {
        let at = |byte: usize| readable(&self.0.bytes[..byte.min(self.0.bytes.len())]).len();
        at(span.start)..at(span.end)
    }
}

fn readable(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    if !text.contains('\r') {
        return visible_lines(&text).into_owned();
    }
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    visible_lines(&text).into_owned()
}

/// Offsets of the first byte of every line; CR, LF and CRLF end a line.
fn line_starts(bytes: &[u8]) -> Vec<usize> {
    let mut starts = vec![0];
    for (i, &b) in bytes.iter().enumerate() {
        if b == b'\n' || (b == b'\r' && bytes.get(i + 1) != Some(&b'\n')) {
            starts.push(i + 1);
        }
    }
    starts
}

impl miette::SourceCode for Source {
    fn read_span<'a>(
        &'a self,
        span: &miette::SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn miette::SpanContents<'a> + 'a>, miette::MietteError> {
        let text = self.0.text.get_or_init(|| readable(&self.0.bytes));
        let contents = text.read_span(span, before, after)?;
        Ok(Box::new(miette::MietteSpanContents::new_named(
            visible(&self.0.name).into_owned(),
            contents.data(),
            *contents.span(),
            contents.line(),
            contents.column(),
            contents.line_count(),
        )))
    }
}
