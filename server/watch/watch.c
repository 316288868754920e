/* watch.c - see watch.h. */
#include "server/watch/watch.h"

#include "server/jobs/upkeep.h"
#include "server/watch/agenda.h"
#include "server/watch/feed.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    RETRY_MS = 1000, /* after a triangulation for watchers has failed */
    KEEP_MS = 60000, /* what has changed lately is kept for watchers that come back */
    /* Events get one part of SHARE of the processor time while a set is edited, and some of the time in which the loop
     * has nothing to do, at most CREDIT_NS at once after a pause. What they exceed that by is owed, up to DEBT_NS. */
    SHARE = 12,
    CREDIT_NS = 2000 * 1000,
    DEBT_NS = 5000 * 1000,
    SEND_NS = 5000,             /* for sending an event to a watcher */
    CHUNK_NS = 50 * 1000,       /* the time for sending an event in a turn */
    KEY_NS = 400,               /* about so much for the rows of a key */
    SMALL_NS = 40 * 1000,       /* an event that takes less never waits: one after one edit */
    QUIET_NS = 3 * 1000 * 1000, /* a set that has not been edited for so long pauses */
    TURN_NS = 1000 * 1000,      /* the time for watchers that lag in a turn, and for late ones */
    WAKE_MS = 4,                /* until a delay is examined again, if nothing else happens */
    COLLECT_KEYS = 4096         /* so many are collected also while no event may be sent */
};

static void do_nothing(struct task *t)
{
    (void)t;
}

static void wake(struct timer *t)
{
    (void)t; /* events are written at the end of every turn */
}

/* ---- collecting ---- */

static void count_memory(struct watched *k)
{
    size_t bytes = sizeof *k + recent_memory(&k->recent);
    for (const struct feed *f = list_first(&k->feeds); f != NULL; f = list_next(&k->feeds, f))
        bytes += feed_memory(f);
    reservation_set(&k->memory, bytes);
}

/* Takes what edits have touched, and reports it to the feeds. */
static void collect(struct server *s, struct watched *k, bool now)
{
    struct dt *dt = k->set->current->dt;
    struct feed_change c = {.from = k->ids, .values_known = true};
    c.rows_known = dt_touched_take(dt, &c.row, &c.rows);
    if (k->values)
        c.values_known = dt_touched_take_values(dt, &c.value, &c.values);
    dt_touched_begin(dt, k->values);
    k->version = k->set->version;
    k->ids = dt_next_id(dt);
    if (!c.values_known)
        k->values_since = k->version;
    for (struct feed *f = list_first(&k->feeds); f != NULL; f = list_next(&k->feeds, f))
        feed_change(s, f, &c, now);
    if (!c.rows_known) {
        recent_restart(&k->recent, k->version, k->ids);
        return;
    }
    recent_put(&k->recent, c.row, c.rows);
    recent_put(&k->recent, c.value, c.values);
    recent_mark(&k->recent, k->version, k->ids);
}

/* ---- a triangulation that edits have left for later ---- */

/* Whether the triangulation is current; if not, a job updates it. */
static bool refresh(struct server *s, struct watched *k)
{
    int64_t now = clock_ms();
    if (!version_is_stale(k->set->current))
        return true;
    if (!dataset_admits(k->set, true, NULL) || now < k->retry_ms)
        return false;
    struct buf out = {0};
    struct answer nobody = {.out = &out};
    k->retry_ms = now + RETRY_MS;
    bool current = upkeep_refresh(s, &nobody, k->set);
    buf_free(&out);
    return current;
}

/* ---- when events are written ---- */

/* Processor time of this thread: the time that others take on a busy machine does not count. */
static int64_t processor_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Events of a set get a share of the time while it is edited, so that a watcher slows edits down by little; what is not
 * sent yet is merged. Isolated edits never wait, because there is credit. The time in which the loop is idle is not spare if
 * it is busy as long: clients that edit without pause need processors, too. */
static bool is_due(struct watched *k, const struct loop *loop, int64_t processor)
{
    int64_t now = clock_ns(), busy = processor - k->credit_at_ns;
    int64_t idle = loop == NULL ? 0 : loop->idle_ns - k->idle_ns;
    int64_t credit = k->credit_ns + busy / SHARE + (idle > busy ? (idle - busy) / 2 : 0);
    k->credit_ns = credit < CREDIT_NS ? credit : CREDIT_NS;
    k->credit_at_ns = processor;
    k->idle_ns += idle;
    if (k->changing != k->set->version) {
        k->changing = k->set->version;
        k->changed_ns = now;
    }
    return k->credit_ns >= 0 || now - k->changed_ns >= QUIET_NS;
}

