#![allow(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_arithmetic
)]
use std::string::String;
use std::vec;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::image::{Binding, CorrectionLimits, FineOffset, PathWindow, dump};
use truepath_units::{Position, Real};

fn settings() -> ImageSettings {
    ImageSettings {
        binding: Binding { program_crc: 0xdead_beef, feature: 1, pass: 2, tool: 3, tool_offset: 3, setup: 4 },
        closed: false,
        feed: FeedLaw::new(
            FineOffset::from_bits(44_444 << 8),
            6,
            1_500_000,
            Real::ratio(2, 10),
            Real::ratio(1, 4),
            Real::ratio(3, 2),
        ),
        limits: CorrectionLimits {
            clamp: Offset::from_um(500),
            warn: Offset::from_um(400),
            slew_nm_per_s: 20_000_000,
            acceleration_nm_per_s2: 1_000_000_000,
        },
        window: PathWindow {
            tolerance: Offset::from_um(100),
            z_low: Position::from_nm(-10_000_000),
            z_high: Position::from_nm(-10_000_000),
            gate_height: Offset::from_um(5_000),
        },
        node_step: Offset::from_um(100),
    }
}

fn nodes(count: i64) -> Vec<ImageNode> {
    let f = FineOffset::from_bits;
    (0..count)
        .map(|i| ImageNode {
            point: Point::from_nm(34_000_000 + i * 100_000, -4_300_000_000),
            chip: [f(-(i as i32) * 1_000), f(25_600_000)],
            edge: [f(7), f(-2_560_000)],
        })
        .collect()
}

fn bytes(count: i64) -> Vec<u8> {
    let mut buffer = vec![0; image_bytes(count as usize)];
    build(&settings(), nodes(count), &mut buffer).unwrap();
    buffer
}

#[test]
fn an_image_gives_back_what_was_put_in() {
    let given = nodes(50);
    let buffer = bytes(50);
    let image = Image::new_checked(&buffer).unwrap();
    assert_eq!(*image.settings(), settings());
    assert_eq!((image.len(), image.is_empty()), (50, false));
    for (node, given) in image.nodes().zip(&given) {
        let origin = image.header().origin;
        let point = Point::from_nm(origin.x.nm() + i64::from(node.x), origin.y.nm() + i64::from(node.y));
        assert_eq!((point, node.chip, node.edge), (given.point, given.chip, given.edge));
    }
}

#[test]
fn every_flipped_bit_is_noticed() {
    let mut buffer = bytes(12);
    for bit in 0..buffer.len() * 8 {
        buffer[bit / 8] ^= 1 << (bit % 8);
        assert!(Image::new_checked(&buffer).is_err(), "bit {bit}");
        buffer[bit / 8] ^= 1 << (bit % 8);
    }
    assert!(Image::new_checked(&buffer).is_ok());
}

#[test]
fn every_other_length_is_noticed() {
    let mut buffer = bytes(5);
    for end in 0..buffer.len() {
        assert!(Image::new_checked(&buffer[..end]).is_err(), "{end} bytes");
    }
    buffer.push(0);
    assert!(matches!(Image::new_checked(&buffer), Err(ImageError::Length { .. })));
}

#[test]
fn other_versions_are_refused_by_name() {
    let with = |at: usize| {
        let mut b = bytes(5);
        b[at] ^= 0x40;
        Image::new_checked(&b).map(|i| i.crc())
    };
    assert_eq!(with(0), Err(ImageError::Magic));
    assert_eq!(with(8), Err(ImageError::Format { found: 0x41, expected: 1 }));
    assert_eq!(
        with(12),
        Err(ImageError::Semantics { found: crate::image::SEMANTICS ^ 0x40, expected: crate::image::SEMANTICS })
    );
    assert!(matches!(with(300), Err(ImageError::Checksum { .. })));
}

/// A change made behind a right checksum must still be found.
fn resealed(change: impl FnOnce(&mut [u8])) -> Result<u32, ImageError> {
    let mut b = bytes(5);
    change(&mut b);
    let end = b.len() - 4;
    let crc = crc32(&b[..end]);
    b[end..].copy_from_slice(&crc.to_le_bytes());
    Image::new_checked(&b).map(|i| i.crc())
}

