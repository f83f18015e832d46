//! Expressions: what stands in brackets and behind `#`, computed in floating point.
//!
//! | file | what |
//! |---|---|
//! | `evaluator.rs` | reads and computes, with stacks of its own and no recursion |
//! | `operator.rs` | `** * / MOD + - EQ NE GT GE LT LE AND OR XOR` |
//! | `function.rs` | `ABS` … `TAN`, in degrees |
//! | `name.rs` | names of parameters |
//!
//! Rules and precedence are LinuxCNC's: `**` before `* / MOD` before `+ -` before comparisons before `AND OR XOR`, from
//! the left within a rank; a sign binds closer than any of them.

mod evaluator;
mod function;
mod name;
mod operator;

pub(super) use evaluator::{Evaluator, Fault, parameter_number};
pub(super) use name::name;
