//! Bytes → words: numbers, letters, comments and statements of one line, without knowing what they mean.

mod decimal;
mod extent;
mod number;
mod symbol;
mod token;
mod word;

pub use decimal::{Decimal, NumberError};
pub(super) use decimal::{is_blank, number, plain_number, trimmed};
pub(super) use extent::behind_comments;
pub use number::Number;
pub(super) use symbol::{Function, Operator, spelled};
pub use token::{Token, WrittenWord};
pub use word::Words;
pub(super) use word::is_word;
