/* backup.c - see backup.h. */
#include "server/disk/backup.h"

#include "server/system/own_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MODE = 0700, ATTEMPTS = 10 };

static const char unfinished[] = ".tmp";

static bool ends_unfinished(const char *text, size_t len)
{
    size_t n = sizeof unfinished - 1;
    return len >= n && memcmp(text + len - n, unfinished, n) == 0;
}

bool backup_may_name(const char *text, size_t len)
{
    static const char allowed[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.:-";
    if (len < 1 || len > BACKUP_NAME_LIMIT || text[0] == '.' || ends_unfinished(text, len))
        return false;
    for (size_t i = 0; i < len; i++)
        if (text[i] == '\0' || strchr(allowed, text[i]) == NULL)
            return false;
    return true;
}

/* ---- the directory of backups ---- */

/* Removes an incomplete backup. Other files in the directory stay, and then the directory stays, too. */
static void remove_unfinished(int under, const char *name)
{
    struct datadir d = {.fd = own_folder_open(under, name)};
    if (d.fd >= 0)
        own_file_close(d.fd, datadir_empty(&d));
    unlinkat(under, name, AT_REMOVEDIR);
}

/* Removes those of killed daemons. */
static void remove_all_unfinished(int under)
{
    DIR *names = own_folder_names(under);
    if (names == NULL)
        return;
    for (const struct dirent *e; (e = readdir(names)) != NULL;)
        if (ends_unfinished(e->d_name, strlen(e->d_name)))
            remove_unfinished(under, e->d_name);
    closedir(names);
}

/* Opens the directory of backups, which is created if it is missing. -1 with errno. */
static int open_under(const char *path)
{
    bool made = mkdir(path, MODE) == 0;
    int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    int parent = !made || fd < 0 ? -1 : openat(fd, "..", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (parent >= 0) {
        fsync(parent); /* best effort: the reply says that the backup is complete */
        close(parent);
    }
    return fd;
}

/* Whether there is something of that name that a rename would not replace. */
static bool is_taken(int under, const char *name)
{
    struct stat st;
    if (fstatat(under, name, &st, AT_SYMLINK_NOFOLLOW) != 0)
        return false; /* if there is something, the rename reports it */
    int fd = S_ISDIR(st.st_mode) ? own_folder_open(under, name) : -1;
    return own_file_close(fd, fd < 0 || !own_folder_is_empty(fd));
}

/* ---- the files ---- */

/* The moment that a backup shows: the first `bytes` bytes of this segment, and everything before it. */
struct moment {
    uint64_t segment, bytes, lsn;
};

/* Waits until the changes up to b->least are durable. */
static enum backup_result await_log(struct backup *b, struct moment *m)
{
    struct log_status st;
    for (;;) {
        log_status(b->log, &st);
        *m = (struct moment){st.segment, st.bytes, st.durable};
        b->error = st.error;
        if (st.state == LOG_FAILED)
            return BACKUP_LOG_FAILED;
        if (st.durable >= b->least)
            return BACKUP_OK;
        if (*b->cancel)
            return BACKUP_CANCELLED;
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL); /* a sync takes about as long */
    }
}

/* The newest snapshot of the files that has no change after the moment; NULL: there is none. */
static const struct datafile *newest(const struct datafiles *files, const struct moment *m)
{
    const struct datafile *found = NULL;
    for (size_t i = 0; i < files->n && files->v[i].kind == DATAFILE_SNAPSHOT; i++)
        if (files->v[i].lsn <= m->lsn)
            found = &files->v[i];
    return found;
}

/* Whether a start with that snapshot, at that moment, would read the segment files->v[i]. */
static bool is_read(const struct datafiles *files, size_t i, uint64_t snapshot,
                    const struct moment *m)
{
    const struct datafile *f = &files->v[i];
    if (f->kind != DATAFILE_LOG || f->lsn > m->segment)
        return false;
    bool covered = i + 1 < files->n && f[1].kind == DATAFILE_LOG && f[1].lsn <= snapshot + 1;
    return f->lsn == m->segment || !covered;
}

static bool is_no_link(int error)
{
    return error == EXDEV || error == EPERM || error == EMLINK || error == EOPNOTSUPP ||
           error == ENOSYS;
}

/* Gives the file a name in the directory `to` as well, or copies it. False with errno. */
static bool put(struct backup *b, const struct datafile *f, bool grows, int to)
{
    if (!own_file_admits(b->dir->fd, b->dir->path, f->name, false))
        return false;
    bool linked = !grows && linkat(b->dir->fd, f->name, to, f->name, 0) == 0;
    if (!linked && !grows && !is_no_link(errno))
        return false;
    if (!linked && !datadir_copy_to(b->dir, f, to, b->cancel))
        return false;
    b->files++;
    b->bytes += f->bytes;
    b->copied += linked ? 0 : f->bytes;
    return true;
}

/* Fills the directory `to` with the state at that moment. False with errno; ENOENT or ESTALE: a file has been removed
 * or replaced meanwhile. */
static bool fill(struct backup *b, const struct moment *m, int to)
{
    struct datafiles files;
    if (!datadir_list(b->dir, &files))
        return false;
    const struct datafile *snapshot = newest(&files, m);
    bool ok = snapshot == NULL || put(b, snapshot, false, to), complete = false;
    for (size_t i = 0; ok && i < files.n; i++) {
        struct datafile f = files.v[i];
        bool grows = f.lsn == m->segment;
        if (!is_read(&files, i, snapshot == NULL ? 0 : snapshot->lsn, m))
            continue;
        f.bytes = grows ? m->bytes : f.bytes;
        complete = complete || grows;
        ok = put(b, &f, grows, to);
    }
    int error = ok && !complete ? ENOENT : errno;
    datafiles_free(&files);
    errno = error;
    return ok && complete;
}

static bool is_cancelled(struct backup *b)
{
    return *b->cancel || b->error == ECANCELED;
}

/* The same, and makes it durable. A snapshot that was written before the files had been pinned, or a log that has
 * continued after a failure, makes another attempt necessary. */
static enum backup_result fill_durably(struct backup *b, int to)
{
    for (int i = 0; i < ATTEMPTS; i++) {
        struct moment m;
        enum backup_result result = await_log(b, &m);
        if (result != BACKUP_OK)
            return result;
        b->lsn = m.lsn;
        b->files = b->bytes = b->copied = 0;
        if (fill(b, &m, to) && fsync(to) == 0)
            return BACKUP_OK;
        b->error = errno;
        if (is_cancelled(b))
            return BACKUP_CANCELLED;
        if (b->error != ENOENT && b->error != ESTALE)
            return BACKUP_ERROR;
        datadir_empty(&(struct datadir){.fd = to});
    }
    return BACKUP_ERROR;
}

/* ---- the whole ---- */

static enum backup_result fail(struct backup *b, enum backup_result result)
{
    b->error = errno;
    return result;
}

/* Gives the complete backup its name. If that cannot be made durable, there is no backup. */
static enum backup_result give_name(struct backup *b, int under, const char *temporary)
{
    if (renameat(under, temporary, under, b->name) != 0)
        return fail(b, errno == EEXIST || errno == ENOTEMPTY ? BACKUP_EXISTS : BACKUP_ERROR);
    if (fsync(under) == 0)
        return BACKUP_OK;
    fail(b, BACKUP_ERROR);
    renameat(under, b->name, under, temporary);
    return BACKUP_ERROR;
}

static enum backup_result write_under(struct backup *b, int under)
{
    char temporary[BACKUP_NAME_LIMIT + sizeof unfinished];
    snprintf(temporary, sizeof temporary, "%s%s", b->name, unfinished);
    if (is_taken(under, b->name))
        return BACKUP_EXISTS;
    remove_all_unfinished(under);
    if (mkdirat(under, temporary, MODE) != 0)
        return fail(b, BACKUP_ERROR);
    int fd = own_folder_open(under, temporary);
    enum backup_result result = fd < 0 ? fail(b, BACKUP_ERROR) : BACKUP_OK;
    if (result == BACKUP_OK) {
        datadir_pin(b->dir);
        result = fill_durably(b, fd);
        datadir_unpin(b->dir);
        close(fd);
    }
    if (result == BACKUP_OK)
        result = give_name(b, under, temporary);
    if (result != BACKUP_OK)
        remove_unfinished(under, temporary);
    return result;
}

enum backup_result backup_write(struct backup *b)
{
    enum backup_result result = BACKUP_BUSY;
    struct stat in, of;
    int under = open_under(b->under);
    if (under < 0)
        return fail(b, BACKUP_ERROR);
    /* The data directory has a lock of its own. */
    bool same = fstat(under, &in) == 0 && fstat(b->dir->fd, &of) == 0 && in.st_dev == of.st_dev &&
                in.st_ino == of.st_ino;
    if (same || flock(under, LOCK_EX | LOCK_NB) == 0) {
        result = same ? BACKUP_ERROR : write_under(b, under);
        b->error = same ? EINVAL : b->error;
    } else if (errno != EWOULDBLOCK) {
        result = fail(b, BACKUP_ERROR);
    }
    close(under);
    return result;
}
