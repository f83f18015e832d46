//! The live table as lines: one a look. (The view on a terminal is `monitor`.)

use std::io::Write;
use std::time::{Duration, Instant};

use truepath_bench::{BenchError, Client, Wire};
use truepath_core::link::{Ask, DeviceStatus, Reply, TraceSample};
use truepath_core::rewrite::Status;
use truepath_ground::diagnostics::Failure;

use crate::terminal::{Terminal, print};

/// Shows the device until `end`, or until standard output is closed.
pub(super) fn run<W: Wire>(
    client: &mut Client<W>,
    end: Option<Duration>,
    every: Duration,
    terminal: &Terminal,
) -> Result<(), Failure> {
    let start = Instant::now();
    if !terminal.json() {
        print(HEAD.as_bytes())?;
    }
    while end.is_none_or(|end| start.elapsed() < end) {
        let look = Instant::now();
        let status = client.status()?;
        let (dropped, sample) = newest(client)?;
        let time = start.elapsed().as_secs_f64();
        let text = if terminal.json() {
            let value = serde_json::json!({ "t_s": time, "status": status, "sample": sample, "dropped": dropped });
            format!("{value}\n")
        } else {
            line(time, &status, sample.as_ref())
        };
        let mut out = std::io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => return Ok(()),
            other => other.map_err(|e| Failure::Internal(e.to_string()))?,
        }
        std::thread::sleep(every.saturating_sub(look.elapsed()));
    }
    Ok(())
}

/// The newest sample of the live trace; the older ones are fetched with it and left.
fn newest<W: Wire>(client: &mut Client<W>) -> Result<(u32, Option<TraceSample>), BenchError> {
    let (mut lost, mut newest) = (0, None);
    // The queue of the device is shorter than so many replies.
    for _ in 0..8 {
        let reply = client.ask(Ask::Trace)?;
        let Reply::Trace { dropped, samples } = reply else {
            return Err(BenchError::Foreign(format!("{reply:?}")));
        };
        lost += dropped;
        newest = samples.last().copied().or(newest);
        if !samples.is_full() {
            break;
        }
    }
    Ok((lost, newest))
}

const HEAD: &str = "     t s  state    sequence      node   corr X nm   corr Y nm   feed  flags  accepted   damaged      lost  reason\n";

fn line(time: f64, status: &DeviceStatus, sample: Option<&TraceSample>) -> String {
    let counters = &status.counters;
    let blank = TraceSample::default();
    let s = sample.unwrap_or(&blank);
    let flags: String = [
        (Status::WARN, 'W'),
        (Status::SATURATED, 'S'),
        (Status::LAGGING, 'L'),
        (Status::FADED, 'F'),
        (Status::JOINT_LIMITED, 'J'),
    ]
    .map(|(bit, letter)| if s.status.has(bit) { letter } else { '-' })
    .iter()
    .collect();
    format!(
        "{time:>8.1}  {:<7}{:>10}{:>10}{:>12}{:>12}{:>6.0}%  {flags}{:>10}{:>10}{:>10}  {}\n",
        status.mode.to_string(),
        s.sequence,
        s.place.node,
        s.correction_nm[0],
        s.correction_nm[1],
        f64::from(s.feed_ratio) / 655.36,
        counters.accepted,
        counters.damaged,
        counters.lost,
        status.reason,
    )
}
