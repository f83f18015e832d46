// SPDX-License-Identifier: GPL-2.0-or-later
//
// Whole files of the configuration thread, the only one to call this: read at once, written so that there is the new file or the
// one before.

#ifndef TRUEPATH_FILES_H
#define TRUEPATH_FILES_H

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Who may have written a file: root or who started LinuxCNC, and nobody else.
static bool is_own(const struct stat *about) {
    return (about->st_uid == 0 || about->st_uid == getuid()) && !(about->st_mode & (S_IWGRP | S_IWOTH));
}

// Reads a file of at most `most` bytes into memory that the caller frees; `own`: -EPERM unless it is_own. 0 or a negative
// errno.
static int read_file(const char *path, size_t most, bool own, unsigned char **bytes, size_t *count) {
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) return -errno;
    struct stat about;
    int r = fstat(fd, &about) ? -errno : !S_ISREG(about.st_mode) ? -EINVAL : about.st_size > (off_t)most ? -EFBIG : 0;
    if (!r && own && !is_own(&about)) r = -EPERM;
    size_t size = r ? 0 : (size_t)about.st_size;
    unsigned char *into = r ? NULL : malloc(size + 1);
    if (!r && !into) r = -ENOMEM;
    size_t got = 0;
    while (!r && got < size) {
        ssize_t n = read(fd, into + got, size - got);
        if (n > 0) got += (size_t)n;
        else if (n == 0) r = -EIO; // It was cut off while it was read.
        else if (errno != EINTR) r = -errno;
    }
    close(fd);
    if (r) {
        free(into);
        return r;
    }
    *bytes = into;
    *count = got;
    return 0;
}

static int write_all(int fd, const unsigned char *bytes, size_t count) {
    while (count) {
        ssize_t n = write(fd, bytes, count);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return n ? -errno : -EIO;
        bytes += n;
        count -= (size_t)n;
    }
    return 0;
}

// The folder of a file, so that a renamed file in it is on the disk too.
static int sync_folder(const char *path) {
    static char folder[PATH_MAX];
    const char *slash = strrchr(path, '/');
    int length = slash ? (int)(slash - path) : 0;
    snprintf(folder, sizeof folder, "%.*s", length ? length : 1, length ? path : slash ? "/" : ".");
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) return -errno;
    int r = fsync(fd) ? -errno : 0;
    close(fd);
    return r;
}

// Writes a file beside it, syncs, renames. On an error the file before is still there. 0 or a negative errno.
static int write_file(const char *path, const unsigned char *bytes, size_t count) {
    static char beside[PATH_MAX];
    if (snprintf(beside, sizeof beside, "%s.new", path) >= (int)sizeof beside) return -ENAMETOOLONG;
    int fd = open(beside, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (fd < 0) return -errno;
    int r = write_all(fd, bytes, count);
    if (!r && fsync(fd)) r = -errno;
    if (close(fd) && !r) r = -errno;
    if (!r && rename(beside, path)) r = -errno;
    return r ? r : sync_folder(path);
}

#endif
