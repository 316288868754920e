/* constrain.c - declares and releases constraints; see core/delaunay_constraints.h.
 *
 * In a live set, each constraint first becomes a chain of edges, and is declared when that has succeeded. If one fails,
 * the constraints before it are released again: the triangulation is canonical, so this restores the previous one. Many
 * constraints are declared first, and become edges in the order of memory. If some cross, they are tried one by one, so
 * that the first is named. */
#include "core/edit/constrain.h"

#include <stdlib.h>

#include "core/constraints/march.h"
#include "core/edit/update.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"
#include "core/mesh/fixed.h"

/* ---- one constraint and the mesh ---- */

static struct dt_enforcer *enforcer(struct dt *t)
{
    struct dt_enforcer *e = &t->constraints->enforcer;
    e->mesh = &t->mesh;
    e->xy = t->points.xy;
    e->changes = t->scratch.changes;
    return e;
}

static bool have_opposite_sides(struct dt_point a, struct dt_point b, struct dt_point p,
                                struct dt_point q)
{
    return dt_orient2d(a, b, p) * dt_orient2d(a, b, q) < 0;
}

/* Whether the constraint between p and q covers one of the edges that the way from a to b crosses. */
static bool covers_crossed(const struct dt *t, struct dt_point p, struct dt_point q)
{
    const struct dt_ids *crossed = &t->constraints->enforcer.crossed;
    for (size_t i = 0; i < crossed->n; i++) {
        struct dt_point u = t->points.xy[dt_origin(&t->mesh, crossed->v[i])];
        struct dt_point w = t->points.xy[dt_dest(&t->mesh, crossed->v[i])];
        if (dt_orient2d(p, q, u) == 0 && dt_orient2d(p, q, w) == 0)
            return true;
    }
    return false;
}

/* Whether a declared constraint crosses the way between a and b that was just found. */
static bool crosses(const struct dt *t, const struct dt_constraint *c, struct dt_point a,
                    struct dt_point b)
{
    uint32_t v = dt_points_vertex(&t->points, c->a), w = dt_points_vertex(&t->points, c->b);
    struct dt_point p = t->points.xy[v], q = t->points.xy[w];
    return v != w && have_opposite_sides(a, b, p, q) && have_opposite_sides(p, q, a, b) &&
           covers_crossed(t, p, q);
}

/* Two that cross: *out becomes these, unless it is found already and comes first. */
static void keep_first(struct dt_crossed *out, struct dt_constraint a, struct dt_constraint b,
                       bool *found)
{
    bool swap = dt_constraint_compare(&a, &b) < 0;
    struct dt_crossed pair = {swap ? b : a, swap ? a : b};
    int sign = *found ? dt_constraint_compare(&pair.one, &out->one) : -1;
    if (sign == 0)
        sign = dt_constraint_compare(&pair.other, &out->other);
    if (sign < 0)
        *out = pair;
    *found = true;
}

enum dt_status dt_name_crossed(struct dt *t, uint32_t id, struct dt_stop *work)
{
    const struct dt_declared *d = &t->constraints->declared;
    bool found = false;
    for (uint32_t row = dt_declared_first(d, id); row != DT_NONE;
         row = dt_declared_next(d, row, id)) {
        enum dt_status status = dt_work(work, d->rows);
        if (status != DT_OK)
            return status;
        struct dt_constraint own = dt_declared_get(d, row);
        uint32_t a = dt_points_vertex(&t->points, own.a), b = dt_points_vertex(&t->points, own.b);
        if (a == b || dt_enforce_look(enforcer(t), a, b, NULL) != DT_OK ||
            t->constraints->enforcer.crossed.n == 0)
            continue;
        for (uint32_t i = 0; i < d->end; i++) {
            struct dt_constraint other = dt_declared_get(d, i);
            if (dt_declared_is_live(d, i) && crosses(t, &other, t->points.xy[a], t->points.xy[b]))
                keep_first(&t->constraints->crossed, own, other, &found);
        }
    }
    return DT_CROSSES;
}

