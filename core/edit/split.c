/* split.c - plans points and parts, so that constraints that cross share points; see core/delaunay_constraints.h.
 *
 * A round finds all crossings of the existing parts, rounds each crossing to a place, and cuts the parts at that place.
 * Rounding moves parts, so that these may cross others in the next round. Two parts that are almost parallel could cross
 * again for many rounds, one unit of the last place further each time. So from the second round on, such parts
 * are cut at an end of one of them if that end is near the other: within one unit, two, four and so on.
 *
 * Nothing depends on the order of constraints: crossings are found exactly, and new points are numbered in the order of
 * their places. Rounding is monotone, so that places follow one another along a part as the crossings do. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/constraints/crossings.h"
#include "core/delaunay_fields.h"
#include "core/edit/constrain.h"
#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "core/exact/vectors.h"
#include "core/memory/memory.h"
#include "core/query/query.h"

enum { ROUNDS = 16 };

/* A part of a constraint, or a whole constraint. */
struct part {
    uint32_t end[2]; /* ids, or those that new points will get */
    uint32_t origin; /* the constraint */
    bool fresh;      /* made in the last round */
};

/* A constraint that is declared, or is asked for. */
struct origin {
    struct dt_constraint c;
    bool declared, cut;
};

/* A place at which a part is cut. */
struct cut {
    uint32_t part, id;
    struct dt_point at, along; /* the place; the same, ascending along the part */
};

struct plan {
    struct dt *t;
    struct dt_stop *work;
    struct dt_points fresh; /* the new points; their vertices are in order */
    struct origin *origin;  /* owns */
    size_t origins;
    struct part *part; /* owns */
    size_t parts;
    struct cut *cut; /* owns; of this round */
    size_t cuts, cut_cap;
    struct dt_segment *segment; /* owns; of the parts of this round */
    struct dt_pairs pairs;
};

/* Whether the places of points are looked up by their index. Otherwise the mesh serves: it exists, and the tolerance is 0. */
static bool needs_index(const struct dt *t)
{
    return t->points.tol > 0 || !dt_is_live(t);
}

/* ---- points that are there and those that are new ---- */

/* The id that stands for the id. */
static uint32_t representative(const struct plan *s, uint32_t id)
{
    const struct dt_points *p = &s->t->points;
    return id < p->next_id ? p->id[dt_points_vertex(p, id)] : id;
}

static struct dt_point place_of(const struct plan *s, uint32_t id)
{
    const struct dt_points *p = &s->t->points;
    return id < p->next_id ? p->xy[dt_points_vertex(p, id)] : s->fresh.xy[id - p->next_id];
}

/* The representative that a point at q would coincide with, DT_NONE if there is none. */
static uint32_t point_at(const struct plan *s, struct dt_point q)
{
    const struct dt *t = s->t;
    uint32_t half, v = DT_NONE;
    if (needs_index(t))
        v = dt_points_find(&t->points, q, DT_NONE);
    else if (dt_place_find(t, q, DT_NONE, &half) == DT_ON_VERTEX)
        v = dt_origin(&t->mesh, half);
    if (v != DT_NONE)
        return t->points.id[v];
    v = dt_points_find(&s->fresh, q, DT_NONE);
    return v == DT_NONE ? DT_NONE : t->points.next_id + v;
}

/* The same; if there is none, a new point is made. */
static enum dt_status take_point_at(struct plan *s, struct dt_point q, uint32_t *id)
{
    *id = point_at(s, q);
    if (*id != DT_NONE)
        return DT_OK;
    if (dt_points_vertices(&s->fresh) >= UINT32_MAX - 1 - s->t->points.next_id)
        return DT_TOOBIG;
    enum dt_status status = dt_points_reserve(&s->fresh, 1, NULL);
    if (status != DT_OK)
        return status;
    *id = s->t->points.next_id + dt_points_enter(&s->fresh, s->fresh.next_id, q);
    dt_points_arrived(&s->fresh, 1);
    return DT_OK;
}

/* ---- the constraints ---- */

static int compare_constraints(const void *a, const void *b)
{
    return dt_constraint_compare(&((const struct origin *)a)->c, &((const struct origin *)b)->c);
}