/* Whether the next event is a small one. */
static bool is_small(const struct watched *k)
{
    const struct dt *dt = k->set->current->dt;
    int64_t ns = ((int64_t)dt_touched_count(dt) + dt_next_id(dt) - k->ids) * KEY_NS;
    for (const struct feed *f = list_first(&k->feeds); f != NULL && ns <= SMALL_NS;
         f = list_next(&k->feeds, f)) {
        if (!list_is_empty(&f->watchers) && backlog_lags(&f->shared))
            return false;
        for (const struct watcher *w = list_first(&f->watchers); w != NULL && ns <= SMALL_NS;
             w = list_next(&f->watchers, w))
            ns += SEND_NS;
    }
    return ns <= SMALL_NS;
}

/* Late watchers get parts in order, as far as the time goes. False: more could be sent at once. */
static bool serve_late(struct server *s, struct watched *k, int64_t end)
{
    size_t n = 0;
    bool all = true;
    for (const struct watcher *w = list_first(&k->late); w != NULL; w = list_next(&k->late, w))
        n++;
    for (struct watcher *w = list_first(&k->late), *next; n-- > 0; w = next) {
        next = list_next(&k->late, w);
        if (!feed_late_part(s, w))
            continue;
        all = all && !w->late;
        if (clock_ns() >= end)
            return all && n == 0;
    }
    return all;
}

static bool is_sending(const struct watched *k)
{
    for (const struct feed *f = list_first(&k->feeds); f != NULL; f = list_next(&k->feeds, f))
        if (f->unsent != NULL)
            return true;
    return false;
}

/* Continues to send events that have been begun. False: some watchers have not been sent theirs. */
static bool send_begun(struct server *s, const struct watched *k, int64_t end)
{
    for (struct feed *f = list_first(&k->feeds); f != NULL; f = list_next(&k->feeds, f))
        if (f->unsent != NULL)
            feed_send(s, f, end);
    return !is_sending(k);
}

static bool feeds_lag(const struct watched *k)
{
    for (const struct feed *f = list_first(&k->feeds); f != NULL; f = list_next(&k->feeds, f))
        if (!list_is_empty(&f->watchers) && backlog_lags(&f->shared))
            return true;
    return false;
}

/* Feeds get parts in order, as far as the time goes. */
static void serve_feeds(struct server *s, struct watched *k, int64_t end)
{
    size_t n = 0;
    for (const struct feed *f = list_first(&k->feeds); f != NULL; f = list_next(&k->feeds, f))
        n++;
    for (; n > 0 && clock_ns() < end; n--) {
        struct feed *f = list_first(&k->feeds);
        if (!list_is_empty(&f->watchers) && backlog_lags(&f->shared))
            feed_part(s, f);
        list_append(&k->feeds, list_pop(&k->feeds)); /* the first one becomes the last one */
    }
}

static struct loop *loop_of_first(const struct list *watchers)
{
    const struct watcher *w = list_first(watchers);
    return w == NULL ? NULL : w->session->conn.loop;
}

static struct loop *loop_of(const struct watched *k)
{
    for (const struct feed *f = list_first(&k->feeds); f != NULL; f = list_next(&k->feeds, f))
        if (!list_is_empty(&f->watchers))
            return loop_of_first(&f->watchers);
    return loop_of_first(&k->late);
}

/* Collects changes and makes events. False: more could be made at once. */
static bool make_events(struct server *s, struct watched *k, bool changed, bool due)
{
    if (changed && (due || dt_touched_count(k->set->current->dt) >= COLLECT_KEYS)) {
        k->retry_ms = 0;
        collect(s, k, due);
    }
    if (!due)
        return true;
    serve_feeds(s, k, clock_ns() + TURN_NS);
    return serve_late(s, k, clock_ns() + TURN_NS) && !feeds_lag(k);
}

/* Whether what has changed may be looked at: no job has the set, and the triangulation is current. */
static bool is_ready(struct server *s, struct watched *k, bool changed, const struct loop *loop)
{
    if (k->set->exclusive || !changed)
        return !k->set->exclusive;
    return loop == NULL ? !version_is_stale(k->set->current) : refresh(s, k);
}

static void flush(struct server *s, struct watched *k)
{
    static struct task again = {.run = do_nothing};
    struct loop *loop = loop_of(k);
    bool changed = k->version != k->set->version, all = true;
    if (!changed && list_is_empty(&k->late) && !feeds_lag(k) && !is_sending(k))
        return;
    int64_t before = processor_ns();
    if (is_ready(s, k, changed, loop)) {
        bool due = is_due(k, loop, before) || (changed && is_small(k));
        all = make_events(s, k, changed, due);
        if (!due && loop != NULL)
            loop_at(loop, &k->due, loop->now_ms + WAKE_MS);
    }
    if (!send_begun(s, k, clock_ns() + CHUNK_NS) || !all)
        loop_defer(loop, &again);
    count_memory(k);
    k->credit_ns -= processor_ns() - before + (int64_t)k->later * SEND_NS;
    k->later = 0;
    if (k->credit_ns < -DEBT_NS)
        k->credit_ns = -DEBT_NS;
}

