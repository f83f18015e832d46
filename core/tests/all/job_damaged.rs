//! Whatever comes over the wire: a damaged job, program or measurement is refused or computed, never more.

use crate::job_support;

use job_support::{Part, Room, corner, made, short, um};
use proptest::prelude::*;
use truepath_core::gcode::DeviceMemory;
use truepath_core::image::Image;
use truepath_core::job::{COMPACT_BYTES, Job, JobError};
use truepath_core::units::{Offset, Real};

/// The result of a part is an image or an error with a code and a sentence.
fn judged(part: &Part) -> Result<(), TestCaseError> {
    match made(part) {
        Ok((made, bytes)) => {
            let image = Image::new_checked(&bytes).map_err(|e| TestCaseError::fail(e.to_string()))?;
            prop_assert_eq!(image.crc(), made.crc);
            prop_assert!(made.largest <= part.job.correct.clamp);
        }
        Err(error) => {
            prop_assert_eq!(error.code().len(), 4);
            prop_assert!(!error.to_string().is_empty());
        }
    }
    Ok(())
}

/// Changes some bytes.
fn damaged(bytes: &[u8], damage: &[(usize, u8)]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for (at, value) in damage {
        let at = at % out.len();
        out[at] = *value;
    }
    out
}

/// Bytes that occur in programs and measurements.
fn letter() -> impl Strategy<Value = u8> {
    prop_oneof![
        4 => b'0'..=b'9',
        2 => prop::sample::select(&b" -.,\n\rXYZIJRFGMST%()"[..]),
        1 => any::<u8>(),
    ]
}

/// A length anywhere, mostly where jobs are.
fn length() -> impl Strategy<Value = Offset> {
    prop_oneof![(-10i64..200_000).prop_map(um), any::<i64>().prop_map(Offset::from_nm)]
}

/// A number anywhere.
fn number() -> impl Strategy<Value = Real> {
    prop_oneof![(-2i32..30_000).prop_map(Real::from_int), any::<i64>().prop_map(Real::from_bits)]
}

/// The corner's job with one field replaced.
fn replaced(field: usize, length: Offset, number: Real) -> Job {
    let mut job = corner().job;
    let probe = job.probe.as_mut().unwrap();
    match field {
        0 => job.allowance = length,
        1 => job.tool.diameter = length,
        2 => job.tool.measured_diameter = Some(length),
        3 => job.tool.helix_deg = number,
        4 => job.cut.axial_depth = length,
        5 => job.cut.spindle_rpm = Some(number),
        6 => job.cut.feed_mm_per_min = Some(number),
        7 => job.force.ktc = number,
        8 => job.force.krc = number,
        9 => job.force.kte = number,
        10 => job.machine.stiffness_x = number,
        11 => probe.ball_diameter = length,
        12 => probe.noise = length,
        13 => job.correct.clamp = length,
        14 => job.correct.band[1] = length,
        15 => job.correct.max_gouge = Some(length),
        16 => job.tool.number = Some(number.bits() as u32),
        17 => job.tool.offset_number = number.bits() as u32,
        18 => job.correct.setup = number.bits() as u32,
        _ => job.tool.teeth = number.bits() as u8,
    }
    job
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_a_checked_job_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..160)) {
        if let Ok(job) = Job::from_compact(&bytes) {
            prop_assert_eq!(job.check(), Ok(()));
        }
    }

    #[test]
    fn a_damaged_compact_job_is_refused_or_computed(damage in prop::collection::vec((any::<usize>(), any::<u8>()), 1..4)) {
        let mut buffer = [0; COMPACT_BYTES];
        let bytes = damaged(short().job.to_compact(&mut buffer).unwrap(), &damage);
        if let Ok(job) = Job::from_compact(&bytes) {
            judged(&Part { job, ..short() })?;
        }
    }

    #[test]
    fn a_quantity_out_of_range_is_refused_before_the_program_is_read(field in 0usize..20, length in length(), number in number()) {
        let job = replaced(field, length, number);
        let part = Part { job, program: b"not a program", ..corner() };
        let range = matches!(made(&part), Err(JobError::Range { .. }));
        prop_assert_eq!(range, job.check().is_err());
    }

    #[test]
    fn a_damaged_program_is_refused_or_computed(damage in prop::collection::vec((any::<usize>(), letter()), 1..5)) {
        let program = damaged(short().program, &damage).leak();
        judged(&Part { program, ..short() })?;
    }

    #[test]
    fn a_damaged_measurement_is_refused_or_computed(damage in prop::collection::vec((any::<usize>(), letter()), 1..5)) {
        let probe = damaged(short().probe, &damage).leak();
        judged(&Part { probe, ..short() })?;
    }
}

#[test]
fn the_extremes_of_every_range_are_computed_or_refused() {
    let change: [&dyn Fn(&mut Job); 8] = [
        &|j| (j.machine.stiffness_x, j.machine.stiffness_y) = (Real::from_int(10), Real::from_int(1_000_000)),
        &|j| j.force.ktc = Real::STEP,
        &|j| (j.force.ktc, j.force.krc) = (Real::from_int(20_000), Real::from_int(20_000)),
        &|j| (j.force.kte, j.force.kre) = (Real::from_int(500), Real::from_int(500)),
        &|j| j.cut.spindle_rpm = Some(Real::ONE),
        &|j| j.cut.feed_mm_per_min = Some(Real::from_int(100_000)),
        &|j| j.tool.helix_deg = Real::from_int(60),
        &|j| (j.tool.teeth, j.correct.max_gouge) = (12, Some(Offset::ZERO)),
    ];
    for change in change {
        let mut part = short();
        change(&mut part.job);
        assert_eq!(part.job.check(), Ok(()));
        judged(&part).unwrap();
    }
}

#[test]
fn the_room_of_these_tests_is_what_it_says() {
    let said = Room::COUNTS.bytes() + size_of::<DeviceMemory>();
    assert!(size_of::<Room>() >= said);
    assert!(size_of::<Room>() - said < 256);
    // What the documentation of the workspace says of the parameters.
    assert!(size_of::<DeviceMemory>() <= 10 << 10);
}