/* Lists the declared constraints, and then the constraints of c[n] that are not declared, sorted; each once. */
static enum dt_status list_origins(struct plan *s, const struct dt_constraint *c, size_t n)
{
    const struct dt_declared *d = s->t->constraints == NULL ? NULL : &s->t->constraints->declared;
    size_t k = 0, kept, declared = d == NULL ? 0 : d->rows;
    s->origin = dt_array_new(declared + n + 1, sizeof *s->origin);
    if (s->origin == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; d != NULL && i < d->end; i++)
        if (dt_declared_is_live(d, i))
            s->origin[k++] = (struct origin){dt_declared_get(d, i), true, false};
    for (size_t i = kept = 0; i < n; i++)
        if (declared == 0 || dt_declared_find(d, &c[i]) == DT_NONE)
            s->origin[k + kept++] = (struct origin){dt_constraint_ascending(c[i]), false, false};
    qsort(s->origin + k, kept, sizeof *s->origin, compare_constraints);
    size_t first = k;
    for (size_t i = first; i < first + kept; i++)
        if (k == first || compare_constraints(&s->origin[k - 1], &s->origin[i]) != 0)
            s->origin[k++] = s->origin[i];
    s->origins = k;
    return k > DT_MAX_CONSTRAINTS ? DT_TOOBIG : dt_work(s->work, k);
}

static enum dt_status begin_parts(struct plan *s)
{
    s->part = dt_array_new(s->origins + 1, sizeof *s->part);
    if (s->part == NULL)
        return DT_NOMEM;
    for (size_t i = 0; i < s->origins; i++) {
        const struct dt_constraint *c = &s->origin[i].c;
        bool fresh = !s->origin[i].declared || !s->t->triangulated; /* else they do not cross */
        s->part[i] = (struct part){{c->a, c->b}, (uint32_t)i, fresh};
    }
    s->parts = s->origins;
    return DT_OK;
}

/* ---- a round ---- */

static enum dt_status find_crossings(struct plan *s)
{
    dt_array_free(s->segment);
    s->segment = dt_array_new(s->parts + 1, sizeof *s->segment);
    if (s->segment == NULL)
        return DT_NOMEM;
    for (size_t i = 0; i < s->parts; i++) {
        const struct part *p = &s->part[i];
        s->segment[i] =
            (struct dt_segment){place_of(s, p->end[0]), place_of(s, p->end[1]), p->fresh};
    }
    return dt_crossings(s->segment, s->parts, s->work, &s->pairs);
}

/* Whether a point is exactly where the two segments cross; q: that place, rounded. */
static bool meet_at_point(const struct plan *s, const struct dt_segment *a,
                          const struct dt_segment *b, struct dt_point q)
{
    if (dt_orient2d(a->p, a->q, q) != 0 || dt_orient2d(b->p, b->q, q) != 0)
        return false;
    uint32_t id = point_at(s, q);
    return id != DT_NONE && dt_compare_xy(place_of(s, id), q) == 0;
}

static double size_of(struct dt_point p)
{
    return dt_greater(fabs(p.x), fabs(p.y));
}

/* The distance of r from the line through p and q. */
static double distance(struct dt_point p, struct dt_point q, struct dt_point r)
{
    struct dt_vector2 d = dt_vector2_of(p, q);
    return fabs(dt_vector2_cross(d, dt_vector2_of(p, r)).value.hi) / hypot(d.x.hi, d.y.hi);
}

static bool is_between(double a, double b, double v, double slack)
{
    return v >= fmin(a, b) - slack && v <= fmax(a, b) + slack;
}

/* The place at which two segments that cross at q are cut. It is the end of one segment that is nearest to the other segment,
 * if it is near enough; else q. */
static struct dt_point move_to_end(const struct dt_segment *a, const struct dt_segment *b,
                                   struct dt_point q, int round)
{
    const struct dt_point end[] = {a->p, a->q, b->p, b->q};
    const double near = ldexp(size_of(q), round - 53);
    struct dt_point best = q;
    double least = HUGE_VAL;
    for (int i = 0; i < 4; i++) {
        const struct dt_segment *other = i < 2 ? b : a;
        if (!is_between(other->p.x, other->q.x, end[i].x, near) ||
            !is_between(other->p.y, other->q.y, end[i].y, near))
            continue;
        double d = distance(other->p, other->q, end[i]);
        if (d <= near && (d < least || (d == least && dt_compare_xy(end[i], best) < 0))) {
            best = end[i];
            least = d;
        }
    }
    return best;
}

