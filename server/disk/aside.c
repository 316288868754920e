/* aside.c - see aside.h. */
#include "server/disk/aside.h"

#include "server/disk/log_file.h"
#include "server/system/own_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FLUSH_BYTES = 1 << 20 };

static const char incoming[] = "incoming", arrived_name[] = "arrived";

/* Removes the files of a folder inside the directory, then the folder. True if there is none. */
static bool remove_folder(const struct datadir *dir, const char *name)
{
    struct datadir folder = {.fd = own_folder_open(dir->fd, name), .path = name};
    if (folder.fd < 0)
        return errno == ENOENT;
    return own_file_close(folder.fd, datadir_empty(&folder)) &&
           unlinkat(dir->fd, name, AT_REMOVEDIR) == 0;
}

/* ---- receiving ---- */

static bool flush(struct aside *a)
{
    bool ok = own_file_write(a->fd, buf_head(&a->out), buf_len(&a->out));
    buf_rewind(&a->out, 0);
    return ok;
}

bool aside_begin(struct aside *a, const struct datadir *dir, const struct segment *header)
{
    char name[DATAFILE_NAME], bytes[SEGMENT_HEADER];
    *a = (struct aside){.dir = dir, .folder = -1, .fd = -1};
    datafile_name(name, DATAFILE_SNAPSHOT, header->lsn);
    if (remove_folder(dir, incoming) && mkdirat(dir->fd, incoming, 0700) == 0 &&
        (a->folder = own_folder_open(dir->fd, incoming)) >= 0)
        a->fd = openat(a->folder, name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    segment_write(bytes, header);
    return a->fd >= 0 && aside_write(a, bytes, sizeof bytes);
}

bool aside_write(struct aside *a, const char *bytes, size_t n)
{
    buf_append(&a->out, bytes, n);
    if (!a->out.failed)
        return buf_len(&a->out) < FLUSH_BYTES || flush(a);
    errno = ENOMEM;
    return false;
}

static void end(struct aside *a)
{
    if (a->fd >= 0)
        close(a->fd);
    buf_free(&a->out);
    a->fd = -1;
    a->dir = NULL;
}

bool aside_complete(struct aside *a, const struct segment *header, struct datadir *arrived)
{
    *arrived = (struct datadir){
        .fd = a->folder, .path = incoming, .lineage = {header->life, header->history}};
    bool ok = flush(a) && fsync(a->fd) == 0 &&
              log_file_begin(arrived, header->lsn + 1, header->digest) && datadir_sync(arrived) &&
              datadir_sync(a->dir);
    int error = errno;
    if (!ok) {
        aside_abandon(a);
        errno = error;
        return false;
    }
    end(a);
    return true;
}

void aside_close(struct datadir *arrived)
{
    close(arrived->fd);
    arrived->fd = -1;
}

void aside_abandon(struct aside *a)
{
    const struct datadir *dir = a->dir;
    if (dir == NULL)
        return;
    end(a);
    if (a->folder >= 0)
        close(a->folder);
    remove_folder(dir, incoming);
}

/* ---- putting it in place ---- */

/* Gives the files of the folder second names in the directory. */
static bool link_files(const struct datadir *dir, const struct datadir *folder)
{
    struct datafiles files;
    if (!datadir_list(folder, &files))
        return false;
    bool ok = true;
    for (size_t i = 0; ok && i < files.n; i++)
        ok = linkat(folder->fd, files.v[i].name, dir->fd, files.v[i].name, 0) == 0;
    datafiles_free(&files);
    return ok;
}

/* `arrived` exists: its files replace the files of the directory. It has to be complete as long as it has that name. */
static bool replace(const struct datadir *dir)
{
    struct datadir folder = {.fd = own_folder_open(dir->fd, arrived_name), .path = arrived_name};
    if (folder.fd < 0)
        return false;
    bool ok = datadir_empty(dir) && link_files(dir, &folder) && datadir_sync(dir);
    return own_file_close(folder.fd, ok) && remove_folder(dir, incoming) &&
           renameat(dir->fd, arrived_name, dir->fd, incoming) == 0 && datadir_sync(dir) &&
           remove_folder(dir, incoming);
}

bool aside_put_in_place(const struct datadir *dir)
{
    return renameat(dir->fd, incoming, dir->fd, arrived_name) == 0 && datadir_sync(dir) &&
           replace(dir);
}

bool aside_open(const struct datadir *dir, struct datadir *arrived)
{
    *arrived = (struct datadir){.fd = own_folder_open(dir->fd, arrived_name), .path = arrived_name};
    return arrived->fd >= 0;
}

bool aside_finish(const struct datadir *dir)
{
    struct datadir arrived;
    bool there = aside_open(dir, &arrived);
    if (there)
        aside_close(&arrived);
    if (there && !replace(dir))
        return false;
    return remove_folder(dir, incoming);
}
