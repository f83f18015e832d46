//! The attack on the servo, and doubles of the servo that break one rule each.

mod attack_mutants;
mod attack_random;
mod attack_settled;
mod doubles;
mod requirements;