/* Finds the least constraint that the way of c, which was looked at last, crosses. Cost: the number of constraints. */
static void report_crossing(struct dt *t, const struct dt_constraint *c)
{
    struct dt_point a = t->points.xy[dt_points_vertex(&t->points, c->a)];
    struct dt_point b = t->points.xy[dt_points_vertex(&t->points, c->b)];
    const struct dt_declared *d = &t->constraints->declared;
    struct dt_crossed *out = &t->constraints->crossed;
    bool found = false;
    out->one = *c;
    for (uint32_t i = 0; i < d->end; i++) {
        if (!dt_declared_is_live(d, i))
            continue;
        struct dt_constraint other = dt_declared_get(d, i);
        if ((found && dt_constraint_compare(&other, &out->other) >= 0) || !crosses(t, &other, a, b))
            continue;
        out->other = other;
        found = true;
    }
}

/* A border comes, goes or moves. */
static void forget_regions(struct dt *t, const struct dt_constraint *c)
{
    if (c->border)
        dt_regions_clear(&t->constraints->regions);
}

/* The segment between the ends becomes a chain of edges of the live mesh, or dt_crossed names the crossed constraint. */
static enum dt_status enforce_or_name(struct dt *t, const struct dt_constraint *c,
                                      struct dt_stop *work)
{
    uint32_t a = dt_points_vertex(&t->points, c->a), b = dt_points_vertex(&t->points, c->b);
    forget_regions(t, c);
    enum dt_status status = dt_enforce_segment(enforcer(t), a, b, work), named;
    if (status != DT_CROSSES)
        return status;
    named = dt_work(work, t->constraints->declared.rows);
    if (named == DT_OK)
        report_crossing(t, c);
    return named == DT_OK ? DT_CROSSES : named;
}

enum dt_status dt_constrain_row(struct dt *t, uint32_t row, uint32_t a, uint32_t b,
                                struct dt_stop *work)
{
    if ((t->constraints->declared.row[row].what & 1) != 0)
        dt_regions_clear(&t->constraints->regions);
    return dt_enforce_segment(enforcer(t), a, b, work);
}

void dt_forget_regions(struct dt *t, uint32_t id)
{
    const struct dt_declared *d = &t->constraints->declared;
    for (uint32_t row = dt_declared_first(d, id); row != DT_NONE;
         row = dt_declared_next(d, row, id)) {
        struct dt_constraint c = dt_declared_get(d, row);
        forget_regions(t, &c);
    }
}

void dt_release_row(struct dt *t, uint32_t row)
{
    struct dt_constraint c = dt_declared_get(&t->constraints->declared, row);
    uint32_t a = dt_points_vertex(&t->points, c.a), b = dt_points_vertex(&t->points, c.b);
    forget_regions(t, &c);
    if (a == b)
        return;
    struct dt_enforcer *e = enforcer(t);
    dt_enforce_release(e, a, b);
    dt_enforce_mend(e);
}

/* ---- all of a mesh that was just built ---- */

static enum dt_status constrain_sorted(struct dt *t, struct dt_stop *stop)
{
    struct dt_constraint *c;
    size_t n;
    enum dt_status status = dt_constraints(t, NULL, DT_NONE, &c, &n);
    dt_fixed_end(&t->mesh);
    if (status == DT_OK)
        status = dt_fixed_begin(&t->mesh);
    for (size_t i = 0; i < n && status == DT_OK; i++)
        status = enforce_or_name(t, &c[i], stop);
    free(c);
    return status;
}

enum dt_status dt_constrain_all(struct dt *t, struct dt_stop *stop)
{
    const struct dt_changes *changes = t->scratch.changes;
    t->scratch.enforcer = &t->constraints->enforcer;
    t->scratch.changes = NULL; /* nobody reads the stars of a mesh that is not finished */
    dt_regions_clear(&t->constraints->regions);
    size_t made;
    enum dt_status status = dt_fixed_begin(&t->mesh);
    if (status == DT_OK)
        status = dt_constrain_in_order(t, 0, NULL, &made, stop);
    if (status == DT_CROSSES)
        status = constrain_sorted(t, stop);
    t->scratch.changes = changes;
    return status;
}

/* ---- declaring ---- */

