/* snapshot.c - see snapshot.h. */
#include "server/disk/snapshot.h"

#include "core/delaunay_fields.h"
#include "proto/records/record.h"
#include "server/changes/constraint.h"
#include "server/system/own_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <unistd.h>

enum {
    FLUSH_BYTES = 1 << 20,
    SYNC_BYTES =
        8 << 20,      /* after which it syncs, so that the disk's queue stays short for the log */
    TURN_ROWS = 4096, /* rows that are read in one visit, */
    TURN_PAGES = 32,  /* and pages of values, */
    TURN_CONSTRAINTS = 2048, /* or constraints, about */
    NICE = 10
};

_Static_assert(sizeof(struct record_row) == sizeof(struct dt_row) &&
                   offsetof(struct record_row, x) == offsetof(struct dt_row, at),
               "the rows of a set are written as they are");

/* ---- on its thread ---- */

struct output {
    struct snapshot *snap;
    int fd;
    struct buf out;
    uint64_t number, unsynced;
};

static bool fail(struct output *o, int error)
{
    o->snap->error = error;
    return false;
}

static bool sync_output(struct output *o)
{
    o->unsynced = 0;
    return fdatasync(o->fd) == 0 || fail(o, errno);
}

static bool flush(struct output *o)
{
    if (o->out.failed)
        return fail(o, ENOMEM);
    size_t n = buf_len(&o->out);
    if (!own_file_write(o->fd, buf_head(&o->out), n))
        return fail(o, errno);
    buf_rewind(&o->out, 0);
    o->snap->bytes += n;
    o->unsynced += n;
    if (o->snap->cancel)
        return fail(o, ECANCELED);
    return o->unsynced < SYNC_BYTES || sync_output(o);
}

static bool put(struct output *o, struct record *r)
{
    r->lsn = ++o->number;
    record_write(&o->out, r);
    return !o->out.failed ? buf_len(&o->out) < FLUSH_BYTES || flush(o) : fail(o, ENOMEM);
}

/* Reads up to RECORD_POINTS rows, fewer only at the end; edits of the set may run in between. */
static enum dt_status read_rows(const struct snapshot_source *s, uint32_t *from, struct dt_row *row,
                                uint32_t *rows)
{
    enum dt_status status = DT_OK;
    size_t n = TURN_ROWS;
    for (*rows = 0; status == DT_OK && n == TURN_ROWS && *rows < RECORD_POINTS;) {
        gate_visit(&s->version->gate);
        status = dt_view_rows(s->version->dt, s->view, from, row + *rows, TURN_ROWS, &n);
        gate_end_visit(&s->version->gate);
        *rows += (uint32_t)n;
    }
    return status;
}

static bool put_rows(struct output *o, const struct snapshot_source *s, struct dt_row *row)
{
    struct record r = {.type = RECORD_ROWS, .items = row};
    uint32_t from = 0;
    do {
        if (read_rows(s, &from, row, &r.n) != DT_OK)
            return fail(o, ENOMEM);
        if (r.n > 0 && !put(o, &r))
            return false;
    } while (r.n == RECORD_POINTS);
    return true;
}

/* ---- values ---- */

enum { PAGE = DT_FIELD_PAGE };

_Static_assert(RECORD_MOST_VALUES % DT_FIELD_PAGE == 0, "a record has whole pages of values");

/* Whether the view can still be read, in a visit. */
static bool is_readable(const struct snapshot_source *s)
{
    uint32_t from = 0;
    size_t n;
    return dt_view_rows(s->version->dt, s->view, &from, NULL, 0, &n) == DT_OK;
}

/* A field that is being written: NULL, before the first one and after the last one. */
struct writing {
    const struct dt_field *field;
    char name[DT_FIELD_NAME + 1];
};

