//! The rewriter alone and the whole setpoint path, fed with the same setpoints.

use static_cell::ConstStaticCell;
use truepath_core::geometry::Point;
use truepath_core::image::{
    Binding, CorrectionLimits, FeedLaw, FineOffset, Image, ImageNode, ImageSettings, PathWindow, build,
};
use truepath_core::link::{
    AnswerFrame, DeviceSettings, MAX_ANSWER_BYTES, MAX_SETPOINT_BYTES, SetpointFrame, stuff, unstuff,
};
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Mode, Output, Rewriter, Setpoint, State};
use truepath_core::units::{Offset, Position, Real};
use truepath_fw::active::Loaded;
use truepath_fw::servo::Servo;

use crate::measure::{Series, count};

/// Most nodes of a contour here.
const MOST_NODES: usize = 10_000;
const IMAGE_BYTES: usize = 384 << 10;
const RECORDING_BYTES: usize = 64 << 10;
/// Spindle speed, 10⁻³ rev/min.
const SPINDLE: u32 = 1_500_000;

/// Everything a run needs.
pub struct Machine {
    rewriter: Rewriter<'static>,
    state: State,
    output: Output,
    stream: Servo<'static>,
    spi: Servo<'static>,
    axes: u8,
    frame: Frame,
    next: Setpoint,
    part: u32,
    now_us: u64,
}

/// Memory that is used anew by each machine; the one before has gone by then.
macro_rules! again {
    ($type:ty = $value:expr) => {{
        static CELL: ConstStaticCell<$type> = ConstStaticCell::new($value);
        static mut PLACE: Option<&'static mut $type> = None;
        // SAFETY: one thread, no interrupts; the machine that had it is not used any more.
        let place = unsafe { &mut *(&raw mut PLACE) };
        let taken: &'static mut $type = place.get_or_insert_with(|| CELL.take());
        taken
    }};
}

impl Machine {
    /// A contour of so many nodes 0.1 mm apart, at an angle to the axes, with a correction that changes all the time.
    pub fn new(axes: u8, nodes: usize) -> Self {
        let device = DeviceSettings { axes, ..DeviceSettings::at_1_khz() };
        let points = again!([ImageNode; MOST_NODES] = [BLANK; MOST_NODES]);
        let fine = FineOffset::from_bits;
        for (i, node) in points.iter_mut().enumerate() {
            let u = (i as i32 % 60) - 30;
            let bump = 20_000 * (900 - u * u);
            *node = ImageNode {
                point: Point::from_nm(i as i64 * 80_000, i as i64 * 60_000),
                chip: [fine(bump), fine(-bump)],
                edge: [fine(-5_000_000 + bump / 3), fine(1_000_000)],
            };
        }
        let points = points.get(..nodes).unwrap_or(&[]);
        let images = [
            again!([u8; IMAGE_BYTES] = [0; IMAGE_BYTES]),
            again!([u8; IMAGE_BYTES] = [0; IMAGE_BYTES]),
            again!([u8; IMAGE_BYTES] = [0; IMAGE_BYTES]),
        ];
        let recordings = [
            again!([u8; RECORDING_BYTES] = [0; RECORDING_BYTES]),
            again!([u8; RECORDING_BYTES] = [0; RECORDING_BYTES]),
        ];
        let [a, b, c] = images.map(|buffer| {
            let length = built(points, buffer);
            (buffer, length)
        });
        let image = Image::new_checked(a.0.get(..a.1).unwrap_or(&[])).expect("built here");
        let rewriter = Rewriter::new(device.rewriter, Some(image)).expect("settings of the library");
        let [d, e] = recordings;
        let [stream, spi] = [(b, d), (c, e)].map(|((buffer, length), recording)| {
            let bare = Rewriter::new(device.rewriter, None).expect("settings of the library");
            let mut servo = Servo::new(device, bare, Default::default(), recording);
            let loaded = Loaded::load(buffer, length, &device.rewriter).unwrap_or_else(|_| unreachable!("built here"));
            assert!(servo.give_image(loaded).is_none(), "in Off");
            servo
        });
        let mut frame = Frame::identity();
        (frame.cosine, frame.sine) = (858_993_459, 644_245_094);
        let frame = frame.sealed();
        let next = Setpoint { spindle_millirpm: SPINDLE, frame_crc: frame.crc, ..Setpoint::default() };
        let mut machine = Self {
            rewriter,
            state: State::default(),
            output: Output::NONE,
            stream,
            spi,
            axes,
            frame,
            next,
            part: 0,
            now_us: 0,
        };
        // The device wants to hear the controller before the drives are acknowledged, and to know its pace before it arms.
        for _ in 0..40 {
            machine.send(0, 0, 0, None);
        }
        machine.acknowledge();
        machine
    }

    fn acknowledge(&mut self) {
        self.rewriter.acknowledge_drives_disabled(&mut self.state).expect("in Off");
        for servo in [&mut self.stream, &mut self.spi] {
            servo.acknowledge(self.now_us).expect("in Off");
        }
        self.next.flags = Flags::DRIVES_ENABLED;
    }

