//! As much of the Thumb-2 instruction set as a call graph needs: branches that leave a function, and the stack.
//!
//! Encodings: Arm DDI 0403 (ARMv7-M), A6.7.12 (B), A6.7.18 (BL), A6.7.19 (BLX), A6.7.20 (BX), A6.7.21 (CBZ), A6.7.99 (PUSH), A6.7.134
//! (SUB from SP), A6.7.163 (VPUSH). Everything else is passed over by its length.

/// What an instruction does to the call graph or the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// A call of an address.
    Call(u32),
    /// A branch to an address.
    Branch(u32),
    /// A call or branch through a register other than the link register, by its number; `None` through memory.
    Indirect(Option<usize>),
    /// The stack grows by so many bytes.
    Push(u32),
    /// The stack grows by what a register holds.
    PushUnknown,
    /// Nothing of that.
    Other,
}

/// The effect of the instruction at an address and its bytes. `None` at the end of the code.
pub fn decode(code: &[u8], address: u32) -> Option<(Effect, u32)> {
    let half = |at: usize| Some(u32::from(u16::from_le_bytes([*code.get(at)?, *code.get(at + 1)?])));
    let first = half(0)?;
    if first >> 11 < 0b11101 {
        return Some((narrow(first, address), 2));
    }
    Some((wide(first, half(2)?, address), 4))
}

fn sign(value: u32, bits: u32) -> u32 {
    let shift = 32 - bits;
    (((value << shift) as i32) >> shift) as u32
}

fn narrow(h: u32, address: u32) -> Effect {
    let to = |offset: u32| Effect::Branch(address.wrapping_add(4).wrapping_add(offset));
    match h {
        // B<c> (T1); 1110 is undefined and 1111 is SVC.
        _ if h >> 12 == 0b1101 && h >> 9 != 0b110_1111 => to(sign((h & 0xFF) << 1, 9)),
        // B (T2).
        _ if h >> 11 == 0b11100 => to(sign((h & 0x7FF) << 1, 12)),
        // CBZ, CBNZ.
        _ if h & 0xF500 == 0xB100 => to(h >> 3 & 0x40 | h >> 2 & 0x3E),
        // BLX register, BX register.
        _ if h & 0xFF87 == 0x4780 => Effect::Indirect(Some((h >> 3 & 0xF) as usize)),
        _ if h & 0xFF87 == 0x4700 && h >> 3 & 0xF != 14 => Effect::Indirect(Some((h >> 3 & 0xF) as usize)),
        // PUSH (T1): eight low registers and the link register.
        _ if h & 0xFE00 == 0xB400 => Effect::Push(4 * (h & 0x1FF).count_ones()),
        // SUB SP, #imm7 (T1).
        _ if h & 0xFF80 == 0xB080 => Effect::Push((h & 0x7F) * 4),
        _ => Effect::Other,
    }
}

fn wide(a: u32, b: u32, address: u32) -> Effect {
    let to = |offset: u32| Effect::Branch(address.wrapping_add(4).wrapping_add(offset));
    let (s, j1, j2) = (a >> 10 & 1, b >> 13 & 1, b >> 11 & 1);
    if a >> 11 == 0b11110 && b & 0x8000 != 0 {
        // BL (T1) and B (T4).
        if b & 0x5000 == 0x5000 || b & 0x5000 == 0x1000 {
            let (i1, i2) = (j1 ^ s ^ 1, j2 ^ s ^ 1);
            let offset = s << 24 | i1 << 23 | i2 << 22 | (a & 0x3FF) << 12 | (b & 0x7FF) << 1;
            let target = address.wrapping_add(4).wrapping_add(sign(offset, 25));
            return if b & 0x4000 != 0 { Effect::Call(target) } else { Effect::Branch(target) };
        }
        // B<c> (T3); conditions 1110 and 1111 are other instructions.
        if b & 0x5000 == 0 && a >> 7 & 7 != 7 {
            let offset = s << 20 | j2 << 19 | j1 << 18 | (a & 0x3F) << 12 | (b & 0x7FF) << 1;
            return to(sign(offset, 21));
        }
    }
    let imm12 = (a >> 10 & 1) << 11 | (b >> 12 & 7) << 8 | b & 0xFF;
    match (a, b) {
        // STMDB SP!, PUSH (T2).
        (0xE92D, _) => Effect::Push(4 * (b & 0x7FFF).count_ones()),
        // STR Rt, [SP, #-imm8]!, PUSH (T3).
        (0xF84D, _) if b & 0xF00 == 0xD00 => Effect::Push(b & 0xFF),
        // VPUSH of doubles and singles: a count of words either way.
        (0xED2D | 0xED6D, _) if b & 0xE00 == 0xA00 => Effect::Push(4 * (b & 0xFF)),
        // SUB SP, SP, #const (T2, expanded) and #imm12 (T3).
        _ if a & 0xFBEF == 0xF1AD && b >> 8 & 0xF == 13 => Effect::Push(expanded(imm12)),
        _ if a & 0xFBFF == 0xF2AD && b >> 8 & 0xF == 13 => Effect::Push(imm12),
        // SUB SP, SP, register (T1).
        _ if a & 0xFFEF == 0xEBAD && b >> 8 & 0xF == 13 => Effect::PushUnknown,
        // LDR PC, [register]: a branch through memory, unless it pops.
        _ if a & 0xFFF0 == 0xF8D0 && b >> 12 == 15 => Effect::Indirect(None),
        _ => Effect::Other,
    }
}

