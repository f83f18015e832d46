//! A story as bytes: a tar archive in gzip, which any archiver opens, with `story.json` at its head.
//!
//! The same story gives the same bytes: no times, no owners, names in order. What is read may come from anywhere: sizes are
//! bounded before they are held, names stay in their folder on every system, only plain files are taken, and every file is the
//! one that `story.json` tells of.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Write};

use flate2::read::GzDecoder;
use flate2::{Compression, GzBuilder};
use tar::{Archive, Builder, EntryType, Header};
use truepath_core::checksum::crc32;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::output::json;

use crate::codes::{U001, U002, U003};
use crate::contents::{Story, Told, VERSION};

/// The file at the head.
pub const HEAD: &str = "story.json";
/// Bytes of a pack at most.
pub const MOST_PACKED: usize = 64 << 20;
/// Bytes of all its files at most.
pub const MOST_UNPACKED: u64 = 256 << 20;
/// Files at most.
pub const MOST_FILES: usize = 2000;
/// Letters of a name at most.
pub const LONGEST_NAME: usize = 200;

/// Writes a story.
///
/// # Errors
/// `U002` for a name that a pack may not hold, `U003` beyond the limits.
pub fn packed(story: &Story) -> Result<Vec<u8>, Failure> {
    let size: u64 = story.files.values().map(|bytes| bytes.len() as u64).sum();
    within_limits(story.files.len() + 1, size)?;
    let internal = |error: std::io::Error| Failure::Internal(format!("a pack cannot be written: {error}"));
    let zipped = GzBuilder::new().mtime(0).operating_system(255).write(Vec::new(), Compression::best());
    let mut archive = Builder::new(zipped);
    let head = json(&story.told)?;
    let files = story.files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    for (name, bytes) in std::iter::once((HEAD, head.as_slice())).chain(files) {
        sound_name(name)?;
        let mut header = Header::new_gnu();
        header.set_entry_type(EntryType::Regular);
        header.set_mode(0o644);
        header.set_size(bytes.len() as u64);
        archive.append_data(&mut header, name, bytes).map_err(internal)?;
    }
    let mut zipped = archive.into_inner().map_err(internal)?;
    zipped.flush().map_err(internal)?;
    let bytes = zipped.finish().map_err(internal)?;
    if bytes.len() > MOST_PACKED {
        let found = format!("{} bytes when packed", bytes.len());
        return Err(U003.error(found, format!("at most {MOST_PACKED}")).into());
    }
    Ok(bytes)
}

/// Reads a story.
///
/// # Errors
/// `U001` for a damaged file or another one, `U002` for names that lead out of the folder and what is no file, `U003` beyond
/// the limits.
pub fn unpacked(bytes: &[u8]) -> Result<Story, InputError> {
    if bytes.len() > MOST_PACKED {
        return Err(U003.error(format!("{} bytes", bytes.len()), format!("at most {MOST_PACKED}")));
    }
    let broken =
        |why: &dyn std::fmt::Display| U001.error(format!("the pack is damaged ({why})"), "a pack as it was written");
    // One byte more than allowed tells a bomb from a pack of just the size; headers and padding are counted with the files.
    let mut plain = Vec::new();
    let mut zipped = GzDecoder::new(bytes);
    let most = MOST_UNPACKED + 1024 * MOST_FILES as u64;
    zipped.by_ref().take(most + 1).read_to_end(&mut plain).map_err(|error| broken(&error))?;
    if plain.len() as u64 > most {
        return Err(U003.error("it unpacks to more than it may", format!("at most {MOST_UNPACKED} bytes")));
    }
    if !zipped.into_inner().is_empty() {
        return Err(broken(&"something follows its end"));
    }
    let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut alike = BTreeSet::new();
    let mut archive = Archive::new(plain.as_slice());
    let mut size = 0u64;
    for entry in archive.entries().map_err(|error| broken(&error))? {
        let mut entry = entry.map_err(|error| broken(&error))?;
        let path = entry.path_bytes();
        let name = std::str::from_utf8(&path).map_err(|_| U002.error("a name that is not UTF-8", "names in UTF-8"))?;
        let name = name.to_owned();
        drop(path);
        if entry.header().entry_type() != EntryType::Regular {
            return Err(U002.error(format!("{name} is a link, a folder or a device"), "plain files alone"));
        }
        sound_name(&name)?;
        // Some systems do not tell capitals from small letters.
        if !alike.insert(name.to_lowercase()) {
            return Err(U002.error(format!("{name} is there twice"), "every name once"));
        }
        size = size.saturating_add(entry.size());
        within_limits(files.len() + 1, size)?;
        let mut content = Vec::new();
        entry.read_to_end(&mut content).map_err(|error| broken(&error))?;
        if content.len() as u64 != entry.size() {
            return Err(broken(&format!("{name} is cut off")));
        }
        files.insert(name, content);
    }
    let head = files.remove(HEAD).ok_or_else(|| broken(&format!("no {HEAD}")))?;
    let told: Told = serde_json::from_slice(&head).map_err(|error| broken(&format!("{HEAD}: {error}")))?;
    if told.version != VERSION {
        let found = format!("{HEAD} is of version {}", told.version);
        return Err(U001.error(found, format!("version {VERSION}")));
    }
    agree(&told, &files).map_err(|why| broken(&why))?;
    Ok(Story { told, files })
}

