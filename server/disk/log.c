/* log.c - the queue between reactors and the log thread, and the loop of that thread; files are in
 * log_file.c. One mutex guards the queue and the status; nothing slow is done under it. */
#include "server/disk/log.h"

#include "core/delaunay.h"
#include "server/disk/log_file.h"
#include "server/system/list.h"
#include "server/system/loop.h"
#include "server/system/notice.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum {
    SYNC_EVERY_MS = 1000,
    GATHER_LIMIT_NS = 2 * 1000 * 1000, /* how long a sync may wait for more records */
    PIECE_FULL = 32 * 1024,            /* bytes of small records after which a new piece begins */
    MUCH = 1 << 20 /* bytes whose end in the queue is reported before the sync */
};

enum piece_kind { PIECE_BYTES, PIECE_LOAD, PIECE_ROTATE, PIECE_TEND };

/* An element of the queue: many small records, the items of a large one, or a command. */
struct piece {
    struct list_link link; /* first */
    enum piece_kind kind;
    unsigned records;
    uint64_t last;           /* the lsn of its last record */
    size_t size;             /* bytes of memory */
    struct lineage *lineage; /* owns; PIECE_ROTATE: from now on; NULL: the same */
    uint32_t version;        /* PIECE_ROTATE: of a segment that the log begins by itself; or 0 */
    struct buf bytes;        /* owns; PIECE_BYTES: encoded records */
    void *items;             /* owns; PIECE_LOAD: as many as its record says */
    struct columns *values;  /* owns; PIECE_LOAD: those that come with the points, or NULL */
    struct pslg_lists lists; /* owns; PIECE_LOAD: constraints that come with the points */
    struct record record; /* PIECE_LOAD: the first, of the type of its parts; its name is `name` */
    char name[RECORD_NAME_LIMIT];
};

struct queue {
    struct list pieces;
    unsigned records;
};

struct log {
    bool unmarked;          /* no RECORD_CLOSE at the end */
    atomic_size_t appended; /* bytes of all pieces so far */
    atomic_size_t freed;    /* bytes of the pieces that have been freed */
    _Atomic uint64_t synced;
    _Atomic uint64_t next; /* the lsn of the next record; changed under the mutex */
    /* under the mutex */
    pthread_mutex_t mutex;
    pthread_cond_t wake;
    struct queue queue;
    bool pushed;      /* the thread is to write the queue */
    uint32_t version; /* of the segment that the next record is in */
    struct log_status status;
    uint64_t resume;        /* not 0: the argument of log_resume, plus 1, */
    uint64_t resume_digest; /* and the other one */
    uint64_t broken;        /* a record up to this lsn is missing from the queue; 0: none */
    bool stopping;
    /* the log thread's */
    struct log_file file;
    uint64_t rotated, rotated_digest; /* as in log_status */
    enum log_policy policy;
    int event;
    int64_t synced_ms, sync_ns;
    unsigned expected; /* records that will probably be appended before the next sync */
    pthread_t thread;
};

/* ---- reactors ---- */

/* Moves everything to the end of another queue. */
static void move(struct queue *to, struct queue *from)
{
    list_move(&to->pieces, &from->pieces);
    to->records += from->records;
    from->records = 0;
}

/* A record up to the last one is missing: out of memory. */
static void lose(struct log *log)
{
    log->broken = log->next - 1;
}

/* A new piece at the end of the queue; NULL: out of memory. */
static struct piece *new_piece(struct log *log, enum piece_kind kind)
{
    struct piece *p = calloc(1, sizeof *p);
    if (p == NULL)
        return NULL;
    p->kind = kind;
    p->last = log->next - 1;
    list_append(&log->queue.pieces, &p->link);
    return p;
}

/* Records that a piece takes `size` bytes now. */
static void measure(struct log *log, struct piece *p, size_t size)
{
    if (size != p->size)
        log->appended += size - p->size;
    p->size = size;
}

