// SPDX-License-Identifier: GPL-2.0-or-later
component truepath_wall "A milled wall that a touch probe finds; for the simulated sample machine only.";
description """
Trips *contact* while a ball touches a wall that is read from a file, so that a probing program runs on a simulated
machine. The file is probed-wall.csv of `truepath simulate --probed-wall`: a line of names, then z,x,y of the points of the
wall in program coordinates, height by height from below, along the wall within a height.

 loadrt truepath_wall wall=FILE
 addf truepath-wall.update servo-thread 1
 net probe truepath-wall.contact => motion.probe-input

The contact is looked for in the plane of the ball's centre, between the two heights next to it; above and below the wall
there is nothing. Where the ball is follows from the drives' positions, as LinuxCNC computes it, so that the position that
LinuxCNC latches in this period is one at which the ball touches. The file is read at load and on a rising edge of
*reload*, by a thread of its own.
""";
license "GPL";
author "The Truepath developers";
option singleton yes;
option rtapi_app no;
option no_convenience_defines yes;

pin in float position-#[3] "Position of the drive of X, Y, Z; motor coordinates, machine units";
pin in float motor-offset-#[3] "From joint.N.motor-offset";
pin in float backlash-#[3] "From joint.N.backlash-filt";
pin in float offset-#[3] "Machine position of the program's origin, tool offset included";
pin in s32 frame-cosine = 1073741824 "Cosine of the rotation of the work offset, units of 2^-30";
pin in s32 frame-sine "Its sine";
pin in s32 tool "Number of the tool in the spindle, from iocontrol.0.tool-number";
pin in bit reload "Rising edge: read the file again";
pin out bit contact "The ball touches; to motion.probe-input";
pin out float gap "From the ball to the wall, machine units; 1000 far from it";
pin out u32 points "Points of the wall in use";
pin out u32 loads "How often the file has been read";
param rw s32 probe-tool = 9 "Tool number of the probe; any other tool touches nothing";
param rw float ball-radius = 3.0 "Radius of the ball, machine units";

function update fp "Before motion-controller";
;;

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static char *wall = "";
RTAPI_MP_STRING(wall, "file of the wall");

enum {
    MOST_HEIGHTS = 32,
    // Two heights are gone through in a period: 80 us on a slow PC.
    MOST_POINTS = 8192,
    ROUND_NS = 20000000,
};
static const double FAR = 1000.0;

struct height {
    double z;
    int count;
    struct { double x, y; } at[MOST_POINTS];
};
struct wall {
    int heights;
    unsigned points;
    // What lies within the box may touch.
    double low[2], high[2];
    struct height height[MOST_HEIGHTS];
};

// One is in use, the other is filled; the thread fills it only when the servo thread uses the first.
static struct wall walls[2];
static atomic_int wanted, used;
static atomic_uint asked, loaded;
static atomic_bool end;
static pthread_t reader;
static bool reload_before;

#define FUNCTION(name) static void name(struct __comp_state *hal, long period)

static bool add(struct wall *to, double z, double x, double y) {
    struct height *last = to->heights ? &to->height[to->heights - 1] : NULL;
    if (!last || z != last->z) {
        if (to->heights == MOST_HEIGHTS || (last && z < last->z)) return false;
        last = &to->height[to->heights++];
        last->z = z;
        last->count = 0;
    }
    if (last->count == MOST_POINTS) return false;
    last->at[last->count].x = x;
    last->at[last->count++].y = y;
    const double place[2] = {x, y};
    for (int k = 0; k < 2; k++) {
        if (!to->points || place[k] < to->low[k]) to->low[k] = place[k];
        if (!to->points || place[k] > to->high[k]) to->high[k] = place[k];
    }
    to->points++;
    return true;
}

// 0, or the number of the line that is wrong; -1 without a file.
static int read_wall(struct wall *to) {
    FILE *file = fopen(wall, "r");
    char line[128];
    int number = 0, wrong = 0;
    to->heights = 0;
    to->points = 0;
    if (!file) return -1;
    while (!wrong && fgets(line, sizeof line, file)) {
        double z, x, y;
        number++;
        if (number == 1) continue;
        if (sscanf(line, "%lf,%lf,%lf", &z, &x, &y) != 3 || !isfinite(z + x + y) || !add(to, z, x, y)) wrong = number;
    }
    fclose(file);
    if (wrong) to->heights = 0;
    return wrong;
}

