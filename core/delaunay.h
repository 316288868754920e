/* delaunay.h - the core's public header: a set of points of the plane and its Delaunay triangulation. delaunay_surface.h,
 * delaunay_fields.h, delaunay_constraints.h, delaunay_thinning.h, delaunay_arrays.h and delaunay_tiles.h are its further parts.
 *
 * A set hands out an id for every point it is given: 0, 1, 2, ... in order of arrival, never used twice. A point within the
 * set's coincidence tolerance of an earlier one becomes an alias of it (its representative); only representatives are vertices of
 * the triangulation. Functions that take an id of the triangulation answer for its representative.
 *
 * The triangulation is canonical: ties of cocircular points are broken by symbolic perturbation [Devillers & Teillaud 2003], so it
 * depends on the coordinates alone. The algorithm is that of Fang & Piegl, "Delaunay Triangulation Using a Uniform Grid", IEEE
 * CG&A 13(3), 1993 ("the paper" in every comment of core/).
 *
 * Nothing here prints, aborts or keeps global state. A function that fails leaves the set as it was. Functions that take a const
 * set may run in several threads at once; any other function needs exclusive access to the set. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#include <atomic>
typedef std::atomic_bool dt_atomic_bool;
typedef std::atomic_uint dt_atomic_uint;
extern "C" {
#else
#include <stdatomic.h>
typedef atomic_bool dt_atomic_bool;
typedef atomic_uint dt_atomic_uint;
#endif

#define DT_NONE UINT32_MAX             /* no id, no vertex, no half edge */
#define DT_MAX_POINTS ((1u << 28) - 1) /* live points of one set */

struct dt;
struct dt_pages;
struct dt_view;

struct dt_point {
    double x, y;
};

/* A growing array of ids, owned by the caller: start with {0}, free(v) at the end. */
struct dt_ids {
    uint32_t *v;
    size_t n, cap;
};

enum dt_status {
    DT_OK = 0,
    DT_NOMEM,          /* out of memory */
    DT_TOOBIG,         /* more than DT_MAX_POINTS points, or the ids have run out */
    DT_RANGE,          /* a coordinate outside the range in which the predicates are exact */
    DT_NOPOINT,        /* no such id */
    DT_NOEDGE,         /* the two points are not joined by an edge */
    DT_NOTRIANGLE,     /* the three points are not a triangle of the triangulation */
    DT_NOFIELD,        /* no such field (core/delaunay_fields.h) */
    DT_UNTRIANGULATED, /* dt_triangulate has not been called yet */
    DT_CANCELLED,      /* the caller's cancel flag was seen */
    DT_CORRUPT,        /* dt_check found a fault */
    DT_TOOSMALL,       /* the caller's buffer does not hold one row; the size it needs is set */
    DT_TOOLONG,        /* it takes more steps than the caller allows (struct dt_options) */
    DT_CROSSES,
    DT_CONSTRAINED,
    DT_NOCONSTRAINT,
    DT_NOTDELAUNAY,
    DT_UNSURVEYED,
    DT_NOREGION,
    DT_OPEN /* core/delaunay_constraints.h */
};

/* A sentence for people, for any number: a static string. */
const char *dt_status_text(enum dt_status status);

/* ---- how a call may be carried out ---- */

/* The source of the core's threads: run(ctx, n, job, arg) calls job(arg, i) for every i < n, in any order, on up to
 * `threads` threads at once. It returns when all calls have returned. A job never waits for another one. */
struct dt_pool {
    unsigned threads;
    void (*run)(void *ctx, unsigned n, void (*job)(void *arg, unsigned i), void *arg);
    void *ctx;
};

enum dt_method { DT_AUTO, DT_SHELLING, DT_DIVIDE };

