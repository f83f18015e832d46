//! What makes the error at the worst place of a wall.
//!
//! The part of bending is found by cutting the same wall with a cutter that does not bend: what changes over the height is bending,
//! what is left over the height beside it the helix makes. What changes of the mean belongs to the mean, which a shift cures.

use truepath_ground::length::Unit;

/// The error at the worst place of a wall in its parts, mm, material left positive: the first three add up to it; the others are
/// standard deviations of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Causes {
    /// The mean over the height there: what a shift in x and y cures.
    pub mean_mm: f64,
    /// What the helix makes over the height: each height is cut at another instant, under another force.
    pub height_mm: f64,
    /// What bending makes over the height: the tip gives way farther than the top of the cut.
    pub bending_mm: f64,
    /// What noise and number of the points leave open of machine and material: one standard deviation.
    pub noise_mm: f64,
    /// What the model lacks, and what parts have shown beside it: one standard deviation.
    pub not_modelled_mm: f64,
}

impl Causes {
    /// Of the errors over the height of the worst place, with the cutter as it is and with one that does not bend, at the worst of its
    /// heights; without what is not known.
    pub fn of(column: &[f64], unbent: &[f64], worst: usize) -> Self {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let at = |values: &[f64]| values.get(worst).copied().unwrap_or_default();
        let (whole, stiff) = (mean(column), mean(unbent));
        let height_mm = at(unbent) - stiff;
        Self { mean_mm: whole, height_mm, bending_mm: at(column) - whole - height_mm, ..Self::default() }
    }

    /// The error that they make up.
    pub fn error_mm(&self) -> f64 {
        self.mean_mm + self.height_mm + self.bending_mm
    }

    /// The largest of them in words, of what is not known two standard deviations.
    pub fn largest(&self) -> &'static str {
        let parts = [
            (self.height_mm.abs(), "height (helix)"),
            (self.bending_mm.abs(), "bending of the cutter"),
            (self.mean_mm.abs(), "mean (what one pass can follow)"),
            (2.0 * self.noise_mm, "noise and number of the points"),
            (2.0 * self.not_modelled_mm, "what the model lacks"),
        ];
        parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or("", |part| part.1)
    }

    /// All of them in a line.
    pub fn words(&self, unit: Unit) -> String {
        format!(
            "{:+.4} {} = mean {:+.4}, helix {:+.4}, bending {:+.4}; sigma from noise {:.4}, not modelled {:.4}",
            unit.of(self.error_mm()),
            unit.name(),
            unit.of(self.mean_mm),
            unit.of(self.height_mm),
            unit.of(self.bending_mm),
            unit.of(self.noise_mm),
            unit.of(self.not_modelled_mm)
        )
    }
}

/// The error at the worst place of a wall that was cut, in its parts, mm, material left positive: the first two add up to it. What a
/// helix makes of the second and what bending, no measurement alone tells apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MeasuredCauses {
    /// The mean over the heights that were seen there: what a shift in x and y cures.
    pub mean_mm: f64,
    /// What helix and bending make beside it at the worst of these heights.
    pub height_mm: f64,
    /// What a reading leaves open: one standard deviation; 0 where a wall is known without readings.
    pub noise_mm: f64,
}

impl MeasuredCauses {
    /// Of the errors over the height of the worst place, at the worst of its heights.
    pub fn of(column: &[f64], worst: f64, noise_mm: f64) -> Self {
        let mean_mm = column.iter().sum::<f64>() / column.len().max(1) as f64;
        Self { mean_mm, height_mm: worst - mean_mm, noise_mm }
    }

    /// All of them in a line.
    pub fn words(&self, unit: Unit) -> String {
        let read = if self.noise_mm > 0.0 {
            format!("; sigma of a reading {:.4}", unit.of(self.noise_mm))
        } else {
            String::new()
        };
        format!(
            "{:+.4} {} = mean {:+.4}, over the height (helix and bending) {:+.4}{read}",
            unit.of(self.mean_mm + self.height_mm),
            unit.name(),
            unit.of(self.mean_mm),
            unit.of(self.height_mm),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bending_is_what_a_stiff_cutter_does_not_do_over_the_height() {
        // Helix: +2, −2, 0 um beside a mean of 10; bending adds 6, 3, 0.
        let unbent = [0.012, 0.008, 0.010];
        let bent = [0.018, 0.011, 0.010];
        let causes = Causes::of(&bent, &unbent, 0);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(causes.mean_mm, 0.013) && near(causes.height_mm, 0.002) && near(causes.bending_mm, 0.003));
        assert!(near(causes.error_mm(), 0.018), "{causes:?}");
        assert_eq!(causes.largest(), "mean (what one pass can follow)");
        assert_eq!(Causes { noise_mm: 0.007, ..causes }.largest(), "noise and number of the points");
    }

    #[test]
    fn a_measured_error_is_its_mean_and_what_the_height_adds() {
        let causes = MeasuredCauses::of(&[0.040, -0.020], 0.040, 0.002);
        assert!((causes.mean_mm - 0.010).abs() < 1e-12 && (causes.height_mm - 0.030).abs() < 1e-12, "{causes:?}");
        assert!(causes.words(Unit::Millimetre).ends_with(
            "+0.0400 mm = mean +0.0100, over the height (helix and bending) +0.0300; sigma of a reading 0.0020"
        ));
        assert!(!MeasuredCauses { noise_mm: 0.0, ..causes }.words(Unit::Millimetre).contains("sigma"));
    }
}
