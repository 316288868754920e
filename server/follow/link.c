/* link.c - see link.h. */
#include "server/follow/link.h"

#include "server/follow/consent.h"
#include "server/follow/incoming.h"
#include "server/system/loop.h"
#include "server/system/notice.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    READ_BYTES = 256 * 1024,
    QUEUE_BYTES = 4 << 20,  /* of pieces that are not taken yet: then nothing is received */
    SILENCE_MS = 10 * 1000, /* without a byte from the leader, which sends something every second */
    PATIENCE_MS = 600 * 1000, /* the same before its first header: it may be writing a snapshot */
    LAST_PAUSE_MS = 3 * 1000,
    LAST_TRANSFER_PAUSE_MS = 30 * 1000 /* for example, of a snapshot to a disk that is full */
};

/* A connection. */
struct wire {
    struct link *l;
    int fd;
    struct incoming incoming;
    uint64_t acked, acked_bytes; /* what the leader knows */
    int64_t log_since_ms;        /* since when it sends its log; 0: it does not */
    int64_t heard_ms;
};

static void notify(const struct link *l)
{
    eventfd_write(l->event, 1);
}

static void set_state(struct link *l, enum link_state state, const char *why)
{
    char leader[ROLE_TEXT];
    role_write_address(leader, l->host, l->dial.port);
    pthread_mutex_lock(&l->mutex);
    bool news = why[0] != '\0' && strcmp(l->noted, why) != 0;
    l->state = state;
    snprintf(l->why, sizeof l->why, "%s", why);
    if (news)
        snprintf(l->noted, sizeof l->noted, "%s", why);
    pthread_mutex_unlock(&l->mutex);
    if (news)
        notice(state == LINK_REFUSED ? NOTICE_ERROR : NOTICE_WARNING, "following %s: %s", leader,
               why);
    notify(l);
}

/* ---- sending ---- */

static bool acknowledge(struct wire *w)
{
    char line[64];
    if (w->log_since_ms == 0)
        return true;
    pthread_mutex_lock(&w->l->mutex);
    uint64_t lsn = w->l->acked, bytes = w->l->acked_bytes;
    bool works = w->l->works;
    w->l->works = false;
    pthread_mutex_unlock(&w->l->mutex);
    if (lsn <= w->acked && bytes <= w->acked_bytes && !works)
        return true;
    w->acked = lsn;
    w->acked_bytes = bytes;
    int n = snprintf(line, sizeof line, "ACK %" PRIu64 " %" PRIu64 "\n", lsn, bytes);
    return dial_send(&w->l->dial, w->fd, line, (size_t)n);
}

/* ---- receiving ---- */

/* Receives more bytes. False: the connection has ended. */
static bool hear(struct wire *w)
{
    char *to = buf_reserve(&w->incoming.in, READ_BYTES);
    if (to == NULL)
        return false;
    for (;;) {
        ssize_t n = recv(w->fd, to, READ_BYTES, MSG_DONTWAIT);
        if (n > 0) {
            buf_commit(&w->incoming.in, (size_t)n);
            w->heard_ms = clock_ms();
            return true;
        }
        if (n == 0 || (errno != EAGAIN && errno != EINTR))
            return false;
        bool begun = w->log_since_ms != 0 || w->incoming.in_snapshot;
        if (clock_ms() - w->heard_ms > (begun ? SILENCE_MS : PATIENCE_MS) ||
            !dial_wait(&w->l->dial, w->fd, POLLIN, 1000) || !acknowledge(w))
            return false;
    }
}

/* ---- connecting ---- */

/* Waits for the position to continue from. */
static bool ask_position(struct link *l, struct position *from)
{
    pthread_mutex_lock(&l->mutex);
    l->acked = l->acked_bytes = 0;
    l->wants_position = true;
    pthread_mutex_unlock(&l->mutex);
    notify(l);
    for (bool wants = true; wants;) {
        pthread_mutex_lock(&l->mutex);
        wants = l->wants_position;
        *from = l->from;
        pthread_mutex_unlock(&l->mutex);
        if (wants && !dial_wait(&l->dial, -1, 0, 1000))
            return false;
    }
    return true;
}

