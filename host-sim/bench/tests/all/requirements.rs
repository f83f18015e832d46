//! `docs/requirements.md`: every rule of the safety contract traced to the code that keeps it, the tests of it, the events
//! that it answers, and the mistake that the attack must notice. An orphan on any side fails.
//! `BLESS=1 cargo test -p truepath-bench requirements` writes the page after a wanted change.

use std::collections::BTreeSet;
use std::fs::read_to_string;

use truepath_bench::attack::Rule;

use crate::attack_mutants::EXPECTED;

// The events of docs/safety.md, as the tests of the core have them.
#[allow(dead_code)]
#[path = "../../../../core/wire/tests/all/safety/mod.rs"]
mod safety;

/// What keeps a rule and what shows it.
struct Trace {
    rule: Rule,
    /// File, and the line in it where the rule is kept.
    code: (&'static str, &'static str),
    /// File and name of a test beside those of the events.
    test: (&'static str, &'static str),
    /// Events of docs/safety.md that the rule answers.
    events: &'static [&'static str],
}

const WIRE: &str = "core/wire/src/";
const TESTS: &str = "core/wire/tests/all/";

const fn trace(
    rule: Rule,
    code: (&'static str, &'static str),
    test: (&'static str, &'static str),
    events: &'static [&'static str],
) -> Trace {
    Trace { rule, code, test, events }
}

