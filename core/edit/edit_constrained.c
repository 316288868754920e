/* edit_constrained.c - edits of points of a set with constraints.
 *
 * Usually the mesh is edited as without constraints: a vertex moves within its star, and its constraints with it; or these
 * are released, and return when it has moved. That fails if constraints would cross on the way, or if a tolerance makes
 * the edit concern more than one vertex. Then the edit is judged as a whole: a copy of the points is edited and built. If
 * that succeeds, the set is edited and built, too. */
#include "core/edit/constrain.h"

#include <stdlib.h>

#include "core/edit/update.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"
#include "core/mesh/fixed.h"
#include "core/mesh/hull.h"

/* ---- judged as a whole ---- */

/* An edit of points; the sets that it is applied to do not await a mesh. */
struct points_edit {
    const uint32_t *ids;
    const struct dt_point *to; /* NULL: they are deleted */
    size_t n;
};

static enum dt_status apply(struct dt *t, const struct points_edit *e)
{
    struct dt_stop none = dt_stop_of(NULL);
    if (e->to == NULL)
        return dt_update_delete(t, e->ids, e->n, &none, false);
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < e->n && status == DT_OK; i++)
        status = dt_update_move(t, e->ids[i], e->to[i], &none);
    return status;
}

/* Whether constraints would cross after the edit. */
static enum dt_status judge(struct dt *t, const struct points_edit *e, const struct dt_options *opt)
{
    struct dt *copy;
    struct dt_options build = {.pool = opt == NULL ? NULL : opt->pool,
                               .cancel = opt == NULL ? NULL : opt->cancel,
                               .disposable = true};
    enum dt_status status = dt_clone_points(t, opt, &copy);
    if (status != DT_OK)
        return status;
    copy->triangulated = false;
    status = apply(copy, e);
    if (status == DT_OK)
        status = dt_triangulate(copy, &build);
    if (status == DT_CROSSES)
        t->constraints->crossed = copy->constraints->crossed;
    dt_free(copy);
    return status;
}

/* Views continue to read the triangulation as it is now. */
static void save_stars(const struct dt *t)
{
    const struct dt_points *p = &t->points;
    for (uint32_t v = 0; t->scratch.changes != NULL && v < p->end; v++)
        if (p->id[v] != DT_NONE)
            dt_changes_star(t->scratch.changes, v);
}

/* Out of memory, the set awaits dt_refresh. */
static void rebuild(struct dt *t, const struct dt_options *opt)
{
    struct dt_options build = {.rebuild = true, .pool = opt == NULL ? NULL : opt->pool};
    if (dt_triangulate(t, &build) == DT_OK)
        return;
    t->current = false;
    dt_views_lose_rings(&t->views);
}

static enum dt_status edit_as_a_whole(struct dt *t, const struct points_edit *e,
                                      const struct dt_options *opt)
{
    if (opt != NULL && opt->steps != 0)
        return DT_TOOLONG;
    enum dt_status status = judge(t, e, opt);
    if (status != DT_OK)
        return status;
    save_stars(t);
    t->current = false;
    status = apply(t, e);
    if (status == DT_OK || e->n == 1 || e->to == NULL)
        t->current = true;
    if (status == DT_OK)
        rebuild(t, opt);
    return status;
}

/* ---- deletion ---- */

/* Whether a representative with aliases elsewhere is among the ids: another place would represent them. */
static bool leaves_heirs(const struct dt_points *p, const uint32_t *ids, size_t n)
{
    for (size_t i = 0; p->tol > 0 && p->aliases.count > 0 && i < n; i++)
        if (!dt_points_is_alias(p, ids[i]) &&
            dt_points_heir(p, dt_points_vertex(p, ids[i]), NULL, 0) != NULL)
            return true;
    return false;
}

