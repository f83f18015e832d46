// SPDX-License-Identifier: GPL-2.0-or-later
//
// Route B: a setpoint goes to the coprocessor and its answer comes back within the same servo cycle.
//
// The servo thread waits for the answer, at most for a stated part of its period; what an answer is worth, and what goes
// to the drives without one, is decided in abi/src/board. Called by truepath.command in each period, deadline the end
// of the wait. A port that is not open, or breaks, is a link that is lost.

#ifndef TRUEPATH_ROUTE_B_H
#define TRUEPATH_ROUTE_B_H

#include "abi/truepath-board.h"
#include "port.h"

struct board {
    struct truepath_board link;
    struct port port;
    struct truepath_board_got got;
    // From the sending to the answer, ns; that of the last answer, and the longest.
    long long took, longest;
};

// Settings must have been taken by truepath_board_new before; then the port may open.
static int board_start(struct board *board, const char *path, unsigned baud) {
    board->took = board->longest = 0;
    board->got.cause = 1;
    return port_start(&board->port, path, baud);
}

static void board_stop(struct board *board) {
    port_stop(&board->port);
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

// One setpoint there and back; wait is the part of the period that may pass, 0 to 1. The result is in board->got.
static void board_exchange(struct board *board, const struct truepath_board_sent *sent, long period, double wait) {
    unsigned char packet[TRUEPATH_BOARD_PACKET_BYTES];
    long long begin = port_now();
    long long until = begin + (long long)((double)period * (wait < 0 ? 0 : wait > 0.9 ? 0.9 : wait));
    int fd = atomic_load(&board->port.open);
    if (fd >= 0 && board->got.cause && !board->got.answered) {
        // Old setpoints in the port would only be answered late, and for ever.
        port_discard(fd);
        truepath_board_not_sent(&board->link);
    }
    size_t count = truepath_board_begin(&board->link, sent, packet);
    int done = fd < 0 ? -EBADF : port_send(fd, packet, count);
    if (done >= 0 && (size_t)done < count) truepath_board_not_sent(&board->link);
    if (done < 0 || !board_listen(board, fd, until)) {
        if (fd >= 0) port_break(&board->port);
        truepath_board_port_failed(&board->link);
    }
    truepath_board_finish(&board->link, &board->got);
    if (board->got.answered) {
        board->took = port_now() - begin;
        if (board->took > board->longest) board->longest = board->took;
    }
}

#endif
