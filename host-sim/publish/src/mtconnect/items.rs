//! Data items: what an agent is told of state and alarms. `docs/publish.md` has the device model with the same names.

use crate::message::{AlarmMessage, BatchState, Level, PartMessage, Raised, StateMessage};

use super::shdr;

/// What an item has of which nothing is known.
pub const UNAVAILABLE: &str = "UNAVAILABLE";
/// Whether somebody follows.
pub const AVAILABLE: &str = "tp_avail";
/// The condition that alarms are.
pub const ALARM: &str = "tp_alarm";
/// The items of the state, in the order of [`of_state`].
const OF_STATE: [&str; 15] = [
    "tp_batch",
    "tp_in_control",
    "tp_last_part",
    "tp_parts_left",
    "tp_force_level",
    "tp_force_level_sigma",
    "tp_radius_lost",
    "tp_radius_lost_sigma",
    "tp_datum_x",
    "tp_datum_x_sigma",
    "tp_datum_y",
    "tp_datum_y_sigma",
    "tp_next_in_tolerance",
    "tp_alarms",
    "tp_version",
];
/// The items of a part, in the order of [`of_part`].
const OF_PART: [&str; 3] = ["tp_part", "tp_deviation", "tp_in_tolerance"];

/// All items but the condition, in their order.
pub fn all() -> impl Iterator<Item = &'static str> {
    [AVAILABLE].into_iter().chain(OF_STATE).chain(OF_PART)
}

/// Values of items.
pub type Values = Vec<(&'static str, String)>;

/// Of a state. Shares are percent, as the units of the standard have it.
pub fn of_state(message: &StateMessage) -> Values {
    let BatchState { batch, in_control, last_part, parts_left, .. } = &message.batch;
    let known = |value: Option<String>| value.unwrap_or_else(|| UNAVAILABLE.to_owned());
    let percent = |share: Option<f64>| known(share.map(|share| format!("{:.2}", 100.0 * share)));
    let mm = |value: f64| format!("{value:.6}");
    let state = &message.batch;
    let values = [
        batch.clone(),
        yes(*in_control),
        last_part.to_string(),
        known(parts_left.map(|left| left.to_string())),
        percent(state.force_level),
        percent(state.force_level_sigma),
        mm(state.radius_lost_mm),
        mm(state.radius_lost_sigma_mm),
        mm(state.datum_x_mm),
        mm(state.datum_x_sigma_mm),
        mm(state.datum_y_mm),
        mm(state.datum_y_sigma_mm),
        percent(state.next_in_tolerance),
        message.alarms.to_string(),
        message.software_version.to_owned(),
    ];
    OF_STATE.into_iter().zip(values).collect()
}

/// Of a part.
pub fn of_part(message: &PartMessage) -> Values {
    let part = &message.part;
    let values = [
        part.part.to_string(),
        format!("{:.6}", part.worst_deviation_mm),
        part.in_tolerance.map_or_else(|| UNAVAILABLE.to_owned(), yes),
    ];
    OF_PART.into_iter().zip(values).collect()
}

fn yes(value: bool) -> String {
    if value { "YES" } else { "NO" }.to_owned()
}

/// Lines that bring the condition from any state to this one.
pub fn conditions(message: &AlarmMessage) -> String {
    // Without a code it clears all.
    normal(message.head.time(), "")
        + &message.raised.iter().map(|one| raised(message.head.time(), one)).collect::<String>()
}

/// Lines that bring the condition from that of the message before to this one.
pub fn changes(before: Option<&AlarmMessage>, message: &AlarmMessage) -> String {
    let Some(before) = before else { return conditions(message) };
    let time = message.head.time();
    let gone = message.cleared.iter().map(|cleared| normal(time, &cleared.key));
    let new = message.raised.iter().filter(|one| !before.raised.contains(one)).map(|one| raised(time, one));
    gone.chain(new).collect()
}

fn normal(time: &str, code: &str) -> String {
    shdr::condition(time, ALARM, "NORMAL", code, "", "")
}

fn raised(time: &str, Raised { key, level, qualifier, text, .. }: &Raised) -> String {
    let level = if *level == Level::Fault { "FAULT" } else { "WARNING" };
    shdr::condition(time, ALARM, level, key, qualifier, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_device_model_of_the_document_has_the_items_that_are_sent() {
        let document = include_str!("../../../../docs/publish.md");
        let model: Vec<&str> =
            document.split("<DataItem id=\"").skip(1).filter_map(|row| row.split('"').next()).collect();
        let sent: Vec<&str> = all().chain([ALARM]).collect();
        assert_eq!(model, sent);
    }
}
