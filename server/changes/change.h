/* change.h - a change of a set in one value: the edit, its record in the log, and its outcome.
 *
 *     a command      reads a change and submits it (jobs/submit.h), which applies it and appends it to the log
 *     a restart      decodes changes from records and applies them (disk/replay.h)
 *     a follower     decodes changes from its leader's records and submits them (follow/apply.h)
 *
 * Each kind of change is a row of a table, `change_kinds`. The records of a LOAD, which are one change, are joined by an assembly
 * (assembly.h). */
#pragma once

#include "core/delaunay_constraints.h"
#include "proto/records/record.h"
#include "server/changes/pslg.h"
#include "server/sets/dataset.h"

#define CHANGE_ANY UINT32_MAX   /* as `first`: the next id, whatever it is */
#define CHANGE_LATEST_MS 0x1p53 /* since 1970; the last time at which a set may be dropped */

enum change_code {
    CHANGE_NONE, /* no kind */
    CHANGE_CREATE,
    CHANGE_DROP,
    CHANGE_EXPIRE,
    CHANGE_ADD,
    CHANGE_DELETE,
    CHANGE_MOVE,
    CHANGE_SET, /* values of ids in any order */
    CHANGE_RUN, /* values of ids that follow each other */
    CHANGE_FDROP,
    CHANGE_TRIANGULATE,
    CHANGE_CONSTRAIN,
    CHANGE_RELEASE,
    CHANGE_CASCADE, /* CHANGE_DELETE, and the constraints at these points are released */
    CHANGE_MOVES,   /* of several points at once */
    CHANGE_PSLG,    /* points, and constraints between them and others */
    CHANGE_KINDS
};

/* Each kind uses some of the arguments:
 *
 *     CREATE    a: the tolerance
 *     EXPIRE    a: the time, as in RECORD_EXPIRE
 *     ADD       first: the id that must be the next one, or CHANGE_ANY; afterwards the id of the first point;
 *               n points, in rows, or in points and columns
 *     DELETE    n ids
 *     MOVE      first: the id; a, b: the new place
 *     SET       field, n pairs
 *     RUN       a column of n values
 *     FDROP     field
 *     CONSTRAIN n constraints; or rows, which are n pairs of ids, and first: what they are, as in record_constraint
 *     RELEASE   a: which, as in RECORD_RELEASE; first, or the same as CONSTRAIN
 *     CASCADE   n ids
 *     MOVES     n moves
 *     PSLG      as ADD, and constraints (pslg.h) */
struct change {
    const struct change_kind *kind;
    struct name set;
    struct name field; /* the columns have their own names */
    uint32_t first, n;
    double a, b;
    double *rows; /* owns, from dt_pages_grow: points, each with its values; pairs; or NULL */
    union { /* owns n, as its kind says; ids, pairs and moves from malloc, others from dt_pages_grow */
        void *items;
        struct dt_point *points;
        uint32_t *ids;
        struct record_value *pairs;
        struct record_constraint *constraints;
        struct record_move *moves;
    };
    struct columns *columns; /* owns */
    struct pslg *pslg;       /* owns */
    struct dt_pages *pages;  /* borrows; where large arrays come from; NULL: the system */
    /* the outcome, if it has been applied: */
    uint64_t lsn; /* of its record in the log; 0: it has none, or none yet */
    struct dt_added added;
    uint32_t deleted, missing; /* missing: of DT_NOPOINT, the first id that does not exist */
    size_t constrained;        /* how many constraints it has declared, or released */
    struct dt_crossed crossed; /* of DT_CROSSES; of DT_NOCONSTRAINT, `one` */
};

enum {
    CHANGE_EXISTING = 1, /* the set must be there */
    CHANGE_NEW = 2,      /* the set must not be there */
    CHANGE_GROWS = 4,    /* the points get the next ids of the set; a missing set is created */
    /* it makes the set smaller: possible as long as there is any space on the disk */
    CHANGE_FREES = 8
};

/* The part of the change that a record's items hold. */
enum change_items {
    ITEMS_NONE,
    ITEMS_POINTS,
    ITEMS_IDS,
    ITEMS_PAIRS,
    ITEMS_COLUMN,
    ITEMS_CONSTRAINTS,
    ITEMS_MOVES,
    ITEMS_PSLG /* these and points are in the records of a LOAD */
};

struct change_kind {
    enum record_type record; /* 0: it is always a LOAD */
    const char *what;        /* for progress comments; NULL: it is quick */
    unsigned flags;
    enum change_items items;
    bool has_field;
    const char *undone; /* what an error about a missing point adds */
    /* Edits the set's points or values, all or nothing; on any thread. NULL: the change does not touch them. */
    enum dt_status (*edit)(struct dt *dt, struct change *c, const struct dt_options *opt);
    /* Notes the change in the set after that, on the thread that owns the sets. NULL: there is nothing to note. */
    void (*note)(struct registry *r, struct dataset *set, const struct change *c);
};

extern const struct change_kind change_kinds[CHANGE_KINDS];

/* Makes *c, which is all zero, a change of the set. */
void change_init(struct change *c, enum change_code code, const struct word *set);

/* Gives it the n points, from dt_pages_grow, each followed by the values of the columns, if there are any. */
void change_set_rows(struct change *c, double *rows);

/* The coincidence tolerance of the set that it creates, if it creates one. */
double change_tolerance(const struct change *c);

/* Edits the set's points, values or constraints, as the kind of change says; its outcome is in *c, whose `first` is then the id of
 * the first new point. */
enum dt_status change_edit(struct dt *dt, struct change *c, const struct dt_options *opt);

/* Whether the change has been applied and has changed nothing: it gets no record, and the set no new version. */
bool change_is_void(const struct change *c);

/* Frees the memory that it owns. */
void change_clear(struct change *c);

/* Why the change does not fit the set, which is NULL if there is none: a static sentence. NULL: it may be applied. */
const char *change_contradiction(const struct change *c, const struct dataset *set);

/* ---- records ---- */

/* Whether the record is one of those that an assembly joins. */
bool change_is_part(const struct record *r);

/* Makes a change of a record that is one alone. pages may be NULL. DT_NOMEM; DT_RANGE: its names or numbers are impossible. Unless
 * DT_OK, *c owns nothing. */
enum dt_status change_decode(struct change *c, const struct record *r, struct dt_pages *pages);

/* The record of a change that has been applied, which borrows from it; lsn and synced are 0. */
struct record change_encode(const struct change *c);

/* Whether one record is not enough, so that the change becomes a LOAD (log_append_load). */
bool change_is_long(const struct change *c);
