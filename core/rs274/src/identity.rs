//! What a program is recognised by: its check sum, and the mark of a corrected program.

use super::lexical::is_blank;
use truepath_units::checksum::crc32;

/// The mark that a corrected program carries as a comment.
pub const CORRECTED_MARK: &str = "(TRUEPATH CORRECTED)";

/// CRC-32 (ISO-HDLC, as in zip and Ethernet) of the bytes of a program as they are, line ends included.
pub fn program_crc(program: &[u8]) -> u32 {
    crc32(program)
}

/// Whether a comment of the file begins with `TRUEPATH CORRECTED`, in any case, wherever it stands: a correction
/// must never be applied twice, so text outside `%` counts as well.
pub fn is_marked_corrected(program: &[u8]) -> bool {
    memchr::memchr2_iter(b'(', b';', program).any(|at| {
        let body = program.get(at.saturating_add(1)..).unwrap_or(&[]);
        let mut letters = body.iter().filter(|b| !is_blank(**b)).map(u8::to_ascii_uppercase);
        b"TRUEPATHCORRECTED".iter().all(|&expected| letters.next() == Some(expected))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_sum_is_the_one_of_zip() {
        assert_eq!(program_crc(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn the_mark_is_seen_in_any_case_and_place() {
        assert!(is_marked_corrected(CORRECTED_MARK.as_bytes()));
        assert!(is_marked_corrected(b"%\nG1 ( truepath  corrected from a.nc)\n%"));
        assert!(is_marked_corrected(b"; Truepath corrected\n%\n"));
        assert!(!is_marked_corrected(b"(TRUEPATH BEGIN pocket-1)\n(TRUEPATH\nCORRECTED)"));
    }
}
