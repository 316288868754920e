/* feed.c - see feed.h. */
#include "server/watch/feed.h"

#include "server/jobs/durable.h"

#include <stdlib.h>
#include <string.h>

enum {
    /* with a box, more changes than this are found by a sweep: few points are in it */
    BOX_KEYS = 256,
    BOX_STEPS = 10000,   /* a box whose search takes longer, or of which more points */
    BOX_KNOWN = 10000,   /* may be known, is swept like the whole set */
    LINE_STEPS = 100000, /* rings on a line that take more are sent in parts */
    LISTED_STEPS = 256,  /* of constraints that are listed at a time, each of which */
    LISTED_STEP = 10,    /* is so many of an event */
    MOST_ALTERED = 1024  /* changed constraints that are looked at at a time */
};

uint32_t feed_line(const struct watched *k)
{
    const struct dt_summary *sum = &k->set->current->sum;
    return sum->triangulated && sum->triangles == 0 ? sum->points : 0;
}

uint64_t feed_first_tick(const struct feed *f)
{
    const struct watched *k = f->of;
    uint64_t tick = k->all_tick;
    if (f->scope.names != NULL && k->value_tick > tick)
        tick = k->value_tick;
    if (f->scope.boxed && k->line_tick > tick)
        tick = k->line_tick;
    return tick;
}

static bool has_changed(const struct feed *f, uint32_t id, uint64_t tick)
{
    return stamps_after(&f->of->row_stamps, id, tick) ||
           (f->scope.names != NULL && stamps_after(&f->of->value_stamps, id, tick));
}

/* ---- the rows of an event ---- */

