//! Settings by name, as the command line shows and changes them.
//!
//! The names are those of the fields, joined by points where one holds another: `axes`, `rewriter.tick_hz`. A value is
//! written as in JSON. A field that is added in core is there without a line here.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use truepath_core::link::DeviceSettings;
use truepath_core::rewrite::Settings;

/// What is wrong with a change.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoSuchSetting {
    /// What was found.
    pub found: String,
    /// What to do.
    pub help: String,
}

/// Every setting with its value.
pub fn named(settings: &impl Serialize) -> Vec<(String, Value)> {
    let mut out = Vec::new();
    if let Ok(value) = serde_json::to_value(settings) {
        flatten("", &value, &mut out);
    }
    out
}

fn flatten(name: &str, value: &Value, out: &mut Vec<(String, Value)>) {
    match value {
        Value::Object(members) => {
            for (key, value) in members {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                flatten(&name, value, out);
            }
        }
        _ => out.push((name.to_owned(), value.clone())),
    }
}

/// Settings with some of them changed, each as `name=value`.
///
/// # Errors
/// A name or a value that there is not; ranges are for the user of the settings to check.
pub fn changed<S: Serialize + DeserializeOwned>(settings: &S, changes: &[String]) -> Result<S, NoSuchSetting> {
    let wrong = |found: String, help: String| NoSuchSetting { found, help };
    let mut all = serde_json::to_value(settings).map_err(|e| wrong(e.to_string(), String::new()))?;
    for change in changes {
        let names = || named(settings).into_iter().map(|(name, _)| name).collect::<Vec<_>>().join(", ");
        let (name, text) = change
            .split_once('=')
            .ok_or_else(|| wrong(format!("\"{change}\" is no name=value"), "write a name, = and a value".into()))?;
        let place = all
            .pointer_mut(&format!("/{}", name.replace('.', "/")))
            .filter(|place| !place.is_object())
            .ok_or_else(|| wrong(format!("there is no setting \"{name}\""), format!("one of {}", names())))?;
        *place = serde_json::from_str(text)
            .map_err(|_| wrong(format!("\"{text}\" is no value"), format!("{name} is {place} now")))?;
    }
    serde_json::from_value(all).map_err(|e| wrong(format!("settings: {e}"), "give values of the kind shown".into()))
}

/// Settings for a controller that sends a setpoint each `period_us`: what is counted in ticks, and the largest step, become
/// those of [`replay`](truepath_trial::replay::settings); an answer within half a period, silence after 20. The rest stays.
pub fn paced(settings: &DeviceSettings, period_us: u32) -> DeviceSettings {
    let paced = truepath_trial::replay::settings(i64::from(period_us) * 1000);
    DeviceSettings {
        rewriter: Settings {
            tick_hz: paced.tick_hz,
            max_step: paced.max_step,
            max_lost_frames: paced.max_lost_frames,
            hold_after_ticks: paced.hold_after_ticks,
            spindle_stale_ticks: paced.spindle_stale_ticks,
            fade_ticks: paced.fade_ticks,
            feed_smoothing: paced.feed_smoothing,
            ..settings.rewriter
        },
        deadline_us: (period_us / 2).max(10),
        silence_us: period_us.saturating_mul(20),
        ..*settings
    }
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_setting_is_changed_by_its_name_and_nothing_else_is() {
        let settings = DeviceSettings::at_1_khz();
        let wanted = ["axes=6".to_owned(), "rewriter.tick_hz=2000".to_owned()];
        let new = changed(&settings, &wanted).expect("settings");
        let mut expected = settings;
        (expected.axes, expected.rewriter.tick_hz) = (6, 2000);
        assert_eq!(new, expected);
        for wrong in ["axis=6", "axes", "axes=many", "axes=300", "rewriter=1"] {
            assert!(changed(&settings, &[wrong.to_owned()]).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_limits_of_the_joints_are_one_value() {
        let all = "joint_limits_nm=[[-1,2],[-3,4],[0,5],[0,0],[0,0],[0,0]]".to_owned();
        let new = changed(&Settings::at_1_khz(), &[all]).expect("settings");
        assert_eq!(new.joint_limits_nm[..3], [(-1, 2), (-3, 4), (0, 5)]);
    }

    #[test]
    fn settings_for_a_pace_are_those_of_a_replay_at_that_pace_and_keep_the_machine() {
        let mut old = DeviceSettings { axes: 4, ..DeviceSettings::at_1_khz() };
        old.rewriter.joint_limits_nm[1] = (-5, 5);
        old.rewriter.require_spindle_load = true;
        for period_us in [10, 1_000, 10_000, 100_000] {
            let new = paced(&old, period_us);
            assert_eq!(new.check(), Ok(()), "{period_us} us");
            let mut expected = truepath_trial::replay::settings(i64::from(period_us) * 1000);
            expected.joint_limits_nm = old.rewriter.joint_limits_nm;
            expected.require_spindle_load = true;
            assert_eq!((new.rewriter, new.axes), (expected, 4));
        }
        assert_eq!(paced(&DeviceSettings::at_1_khz(), 1_000), DeviceSettings::at_1_khz());
    }
}