/* ---- the end of a turn ---- */

static void free_deserted_feeds(struct watched *k)
{
    for (struct feed *f = list_first(&k->feeds), *next; f != NULL; f = next) {
        next = list_next(&k->feeds, f);
        if (!list_is_empty(&f->watchers) || f->late > 0)
            continue;
        list_remove(&f->link);
        feed_free(f);
    }
}

static void free_watched(struct watched *k)
{
    timer_clear(&k->due);
    free_deserted_feeds(k);
    recent_clear(&k->recent);
    reservation_set(&k->memory, 0);
    free(k);
}

/* The set is watched no longer. */
static void forget(struct watched *k)
{
    if (k->set != NULL) {
        dt_touched_end(k->set->current->dt);
        k->set->watched = NULL;
    }
    agenda_leave(k);
    free_watched(k);
}

/* Whether the watcher can take an event now; if not, its connection says when it can (watch_resume). */
static bool can_take(struct watcher *w)
{
    bool can = feed_can_take(w);
    w->session->conn.wants_room = w->session->conn.wants_room || !can;
    return can;
}

/* Whether there is more to do in the next turn. */
static bool is_busy(struct watched *k)
{
    bool more = k->set != NULL && (feeds_lag(k) || is_sending(k) ||
                                   (k->version != k->set->version && loop_of(k) != NULL));
    for (struct watcher *w = list_first(&k->late); w != NULL; w = list_next(&k->late, w))
        more = can_take(w) || more;
    for (const struct feed *f = list_first(&k->feeds); k->set == NULL && f != NULL;
         f = list_next(&k->feeds, f))
        for (struct watcher *w = list_first(&f->watchers); w != NULL;
             w = list_next(&f->watchers, w))
            more = can_take(w) || more;
    return more;
}

static void look_at(struct server *s, struct watched *k)
{
    if (k->set == NULL)
        feed_dropped(s, k);
    else
        flush(s, k);
    free_deserted_feeds(k);
    bool deserted = list_is_empty(&k->feeds);
    if (deserted && k->set == NULL) {
        forget(k);
        return;
    }
    if (deserted)
        agenda_desert(k, clock_ms());
    if (is_busy(k))
        agenda_call(k);
}

/* Forgets sets whose last watcher left long ago. While a worker notes what an edit touches, it stays. */
static void forget_deserted(struct server *s)
{
    enum { MOST = 256 }; /* some microseconds each */
    int64_t now = agenda_deserted(s) == NULL ? 0 : clock_ms();
    struct watched *k;
    for (int i = 0; i < MOST && (k = agenda_deserted(s)) != NULL; i++) {
        if (now - k->deserted_ms < KEEP_MS)
            return;
        agenda_return(k);
        if (k->set != NULL && k->set->exclusive)
            agenda_desert(k, now);
        else
            forget(k);
    }
}

void watch_turn_end(struct server *s)
{
    agenda_begin(s);
    for (struct watched *k; (k = agenda_next(s)) != NULL;)
        look_at(s, k);
    forget_deserted(s);
}

void watch_clear(struct server *s)
{
    for (struct watched *k; (k = list_first(&s->watching.all)) != NULL;) {
        agenda_leave(k);
        free_watched(k);
    }
}

/* ---- who watches ---- */

static struct watched *watched_of(struct server *s, struct dataset *set)
{
    struct watched *k = set->watched;
    if (k != NULL || (k = calloc(1, sizeof *k)) == NULL)
        return k;
    memcpy(k->name, set->name, set->name_len);
    k->set = set;
    k->version = k->changing = set->version;
    k->ids = dt_next_id(set->current->dt);
    k->credit_at_ns = processor_ns();
    k->credit_ns = CREDIT_NS;
    k->due.run = wake;
    k->memory = server_reservation(s, BUDGET_CLIENTS);
    dt_touched_begin(set->current->dt, false);
    recent_restart(&k->recent, k->version, k->ids);
    k->server = s;
    agenda_enter(k);
    set->watched = k;
    return k;
}

static struct watcher *first_of(const struct session *who)
{
    return list_owner(list_first(&who->watching), offsetof(struct watcher, also));
}

static struct watcher *next_of(const struct session *who, const struct watcher *w)
{
    return list_owner(list_next(&who->watching, &w->also), offsetof(struct watcher, also));
}

/* The session's watcher of a set of that name; NULL: none. */
static struct watcher *find(const struct session *who, const char *name)
{
    struct watcher *w = first_of(who);
    while (w != NULL && strcmp(w->feed->of->name, name) != 0)
        w = next_of(who, w);
    return w;
}

