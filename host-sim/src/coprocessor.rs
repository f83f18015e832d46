//! `device`: what a retrofit engineer asks of a coprocessor over its configuration link.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;
use truepath_bench::{Access, BenchError, Client, Committed, Wire};
use truepath_core::image::Rights;
use truepath_core::link::{Ask, Denial, Item, Reply, ResetCause, SetpointFrame, Slot, setpoint_bytes};
use truepath_core::rewrite::{AXES, Setpoint};
use truepath_ground::diagnostics::InputError;
use truepath_job::signing::Signer;

/// Identity and sizes of a device.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "named as in core::link::Hello")]
pub struct Info {
    pub board: String,
    pub firmware: String,
    pub link_version: u8,
    pub semantics: u32,
    pub image_format: u16,
    pub axes: u8,
    pub most_nodes: u32,
    pub slot_bytes: u32,
    pub program_bytes: u32,
    pub job_bytes: u32,
    pub probe_bytes: u32,
    pub boots: u32,
    pub last_reset: ResetCause,
    /// Whose images it takes; `None` of a firmware that takes every image and knows no keys.
    pub trust: Option<Trust>,
}

/// Whose images a device takes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Trust {
    /// Every image, because it never had a key.
    pub open: bool,
    /// The numbers of its keys.
    pub keys: Vec<String>,
    /// What each of them is good for: the highest role it can log in with, and whether images that it signs are taken; nothing of
    /// a firmware that knows no roles.
    pub rights: Option<Vec<Rights>>,
    /// The numbers of those whose firmware is taken.
    pub firmware: Vec<String>,
    /// The number of the key of who is logged in.
    pub logged_in: Option<String>,
    /// The numbers of those that were revoked.
    pub revoked: Vec<String>,
    /// What kind of device it is.
    pub class: &'static str,
    /// Whether its button was held at its last reset, so that keys can be provisioned and revoked.
    pub provisioning: bool,
}

impl Trust {
    /// In words, on lines of its own.
    pub fn words(&self) -> String {
        let class = self.class;
        let mut text = if self.open {
            format!("OPEN: takes every image, signed or not (class {class}, no key is provisioned)\n")
        } else if self.keys.is_empty() {
            "CLOSED: takes no image, every key was revoked; provision another one\n".to_owned()
        } else {
            let signs = |at: usize| self.rights.as_ref().is_none_or(|rights| rights.get(at).is_some_and(|r| r.signs));
            let signers = self.keys.iter().enumerate().filter(|(at, _)| signs(*at)).map(|(_, key)| key.as_str());
            let signers = signers.collect::<Vec<_>>().join(" or ");
            let none = if signers.is_empty() { "no key that is here" } else { "" };
            format!("takes images signed for {class} with {signers}{none}\n")
        };
        for (key, rights) in self.keys.iter().zip(self.rights.iter().flatten()) {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "key {key}: {rights}");
        }
        if let Some(key) = &self.logged_in {
            let _ = writeln!(text, "logged in: {key}");
        }
        if !self.revoked.is_empty() {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "revoked for ever: {}", self.revoked.join(", "));
        }
        if self.provisioning {
            text += "the button was held at the last reset: keys can be provisioned and revoked until the next one\n";
        }
        text
    }
}

/// Access to a device with the private key of a file.
///
/// # Errors
/// As [`Signer::read`].
pub fn access(path: &Path) -> Result<Access, InputError> {
    let signer = Signer::read(path, &[])?;
    Ok(Access::new(&signer.public(), move |message| signer.sign(message)))
}

