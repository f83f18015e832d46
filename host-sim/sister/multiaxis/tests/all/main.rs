//! Five axes: the reference numbers, every type of machine, random moves.

mod ball;
mod extremes;
mod kinematics;
mod machine_file;
mod machines;
mod random;
mod random_moves;
mod reference;
mod singular;
