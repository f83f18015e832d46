//! Doubles of the servo: the host's own, with one mistake each; and of a whole device, with the same mistakes and some more.
//!
//! Where it can be, the mistake is made before the servo: it is told of another image, another setting, another time, or
//! another setpoint than the one that came, and answers to that. Nothing of the servo itself is changed for it.

use truepath_bench::attack::{HostServo, Servo, Setup};
use truepath_bench::traffic::Command;
use truepath_bench::whole::{Whole, WholeDevice};
use truepath_core::checksum::crc32;
use truepath_core::image::{Binding, SignatureError};
use truepath_core::job::Workspace;
use truepath_core::link::{
    Ask, Denial, MAX_SETPOINT_BYTES, PACKET_BYTES, Reply, Request, ResetCause, Response, SetpointFrame, decode,
    decode_request, encode, stuff, unstuff,
};
use truepath_core::rewrite::{ArmRequest, Flags, Mode, Output, Reason, Refusal, Setpoint};
use truepath_fw::config_service::Restart;
use truepath_fw::flash::Cut;

/// The mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mistake {
    /// A frame whose checksum is wrong is given the right one.
    DamagedFrameFollowed,
    /// A repeated frame is answered again.
    RepeatedFrameAnswered,
    /// An answer is given however late it is.
    LateAnswerGiven,
    /// A position is a nanometre from setpoint and correction.
    SumOffByOne,
    /// A nanometre is on in `Bypass`.
    CorrectedInBypass,
    /// The drive enable stays in `Off`.
    EnabledInOff,
    /// The drives count as disabled whatever the setpoints say.
    AcknowledgedWithDrives,
    /// The timer does nothing.
    SilenceIgnored,
    /// What has ended is armed again by itself.
    ArmsItself,
    /// The numbers of the request are not compared.
    BindingIgnored,
    /// Arming does not ask for `Bypass`.
    ArmedInFault,
    /// The list of spent parts is not consulted.
    SpentListIgnored,
    /// The gate is not waited for.
    GateIgnored,
    /// The correction of X is on the axis of Z.
    OtherAxis,
    /// At its end the correction is a nanometre beyond the clamp.
    ClampOffByOne,
    /// A gap beyond the limit counts as none.
    GapFollowed,
    /// Setpoints that come too fast count as in time.
    PaceIgnored,
    /// Another image ends nothing.
    ImageChangeIgnored,
    /// The spindle counts as turning.
    SpindleIgnored,
    /// The ramp ends with its first tick.
    RampCutShort,
    /// The ramp stands still.
    RampStands,
    /// A disarming is confirmed, and nothing else.
    DisarmIgnored,
    /// What ends a correction for this reason is not seen: the servo is told that the machine stands, undisturbed.
    Deaf(Reason),
    /// The image of the servo has a tolerance wider by a fiftieth.
    WideTolerance,
    /// Three times the speed.
    TooFast,
    /// Eight times the acceleration.
    TooHard,
    /// No joint limits.
    NoJointLimits,
    /// Of a device: a request is carried out for whoever asks.
    RoleIgnored,
    /// Of a device: an image is said to be taken whoever signed it, or nobody.
    SignatureIgnored,
    /// Of a device: an older image is said to be in use.
    CounterIgnored,
    /// Of a device: settings are confirmed, and not kept.
    SettingsForgotten,
    /// Of a device: an image is confirmed, and taken out of use again.
    ActivationForgotten,
    /// Of a device: an answer has a damaged checksum.
    AnswerDamaged,
    /// Of a device: an answer has another number than its request.
    AnswerOfAnother,
    /// Of a device: it is in `Bypass` after a reset.
    AwakeAfterReset,
}

/// What a mistake is made with, seen from inside.
trait Inside: Servo {
    /// Setpoints that were accepted.
    fn accepted(&mut self) -> u64;
    /// Why a setpoint would end what is on, given that nothing has yet.
    fn would_end(&self, setpoint: &Setpoint, axes: u8, now_us: u64) -> Option<Reason>;
    /// Whether a disarming would be confirmed.
    fn would_disarm(&self, now_us: u64) -> Result<(), Refusal>;
    /// Numbers of the image in use.
    fn binding(&self) -> Option<Binding>;
}

