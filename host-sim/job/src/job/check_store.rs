//! The `[store]` table: the shop store that the parts of this job go into, and what they were cut on, with and from.
//!
//! Every key is optional, and so is the table. A job goes from hand to hand, so it holds no password.

use std::path::{Path, PathBuf};

use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::Section;

use super::check_part::line;
use crate::codes::J045;

/// What the table says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StoreTable {
    /// Where the store is.
    pub place: Option<StorePlace>,
    /// What the parts were cut on, with and from.
    pub names: StoreNames,
    /// Where the fit to the points begins.
    pub prior: PriorOf,
}

/// Where the fit to the points of a part begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PriorOf {
    /// At what the job states of machine and material.
    #[default]
    Job,
    /// At what other jobs of the store say of them.
    Shop,
}

/// Where it may begin, by name.
const PRIORS: [(&str, PriorOf); 2] = [("job", PriorOf::Job), ("shop", PriorOf::Shop)];

/// Where a store is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StorePlace {
    /// A file, as a path that can be opened.
    File(PathBuf),
    /// A database of a PostgreSQL server, as a URL without a password.
    Server(String),
}

/// What a part was cut on, with and from, as the shop calls it; texts of 1 to 100 characters in a job.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct StoreNames {
    /// The make of the machine: machines of one make are more alike.
    #[arg(long, value_name = "NAME")]
    pub make: Option<String>,
    /// The machine.
    #[arg(long, value_name = "NAME")]
    pub machine: Option<String>,
    /// The holder of the cutter.
    #[arg(long, value_name = "NAME")]
    pub holder: Option<String>,
    /// The article number of the cutter.
    #[arg(long, value_name = "ARTICLE")]
    pub cutter: Option<String>,
    /// The very cutter: what is engraved on it, or its number in the tool crib.
    #[arg(long, value_name = "TEXT")]
    pub cutter_serial: Option<String>,
    /// The material.
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// The lot of the material.
    #[arg(long, value_name = "TEXT")]
    pub lot: Option<String>,
    /// The serial number of the part that was measured last.
    #[arg(long, value_name = "TEXT")]
    pub serial: Option<String>,
}

/// What the table says; relative paths start at `folder`.
pub(super) fn store(source: &Source, section: Option<&Section<'_>>, folder: &Path) -> Result<StoreTable, InputError> {
    let Some(section) = section else { return Ok(StoreTable::default()) };
    let place = match (section.text("path")?, section.text("url")?) {
        (None, None) => None,
        (Some(("", value)), None) => {
            return Err(section.out_of_range(&value, "the name of a file", "name the store, relative to this file"));
        }
        (Some((path, _)), None) => Some(StorePlace::File(folder.join(path))),
        (None, Some((url, value))) => {
            if !["postgres://", "postgresql://"].iter().any(|scheme| url.starts_with(scheme)) {
                let help = "write url = \"postgres://host/database\", or path = \"shop.db\" for a file";
                return Err(section.out_of_range(&value, "a URL that begins with postgres://", help));
            }
            if has_password(url) {
                let found = format!("store.url holds a password: {}", without_password(url));
                // The line is not shown: whoever looks on would read the password.
                return Err(J045.error(found, "a URL without one").in_file(Path::new(source.name())));
            }
            Some(StorePlace::Server(url.to_owned()))
        }
        (Some(_), Some((_, value))) => {
            let help = "remove path for a server, or url for a file";
            return Err(section.contradiction(&value, "store.url is given as well as store.path", "one store", help));
        }
    };
    let names = StoreNames {
        make: line(section, "make")?,
        machine: line(section, "machine")?,
        holder: line(section, "holder")?,
        cutter: line(section, "cutter")?,
        cutter_serial: line(section, "cutter_serial")?,
        material: line(section, "material")?,
        lot: line(section, "lot")?,
        serial: line(section, "serial")?,
    };
    let prior = section.choice("prior", &PRIORS)?.unwrap_or_default();
    section.close()?;
    Ok(StoreTable { place, names, prior })
}

/// Whether the URL of a server holds a password.
pub fn has_password(url: &str) -> bool {
    without_password(url) != url
}

/// A URL as it may be shown: `…` in place of its password.
pub fn without_password(url: &str) -> String {
    let (scheme, rest) = url.split_once("://").unwrap_or(("", url));
    let (before, query) = rest.split_once('?').map_or((rest, None), |(before, query)| (before, Some(query)));
    // A password may hold an @ or a / that should have been escaped: all up to the last @ is user and password.
    let shown = match before.rsplit_once('@') {
        Some((user, host)) => match user.split_once(':') {
            Some((name, _)) => format!("{name}:…@{host}"),
            None => before.to_owned(),
        },
        None => before.to_owned(),
    };
    let query = query.map(|query| {
        let shown = query.split('&').map(|pair| match pair.split_once('=') {
            Some((key, _)) if key.eq_ignore_ascii_case("password") => format!("{key}=…"),
            _ => pair.to_owned(),
        });
        format!("?{}", shown.collect::<Vec<_>>().join("&"))
    });
    format!("{scheme}://{shown}{}", query.unwrap_or_default())
}
