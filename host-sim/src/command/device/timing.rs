//! `truepath device timing`: how regularly setpoints arrive and how fast they are answered, in words.

use std::fmt::Write;

use truepath_core::link::{Spread, TIMING_BINS, TIMING_EDGES_NS, Timing};

/// Letters of the longest bar.
const BAR: usize = 40;

/// A table and a histogram of each.
pub fn words(timing: &Timing) -> String {
    let Timing { period_ns, arrivals, early, late, answers, taken, missed } = timing;
    let mut text =
        format!("{:<22}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "µs", "count", "mean", "deviation", "least", "greatest");
    text += &row("arrival less period", arrivals);
    text += &row("arrival to answer", answers);
    let period = f64::from(*period_ns) / 1e3;
    // Writing to a String cannot fail.
    let _ = writeln!(text, "\nsetpoints by how far off their period of {period:.3} µs they arrive");
    // The earliest first; of a bin of early ones the bounds change places.
    let early = (0..TIMING_BINS).rev().filter(|bin| early[*bin] > 0).map(|bin| (bounds(bin, "early"), early[bin]));
    let late = (0..TIMING_BINS).filter(|bin| late[*bin] > 0).map(|bin| (bounds(bin, "late"), late[bin]));
    text += &histogram(&early.chain(late).collect::<Vec<_>>());
    let _ = writeln!(text, "\nsetpoints by the time to their answer");
    let taken = (0..TIMING_BINS).filter(|bin| taken[*bin] > 0).map(|bin| (bounds(bin, ""), taken[bin]));
    text += &histogram(&taken.collect::<Vec<_>>());
    if *missed > 0 {
        let _ =
            writeln!(text, "\n{missed} setpoints are in none of this: the device was busy with its configuration link");
    }
    text
}

fn row(name: &str, spread: &Spread) -> String {
    let Spread { count, mean_ns, deviation_ns, least_ns, greatest_ns } = *spread;
    let [mean, least, greatest] = [mean_ns, least_ns, greatest_ns].map(|ns| f64::from(ns) / 1e3);
    let deviation = f64::from(deviation_ns) / 1e3;
    format!("{name:<22}{count:>12}{mean:>12.3}{deviation:>12.3}{least:>12.3}{greatest:>12.3}\n")
}

/// The bounds of a bin, µs.
fn bounds(bin: usize, side: &str) -> String {
    let us = |edge: Option<&u32>| edge.map(|ns| ns / 1_000);
    let (from, to) = (bin.checked_sub(1).and_then(|k| us(TIMING_EDGES_NS.get(k))), us(TIMING_EDGES_NS.get(bin)));
    let range = match (from, to) {
        (None, Some(to)) => format!("below {to}"),
        (Some(from), Some(to)) => format!("{from} to {to}"),
        (Some(from), None) => format!("{from} and more"),
        (None, None) => String::new(),
    };
    format!("{range:>13} µs {side}")
}

/// A line for each bin that has something in it. The bar has one letter at least, so that a single one is seen.
fn histogram(bins: &[(String, u32)]) -> String {
    let most = bins.iter().map(|(_, count)| *count).max().unwrap_or(0);
    let all: u64 = bins.iter().map(|(_, count)| u64::from(*count)).sum();
    if all == 0 {
        return "    none yet\n".to_owned();
    }
    let line = |(bounds, count): &(String, u32)| {
        let bar = "#".repeat((*count as usize * BAR).div_ceil(most as usize));
        let share = f64::from(*count) / all as f64 * 100.0;
        format!("{bounds:<22}{count:>12}{share:>9.3} %  {bar}\n")
    };
    bins.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_and_histograms_have_every_value_and_no_empty_bin() {
        let arrivals =
            Spread { count: 1_003, mean_ns: -250, deviation_ns: 12_345, least_ns: -21_000, greatest_ns: 1_500_000 };
        let answers = Spread { count: 1_004, mean_ns: 8_100, deviation_ns: 90, least_ns: 7_900, greatest_ns: 9_000 };
        let mut timing = Timing { period_ns: 1_000_000, arrivals, answers, missed: 17, ..Timing::default() };
        (timing.early[5], timing.early[0]) = (2, 200);
        (timing.late[0], timing.late[10]) = (800, 1);
        timing.taken[3] = 1_004;
        assert_eq!(
            words(&timing),
            "µs                           count        mean   deviation       least    greatest\n\
             arrival less period           1003      -0.250      12.345     -21.000    1500.000\n\
             arrival to answer             1004       8.100       0.090       7.900       9.000\n\
             \n\
             setpoints by how far off their period of 1000.000 µs they arrive\n     \
             20 to 50 µs early           2    0.199 %  #\n      \
             below 1 µs early         200   19.940 %  ##########\n      \
             below 1 µs late          800   79.761 %  ########################################\n\
             1000 and more µs late            1    0.100 %  #\n\
             \n\
             setpoints by the time to their answer\n      \
             5 to 10 µs              1004  100.000 %  ########################################\n\
             \n\
             17 setpoints are in none of this: the device was busy with its configuration link\n"
        );
        assert!(words(&Timing::default()).contains("none yet"), "a device that has heard nothing");
    }
}
