//! The records of the bench link: what a batch is made of in shared memory. See "Bench link" in `docs/link.md`.

use truepath_fw::bench::MOST_BYTES;

use super::board::Event;

pub use truepath_fw::bench::{Channel, Records};

/// Appends bytes as records of a channel.
pub fn write(channel: Channel, bytes: &[u8], out: &mut Vec<u8>) {
    for piece in bytes.chunks(MOST_BYTES) {
        let [low, high] = (piece.len() as u16).to_le_bytes();
        out.extend_from_slice(&[channel as u8, 0, low, high]);
        out.extend_from_slice(piece);
        out.resize(out.len().next_multiple_of(4), 0);
    }
}

/// Appends an event.
pub fn write_event(event: &Event, out: &mut Vec<u8>) {
    match event {
        Event::Time(us) => write(Channel::Time, &us.to_le_bytes(), out),
        Event::Setpoint { bytes, .. } => write(Channel::Setpoint, bytes, out),
        Event::Request(bytes) => write(Channel::Config, bytes, out),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_device_reads_the_records_as_they_were_written() {
        let mut bytes = vec![];
        let events = [
            Event::Time(1000),
            Event::Setpoint { bytes: vec![1, 2, 3, 0], answers: 1 },
            Event::Setpoint { bytes: vec![9; 5], answers: 0 },
            Event::Request(vec![7]),
        ];
        events.iter().for_each(|e| write_event(e, &mut bytes));
        let found: Vec<(Channel, Vec<u8>)> = Records::new(&bytes).map(|r| (r.channel, r.bytes.to_vec())).collect();
        let wanted = [
            (Channel::Time, vec![0xe8, 3, 0, 0]),
            (Channel::Setpoint, vec![1, 2, 3, 0]),
            (Channel::Setpoint, vec![9; 5]),
            (Channel::Config, vec![7]),
        ];
        assert_eq!(found, wanted);
        assert_eq!(bytes.len() % 4, 0);
    }
}
