//! What somebody with a key may do on a device.

use core::fmt;

use serde::{Deserialize, Serialize};

/// What may be asked of a device. Each role includes those before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Role {
    /// Look. Everybody may, without a key.
    #[default]
    Read,
    /// Arm, disarm, acknowledge, reset.
    Operate,
    /// Upload, put in use, change settings.
    Engineer,
}

impl Role {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 3] = [Self::Read, Self::Operate, Self::Engineer];
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Operate => "operate",
            Self::Engineer => "engineer",
        }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a key is good for, said when it is provisioned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rights {
    /// The highest role that it can log in with.
    pub role: Role,
    /// Whether images that it signs are taken.
    pub signs: bool,
    /// Whether firmware that it signs is taken. A message that is older than this right has none of it.
    #[serde(skip)]
    pub firmware: bool,
}

/// What a key has that was provisioned without a word of rights: every role, and images. Firmware has to be said.
impl Default for Rights {
    fn default() -> Self {
        Self { role: Role::Engineer, signs: true, firmware: false }
    }
}

const OPERATE: u32 = 1;
const READ: u32 = 2;
const SIGNS_NOTHING: u32 = 4;
const FIRMWARE: u32 = 8;

impl Rights {
    /// As a word in the flash; 0 is every role, and images.
    pub const fn bits(self) -> u32 {
        let role = match self.role {
            Role::Engineer => 0,
            Role::Operate => OPERATE,
            Role::Read => READ,
        };
        (if self.signs { role } else { role | SIGNS_NOTHING }) | if self.firmware { FIRMWARE } else { 0 }
    }
    /// The rights of a word; of one that a later version may have written, none.
    pub const fn of(bits: u32) -> Self {
        let firmware = bits & FIRMWARE != 0;
        match bits & !FIRMWARE {
            0 => Self { role: Role::Engineer, signs: true, firmware },
            SIGNS_NOTHING => Self { role: Role::Engineer, signs: false, firmware },
            OPERATE => Self { role: Role::Operate, signs: true, firmware },
            5 => Self { role: Role::Operate, signs: false, firmware },
            READ => Self { role: Role::Read, signs: true, firmware },
            6 => Self { role: Role::Read, signs: false, firmware },
            _ => Self { role: Role::Read, signs: false, firmware: false },
        }
    }
}

impl fmt::Display for Rights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (images, firmware) = (if self.signs { ", signs images" } else { "" }, self.firmware);
        write!(f, "{}{images}{}", self.role, if firmware { ", signs firmware" } else { "" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rights_come_back_from_their_word_and_unknown_words_give_none() {
        for role in Role::ALL {
            for (signs, firmware) in [(false, false), (true, false), (false, true), (true, true)] {
                let rights = Rights { role, signs, firmware };
                assert_eq!(Rights::of(rights.bits()), rights);
            }
        }
        assert_eq!(Rights::of(0), Rights::default());
        for bits in [3, 7, 11, 16, u32::MAX] {
            assert_eq!(Rights::of(bits), Rights { role: Role::Read, signs: false, firmware: false });
        }
    }
}
