//! `truepath hil --trust`: what a device with a key has to refuse, tried over its configuration link.
//!
//! The keys are made for this run. A real board is left with them, all revoked: it takes no image any more.

use std::time::Duration;

use serde::Serialize;
use truepath_bench::{Access, BenchError, Board, Client, Wire, restart};
use truepath_core::checksum::crc32;
use truepath_core::image::{
    DeviceClass, DeviceClasses, ImageError, KeyId, Rights, Role, SIGNATURE_BYTES, SignatureError,
};
use truepath_core::link::{
    AccessError, Ask, CHUNK_BYTES, Denial, Item, MOST_TRIES, PACKET_BYTES, Reply, Request, Response, SessionEnd, Slot,
    decode, encode_request,
};
use truepath_ground::diagnostics::Failure;
use truepath_job::signing::Signer;

/// What was tried.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Attempt {
    /// What the device was given.
    pub given: &'static str,
    /// What it said; nothing when it took it.
    pub refused: Option<String>,
}

/// What came of it: everything was as it has to be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TrustReport {
    /// What board it was.
    pub board: String,
    /// What was tried, in its order.
    pub attempts: Vec<Attempt>,
}

impl TrustReport {
    /// What a person reads.
    pub fn words(&self) -> String {
        let line = |attempt: &Attempt| {
            let said = attempt.refused.as_ref().map_or_else(|| "taken".to_owned(), |why| format!("refused: {why}"));
            format!("{:<44} {said}\n", attempt.given)
        };
        format!("{}\n", self.board) + &self.attempts.iter().map(line).collect::<String>()
    }
}

/// Key of the shop, of a second one, of a stranger, and of an operator.
const SEEDS: [[u8; 32]; 4] = [[0x51; 32], [0x52; 32], [0x53; 32], [0x54; 32]];
/// Time for the answer to a replayed packet.
const PATIENCE: Duration = Duration::from_secs(10);
/// Where the number of the key lies, from the end.
const KEY_FROM_END: usize = SIGNATURE_BYTES - 8 + 4;

