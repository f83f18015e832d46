//! Keys: whose images the component takes, and that none goes back.

use crate::pc_support::*;
use crate::rewrite_support::CLEAR;
use ed25519_dalek::{Signer, SigningKey};
use truepath_abi::pc::{LEDGER_BYTES, NO_KEY};
use truepath_abi::pc_abi::{truepath_pc_count, truepath_pc_trust, truepath_pc_written};
use truepath_core::image::{DeviceClass, DeviceClasses, PublicKey, sign, signed_bytes};

fn public(seed: u8) -> PublicKey {
    PublicKey(SigningKey::from_bytes(&[seed; 32]).verifying_key().to_bytes())
}

fn file(seed: u8) -> String {
    let digits: String = public(seed).0.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("# truepath public key\ned25519 {digits}\n")
}

fn signed(image: &[u8], seed: u8, classes: DeviceClasses, counter: u32) -> Vec<u8> {
    let key = SigningKey::from_bytes(&[seed; 32]);
    let mut bytes = vec![0; signed_bytes(image)];
    sign(image, &public(seed), classes, counter, |message| key.sign(message).to_bytes(), &mut bytes).unwrap();
    bytes
}

fn trust(pc: &mut Pc, file: &str) -> u32 {
    // SAFETY: the bytes of the text.
    unsafe { truepath_pc_trust(pc.config, file.as_ptr(), file.len()) }
}

/// Standing in `Bypass` without an image, with the key of the shop.
fn with_key(disk: &[u8]) -> Pc {
    let mut pc = Pc::load(disk);
    assert_eq!(trust(&mut pc, &file(1)), 0);
    pc.to(0, 0, CLEAR);
    pc.period();
    pc
}

/// What the configuration thread does with an image: its counter into the ledger, then the offer.
fn used(pc: &mut Pc, image: &[u8]) -> u32 {
    let mut ledger = [0; LEDGER_BYTES];
    // SAFETY: the bytes of the image.
    let count = unsafe { truepath_pc_count(pc.config, image.as_ptr(), image.len(), &mut ledger) };
    if count > 0 {
        if !pc.disk_fails {
            pc.disk = ledger[..count].to_vec();
        }
        truepath_pc_written(pc.config, (!pc.disk_fails).into());
    }
    let error = pc.offer(image);
    pc.period();
    error
}

#[test]
fn with_a_key_only_its_images_for_this_class_are_taken() {
    let all = DeviceClasses::ALL;
    let mut pc = with_key(&[]);
    assert_eq!(used(&mut pc, &image()), 15);
    assert_eq!(used(&mut pc, &signed(&image(), 2, all, 100)), 16);
    let mut changed = signed(&image(), 1, all, 100);
    changed[72] ^= 1;
    let (content, crc) = changed.split_last_chunk_mut::<4>().unwrap();
    *crc = truepath_core::checksum::crc32(content).to_le_bytes();
    assert_eq!(used(&mut pc, &changed), 17);
    let board = DeviceClasses::of(&[DeviceClass::Board]).unwrap();
    assert_eq!(used(&mut pc, &signed(&image(), 1, board, 100)), 18);
    assert_eq!((pc.last.image_ready, pc.disk.len()), (0, 0), "none is in use, and none was counted");
    assert_eq!(used(&mut pc, &signed(&image(), 1, all, 100)), 0);
    assert_eq!(pc.last.image_ready, 1);
}

#[test]
fn a_component_without_keys_takes_every_image_and_counts_none() {
    let mut pc = Pc::load(&[]);
    pc.to(0, 0, CLEAR);
    pc.period();
    assert_eq!(used(&mut pc, &signed(&image(), 9, DeviceClasses::ALL, u32::MAX)), 0);
    assert_eq!(used(&mut pc, &image()), 0);
    assert_eq!((pc.last.image_ready, pc.disk.len()), (1, 0));
}

#[test]
fn an_older_image_is_refused_also_after_a_restart_and_parts_and_counters_are_kept_together() {
    let of = |counter| signed(&image(), 1, DeviceClasses::ALL, counter);
    let mut pc = with_key(&[]);
    assert_eq!((used(&mut pc, &of(100)), used(&mut pc, &of(200)), used(&mut pc, &of(200))), (0, 0, 0));
    assert_eq!(used(&mut pc, &of(199)), 20);
    pc.set(truepath_abi::pc::Switches::DRIVES_ON, true);
    pc.set(truepath_abi::pc::Switches::PROGRAM_RUNNING, true);
    pc.period();
    assert_eq!(pc.arm(), 0);
    let disk = pc.disk.clone();
    let mut pc = with_key(&disk);
    assert_eq!((used(&mut pc, &of(199)), used(&mut pc, &of(0)), used(&mut pc, &of(201))), (20, 20, 0));
    pc.set(truepath_abi::pc::Switches::DRIVES_ON, true);
    pc.set(truepath_abi::pc::Switches::PROGRAM_RUNNING, true);
    pc.period();
    assert_eq!(pc.arm(), 4, "the part was armed before");
}

#[test]
fn an_image_whose_counter_cannot_be_written_is_not_used() {
    let of = |counter| signed(&image(), 1, DeviceClasses::ALL, counter);
    let mut pc = with_key(&[]);
    assert_eq!(used(&mut pc, &of(100)), 0);
    pc.disk_fails = true;
    assert_eq!(used(&mut pc, &of(200)), 42);
    assert_eq!(used(&mut pc, &of(100)), 0, "that one is in the ledger");
    // Not even when nobody asked for the ledger.
    assert_eq!(pc.offer(&of(300)), 42);
}

#[test]
fn a_file_without_a_key_or_with_a_wrong_line_is_told() {
    let mut pc = Pc::load(&[]);
    assert_eq!((trust(&mut pc, "# nothing\n"), trust(&mut pc, "")), (NO_KEY, NO_KEY));
    assert_eq!(trust(&mut pc, &(file(1) + "ed25519 12\n")), 3);
    assert_eq!(trust(&mut pc, &(1..=5).map(file).collect::<String>()), 10);
    assert_eq!(trust(&mut pc, &(1..=4).map(file).collect::<String>()), 0);
}
