/* repair.c - delaunayd --check DIR and --repair DIR. */
#include "server/recover.h"

#include "server/salvage.h"

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

static int tell(struct recovery *r)
{
    if (r->why[0] != '\0')
        printf("%s\n", r->why);
    if (r->result == RECOVERY_OK)
        summarize(r);
    printf("%s\n", r->result == RECOVERY_OK ? "good" : "not good");
    return r->result == RECOVERY_OK ? 0 : 1;
}

int recovery_check(const char *path)
{
    struct datadir dir;
    struct recovery r;
    if (!datadir_open(&dir, path, false))
        return 1;
    recovery_init(&r, &dir);
    r.report = stdout;
    recovery_run(&r);
    int status = tell(&r);
    recovery_clear(&r);
    datadir_close(&dir);
    return status;
}

/* ---- repair: nothing is thrown away, it only moves to files called damaged.* ---- */

/* Moves what follows byte `at` of the segment into a file of its own. */
static bool put_rest_aside(const struct datadir *dir, const struct datafile *f, uint64_t at)
{
    int fd = openat(dir->fd, f->name, O_WRONLY | O_CLOEXEC);
    bool ok = fd >= 0 && datadir_copy_aside(dir, f, at) && ftruncate(fd, (off_t)at) == 0 &&
              fsync(fd) == 0;
    int error = errno;
    if (fd >= 0)
        close(fd);
    errno = error;
    return ok;
}

static bool put_later_aside(const struct datadir *dir, const struct datafile *f)
{
    struct datafiles files;
    bool ok = datadir_list(dir, &files);
    for (size_t i = 0; ok && i < files.n; i++) {
        if (files.v[i].kind != DATAFILE_LOG || files.v[i].lsn <= f->lsn)
            continue;
        ok = datadir_copy_aside(dir, &files.v[i], 0) && unlinkat(dir->fd, files.v[i].name, 0) == 0;
    }
    datafiles_free(&files);
    return ok && datadir_sync(dir);
}

int recovery_repair(const char *path)
{
    struct datadir dir;
    struct recovery r;
    if (!datadir_open(&dir, path, false))
        return 1;
    recovery_init(&r, &dir);
    recovery_run(&r);
    bool corrupt = r.result == RECOVERY_CORRUPT;
    if (corrupt && put_later_aside(&dir, &r.file) && put_rest_aside(&dir, &r.file, r.at)) {
        printf("%s: cut off at byte %" PRIu64 "; what was there is in damaged.*\n", r.file.name,
               r.at);
    } else if (corrupt) {
        printf("cannot put the damaged part aside: %s\n", strerror(errno));
    } else if (r.result == RECOVERY_REFUSED && r.bad_snapshot) {
        printf("%s\n", r.why);
        salvage(&dir);
    } else if (r.result == RECOVERY_OK && !recovery_tidy(&r)) {
        printf("%s\n", r.why);
    }
    recovery_clear(&r);
    datadir_close(&dir);
    return recovery_check(path);
}
