//! What a G code means for the place of the axes: a table, not an interpreter.
//!
//! Three kinds matter. Codes of the modal groups of RS274/NGC (NIST 6556, table 4) that say how axis words are meant;
//! codes that give the same words another meaning (tool centre point control, tilted planes, scaling …), under which
//! a move is not checked; and everything else, which does not move an axis and is passed on. A code that is in none of
//! them is [`Meaning::Unknown`]: the axes of its block are taken as unknown afterwards.

use truepath_core::gcode::{Dialect, FeedMode, Units};

/// How axis words move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motion {
    /// G80, and before any.
    #[default]
    None,
    /// G0.
    Traverse,
    /// G1.
    Feed,
    /// G2, G3.
    Arc,
    /// A spline, a canned cycle, tapping or threading; the code in tenths.
    Other(u16),
    /// Probing, which stops where it touches.
    Probe,
}

/// What gives XYZ another meaning until it is cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transform {
    /// G16 … G15.
    Polar,
    /// G51 … G50.
    Scaling,
    /// G51.1 … G50.1.
    Mirror,
    /// G68, G68.2 … G69; G268 … G269.
    Rotation,
    /// G12.1, G112 … G13.1, G113.
    PolarInterpolation,
    /// G7.1, G107: cancelled only by the end of the program as read here.
    Cylinder,
    /// M430: kinematics of the user's own.
    Kinematics,
    /// G54.2, G54.4, G254 … G255: offsets that turn with the table.
    TurningOffset,
}

/// Number of [`Transform`]s.
pub const TRANSFORMS: usize = 8;

/// What a code does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Axis words move so from here on.
    Motion(Motion),
    /// G20, G21, G70, G71.
    Units(Units),
    /// G90 (true), G91.
    Absolute(bool),
    /// G93, G94, G95.
    FeedMode(FeedMode),
    /// G41, G42 and the spatial ones (true), G40.
    Compensation(bool),
    /// G43, G44, G49 and theirs: Z is counted anew.
    ToolLength,
    /// G43.4, G43.5, G234: the control keeps the tool's tip.
    CentrePoint,
    /// G54 …, G54.1, G154.
    WorkOffset,
    /// G10.
    Table,
    /// G52.
    Local,
    /// G92.
    Name,
    /// G92.1, G92.2 (true); G92.3.
    NameOff(bool),
    /// G28, G30, G53, G53.1: the axes named end where no word says.
    Elsewhere,
    /// G4: its X is a time.
    Dwell,
    /// A transform begins (true) or ends.
    Transform(Transform, bool),
    /// G65, G66: a macro.
    Macro,
    /// G9: holds for its block, and belongs to its end.
    ExactStop,
    /// Does not matter here.
    Harmless,
    /// Not known here.
    Unknown,
}

/// The meaning of a G code, in tenths.
pub const fn meaning(tenths: u16, dialect: Dialect) -> Meaning {
    use Meaning as M;
    let splines = matches!(dialect, Dialect::Linuxcnc | Dialect::Mach);
    match tenths {
        0 => M::Motion(Motion::Traverse),
        10 => M::Motion(Motion::Feed),
        20 | 30 => M::Motion(Motion::Arc),
        800 => M::Motion(Motion::None),
        50..=53 if splines => M::Motion(Motion::Other(tenths)),
        330..=332 | 730 | 740 | 760 | 810 | 820 | 830 | 840 | 850 | 860 | 870 | 880 | 890 => {
            M::Motion(Motion::Other(tenths))
        }
        382..=385 | 310 => M::Motion(Motion::Probe),
        40 => M::Dwell,
        90 => M::ExactStop,
        100 => M::Table,
        160 => M::Transform(Transform::Polar, true),
        150 => M::Transform(Transform::Polar, false),
        510 => M::Transform(Transform::Scaling, true),
        500 => M::Transform(Transform::Scaling, false),
        511 => M::Transform(Transform::Mirror, true),
        501 => M::Transform(Transform::Mirror, false),
        680..=685 => M::Transform(Transform::Rotation, true),
        690 => M::Transform(Transform::Rotation, false),
        121 | 1120 => M::Transform(Transform::PolarInterpolation, true),
        131 | 1130 => M::Transform(Transform::PolarInterpolation, false),
        71 | 1070 => M::Transform(Transform::Cylinder, true),
        // Offsets that turn with the table: G54.2 and G54.4 of Fanuc, G254 and G268 of Haas.
        542 | 544 | 2540 => M::Transform(Transform::TurningOffset, true),
        2550 => M::Transform(Transform::TurningOffset, false),
        2680 => M::Transform(Transform::Rotation, true),
        2690 => M::Transform(Transform::Rotation, false),
        200 => M::Units(Units::Inches),
        210 => M::Units(Units::Millimetres),
        700 if dialect.has_metric_g71() => M::Units(Units::Inches),
        710 if dialect.has_metric_g71() => M::Units(Units::Millimetres),
        280 | 300 | 530 | 531 => M::Elsewhere,
        400 => M::Compensation(false),
        410..=429 => M::Compensation(true),
        430..=433 | 440 | 490 => M::ToolLength,
        434 | 435 | 2340 => M::CentrePoint,
        520 => M::Local,
        540 | 541 | 550 | 560 | 570 | 580 | 590..=593 | 1540 => M::WorkOffset,
        650 | 660 | 661 => M::Macro,
        900 => M::Absolute(true),
        910 => M::Absolute(false),
        920 => M::Name,
        921 | 922 => M::NameOff(true),
        923 => M::NameOff(false),
        930 => M::FeedMode(FeedMode::InverseTime),
        940 => M::FeedMode(FeedMode::PerMinute),
        950 => M::FeedMode(FeedMode::PerRevolution),
        50..=54 if !splines => M::Harmless,
        170 | 180 | 190 | 70 | 80 | 281 | 301 | 610 | 611 | 612 | 620 | 630 | 640 | 670 | 901 | 911 | 960 | 970
        | 980 | 990 | 1870 => M::Harmless,
        _ => M::Unknown,
    }
}
