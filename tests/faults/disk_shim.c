/* disk_shim.c - a failing disk, loaded into a daemon with LD_PRELOAD.
 *
 *     DISK_DIR     calls on files below this directory count
 *     DISK_OP      which ones: write, short (a write that writes half), sync, rename, open, stall
 *                  (an open that takes DISK_ERRNO milliseconds)
 *     DISK_NTH     the first call that fails, counted from 1
 *     DISK_TIMES   how many fail from that one on
 *     DISK_ERRNO   the error
 *     DISK_FIRED   a file that is created when the first call has failed
 *     DISK_GATE    as long as a file of that name exists, syncs wait */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long calls;

static void *real(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

static bool is_below(int fd)
{
    char link[64], path[512];
    const char *dir = getenv("DISK_DIR");
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t n = dir == NULL ? -1 : readlink(link, path, sizeof path - 1);
    return n >= (ssize_t)strlen(dir) && strncmp(path, dir, strlen(dir)) == 0;
}

static void note(void)
{
    int (*open_file)(int, const char *, int, ...) =
        (int (*)(int, const char *, int, ...))real("openat");
    const char *path = getenv("DISK_FIRED");
    int fd = path == NULL ? -1 : open_file(AT_FDCWD, path, O_WRONLY | O_CREAT, 0600);
    if (fd >= 0)
        close(fd);
}

static bool strikes(const char *op, int fd)
{
    const char *wanted = getenv("DISK_OP"), *nth = getenv("DISK_NTH"),
               *times = getenv("DISK_TIMES");
    if (wanted == NULL || nth == NULL || strcmp(wanted, op) != 0 || !is_below(fd))
        return false;
    long call = atomic_fetch_add(&calls, 1) + 1, first = atol(nth);
    bool yes = call >= first && call < first + (times == NULL ? 1 : atol(times));
    if (yes) {
        note();
        errno = getenv("DISK_ERRNO") == NULL ? EIO : atoi(getenv("DISK_ERRNO"));
    }
    return yes;
}

ssize_t write(int fd, const void *bytes, size_t n)
{
    ssize_t (*call)(int, const void *, size_t) =
        (ssize_t(*)(int, const void *, size_t))real("write");
    if (strikes("write", fd))
        return -1;
    return call(fd, bytes, n > 1 && strikes("short", fd) ? n / 2 : n);
}

static void wait_at_gate(int fd)
{
    const char *gate = getenv("DISK_GATE");
    while (gate != NULL && access(gate, F_OK) == 0 && is_below(fd))
        usleep(1000);
}

int fdatasync(int fd)
{
    int (*call)(int) = (int (*)(int))real("fdatasync");
    wait_at_gate(fd);
    return strikes("sync", fd) ? -1 : call(fd);
}

int fsync(int fd)
{
    int (*call)(int) = (int (*)(int))real("fsync");
    wait_at_gate(fd);
    return strikes("sync", fd) ? -1 : call(fd);
}

int renameat(int from, const char *name, int to, const char *new_name)
{
    int (*call)(int, const char *, int, const char *) =
        (int (*)(int, const char *, int, const char *))real("renameat");
    return strikes("rename", from) ? -1 : call(from, name, to, new_name);
}

int openat(int dir, const char *name, int flags, ...)
{
    int (*call)(int, const char *, int, ...) = (int (*)(int, const char *, int, ...))real("openat");
    va_list ap;
    va_start(ap, flags);
    unsigned mode = flags & O_CREAT ? va_arg(ap, unsigned) : 0;
    va_end(ap);
    if (strikes("stall", dir))
        usleep((useconds_t)errno * 1000);
    return strikes("open", dir) ? -1 : call(dir, name, flags, mode);
}