/// The modified immediate of Thumb-2 (A5.3.2).
fn expanded(imm12: u32) -> u32 {
    let byte = imm12 & 0xFF;
    match imm12 >> 8 {
        0 => byte,
        1 => byte | byte << 16,
        2 => byte << 8 | byte << 24,
        3 => byte | byte << 8 | byte << 16 | byte << 24,
        _ => (0x80 | imm12 & 0x7F).rotate_right(imm12 >> 7),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(bytes: &[u8]) -> (Effect, u32) {
        decode(bytes, 0x1000).unwrap()
    }

    #[test]
    fn calls_and_branches_lead_where_the_assembler_says() {
        // bl .+0x20; bl .-0x100; b.w .+0x2000; bne.w .+0x400; beq .+8; b .-2
        assert_eq!(of(&[0x00, 0xF0, 0x0E, 0xF8]), (Effect::Call(0x1020), 4));
        assert_eq!(of(&[0xFF, 0xF7, 0x7E, 0xFF]), (Effect::Call(0x0F00), 4));
        assert_eq!(of(&[0x01, 0xF0, 0xFE, 0xBF]), (Effect::Branch(0x3000), 4));
        assert_eq!(of(&[0x40, 0xF0, 0xFE, 0x81]), (Effect::Branch(0x1400), 4));
        assert_eq!(of(&[0x02, 0xD0]), (Effect::Branch(0x1008), 2));
        assert_eq!(of(&[0xFD, 0xE7]), (Effect::Branch(0x0FFE), 2));
        assert_eq!(of(&[0x08, 0xB1]), (Effect::Branch(0x1006), 2)); // cbz r0, .+6
        assert_eq!(of(&[0x00, 0xBB]), (Effect::Branch(0x1044), 2)); // cbnz r0, .+0x44
    }

    #[test]
    fn a_return_is_no_call_and_a_call_through_a_register_is_one() {
        assert_eq!(of(&[0x70, 0x47]).0, Effect::Other); // bx lr
        assert_eq!(of(&[0x98, 0x47]).0, Effect::Indirect(Some(3))); // blx r3
        assert_eq!(of(&[0x18, 0x47]).0, Effect::Indirect(Some(3))); // bx r3
        assert_eq!(of(&[0xF0, 0xBD]).0, Effect::Other); // pop {r4-r7, pc}
    }

    #[test]
    fn what_grows_the_stack_is_counted_in_bytes() {
        assert_eq!(of(&[0xF0, 0xB5]).0, Effect::Push(20)); // push {r4-r7, lr}
        assert_eq!(of(&[0x2D, 0xE9, 0xF0, 0x4F]).0, Effect::Push(36)); // push.w {r4-r11, lr}
        assert_eq!(of(&[0x84, 0xB0]).0, Effect::Push(16)); // sub sp, #16
        assert_eq!(of(&[0xAD, 0xF5, 0x00, 0x7D]).0, Effect::Push(512)); // sub.w sp, sp, #512
        assert_eq!(of(&[0x2D, 0xED, 0x02, 0x8B]).0, Effect::Push(8)); // vpush {d8}
        assert_eq!(of(&[0xAD, 0xEB, 0x0C, 0x0D]).0, Effect::PushUnknown); // sub.w sp, sp, r12
    }
}
