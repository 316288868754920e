/* cmd_cells.c - VORONOI, AREAS and ALPHA.
 *
 * Cells are rows that are made as they are sent. Before the first one, the status line says what must be found first:
 * the box around all points, and with BINARY how many corners there are. Both are found as of the same moment as
 * the rows, piece by piece by a worker where that takes long. To count corners, all cells are made at once and kept,
 * if there is memory for them and no edit comes in between; otherwise they are made twice. Areas are made at once, too:
 * that is three times as fast as one cell after the other, and takes 8 bytes for each. */
#include "server/command/command.h"

#include "server/jobs/job.h"
#include "server/ops/cost.h"
#include "server/rows/answer_rows.h"

#include <math.h>
#include <stdlib.h>

enum {
    CELLS_AT_ONCE = 64,   /* cells that a reactor looks at itself */
    CELLS_A_VISIT = 1024, /* that a worker counts in one visit, */
    CELLS_MADE = 4096,    /* or makes */
    HULL_LOCKED = 4096,   /* the same for points of the hull */
    STARS_AT_ONCE = 256,  /* as cells, for ALPHA */
    STARS_LOCKED = 4096
};

struct cells_job {
    struct job job;
    struct rows rows;       /* owns its ids */
    struct dt_point lo, hi; /* the box */
    bool boxed;             /* these are those of the request */
    uint64_t corners;       /* with BINARY: of all cells */
};

/* Whether all cells are made at once, if there is memory for them: those that must be counted, and areas. */
static bool is_made(const struct rows *r)
{
    return r->heavy && r->ids.v == NULL && (r->binary || r->form == ROW_AREA);
}

/* ---- before the status line ---- */

static enum dt_status find_box(struct cells_job *j)
{
    struct dt_bounds bounds = {0};
    enum dt_status status = DT_OK;
    for (bool done = false; !done && status == DT_OK;) {
        status = dt_bounds_read(j->job.dt, j->job.view, &bounds, HULL_LOCKED, &done);
        status = job_pause(&j->job, status);
    }
    dt_bounds_grow(&bounds, &j->lo, &j->hi);
    return status;
}

/* Counts the corners of the next cells, about a thousand. */
static enum dt_status count_some(const struct dt *dt, struct dt_cells *c, size_t *cells,
                                 uint64_t *corners)
{
    struct dt_cell cell[CELLS_AT_ONCE];
    struct dt_point corner[8 * CELLS_AT_ONCE];
    size_t n = 1, found;
    *cells = 0;
    while (n > 0 && *cells < CELLS_A_VISIT) {
        enum dt_status status =
            dt_cells_read(dt, c, cell, CELLS_AT_ONCE, corner, 8 * CELLS_AT_ONCE, &n, &found);
        if (status == DT_TOOSMALL) {
            struct dt_point *room = malloc(found * sizeof *room);
            if (room == NULL)
                return DT_NOMEM;
            status = dt_cells_read(dt, c, cell, 1, room, found, &n, &found);
            free(room);
        }
        if (status != DT_OK)
            return status;
        *cells += n;
        *corners += found;
    }
    return DT_OK;
}

static enum dt_status count_corners(struct cells_job *j)
{
    const struct dt_options opt = {.cancel = &j->job.cancel};
    struct dt_cells whole = j->rows.cells, one;
    const struct dt_ids *ids = &j->rows.ids;
    size_t n = 1, done = 0, all = rows_count(&j->rows);
    enum dt_status status = DT_OK;
    whole.opt = &opt;
    while (status == DT_OK && n > 0 && done < all) {
        if (ids->v != NULL)
            dt_cells_only(&whole, ids->v[done], &one);
        status = count_some(j->job.dt, ids->v != NULL ? &one : &whole, &n, &j->corners);
        done += n;
        atomic_store(&j->job.progress, (unsigned)(done * 100 / (all + 1)));
        status = job_pause(&j->job, status);
    }
    return status;
}

