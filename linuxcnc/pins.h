// SPDX-License-Identifier: GPL-2.0-or-later
//
// HAL's pins from and to the structures of the library: copies, nothing is decided here. Included by truepath.comp, which
// declares the pins and knows the number of joints.

#ifndef TRUEPATH_PINS_H
#define TRUEPATH_PINS_H

#include "board.h"

static uint32_t switches(const struct __comp_state *hal) {
    bool homed = true;
    for (int j = 0; j < joints; j++) homed &= *hal->_homed[j];
    return (*hal->drives_on ? TRUEPATH_DRIVES_ON : 0)
        | (homed ? TRUEPATH_ALL_HOMED : 0)
        | (*hal->emergency_stop ? TRUEPATH_EMERGENCY_STOP : 0)
        | (*hal->feed_hold ? TRUEPATH_FEED_HOLD : 0)
        | (*hal->program_running ? TRUEPATH_PROGRAM_RUNNING : 0)
        | (*hal->tool_change ? TRUEPATH_TOOL_CHANGE : 0)
        | (*hal->spindle_on ? TRUEPATH_SPINDLE_ON : 0)
        | (*hal->spindle_loaded ? TRUEPATH_SPINDLE_LOADED : 0)
        | (*hal->trivial_kinematics ? TRUEPATH_TRIVIAL_KINEMATICS : 0)
        | (*hal->enable ? TRUEPATH_ENABLE : 0)
        | (*hal->arm ? TRUEPATH_ARM : 0)
        | (*hal->disarm ? TRUEPATH_DISARM : 0);
}

static void read_pins(const struct __comp_state *hal, long period, struct truepath_inputs *in) {
    for (int j = 0; j < joints; j++) {
        in->pos_cmd[j] = *hal->_pos_cmd[j];
        in->motor_pos_cmd[j] = *hal->_motor_pos_cmd_in[j];
    }
    in->offset[0] = *hal->offset_x;
    in->offset[1] = *hal->offset_y;
    in->offset[2] = *hal->offset_z;
    in->spindle_rpm = *hal->spindle_rpm;
    in->nm_per_unit = hal->nm_per_unit;
    in->cosine = *hal->frame_cosine;
    in->sine = *hal->frame_sine;
    in->motion_type = *hal->motion_type;
    in->tool = *hal->tool;
    in->tool_offset = *hal->tool_offset;
    in->program_crc = *hal->program_crc;
    in->feature = *hal->feature;
    in->pass = *hal->pass;
    in->setup = *hal->setup;
    in->part_serial = *hal->part_serial;
    in->switches = switches(hal);
    in->period_ns = (uint32_t)period;
}

static void write_pins(struct __comp_state *hal, const struct truepath_outputs *out) {
    bool held = false;
    for (int j = 0; j < joints; j++) {
        *hal->_motor_pos_cmd[j] = out->motor_pos_cmd[j];
        *hal->_amp_enable[j] = *hal->_amp_enable_in[j] && out->forward;
        held |= *hal->_amp_enable_in[j] && !out->forward;
    }
    *hal->amp_fault = held;
    *hal->state = out->state;
    *hal->armed = out->state == 2;
    *hal->active = out->state >= 3;
    *hal->fault = out->fault;
    *hal->reason = out->reason;
    *hal->refusal = out->refusal;
    *hal->warn = out->status & TRUEPATH_WARN;
    *hal->saturated = (out->status & TRUEPATH_SATURATED) != 0;
    *hal->lagging = (out->status & TRUEPATH_LAGGING) != 0;
    *hal->faded = (out->status & TRUEPATH_FADED) != 0;
    *hal->joint_limited = (out->status & TRUEPATH_JOINT_LIMITED) != 0;
    *hal->correction_x = out->correction[0];
    *hal->correction_y = out->correction[1];
    *hal->correction_z = out->correction[2];
    for (int axis = 0; axis < 3; axis++) *hal->correction_nm[axis] = out->correction_nm[axis];
    *hal->armed_serial = out->armed_serial;
    *hal->image_ready = out->image_ready;
    *hal->image_crc = out->image_crc;
    *hal->node = out->node;
    *hal->sequence = out->sequence;
    *hal->flags = out->flags;
    *hal->feed_inhibit = out->feed_inhibit;
}

static void write_link(struct __comp_state *hal, const struct board *board) {
    *hal->link_lost = board->state.cause != TRUEPATH_LINK_THERE;
    *hal->link_cause = board->state.cause;
    *hal->link_misses = board->state.missed;
    *hal->link_late = board->state.late;
    *hal->link_damaged = board->state.damaged;
    if (!board->state.answered) return;
    *hal->link_time = (hal_u32_t)board->took;
    if (*hal->link_lost) *hal->link_time_max = 0;
    else if (board->took > *hal->link_time_max) *hal->link_time_max = (hal_u32_t)board->took;
}

#endif
