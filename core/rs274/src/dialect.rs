//! Dialects of G-code: controls that give the same words another meaning.

/// The control a program is written for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Dialect {
    /// LinuxCNC, and whatever keeps to RS274/NGC.
    #[default]
    Linuxcnc,
    /// Fanuc with custom macro B.
    Fanuc,
    /// Haas.
    Haas,
    /// Siemens in ISO mode: G70 and G71 are units.
    Siemens,
    /// Mach3 and Mach4: G70 and G71 are units.
    Mach,
    /// HEIDENHAIN's conversational language, `.h`; read where the feature `klartext` is built in.
    Heidenhain,
}

impl Dialect {
    /// Whether programs are steered by Fanuc's custom macro B (`IF [..] GOTO 10`, `WHILE [..] DO1`) and a parameter that was
    /// never set is vacant, not 0.
    pub const fn has_macro_b(self) -> bool {
        matches!(self, Self::Fanuc | Self::Haas)
    }
    /// Whether blocks are conversational: no words of G-code.
    pub const fn is_klartext(self) -> bool {
        matches!(self, Self::Heidenhain)
    }
    /// Whether programs are steered by LinuxCNC's O words.
    pub const fn has_o_words(self) -> bool {
        matches!(self, Self::Linuxcnc | Self::Mach)
    }
    /// Whether G70 and G71 are inches and millimetres.
    pub const fn has_metric_g71(self) -> bool {
        matches!(self, Self::Siemens | Self::Mach)
    }
    /// Whether R, the depth and Q go on to a cycle of another code until G80: Fanuc, and those that follow it.
    pub const fn keeps_words_of_cycles(self) -> bool {
        matches!(self, Self::Fanuc | Self::Haas | Self::Siemens)
    }
    /// The largest number of a parameter.
    pub const fn largest_parameter(self) -> u16 {
        if matches!(self, Self::Linuxcnc) { 5_601 } else { u16::MAX }
    }
    /// How many numbered parameters, from `#1`, belong to a call.
    pub const fn locals(self) -> u8 {
        if self.has_macro_b() { 33 } else { 30 }
    }
}
