//! Batches drawn at random, against what was drawn.

mod drawn;
mod followed;
