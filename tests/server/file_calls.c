/* file_calls.c - see file_calls.h. */
#include "tests/server/file_calls.h"

#include "tests/test.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

ssize_t __real_write(int fd, const void *bytes, size_t n);
int __real_fdatasync(int fd);
int __real_fsync(int fd);
int __real_ftruncate(int fd, off_t length);
int __real_openat(int dir, const char *name, int flags, ...);
int __real_renameat(int from, const char *name, int to, const char *new_name);
int __real_linkat(int from, const char *name, int to, const char *new_name, int flags);
int __real_unlinkat(int dir, const char *name, int flags);
ssize_t __real_read(int fd, void *bytes, size_t n);
struct dirent *__real_readdir(DIR *dir);
int __real_posix_fallocate(int fd, off_t at, off_t length);
ssize_t __wrap_write(int fd, const void *bytes, size_t n);
int __wrap_fdatasync(int fd);
int __wrap_fsync(int fd);
int __wrap_ftruncate(int fd, off_t length);
int __wrap_openat(int dir, const char *name, int flags, ...);
int __wrap_renameat(int from, const char *name, int to, const char *new_name);
int __wrap_linkat(int from, const char *name, int to, const char *new_name, int flags);
int __wrap_unlinkat(int dir, const char *name, int flags);
ssize_t __wrap_read(int fd, void *bytes, size_t n);
struct dirent *__wrap_readdir(DIR *dir);
int __wrap_posix_fallocate(int fd, off_t at, off_t length);

enum { LINE = 200, TEXT = 1 << 16 };

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t change = PTHREAD_COND_INITIALIZER;

static atomic_bool watching;

/* All of it under the mutex. */
static struct {
    char directory[128];
    char text[TEXT];
    size_t used;
    char to_fail[LINE];
    unsigned first, times, seen, failed;
    int error;
    bool limited;
    size_t space, reserve;
    char to_stop[LINE];
    bool stopped;
} w;

/* ---- the interface for tests ---- */

void calls_watch(const char *directory)
{
    pthread_mutex_lock(&mutex);
    memset(&w, 0, sizeof w);
    snprintf(w.directory, sizeof w.directory, "%s", directory);
    watching = true;
    pthread_mutex_unlock(&mutex);
}

const char *calls_text(void)
{
    static char text[TEXT];
    pthread_mutex_lock(&mutex);
    memcpy(text, w.text, w.used + 1);
    pthread_mutex_unlock(&mutex);
    return text;
}

unsigned calls_count(const char *line)
{
    unsigned n = 0;
    size_t length = strlen(line);
    for (const char *at = calls_text(); *at != '\0'; at = strchr(at, '\n') + 1)
        n += strncmp(at, line, length) == 0 && at[length] == '\n';
    return n;
}

bool calls_end(const char *lines)
{
    const char *text = calls_text();
    size_t n = strlen(lines), all = strlen(text);
    return all >= n && strcmp(text + all - n, lines) == 0;
}

void calls_fail(const char *line, unsigned n, unsigned times, int error)
{
    pthread_mutex_lock(&mutex);
    snprintf(w.to_fail, sizeof w.to_fail, "%s", line);
    w.first = n;
    w.times = times;
    w.seen = w.failed = 0;
    w.error = error;
    pthread_mutex_unlock(&mutex);
}

unsigned calls_failed(void)
{
    pthread_mutex_lock(&mutex);
    unsigned n = w.failed;
    pthread_mutex_unlock(&mutex);
    return n;
}

void calls_limit_space(size_t bytes)
{
    pthread_mutex_lock(&mutex);
    w.limited = true;
    w.space = w.reserve = bytes;
    pthread_mutex_unlock(&mutex);
}

void calls_stop(const char *line)
{
    pthread_mutex_lock(&mutex);
    snprintf(w.to_stop, sizeof w.to_stop, "%s", line);
    w.stopped = false;
    pthread_mutex_unlock(&mutex);
}

void calls_await_stopped(void)
{
    pthread_mutex_lock(&mutex);
    while (!w.stopped)
        pthread_cond_wait(&change, &mutex);
    pthread_mutex_unlock(&mutex);
}