/* All fields may be zero: automatic choice, no rebuild, one thread, never cancelled, no limit.
 *
 * A function with a parameter struct dt_options takes NULL for that. A flag that is set makes it
 * return DT_CANCELLED within some milliseconds of work; on ten million points within 100, or 200 for
 * dt_delete_many and dt_refresh if millions of them coincide. Within that time an edit is undone, and a build that
 * has begun to change the set is completed. With `disposable` the call may return in the middle instead, and the
 * set can then only be freed. `steps` makes it return DT_TOOLONG before it has done much more
 * than that number of steps. In both cases the set is otherwise unchanged.
 *
 * A step examines a neighbour, a triangle or a point, which takes about as long as a cache miss; usual edits
 * and searches of a point take about twenty. So a thread that must not block for long can try with a limit, and leave what
 * exceeds it to another one. dt_triangulate, dt_refresh, dt_check and dt_trace ignore the limit. */
struct dt_options {
    enum dt_method method;
    bool rebuild;                 /* rebuild a triangulation that exists already */
    const struct dt_pool *pool;   /* borrowed during the call; NULL: the caller's thread alone */
    const dt_atomic_bool *cancel; /* borrowed during the call; polled; NULL: never cancelled */
    dt_atomic_uint *progress;     /* borrowed during the call; per cent done; NULL: not reported */
    uint32_t steps;               /* upper limit of steps; 0: no limit */
    bool disposable;              /* the caller frees the set unless the call returns DT_OK */
};

/* ---- life ---- */

/* A new empty set with coincidence tolerance tol >= 0 (see dt_coordinate_ok); NULL when out of memory. The caller owns it. */
struct dt *dt_new(double tol);
void dt_free(struct dt *t);

/* The same, and its large arrays come from the keeper and go back there (see below). pages may be NULL. */
struct dt *dt_new_in(double tol, struct dt_pages *pages);

/* An independent copy in *copy, which the caller owns, on the same keeper. Cost: a copy of the points, and if t has a
 * triangulation, as of dt_triangulate. */
enum dt_status dt_clone(const struct dt *t, struct dt **copy);

/* The same without the triangulation, which awaits dt_refresh if t has one: for a caller that is going
 * to triangulate the copy again. opt, which may be NULL: its flag is polled. */
enum dt_status dt_clone_points(const struct dt *t, const struct dt_options *opt, struct dt **copy);

double dt_tolerance(const struct dt *t);

/* Whether v is zero or 2^-142 <= |v| <= 2^201: the range in which all predicates are exact. */
bool dt_coordinate_ok(double v);
bool dt_coordinates_ok(const double *v, size_t n); /* all of v[n] */

/* ---- memory that is used again ----
 *
 * A keeper of pages keeps pages that large arrays of sets release, for the next ones, because fresh pages are
 * expensive: they can cost as much as a triangulation. Any number of sets and threads may use one at the same
 * time. The caller owns it, and it must outlive everything that was taken from it.
 *
 * Bytes kept and in use together do not exceed the limit, unless those in use do so alone; arrays of less than
 * 3 MiB are not counted. */

/* NULL when out of memory. */
struct dt_pages *dt_pages_new(size_t limit);

/* Gives back the kept pages. */
void dt_pages_free(struct dt_pages *p);

/* Sets the limit, in bytes. Kept bytes beyond it are released when more is given back, or by dt_pages_trim. */
void dt_pages_limit(struct dt_pages *p, size_t limit);

/* Releases up to `bytes` of the kept bytes, rounded up to 2 MiB, and returns the number of bytes
 * released. Cost: linear in the bytes released. */
size_t dt_pages_trim(struct dt_pages *p, size_t bytes);

/* Prefaults up to `bytes` fresh bytes, rounded up to 2 MiB, and keeps them, as far as the limit allows. Returns
 * how many; 0: none. For an idle thread, because the system clears the pages. */
size_t dt_pages_prepare(struct dt_pages *p, size_t bytes);

struct dt_pages_summary {
    size_t held;    /* bytes in use and kept */
    size_t kept;    /* bytes of these that wait to be used again */
    uint64_t fresh; /* bytes that have ever been asked of the system */
    uint64_t uses;  /* number of takes and gives: it changes while the keeper is in use */
};

/* A snapshot of the figures; while other threads use the keeper, each may be of another moment. */
void dt_pages_summary(const struct dt_pages *p, struct dt_pages_summary *out);