impl Inside for HostServo<'_> {
    fn accepted(&mut self) -> u64 {
        self.endpoint().counters().accepted.into()
    }
    fn would_end(&self, setpoint: &Setpoint, axes: u8, now_us: u64) -> Option<Reason> {
        let mut trial = self.clone();
        if trial.endpoint().state().reason() != Reason::None {
            return None;
        }
        trial.receive(&packet(setpoint, axes), now_us, 0);
        Some(trial.endpoint().state().reason())
    }
    fn would_disarm(&self, now_us: u64) -> Result<(), Refusal> {
        self.clone().command(&Command::Disarm, now_us)
    }
    fn binding(&self) -> Option<Binding> {
        self.image().map(|image| image.settings().binding)
    }
}

/// There are no two of a device to try one of them: what a setpoint ends is read off its flags alone.
impl Inside for WholeDevice {
    fn accepted(&mut self) -> u64 {
        Self::accepted(self)
    }
    fn would_end(&self, setpoint: &Setpoint, _: u8, _: u64) -> Option<Reason> {
        if self.reason() != Reason::None || !matches!(self.mode(), Mode::Armed | Mode::Active | Mode::Hold) {
            return None;
        }
        let stops = [
            (Flags::EMERGENCY_STOP, Reason::EmergencyStop),
            (Flags::ABORT, Reason::Abort),
            (Flags::TOOL_CHANGE, Reason::ToolChange),
            (Flags::PROGRAM_END, Reason::ProgramEnd),
        ];
        let flag = stops.into_iter().find(|(flag, _)| setpoint.flags.has(*flag)).map(|(_, reason)| reason);
        flag.or((!setpoint.flags.has(Flags::DRIVES_ENABLED)).then_some(Reason::DrivesDisabled))
    }
    fn would_disarm(&self, _: u64) -> Result<(), Refusal> {
        match self.mode() {
            Mode::Armed | Mode::Active | Mode::Hold => Ok(()),
            mode => Err(Refusal::State(mode)),
        }
    }
    /// The mistake that needs it is made with the numbers of the set-up.
    fn binding(&self) -> Option<Binding> {
        None
    }
}

/// A servo with a mistake, for a set-up of the attack.
pub fn double<'a>(setup: &'a Setup, mistake: Mistake) -> Box<dyn Servo + 'a> {
    if matches!(mistake, Mistake::Deaf(_)) && setup.has_joint_limits() {
        // Told of another place, the servo could not hold this one at its joint limits: two mistakes in one.
        return Box::new(HostServo::new(setup));
    }
    // A set-up of its own lives until the tests end; there are some hundred, of 10 kB each.
    let own: &Setup = Box::leak(Box::new(mistaken(setup, mistake)));
    Box::new(Double::new(HostServo::new(own), setup, mistake))
}

/// A whole device with a mistake.
pub fn whole_double<'a>(device: WholeDevice, setup: &'a Setup, mistake: Mistake) -> Box<dyn Whole + 'a> {
    Box::new(Double::new(device, setup, mistake))
}

/// A set-up as the servo with a mistake has it.
pub fn mistaken(setup: &Setup, mistake: Mistake) -> Setup {
    match mistake {
        Mistake::WideTolerance => setup.with_image(|image| {
            let nm = image.window.tolerance.nm();
            image.window.tolerance = truepath_core::units::Offset::from_nm((nm + nm / 50).min(5_000_000));
        }),
        Mistake::TooFast => setup
            .with_image(|image| {
                image.limits.slew_nm_per_s = image.limits.slew_nm_per_s.saturating_mul(3).min(4_000_000_000);
            })
            .with_settings(|device| {
                let slew = &mut device.rewriter.correction_slew_nm_per_s;
                *slew = slew.saturating_mul(3);
            }),
        Mistake::TooHard => setup
            .with_image(|image| {
                let hard = image.limits.acceleration_nm_per_s2.saturating_mul(8);
                image.limits.acceleration_nm_per_s2 = hard.min(1_000_000_000_000);
            })
            .with_settings(|device| {
                let hard = &mut device.rewriter.correction_acceleration_nm_per_s2;
                *hard = hard.saturating_mul(8).min(1_000_000_000_000);
            }),
        Mistake::NoJointLimits => {
            setup.with_settings(|device| device.rewriter.joint_limits_nm = [(i64::MIN, i64::MAX); 6])
        }
        _ => setup.clone(),
    }
}

