//! Requests and replies of the configuration link, in postcard.
//!
//! The order of the variants is the number on the wire; new ones go to the end. What each does, and in which modes it
//! is taken, stands in `docs/link.md`. Byte slices are borrowed from the frame they came in.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::access::{DEVICE_ID_BYTES, DeviceSession, NONCE_BYTES};
use super::denial::Denial;
use super::device::{DeviceKeys, DeviceStatus, Hello, Item, Progress, Slot};
use super::log::{LOG_ENTRIES, LogEntry};
use super::settings::DeviceSettings;
use super::timing::Timing;
use super::trace::{TRACE_SAMPLES, TraceSample};
use super::update::UpdateStatus;
use crate::image::{KeyId, PublicKey, Rights, Role};
use crate::rewrite::ArmRequest;

/// Most bytes of a message with its CRC-32, before COBS.
pub const MESSAGE_BYTES: usize = 1_280;
/// Most bytes of a message on the wire: with COBS and the 0x00 at its end.
pub const PACKET_BYTES: usize = cobs::max_encoding_length(MESSAGE_BYTES).saturating_add(1);
/// Most bytes of an item in one [`Ask::Chunk`], and of frames in one [`Reply::Recording`].
pub const CHUNK_BYTES: usize = 1_024;

/// What a client sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Request<'a> {
    /// Chosen by the client; the response carries it.
    pub id: u16,
    /// The request.
    #[serde(borrow)]
    pub ask: Ask<'a>,
}

/// What the device answers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Response<'a> {
    /// That of the request.
    pub id: u16,
    /// What became of it.
    #[serde(borrow)]
    pub answer: Result<Reply<'a>, Denial>,
}

/// The requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ask<'a> {
    /// Who is there.
    Hello,
    /// Mode, reason, counters, active image.
    Status,
    /// The controller has disabled the drives.
    AcknowledgeDrivesDisabled,
    /// What `Arm` would say.
    Check(ArmRequest),
    /// Arms the active image for one pass of one part.
    Arm(ArmRequest),
    /// Ends the arming.
    Disarm,
    /// Begins or resumes an upload.
    Begin {
        /// What is sent.
        item: Item,
        /// Its bytes in all.
        length: u32,
        /// CRC-32 of all of them.
        crc: u32,
    },
    /// A piece of the upload.
    Chunk {
        /// Where it goes; that named by [`Reply::Next`].
        offset: u32,
        /// At most [`CHUNK_BYTES`].
        bytes: &'a [u8],
    },
    /// The upload is complete: check and keep it.
    Commit,
    /// Both image slots.
    List,
    /// Makes the image of a slot the active one.
    Activate {
        /// 0 or 1.
        slot: u8,
        /// Checksum of the image that is meant.
        crc: u32,
    },
    /// No image is active any more.
    Deactivate,
    /// The settings in use.
    Settings,
    /// Other settings.
    Configure(DeviceSettings),
    /// Sets the counters to zero.
    ClearCounters,
    /// Samples since the last time.
    Trace,
    /// Frames before the last fault.
    Recording {
        /// Number of the first one wanted; 0 is the oldest.
        from: u32,
    },
    /// Lets the recorder run again.
    ReleaseRecording,
    /// Makes an image on the device.
    Compute,
    /// How far `Compute` is.
    Progress,
    /// Resets the device.
    Restart {
        /// By letting the watchdog run out.
        watchdog: bool,
    },
    /// The keys whose signatures the device trusts.
    Keys,
    /// Trusts one more key, until it is revoked.
    Provision(PublicKey),
    /// Trusts a key no more, for ever.
    Revoke(KeyId),
    /// Entries of the log of changes.
    Log {
        /// Number of the first one wanted; older ones than are kept are passed over.
        from: u32,
    },
    /// Tells the device the time, for its log.
    Time {
        /// Seconds since 1970.
        unix_s: u32,
    },
    /// What is to be signed to log in.
    Challenge,
    /// Answers the challenge; whoever was logged in is not any more.
    Login {
        /// Number of the key.
        key: KeyId,
        /// The role that is wanted.
        role: Role,
        /// Ed25519 signature of [`login_message`](super::login_message), in two halves.
        signature: [[u8; 32]; 2],
    },
    /// Ends the session.
    Logout,
    /// Who is logged in, and what the keys are good for.
    Session,
    /// As `Provision`, with these rights.
    ProvisionAs {
        /// The key.
        key: PublicKey,
        /// What it is good for.
        rights: Rights,
    },
    /// How regularly setpoints arrive and how fast they are answered.
    Timing,
    /// The program that runs, and where an update of it stands.
    Update,
    /// Has the loader start the program that was uploaded, at the next reset.
    Install,
    /// Keeps the program that is on trial.
    Confirm,
    /// As `ProvisionAs`; firmware that the key signs is taken as well.
    ProvisionFirmware {
        /// The key.
        key: PublicKey,
        /// What else it is good for.
        rights: Rights,
    },
}