enum dt_status dt_constrainable(const struct dt *t, const struct dt_constraint *c, size_t n,
                                uint32_t *missing)
{
    for (size_t i = 0; i < n; i++) {
        if (i + DT_AHEAD < n) {
            dt_idmap_fetch(&t->points.value, c[i + DT_AHEAD].a);
            dt_idmap_fetch(&t->points.value, c[i + DT_AHEAD].b);
        }
        bool has_a = dt_points_vertex(&t->points, c[i].a) != DT_NONE;
        if (!has_a || dt_points_vertex(&t->points, c[i].b) == DT_NONE) {
            *missing = has_a ? c[i].b : c[i].a;
            return DT_NOPOINT;
        }
        if (c[i].a == c[i].b) {
            *missing = c[i].a;
            return DT_NOEDGE;
        }
        if (c[i].number > DT_MAX_NUMBER)
            return DT_RANGE;
    }
    return DT_OK;
}

void dt_constraints_tidy(struct dt *t)
{
    if (t->constraints == NULL || t->constraints->declared.rows > 0)
        return;
    struct dt_crossed crossed = t->constraints->crossed;
    dt_declared_clear(&t->constraints->declared);
    dt_enforcer_clear(&t->constraints->enforcer);
    dt_regions_clear(&t->constraints->regions);
    dt_fixed_end(&t->mesh);
    t->scratch.enforcer = NULL;
    t->constraints->crossed = crossed; /* may still be asked for */
}

/* An edit of n constraints begins: forgets the history that no view reads any more. */
static enum dt_status prepare_history(struct dt *t, size_t n)
{
    struct dt_history *h = &t->constraints->history;
    dt_views_edit_begin(t);
    const struct dt_view *oldest = dt_views_oldest(&t->views);
    dt_history_trim(h, oldest == NULL ? UINT64_MAX : oldest->constraints);
    return oldest == NULL ? DT_OK : dt_history_reserve(h, n);
}

/* Room to note changes of constraints whose smaller end is the id. */
static enum dt_status prepare_note(struct dt *t, uint32_t id)
{
    return dt_views_oldest(&t->views) == NULL ? DT_OK
                                              : dt_history_reserve_id(&t->constraints->history, id);
}

static void note(struct dt *t, uint32_t row, bool added)
{
    struct dt_constraint c = dt_declared_get(&t->constraints->declared, row);
    if (t->touched.on)
        dt_touched_note_constraint(t, &c, false);
    if (dt_views_oldest(&t->views) != NULL)
        dt_history_note(&t->constraints->history, c, added);
}

/* Room for n constraints more. */
static enum dt_status prepare(struct dt *t, size_t n)
{
    if (t->constraints == NULL)
        t->constraints = dt_constraints_new(t->points.pages);
    if (t->constraints == NULL)
        return DT_NOMEM;
    enum dt_status status = dt_declared_reserve(&t->constraints->declared, n);
    if (status == DT_OK)
        status = prepare_history(t, 4 * n); /* twice, and to undo them */
    if (status == DT_OK && dt_is_live(t))
        status = dt_fixed_begin(&t->mesh);
    t->scratch.enforcer = &t->constraints->enforcer;
    return status;
}

static enum dt_status declare(struct dt *t, struct dt_constraint c, struct dt_stop *work,
                              uint32_t *row)
{
    struct dt_declared *d = &t->constraints->declared;
    enum dt_status status = dt_work(work, 1);
    *row = DT_NONE;
    if (status != DT_OK || dt_declared_find(d, &c) != DT_NONE)
        return status;
    status = dt_is_live(t) ? enforce_or_name(t, &c, work) : DT_OK;
    if (status != DT_OK)
        return status;
    status = prepare_note(t, c.a);
    if (status == DT_OK)
        status = dt_declared_add(d, &c, row);
    if (status == DT_OK)
        note(t, *row, true);
    if (status != DT_OK && dt_is_live(t)) {
        struct dt_enforcer *e = enforcer(t);
        uint32_t a = dt_points_vertex(&t->points, c.a), b = dt_points_vertex(&t->points, c.b);
        if (a != b)
            dt_enforce_release(e, a, b);
        dt_enforce_mend(e);
    }
    return status;
}

