//! Where a store is: a file, or a database of a server.

use std::fmt;
use std::path::{Path, PathBuf};

use truepath_job::job::{StorePlace, without_password};

/// The environment variable that names one.
pub const VARIABLE: &str = "TRUEPATH_STORE";

/// Where a store is.
#[derive(Clone, PartialEq, Eq)]
pub enum Place {
    /// A file of SQLite.
    File(PathBuf),
    /// A database of PostgreSQL, as a URL.
    Server(String),
}

impl Place {
    /// Of a text: a URL of PostgreSQL, or the name of a file.
    pub fn of(text: &str) -> Self {
        let server = ["postgres://", "postgresql://"].iter().any(|scheme| text.starts_with(scheme));
        if server { Self::Server(text.to_owned()) } else { Self::File(PathBuf::from(text)) }
    }

    /// Of the place that a job names.
    pub fn of_job(place: &StorePlace) -> Self {
        match place {
            StorePlace::File(path) => Self::File(path.clone()),
            StorePlace::Server(url) => Self::Server(url.clone()),
        }
    }

    /// What the environment names.
    pub fn of_environment() -> Option<Self> {
        std::env::var(VARIABLE).ok().filter(|text| !text.is_empty()).map(|text| Self::of(&text))
    }

    /// The file, where it is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Server(_) => None,
        }
    }
}

/// As it may be shown: without a password.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Server(url) => f.write_str(&without_password(url)),
        }
    }
}

impl fmt::Debug for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Place({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_is_never_shown() {
        for url in ["postgres://ann:se:c@ret@db/shop", "postgresql://db/shop?user=ann&password=secret&sslmode=require"]
        {
            let shown = format!("{} {:?}", Place::of(url), Place::of(url));
            assert!(!shown.contains("ret") && !shown.contains("secret") && shown.contains("ann"), "{shown}");
        }
        assert_eq!(Place::of("shop.db"), Place::File("shop.db".into()));
    }
}
