//! Requests that are drawn: every kind, with arguments that mean something more often than not.

use ed25519_dalek::Signer;
use truepath_core::image::{Rights, Role};
use truepath_core::link::{Ask, DeviceSettings, NONCE_BYTES, login_message};
use truepath_core::rewrite::{ArmRequest, Frame};
use truepath_core::units::Offset;

use super::device::ID;
use super::tape::Tape;
use super::things::Things;

/// What the arguments are about.
pub(super) struct Known<'t> {
    pub things: &'t Things,
    pub frame: Frame,
    pub settings: DeviceSettings,
}

/// A request.
pub(super) fn drawn<'a>(tape: &mut Tape<'_>, known: &Known<'_>) -> Ask<'a> {
    let things = known.things;
    match tape.byte() % 33 {
        0 => Ask::Hello,
        1 => Ask::Status,
        2 => Ask::AcknowledgeDrivesDisabled,
        3 => Ask::Check(arming(tape, known)),
        4 => Ask::Arm(arming(tape, known)),
        5 => Ask::Disarm,
        6 => Ask::List,
        7 => {
            let slot = tape.byte() % 3;
            let image = &things.images[usize::from(tape.byte()) % things.images.len()];
            Ask::Activate { slot, crc: image.crc }
        }
        8 => Ask::Deactivate,
        9 => Ask::Configure(settings(tape, &known.settings)),
        10 => Ask::ClearCounters,
        11 => Ask::Trace,
        12 => Ask::Recording { from: tape.byte().into() },
        13 => Ask::ReleaseRecording,
        14 => Ask::Compute,
        15 => Ask::Progress,
        16 => Ask::Restart { watchdog: tape.byte() & 1 != 0 },
        17 => Ask::Keys,
        18 => Ask::Provision(things.public(tape.byte().into())),
        19 => Ask::Revoke(things.public(tape.byte().into()).id()),
        20 => Ask::Log { from: tape.byte().into() },
        21 => Ask::Time { unix_s: u32::from(tape.word()) << 16 },
        22 => Ask::Challenge,
        23 => Ask::Logout,
        24 => Ask::Session,
        25 => Ask::ProvisionAs { key: things.public(tape.byte().into()), rights: rights(tape) },
        26 => Ask::Timing,
        27 => Ask::Update,
        28 => Ask::Install,
        29 => Ask::Confirm,
        30 => Ask::ProvisionFirmware { key: things.public(tape.byte().into()), rights: rights(tape) },
        31 => Ask::Settings,
        _ => Ask::Commit,
    }
}

fn rights(tape: &mut Tape<'_>) -> Rights {
    let byte = tape.byte();
    Rights { role: Role::ALL[usize::from(byte % 3)], signs: byte & 4 != 0, firmware: false }
}

/// An arming, at times for another image, with a damaged frame or one on axes that nobody sends.
fn arming(tape: &mut Tape<'_>, known: &Known<'_>) -> ArmRequest {
    let [image, other] = known.things.setup.images();
    let part_serial = tape.byte().into();
    let mut request = ArmRequest { binding: image.settings().binding, part_serial, frame: known.frame };
    match tape.byte() {
        1 => request.binding = other.settings().binding,
        2 => request.binding.tool ^= 1,
        3 => request.frame.crc ^= 1,
        4 => {
            request.frame.axes[1].axis = 5;
            request.frame = request.frame.sealed();
        }
        5 => {
            request.frame.cosine /= 2;
            request.frame = request.frame.sealed();
        }
        _ => {}
    }
    request
}

/// Settings that differ from others in one or two values.
fn settings(tape: &mut Tape<'_>, from: &DeviceSettings) -> DeviceSettings {
    let mut to = *from;
    let (what, value) = (tape.byte(), u32::from(tape.byte()));
    match what % 12 {
        0 => to = DeviceSettings::at_1_khz(),
        1 => to.rewriter.tick_hz = [100, 250, 500, 1_000, 2_000, 10_000][value as usize % 6],
        2 => to.rewriter.max_lost_frames = value % 20,
        3 => to.deadline_us = 10 + 10 * value,
        4 => to.silence_us = 5_000 + 1_000 * value,
        5 => to.axes = value as u8 % 8,
        6 => to.rewriter.joint_limits_nm[1] = (-1_000_000_000, i64::from(value) * 2_000),
        7 => to.rewriter.hold_after_ticks = value,
        8 => to.rewriter.fade_ticks = value,
        9 => to.rewriter.max_step = Offset::from_um(10 * i64::from(value)),
        10 => to.rewriter.correction_slew_nm_per_s = 100_000 * value,
        _ => to.rewriter.spindle_stale_ticks = value,
    }
    to
}

/// The answer to a challenge by one of the keys.
pub(super) fn login<'a>(tape: &mut Tape<'_>, things: &Things, nonce: &[u8; NONCE_BYTES]) -> Ask<'a> {
    let (by, role, spoilt) = (usize::from(tape.byte()) % things.keys.len(), tape.byte(), tape.byte());
    let (key, role) = (things.public(by).id(), Role::ALL[usize::from(role % 3)]);
    let mut bytes = things.keys[by].sign(&login_message(&ID, nonce, key, role)).to_bytes();
    bytes[usize::from(spoilt) % 64] ^= spoilt;
    let (halves, _) = bytes.as_chunks::<32>();
    Ask::Login { key, role, signature: [halves[0], halves[1]] }
}
