//! Where calls through a register lead when the function itself has put the address there.
//!
//! Built for size, a compiler calls a function it needs several times through a register, loaded once from the constants
//! behind the code or by MOVW and MOVT. What each register holds is followed along every path of the function: a value
//! stands only if all paths bring the same. An instruction that is not known here may have written to every register, a
//! call to those that the procedure call standard leaves to it (Arm IHI 0042: r0 to r3, r12, lr). Encodings: Arm DDI 0403,
//! A5.2 and A5.3.

use std::collections::BTreeMap;

use super::thumb::{Effect, decode};

/// What each register holds, where that is known.
type State = [Option<u32>; 16];

/// What a call leaves to its callee.
const SCRATCH: u16 = 0b0101_0000_0000_1111;
const ALL: u16 = 0xFFFF;

/// An instruction.
#[derive(Clone, Copy)]
struct Instruction {
    /// Its halves; the second of a narrow one is 0.
    first: u16,
    second: u16,
    bytes: u32,
    effect: Effect,
    /// Whether it is within an IT block.
    conditional: bool,
}

/// What an instruction does to the registers.
enum Writes {
    /// A constant.
    Constant(usize, u32),
    /// A constant in the upper half; the lower one stays.
    Top(usize, u32),
    /// What another register holds.
    Copy(usize, usize),
    /// Something, to all of these.
    Something(u16),
}

/// Addresses called through registers, by the address of the call; calls whose register is not known are left out.
///
/// `code` is that of the function, `start` its address, `is_code` says whether an address holds an instruction, `word`
/// reads a constant of the image.
pub fn calls(
    code: &[u8],
    start: u32,
    is_code: impl Fn(u32) -> bool,
    word: impl Fn(u32) -> Option<u32>,
) -> BTreeMap<u32, u32> {
    let instructions = instructions(code, start, &is_code);
    let is_call = |i: &Instruction| matches!(i.effect, Effect::Indirect(Some(_)));
    // Where it may go on within itself by a way that is not read, nothing is known.
    if !instructions.values().any(is_call) || instructions.values().any(hides_its_way) {
        return BTreeMap::new();
    }
    let mut states: BTreeMap<u32, State> = BTreeMap::from([(start, [None; 16])]);
    let mut open = vec![start];
    while let Some(at) = open.pop() {
        let (Some(instruction), Some(&before)) = (instructions.get(&at), states.get(&at)) else { continue };
        let after = instruction.apply(at, before, &word);
        let table = instruction.table_bytes().map(|size| targets(code, start, at, size, &is_code));
        let mut next = table.unwrap_or_default();
        if instruction.goes_on() {
            next.push(at + instruction.bytes);
        }
        if let Effect::Branch(to) = instruction.effect {
            next.push(to);
        }
        for to in next.into_iter().filter(|to| instructions.contains_key(to)) {
            let joined = states
                .get(&to)
                .map_or(after, |known| std::array::from_fn(|r| known[r].filter(|value| after[r] == Some(*value))));
            if states.insert(to, joined) != Some(joined) {
                open.push(to);
            }
        }
    }
    let called = instructions.iter().filter_map(|(&at, instruction)| match instruction.effect {
        Effect::Indirect(Some(register)) => Some((at, (*states.get(&at)?)[register]?)),
        _ => None,
    });
    called.collect()
}

fn instructions(code: &[u8], start: u32, is_code: impl Fn(u32) -> bool) -> BTreeMap<u32, Instruction> {
    let mut found = BTreeMap::new();
    let (mut at, mut within) = (0, 0u32);
    while let Some(rest) = code.get(at as usize..).filter(|rest| !rest.is_empty()) {
        if !is_code(start + at) {
            at += 2;
            continue;
        }
        let Some((effect, bytes)) = decode(rest, start + at) else { break };
        let half = |k: usize| rest.get(k..k + 2).map_or(0, |h| u16::from_le_bytes([h[0], h[1]]));
        let (first, second) = (half(0), if bytes == 4 { half(2) } else { 0 });
        let conditional = within > 0;
        within = within.saturating_sub(1);
        // IT: as many as the mask has bits above its lowest one.
        if bytes == 2 && first >> 8 == 0xBF && first & 0xF != 0 {
            within = 4 - u32::from(first & 0xF).trailing_zeros();
        }
        found.insert(start + at, Instruction { first, second, bytes, effect, conditional });
        at += bytes;
    }
    found
}

