//! Signed images: what verifies, and that nothing else does.

use crate::rewrite_support as part;
use ed25519_dalek::{Signer, SigningKey};
use part::{nodes, settings, straight};
use proptest::prelude::*;
use truepath_wire::image::{
    DeviceClass, DeviceClasses, Image, ImageError, KeyId, KeyRing, KeyRingError, MOST_KEYS, MOST_KEYS_EVER, PublicKey,
    SIGNATURE_BYTES, SignatureError, Signed, build, crc32, image_bytes, sign, signed_bytes, verify,
};

const CLASS: DeviceClass = DeviceClass::Board;
const COUNTER: u32 = 1_700_000_000;

fn owner(seed: u8) -> SigningKey {
    SigningKey::from_bytes(&[seed; 32])
}

fn public(key: &SigningKey) -> PublicKey {
    PublicKey(key.verifying_key().to_bytes())
}

fn ring(keys: &[&SigningKey]) -> KeyRing {
    let mut ring = KeyRing::default();
    keys.iter().for_each(|key| ring.add(public(key)).unwrap());
    ring
}

fn unsigned() -> Vec<u8> {
    let nodes = nodes(straight());
    let mut bytes = vec![0; image_bytes(nodes.len())];
    build(&settings(), &nodes, &mut bytes).unwrap();
    bytes
}

fn signed_for(image: &[u8], key: &SigningKey, classes: DeviceClasses) -> Vec<u8> {
    counted(image, key, classes, COUNTER)
}

fn counted(image: &[u8], key: &SigningKey, classes: DeviceClasses, counter: u32) -> Vec<u8> {
    let mut bytes = vec![0; signed_bytes(image)];
    sign(image, &public(key), classes, counter, |message| key.sign(message).to_bytes(), &mut bytes).unwrap();
    bytes
}

fn refused(image: &[u8], keys: &KeyRing, class: DeviceClass) -> SignatureError {
    verify(image, keys, class).map(|found| found.key).unwrap_err()
}

fn signed(key: &SigningKey) -> Vec<u8> {
    signed_for(&unsigned(), key, DeviceClasses::ALL)
}

/// The same bytes with a checksum that fits them: what anybody can do.
fn resealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let (content, crc) = bytes.split_last_chunk_mut::<4>().unwrap();
    *crc = crc32(content).to_le_bytes();
    bytes
}

#[test]
fn a_signed_image_is_an_image_with_the_same_content_and_another_name() {
    let (plain, key) = (unsigned(), owner(1));
    let bytes = signed(&key);
    assert_eq!(bytes.len(), plain.len() + SIGNATURE_BYTES);
    let (before, after) = (Image::new_checked(&plain).unwrap(), Image::new_checked(&bytes).unwrap());
    assert_eq!(before.settings(), after.settings());
    assert!(before.nodes().eq(after.nodes()));
    assert_ne!(before.crc(), after.crc());
    assert_eq!(
        verify(&bytes, &ring(&[&owner(2), &key]), CLASS).map(|found| (found.key, found.counter)),
        Ok((public(&key).id(), COUNTER))
    );
}

#[test]
fn an_open_ring_takes_every_image_and_a_closed_one_no_unsigned_one() {
    let (plain, key) = (unsigned(), owner(1));
    let open = KeyRing::default();
    assert!(open.is_open());
    assert_eq!((open.admits(&plain, CLASS), open.admits(&signed(&key), CLASS)), (Ok(None), Ok(None)));
    let closed = ring(&[&key]);
    assert!(!closed.is_open());
    assert_eq!(closed.admits(&plain, CLASS), Err(SignatureError::Missing));
    assert_eq!(closed.admits(&signed(&key), CLASS), Ok(Some(COUNTER)));
}

#[test]
fn no_bit_of_a_signed_image_can_be_changed() {
    let key = owner(3);
    let (bytes, ring) = (signed(&key), ring(&[&key]));
    let head = (0..288).step_by(7);
    let tail = bytes.len() - SIGNATURE_BYTES - 4..bytes.len() - 4;
    for at in head.chain((288..tail.start).step_by(97)).chain(tail) {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (at % 8);
        assert!(verify(&resealed(changed), &ring, CLASS).is_err(), "byte {at}");
    }
}

#[test]
fn an_image_that_is_cut_off_is_refused_at_every_length() {
    let key = owner(3);
    let (bytes, ring) = (signed(&key), ring(&[&key]));
    for length in (0..bytes.len()).rev().step_by(41) {
        assert!(verify(&bytes[..length], &ring, CLASS).is_err(), "{length} bytes");
        assert!(Image::new_checked(&bytes[..length]).is_err(), "{length} bytes");
    }
}

