//! From instructions to a rate: what share of a Cortex-M7 at 480 MHz the setpoint path takes.
//!
//! The emulator counts instructions, not cycles. The M7 issues up to two instructions a cycle and waits for branches,
//! loads and flash; [`CYCLES_PER_INSTRUCTION`] is an assumption, on the safe side of what is published for integer code
//! that runs from tightly coupled memory or cache, and has to be measured on a board.

use std::collections::BTreeMap;

use crate::table::thousands;

/// Assumed.
const CYCLES_PER_INSTRUCTION: f64 = 1.5;
/// Clock of the STM32H743.
const CLOCK_HZ: f64 = 480e6;
/// Share of the processor that the setpoint path may take.
const SHARE: f64 = 0.25;
/// The rates that are wanted.
const GOALS: [(u32, f64); 2] = [(3, 20e3), (6, 10e3)];

/// Head of the table.
pub const HEAD: [&str; 5] = [
    "axes",
    "instructions of an exchange on SPI",
    "time, µs",
    "share at the rate wanted",
    "rate at a share of 25 %, Hz",
];

/// A row for each goal.
pub fn rows(worst: &BTreeMap<String, u32>) -> Vec<Vec<String>> {
    let row = |(axes, goal): (u32, f64)| {
        let most = worst.get(&format!("{axes}-axes-10000-nodes.spi")).copied()?;
        let seconds = f64::from(most) * CYCLES_PER_INSTRUCTION / CLOCK_HZ;
        Some(vec![
            axes.to_string(),
            thousands(most.into()),
            format!("{:.1}", seconds * 1e6),
            format!("{:.0} % at {:.0} kHz", seconds * goal * 100.0, goal / 1e3),
            thousands((SHARE / seconds / 100.0).round() as u64 * 100),
        ])
    };
    GOALS.into_iter().filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_the_processor_is_the_rate_whose_exchanges_take_a_quarter_of_the_time() {
        // 3,200 instructions, 1.5 cycles each: 10 µs at 480 MHz, so 25 kHz at a quarter.
        let rows = rows(&BTreeMap::from([("3-axes-10000-nodes.spi".to_owned(), 3_200)]));
        assert_eq!(rows, [["3", "3,200", "10.0", "20 % at 20 kHz", "25,000"].map(str::to_owned).to_vec()]);
    }
}
