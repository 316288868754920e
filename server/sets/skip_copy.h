/* skip_copy.h - copies of sets without the points that lack a value of a field (MISSING skip), kept for the next request.
 *
 * A set has at most one copy for each of its fields. The copy is a version of its own, which nobody edits. It is made by a job
 * (missing_skip.h), of one moment, while the set can be edited:
 *
 *      set -> copy of z: version, of the moment 7; build of the moment 9; queue of requests that wait for the build
 *          -> copy of t: version, of the moment 8
 *
 * A copy is as the set is now while neither the points and constraints nor the field have been edited since its moment. A request
 * that has waited for the build may use an older one, of a moment after it came: so edits that never end do not keep it waiting.
 *
 * Copies are freed when they are out of date, when the set goes, and when memory is short. All functions: the reactor is alone in
 * the world, or it only reads. */
#pragma once

#include "core/delaunay_constraints.h"
#include "server/sets/dataset.h"

struct skip_copy_moment {
    uint64_t edits, field_edits; /* dt_edits, dt_field_edits */
    uint32_t field;              /* dt_field_number */
    int64_t at_ns;               /* 0: there was none */
};

struct skip_copy {
    struct list_link link;  /* first: in registry.skip_copies */
    struct skip_copy *next; /* of the same set */
    struct dataset *set; /* borrows; NULL: the set has gone, and the end of the build frees this */
    char field[DT_FIELD_NAME + 1];
    struct skip_copy_moment of; /* the moment of the last build that has ended, */
    enum dt_status status;      /* its outcome, */
    struct dt_crossed crossed;  /* of DT_CROSSES, */
    /* and its result: owns a reference; NULL unless the outcome is DT_OK */
    struct version *version;
    struct skip_copy_moment build; /* of the build that is under way; at_ns 0: none is */
    atomic_bool *cancel;           /* borrows; of that build */
    struct request_queue queue;    /* of requests that wait for its end */
};

/* The copy for the field, which may be out of date or not made yet; NULL: none. Cost: the number of copies. */
struct skip_copy *skip_copy_find(const struct dataset *set, const struct dt_field *f);

/* Whether the outcome is that of the set as it is now, or was at `since_ns` or later; 0: now. */
bool skip_copy_serves(const struct skip_copy *c, const struct dt_field *f, int64_t since_ns);

/* A build of the set as it is now begins; none is under way. Its flag must last until skip_copy_end. NULL: out of memory. */
struct skip_copy *skip_copy_begin(struct registry *r, struct dataset *set, const struct dt_field *f,
                                  atomic_bool *cancel);
/* It has ended; dt moves here. Requests that wait are called. NULL and DT_OK: it was not carried out. */
void skip_copy_end(struct registry *r, struct skip_copy *c, enum dt_status status, struct dt *dt,
                   const struct dt_crossed *crossed);

/* registry.forget. Requests that wait are woken. */
void skip_copy_forget(struct registry *r, struct dataset *set);

/* Frees copies that are not in use; false: there are none. */
bool skip_copy_release(struct registry *r);

/* Frees those that are out of date, or all if memory is short, and cancels builds for which nobody waits. To be called once a
 * second. */
void skip_copy_tidy(struct registry *r);

/* The bytes of the copies of a set. */
size_t skip_copy_memory(const struct dataset *set);
