//! Counts in sentences.

use core::fmt::Display;

/// A count with its noun, given in the singular: `1 pass`, `3 passes`, `0 places`.
pub fn counted(count: impl Display, noun: &str) -> String {
    let count = count.to_string();
    let ending = match (count.as_str(), noun.ends_with('s')) {
        ("1", _) => "",
        (_, true) => "es",
        (_, false) => "s",
    };
    format!("{count} {noun}{ending}")
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_is_singular_and_all_others_are_not() {
        let told = [counted(1, "pass"), counted(3_usize, "pass"), counted(0, "place"), counted(1_u64, "place")];
        assert_eq!(told, ["1 pass", "3 passes", "0 places", "1 place"]);
    }
}
