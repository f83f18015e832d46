//! Any bytes as a correction image: refused with a reason, or an image whose every node can be read and dumped.
#![no_main]

use libfuzzer_sys::fuzz_target;
use truepath_core::image::{Image, Signed};

fuzz_target!(|bytes: &[u8]| {
    judge(bytes);
    // Random bytes never carry the right length and checksum; with them the checks behind are reached.
    let mut sealed = bytes.to_vec();
    let length = u32::try_from(sealed.len()).unwrap_or(u32::MAX);
    if let Some(field) = sealed.get_mut(16..20) {
        field.copy_from_slice(&length.to_le_bytes());
    }
    if let Some((body, crc)) = sealed.split_last_chunk_mut::<4>() {
        *crc = truepath_core::checksum::crc32(body).to_le_bytes();
        judge(&sealed);
    }
});

fn judge(bytes: &[u8]) {
    let signed = Signed::of(bytes);
    match Image::new_checked(bytes) {
        Ok(image) => {
            assert!(image.len() >= 2 && image.nodes().count() == image.len());
            let mut text = String::new();
            truepath_core::image::dump(&image, signed.as_ref(), &mut text).expect("memory");
            assert!(text.lines().count() > image.len());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
