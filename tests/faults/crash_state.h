/* crash_state.h - the directories that a power cut may leave behind.
 *
 * Of what a process has done to its files (power_log.h), a sync covers what came before it began:
 * that of a file its data and its size, that of a directory the names in it, and nothing else, as
 * POSIX has it. What is covered is on the disk. Of the rest any part may be there or not, as
 * somebody decides (struct crash_fate):
 *
 *     a sector   each 512 bytes that a write has touched, torn out of the write
 *     a size     that a write, a truncation or an allocation has given to a file
 *     a name     that was created, renamed, linked or removed; a rename is two: its new name and
 *                its old one
 *
 * What is not there is as it was before: a sector has its old content, or zeros if it had none.
 *
 * The order in which they get to the disk needs no decision of its own: where two of them concern
 * the same sector, size or name, the later one hides the earlier one; in the other order it would
 * look as if the later one were missing.
 *
 * After a sync that has failed, what it should have covered is never covered, by no later sync
 * either: the system takes it for clean [Rebello et al., "Can Applications Recover from fsync
 * Failures?", ATC 2020]. */
#ifndef TESTS_FAULTS_CRASH_STATE_H
#define TESTS_FAULTS_CRASH_STATE_H

#include "tests/faults/power_log.h"
#include "tests/faults/tree.h"

enum { CRASH_SECTOR = 512 };

enum crash_part { PART_SECTOR, PART_SIZE, PART_NAME, PART_OLD_NAME };

/* Decides about a part of the log's operation `number`: whether it is on the disk. */
struct crash_fate {
    bool (*keeps)(struct crash_fate *fate, size_t number, enum crash_part part, uint64_t sector);
};

struct crash;

/* What a log says of a directory that held `before`; both are borrowed. */
struct crash *crash_new(const struct tree *before, const struct power_log *log);
void crash_free(struct crash *c);

/* What is left if the power fails after the first `cut` operations. */
struct tree crash_state(struct crash *c, size_t cut, struct crash_fate *fate);

/* What the files hold as long as the power does not fail. */
struct tree crash_none(struct crash *c, size_t cut);

/* The file or directory that operation `number` is about, as a name that it had; "" if there is none.
 */
const char *crash_subject(const struct crash *c, size_t number);

#endif
