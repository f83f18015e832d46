//! All errors and warnings of the core.

use crate::gcode::compensation::CompensationError;
use crate::gcode::{
    CornerError, CycleError, ExpressionError, FlowError, GcodeErrorKind, KlartextError, ParameterError, SettingError,
    WarningKind,
};
use crate::image::{ImageError, SignatureError};
use crate::job::{Buffer, JobError};
use crate::link::{AccessError, LinkError};
use crate::probe::{ProbeErrorKind, Suspicion};
use crate::update::UpdateError;

pub use crate::units::errors::{Row, number};

/// The rows of every enum of errors.
pub const CATALOGUE: [&[Row]; 19] = [
    GcodeErrorKind::CATALOGUE,
    ParameterError::CATALOGUE,
    CompensationError::CATALOGUE,
    ExpressionError::CATALOGUE,
    FlowError::CATALOGUE,
    CycleError::CATALOGUE,
    CornerError::CATALOGUE,
    SettingError::CATALOGUE,
    KlartextError::CATALOGUE,
    WarningKind::CATALOGUE,
    ProbeErrorKind::CATALOGUE,
    Suspicion::CATALOGUE,
    ImageError::CATALOGUE,
    SignatureError::CATALOGUE,
    AccessError::CATALOGUE,
    UpdateError::CATALOGUE,
    LinkError::CATALOGUE,
    JobError::CATALOGUE,
    Buffer::CATALOGUE,
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Codes of mistakes that show in several forms: `,R` or `,C` without its lines, a wrong ball, another frame, a
    /// mirrored axis.
    const OF_SEVERAL_FORMS: [(&str, usize); 4] = [("G058", 2), ("M013", 3), ("M014", 2), ("M019", 2)];

    #[test]
    fn a_code_has_one_meaning() {
        let mut rows = BTreeMap::new();
        for row in CATALOGUE.into_iter().flatten() {
            *rows.entry(row.code).or_insert(0) += 1;
            let (letter, digits) = row.code.split_at(1);
            assert!(
                "GIJKMW".contains(letter) && digits.len() == 3 && digits.parse() == Ok(number(row.code)),
                "{row:?}"
            );
            assert!(!row.says.iter().any(|text| text.is_empty()), "{row:?}");
        }
        rows.retain(|_, times| *times > 1);
        assert_eq!(rows, BTreeMap::from(OF_SEVERAL_FORMS));
    }
}
