/* delaunay_constraints.h - the core's public header for constraints: straight segments between points that the
 * triangulation keeps; see delaunay.h.
 *
 * A constraint is a pair of ids, a kind and a number. It stands between the representatives of its ids. If both have the
 * same representative, it has no edges. The triangulation of a set with constraints is the constrained Delaunay
 * triangulation. Every constraint is an edge, or a chain of edges through the vertices that lie exactly on it. Every other
 * edge is locally Delaunay under the symbolic perturbation (delaunay.h). It is the only such triangulation, so it depends on
 * the representatives' coordinates and the constraints alone [Agarwal, Arge & Yi 2005; Shewchuk & Brown 2015].
 *
 * Constraints may share ends, touch, overlap, and run through vertices. Two that cross where no vertex is are refused
 * (DT_CROSSES), by every function that would make them cross; dt_crossed names them. In a set that has not been
 * triangulated, constraints are recorded, and dt_triangulate refuses those that cross.
 *
 * A set without constraints pays nothing for them. With constraints, cells, areas, alpha shapes and natural neighbours
 * are refused (DT_NOTDELAUNAY). */
#pragma once

#include "core/delaunay_fields.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DT_MAX_CONSTRAINTS (1u << 28) /* of one set */
#define DT_MAX_NUMBER (INT32_MAX)     /* of a constraint */

struct dt_constraint {
    uint32_t a, b;   /* ids */
    bool border;     /* it is a part of the border of a region; else a line */
    uint32_t number; /* of the line or region, at most DT_MAX_NUMBER */
};

/* Two constraints that cross, each a < b. */
struct dt_crossed {
    struct dt_constraint one, other;
};

/* Declares n constraints, all or none. The same one again changes nothing; *added counts the others. In a set that is
 * triangulated they are kept from now on. DT_NOPOINT puts an id that is missing into *missing, and DT_NOEDGE one that
 * is both ends; DT_RANGE: a number is too large; DT_TOOBIG: too many constraints; DT_CROSSES: of the first, in the
 * order of c[], that crosses one before it or an existing one, and the least of these. A set whose triangulation
 * awaits dt_refresh gets that first. opt may be NULL: steps and its flag. Cost of each: the edges that it crosses, and
 * their logarithm. */
enum dt_status dt_constrain(struct dt *t, const struct dt_constraint *c, size_t n,
                            const struct dt_options *opt, size_t *added, uint32_t *missing);

/* Releases n constraints, all or none; one named twice is released once, *released counts distinct ones.
 * DT_NOCONSTRAINT puts the index of the first that is not there into *missing. */
enum dt_status dt_release(struct dt *t, const struct dt_constraint *c, size_t n,
                          const struct dt_options *opt, size_t *released, size_t *missing);

/* An upper bound of the bytes that dt_constrain of n constraints touches at its peak beyond dt_summary.memory. */
size_t dt_constrain_memory(const struct dt *t, size_t n);

/* The number of constraints. */
uint32_t dt_constraints_count(const struct dt *t);

/* A growing array. Start with {0}; its owner frees v. */
struct dt_constraint_list {
    struct dt_constraint *v;
    size_t n, cap;
};

/* All constraints, or those with the end `id` unless that is DT_NONE, now or at the moment of a view. The caller frees their
 * array *rows: a < b, sorted by a, b, lines before borders, number. */
enum dt_status dt_constraints(const struct dt *t, const struct dt_view *v, uint32_t id,
                              struct dt_constraint **rows, size_t *n);

/* The same piece by piece; if a view is read, the set may be edited between the pieces. Appends the constraints whose smaller end
 * is *from or an id after it, until that has taken `steps` steps: of constraints, and of ids that are ends. Then *from is the
 * next id, DT_NONE at the end. The constraints of an id are read at once. DT_NOMEM: the appended rows and *from are undefined. */
enum dt_status dt_constraints_read(const struct dt *t, const struct dt_view *v, uint32_t *from,
                                   size_t steps, struct dt_constraint_list *out);

/* < 0 if the constraint at a is before that at b in this order, 0 if they are the same; ends ascending. */
int dt_constraint_compare(const void *a, const void *b);

/* The number of constraints that end at the id, but at most `most`. The cost is `most`, too. */
size_t dt_constraints_at(const struct dt *t, uint32_t id, size_t most);