const TRACES: &[Trace] = &[
    trace(
        Rule::Damaged,
        ("link/setpoint.rs", "pub fn decode("),
        ("link_endpoint", "a_damaged_frame_changes_nothing_and_is_not_answered_in_every_mode"),
        &["frame damaged (CRC, length, kind, version, axes)"],
    ),
    trace(
        Rule::Old,
        ("link/endpoint.rs", "fn judge("),
        ("link_endpoint", "a_repeated_frame_is_neither_followed_nor_answered_in_every_mode"),
        &[
            "frame repeated",
            "two frames exchanged",
            "old frames in a burst, up to 63 before the last one",
            "controller counts anew, by less than 64",
        ],
    ),
    trace(
        Rule::Late,
        ("link/endpoint/reply.rs", "fn in_time("),
        ("link_endpoint", "a_late_answer_is_withheld_and_counts_like_a_lost_frame_in_every_mode"),
        &["up to 2 deadlines missed in a row"],
    ),
    trace(
        Rule::Sum,
        ("rewrite/tick.rs", "fn carry("),
        ("link_chaos", "whatever_the_line_does_only_setpoints_that_were_sent_go_out_and_only_within_the_limits"),
        &[],
    ),
    trace(
        Rule::Plain,
        ("rewrite/tick.rs", "Mode::Bypass => {}"),
        ("rewrite_states", "bypass_and_armed_pass_any_setpoint_byte_for_byte"),
        &["program repeated without arming", "restart in the middle"],
    ),
    trace(
        Rule::Enable,
        ("link/endpoint/command.rs", "pub fn drive_enable("),
        ("rewrite_faults", "taking_the_image_away_in_the_cut_drops_the_drives_instead_of_jumping"),
        &["reset in any state, the watchdog's too", "image taken away while active"],
    ),
    trace(
        Rule::Acknowledge,
        ("rewrite/command.rs", "pub fn acknowledge_drives_disabled("),
        ("rewrite_states", "after_power_up_nothing_goes_out_until_the_drives_are_acknowledged_as_disabled"),
        &["reset in any state, the watchdog's too"],
    ),
    trace(
        Rule::Silence,
        ("link/endpoint.rs", "pub fn watch("),
        (
            "link_endpoint",
            "silence_drops_the_drives_in_every_mode_and_nothing_goes_out_until_they_are_acknowledged_as_disabled",
        ),
        &["silence"],
    ),
    trace(
        Rule::Unarmed,
        ("rewrite/command.rs", "pub fn arm("),
        ("rewrite_once", "the_program_repeated_without_a_new_arming_runs_uncorrected"),
        &["program repeated without arming"],
    ),
    trace(
        Rule::Arming,
        ("link/endpoint/command.rs", "fn armed("),
        ("rewrite_states", "every_difference_of_identity_is_refused_by_name"),
        &[
            "image for another program, feature, pass, tool, offset or setup",
            "frame onto an axis that is not sent",
            "wrong image: damaged, of another version, under another name",
            "upload cut off at any byte, power cut at any flash operation",
        ],
    ),
    trace(
        Rule::Spent,
        ("rewrite/spent.rs", "pub fn contains("),
        ("rewrite_once", "every_part_of_a_long_series_stays_spent"),
        &["spring pass"],
    ),
    trace(
        Rule::Begin,
        ("rewrite/follow.rs", "pub(super) fn enters("),
        ("rewrite_states", "the_gate_opens_only_over_the_start_at_gate_height_at_feed_speed_and_forwards"),
        &["restart in the middle"],
    ),
    trace(
        Rule::Axis,
        ("rewrite/frame.rs", "pub fn machine("),
        ("rewrite_states", "a_frame_with_offset_turn_and_exchanged_axes_corrects_the_right_axes"),
        &[],
    ),
    trace(
        Rule::Clamp,
        ("rewrite/limit.rs", "pub fn step("),
        ("rewrite_streams", "a_million_random_streams_never_leave_the_limits"),
        &[],
    ),
    trace(
        Rule::Speed,
        ("rewrite/limit.rs", "fn braking("),
        ("rewrite_caps", "a_correction_is_no_faster_than_the_machine_permits"),
        &[],
    ),
    trace(
        Rule::Acceleration,
        ("rewrite/limit.rs", "let velocity = wish.max("),
        ("rewrite_caps", "the_lower_of_cap_and_image_counts_for_each_of_the_two"),
        &[],
    ),
    trace(
        Rule::Joint,
        ("rewrite/tick.rs", "fn held_back("),
        ("rewrite_faults", "a_correction_that_would_pass_a_joint_limit_is_a_fault_and_the_output_stays_inside"),
        &["joint limit", "setpoint out of range, up to the ends of i64"],
    ),
    trace(
        Rule::Gap,
        ("link/endpoint.rs", "if self.unanswered > most {"),
        ("link_endpoint", "more_lost_frames_or_a_sequence_from_elsewhere_end_what_is_armed_or_active"),
        &[
            "up to 2 frames lost in a row",
            "more than 2 frames lost in a row",
            "sequence from elsewhere",
            "more than 2 deadlines missed in a row",
            "more than 2 answers in a row not fetched (SPI)",
        ],
    ),
    trace(
        Rule::Stopped,
        ("rewrite/tick.rs", "fn disturbance("),
        ("rewrite_faults", "an_emergency_stop_is_a_fault"),
        &[
            "emergency stop",
            "abort",
            "drives disabled",
            "tool changed while active",
            "frame changed while active",
            "end of the program (M2, M30)",
            "disarmed by command",
        ],
    ),
    trace(
        Rule::ImageChanged,
        ("rewrite/tick.rs", "Reason::ImageChanged;"),
        ("rewrite_faults", "a_changed_image_is_a_fault"),
        &["image changed while active", "image taken away while active"],
    ),
    trace(
        Rule::Pace,
        ("link/endpoint/pace.rs", "pub fn is_too_fast("),
        ("link_pace", "too_fast_a_pace_disarms_and_is_counted"),
        &[
            "setpoints faster than the settings by more than half",
            "arming before 33 setpoints have come at the pace of the settings",
        ],
    ),
    trace(
        Rule::Jump,
        ("rewrite/follow.rs", "fn is_jump("),
        ("rewrite_faults", "a_rapid_is_a_fault"),
        &["setpoint jumps by more than a feed move"],
    ),
    trace(
        Rule::OffPath,
        ("rewrite/follow.rs", "foot.distance_squared > plan.tolerance_squared"),
        ("rewrite_faults", "leaving_the_path_sideways_is_a_fault"),
        &["setpoint off the contour"],
    ),
    trace(
        Rule::Backwards,
        ("rewrite/follow.rs", "state.behind > plan.tolerance_nm"),
        ("rewrite_faults", "going_back_farther_than_the_tolerance_is_a_fault"),
        &["back along the contour at feed speed, beyond the tolerance of 0.2 mm"],
    ),
    trace(
        Rule::AbovePass,
        ("rewrite/follow.rs", "fn above("),
        ("rewrite_faults", "rising_in_the_middle_of_the_path_is_a_fault"),
        &["out of the pass, up"],
    ),
    trace(
        Rule::BelowPass,
        ("rewrite/follow.rs", "at.z < plan.z_bottom"),
        ("rewrite_faults", "going_below_the_pass_is_a_fault"),
        &["out of the pass, down"],
    ),
    trace(
        Rule::MovedInHold,
        ("rewrite/follow.rs", "fn holds("),
        ("rewrite_states", "a_hold_ends_by_disarm_or_fault_with_a_ramp_to_zero"),
        &["feed hold, once the axes stand", "standing without feed hold", "moved away in feed hold"],
    ),
    trace(
        Rule::Fade,
        ("rewrite/follow.rs", "fn live_spindle("),
        ("rewrite_fade", "a_dry_run_has_no_correction_from_its_first_tick"),
        &[
            "spindle stopped",
            "spindle speed not renewed",
            "no load on the spindle, when it is asked for",
            "no load on the spindle while the axes stand, or above the pass",
        ],
    ),
    trace(
        Rule::RampCut,
        ("rewrite/state.rs", "fn is_at_rest("),
        ("rewrite_states", "the_end_of_the_path_holds_the_correction_until_the_cutter_leaves"),
        &["end of the contour"],
    ),
    trace(
        Rule::RampLong,
        ("rewrite/limit.rs", "fn longest_ramp("),
        ("rewrite_streams", "long_streams_end_at_rest_in_bypass_after_a_stop"),
        &["end of the contour"],
    ),
];

