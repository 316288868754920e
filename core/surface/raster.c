/* raster.c - values of a surface at many places, and at the cells of a raster, by rows (raster_rows.h). */
#include "core/control/parallel.h"
#include "core/query/prefetch.h"
#include "core/surface/raster_rows.h"

/* The values at the next of n places, which are walked to side by side (prefetch.h); adds those that are written to *done. */
static enum dt_status next_values(struct dt_valuer *v, const struct dt_point *q, size_t n,
                                  double *out, size_t *done)
{
    struct dt_place place[DT_AHEAD];
    enum dt_status status = DT_OK;
    n = n < DT_AHEAD ? n : DT_AHEAD;
    for (size_t i = 0; i < n; i++)
        place[i].at = q[i];
    dt_walk_to_places(v->t, place, n, DT_PLACE_READ);
    dt_values_fetch(v, place, n);
    for (size_t i = 0; status == DT_OK && i < n; i++) {
        status = dt_work(&v->work, 8 + dt_value_steps(v));
        if (status == DT_OK)
            status = dt_value_find(v, q[i], &place[i].near, &out[i * v->numbers]);
        *done += status == DT_OK;
    }
    return status;
}

enum dt_status dt_values(const struct dt *t, const struct dt_surface *s, const struct dt_point *q,
                         size_t n, const struct dt_options *opt, double *out, size_t *done)
{
    struct dt_valuer v;
    *done = 0;
    enum dt_status status = dt_valuer_init(&v, t, s, opt);
    while (status == DT_OK && *done < n)
        status = next_values(&v, q + *done, n - *done, out + *done * v.numbers, done);
    dt_valuer_clear(&v);
    return status;
}

/* ---- cells ---- */

/* The next of n cells, which are looked up; adds those that are written to *done. */
static enum dt_status next_cells(struct dt_valuer *v, const struct dt_raster *r, uint64_t from,
                                 size_t n, double *out, size_t *done)
{
    struct dt_point q[DT_AHEAD];
    n = n < DT_AHEAD ? n : DT_AHEAD;
    for (size_t i = 0; i < n; i++)
        q[i] = dt_raster_centre(r, from + i);
    return next_values(v, q, n, out, done);
}

/* n cells from the cell `from` on, on this thread. */
static enum dt_status scan_cells(const struct dt *t, const struct dt_surface *s,
                                 const struct dt_raster *r, uint64_t from, size_t n,
                                 const struct dt_options *opt, double *out, size_t *done)
{
    struct dt_valuer v;
    *done = 0;
    enum dt_status status = dt_valuer_init(&v, t, s, opt);
    if (status == DT_OK)
        status = dt_valuer_scan(&v, n);
    if (status == DT_OK && dt_rows_suit(r))
        status = dt_rows_scan(&v, r, from, n, out, done);
    if (status == DT_TOOLONG) /* single cells go on, up to the one that takes long */
        status = DT_OK;
    while (status == DT_OK && *done < n)
        status = next_cells(&v, r, from + *done, n - *done, out + *done * v.numbers, done);
    dt_valuer_clear(&v);
    return status;
}

/* ---- on several threads ---- */

struct slices {
    const struct dt *t;
    const struct dt_surface *s;
    const struct dt_raster *r;
    uint64_t from;
    size_t n;
    double *out;
    unsigned slices;
    struct dt_stop stop;
};

static void scan_slice(void *arg, unsigned i)
{
    struct slices *k = arg;
    struct dt_options opt = {.cancel = k->stop.cancel};
    size_t numbers = 0;
    for (const struct dt_surface *s = k->s; s != NULL; s = s->next)
        numbers += dt_surface_numbers(s);
    size_t a = (size_t)((uint64_t)k->n * i / k->slices),
           b = (size_t)((uint64_t)k->n * (i + 1) / k->slices), done;
    enum dt_status status =
        scan_cells(k->t, k->s, k->r, k->from + a, b - a, &opt, k->out + a * numbers, &done);
    if (status != DT_OK)
        dt_stop_because(&k->stop, status);
}

enum dt_status dt_raster_values(const struct dt *t, const struct dt_surface *s,
                                const struct dt_raster *r, uint64_t from, size_t n,
                                const struct dt_options *opt, double *out, size_t *done)
{
    enum { SLICES = 4 }; /* for each thread */
    bool limited = opt != NULL && opt->steps > 0;
    unsigned threads = opt == NULL || limited
                           ? 1
                           : dt_threads_for(opt->pool, n < UINT32_MAX ? (uint32_t)n : UINT32_MAX);
    if (threads == 1)
        return scan_cells(t, s, r, from, n, opt, out, done);
    struct slices k = {t, s, r, from, n, out, SLICES * threads, dt_stop_of(opt)};
    dt_run(opt->pool, k.slices, scan_slice, &k);
    *done = dt_stop_status(&k.stop) == DT_OK ? n : 0;
    return dt_stop_status(&k.stop);
}
