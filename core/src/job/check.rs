//! The ranges of a job. It may come over a wire: what is outside them is refused before anything is computed.

use super::{Correct, Cut, Force, Job, JobError, LARGEST_NUMBER, Machine, Part, Probe, Tool};
use crate::probe::{DecimalSign, Format, Frame, Separator};
use crate::units::{Offset, Real};

/// Refuses unless a condition holds; the sentence names quantity and range.
const fn require(holds: bool, sentence: &'static str) -> Result<(), JobError> {
    if holds { Ok(()) } else { Err(JobError::Range { sentence }) }
}

fn within<T: PartialOrd>(value: T, low: T, high: T) -> bool {
    low <= value && value <= high
}

const fn um(value: i64) -> Offset {
    Offset::from_um(value)
}

fn whole(value: Real, low: i32, high: i32) -> bool {
    within(value, Real::from_int(low), Real::from_int(high))
}

impl Job {
    /// Checks every range; they are those of the job file.
    ///
    /// # Errors
    /// [`JobError::Range`] at the first quantity outside its range.
    pub fn check(&self) -> Result<(), JobError> {
        self.tool.check()?;
        require(
            within(self.allowance, Offset::from_nm(1), um(100_000)) && self.allowance < self.tool.diameter,
            "the allowance is not above 0, up to 100 mm and below the cutter's diameter",
        )?;
        self.cut.check()?;
        if let Some(stickout) = self.tool.cantilever {
            require(
                within(stickout.length, self.cut.axial_depth, um(500_000)),
                "the cutter's free length is not between the axial depth and 500 mm",
            )?;
        }
        self.force.check()?;
        self.machine.check()?;
        self.probe.as_ref().map_or(Ok(()), Probe::check)?;
        self.correct.check(self.cut.axial_depth)?;
        self.part.as_ref().map_or(Ok(()), Part::check)
    }
}

impl Part {
    fn check(&self) -> Result<(), JobError> {
        require(
            within(self.feature, 1, LARGEST_NUMBER) && within(self.pass, 1, LARGEST_NUMBER),
            "the number of the feature or the pass is not 1 to 99,999",
        )?;
        require(self.run > 0 && self.blocks > 0, "the part of the program names no run or no block")?;
        require(
            self.alike.iter().all(|tip| within(*tip, um(-1_000_000), um(1_000_000))),
            "another pass that cuts alike is more than 1 m above or below",
        )
    }
}

impl Tool {
    fn check(&self) -> Result<(), JobError> {
        require(within(self.diameter, um(100), um(100_000)), "the cutter's diameter is not 0.1 to 100 mm")?;
        if let Some(measured) = self.measured_diameter {
            let tenth = self.diameter.nm() / 10;
            require(
                within(measured, um(100), um(110_000)) && (measured - self.diameter).abs().nm() <= tenth,
                "the measured diameter is not 0.1 to 110 mm and within 10 % of the nominal one",
            )?;
        }
        require(within(self.runout, Offset::ZERO, um(200)), "the runout is not 0 to 0.2 mm")?;
        require(whole(self.runout_deg, 0, 360), "the direction of the runout is not 0 to 360 degrees")?;
        require(within(self.teeth, 1, 12), "the number of teeth is not 1 to 12")?;
        require(whole(self.helix_deg, 0, 60), "the helix angle is not 0 to 60 degrees")?;
        let number = self.number.is_none_or(|n| within(n, 1, LARGEST_NUMBER));
        require(number, "the tool number is not 1 to 99,999")?;
        require(self.offset_number <= LARGEST_NUMBER, "the number of the tool offset is not 0 to 99,999")
    }
}

impl Cut {
    fn check(&self) -> Result<(), JobError> {
        require(
            within(self.axial_depth, Offset::from_nm(1), um(200_000)),
            "the axial depth is not above 0, up to 200 mm",
        )?;
        let rpm = self.spindle_rpm.is_none_or(|v| whole(v, 1, 200_000));
        require(rpm, "the spindle speed is not 1 to 200,000 rev/min")?;
        let feed = self.feed_mm_per_min.is_none_or(|v| within(v, Real::ratio(1, 10), Real::from_int(100_000)));
        require(feed, "the feed is not 0.1 to 100,000 mm/min")
    }
}

impl Force {
    fn check(&self) -> Result<(), JobError> {
        require(
            self.ktc > Real::ZERO && whole(self.ktc, 0, 20_000),
            "the tangential chip coefficient is not above 0, up to 20,000 N/mm²",
        )?;
        require(whole(self.krc, 0, 20_000), "the radial chip coefficient is not 0 to 20,000 N/mm²")?;
        require(whole(self.kte, 0, 500), "the tangential edge coefficient is not 0 to 500 N/mm")?;
        require(whole(self.kre, 0, 500), "the radial edge coefficient is not 0 to 500 N/mm")
    }
}

impl Machine {
    fn check(&self) -> Result<(), JobError> {
        require(
            whole(self.stiffness_x, 10, 1_000_000) && whole(self.stiffness_y, 10, 1_000_000),
            "a stiffness is not 10 to 1,000,000 N/mm",
        )
    }
}

impl Probe {
    fn check(&self) -> Result<(), JobError> {
        require(within(self.ball_diameter, um(100), um(50_000)), "the ball's diameter is not 0.1 to 50 mm")?;
        require(
            within(self.noise, Offset::from_nm(1), um(100)),
            "the noise of a reading is not above 0, up to 0.1 mm",
        )?;
        let far = um(10_000_000);
        let near = |offset: [Offset; 3]| offset.into_iter().all(|o| within(o, -far, far));
        require(self.work_offset.is_none_or(near), "the work offset is not within 10 m")?;
        let Some(layout) = self.layout else { return Ok(()) };
        require(self.format == Format::Columns, "a layout is given for a file that is not of columns")?;
        require(
            (layout.separator, layout.decimal) != (Separator::Comma, DecimalSign::Comma),
            "commas cannot both separate columns and stand before decimals",
        )?;
        require(layout.frame == Frame::Work || self.work_offset.is_some(), "machine coordinates need the work offset")
    }
}

impl Correct {
    fn check(&self, axial_depth: Offset) -> Result<(), JobError> {
        require(within(self.clamp, Offset::from_nm(1), um(4_000)), "the clamp is not above 0, up to 4 mm")?;
        let [low, high] = self.band;
        require(
            Offset::ZERO <= low && low < high && high <= axial_depth,
            "the band of heights does not rise within the axial depth",
        )?;
        let gouge = self.max_gouge.is_none_or(|v| within(v, Offset::ZERO, um(1_000)));
        require(gouge, "the largest gouge is not 0 to 1 mm")?;
        require(within(self.setup, 1, LARGEST_NUMBER), "the number of the setup is not 1 to 99,999")
    }
}
