//! Force tables, each made once.
//!
//! The machines beside an identified one have its material, or that moved by as much as the points leave open, and one step after the other
//! asks for the same again.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use truepath_core::cut::ForceTable;
use truepath_core::identify::Parameters;
use truepath_core::units::Real;

/// The force table of a machine and its material.
pub fn force_table(parameters: &Parameters) -> Arc<ForceTable> {
    static LATEST: Latest = Latest(Mutex::new(VecDeque::new()));
    LATEST.of(parameters.coefficients.size_exponent)
}

/// The tables that were made last, the latest first.
struct Latest(Mutex<VecDeque<Arc<ForceTable>>>);

impl Latest {
    /// Tables kept, 16 KiB each.
    const KEPT: usize = 64;

    fn of(&self, size_exponent: Real) -> Arc<ForceTable> {
        let all = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = all().iter().find(|table| table.size_exponent() == size_exponent).cloned();
        found.unwrap_or_else(|| {
            // Unlocked meanwhile: two that make the same at once make it alike.
            let table = Arc::new(ForceTable::new(size_exponent));
            let mut all = all();
            all.push_front(Arc::clone(&table));
            all.truncate(Self::KEPT);
            table
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_that_of_its_exponent_and_made_again_only_when_others_took_its_place() {
        let latest = Latest(Mutex::default());
        let of = |thousandths: usize| latest.of(Real::ratio(thousandths as i64, 1_000));
        let words = |table: &ForceTable| format!("{table:?}");
        let first = of(123);
        assert_eq!(words(&first), words(&ForceTable::new(Real::ratio(123, 1_000))));
        for other in 200..200 + Latest::KEPT - 1 {
            assert_eq!(of(other).size_exponent(), Real::ratio(other as i64, 1_000));
        }
        assert!(Arc::ptr_eq(&first, &of(123)));
        of(300);
        let again = of(123);
        assert!(!Arc::ptr_eq(&first, &again));
        assert_eq!(words(&first), words(&again));
        assert_eq!(latest.0.into_inner().map(|all| all.len()).ok(), Some(Latest::KEPT));
    }
}