static void undeclare(struct dt *t, uint32_t row)
{
    if (dt_is_live(t))
        dt_release_row(t, row);
    note(t, row, false);
    dt_declared_remove(&t->constraints->declared, row);
}

/* Fetches the data that the declarations of c[i] and later constraints will read, some steps before. */
static void fetch_constraints(const struct dt *t, const struct dt_constraint *c, size_t i, size_t n)
{
    enum { STEP = 8 };
    const struct dt_points *p = &t->points;
    if (i + 3 * STEP < n) {
        dt_declared_fetch(&t->constraints->declared, &c[i + 3 * STEP]);
        dt_idmap_fetch(&p->value, c[i + 3 * STEP].a);
        dt_idmap_fetch(&p->value, c[i + 3 * STEP].b);
    }
    for (size_t k = 1; dt_is_live(t) && k <= 2 && i + k * STEP < n; k++) {
        uint32_t v = dt_points_vertex(p, c[i + k * STEP].a);
        uint32_t w = dt_points_vertex(p, c[i + k * STEP].b);
        dt_fetch(k == 2 ? (const void *)&t->mesh.leaving[v] : &t->mesh.half[t->mesh.leaving[v]]);
        dt_fetch(k == 2 ? (const void *)&t->mesh.leaving[w] : &t->mesh.half[t->mesh.leaving[w]]);
        if (k == 2) {
            dt_fetch(&p->xy[v]);
            dt_fetch(&p->xy[w]);
        }
    }
}

/* Takes back the declarations of the last rows, from `from` on. */
static void undeclare_rows(struct dt *t, uint32_t from)
{
    struct dt_declared *d = &t->constraints->declared;
    for (uint32_t i = d->end; i-- > from;) {
        note(t, i, false);
        dt_declared_remove(d, i);
    }
}

/* Declares them, and then makes the new ones edges. There are no free rows. row[n]: scratch memory. DT_CROSSES names
 * nothing. */
static enum dt_status declare_together(struct dt *t, const struct dt_constraint *c, size_t n,
                                       struct dt_stop *work, uint32_t *row, size_t *added)
{
    struct dt_declared *d = &t->constraints->declared;
    uint32_t from = d->end, last;
    size_t made = 0;
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < n && status == DT_OK; i++) {
        struct dt_constraint own = dt_constraint_ascending(c[i]);
        if (i + DT_AHEAD < n)
            dt_declared_fetch(d, &c[i + DT_AHEAD]);
        status = dt_work(work, 1);
        if (status != DT_OK || dt_declared_find(d, &own) != DT_NONE)
            continue;
        status = dt_declared_add(d, &own, &last);
        if (status == DT_OK)
            note(t, last, true);
    }
    if (status == DT_OK)
        status = dt_constrain_in_order(t, from, row, &made, work);
    *added = d->end - from;
    while (status != DT_OK && made > 0)
        dt_release_row(t, row[--made]);
    if (status != DT_OK)
        undeclare_rows(t, from);
    return status;
}

/* Declares them one by one, those that are new into row[]. */
static enum dt_status declare_all(struct dt *t, const struct dt_constraint *c, size_t n,
                                  struct dt_stop *work, uint32_t *row, size_t *added)
{
    enum dt_status status = DT_OK;
    size_t k = 0;
    for (size_t i = 0; i < n && status == DT_OK; i++) {
        if (n > 1)
            fetch_constraints(t, c, i, n);
        status = declare(t, dt_constraint_ascending(c[i]), work, &row[k]);
        k += status == DT_OK && row[k] != DT_NONE;
    }
    *added = k;
    while (status != DT_OK && k > 0)
        undeclare(t, row[--k]);
    return status;
}

/* Declares them all, or none. row[n]: scratch memory. */
static enum dt_status declare_batch(struct dt *t, const struct dt_constraint *c, size_t n,
                                    struct dt_stop *work, uint32_t *row, size_t *added)
{
    struct dt_declared *d = &t->constraints->declared;
    if (!dt_is_live(t) || !dt_is_large_batch(t, n) || d->rows != d->end)
        return declare_all(t, c, n, work, row, added);
    enum dt_status status = declare_together(t, c, n, work, row, added);
    if (status != DT_CROSSES)
        return status;
    status = dt_declared_reserve(d, n); /* the room may be gone with the last row */
    return status == DT_OK ? declare_all(t, c, n, work, row, added) : status;
}

