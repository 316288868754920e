/* cmd_load.c - LOAD, LOADB and FSETB, when their body is complete: all of it counts at once, so that a load is atomic. */
#include "server/command/command.h"

#include "server/bodies/load.h"
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

/* Adds the points, if there is memory for them; else they stay. */
void cmd_load(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct load *l = a->body;
    if (!submit_may(a, set, CHANGE_ADD, l->body.n))
        return;
    struct submission *x = submission_new(s, a, CHANGE_ADD, &q->word[1]);
    struct word names = load_field_names(l->shape, q);
    double *rows;
    if (x == NULL)
        return;
    x->change.first = CHANGE_ANY;
    x->change.n = (uint32_t)l->body.n;
    if ((names.len > 0 && (x->change.columns = read_field_names(a, set, &names)) == NULL) ||
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
