//! Where the fade begins and where it rests: at the gate without a spindle, and while the axes stand.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_wire::rewrite::{Flags, Mode, Status};

#[test]
fn a_dry_run_has_no_correction_from_its_first_tick() {
    for stale in [false, true] {
        let mut m = Machine::on(straight()).armed();
        if stale {
            m.next.spindle_age_ticks = 100;
        } else {
            m.next.spindle_millirpm = 0;
        }
        let [x, y, ..] = m.next.axes;
        for i in 0..100 {
            assert_eq!(m.send(x, y, GATE + (PASS - GATE) * i / 100).correction_nm, [0; 6], "tick {i} of the plunge");
        }
        let mut active = false;
        for i in 0..300 {
            let out = m.forward(1);
            assert_eq!(out.correction_nm, [0; 6], "tick {i} in the pass");
            active |= out.mode == Mode::Active && out.status.has(Status::FADED);
        }
        assert!(active);
    }
}

#[test]
fn a_correction_rests_where_it_was_when_the_axes_slow_down_into_a_standstill() {
    for flag in [false, true] {
        let mut m = Machine::on((0..=300).map(|i| (i * MM / 10, 0))).active();
        let full = m.forward(500).correction_nm;
        m.next.flags = if flag { m.next.flags.with(Flags::FEED_HOLD) } else { m.next.flags };
        // Out of the feed window on the way to standing, as every planner does.
        for part in (0..30).rev() {
            let [x, y, z, ..] = m.next.axes;
            m.send(x + FEED * part / 30, y, z);
        }
        for _ in 0..40 {
            m.stay();
        }
        let standing = m.stay();
        assert_eq!(standing.mode, Mode::Hold);
        assert_ne!(standing.correction_nm, [0; 6]);
        for tick in 0..1_000 {
            assert_eq!(m.stay().correction_nm, standing.correction_nm, "tick {tick} of the hold");
        }
        m.next.flags = Flags::DRIVES_ENABLED;
        let back = m.forward(500);
        assert_eq!(back.mode, Mode::Active);
        assert!(!back.status.has(Status::FADED), "{full:?} {:?}", back.correction_nm);
    }
}

#[test]
fn what_had_faded_before_a_standstill_stays_faded_in_it_and_fades_on_when_the_spindle_stops() {
    for flags in [Flags::DRIVES_ENABLED, Flags::DRIVES_ENABLED.with(Flags::FEED_HOLD)] {
        for stale in [false, true] {
            let mut m = Machine::on((0..=300).map(|i| (i * MM / 10, 0))).active();
            m.forward(300);
            m.next.flags = flags;
            // So slowly into the standstill that for some hundred ticks the feed is below its window.
            for part in (0..600).rev() {
                let [x, y, z, ..] = m.next.axes;
                m.send(x + FEED * part / 600, y, z);
            }
            for _ in 0..40 {
                m.stay();
            }
            let standing = m.stay();
            assert!(standing.status.has(Status::FADED) && standing.correction_nm != [0; 6], "{standing:?}");
            for tick in 0..500 {
                assert_eq!(m.stay().correction_nm, standing.correction_nm, "tick {tick} of the standstill");
            }
            if stale {
                m.next.spindle_age_ticks = 100;
            } else {
                m.next.spindle_millirpm = 0;
            }
            for _ in 0..250 {
                m.stay();
            }
            let gone = m.stay();
            assert_eq!((gone.mode, gone.correction_nm), (Mode::Hold, [0; 6]));
            // The spindle alone does not bring it back: the feed was too low when the axes last moved.
            m.next.spindle_age_ticks = 0;
            m.next.spindle_millirpm = SPINDLE;
            for _ in 0..300 {
                assert_eq!(m.stay().correction_nm, [0; 6]);
            }
            m.next.flags = Flags::DRIVES_ENABLED;
            let back = m.forward(400);
            assert!(back.mode == Mode::Active && !back.status.has(Status::FADED), "{back:?}");
        }
    }
}
