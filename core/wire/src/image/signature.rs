//! Who made an image: an Ed25519 signature (RFC 8032) at its end, and the keys a device trusts.
//!
//! What is signed, and where the signature lies, is in [`block`](super::block).
//!
//! A signature says who made an image, not that it is a good one: [`Image::new_checked`](super::Image::new_checked)
//! is needed as well. Verification is one pass over the bytes (SHA-512) and one double scalar multiplication of
//! variable time, which depends on public data alone. Not for the servo cycle.
//!
//! `ed25519-dalek` and not `salty`: it is looked after by several people, was audited, and its strict verification refuses
//! keys of small order and every second form of a signature. It costs 35 KB of flash and 5 KB of stack more, which the
//! boards have (`docs/firmware.md`).

use ed25519_dalek::{Signature, VerifyingKey};
use serde::{Deserialize, Serialize};
use truepath_units::errors;

use super::block::{BLOCK, RAW_BYTES, SIGNATURE_BYTES};
use super::header::{COUNTER, CRC_BYTES};
use super::{DeviceClass, DeviceClasses, Image, ImageError, KeyId, Rights, SIGNED_FORMAT, Signed, crc32};

/// Most keys a device trusts at a time.
pub const MOST_KEYS: usize = 4;
/// Most keys a device knows in its life, those that were revoked among them: each that is trusted can still be revoked.
pub const MOST_KEYS_EVER: usize = 8;

errors! {
    /// Why an image is not trusted. The sentence of each variant is the text shown.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum SignatureError {
        /// It has no signature.
        Missing = "I015", "the image is not signed, and only signed images are taken here: a key is provisioned"
            => "sign it with truepath image sign, or make it with truepath correct --sign";
        /// It is signed with a key that is not trusted.
        UnknownKey {
            /// Number of the key in the image.
            key: KeyId,
        } = "I016", "the image is signed with key {key}, which is not trusted here"
            => "sign it with a key that is provisioned, or provision this one";
        /// The signature is not one of these bytes by this key.
        Forged {
            /// Number of the key in the image.
            key: KeyId,
        } = "I017", "the signature does not belong to key {key}: the image was changed, or signed by somebody else"
            => "do not use it; make and sign it again, and find out where it came from";
        /// It was signed for devices of another class.
        OtherClass {
            /// What it is for.
            found: DeviceClasses,
            /// What the device is.
            expected: DeviceClass,
        } = "I018", "the image is signed for {found}, this is {expected}"
            => "sign it again with --for";
        /// The public key is no point of the curve, or one of small order.
        Key {
            /// Its number.
            key: KeyId,
        } = "I019", "key {key} cannot be used: it is no sound public key"
            => "copy the public key again, or make a new pair with truepath key new";
        /// An image of this pass that was signed later was in use, or the pass was forgotten since.
        RolledBack {
            /// Counter of the image.
            found: u32,
            /// The least that is taken.
            least: u32,
        } = "I020", "the image has counter {found}, and a later one of its program was in use: less than {least} is not taken"
            => "use the latest image; to go back on purpose, sign this one again with truepath image sign";
        /// The key is trusted no more.
        Revoked {
            /// Its number.
            key: KeyId,
        } = "I021", "key {key} was revoked here, and signs nothing any more"
            => "sign with another key that is provisioned, and find out what else this one has signed";
        /// The key is good for logging in, not for images.
        SignsNothing {
            /// Its number.
            key: KeyId,
        } = "I022", "key {key} was provisioned without the right to sign images"
            => "sign with another key that is provisioned";
    }
}

impl core::error::Error for SignatureError {}

/// A public key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PublicKey(pub [u8; 32]);

impl PublicKey {
    /// Its number.
    pub fn id(&self) -> KeyId {
        KeyId(self.0.first_chunk().copied().unwrap_or_default())
    }
    /// Whether a signature can be verified with it.
    ///
    /// # Errors
    /// [`SignatureError::Key`].
    pub fn check(&self) -> Result<(), SignatureError> {
        self.verifying().map(|_| ())
    }
    /// Whether it signed a message.
    ///
    /// Not inlined: as [`verify`].
    #[inline(never)]
    pub fn signed(&self, message: &[u8], signature: &[u8; RAW_BYTES]) -> bool {
        self.verifying().is_ok_and(|key| key.verify_strict(message, &Signature::from_bytes(signature)).is_ok())
    }
    /// Not inlined: as [`verify`], it is known by its name where the rest of a program is proved to have no panic.
    #[inline(never)]
    fn verifying(&self) -> Result<VerifyingKey, SignatureError> {
        let key = VerifyingKey::from_bytes(&self.0).ok().filter(|key| !key.is_weak());
        key.ok_or(SignatureError::Key { key: self.id() })
    }
}

