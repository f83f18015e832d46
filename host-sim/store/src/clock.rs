//! When something was stored: seconds since 1970, UTC.

use std::time::{SystemTime, UNIX_EPOCH};

/// Now. A clock that stands before 1970 gives 0.
pub(crate) fn now() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_secs()).unwrap_or(i64::MAX)
}

/// A time in words, `2026-11-27 18:35`, UTC; years 1970…9999.
pub(crate) fn utc(seconds: i64) -> String {
    let seconds = seconds.clamp(0, 253_402_300_799);
    let (days, minutes) = (seconds / 86_400, seconds / 60 % 1440);
    // Days of the calendar that begins on 1 March of the year 0, in eras of 400 years.
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (year, month) = (400 * era + year + i64::from(month >= 10), if month < 10 { month + 3 } else { month - 9 });
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}", minutes / 60, minutes % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_the_calendar() {
        let known = [
            (0, "1970-01-01 00:00"),
            (951_782_399, "2000-02-28 23:59"),
            (951_782_400, "2000-02-29 00:00"),
            (1_795_804_501, "2026-11-27 18:35"),
            (4_107_542_400, "2100-03-01 00:00"),
        ];
        for (seconds, text) in known {
            assert_eq!(utc(seconds), text);
        }
    }
}
