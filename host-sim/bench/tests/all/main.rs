//! The attack on the servo, a whole device that is told anything, and doubles of both that break one rule each.

mod attack_mutants;
mod attack_random;
mod attack_settled;
mod doubles;
mod requirements;
mod whole;
mod whole_seeds;