fn file(path: &str) -> String {
    let path = format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"));
    read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

const PAGE: &str = "docs/requirements.md";
const HEAD: &str = "# Requirements of the safety contract

Made by `BLESS=1 cargo test -p truepath-bench requirements` from the table in `host-sim/bench/tests/all/requirements.rs`; a test
compares. A requirement without code, test or injected mistake fails it, and so do an event of [safety.md](safety.md), a rule
of the attack and a mistake that belong to no requirement.

`SR-nn` is the number that an alarm of `truepath hil --attack` names. Code lies below `core/wire/src`, tests below
`core/wire/tests/all`; the events have tests of their own, which [safety.md](safety.md) names. The last column is what a double of the
servo does wrong (`host-sim/bench/tests/all/doubles.rs`), upon which the attack must raise the alarm of this number.

";

fn page() -> String {
    let mut text = HEAD.to_owned();
    text.push_str("| number | requirement | kept in | test | events | injected mistake |\n|---|---|---|---|---|---|\n");
    for Trace { rule, code, test, events } in TRACES {
        let mistakes: Vec<String> =
            EXPECTED.iter().filter(|(_, of)| of == rule).map(|(mistake, _)| format!("`{mistake:?}`")).collect();
        let mut sentence = rule.sentence().to_owned();
        sentence[..1].make_ascii_uppercase();
        let events = if events.is_empty() { "all".to_owned() } else { events.join("<br>") };
        let cells = [
            format!("SR-{:02}", rule.number()),
            sentence,
            format!("{}: `{}`", code.0, code.1.trim_end_matches(['(', '{', ' '])),
            format!("{}: `{}`", test.0, test.1),
            events,
            mistakes.join("<br>"),
        ];
        text.push_str(&format!("| {} |\n", cells.join(" | ")));
    }
    text
}

#[test]
fn the_page_of_requirements_is_the_table_of_this_test() {
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(format!("{}/../../{PAGE}", env!("CARGO_MANIFEST_DIR")), page()).unwrap();
    }
    assert_eq!(file(PAGE), page());
}

#[test]
fn every_requirement_has_code_a_test_and_a_mistake_that_exist() {
    for Trace { rule, code, test, .. } in TRACES {
        assert!(file(&format!("{WIRE}{}", code.0)).contains(code.1), "{rule}: no {} in {}", code.1, code.0);
        let tests = file(&format!("{TESTS}{}.rs", test.0));
        assert!(tests.contains(&format!("#[test]\nfn {}()", test.1)), "{rule}: no test {} in {}", test.1, test.0);
        assert!(EXPECTED.iter().any(|(_, of)| of == rule), "{rule}: no mistake breaks it");
    }
}

#[test]
fn no_rule_and_no_event_is_without_a_requirement() {
    let traced: Vec<Rule> = TRACES.iter().map(|trace| trace.rule).collect();
    assert_eq!(traced, Rule::ALL);
    let named: BTreeSet<&str> = TRACES.iter().flat_map(|trace| trace.events).copied().collect();
    let events: BTreeSet<&str> = safety::rows().map(|row| row.event).collect();
    assert_eq!(named, events);
}

#[test]
fn every_requirement_meets_a_hazard_and_every_number_of_the_hazard_table_exists() {
    let hazards = file("docs/hazards.md");
    let named: BTreeSet<&str> =
        hazards.split("SR-").skip(1).map(|rest| rest.get(..2).expect("a number behind SR-")).collect();
    let numbers: Vec<String> = Rule::ALL.iter().map(|rule| format!("{:02}", rule.number())).collect();
    let known: BTreeSet<&str> = numbers.iter().map(String::as_str).collect();
    // Every requirement meets a hazard, and no hazard names one that there is not.
    assert_eq!(named, known);
}