static struct cut cut_of(const struct plan *s, uint32_t part, struct dt_point q)
{
    const struct dt_segment *g = &s->segment[part];
    struct dt_point along = {g->p.x <= g->q.x ? q.x : -q.x, g->p.y <= g->q.y ? q.y : -q.y};
    return (struct cut){part, DT_NONE, q, along};
}

/* Lists the cuts of every crossing, one after the other. */
static enum dt_status list_cuts(struct plan *s, int round)
{
    enum dt_status status = find_crossings(s);
    s->cuts = 0;
    for (size_t i = 0; i < s->pairs.n && status == DT_OK; i++) {
        uint32_t a = (uint32_t)(s->pairs.v[i] >> 32), b = (uint32_t)s->pairs.v[i];
        struct dt_point q = dt_crossing_place(&s->segment[a], &s->segment[b]);
        status = dt_work(s->work, 16);
        if (status != DT_OK || meet_at_point(s, &s->segment[a], &s->segment[b], q))
            continue;
        if (round > 0)
            q = move_to_end(&s->segment[a], &s->segment[b], q, round);
        if (dt_items_reserve(&s->cut, s->cuts + 2, &s->cut_cap, sizeof *s->cut) != DT_OK)
            return DT_NOMEM;
        s->cut[s->cuts++] = cut_of(s, a, q);
        s->cut[s->cuts++] = cut_of(s, b, q);
    }
    return status;
}

static int compare_places(const void *a, const void *b)
{
    return dt_compare_xy(((const struct cut *)a)->at, ((const struct cut *)b)->at);
}

static int compare_along(const void *a, const void *b)
{
    const struct cut *p = a, *q = b;
    return p->part != q->part ? (p->part > q->part) - (p->part < q->part)
                              : dt_compare_xy(p->along, q->along);
}

/* Gives the cuts their points, in the order of their places. */
static enum dt_status take_points(struct plan *s)
{
    enum dt_status status = DT_OK;
    qsort(s->cut, s->cuts, sizeof *s->cut, compare_places);
    for (size_t i = 0; i < s->cuts && status == DT_OK; i++)
        if (i > 0 && compare_places(&s->cut[i - 1], &s->cut[i]) == 0)
            s->cut[i].id = s->cut[i - 1].id;
        else
            status = take_point_at(s, s->cut[i].at, &s->cut[i].id);
    qsort(s->cut, s->cuts, sizeof *s->cut, compare_along);
    return status;
}

/* Appends the pieces of part i, which has the cuts from *c on, to out[n]; returns the new number of pieces. */
static size_t cut_part(struct plan *s, uint32_t i, size_t *c, struct part *out, size_t n)
{
    struct part whole = s->part[i];
    uint32_t last = representative(s, whole.end[1]), before = representative(s, whole.end[0]);
    size_t first = n;
    whole.fresh = false;
    out[n++] = whole;
    for (; *c < s->cuts && s->cut[*c].part == i; ++*c) {
        uint32_t id = s->cut[*c].id;
        if (id == before || id == last)
            continue;
        out[n - 1].end[1] = before = id;
        out[n++] = (struct part){{id, whole.end[1]}, whole.origin, false};
    }
    for (size_t k = first; k < n && n > first + 1; k++)
        out[k].fresh = true;
    s->origin[whole.origin].cut |= n > first + 1;
    return n;
}

static enum dt_status cut_parts(struct plan *s)
{
    struct part *out = dt_array_new(s->parts + s->cuts + 1, sizeof *out);
    size_t n = 0, c = 0;
    if (out == NULL)
        return DT_NOMEM;
    for (size_t i = 0; i < s->parts; i++)
        n = cut_part(s, (uint32_t)i, &c, out, n);
    dt_array_free(s->part);
    s->part = out;
    s->parts = n;
    return n > DT_MAX_CONSTRAINTS ? DT_TOOBIG : DT_OK;
}

/* ---- the values of fields at new points ---- */

/* The range of the values that the constraints through a point give it. */
struct opinion {
    uint32_t known; /* how many say something */
    double least, most;
};

/* The value at the place of constraint c, linear between its ends; nan if one of them has none. */
static double value_along(const struct plan *s, const struct dt_field *f,
                          const struct dt_constraint *c, struct dt_point at)
{
    const uint32_t end[] = {c->a, c->b};
    double v[2];
    dt_field_values(f, NULL, end, 2, v);
    struct dt_point p = place_of(s, c->a), q = place_of(s, c->b);
    double dx = q.x - p.x, dy = q.y - p.y;
    double t = ((at.x - p.x) * dx + (at.y - p.y) * dy) / (dx * dx + dy * dy);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return v[0] == v[1] ? v[0] : (1 - t) * v[0] + t * v[1];
}

