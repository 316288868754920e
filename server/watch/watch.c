/* watch.c - see watch.h. */
#include "server/watch/watch.h"

#include "server/jobs/job.h"
#include "server/jobs/journal.h"
#include "server/ops/cost.h"
#include "server/redis/resp3.h"
#include "server/watch/event.h"

#include <stdlib.h>
#include <string.h>

enum {
    SHARED_IDS = 4096, /* more ids than this are sent in parts: some 300 KB */
    NEW_IDS = 65536,   /* more than this are a reset */
    RETRY_MS = 1000    /* after a triangulation for watchers has failed */
};

/* A set that is watched, or was when it was dropped. */
struct watched {
    struct watched *next;
    struct dataset *set;   /* borrows; NULL: dropped */
    struct watcher *first; /* owns */
    uint64_t version;      /* what has been collected so far */
    uint32_t ids;          /* the next id at that time */
    int64_t retry_ms;
    uint64_t lsn; /* of the DROP */
    char name[SET_NAME_LIMIT + 1];
};

struct watcher {
    struct watcher *next; /* of the set */
    struct watcher *also; /* of the session */
    struct watched *of;
    struct session *session;
    bool typed;    /* in RESP 3 */
    bool reset;    /* the next event begins a reset */
    bool sweeping; /* ids from `sweep` on have not been sent since */
    uint32_t sweep;
    uint64_t *dirty; /* owns: a bit for each id that has changed; NULL: none */
    uint32_t words, count, cursor;
};

/* ---- what a watcher does not know ---- */

static void count_memory(struct watcher *w, size_t before)
{
    struct conn *c = &w->session->conn;
    size_t now = w->words * sizeof *w->dirty;
    c->owner_bytes = c->owner_bytes - before + now;
    if (!c->closed)
        reservation_set(&c->memory, c->owner_bytes + c->in.cap + c->out.cap);
}

static void forget(struct watcher *w)
{
    size_t before = w->words * sizeof *w->dirty;
    free(w->dirty);
    w->dirty = NULL;
    w->words = w->count = w->cursor = 0;
    count_memory(w, before);
}

static void mark_all(struct watcher *w)
{
    forget(w);
    w->reset = w->sweeping = true;
    w->sweep = 0;
}

static bool make_room(struct watcher *w, uint32_t id)
{
    size_t before = w->words * sizeof *w->dirty;
    uint32_t need = id / 64 + 1, words = w->of->ids / 64 + 1;
    if (need <= w->words)
        return true;
    words = words > need ? words : need;
    uint64_t *larger = realloc(w->dirty, words * sizeof *larger);
    if (larger == NULL)
        return false;
    memset(larger + w->words, 0, (words - w->words) * sizeof *larger);
    w->dirty = larger;
    w->words = words;
    count_memory(w, before);
    return true;
}

static void mark(struct watcher *w, uint32_t id)
{
    if (w->sweeping && id >= w->sweep)
        return;
    if (!make_room(w, id)) {
        mark_all(w);
        return;
    }
    uint64_t bit = (uint64_t)1 << id % 64;
    w->count += (w->dirty[id / 64] & bit) == 0;
    w->dirty[id / 64] |= bit;
}

static bool lags(const struct watcher *w)
{
    return w->sweeping || w->count > 0;
}

/* ---- sending ---- */

/* Whether an event may follow what is in the output: not within a reply, and the client reads. */
static bool can_take(const struct watcher *w)
{
    const struct session *s = w->session;
    return !s->conn.closed && !s->conn.finishing && s->state != SESSION_STREAMING &&
           s->state != SESSION_LISTING && !conn_full(&s->conn);
}

static void send_event(struct server *s, const struct watcher *w, const struct event *e,
                       uint64_t lsn)
{
    struct conn *c = &w->session->conn;
    hold_view(&s->held, &c->hold, lsn, conn_out_end(c));
    if (!w->typed) {
        buf_append(&c->out, buf_head(&e->head), buf_len(&e->head));
        buf_append(&c->out, buf_head(&e->rows), buf_len(&e->rows));
    } else {
        resp3_push(&c->out, buf_head(&e->head), buf_len(&e->head), buf_head(&e->rows),
                   buf_len(&e->rows), e->n);
    }
    if (c->out.failed || e->head.failed || e->rows.failed)
        conn_close(c);
    conn_again(c);
}

