//! One of each: every request, reply and denial, with the number that `docs/link.md` gives it. The lists cannot fall
//! behind: a new variant does not compile before it is named here.

use truepath_wire::image::{Binding, DeviceClass, ImageError, KeyId, KeyRing, PublicKey, Rights, Role, SignatureError};
use truepath_wire::link::{
    AccessError, ActiveImage, Ask, Change, ComputeFailure, Counters, Denial, DeviceKeys, DeviceSession, DeviceSetting,
    DeviceSettings, DeviceSettingsError, DeviceStatus, Firmware, Hello, Item, LogEntry, Progress, Reply, ResetCause,
    Slot, Spread, Stage, Timing, TraceSample, UpdateStage, UpdateStatus,
};
use truepath_wire::rewrite::{ArmRequest, AxisMap, Frame, Identity, Mode, Place, Reason, Refusal, Status};
use truepath_wire::update::{Label, UpdateError};

pub const BINDING: Binding =
    Binding { program_crc: 0xcbf4_3926, feature: 1, pass: 2, tool: 4, tool_offset: 40, setup: 300 };

pub fn arm_request() -> ArmRequest {
    let axes = [(0, false), (2, true), (1, false)].map(|(axis, reversed)| AxisMap { axis, reversed });
    // 3-4-5: cosine 0.8, sine −0.6.
    let offset_nm = [125_000_000, -1, -4_000_000_000];
    let frame = Frame { offset_nm, cosine: 858_993_459, sine: -644_245_094, axes, crc: 0 }.sealed();
    ArmRequest { binding: BINDING, part_serial: 1_000_001, frame }
}

/// Every request with its name.
pub fn asks() -> Vec<(&'static str, Ask<'static>)> {
    let all = [
        Ask::Hello,
        Ask::Status,
        Ask::AcknowledgeDrivesDisabled,
        Ask::Check(arm_request()),
        Ask::Arm(arm_request()),
        Ask::Disarm,
        Ask::Begin { item: Item::Job, length: 1_000, crc: 0x1234_5678 },
        Ask::Chunk { offset: 512, bytes: &[1, 0, 0, 255, 4] },
        Ask::Commit,
        Ask::List,
        Ask::Activate { slot: 1, crc: 0x89ab_cdef },
        Ask::Deactivate,
        Ask::Settings,
        Ask::Configure(DeviceSettings::at_1_khz()),
        Ask::ClearCounters,
        Ask::Trace,
        Ask::Recording { from: 128 },
        Ask::ReleaseRecording,
        Ask::Compute,
        Ask::Progress,
        Ask::Restart { watchdog: true },
        Ask::Keys,
        Ask::Provision(PublicKey([7; 32])),
        Ask::Revoke(KeyId([7; 8])),
        Ask::Log { from: 300 },
        Ask::Time { unix_s: 1_700_000_000 },
        Ask::Challenge,
        Ask::Login { key: KeyId([7; 8]), role: Role::Operate, signature: [[1; 32], [2; 32]] },
        Ask::Logout,
        Ask::Session,
        Ask::ProvisionAs {
            key: PublicKey([7; 32]),
            rights: Rights { role: Role::Operate, signs: false, firmware: false },
        },
        Ask::Timing,
        Ask::Update,
        Ask::Install,
        Ask::Confirm,
        Ask::ProvisionFirmware {
            key: PublicKey([7; 32]),
            rights: Rights { role: Role::Operate, signs: false, firmware: false },
        },
    ];
    all.into_iter().map(|ask| (ask_name(&ask), ask)).collect()
}

