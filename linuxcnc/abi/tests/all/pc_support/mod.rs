//! A LinuxCNC with its configuration thread, around the functions of C: positions in, what goes to the drives out.

use crate::remote_support;

use crate::rewrite_support::*;
pub use remote_support::{ON, inputs, outputs};
use truepath_abi::pc::{Config, Inputs, LEDGER_BYTES, Limits, Outputs, Servo, Switches};
use truepath_abi::pc_abi::*;
use truepath_core::image::{Image, build, image_bytes};

pub const OFF: u32 = 0;
pub const BYPASS: u32 = 1;
pub const ARMED: u32 = 2;
pub const ACTIVE: u32 = 3;
pub const HOLD: u32 = 4;
pub const FAULT: u32 = 5;
/// X, Y, Z, and a second joint of Y.
pub const JOINTS: [u8; 6] = [0, 1, 2, 1, 255, 255];

pub fn limits() -> Limits {
    Limits {
        least: [-500.0; 6],
        greatest: [500.0; 6],
        velocity: [20.0; 6],
        acceleration: [1_000.0; 6],
        nm_per_unit: 1e6,
    }
}

/// The bytes of an image of the straight path.
pub fn image() -> Vec<u8> {
    let nodes = nodes(straight());
    let mut bytes = vec![0; image_bytes(nodes.len())];
    build(&settings(), &nodes, &mut bytes).unwrap();
    bytes
}

pub struct Pc {
    pub servo: &'static mut Servo,
    pub config: &'static mut Config,
    pub next: Inputs,
    pub last: Outputs,
    /// The ledger on the disk.
    pub disk: Vec<u8>,
    pub disk_fails: bool,
}

impl Pc {
    /// Loaded, with what the disk has.
    pub fn load(disk: &[u8]) -> Self {
        let block = Box::leak(Box::new(Block::new()));
        let mut sides = Sides { servo: std::ptr::null_mut(), config: std::ptr::null_mut() };
        // SAFETY: the block is leaked, so it lives as long as its sides; the ledger is a slice.
        let (servo, config) = unsafe {
            assert_eq!(truepath_pc_new(block, &JOINTS, disk.as_ptr(), disk.len(), &mut sides), 0);
            (&mut *sides.servo, &mut *sides.config)
        };
        let binding = settings().binding;
        let next = Inputs {
            spindle_rpm: 1500.0,
            tool: 3,
            tool_offset: 3,
            program_crc: binding.program_crc,
            feature: binding.feature,
            pass: binding.pass,
            setup: binding.setup,
            switches: Switches(ON & !Switches::DRIVES_ON.0 & !Switches::PROGRAM_RUNNING.0),
            ..inputs()
        };
        Self { servo, config, next, last: outputs(), disk: disk.to_vec(), disk_fails: false }
    }

    /// Homed, on, with an image, standing over the start of the path.
    pub fn ready(disk: &[u8]) -> Self {
        let mut pc = Self::load(disk);
        pc.to(0, 0, CLEAR);
        pc.period();
        assert_eq!(pc.offer(&image()), 0);
        pc.set(Switches::DRIVES_ON, true);
        pc.period();
        assert_eq!((pc.last.state, pc.last.image_ready), (BYPASS, 1));
        pc
    }

    /// Armed from a running program.
    pub fn armed() -> Self {
        let mut pc = Self::ready(&[]);
        pc.set(Switches::PROGRAM_RUNNING, true);
        pc.arm();
        assert_eq!((pc.last.state, pc.last.refusal), (ARMED, 0));
        pc
    }

    /// In the pass with the correction on.
    pub fn active() -> Self {
        let mut pc = Self::armed();
        for i in 0..=100 {
            pc.go(0, 0, GATE + (PASS - GATE) * i / 100);
        }
        for i in 1..500 {
            pc.go(i * FEED, 0, PASS);
        }
        assert_eq!(pc.last.state, ACTIVE);
        assert!(pc.last.correction_nm[0].abs() > 10_000);
        pc
    }

    pub fn set(&mut self, switch: Switches, on: bool) {
        let Switches(bits) = self.next.switches;
        self.next.switches = Switches(if on { bits | switch.0 } else { bits & !switch.0 });
    }

    /// The next setpoint, nm. The drives get it with a homing offset.
    pub fn to(&mut self, x: i64, y: i64, z: i64) {
        let [x, y, z] = [x, y, z].map(|nm| nm as f64 / 1e6);
        self.next.pos_cmd = [x, y, z, y, 0.0, 0.0];
        self.next.motor_pos_cmd = [x + 10.0, y - 20.0, z + 30.0, y + 0.125, 0.0, 0.0];
    }

    pub fn go(&mut self, x: i64, y: i64, z: i64) -> Outputs {
        self.to(x, y, z);
        self.period()
    }

    /// A servo period.
    pub fn period(&mut self) -> Outputs {
        truepath_pc_command(self.servo, &self.next, &mut self.last);
        self.last
    }

    pub fn periods(&mut self, count: usize) -> Outputs {
        for _ in 0..count {
            self.period();
        }
        self.last
    }

    /// A round of the configuration thread.
    pub fn round(&mut self) {
        let mut file = [0; LEDGER_BYTES];
        let used = truepath_pc_spend(self.config, &mut file);
        if used > 0 {
            if !self.disk_fails {
                self.disk = file[..used].to_vec();
            }
            truepath_pc_written(self.config, (!self.disk_fails).into());
        }
    }

    /// The pin arm goes up and down; gives the refusal.
    pub fn arm(&mut self) -> u32 {
        self.set(Switches::ARM, true);
        self.period();
        self.round();
        self.period();
        self.set(Switches::ARM, false);
        self.period();
        self.last.refusal
    }

    pub fn offer(&mut self, bytes: &[u8]) -> u32 {
        let bytes = bytes.to_vec().leak();
        // SAFETY: leaked, and nobody changes them.
        unsafe { truepath_pc_offer(self.config, &limits(), bytes.as_ptr(), bytes.len()) }
    }

    pub fn crc(bytes: &[u8]) -> u32 {
        Image::new_checked(bytes).unwrap().crc()
    }

    /// Runs until nothing is left of the correction; no period moves an axis by more than its limits.
    pub fn ramp(&mut self) {
        let mut before = self.last.correction_nm;
        let mut speed = [None; 2];
        for _ in 0..300 {
            let now = self.period().correction_nm;
            for axis in 0..2 {
                let velocity = now[axis] - before[axis];
                assert!(velocity.abs() <= 20_001, "{velocity} nm in a period");
                if let Some(last) = speed[axis].replace(velocity) {
                    assert!((velocity - last).abs() <= 1_002, "{} nm per period squared", velocity - last);
                }
            }
            before = now;
            if self.last.state == BYPASS {
                assert_eq!(now, [0; 3]);
                return;
            }
        }
        panic!("the correction is not out after 300 periods: {:?}", self.last);
    }
}

/// Whether what goes to the drives is what LinuxCNC commands, bit for bit.
pub fn untouched(inputs: &Inputs, outputs: &Outputs) -> bool {
    inputs.motor_pos_cmd.map(f64::to_bits) == outputs.motor_pos_cmd.map(f64::to_bits)
        && outputs.correction_nm == [0; 3]
        && outputs.correction == [0.0; 3]
}
