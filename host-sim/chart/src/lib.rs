//! Charts of lines (SVG, PNG): panels over each other with one axis along, curves thinned without losing a peak (M4), a
//! legend, a font of their own.
//!
//! They know nothing of milling; what is drawn belongs to the rooms that draw it. A picture stays below a megabyte
//! whatever the number of points.

pub mod axis;
pub mod chart;
pub mod codes;
pub mod curve;
pub mod legend;
pub mod letters;
pub mod page;
pub mod panel;
pub mod raster;
pub mod style;
pub mod thin;
pub mod view;