/// Whether the files are those that the head tells of.
fn agree(told: &Told, files: &BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    if let Some(name) = told.files.keys().find(|name| !files.contains_key(*name)) {
        return Err(format!("{name} is missing"));
    }
    for (name, bytes) in files {
        match told.files.get(name) {
            None => return Err(format!("{HEAD} does not tell of {name}")),
            Some(sum) if *sum != format!("{:08x}", crc32(bytes)) => {
                return Err(format!("{name} is not what was packed"));
            }
            Some(_) => {}
        }
    }
    let named = told.steps.iter().flat_map(|step| step.readings().chain([&step.job])).chain(&told.cut_again);
    match named.into_iter().find(|name| !files.contains_key(*name)) {
        Some(name) => Err(format!("a step names {name}, which is not there")),
        None => {
            told.steps.iter().flat_map(|step| std::iter::once(&step.output).chain(&step.from)).try_for_each(|folder| {
                if folder.is_empty() { Ok(()) } else { sound_name(folder).map_err(|error| error.found().to_owned()) }
            })
        }
    }
}

/// Refuses too many files or bytes.
fn within_limits(files: usize, size: u64) -> Result<(), InputError> {
    if files > MOST_FILES {
        return Err(U003.error("too many files", format!("at most {MOST_FILES}")));
    }
    if size > MOST_UNPACKED {
        return Err(U003.error(format!("{size} bytes in its files"), format!("at most {MOST_UNPACKED}")));
    }
    Ok(())
}

/// Refuses a name that is not one of a file below the folder, on any system.
pub(crate) fn sound_name(name: &str) -> Result<(), InputError> {
    let refused = |why: &str| {
        Err(U002.error(format!("the name “{name}” {why}"), "a path below the folder, with / between its parts"))
    };
    if name.is_empty() || name.chars().count() > LONGEST_NAME {
        return refused("is empty or too long");
    }
    if name.starts_with('/') || name.split('/').any(|part| matches!(part, "" | "." | "..")) {
        return refused("leads out of the folder");
    }
    if name
        .chars()
        .any(|letter| letter.is_control() || matches!(letter, '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|'))
    {
        return refused("holds a letter that not every system allows");
    }
    if name.split('/').any(|part| part.ends_with(['.', ' ']) || is_device(part)) {
        return refused("is that of a device, or ends in a point or a blank");
    }
    Ok(())
}

