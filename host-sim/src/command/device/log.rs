//! `truepath device log`: the log of changes, as a person and a program read it.

use std::fmt::Write;

use serde::Serialize;
use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;
use truepath_core::link::LogEntry;

/// The log, or what of it was asked for.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct Log {
    /// Oldest first.
    entries: Vec<Entry>,
    /// Numbers of entries that were asked for and are not there: overwritten, without room while the flash could not be
    /// written, or not written yet.
    missing: u32,
    /// Number of the next entry.
    next: u32,
}

#[derive(Debug, PartialEq, Eq, Serialize)]
struct Entry {
    number: u32,
    boots: u32,
    uptime_us: u64,
    /// UTC by the clock of the host that was there.
    host_time: Option<String>,
    /// Number of the key of who asked.
    by: Option<String>,
    /// Logins that failed since the entry before.
    refused: u16,
    what: String,
}

impl Log {
    /// Entries from a number on.
    pub fn of(entries: &[LogEntry], from: u32, next: u32) -> Self {
        let there = u32::try_from(entries.len()).unwrap_or(u32::MAX);
        let missing = next.saturating_sub(from.max(1)).saturating_sub(there);
        Self { entries: entries.iter().map(Entry::of).collect(), missing, next }
    }
    /// A line for each entry.
    pub fn words(&self) -> String {
        let mut text = String::new();
        for Entry { number, boots, uptime_us, host_time, by, refused, what } in &self.entries {
            let seconds = *uptime_us as f64 / 1e6;
            let (time, by) = (host_time.as_deref().unwrap_or("-"), by.as_deref().unwrap_or("-"));
            let wrong = if *refused > 0 { format!(", after {refused} failed logins") } else { String::new() };
            // Writing to a String cannot fail.
            let _ =
                writeln!(text, "{number:>5}  boot {boots:>4} +{seconds:>12.3} s  {time:<20}  {by:<16}  {what}{wrong}");
        }
        if self.missing > 0 {
            let _ =
                writeln!(text, "{} entries are not there: overwritten, or never written to the flash", self.missing);
        }
        text
    }
}

impl Entry {
    fn of(entry: &LogEntry) -> Self {
        let utc = |seconds: u32| OffsetDateTime::from_unix_timestamp(seconds.into()).ok()?.format(&Rfc3339).ok();
        Self {
            number: entry.sequence,
            boots: entry.boots,
            uptime_us: entry.uptime_us,
            host_time: entry.host_s.and_then(utc),
            by: entry.by.map(|key| key.to_string()),
            refused: entry.refused,
            what: entry.to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use truepath_core::image::KeyId;
    use truepath_core::link::Change;

    #[test]
    fn every_entry_is_a_line_and_missing_numbers_are_told() {
        let first = LogEntry {
            sequence: 7,
            boots: 3,
            uptime_us: 61_250_000,
            host_s: Some(1_700_000_000),
            by: None,
            change: Change::Activated,
            key: Some(KeyId([7; 8])),
            value: 0x89ab_cdef,
            refused: 0,
            counter: 12,
        };
        let second = LogEntry { sequence: 9, host_s: None, change: Change::Disarmed, key: None, refused: 2, ..first };
        let log = Log::of(&[first, second], 0, 11);
        assert_eq!(
            log.words(),
            "    7  boot    3 +      61.250 s  2023-11-14T22:13:20Z  -                 image 89abcdef activated, \
             signed by 0707070707070707, counter 12\n    \
             9  boot    3 +      61.250 s  -                     -                 disarmed, after 2 failed logins\n\
             8 entries are not there: overwritten, or never written to the flash\n"
        );
        assert_eq!(Log::of(&[second], 9, 10).missing, 0);
    }
}
