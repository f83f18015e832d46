//! JSON objects that carry their own checksum.

use truepath_core::checksum::crc32;

/// What such an object begins with: the checksum of all bytes behind it.
const SEAL: &[u8] = b"{\"crc32\":\"";

/// A JSON object with its checksum as the first entry.
pub fn sealed(body: &[u8]) -> Vec<u8> {
    let rest = [body.strip_prefix(b"{").unwrap_or(body), b"\n"].concat();
    let seal = format!("{:08x}\",", crc32(&rest));
    [SEAL, seal.as_bytes(), &rest].concat()
}

/// The JSON object without its checksum.
///
/// # Errors
/// What is wrong with the checksum.
pub fn unsealed(text: &[u8]) -> Result<Vec<u8>, String> {
    let none = || "does not begin with its checksum".to_owned();
    let (seal, rest) = text.strip_prefix(SEAL).and_then(|text| text.split_at_checked(10)).ok_or_else(none)?;
    let crc = format!("{:08x}\",", crc32(rest));
    if crc.as_bytes() != seal {
        return Err("was changed, or is not whole: its checksum differs".to_owned());
    }
    Ok([b"{", rest].concat())
}
