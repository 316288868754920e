/* power_disk.c - see power_disk.h. */
#include "tests/server/power/power_disk.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void set(const char *name, uint64_t v)
{
    char text[32];
    snprintf(text, sizeof text, "%" PRIu64, v);
    setenv(name, text, 1);
}

void power_disk_load(const struct power_disk *d)
{
    setenv("LD_PRELOAD", getenv("POWER_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("TSAN_OPTIONS", "atexit_sleep_ms=0", 0);
    setenv("POWER_ROOT", d->root, 1);
    setenv("POWER_LOG", d->ops, 1);
    set("POWER_FIRST", d->first);
    set("POWER_CRASH", d->crash);
    set("POWER_SEED", d->seed);
    set("POWER_SYNC_FAILS", d->sync_fails);
    set("POWER_WRITE_FAILS", d->write_fails);
    set("POWER_STALL_US", d->stall_us);
    set("POWER_SPACE", d->space);
}
