//! LinuxCNC's tool table: `T1 P1 X0 Z12.98 D3.175 ;comment`, one tool a line, lengths in the machine's unit.
//!
//! Columns: T tool, P pocket, X Y Z U V W offsets, A B C offsets in degrees, D diameter, I J Q the shape of a lathe
//! tool. Only T is needed.
//!
//! Limits: 1,000 tools, as many as LinuxCNC's changer has pockets; a number once.

use std::collections::BTreeMap;

use truepath_core::gcode::{AXIS_LETTERS, Decimal, Lines, NineAxes, Token, Tool, Units, Words};
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::T001;

/// Rows of a table.
const LIMIT: usize = 1_000;

/// The tools, in the order of their rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ToolTable {
    tools: Vec<Tool>,
    rows: BTreeMap<u32, u32>,
}

impl ToolTable {
    /// Reads a table whose lengths are in `units`.
    ///
    /// # Errors
    /// `T001` for a line that is no row of a tool table.
    pub fn parse(source: &Source, units: Units) -> Result<Self, InputError> {
        let mut table = Self::default();
        for line in Lines::new(source.bytes()) {
            let span = line.span();
            let refused = |found: &str| T001.error(found, "a row of a tool table").at(source, span.start..span.end());
            let mut row = Row::default();
            for token in Words::new(line) {
                let Token::Word(word) = token.map_err(|_| refused("this line cannot be read"))? else { continue };
                let value = word.value.ok_or_else(|| refused("this row has an expression"))?;
                row.take(word.letter, value, units).map_err(|found| refused(&found))?;
            }
            if row.any {
                let number = row.tool.ok_or_else(|| refused("this row has no T with a whole number"))?;
                if table.tools.len() == LIMIT {
                    return Err(refused(&format!("this table has more than {LIMIT} tools")));
                }
                if table.rows.insert(number, table.tools.len() as u32 + 1).is_some() {
                    return Err(refused(&format!("T{number} is in the table twice")));
                }
                table.tools.push(Tool { number, pocket: row.pocket, diameter: row.diameter, offset: row.offset });
            }
        }
        Ok(table)
    }

    /// The tools.
    pub fn tools(&self) -> &[Tool] {
        &self.tools
    }
    /// The number by which the reference names a tool when it is changed: its row, or the tool's own without a table.
    pub(super) fn row(&self, tool: u32) -> u32 {
        self.rows.get(&tool).copied().unwrap_or(tool)
    }
}

/// A row while it is read.
#[derive(Default)]
struct Row {
    any: bool,
    tool: Option<u32>,
    pocket: u32,
    diameter: Offset,
    offset: NineAxes,
}

impl Row {
    fn take(&mut self, letter: u8, value: Decimal, units: Units) -> Result<(), String> {
        self.any = true;
        let scaled = |unit: i64| {
            let too_large = |_| format!("the number behind {} is too large", char::from(letter));
            i64::try_from(value.times(unit)).map_err(too_large)
        };
        let whole = || value.exactly_times(1).and_then(|n| u32::try_from(n).ok());
        match letter {
            b'T' => self.tool = whole(),
            b'P' => self.pocket = whole().unwrap_or(0),
            b'D' => self.diameter = Offset::from_nm(scaled(units.nanometres())?),
            b'I' | b'J' | b'Q' => {}
            _ => {
                let Some(axis) = AXIS_LETTERS.iter().position(|l| *l == letter) else {
                    return Err(format!("{} is no column of a tool table", char::from(letter)));
                };
                let turns = (3..6).contains(&axis);
                self.offset[axis] = scaled(if turns { Units::Millimetres } else { units }.nanometres())?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<ToolTable, InputError> {
        ToolTable::parse(&Source::new("tool.tbl", text.as_bytes().to_vec()), Units::Inches)
    }

    #[test]
    fn rows_are_read_in_any_order_and_remarks_skipped() {
        let table = table("; tools\nT7 P1 Z1.25 D.5 ;end mill\n\nD1 T1 P2 X-1 A2.5 W1\n").expect("a table");
        let [first, second] = table.tools() else { panic!("two tools") };
        assert_eq!((first.number, first.offset[2], first.diameter.nm()), (7, 31_750_000, 12_700_000));
        assert_eq!(second.offset, [-25_400_000, 0, 0, 2_500_000, 0, 0, 0, 0, 25_400_000]);
        assert_eq!((table.row(7), table.row(1), table.row(3)), (1, 2, 3));
    }

    #[test]
    fn a_row_that_is_none_is_an_error_with_its_place() {
        for (text, line) in [("T1 Z1\nP2 Z3\n", 2), ("T1.5 Z1", 1), ("T1 Z1\nT1 Z2", 2), ("\nT1 F3", 2)] {
            let error = table(text).expect_err(text);
            assert_eq!((error.code(), error.line_column()), ("T001", Some((line, 1))), "{text}");
        }
    }
}
