// SPDX-License-Identifier: GPL-2.0-or-later
component truepath "Deflection compensator between motion controller and drives";
description """
Rewrites the commanded position of each joint so that the deflection of the machine under the cutting force cancels.
Two functions of the servo thread stand around *motion-controller*:

 addf truepath.feedback servo-thread
 addf motion-controller servo-thread
 addf truepath.command  servo-thread

Only trivial kinematics: a joint is an axis, by the letters of *coordinates*. The pins whose name begins with a number
exist once for each of its letters. Lengths are in machine units, angles do not occur.
""";
license "GPL";
author "The Truepath developers";
option singleton yes;
option rtapi_app no;
option no_convenience_defines yes;

// Joints. The number of letters in `coordinates` is the personality.
pin in float #.pos-cmd[6 : personality] "Commanded position without homing offset and backlash; from joint.N.pos-cmd";
pin in float #.motor-pos-cmd-in[6 : personality] "From joint.N.motor-pos-cmd";
pin out float #.motor-pos-cmd[6 : personality] "To the drive: motor-pos-cmd-in with the correction added";
pin in float #.motor-pos-fb-in[6 : personality] "From the drive";
pin out float #.motor-pos-fb[6 : personality] "To joint.N.motor-pos-fb: motor-pos-fb-in with the correction removed";
pin in bit #.homed[6 : personality] "From joint.N.homed";
pin in bit #.amp-enable-in[6 : personality] "From joint.N.amp-enable-out";
pin out bit #.amp-enable[6 : personality] "To the drive; false in state 0 and when the link to the board is lost";
param rw float #.min-limit[6 : personality] "Least position of the joint, machine units; the INI file's MIN_LIMIT";
param rw float #.max-limit[6 : personality] "Greatest position of the joint, machine units; the INI file's MAX_LIMIT";
param rw float #.max-correction-vel[6 : personality] "Velocity left to the correction, machine units per second";
param rw float #.max-correction-accel[6 : personality] "Acceleration left to the correction, machine units per second squared";
param rw float nm-per-unit = 1000000.0 "Nanometres per machine unit: 1000000 for mm, 25400000 for inch";

// State of the machine.
pin in bit drives-on "From motion.motion-enabled";
pin in bit emergency-stop "True while the emergency stop is pressed";
pin in bit feed-hold "True while the program is paused";
pin in bit program-running "From halui.program.is-running";
pin in bit tool-change "True while a tool change is under way";
pin in s32 motion-type "From motion.motion-type; 5 is probing";
pin in float spindle-rpm "Speed of the spindle, revolutions per minute; the sign does not matter";
pin in bit spindle-on "The spindle turns by command";
pin in bit spindle-loaded = 1 "The spindle is under load; leave it unconnected without a load input";
pin in bit trivial-kinematics "From truepath-config: kinematics are trivial";

// Frame of the program and identity of what runs, from truepath-config.
pin in float offset-x "Machine position of the program's origin: g5x, rotated g92 and tool offset, X";
pin in float offset-y "The same, Y";
pin in float offset-z "The same, Z";
pin in s32 frame-cosine = 1073741824 "Cosine of the rotation of the work offset, units of 2^-30";
pin in s32 frame-sine "Sine of that rotation, units of 2^-30";
pin in u32 program-crc "CRC-32 of the program file";
pin in u32 feature "Number of the feature";
pin in u32 pass "Number of the pass";
pin in u32 setup "Number of the setup";
pin in u32 part-serial "Serial number of the part; counts up";
pin in s32 tool "Number of the tool in the spindle";
pin in s32 tool-offset "Number of the tool offset in force";

// Commands.
pin in bit enable "Master switch; while false nothing can be armed and a correction that is on ramps out";
pin in bit arm "Rising edge: arm for one pass of one part";
pin in bit disarm "Rising edge: end the arming";
pin in bit reload "Rising edge: read the image file again";

