//! The inputs that fuzzing of a whole device begins with, in words. They lie in `fuzz/seeds/device` as bytes.
//! `BLESS=1 cargo test -p truepath-bench seeds` writes them after a wanted change.

/// Where an input begins: the order is that of the stand.
#[derive(Clone, Copy)]
pub enum Start {
    Ready,
    Closed,
    Limited,
    Updatable,
    Factory,
}

/// Flags of a setpoint.
const OFF: u8 = 0;
const ON: u8 = 1;
const HELD: u8 = 3;

/// The bytes of an input, step by step.
pub struct Script(pub Vec<u8>);

impl Script {
    /// With somebody at the device.
    pub fn at(start: Start) -> Self {
        Self(vec![(start as u8) << 1])
    }
    pub fn step(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }
    fn word(self, word: i16) -> Self {
        self.step(&word.to_le_bytes())
    }
    /// A request of a kind, with the bytes of its arguments.
    pub fn ask(self, kind: u8, arguments: &[u8]) -> Self {
        self.step(&[11, kind]).step(arguments)
    }
    /// To a place, µm from the start of the path, in so many ticks.
    fn go(self, x: i16, y: i8, z: i16, ticks: u8) -> Self {
        self.step(&[3]).word(x).step(&[y as u8]).word(z).step(&[ticks - 1])
    }
    pub fn stay(self, ticks: u8) -> Self {
        self.step(&[4, ticks - 1])
    }
    fn flags(self, flags: u8) -> Self {
        self.step(&[5, flags])
    }
    /// Time between setpoints, 0.1 ms, and from one to its answer, 16 µs.
    pub fn pace(self, gap: u8, delay: u8) -> Self {
        self.step(&[6, gap, delay])
    }
    fn skip(self, setpoints: i16) -> Self {
        self.step(&[7]).word(setpoints)
    }
    /// Milliseconds, at most 32.
    pub fn wait(self, ms: u8) -> Self {
        self.step(&[13]).word(i16::from(ms) * 1_000).step(&[0])
    }
    pub fn reset(self, cause: u8) -> Self {
        self.step(&[14, cause])
    }
    /// The power fails after so many operations of the flash.
    pub fn cut(self, moment: u8, after: u8) -> Self {
        let within: &[u8] = if moment == 1 { &[7, 0] } else { &[] };
        self.step(&[15, moment]).step(within).step(&[after])
    }
    /// Key, role.
    fn log_in(self, key: u8, role: u8) -> Self {
        self.step(&[17, key, role, 0])
    }
    /// An image in all its pieces; put in use from a slot, or not (2).
    fn upload(self, image: u8, slot: u8) -> Self {
        self.step(&[12, image, 0xFF, 0xFF, 0, 255, slot])
    }

    /// Out of `Off`, drives enabled, the pace known.
    pub fn awake(self) -> Self {
        self.pace(10, 0).flags(OFF).stay(40).ask(2, &[]).flags(ON).stay(40)
    }
    /// A part armed over the start, and down into the pass.
    fn armed(self, part: u8) -> Self {
        self.go(0, 0, 3_000, 1).ask(4, &[part, 0]).stay(2).go(0, 0, 0, 100)
    }
    /// So far along the path at its feed that a correction is on.
    fn milled(self, part: u8) -> Self {
        self.armed(part).go(1_500, 0, 0, 225)
    }
    /// Until the correction is out, whatever ended it.
    fn settled(self) -> Self {
        self.pace(10, 0).flags(ON).stay(250).stay(250)
    }
}