enum dt_status dt_constrained_delete(struct dt *t, const uint32_t *ids, size_t n,
                                     const struct dt_options *opt)
{
    struct dt_stop work = dt_stop_of(opt);
    struct points_edit e = {ids, NULL, n};
    enum dt_status status = dt_refresh(t, opt);
    if (status != DT_OK)
        return status;
    if (dt_is_large_batch(t, n) || leaves_heirs(&t->points, ids, n))
        return edit_as_a_whole(t, &e, opt);
    status = dt_update_delete(t, ids, n, &work, false);
    return status == DT_CROSSES ? edit_as_a_whole(t, &e, opt) : status;
}

/* ---- moves ---- */

/* The constraints at id: the next of them are kept, or none. */
static enum dt_status keep_rows(struct dt *t, uint32_t id, size_t n, struct dt_stop *work)
{
    const struct dt_declared *d = &t->constraints->declared;
    enum dt_status status = DT_OK;
    uint32_t row = dt_declared_first(d, id);
    size_t kept = 0;
    for (; row != DT_NONE && kept < n && status == DT_OK; row = dt_declared_next(d, row, id)) {
        const uint32_t *end = d->row[row].end;
        status = dt_constrain_row(t, row, dt_points_vertex(&t->points, end[0]),
                                  dt_points_vertex(&t->points, end[1]), NULL);
        kept += status == DT_OK;
    }
    if (status == DT_OK)
        return DT_OK;
    if (status == DT_CROSSES)
        status = dt_name_crossed(t, id, work);
    row = dt_declared_first(d, id);
    for (; kept > 0; kept--, row = dt_declared_next(d, row, id))
        dt_release_row(t, row);
    return status;
}

static size_t release_rows(struct dt *t, uint32_t id)
{
    const struct dt_declared *d = &t->constraints->declared;
    uint32_t row = dt_declared_first(d, id);
    size_t n = 0;
    for (; row != DT_NONE; row = dt_declared_next(d, row, id), n++)
        dt_release_row(t, row);
    return n;
}

/* Whether the move changes one vertex alone. */
static bool moves_alone(struct dt *t, uint32_t id, struct dt_point to)
{
    const struct dt_points *p = &t->points;
    if (p->tol == 0)
        return true;
    return !dt_points_is_alias(p, id) &&
           dt_points_heir(p, dt_points_vertex(p, id), NULL, 0) == NULL &&
           dt_points_find(p, to, dt_points_vertex(p, id)) == DT_NONE;
}

enum { MANY = 16 };

/* The vertices to which constraints at id lead, into end[MANY]; MANY + 1: there are more. */
static uint32_t list_ends(const struct dt *t, uint32_t id, uint32_t *end)
{
    const struct dt_declared *d = &t->constraints->declared;
    uint32_t n = 0;
    for (uint32_t row = dt_declared_first(d, id); row != DT_NONE && n <= MANY;
         row = dt_declared_next(d, row, id), n++)
        if (n < MANY)
            end[n] = dt_points_vertex(&t->points, d->row[row].end[d->row[row].end[0] == id]);
    return n;
}

/* *own: whether every fixed edge of vertex v, of id, is a constraint of its own and of no other, to the vertex at the other
 * end; false where there are many. */
static enum dt_status look_at_own(const struct dt *t, uint32_t id, uint32_t v, struct dt_stop *work,
                                  bool *own)
{
    const struct dt_mesh *m = &t->mesh;
    enum dt_status status = DT_OK;
    uint32_t end[MANY], n = list_ends(t, id, end), found = 0, steps = 0, h = m->leaving[v];
    *own = n <= MANY;
    while (*own && status == DT_OK) {
        uint32_t covers = dt_is_fixed(m, h) ? dt_fixed_count(m, h) : 0, known = 0;
        for (uint32_t i = 0; covers > 0 && i < n; i++)
            known += end[i] == dt_dest(m, h);
        found += known;
        *own = known == covers;
        if ((++steps & DT_WORK_MASK) == 0)
            status = dt_work(work, DT_WORK_BLOCK);
        h = dt_turn_ccw(m, h);
        if (h == m->leaving[v])
            break;
    }
    *own = *own && found == n;
    return status;
}

