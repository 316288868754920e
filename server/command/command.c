/* command.c - see command.h. */
#include "server/command/command.h"

#include "proto/number.h"
#include "server/bodies/load.h"
#include "server/jobs/durable.h"
#include "server/jobs/expire.h"
#include "server/jobs/restart.h"
#include "server/jobs/submit.h"
#include "server/jobs/upkeep.h"
#include "server/ops/limits.h"
#include "server/rows/stream.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct command *command_find(const struct server *s, const struct word *name)
{
    for (size_t i = 0; i < s->command_count; i++)
        if (word_is(name, s->commands[i].name))
            return &s->commands[i];
    return NULL;
}

/* ---- checks before a handler runs ---- */

bool answer_usage(struct answer *a)
{
    return answer_err(a, ERR_SYNTAX, "usage: %s", a->command->usage);
}

/* Whether the number of words is one that the command takes. `most` counts FIELDS and the names, PATHS BORDER OF k SPLIT, and CONSTRAINTS
 * m SPLIT, which may be missing. */
static bool has_words(const struct command *c, const struct request *q)
{
    unsigned without = 0;
    if (c->body.rows != LOAD_NOTHING) {
        struct load_words w = load_words_of(&c->body, q);
        without += c->body.fields && w.names.len == 0 ? 2 : 0;
        without += c->body.paths && w.paths == 0 ? 5 : 0;
        without += c->body.constraints && w.constraints.end == 0 ? 3 : 0;
    }
    return q->n >= c->least && (c->most == 0 || q->n <= c->most - without);
}

static bool check_words(struct answer *a, const struct command *c, const struct request *q)
{
    return has_words(c, q) || answer_usage(a);
}

bool check_delaunay(struct answer *a, const struct version *v)
{
    return dt_constraints_count(v->dt) == 0 || answer_status(a, DT_NOTDELAUNAY);
}

bool check_write_role(struct answer *a)
{
    if (a->client.role == ROLE_WRITE)
        return true;
    return answer_err(a, ERR_DENIED, "your token is for reading only");
}

static bool check_role(struct answer *a, const struct command *c)
{
    if (a->client.role != ROLE_NONE)
        return (c->flags & (CMD_WRITE | CMD_ADMIN)) == 0 || check_write_role(a);
    if ((c->flags & CMD_OPEN) != 0)
        return true;
    return answer_err(a, ERR_NOAUTH, "authenticate first: AUTH token");
}

/* At the start there are no sets until the data directory has been read. */
static bool check_loaded(struct server *s, struct answer *a, const struct command *c)
{
    return (c->flags & (CMD_SET | CMD_ALL_SETS)) == 0 || durable_loaded(s, a);
}

/* Sets the change that the reply will show: the last one of the set; NULL: there is no set. A command for writing
 * acknowledges it, even if it finds nothing left to change. */
static void note_changes(const struct server *s, struct answer *a, const struct command *c,
                         const struct dataset *set)
{
    if ((c->flags & CMD_WRITE) != 0)
        a->lsn = durable_lsn(s, set);
    else
        a->shown = durable_lsn(s, set);
}

bool check_set_name(struct answer *a, const struct word *w)
{
    return word_is_set_name(w) ||
           answer_err(a, ERR_SYNTAX, "a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -");
}

/* Finds the set of the request: *set, NULL if there is none. */
static bool check_set(struct server *s, struct answer *a, const struct command *c,
                      const struct request *q, struct dataset **set)
{
    *set = NULL;
    if ((c->flags & CMD_SET) == 0)
        return true;
    if (!check_set_name(a, &q->word[1]))
        return false;
    *set = registry_find(&s->sets, &q->word[1]);
    if (*set != NULL && expire_is_due(*set) && !world_alone(a))
        return false;
    if (*set != NULL && expire_drop_if_due(s, *set))
        *set = NULL;
    /* Only commands for writing see a set whose creation has not succeeded yet. */
    bool there = *set != NULL && ((*set)->born || (c->flags & CMD_WRITE) != 0);
    if (!there)
        *set = NULL;
    if (!there && command_needs_set(c)) {
        note_changes(s, a, c, NULL);
        return answer_err(a, ERR_NOSET, "there is no set %.*s", QUOTED(&q->word[1]));
    }
    return true;
}