/// Verifies that one of the keys signed an image for a class of device; gives its signature.
///
/// # Errors
/// A [`SignatureError`]; whatever the bytes are.
#[inline(never)]
pub fn verify<'a>(image: &'a [u8], keys: &KeyRing, class: DeviceClass) -> Result<Signed<'a>, SignatureError> {
    let signed = Signed::of(image).ok_or(SignatureError::Missing)?;
    let Signed { message, signature, key, classes, .. } = signed;
    let unknown =
        if keys.is_revoked(key) { SignatureError::Revoked { key } } else { SignatureError::UnknownKey { key } };
    let (trusted, rights) = keys.find(key).ok_or(unknown)?;
    if !rights.signs {
        return Err(SignatureError::SignsNothing { key });
    }
    let forged = |_| SignatureError::Forged { key };
    trusted.verifying()?.verify_strict(message, &Signature::from_bytes(signature)).map_err(forged)?;
    // Behind the signature, so that what is said of the classes is what the signer said.
    if classes.holds(class) { Ok(signed) } else { Err(SignatureError::OtherClass { found: classes, expected: class }) }
}

/// The keys that a device trusts, and those that were revoked. One that never had a key is open: it takes every image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyRing {
    trusted: [Option<PublicKey>; MOST_KEYS],
    revoked: [Option<KeyId>; MOST_KEYS_EVER],
    /// Of the trusted ones. A message of before there were rights has none.
    #[serde(skip)]
    rights: [Rights; MOST_KEYS],
}

/// Why a key was not added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyRingError {
    /// It cannot be used.
    Key(SignatureError),
    /// It is there, with other rights.
    OtherRights {
        /// Its number.
        key: KeyId,
    },
    /// There are [`MOST_KEYS`], or with the revoked ones [`MOST_KEYS_EVER`].
    Full,
}

impl KeyRing {
    /// The keys that are trusted.
    pub fn iter(&self) -> impl Iterator<Item = &PublicKey> {
        self.trusted.iter().flatten()
    }
    /// The rights of the keys, in the order of [`KeyRing::iter`]; behind the last of them those of no key.
    pub fn rights(&self) -> [Rights; MOST_KEYS] {
        let mut all = [Rights::default(); MOST_KEYS];
        let there = self.trusted.iter().zip(self.rights).filter(|(key, _)| key.is_some());
        for (place, (_, rights)) in all.iter_mut().zip(there) {
            *place = rights;
        }
        all
    }
    /// A trusted key and its rights.
    pub fn find(&self, key: KeyId) -> Option<(&PublicKey, Rights)> {
        let mut all = self.trusted.iter().zip(self.rights);
        all.find_map(|(there, rights)| there.as_ref().filter(|there| there.id() == key).map(|there| (there, rights)))
    }
    /// The numbers of those that were revoked.
    pub fn revoked(&self) -> impl Iterator<Item = KeyId> {
        self.revoked.iter().copied().flatten()
    }
    /// Whether every image is taken, because there never was a key. With all keys revoked none is.
    pub fn is_open(&self) -> bool {
        self.iter().next().is_none() && self.revoked().next().is_none()
    }
    /// Whether a key was revoked.
    pub fn is_revoked(&self, key: KeyId) -> bool {
        self.revoked().any(|revoked| revoked == key)
    }
    /// Adds a key with all rights; one that is there already changes nothing.
    ///
    /// # Errors
    /// As [`KeyRing::add_with`].
    pub fn add(&mut self, key: PublicKey) -> Result<(), KeyRingError> {
        self.add_with(key, Rights::default())
    }
    /// Adds a key; one that is there already changes nothing.
    ///
    /// # Errors
    /// It cannot be used, was revoked, is there with other rights, or there is no room. A key with the number of another one
    /// counts as unusable.
    pub fn add_with(&mut self, key: PublicKey, rights: Rights) -> Result<(), KeyRingError> {
        key.check().map_err(KeyRingError::Key)?;
        let id = key.id();
        if self.is_revoked(id) {
            return Err(KeyRingError::Key(SignatureError::Revoked { key: id }));
        }
        if let Some((there, its)) = self.find(id) {
            return match (*there == key, its == rights) {
                (true, true) => Ok(()),
                (true, false) => Err(KeyRingError::OtherRights { key: id }),
                (false, _) => Err(KeyRingError::Key(SignatureError::Key { key: id })),
            };
        }
        let known = self.iter().count().saturating_add(self.revoked().count());
        let mut places = self.trusted.iter_mut().zip(&mut self.rights);
        let place = places.find(|(place, _)| place.is_none() && known < MOST_KEYS_EVER);
        let (place, its) = place.ok_or(KeyRingError::Full)?;
        (*place, *its) = (Some(key), rights);
        Ok(())
    }
    /// Trusts a key no more, for ever, also one that was never trusted. There always is room for one that is.
    ///
    /// # Errors
    /// There is no room.
    pub fn revoke(&mut self, key: KeyId) -> Result<(), KeyRingError> {
        if self.is_revoked(key) {
            return Ok(());
        }
        *self.revoked.iter_mut().find(|place| place.is_none()).ok_or(KeyRingError::Full)? = Some(key);
        for (place, rights) in self.trusted.iter_mut().zip(&mut self.rights) {
            *place = place.filter(|trusted| trusted.id() != key);
            if place.is_none() {
                *rights = Rights::default();
            }
        }
        Ok(())
    }
    /// Whether an image may be used on a device of a class: any while the ring is open, else one that [`verify`] passes,
    /// whose counter it gives.
    ///
    /// # Errors
    /// As [`verify`].
    pub fn admits(&self, image: &[u8], class: DeviceClass) -> Result<Option<u32>, SignatureError> {
        if self.is_open() { Ok(None) } else { verify(image, self, class).map(|signed| Some(signed.counter)) }
    }
}

