//! The ledger's records, written by hand from their layout.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::checksum::crc32;
use truepath_core::image::{Counted, Rights};
use truepath_core::link::{ActiveImage, Change, DeviceSettings, LogEntry};
use truepath_core::rewrite::Spent;
use truepath_fw::flash::{BANK_BYTES, BANK_WORDS, Cut, LEDGER_SECTORS, Moment, Nor, SECTOR_BYTES, WordState};
use truepath_fw::ledger::{Ledger, PLACES, Remembered};

use crate::wire_support::{owner, public};

fn erased() -> Nor<'static> {
    Nor::erased(vec![0; BANK_BYTES].leak(), vec![WordState::Blank; BANK_WORDS].leak())
}

fn part(part_serial: u32) -> Spent {
    Spent { part_serial, program_crc: 2, feature: 3, pass: 4 }
}

/// A record at a place, as the layout says; `crc` is that of the payload in its head.
fn record(nor: &mut Nor<'_>, sector: usize, place: usize, sequence: u32, payload: &[u8], crc: u32) {
    sealed_record(nor, *b"TPL2", sector, place, sequence, payload, crc);
}

fn sealed_record(
    nor: &mut Nor<'_>,
    magic: [u8; 4],
    sector: usize,
    place: usize,
    sequence: u32,
    payload: &[u8],
    crc: u32,
) {
    let at = LEDGER_SECTORS.start() + (sector * SECTOR_BYTES + place * 1_024) as u32;
    let mut padded = payload.to_vec();
    padded.resize(payload.len().next_multiple_of(32), 0);
    nor.write(at + 32, &padded).unwrap();
    let mut head = [0; 32];
    head[..4].copy_from_slice(&magic);
    head[4..8].copy_from_slice(&sequence.to_le_bytes());
    head[8..12].copy_from_slice(&(payload.len() as u32).to_le_bytes());
    head[12..16].copy_from_slice(&crc.to_le_bytes());
    let sum = crc32(&head[..28]);
    head[28..].copy_from_slice(&sum.to_le_bytes());
    nor.write(at, &head).unwrap();
}

fn payload(boots: u32) -> Vec<u8> {
    let settings = Some(DeviceSettings::at_1_khz());
    let mut remembered = Remembered { boots, settings, ..Remembered::default() };
    remembered.spend(part(boots));
    encoded(&remembered)
}

fn encoded(value: &impl serde::Serialize) -> Vec<u8> {
    postcard::to_slice(value, &mut [0; 992]).unwrap().to_vec()
}

#[test]
fn the_newest_undamaged_record_counts_wherever_it_lies() {
    let mut nor = erased();
    for (sector, place, sequence) in [(1, 0, 7), (1, 1, 8), (0, 5, 9), (0, 2, 3)] {
        let payload = payload(sequence);
        record(&mut nor, sector, place, sequence, &payload, crc32(&payload));
    }
    assert_eq!(Ledger::open(&mut nor).now().boots, 9);
    // Newer ones whose payload is not what the head says, or that are no record at all.
    let damaged = payload(10);
    record(&mut nor, 0, 6, 10, &damaged, crc32(&damaged) ^ 1);
    record(&mut nor, 0, 7, 11, &[], 5);
    let at = LEDGER_SECTORS.start() + 8 * 1_024;
    nor.write(at, &[0; 32]).unwrap();
    let mut ledger = Ledger::open(&mut nor);
    assert_eq!(ledger.now().boots, 9);
    assert!(ledger.now().is_spent(&part(9)));
    // And what is written now goes behind all of that.
    ledger.change(&mut nor, |now| now.boots = 50).unwrap();
    assert_eq!(Ledger::open(&mut nor).now().boots, 50);
    assert_eq!(nor.word_state(LEDGER_SECTORS.start() + 9 * 1_024), WordState::Programmed);
}

#[test]
fn a_record_of_another_firmware_still_tells_which_parts_were_armed() {
    let mut nor = erased();
    // The settings behind it have another layout: longer, and cut off.
    for (place, bytes) in [payload(1), payload(2)].into_iter().enumerate() {
        let mut bytes = bytes;
        let end = bytes.len() - 9;
        bytes.truncate(end);
        record(&mut nor, 0, place, place as u32 + 1, &bytes, crc32(&bytes));
    }
    let ledger = Ledger::open(&mut nor);
    assert!(ledger.now().is_spent(&part(2)));
    assert_eq!(ledger.now().settings, None);
}