/* Grows an array from the keeper, which may be NULL, so that it has room for `bytes`, and keeps the first `used` of
 * them. The caller owns it and releases it by dt_pages_release. NULL: out of memory, the array is unchanged. */
void *dt_pages_grow(struct dt_pages *p, void *array, size_t used, size_t bytes);

/* Nothing for NULL. */
void dt_pages_release(void *array);

/* ---- points ---- */

struct dt_added {
    uint32_t first;      /* the id of the first point added; the others follow */
    uint32_t added;      /* how many */
    uint32_t coincident; /* how many of them became aliases */
};

/* Adds n points, all or none: DT_RANGE, DT_TOOBIG and DT_NOMEM leave the set as it was. n = 0 is allowed. */
enum dt_status dt_add(struct dt *t, const struct dt_point *p, size_t n, struct dt_added *out);

/* The same within a limit, and on the threads of a pool if there are enough points. The flag must not
 * be cleared during the call. */
enum dt_status dt_add_many(struct dt *t, const struct dt_point *p, size_t n,
                           const struct dt_options *opt, struct dt_added *out);

/* Deletes n ids, all or none; an id named twice is deleted once, *deleted counts distinct ids.
 * DT_NOPOINT puts the first id that is missing in *missing. If a representative is deleted, its lowest alias
 * replaces it. */
enum dt_status dt_delete(struct dt *t, const uint32_t *ids, size_t n, uint32_t *deleted,
                         uint32_t *missing);
enum dt_status dt_delete_many(struct dt *t, const uint32_t *ids, size_t n,
                              const struct dt_options *opt, uint32_t *deleted, uint32_t *missing);

/* Moves a point; it keeps its id. At its new place it may become an alias, or the representative of equal
 * points with higher ids. */
enum dt_status dt_move(struct dt *t, uint32_t id, struct dt_point to);
enum dt_status dt_move_to(struct dt *t, uint32_t id, struct dt_point to,
                          const struct dt_options *opt);

/* Fills a new set (dt_new) with n points as they were in another one: their ids, their places, and for each its
 * representative's id (its own unless it is an alias). The ids are in ascending order and below next_id, the id that
 * the next point will get. DT_CORRUPT: these cannot come from a
 * set, or t is not new; the set is unchanged. opt may be NULL: its flag is polled. Cost: linear. */
enum dt_status dt_restore(struct dt *t, const uint32_t *ids, const struct dt_point *p,
                          const uint32_t *representatives, size_t n, uint32_t next_id,
                          const struct dt_options *opt);

/* The id that the next point will get: one more than the largest ever given. */
uint32_t dt_next_id(const struct dt *t);

/* The point's own coordinates (an alias has its own). */
enum dt_status dt_get(const struct dt *t, uint32_t id, struct dt_point *p);

/* The representative of id: id itself unless it is an alias. */
enum dt_status dt_representative(const struct dt *t, uint32_t id, uint32_t *rep);

/* From now on edits note which points they touch, and with `values` whose values of fields, until dt_touched_end.
 * Cost: O(1) for each row, ring and value that an edit changes. */
void dt_touched_begin(struct dt *t, bool values);
void dt_touched_end(struct dt *t);

size_t dt_touched_count(const struct dt *t); /* how many keys there are to be taken */

/* Returns the keys that edits have touched since the last call, in no order, and possibly repeated. A key is an id, shifted by
 * 32, and one of the numbers below. New ids are not among them, nor values of new points. Keys are
 * borrowed until the next edit. False: everything may have changed, or every value; also if edits have not noted it.
 * Cost: O(1); while all points are on one line, O(n). */
enum { DT_TOUCHED_ROW, DT_TOUCHED_RING, DT_TOUCHED_VALUE /* plus dt_field_number */ };
bool dt_touched_take(struct dt *t, const uint64_t **keys, size_t *n);
bool dt_touched_take_values(struct dt *t, const uint64_t **keys, size_t *n);

/* ---- the triangulation ---- */

