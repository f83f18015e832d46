//! Error codes: every error that a user can meet is one row, and only a row makes an error.
//!
//! Each room declares its rows with [`codes!`](crate::codes!) in a module of this name. From all of them
//! `cargo xtask errors --write` makes docs/errors.md.

/// A row of a catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Row {
    /// The code: a letter and three digits, stable.
    pub code: &'static str,
    /// What it means.
    pub says: &'static str,
    /// What to do. An error may know better.
    pub remedy: &'static str,
}

impl Row {
    /// For [`codes!`](crate::codes!) alone.
    #[doc(hidden)]
    pub const fn new(code: &'static str, says: &'static str, remedy: &'static str) -> Self {
        Self { code, says, remedy }
    }
}

/// Declares a constant for every row, `CODE => "what it means" / "what to do"`, and `CATALOGUE` with all of them.
#[macro_export]
macro_rules! codes {
    ($($code:ident => $says:literal / $remedy:literal,)+) => {
        $(
            #[doc = concat!("An error: ", $says, ".")]
            pub const $code: $crate::codes::Row = $crate::codes::Row::new(stringify!($code), $says, $remedy);
        )+

        /// All rows, in their order.
        pub const CATALOGUE: &[$crate::codes::Row] = &[$($code),+];
    };
}

codes! {
    F001 => "a file cannot be read"
        / "check the name and the permissions",
    F002 => "a file or a folder cannot be written"
        / "check that the folder exists and may be written to",
    F003 => "an output exists already, or is of another kind than what is written"
        / "name another output, or add --force to replace it",
    F004 => "another run writes the same folder"
        / "wait until it has ended, or name another folder",
    C001 => "arguments that do not go together, or a value out of range"
        / "run the command with --help",
    J002 => "not TOML, or not UTF-8"
        / "correct the line; https://toml.io shows the notation",
    J003 => "an unknown key"
        / "remove it, or correct its name",
    J004 => "a key or a table is missing"
        / "add it with a value in the range that the error names",
    J005 => "a value of the wrong type"
        / "write a value of the type that the error names",
    J006 => "a value out of range"
        / "write a value in the range that the error names",
    J007 => "an unknown name"
        / "write one of the names exactly",
    J008 => "keys that contradict each other"
        / "remove or correct one of them",
    J010 => "another version of the format"
        / "write version = 1, or use the program the file was made for",
    Z006 => "no table, a column that is missing, or a line with another number of fields"
        / "write the table again with the command it comes from",
    Z007 => "a field that is no number, or beyond ±1e9"
        / "correct the field, or write the table again",
    Z008 => "an arc length that falls"
        / "correct the field, or write the table again",
    Z010 => "a table of more than 2,000,000 lines or 1 GB"
        / "cut it into pieces",
    X001 => "a fault of the program itself"
        / "this is a fault of the program: please report it with the command and its input files",
}
