/* pslg.c - see pslg.h. An edit that fails is undone: constraints first, then points. */
#include "server/changes/pslg.h"

#include "server/changes/constraint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

uint64_t pslg_lists_records(const struct pslg_lists *d)
{
    return (uint64_t)record_parts(RECORD_RELEASE, d->n_released) +
           record_parts(RECORD_CONSTRAIN, d->n_added);
}

void pslg_lists_clear(struct pslg_lists *d)
{
    dt_pages_release(d->released);
    dt_pages_release(d->added);
    *d = (struct pslg_lists){0};
}

struct pslg *pslg_new(void)
{
    return calloc(1, sizeof(struct pslg));
}

void pslg_free(struct pslg *d)
{
    if (d == NULL)
        return;
    pslg_lists_clear(&d->lists);
    free(d->line);
    free(d);
}

/* ---- constraints ---- */

/* Releases and declares, all or nothing. */
static enum dt_status replace(struct dt *dt, struct pslg *d, const struct dt_constraint *released,
                              size_t n_released, const struct dt_constraint *added, size_t n_added,
                              const struct dt_options *opt, uint32_t *missing)
{
    size_t k = 0, at;
    uint32_t none;
    enum dt_status status =
        n_released == 0 ? DT_OK : dt_release(dt, released, n_released, opt, &k, &at);
    if (status == DT_OK)
        status = dt_constrain(dt, added, n_added, opt, &d->declared, missing);
    if (status == DT_CROSSES)
        dt_crossed(dt, &d->crossed);
    if (status != DT_OK && k > 0)
        (void)dt_constrain(dt, released, n_released, NULL, &k, &none);
    return status;
}

/* Applies the constraints of a change that needs no plan. */
static enum dt_status apply(struct dt *dt, struct pslg *d, const struct dt_options *opt,
                            uint32_t *missing)
{
    const struct pslg_lists *v = &d->lists;
    struct dt_constraint *released = constraint_listed(v->released, v->n_released);
    struct dt_constraint *added = constraint_listed(v->added, v->n_added);
    enum dt_status status =
        released == NULL || added == NULL
            ? DT_NOMEM
            : replace(dt, d, released, v->n_released, added, v->n_added, opt, missing);
    free(released);
    free(added);
    return status;
}

/* ---- a split: what it does becomes the change ---- */

/* Plans it, with as many crossings as there is memory for. */
static enum dt_status plan(struct dt *dt, struct pslg *d, const struct dt_options *opt,
                           struct dt_split *out, uint32_t *missing)
{
    enum { FEW = 1024, MORE = 4 };
    const size_t n = d->lists.n_added;
    struct dt_constraint *asked = constraint_listed(d->lists.added, n);
    enum dt_status status = asked == NULL ? DT_NOMEM : DT_OK;
    size_t most = d->reserve == NULL ? UINT32_MAX : FEW + n;
    for (bool done = false; status == DT_OK && !done; most *= MORE) {
        if (d->reserve != NULL)
            status = d->reserve(d->ctx, dt_split_memory(dt, n, most));
        if (status == DT_OK)
            status = dt_plan_split(dt, asked, n, most, opt, out, missing);
        done = status != DT_NOMEM || d->reserve == NULL || most > UINT32_MAX;
        if (!done && out->point == NULL)
            status = DT_OK;
    }
    free(asked);
    if (status == DT_CROSSES)
        d->crossed = out->crossed;
    return status;
}

/* The same for a REFINE, with as many points as there is memory for. */
static enum dt_status plan_refinement(struct dt *dt, struct pslg *d, const struct dt_options *opt,
                                      struct dt_split *out)
{
    struct dt_quality quality = d->quality;
    struct dt_refined refined;
    if (quality.most > d->most)
        quality.most = (size_t)d->most + 1; /* one too many is an error */
    quality.reserve = d->reserve;
    quality.ctx = d->ctx;
    enum dt_status status = dt_plan_refine(dt, &quality, opt, &refined);
    *out = refined.change;
    d->angle = refined.angle;
    d->unrefined = refined.unrefined;
    d->hull = refined.hull;
    return status;
}

