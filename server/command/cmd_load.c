/* cmd_load.c - LOAD, LOADB and FSETB, when their body is complete: all of it counts at once, so that a load is atomic. */
#include "server/command/command.h"

#include "server/bodies/load.h"
#include "server/changes/paths.h"
#include "server/jobs/submit.h"

/* The rows of the body. A reactor that shares the world may have to give up the change, so it copies the few rows that it takes.
 * False: out of memory. */
static bool take_rows(struct answer *a, struct submission *x, double **rows)
{
    *rows = answer_shares(a) ? load_copy(a->body) : load_take(a->body, &x->job.memory);
    if (*rows == NULL && a->body->body.n > 0)
        answer_out_of_memory(a);
    return !a->out->failed;
}

/* ---- LOAD ... PATHS ---- */

/* Reads the words behind PATHS: the constraints of the body. */
static bool read_paths(struct answer *a, const struct request *q, const struct load_words *w,
                       struct chosen *f)
{
    const struct body *b = &a->body->body;
    if (!read_chosen(a, q, w->paths + 1, f))
        return false;
    if (f->at != w->end)
        return answer_usage(a);
    size_t paths = paths_count(b->xy, b->n, b->width);
    if (paths > 0 && paths - 1 > DT_MAX_NUMBER - (f->what >> 1))
        return answer_err(a, ERR_RANGE, "the number of a constraint is at most %d", DT_MAX_NUMBER);
    return true;
}

/* The change has its sizes; `constraints` is the most that it can have. */
static bool begin_drawing(struct answer *a, bool splits, size_t constraints, struct change *c)
{
    c->pslg = pslg_new();
    if (c->pslg == NULL)
        return answer_out_of_memory(a);
    c->kind = &change_kinds[CHANGE_PSLG];
    c->pslg->loads = true;
    c->pslg->asked = c->pslg->splits = splits;
    c->pslg->lists.n_added = (uint32_t)constraints;
    return true;
}

/* Points and constraints that a body has: rows of paths, or with `records` points and then the records of constraints. */
struct drawn_body {
    const struct word *names; /* of the fields; borrows */
    size_t points, records;
    uint32_t what;
    bool splits;
};

static void load_drawing(struct server *s, struct dataset *set, const struct request *q,
                         struct answer *a, const struct drawn_body *b)
{
    struct load *l = a->body;
    struct submission *x = submission_new(s, a, CHANGE_ADD, &q->word[1]);
    if (x == NULL)
        return;
    struct change *c = &x->change;
    uint32_t first = set == NULL ? 0 : dt_next_id(set->current->dt);
    c->first = CHANGE_ANY;
    c->n = (uint32_t)b->points;
    if ((b->names->len > 0 && (c->columns = read_field_names(a, set, b->names)) == NULL) ||
        !begin_drawing(a, b->splits, l->body.paths ? b->points : b->records, c) ||
        !submit_reserve(s, a, set, x)) {
        job_free(s, &x->job);
        return;
    }
    x->expected = load_hand_on_expected(s, l);
    double *rows = load_take(l, &x->job.memory);
    c->pslg->counts = !l->body.paths;
    if (l->body.paths ? paths_take(c, rows, b->points, first, b->what)
                      : paths_take_records(c, rows, b->points, b->records, first)) {
        submit(s, a, set, x);
        return;
    }
    answer_out_of_memory(a);
    job_free(s, &x->job);
}

static void load_paths(struct server *s, struct dataset *set, const struct request *q,
                       struct answer *a, const struct load_words *w)
{
    struct chosen f;
    struct drawn_body b = {.names = &w->names, .points = a->body->body.n};
    if (!world_alone(a) || !read_paths(a, q, w, &f))
        return;
    b.what = f.what;
    b.splits = f.splits;
    load_drawing(s, set, q, a, &b);
}

/* ---- LOADB ... CONSTRAINTS ---- */

/* Whether every record is a constraint between two of the n points. */
static bool check_records(struct answer *a, size_t n, size_t records)
{
    const struct body *b = &a->body->body;
    for (size_t i = 0; i < records; i++) {
        struct paths_record r = paths_record_at(b->xy, n, b->width, i);
        bool good = r.a < n && r.b < n && r.a != r.b && r.border <= 1 && r.number <= DT_MAX_NUMBER;
        if (good)
            continue;
        if (r.a >= n || r.b >= n)
            answer_err(a, ERR_NOPOINT, "constraint %zu: %u %u are not two of the %zu points", i + 1,
                       r.a, r.b, n);
        else if (r.a == r.b)
            answer_err(a, ERR_SYNTAX, "constraint %zu has one end only", i + 1);
        else
            answer_err(a, ERR_RANGE,
                       "constraint %zu: 1 is a border, 0 a line; its number is at most %d", i + 1,
                       DT_MAX_NUMBER);
        return false;
    }
    return true;
}

static void load_records(struct server *s, struct dataset *set, const struct request *q,
                         struct answer *a, const struct load_words *w)
{
    size_t n = w->constraints.n;
    struct drawn_body b = {.names = &w->names,
                           .points = a->body->body.n - n,
                           .records = n,
                           .splits = w->constraints.splits};
    if (!world_alone(a))
        return;
    if (w->constraints.end != w->end)
        answer_usage(a);
    else if (check_records(a, b.points, n))
        load_drawing(s, set, q, a, &b);
}

/* ---- the others ---- */

/* Adds the points, if there is memory for them; else they stay. */
void cmd_load(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct load *l = a->body;
    const struct load_words w = load_words_of(l->shape, q);
    if (w.paths > 0) {
        load_paths(s, set, q, a, &w);
        return;
    }
    if (w.constraints.end > 0) {
        load_records(s, set, q, a, &w);
        return;
    }
    if (!submit_may(a, set, CHANGE_ADD, l->body.n))
        return;
    struct submission *x = submission_new(s, a, CHANGE_ADD, &q->word[1]);
    double *rows;
    if (x == NULL)
        return;
    x->change.first = CHANGE_ANY;
    x->change.n = (uint32_t)l->body.n;
    if ((w.names.len > 0 && (x->change.columns = read_field_names(a, set, &w.names)) == NULL) ||
        !submit_reserve(s, a, set, x) || !take_rows(a, x, &rows)) {
        job_free(s, &x->job);
        return;
    }
    x->expected = load_hand_on_expected(s, l);
    change_set_rows(&x->change, rows);
    submit(s, a, set, x);
}

void cmd_fsetb(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct load *l = a->body;
    if (!submit_may(a, set, CHANGE_RUN, l->body.n))
        return;
    struct submission *x = submission_new(s, a, CHANGE_RUN, &q->word[1]);
    uint32_t first;
    if (x == NULL)
        return;
    x->change.n = (uint32_t)l->body.n;
    struct columns *v = x->change.columns = columns_new(1);
    if (v == NULL)
        answer_out_of_memory(a);
    if (v == NULL || !read_field_name(a, &q->word[2]) || !read_id(a, &q->word[3], &first) ||
        !submit_reserve(s, a, set, x) || !take_rows(a, x, &v->v)) {
        job_free(s, &x->job);
        return;
    }
    v->first = first;
    v->n = x->change.n;
    v->field[0] = name_of(q->word[2].text, q->word[2].len);
    submit(s, a, set, x);
}
