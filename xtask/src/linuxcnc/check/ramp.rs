//! The way of a correction to zero after an event.

use super::super::recording::{JOINTS, Row};

/// Periods within which every ramp is over (docs/safety.md has 121 for a clamp of 0.5 mm), with those in which the
/// controller has not yet acted on what it was told: its task runs beside the servo thread.
const LONGEST: usize = 1000;
/// Fault, or Active on the way out.
const RAMP: [u32; 2] = [3, 5];

/// Checks that the correction goes to zero, no axis through it or up again once the ramp has begun, and stays there.
///
/// # Errors
/// What is wrong, with the period.
pub fn to_zero(rows: &[Row]) -> Result<(), String> {
    let begin = rows.iter().position(|row| row.reason != rows[0].reason || row.state == RAMP[1]);
    let ramp = &rows[begin.unwrap_or(0)..];
    let Some(over) = ramp.iter().position(|row| row.correction == [0; JOINTS]) else {
        return Err("the correction never came to zero".to_owned());
    };
    if begin.unwrap_or(0) + over > LONGEST {
        return Err(format!("the correction was out only after {} periods", begin.unwrap_or(0) + over));
    }
    if let Some(row) = ramp[over..].iter().find(|row| row.correction != [0; JOINTS]) {
        return Err(format!("it was {:?} nm again in period {}", row.correction, row.sequence));
    }
    if let Some(row) = ramp[..over].iter().find(|row| !RAMP.contains(&row.state)) {
        return Err(format!("state {} on the ramp in period {}", row.state, row.sequence));
    }
    for axis in 0..JOINTS {
        let start = ramp.first().map_or(0, |row| row.correction[axis]);
        // It may still have been rising, and brakes first.
        let most = start.abs() + start.abs() / 20 + 2_000;
        let wrong = ramp.iter().find(|row| row.correction[axis].abs() > most || row.correction[axis] * start < 0);
        if let Some(row) = wrong {
            let now = row.correction[axis];
            return Err(format!("axis {axis} went from {start} to {now} nm in period {}", row.sequence));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(corrections: &[i64]) -> Vec<Row> {
        let first = Row { state: 3, correction: [corrections[0], 0, 0], ..Row::default() };
        let ramp = corrections.iter().map(|&c| Row { state: 5, reason: 17, correction: [c, 0, 0], ..Row::default() });
        std::iter::once(first).chain(ramp).collect()
    }

    #[test]
    fn only_a_ramp_to_zero_that_stays_there_passes() {
        assert_eq!(to_zero(&rows(&[50_000, 30_000, 10_000, 0, 0])), Ok(()));
        for wrong in [&[50_000, 30_000, 10_000][..], &[50_000, 0, 7, 0], &[50_000, 90_000, 0], &[50_000, -4, 0]] {
            assert!(to_zero(&rows(wrong)).is_err(), "{wrong:?}");
        }
    }
}