/* Whether the request has to be saved: not if it is about a temporary set, or creates one. */
static bool is_saved(const struct server *s, const struct command *c, const struct request *q,
                     const struct dataset *set)
{
    if (set != NULL)
        return !set->temporary;
    bool temporary = false;
    for (size_t i = 2; c->change == CHANGE_CREATE && s->read_only.why == NULL && i < q->n; i++)
        temporary = temporary || word_is(&q->word[i], "TEMPORARY");
    return !temporary;
}

/* Whether what the request changes can be saved now, if it has to be. If not, the request waits, or the ERR line has been written. */
static bool check_saving(struct server *s, struct answer *a, const struct command *c,
                         const struct request *q, const struct dataset *set)
{
    bool all = (c->flags & CMD_ALL_SETS) != 0; /* it saves what is there */
    if ((c->flags & CMD_WRITE) == 0 || !is_saved(s, c, q, set))
        return true;
    if (all && s->read_only.why != NULL) /* so a follower may do it, too */
        return true;
    return durable_admits_change(s, a, all || (change_kinds[c->change].flags & CHANGE_FREES) != 0);
}

/* Whether the state of the set allows the command now. If not, the request waits, or the ERR line has been written. */
static bool check_state(struct server *s, struct answer *a, const struct command *c,
                        const struct request *q, struct dataset *set)
{
    bool writes = (c->flags & CMD_WRITE) != 0;
    if (set != NULL && set->loading) {
        restart_refuse(a, set);
        return false;
    }
    if (!check_saving(s, a, c, q, set))
        return false;
    if (set == NULL)
        return true;
    if (!dataset_admits(set, writes, a->turn))
        return answer_wait(a, &set->queue, writes);
    if ((c->flags & CMD_LIVE) != 0 && !set->current->sum.triangulated)
        return answer_status(a, DT_UNTRIANGULATED);
    if ((c->flags & CMD_FRESH) != 0 && !upkeep_refresh(s, a, set))
        return false;
    return (c->flags & CMD_SEARCH) == 0 || upkeep_prepare(s, a, set);
}

bool command_find_other(struct server *s, struct answer *a, const struct word *name,
                        struct dataset **set)
{
    struct word word[2] = {*name, *name};
    const struct request q = {.word = word, .n = 2};
    uint64_t shown = a->shown;
    if (!check_set(s, a, a->command, &q, set) || !check_state(s, a, a->command, &q, *set))
        return false;
    note_changes(s, a, a->command, *set);
    a->shown = shown > a->shown ? shown : a->shown;
    return true;
}

/* ---- bodies of refused requests ---- */

/* The command of that name, if its requests have a body; else NULL. */
static const struct command *find_with_body(const struct server *s, const struct word *name)
{
    const struct command *c = command_find(s, name);
    return c != NULL && c->body.rows != LOAD_NOTHING ? c : NULL;
}

void command_skip_body(struct server *s, const struct request *q, struct answer *a)
{
    struct request rest = *q;
    while (rest.n > 2 && word_is(rest.word, "TIMEOUT")) {
        rest.word += 2;
        rest.n -= 2;
    }
    const struct command *c = find_with_body(s, rest.word);
    if (c != NULL && has_words(c, &rest)) {
        load_skip(s, &c->body, &rest, a);
    } else if (c != NULL) {
        a->closes = true;
    } else if (word_is(q->word, "TIMEOUT") || command_find(s, q->word) == NULL) {
        for (size_t i = 1; i < q->n; i++)
            if (find_with_body(s, &q->word[i]) != NULL)
                a->closes = true;
    }
}

/* ---- running ---- */

const struct command *command_find_again(const struct server *s, struct reactor *r,
                                         const struct word *name)
{
    if (r->command == NULL || !word_is(name, r->command->name))
        r->command = command_find(s, name);
    return r->command;
}

bool command_is_quick(const struct server *s, struct reactor *r, const struct request *q)
{
    const struct command *c = command_find_again(s, r, &q->word[0]);
    return c == NULL || (c->flags & CMD_QUICK) != 0;
}

bool command_shares(const struct server *s, struct reactor *r, const struct request *q)
{
    const struct command *c = command_find_again(s, r, &q->word[0]);
    return c != NULL && (c->flags & CMD_SHARES) != 0;
}

