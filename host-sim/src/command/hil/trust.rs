//! `truepath hil --trust`: what a device with a key has to refuse, tried over its configuration link.
//!
//! The keys are made for this run. A real board is left with them, all revoked: it takes no image any more.

use std::time::Duration;

use serde::Serialize;
use truepath_bench::{BenchError, Board, Client, Wire, restart};
use truepath_core::checksum::crc32;
use truepath_core::image::{DeviceClass, DeviceClasses, ImageError, KeyId, SIGNATURE_BYTES, SignatureError};
use truepath_core::link::{
    Ask, CHUNK_BYTES, Denial, Item, PACKET_BYTES, Reply, Request, Response, Slot, decode, encode,
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

/// Key of the shop, of a second one, and of a stranger.
const SEEDS: [[u8; 32]; 3] = [[0x51; 32], [0x52; 32], [0x53; 32]];
/// Time for the answer to a replayed packet.
const PATIENCE: Duration = Duration::from_secs(10);
/// Where the number of the key lies, from the end.
const KEY_FROM_END: usize = SIGNATURE_BYTES - 8 + 4;

/// Tries everything on a board whose button is held, with an image that is not signed.
///
/// # Errors
/// The device took something, refused something, or refused it for another reason than it has to; the board has a key.
pub fn run(board: &mut dyn Board, image: &[u8]) -> Result<TrustReport, Failure> {
    let [shop, second, stranger] = SEEDS.map(|seed| Signer::of_seed(&seed));
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
    let mut tried = Tried { attempts: Vec::new(), board };

    if !tried.board.client().keys()?.keys.is_open() {
        let (found, help) = ("the device has a key already".to_owned(), "try it on one that is open".to_owned());
        return Err(BenchError::Option { found, help }.into());
    }
    tried.upload("not signed, no key: open", image, Ok(()))?;
    tried.ask("first key", Ask::Provision(shop.public()), Ok(()))?;
    tried.in_use("in use while it was open", None)?;
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
    let packets = packets(&old, first_id)?;
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
    tried.in_use("signed with the revoked key", None)?;
    let revoked = untrusted(SignatureError::Revoked { key });
    tried.upload("signed with the revoked key", &signed(&shop, 400, all)?, revoked)?;
    tried.ask("the revoked key once more", Ask::Provision(shop.public()), revoked)?;
    tried.upload("signed with the second key", &signed(&second, 400, all)?, Ok(()))?;
    tried.ask("second key revoked", Ask::Revoke(second.public().id()), Ok(()))?;
    tried.upload("not signed, all keys revoked", image, untrusted(SignatureError::Missing))?;
    restart(tried.board)?;
    tried.upload("the same behind a reset", image, untrusted(SignatureError::Missing))?;
    tried.in_use("at the end", None)?;
    Ok(TrustReport { board: tried.board.describe(), attempts: tried.attempts })
}

const fn untrusted(error: SignatureError) -> Result<(), Denial> {
    Err(Denial::Untrusted(error))
}

/// The board, and what was tried on it.
struct Tried<'b> {
    board: &'b mut dyn Board,
    attempts: Vec<Attempt>,
}

impl Tried<'_> {
    /// Keeps what the device did, if it is what it has to do.
    fn keep(
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
    fn ask(&mut self, given: &'static str, ask: Ask<'_>, expected: Result<(), Denial>) -> Result<(), BenchError> {
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

/// The packets of an upload of an image into the first slot, and of its activation.
fn packets(image: &[u8], first_id: u16) -> Result<Vec<Vec<u8>>, BenchError> {
    let crc = name(image);
    let chunks = image.chunks(CHUNK_BYTES).enumerate();
    let chunks = chunks.map(|(k, bytes)| Ask::Chunk { offset: (k * CHUNK_BYTES) as u32, bytes });
    let begin = Ask::Begin { item: Item::Image, length: image.len() as u32, crc };
    let asks = [begin].into_iter().chain(chunks).chain([Ask::Commit, Ask::Activate { slot: 0, crc }]);
    let packet = |(ask, id): (Ask<'_>, u16)| {
        let mut packet = [0; PACKET_BYTES];
        let used = encode(&Request { id, ask }, &mut packet).map_err(|e| BenchError::Foreign(e.to_string()))?;
        Ok(packet[..used].to_vec())
    };
    asks.zip(std::iter::successors(Some(first_id), |id| Some(id.wrapping_add(1)))).map(packet).collect()
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
        assert_eq!((report.attempts.len(), refused), (24, 15), "{}", report.words());
        assert!(run(&mut board, image).is_err(), "it has known keys");
    }
}
