//! Route B: what has to come of each scenario in which the link to the board fails.

use super::super::recording::Row;
use super::case::Case;

const BYPASS: u32 = 1;
const COMPLETED: u32 = 1;
/// Periods over which the last correction is held before the link is lost.
const HELD: usize = 2;
/// Refusal of truepath-config: the board refuses.
const REFUSED_BY_BOARD: f64 = 110.0;
/// Less than this is no correction that a test could see, nm.
const VISIBLE: i64 = 10_000;

/// The whole contour through the board.
pub fn milled(case: &Case) {
    case.expect(Case::largest(case.rows) > VISIBLE, "there was no correction to speak of");
    let end = case.rows.last().map(|row| (row.state, row.reason));
    case.expect(end == Some((BYPASS, COMPLETED)), format!("it ended as {end:?}, not completed"));
    case.expect(case.rows.iter().all(|row| !row.link_lost), "the link was lost");
}

/// In the contour the link is lost: held for two periods, then the drives go, and nothing is corrected any more.
pub fn lost(case: &Case) {
    let after = case.between("event", "");
    match broken(after) {
        Err(wrong) => case.expect(false, wrong),
        Ok(first) => {
            let later = &after[first..];
            let off = later.iter().position(|row| !row.drives_on).unwrap_or(later.len());
            case.expect(off < later.len(), "the drives were not switched off");
            // Drives that are off are told one period later at most.
            case.untouched(later.get(off + 1..).unwrap_or_default(), "with the drives off, and after it");
        }
    }
    case.moved(case.between("on", "again"), "after it");
    // The board tells why in words.
    let refused = case.notes.number("refusal") == Some(REFUSED_BY_BOARD);
    let repeated = case.notes.said.iter().any(|said| said.contains("armed for this pass before"));
    case.expect(refused && repeated, "the same part was not refused");
}

/// A board that is reset says so in its first answer: nothing needs to be held before.
pub fn reset(case: &Case) {
    lost(case);
    case.expect(case.notes.number("truepath.link-cause").is_some_and(|cause| cause >= 2.0), "the cause is not told");
}

/// The first period of the lost link, with the correction that stands and the drives that are disabled from there on.
fn broken(rows: &[Row]) -> Result<usize, String> {
    let first = rows.iter().position(|row| row.link_lost).ok_or("the link was not lost")?;
    let held = rows[first].correction;
    if held == [0; 3] {
        return Err("there was no correction to be held".to_owned());
    }
    let frozen = rows[..first].iter().rev().take_while(|row| row.correction == held).count();
    let silent = rows[..first].iter().rev().zip(rows[..=first].iter().rev());
    let missed = silent.take_while(|(before, row)| row.link_misses > before.link_misses).count();
    if missed > HELD + 1 || frozen < missed.saturating_sub(1) {
        return Err(format!("{missed} periods without an answer, the correction stood for {frozen}"));
    }
    let on = rows[first..].iter().take_while(|row| row.drives_on);
    for row in on {
        if row.correction != held || row.drive_enabled {
            return Err(format!(
                "period {}: correction {:?}, drives enabled {}",
                row.sequence, row.correction, row.drive_enabled
            ));
        }
    }
    Ok(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(misses: u32, nm: i64, lost: bool, drives: bool) -> Row {
        let drive_enabled = !lost && drives;
        Row {
            correction: [nm, 0, 0],
            link_misses: misses,
            link_lost: lost,
            drives_on: drives,
            drive_enabled,
            ..Row::default()
        }
    }

    #[test]
    fn a_correction_that_is_held_until_the_drives_are_off_is_as_it_should_be() {
        let rows = [row(0, 5, false, true), row(0, 7, false, true), row(1, 7, false, true), row(2, 7, false, true)];
        let lost = [row(3, 7, true, true), row(4, 7, true, true), row(5, 0, true, false)];
        assert_eq!(broken(&[&rows[..], &lost].concat()), Ok(4));
        assert!(broken(&rows).is_err());
        assert!(broken(&[&rows[..], &[row(3, 6, true, true)]].concat()).is_err());
        assert!(broken(&[&rows[..], &[row(3, 7, true, true), row(4, 0, true, true)]].concat()).is_err());
        assert!(broken(&[&rows[..3], &[row(2, 8, false, true)], &lost[..]].concat()).is_err());
    }
}
