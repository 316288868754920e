/* apply.c - see apply.h. */
#include "server/follow/apply.h"

#include "core/delaunay_fields.h"
#include "server/command/command.h"
#include "server/jobs/durable.h"
#include "server/jobs/edit.h"
#include "server/jobs/job.h"
#include "server/jobs/journal.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void on_wake(struct waiter *w)
{
    struct apply *p = (struct apply *)((char *)w - offsetof(struct apply, waiter));
    p->resume(p);
}

void apply_init(struct apply *p, struct server *s, void (*resume)(struct apply *p))
{
    *p = (struct apply){
        .server = s, .resume = resume, .memory = server_reservation(s, BUDGET_LOADS)};
    p->waiter.wake = on_wake;
    p->waiter.writes = true;
}

static void drop_load(struct apply *p)
{
    p->in_load = false;
    dt_pages_release(p->points);
    columns_free(p->columns);
    buf_free(&p->values);
    p->points = NULL;
    p->columns = NULL;
    p->n = p->cap = 0;
    p->values_n = 0;
    reservation_set(&p->memory, 0);
}

void apply_clear(struct apply *p)
{
    wait_served(&p->waiter);
    drop_load(p);
    buf_free(&p->out);
}

bool apply_in_load(const struct apply *p)
{
    return p->in_load;
}

/* ---- answers ---- */

static enum applied fail(struct apply *p, const char *why)
{
    snprintf(p->why, sizeof p->why, "%s", why);
    return APPLY_FAILED;
}

static enum applied short_of_memory(struct apply *p)
{
    snprintf(p->why, sizeof p->why, "out of memory (--max-memory)");
    return APPLY_LATER;
}

static struct answer answer_of(struct apply *p)
{
    buf_rewind(&p->out, 0);
    return (struct answer){.out = &p->out,
                           .owner = APPLY_OWNER,
                           .role = ROLE_WRITE,
                           .turn = wait_turn(&p->waiter),
                           .of_leader = true};
}

static bool begins_with(const struct buf *b, const char *text)
{
    size_t n = strlen(text);
    return buf_len(b) >= n && memcmp(buf_head(b), text, n) == 0;
}

/* What the answer of an edit means. */
static enum applied outcome(struct apply *p, const struct answer *a)
{
    switch (a->next) {
    case ANSWER_WAIT:
        p->waiter.writes = a->wait_writes;
        wait_enter(a->wait, &p->waiter);
        return APPLY_WAIT;
    case ANSWER_JOB:
        return APPLY_JOB;
    default:
        break;
    }
    if (!a->out->failed && begins_with(a->out, "OK"))
        return APPLY_DONE;
    if (a->out->failed || buf_len(a->out) < strlen("ERR "))
        return short_of_memory(p);
    bool later = begins_with(a->out, "ERR NOMEM") || begins_with(a->out, "ERR BUSY");
    const char *line = buf_head(a->out) + strlen("ERR ");
    snprintf(p->why, sizeof p->why, "%.*s", (int)strcspn(line, "\n"), line);
    return later ? APPLY_LATER : APPLY_FAILED;
}

void apply_job_done(struct apply *p, struct job *j)
{
    struct answer a = answer_of(p);
    job_finish(p->server, j, &a);
    wait_served(&p->waiter);
    p->job = outcome(p, &a);
    p->resume(p);
}

enum applied apply_result(struct apply *p)
{
    return p->job;
}

/* ---- loads ---- */

/* The points and values of a load that has not ended. */
static bool reserve_load(struct apply *p, size_t points, size_t values)
{
    return reservation_resize(&p->memory, points * sizeof *p->points + values * sizeof(double));
}

static bool take_points(struct apply *p, const struct record *r)
{
    size_t want = p->n + r->n;
    if (r->n == 0) /* there may be no array */
        return true;
    if (want > p->cap) {
        size_t cap = want > 2 * p->cap ? want : 2 * p->cap;
        struct dt_point *larger = NULL;
        if (reserve_load(p, cap, buf_len(&p->values) / sizeof(double)))
            larger = dt_pages_grow(p->server->pages, p->points, p->n * sizeof *larger,
                                   cap * sizeof *larger);
        if (larger == NULL)
            return false;
        p->points = larger;
        p->cap = cap;
    }
    record_points(r, &p->points[p->n].x);
    p->n += r->n;
    return true;
}

/* Another column begins. */
static bool add_column(struct apply *p, const struct record *r)
{
    size_t before = p->columns == NULL ? 0 : p->columns->count;
    struct columns *v = before == DT_MAX_FIELDS ? NULL : columns_new(before + 1);
    if (v == NULL)
        return false;
    if (before > 0)
        memcpy(v->field, p->columns->field, before * sizeof v->field[0]);
    v->field[before].len = r->field_len;
    memcpy(v->field[before].text, r->field, r->field_len);
    columns_free(p->columns);
    p->columns = v;
    return true;
}

