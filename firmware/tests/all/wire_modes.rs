//! Which request is taken in which mode: the table of the document against the device, request by request.

use crate::wire_support;
use truepath_core::image::{Rights, Role};
use truepath_core::link::{ActiveImage, Ask, Denial, DeviceSettings, Item, Slot};
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Identity, Mode, Refusal};
use wire_support::part::{self, FEED, PASS, straight};
use wire_support::*;

const MODES: [Mode; 6] = [Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault];

/// Rows of the table of requests: number, name, modes.
fn table() -> Vec<(usize, String, Vec<Mode>)> {
    let text = include_str!("../../../docs/link.md");
    let lines = text.lines().skip_while(|line| !line.starts_with("| index | `Ask`")).skip(2);
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let name = cells[2].trim_matches('`').split([' ', '(', '{']).next().unwrap().to_string();
        let modes = MODES.into_iter().filter(|mode| cells[3] == "all" || cells[3].contains(&mode.to_string()));
        (cells[1].parse().unwrap(), name, modes.collect())
    };
    lines.take_while(|line| line.starts_with('|')).map(row).collect()
}

pub fn asks(image: &[u8]) -> Vec<Ask<'_>> {
    let request = ArmRequest { binding: part::settings().binding, part_serial: 5, frame: Frame::identity() };
    vec![
        Ask::Hello,
        Ask::Status,
        Ask::AcknowledgeDrivesDisabled,
        Ask::Check(request),
        Ask::Arm(request),
        Ask::Disarm,
        Ask::Begin { item: Item::Image, length: image.len() as u32, crc: name(image) },
        Ask::Chunk { offset: 0, bytes: &image[..10] },
        Ask::Commit,
        Ask::List,
        Ask::Activate { slot: 0, crc: name(image) },
        Ask::Deactivate,
        Ask::Settings,
        Ask::Configure(DeviceSettings::at_1_khz()),
        Ask::ClearCounters,
        Ask::Trace,
        Ask::Recording { from: 0 },
        Ask::ReleaseRecording,
        Ask::Compute,
        Ask::Progress,
        Ask::Restart { watchdog: false },
        Ask::Keys,
        Ask::Provision(public(&owner(1))),
        Ask::Revoke(public(&owner(1)).id()),
        Ask::Log { from: 0 },
        Ask::Time { unix_s: 1_700_000_000 },
        Ask::Challenge,
        Ask::Login { key: public(&owner(1)).id(), role: Role::Operate, signature: [[1; 32]; 2] },
        Ask::Logout,
        Ask::Session,
        Ask::ProvisionAs {
            key: public(&owner(1)),
            rights: Rights { role: Role::Operate, signs: false, firmware: false },
        },
        Ask::Timing,
        Ask::Update,
        Ask::Install,
        Ask::Confirm,
        Ask::ProvisionFirmware { key: public(&owner(1)), rights: Rights::default() },
    ]
}

fn in_mode(mode: Mode, image: &[u8]) -> Rig {
    if matches!(mode, Mode::Off | Mode::Bypass | Mode::Armed) {
        let mut rig = Rig::with_image(image);
        if mode != Mode::Off {
            rig.enable();
        } else {
            rig.setpoint.flags = Flags::default();
            rig.stay();
        }
        if mode == Mode::Armed {
            rig.arm(1).unwrap();
        }
        return rig;
    }
    let mut rig = Rig::active(image);
    let [x, y, z, ..] = rig.setpoint.axes;
    if mode == Mode::Hold {
        rig.setpoint.flags = rig.setpoint.flags.with(Flags::FEED_HOLD);
        rig.stay();
    } else if mode == Mode::Fault {
        rig.send(x, y + 400_000, z);
    }
    rig
}

#[test]
fn every_request_is_taken_in_the_modes_of_the_document_and_in_no_other() {
    let image = image_of(straight());
    let (table, asks) = (table(), asks(&image));
    assert_eq!(table.len(), asks.len());
    for ((number, name, modes), ask) in table.into_iter().zip(asks) {
        assert_eq!(format!("{ask:?}").split([' ', '(']).next().unwrap(), name, "row {number}");
        for mode in MODES {
            let mut rig = in_mode(mode, &image);
            assert_eq!(rig.mode(), mode);
            let before = (rig.slots(), rig.settings(), rig.operations());
            let refused = match rig.ask(ask) {
                Err(Denial::Refused(Refusal::Off { .. })) => {
                    assert_eq!(mode, Mode::Off);
                    true
                }
                Err(Denial::Mode(found)) | Err(Denial::Refused(Refusal::State(found))) => {
                    assert_eq!(found, mode);
                    true
                }
                _ => false,
            };
            // What arming would say includes that the mode is the wrong one.
            if !matches!(ask, Ask::Check(_)) {
                assert_eq!(refused, !modes.contains(&mode), "{name} in {mode}");
            }
            if refused {
                assert_eq!(before, (rig.slots(), rig.settings(), rig.operations()), "{name} in {mode}");
                assert_eq!(rig.mode(), mode);
            }
        }
    }
}

