/* log_file.c - see log_file.h. */
#include "server/disk/log_file.h"

#include "proto/records/record.h"
#include "server/system/own_file.h"
#include "server/system/random.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RESERVE_BYTES = 4 << 20, INSPECT_EVERY_MS = 100 };

static const char reserve_name[] = "reserve";

void log_file_init(struct log_file *f, const struct datadir *dir, uint64_t digest)
{
    *f = (struct log_file){.dir = dir,
                           .fd = -1,
                           .lineage = dir->lineage,
                           .version = RECORD_VERSION_PLAIN,
                           .digest = digest};
    if (digest == 0) {
        f->digest = random_bits();
        f->broken = true;
    }
}

void log_file_clear(struct log_file *f)
{
    if (f->fd >= 0)
        close(f->fd);
    f->fd = -1;
}

void log_file_fail(struct log_file *f, int error)
{
    log_file_clear(f);
    f->error = error;
    f->unsynced = false;
}

/* ---- the reserve ---- */

/* The reserve of an earlier start, or a new one. One with a second name is not ours to fill. */
static int open_reserve(int dir)
{
    struct stat st;
    bool there = fstatat(dir, reserve_name, &st, AT_SYMLINK_NOFOLLOW) == 0 && st.st_nlink == 1;
    return there ? own_file_open(dir, reserve_name, O_WRONLY)
                 : own_file_create(dir, reserve_name, O_WRONLY);
}

void log_file_reserve(struct log_file *f)
{
    if (f->reserved)
        return;
    int fd = open_reserve(f->dir->fd);
    int error = fd < 0 ? errno : posix_fallocate(fd, 0, RESERVE_BYTES);
    if (fd >= 0)
        close(fd);
    f->reserved = !own_file_lacks_space(error); /* a file system without fallocate: no reserve */
    f->full_error = error;
    if (error != 0)
        unlinkat(f->dir->fd, reserve_name, 0);
}

/* Frees the reserve; whether another attempt makes sense. */
static bool use_reserve(struct log_file *f, int error)
{
    if (!own_file_lacks_space(error) || !f->reserved)
        return false;
    f->reserved = false;
    f->full_error = error;
    return unlinkat(f->dir->fd, reserve_name, 0) == 0;
}

/* ---- writing ---- */

void log_file_mark(struct log_file *f)
{
    f->mark = f->bytes;
}

static void write_bytes(struct log_file *f, struct buf *b)
{
    if (b->failed && f->error == 0)
        log_file_fail(f, ENOMEM);
    while (f->error == 0 && buf_len(b) > 0) {
        ssize_t n = write(f->fd, buf_head(b), buf_len(b));
        if (n >= 0) {
            buf_consume(b, (size_t)n);
            f->bytes += (uint64_t)n;
            f->unsynced = true;
        } else if (errno != EINTR && !use_reserve(f, errno)) {
            int error = errno;
            /* This makes space for the snapshot that follows; what is cut off was not acknowledged. */
            if (own_file_lacks_space(error) && ftruncate(f->fd, (off_t)f->mark) == 0)
                f->bytes = f->mark;
            log_file_fail(f, error);
        }
    }
}

void log_file_write(struct log_file *f, struct buf *b)
{
    const char *at = buf_head(b), *end = at + buf_len(b);
    /* After a failure the buffer may begin inside a record that was written in part. */
    for (size_t n; f->error == 0 && at < end; at += n) {
        n = RECORD_HEADER + record_outline(at).length;
        f->digest = record_digest(f->digest, at, n);
    }
    write_bytes(f, b);
}

/* A column of values; *lsn is that of the record before, and then of the last one. */
static void write_column(struct log_file *f, const struct columns *v, size_t column,
                         uint64_t synced, uint64_t *lsn, struct buf *out)
{
    struct record r = {.type = RECORD_VALUES,
                       .synced = synced,
                       .field = v->field[column].text,
                       .field_len = v->field[column].len};
    uint32_t at = 0;
    do {
        r.lsn = ++*lsn;
        r.first = v->first + at;
        r.n = v->n - at < RECORD_MOST_VALUES ? v->n - at : RECORD_MOST_VALUES;
        r.items = r.n > 0 ? v->v + column * (size_t)v->n + at : NULL; /* a field without values */
        record_write(out, &r);
        log_file_write(f, out);
        at += r.n;
    } while (at < v->n && f->error == 0);
}

/* Items of r->type, n of them, behind the record r, which becomes the last of theirs. */
static void write_items(struct log_file *f, struct record *r, const void *items, uint32_t n,
                        struct buf *out)
{
    const size_t size = record_item_size(r->type); /* in memory, too */
    const uint32_t most = record_most(r->type);
    for (uint32_t at = 0; at < n && f->error == 0; at += r->n) {
        r->lsn++;
        r->n = n - at < most ? n - at : most;
        r->items = (const char *)items + at * size;
        record_write(out, r);
        log_file_write(f, out);
    }
}

