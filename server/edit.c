/* edit.c - see edit.h. */
#include "server/edit.h"

#include "server/journal.h"
#include "server/keep.h"

#include <stdlib.h>

enum {
    SETS_LIMIT = 65536,
    EDITS_AT_ONCE = 100, /* points that the I/O thread itself adds or deletes */
    BYTES_PER_POINT = 64 /* what a new point is expected to take, for --max-memory */
};

struct edit {
    struct job job;
    struct dt_point *p; /* owns: the points to add */
    uint32_t *ids;      /* owns: the ids to delete */
    size_t n;
    size_t expected;       /* bytes that are expected to be wanted after it (keep.h) */
    struct server *server; /* borrows; to be told when that is over */
    uint32_t id;           /* the point to move */
    struct dt_point to;
    struct dt_added added;
    uint32_t deleted, missing;
};

static void clear_edit(struct job *j)
{
    struct edit *e = (struct edit *)j;
    dt_pages_release(e->p);
    free(e->ids);
    if (e->expected > 0)
        keep_expect(e->server, 0, e->expected);
}

static unsigned how(size_t n)
{
    return n > EDITS_AT_ONCE ? JOB_HEAVY : 0;
}

struct dataset *edit_create(struct server *s, struct answer *a, const struct word *name,
                            double tolerance)
{
    struct dataset *set = NULL;
    if (s->sets.sets >= SETS_LIMIT)
        reply_err(a->out, ERR_TOOBIG, "a server holds at most %d sets", SETS_LIMIT);
    else if ((set = registry_create(&s->sets, name, tolerance)) == NULL)
        answer_out_of_memory(a);
    return set;
}

/* ---- add ---- */

static void run_add(struct job *j)
{
    struct edit *e = (struct edit *)j;
    j->status = dt_add_many(j->dt, e->p, e->n, &j->options, &e->added);
}

static void record_add(struct server *s, struct job *j)
{
    struct edit *e = (struct edit *)j;
    struct dt_point *p = e->p;
    e->p = NULL;
    journal_add(s, j->set, e->added.first, p, e->n);
}

static void add_done(struct server *s, struct job *j, struct answer *a)
{
    struct edit *e = (struct edit *)j;
    (void)s;
    if (j->status != DT_OK) {
        answer_status(a, j->status);
        return;
    }
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "first", e->added.first);
    reply_key_u64(a->out, "added", e->added.added);
    reply_key_u64(a->out, "coincident", e->added.coincident);
    reply_end(a->out);
}

/* Whether the set, NULL for a new one, may grow by n points. */
static bool may_grow(struct server *s, struct answer *a, const struct dataset *set, size_t n)
{
    uint32_t points = set != NULL ? set->current->sum.points : 0, most = s->config->max_points;
    if (points > most || n > most - points)
        reply_err(a->out, ERR_TOOBIG, "a set holds at most %u points (--max-points)", most);
    else if (server_lacks_memory(s, n * BYTES_PER_POINT))
        reply_err(a->out, ERR_NOMEM, "the memory for sets is used up (--max-memory)");
    else
        return true;
    return false;
}

void edit_add(struct server *s, struct answer *a, const struct word *name, struct dt_point *p,
              size_t n, size_t expected)
{
    struct dataset *set = registry_find(&s->sets, name);
    struct edit *e = NULL;
    if (may_grow(s, a, set, n)) {
        e = job_new(sizeof *e, run_add, add_done);
        if (e == NULL)
            answer_out_of_memory(a);
    }
    if (e != NULL && set == NULL)
        set = edit_create(s, a, name, 0);
    if (e == NULL || set == NULL) {
        free(e);
        dt_pages_release(p);
        keep_expect(s, 0, expected);
        return;
    }
    e->job.clear = clear_edit;
    e->job.record = record_add;
    e->job.what = "adding points";
    e->p = p;
    e->n = n;
    e->expected = expected;
    e->server = s;
    job_write(s, a, &e->job, set, how(n));
}

/* ---- delete ---- */

static void run_delete(struct job *j)
{
    struct edit *e = (struct edit *)j;
    j->status = dt_delete_many(j->dt, e->ids, e->n, &j->options, &e->deleted, &e->missing);
}

static void record_delete(struct server *s, struct job *j)
{
    struct edit *e = (struct edit *)j;
    journal_delete(s, j->set, e->ids, e->n);
}

static void delete_done(struct server *s, struct job *j, struct answer *a)
{
    struct edit *e = (struct edit *)j;
    (void)s;
    if (j->status == DT_NOPOINT) {
        reply_err(a->out, ERR_NOPOINT, "there is no point %u; nothing was deleted", e->missing);
    } else if (j->status != DT_OK) {
        answer_status(a, j->status);
    } else {
        reply_ok(a->out, 0);
        reply_key_u64(a->out, "deleted", e->deleted);
        reply_end(a->out);
    }
}

void edit_delete(struct server *s, struct answer *a, struct dataset *set, uint32_t *ids, size_t n)
{
    struct edit *e = job_new(sizeof *e, run_delete, delete_done);
    if (e == NULL) {
        free(ids);
        answer_out_of_memory(a);
        return;
    }
    e->job.clear = clear_edit;
    e->job.record = record_delete;
    e->job.what = "deleting points";
    e->ids = ids;
    e->n = n;
    job_write(s, a, &e->job, set, how(n));
}

/* ---- move ---- */

static void run_move(struct job *j)
{
    struct edit *e = (struct edit *)j;
    j->status = dt_move_to(j->dt, e->id, e->to, &j->options);
}

static void record_move(struct server *s, struct job *j)
{
    struct edit *e = (struct edit *)j;
    journal_move(s, j->set, e->id, e->to);
}

static void move_done(struct server *s, struct job *j, struct answer *a)
{
    struct edit *e = (struct edit *)j;
    (void)s;
    if (j->status == DT_NOPOINT) {
        reply_err(a->out, ERR_NOPOINT, "there is no point %u", e->id);
    } else if (j->status != DT_OK) {
        answer_status(a, j->status);
    } else {
        reply_ok(a->out, 0);
        reply_end(a->out);
    }
}

void edit_move(struct server *s, struct answer *a, struct dataset *set, uint32_t id,
               struct dt_point to)
{
    struct edit *e = job_new(sizeof *e, run_move, move_done);
    if (e == NULL) {
        answer_out_of_memory(a);
        return;
    }
    e->job.record = record_move;
    e->job.what = "moving a point";
    e->id = id;
    e->to = to;
    job_write(s, a, &e->job, set, 0);
}
