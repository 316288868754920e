/* salvage.c - repair of a damaged snapshot. Nothing is lost if an older snapshot, or the log from its beginning,
 * still exists; otherwise every set is kept whose records are all intact.
 *
 * The checksums show which records are intact, and their numbers whether one is missing. A set that has lost
 * a record is lost as a whole: a part of a set would be wrong data. Its later changes in the log are
 * skipped; later changes of other sets are applied. Then all sets are written as a new snapshot, and a new log
 * begins after it. The old files stay as damaged.*, and every loss is reported. A crash at any point leaves
 * the directory as it was before, or repaired. */
#include "server/repair/salvage.h"

#include "server/disk/log_file.h"
#include "server/disk/recover.h"
#include "server/disk/segment_reader.h"
#include "server/disk/snapshot.h"
#include "server/system/own_file.h"
#include "server/system/random.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

static bool report_failure(const char *what)
{
    printf("%s: %s\n", what, strerror(errno));
    return false;
}

/* ---- reading what is intact ---- */

struct reading {
    struct recovery *r;
    struct losses *losses;
    struct segment_reader in;
    uint64_t bytes;  /* of the file */
    uint64_t lsn;    /* of the snapshot: it has all changes up to this one */
    uint64_t number; /* of the next record */
    bool damaged;    /* some record before that was damaged or missing */
    bool ended;
};

/* The set whose rows are being read is lost. */
static void lose_set(struct reading *s)
{
    struct replay *p = &s->r->replay;
    struct dataset *set = p->restoring;
    if (set != NULL)
        losses_add(s->losses, set->name, set->name_len, p->rows);
    replay_abandon_set(p);
}

static void take_record(struct reading *s, const struct record *record)
{
    struct replay *p = &s->r->replay;
    if (record->type == RECORD_END) {
        s->losses->announced = record->n;
        s->ended = true;
        lose_set(s);
        return;
    }
    if (record->type == RECORD_SET) {
        lose_set(s);
        s->losses->sets++;
    } else if (p->restoring == NULL) {
        return; /* rows of a set that is lost */
    }
    if (replay_snapshot(p, record) != NULL && !p->out_of_memory)
        lose_set(s);
}

/* Whether a damaged RECORD_END has the number of sets that were seen. */
static bool end_counts(const struct reading *s)
{
    return record_outline(buf_head(&s->in.window)).n == s->losses->sets;
}

/* Whether the damaged record is RECORD_END: the last one, of that length, and like it in two of three
 * fields. */
static bool is_damaged_end(const struct reading *s)
{
    if (s->bytes - s->in.at != RECORD_HEADER || buf_len(&s->in.window) != RECORD_HEADER)
        return false;
    struct record_outline o = record_outline(buf_head(&s->in.window));
    return (o.type == RECORD_END) + (o.length == 0) + end_counts(s) >= 2;
}

/* Skips a damaged record and goes to the next intact one. False at the end. The missing records may have been
 * an empty set, unless only one is missing and rows follow: then these were its rows. */
static bool pass_damage(struct reading *s, enum reader_result got, struct record *record)
{
    bool last = got == READER_BAD && is_damaged_end(s);
    bool counted = last && (!s->damaged || end_counts(s));
    lose_set(s);
    s->damaged = true;
    if (reader_search(&s->in, s->number, record) != READER_OK) {
        s->losses->empty |= !last;
        if (counted)
            s->losses->announced = s->losses->sets;
        return false;
    }
    s->losses->empty |= record->lsn != s->number + 1 || record->type != RECORD_ROWS;
    return true;
}

static bool read_intact_records(struct reading *s, const struct datafile *f)
{
    struct segment header = {0};
    struct record record;
    enum reader_result got = reader_open(&s->in, s->r->dir, f, &header);
    if (got == READER_BAD)
        reader_pass_header(&s->in);
    /* If the header cannot be read, the file's name says the same. */
    s->lsn = got == READER_BAD && header.kind == SEGMENT_SNAPSHOT ? header.lsn : f->lsn;
    for (s->number = 1; got != READER_ERROR && !s->ended; s->number = record.lsn + 1) {
        got = reader_next(&s->in, &record);
        if (got == READER_ERROR)
            break;
        if ((got != READER_OK || record.lsn != s->number) && !pass_damage(s, got, &record))
            break;
        take_record(s, &record);
    }
    lose_set(s);
    bool no_memory = s->r->replay.out_of_memory || s->losses->failed;
    int error = s->in.error != 0 || !no_memory ? s->in.error : ENOMEM;
    reader_close(&s->in);
    errno = error;
    return error == 0;
}

