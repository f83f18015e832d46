//! `truepath image`: a correction image as text; its signature.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use truepath_core::image::{
    DeviceClass, Image, ImageError, KeyId, KeyRing, KeyRingError, PublicKey, SignatureError, Signed, dump, verify,
};
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::files;
use truepath_ground::output::write_file;
use truepath_job::signing::{Signer, class, now, read_public};

use crate::terminal::{Terminal, print};

/// Which image.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Options {
    /// The correction image.
    #[arg(required = true)]
    file: Option<PathBuf>,
    /// Write to a file instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the output file if it exists.
    #[arg(long, requires = "output")]
    force: bool,
    #[command(subcommand)]
    task: Option<Task>,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Whether an image is signed with one of some keys: exit code 0, else 1.
    Verify {
        /// The correction image.
        file: PathBuf,
        /// A file of public keys; more than one may be named.
        #[arg(long, value_name = "PUB", required = true)]
        key: Vec<PathBuf>,
        /// The class of device that is to take it; otherwise any.
        #[arg(long = "for", value_name = "CLASS", value_parser = class)]
        class: Option<DeviceClass>,
    },
    /// Signs an image, in place of the signature it may have.
    Sign {
        /// The correction image.
        file: PathBuf,
        /// The private key (truepath key new).
        #[arg(long, value_name = "KEY")]
        key: PathBuf,
        /// Sign for devices of these classes only: board, linuxcnc, bench.
        #[arg(long = "for", value_name = "CLASS", value_delimiter = ',', value_parser = class)]
        classes: Vec<DeviceClass>,
        /// Counter of the signature. [default: the time in seconds since 1970, or one more than the image has]
        #[arg(long, value_name = "N")]
        counter: Option<u32>,
        /// The signed image.
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        /// Replace the output file if it exists.
        #[arg(long)]
        force: bool,
    },
}

/// Prints the image.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let file = match (&options.task, &options.file) {
        (Some(Task::Verify { file, key, class }), _) => return verified(file, key, *class, terminal),
        (Some(Task::Sign { file, key, classes, counter, output, force }), _) => {
            return signed(file, (Signer::read(key, classes)?, *counter), (output, *force), terminal);
        }
        (None, Some(file)) => file,
        (None, None) => return Err(Failure::Internal("an image without a name".to_owned())),
    };
    let bytes = read(file)?;
    let image = check(&bytes, file)?;
    let mut text = String::new();
    dump(&image, Signed::of(&bytes).as_ref(), &mut text).map_err(|e| Failure::Internal(e.to_string()))?;
    if terminal.json() {
        text = json(&text)?;
    }
    match &options.output {
        Some(path) => Ok(write_file(path, options.force, text.as_bytes())?),
        None => print(text.as_bytes()),
    }
}

/// Verifies the signature of an image.
fn verified(file: &Path, keys: &[PathBuf], class: Option<DeviceClass>, terminal: &Terminal) -> Result<(), Failure> {
    let bytes = read(file)?;
    check(&bytes, file)?;
    let mut ring = KeyRing::default();
    for path in keys {
        for key in read_public(path)? {
            ring.add(key).map_err(|error| refused_key(error, &key, path))?;
        }
    }
    let untrusted = |error: SignatureError| {
        let found = match error {
            SignatureError::Missing => format!("{} is not signed", file.display()),
            _ => format!("{}: {error}", file.display()),
        };
        InputError::of_core(error.code(), found, "an image signed with one of the keys", error.help()).in_file(file)
    };
    let signed = Signed::of(&bytes).ok_or_else(|| untrusted(SignatureError::Missing))?;
    let any = DeviceClass::ALL.into_iter().find(|&one| signed.classes.holds(one));
    let class = class.or(any).unwrap_or(DeviceClass::Board);
    let Signed { key, classes, counter, .. } = verify(&bytes, &ring, class).map_err(untrusted)?;
    let (key, classes) = (key.to_string(), classes.to_string());
    let value = serde_json::json!({ "key": key, "for": classes, "counter": counter });
    terminal.tell(&value, || format!("signed with key {key} for {classes}, counter {counter}\n"))
}

