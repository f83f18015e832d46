//! Keys that sign images: their files, and the signature of an image.
//!
//! Both files are text: lines that begin with `#` say something to people, of the others each is a word and 64 hexadecimal
//! digits. A private key is one line, `ed25519-seed …` (the seed of RFC 8032); a file of public keys is one line for each
//! key, `ed25519 …`. So the public keys of several people are one file, put together with `cat`.
//!
//! The counter of a signature is the time of the signing, whole seconds since 1970: what several people and PCs that sign for one
//! machine have in common, where an output folder is only one of many. `SOURCE_DATE_EPOCH` stands for the clock where it
//! is set, so that a build gives the same bytes again.

use std::ops::Range;
use std::path::Path;

use ed25519_dalek::{Signer as _, SigningKey};
use truepath_core::image::{DeviceClass, DeviceClasses, KeyId, PublicKey, Role, sign, signed_bytes};
use truepath_ground::diagnostics::{Failure, InputError, Source};

#[cfg(unix)]
use crate::codes::K022;
use crate::codes::{K020, K021, K023};

/// The word before a seed.
const PRIVATE: &str = "ed25519-seed";
/// The word before a public key.
const PUBLIC: &str = "ed25519";

/// Somebody's private key, the classes of device that images are signed for, and the counter they get.
#[derive(Clone, Debug)]
pub struct Signer {
    key: SigningKey,
    /// The classes.
    pub classes: DeviceClasses,
    /// The counter: above that of every image of the same pass that was signed before.
    pub counter: u32,
}

/// What a command that writes images says of their signature.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct SignFlags {
    /// Sign images with this private key (truepath key new).
    #[arg(long, value_name = "KEY")]
    pub sign: Option<std::path::PathBuf>,
    /// Sign for devices of these classes only.
    #[arg(long = "for", value_name = "CLASS", value_delimiter = ',', value_parser = class, requires = "sign")]
    pub classes: Vec<DeviceClass>,
    /// Counter of the signature, in place of the time in seconds since 1970: a device takes none below one that was in use.
    #[arg(long, value_name = "N", requires = "sign")]
    pub counter: Option<u32>,
}

impl SignFlags {
    /// Who signs, if anybody does.
    ///
    /// # Errors
    /// As [`Signer::read`], and `K023`.
    pub fn signer(&self) -> Result<Option<Signer>, InputError> {
        let Some(file) = self.sign.as_deref() else { return Ok(None) };
        let counter = self.counter.map_or_else(now, Ok)?;
        Ok(Some(Signer { counter, ..Signer::read(file, &self.classes)? }))
    }
}

/// A class of device by its name.
///
/// # Errors
/// The names there are.
pub fn class(text: &str) -> Result<DeviceClass, String> {
    let names = || DeviceClass::ALL.map(DeviceClass::name).join(", ");
    DeviceClass::ALL.into_iter().find(|class| class.name() == text).ok_or_else(|| format!("one of {}", names()))
}

/// A role by its name.
///
/// # Errors
/// The names there are.
pub fn role(text: &str) -> Result<Role, String> {
    let names = || Role::ALL.map(Role::name).join(", ");
    Role::ALL.into_iter().find(|role| role.name() == text).ok_or_else(|| format!("one of {}", names()))
}

/// The number of a key from its digits.
///
/// # Errors
/// What it looks like.
pub fn key_id(text: &str) -> Result<KeyId, String> {
    unhex(text).map(KeyId).ok_or_else(|| "16 hexadecimal digits".to_owned())
}

impl Signer {
    /// A key from its seed; signs for every class, with the least counter.
    pub fn of_seed(seed: &[u8; 32]) -> Self {
        Self { key: SigningKey::from_bytes(seed), classes: DeviceClasses::ALL, counter: 0 }
    }
    /// Reads a private key; it signs for `classes`, for all without any, with the least counter.
    ///
    /// # Errors
    /// `F001` and `K020` to `K022`.
    pub fn read(path: &Path, classes: &[DeviceClass]) -> Result<Self, InputError> {
        let source = Source::read(path)?;
        refuse_open(path)?;
        let lines = lines(&source)?;
        let [Line { word: PRIVATE, bytes, .. }] = &lines[..] else {
            let Some(other) = lines.iter().find(|line| line.word == PUBLIC) else {
                return Err(K020
                    .error("no single private key is in the file", "one line, ed25519-seed and 64 digits")
                    .in_file(path));
            };
            let error = K021.error("this is a public key, which signs nothing", "a private key");
            return Err(error.at(&source, other.span.clone()));
        };
        let classes = DeviceClasses::of(classes).unwrap_or(DeviceClasses::ALL);
        Ok(Self { classes, ..Self::of_seed(bytes) })
    }
    /// The text of its file.
    pub fn text(&self) -> String {
        let digits = hex(&self.key.to_bytes());
        format!("# truepath private key {}: keep it to yourself\n{PRIVATE} {digits}\n", self.public().id())
    }
    /// The key that others verify with.
    pub fn public(&self) -> PublicKey {
        PublicKey(self.key.verifying_key().to_bytes())
    }
    /// The signature of a message.
    pub fn sign(&self, message: &[u8]) -> [u8; 64] {
        self.key.sign(message).to_bytes()
    }
    /// An image with its signature; one that is signed already gets this one in place of the other.
    ///
    /// # Errors
    /// The bytes are no image, which those who write one have seen to.
    pub fn signed(&self, image: &[u8]) -> Result<Vec<u8>, Failure> {
        let mut bytes = vec![0; signed_bytes(image)];
        sign(image, &self.public(), self.classes, self.counter, |message| self.sign(message), &mut bytes)
            .map_err(|error| Failure::Internal(error.to_string()))?;
        Ok(bytes)
    }
}

