/* recover.c - see recover.h. */
#include "server/disk/recover.h"

#include "server/disk/segment_reader.h"
#include "server/system/own_file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

void recovery_init(struct recovery *r, struct datadir *dir)
{
    *r = (struct recovery){.dir = dir};
    replay_init(&r->replay);
    r->replay.cancel = &r->cancel;
}

void recovery_clear(struct recovery *r)
{
    replay_clear(&r->replay);
}

unsigned recovery_percent(struct recovery *r)
{
    uint64_t total = r->total, done = r->done;
    return total == 0 ? 0 : (unsigned)(done * 100 / total);
}

__attribute__((format(printf, 3, 4))) static bool
fail(struct recovery *r, enum recovery_result result, const char *format, ...)
{
    va_list ap;
    va_start(ap, format);
    vsnprintf(r->why, sizeof r->why, format, ap);
    va_end(ap);
    r->result = result;
    return false;
}

static bool fail_to_read(struct recovery *r, const struct datafile *f, int error)
{
    return fail(r, RECOVERY_ERROR, "cannot read %s: %s", f->name, strerror(error));
}

__attribute__((format(printf, 2, 3))) static void report(struct recovery *r, const char *format,
                                                         ...)
{
    va_list ap;
    if (r->report == NULL)
        return;
    va_start(ap, format);
    vfprintf(r->report, format, ap);
    va_end(ap);
}

static bool cancelled(struct recovery *r)
{
    if (r->cancel)
        fail(r, RECOVERY_CANCELLED, "cancelled");
    return r->cancel;
}

static const char keeps[] = "; --repair DIR would keep every intact set";
static const char begins[] =
    ", and there is no snapshot: every change is lost; --repair DIR would begin again";
static const char mends[] = "; --repair DIR would keep the changes before that";

/* Reports a record that was refused, or that memory ran out. */
static bool fail_record(struct recovery *r, const struct datafile *f, uint64_t at,
                        const char *fault)
{
    if (cancelled(r))
        return false;
    if (r->replay.out_of_memory)
        return fail(r, RECOVERY_ERROR, "out of memory while reading %s", f->name);
    r->bad_snapshot = f->kind == DATAFILE_SNAPSHOT;
    r->bad_log = !r->bad_snapshot;
    return fail(r, RECOVERY_REFUSED, "%s: the record at byte %" PRIu64 " is damaged: %s%s", f->name,
                at, fault, r->bad_snapshot ? keeps : mends);
}

/* The records that follow were written in the life of the header; 0: unknown. */
static void note_life(struct recovery *r, const struct segment *header)
{
    struct lineage *l = &r->lineage;
    r->replay.sets.life = header->life;
    l->life = header->life > l->life ? header->life : l->life;
    if (header->history.origin != 0)
        l->history = header->history;
    if (header->digest != 0)
        r->digest = header->digest;
}

/* ---- the snapshot ---- */

static bool read_snapshot_records(struct recovery *r, const struct datafile *f,
                                  struct segment_reader *in)
{
    struct record record;
    for (uint64_t number = 1;; number++) {
        enum reader_result got = reader_next(in, &record);
        if (got == READER_ERROR)
            return fail_to_read(r, f, in->error);
        if (got == READER_END && r->replay.ended)
            return true;
        const char *fault = got == READER_END ? "the file ends too early" : in->fault;
        if (got == READER_OK)
            fault = record.lsn == number ? replay_snapshot(&r->replay, &record) : "it is misplaced";
        if (got != READER_OK || fault != NULL)
            return fail_record(r, f, in->at, fault);
        r->done += in->last;
        if (cancelled(r))
            return false;
    }
}

static bool read_snapshot(struct recovery *r, const struct datafile *f)
{
    struct segment_reader in;
    struct segment header = {0};
    enum reader_result got = reader_open(&in, r->dir, f, &header);
    bool ok = false;
    if (got == READER_ERROR)
        fail_to_read(r, f, in.error);
    else if (got == READER_BAD && reader_is_later(&in, &header))
        fail(r, RECOVERY_REFUSED, "%s: %s", f->name, in.fault);
    else if (got == READER_BAD)
        r->bad_snapshot = !fail(r, RECOVERY_REFUSED, "%s: %s%s", f->name, in.fault, keeps);
    else {
        note_life(r, &header);
        ok = read_snapshot_records(r, f, &in);
    }
    reader_close(&in);
    r->last = r->replay.snapshot = f->lsn;
    r->snapshot_digest = r->digest;
    r->digest = 0; /* the log begins before the snapshot */
    if (ok)
        report(r, "%s: %zu sets, all changes up to %" PRIu64 "\n", f->name, r->replay.sets.sets,
               f->lsn);
    return ok;
}

/* ---- a segment of the log ---- */