static void free_piece(struct log *log, struct piece *p)
{
    atomic_fetch_add(&log->freed, p->size);
    buf_free(&p->bytes);
    dt_pages_release(p->items);
    columns_free(p->values);
    pslg_lists_clear(&p->lists);
    free(p->lineage);
    free(p);
}

/* A record of a type that the segment's version does not have begins another segment. */
static void begin_version(struct log *log, enum record_type type)
{
    uint32_t version = record_version(type);
    if (version <= log->version)
        return;
    struct piece *p = new_piece(log, PIECE_ROTATE);
    if (p != NULL)
        log->version = p->version = version;
    else
        log->broken = log->next; /* the record that is to be appended */
}

/* The piece for one more small record, which has the last lsn; NULL: out of memory. */
static struct piece *open_piece(struct log *log, enum record_type type)
{
    begin_version(log, type);
    struct piece *p = list_last(&log->queue.pieces);
    log->next++;
    if (p == NULL || p->kind != PIECE_BYTES || buf_len(&p->bytes) >= PIECE_FULL)
        p = new_piece(log, PIECE_BYTES);
    if (p == NULL)
        lose(log);
    return p;
}

/* The record has been appended to the piece. */
static void end_append(struct log *log, struct piece *p)
{
    measure(log, p, p->bytes.cap);
    if (p->bytes.failed)
        lose(log);
    p->last = log->next - 1;
    p->records++;
    log->queue.records++;
}

uint64_t log_append(struct log *log, struct record *r)
{
    pthread_mutex_lock(&log->mutex);
    r->lsn = log->next;
    r->synced = atomic_load(&log->synced);
    struct piece *p = open_piece(log, r->type);
    if (p != NULL) {
        record_write(&p->bytes, r);
        end_append(log, p);
    }
    pthread_mutex_unlock(&log->mutex);
    return r->lsn;
}

/* No segment begins between the records, since a LOAD does not continue in another one. */
uint64_t log_append_copy(struct log *log, const char *bytes, size_t n)
{
    pthread_mutex_lock(&log->mutex);
    for (size_t at = 0; at < n; at += RECORD_HEADER + record_outline(bytes + at).length)
        begin_version(log, (enum record_type)record_outline(bytes + at).type);
    for (size_t at = 0, length; at < n; at += length) {
        struct record_outline r = record_outline(bytes + at);
        struct piece *p = open_piece(log, (enum record_type)r.type);
        length = RECORD_HEADER + r.length;
        if (p == NULL)
            continue;
        record_copy(&p->bytes, bytes + at, length, atomic_load(&log->synced));
        end_append(log, p);
    }
    uint64_t last = log->next - 1;
    pthread_mutex_unlock(&log->mutex);
    return last;
}

/* Gives the piece the items, the values and the constraints. */
static void take_load(struct log *log, struct piece *p, const struct record *r, void *items,
                      struct columns *v, const struct pslg_lists *d)
{
    memcpy(p->name, r->name, r->name_len);
    p->record = *r;
    p->record.name = p->name;
    p->items = items;
    p->values = v;
    p->lists = *d;
    measure(log, p,
            r->n * record_item_size(r->type) + (v == NULL ? 0 : v->count * v->n) * sizeof *v->v +
                (d->n_released + (size_t)d->n_added) * sizeof *d->added);
    p->last = log->next - 1;
    p->records = 1;
    log->queue.records++;
}

uint64_t log_append_load(struct log *log, struct record *r, void *items, struct columns *v,
                         struct pslg_lists *d)
{
    struct pslg_lists lists = d == NULL ? (struct pslg_lists){0} : *d;
    pthread_mutex_lock(&log->mutex);
    begin_version(log, pslg_lists_records(&lists) > 0 ? RECORD_CONSTRAIN : r->type);
    struct piece *p = new_piece(log, PIECE_LOAD);
    r->lsn = log->next;
    r->synced = atomic_load(&log->synced);
    log->next += 2 + record_parts(r->type, r->n) + columns_records(v) + pslg_lists_records(&lists);
    uint64_t last = log->next - 1;
    if (p != NULL)
        take_load(log, p, r, items, v, &lists);
    else
        lose(log);
    pthread_mutex_unlock(&log->mutex);
    if (p == NULL) {
        dt_pages_release(items);
        columns_free(v);
        pslg_lists_clear(&lists);
    }
    if (d != NULL)
        d->released = d->added = NULL; /* their numbers remain */
    return last;
}