static void load(bool first) {
    int fill = 1 - atomic_load(&used);
    int wrong = read_wall(&walls[fill]);
    if (wrong > 0) {
        rtapi_print_msg(RTAPI_MSG_ERR, "truepath_wall: %s, line %d: expected z,x,y, heights rising, at most %d heights of %d "
            "points\n", wall, wrong, MOST_HEIGHTS, MOST_POINTS);
    } else if (wrong && !first) {
        rtapi_print_msg(RTAPI_MSG_ERR, "truepath_wall: %s: %s; there is no wall\n", wall, strerror(errno));
    }
    atomic_store(&wanted, fill);
    atomic_fetch_add(&loaded, 1);
}

static void *read_when_asked(void *nothing) {
    const struct timespec round = {0, ROUND_NS};
    unsigned seen = atomic_load(&asked);
    while (!atomic_load(&end)) {
        unsigned now = atomic_load(&asked);
        if (now != seen && atomic_load(&used) == atomic_load(&wanted)) {
            seen = now;
            load(false);
        }
        nanosleep(&round, NULL);
    }
    return nothing;
}

// Distance of a point from the wall at a height.
static double distance(const struct height *h, double x, double y) {
    double least = FAR * FAR;
    for (int k = 0; k + 1 < h->count; k++) {
        double ux = h->at[k + 1].x - h->at[k].x, uy = h->at[k + 1].y - h->at[k].y;
        double vx = x - h->at[k].x, vy = y - h->at[k].y;
        double square = ux * ux + uy * uy, share = ux * vx + uy * vy;
        if (share > 0.0) {
            share = share < square ? share / square : 1.0;
            vx -= share * ux;
            vy -= share * uy;
        }
        double here = vx * vx + vy * vy;
        if (here < least) least = here;
    }
    return sqrt(least);
}

static double gap_at(const struct wall *w, double radius, double x, double y, double z) {
    if (!w->heights || z < w->height[0].z || z > w->height[w->heights - 1].z) return FAR;
    if (x < w->low[0] - radius || x > w->high[0] + radius || y < w->low[1] - radius || y > w->high[1] + radius) return FAR;
    int above = 0;
    while (above < w->heights - 1 && w->height[above].z < z) above++;
    const struct height *upper = &w->height[above], *lower = above ? upper - 1 : upper;
    double gap = distance(upper, x, y), span = upper->z - lower->z;
    if (span > 0.0 && z < upper->z) gap += (distance(lower, x, y) - gap) * (upper->z - z) / span;
    return gap - radius;
}

FUNCTION(update) {
    (void)period;
    double p[3];
    for (int k = 0; k < 3; k++)
        p[k] = *hal->position[k] - *hal->motor_offset[k] - *hal->backlash[k] - *hal->offset[k];
    double c = *hal->frame_cosine / 1073741824.0, s = *hal->frame_sine / 1073741824.0;
    atomic_store(&used, atomic_load(&wanted));
    const struct wall *w = &walls[atomic_load(&used)];
    bool probe = *hal->tool == hal->probe_tool;
    double gap = probe ? gap_at(w, hal->ball_radius, c * p[0] + s * p[1], c * p[1] - s * p[0], p[2]) : FAR;
    *hal->gap = gap;
    *hal->contact = gap <= 0.0;
    *hal->points = w->points;
    *hal->loads = atomic_load(&loaded);
    bool reload = *hal->reload;
    if (reload && !reload_before) atomic_fetch_add(&asked, 1);
    reload_before = reload;
}

// Starts the thread with the scheduling of a normal program, not that of the servo thread; it takes no signals.
static int start_reader(void) {
    pthread_attr_t attributes;
    const struct sched_param normal = {0};
    sigset_t all, before;
    sigfillset(&all);
    pthread_attr_init(&attributes);
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, SCHED_OTHER);
    pthread_attr_setschedparam(&attributes, &normal);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int r = -pthread_create(&reader, &attributes, read_when_asked, NULL);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return r;
}

int rtapi_app_main(void) {
    load(true);
    atomic_store(&used, atomic_load(&wanted));
    comp_id = hal_init("truepath_wall");
    if (comp_id < 0) return comp_id;
    int r = export("truepath-wall", 0);
    if (!r) r = start_reader();
    if (r) {
        hal_exit(comp_id);
        return r;
    }
    return hal_ready(comp_id);
}

void rtapi_app_exit(void) {
    atomic_store(&end, true);
    pthread_join(reader, NULL);
    hal_exit(comp_id);
}
