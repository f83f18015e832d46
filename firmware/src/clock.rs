//! Time, as the device needs it.

/// A monotonic clock.
pub trait Clock {
    /// Microseconds since the reset.
    fn now_us(&self) -> u64;
    /// A counter for short times, wrapping; [`Board::counter_hz`](crate::config_service::Board::counter_hz) is its rate.
    fn count(&self) -> u32 {
        self.now_us() as u32
    }
}

/// A time that stands still: of a batch of the bench link, and of tests.
impl Clock for u64 {
    fn now_us(&self) -> u64 {
        *self
    }
}

/// A time that is asked for anew at each reading.
impl<F: Fn() -> u64> Clock for F {
    fn now_us(&self) -> u64 {
        self()
    }
}
