//! The reference values of the chord error, to all their printed digits, and the kinematics they rest on.
//!
//! Each was computed independently of this code. A trunnion is `x = Rx(A) Rz(C) p`, right-handed, through the origin.

use truepath_multiaxis::machine::{Letter, Machine, Rotary, Sense, Side, Tool};
use truepath_multiaxis::{Joints, Rule, chord_error, divide};

fn table(first: Letter, second: Letter) -> Machine {
    let axis =
        |letter| Rotary { letter, side: Side::Table, point_mm: [0.0; 3], sense: Sense::RightHand, limits_deg: None };
    Machine::new([axis(first), axis(second)], Tool::default()).expect("a machine")
}

/// The joints at both ends of a move given by points of the part and rotary words in degrees.
fn ends(machine: &Machine, points: [[f64; 3]; 2], words: [[f64; 2]; 2]) -> [Joints; 2] {
    [0, 1].map(|i| machine.inverse(points[i], words[i].map(f64::to_radians)))
}

/// A turn of the C table by `degrees` while the tool runs along a chord.
fn turned(from: [f64; 2], to: [f64; 2], degrees: f64) -> (Machine, [Joints; 2]) {
    let machine = table(Letter::A, Letter::C);
    let points = [[from[0], from[1], 0.0], [to[0], to[1], 0.0]];
    let joints = ends(&machine, points, [[0.0, 0.0], [0.0, degrees]]);
    (machine, joints)
}

const POINTS: [[f64; 3]; 2] = [[60.0, 20.0, 30.0], [62.0, 23.0, 31.0]];
const ANGLES: [[f64; 2]; 2] = [[10.0, 20.0], [13.0, 26.0]];

#[test]
fn one_rotary_axis_gives_the_printed_errors() {
    for (from, to, degrees, printed) in [
        ([100.0, -1.0], [100.0, 1.0], 2.0, "0.032683"),
        ([100.0, -2.5], [100.0, 2.5], 5.0, "0.204226"),
        ([100.0, -2.5], [100.0, 2.5], -5.0, "0.013871"),
        ([0.0, -5.0], [0.0, 5.0], 5.0, "0.218097"),
    ] {
        let (machine, [from, to]) = turned(from, to, degrees);
        let error = chord_error(&machine, &from, &to);
        assert_eq!(format!("{:.6}", error.exact), printed, "{degrees} degrees");
    }
}

#[test]
fn the_trunnions_give_the_printed_errors_and_place() {
    let machine = table(Letter::A, Letter::C);
    let [from, to] = ends(&machine, POINTS, ANGLES);
    let error = chord_error(&machine, &from, &to);
    assert_eq!((format!("{:.6}", error.exact), format!("{:.4}", error.at)), ("0.188736".into(), "0.5033".into()));
    let machine = table(Letter::A, Letter::B);
    let [from, to] = ends(&machine, POINTS, ANGLES);
    let error = chord_error(&machine, &from, &to);
    assert_eq!(format!("{:.6}", error.exact), "0.125032");
}

#[test]
fn divisions_have_the_printed_numbers_of_pieces() {
    let machine = table(Letter::A, Letter::C);
    let [from, to] = ends(&machine, POINTS, ANGLES);
    for (tolerance, halved, equal) in [(0.05, 2, 2), (0.01, 8, 5), (0.005, 8, 7), (0.001, 16, 14)] {
        let pieces = |rule| divide(&machine, &from, &to, tolerance, rule).expect("a division").pieces();
        assert_eq!((pieces(Rule::Midpoint), pieces(Rule::Equal)), (halved, equal), "{tolerance} mm");
        assert!(pieces(Rule::Fewest) <= equal);
    }
}

/// The table of docs/multiaxis.md.
#[test]
fn longest_pieces_and_fewest_are_as_the_document_says() {
    let machine = table(Letter::A, Letter::C);
    let [from, to] = ends(&machine, POINTS, ANGLES);
    for (tolerance, printed) in [(0.05, 2), (0.01, 5), (0.005, 7), (0.001, 14)] {
        for rule in [Rule::Longest, Rule::Fewest] {
            let pieces = divide(&machine, &from, &to, tolerance, rule).expect("a division").pieces();
            assert_eq!(pieces, printed, "{rule:?} {tolerance}");
        }
    }
}

/// The other table: the closed form, and what the usual sagitta makes of the same moves.
#[test]
fn the_closed_form_is_near_where_the_usual_sagitta_is_not() {
    for (from, to, degrees, closed, usual) in [
        ([100.0, -1.0], [100.0, 1.0], 2.0, "0.032685", "0.015230"),
        ([100.0, -2.5], [100.0, 2.5], 5.0, "0.204306", "0.095178"),
        ([100.0, -2.5], [100.0, 2.5], -5.0, "0.013860", "0.095178"),
        ([0.0, -5.0], [0.0, 5.0], 5.0, "0.218166", "0.000000"),
    ] {
        let middle = f64::hypot((from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0);
        let sagitta = middle * (1.0 - (f64::to_radians(degrees) / 2.0).cos());
        let (machine, [start, end]) = turned(from, to, degrees);
        let error = chord_error(&machine, &start, &end);
        assert_eq!((format!("{:.6}", error.estimate), format!("{sagitta:.6}")), (closed.into(), usual.into()));
        assert!((error.estimate - error.exact).abs() < 1e-3 * error.exact, "{error:?}");
        // The formula of the plane: Δθ²ρ − 2Δθ·JΔp across the chord, which runs along y.
        let (turn, chord) = (f64::to_radians(degrees), to[1] - from[1]);
        let plane = (turn * turn * from[0] + 2.0 * turn * chord).abs() / 8.0;
        assert!((plane - error.estimate).abs() < 5e-3 * error.exact, "{plane} {error:?}");
    }
}
