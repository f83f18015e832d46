//! An input on its way through a device: what each of its bytes does, and everything that comes of it told to those who judge.

use truepath_core::checksum::crc32;
use truepath_core::job::Workspace;
use truepath_core::link::{
    Ask, CHUNK_BYTES, DeviceSettings, Item, LinkError, MAX_SETPOINT_BYTES, PACKET_BYTES, Reply, Request, ResetCause,
    Response, SetpointFrame, decode, decode_request, encode, encode_request,
};
use truepath_core::rewrite::{AXES, AxisMap, Flags, Frame, Mode, Setpoint};
use truepath_fw::flash::{Cut, Moment};

use super::asks::{self, Known};
use super::broken::{Kept, Promise, keep};
use super::contract::Contract;
use super::device::Whole;
use super::tape::{Raw, Tape};
use super::things::Things;
use crate::attack::Checker;
use crate::example::EXAMPLE_PASS;
use crate::traffic::Command;

/// Longest content of a drawn request, bytes.
const CONTENT_BYTES: usize = 160;
/// Steps of the time from a setpoint to its answer, µs.
const DELAY_STEP_US: u32 = 16;

/// One input.
pub(super) struct Run<'r> {
    pub whole: Box<dyn Whole + 'r>,
    pub contract: Contract,
    things: &'r Things,
    workspace: &'r mut Workspace<'static>,
    /// None once something is in use that is not known here: what is on the axes then cannot be judged.
    checker: Option<Checker>,
    now_us: u64,
    id: u16,
    session: Option<u64>,
    /// Whether requests are those of the session.
    in_session: bool,
    /// What a message began with that has not ended.
    partial: Vec<u8>,
    /// What is uploaded.
    item: Item,
    /// The last packet, with what it was answered.
    packet: Vec<u8>,
    answer: Vec<u8>,
    /// Program coordinates of the tool, nm.
    at: [i64; 3],
    setpoint: Setpoint,
    frame: Frame,
    gap_us: u32,
    delay_us: u32,
    /// Byte of the next setpoint that is changed, and how.
    damage: Option<(u8, u8)>,
    /// The last setpoint as it was sent.
    line: Vec<u8>,
}

impl<'r> Run<'r> {
    pub fn new(
        whole: Box<dyn Whole + 'r>,
        checker: Checker,
        contract: Contract,
        things: &'r Things,
        workspace: &'r mut Workspace<'static>,
    ) -> Self {
        let frame = Frame::identity();
        Self {
            whole,
            contract,
            things,
            workspace,
            checker: Some(checker),
            now_us: 1_000,
            id: 0,
            session: None,
            in_session: true,
            partial: vec![],
            item: Item::Image,
            packet: vec![],
            answer: vec![],
            at: [0, 0, EXAMPLE_PASS + 3_000_000],
            setpoint: Setpoint { spindle_millirpm: 1_500_000, frame_crc: frame.crc, ..Setpoint::default() },
            frame,
            gap_us: 1_000,
            delay_us: 0,
            damage: None,
            line: vec![],
        }
    }