static void carry_out(struct server *s, struct dataset *set, const struct request *q,
                      struct answer *a)
{
    const struct command *c = a->command;
    if (!check_state(s, a, c, q, set))
        return;
    if ((c->flags & CMD_SET) != 0)
        note_changes(s, a, c, set);
    c->handler(s, set, q, a);
}

/* While reactors share the world, one of them changes a set, or several read it. An edit does not wait for the piece that a
 * worker reads: a reactor that is alone gives it to a worker. */
static void carry_out_inside(struct server *s, struct dataset *set, const struct request *q,
                             struct answer *a)
{
    struct gate *gate = &set->current->gate;
    if ((a->command->flags & CMD_WRITE) == 0) {
        gate_enter(gate, a->reactor->number);
        carry_out(s, set, q, a);
        gate_leave(gate, a->reactor->number);
    } else if (gate_close_unvisited(gate)) {
        carry_out(s, set, q, a);
        gate_open(gate);
    } else {
        world_alone(a);
    }
}

static void dispatch(struct server *s, const struct request *q, struct answer *a)
{
    const struct command *c = command_find_again(s, a->reactor, &q->word[0]);
    struct dataset *set;
    a->command = c;
    stats_begin(&a->reactor->stats, command_number(s, c));
    if (c == NULL) {
        answer_err(a, ERR_UNKNOWN, "there is no command %.*s; try HELP", QUOTED(&q->word[0]));
        command_skip_body(s, q, a);
    } else if (!check_words(a, c, q) || !check_role(a, c) || !check_loaded(s, a, c) ||
               !check_set(s, a, c, q, &set)) {
        if (a->body == NULL)
            command_skip_body(s, q, a);
    } else if (c->body.rows != LOAD_NOTHING && a->body == NULL) {
        load_start(s, &c->body, q, a);
    } else if (set != NULL && answer_shares(a)) {
        carry_out_inside(s, set, q, a);
    } else {
        carry_out(s, set, q, a);
    }
}

void command_take_timeout(struct request *q, int64_t *ms)
{
    double seconds;
    *ms = 0;
    if (q->n < 3 || !word_is(&q->word[0], "TIMEOUT") || word_is(&q->word[2], "TIMEOUT") ||
        !proto_read_double(q->word[1].text, q->word[1].len, &seconds) || !(seconds > 0) ||
        seconds > LIMIT_TIMEOUT_S)
        return;
    *ms = (int64_t)(seconds * 1000) + 1;
    q->n -= 2;
    memmove(q->word, q->word + 2, q->n * sizeof *q->word);
}

/* Runs only if the prefix is not valid; see command_take_timeout. */
void cmd_timeout(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    answer_err(a, ERR_SYNTAX, "usage: TIMEOUT seconds command, with more than 0 and at most %d",
               LIMIT_TIMEOUT_S);
    command_skip_body(s, q, a);
}

void command_out_of_memory(struct server *s, struct answer *a, size_t mark)
{
    if (a->next == ANSWER_STREAM) {
        stream_free(s, a->stream);
        a->next = ANSWER_DONE;
    }
    buf_rewind(a->out, mark);
    if (a->busy)
        answer_err(a, ERR_BUSY, "not enough free memory for the reply at the moment; try again");
    else
        answer_err(a, ERR_NOMEM, "out of memory; nothing has changed");
}

static bool has_room_for_error(struct answer *a)
{
    a->broken = buf_reserve(a->out, REPLY_ERR_ROOM) == NULL;
    return !a->broken;
}

void command_run(struct server *s, const struct request *q, struct answer *a)
{
    size_t mark = buf_len(a->out);
    if (!has_room_for_error(a))
        return;
    if (a->reactor == NULL)
        a->reactor = s->reactor;
    dispatch(s, q, a);
    if (a->next == ANSWER_WAIT)
        buf_rewind(a->out, mark);
    else if (a->out->failed)
        command_out_of_memory(s, a, mark);
}

void command_run_body(struct server *s, struct load *l, struct answer *a)
{
    size_t mark = buf_len(a->out);
    if (!has_room_for_error(a) || l->refused || load_refuse(s, l, a))
        return;
    a->body = l;
    struct request *q = &reactor_of(s, a)->request;
    if (request_split(q, buf_head(&l->line), buf_len(&l->line)))
        command_run(s, q, a);
    else
        command_out_of_memory(s, a, mark);
}

