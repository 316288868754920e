/* feed.c - see feed.h. */
#include "server/watch/feed.h"

#include "server/jobs/durable.h"

#include <stdlib.h>
#include <string.h>

enum {
    SHARED_KEYS = 1024, /* more than this are sent in parts */
    NEW_IDS = 65536,    /* more than this are a reset */
    BOX_STEPS = 10000,  /* a search that takes longer is left for a sweep */
    LINE_STEPS = 100000 /* rings on a line that take more are sent in parts */
};

/* ---- backlogs ---- */

bool backlog_lags(const struct backlog *b)
{
    return b->reset || b->outdated || b->sweeping || b->ids.count > 0;
}

void backlog_clear(struct backlog *b)
{
    idset_clear(&b->ids);
    *b = (struct backlog){.reset = false};
}

void backlog_all(struct backlog *b)
{
    backlog_clear(b);
    b->reset = b->sweeping = true;
}

void backlog_mark(struct backlog *b, uint32_t id, uint32_t ids)
{
    if (b->sweeping && id >= b->sweep)
        return;
    if (!idset_add(&b->ids, id, ids))
        backlog_all(b);
}

static void backlog_copy(struct backlog *to, const struct backlog *from)
{
    *to = *from;
    to->ids = (struct idset){.count = 0};
    if (!idset_copy(&to->ids, &from->ids))
        backlog_all(to);
}

bool feed_find_box(const struct feed *f, struct dt_ids *found)
{
    struct dt_options opt = {.steps = BOX_STEPS};
    return dt_within_box(f->of->set->current->dt, f->scope.lo, f->scope.hi, &opt, found) == DT_OK;
}

/* The ids of a new backlog of everything, if the set can find those in the box quickly. */
static void seek_box(struct backlog *b, const struct feed *f)
{
    struct dt_ids found = {0};
    if (feed_find_box(f, &found)) {
        b->sweeping = false;
        for (size_t i = 0; i < found.n; i++)
            backlog_mark(b, found.v[i], f->of->ids);
    }
    free(found.v);
}

/* Moves as much of the backlog as makes a part into the event. */
static void put_part(struct event *e, struct backlog *b, const struct feed *f, const struct dt *dt)
{
    enum { LOOKED_AT = 20000 };
    uint32_t ids = f->of->ids;
    b->outdated = false;
    if (b->sweeping && b->sweep == 0 && f->scope.boxed)
        seek_box(b, f);
    if (b->sweeping) {
        for (unsigned i = 0; b->sweep < ids && i < LOOKED_AT && !event_is_full(e); i++)
            event_put(e, dt, b->sweep++, EVENT_NEW);
        b->sweeping = b->sweep < ids;
    } else {
        while (b->ids.count > 0 && !event_is_full(e))
            event_put(e, dt, idset_take(&b->ids), EVENT_ALL);
    }
    if (!b->sweeping && b->ids.count == 0)
        idset_clear(&b->ids);
}

/* ---- lists of watchers ---- */

static void count_memory(struct watcher *w)
{
    struct conn *c = &w->session->conn;
    size_t now = idset_memory(&w->own.ids);
    if (now == w->counted)
        return;
    c->owner_bytes = c->owner_bytes - w->counted + now;
    w->counted = now;
    if (!c->closed)
        reservation_set(&c->memory, c->owner_bytes + c->in.cap + c->out.cap);
}

static void take_out(struct watcher *w)
{
    struct feed *f = w->feed;
    if (f->unsent == w)
        f->unsent = list_next(&f->watchers, w);
    f->late -= w->late;
    list_remove(&w->link);
}

void feed_join(struct watcher *w)
{
    w->late = false;
    list_prepend(&w->feed->watchers, &w->link);
    count_memory(w);
}

void feed_join_late(struct watcher *w)
{
    list_append(&w->feed->of->late, &w->link);
    w->late = true;
    w->feed->late++;
    count_memory(w);
}

void feed_leave(struct watcher *w)
{
    take_out(w);
    list_remove(&w->also);
    w->session->watches--;
    w->session->server->count.watchers--;
    backlog_clear(&w->own);
    count_memory(w);
    free(w);
}

/* ---- sending ---- */

bool feed_can_take(const struct watcher *w)
{
    const struct session *s = w->session;
    return !s->conn.closed && !s->conn.finishing && s->state != SESSION_STREAMING &&
           s->state != SESSION_LISTING && !conn_full(&s->conn);
}

uint32_t feed_line(const struct watched *k)
{
    const struct dt_summary *sum = &k->set->current->sum;
    return sum->triangulated && sum->triangles == 0 ? sum->points : 0;
}