/* The constraints at id move along with its vertex, as edges, if the star of that allows it. */
static enum dt_status shift_with_rows(struct dt *t, uint32_t id, struct dt_point to,
                                      struct dt_stop *work, bool *moved)
{
    uint32_t v = dt_points_vertex(&t->points, id);
    bool own;
    *moved = false;
    if (!dt_is_end(t, id) || t->points.id[v] != id || dt_on_hull(&t->mesh, v))
        return DT_OK;
    enum dt_status status = look_at_own(t, id, v, work, &own);
    if (status == DT_OK && own)
        status = dt_update_shift(t, v, to, work, moved);
    if (*moved)
        dt_forget_regions(t, id);
    return status;
}

/* A failure leaves the set as it was, or without a mesh. *final: constraints would cross where the point comes to. */
static enum dt_status move_with_rows(struct dt *t, uint32_t id, struct dt_point to,
                                     struct dt_stop *work, bool *final)
{
    bool moved;
    enum dt_status status = shift_with_rows(t, id, to, work, &moved);
    *final = false;
    if (status != DT_OK || moved)
        return status;
    struct dt_point from = dt_points_xy(&t->points, id);
    size_t n = release_rows(t, id);
    status = dt_update_move(t, id, to, work);
    if (status == DT_OK) {
        status = t->current ? keep_rows(t, id, n, work) : DT_OK;
        *final = status == DT_CROSSES;
        if (status == DT_OK)
            return DT_OK;
        if (dt_update_move(t, id, from, NULL) != DT_OK)
            t->current = false;
    }
    if (t->current && keep_rows(t, id, n, NULL) != DT_OK)
        t->current = false;
    return status;
}

enum dt_status dt_constrained_move(struct dt *t, uint32_t id, struct dt_point to,
                                   const struct dt_options *opt)
{
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status status = dt_refresh(t, opt);
    if (status == DT_OK)
        dt_update_fetch(t, dt_points_vertex(&t->points, id));
    if (status == DT_OK && t->points.tol > 0)
        status = dt_points_index(&t->points, &work);
    if (status != DT_OK)
        return status;
    bool final = false;
    status = DT_CROSSES;
    if (moves_alone(t, id, to))
        status = move_with_rows(t, id, to, &work, &final);
    return status == DT_CROSSES && !final
               ? edit_as_a_whole(t, &(struct points_edit){&id, &to, 1}, opt)
               : status;
}

/* Whether the ids are live and distinct. */
static enum dt_status check_ids(const struct dt *t, const uint32_t *ids, size_t n,
                                uint32_t *missing)
{
    for (size_t i = 0; i < n; i++)
        if (dt_points_vertex(&t->points, ids[i]) == DT_NONE) {
            *missing = ids[i];
            return DT_NOPOINT;
        }
    uint32_t *sorted = dt_array_new(n + 1, sizeof *sorted);
    if (sorted == NULL)
        return DT_NOMEM;
    for (size_t i = 0; i < n; i++)
        sorted[i] = ids[i];
    dt_sort_ids(sorted, n, t->points.pages, NULL);
    enum dt_status status = DT_OK;
    for (size_t i = 1; i < n && status == DT_OK; i++)
        if (sorted[i] == sorted[i - 1]) {
            *missing = sorted[i];
            status = DT_NOPOINT;
        }
    dt_array_free(sorted);
    return status;
}

/* Moves one of several: with its constraints, or without any. */
static enum dt_status move_one(struct dt *t, uint32_t id, struct dt_point to)
{
    if (!dt_is_constrained(t) || !dt_is_live(t))
        return dt_update_move(t, id, to, NULL);
    bool final;
    return move_with_rows(t, id, to, NULL, &final);
}

