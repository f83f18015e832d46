//! Keys and what they are good for.

use ed25519_dalek::{Signer, SigningKey};
use truepath_wire::image::{KeyRing, KeyRingError, PublicKey, Rights, Role};

fn owner(seed: u8) -> SigningKey {
    SigningKey::from_bytes(&[seed; 32])
}

fn public(key: &SigningKey) -> PublicKey {
    PublicKey(key.verifying_key().to_bytes())
}

#[test]
fn a_message_is_signed_by_its_signer_alone() {
    let (one, other) = (owner(1), owner(2));
    let signature = one.sign(b"log in").to_bytes();
    assert!(public(&one).signed(b"log in", &signature));
    assert!(!public(&one).signed(b"log on", &signature));
    assert!(!public(&other).signed(b"log in", &signature));
    assert!(!public(&one).signed(b"log in", &other.sign(b"log in").to_bytes()));
    // The neutral element of the curve would verify what nobody signed.
    let neutral = PublicKey(core::array::from_fn(|k| u8::from(k == 0)));
    let nobodys = core::array::from_fn(|k| u8::from(k == 0));
    assert!(!neutral.signed(b"log in", &nobodys));
    assert!(neutral.check().is_err());
}

#[test]
fn each_key_keeps_its_rights_whatever_becomes_of_the_others() {
    let keys = [1, 2, 3].map(|seed| public(&owner(seed)));
    let rights = [
        Rights { role: Role::Read, signs: true, firmware: false },
        Rights { role: Role::Operate, signs: false, firmware: true },
        Rights { role: Role::Engineer, signs: false, firmware: false },
    ];
    let mut ring = KeyRing::default();
    assert_eq!(ring.rights(), [Rights::default(); 4]);
    for (key, rights) in keys.iter().zip(rights) {
        ring.add_with(*key, rights).unwrap();
        ring.add_with(*key, rights).unwrap();
        assert_eq!(ring.add(*key), Err(KeyRingError::OtherRights { key: key.id() }));
        assert_eq!(ring.find(key.id()), Some((key, rights)));
    }
    assert_eq!(ring.rights(), [rights[0], rights[1], rights[2], Rights::default()]);
    ring.revoke(keys[0].id()).unwrap();
    assert_eq!(ring.rights(), [rights[1], rights[2], Rights::default(), Rights::default()]);
    assert_eq!(ring.find(keys[0].id()), None);
    assert!(ring.iter().eq([&keys[1], &keys[2]]));
    // Its place is taken by another, with rights of its own.
    let next = public(&owner(4));
    ring.add(next).unwrap();
    assert_eq!(ring.find(next.id()), Some((&next, Rights::default())));
    assert_eq!(ring.find(keys[1].id()), Some((&keys[1], rights[1])));
}
