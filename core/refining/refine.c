/* refine.c - plans a refinement, which is carried out as a split is; see core/delaunay_constraints.h.
 *
 * The plan is made on a set of its own: the representatives in the order of their ids, the constraints between them, and
 * nothing of the history of the set. There the refiner (refiner.h) adds points. Then each constraint of which an edge
 * has been divided is replaced by its parts. */
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_surface.h"
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"
#include "core/query/query.h"
#include "core/refining/angles.h"
#include "core/refining/refiner.h"

enum { POINT_BYTES = 640 }; /* what a new point takes, with what arrays grow by */

struct plan {
    struct dt *t;
    const struct dt_quality *quality;
    const struct dt_options *opt;
    struct dt_stop *work;
    struct dt_refiner r;
    /* owns n: the representatives, ascending; point i of the refiner's set is id[i] */
    uint32_t *id;
    uint32_t *index; /* owns: of each vertex of t, that i */
    uint32_t n;
    struct dt_constraint_list old; /* owns: declared ones, and the hull's */
    size_t declared;               /* how many of them are */
};

/* ---- the set of the refiner ---- */

static enum dt_status list_points(struct plan *s)
{
    const struct dt_points *p = &s->t->points;
    s->n = dt_points_vertices(p);
    s->id = dt_array_new(s->n + (size_t)1, sizeof *s->id);
    s->index = dt_array_new(p->end + (size_t)1, sizeof *s->index);
    if (s->id == NULL || s->index == NULL)
        return DT_NOMEM;
    uint32_t k = 0;
    for (uint32_t id = dt_points_next_live(p, 0); id != DT_NONE;
         id = dt_points_next_live(p, id + 1))
        if (!dt_points_is_alias(p, id)) {
            s->index[dt_points_vertex(p, id)] = k;
            s->id[k++] = id;
        }
    return dt_work(s->work, k);
}

/* Border 0 around the hull. */
static enum dt_status list_hull(struct plan *s)
{
    uint32_t *ids = dt_array_new(s->n + (size_t)2, sizeof *ids);
    struct dt_cursor c;
    size_t rows = 0, words;
    if (ids == NULL)
        return DT_NOMEM;
    enum dt_status status = dt_table_begin(s->t, NULL, DT_HULL, false, &c);
    if (status == DT_OK)
        status = dt_table_read(s->t, &c, ids, s->n + (size_t)1, s->n, &rows, &words);
    for (size_t i = 0; i < rows && status == DT_OK; i++) {
        uint32_t a = ids[i], b = ids[i + 1 < rows ? i + 1 : 0];
        struct dt_constraint side = {a < b ? a : b, a < b ? b : a, true, 0};
        status = dt_constraint_append(&s->old, side);
    }
    dt_array_free(ids);
    return status;
}

static enum dt_status list_constraints(struct plan *s)
{
    uint32_t from = 0;
    enum dt_status status = dt_constraints_read(s->t, NULL, &from, SIZE_MAX, &s->old);
    s->declared = s->old.n;
    if (status == DT_OK && !dt_has_borders(s->t))
        status = list_hull(s);
    return status;
}

/* Sorts c[n], and leaves each once. Borders of a number that lie on one another an even number of times are none, but
 * the edge stays: as a line of the number. Returns how many are left. */
static size_t settle(struct dt_constraint *c, size_t n)
{
    size_t kept = 0, k;
    bool lines = false;
    qsort(c, n, sizeof *c, dt_constraint_compare);
    for (size_t i = 0; i < n; i += k) {
        for (k = 1; i + k < n && dt_constraint_compare(&c[i], &c[i + k]) == 0; k++)
            ;
        struct dt_constraint one = c[i];
        lines |= one.border && k % 2 == 0;
        one.border = one.border && k % 2 == 1;
        c[kept++] = one;
    }
    return lines ? settle(c, kept) : kept;
}

/* The same constraints between points of the refiner's set. */
static enum dt_status copy_constraints(struct plan *s)
{
    struct dt_constraint *c = dt_array_new(s->old.n + 1, sizeof *c);
    size_t n = 0, added;
    uint32_t missing;
    if (c == NULL)
        return DT_NOMEM;
    for (size_t i = 0; i < s->old.n; i++) {
        uint32_t a = s->index[dt_points_vertex(&s->t->points, s->old.v[i].a)];
        uint32_t b = s->index[dt_points_vertex(&s->t->points, s->old.v[i].b)];
        c[n] = s->old.v[i];
        c[n].a = a < b ? a : b;
        c[n].b = a < b ? b : a;
        n += a != b;
    }
    n = settle(c, n);
    struct dt_options opt = {.cancel = s->work->cancel, .disposable = true};
    enum dt_status status = dt_constrain(s->r.t, c, n, &opt, &added, &missing);
    dt_array_free(c);
    return status;
}

