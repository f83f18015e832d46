//! A probe file that names the correction its part was cut with, in every format that has room for it.

use truepath_core::probe::CutWith;
use truepath_ground::diagnostics::{Form, Source};
use truepath_job::measurement::Measurement;

use crate::probe_files::{named, pass, replaced};

/// Name, format, and what to replace by what to make it a file of a corrected part.
const FILES: [(&str, &str, &str, &str); 4] = [
    ("linuxcnc-log.txt", "linuxcnc-log", "# unit mm", "# correction 00C0FFEE\n# unit mm"),
    ("dprnt.txt", "dprnt", "UNIT MM", "CORRECTION 00C0FFEE\nUNIT MM"),
    ("inspection.txt", "inspection", "START", "START\nCORRECTION 00c0ffee"),
    ("grbl.txt", "grbl", "[PRB:-345.432", ">>> ;VERIFY CORRECTION 00c0ffee\n[PRB:-345.432"),
];
const OWN: u32 = 0x00C0_FFEE;

#[test]
fn it_is_read_for_that_correction_and_for_any_and_refused_otherwise() {
    for (name, format, from, to) in FILES {
        let file = Source::new("probe.txt", replaced(name, from, to));
        let read = |cut_with| Measurement::read(&pass(&named(format), "6.0").cut_with(cut_with), &file);
        let fails = |cut_with| read(cut_with).expect_err(name).render(Form::Plain);
        let corrected = fails(CutWith::Nothing);
        assert!(corrected.contains("M038") && corrected.contains("correction 00c0ffee"), "{name}: {corrected}");
        assert!(corrected.contains("truepath learn"), "{name}: {corrected}");
        let other = fails(CutWith::Correction([Some(0x1234_5678), None]));
        assert!(other.contains("M039"), "{name}: {other}");
        let plain = Source::new("probe.txt", crate::probe_files::file(name));
        let expected = Measurement::read(&pass(&named(format), "6.0"), &plain).unwrap().contacts;
        for cut_with in
            [CutWith::Anything, CutWith::Correction([Some(OWN), None]), CutWith::Correction([None, Some(OWN)])]
        {
            let contacts = read(cut_with).unwrap_or_else(|e| panic!("{name}: {}", e.render(Form::Plain))).contacts;
            let errors =
                |contacts: &[truepath_core::probe::Contact]| contacts.iter().map(|c| c.error).collect::<Vec<_>>();
            assert_eq!(errors(&contacts), errors(&expected), "{name}");
        }
    }
}

#[test]
fn a_file_that_names_none_may_be_of_any_part() {
    for (name, format, ..) in FILES {
        let file = Source::new("probe.txt", crate::probe_files::file(name));
        for cut_with in [CutWith::Nothing, CutWith::Anything, CutWith::Correction([Some(OWN), None])] {
            assert!(Measurement::read(&pass(&named(format), "6.0").cut_with(cut_with), &file).is_ok(), "{name}");
        }
    }
}

#[test]
fn a_check_sum_that_is_none_is_refused_as_such() {
    for (name, format, from, to) in FILES {
        let spoiled = to.replace("00C0FFEE", "00C0FFEEE").replace("00c0ffee", "coffee");
        let file = Source::new("probe.txt", replaced(name, from, &spoiled));
        let text = Measurement::read(&pass(&named(format), "6.0"), &file).expect_err(name).render(Form::Plain);
        assert!(text.contains("M033") && text.contains("8 hexadecimal digits"), "{name}: {text}");
    }
}
