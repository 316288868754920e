/* cell.c - see cell.h. */
#include "core/cells/cell.h"

#include "core/cells/centre.h"
#include "core/exact/predicates.h"

#include <math.h>
#include <stdlib.h>

void dt_cell_clear(struct dt_cell_work *w)
{
    free(w->ring);
    free(w->centre);
    free(w->polygon);
    free(w->corner);
    free(w->other);
    *w = (struct dt_cell_work){.stop = w->stop};
}

size_t dt_cell_memory(const struct dt_cell_work *w)
{
    return 3 * (size_t)w->ring_cap * sizeof *w->ring +
           w->cap * (sizeof *w->polygon + sizeof *w->corner + sizeof *w->other);
}

bool dt_cell_reserve(struct dt_cell_work *w, uint32_t degree)
{
    if (w->corner != NULL && degree <= w->ring_cap)
        return true;
    uint32_t cap = degree < 64 ? 64 : degree + degree / 2;
    dt_cell_clear(w);
    w->ring = malloc(cap * sizeof *w->ring);
    w->centre = malloc(2 * cap * sizeof *w->centre); /* twice: dt_cell_make_plain */
    w->cap = cap + DT_CELL_MORE;
    w->polygon = malloc(w->cap * sizeof *w->polygon);
    w->corner = malloc(w->cap * sizeof *w->corner);
    w->other = malloc(w->cap * sizeof *w->other);
    w->ring_cap = cap;
    if (w->ring != NULL && w->centre != NULL && w->polygon != NULL && w->corner != NULL &&
        w->other != NULL)
        return true;
    dt_cell_clear(w);
    return false;
}

static void put(struct dt_cell_work *w, struct dt_point at, uint32_t edge)
{
    w->corner[w->n++] = (struct dt_cell_corner){at, edge};
}

/* ---- circumcentres around a site ---- */

static dt_lanes lanes_of(struct dt_point p)
{
    return (dt_lanes){p.x, p.y};
}

/* w->centre[i]: the corner between neighbours i and i + 1, for i < n, the next one of the last being the first. False: it
 * was stopped. */
static bool find_centres(struct dt_cell_work *w, struct dt_point at, uint32_t degree, uint32_t n)
{
    for (uint32_t i = 0; i < n; i += 2) {
        if (i % DT_POLL_MISSES == 0 && dt_stopped(w->stop))
            return false;
        uint32_t next = i + 1 < degree ? i + 1 : 0, after = next + 1 < degree ? next + 1 : 0;
        const struct dt_point p[3] = {at, w->ring[i], w->ring[next]};
        const struct dt_point q[3] = {at, w->ring[next], w->ring[after]};
        dt_centre_two(p, i + 1 < n ? q : p, &w->centre[i], &w->centre[i + 1]);
    }
    return true;
}

static void put_centres(struct dt_cell_work *w, uint32_t degree, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        put(w, w->centre[i], i + 1 < degree ? i + 1 : 0);
}

/* ---- corners at infinity ---- */

static double far_along(double direction, double middle)
{
    return direction > 0 ? (double)INFINITY : direction < 0 ? -(double)INFINITY : middle;
}

/* The end, in the direction d, of a line through m. */
static struct dt_point far_end(double dx, double dy, struct dt_point m)
{
    return (struct dt_point){far_along(dx, m.x), far_along(dy, m.y)};
}

/* The far end of the bisector of p and q to the right of the way from p to q. */
static struct dt_point far_right(struct dt_point p, struct dt_point q)
{
    struct dt_point middle = {(p.x + q.x) / 2 + 0.0, (p.y + q.y) / 2 + 0.0};
    return far_end(q.y - p.y, p.x - q.x, middle);
}

static void put_hull_cell(struct dt_cell_work *w, struct dt_point site, uint32_t degree)
{
    if (!find_centres(w, site, degree, degree - 1))
        return;
    put_centres(w, degree, degree - 1);
    put(w, far_right(w->ring[degree - 1], site), DT_EDGE_FAR);
    put(w, far_right(site, w->ring[0]), 0);
}

static void put_line_cell(struct dt_cell_work *w, struct dt_point site, uint32_t degree)
{
    struct dt_point a = degree > 0 ? w->ring[0] : site, b = degree > 1 ? w->ring[1] : site;
    if (degree == 0) { /* the plane */
        put(w, far_end(-1, -1, site), DT_EDGE_FAR);
        put(w, far_end(1, -1, site), DT_EDGE_FAR);
        put(w, far_end(1, 1, site), DT_EDGE_FAR);
        put(w, far_end(-1, 1, site), DT_EDGE_FAR);
        return;
    }
    put(w, far_right(a, site), DT_EDGE_FAR); /* left of the way to a */
    if (degree == 1) {
        put(w, far_end(site.x - a.x, site.y - a.y, site), DT_EDGE_FAR);
    } else {
        put(w, far_right(site, b), 1);
        put(w, far_right(b, site), DT_EDGE_FAR);
    }
    put(w, far_right(site, a), 0);
}