enum dt_status dt_constrain(struct dt *t, const struct dt_constraint *c, size_t n,
                            const struct dt_options *opt, size_t *added, uint32_t *missing)
{
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status status = dt_constrainable(t, c, n, missing);
    *added = 0;
    if (status == DT_OK)
        status = dt_refresh(t, opt);
    if (status != DT_OK || n == 0)
        return status;
    uint32_t one = 0, *row = n == 1 ? &one : dt_array_new_in(t->points.pages, n, sizeof *row);
    if (row == NULL)
        return DT_NOMEM;
    status = prepare(t, n);
    if (status == DT_OK)
        status = declare_batch(t, c, n, &work, row, added);
    if (status != DT_OK)
        *added = 0;
    dt_constraints_tidy(t);
    if (row != &one)
        dt_array_free(row);
    return status;
}

/* ---- releasing ---- */

/* Finds the rows, each once. */
static enum dt_status find_rows(const struct dt *t, const struct dt_constraint *c, size_t n,
                                uint32_t *row, size_t *distinct, size_t *missing)
{
    for (size_t i = 0; i < n; i++) {
        bool declared = dt_is_constrained(t) && c[i].number <= DT_MAX_NUMBER;
        row[i] = declared ? dt_declared_find(&t->constraints->declared, &c[i]) : DT_NONE;
        if (row[i] == DT_NONE) {
            *missing = i;
            return DT_NOCONSTRAINT;
        }
    }
    *distinct = dt_sort_unique(row, n, t->points.pages, NULL);
    return DT_OK;
}

enum dt_status dt_release(struct dt *t, const struct dt_constraint *c, size_t n,
                          const struct dt_options *opt, size_t *released, size_t *missing)
{
    struct dt_stop work = dt_stop_of(opt);
    uint32_t one = 0, *row = n <= 1 ? &one : dt_array_new(n, sizeof *row);
    *released = 0;
    if (row == NULL)
        return DT_NOMEM;
    size_t k = 0;
    enum dt_status status = find_rows(t, c, n, row, &k, missing);
    if (status == DT_OK)
        status = dt_work(&work, k);
    if (status == DT_OK && k > 0)
        status = prepare_history(t, k);
    for (size_t i = 0; i < k && status == DT_OK; i++)
        status = prepare_note(t, t->constraints->declared.row[row[i]].end[0]);
    if (status == DT_OK) {
        for (size_t i = 0; i < k; i++)
            undeclare(t, row[i]);
        dt_constraints_tidy(t);
        *released = k;
    }
    if (row != &one)
        dt_array_free(row);
    return status;
}

/* ---- reading ---- */

void dt_crossed(const struct dt *t, struct dt_crossed *out)
{
    *out = t->constraints == NULL ? (struct dt_crossed){{0, 0, false, 0}, {0, 0, false, 0}}
                                  : t->constraints->crossed;
}

static int compare_pairs(const void *a, const void *b)
{
    const uint32_t *p = a, *q = b;
    if (p[0] != q[0])
        return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

enum dt_status dt_constrained_edges(const struct dt *t, struct dt_ids *out)
{
    const struct dt_mesh *m = &t->mesh;
    enum dt_status status = dt_readable(t);
    size_t from = out->n;
    for (uint32_t h = 0; status == DT_OK && m->fixed != NULL && h < 8 * m->tri_end;
         h = (h & 7) == 2 ? h + 6 : h + 1) {
        if (dt_is_dead(m, h) || h > dt_twin(m, h) || !dt_is_fixed(m, h))
            continue;
        uint32_t a = t->points.id[dt_origin(m, h)], b = t->points.id[dt_dest(m, h)];
        status = dt_ids_reserve(out, 2);
        if (status != DT_OK)
            break;
        out->v[out->n++] = a < b ? a : b;
        out->v[out->n++] = a < b ? b : a;
    }
    if (status == DT_OK && out->n > from)
        qsort(out->v + from, (out->n - from) / 2, 2 * sizeof *out->v, compare_pairs);
    else
        out->n = from;
    return status;
}
