/* daemon.c - see daemon.h. */
#include "tests/server/daemon.h"

#include "tests/test.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

void say_bytes(int fd, const void *bytes, size_t n)
{
    const char *p = bytes;
    while (n > 0) {
        ssize_t sent = send(fd, p, n, MSG_NOSIGNAL);
        CHECK_MSG(sent > 0, "send: %s", strerror(errno));
        p += sent;
        n -= (size_t)sent;
    }
}

void say(int fd, const char *text)
{
    say_bytes(fd, text, strlen(text));
}

/* Skips a set's version if the reply has one where `want` ends the line. */
static bool skip_version(int fd, char got, char want)
{
    static const char mark[] = " version=";
    char c = got;
    if (got != ' ' || (want != '\n' && want != '\r'))
        return false;
    for (size_t i = 0; mark[i] != '\0'; i++)
        if (recv(fd, &c, 1, 0) != 1 || c != mark[i])
            return false;
    while (recv(fd, &c, 1, MSG_PEEK) == 1 && c >= '0' && c <= '9')
        if (recv(fd, &c, 1, 0) != 1)
            return false;
    return true;
}

void(expect)(int fd, const char *want)
{
    size_t n = strlen(want), got = 0;
    char *text = calloc(1, n + 1);
    CHECK(text != NULL);
    while (got < n) {
        ssize_t r = recv(fd, text + got, n - got, MSG_PEEK);
        size_t same = 0, most = r > 0 ? (size_t)r : 0;
        while (same < most && text[got + same] == want[got + same])
            same++;
        bool more = same > 0 && recv(fd, text + got, same, 0) == (ssize_t)same;
        got += same;
        if (same < most)
            more = skip_version(fd, text[got], want[got]);
        if (!more) {
            CHECK_STR(text, want);
            test_fail(__FILE__, __LINE__, "the connection ended");
        }
    }
    free(text);
}

const char *hear_line(int fd)
{
    static _Thread_local char line[1 << 16];
    enum { PIECE = 200 };
    size_t n = 0;
    for (bool ended = false; !ended && n < sizeof line - PIECE;) {
        ssize_t r = recv(fd, line + n, PIECE, MSG_PEEK);
        const char *lf = r > 0 ? memchr(line + n, '\n', (size_t)r) : NULL;
        ended = lf != NULL;
        size_t take = ended ? (size_t)(lf - (line + n)) + 1 : (size_t)r;
        CHECK_MSG(r > 0 && recv(fd, line + n, take, 0) == (ssize_t)take,
                  "the connection ended after \"%.*s\"", (int)n, line);
        n += take - ended;
    }
    line[n] = '\0';
    return line[0] == '#' ? hear_line(fd) : line;
}

void hear_exactly(int fd, void *to, size_t n)
{
    for (size_t got = 0; got < n;) {
        ssize_t more = read(fd, (char *)to + got, n - got);
        CHECK_MSG(more > 0, "the connection ended after %zu bytes", got);
        got += (size_t)more;
    }
}

char *hear_all_and_comments(int fd, size_t *n)
{
    size_t cap = 1 << 16;
    char *text = malloc(cap);
    *n = 0;
    for (;;) {
        CHECK(text != NULL);
        ssize_t r = recv(fd, text + *n, cap - *n - 1, 0);
        CHECK_MSG(r >= 0, "recv after %zu bytes: %s", *n, strerror(errno));
        if (r == 0)
            break;
        *n += (size_t)r;
        if (cap - *n < cap / 2)
            text = realloc(text, cap *= 2);
    }
    text[*n] = '\0';
    return text;
}

/* Takes the comments about progress out of text[n]; returns how many bytes are left. */
static size_t drop_comments(char *text, size_t n)
{
    static const char mark[] = "# progress ";
    size_t kept = 0;
    for (size_t at = 0; at < n;) {
        const char *lf = memchr(text + at, '\n', n - at);
        size_t len = lf == NULL ? n - at : (size_t)(lf - (text + at)) + 1;
        if (strncmp(text + at, mark, sizeof mark - 1) != 0) {
            memmove(text + kept, text + at, len);
            kept += len;
        }
        at += len;
    }
    text[kept] = '\0';
    return kept;
}

char *hear_all(int fd, size_t *n)
{
    char *text = hear_all_and_comments(fd, n);
    *n = drop_comments(text, *n);
    return text;
}

int connect_unix(const char *path)
{
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    snprintf(at.sun_path, sizeof at.sun_path, "%s", path);
    CHECK(fd >= 0);
    if (connect(fd, (struct sockaddr *)&at, sizeof at) == 0)
        return fd;
    close(fd);
    return -1;
}

