//! Canonical text, and corrected programs against their originals.

mod canon_text;
mod program_dialect;
mod program_writer;
mod program_writer_random;