/// Whether an instruction loads or adds to the program counter what is not known: MOV and ADD of it, LDR.
fn hides_its_way(i: &Instruction) -> bool {
    let narrow = i.bytes == 2 && matches!(i.first & 0xFF87, 0x4687 | 0x4487);
    // From the stack it is a return.
    let load = i.bytes == 4 && i.first & 0xFF70 == 0xF850 && i.first & 0xF != 13 && i.second >> 12 == 15;
    narrow || load || i.effect == Effect::Indirect(None)
}

/// Where a table branch leads: offsets of one byte or two behind it, in halfwords from the table on. What is behind the
/// last one for alignment leads nowhere.
fn targets(code: &[u8], start: u32, at: u32, size: usize, is_code: impl Fn(u32) -> bool) -> Vec<u32> {
    let table = at + 4;
    let bytes = (table..).take_while(|&place| place - start < code.len() as u32 && !is_code(place & !1));
    let places: Vec<usize> = bytes.map(|place| (place - start) as usize).collect();
    let offset = |place: &[usize]| place.iter().rev().fold(0, |sum, &k| sum << 8 | u32::from(code[k]));
    places.chunks_exact(size).map(|entry| table + 2 * offset(entry)).collect()
}

impl Instruction {
    /// Bytes of an entry, if it is TBB or TBH.
    fn table_bytes(&self) -> Option<usize> {
        let table = self.bytes == 4 && self.first & 0xFFF0 == 0xE8D0 && self.second & 0xFFE0 == 0xF000;
        table.then(|| 1 + usize::from(self.second >> 4 & 1))
    }

    /// Whether what follows it may be next.
    fn goes_on(&self) -> bool {
        let (a, b) = (self.first, self.second);
        let ends = if self.bytes == 2 {
            // B, POP with pc, BX, UDF.
            a >> 11 == 0b11100 || a & 0xFF00 == 0xBD00 || a & 0xFF87 == 0x4700 || a >> 8 == 0xDE
        } else {
            // B, LDM with pc, LDR to pc, TBB, TBH.
            a >> 11 == 0b11110 && b & 0xD000 == 0x9000
                || a & 0xFE50 == 0xE810 && b & 0x8000 != 0
                || a & 0xFF70 == 0xF850 && b >> 12 == 15
                || self.table_bytes().is_some()
        };
        !ends || self.conditional
    }

    fn apply(&self, at: u32, mut state: State, word: impl Fn(u32) -> Option<u32>) -> State {
        let writes = match self.effect {
            Effect::Call(_) | Effect::Indirect(_) => Writes::Something(SCRATCH),
            Effect::Branch(_) => Writes::Something(0),
            _ if self.bytes == 2 => narrow(self.first, at, word),
            _ => wide(self.first, self.second, at, word),
        };
        let set = |state: &mut State, register: usize, value: Option<u32>| {
            if let Some(place) = state.get_mut(register) {
                *place = value.filter(|_| !self.conditional);
            }
        };
        match writes {
            Writes::Constant(register, value) => set(&mut state, register, Some(value)),
            Writes::Top(register, top) => {
                let value = state[register].map(|low| low & 0xFFFF | top << 16);
                set(&mut state, register, value);
            }
            Writes::Copy(to, from) => {
                let value = state[from];
                set(&mut state, to, value);
            }
            Writes::Something(registers) => {
                (0..16).filter(|r| registers >> r & 1 != 0).for_each(|r| state[r] = None);
            }
        }
        state
    }
}