static struct record_constraint *records_of(struct dt_pages *pages, const struct dt_constraint *c,
                                            size_t n)
{
    struct record_constraint *r = dt_pages_grow(pages, NULL, 0, (n + 1) * sizeof *r);
    for (size_t i = 0; r != NULL && i < n; i++)
        r[i] = constraint_record(&c[i]);
    return r;
}

static const double *values_of(const struct dt_split *s, const struct name *field)
{
    for (size_t k = 0; k < s->columns; k++)
        if (name_equals(field, s->column[k].name, s->column[k].len))
            return s->column[k].values;
    return NULL;
}

static size_t find_column(const struct columns *v, const struct dt_values_of *column)
{
    size_t k = 0;
    while (v != NULL && k < v->count && !name_equals(&v->field[k], column->name, column->len))
        k++;
    return k;
}

static void copy_values(double *to, const double *from, size_t n)
{
    for (size_t i = 0; i < n; i++)
        to[i] = from == NULL ? (double)NAN : from[i];
}

/* The columns of v, which have n values, and the columns of the plan, each for all points; *ok: there was memory. */
static struct columns *join_columns(struct dt_pages *pages, const struct columns *v, size_t n,
                                    const struct dt_split *s, bool *ok)
{
    size_t old = v == NULL ? 0 : v->count, count = old, all = n + s->n_points;
    for (size_t k = 0; k < s->columns; k++)
        count += find_column(v, &s->column[k]) == old;
    struct columns *to = count == 0 ? NULL : columns_new(count);
    if (to != NULL)
        to->v = dt_pages_grow(pages, NULL, 0, (count * all + 1) * sizeof *to->v);
    *ok = count == 0 || (to != NULL && to->v != NULL);
    if (!*ok || count == 0)
        return to;
    to->n = (uint32_t)all;
    for (size_t k = 0; k < old; k++)
        to->field[k] = v->field[k];
    for (size_t k = 0, at = old; k < s->columns; k++)
        if (find_column(v, &s->column[k]) == old)
            to->field[at++] = name_of(s->column[k].name, s->column[k].len);
    for (size_t k = 0; k < count; k++) {
        double *values = to->v + k * all;
        copy_values(values, k < old ? columns_values(v, k) : NULL, n);
        copy_values(values + n, values_of(s, &to->field[k]), s->n_points);
    }
    return to;
}

/* The lists of the change after the plan has been carried out. */
struct result {
    struct pslg_points all;
    struct pslg_lists lists;
};

static void free_result(struct result *r)
{
    dt_pages_release(r->all.points);
    columns_free(r->all.columns);
    pslg_lists_clear(&r->lists);
}

static bool make_result(const struct pslg_points *p, const struct dt_split *s,
                        struct dt_pages *pages, struct result *r)
{
    size_t n = p->n + s->n_points;
    bool ok;
    *r = (struct result){.lists = {.released = records_of(pages, s->released, s->n_released),
                                   .added = records_of(pages, s->added, s->n_added),
                                   .n_released = (uint32_t)s->n_released,
                                   .n_added = (uint32_t)s->n_added}};
    struct dt_point *points = dt_pages_grow(pages, NULL, 0, (n + 1) * sizeof *points);
    r->all =
        (struct pslg_points){points, (uint32_t)n, join_columns(pages, p->columns, p->n, s, &ok)};
    ok = ok && points != NULL && r->lists.released != NULL && r->lists.added != NULL;
    if (ok && p->n > 0)
        memcpy(points, p->points, p->n * sizeof *points);
    if (ok && s->n_points > 0)
        memcpy(points + p->n, s->point, s->n_points * sizeof *points);
    if (!ok)
        free_result(r);
    return ok;
}

/* The change becomes that. */
static void take_result(struct pslg *d, struct pslg_points *p, const struct dt_split *s,
                        struct result *r)
{
    dt_pages_release(p->points);
    columns_free(p->columns);
    pslg_lists_clear(&d->lists);
    *p = r->all;
    d->lists = r->lists;
    d->split = s->split;
    d->deviation = s->deviation;
    d->splits = false;
}

