//! Chip thickness of a tooth, and the cutting force per unit depth it makes.
//!
//! Tangential `Ktc·h·(h/0.05)^(−m) + Kte`, radial likewise, resolved along n and t as the force on the tool (the general form of
//! P23 eq (1)). With runout a tooth cuts what the teeth before it have left.

use super::machine::Machine;

/// Chip thickness at which the chip coefficients are stated, mm.
const REFERENCE_CHIP_MM: f64 = 0.05;
/// Chip thickness of `tooth`, mm: the least that any of the teeth before it has left.
pub(super) fn chip_thickness(phi: f64, feed: f64, tooth: usize, runout: &[f64]) -> f64 {
    let advance = feed * phi.sin();
    if runout.is_empty() {
        return advance;
    }
    let n = runout.len();
    (1..=n)
        .map(|k| k as f64 * advance + runout[tooth] - runout[(tooth + n - k) % n])
        .fold(f64::INFINITY, f64::min)
        .max(0.0)
}

/// Force per unit depth: chip n, t and edge n, t.
pub(super) fn density(machine: &Machine, sense: f64, phi: f64, chip: f64) -> [f64; 4] {
    let (s, c) = phi.sin_cos();
    let resolve =
        |tangential: f64, radial: f64| [sense * tangential * s - radial * c, -sense * tangential * c - radial * s];
    let m = machine.size_exponent;
    let area = if chip > 0.0 { chip.powf(1.0 - m) * REFERENCE_CHIP_MM.powf(m) } else { 0.0 };
    let level = machine.force_factor;
    let [cn, ct] = resolve(level * machine.ktc_n_per_mm2 * area, level * machine.krc_n_per_mm2 * area);
    // At the very ends of the arc the chip is zero but the edge is in contact; only runout lifts a tooth off.
    let contact = if chip > 0.0 || machine.runout_mm.is_empty() { 1.0 } else { 0.0 };
    let [en, et] = resolve(level * machine.kte_n_per_mm * contact, level * machine.kre_n_per_mm * contact);
    [cn, ct, en, et]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runout_shifts_chip_between_teeth_and_leaves_their_sum() {
        // While every tooth still cuts, the chips of a revolution telescope to N·f·sin φ.
        let runout = [0.003, -0.002, 0.004, 0.0, -0.003, 0.001];
        let sum: f64 = (0..6).map(|j| chip_thickness(1.0, 0.0444, j, &runout)).sum();
        assert!((sum - 6.0 * 0.0444 * 1f64.sin()).abs() < 1e-12);
        assert!(chip_thickness(1.0, 0.0444, 2, &runout) > chip_thickness(1.0, 0.0444, 1, &runout));
        // A tooth that is much too short cuts nothing, and the next one takes its share.
        let short = [0.0, -0.2, 0.0];
        assert_eq!(chip_thickness(1.0, 0.0444, 1, &short), 0.0);
        let next = chip_thickness(1.0, 0.0444, 2, &short);
        assert!((next - 2.0 * 0.0444 * 1f64.sin()).abs() < 1e-12);
    }
}
