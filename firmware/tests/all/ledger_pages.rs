//! Where the ledger writes, how often, and what becomes of a word that does not take what is programmed.

use crate::wire_support;
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use truepath_core::image::{Counted, MOST_KEYS, PublicKey, Rights};
use truepath_core::link::{Change, LogEntry};
use truepath_fw::flash::{BANK_BYTES, BANK_WORDS, LEDGER_SECTORS, Nor, NorError, SECTOR_BYTES, WordState};
use truepath_fw::ledger::{FIRST_COUNTER_PLACE, Ledger, MOST_COUNTED, MOST_LOGGED, PLACES};
use wire_support::{owner, public};

const PLACE: u32 = 1_024;

/// A flash that holds the ledger to the rules of the part: nothing outside its sectors, no word twice.
struct Strict {
    nor: Nor<'static>,
    /// The word that does not take what is programmed, and stays blank.
    worn: Option<u32>,
}

impl Strict {
    fn new() -> Self {
        let nor = Nor::erased(vec![0; BANK_BYTES].leak(), vec![WordState::Blank; BANK_WORDS].leak());
        Self { nor, worn: None }
    }
    fn erased(&self) -> u32 {
        self.nor.wear().erased_sectors
    }
    /// Whether a word of a place was programmed.
    fn holds(&self, sector: u32, place: usize, word: u32) -> bool {
        self.nor.word_state(address(sector, place, word)) == WordState::Programmed
    }
}

fn address(sector: u32, place: usize, word: u32) -> u32 {
    LEDGER_SECTORS.start() + sector * SECTOR_BYTES as u32 + place as u32 * PLACE + word * 32
}

impl ErrorType for Strict {
    type Error = NorError;
}

impl ReadNorFlash for Strict {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorError> {
        assert!((LEDGER_SECTORS.start()..LEDGER_SECTORS.end()).contains(&offset), "read at {offset}");
        self.nor.read(offset, bytes)
    }
    fn capacity(&self) -> usize {
        self.nor.capacity()
    }
}

