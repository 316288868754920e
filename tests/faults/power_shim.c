/* power_shim.c - records the operations of a daemon on its disk, loaded into it with LD_PRELOAD. A test can compute from
 * them what a power cut might have left (power_cut.h). It also ends the daemon at a given moment, and
 * makes the disk stall, fail and fill up.
 *
 *     POWER_ROOT         files below this directory count
 *     POWER_LOG          the file for the operations (power_log.h)
 *     POWER_FIRST        the number of operations of earlier processes in that file
 *     POWER_CRASH        the daemon ends after this many operations of its own, wherever it is
 *     POWER_SEED         for the random decisions below
 *     POWER_SYNC_FAILS   how many of a thousand syncs fail
 *     POWER_WRITE_FAILS  how many of a thousand writes, renames and openings fail or are cut short
 *     POWER_STALL_US     the longest duration of a sync in microseconds
 *     POWER_SPACE        bytes that the files of one directory may have
 *
 * Nothing is really synced: written bytes survive the daemon anyway. The daemon uses no other calls
 * than those below; the test checks that, by comparing the recorded operations with the files. */
#include "tests/faults/power_log.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum { PATH_LIMIT = 512, EXIT_CRASH = 99 };

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static int log_fd = -1;
static uint64_t operations, last, chance; /* those in the file; it ends with that one */