/// The record before its settings had caps of the correction: everything before and behind them is as it was.
fn payload_without_caps(boots: u32, settings: DeviceSettings) -> Vec<u8> {
    let mut remembered = Remembered { boots, settings: Some(settings), ..Remembered::default() };
    remembered.spend(part(boots));
    let whole = encoded(&remembered);
    let caps = (settings.rewriter.correction_slew_nm_per_s, settings.rewriter.correction_acceleration_nm_per_s2);
    let caps = encoded(&caps);
    let tail = encoded(&(settings.axes, settings.deadline_us, settings.silence_us, boots));
    let end = whole.len() - tail.len();
    let begin = end - caps.len();
    assert_eq!((&whole[begin..end], &whole[end..]), (&caps[..], &tail[..]));
    [&whole[..begin], &tail[..]].concat()
}

#[test]
fn a_record_from_before_the_caps_tells_the_armed_parts_and_is_never_taken_for_other_settings() {
    for boots in [0, 1, 127, 128, 300, 70_000, u32::MAX] {
        for (deadline_us, silence_us) in [(10, 4_000), (128, 16_384), (500, 20_000), (1_000_000, 10_000_000)] {
            let settings = DeviceSettings { deadline_us, silence_us, ..DeviceSettings::at_1_khz() };
            let bytes = payload_without_caps(boots, settings);
            let mut nor = erased();
            record(&mut nor, 0, 0, 1, &bytes, crc32(&bytes));
            let ledger = Ledger::open(&mut nor);
            assert!(ledger.now().is_spent(&part(boots)));
            assert_eq!(ledger.now().settings, None, "{boots} {deadline_us} {silence_us}");
        }
    }
}

#[test]
fn settings_that_are_out_of_range_count_as_none() {
    let mut nor = erased();
    let settings = DeviceSettings { axes: 9, ..DeviceSettings::at_1_khz() };
    let wrong = Remembered { boots: 4, settings: Some(settings), ..Remembered::default() };
    let mut buffer = [0; 992];
    let bytes = postcard::to_slice(&wrong, &mut buffer).unwrap();
    record(&mut nor, 0, 0, 1, bytes, crc32(bytes));
    let ledger = Ledger::open(&mut nor);
    assert_eq!((ledger.now().boots, ledger.now().settings), (4, None));
    assert_eq!(ledger.now().settings_in_use(), DeviceSettings::at_1_khz());
}

#[test]
fn the_longest_record_fits_into_its_place() {
    let mut nor = erased();
    let mut ledger = Ledger::open(&mut nor);
    let longest = |now: &mut Remembered| {
        for feature in 0..100 {
            now.spend(Spent { part_serial: u32::MAX, program_crc: u32::MAX, feature, pass: u32::MAX });
        }
        now.active = Some(ActiveImage { slot: 255, crc: u32::MAX });
        now.boots = u32::MAX;
        let mut settings =
            DeviceSettings { deadline_us: 1_000_000, silence_us: 10_000_000, ..DeviceSettings::at_1_khz() };
        settings.rewriter.joint_limits_nm = [(i64::MIN, i64::MAX); 6];
        settings.rewriter.hold_after_ticks = 1 << 31;
        settings.rewriter.spindle_stale_ticks = u32::MAX;
        settings.rewriter.correction_slew_nm_per_s = u32::MAX;
        settings.rewriter.correction_acceleration_nm_per_s2 = 1_000_000_000_000;
        now.settings = Some(settings);
    };
    ledger.change(&mut nor, longest).unwrap();
    assert!(ledger.now().settings.unwrap().check().is_ok());
    assert_eq!(Ledger::open(&mut nor).now(), ledger.now());
}

