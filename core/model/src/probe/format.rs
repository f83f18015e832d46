//! Formats of measurement files, and what is said about them outside the file.
//!
//! Frame, unit and point belong to the format; only a file of columns leaves them to its [`Layout`].
//! `docs/probe-formats.md` shows an example of each.

use serde::{Deserialize, Serialize};

use truepath_units::Offset;

/// The unit of the numbers in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum LengthUnit {
    /// Millimetres.
    #[default]
    Millimetre,
    /// Inches.
    Inch,
}

impl LengthUnit {
    /// Its length.
    pub(super) const fn nm(self) -> i64 {
        match self {
            Self::Millimetre => 1_000_000,
            Self::Inch => 25_400_000,
        }
    }
}

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// LinuxCNC's `(PROBEOPEN file)`: nine numbers X Y Z A B C U V W, no header; work coordinates, ball centre, unit of
    /// the program.
    Linuxcnc,
    /// A point a line with the columns of a [`Layout`], or those a header names.
    Columns,
    /// `(LOG, …)` of a LinuxCNC verification program: `id,nx,ny,xn,yn,xs,ys,zs,hit`; work coordinates, ball centre.
    LinuxcncLog,
    /// Console log of grbl or grblHAL: `[PRB:x,y,z:1]`; machine coordinates, ball centre, unit by `$13`.
    Grbl,
    /// Inspection results of Autodesk posts: `G800` nominal, `G801` measured; work coordinates, unit of the program.
    Inspection,
    /// The same as DPRNT of Haas and Fanuc sends it, and X Y Z words alone, which are surface values.
    Dprnt,
}

/// The coordinates of a file of columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Frame {
    /// Those of the program.
    #[default]
    Work,
    /// Those of the machine; the work offset is taken off.
    Machine,
}

/// What the X and Y of a file of columns are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PointKind {
    /// The centre of the probe's ball.
    #[default]
    Tip,
    /// The point of the wall that was touched.
    Surface,
}

/// What stands between the columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Separator {
    /// Tabs where there are any, else semicolons, else commas unless they are decimal signs, else blanks.
    #[default]
    Auto,
    /// One comma.
    Comma,
    /// One semicolon.
    Semicolon,
    /// One tab.
    Tab,
    /// Blanks and tabs, any number of them.
    Blank,
}

/// What stands before the decimals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum DecimalSign {
    /// A point, or a comma where commas do not separate.
    #[default]
    Auto,
    /// A comma only.
    Comma,
    /// A point only.
    Point,
}

/// Places of the quantities in a line, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Columns {
    /// Columns of x, y and z.
    pub axes: [u8; 3],
    /// Columns of the x and y component of the normal, from the wall to the free side.
    pub normal: Option<[u8; 2]>,
    /// Column that says 1 for a touch and 0 for a miss.
    pub hit: Option<u8>,
}

impl Columns {
    /// x, y, z and nothing else.
    pub const XYZ: Self = Self { axes: [0, 1, 2], normal: None, hit: None };

    /// Columns a line must have.
    pub(super) fn least(&self) -> usize {
        let [nx, ny] = self.normal.unwrap_or([0, 0]);
        let last = self.axes.into_iter().chain([nx, ny, self.hit.unwrap_or(0)]).max().unwrap_or(0);
        usize::from(last).saturating_add(1)
    }
}

/// What a file of columns does not say itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Layout {
    /// The columns; `None` takes them from the header, or x, y and z from the first three.
    pub columns: Option<Columns>,
    /// What stands between them.
    pub separator: Separator,
    /// What stands before the decimals; not [`DecimalSign::Comma`] with [`Separator::Comma`].
    pub decimal: DecimalSign,
    /// Work or machine coordinates.
    pub frame: Frame,
    /// Ball centre or surface.
    pub point: PointKind,
    /// The unit.
    pub unit: LengthUnit,
}

/// What the caller wants of a measured part: which correction it was cut with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CutWith {
    /// None: what follows is added to no other correction. A file that names one is refused.
    #[default]
    Nothing,
    /// Any, or none.
    Anything,
    /// The one with this CRC-32 of its program, or this of its image. A file that names another one is refused.
    Correction([Option<u32>; 2]),
}

/// What is known about a file before it is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Given {
    /// Its format.
    pub format: Format,
    /// Layout of a file of columns.
    pub layout: Layout,
    /// Origin of the work coordinates in machine coordinates, for files in the latter that do not say it.
    pub work_offset: Option<[Offset; 3]>,
    /// Unit of the program that the part was cut with.
    pub program_unit: LengthUnit,
    /// CRC-32 of that program.
    pub program_crc: u32,
    /// Diameter of the probe's ball.
    pub ball_diameter: Offset,
    /// The correction that the part has to be cut with.
    pub cut_with: CutWith,
}

impl Given {
    /// Radius of the probe's ball.
    pub const fn ball_radius(&self) -> Offset {
        Offset::from_nm(self.ball_diameter.nm() / 2)
    }

    /// Whether a ball named in a file is another one: more than 5 % off, which no calibration is.
    pub(super) fn is_other_ball(&self, diameter: Offset) -> bool {
        (diameter - self.ball_diameter).abs().nm() > self.ball_diameter.nm() / 20
    }
}
