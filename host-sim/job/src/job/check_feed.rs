//! The `[feed]` table: whether and how far the feeds along the contour may be changed.

use truepath_core::units::Real;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::InputError;
use truepath_ground::document::Section;
use truepath_ground::limits::Limits;

/// What the table says; without it no F word is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeedTable {
    /// Lowest and highest feed, percent of the programmed one, 5…100 and 100…200.
    pub percent: [u16; 2],
    /// What the force is held against.
    pub limit: ForceLimit,
}

/// What the force is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceLimit {
    /// The largest mean force at the probed places: the window in which the model was identified.
    Probed,
    /// A mean force, N.
    Newtons(Real),
}

/// What the table says.
pub(super) fn feed(section: Option<&Section<'_>>) -> Result<Option<FeedTable>, InputError> {
    let Some(section) = section else { return Ok(None) };
    let help = "write whole percents of the programmed feed";
    let lowest = section.whole("min_percent", Limits::within("5", "100", "%"), help)?;
    let highest = section.whole("max_percent", Limits::within("100", "200", "%"), help)?.unwrap_or(100);
    let keep = section.choice("keep", &[("probed", ForceLimit::Probed)])?;
    let newtons = section.number("max_force_n", Limits::above("0", "100000", "N"))?.map(Decimal::as_real);
    let limit = match (keep, newtons) {
        (Some(_), Some(_)) => {
            let value = section.value("keep").map_or_else(
                || section.missing("keep", "a name"),
                |value| {
                    let help = "remove keep to use your own limit, or remove max_force_n";
                    section.contradiction(
                        &value,
                        "feed.keep is given as well as feed.max_force_n",
                        "one of the two",
                        help,
                    )
                },
            );
            return Err(value);
        }
        (_, Some(newtons)) => ForceLimit::Newtons(newtons),
        (_, None) => ForceLimit::Probed,
    };
    let Some(lowest) = lowest else {
        return Err(section.missing("min_percent", "the lowest feed, 5 to 100 % of the programmed one"));
    };
    section.close()?;
    Ok(Some(FeedTable { percent: [lowest, highest], limit }))
}
