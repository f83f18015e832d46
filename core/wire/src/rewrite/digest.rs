//! A running fingerprint of outputs, to compare a host with a device without sending every bit.

use super::Output;

/// FNV-1a over 64 bits of every field of every output in order. For comparing honest runs, not against forgery.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Takes in one output.
    pub fn add(&mut self, output: &Output) {
        for axis in output.axes {
            self.bytes(&axis.to_le_bytes());
        }
        for correction in output.correction_nm {
            self.bytes(&correction.to_le_bytes());
        }
        self.bytes(&[u8::from(output.forward), output.mode as u8]);
        self.bytes(&output.reason.code().to_le_bytes());
        self.bytes(&output.status.0.to_le_bytes());
        self.bytes(&output.place.node.to_le_bytes());
        self.bytes(&output.place.fraction.to_le_bytes());
        self.bytes(&output.sequence.to_le_bytes());
    }
    /// The fingerprint so far.
    pub const fn value(&self) -> u64 {
        self.0
    }
    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_is_fnv_1a_of_64_bits() {
        // Test vectors of its authors (Fowler, Noll, Vo).
        let of = |text: &str| {
            let mut digest = Digest::default();
            digest.bytes(text.as_bytes());
            digest.value()
        };
        assert_eq!(of(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(of("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(of("foobar"), 0x8594_4171_f739_67e8);
    }
}
