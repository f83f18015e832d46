//! One part, one arming, over a series of parts: what the ledger still knows after hundreds of armings and resets.

use crate::wire_support;
use truepath_core::link::{Ask, Denial, ResetCause};
use truepath_core::rewrite::{Refusal, Spent};
use truepath_fw::flash::{BANK_BYTES, BANK_WORDS, Nor, WordState};
use truepath_fw::ledger::Ledger;
use wire_support::part::straight;
use wire_support::*;

const PARTS: u32 = 100;

fn erased() -> Nor<'static> {
    Nor::erased(vec![0; BANK_BYTES].leak(), vec![WordState::Blank; BANK_WORDS].leak())
}

fn repeated(rig: &mut Rig, last: u32) {
    for part_serial in 1..=last {
        let expected = Err(Denial::Refused(Refusal::PartRepeated { part_serial }));
        let request = rig.request(part_serial);
        assert_eq!(rig.done(Ask::Check(request)), expected, "{part_serial} of {last}");
    }
    assert_eq!(rig.arm(1), Err(Denial::Refused(Refusal::PartRepeated { part_serial: 1 })));
}

#[test]
fn every_part_of_a_long_series_stays_spent_also_after_resets() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.enable();
    for part in 1..=PARTS {
        rig.arm(part).unwrap();
        rig.done(Ask::Disarm).unwrap();
        repeated(&mut rig, part);
        if part % 10 == 7 {
            rig.reset(ResetCause::Watchdog);
            rig.enable();
            repeated(&mut rig, part);
        }
    }
    let request = rig.request(PARTS + 1);
    rig.done(Ask::Check(request)).unwrap();
    // Servo and ledger agree on what is known.
    let state = rig.device().state();
    assert!((1..=PARTS).all(|part| state.spent().contains(&spent(part, request.binding.feature, &request))));
}

fn spent(part_serial: u32, feature: u32, request: &truepath_core::rewrite::ArmRequest) -> Spent {
    Spent { part_serial, program_crc: request.binding.program_crc, feature, pass: request.binding.pass }
}

#[test]
fn every_feature_of_every_part_of_a_long_series_stays_spent_also_after_resets() {
    let of = |part_serial, feature| Spent { part_serial, program_crc: 0xFFFF_FFFE, feature, pass: 1 };
    let mut nor = erased();
    for part in 1..=PARTS {
        // A reset before every part.
        let mut ledger = Ledger::open(&mut nor);
        for feature in 0..20 {
            assert!(!ledger.now().is_spent(&of(part, feature)), "{part}, {feature}");
            ledger.change(&mut nor, |now| now.spend(of(part, feature))).unwrap();
        }
        for ledger in [ledger, Ledger::open(&mut nor)] {
            for (part, feature) in (1..=part).flat_map(|part| (0..20).map(move |feature| (part, feature))) {
                assert!(ledger.now().is_spent(&of(part, feature)), "{part}, {feature}");
            }
        }
    }
}