/* Goes on to the next field; false: the view cannot be read any more. */
static bool next_field(const struct snapshot_source *s, struct writing *w)
{
    gate_visit(&s->version->gate);
    bool ok = is_readable(s);
    if (ok)
        w->field = dt_field_next(s->version->dt, s->view, w->field);
    if (ok && w->field != NULL)
        strcpy(w->name, dt_field_name(w->field));
    gate_end_visit(&s->version->gate);
    return ok;
}

/* Reads pages that follow each other, as many as a record has, into r; *more: the field has others. */
static bool read_values(const struct snapshot_source *s, const struct dt_field *f, uint64_t *from,
                        struct record *r, double *value, bool *more)
{
    bool ok = true, fits = true;
    r->first = (uint32_t)*from;
    for (r->n = 0, *more = true; ok && *more && fits;) {
        gate_visit(&s->version->gate);
        ok = is_readable(s);
        for (unsigned i = 0; ok && fits && i < TURN_PAGES; i++) {
            const double *page = dt_field_page(f, s->view, from);
            *more = page != NULL;
            r->first = r->n == 0 && *more ? (uint32_t)*from : r->first;
            fits = *more && *from == (uint64_t)r->first + r->n && r->n < RECORD_MOST_VALUES;
            if (!fits)
                break;
            memcpy(value + r->n, page, PAGE * sizeof *value);
            r->n += PAGE;
            *from += PAGE;
        }
        gate_end_visit(&s->version->gate);
    }
    return ok;
}

static bool put_field(struct output *o, const struct snapshot_source *s, const struct writing *w,
                      double *value)
{
    struct record r = {
        .type = RECORD_VALUES, .field = w->name, .field_len = strlen(w->name), .items = value};
    uint64_t from = 0;
    bool more;
    do {
        if (!read_values(s, w->field, &from, &r, value, &more))
            return fail(o, ENOMEM);
        while (r.n > 0 && isnan(value[r.n - 1])) /* a small set has a small file */
            r.n--;
        if (!put(o, &r))
            return false;
    } while (more);
    return true;
}

static bool put_fields(struct output *o, const struct snapshot_source *s, struct writing *w)
{
    if (w->field == NULL)
        return true;
    double *value = malloc(RECORD_MOST_VALUES * sizeof *value);
    bool ok = value != NULL || fail(o, ENOMEM);
    while (ok && w->field != NULL) {
        ok = put_field(o, s, w, value);
        if (ok && !next_field(s, w))
            ok = fail(o, ENOMEM);
    }
    free(value);
    return ok;
}

/* ---- constraints ---- */

/* Reads the next constraints, until a record is full; *from: the next id, DT_NONE at the end. */
static bool read_constraints(const struct snapshot_source *s, uint32_t *from,
                             struct dt_constraint_list *list)
{
    bool ok = true;
    while (ok && *from != DT_NONE && list->n < RECORD_CONSTRAINTS) {
        gate_visit(&s->version->gate);
        ok = is_readable(s) &&
             dt_constraints_read(s->version->dt, s->view, from, TURN_CONSTRAINTS, list) == DT_OK;
        gate_end_visit(&s->version->gate);
    }
    return ok;
}

/* Writes the first ones as a record and removes them. */
static bool put_first(struct output *o, struct dt_constraint_list *list,
                      struct record_constraint *items)
{
    struct record r = {.type = RECORD_CONSTRAIN, .items = items};
    r.n = (uint32_t)(list->n < RECORD_CONSTRAINTS ? list->n : RECORD_CONSTRAINTS);
    for (uint32_t i = 0; i < r.n; i++)
        items[i] = constraint_record(&list->v[i]);
    list->n -= r.n;
    memmove(list->v, list->v + r.n, list->n * sizeof *list->v);
    return put(o, &r);
}

static bool put_constraints(struct output *o, const struct snapshot_source *s)
{
    struct dt_constraint_list list = {.n = 0};
    struct record_constraint *items = malloc(RECORD_CONSTRAINTS * sizeof *items);
    uint32_t from = 0;
    bool ok = items != NULL || fail(o, ENOMEM);
    do {
        ok = ok && (read_constraints(s, &from, &list) || fail(o, ENOMEM));
        if (ok && list.n > 0)
            ok = put_first(o, &list, items);
    } while (ok && (list.n > 0 || from != DT_NONE));
    free(items);
    free(list.v);
    return ok;
}