fn narrow(h: u16, at: u32, word: impl Fn(u32) -> Option<u32>) -> Writes {
    let bit = |register: u16| Writes::Something(1 << register);
    let (low, middle) = (h & 7, h >> 8 & 7);
    match h >> 11 {
        // Shifts, ADD and SUB of three registers.
        0b00000..=0b00011 => bit(low),
        // CMP.
        0b00101 => Writes::Something(0),
        0b00100 | 0b00110 | 0b00111 => bit(middle),
        0b01000 => match h >> 6 & 0xF {
            // Data processing; TST, CMP, CMN.
            8 | 10 | 11 if h >> 10 & 1 == 0 => Writes::Something(0),
            _ if h >> 10 & 1 == 0 => bit(low),
            // Of high registers: CMP, MOV, ADD.
            _ if h >> 8 & 3 == 1 => Writes::Something(0),
            _ if h >> 8 & 3 == 2 => Writes::Copy(usize::from(h >> 4 & 8 | low), usize::from(h >> 3 & 0xF)),
            _ if h >> 8 & 3 == 0 => bit(h >> 4 & 8 | low),
            _ => Writes::Something(ALL),
        },
        // LDR from the constants.
        0b01001 => {
            let place = (at & !3).wrapping_add(4 + 4 * u32::from(h & 0xFF));
            word(place).map_or_else(|| bit(middle), |value| Writes::Constant(usize::from(middle), value))
        }
        // Loads and stores with a register.
        0b01010 | 0b01011 => {
            if h >> 9 & 7 >= 3 {
                bit(low)
            } else {
                Writes::Something(0)
            }
        }
        // Loads and stores with an offset, and from the stack.
        0b01100 | 0b01110 | 0b10000 | 0b10010 => Writes::Something(0),
        0b01101 | 0b01111 | 0b10001 => bit(low),
        // LDR from the stack, ADR, ADD to SP.
        0b10011..=0b10101 => bit(middle),
        0b10110 | 0b10111 => match h >> 8 & 0xF {
            // ADD and SUB of SP, CBZ, CBNZ, PUSH, CPS, BKPT, hints and IT.
            0 | 1 | 3 | 4 | 5 | 6 | 9 | 11 | 14 | 15 => Writes::Something(0),
            // SXTB and its like, REV.
            2 | 10 => bit(low),
            // POP.
            12 | 13 => Writes::Something(h & 0xFF),
            _ => Writes::Something(ALL),
        },
        // STM and LDM.
        0b11000 => bit(middle),
        0b11001 => Writes::Something(h & 0xFF | 1 << middle),
        _ => Writes::Something(ALL),
    }
}

