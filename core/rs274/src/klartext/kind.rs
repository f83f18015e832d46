//! What conversational blocks do.

use super::super::Units;

/// How an APPR or DEP block leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `LT`: along a line, tangent to the contour.
    Line,
    /// `LN`: along a line, at a right angle to it.
    Normal,
    /// `CT`: along an arc, tangent to it.
    Arc,
    /// `LCT`: along a line and an arc, tangent to both.
    LineArc,
}

/// What a block does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Statement {
    /// Nothing, or a comment.
    #[default]
    Empty,
    /// `BEGIN PGM NAME MM`, with its unit.
    Begin(Units),
    /// `END PGM NAME MM`.
    End,
    /// What changes nothing here: BLK FORM, TOOL DEF, FUNCTION MODE MILL, SEL TABLE, output by FN.
    Passed,
    /// `L`, or axis words alone.
    Line,
    /// `C`: an arc about the pole.
    Arc,
    /// `CR`: an arc by its radius.
    RadiusArc,
    /// `CT`: an arc tangent to what comes before it.
    TangentArc,
    /// `LP`: a line in polar coordinates.
    PolarLine,
    /// `CP`: an arc about the pole in polar coordinates, or a helix.
    PolarArc,
    /// `CTP`.
    PolarTangentArc,
    /// `CC`: the pole.
    Pole,
    /// `RND`.
    Rounding,
    /// `CHF`.
    Chamfer,
    /// `APPR`, and whether its place is polar.
    Approach(Form, bool),
    /// `DEP`, and whether its place is polar.
    Depart(Form, bool),
    /// `TOOL CALL`.
    ToolCall,
    /// `STOP`.
    Stop,
    /// M and F words alone.
    Functions,
    /// `CYCL DEF` of a number and part: 7.1 is (7, 1).
    Cycle(u16, u8),
    /// `CYCL CALL`, `CYCL CALL POS`.
    CycleCall,
    /// `LBL`.
    Label,
    /// `CALL LBL`.
    Call,
    /// `FN` of a number.
    Function(u8),
    /// `Q1 = …`, alone or behind a cycle.
    Assignment,
}

impl Statement {
    /// Whether it steers the program or sets a parameter.
    pub(in super::super) const fn is_control(self) -> bool {
        matches!(self, Self::Label | Self::Call | Self::Function(_) | Self::Assignment)
    }
    /// Whether it is a move of a contour.
    pub const fn is_path(self) -> bool {
        matches!(
            self,
            Self::Line
                | Self::Arc
                | Self::RadiusArc
                | Self::TangentArc
                | Self::PolarLine
                | Self::PolarArc
                | Self::PolarTangentArc
        )
    }
    /// Whether it cuts the corner between two others.
    pub const fn is_corner(self) -> bool {
        matches!(self, Self::Rounding | Self::Chamfer)
    }
}