    /// What the next bytes of an input do.
    pub fn step(&mut self, tape: &mut Tape<'_>) -> Kept {
        match tape.byte() % 24 {
            0 => {
                let length = usize::from(tape.byte()) % CONTENT_BYTES;
                let mut packet = [0; PACKET_BYTES];
                let Ok(used) = encode(&Raw(tape.take(length)), &mut packet) else { return Ok(()) };
                self.told(&packet[..used])
            }
            1 => {
                let length = tape.byte().into();
                tape.take(length).split_inclusive(|&byte| byte == 0).try_for_each(|piece| self.told(piece))
            }
            2 => {
                self.at = [tape.around(), tape.around(), tape.around()].map(|um| um * 1_000);
                self.at[2] += EXAMPLE_PASS;
                self.setpoint.flags = Flags(tape.byte().into());
                self.send()
            }
            3 => self.go(tape),
            4 => (0..=tape.byte()).try_for_each(|_| self.send()),
            5 => {
                self.setpoint.flags = Flags(tape.byte().into());
                Ok(())
            }
            6 => {
                self.gap_us = 100 * u32::from(tape.byte());
                self.delay_us = DELAY_STEP_US * u32::from(tape.byte());
                Ok(())
            }
            7 => {
                self.setpoint.sequence = self.setpoint.sequence.wrapping_add_signed(tape.around() as i32);
                Ok(())
            }
            8 => {
                self.setpoint.spindle_millirpm = u32::from(tape.byte()) * 10_000;
                self.setpoint.spindle_age_ticks = tape.byte().into();
                Ok(())
            }
            9 => {
                let line = std::mem::take(&mut self.line);
                self.advance(self.gap_us)?;
                self.deliver(&line, false)?;
                self.line = line;
                Ok(())
            }
            10 => {
                self.damage = Some((tape.byte(), tape.byte()));
                Ok(())
            }
            11 => self.request(tape),
            12 => self.image(tape),
            13 => self.advance(u32::from(tape.word()) << (tape.byte() % 16)),
            14 => self
                .reset([ResetCause::PowerOn, ResetCause::Software, ResetCause::Watchdog][usize::from(tape.byte() % 3)]),
            15 => {
                let moment = match tape.byte() % 3 {
                    0 => Moment::Before,
                    1 => Moment::Within(tape.word().into()),
                    _ => Moment::After,
                };
                self.contract.shake();
                self.whole.cut(Cut { after_operations: tape.byte().into(), moment });
                Ok(())
            }
            16 => {
                let packet = [self.packet.as_slice(), &[0]].concat();
                self.told(&packet)
            }
            17 => self.log_in(tape),
            18 => {
                self.in_session = tape.byte() & 1 == 0;
                Ok(())
            }
            19 => {
                let things = self.things;
                let update = &things.updates[usize::from(tape.byte()) % things.updates.len()];
                self.upload(Item::Firmware, update, crc32(update), tape)
            }
            20 => {
                self.whole.compute(self.workspace);
                self.sync()
            }
            21 => {
                let item = [Item::Program, Item::Job, Item::Probe][usize::from(tape.byte() % 3)];
                let length = usize::from(tape.byte());
                let bytes = tape.take(length).to_vec();
                self.upload(item, &bytes, crc32(&bytes), tape)
            }
            22 => {
                self.frame = frame(tape);
                self.setpoint.frame_crc = self.frame.crc;
                Ok(())
            }
            _ => (0..40).try_for_each(|_| self.send()),
        }
    }

    /// To a place of the program, in so many ticks.
    fn go(&mut self, tape: &mut Tape<'_>) -> Kept {
        let to = [tape.around() * 1_000, i64::from(tape.byte() as i8) * 4_000, tape.around() * 1_000 + EXAMPLE_PASS];
        let (from, ticks) = (self.at, 1 + i64::from(tape.byte()));
        (1..=ticks).try_for_each(|tick| {
            for axis in 0..3 {
                self.at[axis] = from[axis] + (to[axis] - from[axis]) * tick / ticks;
            }
            self.send()
        })
    }

    /// The next setpoint: where the tool is, in the frame.
    fn send(&mut self) -> Kept {
        self.setpoint.sequence = self.setpoint.sequence.wrapping_add(1);
        self.setpoint.axes = [0; AXES];
        for (k, AxisMap { axis, reversed }) in self.frame.axes.into_iter().enumerate() {
            let nm = if reversed { -self.at[k] } else { self.at[k] };
            self.setpoint.axes[usize::from(axis)] = nm + self.frame.offset_nm[k];
        }
        let mut packet = [0; MAX_SETPOINT_BYTES + 2];
        let frame = SetpointFrame { axes: self.whole.axes(), setpoint: self.setpoint };
        let Ok(used) = frame.encode_packet(&mut packet) else { return Ok(()) };
        let packet = &mut packet[..used];
        if let Some(checker) = &mut self.checker {
            checker.sent(packet, &self.setpoint);
        }
        self.line.clear();
        self.line.extend_from_slice(packet);
        let damage = self.damage.take();
        if let Some((at, change)) = damage {
            packet[usize::from(at) % used] ^= change;
        }
        self.advance(self.gap_us)?;
        self.deliver(packet, damage.is_some())
    }

