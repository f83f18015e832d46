// SPDX-License-Identifier: GPL-2.0-or-later
//
// The configuration thread: reads the image, verifies whose it is, keeps the ledger on the disk. It has the scheduling of a normal program and shares
// nothing with the servo thread but the queues of truepath.h and the counter of reloads.

#ifndef TRUEPATH_CONFIG_THREAD_H
#define TRUEPATH_CONFIG_THREAD_H

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <time.h>

#include "files.h"
#include "rtapi.h"
#include "truepath.h"

enum {
    // An image of the most nodes is smaller.
    CONFIG_IMAGE_BYTES = 64 << 20,
    // In use, waiting to be used, and come back: there are never more.
    CONFIG_IMAGES = 3,
    // A few public keys with what is said about them.
    CONFIG_KEYS_BYTES = 64 << 10,
    // Between two rounds. An arming waits for one of them and for the disk.
    CONFIG_ROUND_NS = 5000000,
    // All memory of a real-time process is locked, the thread's stack as well.
    CONFIG_STACK_BYTES = 256 << 10,
};

// Values of image-error besides those of the library.
enum { CONFIG_NOT_READ = 64 };

struct config {
    const char *image, *ledger, *keys;
    struct truepath_config *side;
    // The parameters of the component, as they are now.
    void (*limits)(struct truepath_limits *limits);
    // Pin image-error: HAL moves it when it is connected.
    hal_u32_t *volatile *error;
    atomic_uint reloads;
    atomic_bool end;
    pthread_t thread;
    unsigned char *images[CONFIG_IMAGES];
    // The ledger that is written next.
    unsigned char file[TRUEPATH_LEDGER_BYTES];
};

static atomic_bool config_halted;

// Where a panic within the verification of a signature ends, should there be one: see abi/src/panic.rs.
_Noreturn void truepath_halt(void) {
    atomic_store(&config_halted, true);
    for (;;) pause();
}

static void config_forget(struct config *config, const unsigned char *image) {
    for (int i = 0; i < CONFIG_IMAGES; i++) {
        if (config->images[i] != image) continue;
        free(config->images[i]);
        config->images[i] = NULL;
    }
}

// Keeps the memory of an image that is lent; false when there is no place, which does not happen.
static bool config_keep(struct config *config, unsigned char *image) {
    for (int i = 0; i < CONFIG_IMAGES; i++) {
        if (config->images[i]) continue;
        config->images[i] = image;
        return true;
    }
    return false;
}

// Writes it; `then`: what follows when that fails.
static void config_write_ledger(struct config *config, size_t count, const char *then) {
    int r = *config->ledger ? write_file(config->ledger, config->file, count) : -ENOENT;
    if (r) rtapi_print_msg(RTAPI_MSG_ERR, "truepath: ledger %s: %s; %s\n",
        *config->ledger ? config->ledger : "(no file is named)", strerror(-r), then);
    truepath_pc_written(config->side, !r);
}

// Writes the counter of a signed image into the ledger, before the image is offered. Without it the offer is refused.
static void config_count(struct config *config, const unsigned char *bytes, size_t count) {
    size_t used = truepath_pc_count(config->side, bytes, count, config->file);
    if (used) config_write_ledger(config, used, "the signed image is not used");
}

// Offers what the image file holds now, or that there is none. `first`: a missing file is no error.
static void config_offer(struct config *config, const struct truepath_limits *limits, bool first) {
    unsigned char *bytes = NULL;
    size_t count = 0;
    int r = *config->image ? read_file(config->image, CONFIG_IMAGE_BYTES, false, &bytes, &count) : -ENOENT;
    uint32_t error = 0;
    if (r) {
        error = first && r == -ENOENT ? 0 : CONFIG_NOT_READ;
        if (error) rtapi_print_msg(RTAPI_MSG_ERR, "truepath: image %s: %s\n", config->image, strerror(-r));
    } else if (!config_keep(config, bytes)) {
        error = CONFIG_NOT_READ;
        free(bytes);
        bytes = NULL;
    } else if (config_count(config, bytes, count), (error = truepath_pc_offer(config->side, limits, bytes, count))) {
        rtapi_print_msg(RTAPI_MSG_ERR, "truepath: image %s is not used: error %u, see docs/linuxcnc.md\n", config->image, error);
        config_forget(config, bytes);
        bytes = NULL;
    }
    // Never an image that is not the one in the file.
    if (!bytes) truepath_pc_offer(config->side, limits, NULL, 0);
    **config->error = error;
}