/* The next ids that a watcher in a reset has not got. */
static void put_swept(struct watcher *w, const struct dt *dt, struct event *e)
{
    enum { LOOKED_AT = 20000 };
    for (unsigned i = 0; w->sweep < w->of->ids && i < LOOKED_AT && !event_is_full(e); i++)
        event_put(e, dt, w->sweep++, EVENT_NEW);
    w->sweeping = w->sweep < w->of->ids;
}

static void put_dirty(struct watcher *w, const struct dt *dt, struct event *e)
{
    for (; w->count > 0 && !event_is_full(e); w->cursor = (w->cursor + 1) % w->words) {
        uint64_t *word = &w->dirty[w->cursor];
        while (*word != 0 && !event_is_full(e)) {
            uint32_t id = 64 * w->cursor + (uint32_t)__builtin_ctzll(*word);
            *word &= *word - 1;
            w->count--;
            event_put(e, dt, id, EVENT_ALL);
        }
    }
    if (w->count == 0)
        forget(w);
}

/* Sends a lagging watcher a part of what it does not know. */
static void send_part(struct server *s, struct watcher *w)
{
    const struct watched *k = w->of;
    const struct dt_summary *sum = &k->set->current->sum;
    struct event e = {.line = sum->triangulated && sum->triangles == 0 ? sum->points : 0};
    if (w->sweeping)
        put_swept(w, k->set->current->dt, &e);
    else
        put_dirty(w, k->set->current->dt, &e);
    event_head(&e, k->name, k->version, w->reset, lags(w));
    w->reset = false;
    send_event(s, w, &e, journal_of(s, k->set));
    event_free(&e);
}

/* ---- changes ---- */

/* What has changed, for all watchers: the same text for those that are up to date. */
static void share(struct server *s, struct watched *k, const uint64_t *key, size_t n, uint32_t from)
{
    struct event e = {0};
    for (size_t i = 0; i < n; i++)
        if (key[i] >> 1 < from)
            event_put(&e, k->set->current->dt, (uint32_t)(key[i] >> 1),
                      (key[i] & 1) != 0 ? EVENT_RING : EVENT_ALL);
    for (uint32_t id = from; id < k->ids; id++)
        event_put(&e, k->set->current->dt, id, EVENT_NEW);
    event_head(&e, k->name, k->version, false, false);
    for (struct watcher *w = k->first; w != NULL; w = w->next) {
        if (!lags(w) && can_take(w)) {
            send_event(s, w, &e, journal_of(s, k->set));
            continue;
        }
        for (size_t i = 0; i < n; i++)
            mark(w, (uint32_t)(key[i] >> 1));
        for (uint32_t id = from; id < k->ids; id++)
            mark(w, id);
    }
    event_free(&e);
}

static void collect(struct server *s, struct watched *k)
{
    struct dt *dt = k->set->current->dt;
    const uint64_t *key;
    size_t n;
    bool known = dt_touched_take(dt, &key, &n);
    uint32_t from = k->ids;
    dt_touched_begin(dt);
    k->version = k->set->version;
    k->ids = dt_next_id(dt);
    if (known && n + (k->ids - from) <= SHARED_IDS) {
        share(s, k, key, n, from);
        return;
    }
    for (struct watcher *w = k->first; w != NULL; w = w->next) {
        if (!known || k->ids - from > NEW_IDS) {
            mark_all(w);
            continue;
        }
        for (size_t i = 0; i < n; i++)
            mark(w, (uint32_t)(key[i] >> 1));
        for (uint32_t id = from; id < k->ids; id++)
            mark(w, id);
    }
}

/* ---- a triangulation that edits have left for later ---- */

static void run_refresh(struct job *j)
{
    j->status = dt_refresh(j->dt, &j->options);
}

static void refreshed(struct server *s, struct job *j, struct answer *a)
{
    (void)s, (void)j, (void)a;
}

/* Whether the triangulation is current; if not, a job updates it. */
static bool refresh(struct server *s, struct watched *k)
{
    struct dataset *set = k->set;
    int64_t now = clock_ms();
    if (!version_is_stale(set->current))
        return true;
    if (!dataset_admits(set, true, NULL) || now < k->retry_ms)
        return false;
    struct buf out = {0};
    struct answer nobody = {.out = &out};
    struct reservation memory = server_reservation(s, BUDGET_BUILDS);
    bool large = !cost_at_once(COST_BUILD, set->current->sum.points);
    struct job *j = NULL;
    k->retry_ms = now + RETRY_MS;
    if (!large || job_reserve_build(s, &nobody, set, &memory))
        j = job_new(sizeof *j, run_refresh, refreshed);
    if (j == NULL) {
        reservation_set(&memory, 0);
    } else {
        j->memory = memory;
        j->what = "triangulating";
        job_write(s, &nobody, j, set, large ? JOB_HEAVY : 0);
    }
    buf_free(&out);
    return !set->exclusive && !version_is_stale(set->current);
}

