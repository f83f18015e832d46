//! Numbers and times as people read them.

use std::time::Duration;

/// Nanometres as micrometres with sign and one decimal.
pub fn micrometres(nm: i32) -> String {
    format!("{:+.1}", f64::from(nm) / 1000.0)
}

/// A number with its thousands apart.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A time with the two units that matter.
pub fn time(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..10 => format!("{:.1} s", time.as_secs_f64()),
        10..120 => format!("{seconds} s"),
        120..7_200 => format!("{} min {:02} s", seconds / 60, seconds % 60),
        7_200..172_800 => format!("{} h {:02} min", seconds / 3_600, seconds / 60 % 60),
        _ => format!("{} d {:02} h", seconds / 86_400, seconds / 3_600 % 24),
    }
}

/// A rate: exact when low, short when high.
pub fn rate(per_s: f64) -> String {
    match per_s {
        r if r < 0.05 => "0".to_owned(),
        r if r < 10.0 => format!("{r:.1}"),
        r => grouped(r.round() as u64),
    }
}

/// A text in lines of a width, broken between words; a longer word is cut.
pub fn wrapped(text: &str, width: u16) -> Vec<String> {
    let width = usize::from(width.max(1));
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.chars().take(width).collect()),
        }
    }
    lines
}

/// A time of microseconds or milliseconds.
pub fn short_time(us: f64) -> String {
    if us < 1_000.0 { format!("{us:.0} us") } else { format!("{:.1} ms", us / 1_000.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_times_are_short_and_exact_enough() {
        assert_eq!([0, 999, 1_000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
        assert_eq!([-123_456, 0, 49].map(micrometres), ["-123.5", "+0.0", "+0.0"]);
        let times = [0.04, 9.94, 59.9, 130.0, 7_260.0, 200_000.0].map(Duration::from_secs_f64).map(time);
        assert_eq!(times, ["0.0 s", "9.9 s", "59 s", "2 min 10 s", "2 h 01 min", "2 d 07 h"]);
        assert_eq!([0.0, 2.54, 999.6, 12_345.0].map(rate), ["0", "2.5", "1,000", "12,345"]);
        assert_eq!(wrapped("a bcd  ef ghijklm", 5), ["a bcd", "ef", "ghijk"]);
        assert_eq!([13.4, 2_540.0].map(short_time), ["13 us", "2.5 ms"]);
    }
}