/// The servo with a mistake.
struct Double<S> {
    mistake: Mistake,
    servo: S,
    binding: Binding,
    max_lost: u32,
    axes: u8,
    tick_us: u64,
    max_step_nm: i64,
    clamp_nm: i32,
    spindle_millirpm: u32,
    /// Whether the last bytes ended without a delimiter.
    open: bool,
    /// Sequence that the servo was told last, and the one that came.
    told: Option<(u32, u32)>,
    last: Option<Setpoint>,
    /// The setpoint that came last.
    came: Option<Setpoint>,
    output: Option<Output>,
    request: Option<ArmRequest>,
    /// Time of the servo ahead of the true one, µs.
    ahead_us: u64,
    heard_us: u64,
    /// Mode that is shown instead of the servo's.
    shown: Option<Mode>,
    /// It shows `Bypass` in `Off`.
    awake: bool,
    /// Name of the image whose upload was begun last.
    begun: u32,
}

impl<S: Inside> Double<S> {
    fn new(servo: S, setup: &Setup, mistake: Mistake) -> Self {
        let [image, _] = setup.images();
        Self {
            mistake,
            servo,
            binding: image.settings().binding,
            max_lost: setup.settings().rewriter.max_lost_frames,
            axes: setup.settings().axes,
            tick_us: 1_000_000u64.div_ceil(setup.settings().rewriter.tick_hz.into()),
            max_step_nm: setup.settings().rewriter.max_step.nm(),
            clamp_nm: image.settings().limits.clamp.nm() as i32,
            spindle_millirpm: image.settings().feed.spindle_millirpm,
            open: false,
            told: None,
            last: None,
            came: None,
            output: None,
            request: None,
            ahead_us: 0,
            heard_us: 0,
            shown: None,
            awake: false,
            begun: 0,
        }
    }

    /// What is made of a command that the servo has answered.
    fn commanded(&mut self, command: &Command, mut done: Result<(), Refusal>, now_us: u64) -> Result<(), Refusal> {
        if let Command::Arm(request) = command {
            let mut request = *request;
            done = match (self.mistake, done) {
                (Mistake::SpentListIgnored, Err(Refusal::PartRepeated { .. })) => {
                    request.part_serial = request.part_serial.wrapping_add(1 << 24);
                    self.servo.command(&Command::Arm(request), now_us)
                }
                (Mistake::BindingIgnored, Err(Refusal::Identity { .. })) => {
                    request.binding = self.servo.binding().unwrap_or(self.binding);
                    self.servo.command(&Command::Arm(request), now_us)
                }
                (Mistake::ArmedInFault, Err(Refusal::State(Mode::Fault))) => Ok(()),
                (_, done) => done,
            };
            if done.is_ok() {
                self.request = Some(request);
            }
        }
        if done.is_ok() {
            self.shown = None;
        }
        done
    }