void calls_go_on(void)
{
    pthread_mutex_lock(&mutex);
    w.to_stop[0] = '\0';
    pthread_cond_broadcast(&change);
    pthread_mutex_unlock(&mutex);
}

/* ---- names ---- */

/* The name of a path as the lines have it: relative, without the zeros. False: it lies elsewhere. */
static bool shorten(const char *path, char *name, size_t size)
{
    char directory[sizeof w.directory];
    pthread_mutex_lock(&mutex);
    memcpy(directory, w.directory, sizeof directory);
    pthread_mutex_unlock(&mutex);
    size_t length = strlen(directory);
    const char *last = strrchr(directory, '/');
    if (strcmp(path, directory) == 0)
        return snprintf(name, size, ".") > 0;
    if (last != NULL && strlen(path) == (size_t)(last - directory) &&
        strncmp(path, directory, strlen(path)) == 0)
        return snprintf(name, size, "..") > 0;
    if (strncmp(path, directory, length) != 0 || path[length] != '/')
        return false;
    size_t n = 0;
    for (const char *at = path + length + 1; *at != '\0' && n + 1 < size; at++)
        if (*at != '0' || (n > 0 && name[n - 1] != '.'))
            name[n++] = *at;
    name[n] = '\0';
    return true;
}

static bool path_of(int fd, char *path, size_t size)
{
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t n = readlink(link, path, size - 1);
    path[n < 0 ? 0 : n] = '\0';
    return n > 0;
}

static bool name_of(int fd, char *name, size_t size)
{
    char path[256];
    return watching && path_of(fd, path, sizeof path) && shorten(path, name, size);
}

static bool name_in(int dir, const char *file, char *name, size_t size)
{
    char path[256];
    if (!watching || !path_of(dir, path, sizeof path))
        return false;
    size_t n = strlen(path);
    snprintf(path + n, sizeof path - n, "/%s", file);
    return shorten(path, name, size);
}

/* ---- before and after a call ---- */

/* Whether the call may be made; else errno is set. */
static bool admit(const char *line)
{
    bool fails = false;
    pthread_mutex_lock(&mutex);
    while (strcmp(w.to_stop, line) == 0) {
        w.stopped = true;
        pthread_cond_broadcast(&change);
        pthread_cond_wait(&change, &mutex);
    }
    if (strcmp(w.to_fail, line) == 0 || strcmp(w.to_fail, "*") == 0) {
        w.seen++;
        fails = w.seen >= w.first && w.seen - w.first < w.times;
        w.failed += fails;
    }
    int error = w.error;
    pthread_mutex_unlock(&mutex);
    errno = fails ? error : errno;
    return !fails;
}

static void record(const char *line)
{
    size_t length = strlen(line);
    int error = errno;
    pthread_mutex_lock(&mutex);
    bool again = strncmp(line, "write ", 6) == 0 && w.used > length &&
                 strncmp(w.text + w.used - length - 1, line, length) == 0 &&
                 (w.used == length + 1 || w.text[w.used - length - 2] == '\n');
    if (!again && w.used + length + 2 <= TEXT)
        w.used += (size_t)snprintf(w.text + w.used, TEXT - w.used, "%s\n", line);
    pthread_mutex_unlock(&mutex);
    errno = error;
}

static void use_reserve(void)
{
    pthread_mutex_lock(&mutex);
    w.space += w.reserve;
    w.reserve = 0;
    pthread_mutex_unlock(&mutex);
}

/* Returns how many of n bytes fit on the disk. */
static size_t take_space(size_t n)
{
    pthread_mutex_lock(&mutex);
    if (w.limited && n > w.space)
        n = w.space;
    if (w.limited)
        w.space -= n;
    pthread_mutex_unlock(&mutex);
    return n;
}

/* ---- the calls ---- */

ssize_t __wrap_write(int fd, const void *bytes, size_t n)
{
    char name[LINE], line[LINE + 16];
    if (!name_of(fd, name, sizeof name))
        return __real_write(fd, bytes, n);
    snprintf(line, sizeof line, "write %s", name);
    if (!admit(line))
        return -1;
    size_t fits = take_space(n);
    if (fits == 0 && n > 0) {
        errno = ENOSPC;
        return -1;
    }
    ssize_t wrote = __real_write(fd, bytes, fits);
    if (wrote >= 0)
        record(line);
    return wrote;
}