/* Adds the points of the plan; in small pieces if many at once would end views of the triangulation. *n: the number added. */
static enum dt_status add_planned(struct dt *dt, const struct dt_split *s,
                                  const struct dt_options *opt, size_t *n)
{
    enum { PIECE = 64 };
    const size_t piece = dt_view_blocks(dt, s->n_points) ? PIECE : s->n_points;
    struct dt_values_of column[DT_MAX_FIELDS];
    struct dt_added added;
    enum dt_status status = DT_OK;
    for (*n = 0; *n < s->n_points && status == DT_OK;) {
        size_t k = s->n_points - *n < piece ? s->n_points - *n : piece;
        for (size_t i = 0; i < s->columns; i++) {
            column[i] = s->column[i];
            column[i].values += *n;
        }
        status = dt_add_values(dt, s->point + *n, k, column, s->columns, opt, &added);
        *n += status == DT_OK ? k : 0;
    }
    return status;
}

/* Memory for the steps of a plan. */
static enum dt_status reserve_changes(const struct dt *dt, const struct pslg *d,
                                      const struct dt_split *s, const struct dt_options *opt)
{
    return d->reserve == NULL ? DT_OK
                              : d->reserve(d->ctx, dt_split_memory(dt, s->n_added, s->n_points) +
                                                       dt_add_memory(dt, s->n_points, opt) +
                                                       dt_constrain_memory(dt, s->n_added));
}

static enum dt_status carry_out(struct dt *dt, struct pslg *d, struct pslg_points *p,
                                struct dt_pages *pages, const struct dt_split *s,
                                const struct dt_options *opt)
{
    struct result r;
    size_t added = 0;
    uint32_t missing;
    if (s->n_points > d->most)
        return DT_TOOBIG;
    enum dt_status status = reserve_changes(dt, d, s, opt);
    if (status == DT_OK && !make_result(p, s, pages, &r))
        status = DT_NOMEM;
    if (status != DT_OK)
        return status;
    status = add_planned(dt, s, opt, &added);
    if (status == DT_OK)
        status = replace(dt, d, s->released, s->n_released, s->added, s->n_added, opt, &missing);
    if (status == DT_OK) {
        take_result(d, p, s, &r);
        return DT_OK;
    }
    if (opt == NULL || !opt->disposable)
        dt_take_back(dt, (uint32_t)added);
    free_result(&r);
    return status;
}

static enum dt_status split(struct dt *dt, struct pslg *d, struct pslg_points *p,
                            struct dt_pages *pages, const struct dt_options *opt, uint32_t *missing)
{
    struct dt_split s = {0};
    enum dt_status status =
        d->refines ? plan_refinement(dt, d, opt, &s) : plan(dt, d, opt, &s, missing);
    if (status == DT_OK)
        status = carry_out(dt, d, p, pages, &s, opt);
    dt_split_clear(&s);
    return status;
}

/* ---- all of it ---- */

/* The line of the constraint, which was asked for; 0: it was not, or has none. */
static uint64_t line_of(const struct pslg *d, const struct dt_constraint *c)
{
    struct record_constraint key = constraint_record(c);
    for (uint32_t i = 0; d->line != NULL && i < d->lists.n_added; i++) {
        const struct record_constraint *r = &d->lists.added[i];
        bool same = (r->a == key.a && r->b == key.b) || (r->a == key.b && r->b == key.a);
        if (same && r->what == key.what)
            return d->line[i];
    }
    return 0;
}

enum dt_status pslg_edit(struct dt *dt, struct pslg *d, struct pslg_points *p,
                         struct dt_pages *pages, const struct dt_options *opt, uint32_t *missing)
{
    enum dt_status status =
        d->splits ? split(dt, d, p, pages, opt, missing) : apply(dt, d, opt, missing);
    if (status == DT_CROSSES) {
        d->crossed_line[0] = line_of(d, &d->crossed.one);
        d->crossed_line[1] = line_of(d, &d->crossed.other);
    }
    return status;
}