#[test]
fn a_wrong_value_behind_a_right_checksum_is_still_refused() {
    assert!(resealed(|_| ()).is_ok());
    assert_eq!(resealed(|b| b[10] = 1), Err(ImageError::Reserved));
    assert_eq!(resealed(|b| b[20] = 2), Err(ImageError::Reserved));
    assert_eq!(resealed(|b| b[20] = 1), Err(ImageError::NotClosed));
    assert_eq!(resealed(|b| b[136 + 4 * 20 + 3] = 0), Err(ImageError::FactorTable { entry: 20 }));
    assert!(matches!(resealed(|b| b[100] = 4), Err(ImageError::Length { .. })));
    assert!(matches!(resealed(|b| b[52] = 0), Err(ImageError::Range { name: Field::Teeth, value: 0, .. })));
    assert!(matches!(resealed(|b| b[79] = 1), Err(ImageError::Range { name: Field::Clamp, .. })));
    let node = HEADER_BYTES + 2 * NODE_BYTES;
    assert_eq!(resealed(|b| b[node + 24] ^= 1), Err(ImageError::Derived { node: 2 }));
    assert_eq!(resealed(|b| b[node] ^= 4), Err(ImageError::Derived { node: 1 }));
    assert!(matches!(resealed(|b| b[node + 3] = 9), Err(ImageError::Spacing { node: 1, .. })));
    assert!(matches!(resealed(|b| b[node + 15] = 0x7f), Err(ImageError::OverClamp { node: 2, .. })));
}

#[test]
fn a_correction_that_the_feed_window_lifts_over_the_clamp_cannot_be_built() {
    let mut buffer = vec![0; image_bytes(3)];
    let mut n = nodes(3);
    // Within the clamp at the nominal feed, beyond it at 1.5 times the feed.
    n[1].chip[1] = FineOffset::from_bits(450_000 << 8);
    n[1].edge[1] = FineOffset::ZERO;
    let expected = 450_000.0 * 1.5f64.powf(0.8);
    let Err(ImageError::OverClamp { node: 1, correction_nm, clamp_nm: 500_000 }) = build(&settings(), &n, &mut buffer)
    else {
        panic!("built");
    };
    assert!((correction_nm as f64 - expected).abs() < 10.0, "{correction_nm} {expected}");
    assert_eq!(peak(&n, &settings().feed).nm(), correction_nm);
    let mut wide = settings();
    wide.limits.clamp = peak(&n, &wide.feed);
    assert!(build(&wide, &n, &mut buffer).is_ok());
}

#[test]
fn what_does_not_fit_is_an_error_that_names_the_limit() {
    let mut small = vec![0; image_bytes(5) - 1];
    let found = small.len();
    let error = build(&settings(), nodes(5), &mut small).map(|i| i.crc());
    assert_eq!(error, Err(ImageError::Buffer { needed: found + 1, found }));
    let mut buffer = vec![0; image_bytes(5)];
    let mut far = nodes(5);
    far[4].point.x = Position::from_nm(9_000_000_000);
    assert_eq!(build(&settings(), &far, &mut buffer).map(|i| i.crc()), Err(ImageError::NodeFar { node: 4 }));
    let mut same = nodes(5);
    same[3] = same[2];
    assert!(matches!(build(&settings(), &same, &mut buffer), Err(ImageError::Spacing { node: 2, found_nm: 0, .. })));
    assert!(matches!(build(&settings(), nodes(1), &mut buffer), Err(ImageError::Range { value: 1, .. })));
    let mut gate = settings();
    gate.window.gate_height = Offset::from_nm(-1);
    assert!(matches!(build(&gate, nodes(5), &mut buffer), Err(ImageError::Range { .. })));
}

#[test]
fn the_text_names_every_value_in_millimetres() {
    let buffer = bytes(3);
    let mut text = String::new();
    dump(&Image::new_checked(&buffer).unwrap(), None, &mut text).unwrap();
    for line in [
        "program_crc = deadbeef",
        "feed_per_tooth_mm = 0.044444",
        "spindle_rpm = 1500.000",
        "size_exponent = 0.2000",
        "clamp_mm = 0.500000",
        "slew_mm_per_s = 20.000000",
        "z_low_mm = -10.000000",
        "1 34.100000 -4300.000000 -0.000004 0.100000 0.000000 -0.010000",
    ] {
        assert!(text.lines().any(|l| l == line), "{line} not in\n{text}");
    }
}

proptest! {
    #[test]
    fn random_bytes_are_never_an_image(mut noise in proptest::collection::vec(any::<u8>(), 0..800), head in any::<bool>()) {
        let good = bytes(5);
        if head {
            let n = noise.len().min(24);
            noise[..n].copy_from_slice(&good[..n]);
        }
        prop_assert!(Image::new_checked(&noise).is_err());
    }

    #[test]
    fn a_burst_of_damage_is_always_noticed(at in 0usize..400, burst in 1u32..) {
        let mut b = bytes(5);
        let at = at.min(b.len() - 4);
        for (byte, flip) in b[at..at + 4].iter_mut().zip(burst.to_le_bytes()) {
            *byte ^= flip;
        }
        prop_assert!(Image::new_checked(&b).is_err());
    }
}