fn ask_name(ask: &Ask<'_>) -> &'static str {
    match ask {
        Ask::Hello => "Hello",
        Ask::Status => "Status",
        Ask::AcknowledgeDrivesDisabled => "AcknowledgeDrivesDisabled",
        Ask::Check(_) => "Check",
        Ask::Arm(_) => "Arm",
        Ask::Disarm => "Disarm",
        Ask::Begin { .. } => "Begin",
        Ask::Chunk { .. } => "Chunk",
        Ask::Commit => "Commit",
        Ask::List => "List",
        Ask::Activate { .. } => "Activate",
        Ask::Deactivate => "Deactivate",
        Ask::Settings => "Settings",
        Ask::Configure(_) => "Configure",
        Ask::ClearCounters => "ClearCounters",
        Ask::Trace => "Trace",
        Ask::Recording { .. } => "Recording",
        Ask::ReleaseRecording => "ReleaseRecording",
        Ask::Compute => "Compute",
        Ask::Progress => "Progress",
        Ask::Restart { .. } => "Restart",
        Ask::Keys => "Keys",
        Ask::Provision(_) => "Provision",
        Ask::Revoke(_) => "Revoke",
        Ask::Log { .. } => "Log",
        Ask::Time { .. } => "Time",
        Ask::Challenge => "Challenge",
        Ask::Login { .. } => "Login",
        Ask::Logout => "Logout",
        Ask::Session => "Session",
        Ask::ProvisionAs { .. } => "ProvisionAs",
        Ask::Timing => "Timing",
        Ask::Update => "Update",
        Ask::Install => "Install",
        Ask::Confirm => "Confirm",
        Ask::ProvisionFirmware { .. } => "ProvisionFirmware",
    }
}

pub fn hello() -> Hello<'static> {
    Hello {
        link_version: 1,
        semantics: 1,
        image_format: 1,
        board: "virtual",
        firmware: "0.1.0",
        axes: 3,
        most_nodes: 12_000,
        slot_bytes: 393_152,
        program_bytes: 524_288,
        job_bytes: 4_096,
        probe_bytes: 65_536,
        boots: 7,
        last_reset: ResetCause::Watchdog,
    }
}

pub fn counters() -> Counters {
    let mut faults = [0; Reason::FAULTS];
    faults[15] = 300;
    Counters {
        accepted: 1_000_000,
        answered: 999_998,
        damaged: 3,
        repeated: 4,
        out_of_order: 5,
        lost: 6,
        jumps: 7,
        late: 2,
        silences: 1,
        faults,
        messages: 80,
        messages_damaged: 9,
    }
}

pub fn status() -> DeviceStatus {
    DeviceStatus {
        mode: Mode::Hold,
        reason: Reason::JointLimit,
        drive_enable: true,
        active: Some(ActiveImage { slot: 1, crc: 0x89ab_cdef }),
        recording_frozen: false,
        counters: counters(),
        uptime_us: 5_000_000_000,
    }
}

pub fn keys() -> DeviceKeys {
    DeviceKeys { class: DeviceClass::Board, present: false, keys: KeyRing::default() }
}

pub fn session() -> DeviceSession {
    let operator = Rights { role: Role::Operate, signs: false, firmware: false };
    let rights = [Rights::default(), operator, Rights::default(), Rights::default()];
    DeviceSession { open: false, role: Role::Operate, key: Some(KeyId([7; 8])), refused: 3, rights }
}

pub fn log_entry() -> LogEntry {
    LogEntry {
        sequence: 301,
        boots: 7,
        uptime_us: 90_000_000,
        host_s: Some(1_700_000_000),
        by: None,
        change: Change::Activated,
        key: Some(KeyId([7; 8])),
        value: 0x89ab_cdef,
        refused: 2,
        counter: 17,
    }
}

pub fn sample() -> TraceSample {
    TraceSample {
        sequence: 70_000,
        mode: Mode::Active,
        reason: Reason::None,
        status: Status(0x0103),
        place: Place { node: 99, fraction: 1 << 29 },
        correction_nm: [-24_000, 90_000],
        feed_ratio: 65_536,
    }
}

pub fn timing() -> Timing {
    let spread =
        |mean_ns| Spread { count: 70_000, mean_ns, deviation_ns: 2_500, least_ns: -90_000, greatest_ns: 1_200_000 };
    Timing {
        period_ns: 1_000_000,
        arrivals: spread(-40),
        early: [9, 8, 7, 6, 5, 4, 3, 0, 0, 0, 0],
        late: [60_000, 500, 400, 300, 200, 100, 0, 0, 0, 0, 1],
        answers: spread(8_100),
        taken: [0, 0, 3, 69_000, 900, 0, 0, 0, 0, 0, 0],
        missed: 4_000,
    }
}

pub fn update() -> UpdateStatus {
    let key = KeyId([7; 8]);
    let version = Label::of("0.2.0").unwrap();
    let running = Firmware { version, name: 0x89ab_cdef, counter: 1_700_000_000, key };
    let signs = [true, false, false, false];
    UpdateStatus { stage: UpdateStage::Trial, most: 655_168, running: Some(running), least: 1_600_000_000, signs }
}

