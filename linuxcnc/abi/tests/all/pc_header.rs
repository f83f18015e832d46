//! `truepath.h` says what the crate has: a C compiler tells sizes and places, the functions are compared by name.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::mem::{offset_of, size_of};
use std::process::Command;

use truepath_abi::pc::{Inputs, JOINTS, LEDGER_BYTES, Limits, Outputs, PROBING, Switches};
use truepath_abi::pc_abi::{Block, PC_WORDS, Sides};
use truepath_core::rewrite::Status;

const HEADER: &str = include_str!("../../truepath.h");
const SOURCE: &str = include_str!("../../src/pc_abi.rs");

/// What C has to print, and how.
struct Asked(Vec<(String, usize)>);

impl Asked {
    fn size(&mut self, name: &str, bytes: usize) {
        self.0.push((format!("sizeof(struct {name})"), bytes));
    }
    fn value(&mut self, name: &str, value: usize) {
        self.0.push((name.to_owned(), value));
    }
}

macro_rules! places {
    ($asked:ident, $c:literal, $of:ident: $($field:ident),*) => {
        $asked.size($c, size_of::<$of>());
        $($asked.value(concat!("offsetof(struct ", $c, ", ", stringify!($field), ")"), offset_of!($of, $field));)*
        // A field that the header has besides would not change a size within its padding.
        let named = BTreeSet::from([$(stringify!($field)),*]);
        assert_eq!(fields($c).iter().map(String::as_str).collect::<BTreeSet<_>>(), named);
    };
}

fn fields(name: &str) -> Vec<String> {
    let (_, behind) = HEADER.split_once(&format!("struct {name} {{")).unwrap();
    let (body, _) = behind.split_once('}').unwrap();
    let names = body.split(';').filter_map(|line| line.trim().rsplit([' ', '*']).next());
    names.map(|name| name.split('[').next().unwrap().to_owned()).filter(|name| !name.is_empty()).collect()
}

fn asked() -> Asked {
    let mut asked = Asked(vec![]);
    places!(asked, "truepath_inputs", Inputs: pos_cmd, motor_pos_cmd, offset, spindle_rpm, nm_per_unit, cosine, sine,
        motion_type, tool, tool_offset, program_crc, feature, pass, setup, part_serial, switches, period_ns);
    places!(asked, "truepath_outputs", Outputs: motor_pos_cmd, correction, correction_nm, state, reason, fault, status,
        refusal, forward, armed_serial, image_ready, image_crc, node, sequence, flags, feed_inhibit);
    places!(asked, "truepath_limits", Limits: least, greatest, velocity, acceleration, nm_per_unit);
    places!(asked, "truepath_sides", Sides: servo, config);
    asked.size("truepath_block", size_of::<Block>());
    asked.value("TRUEPATH_PC_WORDS", PC_WORDS);
    asked.value("TRUEPATH_JOINTS", JOINTS);
    asked.value("TRUEPATH_LEDGER_BYTES", LEDGER_BYTES);
    for (name, switch) in [
        ("DRIVES_ON", Switches::DRIVES_ON),
        ("ALL_HOMED", Switches::ALL_HOMED),
        ("EMERGENCY_STOP", Switches::EMERGENCY_STOP),
        ("FEED_HOLD", Switches::FEED_HOLD),
        ("PROGRAM_RUNNING", Switches::PROGRAM_RUNNING),
        ("TOOL_CHANGE", Switches::TOOL_CHANGE),
        ("SPINDLE_ON", Switches::SPINDLE_ON),
        ("SPINDLE_LOADED", Switches::SPINDLE_LOADED),
        ("TRIVIAL_KINEMATICS", Switches::TRIVIAL_KINEMATICS),
        ("ENABLE", Switches::ENABLE),
        ("ARM", Switches::ARM),
        ("DISARM", Switches::DISARM),
    ] {
        asked.value(&format!("TRUEPATH_{name}"), switch.0 as usize);
    }
    for (name, status) in [
        ("WARN", Status::WARN),
        ("SATURATED", Status::SATURATED),
        ("LAGGING", Status::LAGGING),
        ("FADED", Status::FADED),
        ("JOINT_LIMITED", Status::JOINT_LIMITED),
    ] {
        asked.value(&format!("TRUEPATH_{name}"), status.0.into());
    }
    asked
}

#[test]
fn a_c_compiler_finds_every_size_place_and_number_where_the_crate_has_it() {
    let Asked(asked) = asked();
    let mut program = String::from("#include <stdio.h>\n#include \"truepath.h\"\nint main(void) {\n");
    for (what, _) in &asked {
        writeln!(program, "    printf(\"%zu\\n\", (size_t)({what}));").unwrap();
    }
    program.push_str("    return 0;\n}\n");
    let folder = std::env::temp_dir().join(format!("truepath-header-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (source, made) = (folder.join("sizes.c"), folder.join("sizes"));
    std::fs::write(&source, program).unwrap();
    let mut cc = Command::new("cc");
    cc.args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-I", env!("CARGO_MANIFEST_DIR"), "-o"])
        .arg(&made)
        .arg(&source);
    let compiled = cc.output().unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let said = Command::new(&made).output().unwrap().stdout;
    std::fs::remove_dir_all(&folder).unwrap();
    let said: Vec<usize> = String::from_utf8(said).unwrap().lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(said.len(), asked.len());
    for ((what, expected), found) in asked.iter().zip(said) {
        assert_eq!(found, *expected, "{what}");
    }
    // The number that HAL's motion-type has for G38.
    assert_eq!(PROBING, 5);
}

#[test]
fn the_header_declares_every_function_and_no_other() {
    let names = |text: &str| -> BTreeSet<String> {
        let calls = text.split("truepath_pc_").skip(1).filter_map(|s| s.split_once('(')).map(|(name, _)| name);
        calls.filter(|name| name.chars().all(|c| c.is_lowercase() || c == '_')).map(str::to_owned).collect()
    };
    let defined: String = SOURCE.lines().filter(|line| line.contains("extern \"C\" fn")).collect();
    assert_eq!(names(HEADER), names(&defined));
    assert_eq!(names(HEADER).len(), 10);
}