struct dt_summary {
    uint32_t points;     /* live ids, aliases included */
    uint32_t coincident; /* the aliases among them */
    uint32_t triangles, edges, hull;
    uint32_t fields;   /* of values (core/delaunay_fields.h) */
    bool triangulated; /* dt_triangulate has been called */
    bool current;      /* and no edit awaits dt_refresh */
    bool searchable;   /* and there is a grid for searches, or there will be none: see dt_prepare */
    size_t memory;     /* bytes the set holds */
};

/* Computes the triangulation of the set. From then on the set is live: every edit keeps it current. On a set that is
 * triangulated already, DT_AUTO without opt->rebuild does nothing; a named engine rebuilds it. opt may be NULL. */
enum dt_status dt_triangulate(struct dt *t, const struct dt_options *opt);

/* Brings the triangulation up to date if an edit has postponed that; cheap when it is current. Must be called before the
 * const queries below, which otherwise answer DT_UNTRIANGULATED. On a set that was never triangulated it does nothing. */
enum dt_status dt_refresh(struct dt *t, const struct dt_options *opt);

/* dt_triangulate in two steps, for points that a large batch has sorted (dt_build_suits). dt_build only reads, so queries
 * may continue meanwhile. dt_built installs the result, if t has not been edited since. Cost of dt_built: constant. */
struct dt_build;
bool dt_build_suits(const struct dt *t, const struct dt_options *opt);
enum dt_status dt_build(const struct dt *t, const struct dt_options *opt, struct dt_build **out);
void dt_build_free(struct dt_build *b);
void dt_built(struct dt *t, struct dt_build *b);

/* Triangulation counts are 0 while the set is not triangulated or awaits dt_refresh. Cost: constant. */
void dt_summary(const struct dt *t, struct dt_summary *out);

/* Proves the triangulation exactly: every unconstrained edge locally Delaunay under the canonical tie rule, twins and rings
 * consistent, Euler's formula, the hull convex, every representative a vertex, constraints and regions. DT_CORRUPT
 * points *fault (may be NULL) to a static sentence. Cost: linear. */
enum dt_status dt_check(const struct dt *t, const struct dt_options *opt, const char **fault);

/* ---- how much memory work takes ----
 *
 * Upper bounds of the bytes that work on a set touches at its peak beyond dt_summary.memory: for a caller who
 * decides whether to begin. Cost: constant. */

/* dt_triangulate and dt_refresh with these options, even if there is nothing to do. */
size_t dt_build_memory(const struct dt *t, const struct dt_options *opt);

/* dt_prepare and dt_renew. */
size_t dt_prepare_memory(const struct dt *t);

/* dt_add_many of n points, where they come from not included; and if that leaves the triangulation for
 * dt_refresh, what both take. */
size_t dt_add_memory(const struct dt *t, size_t n, const struct dt_options *opt);

/* ---- the paper's algorithm, step by step ---- */

enum dt_event_kind {
    DT_EVENT_GRID,   /* a grid, or that of a crowded cell: its lower left corner p, the side `size`
                        of a cell, a columns, b rows */
    DT_EVENT_START,  /* the first edge joins a, a point near the middle, and b, the nearest to it */
    DT_EVENT_SEARCH, /* the apex of a->b is looked for to the left of it, within the circle of
                        centre p and radius `size`; HUGE_VAL: in the whole half plane */
    DT_EVENT_FIRST,  /* the first triangle a b c */
    DT_EVENT_POINT,  /* the apex c of a->b is a new point: the triangle a b c */
    DT_EVENT_RIGHT,  /* c follows b on the front: the triangle a b c, which encloses b */
    DT_EVENT_LEFT,   /* c precedes a on the front: the triangle a b c, which encloses a */
    DT_EVENT_CAVE,   /* c is elsewhere on the front: a->b waits */
    DT_EVENT_BORDER, /* a->b has no apex: it is an edge of the hull */
    DT_EVENT_REMOVE, /* a is enclosed and leaves the grid */
    DT_EVENT_HULL    /* the hull has come to a: clockwise; points on a line: along the line */
};

struct dt_event {
    enum dt_event_kind kind;
    uint32_t a, b, c; /* ids but for DT_EVENT_GRID */
    struct dt_point p;
    double size;
};

