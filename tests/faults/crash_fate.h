/* crash_fate.h - a power cut that loses random parts: of sectors, sizes and names, a share each is kept,
 * from none to all of them. The same seed makes the same decisions. */
#ifndef TESTS_FAULTS_CRASH_FATE_H
#define TESTS_FAULTS_CRASH_FATE_H

#include "tests/faults/crash_state.h"

enum { RECIPE_BYTES = 3000 };

struct random_fate {
    struct crash_fate fate; /* the first member */
    uint64_t seed;
    uint32_t share[3]; /* per mille, of sectors, sizes, names */
    bool half_renames; /* a rename may leave both names, or none */
    /* what was lost, for people */
    const struct crash *crash;
    const struct power_log *log;
    char recipe[RECIPE_BYTES];
    size_t length, last;
};

void random_fate_init(struct random_fate *f, uint64_t seed, const struct crash *crash,
                      const struct power_log *log);

#endif