static enum dt_status copy_points(struct plan *s)
{
    struct dt_point *p = dt_array_new(s->n + (size_t)1, sizeof *p);
    struct dt_options opt = {.cancel = s->work->cancel, .disposable = true};
    struct dt_added added;
    s->r.t = dt_new_in(s->t->points.tol, s->t->points.pages);
    enum dt_status status = p == NULL || s->r.t == NULL ? DT_NOMEM : DT_OK;
    for (uint32_t i = 0; status == DT_OK && i < s->n; i++)
        p[i] = s->t->points.xy[dt_points_vertex(&s->t->points, s->id[i])];
    if (status == DT_OK)
        status = dt_add_many(s->r.t, p, s->n, &opt, &added);
    if (status == DT_OK)
        status = dt_triangulate(s->r.t, &opt);
    dt_array_free(p);
    return status;
}

static enum dt_status begin(struct plan *s)
{
    struct dt_options opt = {.cancel = s->work->cancel};
    enum dt_status status = copy_points(s);
    if (status == DT_OK)
        status = copy_constraints(s);
    if (status == DT_OK)
        status = dt_survey(s->r.t, &opt);
    if (status == DT_OK && s->t->points.tol > 0)
        status = dt_points_index(&s->r.t->points, s->work);
    if (status == DT_OK)
        status = dt_enclosure_of(s->r.t, s->quality->number, &s->r.in);
    if (status == DT_OK && !dt_has_closed_border(s->r.t))
        status = DT_OPEN;
    s->r.given = s->r.t == NULL ? 0 : s->r.t->points.end;
    s->r.most =
        s->quality->most < DT_MAX_POINTS - s->n ? (uint32_t)s->quality->most : DT_MAX_POINTS - s->n;
    s->r.granted = s->quality->reserve == NULL ? s->r.most : 0;
    return status;
}

/* ---- what it comes to ---- */

static int compare_halved(const void *a, const void *b)
{
    const struct dt_halved *p = a, *q = b;
    return p->a != q->a ? (p->a > q->a) - (p->a < q->a) : (p->b > q->b) - (p->b < q->b);
}

/* The vertex that divides the edge, DT_NONE if it is whole. */
static uint32_t middle_of(const struct dt_refiner *r, uint32_t a, uint32_t b)
{
    struct dt_halved key = {a < b ? a : b, a < b ? b : a, DT_NONE};
    const struct dt_halved *h =
        r->n_halved == 0 ? NULL : bsearch(&key, r->halved, r->n_halved, sizeof key, compare_halved);
    return h == NULL ? DT_NONE : h->middle;
}

/* The vertex of the refiner's set that is vertex v of t. */
static uint32_t copy_of(const struct plan *s, uint32_t v)
{
    return dt_points_vertex(&s->r.t->points, s->index[v]);
}

/* The id that a vertex of the refiner's set has, or gets. */
static uint32_t id_of(const struct plan *s, uint32_t v)
{
    uint32_t k = s->r.t->points.id[v];
    return k < s->n ? s->id[k] : s->t->points.next_id + (k - s->n);
}

/* The parts of one constraint. */
struct parts {
    struct dt_constraint_list *out;
    struct dt_constraint whole;
    uint32_t from; /* where the next part begins: an id */
};

static enum dt_status end_part(struct parts *p, uint32_t id)
{
    struct dt_constraint c = p->whole;
    c.a = p->from < id ? p->from : id;
    c.b = p->from < id ? id : p->from;
    p->from = id;
    return c.a == c.b ? DT_OK : dt_constraint_append(p->out, c);
}

/* Those of the edge from a to b, vertices of the refiner's set, but for the end of the last one. */
static enum dt_status cut_edge(const struct plan *s, uint32_t a, uint32_t b, struct parts *p)
{
    uint32_t middle = middle_of(&s->r, a, b);
    if (middle == DT_NONE)
        return DT_OK;
    enum dt_status status = cut_edge(s, a, middle, p);
    if (status == DT_OK)
        status = end_part(p, id_of(s, middle));
    return status == DT_OK ? cut_edge(s, middle, b, p) : status;
}

/* The vertex that follows v on the constraint that ends at `end`: the next one of its chain, or of a side of the hull its end. */
static uint32_t next_on_way(const struct plan *s, uint32_t v, uint32_t end, bool declared)
{
    const struct dt_mesh *m = &s->t->mesh;
    const struct dt_point *xy = s->t->points.xy;
    return declared ? dt_dest(m, dt_chain_next(m, xy, m->leaving[v], xy[end])) : end;
}

