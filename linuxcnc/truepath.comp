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
pin in bit trivial-kinematics "From truepath-desk: kinematics are trivial";

// Frame of the program and identity of what runs, from truepath-desk.
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
pin out u32 state = 1 "0 off, 1 bypass, 2 armed, 3 active, 4 hold, 5 fault";
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
pin out u32 node "Place on the path: node of the image";
pin out u32 sequence "Number of the cycle";
pin out u32 flags "Flags that the core was given in this cycle";
pin out bit feed-inhibit "To motion.feed-inhibit: a probing move waits until the correction is out";
pin out bit link-lost "The board does not answer";
pin out u32 link-misses "Answers that did not come";
pin out u32 link-late "Answers that came too late";

function feedback fp "Before motion-controller: takes the correction out of the feedback";
function command fp "After motion-controller: adds the correction to the commanded position";
;;

static char *coordinates = "XYZ";
RTAPI_MP_STRING(coordinates, "axis letter of each joint, for instance XYZ, or XYYZ for a gantry");
static char *image = "";
RTAPI_MP_STRING(image, "file of the correction image");
static char *ledger = "";
RTAPI_MP_STRING(ledger, "file that remembers which parts were armed");
static char *port = "";
RTAPI_MP_STRING(port, "serial port of the coprocessor; empty: the correction is computed here");
static int baud = 921600;
RTAPI_MP_INT(baud, "bits per second on that port");
static int axes = 3;
RTAPI_MP_INT(axes, "axes in a frame on that port");

#define FUNCTION(name) static void name(struct __comp_state *hal, long period)

enum { MOST_JOINTS = 6 };
static int joints;

// Joints in `coordinates`, or a negative errno.
static int count_joints(void) {
    int count = 0;
    for (const char *c = coordinates; *c; c++) {
        if (*c == ' ' || *c == ',') continue;
        if (!strchr("XYZABCUVWxyzabcuvw", *c) || count == MOST_JOINTS) {
            rtapi_print_msg(RTAPI_MSG_ERR, "truepath: coordinates=%s: one axis letter for each of at most %d joints is "
                "expected, for instance XYZ\n", coordinates, MOST_JOINTS);
            return -EINVAL;
        }
        count++;
    }
    return count ? count : -EINVAL;
}

FUNCTION(feedback) {
    (void)period;
    for (int j = 0; j < joints; j++) *hal->_motor_pos_fb[j] = *hal->_motor_pos_fb_in[j];
}

FUNCTION(command) {
    (void)period;
    for (int j = 0; j < joints; j++) {
        *hal->_motor_pos_cmd[j] = *hal->_motor_pos_cmd_in[j];
        *hal->_amp_enable[j] = *hal->_amp_enable_in[j];
    }
    *hal->sequence += 1;
}

int rtapi_app_main(void) {
    joints = count_joints();
    if (joints < 0) return joints;
    comp_id = hal_init("truepath");
    if (comp_id < 0) return comp_id;
    int r = export("truepath", 0, joints);
    if (r != 0) {
        hal_exit(comp_id);
        return r;
    }
    rtapi_print_msg(RTAPI_MSG_INFO, "truepath: coordinates=%s, trivial kinematics only\n", coordinates);
    return hal_ready(comp_id);
}

void rtapi_app_exit(void) {
    hal_exit(comp_id);
}
