//! `truepath bore`: waviness of a bore milled by a circling cutter.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truepath_bore::motion::Cutter;
use truepath_bore::setup::{FeedAt, Setup};
use truepath_bore::texture::Cutoffs;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;

use super::{Terminal, bore_text, print};
use crate::command::bore::{Options, run as bore};

#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// Nominal radius of the hole: the path of the centre and the cutter's radius together.
    #[arg(long, value_name = "MM")]
    hole_radius: f64,
    /// Radius of the cutter.
    #[arg(long, value_name = "MM")]
    cutter_radius: f64,
    /// Teeth, equally pitched.
    #[arg(long, value_name = "N")]
    teeth: u32,
    /// Feed; may be left out when a waviness is wanted.
    #[arg(long, value_name = "MM_PER_MIN", required_unless_present = "wanted_waviness")]
    feed: Option<f64>,
    /// Whether the feed is that of the cutter's centre or of the wall.
    #[arg(long, value_enum, default_value_t = At::Centre)]
    feed_at: At,
    /// Spindle speed; a negative one turns against the travel.
    #[arg(long, value_name = "REV_PER_MIN")]
    rpm: f64,
    /// How the cutter turns against its travel round the hole; by default the sign of the speed decides.
    #[arg(long, value_enum)]
    direction: Option<Direction>,
    /// Turn the cutter the other way round.
    #[arg(long, conflicts_with = "direction")]
    reverse: bool,
    /// Helix angle.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    helix: f64,
    /// Look at the wall over this height as well.
    #[arg(long, value_name = "MM")]
    depth: Option<f64>,
    /// Offset of the cutter's axis from the spindle's.
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    runout: f64,
    /// Direction of the runout against tooth 1.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    runout_angle: f64,
    /// Angle of tooth 1 when the circle begins; 0 points straight at the wall.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    tooth_phase: f64,
    /// Laps of the cutter's centre; by default one and as much as it takes to leave no seam.
    #[arg(long, value_name = "N")]
    laps: Option<f64>,
    /// Cut-off wavelength λc between waviness and roughness.
    #[arg(long, value_name = "MM", default_value_t = Cutoffs::default().lambda_c_mm)]
    lambda_c: f64,
    /// Cut-off of roundness, undulations per revolution.
    #[arg(long, value_name = "UPR", default_value_t = Cutoffs::default().upr)]
    upr: f64,
    /// List every time at which a tooth is on the line of the ray --phi.
    #[arg(long, requires = "phi")]
    roots: bool,
    /// The ray, degrees along the travel from where the circle begins.
    #[arg(long, value_name = "DEG", requires = "roots")]
    phi: Option<f64>,
    /// Find the feed at which the height of the waviness is this.
    #[arg(long, value_name = "MM", conflicts_with = "laps")]
    wanted_waviness: Option<f64>,
    /// Folder for tables, pictures and the summary.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "output")]
    force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum At {
    Centre,
    Wall,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Direction {
    /// Against the travel (G3 inside a bore with M3).
    Climb,
    /// With the travel (G2 inside a bore with M3).
    Conventional,
}

impl Arguments {
    fn setup(&self) -> Setup {
        let rpm = match (self.direction, self.reverse) {
            (Some(Direction::Conventional), _) => self.rpm.abs(),
            (Some(Direction::Climb), _) => -self.rpm.abs(),
            (None, true) => -self.rpm,
            (None, false) => self.rpm,
        };
        let cutter = Cutter {
            radius_mm: self.cutter_radius,
            teeth: self.teeth,
            helix_deg: self.helix,
            runout_mm: self.runout,
            runout_deg: self.runout_angle,
            phase_deg: self.tooth_phase,
        };
        Setup {
            hole_mm: self.hole_radius,
            cutter,
            feed_mm_per_min: self.feed.unwrap_or(1.0),
            feed_at: if self.feed_at == At::Wall { FeedAt::Wall } else { FeedAt::Centre },
            rpm,
            laps: self.laps,
        }
    }
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let options = Options {
        setup: arguments.setup(),
        feed_given: arguments.feed.is_some(),
        depth_mm: arguments.depth,
        cutoffs: Cutoffs { lambda_c_mm: arguments.lambda_c, upr: arguments.upr },
        roots_at_deg: arguments.phi,
        wanted_mm: arguments.wanted_waviness,
        out: arguments.output.as_deref(),
        force: arguments.force,
    };
    let mut bar = terminal.progress("milling the bore", 100);
    let summary = bore(&options, &mut |share| bar.reached((share * 100.0) as u64))?;
    drop(bar);
    for warning in &summary.warnings {
        terminal.warn(warning);
    }
    print(&if terminal.json() { json(&summary)? } else { bore_text::words(&summary).into_bytes() })
}