/* Makes the next cells. False: they cannot be made at once. */
static bool make_some(struct cells_job *j, struct dt_cells_made *made, bool *done)
{
    const struct dt *dt = j->job.dt;
    return (j->job.view == NULL || dt_view_is_current(dt, j->job.view)) &&
           dt_cells_make(dt, made, &j->job.options, CELLS_MADE, done) == DT_OK;
}

static bool begin_making(struct cells_job *j, struct dt_cells_made **out)
{
    const struct dt_cells *c = &j->rows.cells;
    enum dt_status status = j->rows.form == ROW_AREA ? dt_areas_make_begin(j->job.dt, c, out)
                                                     : dt_cells_make_begin(j->job.dt, c, out);
    return status == DT_OK && *out != NULL;
}

/* Makes all cells, or their areas, at once. False: no memory, an edit has come in between, or another reason. */
static bool make_cells(struct cells_job *j)
{
    struct dt_cells_made *made;
    uint64_t all = rows_count(&j->rows) + 1;
    bool done = false;
    if (!begin_making(j, &made))
        return false;
    bool ok = reservation_resize(&j->job.memory, dt_cells_made_memory(made));
    for (uint64_t n = CELLS_MADE; ok && !done; n += CELLS_MADE) {
        ok = make_some(j, made, &done) &&
             reservation_resize(&j->job.memory, dt_cells_made_memory(made)) &&
             job_pause(&j->job, DT_OK) == DT_OK;
        atomic_store(&j->job.progress, (unsigned)(n < all ? n * 100 / all : 99));
    }
    if (!ok)
        dt_cells_made_free(made);
    reservation_set(&j->job.memory, ok ? dt_cells_made_memory(made) : 0);
    j->rows.cells.made = j->rows.made = ok ? made : NULL;
    return ok;
}

static void run_cells(struct job *job)
{
    struct cells_job *j = (struct cells_job *)job;
    struct rows *rows = &j->rows;
    job->status = j->boxed ? DT_OK : find_box(j);
    if (job->status == DT_OK)
        job->status = dt_cells_begin(job->dt, job->view, j->lo, j->hi, &rows->cells);
    if (job->status != DT_OK)
        return;
    bool counted = rows->binary && rows->form == ROW_CELL;
    if (is_made(rows) && make_cells(j))
        j->corners = counted ? dt_cells_made_corners(rows->made) : 0;
    else
        job->status = counted ? count_corners(j) : job_pause(job, DT_OK);
}

/* ---- the reply ---- */

static void reply_status(const struct cells_job *j, struct answer *a)
{
    const struct dt_cells *c = &j->rows.cells;
    const double box[] = {c->lo.x, c->lo.y, c->hi.x, c->hi.y};
    uint64_t rows = rows_count(&j->rows);
    reply_ok(a->out, j->rows.binary ? 0 : rows);
    if (j->rows.binary) {
        reply_key_u64(a->out, "rows", rows);
        reply_key_u64(a->out, "bytes",
                      j->rows.form == ROW_AREA ? 12 * rows : 8 * rows + 16 * j->corners);
    }
    reply_key_doubles(a->out, "box", box, 4);
    reply_end(a->out);
}

static void reply_cells(struct server *s, struct cells_job *j, struct answer *a)
{
    j->rows.version = j->job.base;
    j->rows.view = j->job.view;
    j->job.view = NULL;
    reply_status(j, a);
    answer_rows(s, a, &j->rows, j->rows.ids.v == NULL ? NULL : &j->rows.ids);
    if (a->next == ANSWER_STREAM)
        j->rows.made = NULL;
}

static void end_cells(struct server *s, struct job *job, struct answer *a)
{
    struct cells_job *j = (struct cells_job *)job;
    if (job_succeeded(job, a))
        reply_cells(s, j, a);
    dt_cells_made_free(j->rows.made);
    free(j->rows.ids.v);
}

/* ---- the request ---- */

