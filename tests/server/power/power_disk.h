/* power_disk.h - the disk of a test with power cuts: a library loaded into a daemon that records its
 * operations on files (tests/faults/power_shim.c, found through POWER_SHIM). */
#pragma once

#include <stddef.h>
#include <stdint.h>

struct power_disk {
    const char *root, *ops;           /* the watched directory, the file for the operations */
    size_t first;                     /* the number of operations in the file already */
    unsigned crash;                   /* the process ends after this many more; 0: never */
    unsigned sync_fails, write_fails; /* per mille */
    unsigned stall_us;
    unsigned long space;
    uint64_t seed;
};

/* Puts it into the environment; to be called in the child, before exec. */
void power_disk_load(const struct power_disk *d);

/* The exit status of a process that .crash ended. */
enum { POWER_CRASHED = 99 };