/* ---- cutting ---- */

struct side {
    bool vertical, low; /* x or y; what is kept is above `at` */
    double at;
};

/* 1 on the kept side, 0 on the border, -1 on the other side. */
static int place_of(const struct side *s, struct dt_point p)
{
    double v = s->vertical ? p.x : p.y;
    return v == s->at ? 0 : (v > s->at) == s->low ? 1 : -1;
}

/* The point at which the edge from a to b crosses the side. Far edges turn counterclockwise around everything: from right
 * to left they pass the top, and from the top to the bottom the left. */
static struct dt_point crossing(const struct side *s, const struct dt_cell_work *w,
                                struct dt_point site, const struct dt_cell_corner *a,
                                struct dt_point b)
{
    double other;
    if (a->edge == DT_EDGE_SIDE) /* of the sides, the vertical ones come first */
        return (struct dt_point){a->at.x, s->at};
    if (a->edge == DT_EDGE_FAR)
        other =
            (s->vertical ? a->at.x > b.x : a->at.y < b.y) ? (double)INFINITY : -(double)INFINITY;
    else
        other = s->vertical ? dt_bisector_y(site, w->ring[a->edge], s->at)
                            : dt_bisector_x(site, w->ring[a->edge], s->at);
    return s->vertical ? (struct dt_point){s->at, other} : (struct dt_point){other, s->at};
}

/* [Sutherland & Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974], one side. */
static void cut(struct dt_cell_work *w, struct dt_point site, const struct side *s)
{
    struct dt_cell_corner *from = w->corner;
    uint32_t n = w->n;
    w->corner = w->other;
    w->other = from;
    w->n = 0;
    for (uint32_t i = 0; i < n; i++) {
        const struct dt_cell_corner *a = &from[i];
        struct dt_point b = from[i + 1 < n ? i + 1 : 0].at;
        int here = place_of(s, a->at), there = place_of(s, b);
        if (here >= 0)
            put(w, a->at, here == 0 && there < 0 ? DT_EDGE_SIDE : a->edge);
        if (here * there < 0)
            put(w, crossing(s, w, site, a, b), here > 0 ? DT_EDGE_SIDE : a->edge);
    }
}

static void clip(struct dt_cell_work *w, struct dt_point site, const struct dt_box *box)
{
    const struct side side[4] = {{true, true, box->lo.x},
                                 {true, false, box->hi.x},
                                 {false, true, box->lo.y},
                                 {false, false, box->hi.y}};
    for (int i = 0; i < 4; i++)
        cut(w, site, &side[i]);
}

/* ---- the polygon ---- */

static bool is_same(struct dt_point a, struct dt_point b)
{
    return a.x == b.x && a.y == b.y;
}

/* On which sides of the box it is. */
static unsigned sides_of(struct dt_point p, const struct dt_box *box)
{
    return (p.x == box->lo.x ? 1u : 0) | (p.x == box->hi.x ? 2u : 0) | (p.y == box->lo.y ? 4u : 0) |
           (p.y == box->hi.y ? 8u : 0);
}

/* Corners that follow an equal one go; and all, if the others are on one side of the box. */
static void remove_equal(struct dt_cell_work *w, const struct dt_box *box)
{
    struct dt_cell_corner *c = w->corner;
    uint32_t n = 0;
    unsigned sides = 15;
    for (uint32_t i = 0; i < w->n; i++) {
        if (n > 0 && is_same(c[n - 1].at, c[i].at))
            continue;
        c[n++] = c[i];
        sides &= sides_of(c[i].at, box);
    }
    while (n > 1 && is_same(c[n - 1].at, c[0].at))
        n--;
    w->n = n >= 3 && sides == 0 ? n : 0;
}

/* < 0 if the polygon read from corner i on comes before that from corner k on. */
static int compare_turns(const struct dt_cell_work *w, uint32_t i, uint32_t k)
{
    int order = 0;
    for (uint32_t left = w->n; order == 0 && left > 0; left--) {
        order = dt_compare_xy(w->corner[i].at, w->corner[k].at);
        i = i + 1 < w->n ? i + 1 : 0;
        k = k + 1 < w->n ? k + 1 : 0;
    }
    return order;
}

