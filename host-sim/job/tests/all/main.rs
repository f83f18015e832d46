//! Jobs, programs and probe files: what is read, and what is refused with its place.

mod cut_with;
mod dimensions;
mod inches;
mod job_errors;
mod keys;
mod measurement;
mod probe_files;
mod probe_formats;
mod probe_refused;
mod runout;
mod store;