/* Moves one point after the other. A failure, or constraints that would cross on the way, moves the first ones back. */
static enum dt_status move_each(struct dt *t, const struct points_edit *e)
{
    struct dt_point *from = dt_array_new(e->n + 1, sizeof *from);
    enum dt_status status = from == NULL ? DT_NOMEM : DT_OK;
    size_t done = 0;
    for (; done < e->n && status == DT_OK; done += status == DT_OK) {
        from[done] = dt_points_xy(&t->points, e->ids[done]);
        status = move_one(t, e->ids[done], e->to[done]);
    }
    while (status != DT_OK && from != NULL && done-- > 0)
        (void)move_one(t, e->ids[done], from[done]);
    dt_array_free(from);
    return status;
}

enum dt_status dt_move_many(struct dt *t, const uint32_t *ids, const struct dt_point *to, size_t n,
                            const struct dt_options *opt, uint32_t *missing)
{
    enum { STEPS = 32 }; /* of a usual move */
    struct dt_stop work = dt_stop_of(opt);
    struct points_edit e = {ids, to, n};
    enum dt_status status = check_ids(t, ids, n, missing);
    if (status == DT_OK && n > 0 && !dt_coordinates_ok(&to[0].x, 2 * n))
        status = DT_RANGE;
    if (status == DT_OK)
        status = dt_work(&work, STEPS * n);
    if (status == DT_OK)
        status = dt_refresh(t, opt);
    if (status != DT_OK)
        return status;
    dt_views_edit_begin(t);
    bool judged = dt_is_constrained(t) && dt_is_live(t);
    status = judged && t->points.tol > 0 ? DT_CROSSES : move_each(t, &e);
    return judged && status == DT_CROSSES ? edit_as_a_whole(t, &e, opt) : status;
}

/* ---- deletion with constraints ---- */

/* The constraints at the ids, ascending, each once. The caller frees *out. */
static enum dt_status constraints_at(const struct dt *t, const uint32_t *ids, size_t n,
                                     struct dt_constraint **out, size_t *count)
{
    const struct dt_declared *d = &t->constraints->declared;
    struct dt_constraint_list list = {NULL, 0, 0};
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < n; i++)
        for (uint32_t r = dt_declared_first(d, ids[i]); r != DT_NONE && status == DT_OK;
             r = dt_declared_next(d, r, ids[i]))
            status = dt_constraint_append(&list, dt_declared_get(d, r));
    if (list.n > 0)
        qsort(list.v, list.n, sizeof *list.v, dt_constraint_compare);
    *count = 0;
    for (size_t i = 0; i < list.n; i++)
        if (i == 0 || dt_constraint_compare(&list.v[i], &list.v[i - 1]) != 0)
            list.v[(*count)++] = list.v[i];
    *out = list.v;
    return status;
}

enum dt_status dt_delete_cascade(struct dt *t, const uint32_t *ids, size_t n,
                                 const struct dt_options *opt, uint32_t *deleted, uint32_t *missing)
{
    for (size_t i = 0; i < n; i++)
        if (dt_points_vertex(&t->points, ids[i]) == DT_NONE) {
            *missing = ids[i];
            return DT_NOPOINT;
        }
    if (!dt_is_constrained(t))
        return dt_delete_many(t, ids, n, opt, deleted, missing);
    struct dt_constraint *c = NULL;
    size_t k = 0, released = 0, at = 0;
    enum dt_status status = dt_refresh(t, opt);
    if (status == DT_OK)
        status = constraints_at(t, ids, n, &c, &k);
    if (status == DT_OK)
        status = dt_release(t, c, k, opt, &released, &at);
    if (status == DT_OK)
        status = dt_delete_many(t, ids, n, opt, deleted, missing);
    if (status != DT_OK && released > 0)
        (void)dt_constrain(t, c, k, NULL, &at, missing);
    free(c);
    return status;
}
