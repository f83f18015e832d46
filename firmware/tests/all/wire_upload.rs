//! Uploads over the configuration link: whole, in pieces, interrupted, wrong.

use crate::wire_support;
use truepath_core::image::ImageError;
use truepath_core::link::{Ask, CHUNK_BYTES, Denial, Item, ResetCause, Slot};
use wire_support::*;

#[test]
fn an_uploaded_image_is_listed_and_can_be_used() {
    let mut rig = Rig::new();
    assert_eq!(rig.slots(), [Slot::Empty; 2]);
    let image = image_of(straight(0));
    assert_eq!(rig.upload(&image), Ok(0));
    let binding = part::settings().binding;
    let listed = |active| Slot::Image { length: image.len() as u32, crc: name(&image), generation: 1, active, binding };
    assert_eq!(rig.slots(), [listed(false), Slot::Empty]);
    rig.activate(0, name(&image)).unwrap();
    assert_eq!(rig.slots(), [listed(true), Slot::Empty]);
    rig.reset(ResetCause::PowerOn);
    assert_eq!(rig.slots(), [listed(true), Slot::Empty]);
    assert_eq!(rig.status().active.unwrap().crc, name(&image));
}

#[test]
fn uploads_go_to_the_slot_that_is_not_in_use_and_the_older_image_goes_first() {
    let [a, b, c] = [0, 10, 20].map(|shift| image_of(straight(shift)));
    let mut rig = Rig::with_image(&a);
    assert_eq!(rig.upload(&b), Ok(1));
    assert_eq!(rig.upload(&c), Ok(1));
    rig.done(Ask::Deactivate).unwrap();
    // Nothing is in use: the image of generation 1 is older than that of generation 3.
    assert_eq!(rig.upload(&b), Ok(0));
    let generations = rig.slots().map(|slot| match slot {
        Slot::Image { generation, .. } => generation,
        other => panic!("{other:?}"),
    });
    assert_eq!(generations, [4, 3]);
}

#[test]
fn an_upload_goes_on_where_the_link_broke_off_at_every_byte() {
    let mut rig = Rig::new();
    let image = image_of(straight(0)[..4].to_vec());
    for cut in 0..=image.len() {
        rig.wipe();
        let offset = rig.begin(&image).unwrap();
        rig.chunks(offset, &image[..cut], 100).unwrap();
        // Half a message, then another client.
        let half = request(9, Ask::Chunk { offset: cut as u32, bytes: &image[cut..] });
        assert!(rig.raw(&half[..half.len() / 2]).is_empty());
        assert!(rig.raw(&[0]).is_empty());
        let on = rig.begin(&image).unwrap() as usize;
        assert!(on <= cut && on + 32 > cut, "{on} of {cut}");
        rig.chunks(on as u32, &image, CHUNK_BYTES).unwrap();
        assert_eq!(rig.commit(), Ok((0, name(&image))));
    }
}

#[test]
fn an_upload_goes_on_after_a_reset() {
    let mut rig = Rig::new();
    let image = image_of(straight(0));
    for cut in (0..=image.len()).step_by(97) {
        rig.wipe();
        rig.begin(&image).unwrap();
        rig.chunks(0, &image[..cut], CHUNK_BYTES).unwrap();
        rig.reset(ResetCause::Watchdog);
        let written = if cut == image.len() { cut } else { cut / 32 * 32 } as u32;
        assert_eq!(rig.slots()[0], Slot::Partial { length: image.len() as u32, crc: name(&image), written });
        assert_eq!(rig.begin(&image), Ok(written));
        rig.chunks(written, &image, CHUNK_BYTES).unwrap();
        assert_eq!(rig.commit(), Ok((0, name(&image))));
    }
}

#[test]
fn an_upload_of_another_image_begins_anew() {
    let mut rig = Rig::with_image(&image_of(straight(20)));
    let (one, other) = (image_of(straight(0)), image_of(straight(10)));
    assert_eq!(one.len(), other.len());
    rig.begin(&one).unwrap();
    rig.chunks(0, &one[..1_000], CHUNK_BYTES).unwrap();
    assert_eq!(rig.begin(&other), Ok(0));
    rig.chunks(0, &other, CHUNK_BYTES).unwrap();
    assert_eq!(rig.commit(), Ok((1, name(&other))));
}