/// Tries everything on a board whose button is held, with an image that is not signed.
///
/// # Errors
/// The device took something, refused something, or refused it for another reason than it has to; the board has a key.
pub fn run(board: &mut dyn Board, image: &[u8]) -> Result<TrustReport, Failure> {
    let [shop, second, stranger, operator] = SEEDS.map(|seed| Signer::of_seed(&seed));
    let signed = |by: &Signer, counter, classes| {
        let mut by = by.clone();
        (by.counter, by.classes) = (counter, classes);
        by.signed(image)
    };
    let (all, key) = (DeviceClasses::ALL, shop.public().id());
    let [old, new] = [signed(&shop, 100, all)?, signed(&shop, 200, all)?];
    let by_stranger = signed(&stranger, 300, all)?;
    let elsewhere = DeviceClasses::of(&[DeviceClass::LinuxCnc]).unwrap_or(all);
    let first_id = board.first_id();
    let class = board.client().keys()?.class;
    let mut tried = Tried::of(board);

    if !tried.board.client().keys()?.keys.is_open() {
        let (found, help) = ("the device has a key already".to_owned(), "try it on one that is open".to_owned());
        return Err(BenchError::Option { found, help }.into());
    }
    tried.upload("not signed, no key: open", image, Ok(()))?;
    tried.ask("first key", Ask::Provision(shop.public()), Ok(()))?;
    tried.in_use("in use while it was open", None)?;
    tried.roles(&shop, &operator, &stranger)?;
    tried.board.use_access(Some(access(&shop)));
    tried.upload("not signed", image, untrusted(SignatureError::Missing))?;
    let unknown = SignatureError::UnknownKey { key: stranger.public().id() };
    tried.upload("signed by a stranger", &by_stranger, untrusted(unknown))?;
    let forged = untrusted(SignatureError::Forged { key });
    tried.upload("signed by a stranger in the name of the key", &renamed(by_stranger, key), forged)?;
    tried.upload("changed behind the signature", &changed(&new), forged)?;
    let other = SignatureError::OtherClass { found: elsewhere, expected: class };
    tried.upload("signed for another class", &signed(&shop, 300, elsewhere)?, untrusted(other))?;
    let cut = &new[..new.len() - 400];
    let short = ImageError::Length { expected: new.len(), found: cut.len() };
    tried.upload("cut off", cut, Err(Denial::Image(short)))?;
    tried.cut_short("committed before its end", &new)?;

    // The packets of an upload, as somebody at the cable could record them.
    let session = tried.board.session();
    let packets = packets(&old, first_id, session)?;
    tried.replay("an upload and its activation", &packets, None)?;
    tried.in_use("the image of that upload", Some(&old))?;
    tried.upload("signed later", &new, Ok(()))?;
    tried.in_use("the later one", Some(&new))?;
    let rolled_back = SignatureError::RolledBack { found: 100, least: 200 };
    tried.activate("the one before, still in its slot", &old, untrusted(rolled_back))?;
    tried.upload("the one before, sent again", &old, untrusted(rolled_back))?;
    tried.replay("the packets of its upload, replayed", &packets, Some(Denial::Untrusted(rolled_back)))?;
    tried.in_use("the later one", Some(&new))?;
    restart(tried.board)?;
    tried.in_use("the later one, behind a reset", Some(&new))?;
    tried.upload("the one before, behind a reset", &old, untrusted(rolled_back))?;
    tried.upload("the one before, signed again", &signed(&shop, 201, all)?, Ok(()))?;

    tried.ask("second key", Ask::Provision(second.public()), Ok(()))?;
    tried.ask("first key revoked", Ask::Revoke(key), Ok(()))?;
    tried.board.use_access(None);
    tried.in_use("signed with the revoked key", None)?;
    let revoked = untrusted(SignatureError::Revoked { key });
    tried.log_in("login with the revoked key", &shop, Role::Read, unknown_key(&shop))?;
    tried.board.use_access(Some(access(&second)));
    tried.upload("signed with the revoked key", &signed(&shop, 400, all)?, revoked)?;
    tried.ask("the revoked key once more", Ask::Provision(shop.public()), revoked)?;
    tried.upload("signed with the second key", &signed(&second, 400, all)?, Ok(()))?;
    tried.ask("second key revoked", Ask::Revoke(second.public().id()), Ok(()))?;
    tried.board.use_access(None);
    tried.upload("not signed, all keys revoked", image, needs(Role::Engineer))?;
    tried.log_in("login with a key, all keys revoked", &second, Role::Read, unknown_key(&second))?;
    tried.in_use("at the end", None)?;
    Ok(tried.report())
}

/// Access with somebody's key.
pub(super) fn access(by: &Signer) -> Access {
    let signer = by.clone();
    Access::new(&by.public(), move |message| signer.sign(message))
}

const fn needs(needed: Role) -> Result<(), Denial> {
    Err(Denial::Access(AccessError::Role { needed }))
}

fn unknown_key(by: &Signer) -> Result<(), Denial> {
    Err(Denial::Access(AccessError::UnknownKey { key: by.public().id() }))
}

const fn untrusted(error: SignatureError) -> Result<(), Denial> {
    Err(Denial::Untrusted(error))
}

/// The board, and what was tried on it.
pub(super) struct Tried<'b> {
    pub board: &'b mut dyn Board,
    attempts: Vec<Attempt>,
}

impl<'b> Tried<'b> {
    pub fn of(board: &'b mut dyn Board) -> Self {
        Self { board, attempts: Vec::new() }
    }
    pub fn report(self) -> TrustReport {
        TrustReport { board: self.board.describe(), attempts: self.attempts }
    }
}

