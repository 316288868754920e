/* part_file.c - see part_file.h. */
#include "clients/cli/part_file.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

static const char mark_name[] = "user.delaunay";
enum { MARK_ROOM = 64 };

static size_t write_mark(char *mark, const struct stat *st)
{
    return (size_t)snprintf(mark, MARK_ROOM, "%lld %lld.%09ld", (long long)st->st_size,
                            (long long)st->st_mtim.tv_sec, st->st_mtim.tv_nsec);
}

bool part_file_is_foreign(const char *path)
{
    char want[MARK_ROOM], mark[MARK_ROOM];
    struct stat st;
    if (stat(path, &st) != 0 || !S_ISREG(st.st_mode) || st.st_size == 0)
        return false;
    size_t n = write_mark(want, &st);
    return getxattr(path, mark_name, mark, sizeof mark) != (ssize_t)n || memcmp(mark, want, n) != 0;
}

const char *part_file_open(struct part_file *f, const char *path)
{
    struct stat st;
    f->path = path;
    f->direct = stat(path, &st) == 0 && !S_ISREG(st.st_mode);
    if ((size_t)snprintf(f->part, sizeof f->part, "%s%s", path, f->direct ? "" : ".part") >=
        sizeof f->part) {
        errno = ENAMETOOLONG;
        return path;
    }
    f->out = fopen(f->part, "w");
    return f->out == NULL ? f->part : NULL;
}

bool part_file_close(struct part_file *f)
{
    bool written = !ferror(f->out);
    return fclose(f->out) == 0 && written;
}

bool part_file_adopt(const char *from, const char *path)
{
    char mark[MARK_ROOM];
    struct stat st;
    if (stat(from, &st) ==
        0) /* not all file systems support it: then the file counts as another program's */
        (void)!setxattr(from, mark_name, mark, write_mark(mark, &st), 0);
    return rename(from, path) == 0;
}

bool part_file_keep(struct part_file *f)
{
    return f->direct || part_file_adopt(f->part, f->path);
}

void part_file_drop(struct part_file *f)
{
    if (!f->direct)
        unlink(f->part);
}