void log_fill(struct log *log, uint64_t lsn)
{
    struct record nothing = {.type = RECORD_CLOSE};
    while (log->next <= lsn)
        log_append(log, &nothing);
    log_push(log);
}

/* The mutex is held. */
static void push(struct log *log)
{
    log->pushed = true;
    pthread_cond_signal(&log->wake);
}

void log_push(struct log *log)
{
    pthread_mutex_lock(&log->mutex);
    if (!log->pushed && (!list_is_empty(&log->queue.pieces) || log->broken != 0))
        push(log);
    pthread_mutex_unlock(&log->mutex);
}

size_t log_queued(const struct log *log)
{
    size_t freed =
        atomic_load(&log->freed); /* first: it is never more than what has been appended */
    return log->appended - freed;
}

uint64_t log_last(const struct log *log)
{
    return log->next - 1;
}

uint64_t log_rotate(struct log *log, const struct lineage *l)
{
    struct lineage *copy = l != NULL ? malloc(sizeof *copy) : NULL;
    if (copy != NULL)
        *copy = *l;
    pthread_mutex_lock(&log->mutex);
    struct piece *p = new_piece(log, PIECE_ROTATE);
    uint64_t last = log->next - 1;
    if (p == NULL || (l != NULL && copy == NULL))
        lose(log);
    if (p != NULL)
        p->lineage = copy;
    push(log);
    pthread_mutex_unlock(&log->mutex);
    if (p == NULL)
        free(copy);
    return last;
}

void log_tend(struct log *log)
{
    pthread_mutex_lock(&log->mutex);
    (void)new_piece(log, PIECE_TEND); /* out of memory: another one comes in a second */
    push(log);
    pthread_mutex_unlock(&log->mutex);
}

void log_resume(struct log *log, uint64_t lsn, uint64_t digest)
{
    pthread_mutex_lock(&log->mutex);
    log->resume = lsn + 1;
    log->resume_digest = digest;
    push(log);
    pthread_mutex_unlock(&log->mutex);
}

void log_status(struct log *log, struct log_status *status)
{
    pthread_mutex_lock(&log->mutex);
    *status = log->status;
    pthread_mutex_unlock(&log->mutex);
}

/* ---- the log thread ---- */

static void notify(struct log *log)
{
    /* If the counter is full, a reactor has a notification that it has not read yet. */
    eventfd_write(log->event, 1);
}

/* From now on segments have the piece's lineage and version, if it has them. */
static void take_header(struct log_file *f, const struct piece *p)
{
    if (p->lineage != NULL)
        f->lineage = *p->lineage;
    if (p->version > f->version)
        f->version = p->version;
    f->renamed |= p->lineage != NULL || p->version > 0;
}

static void rotate(struct log *log, const struct piece *p)
{
    take_header(&log->file, p);
    log_file_start(&log->file, p->last + 1);
    if (p->version > 0 || log->file.error != 0)
        return;
    log->rotated = log->file.first;
    log->rotated_digest = log->file.digest_before;
}

static void carry_out(struct log *log, struct piece *p)
{
    switch (p->kind) {
    case PIECE_BYTES:
        log_file_write(&log->file, &p->bytes);
        break;
    case PIECE_LOAD:
        log_file_write_load(&log->file, &p->record, p->items, p->values, &p->lists);
        break;
    case PIECE_ROTATE:
        rotate(log, p);
        break;
    case PIECE_TEND:
        log_file_reserve(&log->file);
        break;
    }
}

/* Writes the pieces of a list and frees them. After a failure the rest is only freed: a snapshot will have those
 * changes. Returns the last lsn. */
