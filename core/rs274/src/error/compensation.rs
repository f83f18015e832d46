//! Why a path cannot be compensated.

use truepath_units::{Millimetres, Offset, errors};

errors! {
    /// What the cutter cannot do, or the program must not ask.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum CompensationError {
        /// The first move is not longer than the cutter's radius.
        EntryTooShort {
            /// Its length in the plane.
            length: Offset,
            /// The cutter's radius.
            radius: Offset,
        } = "G120",
            "the first move under G41/G42 is {length:.3} mm long in the plane and must be longer than the cutter's radius, {radius:.3} mm; start farther away, or name the dialect of the control (Fanuc, Haas and Siemens take it)",
                length = Millimetres(length), radius = Millimetres(radius);
        /// The arc from where the cutter stands to beside the end of the first arc is not larger than the cutter.
        EntryArcTooSmall {
            /// The radius of that arc.
            arc: Offset,
            /// The cutter's radius.
            radius: Offset,
        } = "G121",
            "the first move under G41/G42 would be an arc of {arc:.3} mm, which must be larger than the cutter's radius, {radius:.3} mm; enter along a line",
                arc = Millimetres(arc), radius = Millimetres(radius);
        /// The cutter does not fit inside an arc.
        ArcTooSmall {
            /// The radius of the arc.
            arc: Offset,
            /// The cutter's radius.
            radius: Offset,
        } = "G122",
            "an inside arc of {arc:.3} mm must be larger than the cutter's radius, {radius:.3} mm; read the program as the centre's path if it is (D holds wear), or take a smaller cutter",
                arc = Millimetres(arc), radius = Millimetres(radius);
        /// The paths beside the two moves of an inside corner never meet.
        CornerUnreachable {
            /// The cutter's radius.
            radius: Offset,
        } = "G123",
            "the inside corner before this move is too tight for a cutter radius of {radius:.3} mm; read the program as the centre's path if it is (D holds wear), or take a smaller cutter",
                radius = Millimetres(radius);
        /// Nothing is left of a move between its corners: the cutter would cut into the neighbouring walls.
        MoveUnreachable {
            /// The length of the move as programmed.
            length: Offset,
            /// The cutter's radius.
            radius: Offset,
        } = "G124",
            "the move before this one is {length:.3} mm long, too short between its corners for a cutter radius of {radius:.3} mm; it would be gouged: read the program as the centre's path if it is (D holds wear), or take a smaller cutter",
                length = Millimetres(length), radius = Millimetres(radius);
        /// An arc is met at an angle too large for a tangent joint, and too small for a corner.
        ArcDistorted {
            /// The radius of the arc.
            arc: Offset,
            /// The cutter's radius.
            radius: Offset,
        } = "G125",
            "an arc of {arc:.3} mm joins its neighbour neither tangentially nor at a corner, for a cutter radius of {radius:.3} mm; make the joint tangent",
                arc = Millimetres(arc), radius = Millimetres(radius);
        /// The first move after G40 is an arc.
        ExitArc = "G126", "the first move after G40 must be a line, not an arc; leave along a line";
        /// A code that must not stand between G41 or G42 and G40.
        Forbidden = "G127", "this code must not stand between G41/G42 and G40; turn compensation off before it";
        /// G41 or G42 in G19.
        Plane = "G128", "G41/G42 need the XY or the ZX plane; program G17 or G18 before it";
        /// G41 or G42 while it is on.
        AlreadyOn = "G129", "G41/G42 while compensation is on; program G40 before it";
        /// A move in the plane from or to a place that is not known.
        PlaceUnknown = "G130",
            "a move under G41/G42 begins or ends at a place that is not known; give both axes in G90 before it";
        /// More steps between two moves than can wait.
        TooMuchBetween {
            /// How many can.
            limit: usize,
        } = "G131",
            "more than {limit} steps (moves of the third axis, feeds, codes, comments) between two moves in the plane under G41/G42; write G40 before them";
        /// G41.1 or G42.1 without D.
        DiameterMissing = "G132", "G41.1 and G42.1 need D, the cutter's diameter; add it";
        /// A tool that is not in the tool table.
        ToolUnknown {
            /// Its number.
            number: u32,
        } = "G133", "tool {number} is not in the tool table; correct D, or add the tool with its diameter";
        /// A radius beyond 100 m.
        RadiusTooLarge = "G134", "a cutter radius beyond 100 m; correct D";
        /// A first move along an arc, where the control wants a line.
        EntryArc = "G135", "the first move under G41/G42 is an arc, at which this control stops; switch on along a line before it";
    }
}

impl core::error::Error for CompensationError {}