static void *real(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

static uint64_t setting(const char *name)
{
    const char *text = getenv(name);
    return text == NULL ? 0 : strtoull(text, NULL, 10);
}

__attribute__((constructor)) static void start(void)
{
    const char *path = getenv("POWER_LOG");
    operations = setting("POWER_FIRST");
    last = setting("POWER_CRASH") > 0 ? operations + setting("POWER_CRASH") : 0;
    int flags = O_WRONLY | O_CREAT | O_APPEND | (operations == 0 ? O_TRUNC : 0);
    int fd = path == NULL ? -1 : open(path, flags, 0600);
    log_fd = fd < 0 ? -1 : fcntl(fd, F_DUPFD_CLOEXEC, 200);
    if (fd >= 0)
        close(fd);
    chance = setting("POWER_SEED");
}

/* ---- chance; the mutex is held ---- */

static uint64_t draw(void) /* splitmix64 */
{
    uint64_t z = (chance += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static bool happens(const char *name)
{
    uint64_t per_mille = setting(name);
    return per_mille > 0 && draw() % 1000 < per_mille;
}

/* ---- names ---- */

/* The path relative to the root, NULL if it is not below the root. */
static const char *relative(const char *path)
{
    const char *root = getenv("POWER_ROOT");
    size_t n = root == NULL || log_fd < 0 ? 0 : strlen(root);
    if (n == 0 || strncmp(path, root, n) != 0 || (path[n] != '/' && path[n] != '\0'))
        return NULL;
    return path[n] == '/' ? path + n + 1 : path + n;
}

/* Returns the path of a descriptor, in path. */
static const char *name_of(int fd, char path[PATH_LIMIT])
{
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t n = readlink(link, path, PATH_LIMIT - 1);
    path[n > 0 ? n : 0] = '\0';
    return relative(path);
}

/* Returns the path of a name in a directory. */
static const char *name_in(int dir, const char *name, char path[PATH_LIMIT])
{
    if (name[0] == '/' || dir == AT_FDCWD)
        snprintf(path, PATH_LIMIT, "%s", name);
    else if (name_of(dir, path) == NULL)
        return NULL;
    else
        snprintf(path + strlen(path), PATH_LIMIT - strlen(path), "/%s", name);
    return relative(path);
}

/* ---- recording ---- */

/* The mutex is held. */
static void note(struct power_head h, const char *name, const char *other, const void *data,
                 size_t n)
{
    h.name_len = (uint16_t)strlen(name);
    h.other_len = (uint16_t)strlen(other);
    h.bytes = (uint32_t)(sizeof h + h.name_len + h.other_len + 2u + n);
    struct iovec part[] = {{&h, sizeof h},
                           {(void *)(uintptr_t)name, h.name_len + 1u},
                           {(void *)(uintptr_t)other, h.other_len + 1u},
                           {(void *)(uintptr_t)data, n}};
    if (syscall(SYS_writev, log_fd, part, 4) != (long)h.bytes)
        abort();
    if (++operations == last)
        _exit(EXIT_CRASH);
}

static void lock(void)
{
    pthread_mutex_lock(&mutex);
}

/* Preserves errno. */
static void unlock(void)
{
    int error = errno;
    pthread_mutex_unlock(&mutex);
    errno = error;
}

static bool fails(void)
{
    bool yes = happens("POWER_WRITE_FAILS");
    if (yes)
        errno = draw() % 4 == 0 ? ENOSPC : EIO;
    return yes;
}

/* ---- space ---- */

static uint64_t rounded(uint64_t bytes)
{
    return (bytes + 511) / 512 * 512;
}

/* The bytes used by the files in the directory of this one. */
static uint64_t used_beside(int fd)
{
    char path[PATH_LIMIT];
    struct stat st;
    uint64_t bytes = 0;
    name_of(fd, path);
    *strrchr(path, '/') = '\0';
    DIR *dir = opendir(path);
    for (struct dirent *e; dir != NULL && (e = readdir(dir)) != NULL;)
        if (fstatat(dirfd(dir), e->d_name, &st, 0) == 0 && S_ISREG(st.st_mode))
            bytes += rounded((uint64_t)st.st_size);
    if (dir != NULL)
        closedir(dir);
    return bytes;
}

/* Returns how many of n bytes from the offset on fit. */
static size_t affordable(int fd, uint64_t offset, size_t n)
{
    struct stat st;
    uint64_t space = setting("POWER_SPACE");
    if (space == 0 || fstat(fd, &st) != 0)
        return n;
    uint64_t used = used_beside(fd), own = rounded((uint64_t)st.st_size);
    uint64_t end = own + (used < space ? (space - used) / 512 * 512 : 0);
    return end <= offset ? 0 : end - offset < n ? (size_t)(end - offset) : n;
}

/* ---- data ---- */

ssize_t write(int fd, const void *bytes, size_t n)
{
    ssize_t (*call)(int, const void *, size_t) =
        (ssize_t(*)(int, const void *, size_t))real("write");
    char path[PATH_LIMIT];
    struct stat st;
    if (name_of(fd, path) == NULL)
        return call(fd, bytes, n);
    lock();
    ssize_t done = -1;
    bool append = (fcntl(fd, F_GETFL) & O_APPEND) != 0 && fstat(fd, &st) == 0;
    uint64_t at = (uint64_t)(append ? st.st_size : lseek(fd, 0, SEEK_CUR));
    size_t most = affordable(fd, at, n);
    if (most == 0 && n > 0) {
        errno = ENOSPC;
    } else if (!fails()) {
        done = call(fd, bytes, most > 1 && happens("POWER_WRITE_FAILS") ? most / 2 : most);
        if (done > 0)
            note((struct power_head){.kind = POWER_WRITE, .fd = fd, .a = at}, "", "", bytes,
                 (size_t)done);
    }
    unlock();
    return done;
}

int ftruncate(int fd, off_t size)
{
    int (*call)(int, off_t) = (int (*)(int, off_t))real("ftruncate");
    char path[PATH_LIMIT];
    if (name_of(fd, path) == NULL)
        return call(fd, size);
    lock();
    int result = fails() ? -1 : call(fd, size);
    if (result == 0)
        note((struct power_head){.kind = POWER_SIZE, .fd = fd, .a = (uint64_t)size}, "", "", "", 0);
    unlock();
    return result;
}

int posix_fallocate(int fd, off_t offset, off_t n)
{
    int (*call)(int, off_t, off_t) = (int (*)(int, off_t, off_t))real("posix_fallocate");
    char path[PATH_LIMIT];
    if (name_of(fd, path) == NULL)
        return call(fd, offset, n);
    lock();
    bool fits = affordable(fd, (uint64_t)offset, (size_t)n) == (size_t)n;
    int error = fits ? call(fd, offset, n) : ENOSPC;
    if (error == 0)
        note((struct power_head){.kind = POWER_EXTEND, .fd = fd, .a = (uint64_t)(offset + n)}, "",
             "", "", 0);
    unlock();
    return error;
}

/* ---- syncs ---- */

static int sync_file(int fd)
{
    struct power_head h = {.kind = POWER_SYNC, .fd = fd};
    lock();
    h.a = operations;
    h.error = happens("POWER_SYNC_FAILS") ? EIO : 0;
    uint64_t stall = setting("POWER_STALL_US");
    uint64_t us = stall == 0 ? 0 : draw() % stall;
    unlock();
    if (us > 0)
        usleep((useconds_t)us);
    lock();
    note(h, "", "", "", 0);
    unlock();
    errno = h.error;
    return h.error == 0 ? 0 : -1;
}

int fdatasync(int fd)
{
    char path[PATH_LIMIT];
    return name_of(fd, path) != NULL ? sync_file(fd) : ((int (*)(int))real("fdatasync"))(fd);
}

int fsync(int fd)
{
    char path[PATH_LIMIT];
    return name_of(fd, path) != NULL ? sync_file(fd) : ((int (*)(int))real("fsync"))(fd);
}

/* ---- names ---- */

static int open_file(int dir, const char *name, int flags, unsigned mode)
{
    int (*call)(int, const char *, int, ...) = (int (*)(int, const char *, int, ...))real("openat");
    char path[PATH_LIMIT];
    if (name_in(dir, name, path) == NULL)
        return call(dir, name, flags, mode);
    lock();
    int fd = (flags & O_CREAT) != 0 && fails() ? -1 : call(dir, name, flags, mode);
    if (fd >= 0)
        note((struct power_head){.kind = POWER_OPEN, .fd = fd, .a = (uint64_t)flags},
             name_of(fd, path), "", "", 0);
    unlock();
    return fd;
}

int openat(int dir, const char *name, int flags, ...)
{
    va_list ap;
    va_start(ap, flags);
    unsigned mode = flags & O_CREAT ? va_arg(ap, unsigned) : 0;
    va_end(ap);
    return open_file(dir, name, flags, mode);
}

int open(const char *name, int flags, ...)
{
    va_list ap;
    va_start(ap, flags);
    unsigned mode = flags & O_CREAT ? va_arg(ap, unsigned) : 0;
    va_end(ap);
    return open_file(AT_FDCWD, name, flags, mode);
}

int mkdir(const char *name, mode_t mode)
{
    int (*call)(const char *, mode_t) = (int (*)(const char *, mode_t))real("mkdir");
    if (relative(name) == NULL)
        return call(name, mode);
    lock();
    int result = call(name, mode);
    if (result == 0)
        note((struct power_head){.kind = POWER_MKDIR}, relative(name), "", "", 0);
    unlock();
    return result;
}

int mkdirat(int dir, const char *name, mode_t mode)
{
    int (*call)(int, const char *, mode_t) = (int (*)(int, const char *, mode_t))real("mkdirat");
    char path[PATH_LIMIT];
    const char *at = name_in(dir, name, path);
    if (at == NULL)
        return call(dir, name, mode);
    lock();
    int result = call(dir, name, mode);
    if (result == 0)
        note((struct power_head){.kind = POWER_MKDIR}, at, "", "", 0);
    unlock();
    return result;
}

int unlinkat(int dir, const char *name, int flags)
{
    int (*call)(int, const char *, int) = (int (*)(int, const char *, int))real("unlinkat");
    char path[PATH_LIMIT];
    const char *at = name_in(dir, name, path);
    if (at == NULL)
        return call(dir, name, flags);
    lock();
    int result = call(dir, name, flags);
    if (result == 0)
        note((struct power_head){.kind = POWER_UNLINK}, at, "", "", 0);
    unlock();
    return result;
}

int renameat(int dir, const char *name, int to, const char *new_name)
{
    int (*call)(int, const char *, int, const char *) =
        (int (*)(int, const char *, int, const char *))real("renameat");
    char old_path[PATH_LIMIT], path[PATH_LIMIT];
    const char *at = name_in(dir, name, old_path), *new_at = name_in(to, new_name, path);
    if (at == NULL || new_at == NULL)
        return call(dir, name, to, new_name);
    lock();
    int result = fails() ? -1 : call(dir, name, to, new_name);
    if (result == 0)
        note((struct power_head){.kind = POWER_RENAME}, at, new_at, "", 0);
    unlock();
    return result;
}

int linkat(int dir, const char *name, int to, const char *new_name, int flags)
{
    int (*call)(int, const char *, int, const char *, int) =
        (int (*)(int, const char *, int, const char *, int))real("linkat");
    char old_path[PATH_LIMIT], path[PATH_LIMIT];
    const char *at = name_in(dir, name, old_path), *new_at = name_in(to, new_name, path);
    if (at == NULL || new_at == NULL)
        return call(dir, name, to, new_name, flags);
    lock();
    int result = fails() ? -1 : call(dir, name, to, new_name, flags);
    if (result == 0)
        note((struct power_head){.kind = POWER_LINK}, at, new_at, "", 0);
    unlock();
    return result;
}

/* ---- clients ---- */

ssize_t send(int fd, const void *bytes, size_t n, int flags)
{
    ssize_t (*call)(int, const void *, size_t, int) =
        (ssize_t(*)(int, const void *, size_t, int))real("send");
    struct sockaddr_in peer;
    socklen_t size = sizeof peer;
    if (log_fd < 0 || getpeername(fd, (struct sockaddr *)&peer, &size) != 0 ||
        peer.sin_family != AF_INET)
        return call(fd, bytes, n, flags);
    lock();
    ssize_t sent = call(fd, bytes, n, flags);
    if (sent > 0)
        note(
            (struct power_head){.kind = POWER_SENT, .a = ntohs(peer.sin_port), .b = (uint64_t)sent},
            "", "", "", 0);
    unlock();
    return sent;
}
