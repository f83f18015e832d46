//! Settings over the configuration link: ranges, keeping, and what they change.

use crate::wire_support;
use embedded_storage::nor_flash::NorFlash;
use truepath_core::checksum::crc32;
use truepath_core::link::{
    ActiveImage, Ask, Denial, DeviceSetting, DeviceSettings, DeviceSettingsError, ResetCause, setpoint_bytes,
};
use truepath_core::rewrite::{Mode, Setting, SettingsError};
use truepath_core::units::Offset;
use truepath_fw::flash::LEDGER_SECTORS;
use truepath_fw::ledger::Remembered;
use wire_support::part::straight;
use wire_support::*;

type Change = fn(&mut DeviceSettings, i64);

const RANGES: [(Change, i64, i64); 10] = [
    (|s, v| s.axes = v as u8, 1, 6),
    (|s, v| s.deadline_us = v as u32, 10, 1_000_000),
    // At least two ticks more than may be lost, at 1 kHz.
    (|s, v| s.silence_us = v as u32, 4_000, 10_000_000),
    (|s, v| s.rewriter.tick_hz = v as u32, 10, 100_000),
    (|s, v| s.rewriter.max_step = Offset::from_nm(v), 1, 8_000_000),
    (|s, v| s.rewriter.max_lost_frames = v as u32, 0, 16),
    (|s, v| s.rewriter.hold_after_ticks = v as u32, 2, 1 << 31),
    (|s, v| s.rewriter.fade_ticks = v as u32, 1, 65_536),
    (|s, v| s.rewriter.feed_smoothing = v as u32, 0, 12),
    (|s, v| s.rewriter.correction_acceleration_nm_per_s2 = v as u64, 1, 1_000_000_000_000),
];

/// So patient that every tick rate goes with it.
fn patient() -> DeviceSettings {
    DeviceSettings { silence_us: 10_000_000, ..DeviceSettings::at_1_khz() }
}

#[test]
fn every_setting_is_taken_at_its_ends_and_refused_beyond_them() {
    let mut rig = Rig::new();
    for (change, low, high) in RANGES {
        let with = |value| {
            let mut settings = patient();
            change(&mut settings, value);
            settings
        };
        for value in [low, high] {
            rig.done(Ask::Configure(with(value))).unwrap();
            assert_eq!(rig.settings(), with(value));
            rig.reset(ResetCause::PowerOn);
            assert_eq!(rig.settings(), with(value), "kept over a reset");
        }
        for value in [low - 1, high + 1] {
            let before = rig.settings();
            assert!(matches!(rig.done(Ask::Configure(with(value))), Err(Denial::Settings(_))), "{value}");
            assert_eq!(rig.settings(), before);
            rig.reset(ResetCause::PowerOn);
            assert_eq!(rig.settings(), before);
        }
    }
}

#[test]
fn a_refusal_names_the_setting_and_its_range() {
    let mut rig = Rig::new();
    let mut settings = DeviceSettings::at_1_khz();
    settings.axes = 7;
    let expected = DeviceSettingsError::Range { setting: DeviceSetting::Axes, value: 7, low: 1, high: 6 };
    assert_eq!(rig.done(Ask::Configure(settings)), Err(Denial::Settings(expected)));
    let mut settings = DeviceSettings::at_1_khz();
    settings.rewriter.tick_hz = 9;
    let name = Setting::TickRate;
    let expected = SettingsError::Range { name, value: 9, low: 10, high: 100_000 };
    let denied = Denial::Settings(DeviceSettingsError::Rewriter(expected));
    assert_eq!(rig.done(Ask::Configure(settings)), Err(denied));
    let mut settings = DeviceSettings::at_1_khz();
    settings.rewriter.joint_limits_nm[2] = (1, 0);
    let denied = Denial::Settings(DeviceSettingsError::Rewriter(SettingsError::JointLimits { axis: 2 }));
    assert_eq!(rig.done(Ask::Configure(settings)), Err(denied));
}

#[test]
fn another_number_of_axes_makes_frames_of_the_old_one_damaged_and_the_recorder_begin_anew() {
    let mut rig = Rig::new();
    assert!(rig.stay().is_some());
    let mut settings = DeviceSettings::at_1_khz();
    settings.axes = 5;
    rig.done(Ask::Configure(settings)).unwrap();
    let before = rig.status().counters.damaged;
    assert!(rig.stay().is_none());
    assert_eq!(rig.status().counters.damaged, before + 1);
    assert_eq!(setpoint_bytes(5), 64);
}

#[test]
fn settings_that_do_not_go_with_the_image_in_use_are_refused_and_the_image_stays() {
    let mut settings = part::settings();
    settings.limits.slew_nm_per_s = 100;
    let image = image_with(&settings, straight());
    let mut rig = Rig::with_image(&image);
    let mut fast = DeviceSettings::at_1_khz();
    fast.rewriter.tick_hz = 100_000;
    assert!(matches!(
        rig.done(Ask::Configure(fast)),
        Err(Denial::Settings(DeviceSettingsError::Rewriter(SettingsError::LimitVanishes { .. })))
    ));
    assert_eq!(rig.settings(), DeviceSettings::at_1_khz());
    assert_eq!(rig.status().active.unwrap().crc, name(&image));
    rig.enable();
    rig.arm(1).unwrap();
    assert_eq!(rig.mode(), Mode::Armed);
}

