/* directory.c - see directory.h. */
#include "tests/server/directory.h"

#include "server/repair/repair.h"
#include "tests/test.h"

#include <dirent.h>
#include <fcntl.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

struct directory directory_new(void)
{
    struct directory dir;
    const char *tmp = getenv("TMPDIR");
    snprintf(dir.path, sizeof dir.path, "%.40s/delaunayd-XXXXXX", tmp != NULL ? tmp : "/tmp");
    CHECK(mkdtemp(dir.path) != NULL);
    return dir;
}

struct directory directory_quick(void)
{
    struct directory dir = {.path = "/dev/shm/delaunayd-test-XXXXXX"};
    return getenv("TMPDIR") == NULL && mkdtemp(dir.path) != NULL ? dir : directory_new();
}

static int dots(const struct dirent *e)
{
    return strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
}

void directory_remove(const struct directory *dir)
{
    struct dirent **e;
    int n = scandir(dir->path, &e, dots, alphasort);
    for (int i = 0; i < n; i++) {
        char path[400];
        snprintf(path, sizeof path, "%s/%s", dir->path, e[i]->d_name);
        unlink(path);
        free(e[i]);
    }
    if (n >= 0)
        free(e);
    rmdir(dir->path);
}

bool directory_file(const struct directory *dir, const char *prefix, unsigned n, char path[128])
{
    struct dirent **e;
    bool found = false;
    int names = scandir(dir->path, &e, dots, alphasort);
    CHECK(names >= 0);
    for (int i = 0; i < names; i++) {
        if (!found && strncmp(e[i]->d_name, prefix, strlen(prefix)) == 0 && n-- == 0) {
            snprintf(path, 128, "%s/%.60s", dir->path, e[i]->d_name);
            found = true;
        }
        free(e[i]);
    }
    free(e);
    return found;
}

struct daemon directory_daemon(const struct directory *dir, const char *const *arguments)
{
    const char *all[12] = {"--data", dir->path};
    size_t n = 2;
    for (; arguments != NULL && *arguments != NULL && n < 11; arguments++)
        all[n++] = *arguments;
    all[n] = NULL;
    struct daemon d = daemon_start(all);
    await_info(&d, "loaded_percent", 100);
    return d;
}

bool directory_try(const struct directory *dir, const char *const *arguments, struct daemon *d)
{
    const char *argv[16] = {getenv("DELAUNAYD"), "--port", "0", "--data", dir->path};
    int out[2], n = 5;
    char line[128];
    for (; arguments != NULL && *arguments != NULL && n < 15; arguments++)
        argv[n++] = *arguments;
    CHECK(pipe(out) == 0);
    d->pid = fork();
    CHECK(d->pid >= 0);
    if (d->pid == 0) {
        dup2(out[1], STDOUT_FILENO);
        close(out[0]);
        close(out[1]);
        execv(argv[0], (char *const *)(uintptr_t)argv);
        _exit(127);
    }
    close(out[1]);
    FILE *f = fdopen(out[0], "r");
    CHECK(f != NULL);
    bool ready =
        fgets(line, sizeof line, f) != NULL && sscanf(line, "ready on 127.0.0.1:%u", &d->port) == 1;
    fclose(f);
    if (!ready)
        CHECK(waitpid(d->pid, NULL, 0) == d->pid);
    return ready;
}

int directory_run(const struct directory *dir, const char *flag, char *text, size_t size)
{
    int out[2], status;
    size_t n = 0;
    CHECK(pipe(out) == 0);
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        dup2(out[1], STDOUT_FILENO);
        dup2(out[1], STDERR_FILENO);
        close(out[0]);
        execl(getenv("DELAUNAYD"), "delaunayd", flag, dir->path, "--port", "0", (char *)NULL);
        _exit(127);
    }
    close(out[1]);
    for (ssize_t r; n + 1 < size && (r = read(out[0], text + n, size - 1 - n)) > 0;)
        n += (size_t)r;
    text[n] = '\0';
    close(out[0]);
    CHECK(waitpid(pid, &status, 0) == pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool directory_repair_badly(const struct directory *dir, const char *op, unsigned nth)
{
    char text[4096], fired[100], number[16];
    snprintf(fired, sizeof fired, "%s.fired", dir->path);
    snprintf(number, sizeof number, "%u", nth);
    setenv("DISK_DIR", dir->path, 1);
    setenv("DISK_FIRED", fired, 1);
    setenv("DISK_OP", op, 1);
    setenv("DISK_NTH", number, 1);
    setenv("LD_PRELOAD", getenv("DISK_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("TSAN_OPTIONS", "atexit_sleep_ms=0", 0); /* else each process sleeps for a second */
    directory_run(dir, "--repair", text, sizeof text);
    unsetenv("LD_PRELOAD");
    return unlink(fired) == 0;
}

int directory_repair(const struct directory *dir, char *text, size_t size)
{
    char path[100];
    snprintf(path, sizeof path, "%s.said", dir->path);
    fflush(stdout);
    int was = dup(STDOUT_FILENO), to = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
    CHECK(was >= 0 && to >= 0 && dup2(to, STDOUT_FILENO) >= 0);
    int status = repair_run(dir->path);
    fflush(stdout);
    dup2(was, STDOUT_FILENO);
    ssize_t n = pread(to, text, size - 1, 0);
    text[n > 0 ? n : 0] = '\0';
    close(was);
    close(to);
    unlink(path);
    return status;
}

void directory_touch(const struct directory *dir, const char *name)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", dir->path, name);
    file_write(path, "", 0);
}

char *file_read(const char *path, size_t *n)
{
    struct stat st;
    int fd = open(path, O_RDONLY);
    CHECK(fd >= 0 && fstat(fd, &st) == 0);
    *n = (size_t)st.st_size;
    char *bytes = malloc(*n + 1);
    CHECK(bytes != NULL && read(fd, bytes, *n) == (ssize_t)*n);
    close(fd);
    return bytes;
}

void file_write(const char *path, const char *bytes, size_t n)
{
    /* Not O_TRUNC: ext4 flushes a file that was emptied and written again, which takes
     * milliseconds. */
    int fd = open(path, O_WRONLY | O_CREAT, 0600);
    CHECK(fd >= 0 && write(fd, bytes, n) == (ssize_t)n && ftruncate(fd, (off_t)n) == 0);
    close(fd);
}

char *directory_state(const struct daemon *d, const char *const *sets)
{
    size_t n, used = 0;
    char request[4000];
    used += (size_t)snprintf(request, sizeof request, "SETS\n");
    for (; *sets != NULL; sets++)
        used += (size_t)snprintf(request + used, sizeof request - used,
                                 "POINTS %s\nCOINCIDENT %s\nLISTS %s\nHULL %s\n", *sets, *sets,
                                 *sets, *sets);
    int fd = daemon_connect(d);
    say(fd, request);
    shutdown(fd, SHUT_WR);
    char *state = hear_all(fd, &n);
    close(fd);
    return state;
}

void(carry_out)(const struct daemon *d, const char *requests)
{
    size_t n;
    int fd = daemon_connect(d);
    say(fd, requests);
    shutdown(fd, SHUT_WR);
    char *replies = hear_all(fd, &n);
    CHECK_MSG(strncmp(replies, "ERR", 3) != 0 && strstr(replies, "\nERR") == NULL, "%s--- to\n%s",
              replies, requests);
    free(replies);
    close(fd);
}