/// Whether Windows takes a name for a device, whatever its extension.
fn is_device(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or_default().to_ascii_uppercase();
    let numbered = |name: &str| {
        stem.strip_prefix(name).is_some_and(|rest| rest.len() == 1 && rest.bytes().all(|b| b.is_ascii_digit()))
    };
    matches!(stem.as_str(), "CON" | "PRN" | "AUX" | "NUL") || numbered("COM") || numbered("LPT")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::contents::{Command, Step};

    fn story() -> Story {
        let step = Step {
            command: Command::Correct,
            job: "job.toml".to_owned(),
            probe: Some("probe.txt".to_owned()),
            dimensions: None,
            output: "out".to_owned(),
            from: None,
            feature: None,
        };
        let deep = format!("out/{}/summary.json", "contour".repeat(20));
        let files = ["job.toml", "probe.txt", "out/corrected.nc", deep.as_str()];
        let files = files.map(|name| (name.to_owned(), format!("this is {name}\n").repeat(50).into_bytes()));
        Story::new("truepath 0.0.0".to_owned(), vec![step], None, files.into_iter().collect())
    }

    /// A pack with these entries behind a head of its own, as another program might write it.
    fn foreign(entries: &[(&[u8], EntryType, &[u8])]) -> Vec<u8> {
        let mut archive = Builder::new(GzBuilder::new().write(Vec::new(), Compression::fast()));
        for (name, kind, bytes) in entries {
            let mut header = Header::new_gnu();
            header.set_entry_type(*kind);
            header.set_mode(0o644);
            header.set_size(bytes.len() as u64);
            // The crate refuses such names itself when asked politely.
            header.as_mut_bytes()[..name.len()].copy_from_slice(name);
            header.set_cksum();
            archive.append(&header, *bytes).expect("written");
        }
        archive.into_inner().expect("written").finish().expect("written")
    }

    #[test]
    fn a_story_comes_back_and_is_the_same_bytes_each_time() {
        let story = story();
        let bytes = packed(&story).expect("packed");
        assert_eq!(bytes, packed(&story).expect("packed"));
        assert_eq!(unpacked(&bytes).expect("unpacked"), story);
        assert_eq!(story.within("out").count(), 2);
        assert_eq!(story.within("").count(), 4);
    }

    #[test]
    fn a_name_that_leads_out_of_the_folder_is_refused_in_every_spelling() {
        let long = "x".repeat(LONGEST_NAME + 1);
        for name in [
            "../evil",
            "a/../../evil",
            "/etc/passwd",
            "a//b",
            "./a",
            "a/.",
            "..",
            "",
            "C:/a",
            "a\\..\\b",
            "a\nb",
            "con.txt",
            "out/LPT1",
            "a.",
            "a /b",
            &long,
        ] {
            assert_eq!(sound_name(name).expect_err(name).code(), "U002", "{name}");
        }
        for name in ["../evil", "/etc/passwd", "a/../../evil"] {
            let refused = unpacked(&foreign(&[(name.as_bytes(), EntryType::Regular, b"x")])).expect_err(name);
            assert_eq!(refused.code(), "U002");
        }
        assert!(sound_name("out/contours/pocket-1/summary.json").is_ok());
    }

    #[test]
    fn links_devices_and_names_that_stand_twice_are_refused() {
        for kind in [EntryType::Symlink, EntryType::Link, EntryType::Fifo, EntryType::Directory] {
            assert_eq!(unpacked(&foreign(&[(b"a", kind, b"")])).expect_err("a kind").code(), "U002");
        }
        let twice = foreign(&[(b"a", EntryType::Regular, b"x"), (b"A", EntryType::Regular, b"y")]);
        assert_eq!(unpacked(&twice).expect_err("twice").code(), "U002");
    }

    #[test]
    fn a_bomb_is_refused_before_it_is_held() {
        let zeros = vec![0u8; 1 << 20];
        let mut zipped = GzBuilder::new().write(Vec::new(), Compression::fast());
        for _ in 0..300 {
            zipped.write_all(&zeros).expect("written");
        }
        let bomb = zipped.finish().expect("written");
        assert!(bomb.len() < 4 << 20);
        assert_eq!(unpacked(&bomb).expect_err("a bomb").code(), "U003");
        let many: Vec<String> = (0..=MOST_FILES).map(|k| format!("f{k}")).collect();
        let many: Vec<_> = many.iter().map(|name| (name.as_bytes(), EntryType::Regular, &b""[..])).collect();
        assert_eq!(unpacked(&foreign(&many)).expect_err("many").code(), "U003");
    }

    #[test]
    fn what_the_head_does_not_tell_of_is_refused() {
        let mut changed = story();
        changed.files.insert("job.toml".to_owned(), b"another".to_vec());
        let said = unpacked(&packed(&changed).expect("packed")).expect_err("changed");
        assert!(said.code() == "U001" && said.found().contains("job.toml is not what was packed"), "{}", said.found());
        let mut more = story();
        more.files.insert("more.txt".to_owned(), Vec::new());
        assert!(
            unpacked(&packed(&more).expect("packed")).expect_err("more").found().contains("does not tell of more.txt")
        );
        let mut less = story();
        less.files.remove("probe.txt");
        assert!(unpacked(&packed(&less).expect("packed")).expect_err("less").found().contains("probe.txt is missing"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn a_damaged_pack_is_refused_or_the_same(at in any::<prop::sample::Index>(), bit in 0u8..8, cut in any::<bool>()) {
            let story = story();
            let mut bytes = packed(&story).expect("packed");
            let at = at.index(bytes.len());
            if cut { bytes.truncate(at); } else { bytes[at] ^= 1 << bit; }
            match unpacked(&bytes) {
                // Bits of the head of gzip that mean nothing here.
                Ok(read) => prop_assert_eq!(read, story),
                Err(error) => prop_assert!(["U001", "U002", "U003"].contains(&error.code()), "{}", error.code()),
            }
        }
    }
}