    fn deliver(&mut self, bytes: &[u8], touched: bool) -> Kept {
        for piece in bytes.split_inclusive(|&byte| byte == 0) {
            if let Some(checker) = &mut self.checker {
                checker.delivered(piece, self.now_us, touched);
            }
            let was = self.whole.mode();
            let answer = self.whole.receive(piece, self.now_us, self.delay_us);
            let is = self.whole.mode();
            keep(was != Mode::Off || is == Mode::Off, Promise::Message, || "a setpoint led out of Off".to_owned())?;
            keep(is != Mode::Armed || was == Mode::Armed, Promise::Message, || "a setpoint armed".to_owned())?;
            if let Some(checker) = &mut self.checker {
                checker.heard(answer.as_ref(), self.now_us + u64::from(self.delay_us))?;
            }
            self.look()?;
        }
        Ok(())
    }

    /// Time goes by, and the timer is called.
    fn advance(&mut self, us: u32) -> Kept {
        self.now_us += u64::from(us);
        let was = self.whole.mode();
        self.whole.watch(self.now_us);
        let is = self.whole.mode();
        if let Some(checker) = &mut self.checker {
            checker.watched(self.now_us, is)?;
        }
        let may = was == is || is == Mode::Off || was != Mode::Off && is == Mode::Bypass;
        keep(may, Promise::Message, || format!("time: {was} became {is}"))?;
        self.look()?;
        self.restart()
    }

    fn look(&mut self) -> Kept {
        let (mode, enable) = (self.whole.mode(), self.whole.drive_enable());
        match &mut self.checker {
            Some(checker) => Ok(checker.looked(mode, enable)?),
            None => keep(enable == (mode != Mode::Off), Promise::Off, || format!("in {mode} the enable is {enable}")),
        }
    }

    fn restart(&mut self) -> Kept {
        match self.whole.take_restart() {
            Some(restart) if restart.watchdog => self.reset(ResetCause::Watchdog),
            Some(_) => self.reset(ResetCause::Software),
            None => Ok(()),
        }
    }

    /// Switches off and on.
    fn reset(&mut self, cause: ResetCause) -> Kept {
        self.whole.reset_for(cause, self.now_us);
        self.contract.reset();
        self.partial.clear();
        self.packet.clear();
        self.session = None;
        if let Some(checker) = &mut self.checker {
            checker.reset();
        }
        let (mode, enable) = (self.whole.mode(), self.whole.drive_enable());
        keep(mode == Mode::Off && !enable, Promise::Off, || format!("after a reset it is in {mode}, enable {enable}"))?;
        self.look()?;
        let mut told = None;
        self.ask_then(Ask::Settings, |reply| {
            if let Reply::Settings(settings) = reply {
                told = Some(*settings);
            }
        })?;
        if let Some(settings) = told
            && self.contract.settled(&settings)
        {
            self.configured(&settings);
        }
        let told = told.as_ref();
        keep(told == Some(self.contract.settings()), Promise::Settings, || {
            format!("after a reset {told:?} and not {:?}", self.contract.settings())
        })?;
        self.ask(Ask::Update)?;
        self.sync()?;
        self.contract.steady();
        Ok(())
    }

    fn configured(&mut self, settings: &DeviceSettings) {
        let setup = self.things.setup.with_settings(|of| *of = *settings);
        if self.checker.as_mut().is_some_and(|checker| !checker.configured(&setup)) {
            self.checker = None;
        }
    }

    /// Asks which image is in use.
    fn sync(&mut self) -> Kept {
        let mut told = None;
        self.ask_then(Ask::Status, |reply| {
            if let Reply::Status(status) = reply {
                told = Some(status.active);
            }
        })?;
        let Some(found) = told else { return Ok(()) };
        self.contract.in_use(self.things, found)?;
        let known = found.map(|found| self.things.named(found.crc).map(|known| self.things.images[known].other));
        match (known, &mut self.checker) {
            (Some(None), checker) => *checker = None,
            (Some(Some(other)), Some(checker)) => checker.image_exchanged(Some(other)),
            (None, Some(checker)) => checker.image_exchanged(None),
            (_, None) => {}
        }
        Ok(())
    }