/* Reads [BOX x0 y0 x1 y1] [BINARY] at the end of the request; *words become those before them. */
static bool read_options(struct answer *a, const struct request *q, struct cells_job *j,
                         size_t *words)
{
    *words = q->n;
    if (*words > 2 && word_is(&q->word[*words - 1], "BINARY")) {
        j->rows.binary = true;
        --*words;
    }
    if (*words < 7 || !word_is(&q->word[*words - 5], "BOX"))
        return true;
    *words -= 5;
    j->boxed = true;
    if (!read_box(a, &q->word[*words + 1], &j->lo, &j->hi))
        return false;
    if (j->lo.x < j->hi.x && j->lo.y < j->hi.y)
        return true;
    return answer_err(a, ERR_RANGE, "the box has no area");
}

static int compare_ids(const void *p, const void *q)
{
    uint32_t a = *(const uint32_t *)p, b = *(const uint32_t *)q;
    return (a > b) - (a < b);
}

/* The representatives of the words' ids, ascending, each once. */
static bool read_sites(struct answer *a, const struct dt *dt, const struct word *w, size_t n,
                       struct dt_ids *ids)
{
    size_t kept = 0;
    if (!read_points(a, dt, w, n, ids))
        return false;
    for (size_t i = 0; i < n; i++)
        dt_representative(dt, ids->v[i], &ids->v[i]);
    qsort(ids->v, n, sizeof *ids->v, compare_ids);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || ids->v[kept - 1] != ids->v[i])
            ids->v[kept++] = ids->v[i];
    ids->n = kept;
    return true;
}

/* Whether a reactor finds the box and makes the rows itself. */
static bool is_light(const struct cells_job *j, const struct version *v)
{
    uint32_t degrees = 0;
    bool listed = j->rows.ids.v != NULL;
    if (!j->boxed && v->sum.hull > COST_STEPS_AT_ONCE)
        return false;
    if (!listed)
        return v->sum.points <= CELLS_AT_ONCE;
    if (j->rows.ids.n > CELLS_AT_ONCE)
        return false;
    for (size_t i = 0; i < j->rows.ids.n; i++)
        degrees += dt_degree_up_to(v->dt, j->rows.ids.v[i], COST_STEPS_AT_ONCE);
    return degrees < COST_STEPS_AT_ONCE;
}

static bool read_request(struct answer *a, const struct request *q, const struct dt *dt,
                         struct cells_job *j)
{
    size_t words;
    if (!read_options(a, q, j, &words))
        return false;
    if (words > 2 && j->rows.form == ROW_AREA)
        return answer_usage(a);
    return words == 2 || read_sites(a, dt, &q->word[2], words - 2, &j->rows.ids);
}

static void answer_cells(struct server *s, struct dataset *set, const struct request *q,
                         enum row_form form, struct answer *a)
{
    struct version *v = set->current;
    if (!check_delaunay(a, set->current))
        return;
    struct cells_job *j =
        job_new_reading(s, a, sizeof *j, run_cells, end_cells, "computing cells", NULL);
    if (j == NULL)
        return;
    j->rows = (struct rows){.form = form, .width = 1};
    if (!read_request(a, q, v->dt, j)) {
        job_free(s, &j->job);
        return;
    }
    j->rows.heavy = s->workers != NULL && !is_light(j, v);
    if (j->rows.heavy && !job_begin_view(s, a, &j->job, v, true))
        return;
    job_read(s, a, &j->job, v,
             !j->rows.heavy                        ? JOB_LIGHT
             : j->rows.binary || is_made(&j->rows) ? JOB_LONG
                                                   : JOB_SHORT);
}

void cmd_voronoi(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    answer_cells(s, set, q, ROW_CELL, a);
}

void cmd_areas(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    answer_cells(s, set, q, ROW_AREA, a);
}

/* ---- ALPHA ---- */

struct alpha_job {
    struct job job;
    double radius;
    bool automatic;    /* the radius is to be found */
    struct dt_ids ids; /* owns: the loops */
    size_t loops;
};

