/* power_cut_random.h - a power cut that loses random parts: of sectors, sizes and names, a share each is kept,
 * from none to all of them. The same seed makes the same decisions. */
#pragma once

#include "tests/faults/power_cut.h"

enum { RECIPE_BYTES = 3000 };

struct random_fate {
    struct power_cut_fate fate; /* the first member */
    uint64_t seed;
    uint32_t share[3]; /* per mille, of sectors, sizes, names */
    bool half_renames; /* a rename may leave both names, or none */
    /* what was lost, for people */
    const struct power_cut *crash;
    const struct power_log *log;
    char recipe[RECIPE_BYTES];
    size_t length, last;
};

void random_fate_init(struct random_fate *f, uint64_t seed, const struct power_cut *crash,
                      const struct power_log *log);