static void *config_run(void *argument) {
    struct config *config = argument;
    struct truepath_limits used = {0}, now;
    unsigned seen = 0;
    bool first = true;
    const struct timespec round = {0, CONFIG_ROUND_NS};
    while (!atomic_load(&config->end)) {
        const unsigned char *back;
        while ((back = truepath_pc_returned(config->side))) config_forget(config, back);
        size_t count = truepath_pc_spend(config->side, config->file);
        if (count) config_write_ledger(config, count, "nothing can be armed");
        unsigned reloads = atomic_load(&config->reloads);
        memset(&now, 0, sizeof now);
        config->limits(&now);
        if ((first || reloads != seen || memcmp(&now, &used, sizeof now)) && truepath_pc_ready(config->side)) {
            config_offer(config, &now, first);
            used = now;
            seen = reloads;
            first = false;
        }
        nanosleep(&round, NULL);
    }
    return NULL;
}

static bool config_has_keys(const struct config *config) {
    return *config->keys && strcmp(config->keys, "none");
}

// Reads the keys, if a file of them is named. 0 or a negative errno: with keys that cannot be had nothing is corrected, rather
// than by anybody's image.
static int config_trust(struct config *config) {
    if (!config_has_keys(config)) {
        rtapi_print_msg(RTAPI_MSG_WARN, "truepath: OPEN: no file of keys is named ([TRUEPATH]KEYS), every image is taken\n");
        return 0;
    }
    unsigned char *file = NULL;
    size_t count = 0;
    int r = read_file(config->keys, CONFIG_KEYS_BYTES, true, &file, &count);
    if (r) {
        rtapi_print_msg(RTAPI_MSG_ERR, "truepath: keys %s: %s%s\n", config->keys, strerror(-r), r == -EPERM ? ": it has to "
            "belong to root, or to the user who starts LinuxCNC, and nobody else may write to it (chmod go-w)" : "");
        return r;
    }
    uint32_t line = truepath_pc_trust(config->side, file, count);
    free(file);
    if (line == UINT32_MAX) rtapi_print_msg(RTAPI_MSG_ERR, "truepath: keys %s holds no key\n", config->keys);
    else if (line) rtapi_print_msg(RTAPI_MSG_ERR, "truepath: keys %s: line %u is no public key of truepath key new, one that "
        "cannot be used, or one more than 4\n", config->keys, line);
    return line ? -EINVAL : 0;
}

// Reads the ledger and fills the block. 0 or a negative errno.
static int config_open(struct config *config, struct truepath_block *block, const uint8_t *axes, struct truepath_sides *sides) {
    unsigned char *file = NULL;
    size_t count = 0;
    int r = *config->ledger ? read_file(config->ledger, TRUEPATH_LEDGER_BYTES, false, &file, &count) : -ENOENT;
    if (r && r != -ENOENT) {
        rtapi_print_msg(RTAPI_MSG_ERR, "truepath: ledger %s: %s\n", config->ledger, strerror(-r));
        return r;
    }
    // Without a file it is the first start. An empty one is what is left of one.
    uint32_t wrong = !r && !count ? 1 : truepath_pc_new(block, axes, file, count, sides);
    free(file);
    if (wrong) {
        rtapi_print_msg(RTAPI_MSG_ERR, "truepath: ledger %s is %s. It remembers which parts were corrected: move it away "
            "only if none of them is machined again\n", config->ledger, wrong == 1 ? "damaged" : "of another version");
        return -EINVAL;
    }
    if (r && *config->ledger) rtapi_print_msg(RTAPI_MSG_WARN, "truepath: no ledger %s: no part was corrected on this machine "
        "before, as far as is known\n", config->ledger);
    config->side = sides->config;
    return config_trust(config);
}

static int config_start(struct config *config) {
    pthread_attr_t attributes;
    struct sched_param normal = {0};
    sigset_t all, before;
    sigfillset(&all);
    pthread_attr_init(&attributes);
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, SCHED_OTHER);
    pthread_attr_setschedparam(&attributes, &normal);
    pthread_attr_setstacksize(&attributes, CONFIG_STACK_BYTES);
    // Signals are for the program that loads the component.
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int r = pthread_create(&config->thread, &attributes, config_run, config);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    if (r) rtapi_print_msg(RTAPI_MSG_ERR, "truepath: no thread: %s\n", strerror(r));
    return -r;
}

// Ends the thread, which takes as long as the disk.
static void config_stop(struct config *config) {
    atomic_store(&config->end, true);
    if (!atomic_load(&config_halted)) pthread_join(config->thread, NULL);
}

// Gives the memory of the images back, once the servo thread calls the component no more.
static void config_free(struct config *config) {
    for (int i = 0; i < CONFIG_IMAGES; i++) free(config->images[i]);
}

#endif