/* Asks the leader to continue from this position. */
static bool greet(struct wire *w, const struct position *from)
{
    struct link *l = w->l;
    char line[DIAL_LINE];
    struct position asked = *from;
    if (l->confirmed || from->lsn == 0)
        asked.lsn = asked.digest = 0;
    if (!dial_sync(&l->dial, w->fd, &asked, &w->incoming.in, line)) {
        if (line[0] != '\0')
            set_state(l, LINK_CONNECTING, line);
        return false;
    }
    w->heard_ms = clock_ms();
    char why[LINK_WHY];
    struct asker here = {.at = *from, .own = l->own, .confirmed = l->confirmed};
    enum consent consent = consent_to(&here, line, why, sizeof why);
    if (consent != CONSENT_GIVEN)
        set_state(l, consent == CONSENT_REFUSED ? LINK_REFUSED : LINK_CONNECTING, why);
    return consent == CONSENT_GIVEN;
}

/* ---- the stream ---- */

/* Passes bytes on to a reactor, when there is room. */
static bool pass_on(void *ctx, const char *bytes, size_t n)
{
    struct wire *w = ctx;
    struct link *l = w->l;
    struct link_piece *p = calloc(1, sizeof *p);
    if (p != NULL)
        buf_append(&p->bytes, bytes, n);
    if (p == NULL || p->bytes.failed) {
        link_piece_free(p);
        return false;
    }
    p->end = w->incoming.taken;
    for (bool room = false; !room;) {
        pthread_mutex_lock(&l->mutex);
        room = l->queued.bytes < READ_BYTES + QUEUE_BYTES;
        if (room) {
            list_append(&l->pieces, &p->link);
            reservation_set(&l->queued, l->queued.bytes + n);
        }
        pthread_mutex_unlock(&l->mutex);
        if (!room && (!dial_wait(&l->dial, -1, 0, 1000) || !acknowledge(w))) {
            link_piece_free(p);
            return false;
        }
    }
    notify(l);
    return true;
}

/* The sets of a snapshot that has been read. */
struct arrived {
    struct registry *sets;
    struct budget *budget;
    bool lacks; /* memory for a triangulation */
};

/* Triangulates a set that is to have a triangulation, as long as no request waits for it, and counts its memory. */
static void complete(struct dataset *set, void *ctx)
{
    struct arrived *a = ctx;
    struct dt_options options = {.cancel = NULL};
    struct reservation memory = {.budget = a->budget, .kind = BUDGET_BUILDS};
    size_t bytes = set->triangulated ? dt_build_memory(set->current->dt, &options) : 0;
    a->lacks = a->lacks || !reservation_resize(&memory, bytes);
    if (set->triangulated && !a->lacks)
        dt_triangulate(set->current->dt, &options); /* out of memory: a query tries it again */
    version_update(a->sets, set->current);
    reservation_set(&memory, 0);
}

/* The next connection is to come later, and later each time. */
static bool fail_transfer(struct link *l, const char *why)
{
    set_state(l, LINK_CONNECTING, why);
    pthread_mutex_lock(&l->mutex);
    l->repeats = true;
    pthread_mutex_unlock(&l->mutex);
    return false;
}

static const char no_room[] =
    "no room in --max-memory for its snapshot beside the sets here: raise it, "
    "or start with an empty data directory";

/* Reads the snapshot, and triangulates its sets. */
static bool read_arrival(struct link *l, struct link_arrival *a)
{
    struct recovery *r = &a->recovery;
    recovery_init(r, &a->dir);
    r->replay.sets.pages = l->pages;
    r->replay.sets.budget = l->budget;
    recovery_run(r);
    if (r->result != RECOVERY_OK)
        return fail_transfer(l, r->replay.out_of_memory ? no_room : r->why);
    struct arrived arrived = {.sets = &r->replay.sets, .budget = l->budget};
    registry_each(&r->replay.sets, complete, &arrived);
    return !arrived.lacks || fail_transfer(l, no_room);
}