impl Tried<'_> {
    /// Logins that have to be refused, and what a role is not enough for.
    fn roles(&mut self, shop: &Signer, operator: &Signer, stranger: &Signer) -> Result<(), BenchError> {
        let key = shop.public().id();
        let forged = || Err(Denial::Access(AccessError::Forged { key }));
        let only_operates = Rights { role: Role::Operate, signs: false, firmware: false };
        self.ask("key of an operator", Ask::ProvisionAs { key: operator.public(), rights: only_operates }, Ok(()))?;
        let settings = self.board.client().settings()?;
        self.ask("settings without a login", Ask::Configure(settings), needs(Role::Engineer))?;
        self.ask("disarming without a login", Ask::Disarm, needs(Role::Operate))?;

        self.log_in("login by a stranger", stranger, Role::Operate, unknown_key(stranger))?;
        let (device, nonce) = self.challenge()?;
        let Ask::Login { signature, .. } = access(stranger).login(Role::Engineer, &device, &nonce) else {
            return Ok(());
        };
        let ask = Ask::Login { key, role: Role::Engineer, signature };
        self.answer("login by a stranger in the name of the key", ask, forged())?;
        let (device, nonce) = self.challenge()?;
        let Ask::Login { signature, .. } = access(shop).login(Role::Operate, &device, &nonce) else { return Ok(()) };
        let ask = Ask::Login { key, role: Role::Engineer, signature };
        self.answer("answer for another role", ask, forged())?;
        let (mut device, nonce) = self.challenge()?;
        device[0] ^= 1;
        let ask = access(shop).login(Role::Engineer, &device, &nonce);
        self.answer("answer for another device", ask, forged())?;

        let (device, nonce) = self.challenge()?;
        let right = access(shop).login(Role::Engineer, &device, &nonce);
        let session = self.answer("login", right, Ok(()))?;
        let none = Err(Denial::Access(AccessError::NoChallenge));
        self.answer("the same answer again", right, none)?;
        self.challenge()?;
        self.answer("the same answer to a new challenge", right, forged())?;
        let beyond = AccessError::Beyond { key: operator.public().id(), most: Role::Operate };
        self.ask_in(session, "settings by who is logged in", Ask::Configure(settings), Ok(()))?;
        self.ask("settings by a second client", Ask::Configure(settings), needs(Role::Engineer))?;
        // What has failed so far is forgotten with a reset, for which an operator's session is enough.
        self.ask_in(session, "a reset by who is logged in", Ask::Restart { watchdog: false }, Ok(()))?;
        self.awake()?;
        let reset = Err(Denial::Access(AccessError::Ended { why: SessionEnd::Unknown }));
        self.ask_in(session, "the session, behind the reset", Ask::Disarm, reset)?;
        self.log_in("an operator as an engineer", operator, Role::Engineer, Err(Denial::Access(beyond)))?;
        let first = self.log_in("an operator", operator, Role::Operate, Ok(()))?;
        self.ask_in(first, "settings by an operator", Ask::Configure(settings), needs(Role::Engineer))?;
        let second = self.log_in("a second client logs in", shop, Role::Engineer, Ok(()))?;
        let taken = Err(Denial::Access(AccessError::Ended { why: SessionEnd::NewLogin }));
        self.ask_in(first, "the first one asks on", Ask::Disarm, taken)?;

        // One has failed behind the reset already.
        for _ in 1..MOST_TRIES {
            self.log_in("login by a stranger, again and again", stranger, Role::Read, unknown_key(stranger))?;
        }
        let (device, nonce) = self.challenge()?;
        let done = self.board.client().ask(access(shop).login(Role::Read, &device, &nonce)).map(|_| ());
        let Err(BenchError::Denied(Denial::Access(AccessError::TooManyTries { wait_s }))) = done else {
            return Err(BenchError::Differs(format!("too many logins: {done:?}")));
        };
        let many = AccessError::TooManyTries { wait_s };
        self.keep("the right one behind them", done, Err(Denial::Access(many)))?;
        self.ask_in(second, "a reset by the second client", Ask::Restart { watchdog: false }, Ok(()))?;
        self.awake()
    }
    /// Waits until the device answers behind a reset.
    fn awake(&mut self) -> Result<(), BenchError> {
        if !self.board.is_stepped() {
            std::thread::sleep(RESET);
        }
        self.board.client().status().map(|_| ())
    }
    fn challenge(&mut self) -> Result<([u8; 12], [u8; 32]), BenchError> {
        match self.board.client().ask(Ask::Challenge)? {
            Reply::Challenge { device, nonce, .. } => Ok((device, nonce)),
            other => Err(BenchError::Foreign(format!("{other:?}"))),
        }
    }
    /// Gives an answer to a challenge; the number of the session, 0 without one.
    fn answer(&mut self, given: &'static str, ask: Ask<'_>, expected: Result<(), Denial>) -> Result<u64, BenchError> {
        let mut session = 0;
        let done = self.board.client().ask(ask).map(|reply| {
            if let Reply::LoggedIn { session: number } = reply {
                session = number;
            }
        });
        self.keep(given, done, expected).map(|()| session)
    }
    /// The right answer to a challenge, by somebody.
    fn log_in(
        &mut self,
        given: &'static str,
        by: &Signer,
        role: Role,
        expected: Result<(), Denial>,
    ) -> Result<u64, BenchError> {
        let (device, nonce) = self.challenge()?;
        self.answer(given, access(by).login(role, &device, &nonce), expected)
    }
    /// A request of a session.
    fn ask_in(
        &mut self,
        session: u64,
        given: &'static str,
        ask: Ask<'_>,
        expected: Result<(), Denial>,
    ) -> Result<(), BenchError> {
        let id = self.board.first_id();
        let packet = packet(ask, id, Some(session))?;
        let done = answered(self.board.client().wire(), &packet)?;
        self.keep(given, done.map_err(BenchError::Denied), expected)
    }
    /// Keeps what the device did, if it is what it has to do.
    pub fn keep(
        &mut self,
        given: &'static str,
        done: Result<(), BenchError>,
        expected: Result<(), Denial>,
    ) -> Result<(), BenchError> {
        let found = match done {
            Ok(()) => Ok(()),
            Err(BenchError::Denied(denial)) => Err(denial),
            Err(other) => return Err(other),
        };
        if found != expected {
            return Err(BenchError::Differs(format!("{given}: {found:?}, it has to be {expected:?}")));
        }
        self.attempts.push(Attempt { given, refused: found.err().map(|denial| denial.to_string()) });
        Ok(())
    }
    pub fn ask(&mut self, given: &'static str, ask: Ask<'_>, expected: Result<(), Denial>) -> Result<(), BenchError> {
        let done = self.board.client().done(ask);
        self.keep(given, done, expected)
    }
    /// Upload and activation.
    fn upload(&mut self, given: &'static str, image: &[u8], expected: Result<(), Denial>) -> Result<(), BenchError> {
        let done = put_in_use(&mut self.board.client(), image);
        self.keep(given, done, expected)
    }
    /// Activation of an image that is in a slot.
    fn activate(&mut self, given: &'static str, image: &[u8], expected: Result<(), Denial>) -> Result<(), BenchError> {
        let crc = name(image);
        let done = {
            let mut client = self.board.client();
            let there = |slot: &Slot| matches!(slot, Slot::Image { crc: found, .. } if *found == crc);
            let slot = client.slots()?.iter().position(there).unwrap_or(2) as u8;
            client.done(Ask::Activate { slot, crc })
        };
        self.keep(given, done, expected)
    }
    /// An upload that is committed in the middle.
    fn cut_short(&mut self, given: &'static str, image: &[u8]) -> Result<(), BenchError> {
        let length = image.len() as u32;
        let (done, written) = {
            let mut client = self.board.client();
            client.ask(Ask::Begin { item: Item::Image, length, crc: name(image) })?;
            let bytes = &image[..CHUNK_BYTES.min(image.len() / 2)];
            client.ask(Ask::Chunk { offset: 0, bytes })?;
            (client.ask(Ask::Commit).map(|_| ()), bytes.len() as u32)
        };
        self.keep(given, done, Err(Denial::Incomplete { length, written }))
    }
    /// Packets byte for byte; at the end it is in use, or commit and activation were refused.
    fn replay(&mut self, given: &'static str, packets: &[Vec<u8>], refused: Option<Denial>) -> Result<(), BenchError> {
        let mut answers = Vec::new();
        {
            let mut client = self.board.client();
            let wire = client.wire();
            for packet in packets {
                answers.push(answered(wire, packet)?);
            }
        }
        let [.., committed, activated] = &answers[..] else { return Ok(()) };
        let expected = refused.map_or(Ok(()), Err);
        if *committed != expected {
            return Err(BenchError::Differs(format!("{given}: Commit gave {committed:?}, it has to be {expected:?}")));
        }
        // What was refused left no image to be activated.
        let gone = refused.is_some() && matches!(activated, Err(Denial::NoImage { .. } | Denial::OtherImage { .. }));
        let activated = if gone { expected } else { *activated };
        self.keep(given, activated.map_err(BenchError::Denied), expected)
    }
    /// Which image is in use.
    fn in_use(&mut self, what: &'static str, image: Option<&[u8]>) -> Result<(), BenchError> {
        let (found, expected) = (self.board.client().status()?.active.map(|active| active.crc), image.map(name));
        if found == expected {
            Ok(())
        } else {
            Err(BenchError::Differs(format!("{what}: image {found:08x?} is in use, it has to be {expected:08x?}")))
        }
    }
}

