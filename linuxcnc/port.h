// SPDX-License-Identifier: GPL-2.0-or-later
//
// The serial port of the coprocessor, as the servo thread uses it.
//
// The servo thread only reads, writes and waits, without blocking and never beyond the time it is given. Opening and
// closing can take as long as a driver likes, so a thread of its own does both, with the scheduling of a normal
// program: it opens the port once its owner is ready, tries again each second when that fails, and closes it when the
// servo thread says that it is broken. They share one number, the descriptor.

#ifndef TRUEPATH_PORT_H
#define TRUEPATH_PORT_H

// Not <termios.h>: its speeds are names, and any number is permitted here. Both cannot be included.
#include <asm/termbits.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "rtapi.h"

struct port {
    const char *path;
    unsigned baud;
    // Asked by the keeper until it says yes; nothing is opened before.
    bool (*ready)(void *owner);
    void *owner;
    // The descriptor while the servo thread may use it, otherwise -1. Set by the keeper, taken back by the servo thread.
    atomic_int open;
    atomic_bool end;
    pthread_t keeper;
};

static long long port_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000000000LL + now.tv_nsec;
}

// 8N1, raw, without flow control, for this process alone. A negative errno when it is no such port.
static int port_configure(int fd, unsigned baud) {
    struct termios2 mode;
    if (ioctl(fd, TIOCEXCL) || ioctl(fd, TCGETS2, &mode)) return -errno;
    mode.c_iflag = 0;
    mode.c_oflag = 0;
    mode.c_lflag = 0;
    mode.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
    mode.c_ispeed = mode.c_ospeed = baud;
    // No byte there is an error (EAGAIN), so that 0 is left for a port that has gone.
    mode.c_cc[VMIN] = 1;
    mode.c_cc[VTIME] = 0;
    if (ioctl(fd, TCSETS2, &mode) || ioctl(fd, TCFLSH, TCIOFLUSH)) return -errno;
    // USB converters collect bytes for up to 16 ms without it. Ports that do not know it refuse, which does no harm.
    struct serial_struct serial;
    if (!ioctl(fd, TIOCGSERIAL, &serial)) {
        serial.flags |= ASYNC_LOW_LATENCY;
        (void)ioctl(fd, TIOCSSERIAL, &serial);
    }
    return 0;
}

// A descriptor, or a negative errno.
static int port_open(const char *path, unsigned baud) {
    int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) return -errno;
    int error = port_configure(fd, baud);
    if (!error) return fd;
    close(fd);
    return error;
}

static void *port_keep(void *context) {
    struct port *port = context;
    int mine = -1, said = 0;
    while (!atomic_load(&port->end)) {
        if (mine >= 0 && atomic_load(&port->open) < 0) {
            rtapi_print_msg(RTAPI_MSG_ERR, "truepath: %s is broken; it is opened again each second\n", port->path);
            close(mine);
            mine = -1;
        }
        if (mine < 0 && port->ready(port->owner)) {
            mine = port_open(port->path, port->baud);
            if (mine >= 0) {
                atomic_store(&port->open, mine);
                said = 0;
            } else if (mine != said) {
                rtapi_print_msg(RTAPI_MSG_ERR, "truepath: %s: %s; no drive is enabled without the board, it is tried "
                    "again each second\n", port->path, strerror(-mine));
                said = mine;
            }
        }
        for (int i = 0; i < 10 && !atomic_load(&port->end); i++) usleep(100000);
    }
    atomic_store(&port->open, -1);
    if (mine >= 0) close(mine);
    return NULL;
}

// Starts the keeper. 0, or a negative errno.
static int port_start(struct port *port) {
    pthread_attr_t attributes;
    struct sched_param normal = {0};
    sigset_t all, before;
    atomic_store(&port->open, -1);
    atomic_store(&port->end, false);
    sigfillset(&all);
    pthread_attr_init(&attributes);
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, SCHED_OTHER);
    pthread_attr_setschedparam(&attributes, &normal);
    // Signals are for the program that loads the component.
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int error = pthread_create(&port->keeper, &attributes, port_keep, port);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return -error;
}

// Ends the keeper; not before the servo thread has stopped.
static void port_stop(struct port *port) {
    atomic_store(&port->end, true);
    pthread_join(port->keeper, NULL);
}

// Servo thread: the port is broken, the keeper is to close it.
static void port_break(struct port *port) {
    atomic_store(&port->open, -1);
}

// Servo thread: what was not yet sent and not yet read is of no use any more.
static void port_discard(int fd) {
    (void)ioctl(fd, TCFLSH, TCIOFLUSH);
}

// Servo thread: bytes sent, as many as there is room for, or a negative errno when the port is broken.
static int port_send(int fd, const unsigned char *bytes, size_t count) {
    ssize_t sent = write(fd, bytes, count);
    if (sent >= 0) return (int)sent;
    return errno == EAGAIN || errno == EINTR ? 0 : -errno;
}

// Servo thread: bytes that arrive until a time, 0 when none does, or a negative errno when the port is broken.
static int port_receive(int fd, unsigned char *bytes, size_t room, long long until) {
    for (;;) {
        ssize_t got = read(fd, bytes, room);
        if (got > 0) return (int)got;
        if (got == 0) return -EPIPE;
        if (errno != EAGAIN && errno != EINTR) return -errno;
        long long left = until - port_now();
        if (left <= 0) return 0;
        struct timespec wait = { .tv_sec = left / 1000000000, .tv_nsec = left % 1000000000 };
        struct pollfd there = { .fd = fd, .events = POLLIN };
        if (ppoll(&there, 1, &wait, NULL) > 0 && !(there.revents & POLLIN)) return -EIO;
    }
}

#endif