static bool continues_column(const struct apply *p, const struct record *r)
{
    const struct columns *v = p->columns;
    const struct name *last = v == NULL ? NULL : &v->field[v->count - 1];
    return last != NULL && last->len == r->field_len &&
           memcmp(last->text, r->field, r->field_len) == 0;
}

static bool take_values(struct apply *p, const struct record *r)
{
    if (p->columns == NULL)
        p->values_first = r->first;
    if (!reserve_load(p, p->cap, buf_len(&p->values) / sizeof(double) + r->n))
        return false;
    if (!continues_column(p, r) && !add_column(p, r))
        return false;
    char *to = buf_reserve(&p->values, r->n * sizeof(double) + 1);
    if (to == NULL)
        return false;
    for (uint32_t i = 0; i < r->n; i++) {
        double v;
        record_values(&(struct record){.items = (const char *)r->items + i * sizeof v, .n = 1}, &v);
        memcpy(to + i * sizeof v, &v, sizeof v);
    }
    buf_commit(&p->values, r->n * sizeof(double));
    if (p->columns->count == 1)
        p->values_n += r->n;
    return true;
}

/* The columns, as the edit takes them: their values in one array of their own. */
static bool fill_columns(struct apply *p)
{
    struct columns *v = p->columns;
    size_t bytes = buf_len(&p->values);
    if (v == NULL)
        return true;
    v->v = dt_pages_grow(p->server->pages, NULL, 0, bytes + 1);
    if (v->v == NULL)
        return false;
    if (bytes > 0)
        memcpy(v->v, buf_head(&p->values), bytes);
    v->first = p->values_first;
    v->n = p->values_n;
    return true;
}

/* ---- records ---- */

static enum applied add_points(struct apply *p, const struct record *r, struct dataset *set)
{
    struct answer a = answer_of(p);
    struct word name = {r->name, r->name_len};
    size_t columns = p->columns == NULL ? 0 : p->columns->count;
    struct arrival points = {.n = p->n};
    uint32_t next = set == NULL ? 0 : dt_next_id(set->current->dt);
    if (next != p->first)
        return fail(p, "its first id is not the next one here");
    if (!edit_may_add(p->server, &a, set, p->n, columns, &points.memory))
        return outcome(p, &a);
    if (!fill_columns(p)) {
        reservation_set(&points.memory, 0);
        return short_of_memory(p);
    }
    points.rows = (double *)p->points;
    points.values = p->columns;
    p->points = NULL;
    p->columns = NULL;
    edit_add(p->server, &a, &name, &points);
    drop_load(p);
    return outcome(p, &a);
}

static enum applied set_loaded_values(struct apply *p, struct dataset *set)
{
    struct answer a = answer_of(p);
    struct reservation memory;
    if (set == NULL)
        return fail(p, "there is no such set");
    if (!edit_may_set_run(p->server, &a, p->values_n, &memory))
        return outcome(p, &a);
    if (!fill_columns(p)) {
        reservation_set(&memory, 0);
        return short_of_memory(p);
    }
    struct columns *v = p->columns;
    struct word field = {v->field[0].text, v->field[0].len};
    double *values = v->v;
    v->v = NULL;
    edit_set_run(p->server, &a, set, &field, v->first, values, v->n, &memory);
    drop_load(p);
    return outcome(p, &a);
}

static enum applied apply_load(struct apply *p, const struct record *r, struct dataset *set)
{
    bool good = true;
    switch (r->type) {
    case RECORD_LOAD:
        drop_load(p);
        p->skip_load = false;
        p->in_load = true;
        p->first = r->first;
        return APPLY_DONE;
    case RECORD_CHUNK:
        good = take_points(p, r);
        break;
    case RECORD_VALUES:
        good = take_values(p, r);
        break;
    default:
        if (r->n == 0 && p->values_n > 0)
            return set_loaded_values(p, set);
        return r->n == p->n ? add_points(p, r, set) : fail(p, "points of a load are missing");
    }
    return good ? APPLY_DONE : short_of_memory(p);
}

static enum applied apply_add(struct apply *p, const struct record *r, struct dataset *set)
{
    if (p->n == 0 && !take_points(p, r)) /* it may be a second attempt */
        return short_of_memory(p);
    p->first = r->first;
    return add_points(p, r, set);
}

static enum applied apply_create(struct apply *p, const struct record *r, struct dataset *set)
{
    struct answer a = answer_of(p);
    struct word name = {r->name, r->name_len};
    if (set != NULL)
        return fail(p, "the set exists already");
    set = edit_create(p->server, &a, &name, r->a);
    if (set == NULL)
        return outcome(p, &a);
    set->born = true;
    journal_create(p->server, set, r->a);
    return APPLY_DONE;
}

static enum applied apply_delete(struct apply *p, const struct record *r, struct dataset *set)
{
    struct answer a = answer_of(p);
    uint32_t *ids = malloc((r->n + 1) * sizeof *ids);
    if (ids == NULL)
        return short_of_memory(p);
    record_ids(r, ids);
    edit_delete(p->server, &a, set, ids, r->n);
    return outcome(p, &a);
}