/* The least corner. If rounding has made two corners equal, the corners after them decide. */
static uint32_t least_corner(const struct dt_cell_work *w)
{
    uint32_t least = 0;
    for (uint32_t i = 1; i < w->n; i++)
        if (w->corner[i].at.x <= w->corner[least].at.x && compare_turns(w, i, least) < 0)
            least = i;
    return least;
}

static bool is_inside(const struct dt_cell_work *w, const struct dt_box *box)
{
    dt_lanes lo = lanes_of(box->lo), hi = lanes_of(box->hi);
    dt_lanes_holds inside = {-1, -1};
    for (uint32_t i = 0; i < w->n; i++) {
        dt_lanes p = lanes_of(w->corner[i].at);
        inside &= (p > lo) & (p < hi);
    }
    return dt_lanes_bits(inside) == 3;
}

/* Makes the polygon of the corners that the box has left. */
static void cut_polygon(struct dt_cell_work *w, struct dt_point site, const struct dt_box *box)
{
    if (!is_inside(w, box))
        clip(w, site, box);
    remove_equal(w, box);
    uint32_t least = least_corner(w);
    for (uint32_t i = 0; i < w->n; i++)
        w->polygon[i] = w->corner[least + i < w->n ? least + i : least + i - w->n].at;
}

/* Examines the first `some` of corners that go around again: bit i is set if corner i has the least x. *equal: one of them
 * is equal to the next. */
static inline uint32_t find_least(const struct dt_point *centre, uint32_t some, double x,
                                  int *equal)
{
    dt_lanes before = dt_lanes_load(&centre[some].x), least = {x, (double)NAN};
    dt_lanes_holds same = {0, 0};
    uint32_t bits = 0;
    for (uint32_t i = some; i-- > 0;) {
        dt_lanes p = dt_lanes_load(&centre[i].x);
        dt_lanes_holds as_before = p == before;
        same |= as_before & (dt_lanes_holds){as_before[1], as_before[0]};
        bits = bits << 1 | (uint32_t)dt_lanes_bits(p == least);
        before = p;
    }
    *equal = dt_lanes_bits(same);
    return bits;
}

/* As dt_cell_make_plain; some >= n. */
static inline bool write_plain(struct dt_point *centre, uint32_t n, uint32_t some, double x,
                               struct dt_point *polygon)
{
    int equal;
    for (uint32_t i = 0; i < some; i++)
        dt_lanes_store(&centre[n + i].x, dt_lanes_load(&centre[i].x));
    uint32_t bits = find_least(centre, some, x, &equal) & ((1u << n) - 1);
    if (equal || (bits & (bits - 1)) != 0)
        return false;
    const struct dt_point *from = centre + __builtin_ctz(bits);
    for (uint32_t i = 0; i < some; i++)
        dt_lanes_store(&polygon[i].x, dt_lanes_load(&from[i].x));
    return true;
}

bool dt_cell_make_plain(struct dt_point *centre, uint32_t n, dt_lanes least, dt_lanes most,
                        const struct dt_box *box, struct dt_point *polygon)
{
    dt_lanes_holds inside = (least > lanes_of(box->lo)) & (most < lanes_of(box->hi));
    if (dt_lanes_bits(inside) != 3)
        return false;
    if (n <= DT_CELL_USUAL)
        return write_plain(centre, n, DT_CELL_USUAL, least[0], polygon);
    return n < 32 && write_plain(centre, n, n, least[0], polygon);
}

static bool make_plain(struct dt_cell_work *w, uint32_t n, const struct dt_box *box)
{
    dt_lanes least = lanes_of(w->centre[0]), most = least;
    for (uint32_t i = 1; i < n; i++) {
        least = dt_lanes_least(least, lanes_of(w->centre[i]));
        most = dt_lanes_most(most, lanes_of(w->centre[i]));
    }
    if (!dt_cell_make_plain(w->centre, n, least, most, box, w->polygon))
        return false;
    w->n = n;
    return true;
}

void dt_cell_make_around(struct dt_cell_work *w, struct dt_point site, uint32_t degree,
                         const struct dt_box *box)
{
    w->n = 0;
    put_centres(w, degree, degree);
    cut_polygon(w, site, box);
}

void dt_cell_make(struct dt_cell_work *w, struct dt_point site, uint32_t degree,
                  enum dt_cell_kind kind, const struct dt_box *box)
{
    w->n = 0;
    switch (kind) {
    case DT_CELL_INSIDE:
        if (find_centres(w, site, degree, degree) && !make_plain(w, degree, box))
            dt_cell_make_around(w, site, degree, box);
        return;
    case DT_CELL_ON_HULL:
        put_hull_cell(w, site, degree);
        break;
    case DT_CELL_ON_LINE:
        put_line_cell(w, site, degree);
        break;
    }
    cut_polygon(w, site, box);
}
