//! What a piece of work cost: time on the clock, and time of the processor in this program and all it started.

use std::time::{Duration, Instant};

/// Time on the clock and time of the processor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// On the clock.
    pub wall: Duration,
    /// User and system time, of children as well; zero where the system does not tell.
    pub processor: Duration,
}

/// A running measurement.
#[derive(Clone, Copy, Debug)]
pub struct Meter {
    started: Instant,
    processor: Duration,
}

impl Meter {
    /// Begins.
    pub fn start() -> Self {
        Self { started: Instant::now(), processor: processor() }
    }

    /// What was spent since the beginning. Of children those count that have ended.
    pub fn read(&self) -> Cost {
        Cost { wall: self.started.elapsed(), processor: processor().saturating_sub(self.processor) }
    }
}

#[cfg(unix)]
fn processor() -> Duration {
    use nix::sys::resource::{UsageWho, getrusage};
    use nix::sys::time::TimeValLike;
    let spent = |who| {
        let usage = getrusage(who).ok()?;
        let microseconds = (usage.user_time() + usage.system_time()).num_microseconds();
        Some(Duration::from_micros(u64::try_from(microseconds).ok()?))
    };
    [UsageWho::RUSAGE_SELF, UsageWho::RUSAGE_CHILDREN].into_iter().filter_map(spent).sum()
}

#[cfg(not(unix))]
fn processor() -> Duration {
    Duration::ZERO
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::repository::{program, succeeds};

    #[test]
    fn the_time_of_a_child_counts_and_waiting_does_not() {
        let meter = Meter::start();
        assert!(succeeds(program("sh").args(["-c", "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done"])));
        let busy = meter.read();
        assert!(busy.processor > Duration::from_millis(10), "{busy:?}");
        let meter = Meter::start();
        assert!(succeeds(program("sleep").arg("0.5")));
        // Other tests of this program run meanwhile: only the clock is certain.
        assert!(meter.read().wall >= Duration::from_millis(500));
    }
}
