/* cmd_constraint.c - the commands about constraints: segments that the triangulation keeps. */
#include "server/command/command.h"

#include "server/changes/constraint.h"
#include "server/jobs/submit.h"
#include "server/replies/query.h"

#include <stdlib.h>

/* ---- arguments ---- */

bool read_number_of_constraint(struct answer *a, const struct word *w, uint32_t *k)
{
    if (!read_count(a, w, "a number of constraints", k))
        return false;
    if (*k <= DT_MAX_NUMBER)
        return true;
    return answer_err(a, ERR_RANGE, "the number of a constraint is at most %d", DT_MAX_NUMBER);
}

bool read_chosen(struct answer *a, const struct request *q, size_t from, struct chosen *f)
{
    uint32_t k = 0;
    bool border = false, more = true;
    *f = (struct chosen){.at = from};
    while (more && f->at < q->n) {
        const struct word *w = &q->word[f->at];
        if (!border && word_is(w, "BORDER")) {
            border = true;
        } else if (!f->splits && word_is(w, "SPLIT")) {
            f->splits = true;
        } else if (!f->numbered && f->at + 1 < q->n && word_is(w, "OF")) {
            f->numbered = true;
            if (!read_number_of_constraint(a, &q->word[++f->at], &k))
                return false;
        } else {
            more = false;
        }
        f->at += more;
    }
    f->what = constraint_what(border, k);
    return true;
}

/* Constraints that are to be split: the change becomes a PSLG without points. */
static bool become_drawing(struct answer *a, const struct chosen *f, struct change *c)
{
    if (!f->splits)
        return true;
    c->pslg = pslg_new();
    if (c->pslg == NULL)
        return answer_out_of_memory(a);
    c->kind = &change_kinds[CHANGE_PSLG];
    c->first = CHANGE_ANY;
    c->pslg->asked = c->pslg->splits = true;
    c->pslg->lists = (struct pslg_lists){.added = c->constraints, .n_added = c->n};
    c->constraints = NULL;
    c->n = 0;
    return true;
}

/* The constraints whose ends are ids of the request, as the change's: `from` and `step` say which. */
static bool read_segments(struct answer *a, const struct request *q, const struct chosen *f,
                          size_t from, size_t step, size_t n, struct change *c)
{
    size_t ids = q->n - from;
    c->n = (uint32_t)n;
    c->constraints = dt_pages_grow(c->pages, NULL, 0, (n + 1) * sizeof *c->constraints);
    if (c->constraints == NULL)
        answer_out_of_memory(a);
    bool good = c->constraints != NULL;
    for (size_t i = 0; good && i < n; i++) {
        struct record_constraint *to = &c->constraints[i];
        to->what = f->what;
        good = read_id(a, &q->word[from + i * step], &to->a) &&
               read_id(a, &q->word[from + (i * step + 1) % ids], &to->b);
        if (good && to->a == to->b) {
            answer_err(a, ERR_SYNTAX, "the constraint %u %u has one end only", to->a, to->b);
            good = false;
        }
    }
    return good;
}

static bool read_pairs(struct answer *a, const struct request *q, const struct chosen *f,
                       struct change *c)
{
    size_t ids = q->n - f->at;
    if (ids > 0 && ids % 2 == 0)
        return read_segments(a, q, f, f->at, 2, ids / 2, c);
    return answer_usage(a);
}

/* Pairs, PATH or RING. */
static bool read_declared(struct answer *a, const struct request *q, const struct chosen *f,
                          struct change *c)
{
    bool path = f->at < q->n && word_is(&q->word[f->at], "PATH");
    bool ring = f->at < q->n && word_is(&q->word[f->at], "RING");
    if (!path && !ring)
        return read_pairs(a, q, f, c);
    size_t ids = q->n - f->at - 1;
    if (ids >= (path ? 2 : 3))
        return read_segments(a, q, f, f->at + 1, 1, path ? ids - 1 : ids, c);
    return answer_usage(a);
}

bool read_constraints(struct server *s, const struct dataset *set, const struct request *q,
                      struct answer *a, struct change *c)
{
    struct chosen f;
    return read_chosen(a, q, 2, &f) && read_declared(a, q, &f, c) && become_drawing(a, &f, c);
}

bool read_releases(struct server *s, const struct dataset *set, const struct request *q,
                   struct answer *a, struct change *c)
{
    struct chosen f;
    if (q->n == 3 && word_is(&q->word[2], "ALL")) {
        c->a = RELEASE_ALL;
        return true;
    }
    if (!read_chosen(a, q, 2, &f))
        return false;
    if (f.splits)
        return answer_usage(a);
    if (f.at < q->n || !f.numbered)
        return read_pairs(a, q, &f, c);
    c->a = RELEASE_NUMBER;
    c->first = f.what;
    return true;
}

/* The pairs of a body, which keeps them, because the request may have to wait. */
static bool copy_pairs(struct answer *a, const struct chosen *f, struct change *c)
{
    const uint32_t *id = (const uint32_t *)(const void *)a->body->body.xy;
    c->constraints = dt_pages_grow(c->pages, NULL, 0, ((size_t)c->n + 1) * sizeof *c->constraints);
    if (c->constraints == NULL)
        return answer_out_of_memory(a);
    for (size_t i = 0; i < c->n; i++)
        c->constraints[i] = (struct record_constraint){id[2 * i], id[2 * i + 1], f->what};
    return become_drawing(a, f, c);
}

/* CONSTRAINB and RELEASEB, when their pairs have come. */
void cmd_constrainb(struct server *s, struct dataset *set, const struct request *q,
                    struct answer *a)
{
    struct chosen f;
    struct submission *x = submission_new(s, a, a->command->change, &q->word[1]);
    if (x == NULL)
        return;
    bool good = read_chosen(a, q, 2, &f), declares = a->command->change == CHANGE_CONSTRAIN;
    if (good && (f.at + 1 != q->n || (f.splits && !declares))) {
        answer_usage(a);
        good = false;
    }
    x->change.n = (uint32_t)a->body->body.n;
    if (good && f.splits)
        good = copy_pairs(a, &f, &x->change);
    if (!good || !submit_reserve(s, a, set, x)) {
        job_free(s, &x->job);
        return;
    }
    if (!f.splits) {
        x->change.first = f.what;
        x->change.rows = load_take(a->body, &x->job.memory);
    }
    submit(s, a, set, x);
}

/* ---- CONSTRAINTS ---- */

void cmd_constraints(struct server *s, struct dataset *set, const struct request *q,
                     struct answer *a)
{
    struct query query = {.kind = QUERY_CONSTRAINTS};
    query.binary = q->n > 2 && word_is(&q->word[q->n - 1], "BINARY");
    size_t n = q->n - 2 - query.binary;
    query.numbered = n == 2 && word_is(&q->word[2], "OF");
    if (query.numbered && !read_number_of_constraint(a, &q->word[3], &query.k))
        return;
    query.ended = n > 0 && !query.numbered;
    if (!query.ended || read_points(a, set->current->dt, &q->word[2], n, &query.ids))
        query_answer(s, a, set, &query);
}
