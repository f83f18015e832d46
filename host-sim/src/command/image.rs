//! `truepath image`: a correction image as text.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use truepath_core::image::{Image, ImageError, dump};
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::files;
use truepath_ground::output::write_file;

use crate::terminal::{Terminal, print};

/// Which image.
#[derive(Debug, Args)]
pub struct Options {
    /// The correction image.
    file: PathBuf,
    /// Write to a file instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the output file if it exists.
    #[arg(long, requires = "output")]
    force: bool,
}

/// Prints the image.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let bytes = read(&options.file)?;
    let image = check(&bytes, &options.file)?;
    let mut text = String::new();
    dump(&image, &mut text).map_err(|e| Failure::Internal(e.to_string()))?;
    if terminal.json() {
        text = json(&text)?;
    }
    match &options.output {
        Some(path) => Ok(write_file(path, options.force, text.as_bytes())?),
        None => print(text.as_bytes()),
    }
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
        let value = match (name.ends_with("crc"), number(value), value) {
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
