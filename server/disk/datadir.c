/* datadir.c - see datadir.h. The lock is flock on the directory itself: it ends with the process and leaves
 * no file behind. */
#include "server/disk/datadir.h"

#include "server/system/notice.h"
#include "server/system/own_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MODE = 0700 }; /* of a directory that is created */

/* Makes the directory's own name durable. If the parent cannot be opened, that is not possible, and no
 * error. */
static bool sync_parent(const struct datadir *d)
{
    int fd = openat(d->fd, "..", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return own_file_close(fd, fd < 0 || fsync(fd) == 0);
}

static bool lock(struct datadir *d)
{
    if (flock(d->fd, LOCK_EX | LOCK_NB) == 0)
        return true;
    if (errno == EWOULDBLOCK)
        return notice_error("%s is in use by another process", d->path);
    return notice_error("cannot lock %s: %s", d->path, strerror(errno));
}

static bool open_locked(struct datadir *d)
{
    d->fd = open(d->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (d->fd < 0)
        notice_error("cannot open %s: %s", d->path, strerror(errno));
    if (d->fd >= 0 && lock(d))
        return true;
    datadir_close(d);
    return false;
}

/* Whether the directory has been removed and must be created again. If an earlier start could not sync the
 * parent, a later sync need not cover the name; and the directory stays empty until that sync has
 * succeeded. So an empty one is removed here, unless its owner or mode shows that an operator created it.
 * A directory without a link was removed by another process before this one had the lock. */
static bool remove_unused(const struct datadir *d, bool made)
{
    struct stat st;
    if (fstat(d->fd, &st) != 0)
        return false;
    bool ours = st.st_uid == geteuid() && (st.st_mode & 07777) == MODE;
    return st.st_nlink == 0 || (!made && ours && unlinkat(AT_FDCWD, d->path, AT_REMOVEDIR) == 0);
}

/* Whether there is nothing that would be opened but must not be. */
static bool is_all_own(const struct datadir *d)
{
    static const char *const files[] = {"reserve", "role"}, *const folders[] = {"incoming",
                                                                                "arrived"};
    struct datafiles found;
    bool ok = datadir_list(d, &found);
    if (!ok)
        notice_error("cannot list %s: %s", d->path, strerror(errno));
    for (size_t i = 0; ok && i < found.n; i++)
        ok = own_file_admits(d->fd, d->path, found.v[i].name, false);
    for (size_t i = 0; ok && i < sizeof files / sizeof files[0]; i++)
        ok = own_file_admits(d->fd, d->path, files[i], false) &&
             own_file_admits(d->fd, d->path, folders[i], true);
    datafiles_free(&found);
    return ok;
}

static bool open_any(struct datadir *d, const char *path, bool create)
{
    *d = (struct datadir){.fd = -1, .path = path};
    for (;;) {
        bool made = create && mkdir(path, MODE) == 0;
        if (create && !made && errno != EEXIST)
            return notice_error("cannot create %s: %s", path, strerror(errno));
        if (!open_locked(d))
            return false;
        if (!create || !remove_unused(d, made))
            break;
        datadir_close(d);
    }
    if (!create || sync_parent(d))
        return true;
    notice_error("cannot sync the parent of %s: %s", path, strerror(errno));
    datadir_close(d);
    return false;
}

bool datadir_open(struct datadir *d, const char *path, bool create)
{
    if (!open_any(d, path, create))
        return false;
    d->placed = true;
    if (is_all_own(d))
        return true;
    datadir_close(d);
    return false;
}

void datadir_close(struct datadir *d)
{
    if (d->fd >= 0)
        close(d->fd);
    d->fd = -1;
}

/* ---- its place ---- */

/* Only what is certain counts: if a parent may not be searched, nothing is known. */
static bool is_absence(int error)
{
    return error == ENOENT || error == ENOTDIR || error == ELOOP;
}

bool datadir_in_place(const struct datadir *d)
{
    struct stat own, there;
    if (!d->placed || fstat(d->fd, &own) != 0)
        return true;
    bool found = stat(d->path, &there) == 0;
    if (!found && !is_absence(errno))
        return true;
    errno = found ? ESTALE : ENOENT;
    return found && there.st_dev == own.st_dev && there.st_ino == own.st_ino;
}

/* Nothing is hidden by that: what was deleted does not come back. All users of the descriptor have the new directory from
 * now on, and the old one, with its lock, is closed. */
static bool take_empty(const struct datadir *d)
{
    struct stat own;
    struct datadir other = {.fd = open(d->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC),
                            .path = d->path};
    bool ok = other.fd >= 0 && fstat(d->fd, &own) == 0 && own.st_nlink == 0 &&
              own_folder_is_empty(other.fd) && flock(other.fd, LOCK_EX | LOCK_NB) == 0 &&
              sync_parent(&other) && dup3(other.fd, d->fd, O_CLOEXEC) >= 0;
    return own_file_close(other.fd, ok);
}

bool datadir_regain(const struct datadir *d)
{
    if (datadir_in_place(d))
        return true;
    int error = errno;
    bool taken = error == ESTALE && take_empty(d);
    errno = error;
    return taken;
}

const char *datadir_error(int error)
{
    if (error == ENOENT)
        return "the data directory, or the log in it, is gone; the daemon continues when the "
               "directory is back";
    if (error == ESTALE)
        return "another directory is in the place of the data directory; the daemon continues when "
               "its own is back";
    return strerror(error);
}

/* ---- names ---- */

static const char *const prefix[] = {"snapshot.", "log."};

void datafile_name(char name[DATAFILE_NAME], enum datafile_kind kind, uint64_t lsn)
{
    snprintf(name, DATAFILE_NAME, "%s%016" PRIx64 "%s",
             prefix[kind == DATAFILE_LOG ? DATAFILE_LOG : DATAFILE_SNAPSHOT], lsn,
             kind == DATAFILE_TEMPORARY ? ".tmp" : "");
}

/* Whether the name is exactly one that datafile_name makes. */
static bool parse_name(const char *name, struct datafile *f)
{
    for (int kind = DATAFILE_SNAPSHOT; kind <= DATAFILE_TEMPORARY; kind++) {
        const char *start = prefix[kind == DATAFILE_LOG];
        if (strncmp(name, start, strlen(start)) != 0)
            continue;
        f->kind = (enum datafile_kind)kind;
        f->lsn = strtoull(name + strlen(start), NULL, 16);
        datafile_name(f->name, f->kind, f->lsn);
        if (strcmp(f->name, name) == 0)
            return f->kind != DATAFILE_LOG || f->lsn > 0;
    }
    return false;
}

/* Whether a daemon that has a log makes files of that name. */
static bool shows_use(const char *name)
{
    return strcmp(name, "reserve") == 0 || strcmp(name, "role") == 0 ||
           strncmp(name, "damaged.", strlen("damaged.")) == 0;
}

static int by_kind_and_lsn(const void *a, const void *b)
{
    const struct datafile *x = a, *y = b;
    if (x->kind != y->kind)
        return x->kind < y->kind ? -1 : 1;
    return x->lsn < y->lsn ? -1 : x->lsn > y->lsn;
}

static bool append(struct datafiles *files, size_t *cap, const struct datafile *f)
{
    if (files->n == *cap) {
        size_t larger = *cap == 0 ? 16 : 2 * *cap;
        struct datafile *v = realloc(files->v, larger * sizeof *v);
        if (v == NULL)
            return false;
        files->v = v;
        *cap = larger;
    }
    files->v[files->n++] = *f;
    return true;
}

bool datadir_list(const struct datadir *d, struct datafiles *files)
{
    size_t cap = 0;
    bool ok = true;
    *files = (struct datafiles){0};
    DIR *dir = own_folder_names(d->fd);
    if (dir == NULL)
        return false;
    errno = 0;
    for (struct dirent *e; ok && (e = readdir(dir)) != NULL;) {
        struct datafile f;
        struct stat st;
        files->used = files->used || shows_use(e->d_name);
        if (!parse_name(e->d_name, &f))
            continue;
        f.bytes = fstatat(d->fd, f.name, &st, AT_SYMLINK_NOFOLLOW) == 0 ? (uint64_t)st.st_size : 0;
        ok = append(files, &cap, &f);
        errno = ok ? 0 : ENOMEM;
    }
    int error = errno;
    closedir(dir);
    if (error == 0) {
        if (files->n > 0)
            qsort(files->v, files->n, sizeof *files->v, by_kind_and_lsn);
        return true;
    }
    datafiles_free(files);
    errno = error;
    return false;
}

void datafiles_free(struct datafiles *files)
{
    free(files->v);
    *files = (struct datafiles){0};
}

bool datadir_find(const struct datadir *d, enum datafile_kind kind, uint64_t most,
                  struct datafile *out)
{
    struct datafiles files;
    bool found = false;
    if (!datadir_list(d, &files))
        return false;
    for (size_t i = 0; i < files.n; i++) {
        if (files.v[i].kind != kind || files.v[i].lsn > most)
            continue;
        *out = files.v[i];
        found = true;
    }
    datafiles_free(&files);
    return found;
}

bool datadir_empty(const struct datadir *d)
{
    struct datafiles files;
    int error = 0;
    if (!datadir_list(d, &files))
        return false;
    for (size_t i = 0; i < files.n; i++)
        if (unlinkat(d->fd, files.v[i].name, 0) != 0)
            error = errno;
    datafiles_free(&files);
    errno = error;
    return error == 0;
}

bool datadir_sync(const struct datadir *d)
{
    return fsync(d->fd) == 0;
}

/* ---- putting aside ---- */

/* Calls `make` with the first free name; returns its result, or -1 with errno. `make` fails with EEXIST if
 * the name is not free. */
static int make_aside(const struct datadir *d, const struct datafile *f, char name[DATADIR_ASIDE],
                      int (*make)(const struct datadir *, const struct datafile *, const char *))
{
    enum { REPAIRS = 100 };
    snprintf(name, DATADIR_ASIDE, "damaged.%s", f->name);
    int made = make(d, f, name);
    for (int i = 2; made < 0 && errno == EEXIST && i < REPAIRS; i++) {
        snprintf(name, DATADIR_ASIDE, "damaged.%s.%d", f->name, i);
        made = make(d, f, name);
    }
    return made;
}

static int make_file(const struct datadir *d, const struct datafile *f, const char *name)
{
    enum { FLAGS = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC };
    return openat(d->fd, name, FLAGS, 0600);
}

static bool is_same_file(const struct datadir *d, const char *a, const char *b)
{
    struct stat x, y;
    enum { SELF = AT_SYMLINK_NOFOLLOW };
    return fstatat(d->fd, a, &x, SELF) == 0 && fstatat(d->fd, b, &y, SELF) == 0 &&
           x.st_ino == y.st_ino && x.st_dev == y.st_dev;
}

/* If the file has that name already, it is from an interrupted repair, whose sync may have failed. The
 * link is made again, so that there is something to sync. */
static int make_link(const struct datadir *d, const struct datafile *f, const char *name)
{
    int made = linkat(d->fd, f->name, d->fd, name, 0);
    if (made == 0 || errno != EEXIST)
        return made;
    if (is_same_file(d, f->name, name))
        return unlinkat(d->fd, name, 0) == 0 ? linkat(d->fd, f->name, d->fd, name, 0) : -1;
    errno = EEXIST;
    return -1;
}

bool datadir_link_aside(const struct datadir *d, const struct datafile *f)
{
    char name[DATADIR_ASIDE];
    return make_aside(d, f, name, make_link) == 0;
}

bool datadir_put_aside(const struct datadir *d, const struct datafile *f)
{
    return datadir_link_aside(d, f) && datadir_sync(d) && unlinkat(d->fd, f->name, 0) == 0;
}

/* Copies the bytes after byte `at`, up to byte `end`. Fails with ECANCELED once *cancel is set; cancel may be
 * NULL. */
static bool copy_rest(int from, int to, uint64_t at, uint64_t end, const atomic_bool *cancel)
{
    char block[1 << 16];
    ssize_t n = 1;
    if (lseek(from, (off_t)at, SEEK_SET) < 0)
        return false;
    while (at < end && n > 0) {
        n = read(from, block, end - at < sizeof block ? (size_t)(end - at) : sizeof block);
        if (cancel != NULL && *cancel) {
            errno = ECANCELED;
            return false;
        }
        if (n < 0 || !own_file_write(to, block, (size_t)n))
            return false;
        at += (uint64_t)n;
    }
    return fsync(to) == 0;
}

/* Removes an incomplete file; preserves errno. */
static void discard(const struct datadir *d, const char *name)
{
    int error = errno;
    unlinkat(d->fd, name, 0);
    errno = error;
}

bool datadir_copy_aside(const struct datadir *d, const struct datafile *f, uint64_t at,
                        char name[DATADIR_ASIDE])
{
    int from = own_file_open(d->fd, f->name, O_RDONLY);
    int to = from < 0 ? -1 : make_aside(d, f, name, make_file);
    bool ok = to >= 0 && copy_rest(from, to, at, UINT64_MAX, NULL) && datadir_sync(d);
    own_file_close(from, ok);
    own_file_close(to, ok);
    if (to >= 0 && !ok)
        discard(d, name);
    return ok;
}

bool datadir_copy_to(const struct datadir *d, const struct datafile *f, int to,
                     const atomic_bool *cancel)
{
    struct datadir target = {.fd = to};
    struct stat st;
    int from = own_file_open(d->fd, f->name, O_RDONLY);
    int copy = from < 0 ? -1 : make_file(&target, f, f->name);
    bool ok = copy >= 0 && copy_rest(from, copy, 0, f->bytes, cancel) && fstat(copy, &st) == 0;
    if (ok && (uint64_t)st.st_size < f->bytes) {
        errno = ESTALE;
        ok = false;
    }
    own_file_close(from, ok);
    return own_file_close(copy, ok);
}

bool datadir_cut(const struct datadir *d, const struct datafile *f, uint64_t at)
{
    if (!datadir_unshare(d, f))
        return false;
    int fd = own_file_open(d->fd, f->name, O_WRONLY);
    return own_file_close(fd, fd >= 0 && ftruncate(fd, (off_t)at) == 0 && fsync(fd) == 0);
}

/* ---- after failed syncs ---- */

/* A failed sync may have marked pages as clean that are not on the disk; writing marks them as dirty. */
static bool write_again(int fd, uint64_t at)
{
    char block[1 << 16];
    for (;;) {
        ssize_t n = pread(fd, block, sizeof block, (off_t)at);
        if (n == 0)
            return true;
        if (n < 0 || lseek(fd, (off_t)at, SEEK_SET) < 0 || !own_file_write(fd, block, (size_t)n))
            return false;
        at += (uint64_t)n;
    }
}

bool datadir_save_again(const struct datadir *d, const struct datafile *f, uint64_t at)
{
    int fd = own_file_open(d->fd, f->name, O_RDWR);
    return own_file_close(fd, fd >= 0 && write_again(fd, at) && fdatasync(fd) == 0);
}

bool datadir_copy_again(const struct datadir *d, const struct datafile *f,
                        const atomic_bool *cancel)
{
    char temporary[DATAFILE_NAME];
    datafile_name(temporary, DATAFILE_TEMPORARY, f->lsn);
    int from = own_file_open(d->fd, f->name, O_RDONLY);
    int to = from < 0 ? -1 : own_file_create(d->fd, temporary, O_WRONLY);
    bool ok = to >= 0 && copy_rest(from, to, 0, UINT64_MAX, cancel);
    own_file_close(from, ok);
    ok = own_file_close(to, ok) && renameat(d->fd, temporary, d->fd, f->name) == 0;
    if (!ok && to >= 0)
        discard(d, temporary);
    return ok && datadir_sync(d);
}

bool datadir_unshare(const struct datadir *d, const struct datafile *f)
{
    struct stat st;
    if (fstatat(d->fd, f->name, &st, AT_SYMLINK_NOFOLLOW) != 0)
        return false;
    return st.st_nlink == 1 || datadir_copy_again(d, f, NULL);
}

/* ---- removing what a snapshot covers ---- */

/* Whether file i is a segment all of whose changes a snapshot up to lsn has. */
static bool is_covered(const struct datafiles *files, size_t i, uint64_t lsn)
{
    const struct datafile *f = &files->v[i];
    return f->kind == DATAFILE_LOG && i + 1 < files->n && f[1].kind == DATAFILE_LOG &&
           f[1].lsn <= lsn + 1;
}

/* The first of the last segments that stay although they are covered. */
static size_t first_kept(const struct datadir *d, const struct datafiles *files, uint64_t lsn)
{
    size_t room = d->keep_log, i = files->n;
    for (; i > 0; i--) {
        if (!is_covered(files, i - 1, lsn))
            continue;
        if (files->v[i - 1].bytes >= room)
            break;
        room -= files->v[i - 1].bytes;
    }
    return i;
}

bool datadir_keeps(const struct datadir *d)
{
    struct datafiles files;
    uint64_t newest = 0;
    bool keeps = false;
    if (!datadir_list(d, &files))
        return false;
    for (size_t i = 0; i < files.n; i++) /* snapshots come first */
        if (files.v[i].kind == DATAFILE_SNAPSHOT)
            newest = files.v[i].lsn;
        else
            keeps = keeps || is_covered(&files, i, newest);
    datafiles_free(&files);
    return keeps;
}

static void forget(const struct datadir *d, uint64_t lsn)
{
    struct datafiles files;
    if (!datadir_list(d, &files))
        return;
    size_t from = first_kept(d, &files, lsn);
    for (size_t i = 0; i < files.n; i++) { /* the oldest first, so that what stays has no gap */
        const struct datafile *f = &files.v[i];
        if (f->kind == DATAFILE_LOG ? is_covered(&files, i, lsn) && i < from : f->lsn < lsn)
            unlinkat(d->fd, f->name, 0);
    }
    datafiles_free(&files);
}

void datadir_forget(struct datadir *d, uint64_t lsn)
{
    d->covered = lsn;
    if (d->pins == 0)
        forget(d, lsn);
}

void datadir_pin(struct datadir *d)
{
    d->pins++;
}

void datadir_unpin(struct datadir *d)
{
    if (--d->pins == 0 && d->covered > 0)
        forget(d, d->covered);
}