/* Whether it is declared; its ids are in any order. Cost: constant. */
bool dt_constraint_has(const struct dt *t, const struct dt_constraint *c);

/* Whether the closed segment between two places meets the closed box; exact. */
bool dt_segment_meets_box(struct dt_point a, struct dt_point b, struct dt_point lo,
                          struct dt_point hi);

/* A constraint that edits have declared or released, or of which they have moved an end. */
struct dt_touched_constraint {
    struct dt_constraint what;
    struct dt_point at[2]; /* the places of its ends before, if it is not new */
    bool moved;            /* an end has moved; else it has been declared or released */
};

/* Returns the constraints that edits have touched since the last call, as dt_touched_take (delaunay.h); in the order of the edits, possibly
 * repeated. */
bool dt_touched_take_constraints(struct dt *t, const struct dt_touched_constraint **rows,
                                 size_t *n);

/* Appends the pairs a < b, sorted, of the edges that are parts of constraints. */
enum dt_status dt_constrained_edges(const struct dt *t, struct dt_ids *out);

/* The constraints that the last DT_CROSSES was about. */
void dt_crossed(const struct dt *t, struct dt_crossed *out);

/* A plan that lets constraints that would cross share points instead. */
struct dt_split {
    struct dt_point *point; /* owns, as the next two: to be added, with ids from dt_next_id on */
    struct dt_constraint *released; /* declared ones, to be released */
    struct dt_constraint *added;    /* to be declared; all sorted */
    size_t n_points, n_released, n_added;
    struct dt_values_of *column; /* owns `columns`, of fields with values there; borrows names */
    double *value;               /* owns; of the columns */
    size_t columns;
    size_t split;     /* constraints that are replaced by parts, declared ones and others */
    double deviation; /* the largest distance of such a part from its constraint */
    struct dt_crossed crossed;
};

/* Plans n constraints, and changes nothing. To carry it out, dt_add_values the points, dt_release, dt_constrain; these calls
 * then fail only for lack of memory. In rounds, all crossings are found exactly. Each is rounded once to the nearest place
 * that dt_coordinate_ok accepts, and all constraints through it are replaced by their parts. A point that would coincide with
 * an existing one is not added. Borders of a number whose
 * parts come to lie on one another cancel out in pairs. From the second round on, a crossing moves to an end of one of the
 * two that is some units of the last place from the other one. The value of a field at a new point is the mean of those of the
 * constraints through it, which are linear between their ends. In a set that has not been triangulated, declared constraints that cross
 * each other are split, too. The plan does not depend on the order of c[]. After 16 rounds with
 * crossings left: DT_CROSSES, *out names the least constraints whose parts cross. DT_NOMEM, too, if a round has more than
 * about `crossings`. Else as dt_constrain; *out is empty if it
 * fails. Cost: linear in all constraints, and in those asked for O(n log n) if they are short, plus the crossings. */
enum dt_status dt_plan_split(struct dt *t, const struct dt_constraint *c, size_t n,
                             size_t crossings, const struct dt_options *opt, struct dt_split *out,
                             uint32_t *missing);

/* An upper bound of the bytes that planning n constraints with `crossings` crossings touches at its peak beyond
 * dt_summary.memory, and of the bytes of the plan. */
size_t dt_split_memory(const struct dt *t, size_t n, size_t crossings);

void dt_split_clear(struct dt_split *out);

/* Takes the last n points that were added back; they are no ends, and no others have been added since. Afterwards the set is
 * as if they had never existed, and the next point gets the first one's id. Fields that came with them stay. Cost: as
 * dt_delete; of many, a build. */
void dt_take_back(struct dt *t, uint32_t n);

/* dt_delete_many of points that may be ends of constraints, which are released. (dt_delete_many refuses such an id:
 * DT_CONSTRAINED, and puts it into *missing.) */
enum dt_status dt_delete_cascade(struct dt *t, const uint32_t *ids, size_t n,
                                 const struct dt_options *opt, uint32_t *deleted,
                                 uint32_t *missing);

/* Moves n points with distinct ids, all or none, judged as a whole. DT_NOPOINT puts an id that is missing, or named
 * twice, into *missing. Cost: as dt_move of each; where constraints are in the way, up to two builds. */
enum dt_status dt_move_many(struct dt *t, const uint32_t *ids, const struct dt_point *to, size_t n,
                            const struct dt_options *opt, uint32_t *missing);

/* ---- meshes to order ---- */

