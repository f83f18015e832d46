/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * The controller's end of the setpoint link, for C. `src/board_abi.rs` has what each function and field means; a test
 * compares both. All functions are bounded in time and do no input or output.
 */

#ifndef TRUEPATH_BOARD_H
#define TRUEPATH_BOARD_H

#include <stddef.h>
#include <stdint.h>

#define TRUEPATH_BOARD_WORDS 256
#define TRUEPATH_BOARD_PACKET_BYTES 75
#define TRUEPATH_AXES 6

/* Memory of a board. */
struct truepath_board {
    uint64_t words[TRUEPATH_BOARD_WORDS];
};

struct truepath_board_settings {
    uint64_t acceleration_nm_per_s2;
    int64_t least_nm[TRUEPATH_AXES];
    int64_t greatest_nm[TRUEPATH_AXES];
    uint32_t slew_nm_per_s;
    uint32_t tick_hz;
    int32_t clamp_nm;
    uint32_t axes;
};

/* What is sent in a tick. */
struct truepath_board_sent {
    int64_t axes_nm[TRUEPATH_AXES];
    uint32_t spindle_millirpm;
    uint32_t frame_crc;
    uint32_t flags;
    uint32_t drives_on;
};

/* What goes to the drives and to the pins. */
struct truepath_board_got {
    int32_t correction_nm[TRUEPATH_AXES];
    uint32_t enable;
    uint32_t cause; /* of a lost link: 0 it is there, 1 not heard yet, 2 silence, 3 board off, 4 port */
    uint32_t state;
    uint32_t reason;
    uint32_t status;
    uint32_t node;
    uint32_t sequence;
    uint32_t flags;
    uint32_t answered;
    uint32_t missed;
    uint32_t late;
    uint32_t damaged;
};

/* 0, or which setting is refused: 1 axes, 2 tick rate, 3 clamp, 4 speed or acceleration, 5 joint limits, 6 the
 * correction could not move at this tick rate. */
uint32_t truepath_board_new(struct truepath_board *board, const struct truepath_board_settings *settings);

/* In each tick: begin, send, take what arrives while there is room for it, finish. */
size_t truepath_board_begin(struct truepath_board *board, const struct truepath_board_sent *sent,
    unsigned char packet[TRUEPATH_BOARD_PACKET_BYTES]);
void truepath_board_not_sent(struct truepath_board *board);
void truepath_board_port_failed(struct truepath_board *board);
size_t truepath_board_room(const struct truepath_board *board);
void truepath_board_take(struct truepath_board *board, const unsigned char *bytes, size_t count);
void truepath_board_finish(struct truepath_board *board, struct truepath_board_got *got);

#endif
