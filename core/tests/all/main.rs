//! Job, program and touches in memory lent by the caller, whole and damaged.

mod job_damaged;
mod job_image;
mod job_support;
mod probe_damaged;