#[test]
fn a_record_of_the_version_before_is_no_record() {
    let mut nor = erased();
    let bytes = payload(3);
    record(&mut nor, 0, 0, 1, &bytes, crc32(&bytes));
    assert_eq!(Ledger::open(&mut nor).now().boots, 3);
    let mut nor = erased();
    sealed_record(&mut nor, *b"TPL1", 0, 0, 1, &bytes, crc32(&bytes));
    assert_eq!(*Ledger::open(&mut nor).now(), Remembered::default());
    // And its place does not stand in the way of what comes.
    Ledger::open(&mut nor).change(&mut nor, |now| now.boots = 8).unwrap();
    assert_eq!(Ledger::open(&mut nor).now().boots, 8);
}

#[test]
fn thousands_of_changes_wear_both_sectors_alike() {
    let mut nor = erased();
    let mut ledger = Ledger::open(&mut nor);
    let rounds = 10;
    for boots in 1..=(2 * rounds * PLACES) as u32 {
        ledger.change(&mut nor, |now| now.boots = boots).unwrap();
        if boots % 100 == 0 {
            ledger = Ledger::open(&mut nor);
            assert_eq!(ledger.now().boots, boots);
        }
    }
    assert_eq!(nor.wear().erased_sectors, 2 * rounds as u32);
}

#[test]
fn a_change_that_changes_nothing_costs_nothing() {
    let mut nor = erased();
    let mut ledger = Ledger::open(&mut nor);
    ledger.change(&mut nor, |now| now.boots = 1).unwrap();
    let before = nor.wear();
    ledger.change(&mut nor, |now| now.boots = 1).unwrap();
    assert_eq!(nor.wear(), before);
}

/// Ledgers whose last change failed, at each operation and moment of it, with their flash under power again: from one with a key and so
/// many records before.
fn failed_anywhere(records: u32) -> impl Iterator<Item = (String, Nor<'static>, Ledger)> {
    let moments = [Moment::Before, Moment::Within(5), Moment::After];
    (0..20).flat_map(move |after_operations| moments.map(|moment| Cut { after_operations, moment })).filter_map(
        move |cut| {
            let mut nor = erased();
            let mut ledger = Ledger::open(&mut nor);
            for boots in 1..=records {
                ledger.change(&mut nor, |now| now.boots = boots).unwrap();
            }
            ledger.provision(&mut nor, public(&owner(1)), Rights::default()).unwrap();
            nor.cut(Some(cut));
            ledger.change(&mut nor, |now| now.boots = 0).err()?;
            nor.power_up();
            Some((format!("{cut:?} of {records}"), nor, ledger))
        },
    )
}

#[test]
fn what_is_remembered_counts_again_as_soon_as_it_is_changed_back_behind_a_change_that_failed() {
    let mut in_flash = 0;
    for (cut, mut nor, mut ledger) in [1, PLACES as u32].into_iter().flat_map(failed_anywhere) {
        let boots = ledger.now().boots;
        assert!(boots > 0 && ledger.is_in_doubt(), "{cut}");
        in_flash += usize::from(Ledger::open(&mut nor).now().boots == 0);
        ledger.change(&mut nor, |now| now.boots = boots).unwrap();
        assert!(!ledger.is_in_doubt(), "{cut}");
        assert_eq!(Ledger::open(&mut nor).now().boots, boots, "{cut}");
    }
    assert_eq!(in_flash, 2, "the last word was written, and nobody heard of it");
}