static int sync_by(int (*real)(int), int fd)
{
    char name[LINE], line[LINE + 16];
    if (!name_of(fd, name, sizeof name))
        return real(fd);
    snprintf(line, sizeof line, "sync %s", name);
    if (!admit(line))
        return -1;
    int result = real(fd);
    if (result == 0)
        record(line);
    return result;
}

int __wrap_fdatasync(int fd)
{
    return sync_by(__real_fdatasync, fd);
}

int __wrap_fsync(int fd)
{
    return sync_by(__real_fsync, fd);
}

int __wrap_ftruncate(int fd, off_t length)
{
    char name[LINE], line[LINE + 16];
    if (!name_of(fd, name, sizeof name))
        return __real_ftruncate(fd, length);
    snprintf(line, sizeof line, "cut %s", name);
    int result = admit(line) ? __real_ftruncate(fd, length) : -1;
    if (result == 0)
        record(line);
    return result;
}

int __wrap_openat(int dir, const char *file, int flags, ...)
{
    char name[LINE], line[LINE + 16];
    va_list ap;
    va_start(ap, flags);
    unsigned mode = flags & O_CREAT ? va_arg(ap, unsigned) : 0;
    va_end(ap);
    if ((flags & O_CREAT) == 0 || !name_in(dir, file, name, sizeof name))
        return __real_openat(dir, file, flags, mode);
    snprintf(line, sizeof line, "create %s", name);
    int fd = admit(line) ? __real_openat(dir, file, flags, mode) : -1;
    if (fd >= 0)
        record(line);
    return fd;
}

int __wrap_renameat(int from, const char *file, int to, const char *new_file)
{
    char name[LINE], new_name[LINE], line[2 * LINE + 16];
    if (!name_in(from, file, name, sizeof name) || !name_in(to, new_file, new_name, LINE))
        return __real_renameat(from, file, to, new_file);
    snprintf(line, sizeof line, "rename %s %s", name, new_name);
    int result = admit(line) ? __real_renameat(from, file, to, new_file) : -1;
    if (result == 0)
        record(line);
    return result;
}

int __wrap_linkat(int from, const char *file, int to, const char *new_file, int flags)
{
    char name[LINE], new_name[LINE], line[2 * LINE + 16];
    if (!name_in(from, file, name, sizeof name) || !name_in(to, new_file, new_name, LINE))
        return __real_linkat(from, file, to, new_file, flags);
    snprintf(line, sizeof line, "link %s %s", name, new_name);
    int result = admit(line) ? __real_linkat(from, file, to, new_file, flags) : -1;
    if (result == 0)
        record(line);
    return result;
}

int __wrap_unlinkat(int dir, const char *file, int flags)
{
    char name[LINE], line[LINE + 16];
    if (!name_in(dir, file, name, sizeof name))
        return __real_unlinkat(dir, file, flags);
    snprintf(line, sizeof line, "remove %s", name);
    int result = admit(line) ? __real_unlinkat(dir, file, flags) : -1;
    if (result == 0)
        record(line);
    if (result == 0 && strcmp(file, "reserve") == 0)
        use_reserve();
    return result;
}

/* ---- calls that change no file: not recorded ---- */

ssize_t __wrap_read(int fd, void *bytes, size_t n)
{
    char name[LINE], line[LINE + 16];
    if (!name_of(fd, name, sizeof name))
        return __real_read(fd, bytes, n);
    snprintf(line, sizeof line, "read %s", name);
    return admit(line) ? __real_read(fd, bytes, n) : -1;
}

struct dirent *__wrap_readdir(DIR *dir)
{
    char name[LINE], line[LINE + 16];
    if (!name_of(dirfd(dir), name, sizeof name))
        return __real_readdir(dir);
    snprintf(line, sizeof line, "list %s", name);
    return admit(line) ? __real_readdir(dir) : NULL;
}

int __wrap_posix_fallocate(int fd, off_t at, off_t length)
{
    char name[LINE], line[LINE + 16];
    if (!name_of(fd, name, sizeof name))
        return __real_posix_fallocate(fd, at, length);
    snprintf(line, sizeof line, "allocate %s", name);
    return admit(line) ? __real_posix_fallocate(fd, at, length) : errno;
}