struct dt_observer {
    void (*see)(void *ctx, const struct dt_event *e);
    void *ctx;
};

/* Triangulates a copy of the set by DT_SHELLING and reports every step to the observer; the set does not
 * change. opt may be NULL. Cost: as of a triangulation by DT_SHELLING, which here never gives up: about 0.2 s
 * for a thousand of the hardest points; plus the observer's. */
enum dt_status dt_trace(const struct dt *t, const struct dt_options *opt,
                        const struct dt_observer *observer);

/* ---- views: a set as it was at one moment ----
 *
 * A reader that takes longer than edits may wait begins a view and reads the set as it was at that moment,
 * piece by piece, while edits continue between the pieces. An edit saves what it is about to change, once for all
 * views that are open. That takes about 40 bytes for each point changed, and at most 8 bytes for each id of the set. If an
 * open view reads the triangulation, it takes 40 bytes for each neighbour, too. Nothing is saved
 * while no view is open, and nothing is copied at the beginning.
 *
 * A function that reads through a view takes the set as const: several threads may read through the same view or
 * several ones, but not during an edit. If memory for saving runs out, the edit succeeds, and functions that read
 * through the views that were open return DT_NOMEM from then on. So do functions that read the triangulation after
 * an edit that dt_view_blocks has warned of. A copy of the set (dt_clone) has no views. */

/* A view of the present state: of the rows of points and, with `rings`, also of the triangulation, which must
 * be current. NULL: out of memory. May run in parallel with functions that take a const set and with itself. The
 * caller ends it, before the set is freed. Cost: the number of views that are open. */
struct dt_view *dt_view_begin(struct dt *t, bool rings);

/* Ends the view. May run in parallel with anything, even an edit of the set on another thread; later edits or
 * dt_view_tidy free what was saved for it. NULL is allowed. Cost: constant. */
void dt_view_end(struct dt_view *v);

/* Frees some of the saved data that no view needs any more; true: there may be more. Needs exclusive access to
 * the set. Cost: bounded. */
bool dt_view_tidy(struct dt *t);

/* Whether an edit of n points at once would end views that read the triangulation, because it postpones a rebuild.
 * The caller may prefer to edit a copy. May run beside dt_view_begin. (A rebuild of a current
 * triangulation changes nothing that views read.) */
bool dt_view_blocks(const struct dt *t, size_t n);

/* The answers of dt_next_id and dt_summary at the moment of the view (memory: 0). */
uint32_t dt_view_next_id(const struct dt_view *v);
void dt_view_summary(const struct dt_view *v, struct dt_summary *out);

struct dt_row {
    uint32_t id, representative;
    struct dt_point at;
};

/* The next rows, by ascending ids from *from on, `room` of them or all that are left: *n. *from advances past
 * them; it starts with 0. */
enum dt_status dt_view_rows(const struct dt *t, const struct dt_view *v, uint32_t *from,
                            struct dt_row *row, size_t room, size_t *n);

/* dt_get and dt_ring at the moment of the view; now, if v is NULL. */
enum dt_status dt_view_get(const struct dt *t, const struct dt_view *v, uint32_t id,
                           struct dt_point *p);
enum dt_status dt_view_ring(const struct dt *t, const struct dt_view *v, uint32_t id, bool cw,
                            struct dt_ids *ring, uint32_t *rep, bool *boundary);

/* ---- whole-set tables, read row by row ----
 *
 * A table is read through a cursor, a plain value of the caller's. The cursor of a view needs the view open until the last
 * read. The cursor of the present (NULL) needs the set unchanged between begin and the last read. Rows
 * come as words in canonical order:
 *   DT_POINTS      id                         every live id, ascending
 *   DT_COINCIDENT  id representative          every alias, ascending
 *   DT_LISTS       id degree neighbour...     interior points by id, then the hull in order
 *   DT_TRIANGLES   a b c                      each from its smallest id, sorted
 *   DT_EDGES       a b                        a < b, sorted
 *   DT_HULL        id                         along the hull from its smallest id; on a line from
 *                                             the end with the smaller id to the other
 * cw turns rings, hull and triangles to clockwise order (a hull on a line is walked from its other
 * end). All but the first two need a triangulation. */
