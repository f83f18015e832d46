/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Route B for C: the controller's end of the setpoint link. `src/board_abi.rs` has what each function and field means;
 * a test compares both. All functions are bounded in time and do no input or output.
 */

#ifndef TRUEPATH_BOARD_H
#define TRUEPATH_BOARD_H

#include "truepath.h"

#define TRUEPATH_BOARD_WORDS 512
#define TRUEPATH_BOARD_PACKET_BYTES 75

/* Memory of a board. */
struct truepath_board {
    uint64_t words[TRUEPATH_BOARD_WORDS];
};

/* Why the link is lost. */
enum {
    TRUEPATH_LINK_THERE = 0,
    TRUEPATH_LINK_NOT_HEARD = 1,
    TRUEPATH_LINK_SILENT = 2,
    TRUEPATH_LINK_BOARD_OFF = 3,
    TRUEPATH_LINK_PORT = 4,
    TRUEPATH_LINK_NO_SETPOINT = 5,
};

struct truepath_link {
    uint32_t cause;
    uint32_t answered;
    uint32_t missed;
    uint32_t late;
    uint32_t damaged;
};

/* Not for the servo thread. 0, or the number of what is refused: as truepath_pc_offer, or 64 axes, 65 period, 66 clamp,
 * 67 speed or acceleration, 68 joint limits, 69 the correction could not move at this period. */
uint32_t truepath_board_new(struct truepath_board *board, const uint8_t axis_of_joint[TRUEPATH_JOINTS],
    const struct truepath_limits *limits, uint32_t period_ns, uint32_t axes, uint32_t clamp_nm);

/* The servo thread: before the motion controller; then behind it begin, send, take while there is room, finish. */
void truepath_board_feedback(const struct truepath_board *board, const double measured[TRUEPATH_JOINTS],
    double plain[TRUEPATH_JOINTS]);
size_t truepath_board_begin(struct truepath_board *board, const struct truepath_inputs *inputs,
    unsigned char packet[TRUEPATH_BOARD_PACKET_BYTES]);
void truepath_board_not_sent(struct truepath_board *board);
void truepath_board_port_failed(struct truepath_board *board);
size_t truepath_board_room(struct truepath_board *board);
void truepath_board_take(struct truepath_board *board, const unsigned char *bytes, size_t count);
void truepath_board_finish(struct truepath_board *board, const struct truepath_inputs *inputs,
    struct truepath_outputs *outputs, struct truepath_link *link);

#endif
