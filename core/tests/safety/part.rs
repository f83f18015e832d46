//! Rows of the table: resets, parts and images.

use super::{DROPPED, OFF, PLAIN, Row, new};

pub const PART: &[Row] = &[
    new(
        "reset in any state, the watchdog's too",
        DROPPED,
        OFF,
        Some(1),
        Some(0),
        tests!("core/tests/safety_part" a_reset_in_any_state, "firmware/tests/wire_reset" after_a_reset_in_any_state_nothing_is_forwarded_until_the_drives_are_acknowledged_as_disabled,
        "firmware/tests/wire_reset" a_part_that_was_armed_when_the_watchdog_ran_out_is_spent),
    ),
    new(
        "program repeated without arming",
        PLAIN,
        "Bypass",
        None,
        None,
        tests!("core/tests/safety_part" a_program_repeated, "firmware/tests/wire_reset" a_program_repeated_without_a_new_arming_runs_uncorrected_also_after_a_reset),
    ),
    new(
        "spring pass",
        "the setpoint, unchanged; arming is refused",
        "Bypass",
        None,
        None,
        tests!("core/tests/safety_part" a_spring_pass, "firmware/tests/wire_reset" a_spring_pass_of_the_same_part_is_refused_also_after_a_reset_and_the_next_part_is_not),
    ),
    new("restart in the middle", PLAIN, "Armed", None, None, tests!("core/tests/safety_part" a_restart_in_the_middle)),
    new(
        "image for another program, feature, pass, tool, offset or setup",
        "the setpoint, unchanged; arming is refused",
        "Bypass",
        None,
        None,
        tests!("core/tests/safety_part" an_image_for_something_else, "firmware/tests/wire_modes" an_image_of_another_program_feature_pass_tool_offset_or_setup_is_not_armed),
    ),
    new(
        "frame onto an axis that is not sent",
        "the setpoint, unchanged; arming is refused",
        "Bypass",
        None,
        None,
        tests!("core/tests/safety_part" a_frame_onto_an_axis_that_is_not_sent),
    ),
    new(
        "arming before 33 setpoints have come at the pace of the settings",
        "the setpoint, unchanged; arming is refused",
        "Bypass",
        None,
        None,
        tests!("core/tests/safety_part" arming_before_the_pace_is_known, "core/tests/link_pace" nothing_is_armed_before_a_window_of_32_frames_at_a_permitted_pace),
    ),
    new(
        "wrong image: damaged, of another version, under another name",
        "the setpoint, unchanged; it is not activated",
        "Bypass",
        None,
        None,
        tests!("core/tests/safety_part" a_wrong_image, "firmware/tests/wire_upload" damaged_images_are_refused_and_the_next_upload_begins_anew,
        "firmware/tests/wire_upload" an_image_of_another_semantics_is_refused, "firmware/tests/wire_modes" an_image_that_is_not_there_or_another_one_cannot_be_activated),
    ),
    new(
        "upload cut off at any byte, power cut at any flash operation",
        "the setpoint, unchanged",
        "Bypass; after a power cut Off",
        None,
        None,
        tests!("firmware/tests/wire_upload" an_upload_goes_on_where_the_link_broke_off_at_every_byte,
        "firmware/tests/wire_power" an_upload_interrupted_at_every_flash_operation_leaves_the_old_image_or_the_new_one),
    ),
];
