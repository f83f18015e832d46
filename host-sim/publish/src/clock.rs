//! Times as messages carry them.

use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

/// Now in UTC, `2026-11-27T18:35:01.25Z`.
pub(crate) fn now() -> String {
    // Years beyond 9999 alone cannot be written.
    OffsetDateTime::now_utc().truncate_to_millisecond().format(&Rfc3339).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_one_of_utc_in_milliseconds_at_most() {
        let now = now();
        let (date, time) = now.split_once('T').expect("a date and a time");
        assert!(date.len() == 10 && date.starts_with("20") && time.ends_with('Z') && time.len() <= 13, "{now}");
    }
}
