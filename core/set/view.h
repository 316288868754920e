/* view.h - the views of a set: readers of earlier moments, and what edits have saved for them; for the files of
 * core/ only.
 *
 * Three kinds of images are saved (core/set/before_images.h), each in an order of its own, so that none waits for the readers of
 * another kind to be freed; under these keys:
 *
 *      rows       id -> its place, and of which group of aliases it is one
 *      families   group of aliases -> the group that it is part of, or its representative: so that a family
 *                 that gets another one is not many rows, whose images name the group
 *      rings      id of a representative -> whether it is on the hull, and its star in ids (core/mesh/star.h)
 *
 * A key without an image has its present value. The row of an id says whether the id was a representative; only then
 * may its ring be read.
 *
 * Views are read by view_rows.h and view_stars.h, and edits save by view_save.c. */
#pragma once

#include "core/delaunay.h"
#include "core/points/changes.h"
#include "core/set/before_images.h"

enum dt_image_kind { DT_IMAGE_ROW, DT_IMAGE_FAMILY, DT_IMAGE_RING, DT_IMAGE_KINDS };

struct dt_views;

/* The lists of views: all of them, and those with rings. */
enum dt_view_list { DT_VIEWS_ALL, DT_VIEWS_RINGS, DT_VIEW_LISTS };

struct dt_view {
    struct dt_views *home;
    struct dt_view *next_begun, *next_ended; /* on the stacks of its set */
    struct dt_view_link {
        struct dt_view *older, *newer;
    } link[DT_VIEW_LISTS];
    atomic_bool counted; /* in `rings` of its set */
    bool with_rings;     /* it reads the triangulation */
    bool constrained;    /* it has constrained edges, so that it may not be Delaunay */
    bool line;           /* all points are on one line, or there are fewer than three */
    uint32_t on_hull;    /* with rings: a point on the hull, DT_NONE if there is none */
    uint32_t next_id;
    uint64_t constraints; /* the next change of constraints (core/constraints/history.h) */
    uint64_t serial;      /* views are numbered as they begin */
    uint64_t moment[DT_IMAGE_KINDS];
    struct dt_summary sum;
};

/* The moments of one kind that are read. */
struct dt_moments {
    uint64_t oldest, latest; /* UINT64_MAX and 0: none */
    uint32_t keys;           /* only keys below that had a value by the latest; 0: none is read */
};

struct dt_views {
    _Atomic(struct dt_view *) begun; /* owns; a stack of those that are in no list yet */
    _Atomic(struct dt_view *) ended; /* a stack of those that have ended */
    struct dt_view_ends {
        struct dt_view *oldest, *newest; /* DT_VIEWS_ALL owns them */
    } list[DT_VIEW_LISTS];
    atomic_uint rings;            /* views that read the triangulation and have not ended */
    atomic_uint_least64_t serial; /* of the view that began last */
    uint64_t lost;                /* of the last view that cannot be read any more: out of memory */
    uint64_t rings_lost;          /* of the last one whose triangulation cannot be read any more */
    struct dt_images images[DT_IMAGE_KINDS];
    struct dt_changes changes; /* calls back here */
    /* For the edit under way: */
    struct dt_moments read[DT_IMAGE_KINDS];
    uint64_t first, last; /* serials of views that are read; UINT64_MAX and 0: none */
};

/* The oldest view that had begun before this edit did; NULL: none. */
static inline const struct dt_view *dt_views_oldest(const struct dt_views *w)
{
    return w->list[DT_VIEWS_ALL].oldest;
}

static inline bool dt_views_has_any(const struct dt_views *w)
{
    return dt_views_oldest(w) != NULL ||
           atomic_load_explicit(&w->begun, memory_order_relaxed) != NULL;
}

/* All views have ended. */
void dt_views_clear(struct dt_views *w);
size_t dt_views_memory(const struct dt_views *w);

/* Whether nothing is saved. */
bool dt_views_are_empty(const struct dt_views *w);

/* Whether an image of the key has been saved since the view began. */
static inline bool dt_view_has(const struct dt_views *w, const struct dt_view *v,
                               enum dt_image_kind kind, uint32_t key)
{
    return dt_images_has(&w->images[kind], key, v->moment[kind]);
}

/* The value that the key had then, *words of them (may be NULL); NULL: it is what it is now. */
static inline const uint32_t *dt_view_image(const struct dt_views *w, const struct dt_view *v,
                                            enum dt_image_kind kind, uint32_t key, uint32_t *words)
{
    return dt_images_get(&w->images[kind], key, v->moment[kind], words);
}

/* A view that is beginning, in no list yet; NULL: out of memory. */
struct dt_view *dt_views_begin(struct dt_views *w);

/* Opens it, when it has been filled in. */
void dt_views_open(struct dt_views *w, struct dt_view *v);

static inline bool dt_view_reads_rows(const struct dt_views *w, const struct dt_view *v)
{
    return v->serial > w->lost;
}

static inline bool dt_view_reads_rings(const struct dt_views *w, const struct dt_view *v)
{
    return v->with_rings && v->serial > w->rings_lost && dt_view_reads_rows(w, v);
}

/* Whether the triangulation is read through an open view. */
bool dt_views_read_rings(const struct dt_views *w);

/* No view that is open now can be read any more, or none that reads the triangulation. */
void dt_views_lose_rows(struct dt_views *w);
void dt_views_lose_rings(struct dt_views *w);

/* Removes the views that have ended, finds out which moments the others read, and frees some of the images that
 * no view reads. Returns whether something was freed. Cost: constant for each view that has begun or ended since. */
bool dt_views_review(struct dt_views *w);