static enum applied apply_fset(struct apply *p, const struct record *r, struct dataset *set)
{
    struct answer a = answer_of(p);
    struct word field = {r->field, r->field_len};
    struct record_value *v = malloc((r->n + 1) * sizeof *v);
    if (v == NULL)
        return short_of_memory(p);
    for (uint32_t i = 0; i < r->n; i++)
        record_value_at(r, i, &v[i]);
    edit_set_values(p->server, &a, set, &field, v, r->n);
    return outcome(p, &a);
}

static enum applied apply_values(struct apply *p, const struct record *r, struct dataset *set)
{
    struct answer a = answer_of(p);
    struct word field = {r->field, r->field_len};
    struct reservation memory;
    if (!edit_may_set_run(p->server, &a, r->n, &memory))
        return outcome(p, &a);
    double *v = dt_pages_grow(p->server->pages, NULL, 0, r->n * sizeof *v + 1);
    if (v == NULL) {
        reservation_set(&memory, 0);
        return short_of_memory(p);
    }
    record_values(r, v);
    edit_set_run(p->server, &a, set, &field, r->first, v, r->n, &memory);
    return outcome(p, &a);
}

static enum applied apply_triangulate(struct apply *p, const struct record *r, struct dataset *set)
{
    struct answer a = answer_of(p);
    struct word words[] = {{"TRIANGULATE", 11}, {r->name, r->name_len}};
    struct request q = {.word = words, .n = 2};
    cmd_triangulate(p->server, set, &q, &a);
    enum applied how = outcome(p, &a);
    if (how == APPLY_DONE)
        journal_triangulate(p->server, set); /* unless it has been recorded */
    return how;
}

/* A record about a set that must exist. */
static enum applied apply_existing(struct apply *p, const struct record *r, struct dataset *set)
{
    struct server *s = p->server;
    struct answer a = answer_of(p);
    struct word field = {r->field, r->field_len};
    if (set == NULL)
        return fail(p, "there is no such set");
    switch (r->type) {
    case RECORD_DROP:
        journal_drop(s, set);
        registry_drop(&s->sets, set);
        return APPLY_DONE;
    case RECORD_EXPIRE:
        registry_expire(&s->sets, set, (int64_t)r->a);
        journal_expire(s, set);
        return APPLY_DONE;
    case RECORD_DELETE:
        return apply_delete(p, r, set);
    case RECORD_MOVE:
        edit_move(s, &a, set, r->first, (struct dt_point){r->a, r->b});
        return outcome(p, &a);
    case RECORD_FSET:
        return apply_fset(p, r, set);
    case RECORD_VALUES:
        return apply_values(p, r, set);
    case RECORD_FDROP:
        edit_drop_field(s, &a, set, &field);
        return outcome(p, &a);
    case RECORD_TRIANGULATE:
        return apply_triangulate(p, r, set);
    default:
        return fail(p, "it is not a record of a log");
    }
}

static bool is_of_load(const struct record *r)
{
    return r->type == RECORD_LOAD || r->type == RECORD_CHUNK || r->type == RECORD_LOADED ||
           (r->type == RECORD_VALUES && r->name_len == 0);
}

static enum applied apply_to(struct apply *p, const struct record *r, struct dataset *set)
{
    if (p->in_load != (is_of_load(r) && r->type != RECORD_LOAD))
        return fail(p, "a load is not complete");
    if (is_of_load(r))
        return apply_load(p, r, set);
    if (r->type == RECORD_ADD)
        return apply_add(p, r, set);
    return r->type == RECORD_CREATE ? apply_create(p, r, set) : apply_existing(p, r, set);
}

/* Whether the set has the change already, or there is none. */
static bool is_known(struct apply *p, const struct record *r, const struct dataset *set)
{
    if (r->type == RECORD_CLOSE)
        return true;
    if (p->in_load)
        return p->skip_load;
    return set != NULL && r->lsn <= set->current->lsn;
}

enum applied apply_record(struct apply *p, const struct record *r, const char *bytes, size_t n)
{
    struct word name = {r->name, r->name_len};
    struct dataset *set = NULL;
    if (r->name_len > 0 && !word_is_set_name(&name))
        return fail(p, "its set has an impossible name");
    if (r->name_len > 0)
        set = registry_find(&p->server->sets, &name);
    if (is_known(p, r, set)) {
        p->skip_load = p->in_load || r->type == RECORD_LOAD;
        p->in_load = p->skip_load && r->type != RECORD_LOADED;
        log_append_copy(durable_log(p->server), bytes, n);
        return APPLY_DONE;
    }
    if (set != NULL && !dataset_admits(set, true, wait_turn(&p->waiter))) {
        p->waiter.writes = true;
        wait_enter(&set->queue, &p->waiter);
        return APPLY_WAIT;
    }
    if (set != NULL && set->temporary) { /* of a client of this daemon: the leader's has the name */
        registry_drop(&p->server->sets, set);
        set = NULL;
    }
    enum applied how = apply_to(p, r, set);
    if (how != APPLY_WAIT)
        wait_served(&p->waiter);
    return how;
}
