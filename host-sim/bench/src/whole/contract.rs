//! What a device promises on its configuration link, judged from requests and answers alone.

use truepath_core::image::{KeyId, Rights, Role};
use truepath_core::link::{
    ActiveImage, Ask, Denial, DeviceSettings, Item, Reply, Request, SESSION_SILENCE_US, UpdateStage,
};

use super::broken::{Kept, Promise, keep};
use super::things::{KEYS, RIGHTS, Things};

/// What is known of a device.
#[derive(Clone, Debug)]
pub(super) struct Contract {
    /// It has, or had, a key.
    closed: bool,
    /// What keys are good for that are trusted, or may be.
    trusted: [Option<Rights>; KEYS],
    session: Option<Session>,
    /// Image whose upload was begun last, by its name.
    begun: Option<u32>,
    /// An update was begun: its slots are those of the images.
    updated: bool,
    /// Name of the image in use.
    active: Option<u32>,
    /// Newest counter of either pass that was in use.
    newest: [u32; 2],
    settings: DeviceSettings,
    /// Settings that were asked for, without the flash having said that it has them.
    unsure: Vec<DeviceSettings>,
    /// After a reset, until it has told its settings: any of those that are unsure may count.
    unsettled: bool,
    /// The flash has failed since the last reset, or it swaps programs: what is remembered may be either.
    shaken: bool,
}

#[derive(Clone, Copy, Debug)]
struct Session {
    number: u64,
    key: KeyId,
    role: Role,
    at_us: u64,
}

impl Contract {
    /// Of a device as it leaves the factory.
    pub const fn new() -> Self {
        Self {
            closed: false,
            trusted: [None; KEYS],
            session: None,
            begun: None,
            updated: false,
            active: None,
            newest: [0; 2],
            settings: DeviceSettings::at_1_khz(),
            unsure: vec![],
            unsettled: false,
            shaken: false,
        }
    }
    /// Of one that was configured, has an image in use and so many of the keys.
    pub fn begins(&mut self, things: &Things, settings: DeviceSettings, active: u32, keys: usize) {
        (self.settings, self.active, self.closed) = (settings, Some(active), keys > 0);
        for (trusted, rights) in self.trusted.iter_mut().zip(RIGHTS).take(keys) {
            *trusted = Some(rights);
        }
        self.used(things, active);
    }
    pub const fn settings(&self) -> &DeviceSettings {
        &self.settings
    }
    /// The power may fail, or has failed.
    pub const fn shake(&mut self) {
        self.shaken = true;
    }