fn wide(a: u16, b: u16, at: u32, word: impl Fn(u32) -> Option<u32>) -> Writes {
    let (n, t, d) = (a & 0xF, b >> 12, b >> 8 & 0xF);
    let of = |registers: &[u16]| Writes::Something(registers.iter().fold(0, |set, register| set | 1 << register));
    let constant = || u32::from(n << 12 | (a >> 10 & 1) << 11 | (b >> 12 & 7) << 8 | b & 0xFF);
    match a {
        // MOVW and MOVT.
        _ if a & 0xFBF0 == 0xF240 && b & 0x8000 == 0 => Writes::Constant(usize::from(d), constant()),
        _ if a & 0xFBF0 == 0xF2C0 && b & 0x8000 == 0 => Writes::Top(usize::from(d), constant()),
        // LDR from the constants.
        _ if a & 0xFF7F == 0xF85F && t != 15 => {
            let (base, offset) = ((at & !3).wrapping_add(4), u32::from(b & 0xFFF));
            let place = if a & 0x80 != 0 { base.wrapping_add(offset) } else { base.wrapping_sub(offset) };
            word(place).map_or_else(|| of(&[t]), |value| Writes::Constant(usize::from(t), value))
        }
        // Loads and stores of several: the base, and what is loaded.
        _ if a & 0xFE40 == 0xE800 => Writes::Something(1 << n | if a & 0x10 != 0 { b } else { 0 }),
        // Of two (one of the bits for offset and write-back is set): what is loaded, and the base if it moves.
        _ if a & 0xFE40 == 0xE840 && a & 0x120 != 0 => {
            let base = if a & 0x20 != 0 { 1 << n } else { 0 };
            Writes::Something(base | if a & 0x10 != 0 { 1 << t | 1 << d } else { 0 })
        }
        // Exclusive ones, table branches: every register they name.
        _ if a & 0xFE40 == 0xE840 => of(&[n, t, d, b & 0xF]),
        // Data processing with a shifted register, an immediate (with other results too), a register; MRS and barriers.
        _ if a & 0xFE00 == 0xEA00 || a & 0xF800 == 0xF000 || a & 0xFF00 == 0xFA00 => of(&[d]),
        // Two registers to or from the floating-point unit; its loads and stores with the base; one register.
        _ if a & 0xFFE0 == 0xEC40 => of(&[n, t]),
        _ if a & 0xFE00 == 0xEC00 => of(&[n]),
        _ if a & 0xFF00 == 0xEE00 && b & 0x10 != 0 => of(&[t]),
        // Its arithmetic.
        _ if a & 0xEF00 == 0xEE00 && b & 0xE10 == 0xA00 => Writes::Something(0),
        // Loads and stores of one; with bit 11 of the second half and without the large offset the base may move.
        _ if a & 0xFE00 == 0xF800 => {
            let base = if a & 0x80 == 0 && b & 0x800 != 0 { 1 << n } else { 0 };
            Writes::Something(base | if a & 0x10 != 0 { 1 << t } else { 0 })
        }
        // Products.
        _ if a & 0xFF00 == 0xFB00 => of(&[t, d]),
        _ => Writes::Something(ALL),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls of a function at 0x1000 of halves of code, with constants in words behind them.
    fn of(code: &[u16], constants: &[u32]) -> BTreeMap<u32, u32> {
        let mut bytes: Vec<u8> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
        let end = 0x1000 + bytes.len() as u32;
        bytes.extend(constants.iter().flat_map(|word| word.to_le_bytes()));
        let word = |at: u32| Some(u32::from_le_bytes(*bytes.get((at - 0x1000) as usize..)?.first_chunk()?));
        calls(&bytes, 0x1000, |at| at < end, word)
    }

    const TO: u32 = 0x0802_1235;

    #[test]
    fn a_register_that_was_loaded_from_a_constant_is_followed_through_copies_and_calls() {
        // ldr r4, [pc, #8]; mov r8, r4; bl .; blx r8; bx lr
        let code = [0x4C02, 0x46A0, 0xF7FF, 0xFFFE, 0x47C0, 0x4770];
        assert_eq!(of(&code, &[TO]), [(0x1008, TO)].into());
        // movw r3, #0x1235; movt r3, #0x0802; blx r3
        assert_eq!(of(&[0xF241, 0x2335, 0xF6C0, 0x0302, 0x4798], &[]), [(0x1008, TO)].into());
    }

    #[test]
    fn what_a_call_or_anything_else_may_have_changed_is_not_known() {
        // ldr r3, [pc, #8]; nop; bl .; blx r3: a call may change r3.
        assert_eq!(of(&[0x4B02, 0xBF00, 0xF7FF, 0xFFFE, 0x4798, 0x4770], &[TO]), [].into());
        // ldr r4, [pc, #4]; ldr r4, [r0]; blx r4; bx lr: from a table.
        assert_eq!(of(&[0x4C01, 0x6804, 0x47A0, 0x4770], &[TO]), [].into());
        // ldr r4, [pc, #4]; it eq; moveq r4, r0; blx r4
        assert_eq!(of(&[0x4C01, 0xBF08, 0x4604, 0x47A0], &[TO]), [].into());
        // ldr r4, [pc, #4]; mov pc, r0: it may go on anywhere.
        assert_eq!(of(&[0x4C01, 0x4687, 0x47A0, 0x4770], &[TO]), [].into());
        // ldr r4, [pc, #8]; an instruction that is not known; blx r4
        assert_eq!(of(&[0x4C02, 0xBF00, 0xFE00, 0x0010, 0x47A0, 0x4770], &[TO]).len(), 0);
    }

    #[test]
    fn a_value_stands_where_all_paths_bring_it() {
        // ldr r4, [pc, #8]; cbz r0, to the call; ldr r4, [pc, #N]; nop; blx r4; bx lr
        let branch = |second: u16| of(&[0x4C02, 0xB108, second, 0xBF00, 0x47A0, 0x4770], &[TO, TO + 2]);
        // The same constant on both.
        assert_eq!(branch(0x4C01), [(0x1008, TO)].into());
        assert_eq!(branch(0x4C02), [].into());
    }
}
