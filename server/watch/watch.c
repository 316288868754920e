/* watch.c - see watch.h. */
#include "server/watch/watch.h"

#include "server/jobs/upkeep.h"
#include "server/watch/feed.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    RETRY_MS = 1000,            /* after a triangulation for watchers has failed */
    KEEP_MS = 60000,            /* what has changed lately is kept for watchers that come back */
    TURN_NS = 100 * 1000,       /* the time for events in a turn */
    SEND_NS = 5000,             /* for sending an event to a watcher */
    KEY_NS = 400,               /* about so much for the rows of a key */
    SMALL_NS = 40 * 1000,       /* an event that takes less never waits: one after one edit */
    QUIET_NS = 3 * 1000 * 1000, /* a set that has not been edited for so long pauses */
    WAKE_MS = 4,                /* until a delay is examined again, if nothing else happens */
    COLLECT_KEYS = 4096,        /* so many are collected also while no event may be sent */
    NEW_IDS = 65536             /* more than this are a change of everything */
};

/* The work that may still be done in a turn. */
struct turn {
    int64_t end_ns;
    unsigned watchers;
};

static void do_nothing(struct task *t)
{
}

/* The next turn begins at once. */
static void continue_soon(struct server *s)
{
    static struct task again = {.run = do_nothing};
    loop_defer(s->watching.loop, &again);
}

static void wake(struct timer *t)
{
    /* events are written at the end of every turn */
}

/* ---- the sets that a turn looks at ----
 *
 * A set that is merely watched costs a turn nothing. It is in one list or several:
 *
 *     all       every watched set
 *     busy      those that have changed, or have something to send: at the end of this turn,
 *     now       or of the next one, if this turn has taken long
 *     deserted  those whose last watcher has left, in the order in which they did: about a minute later */

/* The set is looked at, at the end of this turn. Reactors that share the world call it, too: of a set whose gate they have closed. */
static void call(struct watched *k)
{
    static pthread_mutex_t calls = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&calls);
    if (!list_holds(&k->busy))
        list_append(&k->server->watching.busy, &k->busy);
    pthread_mutex_unlock(&calls);
}

static void desert(struct watched *k, int64_t now_ms)
{
    if (list_holds(&k->deserted))
        return;
    k->deserted_ms = now_ms;
    list_append(&k->server->watching.deserted, &k->deserted);
}

static struct watched *first_deserted(const struct server *s)
{
    return list_owner(list_first(&s->watching.deserted), offsetof(struct watched, deserted));
}

/* ---- collecting ---- */

static void count_memory(struct watched *k)
{
    reservation_set(&k->memory, sizeof *k + recent_memory(&k->recent) +
                                    stamps_memory(&k->row_stamps) + altered_memory(&k->altered) +
                                    stamps_memory(&k->value_stamps) + k->feed_bytes);
}

static bool put_stamps(struct stamps *s, const uint64_t *key, size_t n, uint64_t tick)
{
    for (size_t i = 0; i < n; i++)
        if (!stamps_put(s, (uint32_t)(key[i] >> 32), tick))
            return false;
    return true;
}

