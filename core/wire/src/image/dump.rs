//! An image as text, for people and for `diff`.

use core::fmt::{self, Write};

use super::{FACTOR_BITS, FORMAT, FineOffset, Image, RATIO_BITS, SEMANTICS, SIGNED_FORMAT, Signed};
use truepath_units::Real;

/// Writes an image as text: the head as `name = value` lines, then one line a node,
/// `index x y chip_x chip_y edge_x edge_y` in millimetres, program coordinates. `signed` is its signature, which is
/// named and not verified.
///
/// # Errors
/// Only those of `out`.
pub fn dump(image: &Image<'_>, signed: Option<&Signed<'_>>, out: &mut impl Write) -> fmt::Result {
    let s = image.settings();
    let b = &s.binding;
    writeln!(out, "format = {}", if signed.is_some() { SIGNED_FORMAT } else { FORMAT })?;
    writeln!(out, "semantics = {SEMANTICS}")?;
    writeln!(out, "crc = {:08x}", image.crc())?;
    if let Some(Signed { key, classes, counter, .. }) = signed {
        writeln!(out, "signature_key = {key}")?;
        writeln!(out, "signature_for = {classes}")?;
        writeln!(out, "signature_counter = {counter}")?;
    }
    writeln!(out, "program_crc = {:08x}", b.program_crc)?;
    writeln!(out, "feature = {}", b.feature)?;
    writeln!(out, "pass = {}", b.pass)?;
    writeln!(out, "tool = {}", b.tool)?;
    writeln!(out, "tool_offset = {}", b.tool_offset)?;
    writeln!(out, "setup = {}", b.setup)?;
    writeln!(out, "closed = {}", s.closed)?;
    writeln!(out, "feed_per_tooth_mm = {}", Millimetres::fine(s.feed.per_tooth))?;
    writeln!(out, "teeth = {}", s.feed.teeth)?;
    writeln!(out, "spindle_rpm = {}", Decimal { value: s.feed.spindle_millirpm.into(), digits: 3 })?;
    writeln!(out, "size_exponent = {}", Decimal::binary(s.feed.size_exponent.into(), RATIO_BITS, 4))?;
    writeln!(out, "feed_ratio_low = {}", Decimal::binary(s.feed.ratio_low.into(), RATIO_BITS, 4))?;
    writeln!(out, "feed_ratio_high = {}", Decimal::binary(s.feed.ratio_high.into(), RATIO_BITS, 4))?;
    out.write_str("chip_factor =")?;
    for entry in s.feed.factor {
        write!(out, " {}", Decimal::binary(entry.into(), FACTOR_BITS, 6))?;
    }
    writeln!(out)?;
    writeln!(out, "clamp_mm = {}", Millimetres(s.limits.clamp.nm()))?;
    writeln!(out, "warn_mm = {}", Millimetres(s.limits.warn.nm()))?;
    writeln!(out, "slew_mm_per_s = {}", Millimetres(s.limits.slew_nm_per_s.into()))?;
    let acceleration = i64::try_from(s.limits.acceleration_nm_per_s2).unwrap_or(i64::MAX);
    writeln!(out, "acceleration_mm_per_s2 = {}", Millimetres(acceleration))?;
    writeln!(out, "tolerance_mm = {}", Millimetres(s.window.tolerance.nm()))?;
    writeln!(out, "z_low_mm = {}", Millimetres(s.window.z_low.nm()))?;
    writeln!(out, "z_high_mm = {}", Millimetres(s.window.z_high.nm()))?;
    writeln!(out, "gate_height_mm = {}", Millimetres(s.window.gate_height.nm()))?;
    writeln!(out, "node_step_mm = {}", Millimetres(s.node_step.nm()))?;
    writeln!(out, "nodes = {}", image.len())?;
    let origin = image.header().origin;
    for (index, node) in image.nodes().enumerate() {
        let x = Millimetres(origin.x.nm().saturating_add(node.x.into()));
        let y = Millimetres(origin.y.nm().saturating_add(node.y.into()));
        let [cx, cy] = node.chip.map(Millimetres::fine);
        let [ex, ey] = node.edge.map(Millimetres::fine);
        writeln!(out, "{index} {x} {y} {cx} {cy} {ex} {ey}")?;
    }
    Ok(())
}

/// Nanometres printed as millimetres with six decimals.
struct Millimetres(i64);

impl Millimetres {
    fn fine(value: FineOffset) -> Self {
        Self(value.offset().nm())
    }
}

impl fmt::Display for Millimetres {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Decimal { value: self.0, digits: 6 }.fmt(f)
    }
}

/// A whole number with the point moved left by some digits.
struct Decimal {
    value: i64,
    digits: u32,
}

impl Decimal {
    /// A binary fraction, rounded to a number of decimals.
    fn binary(value: i64, bits: u32, digits: u32) -> Self {
        let scale = 10i32.saturating_pow(digits);
        let value =
            (Real::from_bits(value << Real::FRACTION_BITS.saturating_sub(bits)) * Real::from_int(scale)).round_to_int();
        Self { value, digits }
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scale = 10u64.saturating_pow(self.digits);
        let magnitude = self.value.unsigned_abs();
        let sign = if self.value < 0 { "-" } else { "" };
        let (whole, rest) = (magnitude.checked_div(scale).unwrap_or(0), magnitude.checked_rem(scale).unwrap_or(0));
        write!(f, "{sign}{whole}.{rest:0width$}", width = self.digits as usize)
    }
}