#[test]
fn what_is_written_beside_the_records_behind_a_change_that_failed_is_found_again() {
    let ([key, new], image) =
        ([1, 2].map(|seed| public(&owner(seed))), Counted { program_crc: 1, feature: 2, pass: 3, counter: 4 });
    let entry = LogEntry {
        sequence: 0,
        boots: 7,
        uptime_us: 0,
        host_s: None,
        by: None,
        change: Change::Restarted,
        key: None,
        value: 9,
        refused: 0,
        counter: 0,
    };
    let ledgers = || [1, PLACES as u32].into_iter().flat_map(failed_anywhere);
    // Until a sector has been erased, and the power failed behind that.
    let through_an_erase = |nor: &mut Nor<'_>| {
        let before = nor.wear().erased_sectors;
        while nor.wear().erased_sectors == before {
            nor.cut(Some(Cut { after_operations: 1, moment: Moment::Before }));
            let mut ledger = Ledger::open(nor);
            ledger.change(nor, |now| now.boots += 1).unwrap_err();
            nor.power_up();
        }
        Ledger::open(nor)
    };
    for (cut, mut nor, mut ledger) in ledgers() {
        ledger.provision(&mut nor, new, Rights::default()).unwrap();
        assert!(Ledger::open(&mut nor).keys().iter().eq([&key, &new]), "{cut}");
        assert!(through_an_erase(&mut nor).keys().iter().eq([&key, &new]), "{cut}");
    }
    for (cut, mut nor, mut ledger) in ledgers() {
        ledger.revoke(&mut nor, key.id()).unwrap();
        assert!(Ledger::open(&mut nor).keys().is_revoked(key.id()), "{cut}");
        assert!(through_an_erase(&mut nor).keys().is_revoked(key.id()), "{cut}");
    }
    for (cut, mut nor, mut ledger) in ledgers() {
        ledger.raise(&mut nor, &image).unwrap();
        assert_eq!(Ledger::open(&mut nor).least(&mut nor, &image), 4, "{cut}");
        assert_eq!(through_an_erase(&mut nor).least(&mut nor, &image), 4, "{cut}");
    }
    for (cut, mut nor, mut ledger) in ledgers() {
        ledger.note(&mut nor, entry).unwrap();
        let found = Ledger::open(&mut nor);
        assert_eq!(found.logged(&mut nor).last().map(|entry| entry.value), Some(9), "{cut}");
        let found = through_an_erase(&mut nor);
        assert_eq!(found.logged(&mut nor).last().map(|entry| entry.value), Some(9), "{cut}");
    }
}

#[test]
fn power_that_fails_at_every_start_leaves_the_next_change_its_place() {
    let mut nor = erased();
    let mut ledger = Ledger::open(&mut nor);
    let configured = |now: &mut Remembered| now.settings = Some(DeviceSettings::at_1_khz());
    ledger.change(&mut nor, configured).unwrap();
    ledger.change(&mut nor, |now| now.spend(part(1))).unwrap();
    for start in 0..3 * PLACES as u32 {
        // Some words of the record are written, one is torn, the head never is.
        nor.cut(Some(Cut { after_operations: start % 4, moment: Moment::Within(start) }));
        let mut ledger = Ledger::open(&mut nor);
        ledger.change(&mut nor, |now| now.boots = start + 1).unwrap_err();
        assert!(!nor.is_powered());
        nor.power_up();
        assert!(Ledger::open(&mut nor).now().is_spent(&part(1)), "start {start}");
    }
    let mut ledger = Ledger::open(&mut nor);
    let before = nor.wear().programmed_words;
    ledger.change(&mut nor, |now| now.spend(part(2))).unwrap();
    assert!(nor.wear().programmed_words - before < 32, "at the first attempt");
    assert!(Ledger::open(&mut nor).now().is_spent(&part(1)) && Ledger::open(&mut nor).now().is_spent(&part(2)));
}

#[test]
fn records_of_a_firmware_without_counters_in_the_places_behind_are_found_and_left_for_the_other_sector() {
    use truepath_core::image::{Binding, Counted};
    let mut nor = erased();
    for (place, sequence) in [(PLACES - 1, 1), (PLACES, 2), (PLACES + 2, 3), (PLACES + 4, 4)] {
        let bytes = payload(sequence);
        record(&mut nor, 0, place, sequence, &bytes, crc32(&bytes));
    }
    let mut ledger = Ledger::open(&mut nor);
    assert_eq!(ledger.now().boots, 4);
    // Between them there are blank words, which may hold counters; a record goes to the other sector.
    let counted = Counted::of(&Binding::default(), 7);
    ledger.raise(&mut nor, &counted).unwrap();
    ledger.change(&mut nor, |now| now.boots = 5).unwrap();
    let ledger = Ledger::open(&mut nor);
    assert_eq!((ledger.now().boots, nor.wear().erased_sectors), (5, 1));
    assert!((1..=4).all(|boots| boots == 4 || !ledger.now().is_spent(&part(boots))) && ledger.now().is_spent(&part(4)));
}
