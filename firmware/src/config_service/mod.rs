//! The configuration link: requests in, responses out.
//!
//! Who calls it: the task of the configuration link, below the setpoint path. A request may take long (an erase of the
//! flash takes seconds on a real part); the setpoint path goes on meanwhile, because the desk reaches it only through
//! the short closures of [`ServoAccess`].
//!
//! A request that changed something is answered again, not carried out again, when it comes once more with the same
//! `id` and the same content, as long as what it changed is still so: once an arming has ended or the drives were
//! dropped, the request is carried out again, which for the arming of a part means that it is refused. Requests that
//! only read, and those that were denied, are simply carried out again. A reset forgets this: what was on the way then
//! has to be asked for (`Status`, `List`, `Check`).

mod activate;
mod compute;
mod memory;
mod office;
mod operate;
mod tell;
mod upload;

use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use truepath_core::link::{
    Ask, CHUNK_BYTES, Deframer, Denial, Framed, LinkError, PACKET_BYTES, Request, Response, decode, encode,
};
use truepath_core::rewrite::Mode;

use crate::servo::ServoAccess;
use crate::shelf::Shelf;
use crate::work::Shelves;
pub use memory::{Board, IMAGE_BYTES, Memory};
use office::Office;

/// The device is to be reset, after what has been answered is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Restart {
    /// By letting the watchdog run out.
    pub watchdog: bool,
}

/// The desk.
pub struct Desk<'a, F: NorFlash> {
    office: Office<'a, F>,
    deframer: Deframer<{ PACKET_BYTES - 1 }>,
    answer: [u8; PACKET_BYTES],
    /// Bytes of `answer`, while it may have to be sent again.
    answered: Option<usize>,
    /// The packet it answers.
    asked: Vec<u8, PACKET_BYTES>,
}

impl<'a, F: NorFlash> Desk<'a, F> {
    fn new(office: Office<'a, F>) -> Self {
        Self { office, deframer: Deframer::new(), answer: [0; PACKET_BYTES], answered: None, asked: Vec::new() }
    }

    /// The flash.
    pub fn flash(&mut self) -> &mut F {
        &mut self.office.flash
    }
    /// Everything that was lent, at a reset; what the servo has of it is handed in. A computation that is under way
    /// elsewhere has its part of the memory and must be given back by [`Desk::finish`] before.
    pub fn into_parts(self, image: Option<&'a mut [u8]>, recording: &'a mut [u8]) -> (F, Memory<'a>, Board) {
        let Office { flash, board, shelves, image: at_desk, work, meter, .. } = self.office;
        let (shelves, at_desk) = match work {
            Some(work) => (Some(work.shelves), Some(work.image)),
            None => (shelves, at_desk),
        };
        let image = image.or(at_desk).unwrap_or_default();
        let [program, job, probe] = shelves.map_or_else(Default::default, |Shelves { program, job, probe }| {
            [program, job, probe].map(Shelf::into_buffer)
        });
        (flash, Memory { image, recording, program, job, probe, meter }, board)
    }

    /// Bytes of the stream; `send` gets the answer to each undamaged request. After a request to restart the rest of
    /// the bytes is left.
    pub fn receive(
        &mut self,
        mut bytes: &[u8],
        now_us: u64,
        servo: &impl ServoAccess<'a>,
        send: &mut impl FnMut(&[u8]),
    ) -> Option<Restart> {
        let Self { office, deframer, answer, answered, asked } = self;
        while let Some(framed) = deframer.feed(&mut bytes) {
            let Framed::Packet(packet) = framed else {
                servo.with(|servo| servo.count_message(true));
                continue;
            };
            let again = asked.as_slice() == &*packet;
            let mut copy: Vec<u8, PACKET_BYTES> = Vec::new();
            // It has room: the deframer takes no longer packet.
            let _ = copy.extend_from_slice(packet);
            let request = decode::<Request>(packet);
            let damaged = !matches!(request, Ok(_) | Err(LinkError::Content { .. }));
            servo.with(|servo| servo.count_message(damaged));
            if damaged {
                continue;
            }
            let still_so = |ask: &Ask<'_>| holds(ask, servo.with(|servo| servo.mode()));
            let remembered = answered.filter(|_| again && request.as_ref().is_ok_and(|r| still_so(&r.ask)));
            if let Some(bytes) = remembered {
                send(answer.get(..bytes).unwrap_or(&[]));
                continue;
            }
            *asked = copy;
            let mut scratch = [0; CHUNK_BYTES];
            let (response, keep, restart) = match request {
                Ok(Request { id, ask }) => {
                    let answer = office.carry_out(&ask, now_us, servo, &mut scratch);
                    let restart = match (&ask, &answer) {
                        (Ask::Restart { watchdog }, Ok(_)) => Some(Restart { watchdog: *watchdog }),
                        _ => None,
                    };
                    let keep = changes(&ask) && answer.is_ok();
                    (Response { id, answer }, keep, restart)
                }
                Err(LinkError::Content { id }) => (Response { id, answer: Err(Denial::Unknown) }, false, None),
                Err(_) => continue,
            };
            let used = encode(&response, answer).unwrap_or(0);
            *answered = keep.then_some(used);
            send(answer.get(..used).unwrap_or(&[]));
            if restart.is_some() {
                return restart;
            }
        }
        None
    }
}

/// Whether what the answer to a request said of the mode is still so. Only such an answer is given again: an arming
/// that an emergency stop has ended meanwhile must not be called done. Of the other requests nothing but a further
/// request, or a reset, undoes what was done.
const fn holds(ask: &Ask<'_>, mode: Mode) -> bool {
    match ask {
        Ask::AcknowledgeDrivesDisabled => matches!(mode, Mode::Bypass),
        Ask::Arm(_) => matches!(mode, Mode::Armed),
        _ => true,
    }
}

/// Whether carrying a request out twice is not the same as once.
const fn changes(ask: &Ask<'_>) -> bool {
    !matches!(
        ask,
        Ask::Hello | Ask::Status | Ask::Check(_) | Ask::List | Ask::Settings | Ask::Recording { .. } | Ask::Progress
    )
}