impl NorFlash for Strict {
    const WRITE_SIZE: usize = 32;
    const ERASE_SIZE: usize = SECTOR_BYTES;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorError> {
        self.nor.erase(from, to)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorError> {
        assert!((LEDGER_SECTORS.start()..LEDGER_SECTORS.end()).contains(&offset), "written at {offset}");
        assert_eq!(self.nor.word_state(offset), WordState::Blank, "written twice at {offset}");
        if self.worn == Some(offset) { Ok(()) } else { self.nor.write(offset, bytes) }
    }
}

fn counted(feature: u32, counter: u32) -> Counted {
    Counted { program_crc: 7, feature, pass: 1, counter }
}

fn key(seed: u8) -> PublicKey {
    public(&owner(seed))
}

fn entry(value: u32) -> LogEntry {
    LogEntry {
        sequence: 0,
        boots: 1,
        uptime_us: 2,
        host_s: None,
        by: None,
        change: Change::Configured,
        key: None,
        value,
        refused: 0,
        counter: 0,
    }
}

/// Changes until the next one begins a sector; the last value.
fn fill(ledger: &mut Ledger, flash: &mut Strict, from: u32) -> u32 {
    let (mut boots, erased) = (from, flash.erased());
    while flash.erased() == erased {
        boots += 1;
        ledger.change(flash, |now| now.boots = boots).unwrap();
    }
    boots
}

#[test]
fn records_counters_log_and_keys_have_their_places_in_both_sectors() {
    let mut flash = Strict::new();
    let mut ledger = Ledger::open(&mut flash);
    ledger.change(&mut flash, |now| now.boots = 1).unwrap();
    ledger.raise(&mut flash, &counted(1, 5)).unwrap();
    ledger.note(&mut flash, entry(1)).unwrap();
    ledger.note(&mut flash, entry(2)).unwrap();
    (1..=2).for_each(|seed| ledger.provision(&mut flash, key(seed), Rights::default()).unwrap());
    let last = SECTOR_BYTES / PLACE as usize - 1;
    for sector in [0, 1] {
        for (place, words) in [(PLACES, 4), (FIRST_COUNTER_PLACE, 1), (last, 4)] {
            for word in 0..32 {
                assert_eq!(flash.holds(sector, place, word), word < words, "sector {sector} place {place} word {word}");
            }
        }
        assert!(flash.holds(sector, 0, 0) && !flash.holds(sector, 1, 0));
        fill(&mut ledger, &mut flash, 10 + 1_000 * sector);
    }
}

#[test]
fn a_sector_takes_as_many_records_as_it_has_places_also_over_resets() {
    for reset in [false, true] {
        let mut flash = Strict::new();
        let mut ledger = Ledger::open(&mut flash);
        for boots in 1..=3 * PLACES as u32 {
            if reset {
                ledger = Ledger::open(&mut flash);
            }
            ledger.change(&mut flash, |now| now.boots = boots).unwrap();
            assert_eq!(flash.erased(), boots.div_ceil(PLACES as u32), "{boots}");
        }
        assert_eq!(Ledger::open(&mut flash).now().boots, 3 * PLACES as u32);
    }
}

#[test]
fn keys_counters_and_entries_wear_no_sector_while_there_is_room() {
    let mut flash = Strict::new();
    let mut ledger = Ledger::open(&mut flash);
    assert!(!ledger.has_waiting());
    ledger.change(&mut flash, |now| now.boots = 1).unwrap();
    for seed in 1..=MOST_KEYS as u8 {
        ledger.provision(&mut flash, key(seed), Rights::default()).unwrap();
    }
    ledger.revoke(&mut flash, key(1).id()).unwrap();
    (1..100).for_each(|counter| ledger.raise(&mut flash, &counted(1, counter)).unwrap());
    (1..100).for_each(|value| ledger.note(&mut flash, entry(value)).unwrap());
    let before = flash.nor.wear();
    assert_eq!(before.erased_sectors, 1);
    // What is known already is not written again.
    ledger.provision(&mut flash, key(2), Rights::default()).unwrap();
    ledger.revoke(&mut flash, key(1).id()).unwrap();
    ledger.raise(&mut flash, &counted(1, 99)).unwrap();
    assert_eq!(flash.nor.wear(), before);
}

#[test]
fn what_a_worn_word_did_not_take_is_written_elsewhere() {
    let last = SECTOR_BYTES / PLACE as usize - 1;
    let words =
        [(0, 0), (0, 1), (1, 0), (1, 1), (FIRST_COUNTER_PLACE, 0), (PLACES, 0), (PLACES, 1), (last, 0), (last, 1)];
    for (place, word) in words {
        let mut flash = Strict::new();
        flash.worn = Some(address(0, place, word));
        let mut ledger = Ledger::open(&mut flash);
        ledger.change(&mut flash, |now| now.boots = 1).unwrap();
        ledger.change(&mut flash, |now| now.boots = 2).unwrap();
        ledger.raise(&mut flash, &counted(1, 5)).unwrap();
        ledger.note(&mut flash, entry(9)).unwrap();
        ledger.provision(&mut flash, key(1), Rights::default()).unwrap();
        let ledger = Ledger::open(&mut flash);
        assert_eq!(ledger.now().boots, 2, "{place} {word}");
        assert_eq!(ledger.least(&mut flash, &counted(1, 0)), 5, "{place} {word}");
        assert!(ledger.logged(&mut flash).map(|entry| entry.value).eq([9]), "{place} {word}");
        assert_eq!(ledger.keys().iter().collect::<Vec<_>>(), [&key(1)], "{place} {word}");
    }
}

#[test]
fn the_counter_of_every_pass_is_the_lowest_that_had_no_room_and_goes_with_the_sector() {
    let mut flash = Strict::new();
    let mut ledger = Ledger::open(&mut flash);
    let most = MOST_COUNTED as u32;
    (1..=most).for_each(|feature| ledger.raise(&mut flash, &counted(feature, 1_000 + feature)).unwrap());
    // One that is known pushes out none.
    ledger.raise(&mut flash, &counted(2, 5_000)).unwrap();
    assert_eq!(ledger.least(&mut flash, &counted(9_999, 0)), 0);
    ledger.raise(&mut flash, &counted(most + 1, 6_000)).unwrap();
    let mut boots = 0;
    for change in 0..4 {
        let mut least = |feature| ledger.least(&mut flash, &counted(feature, 0));
        let known = [least(9_999), least(1), least(2), least(3), least(most + 1)];
        assert_eq!(known, [1_001, 1_001, 5_000, 1_003, 6_000], "change {change}");
        boots = fill(&mut ledger, &mut flash, boots);
        ledger = Ledger::open(&mut flash);
    }
}

#[test]
fn one_that_is_lower_than_all_that_are_known_is_that_of_every_pass_and_takes_no_room() {
    let mut flash = Strict::new();
    let mut ledger = Ledger::open(&mut flash);
    (1..=MOST_COUNTED as u32).for_each(|feature| ledger.raise(&mut flash, &counted(feature, 1_000)).unwrap());
    let programmed = flash.nor.wear().programmed_words;
    ledger.raise(&mut flash, &counted(500, 5)).unwrap();
    assert_eq!(flash.nor.wear().programmed_words - programmed, 1);
    assert_eq!([500, 501].map(|feature| ledger.least(&mut flash, &counted(feature, 0))), [5, 5]);
}

#[test]
fn passes_without_end_with_the_same_counters_always_find_room() {
    let mut flash = Strict::new();
    let mut ledger = Ledger::open(&mut flash);
    let most = MOST_COUNTED as u32;
    for feature in 0..6 * most {
        // Whole rows of them are as low as that of every pass becomes.
        let of = counted(feature, 10 + feature / most);
        ledger.raise(&mut flash, &of).unwrap();
        assert!(ledger.least(&mut flash, &of) >= of.counter);
    }
}

#[test]
fn of_the_log_the_newest_are_kept_and_their_order_over_changes_of_the_sector() {
    let mut flash = Strict::new();
    let mut ledger = Ledger::open(&mut flash);
    let mut boots = 0;
    for value in 1..=3 * MOST_LOGGED as u32 {
        ledger.note(&mut flash, entry(value)).unwrap();
        if value % 50 == 0 {
            boots = fill(&mut ledger, &mut flash, boots);
            ledger = Ledger::open(&mut flash);
            let kept: Vec<_> = ledger.logged(&mut flash).map(|entry| (entry.sequence, entry.value)).collect();
            let first = (value + 1).saturating_sub(MOST_LOGGED as u32).max(1);
            assert_eq!(kept, (first..=value).map(|n| (n, n)).collect::<Vec<_>>());
            assert_eq!(ledger.next_entry(), value + 1);
        }
    }
}
