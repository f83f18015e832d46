//! A job whose program the control compensates by the cutter's radius: it is read as the path of the cutter's centre.

use std::path::Path;

use truepath_core::gcode::Options;
use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_ground::length::Unit;
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, read_blocks};
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

const JOB: &str = include_str!("../../../demo/corner/job.toml");

const PLANT: &str = "ktc_n_per_mm2 = 700\nkrc_n_per_mm2 = 210\nkte_n_per_mm = 14\nkre_n_per_mm = 14\nstiffness_x_n_per_mm = 1500\nstiffness_y_n_per_mm = 2000\n";

/// The wall of the drawing, the cutter of 20 mm on its left, and the path of the cutter's centre beside it.
const DRAWN: &str = "%\nG21 G90 G17 G40\nT1 M6\nS1000 M3\nG0 X24 Y100 Z50\nG0 Z-10\nG1 G41 D1 X24 Y80 F400\nY35\nG3 X39 Y20 I15\nG1 X90\nG40 X110\nG0 Z50\nM30\n%\n";
const CENTRE: &str = "%\nG21 G90 G17 G40\nT1 M6\nS1000 M3\nG0 X24 Y100 Z50\nG0 Z-10\nG1 G41 D0 X34 Y80 F400\nY35\nG3 X39 Y30 I5\nG1 X90\nG40 X110 Y20\nG0 Z50\nM30\n%\n";

fn pass(program: &str, compensation: &str) -> Result<Pass, Failure> {
    let text = JOB.replace("teeth = 6", &format!("teeth = 6\n{compensation}"));
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new(""))?;
    Pass::new(job, Source::new("part.nc", program.as_bytes().to_vec()))
}

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

#[test]
fn a_compensated_program_is_the_same_contour_as_the_path_of_the_centre() {
    let drawn = shown(pass(DRAWN, "compensation = \"radius\""));
    for compensation in ["", "compensation = \"centre\""] {
        let centre = shown(pass(CENTRE, compensation));
        assert_eq!(drawn.blocks, centre.blocks);
        assert_eq!(drawn.core.setup.wall, centre.core.setup.wall);
        assert!(centre.warnings.iter().any(|w| w.contains("W013")), "{:?}", centre.warnings);
    }
    assert!(!drawn.warnings.iter().any(|w| w.contains("W013")), "{:?}", drawn.warnings);
}

/// Mills the pass, probes it and corrects its program.
fn corrected(pass: &Pass) -> CorrectedPass {
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let milled = virtual_mill::mill(pass, &machine, None).unwrap();
    let probe = virtual_mill::probe(pass, &milled, &[25.0, 40.0, 55.0, 70.0, 90.0], &[0.3, 0.8], 6.0).unwrap();
    let file = Source::new("probe.txt", probe.into_bytes());
    let measurement = shown(Measurement::read(pass, &file));
    shown(correct_pass(pass, &measurement, &[], &[Route::Program], &mut |_| ()))
}

#[test]
fn a_compensated_program_is_corrected_as_the_path_of_the_centre() {
    let [drawn, centre] = [(DRAWN, "radius"), (CENTRE, "centre")]
        .map(|(program, compensation)| corrected(&shown(pass(program, &format!("compensation = \"{compensation}\"")))));
    let difference = drawn.summary.program.unwrap();
    assert!(difference.compensation_taken_out && difference.largest_shift.mm > 0.005, "{difference:?}");
    assert!(difference.text("part.nc", Unit::Millimetre).contains("taken out of the contour"));
    let text = String::from_utf8(drawn.program.unwrap()).unwrap();
    assert!(!text.contains("G41") && text.contains("\nG40 ") && text.contains("OF THE CUTTER CENTRE"), "{text}");
    let read = |text: &[u8]| shown(read_blocks(&Source::new("corrected.nc", text.to_vec()), Options::default())).0;
    let (a, b) = (read(text.as_bytes()), read(&centre.program.unwrap()));
    assert_eq!(a.len(), b.len(), "{text}");
    for (a, b) in a.iter().zip(&b) {
        assert!(a.curve.end().distance(b.curve.end()).nm() <= 200, "{text}");
    }
}

#[test]
fn a_wall_that_the_cutter_cannot_follow_is_refused_at_its_line() {
    let tight = DRAWN.replace("I15", "I8").replace("X39 Y20", "X32 Y27").replace("X90\n", "X90 Y27\n");
    let shown = pass(&tight, "compensation = \"radius\"").expect_err("it does not fit").render(Form::Plain);
    assert!(shown.contains("G122") && shown.contains("part.nc:9") && shown.contains("8.000 mm"), "{shown}");
    let shown = pass(DRAWN, "compensation = \"diameter\"").expect_err("no such choice").render(Form::Plain);
    assert!(shown.contains("J007") && shown.contains("radius"), "{shown}");
}

#[test]
fn leads_along_which_the_offset_is_taken_and_given_up_are_no_wall() {
    let centre = pass(CENTRE, "").expect("a readable job");
    let lines = centre.core.contour.lines;
    assert_eq!((lines.first, lines.last, centre.blocks.len()), (8, 10, 3), "the G41 and G40 moves are leads");
    let [before, behind] = centre.leads();
    assert_eq!((before.len(), behind.len()), (1, 1));
}
