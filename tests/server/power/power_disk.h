/* power_disk.h - the disk of a test with power cuts: what is loaded into a daemon so that it writes
 * down what it does (tests/faults/power_shim.c, found through POWER_SHIM). */
#ifndef TESTS_SERVER_POWER_DISK_H
#define TESTS_SERVER_POWER_DISK_H

#include <stddef.h>
#include <stdint.h>

struct power_disk {
    const char *root, *ops;           /* what is watched, the file for the operations */
    size_t first;                     /* so many of these are there already */
    unsigned crash;                   /* the process ends with so many more; 0: it does not */
    unsigned sync_fails, write_fails; /* per mille */
    unsigned stall_us;
    unsigned long space;
    uint64_t seed;
};

/* Puts it into the environment: to be called in the child, before exec. */
void power_disk_load(const struct power_disk *d);

/* The status with which a process ends by .crash. */
enum { POWER_CRASHED = 99 };

#endif