/* ---- changes ---- */

void cmd_change(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct command *c = a->command;
    if (!submit_may(a, set, c->change, q->n / 2)) /* an item of many has two words at least */
        return;
    struct submission *x = submission_new(s, a, c->change, &q->word[1]);
    if (x == NULL)
        return;
    if ((c->read == NULL || c->read(s, set, q, a, &x->change)) && submit_reserve(s, a, set, x))
        submit(s, a, set, x);
    else
        job_free(s, &x->job);
}

/* ---- arguments ---- */

bool read_number(struct answer *a, const struct word *w, double *v)
{
    return proto_read_double(w->text, w->len, v) ||
           answer_err(a, ERR_NUMBER, "%.*s is not a number", QUOTED(w));
}

bool read_finite(struct answer *a, const struct word *w, const char *what, double *v)
{
    if (!read_number(a, w, v))
        return false;
    *v += 0.0; /* -0 becomes 0 */
    return !isinf(*v) || answer_err(a, ERR_RANGE, "a %s is finite", what);
}

bool read_coordinate(struct answer *a, const struct word *w, double *v)
{
    if (!read_number(a, w, v))
        return false;
    return dt_coordinate_ok(*v) || answer_status(a, DT_RANGE);
}

bool read_length(struct answer *a, const struct word *w, const char *what, double *v)
{
    if (!read_number(a, w, v))
        return false;
    *v += 0.0; /* -0 becomes 0 */
    if (*v < 0)
        answer_err(a, ERR_RANGE, "a %s is not negative", what);
    else if (!dt_coordinate_ok(*v))
        answer_err(a, ERR_RANGE, "a %s is 0 or has a magnitude from 2^-142 to 2^201", what);
    else
        return true;
    return false;
}

bool read_point(struct answer *a, const struct word *w, struct dt_point *p)
{
    return read_coordinate(a, &w[0], &p->x) && read_coordinate(a, &w[1], &p->y);
}

static void put_in_order(double *a, double *b)
{
    double t = *a;
    if (*a > *b) {
        *a = *b;
        *b = t;
    }
}

bool read_box(struct answer *a, const struct word w[4], struct dt_point *lo, struct dt_point *hi)
{
    if (!read_point(a, &w[0], lo) || !read_point(a, &w[2], hi))
        return false;
    put_in_order(&lo->x, &hi->x);
    put_in_order(&lo->y, &hi->y);
    return true;
}

bool read_count(struct answer *a, const struct word *w, const char *what, uint32_t *n)
{
    if (proto_read_u32(w->text, w->len, n))
        return true;
    return answer_err(a, ERR_NUMBER, "%.*s is not %s", QUOTED(w), what);
}

bool read_id(struct answer *a, const struct word *w, uint32_t *id)
{
    return read_count(a, w, "an id", id);
}

bool read_places(struct server *s, struct answer *a, const struct request *q, size_t end,
                 struct places *out)
{
    out->n = (end - 3) / 2;
    out->p = dt_pages_grow(s->pages, NULL, 0, out->n * sizeof *out->p);
    if (out->p == NULL)
        answer_out_of_memory(a);
    for (size_t i = 0; out->p != NULL && i < out->n; i++)
        if (!read_point(a, &q->word[3 + 2 * i], &out->p[i]))
            return false;
    return out->p != NULL;
}

uint32_t *read_ids(struct answer *a, const struct word *w, size_t n)
{
    uint32_t *id = malloc(n * sizeof *id);
    if (id == NULL)
        answer_out_of_memory(a);
    for (size_t i = 0; id != NULL && i < n; i++) {
        if (!read_id(a, &w[i], &id[i])) {
            free(id);
            return NULL;
        }
    }
    return id;
}

bool read_points(struct answer *a, const struct dt *dt, const struct word *w, size_t n,
                 struct dt_ids *out)
{
    uint32_t representative;
    *out = (struct dt_ids){read_ids(a, w, n), n, n};
    for (size_t i = 0; out->v != NULL && i < n; i++) {
        if (dt_representative(dt, out->v[i], &representative) != DT_OK) {
            answer_err(a, ERR_NOPOINT, "there is no point %u", out->v[i]);
            free(out->v);
            out->v = NULL;
        }
    }
    return out->v != NULL;
}
