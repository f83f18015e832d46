//! The ends of what an image may hold: each is taken, and what lies one beyond it is refused.

use crate::rewrite_support as part;
use part::{MM, fine, nodes, settings};
use truepath_units::geometry::Point;
use truepath_units::{Offset, Position, Real};
use truepath_wire::image::{
    FACTOR_ONE, FeedLaw, Field, FineOffset, HEADER_BYTES, Image, ImageError, ImageNode, ImageSettings, NODE_BYTES,
    build, crc32, image_bytes, peak,
};

/// Coordinates of a program, 1000 m.
const PLACE: i64 = 1_000_000 * MM;

fn built(settings: &ImageSettings, nodes: &[ImageNode]) -> Result<Vec<u8>, ImageError> {
    let mut bytes = vec![0; image_bytes(nodes.len())];
    build(settings, nodes, &mut bytes).map(drop)?;
    Ok(bytes)
}

/// Nodes without a correction, some way apart along X.
fn plain(count: i64, step: i64) -> Vec<ImageNode> {
    let node = |i| ImageNode { point: Point::from_nm(i * step, 0), ..ImageNode::default() };
    (0..count).map(node).collect()
}

#[test]
fn the_values_of_the_head_are_taken_to_their_ends_and_no_further() {
    type Set = fn(&mut ImageSettings, i64);
    let values: [(Field, i64, i64, Set); 13] = [
        (Field::FeedPerTooth, 1 << 8, (8 * MM) << 8, |s, v| s.feed.per_tooth = FineOffset::from_bits(v as i32)),
        (Field::Teeth, 1, 64, |s, v| s.feed.teeth = v as u32),
        (Field::SizeExponent, 0, 1 << 16, |s, v| s.feed.size_exponent = v as u32),
        (Field::RatioLow, 0, 1 << 16, |s, v| s.feed.ratio_low = v as u32),
        (Field::RatioHigh, 1 << 16, 2 << 16, |s, v| s.feed.ratio_high = v as u32),
        (Field::Clamp, 1, 4 * MM, |s, v| (s.limits.clamp, s.limits.warn) = (Offset::from_nm(v), Offset::ZERO)),
        (Field::Warn, 0, 500_000, |s, v| s.limits.warn = Offset::from_nm(v)),
        (Field::Slew, 1, 4_000_000_000, |s, v| s.limits.slew_nm_per_s = v as u32),
        (Field::Acceleration, 1, PLACE, |s, v| s.limits.acceleration_nm_per_s2 = v as u64),
        (Field::Tolerance, 1_000, 5 * MM, |s, v| s.window.tolerance = Offset::from_nm(v)),
        (Field::PassLow, -PLACE, part::PASS, |s, v| s.window.z_low = Position::from_nm(v)),
        (Field::Gate, 0, 1_000 * MM, |s, v| s.window.gate_height = Offset::from_nm(v)),
        (Field::NodeStep, 1_000, MM, |s, v| s.node_step = Offset::from_nm(v)),
    ];
    for (field, low, high, set) in values {
        let with = |value| {
            let mut settings = settings();
            set(&mut settings, value);
            built(&settings, &plain(3, 100_000))
        };
        for value in [low, high] {
            assert_eq!(with(value).err(), None, "{field:?} {value}");
        }
        for value in [low - 1, high + 1] {
            let found = with(value);
            assert!(
                matches!(found, Err(ImageError::Range { name, .. }) if name == field),
                "{field:?} {value}: {found:?}"
            );
        }
    }
}

#[test]
fn places_are_taken_to_a_thousand_metres() {
    let of_pass = |z: i64| {
        let mut settings = settings();
        (settings.window.z_low, settings.window.z_high) = (Position::from_nm(-PLACE), Position::from_nm(z));
        built(&settings, &plain(3, 100_000)).err()
    };
    let of_origin = |x: i64, y: i64| {
        let moved = |n: ImageNode| ImageNode { point: Point::from_nm(n.point.x.nm() + x, y), ..n };
        built(&settings(), &plain(3, 100_000).into_iter().map(moved).collect::<Vec<_>>()).err()
    };
    let beyond = |error: Option<ImageError>, field: Field| matches!(error, Some(ImageError::Range { name, .. }) if name == field);
    for sign in [1, -1] {
        let (end, further) = (sign * PLACE, sign * (PLACE + 1));
        assert_eq!([of_pass(end), of_origin(end, 0), of_origin(0, end)], [None; 3]);
        assert!(beyond(of_origin(further, 0), Field::OriginX) && beyond(of_origin(0, further), Field::OriginY));
    }
    assert!(beyond(of_pass(PLACE + 1), Field::PassHigh) && beyond(of_pass(-PLACE - 1), Field::PassLow));
}