/* ---- the end of a turn ---- */

static void flush(struct server *s, struct watched *k)
{
    if (k->set->exclusive)
        return;
    if (k->version != k->set->version) {
        if (!refresh(s, k))
            return;
        k->retry_ms = 0;
        collect(s, k);
    }
    for (struct watcher *w = k->first; w != NULL; w = w->next)
        if (lags(w) && can_take(w))
            send_part(s, w);
}

static void leave_session(struct watcher *w)
{
    struct watcher **at = &w->session->watching;
    while (*at != w)
        at = &(*at)->also;
    *at = w->also;
    forget(w);
    free(w);
}

/* The watchers of a dropped set hear of it, and are gone. */
static void tell_dropped(struct server *s, struct watched *k)
{
    struct event e = {0};
    event_dropped(&e, k->name);
    for (struct watcher **at = &k->first; *at != NULL;) {
        struct watcher *w = *at;
        if (!can_take(w)) {
            at = &w->next;
            continue;
        }
        send_event(s, w, &e, s->dropped);
        *at = w->next;
        leave_session(w);
    }
    event_free(&e);
}

void watch_turn_end(struct server *s)
{
    for (struct watched **at = &s->watched; *at != NULL;) {
        struct watched *k = *at;
        if (k->set == NULL)
            tell_dropped(s, k);
        else if (k->first != NULL)
            flush(s, k);
        /* While an edit is under way, a worker may be noting what it touches. */
        if (k->first != NULL || (k->set != NULL && k->set->exclusive)) {
            at = &k->next;
            continue;
        }
        if (k->set != NULL) {
            dt_touched_end(k->set->current->dt);
            k->set->watched = NULL;
        }
        *at = k->next;
        free(k);
    }
}

void watch_clear(struct server *s)
{
    for (struct watched *k = s->watched, *next; k != NULL; k = next) {
        next = k->next;
        free(k);
    }
    s->watched = NULL;
}

/* ---- who watches ---- */

static struct watched *watched_of(struct server *s, struct dataset *set)
{
    struct watched *k = set->watched;
    if (k != NULL || (k = calloc(1, sizeof *k)) == NULL)
        return k;
    memcpy(k->name, set->name, set->name_len);
    k->set = set;
    k->version = set->version;
    k->ids = dt_next_id(set->current->dt);
    dt_touched_begin(set->current->dt);
    k->next = s->watched;
    s->watched = k;
    set->watched = k;
    return k;
}

static void drop_watcher(struct watcher *w)
{
    struct watcher **at = &w->of->first;
    while (*at != w)
        at = &(*at)->next;
    *at = w->next;
    leave_session(w);
}

/* The session's watcher of a set of that name; NULL: none. */
static struct watcher *find(const struct session *who, const char *name)
{
    struct watcher *w = who->watching;
    while (w != NULL && strcmp(w->of->name, name) != 0)
        w = w->also;
    return w;
}

bool watch_begin(struct server *s, struct session *who, struct dataset *set, bool current)
{
    struct watcher *w = find(who, set->name), *fresh = calloc(1, sizeof *fresh);
    struct watched *k = fresh == NULL ? NULL : watched_of(s, set);
    if (k == NULL) {
        free(fresh);
        return false;
    }
    if (w != NULL)
        drop_watcher(w);
    fresh->of = k;
    fresh->session = who;
    fresh->typed = who->resp;
    fresh->next = k->first;
    k->first = fresh;
    fresh->also = who->watching;
    who->watching = fresh;
    /* A triangulation that was left for later will be an event for all. */
    if (!current || k->version != set->version || version_is_stale(set->current))
        mark_all(fresh);
    if (version_is_stale(set->current))
        k->version = 0;
    return true;
}

bool watch_end(struct session *who, const struct dataset *set)
{
    struct watcher *w = find(who, set->name);
    if (w != NULL)
        drop_watcher(w);
    return w != NULL;
}

size_t watch_count(const struct session *who)
{
    size_t n = 0;
    for (const struct watcher *w = who->watching; w != NULL; w = w->also)
        n++;
    return n;
}

void watch_leave(struct session *who)
{
    while (who->watching != NULL)
        drop_watcher(who->watching);
}

void watch_dropped(struct dataset *set)
{
    if (set->watched != NULL)
        set->watched->set = NULL;
}