struct place {
    const struct datafile *file;
    bool last; /* no segment follows */
    uint64_t first;
    uint64_t mark_at, mark_lsn; /* a record; see note_synced */
    uint64_t load_at, load_lsn; /* where an incomplete LOAD begins; 0: there is none */
    uint64_t load_digest;       /* of the changes before it */
};

static bool torn_at(struct recovery *r, const struct place *p, uint64_t at)
{
    int n;
    r->torn = true;
    r->file = *p->file;
    r->at = at;
    n = snprintf(r->why, sizeof r->why,
                 "%s: the end of the log %s; %" PRIu64 " bytes after byte %" PRIu64 " do not count",
                 p->file->name, r->lost ? "is damaged" : "was torn off by a crash",
                 p->file->bytes - at, at);
    if (r->lost)
        snprintf(r->why + n, sizeof r->why - (size_t)n,
                 ", including %" PRIu64
                 " intact records: changes may be lost that were acknowledged",
                 r->later);
    return true;
}

static bool corrupt_at(struct recovery *r, const struct place *p, uint64_t at, const char *fault)
{
    r->file = *p->file;
    r->at = at;
    return fail(r, RECOVERY_CORRUPT,
                "%s: the record at byte %" PRIu64
                " is damaged (%s), and changes that were acknowledged follow. --repair DIR would "
                "keep all changes up to %" PRIu64 " and put everything after them aside: %s%" PRIu64
                " intact records",
                p->file->name, at, fault, r->last, p->last ? "" : "later segments and ", r->later);
}

/* The reader's position has no valid record: is it a torn end? */
static bool judge_end(struct recovery *r, const struct place *p, struct segment_reader *in,
                      const char *fault)
{
    uint64_t at = in->at, bad = r->last + 1;
    bool synced = false, half = in->half;
    struct record later;
    enum reader_result got;
    while ((got = reader_search(in, bad, &later)) == READER_OK) {
        r->later++;
        synced = synced || later.synced >= bad;
        if (cancelled(r))
            return false;
    }
    if (got == READER_ERROR)
        return fail_to_read(r, p->file, in->error);
    if (p->load_at > 0) { /* the whole LOAD is dropped with its end */
        at = p->load_at;
        r->last = p->load_lsn - 1;
        r->digest = p->load_digest;
        replay_abandon_load(&r->replay);
    }
    if (synced || !p->last)
        return corrupt_at(r, p, at, fault);
    r->aside = r->lost = !half || r->later > 0;
    return torn_at(r, p, at);
}

/* A record says up to which lsn everything was synced. The offset is known for one record only, the mark, so
 * synced_at may be earlier than possible. */
static void note_synced(struct recovery *r, struct place *p, uint64_t at,
                        const struct record *record)
{
    if (record->synced + 1 < p->mark_lsn)
        return;
    r->synced_at = record->synced + 1 == record->lsn ? at : p->mark_at;
    p->mark_at = at;
    p->mark_lsn = record->lsn;
}

/* Reads the next record. READER_BAD: it is not the one that has to come here. */
static enum reader_result read_next(const struct recovery *r, const struct place *p,
                                    struct segment_reader *in, struct record *record)
{
    enum reader_result got = reader_next(in, record);
    if (got == READER_OK && record->lsn != r->last + 1) {
        in->fault = "its number is not the next one";
        in->last = 0;
        return READER_BAD;
    }
    if (got != READER_END || p->load_at == 0)
        return got;
    in->half = true;
    in->fault = "a LOAD is not complete";
    return READER_BAD;
}

/* Carries out the record that has been read. */
static bool take_record(struct recovery *r, struct place *p, struct segment_reader *in,
                        const struct record *record)
{
    const char *fault = replay_log(&r->replay, record);
    if (fault != NULL && r->mend && !r->replay.out_of_memory && !r->cancel)
        return corrupt_at(r, p, in->at, fault);
    if (fault != NULL)
        return fail_record(r, p->file, in->at, fault);
    if (record->type == RECORD_LOAD) {
        p->load_at = in->at;
        p->load_lsn = record->lsn;
        p->load_digest = r->digest;
    }
    if (!replay_in_load(&r->replay))
        p->load_at = 0;
    note_synced(r, p, in->at, record);
    r->last = record->lsn;
    r->digest = record_digest(r->digest, reader_bytes(in), in->last);
    r->done += in->last;
    return !cancelled(r);
}

static bool read_log_records(struct recovery *r, struct place *p, struct segment_reader *in)
{
    struct record record;
    enum reader_result got;
    r->synced_at = p->mark_at = SEGMENT_HEADER;
    p->mark_lsn = p->first;
    while ((got = read_next(r, p, in, &record)) == READER_OK)
        if (!take_record(r, p, in, &record))
            return false;
    if (got == READER_BAD)
        return judge_end(r, p, in, in->fault);
    return got == READER_END || fail_to_read(r, p->file, in->error);
}

