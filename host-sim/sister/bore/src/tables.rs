//! Tables of a bore (CSV): the profile with its exact crests, the roots of a ray, dependences, the wall over the depth.

use truepath_ground::diagnostics::Failure;

use super::envelope::Profile;

/// Points written of a profile, about.
const POINTS: usize = 20_000;

fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::Internal(format!("a table cannot be written: {error}"))
}

/// Rows of any kind under the names of their fields.
///
/// # Errors
/// Internal, when they cannot be written.
pub fn rows<T: serde::Serialize>(rows: &[T]) -> Result<Vec<u8>, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(failed)?;
    }
    writer.into_inner().map_err(failed)
}

#[derive(serde::Serialize)]
struct Point {
    phi_deg: f64,
    along_mm: f64,
    radius_mm: f64,
    deviation_mm: f64,
    tooth: usize,
    kind: &'static str,
}

/// `profile.csv`: angle along the travel, place along the wall, radius, deviation from the largest radius, the tooth that cut, and
/// whether the point is a `cusp` (where the lead changes: a crest of material), a `valley` (a tooth at its farthest) or between.
///
/// # Errors
/// Internal, when it cannot be written.
pub fn profile(profile: &Profile) -> Result<Vec<u8>, Failure> {
    let highest = profile.passes.highest();
    let between = (POINTS / profile.stretches.len()).clamp(2, 64);
    let mut points = Vec::new();
    for stretch in &profile.stretches {
        let pass = &profile.passes.passes[stretch.pass];
        let arc = profile.passes.arc(pass);
        let mut push = |phi: f64, kind| {
            let radius_mm = arc.wall(phi - stretch.crest).0;
            let turned = super::passes::around(phi);
            points.push(Point {
                phi_deg: turned.to_degrees(),
                along_mm: turned * highest,
                radius_mm,
                deviation_mm: radius_mm - highest,
                tooth: pass.tooth + 1,
                kind,
            });
        };
        push(stretch.from, "cusp");
        for n in 1..between {
            let phi = stretch.from + (stretch.to - stretch.from) * n as f64 / between as f64;
            push(phi, "between");
        }
        if stretch.from < stretch.crest && stretch.crest < stretch.to {
            push(stretch.crest, "valley");
        }
    }
    points.sort_by(|a, b| a.phi_deg.total_cmp(&b.phi_deg));
    rows(&points)
}

#[derive(serde::Serialize)]
struct Place {
    z_mm: f64,
    along_mm: f64,
    deviation_mm: f64,
}

/// `surface.csv`: the wall over height and place along it.
///
/// # Errors
/// Internal, when it cannot be written.
pub fn surface(patch: &super::picture::Patch) -> Result<Vec<u8>, Failure> {
    let heights = patch.z_mm.iter().zip(patch.deviation_mm);
    let places = heights.flat_map(|(z, row)| {
        patch.along_mm.iter().zip(row).map(|(along, d)| Place { z_mm: *z, along_mm: *along, deviation_mm: *d })
    });
    rows(&places.collect::<Vec<_>>())
}