/* The number of the new point at which the part begins; DT_NONE: it begins at an existing point. */
static uint32_t begins_at(const struct plan *s, const struct part *p)
{
    return p->end[0] < s->t->points.next_id ? DT_NONE : p->end[0] - s->t->points.next_id;
}

/* The values of the field at the n new points: the mean of the values on the constraints through each. Whether there are any. */
static bool interpolate(const struct plan *s, const struct dt_field *f, struct opinion *o,
                        double *out, size_t n)
{
    bool any = false;
    for (size_t i = 0; i < n; i++) {
        o[i] = (struct opinion){0, HUGE_VAL, -HUGE_VAL};
        out[i] = 0;
    }
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < s->parts; i++) {
            uint32_t k = begins_at(s, &s->part[i]);
            double v = k == DT_NONE
                           ? (double)NAN
                           : value_along(s, f, &s->origin[s->part[i].origin].c, s->fresh.xy[k]);
            if (isnan(v))
                continue;
            if (pass == 0)
                o[k] = (struct opinion){o[k].known + 1, fmin(o[k].least, v), fmax(o[k].most, v)};
            else
                out[k] += v / o[k].known;
        }
    for (size_t i = 0; i < n; i++) {
        any |= o[i].known > 0;
        out[i] = o[i].known == 0 ? (double)NAN : fmin(fmax(out[i], o[i].least), o[i].most);
    }
    return any;
}

static enum dt_status write_values(const struct plan *s, struct dt_split *out)
{
    size_t n = out->n_points, fields = n == 0 ? 0 : s->t->fields.n;
    struct opinion *o = dt_array_new(n + 1, sizeof *o);
    out->column = malloc((fields + 1) * sizeof *out->column);
    out->value = malloc((n * fields + 1) * sizeof *out->value);
    const struct dt_field *f = NULL;
    bool room = o != NULL && out->column != NULL && out->value != NULL;
    while (room && n > 0 && (f = dt_field_next(s->t, NULL, f)) != NULL) {
        double *v = out->value + out->columns * n;
        const char *name = dt_field_name(f);
        if (interpolate(s, f, o, v, n))
            out->column[out->columns++] = (struct dt_values_of){name, strlen(name), v};
    }
    dt_array_free(o);
    return room ? DT_OK : DT_NOMEM;
}

/* ---- what is left ---- */

/* The least constraints of which parts still cross. */
static void name_crossing(const struct plan *s, struct dt_crossed *out)
{
    bool found = false;
    for (size_t i = 0; i < s->cuts; i += 2) {
        struct dt_constraint a = s->origin[s->part[s->cut[i].part].origin].c;
        struct dt_constraint b = s->origin[s->part[s->cut[i + 1].part].origin].c;
        bool swap = dt_constraint_compare(&a, &b) > 0;
        struct dt_crossed pair = {swap ? b : a, swap ? a : b};
        int sign = found ? dt_constraint_compare(&pair.one, &out->one) : -1;
        if (sign == 0)
            sign = dt_constraint_compare(&pair.other, &out->other);
        if (sign < 0)
            *out = pair;
        found = true;
    }
}

static double deviation_of(const struct plan *s)
{
    double most = 0;
    for (size_t i = 0; i < s->parts; i++) {
        const struct dt_constraint *c = &s->origin[s->part[i].origin].c;
        if (s->origin[s->part[i].origin].cut && s->part[i].end[0] != c->a) {
            double d =
                distance(place_of(s, c->a), place_of(s, c->b), place_of(s, s->part[i].end[0]));
            most = d > most ? d : most;
        }
    }
    return most;
}

/* Sorts out->added[n], and leaves each once. An even number of borders that have come to lie on one another cancel out,
 * so that closed borders remain closed. A border that is declared already counts. */
