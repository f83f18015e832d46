//! What an input can bring to a device: images signed and not, keys, updates.

use ed25519_dalek::{Signer, SigningKey};
use sha2::{Digest, Sha512};
use truepath_core::image::{DeviceClasses, KeyId, PublicKey, Rights, Role, sign, signed_bytes};
use truepath_core::update::{Label, UpdateHead};

use super::device::BOARD;
use crate::attack::Setup;

/// Keys there are: of an engineer who also signs images and firmware, of an operator, of a stranger.
pub(super) const KEYS: usize = 3;
/// What each is provisioned for.
pub(super) const RIGHTS: [Rights; KEYS] = [
    Rights { role: Role::Engineer, signs: true, firmware: true },
    Rights { role: Role::Operate, signs: false, firmware: false },
    Rights { role: Role::Engineer, signs: true, firmware: false },
];

/// An image that can be uploaded.
pub(super) struct Known {
    pub bytes: Vec<u8>,
    /// Its name.
    pub crc: u32,
    /// Which image of the set-up it is.
    pub other: bool,
    /// Key and counter.
    pub signed: Option<(usize, u32)>,
}

/// All of it.
pub(super) struct Things {
    /// By which devices are judged.
    pub setup: Setup,
    pub images: Vec<Known>,
    pub keys: [SigningKey; KEYS],
    pub updates: Vec<Vec<u8>>,
}

/// Counters of the signed images, of either pass.
const COUNTERS: [u32; 2] = [10, 20];

impl Things {
    /// With the images of another set-up than that by which devices are judged, if a mistake is made.
    pub fn of(setup: Setup, images_of: &Setup) -> Self {
        let keys = [1, 2, 3].map(|seed| SigningKey::from_bytes(&[seed; 32]));
        let mut images = vec![];
        for (other, bytes) in [false, true].into_iter().zip(images_of.bytes()) {
            let signed = |key: usize, counter| {
                let mut signed = vec![0; signed_bytes(bytes)];
                let by = |message: &[u8]| keys[key].sign(message).to_bytes();
                sign(bytes, &public(&keys[key]), DeviceClasses::ALL, counter, by, &mut signed).expect("room");
                known(signed, other, Some((key, counter)))
            };
            let of_each: Vec<Known> =
                [signed(0, COUNTERS[0]), signed(0, COUNTERS[1]), signed(1, 30), signed(2, 40)].into();
            images.push(known(bytes.clone(), other, None));
            images.extend(of_each);
        }
        let updates = [(0, 100), (0, 200), (1, 300)].map(|(key, counter)| update(&keys[key], counter)).into();
        Self { setup, images, keys, updates }
    }
    pub fn public(&self, key: usize) -> PublicKey {
        public(&self.keys[key % KEYS])
    }
    /// The image of a name.
    pub fn named(&self, crc: u32) -> Option<usize> {
        self.images.iter().position(|known| known.crc == crc)
    }
    /// Which key a number is that of.
    pub fn key(&self, id: KeyId) -> Option<usize> {
        (0..KEYS).find(|&key| self.public(key).id() == id)
    }
}

fn public(key: &SigningKey) -> PublicKey {
    PublicKey(key.verifying_key().to_bytes())
}

fn known(bytes: Vec<u8>, other: bool, signed: Option<(usize, u32)>) -> Known {
    let crc = bytes.last_chunk().map_or(0, |crc| u32::from_le_bytes(*crc));
    Known { bytes, crc, other, signed }
}

/// An update with a program of a hundred bytes.
fn update(key: &SigningKey, counter: u32) -> Vec<u8> {
    let program = [counter as u8; 100];
    let head = UpdateHead {
        length: program.len() as u32,
        counter,
        board: Label::of(BOARD).unwrap_or_default(),
        version: Label::of("1.2.3").unwrap_or_default(),
        key: public(key).id(),
        digest: Sha512::digest(program).into(),
    };
    let mut update = head.signed(|message| key.sign(message).to_bytes()).to_vec();
    update.extend_from_slice(&program);
    update
}