#[test]
fn an_image_that_is_not_there_or_another_one_cannot_be_activated() {
    let (one, other) = (image_of(straight()), image_of(wire_support::straight(10)));
    let mut rig = Rig::with_image(&one);
    let before = rig.status().active;
    assert_eq!(before, Some(ActiveImage { slot: 0, crc: name(&one) }));
    assert_eq!(rig.activate(1, name(&one)), Err(Denial::NoImage { slot: 1 }));
    for slot in [2, 7, 255] {
        assert_eq!(rig.activate(slot, name(&one)), Err(Denial::NoImage { slot }));
    }
    rig.upload(&other).unwrap();
    let swapped = Denial::OtherImage { slot: 1, expected: name(&one), found: name(&other) };
    assert_eq!(rig.activate(1, name(&one)), Err(swapped));
    assert_eq!(rig.status().active, before, "what was active stays so");
    rig.enable();
    rig.arm(1).unwrap();
}

#[test]
fn an_image_of_another_program_feature_pass_tool_offset_or_setup_is_not_armed() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.enable();
    let good = rig.request(1);
    for what in
        [Identity::Program, Identity::Feature, Identity::Pass, Identity::Tool, Identity::ToolOffset, Identity::Setup]
    {
        let mut wrong = good;
        let b = &mut wrong.binding;
        let field = match what {
            Identity::Program => &mut b.program_crc,
            Identity::Feature => &mut b.feature,
            Identity::Pass => &mut b.pass,
            Identity::Tool => &mut b.tool,
            Identity::ToolOffset => &mut b.tool_offset,
            Identity::Setup => &mut b.setup,
        };
        let image = *field;
        *field = image + 1;
        let refused = Err(Denial::Refused(Refusal::Identity { what, image, request: image + 1 }));
        assert_eq!(rig.done(Ask::Check(wrong)), refused);
        assert_eq!(rig.done(Ask::Arm(wrong)), refused);
        assert_eq!(rig.mode(), Mode::Bypass);
    }
    // Nothing of this has spent the part.
    rig.done(Ask::Check(good)).unwrap();
    rig.done(Ask::Check(good)).unwrap();
    rig.done(Ask::Arm(good)).unwrap();
}

#[test]
fn without_an_image_nothing_is_armed_and_setpoints_pass_unchanged() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.enable();
    rig.done(Ask::Deactivate).unwrap();
    assert_eq!(rig.status().active, None);
    assert_eq!(rig.arm(1), Err(Denial::Refused(Refusal::NoImage)));
    for i in 0..50 {
        let out = rig.send(i * FEED, 0, PASS).unwrap();
        assert!(out.forward && out.axes == rig.setpoint.axes);
    }
    rig.reset(truepath_core::link::ResetCause::PowerOn);
    assert_eq!(rig.status().active, None);
}

#[test]
fn an_upload_in_bypass_disturbs_neither_the_setpoints_nor_the_image_in_use() {
    let (one, other) = (image_of(straight()), image_of(wire_support::straight(10)));
    let mut rig = Rig::with_image(&one);
    rig.enable();
    let mut offset = rig.begin(&other).unwrap();
    while (offset as usize) < other.len() {
        let out = rig.send(i64::from(offset), 0, PASS).unwrap();
        assert!(out.forward && out.axes == rig.setpoint.axes);
        let end = other.len().min(offset as usize + 500);
        offset = rig.chunk(offset, &other[offset as usize..end]).unwrap();
    }
    assert_eq!(rig.commit(), Ok((1, name(&other))));
    assert_eq!(rig.status().active, Some(ActiveImage { slot: 0, crc: name(&one) }));
    assert!(matches!(rig.slots(), [Slot::Image { active: true, .. }, Slot::Image { active: false, .. }]));
    rig.arm(1).unwrap();
}