enum dt_table { DT_POINTS, DT_COINCIDENT, DT_LISTS, DT_TRIANGLES, DT_EDGES, DT_HULL };

struct dt_cursor {
    enum dt_table table;
    bool cw;
    uint32_t rows;     /* rows of the whole table */
    uint32_t interior; /* DT_LISTS: how many of them are interior points */
    /* private from here on */
    const struct dt_view *view;
    uint32_t id, end, sub, left, hull_at, hull_before, hull_left;
};

enum dt_status dt_table_begin(const struct dt *t, const struct dt_view *v, enum dt_table table,
                              bool cw, struct dt_cursor *c);

/* Writes the whole rows that fit into out[cap], at most max_rows. *rows and *words count the written ones;
 * *rows is 0 at the end of the table. DT_TOOSMALL: the next row alone needs *words words
 * (at most the number of points + 2; 8 are enough for all tables but DT_LISTS). At vertices of
 * very high degree: DT_NOMEM, or DT_TOOLONG to be called again, as none of some thousand points begins a row. */
enum dt_status dt_table_read(const struct dt *t, struct dt_cursor *c, uint32_t *out, size_t cap,
                             size_t max_rows, size_t *rows, size_t *words);

/* Cuts off the first part of the rows that *c has not read yet: the rows of about `ids` ids, possibly none, or
 * all rows along the hull. The cursor *c advances past them; *part is read separately. Several threads may
 * read a part each, and their rows in the order of the cuts are those of *c. False: nothing is left.
 * Cost: O(ids / 4096) if few points have been deleted. */
bool dt_table_cut(const struct dt *t, struct dt_cursor *c, uint32_t ids, struct dt_cursor *part);

/* ---- upkeep ---- */

/* Makes the grid that lets searches of a triangulated set begin near their place, if there is none yet: so sets
 * that are never searched do not pay for it. Without it, also after DT_NOMEM, dt_locate, dt_nearest and
 * dt_within_* walk across the set; edits make it themselves. Cost: linear, about a quarter of dt_triangulate's. */
enum dt_status dt_prepare(struct dt *t, const struct dt_options *opt);

/* Edits degrade the grid for searches. Edits of a large set leave its rebuild to the caller, who can choose the
 * time: it takes as long as dt_prepare. dt_renew_due: whether a rebuild is due. Cost: constant. */
bool dt_renew_due(const struct dt *t);

/* Makes a new grid, which the caller owns. It only reads, so queries may continue meanwhile. opt, which may
 * be NULL: its pool shares the work, and its flag is polled. */
struct dt_renewal;
enum dt_status dt_renew(const struct dt *t, const struct dt_options *opt, struct dt_renewal **out);
void dt_renewal_free(struct dt_renewal *r);

/* Installs it, if t has not been edited since. NULL: there is no memory for one; the set will ask
 * again after more edits. Cost: constant, and freeing the old one. */
void dt_renewed(struct dt *t, struct dt_renewal *r);

/* ---- queries; all answer DT_UNTRIANGULATED before dt_triangulate ---- */

/* Returns the number of neighbours of the representative of id, `limit` if it has more; 0 if there is no such id or
 * no triangulation. Cost: O(that number). It estimates the cost of dt_ring, dt_triangles_at_point and the deletion of a
 * point; among points on one line, dt_ring walks along all of them. */
uint32_t dt_degree_up_to(const struct dt *t, uint32_t id, uint32_t limit);

/* Appends the ring of id: its neighbours in order. An interior point's ring starts at the smallest neighbour, a boundary
 * point's ring at its successor on the hull. *rep is the representative, *boundary whether it lies on the hull. */
enum dt_status dt_ring(const struct dt *t, uint32_t id, bool cw, struct dt_ids *ring, uint32_t *rep,
                       bool *boundary);

