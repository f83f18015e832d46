//! The firmware on the host: bench link, configuration service, flash and ledger.

mod bench_batches;
mod config_interrupted;
mod flash_rules;
#[path = "../../../core/tests/all/job_support/mod.rs"]
mod job_support;
mod ledger_pages;
mod ledger_records;
mod ledger_series;
mod stm32h743;
mod update_power;
mod wire_compute;
mod wire_counted;
mod wire_histories;
mod wire_logged;
mod wire_longest;
mod wire_messages;
mod wire_modes;
mod wire_power;
mod wire_reset;
mod wire_roles;
mod wire_setpoints;
mod wire_settings;
mod wire_signed;
mod wire_support;
mod wire_timing;
mod wire_update;
mod wire_upload;