/// Every reply with its name.
pub fn replies() -> Vec<(&'static str, Reply<'static>)> {
    let failure = ComputeFailure { stage: Stage::Probe, code: 12, line: 40, column: 3 };
    let image = Slot::Image { length: 3_524, crc: 0x89ab_cdef, generation: 5, active: true, binding: BINDING };
    let all = [
        Reply::Done,
        Reply::Hello(hello()),
        Reply::Status(status()),
        Reply::Next { offset: 1_024 },
        Reply::Committed { slot: 1, crc: 0x89ab_cdef },
        Reply::Slots([image, Slot::Partial { length: 9_000, crc: 77, written: 1_024 }]),
        Reply::Settings(DeviceSettings::at_1_khz()),
        Reply::Trace { dropped: 3, samples: [sample(), TraceSample::default()].into_iter().collect() },
        Reply::Recording { total: 200, from: 10, bytes: &[0x53, 1, 3, 0] },
        Reply::Progress(Progress { stage: Stage::Ended, permille: 1_000, result: Some(Err(failure)) }),
        Reply::Keys(keys()),
        Reply::Log { next: 302, entries: [log_entry()].into_iter().collect() },
        Reply::Challenge { device: [5; 12], nonce: [6; 32], random: true },
        Reply::LoggedIn { session: 0x0123_4567_89ab_cdef },
        Reply::Session(session()),
        Reply::Timing(timing()),
        Reply::Update(update()),
    ];
    all.into_iter().map(|reply| (reply_name(&reply), reply)).collect()
}

fn reply_name(reply: &Reply<'_>) -> &'static str {
    match reply {
        Reply::Done => "Done",
        Reply::Hello(_) => "Hello",
        Reply::Status(_) => "Status",
        Reply::Next { .. } => "Next",
        Reply::Committed { .. } => "Committed",
        Reply::Slots(_) => "Slots",
        Reply::Settings(_) => "Settings",
        Reply::Trace { .. } => "Trace",
        Reply::Recording { .. } => "Recording",
        Reply::Progress(_) => "Progress",
        Reply::Keys(_) => "Keys",
        Reply::Log { .. } => "Log",
        Reply::Challenge { .. } => "Challenge",
        Reply::LoggedIn { .. } => "LoggedIn",
        Reply::Session(_) => "Session",
        Reply::Timing(_) => "Timing",
        Reply::Update(_) => "Update",
    }
}

/// Every denial with its name.
pub fn denials() -> Vec<(&'static str, Denial)> {
    let range = DeviceSettingsError::Range { setting: DeviceSetting::Silence, value: 1, low: 501, high: 10_000_000 };
    let all = [
        Denial::Mode(Mode::Active),
        Denial::Refused(Refusal::Identity { what: Identity::Tool, image: 4, request: 5 }),
        Denial::Image(ImageError::Checksum { stored: 1, computed: 2 }),
        Denial::Settings(range),
        Denial::Unknown,
        Denial::Busy,
        Denial::NoUpload,
        Denial::TooLong { item: Item::Image, length: 400_000, most: 393_152 },
        Denial::Offset { expected: 1_024, found: 2_048, bytes: 1_024 },
        Denial::Incomplete { length: 9_000, written: 1_024 },
        Denial::Checksum { expected: 1, found: 2 },
        Denial::NoImage { slot: 1 },
        Denial::OtherImage { slot: 0, expected: 3, found: 4 },
        Denial::Missing(Item::Probe),
        Denial::NoRecording { total: 0 },
        Denial::Flash { address: 0x4_0000 },
        Denial::NotConfigured,
        Denial::Untrusted(SignatureError::UnknownKey { key: KeyId([1; 8]) }),
        Denial::NotPresent,
        Denial::KeysFull,
        Denial::Access(AccessError::Role { needed: Role::Engineer }),
        Denial::Update(UpdateError::RolledBack { found: 1, least: 2 }),
    ];
    all.into_iter().map(|denial| (denial_name(&denial), denial)).collect()
}

fn denial_name(denial: &Denial) -> &'static str {
    match denial {
        Denial::Mode(_) => "Mode",
        Denial::Refused(_) => "Refused",
        Denial::Image(_) => "Image",
        Denial::Settings(_) => "Settings",
        Denial::Unknown => "Unknown",
        Denial::Busy => "Busy",
        Denial::NoUpload => "NoUpload",
        Denial::TooLong { .. } => "TooLong",
        Denial::Offset { .. } => "Offset",
        Denial::Incomplete { .. } => "Incomplete",
        Denial::Checksum { .. } => "Checksum",
        Denial::NoImage { .. } => "NoImage",
        Denial::OtherImage { .. } => "OtherImage",
        Denial::Missing(_) => "Missing",
        Denial::NoRecording { .. } => "NoRecording",
        Denial::Flash { .. } => "Flash",
        Denial::NotConfigured => "NotConfigured",
        Denial::Untrusted(_) => "Untrusted",
        Denial::NotPresent => "NotPresent",
        Denial::KeysFull => "KeysFull",
        Denial::Access(_) => "Access",
        Denial::Update(_) => "Update",
    }
}