static uint64_t write_pieces(struct log *log, struct list *pieces, uint64_t last)
{
    log_file_mark(&log->file);
    for (struct piece *p; (p = list_pop(pieces)) != NULL;) {
        if (log->file.error == 0)
            carry_out(log, p);
        else
            take_header(&log->file, p);
        if (p->last > last)
            last = p->last;
        free_piece(log, p);
    }
    return last;
}

static void sync_file(struct log *log)
{
    int64_t start = clock_ns();
    log_file_sync(&log->file);
    log->sync_ns = clock_ns() - start;
    log->synced_ms = (start + log->sync_ns) / 1000000;
}

static bool sync_is_due(const struct log *log)
{
    return log->policy == LOG_EVERYSEC && log->file.unsynced &&
           clock_ms() - log->synced_ms >= SYNC_EVERY_MS;
}

static void wait_until(struct log *log, int64_t ns)
{
    struct timespec t = {ns / 1000000000, ns % 1000000000};
    pthread_cond_timedwait(&log->wake, &log->mutex, &t);
}

/* Clients whose replies have just been released send their next edits at once. A sync before that would split the
 * clients into two groups, each at half the rate. So it waits for log->expected records, at most a fraction of its duration. */
static void gather(struct log *log)
{
    int64_t patience = log->sync_ns / 4;
    int64_t until = clock_ns() + (patience < GATHER_LIMIT_NS ? patience : GATHER_LIMIT_NS);
    if (log->policy != LOG_ALWAYS)
        return;
    while (log->queue.records < log->expected && !log->stopping && clock_ns() < until)
        wait_until(log, until);
}

/* Publishes the state of the file. The mutex is held. */
static void publish(struct log *log, uint64_t last, unsigned records)
{
    struct log_status *st = &log->status;
    const struct log_file *f = &log->file;
    if (f->error != 0) {
        st->state = LOG_FAILED;
        st->error = f->error;
        st->failures++;
        notice_error("the log cannot be written: %s", datadir_error(f->error));
    } else {
        st->state = f->reserved ? LOG_GOOD : LOG_FULL;
        st->error = f->reserved ? 0 : f->full_error;
        st->durable = last;
        st->digest = f->digest;
        if (!f->unsynced) {
            st->synced = last;
            atomic_store(&log->synced, last);
        }
    }
    st->segment = f->first;
    st->rotated = log->rotated;
    st->rotated_digest = log->rotated_digest;
    st->bytes = f->bytes;
    st->total = f->before + f->bytes;
    st->syncs = f->syncs;
    log->expected = records + log->queue.records;
    notify(log);
}

/* One turn without a failure before it. The mutex is held on entry and on return, not in between. */
static void write_queue(struct log *log, bool sync)
{
    struct queue q = {.records = 0};
    uint64_t last = log->status.durable;
    move(&q, &log->queue);
    log->pushed = false;
    bool broken = log->broken != 0;
    pthread_mutex_unlock(&log->mutex);
    if (broken)
        log_file_fail(&log->file, ENOMEM);
    size_t before = atomic_load(&log->freed);
    last = write_pieces(log, &q.pieces, last);
    if (atomic_load(&log->freed) - before >= MUCH) /* there is room before the sync ends */
        notify(log);
    if (sync || log->policy == LOG_ALWAYS || sync_is_due(log))
        sync_file(log);
    log_file_inspect(&log->file, clock_ms());
    pthread_mutex_lock(&log->mutex);
    publish(log, last, q.records);
}

/* Drops the records that the snapshot contains, and continues with the rest. */
static void resume(struct log *log)
{
    uint64_t first = log->resume, digest = log->resume_digest;
    struct queue q = {.records = 0};
    struct list keep = {0};
    log->resume = 0;
    bool broken = log->broken >= first;
    log->broken = broken ? log->broken : 0;
    move(&q, &log->queue);
    log->pushed = false;
    pthread_mutex_unlock(&log->mutex);
    for (struct piece *p; (p = list_pop(&q.pieces)) != NULL;) {
        if (p->last < first || p->kind == PIECE_ROTATE) {
            take_header(&log->file, p);
            free_piece(log, p);
        } else
            list_append(&keep, &p->link);
    }
    if (broken)
        log_file_fail(&log->file, ENOMEM);
    else
        log_file_restart(&log->file, first, digest);
    if (log->file.error == 0)
        log_file_reserve(&log->file);
    uint64_t last = write_pieces(log, &keep, first - 1);
    sync_file(log);
    pthread_mutex_lock(&log->mutex);
    publish(log, last, 0);
}

