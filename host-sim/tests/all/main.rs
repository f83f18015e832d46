//! The commands as a user calls them: what they write, what they say and what they refuse.

mod bore_command;
mod command_line;
mod features;
mod inspection;
mod learn_refused;
mod multiaxis_contact;
mod multiaxis_example;
mod multiaxis_examples;
mod multiaxis_modes;
mod multiaxis_program;
mod multiaxis_rewritten;
mod multiaxis_support;
mod plot;
mod pocket;
mod pocket_plant;
mod pocket_slot;
mod probe_command;
mod recorded;
mod rehearsal;
mod replay;
mod report_page;
mod shop_corners;
mod split_allowance;
mod study;
mod target_and_guard;
mod verification;
