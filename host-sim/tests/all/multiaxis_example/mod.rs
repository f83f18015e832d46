//! Writes the programs of `examples/multiaxis`: a ball end mill over a surface whose section is a sine curve, as in the
//! paper, posted for a machine.
//!
//! The surface is z = a·sin(2πx/λ); the tool stands along its normal, leaned sideways so that the ball does not cut with
//! its still centre. Tip = contact + R(n − u).

use std::f64::consts::TAU;
use std::fmt::Write;

use truepath_multiaxis::Machine;

const AMPLITUDE: f64 = 4.0;
const WAVE: f64 = 40.0;
const BALL: f64 = 3.0;
const LEAN_DEG: f64 = 15.0;
const PASSES: i32 = 11;
const STEPS: i32 = 40;

/// Tip and tool axis at a contact point.
fn location(x: f64, y: f64) -> ([f64; 3], [f64; 3]) {
    let (height, slope) = (AMPLITUDE * (TAU * x / WAVE).sin(), AMPLITUDE * TAU / WAVE * (TAU * x / WAVE).cos());
    let length = slope.hypot(1.0);
    let normal = [-slope / length, 0.0, 1.0 / length];
    let (lean, upright) = LEAN_DEG.to_radians().sin_cos();
    let axis = [upright * normal[0], lean, upright * normal[2]];
    let contact = [x, y, height];
    (std::array::from_fn(|i| contact[i] + BALL * (normal[i] - axis[i])), axis)
}

/// The program for a machine, with F a length a minute, or with the time of every move (G93).
pub fn program(machine: &Machine, title: &str, inverse_time: bool) -> String {
    let letters = machine.rotary().map(|axis| axis.letter.name());
    let mut text = format!("%\n({title})\nG21 G90 G17 G40 G49 G94\nT1 M6\nG54 S12000 M3\nG43 H1\n");
    let mut near = [0.0, 0.0];
    let mut number = 10;
    for pass in 0..PASSES {
        let y = f64::from(2 * pass - PASSES + 1);
        let mut last = None;
        for step in 0..=STEPS {
            let along = f64::from(if pass % 2 == 0 { step } else { STEPS - step }) * 2.0 - 40.0;
            let (tip, axis) = location(along, y);
            near = machine.orient(axis, near).expect("an orientation the machine can take")[0];
            let joints = machine.inverse(tip, near);
            let ([x, y, z], [first, second]) = (joints.xyz, joints.rotary_deg());
            let place = format!("X{x:.3} Y{y:.3}");
            let turn = format!("{}{first:.3} {}{second:.3}", letters[0], letters[1]);
            match last.replace(tip) {
                None => {
                    writeln!(text, "N{number} G0 {place} {turn}\nG0 Z{:.3}\nG94 G1 Z{z:.3} F600", z + 20.0).unwrap();
                    text += if inverse_time { "G93\n" } else { "F1000\n" };
                }
                Some(before) => {
                    let length = (0..3).map(|i| (tip[i] - before[i]).powi(2)).sum::<f64>().sqrt();
                    let feed = if inverse_time { format!(" F{:.2}", 1000.0 / length) } else { String::new() };
                    writeln!(text, "N{number} G1 {place} Z{z:.3} {turn}{feed}").unwrap();
                }
            }
            number += 10;
        }
        text += "G0 Z80.\n";
    }
    text + "M5\nM30\n%\n"
}
