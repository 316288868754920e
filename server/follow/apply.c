/* apply.c - see apply.h. */
#include "server/follow/apply.h"

#include "server/command/command.h"
#include "server/jobs/durable.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

static void on_wake(struct waiter *w)
{
    struct apply *p = (struct apply *)((char *)w - offsetof(struct apply, waiter));
    p->resume(p);
}

void apply_init(struct apply *p, struct server *s, void (*resume)(struct apply *p))
{
    *p = (struct apply){.server = s, .resume = resume};
    p->load.pages = s->pages;
    p->load.memory = server_reservation(s, BUDGET_LOADS);
    p->copies = server_reservation(s, BUDGET_LOADS);
    p->waiter.wake = on_wake;
    p->waiter.writes = true;
}

static void forget_next(struct apply *p)
{
    if (p->next != NULL)
        job_free(p->server, &p->next->job);
    p->next = NULL;
}

static void forget_copies(struct apply *p)
{
    buf_free(&p->copied);
    reservation_set(&p->copies, 0);
}

void apply_clear(struct apply *p)
{
    queue_served(&p->waiter);
    assembly_clear(&p->load);
    forget_copies(p);
    forget_next(p);
    buf_free(&p->out);
}

bool apply_in_load(const struct apply *p)
{
    return p->load.begun;
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
                           .client.role = ROLE_WRITE,
                           .turn = queue_turn(&p->waiter),
                           .of_leader = true};
}

/* Interprets the answer of an edit. */
static enum applied outcome(struct apply *p, const struct answer *a)
{
    switch (a->next) {
    case ANSWER_WAIT:
        p->waiter.writes = a->wait_writes;
        queue_enter(a->wait, &p->waiter);
        return APPLY_WAIT;
    case ANSWER_WORK:
        return APPLY_JOB;
    default:
        break;
    }
    if (a->out->failed)
        return short_of_memory(p);
    if (!a->refused)
        return APPLY_DONE;
    size_t n = buf_len(a->out), prefix = strlen("ERR ");
    snprintf(p->why, sizeof p->why, "%.*s", (int)(n - prefix - 1), buf_head(a->out) + prefix);
    return a->code == ERR_NOMEM || a->code == ERR_BUSY ? APPLY_LATER : APPLY_FAILED;
}

void apply_job_done(struct apply *p, struct job *j)
{
    struct answer a = answer_of(p);
    job_finish(p->server, j, &a);
    queue_served(&p->waiter);
    p->job = outcome(p, &a);
    p->resume(p);
}

enum applied apply_result(struct apply *p)
{
    return p->job;
}

/* ---- records ---- */

/* A change of the set becomes the next one. */
static enum applied begin_next(struct apply *p, const struct record *r)
{
    struct answer a = answer_of(p);
    struct word name = {r->name, r->name_len};
    p->next = submission_new(p->server, &a, CHANGE_ADD, &name);
    return outcome(p, &a);
}

/* Reads a record of a LOAD, which is the next change with the last one. */
static enum applied read_part(struct apply *p, const struct record *r)
{
    struct change c;
    enum applied how;
    switch (assembly_take(&p->load, r, &c)) {
    case ASSEMBLY_DONE:
        how = begin_next(p, r);
        if (p->next != NULL)
            p->next->change = c;
        else
            change_clear(&c);
        return how;
    case ASSEMBLY_MORE:
    case ASSEMBLY_ENDED:
        return APPLY_DONE;
    case ASSEMBLY_NOMEM:
        return short_of_memory(p);
    case ASSEMBLY_INVALID:
        break;
    }
    return fail(p, "the records of a load do not fit each other");
}

/* Reads a record, which may be the next change. */
static enum applied read_record(struct apply *p, const struct record *r)
{
    if (change_is_part(r))
        return read_part(p, r);
    if (p->load.begun)
        return fail(p, "a load is not complete");
    enum applied how = begin_next(p, r);
    if (p->next == NULL)
        return how;
    enum dt_status status = change_decode(&p->next->change, r, p->server->pages);
    if (status == DT_OK)
        return APPLY_DONE;
    forget_next(p);
    return status == DT_NOMEM ? short_of_memory(p) : fail(p, "it is not a record of a log");
}