fn refused_key(error: KeyRingError, key: &PublicKey, path: &Path) -> InputError {
    match error {
        KeyRingError::Key(error) => {
            InputError::of_core(error.code(), error.to_string(), "", error.help()).in_file(path)
        }
        // The keys of a file have all rights.
        KeyRingError::Full | KeyRingError::OtherRights { .. } => {
            let found = format!("key {} is one too many", key.id());
            let expected = format!("at most {} keys, as many as a device trusts", truepath_core::image::MOST_KEYS);
            C001.error(found, expected).in_file(path)
        }
    }
}

/// Writes the signed form of an image. One that is signed already gets a higher counter, whatever the clock says: this is
/// the way back to an image that devices refuse as too old.
fn signed(
    file: &Path,
    (mut signer, counter): (Signer, Option<u32>),
    to: (&Path, bool),
    terminal: &Terminal,
) -> Result<(), Failure> {
    let bytes = read(file)?;
    check(&bytes, file)?;
    let before = Signed::of(&bytes).map(|signed| (signed.key, signed.counter));
    let least = before.map_or(0, |(_, counter)| counter.saturating_add(1));
    signer.counter = counter.map_or_else(|| now().map(|now| now.max(least)), Ok)?;
    let counter = signer.counter;
    let bytes = signer.signed(&bytes)?;
    let crc = Image::new_checked(&bytes).map_err(|e| Failure::Internal(e.to_string()))?.crc();
    let (output, force) = to;
    write_file(output, force, &bytes)?;
    let (key, classes) = (signer.public().id().to_string(), signer.classes.to_string());
    let name = |(key, counter): (KeyId, u32)| serde_json::json!({ "key": key.to_string(), "counter": counter });
    let value = serde_json::json!({ "key": key, "for": classes, "counter": counter, "before": before.map(name),
        "crc": format!("{crc:08x}"), "file": output });
    let instead = before.map_or_else(String::new, |(key, counter)| format!(", in place of {counter} by key {key}"));
    terminal.tell(&value, || {
        format!(
            "image {crc:08x} signed with key {key} for {classes}, counter {counter}{instead}: {}\n",
            output.display()
        )
    })
}

/// The bytes of an image file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, InputError> {
    files::read(path).map_err(|e| InputError::unreadable(path, &e))
}

/// A checked image; `I…` with the core's number for what it refuses.
pub(super) fn check<'b>(bytes: &'b [u8], path: &Path) -> Result<Image<'b>, InputError> {
    Image::new_checked(bytes).map_err(|error| {
        let sentence = error.to_string();
        let (found, help) = sentence.split_once(": ").unwrap_or((&sentence, ""));
        let (expected, help) = match error {
            ImageError::Magic => ("a correction image (.tpi) written by truepath correct", "name that file"),
            _ if help.starts_with("make") => {
                ("an image for this program", "make the image again with truepath correct")
            }
            _ => ("an image as truepath correct wrote it", "copy the file again, or make the image again"),
        };
        // The detail behind the colon belongs to what was found when it is no instruction.
        let found = if help.is_empty() || sentence.contains("make the image") { found } else { &sentence };
        InputError::of_core(error.code(), format!("{}: {found}", path.display()), expected, help).in_file(path)
    })
}

/// The lines of the text as an object: `name = value` as members, nodes as an array of arrays.
fn json(text: &str) -> Result<String, Failure> {
    let number = |word: &str| word.parse::<serde_json::Number>().ok();
    let mut members = serde_json::Map::new();
    let mut nodes = Vec::new();
    for line in text.lines() {
        let Some((name, value)) = line.split_once(" = ") else {
            // A node; its index is its place in the array.
            let numbers = line.split(' ').skip(1).filter_map(number).map(serde_json::Value::Number);
            nodes.push(serde_json::Value::Array(numbers.collect()));
            continue;
        };
        // Checksums are names, not quantities.
        let value = match (name.ends_with("crc") || name == "signature_key", number(value), value) {
            (false, Some(n), _) => serde_json::Value::Number(n),
            (false, None, "true" | "false") => serde_json::Value::Bool(value == "true"),
            (false, None, list) if list.contains(' ') => {
                list.split(' ').filter_map(number).map(serde_json::Value::Number).collect()
            }
            _ => serde_json::Value::String(value.to_owned()),
        };
        members.insert(name.to_owned(), value);
    }
    members.insert("nodes".to_owned(), serde_json::Value::Array(nodes));
    let mut text = serde_json::to_string_pretty(&members).map_err(|e| Failure::Internal(e.to_string()))?;
    // Writing to a String cannot fail.
    let _ = writeln!(text);
    Ok(text)
}
