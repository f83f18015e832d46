//! The commands as a user calls them: what they write, what they say and what they refuse.

mod batch;
mod bore_command;
mod command_line;
mod depths;
mod dimensions;
mod features;
mod fillet;
mod forces_command;
mod inches;
mod init;
mod inspection;
mod learn_refused;
mod multiaxis_contact;
mod multiaxis_example;
mod multiaxis_examples;
mod multiaxis_modes;
mod multiaxis_program;
mod multiaxis_rewritten;
mod multiaxis_support;
mod pack;
mod plan;
mod plan_learn;
mod plot;
mod pocket;
mod pocket_plant;
mod pocket_slot;
mod probe_command;
mod process;
#[cfg(unix)]
mod publish;
#[cfg(unix)]
#[path = "../../publish/tests/all/support/mod.rs"]
mod publish_support;
mod qif;
mod recorded;
mod rehearsal;
mod replay;
mod report_page;
mod rib;
mod several;
mod shop_corners;
mod signed_images;
mod split_allowance;
mod store;
mod study;
mod summary_schema;
mod target_and_guard;
mod verification;
mod whole_wall;
mod workplace;
