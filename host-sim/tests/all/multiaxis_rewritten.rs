//! What `truepath multiaxis` writes, read by an independent reader and sampled densely on independent kinematics.

use std::fmt::Write;

use crate::multiaxis_support::{Feed, HEADS, Machine, TABLE_HEAD, TABLES_BC, TRUNNION, feeds, matched};
use crate::workplace::truepath;
use tempfile::TempDir;

/// Rounding of what is written: four decimals of a millimetre, six of an inch.
const ROUNDING: f64 = 2e-6;

struct Rewritten {
    folder: TempDir,
    text: String,
    summary: serde_json::Value,
}

fn rewrite(machine: &Machine, program: &str, options: &[&str]) -> Rewritten {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.toml"), machine.toml()).unwrap();
    std::fs::write(folder.path().join("in.nc"), program).unwrap();
    let mut arguments =
        vec!["multiaxis", "in.nc", "--machine", "m.toml", "--tolerance", "0.005", "-o", "out.nc", "--json"];
    arguments.extend(options);
    let output = truepath(folder.path(), &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(folder.path().join("out.nc")).unwrap();
    let summary = serde_json::from_slice(&output.stdout).unwrap();
    Rewritten { folder, text, summary }
}

/// Every move of the rewritten program stays within the tolerance of the chord of the move it comes from. Moves of rotary
/// axes alone are left as they are where XYZ are joints.
fn judge(machine: &Machine, program: &str, rewritten: &str, tip: bool) -> (f64, f64) {
    let (original, written) = (feeds(program), feeds(rewritten));
    let (mut before, mut after) = (0.0f64, 0.0f64);
    for (wanted, pieces) in original.iter().zip(matched(&original, &written)) {
        if !tip && wanted.from[..3] == wanted.to[..3] {
            assert_eq!(pieces.len(), 1);
            continue;
        }
        let chord = (machine.end(&wanted.from, tip), machine.end(&wanted.to, tip));
        before = before.max(machine.error(wanted, chord, tip));
        for piece in pieces {
            let error = machine.error(piece, chord, tip);
            assert!(error <= 0.005 + ROUNDING, "line {}: {error} mm", piece.line);
            after = after.max(error);
        }
    }
    (before, after)
}

/// A random walk that does not repeat: 1, a, a², … modulo a prime.
struct Dice(u64);

impl Dice {
    fn within(&mut self, least: f64, greatest: f64) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        least + (greatest - least) * self.0 as f64 / 2_147_483_647.0
    }
}