/* The limits for triangles inside closed borders; 0: no limit. */
struct dt_quality {
    double angle;    /* no angle is smaller: degrees, below 60 */
    double area;     /* no area is larger, */
    double length;   /* and no edge longer */
    uint32_t number; /* of the border; DT_NONE: inside any */
    bool keep;       /* constraints are not split */
    size_t most;     /* points that may be added */
    enum dt_status (*reserve)(void *ctx,
                              size_t bytes); /* memory, in all; NULL: there is no limit */
    void *ctx;
};

struct dt_refined {
    struct dt_split change; /* `split` counts constraints, the hull's too; there is no deviation */
    double angle;           /* the least one inside, in degrees; nan: there is no triangle */
    size_t unrefined;       /* triangles inside that are not as wanted */
    size_t hull;            /* edges of the hull that become border 0, because there is no border */
};

/* Plans points that make triangles as wanted, and the parts of constraints that they split; and changes nothing: it is carried out
 * as dt_plan_split's. Of a set without borders, the hull becomes border 0. Fixed edges are split in the middle, near a sharp corner at a
 * distance that is a power of two. A place is not refined where a point would round to another one or to the other side of a constraint;
 * and between edges that meet at a small angle. New points have linearly interpolated values. The plan depends on the points, their
 * ids and the constraints alone, and ends with `most` points at the latest. DT_RANGE: a limit; DT_UNTRIANGULATED; DT_NOREGION,
 * DT_OPEN, also if all borders are; DT_CANCELLED, DT_NOMEM, and what `reserve` returns: *out is empty. It makes a copy of the set.
 * Cost: a build, and a few insertions for each new point.
 * An angle is too small if its squared cosine is larger than the double nearest to cos^2 of the limit; decisions are exact.
 * The method: off-centres [Uengoer, "Off-centers: a new type of Steiner points for computing size-optimal quality-guaranteed
 * Delaunay triangulations", 2004]. Also edges with a vertex in their circle, and shells [Ruppert, "A Delaunay refinement
 * algorithm for quality 2-dimensional mesh generation", 1995]. */
enum dt_status dt_plan_refine(struct dt *t, const struct dt_quality *q,
                              const struct dt_options *opt, struct dt_refined *out);

/* An upper bound of the bytes that a plan with `points` new points touches at its peak beyond dt_summary.memory. */
size_t dt_refine_memory(const struct dt *t, size_t points);

/* ---- the shape of triangles ----
 *
 *     dt_measure_begin(t, view, &m);
 *     do
 *         dt_measure_read(t, m, &done);         under the caller's lock
 *     while (!done);
 *     dt_measure_end(m, &shapes);               which needs the set no more
 *     dt_measure_free(m);
 *
 * The least angle of each triangle falls into a bin of 5 degrees. It is below the upper end of a bin if its squared cosine is larger
 * than the double nearest to that of the end; decisions are exact, and those of dt_plan_refine. */
enum { DT_ANGLE_BIN = 5, DT_ANGLE_BINS = 12 };

struct dt_shapes {
    size_t triangles;
    size_t count[DT_ANGLE_BINS]; /* by their least angles: 0 to 5 degrees, ..., 55 to 60 */
    double area;                 /* of them all: the exact one, rounded once */
    double least, largest;       /* angles in degrees, rounded once; all nan without triangles */
    double shortest, longest;    /* edges, within 2^-51 of the length */
};

struct dt_measure;

/* The view must be one that reads rings, begun since the last edit, and open until the last dt_measure_read. Without a view (NULL) the
 * set must not change until the last one. DT_UNTRIANGULATED, DT_NOMEM. */
enum dt_status dt_measure_begin(const struct dt *t, const struct dt_view *view,
                                struct dt_measure **out);

/* Before the first dt_measure_read: only triangles inside the border of the number count, or inside any if that is DT_NONE. Then the
 * set must not be edited until all are read: DT_UNSURVEYED. Errors of dt_region_check. */
enum dt_status dt_measure_inside(struct dt_measure *m, const struct dt *t, uint32_t number);

/* Reads some thousands of triangles more; again from the first one on if the set of the view was edited. Cost: linear. */
enum dt_status dt_measure_read(const struct dt *t, struct dt_measure *m, bool *done);

/* Bytes that it has. */
size_t dt_measure_memory(const struct dt_measure *m);

void dt_measure_end(struct dt_measure *m, struct dt_shapes *out);