static void *serve(void *arg)
{
    struct log *log = arg;
    pthread_mutex_lock(&log->mutex);
    for (;;) {
        bool failed = log->status.state == LOG_FAILED;
        if (failed && log->resume != 0)
            resume(log);
        else if (!failed && log->pushed) {
            log->pushed = false; /* so that who pushes more ends the waiting */
            gather(log);
            write_queue(log, false);
        } else if (!failed && (sync_is_due(log) || (log->stopping && log->file.unsynced))) {
            write_queue(log, true);
        } else if (log->stopping) {
            break;
        } else if (log->policy == LOG_EVERYSEC && log->file.unsynced) {
            wait_until(log, (log->synced_ms + SYNC_EVERY_MS) * 1000000);
        } else {
            pthread_cond_wait(&log->wake, &log->mutex);
        }
    }
    pthread_mutex_unlock(&log->mutex);
    return NULL;
}

/* ---- life ---- */

static bool start_thread(struct log *log)
{
    pthread_condattr_t attr;
    pthread_condattr_init(&attr);
    pthread_condattr_setclock(&attr, CLOCK_MONOTONIC);
    pthread_mutex_init(&log->mutex, NULL);
    pthread_cond_init(&log->wake, &attr);
    pthread_condattr_destroy(&attr);
    return pthread_create(&log->thread, NULL, serve, log) == 0;
}

struct log *log_new(const struct datadir *dir, enum log_policy policy, uint64_t first,
                    uint64_t digest, int event)
{
    struct log *log = calloc(1, sizeof *log);
    if (log == NULL) {
        notice_error("out of memory");
        return NULL;
    }
    log->next = first;
    log->version = RECORD_VERSION_PLAIN;
    log->policy = policy;
    log->event = event;
    log->synced = first - 1;
    log->status.durable = log->status.synced = first - 1;
    log_file_init(&log->file, dir, digest);
    log_file_start(&log->file, first);
    if (log->file.error != 0) {
        notice_error("cannot write in %s: %s", dir->path, strerror(log->file.error));
        free(log);
        return NULL;
    }
    log_file_reserve(&log->file);
    log->synced_ms = clock_ms();
    log->status.segment = log->status.rotated = log->rotated = first;
    log->status.digest = log->status.rotated_digest = log->rotated_digest = log->file.digest;
    log->status.bytes = log->status.total = log->file.bytes;
    log->status.state = log->file.reserved ? LOG_GOOD : LOG_FULL;
    log->status.error = log->file.full_error;
    if (start_thread(log))
        return log;
    notice_error("cannot start a thread");
    log_file_clear(&log->file);
    free(log);
    return NULL;
}

void log_close_mark(struct log *log, bool writes)
{
    log->unmarked = !writes;
}

void log_free(struct log *log)
{
    struct record close = {.type = RECORD_CLOSE};
    log_push(log);
    pthread_mutex_lock(&log->mutex);
    log->stopping = true;
    pthread_cond_signal(&log->wake);
    pthread_mutex_unlock(&log->mutex);
    pthread_join(log->thread, NULL);
    if (log->status.state != LOG_FAILED) {
        /* It says that everything before it was synced, so that later damage is not taken for a torn
         * end. */
        if (!log->unmarked)
            log_append(log, &close);
        write_pieces(log, &log->queue.pieces, 0);
        log_file_sync(&log->file);
    }
    for (struct piece *p; (p = list_pop(&log->queue.pieces)) != NULL;)
        free_piece(log, p);
    log_file_clear(&log->file);
    pthread_cond_destroy(&log->wake);
    pthread_mutex_destroy(&log->mutex);
    free(log);
}