/* Appends the parts of the constraint to *out; none if no edge of it has been divided. */
static enum dt_status cut_constraint(const struct plan *s, const struct dt_constraint *c,
                                     bool declared, struct dt_constraint_list *out)
{
    uint32_t v = dt_points_vertex(&s->t->points, c->a), end = dt_points_vertex(&s->t->points, c->b);
    uint32_t begin = v;
    struct parts p = {out, *c, c->a};
    enum dt_status status = DT_OK;
    while (v != end && status == DT_OK) {
        uint32_t w = next_on_way(s, v, end, declared);
        uint32_t a = copy_of(s, v), b = copy_of(s, w);
        if (middle_of(&s->r, a, b) != DT_NONE) {
            if (v != begin)
                status = end_part(&p, s->t->points.id[v]);
            if (status == DT_OK)
                status = cut_edge(s, a, b, &p);
            if (status == DT_OK && w != end)
                status = end_part(&p, s->t->points.id[w]);
        }
        v = w;
    }
    return p.from == c->a || status != DT_OK ? status : end_part(&p, c->b);
}

/* Drops what is declared already, and takes away in pairs what would be a border twice. */
static void settle_with(const struct plan *s, struct dt_split *out)
{
    const struct dt_declared *d = s->t->constraints == NULL ? NULL : &s->t->constraints->declared;
    size_t n = settle(out->added, out->n_added), kept = 0, released = out->n_released;
    bool lines = false;
    for (size_t i = 0; i < n; i++) {
        struct dt_constraint c = out->added[i];
        bool there = d != NULL && d->rows > 0 && dt_declared_find(d, &c) != DT_NONE &&
                     !dt_constraint_among(out->released, released, &c);
        if (there && c.border) {
            out->released[out->n_released++] = c;
            c.border = false;
            lines = true;
            there = false;
        }
        if (!there)
            out->added[kept++] = c;
    }
    out->n_added = kept;
    qsort(out->released, out->n_released, sizeof *out->released, dt_constraint_compare);
    if (lines)
        settle_with(s, out);
}

static enum dt_status write_constraints(struct plan *s, struct dt_split *out)
{
    struct dt_constraint_list added = {0};
    enum dt_status status = DT_OK;
    if (s->r.n_halved > 0)
        qsort(s->r.halved, s->r.n_halved, sizeof *s->r.halved, compare_halved);
    out->released = malloc((2 * s->declared + 1) * sizeof *out->released);
    if (out->released == NULL)
        return DT_NOMEM;
    for (size_t i = 0; i < s->old.n && status == DT_OK; i++) {
        size_t before = added.n;
        status = cut_constraint(s, &s->old.v[i], i < s->declared, &added);
        bool cut = added.n > before;
        out->split += cut;
        if (cut && i < s->declared)
            out->released[out->n_released++] = s->old.v[i];
        if (!cut && i >= s->declared && status == DT_OK)
            status = dt_constraint_append(&added, s->old.v[i]);
        if (status == DT_OK && (i & DT_WORK_MASK) == 0)
            status = dt_work(s->work, DT_WORK_BLOCK);
    }
    out->added = added.v;
    out->n_added = added.n;
    if (status == DT_OK && added.n > 0)
        settle_with(s, out);
    return status;
}

static enum dt_status write_points(const struct plan *s, struct dt_split *out)
{
    const struct dt_points *p = &s->r.t->points;
    out->n_points = p->end - s->r.given;
    out->point = malloc((out->n_points + 1) * sizeof *out->point);
    if (out->point == NULL)
        return DT_NOMEM;
    memcpy(out->point, p->xy + s->r.given, out->n_points * sizeof *out->point);
    return DT_OK;
}

/* The value at a new point on an edge of the beginning is linear between the ends. */
static void value_on_edge(const struct plan *s, const struct dt_field *f, uint32_t k, double *value)
{
    const struct dt_part *e = &s->r.edge[k];
    if (e->a == DT_NONE)
        return;
    const struct dt_point *xy = s->r.t->points.xy, at = xy[s->r.given + k];
    const uint32_t end[] = {id_of(s, e->a), id_of(s, e->b)};
    double v[2], dx = xy[e->b].x - xy[e->a].x, dy = xy[e->b].y - xy[e->a].y;
    dt_field_values(f, NULL, end, 2, v);
    double t = ((at.x - xy[e->a].x) * dx + (at.y - xy[e->a].y) * dy) / (dx * dx + dy * dy);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    *value = v[0] == v[1] ? v[0] : (1 - t) * v[0] + t * v[1];
}

static enum dt_status write_field(const struct plan *s, const struct dt_field *f, double *value,
                                  const struct dt_split *out)
{
    struct dt_surface surface = {.how = DT_LINEAR, .max_edge = HUGE_VAL};
    struct dt_options opt = {.cancel = s->work->cancel};
    size_t done;
    enum dt_status status = dt_surface_begin(&surface, f, NULL);
    if (status != DT_OK)
        return status;
    status = dt_values(s->t, &surface, out->point, out->n_points, &opt, value, &done);
    dt_surface_end(&surface);
    for (uint32_t k = 0; status == DT_OK && k < out->n_points; k++)
        value_on_edge(s, f, k, &value[k]);
    return status;
}