void log_file_write_load(struct log_file *f, const struct record *load, const void *items,
                         const struct columns *v, const struct pslg_lists *d)
{
    struct buf out = {0};
    struct record r = *load;
    r.type = RECORD_LOAD;
    r.n = 0;
    record_write(&out, &r);
    r.type = load->type;
    r.name_len = 0;
    write_items(f, &r, items, load->n, &out);
    for (size_t i = 0; v != NULL && i < v->count && f->error == 0; i++)
        write_column(f, v, i, load->synced, &r.lsn, &out);
    r.type = RECORD_RELEASE;
    write_items(f, &r, d->released, d->n_released, &out);
    r.type = RECORD_CONSTRAIN;
    write_items(f, &r, d->added, d->n_added, &out);
    r.lsn++;
    r.type = RECORD_LOADED;
    r.name_len = load->name_len;
    r.n = load->n + d->n_released + d->n_added;
    record_write(&out, &r);
    log_file_write(f, &out);
    buf_free(&out);
}

void log_file_sync(struct log_file *f)
{
    if (f->error != 0 || !f->unsynced)
        return;
    if (fdatasync(f->fd) != 0) {
        log_file_fail(f, errno);
        return;
    }
    f->unsynced = false;
    f->syncs++;
}

static bool has_its_name(const struct log_file *f)
{
    char name[DATAFILE_NAME];
    struct stat own, there;
    datafile_name(name, DATAFILE_LOG, f->first);
    errno = ENOENT;
    return fstat(f->fd, &own) != 0 ||
           (fstatat(f->dir->fd, name, &there, AT_SYMLINK_NOFOLLOW) == 0 &&
            there.st_ino == own.st_ino && there.st_dev == own.st_dev);
}

void log_file_inspect(struct log_file *f, int64_t now_ms)
{
    if (f->error != 0 || now_ms - f->inspected_ms < INSPECT_EVERY_MS)
        return;
    f->inspected_ms = now_ms;
    if (!datadir_in_place(f->dir) || !has_its_name(f))
        log_file_fail(f, errno);
}

/* Writes the header of a new segment; it is durable then, or the file has failed. */
static void write_header(struct log_file *f)
{
    struct segment header = {.version = f->version,
                             .kind = SEGMENT_LOG,
                             .lsn = f->first,
                             .life = f->lineage.life,
                             .history = f->lineage.history,
                             .digest = f->digest_before,
                             .flags = f->broken ? SEGMENT_BROKEN : 0};
    struct buf b = {0};
    segment_append(&b, &header);
    log_file_mark(f);
    write_bytes(f, &b);
    log_file_sync(f);
    log_file_mark(f);
    buf_free(&b);
}

/* Begins the segment's file under a temporary name, and gives it its own when the header is durable: so a segment whose
 * header is not whole is damaged. If a file of that name exists, an earlier sync of the name may have failed, and later
 * syncs need not cover it. The new file replaces it, and the next sync does cover the name of the new file. */
static void begin_segment(struct log_file *f)
{
    char temporary[DATAFILE_NAME], name[DATAFILE_NAME];
    struct stat st;
    int dir = f->dir->fd;
    datafile_name(temporary, DATAFILE_TEMPORARY, f->first);
    datafile_name(name, DATAFILE_LOG, f->first);
    f->fd = own_file_create(dir, temporary, O_WRONLY | O_APPEND);
    if (f->fd < 0) {
        log_file_fail(f, errno);
        return;
    }
    write_header(f);
    bool created = fstatat(dir, name, &st, AT_SYMLINK_NOFOLLOW) != 0;
    if (f->error == 0 && renameat(dir, temporary, dir, name) != 0)
        log_file_fail(f, errno);
    if (f->error != 0) {
        unlinkat(dir, temporary, 0);
        return;
    }
    if (datadir_sync(f->dir)) {
        f->broken = false;
        return;
    }
    log_file_fail(f, errno);
    /* Its name may never become durable. If the file stayed, a snapshot would remove the segments before
     * it, and a power failure could leave no segment at all. */
    if (created)
        unlinkat(dir, name, 0);
}

void log_file_start(struct log_file *f, uint64_t first)
{
    if (f->fd >= 0 && f->first == first && f->bytes == SEGMENT_HEADER && !f->renamed)
        return; /* it is new already */
    log_file_sync(f);
    if (f->error != 0)
        return;
    log_file_clear(f);
    f->renamed = false;
    f->first = first;
    f->digest_before = f->digest;
    f->before += f->bytes;
    f->bytes = 0;
    if (datadir_in_place(f->dir))
        begin_segment(f);
    else
        log_file_fail(f, errno);
}

void log_file_restart(struct log_file *f, uint64_t first, uint64_t digest)
{
    f->error = 0;
    f->digest = digest;
    f->broken = true;
    log_file_start(f, first);
}

bool log_file_begin(const struct datadir *dir, uint64_t first, uint64_t digest)
{
    struct log_file f;
    log_file_init(&f, dir, digest);
    log_file_start(&f, first);
    log_file_clear(&f);
    errno = f.error;
    return f.error == 0;
}
