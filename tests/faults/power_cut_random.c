/* power_cut_random.c - see power_cut_random.h. */
#include "tests/faults/power_cut_random.h"

#include "tests/faults/chance.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

/* A number that depends only on the seed and the arguments. */
static uint32_t number_for(const struct random_fate *f, size_t op, uint64_t what)
{
    uint64_t z = f->seed + 0x9E3779B97F4A7C15u * (op + 1);
    return (uint32_t)(chance_mix(chance_mix(z) + what) % 1000);
}

__attribute__((format(printf, 2, 3))) static void note(struct random_fate *f, const char *format,
                                                       ...)
{
    va_list ap;
    va_start(ap, format);
    if (f->length < sizeof f->recipe - 1)
        f->length +=
            (size_t)vsnprintf(f->recipe + f->length, sizeof f->recipe - f->length, format, ap);
    va_end(ap);
}

static void tell_loss(struct random_fate *f, size_t op, enum power_cut_part part, uint64_t sector)
{
    static const char *const kind[] = {"open",   "write", "truncate", "extend", "mkdir",
                                       "rename", "link",  "unlink",   "sync",   "sent"};
    if (f->last != op)
        note(f, "%s%zu: %s %s", f->length > 0 ? "; " : "", op, kind[f->log->op[op].kind],
             power_cut_subject(f->crash, op));
    f->last = op;
    if (part == PART_SECTOR)
        note(f, " [%" PRIu64 "]", sector);
    else
        note(f, "%s", part == PART_SIZE ? " size" : part == PART_NAME ? " name" : " old name");
}

/* Either a whole write is kept or lost, or each of its sectors separately. */
static bool keeps_sector(const struct random_fate *f, size_t op, uint64_t sector)
{
    bool torn = number_for(f, op, 1) < 500;
    return number_for(f, op, torn ? 16 + sector : 2) < f->share[PART_SECTOR];
}

static bool keeps(struct power_cut_fate *fate, size_t op, enum power_cut_part part, uint64_t sector)
{
    struct random_fate *f = (struct random_fate *)(void *)fate;
    bool kept;
    if (part == PART_SECTOR)
        kept = keeps_sector(f, op, sector);
    else if (part == PART_SIZE)
        kept = number_for(f, op, 3) < f->share[PART_SIZE];
    else
        kept = number_for(f, op, part == PART_OLD_NAME && f->half_renames ? 5 : 4) <
               f->share[PART_NAME];
    if (!kept)
        tell_loss(f, op, part, sector);
    return kept;
}

void random_fate_init(struct random_fate *f, uint64_t seed, const struct power_cut *crash,
                      const struct power_log *log)
{
    static const uint32_t share[] = {0, 0, 50, 200, 500, 800, 950, 1000, 1000};
    enum { SHARES = sizeof share / sizeof share[0] };
    struct chance c = {seed};
    *f = (struct random_fate){.fate = {keeps}, .seed = seed, .crash = crash, .log = log};
    f->last = SIZE_MAX;
    bool alike = chance_below(&c, 2) == 0;
    for (int i = 0; i < 3; i++)
        f->share[i] = i > 0 && alike ? f->share[0] : share[chance_below(&c, SHARES)];
    f->half_renames = chance_below(&c, 8) == 0;
}