void expect_end(int fd)
{
    char c;
    ssize_t r = recv(fd, &c, 1, 0);
    CHECK_MSG(r == 0, "%s", r > 0 ? "more than expected" : strerror(errno));
}

void(converse)(const struct daemon *d, const char *request, const char *want)
{
    size_t n;
    int fd = daemon_connect(d);
    say(fd, request);
    shutdown(fd, SHUT_WR);
    char *got = hear_all(fd, &n);
    CHECK_STR(got, want);
    free(got);
    close(fd);
}

uint64_t daemon_info(const struct daemon *d, const char *key)
{
    size_t n;
    char mark[64];
    int fd = daemon_connect(d);
    say(fd, "INFO\nQUIT\n");
    char *text = hear_all(fd, &n);
    close(fd);
    snprintf(mark, sizeof mark, "\n%s:", key);
    const char *at = strstr(text, mark);
    CHECK_MSG(at != NULL, "INFO has no %s", key);
    uint64_t v = strtoull(at + strlen(mark), NULL, 10);
    free(text);
    return v;
}

void await_info(const struct daemon *d, const char *key, uint64_t want)
{
    uint64_t now = daemon_info(d, key), before = now;
    for (unsigned still = 0; now != want; before = now, now = daemon_info(d, key)) {
        still = now == before ? still + 1 : 0;
        if (still == 500 * test_slowness())
            test_fail(__FILE__, __LINE__, "%s stays %" PRIu64, key, now);
        pause_ms(10);
    }
}

void await_info_least(const struct daemon *d, const char *key, uint64_t least)
{
    for (unsigned tries = 0; daemon_info(d, key) < least; tries++, pause_ms(10))
        CHECK_MSG(tries < 1000 * test_slowness(), "%s does not become %" PRIu64, key, least);
}

uint64_t info_of(int fd, const char *key)
{
    size_t lines = 0, n = strlen(key);
    uint64_t found = 0;
    say(fd, "INFO\n");
    CHECK(sscanf(hear_line(fd), "OK %zu", &lines) == 1);
    for (; lines > 0; lines--) {
        const char *line = hear_line(fd);
        if (strncmp(line, key, n) == 0 && line[n] == ':')
            found = strtoull(line + n + 1, NULL, 10);
    }
    return found;
}

void await_input(int fd)
{
    struct pollfd in = {.fd = fd, .events = POLLIN};
    CHECK(poll(&in, 1, 10000 * (int)test_slowness()) == 1);
}

void load_random(int fd, const char *set, uint32_t n)
{
    char head[100];
    double *xy = malloc((size_t)n * 16 + 16);
    CHECK(xy != NULL);
    for (size_t i = 0; i < 2 * (size_t)n; i++)
        xy[i] = test_uniform();
    snprintf(head, sizeof head, "LOADB %s %" PRIu32 "\n", set, n);
    say(fd, head);
    say_bytes(fd, xy, (size_t)n * 16);
    free(xy);
    snprintf(head, sizeof head, "OK 0 first=0 added=%" PRIu32 " coincident=0", n);
    CHECK_STR(hear_line(fd), head);
}

size_t daemon_resident(const struct daemon *d)
{
    char path[64];
    size_t size, resident;
    snprintf(path, sizeof path, "/proc/%d/statm", (int)d->pid);
    FILE *f = fopen(path, "r");
    CHECK(f != NULL && fscanf(f, "%zu %zu", &size, &resident) == 2);
    fclose(f);
    return resident * (size_t)sysconf(_SC_PAGESIZE);
}

size_t daemon_peak_resident(const struct daemon *d)
{
    char path[64], line[256];
    size_t kib = 0;
    snprintf(path, sizeof path, "/proc/%d/status", (int)d->pid);
    FILE *f = fopen(path, "r");
    while (f != NULL && kib == 0 && fgets(line, sizeof line, f) != NULL)
        if (strncmp(line, "VmHWM:", 6) == 0)
            kib = strtoul(line + 6, NULL, 10);
    CHECK(kib > 0);
    fclose(f);
    return kib * 1024;
}

double daemon_cpu_seconds(const struct daemon *d)
{
    char path[64];
    unsigned long user, system;
    snprintf(path, sizeof path, "/proc/%d/stat", (int)d->pid);
    FILE *f = fopen(path, "r");
    CHECK(f != NULL);
    CHECK(fscanf(f, "%*d %*s %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user,
                 &system) == 2);
    fclose(f);
    return (double)(user + system) / (double)sysconf(_SC_CLK_TCK);
}

double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void pause_ms(unsigned ms)
{
    struct timespec t = {ms / 1000, (long)(ms % 1000) * 1000000};
    nanosleep(&t, NULL);
}