// What it says.
pin out u32 state "0 off, 1 bypass, 2 armed, 3 active, 4 hold, 5 fault";
pin out bit active "A correction is on: states 3, 4, 5";
pin out bit armed "State 2";
pin out bit fault "The last correction ended in a fault, until the next arming";
pin out bit warn "The correction is above its warn level";
pin out bit saturated "The correction is cut by its clamp";
pin out bit faded "The correction is faded: spindle stopped or unloaded, or feed outside its window";
pin out bit lagging "The correction is on its way, limited in speed or acceleration";
pin out bit joint-limited "The correction is held back by a joint limit";
pin out u32 reason "Why the last correction ended";
pin out u32 refusal "Why the last arming was refused; 0: it was not";
pin out float correction-x "Correction on the X axis, machine units";
pin out float correction-y "Correction on the Y axis, machine units";
pin out float correction-z "Correction on the Z axis, machine units";
pin out s32 correction-nm-#[3] "Correction on X, Y, Z, nm";
pin out u32 armed-serial "Serial number of the part armed last";
pin out bit image-ready "An image is in use";
pin out u32 image-crc "Its CRC-32";
pin out u32 image-error "Why the image file is not in use; 0: it is, or there is none";
pin out bit image-open "Images of anybody are taken: no file of keys is named; with a board it is the board that decides";
pin out u32 node "Place on the path: node of the image";
pin out u32 sequence "Number of the cycle";
pin out u32 flags "Flags that the core was given in this cycle";
pin out bit feed-inhibit "To motion.feed-inhibit: a probing move waits until the correction is out";
pin out bit amp-fault "To joint.N.amp-fault-in of every joint: a drive that LinuxCNC enables is held disabled";

// The link to a board.
pin out bit link-lost "The link to the board is lost; until the drives are off and the board answers again";
pin out u32 link-cause "Why: 1 not heard yet, 2 no answers, 3 the board was reset, 4 the port, 5 a position is no number";
pin out u32 link-misses "Periods without an answer in time";
pin out u32 link-late "Answers that came too late";
pin out u32 link-damaged "Answers that were damaged or cannot be true";
pin out u32 link-time "From the setpoint to its answer, ns";
pin out u32 link-time-max "The longest of them since the link was there";
param rw float link-wait = 0.5 "Part of the period for which an answer is waited, 0 to 0.9";
param rw u32 link-clamp-nm = 500000 "Largest correction that is taken from a board, nm";

function feedback fp "Before motion-controller: takes the correction out of the feedback";
function command fp "After motion-controller: adds the correction to the commanded position";
;;

static char *coordinates = "XYZ";
RTAPI_MP_STRING(coordinates, "axis letter of each joint, for instance XYZ, or XYYZ for a gantry");
static char *image = "";
RTAPI_MP_STRING(image, "file of the correction image");
static char *ledger = "";
RTAPI_MP_STRING(ledger, "file that remembers which parts were armed, and which images are too old");
static char *keys = "";
RTAPI_MP_STRING(keys, "file of public keys (truepath key new): only images signed with one of them are taken; none: every image");
static char *port = "";
RTAPI_MP_STRING(port, "serial port of the coprocessor; empty: the correction is computed here");
static int baud = 921600;
RTAPI_MP_INT(baud, "bits per second on that port");
static int axes = 3;
RTAPI_MP_INT(axes, "axes in a frame on that port");

#define FUNCTION(name) static void name(struct __comp_state *hal, long period)

#include "board.h"
#include "config_thread.h"

static struct truepath_block block;
static struct truepath_sides sides;
static struct config config;
static struct board board;
static struct __comp_state *component;
static int joints;
// Axis of each joint, 0…5 for X, Y, Z, A, B, C.
static uint8_t axis_of_joint[TRUEPATH_JOINTS];
static bool reload_before;
// LinuxCNC was given positions since the last command; without them it commands into the dark.
static bool fed;

#include "pins.h"