fn put_in_use<W: Wire>(client: &mut Client<W>, image: &[u8]) -> Result<(), BenchError> {
    let there = client.upload(Item::Image, image, |_| ())?;
    client.done(Ask::Activate { slot: there.slot, crc: there.crc })
}

/// Sends a packet; what the device says to it.
fn answered(wire: &mut dyn Wire, packet: &[u8]) -> Result<Result<(), Denial>, BenchError> {
    let lost = |e: std::io::Error| BenchError::Silent(e.to_string());
    wire.send(packet).map_err(lost)?;
    let mut bytes = Vec::new();
    while bytes.last() != Some(&0) {
        let arrival = wire.receive(PATIENCE).map_err(lost)?;
        bytes.extend(arrival.ok_or_else(|| BenchError::Silent("a packet".to_owned()))?.bytes);
    }
    let response: Response<'_> = decode(&mut bytes).map_err(|e| BenchError::Foreign(e.to_string()))?;
    Ok(response.answer.map(|_: Reply<'_>| ()))
}

/// Time a board takes for a reset.
const RESET: Duration = Duration::from_millis(500);

fn packet(ask: Ask<'_>, id: u16, session: Option<u64>) -> Result<Vec<u8>, BenchError> {
    let mut packet = [0; PACKET_BYTES];
    let used = encode_request(&Request { id, ask }, session, &mut packet);
    let used = used.map_err(|e| BenchError::Foreign(e.to_string()))?;
    Ok(packet[..used].to_vec())
}

/// The packets of an upload of an image into the first slot, and of its activation.
fn packets(image: &[u8], first_id: u16, session: Option<u64>) -> Result<Vec<Vec<u8>>, BenchError> {
    let crc = name(image);
    let chunks = image.chunks(CHUNK_BYTES).enumerate();
    let chunks = chunks.map(|(k, bytes)| Ask::Chunk { offset: (k * CHUNK_BYTES) as u32, bytes });
    let begin = Ask::Begin { item: Item::Image, length: image.len() as u32, crc };
    let asks = [begin].into_iter().chain(chunks).chain([Ask::Commit, Ask::Activate { slot: 0, crc }]);
    let ids = std::iter::successors(Some(first_id), |id| Some(id.wrapping_add(1)));
    asks.zip(ids).map(|(ask, id)| packet(ask, id, session)).collect()
}

/// The name of an image, whatever its bytes are worth.
fn name(image: &[u8]) -> u32 {
    image.last_chunk().map_or(0, |crc| u32::from_le_bytes(*crc))
}

/// The bytes with a checksum that fits them: what anybody can do.
fn resealed(mut image: Vec<u8>) -> Vec<u8> {
    if let Some((content, crc)) = image.split_last_chunk_mut::<4>() {
        *crc = crc32(content).to_le_bytes();
    }
    image
}

/// A signed image in the name of another key.
fn renamed(mut image: Vec<u8>, key: KeyId) -> Vec<u8> {
    let at = image.len() - KEY_FROM_END;
    image[at..at + key.0.len()].copy_from_slice(&key.0);
    resealed(image)
}

/// A signed image with another correction: the clamp is a nanometre higher. It is an image, but not the one that was signed.
fn changed(image: &[u8]) -> Vec<u8> {
    let mut image = image.to_vec();
    image[72] ^= 1;
    resealed(image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use truepath_bench::{BulkBoard, InProcess};
    use truepath_core::image::{Image, Signed};

    #[test]
    fn a_board_without_its_button_held_and_one_that_has_a_key_are_told_so() {
        let image = include_bytes!("../../../../fuzz/seeds/image/twelve-nodes.tpi");
        assert!(Image::new_checked(image).is_ok() && Signed::of(image).is_none());
        let mut board = BulkBoard::new(InProcess::start().unwrap());
        assert!(run(&mut board, image).is_err());
        let mut board = BulkBoard::new(InProcess::attended().unwrap());
        let report = run(&mut board, image).unwrap();
        let refused = report.attempts.iter().filter(|attempt| attempt.refused.is_some()).count();
        assert_eq!((report.attempts.len(), refused), (50, 34), "{}", report.words());
        assert!(run(&mut board, image).is_err(), "it has known keys");
    }
}