    /// Bytes with at most one delimiter, at their end, on the configuration link.
    fn told(&mut self, bytes: &[u8]) -> Kept {
        self.told_then(bytes, |_| ())
    }
    fn told_then(&mut self, bytes: &[u8], then: impl FnOnce(&Reply<'_>)) -> Kept {
        self.now_us += 1;
        self.partial.extend_from_slice(bytes);
        let was = self.whole.mode();
        let mut answer = vec![];
        let count = self.whole.told(bytes, self.now_us, &mut answer);
        let mut packet = match self.partial.pop_if(|last| *last == 0) {
            Some(_) => std::mem::take(&mut self.partial),
            None => vec![],
        };
        let again = self.packet == packet && self.answer == answer && count == 1;
        if !packet.is_empty() {
            self.packet.clone_from(&packet);
            self.answer.clone_from(&answer);
        }
        let fits = packet.len() < PACKET_BYTES;
        let request = decode_request(&mut packet);
        let expected = usize::from(fits && matches!(request, Ok(_) | Err(LinkError::Content { .. })));
        keep(count == expected, Promise::Answered, || format!("{count} answers to {request:?}"))?;
        if count == 0 {
            return keep(self.whole.mode() == was, Promise::Message, || "the mode changed by nothing".to_owned());
        }
        let read = decode::<Response<'_>>(&mut answer);
        let Ok(Response { id, answer }) = read else {
            return keep(false, Promise::Answered, || format!("an answer that cannot be read: {read:?}"));
        };
        let is = self.whole.mode();
        let (done, sync) = match &request {
            Ok((request, session)) => {
                keep(id == request.id, Promise::Answered, || format!("{id} answers {}", request.id))?;
                if !(again && holds(&request.ask, was)) {
                    self.contract.answered(self.things, &(*request, *session), &answer, self.now_us)?;
                    self.judge(&request.ask, answer.is_ok(), was)?;
                }
                if let (Ask::Begin { item, .. }, true) = (&request.ask, answer.is_ok()) {
                    self.item = *item;
                }
                (answer.is_ok(), answer.is_ok() && changes_image(&request.ask, self.item))
            }
            Err(_) => (false, false),
        };
        keep(done || is == was, Promise::Message, || format!("{was} became {is} by what was denied"))?;
        // What is on stays on while it goes out.
        let on = |mode| matches!(mode, Mode::Active | Mode::Hold);
        keep(on(was) || !on(is), Promise::Message, || format!("a message led from {was} to {is}"))?;
        if let Ok(reply) = &answer {
            then(reply);
        }
        self.look()?;
        if sync {
            self.sync()?;
        }
        self.restart()
    }

    /// What came of a request that concerns the setpoints.
    fn judge(&mut self, ask: &Ask<'_>, done: bool, was: Mode) -> Kept {
        if let (Ask::Configure(settings), true) = (ask, done) {
            let settings = *settings;
            self.configured(&settings);
        }
        let command = match *ask {
            Ask::AcknowledgeDrivesDisabled => Command::Acknowledge,
            Ask::Arm(request) => Command::Arm(request),
            Ask::Disarm => Command::Disarm,
            _ => {
                let is = self.whole.mode();
                let left = was == Mode::Off && is != Mode::Off || is == Mode::Armed && was != Mode::Armed;
                return keep(!left, Promise::Message, || format!("{ask:?}: {was} became {is}"));
            }
        };
        match &mut self.checker {
            Some(checker) => Ok(checker.commanded(&command, done, was, self.now_us)?),
            None => Ok(()),
        }
    }

    /// A request with the next id, of the session if there is one.
    pub fn ask(&mut self, ask: Ask<'_>) -> Kept {
        self.ask_then(ask, |_| ())
    }
    fn ask_then(&mut self, ask: Ask<'_>, then: impl FnOnce(&Reply<'_>)) -> Kept {
        self.id = self.id.wrapping_add(1);
        let mut packet = [0; PACKET_BYTES];
        let session = self.session.filter(|_| self.in_session);
        let Ok(used) = encode_request(&Request { id: self.id, ask }, session, &mut packet) else { return Ok(()) };
        self.told_then(&packet[..used], then)
    }