    /// The answer to a request at a time. A request that repeats the one before, and is answered as that was, is none.
    pub fn answered(
        &mut self,
        things: &Things,
        (request, session): &(Request<'_>, Option<u64>),
        answer: &Result<Reply<'_>, Denial>,
        now_us: u64,
    ) -> Kept {
        let ask = &request.ask;
        self.permitted(ask, *session, answer.is_ok(), now_us)?;
        if let Err(Denial::Flash { .. }) = answer {
            self.failed(things, ask);
        }
        let Ok(reply) = answer else { return Ok(()) };
        match (ask, reply) {
            (Ask::Begin { item: Item::Image, crc, .. }, _) => self.begun = Some(*crc),
            (Ask::Begin { item: Item::Firmware, .. }, _) => self.updated = true,
            (Ask::Commit, Reply::Committed { crc, .. }) if self.begun == Some(*crc) => {
                self.admitted(things, *crc, "committed")?;
            }
            (Ask::Activate { crc, .. }, _) => {
                self.admitted(things, *crc, "activated")?;
                self.active = Some(*crc);
                self.used(things, *crc);
            }
            (Ask::Deactivate, _) => self.active = None,
            (Ask::Arm(_), _) if self.closed => {
                if let Some(crc) = self.active {
                    self.admitted(things, crc, "armed")?;
                }
            }
            (Ask::Configure(settings), _) => {
                self.settings = *settings;
                self.unsure.clear();
            }
            (Ask::Settings, Reply::Settings(found)) => {
                let may = *found == self.settings || self.unsettled && self.unsure.contains(found);
                keep(may, Promise::Settings, || format!("{found:?} and not {:?}", self.settings))?;
            }
            (Ask::Provision(_) | Ask::ProvisionAs { .. } | Ask::ProvisionFirmware { .. }, _) => {
                self.closed = true;
                self.trust(things, ask);
            }
            (Ask::Revoke(key), _) => {
                if let Some(key) = things.key(*key) {
                    self.trusted[key] = None;
                }
                self.session = self.session.filter(|session| session.key != *key);
            }
            (Ask::Login { key, role, .. }, Reply::LoggedIn { session }) => {
                let most = things.key(*key).and_then(|key| self.trusted[key]).map(|rights| rights.role);
                keep(most.is_some_and(|most| *role <= most), Promise::Role, || {
                    format!("a login as {role} with a key that may {most:?}")
                })?;
                self.session = Some(Session { number: *session, key: *key, role: *role, at_us: now_us });
            }
            (Ask::Logout, _) if session.is_some() => self.session = None,
            (Ask::Update, Reply::Update(status)) => {
                self.shaken |= !matches!(status.stage, UpdateStage::NoLoader | UpdateStage::Settled);
            }
            (Ask::Install | Ask::Confirm, _) => self.shaken = true,
            _ => {}
        }
        Ok(())
    }

    /// Whoever asks has the role for what was carried out.
    fn permitted(&mut self, ask: &Ask<'_>, number: Option<u64>, done: bool, now_us: u64) -> Kept {
        self.session = self.session.filter(|session| now_us.saturating_sub(session.at_us) <= SESSION_SILENCE_US);
        let of = self.session.as_mut().filter(|session| number == Some(session.number));
        let role = of.map_or(Role::Read, |session| {
            session.at_us = now_us;
            session.role
        });
        let needed = needed(ask);
        keep(!done || !self.closed || role >= needed, Promise::Role, || {
            format!("{ask:?} needs {needed}, and was done for {role}")
        })?;
        keep(!done || number.is_none() || self.session.is_some(), Promise::Role, || {
            format!("{ask:?} was done for a session that is none")
        })
    }

    /// What may have happened when the flash failed under a request.
    fn failed(&mut self, things: &Things, ask: &Ask<'_>) {
        self.shaken = true;
        match ask {
            Ask::Configure(settings) => self.unsure.push(*settings),
            _ => self.trust(things, ask),
        }
    }

    /// The key of a request is trusted from now on, or may be.
    fn trust(&mut self, things: &Things, ask: &Ask<'_>) {
        let (key, rights) = match *ask {
            Ask::Provision(key) => (key, Rights::default()),
            Ask::ProvisionAs { key, rights } | Ask::ProvisionFirmware { key, rights } => (key, rights),
            _ => return,
        };
        if let Some(key) = things.key(key.id()) {
            let before = self.trusted[key].unwrap_or(rights);
            let (role, signs) = (before.role.max(rights.role), before.signs || rights.signs);
            self.trusted[key] = Some(Rights { role, signs, ..rights });
        }
    }

    /// An image may be used here.
    fn admitted(&self, things: &Things, crc: u32, what: &str) -> Kept {
        let Some(known) = things.named(crc).map(|known| &things.images[known]) else { return Ok(()) };
        if !self.closed {
            return Ok(());
        }
        let signer = known.signed.filter(|&(key, _)| self.trusted[key].is_some_and(|rights| rights.signs));
        keep(signer.is_some(), Promise::Trust, || format!("{what}: an image signed by {:?}", known.signed))?;
        let (newest, counter) = (self.newest[usize::from(known.other)], signer.map_or(0, |(_, counter)| counter));
        keep(counter >= newest, Promise::Older, || format!("{what}: counter {counter}, {newest} was in use"))
    }
    fn used(&mut self, things: &Things, crc: u32) {
        if let Some(known) = things.named(crc).map(|known| &things.images[known])
            && let (true, Some((_, counter))) = (self.closed, known.signed)
        {
            let newest = &mut self.newest[usize::from(known.other)];
            *newest = counter.max(*newest);
        }
    }

    /// The image in use, as `Status` tells it.
    pub fn in_use(&mut self, things: &Things, found: Option<ActiveImage>) -> Kept {
        if let Some(found) = found {
            self.admitted(things, found.crc, "in use")?;
            keep(self.shaken || self.active == Some(found.crc), Promise::Image, || {
                format!("{:08x} is in use, and not {:08x?}", found.crc, self.active)
            })?;
            self.used(things, found.crc);
        } else if let Some(active) = self.active {
            // One that is not trusted any more is in use no more, and neither is one whose slot belongs to an update.
            let lost = self.shaken || self.updated || self.admitted(things, active, "").is_err();
            keep(lost, Promise::Image, || format!("{active:08x} is in use no more"))?;
        }
        self.active = found.map(|found| found.crc);
        Ok(())
    }

    /// A reset; what it tells of its settings goes to [`Contract::settled`].
    pub const fn reset(&mut self) {
        (self.session, self.unsettled) = (None, true);
    }
    /// Which settings count from a reset on, by what it tells; says whether they are others than before.
    pub fn settled(&mut self, found: &DeviceSettings) -> bool {
        let other = *found != self.settings && self.unsure.contains(found);
        if other {
            self.settings = *found;
        }
        self.unsure.clear();
        self.unsettled = false;
        other
    }
    /// What the last reset could leave either way is known.
    pub const fn steady(&mut self) {
        self.shaken = false;
    }
}

/// The least role of a request, by the table of `docs/link.md`. Every request is named: a new one has to be judged.
const fn needed(ask: &Ask<'_>) -> Role {
    match ask {
        Ask::AcknowledgeDrivesDisabled
        | Ask::Arm(_)
        | Ask::Disarm
        | Ask::ClearCounters
        | Ask::ReleaseRecording
        | Ask::Restart { .. }
        | Ask::Time { .. } => Role::Operate,
        Ask::Begin { .. }
        | Ask::Chunk { .. }
        | Ask::Commit
        | Ask::Activate { .. }
        | Ask::Deactivate
        | Ask::Configure(_)
        | Ask::Compute
        | Ask::Install
        | Ask::Confirm => Role::Engineer,
        Ask::Hello
        | Ask::Status
        | Ask::Check(_)
        | Ask::List
        | Ask::Settings
        | Ask::Trace
        | Ask::Recording { .. }
        | Ask::Progress
        | Ask::Keys
        | Ask::Provision(_)
        | Ask::ProvisionAs { .. }
        | Ask::Revoke(_)
        | Ask::Log { .. }
        | Ask::Challenge
        | Ask::Login { .. }
        | Ask::Logout
        | Ask::Session
        | Ask::Timing
        | Ask::Update
        | Ask::ProvisionFirmware { .. } => Role::Read,
    }
}