#[test]
fn neighbours_are_a_micrometre_to_a_millimetre_apart() {
    for (step, right) in [(999, false), (1_000, true), (MM, true), (MM + 1, false)] {
        assert_eq!(built(&settings(), &plain(3, step)).is_ok(), right, "{step}");
    }
}

#[test]
fn the_factor_may_stay_and_may_be_two_and_is_one_at_the_nominal_feed() {
    let with = |exponent: Real, entry: usize, value: u32| {
        let mut settings = settings();
        let feed = settings.feed;
        settings.feed = FeedLaw::new(feed.per_tooth, feed.teeth, 0, exponent, Real::HALF, Real::from_int(2));
        if value > 0 {
            settings.feed.factor[entry] = value;
        }
        built(&settings, &plain(3, 100_000)).err()
    };
    // Everywhere 1, and from 0 to 2.
    assert_eq!([with(Real::ONE, 0, 0), with(Real::ZERO, 0, 0)], [None; 2]);
    let one = FACTOR_ONE as u32;
    for (entry, value) in [(32, 2 * one + 1), (16, one + 1), (16, one - 1), (15, one + 1), (17, one - 1)] {
        // Where a neighbour is too great, the entry behind it is the one that falls, or is not 1.
        let entry_named = if entry == 15 { 16 } else { entry };
        assert_eq!(with(Real::ZERO, entry, value), Some(ImageError::FactorTable { entry: entry_named }), "{entry}");
    }
}

/// What is said of an image whose bytes were changed behind a right checksum.
fn resealed(settings: &ImageSettings, change: impl FnOnce(&mut [[u8; NODE_BYTES]])) -> Option<ImageError> {
    let mut bytes = built(settings, &plain(5, 100_000)).unwrap();
    let end = bytes.len() - 4;
    change(bytes[HEADER_BYTES..end].as_chunks_mut().0);
    let crc = crc32(&bytes[..end]);
    bytes[end..].copy_from_slice(&crc.to_le_bytes());
    Image::new_checked(&bytes).err()
}

#[test]
fn the_first_node_is_the_origin_and_the_last_has_no_way_behind_it() {
    let settings = settings();
    for axis in [0, 4] {
        // All of them are moved, so that the ways between them stay.
        let found = resealed(&settings, |nodes| nodes.iter_mut().for_each(|node| node[axis] ^= 1));
        assert_eq!(found, Some(ImageError::Derived { node: 0 }));
    }
    for field in [24, 28] {
        assert_eq!(resealed(&settings, |nodes| nodes[4][field] = 1), Some(ImageError::Derived { node: 4 }));
    }
    assert_eq!(resealed(&settings, |nodes| nodes[1][24] ^= 1), Some(ImageError::Derived { node: 1 }));
}

#[test]
fn a_closed_path_ends_where_it_begins_in_both_axes() {
    let closed = ImageSettings { closed: true, ..settings() };
    let path = |x: i64, y: i64| nodes([(0, 0), (100_000, 0), (100_000, 100_000), (x, y)]);
    assert_eq!(built(&closed, &path(0, 0)).err(), None);
    for (x, y) in [(1, 0), (0, 1)] {
        assert_eq!(built(&closed, &path(x, y)).err(), Some(ImageError::NotClosed));
    }
}

#[test]
fn the_reach_of_a_correction_is_rounded_up() {
    let of = |bits: i32| {
        let edge = [FineOffset::from_bits(bits), FineOffset::ZERO];
        peak([ImageNode { edge, ..ImageNode::default() }], &settings().feed).nm()
    };
    assert_eq!([of(256), of(257), of(511), of(-512), of(-513)], [1, 2, 2, 2, 3]);
    // At the clamp itself it is taken.
    let mut nodes = plain(3, 100_000);
    nodes[1].edge = [fine(-500_000), FineOffset::ZERO];
    assert_eq!(built(&settings(), &nodes).err(), None);
    nodes[1].edge[0] = FineOffset::from_bits(nodes[1].edge[0].bits() - 1);
    let found = built(&settings(), &nodes).err();
    assert_eq!(found, Some(ImageError::OverClamp { node: 1, correction_nm: 500_001, clamp_nm: 500_000 }));
}
