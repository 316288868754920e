/* repair.c - see repair.h. */
#include "server/repair/repair.h"

#include "server/disk/aside.h"
#include "server/disk/log_file.h"
#include "server/disk/recover.h"
#include "server/disk/segment_reader.h"
#include "server/follow/role.h"
#include "server/repair/salvage.h"
#include "server/system/own_file.h"
#include "server/system/random.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

static void summarize(struct recovery *r)
{
    uint64_t points = 0;
    for (size_t i = 0; i < r->replay.sets.buckets; i++) {
        for (struct dataset *set = r->replay.sets.bucket[i]; set != NULL; set = set->next) {
            version_update(&r->replay.sets, set->current);
            points += set->current->sum.points;
        }
    }
    printf("%zu sets, %" PRIu64 " points, %" PRIu64 " changes\n", r->replay.sets.sets, points,
           r->last);
}

static int print_result(struct recovery *r)
{
    if (r->why[0] != '\0')
        printf("%s\n", r->why);
    if (r->result == RECOVERY_OK)
        summarize(r);
    bool good = r->result == RECOVERY_OK && !r->lost;
    printf("%s\n", good ? "good" : "not good");
    return good ? 0 : 1;
}

int repair_check(const char *path)
{
    struct datadir dir, arrived;
    struct recovery r;
    if (!datadir_open(&dir, path, false))
        return 1;
    bool replaced = aside_open(&dir, &arrived);
    if (replaced)
        printf("what a leader has sent is in %s; the next start puts it in place\n", arrived.path);
    recovery_init(&r, replaced ? &arrived : &dir);
    r.report = stdout;
    recovery_run(&r);
    int status = print_result(&r);
    recovery_clear(&r);
    if (replaced)
        aside_close(&arrived);
    datadir_close(&dir);
    return status;
}

/* ---- repair: nothing is deleted, only moved to files named damaged.* ---- */

/* Moves the segment from byte `at` on into a file of its own. */
static bool put_rest_aside(const struct datadir *dir, const struct datafile *f, uint64_t at)
{
    char name[DATADIR_ASIDE];
    return datadir_copy_aside(dir, f, at, name) && datadir_cut(dir, f, at);
}

static bool put_later_aside(const struct datadir *dir, const struct datafile *f)
{
    struct datafiles files;
    bool ok = datadir_list(dir, &files);
    for (size_t i = 0; ok && i < files.n; i++)
        if (files.v[i].kind == DATAFILE_LOG && files.v[i].lsn > f->lsn)
            ok = datadir_put_aside(dir, &files.v[i]);
    datafiles_free(&files);
    return ok && datadir_sync(dir);
}

/* The damaged part comes first: if the repair were interrupted when the later segments are gone, it would
 * look like a torn end. */
static bool cut_log(const struct recovery *r)
{
    const struct datafile *f = &r->file;
    bool ok = (r->at > 0 ? put_rest_aside(r->dir, f, r->at) : datadir_put_aside(r->dir, f)) &&
              put_later_aside(r->dir, f);
    if (!ok)
        printf("cannot put the damaged part aside: %s\n", strerror(errno));
    else if (r->at > 0)
        printf("%s: cut off at byte %" PRIu64 "; the rest is in damaged.*\n", f->name, r->at);
    else
        printf("%s: put aside as damaged.*, with everything that follows\n", f->name);
    return ok;
}

/* ---- headers and segments of a log whose records are intact ---- */

/* If the header is damaged, *version is that of a header of its length. */
static bool has_good_header(const struct datadir *dir, const struct datafile *f, uint32_t *version)
{
    struct segment_reader in;
    struct segment header = {0};
    bool bad = reader_open(&in, dir, f, &header) == READER_BAD && !reader_is_later(&in, &header);
    *version = bad ? reader_pass_header(&in) : 0;
    reader_close(&in);
    return !bad;
}

static bool write_header(const struct datadir *dir, const struct datafile *f, uint32_t version)
{
    struct segment header = {
        .version = version == 0 ? RECORD_VERSION : version, .kind = SEGMENT_LOG, .lsn = f->lsn};
    size_t size = segment_header_size(header.version);
    char bytes[SEGMENT_HEADER];
    if (!datadir_unshare(dir, f))
        return false;
    int fd = own_file_open(dir->fd, f->name, O_WRONLY);
    segment_write(bytes, &header);
    return own_file_close(fd, fd >= 0 && write(fd, bytes, size) == (ssize_t)size && fsync(fd) == 0);
}

/* Writes damaged headers of segments again, and a segment if none is left. */
static bool mend_log(const struct recovery *r)
{
    struct datafiles files;
    char aside[DATADIR_ASIDE];
    size_t segments = 0;
    bool ok = datadir_list(r->dir, &files);
    for (size_t i = 0; ok && i < files.n; i++) {
        const struct datafile *f = &files.v[i];
        uint32_t version;
        segments += f->kind == DATAFILE_LOG;
        if (f->kind != DATAFILE_LOG || has_good_header(r->dir, f, &version))
            continue;
        ok = datadir_copy_aside(r->dir, f, 0, aside) && write_header(r->dir, f, version);
        if (ok)
            printf("%s: its header was written again; the old file is in damaged.*\n", f->name);
    }
    datafiles_free(&files);
    if (ok && segments == 0)
        ok = log_file_begin(r->dir, r->last + 1,
                            r->digest); /* a log needs a segment, even an empty one */
    if (!ok)
        printf("cannot repair the log: %s\n", strerror(errno));
    return ok;
}

/* The leader's changes are lost, so a new history begins. Otherwise a follower that has them would give them up when the
 * leader has the same number of other changes. */
static void begin_history(struct datadir *dir)
{
    struct recovery r;
    recovery_init(&r, dir);
    recovery_run(&r);
    dir->lineage = (struct lineage){r.lineage.life, history_begin(random_bits())};
    if (r.lineage.history.origin != 0 &&
        !(r.result == RECOVERY_OK && recovery_tidy(&r) && log_file_begin(dir, r.last + 1, 0)))
        printf("followers cannot see that changes are lost: %s\n", strerror(errno));
    recovery_clear(&r);
}

static void repair(struct recovery *r, bool leads)
{
    if (r->result == RECOVERY_CORRUPT) {
        if (cut_log(r) && mend_log(r) && leads)
            begin_history(r->dir);
    } else if (r->result == RECOVERY_REFUSED && r->bad_snapshot) {
        printf("%s\n", r->why);
        salvage(r->dir);
    } else if (r->result == RECOVERY_OK) {
        bool tidy = recovery_tidy(r);
        if (r->why[0] != '\0')
            printf("%s\n", r->why);
        if (tidy && mend_log(r) && r->lost && leads)
            begin_history(r->dir);
    }
}

int repair_run(const char *path)
{
    struct datadir dir;
    struct recovery r;
    if (!datadir_open(&dir, path, false))
        return 1;
    if (!aside_finish(&dir)) {
        printf("what a leader has sent cannot be put in place: %s\n", strerror(errno));
        datadir_close(&dir);
        return 1;
    }
    recovery_init(&r, &dir);
    recovery_run(&r);
    if (r.result == RECOVERY_REFUSED && r.bad_log) {
        printf("%s\n", r.why);
        recovery_clear(&r);
        recovery_init(&r, &dir);
        r.mend = true;
        recovery_run(&r);
    }
    repair(&r, role_read(path).kind != ROLE_FOLLOWS);
    recovery_clear(&r);
    datadir_close(&dir);
    return repair_check(path);
}