#[test]
fn an_image_that_is_there_already_is_not_sent_again() {
    let mut rig = Rig::new();
    let image = image_of(straight(0));
    rig.upload(&image).unwrap();
    let (before, listed) = (rig.operations(), rig.slots());
    assert_eq!(rig.begin(&image), Ok(image.len() as u32));
    // A chunk of nothing fits there, and changes nothing.
    assert_eq!(rig.chunk(image.len() as u32, &[]), Ok(image.len() as u32));
    assert_eq!(rig.slots(), listed);
    assert_eq!(rig.commit(), Ok((0, name(&image))));
    assert_eq!(rig.operations(), before);
}

#[test]
fn damaged_images_are_refused_and_the_next_upload_begins_anew() {
    let mut rig = Rig::new();
    let image = image_of(straight(0));
    for at in [0, 9, 13, 20, 100, 300, image.len() - 1] {
        rig.wipe();
        let used = image_of(straight(20));
        rig.upload(&used).unwrap();
        rig.activate(0, name(&used)).unwrap();
        let mut damaged = image.clone();
        damaged[at] ^= 4;
        rig.begin_item(Item::Image, &damaged, name(&image)).unwrap();
        rig.chunks(0, &damaged, CHUNK_BYTES).unwrap();
        assert!(matches!(rig.commit(), Err(Denial::Image(_))), "byte {at}");
        assert_eq!(rig.slots()[1], Slot::Damaged);
        rig.reset(ResetCause::PowerOn);
        assert_eq!(rig.slots()[1], Slot::Damaged);
        assert_eq!(rig.activate(1, name(&image)), Err(Denial::NoImage { slot: 1 }));
        assert_eq!(rig.upload(&image), Ok(1));
        assert_eq!(rig.status().active.unwrap().crc, name(&used));
    }
}

#[test]
fn an_image_under_another_name_is_refused() {
    let mut rig = Rig::new();
    let image = image_of(straight(0));
    rig.begin_item(Item::Image, &image, 0xDEAD_BEEF).unwrap();
    rig.chunks(0, &image, CHUNK_BYTES).unwrap();
    assert_eq!(rig.commit(), Err(Denial::Checksum { expected: 0xDEAD_BEEF, found: name(&image) }));
    assert_eq!(rig.slots()[0], Slot::Damaged);
}

#[test]
fn chunks_elsewhere_too_long_or_without_a_beginning_change_nothing() {
    let mut rig = Rig::new();
    let image = image_of(straight(0));
    assert_eq!(rig.chunk(0, &image[..10]), Err(Denial::NoUpload));
    assert_eq!(rig.commit(), Err(Denial::NoUpload));
    rig.begin(&image).unwrap();
    assert_eq!(rig.chunk(1, &image[1..11]), Err(Denial::Offset { expected: 0, found: 1, bytes: 10 }));
    assert_eq!(rig.chunk(0, &image[..1_025]), Err(Denial::Offset { expected: 0, found: 0, bytes: 1_025 }));
    assert_eq!(rig.chunk(0, &image[..100]), Ok(100));
    assert_eq!(rig.chunk(0, &image[..100]), Err(Denial::Offset { expected: 100, found: 0, bytes: 100 }));
    let length = image.len() as u32;
    assert_eq!(rig.commit(), Err(Denial::Incomplete { length, written: 100 }));
    rig.chunks(100, &image, 1_000).unwrap();
    assert_eq!(rig.chunk(length, &[1]), Err(Denial::Offset { expected: length, found: length, bytes: 1 }));
    assert_eq!(rig.commit(), Ok((0, name(&image))));
}

#[test]
fn what_is_too_long_is_refused_before_anything_is_erased() {
    let mut rig = Rig::new();
    let before = rig.operations();
    for (item, most) in [(Item::Image, 384_372), (Item::Program, 4_096), (Item::Job, 512), (Item::Probe, 4_096)] {
        for length in [0, most + 1, u32::MAX] {
            let denied = rig.ask(Ask::Begin { item, length, crc: 1 }).unwrap_err();
            assert_eq!(denied, Denial::TooLong { item, length, most });
        }
    }
    assert_eq!(rig.operations(), before);
}

