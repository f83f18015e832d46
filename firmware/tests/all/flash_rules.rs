//! The model of the flash keeps the rules of the part.

use embedded_storage::nor_flash::{NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use proptest::prelude::*;
use truepath_fw::flash::{
    BANK_BYTES, BANK_WORDS, Cut, Moment, Nor, NorError, SECTOR_BYTES, WORD_BYTES, Wear, WordState,
};

struct Memory {
    bytes: Vec<u8>,
    words: Vec<WordState>,
}

impl Memory {
    fn new() -> Self {
        Self { bytes: vec![0; BANK_BYTES], words: vec![WordState::Torn; BANK_WORDS] }
    }
    fn erased(&mut self) -> Nor<'_> {
        Nor::erased(&mut self.bytes, &mut self.words)
    }
}

#[test]
fn an_erased_bank_is_all_ones_and_whole_words_can_be_programmed_once() {
    let mut memory = Memory::new();
    let mut nor = memory.erased();
    let mut back = [0; 64];
    nor.read(1_000, &mut back).unwrap();
    assert_eq!(back, [0xFF; 64]);
    nor.write(64, &[7; 64]).unwrap();
    nor.read(64, &mut back).unwrap();
    assert_eq!(back, [7; 64]);
    // Also not with the same bytes, and not with fewer ones.
    for again in [[7; 32], [0; 32]] {
        assert_eq!(nor.write(96, &again), Err(NorError::Programmed { offset: 96 }));
    }
    nor.erase(0, SECTOR_BYTES as u32).unwrap();
    nor.write(96, &[1; 32]).unwrap();
    // Ones are something programmed.
    nor.write(128, &[0xFF; 32]).unwrap();
    assert_eq!(nor.write(128, &[1; 32]), Err(NorError::Programmed { offset: 128 }));
    assert_eq!(nor.wear(), Wear { erased_sectors: 1, programmed_words: 4 });
}

#[test]
fn parts_of_words_and_sectors_and_what_lies_beyond_the_end_are_refused() {
    let mut memory = Memory::new();
    let mut nor = memory.erased();
    assert_eq!(nor.write(1, &[0; 32]), Err(NorError::NotAligned));
    assert_eq!(nor.write(0, &[0; 31]), Err(NorError::NotAligned));
    assert_eq!(nor.erase(0, 32), Err(NorError::NotAligned));
    assert_eq!(nor.write(BANK_BYTES as u32, &[0; 32]), Err(NorError::OutOfBounds));
    assert_eq!(nor.read(BANK_BYTES as u32 - 1, &mut [0; 2]), Err(NorError::OutOfBounds));
    assert_eq!(nor.erase(0, (BANK_BYTES + SECTOR_BYTES) as u32), Err(NorError::OutOfBounds));
    assert_eq!(NorError::NotAligned.kind(), NorFlashErrorKind::NotAligned);
    assert_eq!(nor.wear(), Wear::default());
}

#[test]
fn a_word_whose_programming_was_interrupted_reads_as_an_ecc_error_until_it_is_erased() {
    let mut memory = Memory::new();
    let mut nor = memory.erased();
    nor.cut(Some(Cut { after_operations: 1, moment: Moment::Within(0) }));
    assert_eq!(nor.write(0, &[9; 96]), Err(NorError::NoPower));
    assert_eq!(nor.read(0, &mut [0; 1]), Err(NorError::NoPower));
    nor.power_up();
    assert_eq!([0, 32, 64].map(|at| nor.word_state(at)), [WordState::Programmed, WordState::Torn, WordState::Blank]);
    // Any read that touches it, and no other.
    for (at, length, good) in
        [(0, 32, true), (31, 1, true), (31, 2, false), (40, 1, false), (63, 1, false), (64, 9, true)]
    {
        let found = nor.read(at, &mut vec![0; length]);
        assert_eq!(found, if good { Ok(()) } else { Err(NorError::Ecc { offset: 32 }) }, "{at}+{length}");
    }
    assert_eq!(nor.write(32, &[9; 32]), Err(NorError::Ecc { offset: 32 }));
    nor.erase(0, SECTOR_BYTES as u32).unwrap();
    nor.write(32, &[9; 32]).unwrap();
}

#[test]
fn an_interrupted_erase_leaves_some_of_everything_and_a_cut_before_or_after_it_nothing_or_all() {
    for moment in [Moment::Before, Moment::Within(3), Moment::After] {
        let mut memory = Memory::new();
        let mut nor = memory.erased();
        nor.write(0, &[5; SECTOR_BYTES]).unwrap();
        nor.write(SECTOR_BYTES as u32, &[6; 32]).unwrap();
        nor.cut(Some(Cut { after_operations: 0, moment }));
        assert_eq!(nor.erase(0, 2 * SECTOR_BYTES as u32), Err(NorError::NoPower));
        nor.power_up();
        let mut count = [0; 3];
        (0..SECTOR_BYTES).step_by(WORD_BYTES).for_each(|at| count[nor.word_state(at as u32) as usize] += 1);
        let all = SECTOR_BYTES / WORD_BYTES;
        match moment {
            Moment::Before => assert_eq!(count, [0, all, 0]),
            Moment::After => assert_eq!(count, [all, 0, 0]),
            Moment::Within(_) => assert!(count.iter().all(|&n| n > all / 4), "{count:?}"),
        }
        assert_eq!(nor.word_state(SECTOR_BYTES as u32), WordState::Programmed, "the next sector was not reached");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn any_history_reads_as_what_was_written_last(
        operations in prop::collection::vec((0..4usize, 0..200u32, any::<u8>()), 0..200),
    ) {
        let mut memory = Memory::new();
        let mut nor = memory.erased();
        let mut mirror = vec![None; 4 * 200];
        for (sector, word, value) in operations {
            let at = (sector * SECTOR_BYTES) as u32 + word * 32;
            let place = &mut mirror[sector * 200 + word as usize];
            if value < 16 {
                let start = (sector * SECTOR_BYTES) as u32;
                nor.erase(start, start + SECTOR_BYTES as u32).unwrap();
                mirror[sector * 200..][..200].fill(None);
            } else if place.is_some() {
                prop_assert_eq!(nor.write(at, &[value; 32]), Err(NorError::Programmed { offset: at }));
            } else {
                nor.write(at, &[value; 32]).unwrap();
                *place = Some(value);
            }
        }
        for (index, value) in mirror.into_iter().enumerate() {
            let mut back = [0; 32];
            let at = (index / 200 * SECTOR_BYTES + index % 200 * 32) as u32;
            nor.read(at, &mut back).unwrap();
            prop_assert_eq!(back, [value.unwrap_or(0xFF); 32]);
        }
    }
}