    /// What is done before the servo gets a setpoint.
    fn before(&mut self, setpoint: &mut Setpoint, now_us: u64) {
        match self.mistake {
            Mistake::AcknowledgedWithDrives if self.servo.mode() == Mode::Off => setpoint.flags = Flags::default(),
            Mistake::SpindleIgnored => {
                (setpoint.spindle_millirpm, setpoint.spindle_age_ticks) = (self.spindle_millirpm, 0);
            }
            Mistake::GapFollowed => {
                let most = self.max_lost;
                if let Some((told, came)) = self.told {
                    let ahead = setpoint.sequence.wrapping_sub(came);
                    let missing = ahead.wrapping_sub(1);
                    setpoint.sequence =
                        told.wrapping_add(if (1..1 << 31).contains(&ahead) && missing > most { 1 } else { ahead });
                }
            }
            Mistake::PaceIgnored => {
                let from_last = (now_us + self.ahead_us).saturating_sub(self.heard_us);
                self.ahead_us += self.tick_us.saturating_sub(from_last);
            }
            Mistake::Deaf(reason) => {
                if reason != Reason::Jump && self.jumps(setpoint) {
                    // It is deaf to this one reason only, and stood elsewhere: this must not look like a way back.
                    setpoint.axes = setpoint.axes.map(|nm| nm.saturating_add(1_000 * self.max_step_nm));
                }
                let ends = self.servo.would_end(setpoint, self.axes, now_us) == Some(reason);
                if let (true, Some(last)) = (ends, self.last) {
                    *setpoint = Setpoint { sequence: setpoint.sequence, ..last };
                }
            }
            _ => {}
        }
    }

    /// Whether a setpoint is farther from the one before than a feed move, in X or Y.
    fn jumps(&self, setpoint: &Setpoint) -> bool {
        let (Some(before), Some(request)) = (&self.came, &self.request) else { return false };
        let [x, y, _] = request.frame.axes.map(|map| usize::from(map.axis));
        [x, y].iter().any(|&axis| {
            let (from, to) = (before.axes[axis], setpoint.axes[axis]);
            from.abs_diff(to) > self.max_step_nm.unsigned_abs()
        })
    }

    /// What is done with the answer.
    fn after(&mut self, came: &Setpoint, output: &mut Output) {
        output.sequence = came.sequence;
        // It answers to what it was told, but for the correction.
        rebase(came, output);
        match self.mistake {
            Mistake::SumOffByOne if output.mode == Mode::Active => output.axes[1] += 1,
            Mistake::CorrectedInBypass if output.mode == Mode::Bypass => output.correction_nm[0] = 1,
            Mistake::GateIgnored if output.mode == Mode::Armed && came.flags.has(Flags::DRIVES_ENABLED) => {
                output.mode = Mode::Active;
            }
            Mistake::OtherAxis => {
                if let Some(request) = &self.request {
                    let [x, _, z] = request.frame.axes.map(|map| usize::from(map.axis));
                    output.correction_nm.swap(x, z);
                }
            }
            Mistake::ClampOffByOne => {
                for nm in &mut output.correction_nm {
                    *nm += if nm.abs() >= self.clamp_nm { nm.signum() } else { 0 };
                }
            }
            Mistake::RampCutShort if output.mode == Mode::Fault => {
                (output.mode, output.correction_nm) = (Mode::Bypass, [0; 6]);
            }
            Mistake::RampStands if output.mode == Mode::Bypass && is_on(self.output) => {
                // Its last nanometre never goes.
                output.mode = Mode::Fault;
            }
            _ => {}
        }
        if self.mistake != Mistake::SumOffByOne {
            rebase(came, output);
        }
        self.shown = Some(output.mode);
    }
}

fn is_on(output: Option<Output>) -> bool {
    output.is_some_and(|output| matches!(output.mode, Mode::Active | Mode::Hold | Mode::Fault))
}

fn rebase(came: &Setpoint, output: &mut Output) {
    for ((to, from), nm) in output.axes.iter_mut().zip(came.axes).zip(output.correction_nm) {
        *to = from.saturating_add(nm.into());
    }
}

fn packet(setpoint: &Setpoint, axes: u8) -> Vec<u8> {
    let mut packet = [0; MAX_SETPOINT_BYTES + 2];
    let used = SetpointFrame { axes, setpoint: *setpoint }.encode_packet(&mut packet).unwrap();
    packet[..used].to_vec()
}

/// A whole packet with the checksum that its content should have.
fn mended(bytes: &[u8], axes: u8) -> Option<Vec<u8>> {
    let mut copy = bytes.strip_suffix(&[0])?.to_vec();
    let mut raw = unstuff(&mut copy)?.to_vec();
    let end = raw.len().checked_sub(4)?;
    let crc = crc32(&raw[..end]).to_le_bytes();
    raw[end..].copy_from_slice(&crc);
    SetpointFrame::decode(&raw, axes).ok()?;
    let mut packet = [&[0], raw.as_slice(), &[0]].concat();
    stuff(&mut packet);
    Some(packet)
}