/// Name and bytes of each.
pub fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    use Start::{Closed, Factory, Limited, Ready, Updatable};
    let part = Script::at(Ready)
        .awake()
        .milled(1)
        .go(3_000, 0, 0, 225)
        .go(4_500, 0, 0, 225)
        .go(5_900, 0, 0, 210)
        .go(6_000, 0, 0, 20)
        .stay(250)
        .go(6_000, 0, 3_000, 100)
        .settled()
        .ask(4, &[1, 0])
        .armed(1)
        .stay(5)
        .reset(0)
        .awake()
        .ask(4, &[1, 0])
        .armed(1)
        .ask(5, &[]);
    let mut stops = Script::at(Ready).awake();
    for (part, flags) in [16 | ON, 8 | ON, 64 | ON, 32 | ON].into_iter().enumerate() {
        stops = stops.milled(part as u8).flags(flags).stay(20).settled();
    }
    let dropped = Script::at(Ready)
        .awake()
        .milled(1)
        .flags(OFF)
        .stay(20)
        .settled()
        .milled(2)
        .step(&[22, 1, 1, 0, 0, 0, 0, 0])
        .stay(5);
    let frames = Script::at(Ready)
        .awake()
        .step(&[22, 2])
        .milled(1)
        .settled()
        .ask(5, &[])
        .settled()
        .step(&[22, 7, 10, 0, 20, 0, 30, 0])
        .milled(2)
        .stay(5);
    let gaps = Script::at(Ready)
        .awake()
        .milled(1)
        .skip(2)
        .stay(5)
        .step(&[9, 9])
        .step(&[10, 9, 4])
        .stay(3)
        .skip(3)
        .stay(5)
        .settled()
        .milled(2)
        .skip(9)
        .stay(5)
        .skip(-3)
        .stay(2);
    let late =
        Script::at(Ready).awake().milled(1).pace(10, 40).stay(2).pace(10, 31).stay(3).pace(10, 200).stay(9).settled();
    let silent = Script::at(Ready).awake().wait(30).awake().milled(1).wait(30).stay(3);
    let disarmed = Script::at(Ready).awake().milled(1).ask(5, &[]).stay(20).step(&[16]).settled();
    let fast = Script::at(Ready)
        .awake()
        .pace(3, 0)
        .stay(200)
        .ask(4, &[1, 0])
        .pace(10, 0)
        .stay(80)
        .milled(2)
        .pace(3, 0)
        .stay(150);
    let places = Script::at(Ready)
        .awake()
        .milled(1)
        .go(1_500, 100, 0, 100)
        .stay(5)
        .settled()
        .milled(2)
        .go(200, 0, 0, 200)
        .settled()
        .milled(3)
        .go(1_500, 0, 1_500, 100)
        .settled()
        .milled(4)
        .go(1_500, 0, -1_500, 100)
        .settled()
        .milled(5)
        .go(4_500, 0, 0, 1)
        .stay(5);
    let held = Script::at(Ready)
        .awake()
        .milled(1)
        .flags(HELD)
        .stay(60)
        .flags(ON)
        .go(1_800, 0, 0, 45)
        .flags(HELD)
        .stay(30)
        .go(1_500, 0, 0, 100)
        .go(1_000, 0, 0, 100)
        .settled();
    let spindle = Script::at(Ready).awake().milled(1).step(&[8, 0, 0]).stay(250).stay(250).stay(250).stay(250);
    let refused = Script::at(Ready)
        .ask(2, &[])
        .flags(ON)
        .stay(40)
        .ask(2, &[])
        .awake()
        .ask(4, &[1, 1])
        .stay(2)
        .ask(4, &[2, 2])
        .ask(4, &[3, 3])
        .ask(4, &[4, 4])
        .ask(4, &[5, 5])
        .ask(3, &[6, 0])
        .stay(3)
        .milled(7)
        .flags(16 | ON)
        .stay(3)
        .ask(4, &[8, 0])
        .stay(5)
        .settled();
    let limited = Script::at(Limited).awake().milled(1).go(3_000, 0, 0, 225).settled();
    let closed = Script::at(Closed)
        .ask(2, &[])
        .ask(8, &[])
        .upload(0, 0)
        .log_in(1, 2)
        .log_in(1, 1)
        .ask(8, &[])
        .awake()
        .milled(1)
        .ask(5, &[])
        .settled()
        .log_in(0, 2)
        .upload(0, 1)
        .upload(3, 1)
        .upload(4, 1)
        .upload(2, 1)
        .upload(1, 0)
        .step(&[18, 1])
        .ask(10, &[])
        .step(&[18, 0])
        .ask(23, &[])
        .ask(10, &[])
        .step(&[17, 0, 2, 5])
        .reset(0)
        .ask(24, &[]);
    let settings = Script::at(Ready)
        .ask(9, &[2, 5])
        .ask(31, &[])
        .ask(9, &[1, 2])
        .reset(1)
        .ask(9, &[5, 4])
        .ask(9, &[9, 1])
        .stay(3)
        .ask(9, &[0, 0])
        .ask(9, &[6, 250])
        .reset(0)
        .awake()
        .milled(1);
    let factory = Script::at(Factory)
        .awake()
        .ask(4, &[1, 0])
        .wait(30)
        .ask(9, &[0, 0])
        .upload(0, 0)
        .upload(5, 2)
        .ask(7, &[1, 5])
        .ask(6, &[])
        .ask(7, &[0, 0])
        .awake()
        .milled(1)
        .ask(8, &[])
        .ask(5, &[])
        .settled()
        .ask(8, &[])
        .reset(0);
    let images = Script::at(Ready)
        .ask(7, &[1, 5])
        .ask(1, &[])
        .reset(0)
        .ask(8, &[])
        .reset(0)
        .upload(1, 1)
        .ask(18, &[0])
        .ask(7, &[0, 0]);
    let keys = Script::at(Ready)
        .ask(25, &[1, 1])
        .ask(30, &[0, 6])
        .ask(17, &[])
        .log_in(0, 2)
        .upload(1, 0)
        .ask(19, &[0])
        .ask(1, &[])
        .ask(20, &[0])
        .ask(18, &[2])
        .reset(0);
    let update = Script::at(Updatable)
        .log_in(0, 2)
        .step(&[19, 2, 255])
        .step(&[19, 0, 255])
        .ask(28, &[])
        .reset(1)
        .ask(27, &[])
        .log_in(0, 2)
        .ask(29, &[])
        .reset(0)
        .log_in(0, 2)
        .step(&[19, 1, 1])
        .step(&[19, 1, 255])
        .ask(28, &[])
        .ask(16, &[0])
        .reset(0)
        .ask(27, &[]);
    let power = Script::at(Ready)
        .cut(0, 0)
        .ask(9, &[2, 7])
        .reset(0)
        .cut(1, 3)
        .ask(9, &[2, 8])
        .reset(0)
        .cut(2, 30)
        .ask(9, &[2, 9])
        .reset(0)
        .cut(1, 20)
        .upload(0, 0)
        .reset(0)
        .upload(0, 0)
        .awake()
        .cut(2, 2)
        .ask(4, &[1, 0])
        .reset(0)
        .awake()
        .ask(4, &[1, 0])
        .milled(2);
    let mut every = Script::at(Ready);
    for kind in 0..33 {
        every = every.ask(kind, &[0, 0]);
    }
    let every = every
        .step(&[21, 0, 6])
        .step(b"G0 X1\n")
        .step(&[255, 21, 1, 2, 1, 1, 255, 21, 2, 2, 0, 0, 255])
        .ask(14, &[])
        .step(&[20])
        .ask(15, &[]);
    let noise = Script::at(Ready)
        .step(&[1, 9, 1, 2, 0, 3, 0, 5, 0, 0, 7])
        .step(&[0, 5, 9, 9, 9, 9, 9])
        .step(&[2, 0, 0, 0, 0, 0, 0, 1])
        .step(&[2, 1, 2, 3, 4, 5, 6, 255])
        .awake();
    [
        ("a-part", part),
        ("stops", stops),
        ("dropped", dropped),
        ("frames", frames),
        ("gaps", gaps),
        ("late", late),
        ("silent", silent),
        ("disarmed", disarmed),
        ("fast", fast),
        ("places", places),
        ("held", held),
        ("spindle", spindle),
        ("refused", refused),
        ("limited", limited),
        ("closed", closed),
        ("settings", settings),
        ("factory", factory),
        ("images", images),
        ("keys", keys),
        ("update", update),
        ("power", power),
        ("every-request", every),
        ("noise", noise),
    ]
    .into_iter()
    .map(|(name, script)| (name, script.0))
    .collect()
}

#[test]
fn the_seeds_of_the_fuzzing_are_these() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/device");
    for (name, bytes) in seeds() {
        let file = folder.join(format!("{name}.bin"));
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&file, &bytes).unwrap();
        }
        assert!(bytes.len() <= 2_000, "{name}: {} bytes", bytes.len());
        assert!(std::fs::read(&file).is_ok_and(|found| found == bytes), "{} is another one", file.display());
    }
    assert_eq!(
        std::fs::read_dir(&folder).unwrap().count(),
        seeds().len(),
        "a file in {} is none of them",
        folder.display()
    );
}