/* ---- the new directory ---- */

static bool write_snapshot(struct recovery *r)
{
    int event = eventfd(0, EFD_CLOEXEC);
    uint64_t count;
    struct snapshot *snap =
        event >= 0 ? snapshot_begin(r->dir, &r->replay.sets, r->last, event) : NULL;
    errno = ENOMEM;
    if (snap != NULL) {
        snapshot_go(snap, r->digest);
        while (read(event, &count, sizeof count) < 0 && errno == EINTR)
            ;
        errno = snapshot_end(snap, &r->replay.sets);
    }
    return own_file_close(event, errno == 0);
}

/* Begins the log after the snapshot; the earlier segments already have their second names. */
static bool begin_log(const struct recovery *r, const struct datafiles *files)
{
    bool ok = log_file_begin(r->dir, r->last + 1, r->digest);
    for (size_t i = 0; ok && i < files->n; i++)
        if (files->v[i].kind == DATAFILE_LOG && files->v[i].lsn != r->last + 1)
            ok = unlinkat(r->dir->fd, files->v[i].name, 0) == 0 || errno == ENOENT;
    return ok && datadir_sync(r->dir);
}

static bool replace(struct recovery *r, const struct datafiles *files)
{
    for (size_t i = 0; i < files->n; i++)
        if (files->v[i].kind != DATAFILE_TEMPORARY && !datadir_link_aside(r->dir, &files->v[i]))
            return report_failure("cannot put the damaged files aside");
    if (!datadir_sync(r->dir) || !write_snapshot(r) || !begin_log(r, files))
        return report_failure("cannot write a new snapshot");
    return true;
}

/* ---- with and without the newest snapshot ---- */

/* Whether nothing is lost without the newest snapshot. */
static bool is_dispensable(struct datadir *dir, const struct datafile *newest)
{
    struct recovery r;
    recovery_init(&r, dir);
    r.pass_over = true;
    recovery_run(&r);
    bool yes = r.result == RECOVERY_OK && r.last >= newest->lsn;
    recovery_clear(&r);
    return yes;
}

static bool do_without(const struct datadir *dir, const struct datafile *newest)
{
    if (!datadir_put_aside(dir, newest) || !datadir_sync(dir))
        return report_failure("cannot put the damaged snapshot aside");
    printf("%s: put aside; nothing is lost, because the files before it are complete\n",
           newest->name);
    return true;
}

static bool keep_intact_sets(struct datadir *dir, const struct datafiles *files,
                             const struct datafile *newest)
{
    struct losses losses = {.announced = SIZE_MAX};
    struct recovery r;
    recovery_init(&r, dir);
    struct reading s = {.r = &r, .losses = &losses, .bytes = newest->bytes};
    bool ok = read_intact_records(&s, newest) || report_failure("cannot read the snapshot");
    if (ok) {
        r.last = r.replay.snapshot = s.lsn;
        r.replay.losses = &losses;
        r.mend = true;
        recovery_log(&r, files);
        r.last = r.ahead;
        r.digest = random_bits(); /* it is not what was there before */
        ok = r.result == RECOVERY_OK || r.result == RECOVERY_CORRUPT;
        if (r.why[0] != '\0')
            printf("%s\n", r.why);
    }
    ok = ok && replace(&r, files);
    if (ok) {
        losses_print(&losses, stdout);
        printf("%s: %zu sets were intact or are newer; the old files are in damaged.*\n",
               newest->name, r.replay.sets.sets);
    }
    losses_clear(&losses);
    recovery_clear(&r);
    return ok;
}

bool salvage(struct datadir *dir)
{
    struct datafiles files;
    size_t snapshots = 0;
    if (!datadir_list(dir, &files))
        return report_failure("cannot list the directory");
    while (snapshots < files.n && files.v[snapshots].kind == DATAFILE_SNAPSHOT)
        snapshots++;
    bool ok = snapshots > 0;
    if (ok) {
        const struct datafile *newest = &files.v[snapshots - 1];
        ok = is_dispensable(dir, newest) ? do_without(dir, newest)
                                         : keep_intact_sets(dir, &files, newest);
    }
    datafiles_free(&files);
    return ok;
}