fn read(bytes: &[u8], axes: u8) -> Option<Setpoint> {
    let mut copy = bytes.strip_suffix(&[0])?.to_vec();
    SetpointFrame::decode(unstuff(&mut copy)?, axes).ok()
}

impl<S: Inside> Servo for Double<S> {
    fn receive(&mut self, bytes: &[u8], now_us: u64, delay_us: u32) -> Option<Output> {
        let delay_us = if self.mistake == Mistake::LateAnswerGiven { 0 } else { delay_us };
        let was_open = std::mem::replace(&mut self.open, bytes.last() != Some(&0));
        if self.mistake == Mistake::DamagedFrameFollowed
            && !was_open
            && let Some(mended) = mended(bytes, self.axes)
        {
            return self.servo.receive(&mended, now_us, delay_us);
        }
        let Some(came) = read(bytes, self.axes).filter(|_| !was_open) else {
            return self.servo.receive(bytes, now_us + self.ahead_us, delay_us);
        };
        if self.mistake == Mistake::ArmsItself
            && self.servo.mode() == Mode::Bypass
            && let Some(request) = &mut self.request
        {
            request.part_serial = request.part_serial.wrapping_add(1 << 20);
            let again = Command::Arm(*request);
            let _ = self.servo.command(&again, now_us);
        }
        let mut told = came;
        self.before(&mut told, now_us);
        self.came = Some(came);
        let at_us = now_us + self.ahead_us;
        let accepted = self.servo.accepted();
        let answer = self.servo.receive(&packet(&told, self.axes), at_us, delay_us);
        self.heard_us = at_us;
        if self.servo.accepted() != accepted {
            self.told = Some((told.sequence, came.sequence));
        }
        let Some(mut output) = answer else {
            let again = self.output.filter(|output| output.sequence == came.sequence);
            return again.filter(|_| self.mistake == Mistake::RepeatedFrameAnswered);
        };
        self.last = Some(told);
        self.after(&came, &mut output);
        self.output = Some(output);
        Some(output)
    }

    fn watch(&mut self, now_us: u64) {
        if self.mistake != Mistake::SilenceIgnored {
            self.servo.watch(now_us + self.ahead_us);
        }
        if self.servo.mode() == Mode::Off {
            self.shown = None;
        }
    }

    fn command(&mut self, command: &Command, now_us: u64) -> Result<(), Refusal> {
        let now_us = now_us + self.ahead_us;
        if self.mistake == Mistake::DisarmIgnored && *command == Command::Disarm {
            return self.servo.would_disarm(now_us);
        }
        if self.mistake == Mistake::RampStands && self.mode() == Mode::Fault {
            return Err(Refusal::State(Mode::Fault));
        }
        let done = self.servo.command(command, now_us);
        self.commanded(command, done, now_us)
    }
    fn reset(&mut self) {
        self.servo.reset();
        (self.open, self.told, self.last, self.came) = (false, None, None, None);
        (self.output, self.shown) = (None, None);
        self.request = None;
    }
    fn exchange_image(&mut self, to: Option<bool>) {
        if self.mistake != Mistake::ImageChangeIgnored {
            self.servo.exchange_image(to);
        }
    }
    fn mode(&self) -> Mode {
        match self.shown {
            Some(mode) if self.servo.mode() != Mode::Off => mode,
            _ if self.awake => Mode::Bypass,
            _ => self.servo.mode(),
        }
    }
    fn drive_enable(&self) -> bool {
        self.servo.drive_enable() || self.mistake == Mistake::EnabledInOff
    }
}