/* An event with nothing in it yet. */
static struct event event_for(struct server *s, struct feed *f, bool to_all)
{
    scope_find(&f->scope, f->of->set->current->dt);
    return (struct event){.scope = &f->scope,
                          .known = &f->known,
                          .keep_known = !to_all || f->late > 0,
                          .ids = f->of->ids,
                          .line = feed_line(f->of),
                          .lsn = durable_lsn(s, f->of->set)};
}

static void send_event(struct server *s, const struct watcher *w, struct event *e)
{
    struct conn *c = &w->session->conn;
    const struct buf *text = event_text(e, w->typed);
    hold_view(&s->held, &c->hold, e->lsn, conn_out_end(c));
    if (text == NULL)
        conn_close(c);
    else if (!conn_write(c, buf_head(text), buf_len(text)))
        w->feed->of->later++;
    s->count.events++;
}

/* Adds what the event would have said. */
static void mark_event(struct backlog *b, struct feed *f)
{
    const struct event *e = &f->sending;
    bool good = !e->named.failed;
    uint32_t id;
    b->reset = b->reset || e->reset;
    b->outdated = true;
    for (size_t at = 0; good && at < buf_len(&e->named); at += sizeof id) {
        memcpy(&id, buf_head(&e->named) + at, sizeof id);
        good = !f->scope.boxed || known_add(&f->known, id, f->of->ids);
        backlog_mark(b, id, f->of->ids);
    }
    if (!good)
        backlog_all(b);
}

/* A watcher that cannot take the next event becomes late, with a copy of the shared backlog. */
static void become_late(struct watcher *w, bool lacks_event)
{
    backlog_copy(&w->own, &w->feed->shared);
    if (lacks_event)
        mark_event(&w->own, w->feed);
    take_out(w);
    feed_join_late(w);
}

static void leave_late_behind(struct feed *f)
{
    bool lacks_event = false;
    for (struct watcher *w = list_first(&f->watchers), *next; w != NULL; w = next) {
        next = list_next(&f->watchers, w);
        lacks_event = lacks_event || w == f->unsent;
        if (!feed_can_take(w))
            become_late(w, lacks_event);
    }
}

static void begin_sending(struct feed *f, const struct event *e)
{
    event_free(&f->sending);
    f->sending = *e;
    f->unsent = list_first(&f->watchers);
}

void feed_send(struct server *s, struct feed *f, int64_t end_ns)
{
    for (struct watcher *w; (w = f->unsent) != NULL;) {
        if (feed_can_take(w)) {
            send_event(s, w, &f->sending);
            f->unsent = list_next(&f->watchers, w);
        } else {
            become_late(w, true);
        }
        if (clock_ns() >= end_ns)
            break;
    }
    if (f->unsent == NULL)
        event_free(&f->sending);
}

/* Whether a part is worth sending: it has rows, or ends the backlog. */
static bool is_worth_sending(const struct event *e, const struct backlog *b)
{
    return e->n > 0 || !backlog_lags(b) || e->rows.failed;
}

/* Moves a part of the backlog into the event; false: nothing is worth sending yet. */
static bool take_part(struct event *e, struct backlog *b, const struct feed *f)
{
    const struct watched *k = f->of;
    e->reset = b->reset;
    put_part(e, b, f, k->set->current->dt);
    b->reset = false;
    if (!is_worth_sending(e, b)) {
        b->reset = e->reset;
        return false;
    }
    event_head(e, k->name, k->version, backlog_lags(b));
    return true;
}

void feed_part(struct server *s, struct feed *f)
{
    if (f->unsent != NULL)
        return;
    leave_late_behind(f);
    if (list_is_empty(&f->watchers)) {
        backlog_clear(&f->shared);
        return;
    }
    struct event e = event_for(s, f, true);
    if (take_part(&e, &f->shared, f))
        begin_sending(f, &e);
    else
        event_free(&e);
}

bool feed_late_part(struct server *s, struct watcher *w)
{
    struct feed *f = w->feed;
    if (!feed_can_take(w))
        return false;
    struct event e = event_for(s, f, false);
    if (take_part(&e, &w->own, f))
        send_event(s, w, &e);
    event_free(&e);
    take_out(w);
    if (backlog_lags(&w->own))
        feed_join_late(w);
    else
        feed_join(w);
    return true;
}

/* ---- changes ---- */

/* Marks an id, unless a watcher of the box is not sent anything about it: it is not there and was not. */
static void mark(struct backlog *b, const struct feed *f, uint32_t id)
{
    struct dt_point p;
    if (!f->scope.boxed || known_has(&f->known, id) ||
        scope_has_point(&f->scope, f->of->set->current->dt, id, &p))
        backlog_mark(b, id, f->of->ids);
}

