//! Force coefficients and runout of a cutter from records of a dynamometer, or of the power of the spindle.
//!
//! Y. Altintas, Manufacturing Automation (2nd ed., 2012), ch. 2: mean forces over whole revolutions, and the force over the
//! angle of rotation. From below: [`cut`] one cut and its integrals; [`law`] how force grows with the chip; [`squares`]
//! least squares; [`fit`] coefficients from means; [`record`] files of records; [`revolution`] means and harmonics of them;
//! [`shape`] runout from the shape of a revolution;
//! [`description`] what was cut; [`assignment`] axes, signs and units; [`analysis`] all of it in turn; [`written`] and [`page`] what is
//! written.

pub mod analysis;
pub mod assignment;
pub mod codes;
pub mod cut;
pub mod description;
pub mod fit;
pub mod law;
pub mod page;
pub mod record;
pub mod revolution;
pub mod shape;
pub mod squares;
pub mod written;