static bool put_set(struct output *o, const struct snapshot_source *s)
{
    struct writing field = {NULL, ""};
    struct record end = {.type = RECORD_SET_END};
    struct dt_row *row = malloc(RECORD_POINTS * sizeof *row);
    struct dt_summary sum = {0};
    if (s->view != NULL)
        dt_view_summary(s->view, &sum);
    struct record r = {.type = RECORD_SET,
                       .synced = s->lsn,
                       .flags = s->triangulated ? RECORD_TRIANGULATED : 0,
                       .first = s->view == NULL ? 0 : dt_view_next_id(s->view),
                       .n = sum.points,
                       .a = dt_tolerance(s->version->dt),
                       .b = (double)s->expires_ms,
                       .name = s->name,
                       .name_len = s->name_len,
                       .version = s->number};
    if (row == NULL || s->view == NULL || !next_field(s, &field)) {
        free(row);
        return fail(o, ENOMEM);
    }
    r.flags |= field.field != NULL ? RECORD_HAS_FIELDS : 0;
    r.flags |= s->constrained ? RECORD_HAS_CONSTRAINTS : 0;
    bool more = field.field != NULL || s->constrained;
    bool ok = put(o, &r) && put_rows(o, s, row);
    free(row);
    ok = ok && (!s->constrained || put_constraints(o, s)) && put_fields(o, s, &field);
    return ok && (!more || put(o, &end));
}

static uint32_t version_of(const struct snapshot *snap)
{
    uint32_t version = RECORD_VERSION_PLAIN;
    for (size_t i = 0; i < snap->n; i++)
        if (snap->source[i].constrained)
            version = RECORD_VERSION_CONSTRAINTS;
    return version;
}

static bool put_all(struct output *o)
{
    struct snapshot *snap = o->snap;
    struct segment header = {.version = version_of(snap),
                             .kind = SEGMENT_SNAPSHOT,
                             .lsn = snap->lsn,
                             .life = snap->lineage.life,
                             .history = snap->lineage.history,
                             .digest = snap->digest};
    struct record end = {.type = RECORD_END, .n = (uint32_t)snap->n};
    segment_append(&o->out, &header);
    for (size_t i = 0; i < snap->n; i++) {
        if (!put_set(o, &snap->source[i]))
            return false;
        snap->written = i + 1;
    }
    return put(o, &end) && flush(o) && sync_output(o);
}

/* If it fails, snap->error is the errno. */
static void write_snapshot(struct snapshot *snap)
{
    struct output o = {.snap = snap};
    char temporary[DATAFILE_NAME], name[DATAFILE_NAME];
    int dir = snap->dir->fd;
    datafile_name(temporary, DATAFILE_TEMPORARY, snap->lsn);
    datafile_name(name, DATAFILE_SNAPSHOT, snap->lsn);
    if (!datadir_regain(snap->dir)) {
        fail(&o, errno);
        return;
    }
    bool first = faccessat(dir, name, F_OK, 0) != 0;
    o.fd = own_file_create(dir, temporary, O_WRONLY);
    if (o.fd < 0) {
        fail(&o, errno);
        return;
    }
    bool ok = put_all(&o);
    buf_free(&o.out);
    if (close(o.fd) != 0 && ok)
        ok = fail(&o, errno);
    if (ok && renameat(dir, temporary, dir, name) != 0)
        ok = fail(&o, errno);
    if (!ok) {
        unlinkat(dir, temporary, 0);
        return;
    }
    if (datadir_sync(snap->dir)) {
        datadir_forget(snap->dir, snap->lsn);
        return;
    }
    fail(&o, errno);
    /* This name may never become durable, even if a later sync succeeds; but after a restart, new changes
     * would build on it. */
    if (first)
        unlinkat(dir, name, 0);
}

