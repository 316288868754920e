/* pslg.h - a planar straight-line graph (PSLG): points and constraints that are one change, of `CONSTRAIN ... SPLIT`, LOAD PATHS
 * and REFINE.
 *
 * A request asks for points, and for constraints between them and others. With `split`, constraints that would cross are replaced
 * by parts with points in common. Afterwards the change describes its effect: all points, with their values, and the constraints
 * that were released and declared. So the log and followers need no geometry. */
#pragma once

#include "core/delaunay_constraints.h"
#include "server/changes/columns.h"

/* Constraints of a change that has points, too: both arrays are from dt_pages_grow. Start with {0}. */
struct pslg_lists {
    struct record_constraint *released, *added; /* owns */
    uint32_t n_released, n_added;
};

/* Returns how many records they take. */
uint64_t pslg_lists_records(const struct pslg_lists *d);
void pslg_lists_clear(struct pslg_lists *d);

struct pslg {
    struct pslg_lists lists; /* `added` are those asked for, until the change has been applied */
    /* owns; of each that is asked for: the line of its second end; NULL: they have none */
    uint64_t *line;
    bool loads;   /* it is a LOAD, */
    bool thins;   /* or the points that SIMPLIFY has kept */
    bool counts;  /* `line` has the numbers of constraints in a LOADB instead */
    bool asked;   /* it is asked to split constraints that cross, */
    bool splits;  /* and that has not been done yet */
    bool refines; /* it is a REFINE, to `quality`: planned as a split is */
    struct dt_quality quality;
    uint32_t most; /* points that may come with a split */
    enum dt_status (*reserve)(void *ctx,
                              size_t bytes); /* memory for a split; NULL: there is no limit */
    void *ctx;
    /* the outcome: */
    size_t declared, split;
    double deviation;
    double error; /* of `thins` */
    double angle; /* as the next two, of a REFINE: see struct dt_refined */
    size_t unrefined, hull;
    struct dt_crossed crossed; /* of DT_CROSSES, */
    uint64_t crossed_line[2];  /* and the lines of the two; 0: it has none */
};

/* New points, all of them added, and their values. */
struct pslg_points {
    struct dt_point *points; /* from dt_pages_grow */
    uint32_t n;
    struct columns *columns; /* NULL: none */
};

/* All zero; NULL: out of memory. */
struct pslg *pslg_new(void);
void pslg_free(struct pslg *d); /* NULL: nothing */

/* Edits the set, to which the points of *p have just been added, all or nothing: then these are all that there are, and the outcome is in
 * *d. Unless DT_OK, *p and the request are as they were. DT_NOPOINT, DT_NOEDGE: *missing. */
enum dt_status pslg_edit(struct dt *dt, struct pslg *d, struct pslg_points *p,
                         struct dt_pages *pages, const struct dt_options *opt, uint32_t *missing);
