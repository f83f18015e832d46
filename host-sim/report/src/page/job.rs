//! The job of a pass, as the page tells it.

use truepath_core::geometry::Side;
use truepath_ground::length::Said;
use truepath_ground::units::{float, mm, rounded};
use truepath_job::pass::{Pass, milling_name};

use super::program::file_name;
use super::{Column, Cut, Fact, JobFacts, Outlines, Polyline, Stock, Tool};

/// Points of an outline at most; beyond that every n-th.
const MOST_OUTLINE: usize = 20_000;

/// What a page is about: the name of the part, else of the feature, else of the program.
pub fn subject(pass: &Pass) -> String {
    if let Some(name) = &pass.job.part.names.name {
        return name.clone();
    }
    pass.plan.as_ref().and_then(|plan| plan.id.clone()).unwrap_or_else(|| file_name(pass))
}

impl JobFacts {
    /// Of a pass.
    pub fn of(pass: &Pass) -> Self {
        let (setup, tool) = (&pass.core.setup, &pass.job.numbers.tool);
        let feeds = || pass.blocks.iter().map(|b| float(b.feed));
        let (least, most) = feeds().fold((f64::INFINITY, 0.0f64), |(l, m), f| (l.min(f), m.max(f)));
        let one_feed = least >= most;
        let mut facts = Vec::new();
        if !one_feed {
            facts.push(Fact::new(
                "feed",
                Said::of(|unit| {
                    let [least, most] = [least, most].map(|feed| unit.of(rounded(feed, 3)));
                    format!("{least} to {most} {}/min", unit.name())
                }),
            ));
        }
        facts.push(Fact::new(
            "contour",
            Said::of(|unit| format!("{:.3} {} long", unit.of(mm(pass.core.contour.length)), unit.name())),
        ));
        if let Some(probe) = &pass.job.numbers.probe {
            facts.push(Fact::new(
                "probe ball",
                Said::of(|unit| format!("⌀ {} {}", unit.of(mm(probe.ball_diameter)), unit.name())),
            ));
        }
        if pass.surface.is_some() {
            facts.push(Fact::new("stock", "measured surface; the allowance is its median"));
        }
        Self {
            wall: Some(match setup.wall {
                Side::Left => "left",
                Side::Right => "right",
            }),
            milling: Some(milling_name(setup.milling)),
            material: material(pass),
            tool: Some(Tool {
                number: pass.core.binding().ok().map(|binding| binding.tool),
                diameter_mm: 2.0 * mm(setup.radius),
                teeth: Some(setup.teeth),
                helix_deg: Some(rounded(float(setup.helix_deg), 6)),
                stickout_mm: tool.cantilever.map(|stickout| mm(stickout.length)),
            }),
            cut: Some(Cut {
                axial_depth_mm: Some(rounded(float(setup.axial_depth), 6)),
                feed_mm_per_min: one_feed.then_some(rounded(most, 3)),
                spindle_rpm: Some(rounded(float(setup.spindle_rpm), 3)),
            }),
            stock: Some(Stock { allowance_mm: Some(mm(setup.allowance)) }),
            facts,
        }
    }
}

/// The name of the material, where the job gives one.
fn material(pass: &Pass) -> Option<String> {
    const KEY: &str = "force.material";
    let job = &pass.job;
    job.gives(KEY).then(|| job.source().excerpt(job.span(KEY)).trim_matches(['"', '\'']).to_owned())
}

impl Outlines {
    /// The stock of a pass, where it is a measured surface; without one the page draws it from the allowance.
    pub fn of(pass: &Pass) -> Option<Self> {
        let points = pass.surface.as_ref()?.points();
        let every = points.len().div_ceil(MOST_OUTLINE).max(1);
        let column = |axis: usize| Column::of(points.iter().step_by(every).map(|p| p[axis]), 6);
        Some(Self { wall: Vec::new(), stock: vec![Polyline { x_mm: column(0), y_mm: column(1) }] })
    }
}