/* A segment gets its name when its header is durable (log_file.c), so this is no torn end. */
static bool judge_header(struct recovery *r, const struct place *p, const struct segment_reader *in)
{
    if (in->error != 0)
        return fail_to_read(r, p->file, in->error);
    if (r->mend)
        return corrupt_at(r, p, 0, in->fault);
    r->bad_log = true;
    return fail(r, RECOVERY_REFUSED, "%s: %s; --repair DIR would keep what can be read behind it",
                p->file->name, in->fault);
}

/* To repair a log, the records after a damaged header are read. The file name has the same number as the header, and the
 * numbers of the records show whether it is right. */
static bool can_pass_header(const struct recovery *r, struct segment_reader *in)
{
    return r->mend && reader_pass_header(in) > 0;
}

static bool read_segment(struct recovery *r, struct place *p)
{
    const struct datafile *f = p->file;
    struct segment_reader in;
    struct segment header = {0};
    bool ok = false;
    enum reader_result got = reader_open(&in, r->dir, f, &header);
    if (got == READER_ERROR) {
        fail_to_read(r, f, in.error);
    } else if (got == READER_BAD && reader_is_later(&in, &header)) {
        fail(r, RECOVERY_REFUSED, "%s: %s", f->name, in.fault);
    } else if (got == READER_BAD && !can_pass_header(r, &in)) {
        ok = judge_header(r, p, &in);
    } else {
        p->first = r->last + 1;
        note_life(r, &header);
        ok = read_log_records(r, p, &in);
        if (ok && r->last < p->first)
            report(r, "%s: no changes yet\n", f->name);
        else if (ok)
            report(r, "%s: changes %" PRIu64 " to %" PRIu64 "\n", f->name, p->first, r->last);
    }
    reader_close(&in);
    return ok;
}

/* The next segment is missing; `then` is the one that follows, NULL if there is none. */
static bool miss_segment(struct recovery *r, const struct datafile *then)
{
    if (r->last < r->replay.snapshot)
        r->last = r->replay.snapshot;
    if (r->mend && then == NULL)
        return true;
    if (r->mend) {
        r->file = *then;
        r->at = 0;
    }
    r->bad_log = true;
    return fail(r, r->mend ? RECOVERY_CORRUPT : RECOVERY_REFUSED,
                "%s%sthe log segment with change %" PRIu64 " is missing%s",
                then == NULL ? "" : then->name, then == NULL ? "" : ": ", r->last + 1,
                r->last == 0 && then == NULL ? begins : mends);
}

/* A set in a snapshot may have later changes than the snapshot's lsn. If the log has lost these in a crash,
 * their numbers must not be used again. */
static void look_ahead(struct dataset *set, void *ctx)
{
    struct recovery *r = ctx;
    if (set->current->lsn > r->ahead)
        r->ahead = set->current->lsn;
}

/* Reads the segments from the first one that has changes after the snapshot. */
static bool read_segments(struct recovery *r, const struct datafile *f, size_t n)
{
    while (n > 1 && f[1].lsn <= r->replay.snapshot + 1) {
        r->done += f->bytes;
        f++;
        n--;
    }
    if (n == 0 ? r->used || r->replay.snapshot > 0 : f->lsn > r->replay.snapshot + 1)
        return miss_segment(r, n == 0 ? NULL : f);
    for (size_t i = 0; i < n; i++) {
        struct place p = {.file = &f[i], .last = i + 1 == n};
        if (i > 0 && f[i].lsn != r->last + 1)
            return miss_segment(r, &f[i]);
        /* The first one may begin before the snapshot. */
        r->last = i == 0 ? f[i].lsn - 1 : r->last;
        if (!read_segment(r, &p))
            return false;
        r->log_bytes += f[i].bytes;
    }
    if (r->last < r->replay.snapshot) {
        r->last = r->replay.snapshot;
        r->digest = r->snapshot_digest;
    }
    return true;
}

static void read_log(struct recovery *r, const struct datafile *f, size_t n)
{
    if (read_segments(r, f, n))
        r->result = RECOVERY_OK;
    r->ahead = r->last > r->replay.snapshot ? r->last : r->replay.snapshot;
    registry_each(&r->replay.sets, look_ahead, r);
}

/* The first file of the kind, and how many there are; NULL: none. */
static const struct datafile *files_of(const struct datafiles *files, enum datafile_kind kind,
                                       size_t *n)
{
    const struct datafile *first = NULL;
    *n = 0;
    for (size_t i = 0; i < files->n; i++)
        if (files->v[i].kind == kind && (*n)++ == 0)
            first = &files->v[i];
    return first;
}