static void settle_added(const struct plan *s, size_t n, struct dt_split *out)
{
    const struct dt_declared *d = s->t->constraints == NULL ? NULL : &s->t->constraints->declared;
    struct dt_constraint *c = out->added;
    size_t released = out->n_released;
    qsort(c, n, sizeof *c, dt_constraint_compare);
    for (size_t i = 0, k = 0; i < n; i += k) {
        for (k = 1; i + k < n && dt_constraint_compare(&c[i], &c[i + k]) == 0; k++)
            ;
        bool there = d != NULL && d->rows > 0 && dt_declared_find(d, &c[i]) != DT_NONE &&
                     !dt_constraint_among(out->released, released, &c[i]);
        bool stays = !c[i].border || (k + there) % 2 == 1;
        if (stays && !there)
            c[out->n_added++] = c[i];
        if (!stays && there)
            out->released[out->n_released++] = c[i];
    }
    qsort(out->released, out->n_released, sizeof *c, dt_constraint_compare);
}

static enum dt_status write_plan(const struct plan *s, struct dt_split *out)
{
    size_t n = 0;
    out->point = malloc((dt_points_vertices(&s->fresh) + (size_t)1) * sizeof *out->point);
    out->added = malloc((s->parts + 1) * sizeof *out->added);
    out->released = malloc((s->origins + 1) * sizeof *out->released);
    if (out->point == NULL || out->added == NULL || out->released == NULL)
        return DT_NOMEM;
    out->n_points = dt_points_vertices(&s->fresh);
    for (size_t i = 0; i < out->n_points; i++)
        out->point[i] = s->fresh.xy[i];
    for (size_t i = 0; i < s->origins; i++) {
        out->split += s->origin[i].cut;
        if (s->origin[i].cut && s->origin[i].declared)
            out->released[out->n_released++] = s->origin[i].c;
    }
    qsort(out->released, out->n_released, sizeof *out->released, dt_constraint_compare);
    for (size_t i = 0; i < s->parts; i++) {
        const struct origin *o = &s->origin[s->part[i].origin];
        if (o->cut || !o->declared)
            out->added[n++] = dt_constraint_ascending((struct dt_constraint){
                s->part[i].end[0], s->part[i].end[1], o->c.border, o->c.number});
    }
    settle_added(s, n, out);
    out->deviation = deviation_of(s);
    return write_values(s, out);
}

/* ---- all of it ---- */

static enum dt_status plan(struct plan *s, const struct dt_constraint *c, size_t n,
                           struct dt_split *out)
{
    enum dt_status status = list_origins(s, c, n);
    if (status == DT_OK)
        status = begin_parts(s);
    if (status == DT_OK)
        status = list_cuts(s, 0);
    for (int round = 1; status == DT_OK && s->cuts > 0 && round <= ROUNDS; round++) {
        status = take_points(s);
        if (status == DT_OK)
            status = cut_parts(s);
        if (status == DT_OK)
            status = list_cuts(s, round);
    }
    if (status == DT_OK && s->cuts > 0) {
        name_crossing(s, &out->crossed);
        return DT_CROSSES;
    }
    return status == DT_OK ? write_plan(s, out) : status;
}

static void clear(struct plan *s)
{
    dt_points_clear(&s->fresh);
    dt_array_free(s->origin);
    dt_array_free(s->part);
    free(s->cut);
    dt_array_free(s->segment);
    free(s->pairs.v);
}

void dt_split_clear(struct dt_split *out)
{
    free(out->point);
    free(out->added);
    free(out->released);
    free(out->column);
    free(out->value);
    *out = (struct dt_split){.crossed = out->crossed};
}

size_t dt_split_memory(const struct dt *t, size_t n, size_t crossings)
{
    const size_t constraint = 160, crossing = 512; /* with what arrays grow by */
    return (n + dt_constraints_count(t)) * constraint +
           crossings * (crossing + t->fields.n * sizeof(double));
}

enum dt_status dt_plan_split(struct dt *t, const struct dt_constraint *c, size_t n,
                             size_t crossings, const struct dt_options *opt, struct dt_split *out,
                             uint32_t *missing)
{
    struct dt_stop work = dt_stop_of(opt);
    struct plan s = {.t = t, .work = &work, .pairs.most = crossings};
    memset(out, 0, sizeof *out);
    enum dt_status status = dt_constrainable(t, c, n, missing);
    if (status == DT_OK && needs_index(t))
        status = dt_points_index(&t->points, &work);
    if (status != DT_OK)
        return status;
    dt_tend(t, &work); /* places are looked up */
    dt_points_init(&s.fresh, t->points.tol, NULL);
    status = dt_points_index(&s.fresh, NULL);
    if (status == DT_OK)
        status = plan(&s, c, n, out);
    if (status != DT_OK)
        dt_split_clear(out);
    clear(&s);
    return status;
}