static int by_key(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static int by_id(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Finds the keys after a mark that belong to the feed, a value as a row, in ascending order. */
static size_t find_keys(const struct feed *f, const struct recent_mark *m, uint64_t *key)
{
    const struct recent *r = &f->of->recent;
    size_t n = 0;
    for (uint64_t at = m->at; at < r->key_end; at++) {
        uint64_t found = recent_key(r, at);
        if ((uint32_t)found < DT_TOUCHED_VALUE)
            key[n++] = found;
        else if (scope_has_value(&f->scope, found))
            key[n++] = found >> 32 << 32 | DT_TOUCHED_ROW;
    }
    qsort(key, n, sizeof key[0], by_key);
    return n;
}

/* Writes the changes after the position, by id. False: too many, or they are unknown. */
static bool put_change(struct event *e, const struct feed *f, const struct position *p)
{
    const struct watched *k = f->of;
    const struct dt *dt = k->set->current->dt;
    const struct recent_mark *m = recent_at(&k->recent, p->tick);
    uint64_t changes = m == NULL ? UINT64_MAX : k->recent.key_end - m->at + (k->ids - m->ids);
    uint64_t key[FEED_KEYS];
    if (changes > (f->scope.boxed ? BOX_KEYS : FEED_KEYS) || changes * e->line > LINE_STEPS)
        return false;
    size_t n = find_keys(f, m, key);
    for (size_t i = 0; i < n; i++) {
        uint32_t id = (uint32_t)(key[i] >> 32);
        if (id < m->ids && (i == 0 || key[i - 1] >> 32 != id))
            event_put(e, dt, id, (uint32_t)key[i] == DT_TOUCHED_RING ? EVENT_RING : EVENT_ALL);
    }
    for (uint32_t id = m->ids; id < k->ids; id++)
        event_put(e, dt, id, id < p->ids ? EVENT_ALL : EVENT_NEW);
    return true;
}

/* Adds ids that a watcher of the box may know; all are ascending then, and each is there once. */
static bool add_known(struct dt_ids *ids, const struct known *known)
{
    size_t most = ids->n + known->count, n = 0;
    uint32_t *v = realloc(ids->v, (most + 1) * sizeof *v);
    if (v == NULL)
        return false;
    ids->v = v;
    for (uint32_t i = 0; i < known->slots; i++)
        if (known->slot[i] != 0)
            v[ids->n++] = known->slot[i] - 1;
    qsort(v, ids->n, sizeof *v, by_id);
    for (size_t i = 0; i < ids->n; i++)
        if (n == 0 || v[i] != v[n - 1])
            v[n++] = v[i];
    ids->n = n;
    return true;
}

bool feed_find_box(const struct feed *f, struct dt_ids *found)
{
    struct dt_options opt = {.steps = BOX_STEPS};
    return dt_within_box(f->of->set->current->dt, f->scope.lo, f->scope.hi, &opt, found) == DT_OK;
}

/* The ids among which a sweep of a box finds the changed ones. False: too many. */
static bool find_candidates(const struct feed *f, bool reset, struct dt_ids *ids)
{
    if (!reset && (f->known.words > 0 || f->known.count > BOX_KNOWN))
        return false;
    return feed_find_box(f, ids) && (reset || add_known(ids, &f->known));
}

static void put_swept(struct event *e, const struct feed *f, const struct position *p, uint32_t id)
{
    const struct dt *dt = f->of->set->current->dt;
    if (p->tick == 0)
        event_put(e, dt, id, EVENT_NEW);
    else if (has_changed(f, id, p->tick))
        event_put(e, dt, id, EVENT_ALL);
    else
        e->steps++;
}

/* Continues a sweep of a small box. False: it is not small. */
static bool sweep_box(struct event *e, struct feed *f, struct position *p)
{
    struct dt_ids ids = {0};
    if (!f->scope.boxed || (f->wide && p->sweep > 0))
        return false;
    f->wide = !find_candidates(f, p->tick == 0, &ids);
    if (!f->wide) {
        size_t i = 0;
        for (; i < ids.n && ids.v[i] < p->ids && !event_is_full(e); i++)
            if (ids.v[i] >= p->sweep)
                put_swept(e, f, p, ids.v[i]);
        p->sweep = i < ids.n && ids.v[i] < p->ids ? ids.v[i] : p->ids;
    }
    free(ids.v);
    return !f->wide;
}

/* Points, their values and rings. */
static void put_points(struct event *e, struct feed *f, struct position *p)
{
    const struct watched *k = f->of;
    if (p->goal == 0 && put_change(e, f, p)) {
        p->ids = k->ids;
        p->tick = feed_tick(k);
        return;
    }
    if (p->goal == 0) {
        p->ids = k->ids;
        p->goal = feed_tick(k);
    }
    if (!sweep_box(e, f, p))
        for (; p->sweep < p->ids && !event_is_full(e); p->sweep++)
            put_swept(e, f, p, p->sweep);
    if (p->sweep < p->ids)
        return;
    p->tick = p->goal;
    p->goal = p->sweep = 0;
}

/* The next ones of all constraints. */
static void put_listed(struct event *e, const struct feed *f, struct position *p)
{
    const struct dt *dt = f->of->set->current->dt;
    struct dt_constraint_list list = {.n = 0};
    while (p->lists && !event_is_full(e) && !e->rows.failed) {
        list.n = 0;
        if (dt_constraints_read(dt, NULL, &p->listed, LISTED_STEPS, &list) != DT_OK)
            e->rows.failed = true;
        for (size_t i = 0; !e->rows.failed && i < list.n; i++)
            event_put_constraint(e, dt, &list.v[i], false, false);
        e->steps += LISTED_STEPS * LISTED_STEP; /* many ids may be no smaller end */
        p->lists = p->listed != DT_NONE;
    }
    free(list.v);
}

static int by_constraint(const void *a, const void *b)
{
    const struct dt_touched_constraint *const *p = a, *const *q = b;
    return dt_constraint_compare(&(*p)->what, &(*q)->what);
}

/* The next constraints that have changed, each once. */
static void put_altered(struct event *e, const struct feed *f, struct position *p)
{
    const struct altered *r = &f->of->altered;
    const struct dt_touched_constraint *row[MOST_ALTERED];
    size_t n = 0;
    for (; n < MOST_ALTERED && p->altered < r->end; n++)
        row[n] = altered_at(r, p->altered++);
    if (n > 1)
        qsort(row, n, sizeof row[0], by_constraint);
    for (size_t i = 0, first = 0; i < n; i++) {
        bool moved = true, known = false;
        if (i + 1 < n && by_constraint(&row[i], &row[i + 1]) == 0)
            continue;
        for (; first <= i; first++) {
            moved = moved && row[first]->moved;
            known = known || scope_has_segment(&f->scope, row[first]->at);
        }
        event_put_constraint(e, f->of->set->current->dt, &row[i]->what, moved, known);
    }
}

static void put_constraints(struct event *e, const struct feed *f, struct position *p)
{
    put_listed(e, f, p);
    while (!p->lists && p->altered < f->of->altered.end && !event_is_full(e))
        put_altered(e, f, p);
}

/* Whether the changes after the position are not known any more. */
static bool is_lost(const struct feed *f, const struct position *p)
{
    uint64_t reached = p->goal != 0 ? p->goal : p->tick;
    return reached == 0 || reached < feed_first_tick(f) ||
           (f->scope.constraints && p->altered < f->of->altered.first);
}

/* Writes a part of the changes after the position; the position moves behind that part. */
static void put_rows(struct event *e, struct feed *f, struct position *p)
{
    bool constraints = f->scope.constraints;
    if (is_lost(f, p)) {
        *p = (struct position){.reset = true, .lists = constraints};
        p->altered = constraints ? f->of->altered.end : 0;
        if (f->watchers == 1)
            known_clear(&f->known);
    }
    e->reset = p->reset;
    p->reset = false;
    bool complete = p->goal == 0 && p->tick != 0;
    if (!complete || !p->lists) /* then the list of constraints goes first */
        put_points(e, f, p);
    if (constraints && p->goal == 0)
        put_constraints(e, f, p);
}

/* ---- texts ---- */

/* Once all watchers have been sent it, they do not know the points that it says are gone. */
static void free_text(struct feed *f)
{
    uint32_t id;
    for (size_t at = 0; f->sent == f->watchers && at < buf_len(&f->text.gone); at += sizeof id) {
        memcpy(&id, buf_head(&f->text.gone) + at, sizeof id);
        known_remove(&f->known, id);
    }
    event_free(&f->text);
    f->sent = 0;
}

static void count_memory(struct feed *f)
{
    size_t bytes = sizeof *f + known_memory(&f->known) + event_memory(&f->text);
    f->of->feed_bytes += bytes - f->counted;
    f->counted = bytes;
}

void feed_free_texts(struct watched *k)
{
    for (void *link; (link = list_pop(&k->texts)) != NULL;) {
        struct feed *f = list_owner(link, offsetof(struct feed, kept));
        free_text(f);
        count_memory(f);
    }
}

static void make_text(struct feed *f, const struct position *from)
{
    const struct watched *k = f->of;
    free_text(f);
    scope_find(&f->scope, k->set->current->dt);
    f->text = (struct event){.scope = &f->scope,
                             .known = &f->known,
                             .ids = k->ids,
                             .line = feed_line(k),
                             .lsn = durable_lsn(k->server, k->set)};
    f->from = f->to = *from;
    put_rows(&f->text, f, &f->to);
    bool more = feed_lacks(f, &f->to);
    f->silent = f->text.n == 0 && more && !f->text.rows.failed;
    if (f->silent)
        f->to.reset = f->text.reset;
    else
        event_head(&f->text, k->name, k->version, more);
}

/* ---- sending ---- */

bool feed_can_take(const struct watcher *w)
{
    const struct session *s = w->session;
    return !s->conn.closed && !s->conn.finishing && s->state != SESSION_STREAMING &&
           !conn_full(&s->conn);
}

/* Whether the connection sends it later. */
static bool send_event(const struct watcher *w, struct event *e)
{
    struct server *s = w->session->server;
    struct conn *c = &w->session->conn;
    const struct buf *text = event_text(e, w->typed);
    hold_view(&s->held, &c->hold, e->lsn, conn_out_end(c));
    s->count.events++;
    if (text != NULL)
        return !conn_write(c, buf_head(text), buf_len(text));
    conn_close(c);
    return false;
}

static bool is_same(const struct position *a, const struct position *b)
{
    return a->tick == b->tick && a->goal == b->goal && a->sweep == b->sweep && a->ids == b->ids &&
           a->reset == b->reset && a->altered == b->altered && a->lists == b->lists &&
           a->listed == b->listed;
}

bool feed_serve(struct watcher *w)
{
    struct feed *f = w->feed;
    if (f->sent == 0 || !is_same(&f->from, &w->at))
        make_text(f, &w->at);
    bool later = !f->silent && send_event(w, &f->text);
    w->at = f->to;
    f->sent++;
    if (f->sent == f->watchers)
        free_text(f);
    else if (!list_holds(&f->kept))
        list_append(&f->of->texts, &f->kept);
    count_memory(f);
    return later;
}

void feed_end(struct watcher *w)
{
    struct event e = {.scope = &w->feed->scope, .lsn = w->session->server->dropped};
    event_dropped(&e, w->feed->of->name);
    send_event(w, &e);
    event_free(&e);
    feed_leave(w);
}

/* ---- who belongs to it ---- */

struct feed *feed_enter(struct watched *k, struct scope *scope)
{
    struct feed *f = list_first(&k->feeds);
    while (f != NULL && !scope_equal(&f->scope, scope))
        f = list_next(&k->feeds, f);
    if (f != NULL || (f = calloc(1, sizeof *f)) == NULL) {
        scope_clear(scope);
    } else {
        f->of = k;
        f->scope = *scope;
        *scope = (struct scope){.names = NULL};
        list_append(&k->feeds, &f->link);
    }
    if (f != NULL) {
        free_text(f); /* it may be older than the request of the new watcher */
        f->watchers++;
        count_memory(f);
    }
    return f;
}

void feed_leave(struct watcher *w)
{
    struct feed *f = w->feed;
    list_remove(&w->also);
    w->session->watches--;
    w->session->server->count.watchers--;
    f->of->watchers--;
    list_remove(&w->link);
    free(w);
    free_text(f); /* the watcher may be counted in `sent` */
    count_memory(f);
    if (--f->watchers > 0)
        return;
    f->of->feed_bytes -= f->counted;
    list_remove(&f->link);
    list_remove(&f->kept);
    known_clear(&f->known);
    scope_clear(&f->scope);
    free(f);
}