static enum applied triangulate_set(struct apply *p, struct dataset *set)
{
    struct answer a = answer_of(p);
    triangulate(p->server, &a, set, DT_AUTO, false);
    enum applied how = outcome(p, &a);
    if (how == APPLY_DONE && !set->triangulated) /* it needed no job */
        submit_at_once(p->server, set, CHANGE_TRIANGULATE, 0);
    return how;
}

static enum applied submit_next(struct apply *p, struct dataset *set)
{
    struct answer a = answer_of(p);
    struct submission *x = p->next;
    if (!submit_reserve(p->server, &a, set, x))
        return outcome(p, &a);
    reservation_move(&x->job.memory, &p->load.memory);
    p->next = NULL;
    submit(p->server, &a, set, x);
    return outcome(p, &a);
}

static enum applied carry_out(struct apply *p, struct dataset *set)
{
    const struct change *c = &p->next->change;
    const char *why = change_contradiction(c, set);
    enum applied how;
    if (why != NULL)
        how = fail(p, why);
    else if (c->kind == &change_kinds[CHANGE_TRIANGULATE])
        how = triangulate_set(p, set);
    else
        how = submit_next(p, set);
    if (how != APPLY_WAIT)
        forget_next(p);
    return how;
}

/* Whether the set has the change already, or there is none. */
static bool is_known(const struct apply *p, const struct record *r, const struct dataset *set)
{
    if (r->type == RECORD_CLOSE)
        return true;
    if (p->load.begun)
        return p->load.skips;
    return p->next == NULL && set != NULL && r->lsn <= set->current->lsn;
}

/* Keeps a record of a LOAD until the last one comes; false: out of memory. */
static bool keep_copy(struct apply *p, const char *bytes, size_t n)
{
    if (!reservation_resize(&p->copies, buf_len(&p->copied) + n))
        return false;
    char *to = buf_reserve(&p->copied, n);
    p->copied.failed = false;
    if (to == NULL)
        return false;
    memcpy(to, bytes, n);
    buf_commit(&p->copied, n);
    return true;
}

/* The log gets the records of a LOAD together, with the last one. So a connection that ends leaves no part of a LOAD there,
 * and no segment begins within it. */
static enum applied copy_part(struct apply *p, const struct record *r, const char *bytes, size_t n)
{
    if (!keep_copy(p, bytes, n))
        return short_of_memory(p);
    enum applied how = read_part(p, r);
    p->load.skips = p->load.begun;
    if (how == APPLY_DONE && !p->load.begun) {
        log_append_copy(durable_log(p->server), buf_head(&p->copied), buf_len(&p->copied));
        forget_copies(p);
    }
    return how;
}

/* Only the log lacks the record. */
static enum applied copy_record(struct apply *p, const struct record *r, const char *bytes,
                                size_t n)
{
    if (change_is_part(r))
        return copy_part(p, r, bytes, n);
    if (p->load.begun)
        return fail(p, "a load is not complete");
    log_append_copy(durable_log(p->server), bytes, n);
    return APPLY_DONE;
}

enum applied apply_record(struct apply *p, const struct record *r, const char *bytes, size_t n)
{
    struct word name = {r->name, r->name_len};
    struct dataset *set = NULL;
    if (r->name_len > 0 && !word_is_set_name(&name))
        return fail(p, "its set has an impossible name");
    if (r->name_len > 0)
        set = registry_find(&p->server->sets, &name);
    if (is_known(p, r, set))
        return copy_record(p, r, bytes, n);
    enum applied how = p->next != NULL ? APPLY_DONE : read_record(p, r);
    if (how != APPLY_DONE || p->next == NULL)
        return how;
    if (set != NULL && !dataset_admits(set, true, queue_turn(&p->waiter))) {
        p->waiter.writes = true;
        queue_enter(&set->queue, &p->waiter);
        return APPLY_WAIT;
    }
    if (set != NULL && set->temporary) { /* of a client of this daemon: the leader's has the name */
        registry_drop(&p->server->sets, set);
        set = NULL;
    }
    how = carry_out(p, set);
    if (how != APPLY_WAIT)
        queue_served(&p->waiter);
    return how;
}