/* Sorts n ids into the order of DT_LISTS: interior points by id, then boundary points in hull order. Ids are replaced
 * by their representatives, each once. *kept is how many remain, *interior how many of those are interior. Cost:
 * O(n log n), and O(hull) if two or more are boundary points. */
enum dt_status dt_lists_order(const struct dt *t, bool cw, uint32_t *ids, size_t n,
                              const struct dt_options *opt, size_t *kept, size_t *interior);

/* Appends triples a b c, each from its smallest id, of the triangles
 *   at the point a, in ring order;
 *   at the edge a-b, the one left of a->b first (DT_NOEDGE);
 *   adjacent to the triangle a b c across ab, bc, ca (DT_NOTRIANGLE). */
enum dt_status dt_triangles_at_point(const struct dt *t, uint32_t a, bool cw, struct dt_ids *out);
enum dt_status dt_triangles_at_edge(const struct dt *t, uint32_t a, uint32_t b, bool cw,
                                    struct dt_ids *out);
enum dt_status dt_triangles_at_triangle(const struct dt *t, uint32_t a, uint32_t b, uint32_t c,
                                        bool cw, struct dt_ids *out);

enum dt_where { DT_OUTSIDE, DT_ON_VERTEX, DT_ON_EDGE, DT_INSIDE };

struct dt_location {
    enum dt_where where;
    uint32_t id[3]; /* none, a, a < b, or a b c counterclockwise from the smallest */
};

/* A place in question, and, from dt_fetch_places, where it is in the triangulation: a hint that any later edit
 * may invalidate. UINT32_MAX: no hint. Answers do not depend on the hint. */
struct dt_place {
    struct dt_point at;
    uint32_t near;
};

/* Locates q. Exact. Cost: constant expected, with the grid. */
enum dt_status dt_locate(const struct dt *t, struct dt_point q, struct dt_location *out);
enum dt_status dt_locate_place(const struct dt *t, const struct dt_place *q,
                               struct dt_location *out);

/* Appends the k representatives nearest to q (fewer if the set is smaller), nearest first, ties by id: exact order.
 * Cost: O(1) expected for k = 1, else O(k log k), and the degrees of the first k - 1. */
enum dt_status dt_nearest(const struct dt *t, struct dt_point q, uint32_t k, struct dt_ids *out);
enum dt_status dt_nearest_place(const struct dt *t, const struct dt_place *q, uint32_t k,
                                const struct dt_options *opt, struct dt_ids *out);

#define DT_AHEAD 32 /* queries that can be prefetched at a time */

/* For a caller that knows several queries or edits before it makes the first one: prefetches what dt_locate and
 * dt_nearest at these places, or dt_ring and dt_lists_order of these ids, or dt_delete and dt_move of these ids, or dt_get
 * of these points, will probably read. Its only result is p[].near; ids need not exist. n <= DT_AHEAD. */
void dt_fetch_places(const struct dt *t, struct dt_place *p, size_t n);
void dt_fetch_ids(const struct dt *t, const uint32_t *id, size_t n);
void dt_fetch_edits(const struct dt *t, const uint32_t *id, size_t n);
void dt_fetch_points(const struct dt *t, const uint32_t *id, size_t n);

/* ---- many places at once, as of the moment of a view or, if v is NULL, now ----
 *
 * Every place gets a row of the answer. DT_TOOLONG and DT_CANCELLED: *done of them have one, and the call
 * may be repeated for the others; all n have one if DT_OK. out has room for n rows. The view must be one
 * that reads rings. Cost: a third of the cost of single questions, because they wait for memory together; up to ten
 * times the cost if an edit has changed the set since the view began. */

/* Three ids: of the triangles that contain the place, their sides included, the first in DT_TRIANGLES;
 * DT_NONE three times if there is none. */
enum dt_status dt_locate_many(const struct dt *t, const struct dt_view *v, const struct dt_point *p,
                              size_t n, const struct dt_options *opt, uint32_t *out, size_t *done);

/* The k ids that dt_nearest gives, padded with DT_NONE. */
enum dt_status dt_nearest_many(const struct dt *t, const struct dt_view *v,
                               const struct dt_point *p, size_t n, uint32_t k,
                               const struct dt_options *opt, uint32_t *out, size_t *done);