void recovery_run(struct recovery *r)
{
    struct datafiles files;
    size_t snapshots, logs;
    if (!datadir_list(r->dir, &files)) {
        fail(r, RECOVERY_ERROR, "cannot list %s: %s", r->dir->path, strerror(errno));
        return;
    }
    const struct datafile *snapshot = files_of(&files, DATAFILE_SNAPSHOT, &snapshots);
    const struct datafile *log = files_of(&files, DATAFILE_LOG, &logs);
    r->used = files.used;
    for (size_t i = 0; i < files.n; i++)
        r->total += files.v[i].bytes;
    if (r->pass_over && snapshots > 0)
        snapshots--;
    if (snapshots == 0 || read_snapshot(r, &snapshot[snapshots - 1]))
        read_log(r, log, logs);
    datafiles_free(&files);
}

void recovery_log(struct recovery *r, const struct datafiles *files)
{
    size_t logs;
    const struct datafile *log = files_of(files, DATAFILE_LOG, &logs);
    read_log(r, log, logs);
}

/* ---- afterwards ---- */

static void remove_temporaries(const struct datadir *dir, const struct datafiles *files)
{
    for (size_t i = 0; i < files->n; i++)
        if (files->v[i].kind == DATAFILE_TEMPORARY)
            unlinkat(dir->fd, files->v[i].name, 0);
}

/* Cuts off the torn end, after putting it aside if it may have changes. */
static bool cut_torn_end(struct recovery *r)
{
    const struct datafile *f = &r->file;
    char name[DATADIR_ASIDE];
    size_t n = strlen(r->why);
    if (r->aside && !datadir_copy_aside(r->dir, f, r->at, name))
        return fail(r, RECOVERY_ERROR, "cannot put the damaged end of %s aside: %s", f->name,
                    strerror(errno));
    if (r->aside)
        snprintf(r->why + n, sizeof r->why - n, "; they are kept in %s", name);
    /* Even an empty segment stays, because a missing one would look like a loss. */
    if (!datadir_cut(r->dir, f, r->at))
        return fail(r, RECOVERY_ERROR, "cannot cut the end off %s: %s", f->name, strerror(errno));
    return true;
}

/* Syncs the files that were read, because new changes build on them. If the process that wrote them was killed,
 * they need not be on the disk, and a power failure would leave a gap before the new changes. The last
 * segment comes first: the others are nearly always durable already. */
static bool save_log(struct recovery *r, const struct datafiles *files)
{
    bool last = true;
    for (size_t i = files->n; i-- > 0;) {
        const struct datafile *f = &files->v[i];
        if (f->kind != DATAFILE_LOG)
            continue;
        if (!datadir_save_again(r->dir, f, last ? r->synced_at : f->bytes))
            return fail(r, RECOVERY_ERROR, "cannot write and sync %s: %s", f->name,
                        strerror(errno));
        last = false;
    }
    return true;
}

/* The snapshot that was read, if there are also files that it covers: they would have been removed after a
 * sync of its name. NULL: there is no snapshot, or no such file. */
static const struct datafile *unproven_snapshot(const struct recovery *r,
                                                const struct datafiles *files)
{
    const struct datafile *snapshot = NULL;
    bool covers = false;
    for (size_t i = 0; i < files->n; i++) {
        const struct datafile *f = &files->v[i];
        if (f->kind == DATAFILE_SNAPSHOT && f->lsn == r->replay.snapshot)
            snapshot = f;
        covers = covers || (f->kind == DATAFILE_LOG && f->lsn <= r->replay.snapshot) ||
                 (f->kind == DATAFILE_SNAPSHOT && f->lsn < r->replay.snapshot);
    }
    return covers ? snapshot : NULL;
}

/* The process that wrote the snapshot may have been killed after the sync of its name had failed. Such a name
 * may never become durable, even if a later sync succeeds; the name of a copy does. If there is no space
 * for a copy, the original is used. */
static bool save_snapshot(struct recovery *r, const struct datafiles *files)
{
    const struct datafile *f = unproven_snapshot(r, files);
    if (f == NULL || datadir_copy_again(r->dir, f, &r->cancel) || own_file_lacks_space(errno))
        return true;
    int error = errno;
    return !cancelled(r) &&
           fail(r, RECOVERY_ERROR, "cannot save the snapshot: %s", strerror(error));
}

bool recovery_tidy(struct recovery *r)
{
    struct datafiles files;
    if (!datadir_list(r->dir, &files))
        return fail(r, RECOVERY_ERROR, "cannot list the files: %s", strerror(errno));
    remove_temporaries(r->dir, &files);
    bool ok = (!r->torn || cut_torn_end(r)) && save_log(r, &files) && save_snapshot(r, &files);
    datafiles_free(&files);
    return ok;
}