/// Two hundred moves in the given modes; the words of a machine's two rotary letters.
fn program(machine: &Machine, seed: u64, inches: bool, incremental: bool, inverse: bool) -> String {
    let letters = machine.axes.map(|a| ["A", "B", "C"][a.0 - 3]);
    let scale = if inches { 25.4 } else { 1.0 };
    let decimals = if inches { 4 } else { 3 };
    let mut dice = Dice(seed);
    let mut text = format!("%\nG90 {} G94 F500\n", if inches { "G20" } else { "G21" });
    writeln!(text, "G0 X1. Y-1. Z2. {}5. {}-3.", letters[0], letters[1]).unwrap();
    writeln!(text, "{} {} G1", if incremental { "G91" } else { "G90" }, if inverse { "G93" } else { "" }).unwrap();
    let mut at = [scale, -scale, 2.0 * scale, 5.0, -3.0];
    for k in 0..200 {
        let by = [0, 1, 2, 3, 4].map(|i| if i < 3 { dice.within(-9.0, 9.0) } else { dice.within(-6.0, 6.0) });
        let to: [f64; 5] = std::array::from_fn(|i| (at[i] + by[i]).clamp(-70.0, 70.0));
        write!(text, "N{} ", 10 * (k + 1)).unwrap();
        for i in 0..5 {
            // Words are left out now and then, so that the rewriter must know where the axis stands.
            if dice.within(0.0, 1.0) < 0.25 {
                continue;
            }
            let unit = if i < 3 { scale } else { 1.0 };
            let power = 10f64.powi(decimals);
            let value = (if incremental { to[i] - at[i] } else { to[i] }) / unit;
            let value = (value * power).round() / power;
            let letter = if i < 3 { ["X", "Y", "Z"][i] } else { letters[i - 3] };
            write!(text, "{letter}{value:.*} ", decimals as usize).unwrap();
            at[i] = if incremental { at[i] + value * unit } else { value * unit };
        }
        writeln!(text, "F{}", if inverse { 120 + k } else { 400 }).unwrap();
    }
    text + "M30\n%\n"
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn no_sampled_place_of_a_rewritten_program_leaves_the_chord_of_its_original() {
    let machines = [TRUNNION, TABLES_BC, TABLE_HEAD, HEADS];
    for (k, machine) in machines.iter().enumerate() {
        for case in 0..8u64 {
            let [inches, incremental, inverse] = [1, 2, 4].map(|bit| case & bit != 0);
            let tip = (case + k as u64).is_multiple_of(2);
            let text = program(machine, 17 + 8 * k as u64 + case, inches, incremental, inverse);
            let xyz = if tip { "tip" } else { "joints" };
            let rewritten = rewrite(machine, &text, &["--xyz", xyz, "--partial"]);
            let left = rewritten.summary["left"]["count"].as_u64().unwrap();
            assert_eq!(left, 0, "machine {k} case {case}: {}", rewritten.summary["left"]);
            let (before, after) = judge(machine, &text, &rewritten.text, tip);
            assert!(before > 0.1 && after <= 0.005 + ROUNDING, "machine {k} case {case}: {before} {after}");
            let told = rewritten.summary["before"]["maximum_mm"].as_f64().unwrap();
            assert!((told - before).abs() < 0.01 * before, "machine {k} case {case}: told {told}, sampled {before}");
        }
    }
}

#[test]
fn the_pieces_of_a_move_take_its_time_under_inverse_time() {
    for rule in ["equal", "midpoint", "longest", "fewest"] {
        let text = program(&TRUNNION, 5, false, false, true);
        let rewritten = rewrite(&TRUNNION, &text, &["--rule", rule]);
        let moving = |f: &&Feed| f.from[..3] != f.to[..3];
        let (original, written) = (feeds(&text), feeds(&rewritten.text));
        let matched = matched(&original, &written);
        for (wanted, pieces) in original.iter().zip(matched).filter(|(w, _)| moving(w)) {
            let minutes: f64 = pieces.iter().map(|p| 1.0 / p.feed).sum();
            assert!((minutes * wanted.feed - 1.0).abs() < 1e-5, "{rule} line {}", wanted.line);
        }
    }
}

#[test]
fn increments_add_up_to_the_programmed_one_to_the_last_digit() {
    let text = program(&TABLE_HEAD, 99, true, true, false);
    let rewritten = rewrite(&TABLE_HEAD, &text, &[]);
    // Sums of exact decimals: whole numbers of 10⁻⁹.
    let sum = |text: &str, letter: char| {
        let mut sum = 0i128;
        for line in text.lines().filter(|l| l.contains(letter) && !l.starts_with("G0")) {
            let line = line.split('(').next().unwrap_or_default();
            for word in line.split_whitespace().filter(|w| w.starts_with(letter)) {
                let (whole, part) = word[1..].split_once('.').expect("a point");
                let digits = format!("{whole}{part:0<9}");
                sum += digits.parse::<i128>().expect("digits");
            }
        }
        sum
    };
    for letter in ['X', 'Y', 'Z', 'B', 'C'] {
        assert_eq!(sum(&text, letter), sum(&rewritten.text, letter), "{letter}");
    }
}

#[test]
fn a_rewritten_program_needs_no_rewriting() {
    for (machine, tip) in [(TRUNNION, false), (HEADS, true)] {
        let text = program(&machine, 3, false, false, true);
        let xyz = if tip { "tip" } else { "joints" };
        let rewritten = rewrite(&machine, &text, &["--xyz", xyz]);
        assert!(rewritten.summary["points_inserted"].as_u64().unwrap() > 100);
        let folder = rewritten.folder.path();
        let again =
            ["multiaxis", "out.nc", "--machine", "m.toml", "--tolerance", "0.005", "-o", "again.nc", "--xyz", xyz];
        assert!(truepath(folder, &again).status.success());
        assert_eq!(std::fs::read_to_string(folder.join("again.nc")).unwrap(), rewritten.text);
    }
}

#[test]
fn coarse_digits_of_the_control_still_keep_the_tolerance() {
    let text = program(&HEADS, 21, false, false, false);
    let rewritten = rewrite(&HEADS, &text, &["--decimals", "3", "--xyz", "tip"]);
    let (before, after) = judge(&HEADS, &text, &rewritten.text, true);
    assert!(before > 0.1 && after <= 0.005);
    let digits = |line: &str| line.split_whitespace().filter_map(|w| w.split_once('.')).map(|w| w.1.len()).max();
    assert!(rewritten.text.lines().filter_map(digits).all(|d| d <= 3), "no word has more than three decimals");
}
