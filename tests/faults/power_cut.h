/* power_cut.h - the directories that a power cut may leave behind.
 *
 * A sync covers operations of the process (power_log.h) that were complete before it began, as in POSIX. The sync of a file
 * covers its data and its size, the sync of a directory the names in it, and nothing else.
 * Covered operations are on the disk. Of the others, any part may be on the disk or not, as a
 * struct power_cut_fate decides:
 *
 *     a sector   each 512 bytes that a write has touched, independent of the rest of the write
 *     a size     that a write, a truncation or an allocation has given to a file
 *     a name     that was created, renamed, linked or removed; a rename is two: its new name and
 *                its old one
 *
 * A part that is not on the disk is as it was before: a sector has its old content, or zeros if it had none.
 *
 * The order in which the parts reach the disk needs no separate decision. If two of them concern the same sector, size
 * or name, the later one hides the earlier one; the opposite order looks the same as a
 * state without the later one.
 *
 * Operations that a failed sync should have covered are never covered. No later sync covers them, because the kernel
 * considers them clean [Rebello et al., "Can Applications Recover from fsync Failures?", ATC 2020]. */
#pragma once

#include "tests/faults/power_log.h"
#include "tests/faults/tree.h"

enum { POWER_CUT_SECTOR = 512 };

enum power_cut_part { PART_SECTOR, PART_SIZE, PART_NAME, PART_OLD_NAME };

/* Decides about a part of the log's operation `number`: whether it is on the disk. */
struct power_cut_fate {
    bool (*keeps)(struct power_cut_fate *fate, size_t number, enum power_cut_part part,
                  uint64_t sector);
};

struct power_cut;

/* Prepares the states of a directory that contained `before`, after the operations of a log; both are
 * borrowed. */
struct power_cut *power_cut_new(const struct tree *before, const struct power_log *log);
void power_cut_free(struct power_cut *c);

/* The directory if the power fails after the first `cut` operations. */
struct tree power_cut_state(struct power_cut *c, size_t cut, struct power_cut_fate *fate);

/* The directory if the power does not fail. */
struct tree power_cut_none(struct power_cut *c, size_t cut);

/* A name of the file or directory that operation `number` concerns; "" if there is none. */
const char *power_cut_subject(const struct power_cut *c, size_t number);