/* The snapshot is complete: it is read, and then a reactor replaces everything by it. */
static bool install(void *ctx, struct aside *aside, const struct segment *header)
{
    struct wire *w = ctx;
    struct link *l = w->l;
    struct link_arrival *a = calloc(1, sizeof *a);
    if (a == NULL || !aside_complete(aside, header, &a->dir)) {
        free(a);
        return fail_transfer(l, incoming_disk_fault(errno));
    }
    if (!read_arrival(l, a)) {
        recovery_clear(&a->recovery);
        aside_close(&a->dir);
        free(a);
        return false;
    }
    pthread_mutex_lock(&l->mutex);
    l->arrival = a;
    pthread_mutex_unlock(&l->mutex);
    notify(l);
    for (bool done = false; !done && !l->dial.stop;) {
        pthread_mutex_lock(&l->mutex);
        done = l->arrival == NULL;
        pthread_mutex_unlock(&l->mutex);
        if (!done)
            dial_wait(&l->dial, -1, 0, 1000);
    }
    w->heard_ms = clock_ms();
    l->confirmed = false;
    set_state(l, LINK_RECEIVING, "");
    return !l->dial.stop;
}

static bool note_header(void *ctx, const struct segment *h)
{
    struct wire *w = ctx;
    if (h->kind != SEGMENT_LOG) {
        w->log_since_ms = 0;
        set_state(w->l, LINK_LOADING, "");
        return true;
    }
    if (w->log_since_ms == 0)
        w->log_since_ms = clock_ms();
    pthread_mutex_lock(&w->l->mutex);
    if (h->lsn > w->l->leader_lsn + 1)
        w->l->leader_lsn = h->lsn - 1;
    pthread_mutex_unlock(&w->l->mutex);
    return true;
}

/* Says that there is no connection any more, unless there is a reason that says more. */
static void note_end(struct link *l)
{
    pthread_mutex_lock(&l->mutex);
    bool said = l->state != LINK_RECEIVING && l->state != LINK_LOADING;
    pthread_mutex_unlock(&l->mutex);
    if (!said && !l->dial.stop)
        set_state(l, LINK_CONNECTING, "disconnected");
}

static void receive(struct wire *w)
{
    static const struct incoming_calls calls = {note_header, pass_on, install};
    w->incoming.calls = &calls;
    w->incoming.ctx = w;
    w->incoming.dir = w->l->dir;
    set_state(w->l, LINK_RECEIVING, "");
    while (incoming_take(&w->incoming) && hear(w) && acknowledge(w))
        ;
    if (w->incoming.disk_failed)
        fail_transfer(w->l, w->incoming.why);
    else if (w->incoming.why[0] != '\0')
        set_state(w->l, LINK_CONNECTING, w->incoming.why);
    note_end(w->l);
}

/* ---- the thread ---- */

/* One connection. Returns for how many milliseconds it has received the log. */
static int64_t converse(struct link *l)
{
    struct wire w = {.l = l, .fd = -1, .heard_ms = clock_ms()};
    struct position from;
    if (!ask_position(l, &from))
        return 0;
    w.fd = dial_connect(&l->dial);
    if (w.fd < 0) {
        char why[80];
        snprintf(why, sizeof why, "no connection: %s", strerror(errno));
        set_state(l, LINK_CONNECTING, why);
        return 0;
    }
    if (greet(&w, &from))
        receive(&w);
    incoming_clear(&w.incoming);
    close(w.fd);
    return w.log_since_ms != 0 ? clock_ms() - w.log_since_ms : 0;
}

int link_pause(int before, bool repeats, int64_t lasted_ms)
{
    int most = repeats ? LAST_TRANSFER_PAUSE_MS : LAST_PAUSE_MS;
    if (lasted_ms > LAST_PAUSE_MS && lasted_ms > 2 * (int64_t)before)
        return LINK_FIRST_PAUSE_MS;
    return before * 2 < most ? before * 2 : most;
}

/* The pause after a connection that has received the log for that long; `before` was the one before it. */
static int next_pause(struct link *l, int before, int64_t lasted_ms)
{
    pthread_mutex_lock(&l->mutex);
    int pause = link_pause(before, l->repeats, lasted_ms);
    l->repeats = false;
    if (pause == LINK_FIRST_PAUSE_MS)
        l->noted[0] = '\0';
    pthread_mutex_unlock(&l->mutex);
    return pause;
}