static void *serve(void *arg)
{
    struct snapshot *snap = arg;
    int event = snap->event;
    setpriority(PRIO_PROCESS, 0, NICE); /* on Linux: of this thread */
    write_snapshot(snap);
    snap->done = true; /* from here on *snap may be freed */
    eventfd_write(event, 1);
    close(event);
    return NULL;
}

/* ---- on a reactor ---- */

static void start(struct snapshot *snap)
{
    int error = pthread_create(&snap->thread, NULL, serve, snap);
    snap->started = error == 0;
    if (error == 0)
        return;
    snap->error = error;
    snap->done = true;
    eventfd_write(snap->event, 1);
}

static void pin(struct snapshot_source *s, struct dataset *set)
{
    struct version *v = version_pin(set->current);
    s->version = v;
    s->lsn = v->lsn;
    s->number = set->version;
    s->triangulated = set->triangulated;
    s->expires_ms = set->expires_ms;
    s->view = dt_view_begin(v->dt, false);
    s->constrained = dt_constraints_count(v->dt) > 0;
}

static void unpin(struct registry *sets, struct snapshot_source *s)
{
    version_end_view(sets, s->version, s->view);
    version_unpin(sets, s->version);
}

static void on_free(struct waiter *w)
{
    struct snapshot_source *s =
        (struct snapshot_source *)(void *)((char *)w - offsetof(struct snapshot_source, waiter));
    pin(s, s->set);
    queue_served(w);
    if (--s->snapshot->waiting == 0)
        start(s->snapshot);
}

static void count(struct dataset *set, void *ctx)
{
    *(size_t *)ctx += !set->temporary;
}

static void enrol(struct dataset *set, void *ctx)
{
    struct snapshot *snap = ctx;
    if (set->temporary)
        return;
    struct snapshot_source *s = &snap->source[snap->n++];
    s->snapshot = snap;
    s->name_len = set->name_len;
    memcpy(s->name, set->name, set->name_len);
    if (!set->exclusive) {
        pin(s, set);
        return;
    }
    s->set = set;
    s->waiter.wake = on_free;
    queue_enter(&set->queue, &s->waiter);
    snap->waiting++;
}

struct snapshot *snapshot_begin(struct datadir *dir, struct registry *sets, uint64_t lsn, int event)
{
    size_t n = 0;
    registry_each(sets, count, &n);
    struct snapshot *snap = calloc(1, sizeof *snap + n * sizeof snap->source[0]);
    if (snap == NULL)
        return NULL;
    snap->dir = dir;
    snap->lsn = lsn;
    snap->lineage = dir->lineage;
    snap->event = fcntl(event, F_DUPFD_CLOEXEC, 0);
    if (snap->event < 0) {
        free(snap);
        return NULL;
    }
    snap->waiting = 1;
    registry_each(sets, enrol, snap);
    return snap;
}

void snapshot_go(struct snapshot *snap, uint64_t digest)
{
    snap->digest = digest;
    if (--snap->waiting == 0)
        start(snap);
}

void snapshot_release(struct snapshot *snap, struct registry *sets)
{
    size_t written = snap->written;
    for (; snap->released < written; snap->released++)
        unpin(sets, &snap->source[snap->released]);
}

int snapshot_end(struct snapshot *snap, struct registry *sets)
{
    snap->cancel = true;
    /* A thread that is done has only to write the eventfd and end. It has a low priority, so on a busy machine
     * waiting for it would block all clients. */
    if (!snap->started)
        close(snap->event);
    else if (snap->done)
        pthread_detach(snap->thread);
    else
        pthread_join(snap->thread, NULL);
    int error = snap->done ? snap->error : ECANCELED;
    for (size_t i = snap->released; i < snap->n; i++) {
        queue_served(&snap->source[i].waiter);
        if (snap->source[i].version != NULL)
            unpin(sets, &snap->source[i]);
    }
    free(snap);
    return error;
}
