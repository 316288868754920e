/* own_file.c - see own_file.h. A file is judged before it is opened, because opening a device may have effects, and again
 * afterwards, because another one may have taken its name meanwhile. */
#include "server/system/own_file.h"

#include "server/system/notice.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SAFELY = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, MODE = 0600 };

static const char *kind_of(const struct stat *st)
{
    switch (st->st_mode & S_IFMT) {
    case S_IFLNK:
        return "a symbolic link";
    case S_IFIFO:
        return "a pipe";
    case S_IFSOCK:
        return "a socket";
    case S_IFDIR:
        return "a directory";
    case S_IFREG:
        return "a file";
    default:
        return "a device";
    }
}

/* Whether the directory's owner or this process owns it. */
static bool is_own(int dir, const struct stat *st)
{
    struct stat of;
    return st->st_uid == geteuid() || (fstat(dir, &of) == 0 && st->st_uid == of.st_uid);
}

static bool judge(int dir, const char *path, const char *name, const struct stat *st, bool folder)
{
    const char *slash = path[0] == '\0' ? "" : "/";
    if (folder ? !S_ISDIR(st->st_mode) : !S_ISREG(st->st_mode))
        notice_error("%s%s%s is %s and not a %s; it is not opened", path, slash, name, kind_of(st),
                     folder ? "directory" : "regular file");
    else if (!is_own(dir, st))
        notice_error("%s%s%s belongs to user %u, but delaunayd runs as user %u; it is not opened",
                     path, slash, name, (unsigned)st->st_uid, (unsigned)geteuid());
    else
        return true;
    errno = EINVAL;
    return false;
}

bool own_file_admits(int dir, const char *path, const char *name, bool folder)
{
    struct stat st;
    return fstatat(dir, name, &st, AT_SYMLINK_NOFOLLOW) != 0 || judge(dir, path, name, &st, folder);
}

int own_file_open(int dir, const char *name, int flags)
{
    struct stat st;
    if (!own_file_admits(dir, "", name, false))
        return -1;
    int fd = openat(dir, name, flags | SAFELY);
    if (fd < 0 || (fstat(fd, &st) == 0 && judge(dir, "", name, &st, false)))
        return fd;
    own_file_close(fd, false);
    return -1;
}

int own_file_create(int dir, const char *name, int flags)
{
    for (;;) {
        int fd = openat(dir, name, flags | O_CREAT | O_EXCL | SAFELY, MODE);
        if (fd >= 0 || errno != EEXIST || unlinkat(dir, name, 0) != 0)
            return fd;
    }
}

bool own_file_write(int fd, const char *bytes, size_t n)
{
    while (n > 0) {
        ssize_t wrote = write(fd, bytes, n);
        if (wrote < 0 && errno != EINTR)
            return false;
        if (wrote > 0) {
            bytes += wrote;
            n -= (size_t)wrote;
        }
    }
    return true;
}

bool own_file_close(int fd, bool ok)
{
    int error = errno;
    if (fd >= 0)
        close(fd);
    errno = error;
    return ok;
}

/* ---- folders ---- */

int own_folder_open(int dir, const char *name)
{
    return openat(dir, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

DIR *own_folder_names(int dir)
{
    int fd = own_folder_open(dir, ".");
    DIR *names = fd < 0 ? NULL : fdopendir(fd);
    if (names == NULL)
        own_file_close(fd, false);
    return names;
}

bool own_folder_is_empty(int dir)
{
    const struct dirent *e;
    DIR *names = own_folder_names(dir);
    if (names == NULL)
        return false;
    errno = 0;
    do
        e = readdir(names);
    while (e != NULL && (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0));
    bool empty = e == NULL && errno == 0;
    closedir(names);
    return empty;
}