/* Marks what has changed, apart from values that the feed does not show. */
static void mark_change(struct backlog *b, const struct feed *f, const struct feed_change *c)
{
    b->outdated = true;
    for (size_t i = 0; i < c->rows; i++)
        mark(b, f, (uint32_t)(c->row[i] >> 32));
    for (size_t i = 0; i < c->values; i++)
        if (scope_has_value(&f->scope, c->value[i]))
            mark(b, f, (uint32_t)(c->value[i] >> 32));
    for (uint32_t id = c->from; id < f->of->ids; id++)
        mark(b, f, id);
}

/* One that does not read, and lacks much of the set, will be sent a reset, which needs no marks. */
static void mark_late(struct watcher *w, const struct feed_change *c)
{
    enum { FEW = 4096 };
    uint32_t n = w->own.ids.count;
    if (n > FEW && n > w->feed->of->ids / 4 && !feed_can_take(w))
        backlog_all(&w->own);
    mark_change(&w->own, w->feed, c);
    count_memory(w);
}

static int by_key(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* The rows of a small change, by id. */
static void put_change(struct event *e, const struct dt *dt, const struct feed_change *c)
{
    uint64_t key[2 * SHARED_KEYS];
    size_t n = 0;
    for (size_t i = 0; i < c->rows; i++)
        key[n++] = c->row[i];
    for (size_t i = 0; i < c->values; i++)
        if (scope_has_value(e->scope, c->value[i])) /* takes as much as a row */
            key[n++] = c->value[i] >> 32 << 32 | DT_TOUCHED_ROW;
    qsort(key, n, sizeof key[0], by_key);
    for (size_t i = 0; i < n; i++) {
        uint32_t id = (uint32_t)(key[i] >> 32);
        if (id < c->from && (i == 0 || key[i - 1] >> 32 != id))
            event_put(e, dt, id, (uint32_t)key[i] == DT_TOUCHED_RING ? EVENT_RING : EVENT_ALL);
    }
    for (uint32_t id = c->from; id < e->ids; id++)
        event_put(e, dt, id, EVENT_NEW);
}

static void share(struct server *s, struct feed *f, const struct feed_change *c)
{
    const struct watched *k = f->of;
    struct event e = event_for(s, f, true);
    put_change(&e, k->set->current->dt, c);
    event_head(&e, k->name, k->version, false);
    begin_sending(f, &e);
}

void feed_change(struct server *s, struct feed *f, const struct feed_change *c, bool now)
{
    struct watched *k = f->of;
    scope_find(&f->scope, k->set->current->dt);
    bool on_line = f->scope.boxed && feed_line(k) > 0;
    bool all = !c->rows_known || on_line || k->ids - c->from > NEW_IDS ||
               (f->scope.names != NULL && !c->values_known);
    bool small = c->rows <= SHARED_KEYS && c->values <= SHARED_KEYS &&
                 k->ids - c->from <= SHARED_KEYS && !all && !backlog_lags(&f->shared) &&
                 (c->rows + k->ids - c->from) * feed_line(k) <= LINE_STEPS;
    leave_late_behind(f);
    for (struct watcher *w = list_first(&k->late); w != NULL; w = list_next(&k->late, w)) {
        if (w->feed == f && all)
            backlog_all(&w->own);
        else if (w->feed == f)
            mark_late(w, c);
    }
    if (list_is_empty(&f->watchers))
        return;
    if (now && small && f->unsent == NULL)
        share(s, f, c);
    else if (all)
        backlog_all(&f->shared);
    else
        mark_change(&f->shared, f, c);
}

/* ---- the end ---- */

static void tell_dropped(struct server *s, struct watcher *w)
{
    struct event e = {.scope = &w->feed->scope, .lsn = s->dropped};
    if (!feed_can_take(w))
        return;
    event_dropped(&e, w->feed->of->name);
    send_event(s, w, &e);
    event_free(&e);
    feed_leave(w);
}

static void tell_all_dropped(struct server *s, const struct list *watchers)
{
    for (struct watcher *w = list_first(watchers), *next; w != NULL; w = next) {
        next = list_next(watchers, w);
        tell_dropped(s, w);
    }
}

void feed_dropped(struct server *s, struct watched *k)
{
    tell_all_dropped(s, &k->late);
    for (struct feed *f = list_first(&k->feeds); f != NULL; f = list_next(&k->feeds, f))
        tell_all_dropped(s, &f->watchers);
}

size_t feed_memory(const struct feed *f)
{
    return sizeof *f + idset_memory(&f->shared.ids) + known_memory(&f->known) +
           event_memory(&f->sending);
}

void feed_free(struct feed *f)
{
    backlog_clear(&f->shared);
    event_free(&f->sending);
    known_clear(&f->known);
    scope_clear(&f->scope);
    free(f);
}