/// The time, as the counter of a signature.
///
/// # Errors
/// `K023`.
pub fn now() -> Result<u32, InputError> {
    if let Some(stated) = std::env::var_os("SOURCE_DATE_EPOCH") {
        let stated = stated.to_string_lossy();
        let expected = "whole seconds since 1970, up to 4294967295";
        return stated.parse().map_err(|_| K023.error(format!("SOURCE_DATE_EPOCH is {stated:?}"), expected));
    }
    // Nobody signs in a browser, which has no such clock.
    #[cfg(not(target_family = "wasm"))]
    let seconds = std::time::SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default().as_secs();
    #[cfg(target_family = "wasm")]
    let seconds = 0u64;
    Ok(u32::try_from(seconds).unwrap_or(u32::MAX))
}

/// The text of a file with one public key.
pub fn public_text(key: &PublicKey) -> String {
    format!("# truepath public key {}\n{PUBLIC} {}\n", key.id(), hex(&key.0))
}

/// Reads a file of public keys, at least one.
///
/// # Errors
/// `F001`, `K020`, `K021`; a key that cannot be used, with the code of the core.
pub fn read_public(path: &Path) -> Result<Vec<PublicKey>, InputError> {
    let source = Source::read(path)?;
    let lines = lines(&source)?;
    let mut keys = Vec::new();
    for Line { word, bytes, span } in &lines {
        if *word == PRIVATE {
            let error = K021.error("this is a private key, which is for nobody else to see", "a public key");
            return Err(error.at(&source, span.clone()));
        }
        let key = PublicKey(*bytes);
        key.check()
            .map_err(|e| InputError::of_core(e.code(), e.to_string(), "", e.help()).at(&source, span.clone()))?;
        keys.push(key);
    }
    if keys.is_empty() {
        return Err(K020.error("no key is in the file", "lines of ed25519 and 64 hexadecimal digits").in_file(path));
    }
    Ok(keys)
}

/// A line with a key.
struct Line<'a> {
    word: &'a str,
    bytes: [u8; 32],
    span: Range<usize>,
}

fn lines(source: &Source) -> Result<Vec<Line<'_>>, InputError> {
    let text = std::str::from_utf8(source.bytes()).map_err(|e| {
        K020.error("this is not text", "a file of keys").at(source, e.valid_up_to()..e.valid_up_to() + 1)
    })?;
    let mut found = Vec::new();
    let mut at = 0;
    for whole in text.split_inclusive('\n') {
        let line = whole.trim();
        let begin = at + (whole.len() - whole.trim_start().len());
        at += whole.len();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let span = begin..begin + line.len();
        let (word, digits) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let wrong = |found: String| K020.error(found, "ed25519 or ed25519-seed, and 64 hexadecimal digits");
        let known = [PRIVATE, PUBLIC].into_iter().find(|known| *known == word);
        let Some(word) = known else {
            return Err(wrong(format!("a line of a key file begins with {word:?}")).at(source, span));
        };
        let Some(bytes) = unhex(digits.trim()) else {
            return Err(wrong("behind the kind of key are no 64 hexadecimal digits".to_owned()).at(source, span));
        };
        found.push(Line { word, bytes, span });
    }
    Ok(found)
}

fn hex(bytes: &[u8; 32]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn unhex<const BYTES: usize>(digits: &str) -> Option<[u8; BYTES]> {
    let (pairs, []) = digits.as_bytes().as_chunks::<2>() else { return None };
    let mut bytes = [0; BYTES];
    if pairs.len() != BYTES {
        return None;
    }
    for (byte, pair) in bytes.iter_mut().zip(pairs) {
        let value = |digit: u8| char::from(digit).to_digit(16);
        *byte = (value(pair[0])? << 4 | value(pair[1])?) as u8;
    }
    Some(bytes)
}

/// Refuses a private key that others can read.
#[cfg(unix)]
fn refuse_open(path: &Path) -> Result<(), InputError> {
    use std::os::unix::fs::PermissionsExt;
    let mode = std::fs::metadata(path).map_or(0, |found| found.permissions().mode());
    if path == Path::new("-") || mode & 0o077 == 0 {
        return Ok(());
    }
    let found = format!("others can read or write the private key ({:03o})", mode & 0o777);
    Err(K022.error(found, "a file for its owner alone (600)").in_file(path))
}
#[cfg(not(unix))]
fn refuse_open(_: &Path) -> Result<(), InputError> {
    Ok(())
}
