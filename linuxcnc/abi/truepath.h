/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Route A for C: the correction computed on the PC. `src/pc_abi.rs` and `src/pc/` have what each function and field
 * means; a test compares sizes and places. The functions of the servo side are bounded in time, allocate nothing and call
 * nothing.
 */

#ifndef TRUEPATH_H
#define TRUEPATH_H

#include <stddef.h>
#include <stdint.h>

#define TRUEPATH_PC_WORDS 2048
#define TRUEPATH_JOINTS 6
#define TRUEPATH_LEDGER_BYTES 2048
#define TRUEPATH_NO_AXIS 255

/* Bits of truepath_inputs.switches. */
enum {
    TRUEPATH_DRIVES_ON = 1,
    TRUEPATH_ALL_HOMED = 2,
    TRUEPATH_EMERGENCY_STOP = 4,
    TRUEPATH_FEED_HOLD = 8,
    TRUEPATH_PROGRAM_RUNNING = 16,
    TRUEPATH_TOOL_CHANGE = 32,
    TRUEPATH_SPINDLE_ON = 64,
    TRUEPATH_SPINDLE_LOADED = 128,
    TRUEPATH_TRIVIAL_KINEMATICS = 256,
    TRUEPATH_ENABLE = 512,
    TRUEPATH_ARM = 1024,
    TRUEPATH_DISARM = 2048,
};

/* Bits of truepath_outputs.status. */
enum {
    TRUEPATH_WARN = 1,
    TRUEPATH_SATURATED = 2,
    TRUEPATH_LAGGING = 4,
    TRUEPATH_FADED = 8,
    TRUEPATH_JOINT_LIMITED = 16,
};

/* Memory of both sides. */
struct truepath_block {
    uint64_t words[TRUEPATH_PC_WORDS];
};

struct truepath_servo;
struct truepath_config;

struct truepath_sides {
    struct truepath_servo *servo;
    struct truepath_config *config;
};

struct truepath_inputs {
    double pos_cmd[TRUEPATH_JOINTS];
    double motor_pos_cmd[TRUEPATH_JOINTS];
    double offset[3];
    double spindle_rpm;
    double nm_per_unit;
    int32_t cosine;
    int32_t sine;
    int32_t motion_type;
    int32_t tool;
    int32_t tool_offset;
    uint32_t program_crc;
    uint32_t feature;
    uint32_t pass;
    uint32_t setup;
    uint32_t part_serial;
    uint32_t switches;
    uint32_t period_ns;
};

struct truepath_outputs {
    double motor_pos_cmd[TRUEPATH_JOINTS];
    double correction[3];
    int32_t correction_nm[3];
    uint32_t state;
    uint32_t reason;
    uint32_t fault;
    uint32_t status;
    uint32_t refusal;
    uint32_t forward;
    uint32_t armed_serial;
    uint32_t image_ready;
    uint32_t image_crc;
    uint32_t node;
    uint32_t sequence;
    uint32_t flags;
    uint32_t feed_inhibit;
};

struct truepath_limits {
    double least[TRUEPATH_JOINTS];
    double greatest[TRUEPATH_JOINTS];
    double velocity[TRUEPATH_JOINTS];
    double acceleration[TRUEPATH_JOINTS];
    double nm_per_unit;
};

/* 0, or why the ledger cannot be used: 1 damaged, 2 another version. */
uint32_t truepath_pc_new(struct truepath_block *block, const uint8_t axis_of_joint[TRUEPATH_JOINTS], const uint8_t *ledger,
    size_t ledger_bytes, struct truepath_sides *sides);

/* Before the threads run: the keys whose images are taken from then on. 0, the number of the line that is no key, or
 * 2^32 - 1 if there is none. */
uint32_t truepath_pc_trust(struct truepath_config *config, const uint8_t *keys, size_t keys_bytes);

/* The servo thread: before and behind the motion controller. */
void truepath_pc_feedback(const struct truepath_servo *servo, const double measured[TRUEPATH_JOINTS],
    double plain[TRUEPATH_JOINTS]);
void truepath_pc_command(struct truepath_servo *servo, const struct truepath_inputs *inputs,
    struct truepath_outputs *outputs);

/* The configuration thread. Images that were taken (0) are lent until they come back. truepath_pc_count gives the ledger
 * that has to be written before an image can be offered, no bytes for the one that is there; truepath_pc_written follows. */
uint32_t truepath_pc_ready(const struct truepath_config *config);
uint32_t truepath_pc_offer(struct truepath_config *config, const struct truepath_limits *limits, const uint8_t *image,
    size_t image_bytes);
const uint8_t *truepath_pc_returned(struct truepath_config *config);
size_t truepath_pc_count(struct truepath_config *config, const uint8_t *image, size_t image_bytes,
    uint8_t file[TRUEPATH_LEDGER_BYTES]);
size_t truepath_pc_spend(struct truepath_config *config, uint8_t file[TRUEPATH_LEDGER_BYTES]);
void truepath_pc_written(struct truepath_config *config, uint32_t done);

#endif