    fn request(&mut self, tape: &mut Tape<'_>) -> Kept {
        let known = Known { things: self.things, frame: self.frame, settings: *self.contract.settings() };
        let ask = asks::drawn(tape, &known);
        self.ask(ask)
    }

    /// An image, perhaps with a changed byte, in pieces; then it is put in use.
    fn image(&mut self, tape: &mut Tape<'_>) -> Kept {
        let things = self.things;
        let known = &things.images[usize::from(tape.byte()) % things.images.len()];
        let mut bytes = known.bytes.clone();
        let (at, change) = (usize::from(tape.word()), tape.byte());
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= change;
        }
        self.upload(Item::Image, &bytes, known.crc, tape)?;
        match tape.byte() {
            slot @ 0..=1 => self.ask(Ask::Activate { slot, crc: known.crc }),
            _ => Ok(()),
        }
    }

    /// An upload of so many pieces, or of all.
    fn upload(&mut self, item: Item, bytes: &[u8], crc: u32, tape: &mut Tape<'_>) -> Kept {
        let most = usize::from(tape.byte());
        let mut next = None;
        self.ask_then(Ask::Begin { item, length: bytes.len() as u32, crc }, |reply| next = offset(reply))?;
        for _ in 0..most {
            let Some(at) = next.filter(|&at| (at as usize) < bytes.len()) else { break };
            let piece = &bytes[at as usize..];
            let piece = &piece[..piece.len().min(CHUNK_BYTES)];
            next = None;
            self.ask_then(Ask::Chunk { offset: at, bytes: piece }, |reply| next = offset(reply))?;
        }
        if next == Some(bytes.len() as u32) { self.ask(Ask::Commit) } else { Ok(()) }
    }

    /// Challenge and answer, perhaps with a changed byte.
    fn log_in(&mut self, tape: &mut Tape<'_>) -> Kept {
        let mut nonce = None;
        self.ask_then(Ask::Challenge, |reply| {
            if let Reply::Challenge { nonce: told, .. } = reply {
                nonce = Some(*told);
            }
        })?;
        let Some(nonce) = nonce else { return Ok(()) };
        let ask = asks::login(tape, self.things, &nonce);
        let mut session = None;
        self.ask_then(ask, |reply| {
            if let Reply::LoggedIn { session: told } = reply {
                session = Some(*told);
            }
        })?;
        self.session = session.or(self.session);
        Ok(())
    }
}

const fn offset(reply: &Reply<'_>) -> Option<u32> {
    if let Reply::Next { offset } = reply { Some(*offset) } else { None }
}

/// Whether another image may be in use behind a request, or none.
const fn changes_image(ask: &Ask<'_>, item: Item) -> bool {
    let replaces = matches!((ask, item), (Ask::Chunk { .. }, Item::Firmware));
    replaces
        || matches!(
            ask,
            Ask::Commit
                | Ask::Activate { .. }
                | Ask::Deactivate
                | Ask::Configure(_)
                | Ask::Provision(_)
                | Ask::ProvisionAs { .. }
                | Ask::ProvisionFirmware { .. }
                | Ask::Revoke(_)
        )
}

/// Whether what was answered to the same bytes before is still so in a mode: else they are a request of their own.
const fn holds(ask: &Ask<'_>, mode: Mode) -> bool {
    match ask {
        Ask::AcknowledgeDrivesDisabled => matches!(mode, Mode::Bypass),
        Ask::Arm(_) => matches!(mode, Mode::Armed),
        _ => true,
    }
}

/// A frame: the program's own, shifted, with other axes, or mirrored.
fn frame(tape: &mut Tape<'_>) -> Frame {
    let mut frame = Frame::identity();
    let kind = tape.byte();
    if kind & 1 != 0 {
        frame.offset_nm = [tape.around(), tape.around(), tape.around()].map(|um| um * 1_000);
    }
    if kind & 2 != 0 {
        frame.axes.rotate_left(1);
    }
    if kind & 4 != 0 {
        frame.axes[0].reversed = true;
    }
    frame.sealed()
}