impl Double<WholeDevice> {
    /// What is made of a request and the device's answer to it.
    fn mend(&mut self, ask: &Ask<'_>, answer: &mut Result<Reply<'_>, Denial>, now_us: u64) {
        if let (Ask::Begin { crc, .. }, Ok(_)) = (ask, &*answer) {
            self.begun = *crc;
        }
        let taken = match &*answer {
            Err(Denial::Untrusted(SignatureError::RolledBack { .. })) => self.mistake == Mistake::CounterIgnored,
            Err(Denial::Untrusted(_)) => self.mistake == Mistake::SignatureIgnored,
            _ => false,
        };
        if taken && matches!(ask, Ask::Commit) {
            *answer = Ok(Reply::Committed { slot: 1, crc: self.begun });
        }
        match (self.mistake, ask, &*answer) {
            (Mistake::RoleIgnored, _, Err(Denial::Access(_))) => *answer = Ok(Reply::Done),
            (Mistake::ActivationForgotten, Ask::Activate { .. }, Ok(_)) => self.servo.exchange_image(None),
            _ => {}
        }
        let command = match *ask {
            Ask::AcknowledgeDrivesDisabled => Command::Acknowledge,
            Ask::Arm(request) => Command::Arm(request),
            Ask::Disarm => Command::Disarm,
            _ => return,
        };
        let done = match &*answer {
            Ok(_) => Ok(()),
            Err(Denial::Refused(refusal)) => Err(*refusal),
            Err(_) => return,
        };
        match self.commanded(&command, done, now_us) {
            Ok(()) => {
                *answer = Ok(Reply::Done);
                self.shown = None;
            }
            Err(refusal) => *answer = Err(Denial::Refused(refusal)),
        }
    }
}

impl Whole for Double<WholeDevice> {
    fn told(&mut self, bytes: &[u8], now_us: u64, answer: &mut Vec<u8>) -> usize {
        let at_us = now_us + self.ahead_us;
        let mut copy = bytes.strip_suffix(&[0]).unwrap_or(bytes).to_vec();
        let request = decode_request(&mut copy).ok();
        let withheld = match request.as_ref().map(|(request, _)| &request.ask) {
            Some(Ask::Configure(_)) if self.mistake == Mistake::SettingsForgotten => Some(Ok(())),
            Some(Ask::Disarm) if self.mistake == Mistake::DisarmIgnored => Some(self.servo.would_disarm(at_us)),
            _ => None,
        };
        let mut packet = [0; PACKET_BYTES];
        let Some((Request { id, ask }, _)) = request else { return self.servo.told(bytes, at_us, answer) };
        if let Some(done) = withheld {
            let done = done.map(|()| Reply::Done).map_err(Denial::Refused);
            let used = encode(&Response { id, answer: done }, &mut packet).unwrap();
            *answer = packet[..used - 1].to_vec();
            return 1;
        }
        let count = self.servo.told(bytes, at_us, answer);
        let mut given = answer.clone();
        let Ok(Response { id, answer: mut reply }) = decode::<Response<'_>>(&mut given) else { return count };
        self.mend(&ask, &mut reply, at_us);
        let id = if self.mistake == Mistake::AnswerOfAnother { id ^ 1 } else { id };
        let used = encode(&Response { id, answer: reply }, &mut packet).unwrap();
        *answer = packet[..used - 1].to_vec();
        if self.mistake == Mistake::AnswerDamaged
            && let Some(last) = answer.last_mut()
        {
            *last ^= 0x10;
        }
        count
    }
    fn take_restart(&mut self) -> Option<Restart> {
        self.servo.take_restart()
    }
    fn reset_for(&mut self, cause: ResetCause, now_us: u64) {
        self.servo.reset_for(cause, now_us + self.ahead_us);
        (self.open, self.told, self.last, self.came) = (false, None, None, None);
        (self.output, self.shown, self.request) = (None, None, None);
        self.awake = self.mistake == Mistake::AwakeAfterReset;
    }
    fn axes(&mut self) -> u8 {
        self.servo.axes()
    }
    fn cut(&mut self, cut: Cut) {
        self.servo.cut(cut);
    }
    fn compute(&mut self, workspace: &mut Workspace<'_>) {
        self.servo.compute(workspace);
    }
    fn into_device(self: Box<Self>) -> WholeDevice {
        self.servo
    }
}