#[test]
fn the_signature_of_a_stranger_is_refused_under_his_own_number_and_under_that_of_the_key() {
    let (key, stranger) = (owner(3), owner(4));
    let ring = ring(&[&key]);
    let unknown = SignatureError::UnknownKey { key: public(&stranger).id() };
    assert_eq!(refused(&signed(&stranger), &ring, CLASS), unknown);
    let mut bytes = vec![0; signed_bytes(&unsigned())];
    let named = public(&key);
    sign(&unsigned(), &named, DeviceClasses::ALL, COUNTER, |m| stranger.sign(m).to_bytes(), &mut bytes).unwrap();
    assert_eq!(refused(&bytes, &ring, CLASS), SignatureError::Forged { key: named.id() });
}

#[test]
fn the_signature_of_another_image_by_the_same_key_is_refused() {
    let key = owner(3);
    let other = {
        let settings = truepath_wire::image::ImageSettings { closed: false, ..settings() };
        let nodes = nodes(straight().into_iter().take(50));
        let mut bytes = vec![0; image_bytes(nodes.len())];
        build(&settings, &nodes, &mut bytes).unwrap();
        signed_for(&bytes, &key, DeviceClasses::ALL)
    };
    let mut bytes = signed(&key);
    let (at, from) = (bytes.len() - 68, other.len() - 68);
    bytes[at..at + 64].copy_from_slice(&other[from..from + 64]);
    assert_eq!(refused(&resealed(bytes), &ring(&[&key]), CLASS), SignatureError::Forged { key: public(&key).id() });
}

#[test]
fn an_image_for_another_class_of_device_is_refused_and_its_classes_cannot_be_widened() {
    let key = owner(3);
    let (ring, bench) = (ring(&[&key]), DeviceClasses::of(&[DeviceClass::Bench]).unwrap());
    let bytes = signed_for(&unsigned(), &key, bench);
    assert!(verify(&bytes, &ring, DeviceClass::Bench).is_ok());
    let other = SignatureError::OtherClass { found: bench, expected: CLASS };
    assert_eq!(refused(&bytes, &ring, CLASS), other);
    let mut widened = bytes.clone();
    widened[bytes.len() - 80] = 7;
    assert_eq!(refused(&resealed(widened), &ring, CLASS), SignatureError::Forged { key: public(&key).id() });
}

#[test]
fn a_signature_taken_off_leaves_no_image_that_is_trusted() {
    let key = owner(3);
    let bytes = signed(&key);
    let mut stripped = bytes[..bytes.len() - SIGNATURE_BYTES].to_vec();
    let length = stripped.len() as u32;
    stripped[16..20].copy_from_slice(&length.to_le_bytes());
    assert!(Image::new_checked(&resealed(stripped.clone())).is_err(), "the head says that it is signed");
    stripped[8] = 1;
    assert_eq!(Image::new_checked(&resealed(stripped.clone())).map(|_| ()), Err(ImageError::Reserved), "a counter");
    stripped[268..272].fill(0);
    let stripped = resealed(stripped);
    assert_eq!(stripped, unsigned());
    assert_eq!(refused(&stripped, &ring(&[&key]), CLASS), SignatureError::Missing);
}

#[test]
fn an_image_signed_again_has_one_signature_the_last() {
    let (first, second) = (owner(5), owner(6));
    let once = signed(&first);
    let twice = signed_for(&once, &second, DeviceClasses::ALL);
    assert_eq!(twice, signed(&second));
    assert_eq!(Signed::of(&twice).unwrap().key, public(&second).id());
}

#[test]
fn what_is_no_image_is_not_signed_and_a_short_buffer_is_named() {
    let (key, mut buffer) = (owner(1), vec![0; 5_000]);
    let never = |_: &[u8]| -> [u8; 64] { panic!("nothing to be signed") };
    assert!(sign(&[0; 400], &public(&key), DeviceClasses::ALL, COUNTER, never, &mut buffer).is_err());
    let plain = unsigned();
    let needed = plain.len() + SIGNATURE_BYTES;
    let short = sign(&plain, &public(&key), DeviceClasses::ALL, COUNTER, never, &mut buffer[..needed - 1]).map(|_| ());
    assert_eq!(short, Err(ImageError::Buffer { needed, found: needed - 1 }));
}

#[test]
fn a_ring_takes_sound_keys_once_each_up_to_its_end() {
    let mut ring = KeyRing::default();
    // The neutral point, of order 1: every signature would do for some message.
    let mut weak = [0; 32];
    weak[0] = 1;
    let error = SignatureError::Key { key: KeyId(*weak.first_chunk().unwrap()) };
    assert_eq!(ring.add(PublicKey(weak)), Err(KeyRingError::Key(error)));
    assert!(ring.is_open());
    let keys: Vec<SigningKey> = (1..=MOST_KEYS as u8).map(owner).collect();
    for key in &keys {
        assert_eq!((ring.add(public(key)), ring.add(public(key))), (Ok(()), Ok(())));
    }
    assert_eq!(ring.iter().count(), MOST_KEYS);
    assert_eq!(ring.add(public(&owner(99))), Err(KeyRingError::Full));
    assert!(keys.iter().all(|key| verify(&signed(key), &ring, CLASS).is_ok()));
}

