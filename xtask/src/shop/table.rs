//! The table of the programs: what is known of each, and what became of it last time.

use std::fmt::Write;

/// Columns, in their order.
const COLUMNS: [&str; 12] = [
    "file",
    "manner",
    "dialect",
    "wall",
    "allowance_mm",
    "diameter_mm",
    "teeth",
    "helix_deg",
    "depth_mm",
    "keys",
    "wall_lines",
    "expected",
];

/// A program.
#[derive(Clone, Debug)]
pub struct Program {
    /// Its file.
    pub file: String,
    /// Whose manner it is written in.
    pub manner: String,
    /// `dialect` of its job.
    pub dialect: String,
    /// `wall` of its job; empty where G41 or G42 say it.
    pub wall: String,
    /// Stock on the wall.
    pub allowance_mm: f64,
    /// Diameter of the cutter, mm.
    pub diameter_mm: f64,
    /// Its teeth.
    pub teeth: u32,
    /// Its helix.
    pub helix_deg: f64,
    /// The engaged depth, mm.
    pub depth_mm: f64,
    /// Further keys of the job, `table.key = value`. One that begins with `!` is what Truepath has to find out: only the
    /// virtual machine is told it, and the job with the lines named.
    pub keys: Vec<String>,
    /// First and last line of every time a wall is made, leads not included; wall by wall, ` | ` between them.
    pub walls: Vec<Vec<[u32; 2]>>,
    /// The end it came to when the table was renewed.
    pub expected: String,
}

/// Reads the table.
///
/// # Errors
/// What is wrong, in words with the line.
pub fn read(text: &str) -> Result<Vec<Program>, String> {
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.starts_with('#') && !l.trim().is_empty());
    let head = lines.next().map(|(_, l)| l).unwrap_or_default();
    if head != COLUMNS.join(",") {
        return Err(format!("the first line is not {}", COLUMNS.join(",")));
    }
    lines.map(|(at, line)| program(line).map_err(|e| format!("line {}: {e}", at + 1))).collect()
}

fn program(line: &str) -> Result<Program, String> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let [file, manner, dialect, wall, allowance, diameter, teeth, helix, depth, keys, lines, expected] = fields[..]
    else {
        return Err(format!("{} fields instead of {}", fields.len(), COLUMNS.len()));
    };
    let number = |text: &str| text.parse::<f64>().map_err(|_| format!("{text} is no number"));
    let range = |text: &str| -> Result<[u32; 2], String> {
        let whole = |t: &str| t.parse().map_err(|_| format!("{text} are no lines"));
        let (first, last) = text.split_once('-').ok_or_else(|| format!("{text} are no lines"))?;
        Ok([whole(first)?, whole(last)?])
    };
    Ok(Program {
        file: file.to_owned(),
        manner: manner.to_owned(),
        dialect: dialect.to_owned(),
        wall: wall.to_owned(),
        allowance_mm: number(allowance)?,
        diameter_mm: number(diameter)?,
        teeth: number(teeth)? as u32,
        helix_deg: number(helix)?,
        depth_mm: number(depth)?,
        keys: keys.split(';').map(str::trim).filter(|k| !k.is_empty()).map(str::to_owned).collect(),
        walls: lines.split('|').map(|wall| wall.split_whitespace().map(range).collect()).collect::<Result<_, _>>()?,
        expected: expected.to_owned(),
    })
}

/// The table with other expectations where `end` knows one.
pub fn renewed(text: &str, end: impl Fn(&str) -> Option<String>) -> String {
    let mut out = String::new();
    for line in text.lines() {
        let known = line.split_once(',').and_then(|(file, _)| end(file.trim())).zip(line.rsplit_once(','));
        // Writing to a String cannot fail.
        let _ = match known {
            Some((end, (rest, _))) => writeln!(out, "{rest},{end}"),
            None => writeln!(out, "{line}"),
        };
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "# words\n\
        file,manner,dialect,wall,allowance_mm,diameter_mm,teeth,helix_deg,depth_mm,keys,wall_lines,expected\n\
        a.nc,hand; Haas,haas,,0.5,12,4,35,10,!tool.compensation = \"radius\",13-17 20-24,through\n\
        b.nc,hand,mach,left,0.3,6,2,30,4.5,,5-9,new\n";

    #[test]
    fn the_table_says_what_a_machinist_knows_and_where_the_wall_is() {
        let programs = read(TABLE).expect("a table");
        assert_eq!(programs[0].walls, [[[13, 17], [20, 24]]]);
        assert_eq!((programs[0].wall.as_str(), programs[0].keys.len(), programs[1].keys.len()), ("", 1, 0));
        assert_eq!(read(&TABLE.replace("5-9", "5")).expect_err("no lines"), "line 4: 5 are no lines");
        assert_eq!(read(&TABLE.replace(",new", "")).expect_err("a field less"), "line 4: 11 fields instead of 12");
    }

    #[test]
    fn only_the_expectations_that_are_known_are_renewed() {
        let renewed = renewed(TABLE, |file| (file == "b.nc").then(|| "probe V002".to_owned()));
        assert_eq!(renewed, TABLE.replace(",new", ",probe V002"));
    }
}
