//! Errors, each declared in one row: code, variant, sentence and, where there is one, help.
//!
//! A code is a letter and three digits and keeps its meaning: `G…` program, `J…` job, `M…` measurement, `I…` image,
//! `K101` on link, `W…` warnings and, from `W101` on, full buffers. The rows of an enum are its `CATALOGUE`.

/// One row of a catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// The code.
    pub code: &'static str,
    /// What is said, with the names of fields in braces; several where it depends on the fields.
    pub says: &'static [&'static str],
    /// What to do about it; empty where the sentence says so itself.
    pub help: &'static str,
}

/// The digits of a code as a number: 14 of `I014`.
pub const fn number(code: &str) -> u16 {
    match code.as_bytes() {
        [_, a @ b'0'..=b'9', b @ b'0'..=b'9', c @ b'0'..=b'9'] => ((*a & 15) as u16)
            .wrapping_mul(100)
            .wrapping_add(((*b & 15) as u16).wrapping_mul(10))
            .wrapping_add((*c & 15) as u16),
        _ => 0,
    }
}

/// Declares an enum of errors: the type, `code()`, `help()`, `CATALOGUE` and [`Display`](core::fmt::Display) from one row
/// for each variant.
///
/// A row is `Variant { field: Type } = "X001", "sentence with {field}", field = Shown(field) => "help";`. A sentence for
/// some values stands before it as `if condition => "sentence";`. The second block holds variants that carry the code of
/// something else.
///
/// ```
/// truepath_units::errors! {
///     /// What is wrong.
///     #[derive(Clone, Copy, Debug)]
///     pub enum Wrong {
///         /// Too many.
///         Many {
///             /// How many there may be.
///             limit: u8,
///         } = "X001",
///             if limit == 1 => "more than one";
///             "more than {limit}" => "take fewer";
///     }
/// }
/// assert_eq!((Wrong::Many { limit: 3 }.to_string(), Wrong::Many { limit: 1 }.code()), ("more than 3".into(), "X001"));
/// assert_eq!((Wrong::CATALOGUE[0].says, Wrong::CATALOGUE[0].help), (&["more than one", "more than {limit}"][..], "take fewer"));
/// ```
#[macro_export]
macro_rules! errors {
    (
        $(#[$meta:meta])*
        $vis:vis enum $name:ident {
            $(
                $(#[$doc:meta])*
                $variant:ident
                $(( $($item:ident: $item_type:ty),+ ))?
                $({ $( $(#[$field_doc:meta])* $field:ident: $field_type:ty ),+ $(,)? })?
                = $code:literal,
                $( if $condition:expr => $alternative:literal $(, $alternative_key:ident = $alternative_value:expr)*; )*
                $says:literal $(, $key:ident = $value:expr)* $(=> $help:literal)?;
            )*
        }
        $(with the code of {
            $(
                $(#[$other_doc:meta])*
                $other:ident
                $(( $($other_item:ident: $other_item_type:ty),+ ))?
                $({ $( $(#[$other_field_doc:meta])* $other_field:ident: $other_field_type:ty ),+ $(,)? })?
                = $inner:expr,
                $( if $other_condition:expr => $other_alternative:literal; )*
                $other_says:literal;
            )*
        })?
    ) => {
        $(#[$meta])*
        $vis enum $name {
            $(
                $(#[$doc])*
                $variant $(( $($item_type),+ ))? $({ $( $(#[$field_doc])* $field: $field_type ),+ })?,
            )*
            $($(
                $(#[$other_doc])*
                $other $(( $($other_item_type),+ ))? $({ $( $(#[$other_field_doc])* $other_field: $other_field_type ),+ })?,
            )*)?
        }

        impl $name {
            /// All of them but those that carry another's code.
            pub const CATALOGUE: &'static [$crate::errors::Row] = &[$(
                $crate::errors::Row { code: $code, says: &[$($alternative,)* $says], help: concat!($($help)?) },
            )*];

            /// The stable code of this kind.
            #[allow(unused_variables, reason = "only some sentences name their fields")]
            pub const fn code(self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $code,)*
                    $($(Self::$other $(( $($other_item),+ ))? $({ $($other_field),+ })? => $inner,)*)?
                }
            }

            /// What to do about it; empty where the sentence says so itself.
            pub const fn help(self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => concat!($($help)?),)*
                    $($(Self::$other { .. } => "",)*)?
                }
            }
        }

        impl core::fmt::Display for $name {
            #[allow(unused_variables, reason = "only some sentences name their fields")]
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match *self {
                    $(Self::$variant $(( $($item),+ ))? $({ $($field),+ })? => {
                        $(if $condition { return write!(f, $alternative $(, $alternative_key = $alternative_value)*); })*
                        write!(f, $says $(, $key = $value)*)
                    })*
                    $($(Self::$other $(( $($other_item),+ ))? $({ $($other_field),+ })? => {
                        $(if $other_condition { return write!(f, $other_alternative); })*
                        write!(f, $other_says)
                    })*)?
                }
            }
        }
    };
}