impl Ask<'_> {
    /// The least role that may ask it. `Provision` and `Revoke` need somebody at the device instead, who needs no key.
    pub const fn least(&self) -> Role {
        match self {
            Self::Hello
            | Self::Status
            | Self::Check(_)
            | Self::List
            | Self::Settings
            | Self::Trace
            | Self::Recording { .. }
            | Self::Progress
            | Self::Keys
            | Self::Provision(_)
            | Self::ProvisionAs { .. }
            | Self::Revoke(_)
            | Self::Log { .. }
            | Self::Challenge
            | Self::Login { .. }
            | Self::Logout
            | Self::Session
            | Self::Timing
            | Self::Update
            | Self::ProvisionFirmware { .. } => Role::Read,
            Self::AcknowledgeDrivesDisabled
            | Self::Arm(_)
            | Self::Disarm
            | Self::ClearCounters
            | Self::ReleaseRecording
            | Self::Restart { .. }
            | Self::Time { .. } => Role::Operate,
            Self::Begin { .. }
            | Self::Chunk { .. }
            | Self::Commit
            | Self::Activate { .. }
            | Self::Deactivate
            | Self::Configure(_)
            | Self::Compute
            | Self::Install
            | Self::Confirm => Role::Engineer,
        }
    }
}

/// The replies.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reply<'a> {
    /// Carried out.
    Done,
    /// To `Hello`.
    #[serde(borrow)]
    Hello(Hello<'a>),
    /// To `Status`.
    Status(DeviceStatus),
    /// Where the next chunk goes; the length when the upload is complete.
    Next {
        /// Bytes from the start of the item.
        offset: u32,
    },
    /// The item is complete and undamaged. An image also has its commit word.
    Committed {
        /// Slot of the image; 0 for the other items.
        slot: u8,
        /// CRC-32 of the item; of an image the one at its end, its name.
        crc: u32,
    },
    /// To `List`.
    Slots([Slot; 2]),
    /// To `Settings`.
    Settings(DeviceSettings),
    /// To `Trace`.
    Trace {
        /// Samples lost since the last time because nobody asked.
        dropped: u32,
        /// Oldest first.
        samples: Vec<TraceSample, TRACE_SAMPLES>,
    },
    /// To `Recording`.
    Recording {
        /// Frames recorded.
        total: u32,
        /// Number of the first one here.
        from: u32,
        /// Whole raw frames, at most [`CHUNK_BYTES`].
        bytes: &'a [u8],
    },
    /// To `Progress`.
    Progress(Progress),
    /// To `Keys`.
    Keys(DeviceKeys),
    /// To `Log`.
    Log {
        /// Number of the next entry.
        next: u32,
        /// Oldest first; empty behind the newest one that is in the flash.
        entries: Vec<LogEntry, LOG_ENTRIES>,
    },
    /// To `Challenge`.
    Challenge {
        /// Number of the device, zeros where it has none.
        device: [u8; DEVICE_ID_BYTES],
        /// Never twice the same on this device.
        nonce: [u8; NONCE_BYTES],
        /// Whether nobody can know it before: it comes from a random number generator.
        random: bool,
    },
    /// To `Login`.
    LoggedIn {
        /// Number of the session, to stand behind each request.
        session: u64,
    },
    /// To `Session`.
    Session(DeviceSession),
    /// To `Timing`.
    Timing(Timing),
    /// To `Update`.
    Update(UpdateStatus),
}
