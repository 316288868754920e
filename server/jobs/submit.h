/* submit.h - carries out changes (changes/change.h): applies each to its set, appends it to the log, and answers. Commands and
 * followers use it; on a reactor. */
#pragma once

#include "server/changes/change.h"
#include "server/jobs/job.h"

/* A change on its way: a job, if it edits points or values. */
struct submission {
    struct job job;
    struct change change; /* owns */
    size_t base;          /* bytes that are reserved before it splits constraints; 0: it does not */
    size_t expected;      /* bytes that are prepared for it (page_cache.h), until it ends */
    struct list *temporary; /* the new set is one of these; NULL: it is not temporary */
};

/* A change of the set of that name, with everything else 0. It moves to submit, or is freed by job_free. NULL: out of
 * memory, which is the answer. */
struct submission *submission_new(struct server *s, struct answer *a, enum change_code code,
                                  const struct word *set);

/* Whether a reactor that shares the world may submit such a change of n items, within the gate of the set. Then nothing but the set
 * and the log changes, unless the change turns out to need a worker. */
bool submit_shares(const struct dataset *set, enum change_code code, size_t n);
/* The same of any reactor. False: it shares the world, and the request is carried out again when it is alone (world_alone). */
bool submit_may(struct answer *a, const struct dataset *set, enum change_code code, size_t n);

/* Checks the limits and the memory for a change of the set, NULL for a new one; a long job reserves that memory. The change needs
 * only its sizes yet: n, and the number of columns. False: the ERR line has been written, or the request waits. */
bool submit_reserve(struct server *s, struct answer *a, const struct dataset *set,
                    struct submission *x);

/* What submit_reserve would reserve for a change that makes a new set and has all it needs; for callers that cannot wait. */
size_t submit_memory_of_new(const struct server *s, const struct change *c);

/* Carries out a change of the set, which must have no writer; NULL: there is none yet. Answers `OK 0`, the facts of the kind of
 * change, and the version. */
void submit(struct server *s, struct answer *a, struct dataset *set, struct submission *x);

/* The change has been applied to the set, which gets a new version; it is appended to the log unless it is there already. */
void submit_commit(struct server *s, struct dataset *set, struct change *c);

/* Carries out a change that needs no job and no answer: of a kind without `edit`. A set that is dropped is freed. */
void submit_at_once(struct server *s, struct dataset *set, enum change_code code, double a);