/// Bytes of an image once it is signed; of a signed one its own.
pub fn signed_bytes(image: &[u8]) -> usize {
    if Signed::of(image).is_some() { image.len() } else { image.len().saturating_add(SIGNATURE_BYTES) }
}

/// Writes the signed form of a checked image into a lent buffer and gives it back, checked; its bytes are the first
/// [`signed_bytes`] of the buffer. An image that is signed already gets the new signature in place of the old one.
/// Its counter is to be above that of every image of the same pass that was signed before ([`Counted`](super::Counted)).
/// `sign` makes the signature of the key's owner.
///
/// # Errors
/// The buffer is too small, or the bytes are no image.
pub fn sign<'b>(
    image: &[u8],
    key: &PublicKey,
    classes: DeviceClasses,
    counter: u32,
    sign: impl FnOnce(&[u8]) -> [u8; RAW_BYTES],
    buffer: &'b mut [u8],
) -> Result<Image<'b>, ImageError> {
    Image::new_checked(image)?;
    let needed = signed_bytes(image);
    let short = ImageError::Buffer { needed, found: buffer.len() };
    let whole = buffer.get_mut(..needed).ok_or(short)?;
    let (content, crc) = whole.split_last_chunk_mut::<CRC_BYTES>().ok_or(short)?;
    let (message, signature) = content.split_last_chunk_mut::<RAW_BYTES>().ok_or(short)?;
    let (body, tail) = message.split_last_chunk_mut::<{ SIGNATURE_BYTES - RAW_BYTES }>().ok_or(short)?;
    body.copy_from_slice(image.get(..body.len()).ok_or(short)?);
    let [length, counter] = [needed as u32, counter].map(u32::to_le_bytes);
    for (at, field) in [(8, &SIGNED_FORMAT.to_le_bytes()[..]), (16, &length[..]), (COUNTER, &counter[..])] {
        if let Some(place) = body.get_mut(at..).and_then(|rest| rest.get_mut(..field.len())) {
            place.copy_from_slice(field);
        }
    }
    for (place, byte) in tail.iter_mut().zip(BLOCK.into_iter().chain(classes.bits().to_le_bytes()).chain(key.id().0)) {
        *place = byte;
    }
    *signature = sign(message);
    *crc = crc32(content).to_le_bytes();
    Image::new_checked(whole)
}
