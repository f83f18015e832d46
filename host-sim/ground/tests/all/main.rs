//! Files written whole or not at all.

mod output_files;