#[test]
fn the_longest_image_fits() {
    let points = (0..12_000i64).map(|i| (i * 100_000, 0)).collect();
    let image = image_of(points);
    let mut rig = Rig::with_image(&image);
    rig.enable();
    rig.arm(1).unwrap();
}

#[test]
fn an_upload_erases_the_sectors_it_needs_whatever_lies_in_the_others() {
    let long = image_of((0..9_000).map(|i| (i * 100_000, 0)).collect());
    let middle = image_of((0..5_000).map(|i| (i * 100_000, 0)).collect());
    let short = image_of(straight(0));
    let mut rig = Rig::with_image(&image_of(straight(10)));
    for (image, sectors) in [(&long, 3), (&short, 1), (&middle, 2), (&short, 1), (&long, 3), (&middle, 2)] {
        let before = rig.flash().wear().erased_sectors;
        assert_eq!(rig.upload(image), Ok(1));
        assert_eq!(rig.flash().wear().erased_sectors, before + sectors);
        rig.reset(ResetCause::PowerOn);
        assert!(matches!(rig.slots()[1], Slot::Image { crc, .. } if crc == name(image)));
    }
}

#[test]
fn an_image_of_another_semantics_is_refused() {
    let mut rig = Rig::new();
    let mut image = image_of(straight(0));
    image[12] = 99;
    let crc = truepath_core::image::crc32(&image[..image.len() - 4]);
    let end = image.len() - 4;
    image[end..].copy_from_slice(&crc.to_le_bytes());
    rig.begin_item(Item::Image, &image, crc).unwrap();
    rig.chunks(0, &image, CHUNK_BYTES).unwrap();
    assert_eq!(
        rig.commit(),
        Err(Denial::Image(ImageError::Semantics { found: 99, expected: truepath_core::image::SEMANTICS }))
    );
}

#[test]
fn program_job_and_probe_log_go_to_memory_and_are_lost_at_a_reset() {
    let mut rig = Rig::new();
    for item in [Item::Program, Item::Job, Item::Probe] {
        let bytes = b"G1 X1 F100\nM2\n";
        let crc = truepath_core::image::crc32(bytes);
        assert_eq!(rig.begin_item(item, bytes, crc), Ok(0));
        assert_eq!(rig.chunk(0, &bytes[..5]), Ok(5));
        assert_eq!(rig.begin_item(item, bytes, crc), Ok(5));
        rig.chunks(5, bytes, 3).unwrap();
        assert_eq!(rig.commit(), Ok((0, crc)));
        assert_eq!(rig.begin_item(item, bytes, crc ^ 1), Ok(0));
        rig.chunks(0, bytes, 100).unwrap();
        assert_eq!(rig.commit(), Err(Denial::Checksum { expected: crc ^ 1, found: crc }));
    }
    rig.reset(ResetCause::PowerOn);
    assert_eq!(rig.ask(Ask::Compute), Err(Denial::Missing(Item::Program)));
}

#[test]
fn of_a_slot_that_is_not_there_nothing_is_put_in_use() {
    let mut rig = Rig::new();
    let image = image_of(straight(0));
    let slot = rig.upload(&image).unwrap();
    rig.activate(slot, name(&image)).unwrap();
    assert_eq!(rig.upload(&image_of(straight(1))).unwrap(), 1 - slot);
    for slot in [2, 3, u8::MAX] {
        for crc in [name(&image), name(&image_of(straight(1)))] {
            assert_eq!(rig.activate(slot, crc), Err(Denial::NoImage { slot }));
        }
    }
}

#[test]
fn a_slot_is_listed_as_begun_while_an_upload_is_under_way() {
    let mut rig = Rig::new();
    let image = image_of(straight(0));
    assert_eq!(rig.begin(&image), Ok(0));
    let begun = Slot::Partial { length: image.len() as u32, crc: name(&image), written: 0 };
    assert_eq!(rig.slots(), [begun, Slot::Empty]);
}
