//! Bytes → words: numbers, letters, comments and statements of one line, without knowing what they mean.

mod decimal;
mod number;
mod word;

pub use decimal::Decimal;
pub(super) use decimal::is_blank;
pub use number::Number;
pub use word::{Token, Words, WrittenWord};