static enum dt_status read_alpha(struct alpha_job *j, struct dt_alpha *alpha)
{
    struct dt_summary sum;
    enum dt_status status = DT_OK;
    dt_summary(j->job.dt, &sum);
    for (uint64_t stars = STARS_LOCKED, done = 0; status == DT_OK && !done; stars += STARS_LOCKED) {
        bool end = false;
        status = job_reserve(&j->job, dt_alpha_memory(alpha, STARS_LOCKED));
        if (status == DT_OK)
            status = dt_alpha_read(j->job.dt, alpha, STARS_LOCKED, &end);
        status = job_pause(&j->job, status);
        atomic_store(&j->job.progress, (unsigned)(stars * 100 / (sum.points + stars)));
        done = end;
    }
    return status;
}

/* Finds the radius for AUTO. */
static enum dt_status find_radius(struct alpha_job *j)
{
    struct dt_alpha_auto *a;
    bool done = false;
    enum dt_status status = dt_alpha_auto_begin(j->job.dt, j->job.view, &a);
    if (status == DT_OK)
        status = job_reserve(&j->job, dt_alpha_auto_memory(a));
    while (status == DT_OK && !done)
        status = job_pause(&j->job, dt_alpha_auto_read(j->job.dt, a, &done));
    job_end_visit(&j->job);
    if (status == DT_OK)
        status = dt_alpha_auto_end(a, &j->job.options, &j->radius);
    dt_alpha_auto_free(a);
    job_visit(&j->job);
    return status;
}

static void run_alpha(struct job *job)
{
    struct alpha_job *j = (struct alpha_job *)job;
    struct dt_alpha *alpha = NULL;
    job->status = j->automatic ? find_radius(j) : DT_OK;
    if (job->status == DT_OK)
        job->status = dt_alpha_begin(job->dt, job->view, j->radius, &alpha);
    if (job->status == DT_OK)
        job->status = read_alpha(j, alpha);
    job_end_visit(job); /* what is left does not need the set */
    if (job->status == DT_OK)
        job->status = dt_alpha_end(alpha, &job->options, &j->ids, &j->loops);
    dt_alpha_free(alpha);
    job_visit(job);
}

static void end_alpha(struct server *s, struct job *job, struct answer *a)
{
    struct alpha_job *j = (struct alpha_job *)job;
    struct rows rows = {.version = job->base, .form = ROW_WORDS, .format = "hI", .width = 1};
    if (job_succeeded(job, a)) {
        rows.heavy = s->workers != NULL && j->ids.n > COST_STEPS_AT_ONCE;
        reply_ok(a->out, j->loops);
        if (j->automatic)
            reply_key_double(a->out, "radius", j->radius);
        reply_end(a->out);
        answer_rows(s, a, &rows, &j->ids);
    }
    free(j->ids.v);
}

/* Any finite number that is not negative: circumradii can be longer than a coordinate. */
static bool read_radius(struct answer *a, const struct word *w, double *radius)
{
    if (!read_number(a, w, radius))
        return false;
    *radius += 0.0; /* -0 becomes 0 */
    if (*radius < 0)
        answer_err(a, ERR_RANGE, "a radius is not negative");
    else if (isinf(*radius))
        answer_err(a, ERR_RANGE, "a radius is finite");
    else
        return true;
    return false;
}

void cmd_alpha(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    double radius = 0;
    struct version *v = set->current;
    bool light = v->sum.points <= STARS_AT_ONCE, automatic = word_is(&q->word[2], "AUTO");
    if ((!automatic && !read_radius(a, &q->word[2], &radius)) || !check_delaunay(a, set->current))
        return;
    struct alpha_job *j =
        job_new_reading(s, a, sizeof *j, run_alpha, end_alpha, "computing the boundary", NULL);
    if (j == NULL)
        return;
    j->radius = radius;
    j->automatic = automatic;
    if (!light && !job_begin_view(s, a, &j->job, v, true))
        return;
    job_read(s, a, &j->job, v, light ? JOB_LIGHT : JOB_LONG);
}
