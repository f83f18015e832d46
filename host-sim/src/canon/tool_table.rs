//! LinuxCNC's tool table: `T1 P1 X0 Z12.98 D3.175 ;comment`, one tool a line, lengths in the machine's unit.

use std::collections::BTreeMap;

use truepath_core::gcode::{Lines, Token, Units, Words};

use crate::diagnostics::{InputError, Source};

/// The tools by number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ToolTable {
    rows: BTreeMap<u32, Row>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Row {
    /// Counted from 1.
    number: u32,
    /// Nanometres.
    offset: [i64; 3],
}

impl ToolTable {
    /// Reads a table whose lengths are in `units`.
    ///
    /// # Errors
    /// `T001` for a line that is no row of a tool table.
    pub fn parse(source: &Source, units: Units) -> Result<Self, InputError> {
        let mut rows = BTreeMap::new();
        for line in Lines::new(source.bytes()) {
            let span = line.span();
            let refused = |found: &str| {
                let help = "write rows like T1 P1 X0 Z12.98 D3.175 ;comment";
                InputError::new("T001", found, "a row of a tool table", help).at(source, span.start..span.end())
            };
            let (mut tool, mut offset) = (None, [0; 3]);
            let mut any = false;
            for token in Words::new(line) {
                let Token::Word(word) = token.map_err(|_| refused("this line cannot be read"))? else { continue };
                let value = word.value.ok_or_else(|| refused("this row has an expression"))?;
                any = true;
                let nm =
                    || i64::try_from(value.times(units.nanometres())).map_err(|_| refused("this number is too large"));
                match word.letter {
                    b'T' => tool = value.exactly_times(1).and_then(|n| u32::try_from(n).ok()),
                    b'X' => offset[0] = nm()?,
                    b'Y' => offset[1] = nm()?,
                    b'Z' => offset[2] = nm()?,
                    // Pocket, diameter, angles and orientation do not move the tool's tip.
                    b'P' | b'D' | b'I' | b'J' | b'Q' => {}
                    _ => return Err(refused(&format!("{} is no column of a tool table", char::from(word.letter)))),
                }
            }
            if any {
                let number = rows.len() as u32 + 1;
                rows.insert(
                    tool.ok_or_else(|| refused("this row has no T with a whole number"))?,
                    Row { number, offset },
                );
            }
        }
        Ok(Self { rows })
    }

    /// The offset of a tool; none for one that is not in the table.
    pub fn offset(&self, tool: u32) -> Option<[i64; 3]> {
        self.rows.get(&tool).map(|row| row.offset)
    }
    /// The number by which the reference names a tool when it is changed: its row, or the tool's own without a table.
    pub(super) fn row(&self, tool: u32) -> u32 {
        self.rows.get(&tool).map_or(tool, |row| row.number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<ToolTable, InputError> {
        ToolTable::parse(&Source::new("tool.tbl", text.as_bytes().to_vec()), Units::Millimetres)
    }

    #[test]
    fn rows_are_read_in_any_order_and_remarks_skipped() {
        let table = table("; tools\nT7 P1 Z12.5 D6 ;end mill\n\nT1 P2 X-1 Y.5 Z0\n").expect("a table");
        assert_eq!(table.offset(7), Some([0, 0, 12_500_000]));
        assert_eq!(table.offset(1), Some([-1_000_000, 500_000, 0]));
        assert_eq!(table.offset(2), None);
    }

    #[test]
    fn a_row_without_a_tool_is_an_error_with_its_place() {
        let error = table("T1 Z1\nP2 Z3\n").expect_err("no tool");
        assert_eq!((error.code(), error.line_column()), ("T001", Some((2, 1))));
    }
}