    /// Arms the next part.
    pub fn arm(&mut self) {
        self.part += 1;
        let request = ArmRequest { binding: Binding::default(), part_serial: self.part, frame: self.frame };
        self.rewriter.arm(&mut self.state, &request).expect("in Bypass");
        for servo in [&mut self.stream, &mut self.spi] {
            servo.arm(&request).expect("in Bypass");
        }
    }

    /// The flags of the setpoints from here on, besides that of the drives.
    pub fn flags(&mut self, flags: Flags) {
        self.next.flags = Flags::DRIVES_ENABLED.with(flags);
    }

    /// State of the rewriter.
    pub fn mode(&self) -> Mode {
        self.state.mode()
    }

    /// One setpoint, along and beside the contour and above the pass, nm; measured into `series` if there is one.
    pub fn send(&mut self, along: i64, beside: i64, above: i64, series: Option<&mut Series>) {
        let [x, y, z] = self.frame.machine_nm((along * 4 - beside * 3) / 5, (along * 3 + beside * 4) / 5, above);
        self.next.axes = [x, y, z, along, beside, above];
        self.next.sequence = self.next.sequence.wrapping_add(1);
        self.now_us += 1_000;
        let (axes, now_us, setpoint) = (self.axes, self.now_us, self.next);

        let mut packet = [0; MAX_SETPOINT_BYTES + 2];
        let bytes = SetpointFrame { axes, setpoint }.encode_packet(&mut packet).expect("it has room");
        let packet = packet.get(..bytes).unwrap_or(&[]);
        let mut copy = [0; MAX_SETPOINT_BYTES + 2];
        let copy = copy.get_mut(..bytes - 1).unwrap_or_default();
        copy.copy_from_slice(packet.get(..bytes - 1).unwrap_or(&[]));
        let (unstuffed, raw) = count(|| unstuff(copy).map(<[u8]>::len));
        let raw_bytes = raw.unwrap_or(0);
        let raw = copy.get(1..=raw_bytes).unwrap_or(&[]);
        let (decoded, result) = count(|| SetpointFrame::decode(raw, axes));
        assert_eq!(result.map(|s| s.sequence), Ok(setpoint.sequence));

        let (rewriter, state) = (&self.rewriter, &mut self.state);
        let output = &mut self.output;
        let (ticked, ()) = count(|| rewriter.tick_into(state, &setpoint, output));
        let output = *output;

        let answer = AnswerFrame { axes, output };
        let mut place = [0; MAX_ANSWER_BYTES + 2];
        let (encoded, used) = count(|| answer.encode(place.get_mut(1..).unwrap_or_default()).unwrap_or(0));
        let (stuffed, _) = count(|| stuff(place.get_mut(..used + 2).unwrap_or_default()));

        let mut out = [0; MAX_ANSWER_BYTES + 2];
        let servo = &mut self.stream;
        let (exchanged, ()) = count(|| {
            servo.receive(packet, now_us, &now_us, &mut |bytes: &[u8]| {
                if let Some(place) = out.get_mut(..bytes.len()) {
                    place.copy_from_slice(bytes);
                }
            });
        });
        assert_eq!(out.get(..used + 2), place.get(..used + 2), "the setpoint path differs from its parts");
        let servo = &mut self.spi;
        let (on_spi, _) = count(|| servo.frame(raw, now_us, &now_us, &mut out));

        if let Some(series) = series {
            series.tick.add(ticked);
            series.decode.add(decoded);
            series.encode.add(encoded);
            series.unstuff.add(unstuffed);
            series.stuff.add(stuffed);
            series.exchange.add(exchanged);
            series.spi.add(on_spi);
        }
    }
}

const BLANK: ImageNode =
    ImageNode { point: Point::from_nm(0, 0), chip: [FineOffset::from_bits(0); 2], edge: [FineOffset::from_bits(0); 2] };

fn built(points: &[ImageNode], buffer: &mut [u8]) -> usize {
    let settings = ImageSettings {
        binding: Binding::default(),
        closed: false,
        feed: FeedLaw::new(
            FineOffset::from_bits(11_377_778),
            6,
            SPINDLE,
            Real::ratio(1, 4),
            Real::ratio(1, 4),
            Real::ratio(3, 2),
        ),
        limits: CorrectionLimits {
            clamp: Offset::from_um(500),
            warn: Offset::from_um(200),
            slew_nm_per_s: 20_000_000,
            acceleration_nm_per_s2: 1_000_000_000,
        },
        window: PathWindow {
            tolerance: Offset::from_um(200),
            z_low: Position::from_nm(0),
            z_high: Position::from_nm(0),
            gate_height: Offset::from_um(5_000),
        },
        node_step: Offset::from_um(100),
    };
    build(&settings, points, buffer).expect("a sound contour");
    truepath_core::image::image_bytes(points.len())
}
