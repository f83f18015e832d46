//! Updates, as a client sends them.

use ed25519_dalek::{Signer, SigningKey};
use sha2::{Digest, Sha512};
use truepath_core::link::{Ask, CHUNK_BYTES, Denial, Item, Reply, UpdateStage, UpdateStatus};
use truepath_core::update::{Label, UpdateHead};

use super::{Rig, public};

/// A program of two KiB.
pub fn program_of(seed: u8) -> [u8; 2_048] {
    core::array::from_fn(|at| (at as u8).wrapping_mul(31) ^ seed)
}

/// An update of the board of the rig.
pub fn update_of(program: &[u8], key: &SigningKey, counter: u32) -> Vec<u8> {
    update_for("test", program, key, counter)
}
/// An update of a board.
pub fn update_for(board: &str, program: &[u8], key: &SigningKey, counter: u32) -> Vec<u8> {
    let head = UpdateHead {
        length: program.len() as u32,
        counter,
        board: Label::of(board).unwrap(),
        version: Label::of("1.2.3").unwrap(),
        key: public(key).id(),
        digest: Sha512::digest(program).into(),
    };
    let mut update = head.signed(|message| key.sign(message).to_bytes()).to_vec();
    update.extend_from_slice(program);
    update
}

/// The whole upload.
pub fn send(rig: &mut Rig, update: &[u8]) -> Result<u32, Denial> {
    let offset = rig.begin_item(Item::Firmware, update, truepath_core::checksum::crc32(update))?;
    rig.chunks(offset, update, CHUNK_BYTES)?;
    rig.commit().map(|(_, name)| name)
}
/// Upload and hand-over to the loader.
pub fn install_over_link(rig: &mut Rig, update: &[u8]) -> Result<(), Denial> {
    send(rig, update)?;
    rig.done(Ask::Install)
}

pub fn status(rig: &mut Rig) -> UpdateStatus {
    let Reply::Update(status) = rig.ask(Ask::Update).unwrap() else { panic!() };
    status
}
pub fn stage(rig: &mut Rig) -> UpdateStage {
    status(rig).stage
}