/// Asks whose images a device takes.
///
/// # Errors
/// As [`Client::ask`].
pub fn trust<W: Wire>(client: &mut Client<W>) -> Result<Trust, BenchError> {
    let keys = client.keys()?;
    let session = client.session()?;
    // Nothing of a firmware that knows no updates.
    let signs = match client.ask(Ask::Update) {
        Ok(Reply::Update(status)) => status.signs.to_vec(),
        Err(BenchError::Denied(Denial::Unknown)) => vec![],
        other => return Err(BenchError::Foreign(format!("{:?}", other?))),
    };
    let count = keys.keys.iter().count();
    let signs_firmware = keys.keys.iter().zip(&signs).filter(|(_, signs)| **signs);
    Ok(Trust {
        firmware: signs_firmware.map(|(key, _)| key.id().to_string()).collect(),
        open: keys.keys.is_open(),
        keys: keys.keys.iter().map(|key| key.id().to_string()).collect(),
        rights: session.map(|session| {
            let signs = signs.iter().copied().chain(std::iter::repeat(false));
            let rights = session.rights.into_iter().zip(signs);
            rights.map(|(rights, firmware)| Rights { firmware, ..rights }).take(count).collect()
        }),
        logged_in: session.and_then(|session| session.key).map(|key| key.to_string()),
        revoked: keys.keys.revoked().map(|key| key.to_string()).collect(),
        class: keys.class.name(),
        provisioning: keys.present,
    })
}

/// Asks who is there.
///
/// # Errors
/// As [`Client::ask`].
pub fn info<W: Wire>(client: &mut Client<W>) -> Result<Info, BenchError> {
    let trust = match trust(client) {
        Err(BenchError::Denied(Denial::Unknown)) => None,
        other => Some(other?),
    };
    match client.ask(Ask::Hello)? {
        Reply::Hello(h) => Ok(Info {
            board: h.board.to_owned(),
            firmware: h.firmware.to_owned(),
            link_version: h.link_version,
            semantics: h.semantics,
            image_format: h.image_format,
            axes: h.axes,
            most_nodes: h.most_nodes,
            slot_bytes: h.slot_bytes,
            program_bytes: h.program_bytes,
            job_bytes: h.job_bytes,
            probe_bytes: h.probe_bytes,
            boots: h.boots,
            last_reset: h.last_reset,
            trust,
        }),
        other => Err(BenchError::Foreign(format!("{other:?}"))),
    }
}

/// Uploads an image and, if wanted, makes it the active one.
///
/// # Errors
/// As [`Client::upload`].
pub fn upload<W: Wire>(
    client: &mut Client<W>,
    image: &[u8],
    activate: bool,
    progress: impl FnMut(u64),
) -> Result<Committed, BenchError> {
    let committed = client.upload(Item::Image, image, progress)?;
    if activate {
        client.done(Ask::Activate { slot: committed.slot, crc: committed.crc })?;
    }
    Ok(committed)
}

/// Makes the image of a slot the active one; gives its checksum.
///
/// # Errors
/// There is no image in the slot; as [`Client::ask`].
pub fn activate<W: Wire>(client: &mut Client<W>, slot: u8) -> Result<u32, BenchError> {
    let slots = client.slots()?;
    let Some(Slot::Image { crc, .. }) = slots.get(usize::from(slot)) else {
        return Err(BenchError::Denied(truepath_core::link::Denial::NoImage { slot }));
    };
    let crc = *crc;
    client.done(Ask::Activate { slot, crc })?;
    Ok(crc)
}

/// A frame of the recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recorded {
    /// Undamaged.
    Setpoint(Setpoint),
    /// It arrived damaged.
    Damaged,
}

/// Downloads the recorder: the raw frames before the last fault, oldest first. `progress` is told frames and all.
///
/// # Errors
/// The recorder still runs; as [`Client::ask`].
pub fn recording<W: Wire>(
    client: &mut Client<W>,
    axes: u8,
    mut progress: impl FnMut(u64, u64),
) -> Result<Vec<Recorded>, BenchError> {
    let mut frames = Vec::new();
    loop {
        let next = frames.len() as u32;
        let reply = client.ask(Ask::Recording { from: next })?;
        let Reply::Recording { total, from, bytes } = reply else {
            return Err(BenchError::Foreign(format!("{reply:?}")));
        };
        if from != next || bytes.is_empty() {
            return Err(BenchError::Foreign(format!("frames from {from}, asked for {next}")));
        }
        frames.extend(
            bytes
                .chunks(setpoint_bytes(axes))
                .map(|raw| SetpointFrame::decode(raw, axes).map_or(Recorded::Damaged, Recorded::Setpoint)),
        );
        progress(frames.len() as u64, total.into());
        if frames.len() >= total as usize {
            return Ok(frames);
        }
    }
}