/* Takes the keys that edits have touched. Afterwards all watchers lack a change. */
static void collect(struct watched *k)
{
    struct dt *dt = k->set->current->dt;
    uint64_t tick = feed_tick(k) + 1;
    const uint64_t *row, *value = NULL;
    const struct dt_touched_constraint *constraint;
    size_t rows, values = 0, constraints;
    uint32_t from = k->ids;
    bool rows_known = dt_touched_take(dt, &row, &rows);
    bool values_known = !k->values || dt_touched_take_values(dt, &value, &values);
    if (dt_touched_take_constraints(dt, &constraint, &constraints))
        altered_put(&k->altered, constraint, constraints);
    else
        altered_forget(&k->altered);
    dt_touched_begin(dt, k->values);
    k->version = k->set->version;
    k->ids = dt_next_id(dt);
    rows_known =
        rows_known && k->ids - from <= NEW_IDS && put_stamps(&k->row_stamps, row, rows, tick);
    for (uint32_t id = from; rows_known && id < k->ids; id++)
        rows_known = stamps_put(&k->row_stamps, id, tick);
    if (rows_known)
        recent_put(&k->recent, row, rows);
    else
        k->all_tick = tick;
    if (values_known && put_stamps(&k->value_stamps, value, values, tick))
        recent_put(&k->recent, value, values);
    else
        k->value_tick = tick;
    if (feed_line(k) > 0)
        k->line_tick = tick;
    recent_mark(&k->recent, k->version, k->ids, k->altered.end);
    list_move(&k->queue, &k->current);
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

/* Processor time of all reactors, as far as each has come when it is last called there: the time that others take on a
 * busy machine does not count. */
static int64_t processor_ns(struct server *s)
{
    static _Thread_local int64_t seen;
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    int64_t now = (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
    s->watching.processor_ns += now - seen;
    seen = now;
    return s->watching.processor_ns;
}

/* Whether the watchers of a set that is not being edited, or has credit, get events now. */
static bool is_due(struct watched *k, int64_t processor)
{
    credit_earn(&k->credit, processor, k->server->watching.loop->idle_ns);
    return k->credit.ns >= 0 || clock_ns() - k->changed_ns >= QUIET_NS;
}

/* Whether the next events are small ones. */
static bool is_small(const struct watched *k)
{
    const struct dt *dt = k->set->current->dt;
    int64_t keys = (int64_t)dt_touched_count(dt) + dt_next_id(dt) - k->ids;
    return list_is_empty(&k->queue) && keys * KEY_NS + (int64_t)k->watchers * SEND_NS <= SMALL_NS;
}

/* Watchers are served in order, as far as the time goes. Returns how many connections send their events later. */
static unsigned serve(struct watched *k, struct turn *t)
{
    unsigned later = 0;
    struct watcher *w;
    while (t->watchers > 0 && clock_ns() < t->end_ns && (w = list_pop(&k->queue)) != NULL) {
        w->blocked = !feed_can_take(w);
        if (w->blocked) { /* its connection says when it can (watch_resume) */
            w->session->conn.wants_room = true;
            list_append(&k->blocked, &w->link);
            continue;
        }
        t->watchers--;
        if (k->set == NULL) {
            feed_end(w);
            continue;
        }
        later += feed_serve(w);
        list_append(feed_lags(w) ? &k->queue : &k->current, &w->link);
    }
    if (list_is_empty(&k->queue))
        feed_free_texts(k);
    return later;
}

/* Whether the changes may be collected: no job has the set, and the triangulation is current. */
static bool is_ready(struct watched *k, bool changed)
{
    if (k->set->exclusive || !changed)
        return !k->set->exclusive;
    return k->watchers == 0 ? !version_is_stale(k->set->current) : refresh(k->server, k);
}

/* Collects changes; whether events may be made. */
static bool prepare(struct watched *k, int64_t processor)
{
    struct loop *loop = k->server->watching.loop;
    bool changed = k->version != k->set->version;
    if (!is_ready(k, changed))
        return false;
    bool due = is_due(k, processor) || (changed && is_small(k));
    if (changed && (due || dt_touched_count(k->set->current->dt) >= COLLECT_KEYS)) {
        k->retry_ms = 0;
        collect(k);
    }
    if (!due && k->watchers > 0)
        loop_at(loop, &k->due, loop->now_ms + WAKE_MS);
    return due;
}

/* Whether there is more to do in the next turn. */
static bool is_busy(const struct watched *k)
{
    return !list_is_empty(&k->queue) ||
           (k->set != NULL && k->watchers > 0 && k->version != k->set->version);
}

/* Does a part of the work. */
static void run(struct watched *k, struct turn *t)
{
    int64_t before = processor_ns(k->server);
    if (k->set == NULL || prepare(k, before)) {
        credit_spend(&k->credit, (int64_t)serve(k, t) * SEND_NS);
        if (!list_is_empty(&k->queue))
            continue_soon(k->server);
    }
    credit_spend(&k->credit, processor_ns(k->server) - before);
    count_memory(k);
}

/* ---- the end of a turn ---- */

static void free_watched(struct watched *k)
{
    list_remove(&k->link);
    list_remove(&k->busy);
    list_remove(&k->deserted);
    timer_clear(&k->due);
    recent_clear(&k->recent);
    altered_clear(&k->altered);
    stamps_clear(&k->row_stamps);
    stamps_clear(&k->value_stamps);
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
    free_watched(k);
}

static void look_at(struct watched *k, struct turn *t)
{
    if (is_busy(k) || (k->set != NULL && k->version != k->set->version))
        run(k, t);
    if (k->watchers == 0 && k->set == NULL) {
        forget(k);
        return;
    }
    if (k->watchers == 0)
        desert(k, clock_ms());
    if (is_busy(k))
        call(k);
}

/* Forgets sets whose last watcher left long ago. While a worker notes what an edit touches, it stays. */
static void forget_deserted(struct server *s)
{
    enum { MOST = 256 }; /* some microseconds each */
    struct watched *k = first_deserted(s);
    int64_t now = k == NULL ? 0 : clock_ms();
    for (int i = 0; i < MOST && k != NULL && now - k->deserted_ms >= KEEP_MS; i++) {
        list_remove(&k->deserted);
        if (k->set != NULL && k->set->exclusive)
            desert(k, now);
        else
            forget(k);
        k = first_deserted(s);
    }
}

void watch_turn_end(struct server *s)
{
    struct list *now = &s->watching.now;
    list_move(now, &s->watching.busy);
    struct turn t = {.watchers = WATCH_TURN};
    t.end_ns = list_is_empty(now) ? 0 : clock_ns() + TURN_NS;
    for (void *link; (link = list_pop(now)) != NULL;) {
        look_at(list_owner(link, offsetof(struct watched, busy)), &t);
        if (t.watchers == 0 || clock_ns() >= t.end_ns)
            break;
    }
    if (!list_is_empty(now))
        continue_soon(s);
    forget_deserted(s);
}

void watch_clear(struct server *s)
{
    for (struct watched *k; (k = list_first(&s->watching.all)) != NULL;)
        free_watched(k);
}

/* ---- who watches ---- */

static struct watched *watched_of(struct server *s, struct dataset *set)
{
    struct watched *k = set->watched;
    if (k != NULL || (k = calloc(1, sizeof *k)) == NULL)
        return k;
    memcpy(k->name, set->name, set->name_len);
    k->server = s;
    k->set = set;
    k->version = set->version;
    k->ids = dt_next_id(set->current->dt);
    k->credit = (struct credit){.ns = CREDIT_MOST, .processor = processor_ns(s)};
    k->due.run = wake;
    k->memory = server_reservation(s, BUDGET_CLIENTS);
    dt_touched_begin(set->current->dt, false);
    recent_restart(&k->recent, k->version, k->ids, k->altered.end);
    list_append(&s->watching.all, &k->link);
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

/* From now on edits note whose values they change. */
static void collect_values(struct watched *k)
{
    if (k->values)
        return;
    k->values = true;
    k->value_tick = feed_tick(k) + (k->version != k->set->version);
    if (!k->set->exclusive) /* otherwise the next change is one of everything */
        dt_touched_begin(k->set->current->dt, true);
}

bool watch_begin(struct server *s, struct session *who, struct dataset *set, struct scope *scope,
                 uint64_t since)
{
    struct watcher *w = calloc(1, sizeof *w);
    struct watched *k = w == NULL ? NULL : watched_of(s, set);
    s->watching.loop = &s->reactor->loop;
    if (k != NULL)
        watch_end(who, set);
    struct feed *f = k == NULL ? NULL : feed_enter(k, scope);
    if (f == NULL) {
        if (k != NULL)
            call(k); /* it may have no watchers */
        scope_clear(scope);
        free(w);
        return false;
    }
    if (f->scope.names != NULL)
        collect_values(k);
    *w =
        (struct watcher){.feed = f, .session = who, .typed = who->resp, .at = feed_since(f, since)};
    list_append(&who->watching, &w->also);
    who->watches++;
    s->count.watchers++;
    k->watchers++;
    list_append(feed_lags(w) ? &k->queue : &k->current, &w->link);
    count_memory(k);
    list_remove(&k->deserted);
    call(k);
    /* A triangulation that was left for later will be a change of everything. */
    if (version_is_stale(set->current))
        k->version = 0;
    return true;
}

static void leave(struct watcher *w)
{
    call(w->feed->of); /* there may be no other */
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
    for (struct watcher *w = first_of(who); w != NULL; w = next_of(who, w)) {
        if (!w->blocked)
            continue;
        w->blocked = false;
        list_remove(&w->link);
        list_append(&w->feed->of->queue, &w->link);
        call(w->feed->of);
    }
}

void watch_changed(struct dataset *set)
{
    set->watched->changed_ns = clock_ns();
    call(set->watched);
}

void watch_dropped(struct dataset *set)
{
    struct watched *k = set->watched;
    list_move(&k->queue, &k->current);
    k->set = NULL;
    call(k);
}