#[test]
fn an_image_that_does_not_go_with_the_settings_is_not_activated_and_the_one_before_stays() {
    let mut settings = part::settings();
    settings.limits.slew_nm_per_s = 100;
    let (slow, good) = (image_with(&settings, straight()), image_of(straight()));
    let mut rig = Rig::with_image(&good);
    let mut fast = DeviceSettings::at_1_khz();
    fast.rewriter.tick_hz = 100_000;
    rig.done(Ask::Configure(fast)).unwrap();
    rig.upload(&slow).unwrap();
    assert!(matches!(rig.activate(1, name(&slow)), Err(Denial::Settings(_))));
    assert_eq!(rig.status().active.unwrap().crc, name(&good));
    rig.reset(ResetCause::PowerOn);
    assert_eq!(rig.status().active.unwrap().crc, name(&good));
}

/// Neither checked nor armed until configured, setpoints pass on meanwhile.
fn is_armed_only_once_configured(rig: &mut Rig, settings: DeviceSettings) {
    rig.enable();
    let request = rig.request(1);
    for _ in 0..2 {
        assert_eq!(rig.done(Ask::Check(request)), Err(Denial::NotConfigured));
        assert_eq!(rig.arm(1), Err(Denial::NotConfigured));
        let out = rig.stay().unwrap();
        assert!(out.forward && out.mode == Mode::Bypass && out.axes == rig.setpoint.axes);
        // A reset alone, and settings that are refused, do not help.
        rig.reset(ResetCause::PowerOn);
        let wrong = DeviceSettings { axes: 0, ..settings };
        assert!(matches!(rig.done(Ask::Configure(wrong)), Err(Denial::Settings(_))));
        rig.enable();
    }
    rig.reset(ResetCause::PowerOn);
    rig.done(Ask::Configure(settings)).unwrap();
    for _ in 0..2 {
        rig.enable();
        rig.done(Ask::Check(request)).unwrap();
        rig.reset(ResetCause::PowerOn);
        assert_eq!(rig.settings(), settings);
    }
    rig.enable();
    rig.arm(1).unwrap();
    assert_eq!(rig.mode(), Mode::Armed);
}

#[test]
fn a_device_that_was_never_configured_arms_nothing() {
    let image = image_of(straight());
    let mut rig = Rig::from_factory();
    rig.upload(&image).unwrap();
    rig.activate(0, name(&image)).unwrap();
    assert_eq!(rig.settings(), DeviceSettings::at_1_khz(), "what it would use");
    is_armed_only_once_configured(&mut rig, DeviceSettings::at_1_khz());
}

#[test]
fn a_device_that_has_lost_its_joint_limits_arms_nothing() {
    let mut limited = DeviceSettings::at_1_khz();
    limited.rewriter.joint_limits_nm = [(-part::MM, part::MM); 6];
    for cut in [false, true] {
        let image = image_of(straight());
        let mut rig = Rig::from_factory();
        rig.upload(&image).unwrap();
        rig.done(Ask::Configure(limited)).unwrap();
        // The record of a firmware to come: other settings, or settings of another length.
        let wrong = DeviceSettings { axes: 77, ..limited };
        let active = Some(ActiveImage { slot: 0, crc: name(&image) });
        let record = Remembered { boots: 9, active, settings: Some(wrong), ..Remembered::default() };
        let mut bytes = postcard::to_slice(&record, &mut [0; 992]).unwrap().to_vec();
        if cut {
            bytes.truncate(bytes.len() - 3);
        }
        append(rig.flash(), &bytes);
        rig.reset(ResetCause::PowerOn);
        assert_eq!(rig.settings(), DeviceSettings::at_1_khz());
        if cut {
            rig.activate(0, name(&image)).unwrap();
        }
        is_armed_only_once_configured(&mut rig, limited);
    }
}

/// A record behind all others, as the layout of the journal says.
fn append(flash: &mut Bank, payload: &[u8]) {
    let at = LEDGER_SECTORS.start() + 100 * 1_024;
    let mut padded = payload.to_vec();
    padded.resize(payload.len().next_multiple_of(32), 0);
    flash.write(at + 32, &padded).unwrap();
    let mut head = [0; 32];
    head[..4].copy_from_slice(b"TPL2");
    head[4..8].copy_from_slice(&1_000u32.to_le_bytes());
    head[8..12].copy_from_slice(&(payload.len() as u32).to_le_bytes());
    head[12..16].copy_from_slice(&crc32(payload).to_le_bytes());
    let sum = crc32(&head[..28]);
    head[28..].copy_from_slice(&sum.to_le_bytes());
    flash.write(at, &head).unwrap();
}

#[test]
fn settings_are_used_at_once() {
    let mut rig = Rig::with_image(&image_of(straight()));
    let mut settings = DeviceSettings::at_1_khz();
    settings.silence_us = 5_000;
    rig.done(Ask::Configure(settings)).unwrap();
    rig.enable();
    rig.wait(4);
    assert_eq!(rig.mode(), Mode::Bypass);
    rig.wait(2);
    assert_eq!(rig.mode(), Mode::Off);
    assert_eq!(rig.status().counters.silences, 1);
}