#[test]
fn the_counter_is_signed_and_an_image_from_before_there_were_counters_has_none_but_is_good() {
    let key = owner(3);
    let ring = ring(&[&key]);
    for counter in [0, 1, COUNTER, u32::MAX] {
        let bytes = counted(&unsigned(), &key, DeviceClasses::ALL, counter);
        assert!(Image::new_checked(&bytes).is_ok());
        assert_eq!(ring.admits(&bytes, CLASS), Ok(Some(counter)));
        let mut raised = bytes.clone();
        raised[268..272].copy_from_slice(&counter.wrapping_add(1).to_le_bytes());
        assert_eq!(refused(&resealed(raised), &ring, CLASS), SignatureError::Forged { key: public(&key).id() });
    }
    // With a counter of 0 these are the bytes that were signed before: the reserved word was 0.
    let before = counted(&unsigned(), &key, DeviceClasses::ALL, 0);
    assert_eq!(before[268..272], [0; 4]);
    let again = counted(&counted(&unsigned(), &key, DeviceClasses::ALL, 7), &key, DeviceClasses::ALL, 0);
    assert_eq!(again, before, "signed again");
}

#[test]
fn a_revoked_key_signs_nothing_never_comes_back_and_leaves_no_ring_open() {
    let keys: Vec<SigningKey> = (1..=MOST_KEYS_EVER as u8 + 1).map(owner).collect();
    let mut ring = ring(&[&keys[0], &keys[1]]);
    let id = |key: usize| public(&keys[key]).id();
    ring.revoke(id(0)).unwrap();
    assert_eq!(refused(&signed(&keys[0]), &ring, CLASS), SignatureError::Revoked { key: id(0) });
    assert!(verify(&signed(&keys[1]), &ring, CLASS).is_ok());
    let revoked = KeyRingError::Key(SignatureError::Revoked { key: id(0) });
    assert_eq!(ring.add(public(&keys[0])), Err(revoked));
    ring.revoke(id(1)).unwrap();
    assert_eq!((ring.is_open(), ring.iter().count()), (false, 0));
    assert_eq!(ring.admits(&unsigned(), CLASS), Err(SignatureError::Missing));
    // Its place is free, until the last; and each of the last can be revoked.
    for key in &keys[2..6] {
        ring.add(public(key)).unwrap();
    }
    assert_eq!(ring.add(public(&keys[6])), Err(KeyRingError::Full), "four at a time");
    (2..6).for_each(|key| ring.revoke(id(key)).unwrap());
    (6..MOST_KEYS_EVER).for_each(|key| ring.add(public(&keys[key])).unwrap());
    assert_eq!(ring.add(public(&keys[MOST_KEYS_EVER])), Err(KeyRingError::Full), "eight in all");
    (6..MOST_KEYS_EVER).for_each(|key| ring.revoke(id(key)).unwrap());
    assert_eq!((ring.is_open(), ring.iter().count(), ring.revoked().count()), (false, 0, MOST_KEYS_EVER));
    assert!(keys.iter().all(|key| verify(&signed(key), &ring, CLASS).is_err()));
}

#[test]
fn classes_are_some_and_known() {
    assert_eq!(DeviceClasses::of(&[]), None);
    assert_eq!(DeviceClasses::of(&DeviceClass::ALL), Some(DeviceClasses::ALL));
    let key = owner(3);
    for classes in [0u8, 8, 0xff] {
        let mut bytes = signed(&key);
        let at = bytes.len() - 80;
        bytes[at] = classes;
        let bytes = resealed(bytes);
        assert_eq!(Image::new_checked(&bytes).map(|_| ()), Err(ImageError::Reserved));
        assert_eq!(refused(&bytes, &ring(&[&key]), CLASS), SignatureError::Missing);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_bytes_verify_or_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..600),
        block in prop::collection::vec(any::<u8>(), SIGNATURE_BYTES),
        key in any::<[u8; 32]>(),
    ) {
        let known = owner(3);
        let ring = ring(&[&known]);
        prop_assert!(verify(&bytes, &ring, CLASS).is_err());
        // A good image under a made-up signature that names the key.
        let mut whole = signed(&known);
        let at = whole.len() - 4 - SIGNATURE_BYTES;
        whole[at + 16..at + SIGNATURE_BYTES].copy_from_slice(&block[16..]);
        prop_assert!(verify(&resealed(whole), &ring, CLASS).is_err());
        let _ = PublicKey(key).check();
    }
}
