//! The comparison of a batch: bytes first, then the rules.

use std::hash::Hasher;

use truepath_core::link::{AnswerFrame, Denial, Reply, Response, decode, unstuff};
use truepath_core::rewrite::{Output, Refusal};

use super::board::{Event, Exchange};
use super::campaign::{Batch, Campaign};
use super::difference::Difference;
use super::judge::Happened;
use super::watch::TRAIL_EVERY;

impl<'a> Campaign<'a> {
    /// Compares what came back with what had to; judges every answer.
    pub(super) fn compare(&mut self, batch: &Batch<'a>, exchange: &Exchange) -> Result<(), Box<Difference>> {
        self.replies(batch, exchange)?;
        self.host.write(&batch.answers);
        self.board.write(&exchange.answers);
        let expected = packets(&batch.answers);
        let found = packets(&exchange.answers);
        let axes = self.plan.settings.axes;
        for index in 0..expected.len().max(found.len()) {
            let [want, got] = [expected.get(index), found.get(index)].map(|p| p.and_then(|p| answer(p, axes)));
            let ok = expected.get(index) == found.get(index);
            let Some(output) = got.filter(|_| ok) else {
                return Err(self.differs(batch, index, &want, &got, found.get(index)));
            };
            self.outcome.answers += 1;
            if self.outcome.answers.is_multiple_of(TRAIL_EVERY) {
                self.trail.push(output);
            }
            if let Err(violation) = self.judge.answer(&output, &mut self.log) {
                let mut difference = self.differs(batch, index, &want, &got, None);
                difference.what = violation.to_string();
                return Err(difference);
            }
        }
        Ok(())
    }

    fn replies(&self, batch: &Batch<'a>, exchange: &Exchange) -> Result<(), Box<Difference>> {
        let mut replies = packets(&exchange.replies).into_iter();
        for (id, command, expected) in &batch.replies {
            let mut packet = replies.next().map(<[u8]>::to_vec).unwrap_or_default();
            let said = decode::<Response<'_>>(&mut packet);
            let agrees = match (&said, expected) {
                (Ok(Response { id: i, answer: Ok(Reply::Done) }), Ok(())) => i == id,
                (Ok(Response { id: i, answer: Err(Denial::Refused(refusal)) }), Err(e)) => i == id && refusal == e,
                (Ok(Response { id: i, answer: Err(Denial::Mode(mode)) }), Err(Refusal::State(m))) => {
                    i == id && mode == m
                }
                _ => false,
            };
            if !agrees {
                let found = match said {
                    Ok(response) => format!("{:?}", response.answer),
                    Err(error) => format!("no answer ({error})"),
                };
                return Err(Box::new(Difference {
                    tick: self.outcome.answers,
                    what: format!("{command:?}: the host says {expected:?}, the board {found}"),
                    setpoint: None,
                    expected: None,
                    found: None,
                    host_state: format!("{:?}", self.expectation.state()),
                }));
            }
        }
        Ok(())
    }

    /// The host's state after an answer of a batch, by going through the batch once more.
    fn state_at(&self, batch: &Batch<'a>, index: usize) -> String {
        let mut model = batch.start.clone();
        let mut commands = batch.replies.iter();
        let mut answers = 0;
        for event in &batch.events {
            match event {
                Event::Time(us) => model.time(self.passed(*us)),
                Event::Setpoint { bytes, .. } => answers += model.bytes(bytes, &mut vec![]) as usize,
                Event::Request(_) => {
                    // The refusal was compared before.
                    let _ = commands.next().map(|(_, command, _)| model.command(command));
                }
            }
            if answers > index {
                break;
            }
        }
        format!("{:?}", model.state())
    }

    fn differs(
        &self,
        batch: &Batch<'a>,
        index: usize,
        want: &Option<Output>,
        got: &Option<Output>,
        bytes: Option<&&[u8]>,
    ) -> Box<Difference> {
        let what = match (want, got, bytes) {
            (Some(_), Some(_), _) => "the answers differ".to_owned(),
            (Some(_), None, None) => "the board gives no answer".to_owned(),
            (None, _, _) => "the board answers where the host does not".to_owned(),
            (Some(_), None, Some(bytes)) => format!("the board answers what is no frame: {bytes:02x?}"),
        };
        let sequence = want.or(*got).map(|o| o.sequence);
        let setpoint = self.log.iter().find_map(|h| match h {
            Happened::Delivered(s) if Some(s.sequence) == sequence => Some(*s),
            _ => None,
        });
        Box::new(Difference {
            tick: self.outcome.answers,
            what,
            setpoint,
            expected: *want,
            found: *got,
            host_state: self.state_at(batch, index),
        })
    }
}

/// The packets of a stream, without their delimiters.
fn packets(stream: &[u8]) -> Vec<&[u8]> {
    stream.split(|&b| b == 0).filter(|p| !p.is_empty()).collect()
}

/// The output in an answer packet.
fn answer(packet: &[u8], axes: u8) -> Option<Output> {
    let mut packet = packet.to_vec();
    AnswerFrame::decode(unstuff(&mut packet)?, axes).ok().map(|frame| frame.output)
}