static enum dt_status write_values(const struct plan *s, struct dt_split *out)
{
    size_t n = out->n_points, fields = n == 0 ? 0 : s->t->fields.n;
    out->column = malloc((fields + 1) * sizeof *out->column);
    out->value = malloc((n * fields + 1) * sizeof *out->value);
    const struct dt_field *f = NULL;
    enum dt_status status = out->column == NULL || out->value == NULL ? DT_NOMEM : DT_OK;
    while (status == DT_OK && n > 0 && (f = dt_field_next(s->t, NULL, f)) != NULL) {
        double *v = out->value + out->columns * n;
        const char *name = dt_field_name(f);
        status = write_field(s, f, v, out);
        out->column[out->columns++] = (struct dt_values_of){name, strlen(name), v};
    }
    return status;
}

/* Memory for what n new points take: reserved by the caller, as the refiner goes on. */
static enum dt_status grant(void *ctx, uint32_t n)
{
    const struct plan *s = ctx;
    return s->quality->reserve(s->quality->ctx, dt_refine_memory(s->t, n));
}

/* Counts the triangles inside that are not as wanted, and finds the least angle. */
static void measure(const struct plan *s, struct dt_refined *out)
{
    const struct dt_mesh *m = &s->r.t->mesh;
    const struct dt_point *xy = s->r.t->points.xy;
    struct dt_angles angles = {0};
    for (uint32_t h = 0; h < 8 * m->tri_end; h += 8) {
        struct dt_shape shape;
        if (dt_is_dead(m, h) || dt_is_ghost(m, h) || !dt_encloses(&s->r.in, dt_face(m, h)))
            continue;
        dt_shape_of(xy[m->half[h]], xy[m->half[h + 1]], xy[m->half[h + 2]], &shape);
        out->unrefined += dt_shape_breaks(&s->r.wanted, &shape) != 0;
        dt_angles_add(&angles, &shape);
    }
    out->angle = angles.any ? dt_degrees(angles.least) : (double)NAN;
}

/* ---- all of it ---- */

static bool is_limit(double v)
{
    return v >= 0 && v < HUGE_VAL;
}

static enum dt_status plan(struct plan *s, struct dt_refined *out)
{
    enum dt_status status = list_points(s);
    if (status == DT_OK)
        status = list_constraints(s);
    if (status == DT_OK)
        status = begin(s);
    out->hull = s->old.n - s->declared;
    if (status == DT_OK)
        status = dt_refiner_run(&s->r);
    if (status == DT_OK)
        measure(s, out);
    if (status == DT_OK)
        status = write_points(s, &out->change);
    if (status == DT_OK)
        status = write_constraints(s, &out->change);
    return status == DT_OK ? write_values(s, &out->change) : status;
}

size_t dt_refine_memory(const struct dt *t, size_t points)
{
    size_t n = dt_points_vertices(&t->points);
    return (n + points) * (POINT_BYTES + t->fields.n * sizeof(double)) +
           dt_constraints_count(t) * (size_t)512;
}

enum dt_status dt_plan_refine(struct dt *t, const struct dt_quality *q,
                              const struct dt_options *opt, struct dt_refined *out)
{
    struct dt_stop work = dt_stop_of(opt);
    memset(out, 0, sizeof *out);
    out->angle = (double)NAN;
    if (!(is_limit(q->angle) && q->angle < 60 && is_limit(q->area) && is_limit(q->length)))
        return DT_RANGE;
    if (!t->triangulated)
        return DT_UNTRIANGULATED;
    enum dt_status status = dt_refresh(t, opt);
    if (status != DT_OK)
        return status;
    if (q->number != DT_NONE && !dt_has_borders(t))
        return DT_NOREGION;
    if (t->mesh.vertices < 3 || dt_mesh_is_line(&t->mesh))
        return DT_OK;
    struct plan s = {.t = t, .quality = q, .opt = opt, .work = &work};
    s.r.work = &work;
    s.r.grant = grant;
    s.r.ctx = &s;
    s.r.keep = q->keep;
    dt_queue_init(&s.r.queue);
    dt_wanted_of(q, &s.r.wanted);
    if (t->fields.n > 0) /* values will be looked up */
        dt_tend(t, &work);
    status = plan(&s, out);
    if (status != DT_OK)
        dt_split_clear(&out->change);
    dt_refiner_clear(&s.r);
    dt_array_free(s.id);
    dt_array_free(s.index);
    free(s.old.v);
    return status;
}