/// A recording as a table: every axis, speed, flags, damaged frames as rows without numbers.
pub fn recording_table(frames: &[Recorded], axes: u8) -> String {
    let axes = usize::from(axes).min(AXES);
    let mut text = String::from("frame,sequence,flags,spindle_rpm,spindle_age_ticks,frame_crc");
    // Writing to a String cannot fail.
    for axis in 0..axes {
        let _ = write!(text, ",axis{axis}_mm");
    }
    text.push('\n');
    for (index, frame) in frames.iter().enumerate() {
        match frame {
            Recorded::Damaged => {
                let _ = writeln!(text, "{index},damaged,,,,{}", ",".repeat(axes));
            }
            Recorded::Setpoint(s) => {
                let rpm = f64::from(s.spindle_millirpm) / 1000.0;
                let _ = write!(
                    text,
                    "{index},{},{},{rpm},{},{:08x}",
                    s.sequence, s.flags.0, s.spindle_age_ticks, s.frame_crc
                );
                for nm in &s.axes[..axes] {
                    let _ = write!(text, ",{}", millimetres(*nm));
                }
                text.push('\n');
            }
        }
    }
    text
}

/// A recording as a file of setpoints for `replay` and `hil`: machine coordinates, the first three axes as X, Y, Z.
/// Damaged frames leave a gap.
pub fn recording_setpoints(frames: &[Recorded], tick_hz: u32) -> String {
    let mut text = String::from("# frame = machine\nt_s,x_mm,y_mm,z_mm,spindle_rpm,flags,frame_crc\n");
    let good = || frames.iter().filter_map(|f| if let Recorded::Setpoint(s) = f { Some(s) } else { None });
    let first = good().next().map_or(0, |s| s.sequence);
    for s in good() {
        let ticks = u64::from(s.sequence.wrapping_sub(first));
        let ns = ticks * 1_000_000_000 / u64::from(tick_hz.max(1));
        let [x, y, z] = [s.axes[0], s.axes[1], s.axes[2]].map(millimetres);
        let rpm = f64::from(s.spindle_millirpm) / 1000.0;
        let (seconds, rest, flags, frame) = (ns / 1_000_000_000, ns % 1_000_000_000, s.flags.0, s.frame_crc);
        let _ = writeln!(text, "{seconds}.{rest:09},{x},{y},{z},{rpm},{flags},{frame}");
    }
    text
}

/// Nanometres as millimetres, exactly.
fn millimetres(nm: i64) -> String {
    let (sign, nm) = (if nm < 0 { "-" } else { "" }, nm.unsigned_abs());
    format!("{sign}{}.{:06}", nm / 1_000_000, nm % 1_000_000)
}

#[cfg(test)]
mod tests {
    use truepath_core::rewrite::Flags;

    use super::*;

    #[test]
    fn a_recording_is_a_file_that_replay_reads() {
        let setpoint = |sequence, x| Setpoint {
            axes: [x, -1, 2_000_000, 0, 0, 0],
            spindle_millirpm: 1_500_500,
            sequence,
            frame_crc: 7,
            flags: Flags::EMERGENCY_STOP,
            ..Setpoint::default()
        };
        let frames: Vec<Recorded> =
            (0..4).map(|k| Recorded::Setpoint(setpoint(u32::MAX.wrapping_add(k), -1_500_000 + i64::from(k)))).collect();
        let text = recording_setpoints(&frames, 1000);
        let source = truepath_ground::diagnostics::Source::new("recording.csv", text.into_bytes());
        let read = truepath_trial::setpoints::Setpoints::parse(&source).expect("setpoints");
        assert_eq!(read.period_ns, 1_000_000);
        assert_eq!(read.rows[3].position_nm, [-1_499_997, -1, 2_000_000]);
        assert_eq!((read.rows[3].flags, read.rows[3].frame_crc), (Flags::EMERGENCY_STOP, Some(7)));
        let table = recording_table(&[Recorded::Damaged, frames[0]], 3);
        assert_eq!(table.lines().map(|l| l.split(',').count()).collect::<Vec<_>>(), [9, 9, 9]);
    }
}