void dt_measure_free(struct dt_measure *m); /* NULL: nothing */

/* ---- regions ----
 *
 * Take a way from a place to infinity that meets no vertex. The place is inside the border of number k if the way crosses the
 * border constraints of that number an odd number of times, each as often as constraints cover the edge. The border is closed
 * if every representative is the end of an even number of them; nothing is inside an open one. "Inside" alone means
 * inside at least one.
 *
 * Regions are found by dt_survey. Edits of points and of lines keep them current; a change of borders, or of the place of
 * an end of one, or a rebuild, does not: then the queries answer DT_UNSURVEYED. */

/* Finds the regions of a set whose triangulation is current (else DT_UNTRIANGULATED); cheap if they are known. If opt is not
 * NULL, its flag is polled, and DT_TOOLONG is returned at once if there are more triangles than steps. Cost: the
 * edges of borders, and the triangles. */
enum dt_status dt_survey(struct dt *t, const struct dt_options *opt);

/* Whether they are known; a set without borders has none. */
bool dt_surveyed(const struct dt *t);

/* Whether a border is declared. Constant. */
bool dt_has_borders(const struct dt *t);

/* Whether triangulation and constraints, and so regions, are still those of the view. Constant. */
bool dt_view_has_regions(const struct dt *t, const struct dt_view *v);

/* An upper bound of the bytes that dt_survey touches at its peak beyond dt_summary.memory. Cost: O(triangles). */
size_t dt_survey_memory(const struct dt *t);

struct dt_region {
    uint32_t number;
    bool closed;
    uint32_t triangles; /* inside; none if it is open */
    double area;        /* of them all: the exact one, rounded once */
};

/* All borders, by number, in an array that *rows is set to and the caller frees. *inside: of all that is inside one,
 * each triangle once; its number means nothing. Cost: linear. */
enum dt_status dt_regions(const struct dt *t, struct dt_region **rows, size_t *n,
                          struct dt_region *inside);

/* Appends to *in the numbers of the borders that have the place inside. Appends to *on the numbers of the borders whose region has
 * the place on its edge: some way from the place is inside and some other one is not. Each ascending. opt may be NULL: its steps
 * (DT_TOOLONG) and its flag. Cost: as dt_locate, and the logarithm of the borders for each; at a vertex, for each of its triangles. */
enum dt_status dt_regions_at(const struct dt *t, struct dt_point q, const struct dt_options *opt,
                             struct dt_ids *in, struct dt_ids *on);

/* Whether the border of the number, or any if that is DT_NONE, is there and closed: DT_NOREGION, DT_OPEN. All borders may be open.
 * Cost: the logarithm of the borders. */
enum dt_status dt_region_check(const struct dt *t, uint32_t number);

/* Whether one of the borders, which are known, is closed. Cost: the number of borders. */
bool dt_has_closed_border(const struct dt *t);

/* Appends the rows of DT_TRIANGLES or DT_EDGES, in their order, that are inside the border of the number, or inside any
 * if that is DT_NONE. An edge is inside if a triangle on one of its sides is. Errors of dt_region_check, but there may be no
 * border at all. opt may be NULL: its flag is polled. Cost: linear, and the sorting. */
enum dt_status dt_inside(const struct dt *t, uint32_t number, enum dt_table table, bool cw,
                         const struct dt_options *opt, struct dt_ids *out);

/* ---- a polygon at once ---- */

/* Appends the triangles of a polygon to *out: three ids each, counterclockwise from the smallest, in no order.
 * p[n]: the corners of all rings, with the ids 0, 1, 2, ... end[rings]: where each ring ends. A ring may repeat its first corner at its end
 * or not; a ring of one or two corners encloses nothing. A triangle is inside if it is enclosed an odd number of times.
 * A side that crosses an earlier one where no corner is is left out; *left_out counts these sides. Then a triangle is inside if all sides
 * together enclose its centroid an odd number of times. pages may be NULL. DT_RANGE, DT_TOOBIG, DT_NOMEM.
 * Cost: as of dt_triangulate and dt_constrain; each triangle that a side which is left out meets costs a step for each such side. */
enum dt_status dt_polygon(const struct dt_point *p, size_t n, const uint32_t *end, size_t rings,
                          struct dt_pages *pages, struct dt_ids *out, size_t *left_out);

#ifdef __cplusplus
}
#endif