// Reads `coordinates`. 0 or a negative errno.
static int read_coordinates(void) {
    unsigned seen = 0;
    memset(axis_of_joint, TRUEPATH_NO_AXIS, sizeof axis_of_joint);
    for (const char *c = coordinates; *c; c++) {
        if (*c == ' ' || *c == ',') continue;
        const char *letters = "XYZABCUVWxyzabcuvw", *letter = strchr(letters, *c);
        if (!letter || joints == TRUEPATH_JOINTS) {
            seen = 0;
            break;
        }
        int axis = (int)(letter - letters) % 9;
        if (axis < TRUEPATH_JOINTS) axis_of_joint[joints] = (uint8_t)axis;
        seen |= 1u << axis;
        joints++;
    }
    if ((seen & 7) == 7) return 0;
    rtapi_print_msg(RTAPI_MSG_ERR, "truepath: coordinates=%s: the axis letter of each joint, X, Y and Z among them, at most "
        "%d, for instance XYZ or XYYZ\n", coordinates, TRUEPATH_JOINTS);
    return -EINVAL;
}

// The parameters, for the configuration thread.
static void limits(struct truepath_limits *to) {
    for (int j = 0; j < joints; j++) {
        to->least[j] = component->_min_limit[j];
        to->greatest[j] = component->_max_limit[j];
        to->velocity[j] = component->_max_correction_vel[j];
        to->acceleration[j] = component->_max_correction_accel[j];
    }
    to->nm_per_unit = component->nm_per_unit;
}

// Route A. With a port set, Route B takes its place: the same pins, the setpoint of the same rules, the correction of the
// board.
FUNCTION(feedback) {
    (void)period;
    double measured[TRUEPATH_JOINTS] = {0}, plain[TRUEPATH_JOINTS];
    for (int j = 0; j < joints; j++) measured[j] = *hal->_motor_pos_fb_in[j];
    if (*port) board_feedback(&board, measured, plain);
    else truepath_pc_feedback(sides.servo, measured, plain);
    for (int j = 0; j < joints; j++) *hal->_motor_pos_fb[j] = plain[j];
    fed = true;
}

FUNCTION(command) {
    struct truepath_inputs in = {0};
    struct truepath_outputs out;
    read_pins(hal, period, &in);
    if (*port) {
        board_command(&board, &in, &out, hal->link_wait);
        write_link(hal, &board);
    } else {
        truepath_pc_command(sides.servo, &in, &out);
    }
    if (!fed) out.forward = 0;
    fed = false;
    write_pins(hal, &out);
    bool reload = *hal->reload;
    if (reload && !reload_before) atomic_fetch_add(&config.reloads, 1);
    reload_before = reload;
}

int rtapi_app_main(void) {
    config.image = image;
    config.ledger = ledger;
    config.keys = keys;
    config.limits = limits;
    int r = read_coordinates();
    board.axis_of_joint = axis_of_joint;
    board.limits = limits;
    board.axes = (unsigned)axes;
    if (!r && !*port) r = config_open(&config, &block, axis_of_joint, &sides);
    if (r) return r;
    comp_id = hal_init("truepath");
    if (comp_id < 0) return comp_id;
    r = export("truepath", 0, joints);
    if (!r) {
        component = __comp_first_inst;
        config.error = &component->image_error;
        *component->image_open = !*port && !config_has_keys(&config);
        board.clamp_nm = &component->link_clamp_nm;
        r = *port ? board_start(&board, port, (unsigned)baud) : config_start(&config);
    }
    if (r) {
        hal_exit(comp_id);
        return r;
    }
    rtapi_print_msg(RTAPI_MSG_INFO, "truepath: coordinates=%s, trivial kinematics only\n", coordinates);
    return hal_ready(comp_id);
}

void rtapi_app_exit(void) {
    if (*port) board_stop(&board);
    else config_stop(&config);
    hal_exit(comp_id);
    config_free(&config);
}