static void *serve(void *arg)
{
    struct link *l = arg;
    int pause = LINK_FIRST_PAUSE_MS / 2;
    while (!l->dial.stop) {
        l->dial.again = false;
        pause = next_pause(l, pause, converse(l));
        for (int64_t until = clock_ms() + pause; !l->dial.stop && clock_ms() < until;) {
            l->dial.again = false;
            dial_wait(&l->dial, -1, 0, (int)(until - clock_ms()) + 1);
        }
    }
    return NULL;
}

bool link_start(struct link *l)
{
    l->dial.host = l->host;
    l->dial.patience_ms = PATIENCE_MS;
    l->queued = (struct reservation){.budget = l->budget, .kind = BUDGET_LOG};
    if (!dial_init(&l->dial))
        return false;
    pthread_mutex_init(&l->mutex, NULL);
    reservation_set(&l->queued, READ_BYTES);
    int error = pthread_create(&l->thread, NULL, serve, l);
    if (error == 0)
        return true;
    reservation_set(&l->queued, 0);
    pthread_mutex_destroy(&l->mutex);
    dial_clear(&l->dial);
    errno = error;
    return false;
}

void link_end(struct link *l)
{
    dial_stop(&l->dial);
    pthread_join(l->thread, NULL);
    for (struct link_piece *p; (p = link_take(l)) != NULL;)
        link_piece_free(p);
    if (l->arrival != NULL) {
        recovery_clear(&l->arrival->recovery);
        aside_close(&l->arrival->dir);
        free(l->arrival);
    }
    reservation_set(&l->queued, 0);
    pthread_mutex_destroy(&l->mutex);
    dial_clear(&l->dial);
    free(l);
}

/* ---- on a reactor ---- */

bool link_wants_position(struct link *l)
{
    pthread_mutex_lock(&l->mutex);
    bool wants = l->wants_position && list_is_empty(&l->pieces);
    pthread_mutex_unlock(&l->mutex);
    return wants;
}

void link_go(struct link *l, const struct position *from)
{
    pthread_mutex_lock(&l->mutex);
    l->from = *from;
    l->wants_position = false;
    pthread_mutex_unlock(&l->mutex);
    dial_wake(&l->dial);
}

struct link_piece *link_take(struct link *l)
{
    pthread_mutex_lock(&l->mutex);
    struct link_piece *p = list_pop(&l->pieces);
    if (p != NULL)
        reservation_set(&l->queued, l->queued.bytes - buf_len(&p->bytes));
    pthread_mutex_unlock(&l->mutex);
    if (p != NULL)
        dial_wake(&l->dial);
    return p;
}

void link_piece_free(struct link_piece *p)
{
    if (p != NULL)
        buf_free(&p->bytes);
    free(p);
}

struct link_arrival *link_arrival(struct link *l)
{
    pthread_mutex_lock(&l->mutex);
    struct link_arrival *a = l->arrival;
    pthread_mutex_unlock(&l->mutex);
    return a;
}

void link_installed(struct link *l, uint64_t lsn)
{
    pthread_mutex_lock(&l->mutex);
    l->acked = lsn;
    l->arrival = NULL;
    pthread_mutex_unlock(&l->mutex);
    dial_wake(&l->dial);
}

void link_acknowledge(struct link *l, uint64_t lsn, uint64_t bytes)
{
    pthread_mutex_lock(&l->mutex);
    l->acked = lsn;
    if (bytes != 0)
        l->acked_bytes = bytes;
    pthread_mutex_unlock(&l->mutex);
    dial_wake(&l->dial);
}

void link_works(struct link *l)
{
    pthread_mutex_lock(&l->mutex);
    l->works = true;
    pthread_mutex_unlock(&l->mutex);
    dial_wake(&l->dial);
}

void link_again(struct link *l, const char *why)
{
    fail_transfer(l, why);
    l->dial.again = true;
    dial_wake(&l->dial);
}