/* The feed of that scope, which moves there. NULL: out of memory. */
static struct feed *feed_of(struct watched *k, struct scope *scope)
{
    struct feed *f = list_first(&k->feeds);
    while (f != NULL && !scope_equal(&f->scope, scope))
        f = list_next(&k->feeds, f);
    if (f != NULL || (f = calloc(1, sizeof *f)) == NULL) {
        scope_clear(scope);
        return f;
    }
    f->of = k;
    f->scope = *scope;
    *scope = (struct scope){.names = NULL};
    scope_find(&f->scope, k->set->current->dt);
    list_prepend(&k->feeds, &f->link);
    if (f->scope.names != NULL && !k->values) {
        k->values = true;
        k->values_since = k->set->version;
        if (!k->set->exclusive) /* otherwise the next change is one of everything */
            dt_touched_begin(k->set->current->dt, true);
    }
    return f;
}

/* Adds the points in the box to those that a watcher may know: all, if they cannot be found now, or if there are changes that
 * have not been collected: points that have just left the box are not found. */
static bool know_box(struct feed *f)
{
    const struct watched *k = f->of;
    struct dt_ids found = {0};
    bool good = !k->set->exclusive && k->version == k->set->version && feed_find_box(f, &found);
    if (!good)
        good = known_fill(&f->known, k->ids);
    for (size_t i = 0; good && i < found.n; i++)
        good = known_add(&f->known, found.v[i], k->ids);
    free(found.v);
    return good;
}

/* Marks an id; it may have been in the box. */
static bool mark_back(struct watcher *w, uint32_t id)
{
    struct feed *f = w->feed;
    backlog_mark(&w->own, id, f->of->ids);
    return !f->scope.boxed || known_add(&f->known, id, f->of->ids);
}

/* Marks what has changed since a version that the watcher knows. False: that is not known. */
static bool mark_since(struct watcher *w, uint64_t since)
{
    struct feed *f = w->feed;
    const struct watched *k = f->of;
    const struct recent_mark *m = recent_find(&k->recent, since);
    if (since > k->set->version || m == NULL || version_is_stale(k->set->current) ||
        (f->scope.names != NULL && since < k->values_since) || (f->scope.boxed && feed_line(k) > 0))
        return false;
    bool good = !f->scope.boxed || know_box(f);
    w->own.outdated = since != k->version;
    for (uint64_t at = m->at; good && at < k->recent.key_end; at++) {
        uint64_t key = recent_key(&k->recent, at);
        if ((uint32_t)key < DT_TOUCHED_VALUE || scope_has_value(&f->scope, key))
            good = mark_back(w, (uint32_t)(key >> 32));
    }
    for (uint32_t id = m->ids; good && id < k->ids; id++)
        good = mark_back(w, id);
    return good;
}

bool watch_begin(struct server *s, struct session *who, struct dataset *set, struct scope *scope,
                 uint64_t since)
{
    struct watcher *w = calloc(1, sizeof *w);
    struct watched *k = w == NULL ? NULL : watched_of(s, set);
    if (k != NULL)
        watch_end(who, set);
    struct feed *f = k == NULL ? NULL : feed_of(k, scope);
    if (f == NULL) {
        if (k != NULL)
            agenda_call(k); /* it may have no watchers */
        scope_clear(scope);
        free(w);
        return false;
    }
    w->feed = f;
    w->session = who;
    w->typed = who->resp;
    list_append(&who->watching, &w->also);
    who->watches++;
    s->count.watchers++;
    if (!mark_since(w, since))
        backlog_all(&w->own);
    if (backlog_lags(&w->own))
        feed_join_late(w);
    else
        feed_join(w);
    count_memory(k);
    agenda_return(k);
    agenda_call(k);
    /* A triangulation that was left for later will be a change of everything. */
    if (version_is_stale(set->current))
        k->version = 0;
    return true;
}

static void leave(struct watcher *w)
{
    agenda_call(w->feed->of); /* there may be no other */
    feed_leave(w);
}

bool watch_end(struct session *who, const struct dataset *set)
{
    struct watcher *w = find(who, set->name);
    if (w != NULL)
        leave(w);
    return w != NULL;
}

void watch_leave(struct session *who)
{
    for (struct watcher *w; (w = first_of(who)) != NULL;)
        leave(w);
}

void watch_resume(struct session *who)
{
    for (const struct watcher *w = first_of(who); w != NULL; w = next_of(who, w))
        if (w->late || w->feed->of->set == NULL)
            agenda_call(w->feed->of);
}

void watch_changed(struct dataset *set)
{
    agenda_call(set->watched);
}

void watch_dropped(struct dataset *set)
{
    agenda_call(set->watched);
    set->watched->set = NULL;
}
