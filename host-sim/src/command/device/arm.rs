//! `truepath device arm`: the confirmation of one pass of one part, as the controller gives it.
//!
//! Whoever calls this is the controller, or the program beside it that knows what runs: identity and frame are what the
//! machine is about to do, not what would fit. What is not given is taken from the image, so an operator at the bench
//! need not type it; a controller gives all of it, and the device compares.

use std::path::PathBuf;

use clap::Args;
use truepath_bench::{BenchError, Client, Line};
use truepath_core::image::Binding;
use truepath_core::link::Slot;
use truepath_core::rewrite::{ArmRequest, AxisMap, Frame, TURN_ONE};
use truepath_ground::diagnostics::Failure;

use crate::command::image;

#[derive(Debug, Args)]
pub(super) struct ArmOptions {
    /// Image whose identity is taken where none is given; without it that of the active image.
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Serial number of the part; each part has a higher one.
    #[arg(long, value_name = "NUMBER")]
    part: u32,
    /// CRC-32 of the program that runs, hexadecimal.
    #[arg(long, value_name = "HEX", value_parser = hexadecimal)]
    program_crc: Option<u32>,
    /// Number of the feature.
    #[arg(long, value_name = "NUMBER")]
    feature: Option<u32>,
    /// Number of the pass.
    #[arg(long, value_name = "NUMBER")]
    pass: Option<u32>,
    /// Tool in the spindle.
    #[arg(long, value_name = "NUMBER")]
    tool: Option<u32>,
    /// Tool offset in force.
    #[arg(long, value_name = "NUMBER")]
    tool_offset: Option<u32>,
    /// Number of the setup.
    #[arg(long, value_name = "NUMBER")]
    setup: Option<u32>,
    /// Machine coordinates of the program's origin, nm.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<i64>)]
    offset_nm: [i64; 3],
    /// Cosine of the turn of the program in the XY plane, counter-clockwise, units of 2⁻³⁰.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, default_value_t = TURN_ONE)]
    cosine: i32,
    /// Sine of that turn.
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, default_value_t = 0)]
    sine: i32,
    /// Which axes of a setpoint X, Y and Z are.
    #[arg(long, value_name = "X,Y,Z", default_value = "0,1,2", value_parser = numbers::<u8>)]
    axes: [u8; 3],
    /// Only ask what the answer would be.
    #[arg(long)]
    pub check: bool,
}

impl ArmOptions {
    /// The request to send.
    ///
    /// # Errors
    /// An image that cannot be read; no image at all; whatever the link answers.
    pub fn request(&self, client: &mut Client<Line>) -> Result<ArmRequest, Failure> {
        let image = match &self.image {
            Some(path) => image::check(&image::read(path)?, path)?.settings().binding,
            None => active(client)?,
        };
        let binding = Binding {
            program_crc: self.program_crc.unwrap_or(image.program_crc),
            feature: self.feature.unwrap_or(image.feature),
            pass: self.pass.unwrap_or(image.pass),
            tool: self.tool.unwrap_or(image.tool),
            tool_offset: self.tool_offset.unwrap_or(image.tool_offset),
            setup: self.setup.unwrap_or(image.setup),
        };
        let axes = self.axes.map(|axis| AxisMap { axis, reversed: false });
        let frame = Frame { offset_nm: self.offset_nm, cosine: self.cosine, sine: self.sine, axes, crc: 0 }.sealed();
        Ok(ArmRequest { binding, part_serial: self.part, frame })
    }
}

/// The identity of the active image.
fn active(client: &mut Client<Line>) -> Result<Binding, BenchError> {
    let binding =
        |slot: &Slot| if let Slot::Image { active: true, binding, .. } = slot { Some(*binding) } else { None };
    client.slots()?.iter().find_map(binding).ok_or_else(|| BenchError::Option {
        found: "the device has no active image, and no --image is named".to_owned(),
        help: "upload the image first: truepath device upload FILE --activate".to_owned(),
    })
}

fn hexadecimal(text: &str) -> Result<u32, String> {
    u32::from_str_radix(text, 16).map_err(|_| "up to eight hexadecimal digits, like 1a2b3c4d".to_owned())
}

fn numbers<T: std::str::FromStr>(text: &str) -> Result<[T; 3], String> {
    let numbers: Option<Vec<T>> = text.split(',').map(|t| t.trim().parse().ok()).collect();
    numbers.and_then(|n| n.try_into().ok()).ok_or_else(|| "three whole numbers, like 0,1,2".to_owned())
}
