// SPDX-License-Identifier: GPL-2.0-or-later
//
// Route B: a setpoint goes to the coprocessor and its answer comes back within the same servo cycle.
//
// The servo thread waits for the answer, at most for a stated part of its period; what an answer is worth, and what goes
// to the drives without one, is decided in abi/src/board. Until the link has been set up, and while it is lost, no drive
// is enabled.

#ifndef TRUEPATH_ROUTE_B_H
#define TRUEPATH_ROUTE_B_H

#include "port.h"
#include "truepath-board.h"

struct board {
    struct truepath_board link;
    struct port port;
    struct truepath_link state;
    const uint8_t *axis_of_joint;
    // The parameters of the component, as they are now; axes in a frame, largest correction.
    void (*limits)(struct truepath_limits *limits);
    unsigned axes;
    const volatile hal_u32_t *clamp_nm;
    // Written by the servo thread in its first period, 0 before.
    atomic_uint period_ns;
    // The link has been set up: from here on it is the servo thread's.
    atomic_bool made;
    uint32_t refused;
    // From the sending to the answer of the last answered period, ns.
    long long took;
};

// Sets the link up, once there is a period: by the keeper, because it takes longer than a period may.
static bool board_ready(void *owner) {
    struct board *board = owner;
    struct truepath_limits limits = {0};
    unsigned period = atomic_load(&board->period_ns);
    if (atomic_load(&board->made)) return true;
    if (!period) return false;
    board->limits(&limits);
    uint32_t refused = truepath_board_new(&board->link, board->axis_of_joint, &limits, period, board->axes, *board->clamp_nm);
    if (refused && refused != board->refused)
        rtapi_print_msg(RTAPI_MSG_ERR, "truepath: limits of the joints, axes, link-clamp-nm or period do not go with a board: "
            "error %u, see docs/linuxcnc.md\n", refused);
    board->refused = refused;
    if (!refused) atomic_store(&board->made, true);
    return !refused;
}

static int board_start(struct board *board, const char *path, unsigned baud) {
    board->state.cause = TRUEPATH_LINK_NOT_HEARD;
    board->port.path = path;
    board->port.baud = baud;
    board->port.ready = board_ready;
    board->port.owner = board;
    return port_start(&board->port);
}

static void board_stop(struct board *board) {
    port_stop(&board->port);
}

static void board_feedback(struct board *board, const double *measured, double *plain) {
    if (atomic_load(&board->made)) truepath_board_feedback(&board->link, measured, plain);
    else memcpy(plain, measured, TRUEPATH_JOINTS * sizeof *plain);
}

// Reads until the answer is there or the time is over; false when the port is broken.
static bool board_listen(struct board *board, int fd, long long until) {
    unsigned char bytes[256];
    size_t room;
    while ((room = truepath_board_room(&board->link)) > 0) {
        int got = port_receive(fd, bytes, room < sizeof bytes ? room : sizeof bytes, until);
        if (got <= 0) return got == 0;
        truepath_board_take(&board->link, bytes, (size_t)got);
    }
    return true;
}

// Sends the bytes and waits for the answer; false when the port is broken or not open.
static bool board_exchange(struct board *board, const unsigned char *packet, size_t count, long long until) {
    int fd = atomic_load(&board->port.open);
    if (fd < 0) return false;
    // Setpoints that pile up in the port are answered late, and for ever.
    if (board->state.cause && !board->state.answered) port_discard(fd);
    int sent = port_send(fd, packet, count);
    if (sent >= 0 && (size_t)sent < count) truepath_board_not_sent(&board->link);
    if (sent >= 0 && board_listen(board, fd, until)) return true;
    port_break(&board->port);
    return false;
}

// A period; `wait` is the part of it that may pass until the answer, 0 to 0.9.
static void board_command(struct board *board, const struct truepath_inputs *in, struct truepath_outputs *out, double wait) {
    unsigned char packet[TRUEPATH_BOARD_PACKET_BYTES];
    long long begin = port_now();
    if (!atomic_load(&board->made)) {
        memset(out, 0, sizeof *out);
        memcpy(out->motor_pos_cmd, in->motor_pos_cmd, sizeof out->motor_pos_cmd);
        atomic_store(&board->period_ns, in->period_ns);
        return;
    }
    long long until = begin + (long long)(in->period_ns * (wait > 0.9 ? 0.9 : wait > 0 ? wait : 0));
    // After a discarded frame the line has to be cleared; begin does so when the last one was not sent.
    if (board->state.cause && !board->state.answered) truepath_board_not_sent(&board->link);
    size_t count = truepath_board_begin(&board->link, in, packet);
    if (!board_exchange(board, packet, count, until)) truepath_board_port_failed(&board->link);
    truepath_board_finish(&board->link, in, out, &board->state);
    if (board->state.answered) board->took = port_now() - begin;
}

#endif