/* Append the representatives in the closed box, or the closed disc of radius r >= 0, by id. Exact.
 * Cost: O(k log k) for k results, expected, and their degrees. */
enum dt_status dt_within_box(const struct dt *t, struct dt_point lo, struct dt_point hi,
                             const struct dt_options *opt, struct dt_ids *out);
enum dt_status dt_within_disc(const struct dt *t, struct dt_point centre, double r,
                              const struct dt_options *opt, struct dt_ids *out);

/* Appends triples a b c as DT_TRIANGLES has them, in its order: the triangles that have a point in common with the
 * closed box. Exact. Cost: O(k log k) for k results, expected. */
enum dt_status dt_within_triangles(const struct dt *t, struct dt_point lo, struct dt_point hi,
                                   bool cw, const struct dt_options *opt, struct dt_ids *out);

/* Whether the triangle has. Exact. */
bool dt_triangle_meets(const struct dt_point p[3], struct dt_point lo, struct dt_point hi);

/* ---- large results beside edits ----
 *
 * The results of dt_within_box, dt_within_disc and dt_nearest, found by a scan of every row of a view, so that
 * the set is needed for one piece at a time only:
 *
 *     struct dt_sweep s = {.kind = DT_SWEEP_DISC, .at = centre, .radius = r};
 *     do
 *         dt_sweep_read(t, view, &s, 4096);   under the caller's lock
 *         dt_sweep_sift(&s, &ids, &done);     which this does not need
 *     while (!done);
 *     dt_sweep_end(&s, NULL, &ids);
 *     dt_sweep_clear(&s);
 *
 * Cost: linear in the rows; the nearest k, a factor of up to log k more. */
enum dt_sweep_kind { DT_SWEEP_BOX, DT_SWEEP_DISC, DT_SWEEP_NEAREST };

struct dt_nearest_heap;

struct dt_sweep {
    enum dt_sweep_kind kind;
    struct dt_point at, hi; /* the lower corner and the upper one; the centre; the place */
    double radius;          /* of a disc, >= 0 */
    uint32_t k;             /* nearest points */
    /* private from here on */
    uint32_t from;      /* the next id */
    struct dt_row *row; /* owns `room`, holds `rows` */
    size_t room, rows;
    struct dt_nearest_heap *near; /* owns: the nearest so far */
};

/* Reads the next rows; their number is that of the first call. May run beside functions that only read the set. */
enum dt_status dt_sweep_read(const struct dt *t, const struct dt_view *v, struct dt_sweep *s,
                             size_t rows);

/* Bytes that the sweep and its result will have at most after the next dt_sweep_sift or dt_sweep_end. */
size_t dt_sweep_memory(const struct dt_sweep *s, const struct dt_ids *out);

/* Selects the results among these rows. *done: there are no more rows. */
enum dt_status dt_sweep_sift(struct dt_sweep *s, struct dt_ids *out, bool *done);

/* Appends the results that have not been appended yet. The ids in *out are then those that the search of the same
 * name gives, in the same order. opt may be NULL: its flag is polled. */
enum dt_status dt_sweep_end(struct dt_sweep *s, const struct dt_options *opt, struct dt_ids *out);

/* Frees the memory that it owns. */
void dt_sweep_clear(struct dt_sweep *s);

/* The rows of DT_TRIANGLES that dt_within_triangles finds, or those of DT_LISTS whose points are in the box, found by a
 * look at every row, a piece at a time. Start with a cursor that has not been read, and the box. */
struct dt_sift {
    struct dt_cursor cursor;
    struct dt_point lo, hi;
    size_t interior; /* of the rows found so far of DT_LISTS: those of interior points */
    uint64_t words;  /* that they have all together */
    /* private from here on */
    size_t rows;
};

/* Looks at about `rows` rows, and appends to *out the triangles, or the points. *done: all rows have been seen. */
enum dt_status dt_sift_read(const struct dt *t, struct dt_sift *s, size_t rows, struct dt_ids *out,
                            bool *done);

#ifdef __cplusplus
}
#endif
