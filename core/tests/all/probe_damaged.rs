//! Probe files of every format, damaged in any way, are read or refused at a place inside the file.

use proptest::prelude::*;
use truepath_core::probe::{
    Columns, CutWith, DecimalSign, Format, Frame, Given, Layout, LengthUnit, PointKind, Reading, Separator, read,
};
use truepath_core::units::Offset;

use crate::job_support;

/// Files that are whole.
const FILES: [(Format, &[u8]); 7] = [
    (Format::Linuxcnc, include_bytes!("../../../host-sim/job/tests/data/probe/linuxcnc.txt")),
    (Format::LinuxcncLog, include_bytes!("../../../host-sim/job/tests/data/probe/linuxcnc-log.txt")),
    (Format::Grbl, include_bytes!("../../../host-sim/job/tests/data/probe/grbl.txt")),
    (Format::Inspection, include_bytes!("../../../host-sim/job/tests/data/probe/inspection.txt")),
    (Format::Dprnt, include_bytes!("../../../host-sim/job/tests/data/probe/dprnt.txt")),
    (Format::Dprnt, include_bytes!("../../../host-sim/job/tests/data/probe/dprnt-words.txt")),
    (Format::Columns, include_bytes!("../../../host-sim/job/tests/data/probe/columns-centre.csv")),
];

fn given(format: Format, layout: Layout) -> Given {
    Given {
        format,
        layout,
        work_offset: Some([Offset::from_um(-372_500), Offset::from_um(-250_250), Offset::from_um(-412_000)]),
        program_unit: LengthUnit::Millimetre,
        program_crc: 0x23D6_C628,
        ball_diameter: Offset::from_um(6_000),
        cut_with: CutWith::Nothing,
    }
}

/// Reads a file; readings have rising lines within it, an error points into it.
fn judged(file: &[u8], given: &Given) -> Result<usize, TestCaseError> {
    let mut readings = [Reading::default(); 16];
    let lines = file.iter().filter(|b| matches!(b, b'\n' | b'\r')).count() as u32 + 1;
    match read(file, given, &mut readings) {
        Ok(count) => {
            prop_assert!(count > 0 && readings[..count].windows(2).all(|w| w[0].line < w[1].line));
            prop_assert!(readings[..count].iter().all(|r| (1..=lines).contains(&r.line)));
            Ok(count)
        }
        Err(error) => {
            prop_assert!(error.start + error.len <= file.len(), "{error:?}");
            prop_assert!((1..=lines).contains(&error.line) && error.column >= 1, "{error:?}");
            prop_assert!(!error.kind.help().is_empty() && error.kind.code().starts_with('M'));
            Ok(0)
        }
    }
}

fn layout() -> impl Strategy<Value = Layout> {
    use Separator::{Auto, Blank, Comma, Semicolon, Tab};
    let columns = prop::option::of((any::<[u8; 3]>(), any::<Option<[u8; 2]>>(), any::<Option<u8>>()));
    let small = |c: u8| c % 9;
    let columns = columns.prop_map(move |c| {
        c.map(|(axes, normal, hit)| Columns {
            axes: axes.map(small),
            normal: normal.map(|n| n.map(small)),
            hit: hit.map(small),
        })
    });
    let separator = prop::sample::select(vec![Auto, Comma, Semicolon, Tab, Blank]);
    let decimal = prop::sample::select(vec![DecimalSign::Auto, DecimalSign::Comma, DecimalSign::Point]);
    (columns, separator, decimal, any::<[bool; 3]>()).prop_map(
        |(columns, separator, decimal, [machine, surface, inch])| Layout {
            columns,
            separator,
            decimal,
            frame: if machine { Frame::Machine } else { Frame::Work },
            point: if surface { PointKind::Surface } else { PointKind::Tip },
            unit: if inch { LengthUnit::Inch } else { LengthUnit::Millimetre },
        },
    )
}

#[test]
fn whole_files_are_read_and_a_short_buffer_is_an_error() {
    for (format, file) in FILES {
        let count = judged(file, &given(format, Layout::default())).unwrap();
        assert!((5..=11).contains(&count), "{format:?}: {count}");
        let mut short = [Reading::default(); 4];
        let error = read(file, &given(format, Layout::default()), &mut short).unwrap_err();
        assert_eq!(error.kind.code(), "M006", "{format:?}");
    }
}

#[test]
fn a_job_with_a_layout_keeps_it_in_the_compact_form() {
    let layout = Layout { columns: Some(Columns::XYZ), frame: Frame::Machine, ..Layout::default() };
    let mut job = job_support::corner().job;
    let probe = job.probe.as_mut().unwrap();
    (probe.format, probe.layout, probe.work_offset) = (Format::Columns, Some(layout), Some([Offset::from_um(-1); 3]));
    let mut buffer = [0; truepath_core::job::COMPACT_BYTES];
    let bytes = job.to_compact(&mut buffer).unwrap();
    assert_eq!(truepath_core::job::Job::from_compact(bytes), Ok(job));
    job.probe.as_mut().unwrap().work_offset = None;
    assert_eq!(job.check().unwrap_err().code(), "J025");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases.max(2_000), ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_read_or_refused(
        which in 0usize..FILES.len(),
        cut in prop::option::of(any::<prop::sample::Index>()),
        damage in prop::collection::vec((any::<prop::sample::Index>(), prop_oneof![
            any::<u8>(), prop::sample::select(&b"0123456789.,-+:;#[]GXYZNRPB$ \t\r\n"[..])
        ]), 0..6),
        layout in layout(),
    ) {
        let (format, file) = FILES[which];
        let mut bytes = file.to_vec();
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        judged(&bytes, &given(format, layout))?;
    }

    #[test]
    fn any_bytes_are_read_or_refused(
        bytes in prop::collection::vec(any::<u8>(), 0..200), which in 0usize..FILES.len(), layout in layout(),
    ) {
        judged(&bytes, &given(FILES[which].0, layout))?;
    }
}
