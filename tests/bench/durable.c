/* durable.c - the measuring client of durable.sh.
 *
 *     durable add|set PORT CONNECTIONS SECONDS LABEL
 *         single changes, each after the reply to the one before
 *     durable load PORT POINTS LABEL
 *         LOADB into a new set
 *     durable build PORT POINTS LABEL
 *         the same and TRIANGULATE, and another set of 1000 points
 *     durable ready PORT LABEL
 *         seconds since $START_NS until those sets answer
 *     durable snapshot PORT PID LABEL
 *         SNAPSHOT, with PINGs until it is done
 *     durable edited PORT PID POINTS LABEL
 *         the same while the set of POINTS points is edited */
#include <arpa/inet.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { MOST_CONNECTIONS = 1000, MOST_SAMPLES = 1 << 22 };

static float sample[MOST_SAMPLES];
static size_t samples;

static double now(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void die(const char *what)
{
    perror(what);
    exit(1);
}

static int dial(const char *port)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_port = htons((in_port_t)atoi(port))};
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    if (fd < 0 || connect(fd, (struct sockaddr *)&at, sizeof at) != 0)
        die("connect");
    return fd;
}

static void put(int fd, const void *bytes, size_t n)
{
    const char *p = bytes;
    while (n > 0) {
        ssize_t sent = send(fd, p, n, 0);
        if (sent <= 0)
            die("send");
        p += sent;
        n -= (size_t)sent;
    }
}

static void line(int fd, char *text, size_t size)
{
    size_t n = 0;
    for (; n + 1 < size && recv(fd, text + n, 1, 0) == 1 && text[n] != '\n'; n++)
        ;
    text[n] = '\0';
}

/* Sends a request; returns whether the reply is OK. Rows are read and discarded. */
static int ask(int fd, const char *request)
{
    char text[4096];
    int rows = 0;
    put(fd, request, strlen(request));
    do
        line(fd, text, sizeof text);
    while (text[0] == '#');
    int ok = sscanf(text, "OK %d", &rows) == 1;
    while (rows-- > 0)
        line(fd, text, sizeof text);
    return ok;
}

static uint64_t info(int fd, const char *key)
{
    char text[4096];
    int rows = 0;
    uint64_t v = 0;
    put(fd, "INFO\n", 5);
    line(fd, text, sizeof text);
    sscanf(text, "OK %d", &rows);
    while (rows-- > 0) {
        line(fd, text, sizeof text);
        if (strncmp(text, key, strlen(key)) == 0 && text[strlen(key)] == ':')
            v = strtoull(text + strlen(key) + 1, NULL, 10);
    }
    return v;
}

static int by_value(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

static double percentile(double part)
{
    return samples == 0 ? 0 : (double)sample[(size_t)((double)(samples - 1) * part)];
}

static void note(double seconds)
{
    if (samples < MOST_SAMPLES)
        sample[samples++] = (float)(seconds * 1e3);
}

/* ---- single changes ---- */

static void send_change(int fd, int redis, unsigned long i)
{
    char text[128];
    int n = redis ? snprintf(text, sizeof text,
                             "*3\r\n$3\r\nSET\r\n$16\r\nkey:%012lu\r\n$10\r\n%010lu\r\n", i, i)
                  : snprintf(text, sizeof text, "ADD t %lu.5 %lu.25\n", i % 100003, i % 99991);
    put(fd, text, (size_t)n);
}

static void single(int redis, const char *port, int connections, double seconds, const char *label)
{
    static int fd[MOST_CONNECTIONS];
    static double sent[MOST_CONNECTIONS];
    struct epoll_event events[256];
    unsigned long n = 0;
    int epoll = epoll_create1(0);
    double start = now(CLOCK_MONOTONIC), t = start;
    for (int i = 0; i < connections; i++) {
        struct epoll_event e = {.events = EPOLLIN, .data.u32 = (uint32_t)i};
        fd[i] = dial(port);
        epoll_ctl(epoll, EPOLL_CTL_ADD, fd[i], &e);
        sent[i] = t;
        send_change(fd[i], redis, n++);
    }
    while (t - start < seconds) {
        int ready = epoll_wait(epoll, events, 256, 1000);
        t = now(CLOCK_MONOTONIC);
        for (int i = 0; i < ready; i++) {
            uint32_t c = events[i].data.u32;
            char text[512];
            ssize_t got = recv(fd[c], text, sizeof text, 0);
            if (got <= 0 || text[got - 1] != '\n' || (text[0] != 'O' && text[0] != '+'))
                die("reply");
            note(t - sent[c]);
            sent[c] = t;
            send_change(fd[c], redis, n++);
        }
    }
    qsort(sample, samples, sizeof *sample, by_value);
    printf("%-32s %9.0f a second, p50 %.2f ms, p99 %.2f ms\n", label, (double)samples / (t - start),
           percentile(0.5), percentile(0.99));
}

/* ---- large sets ---- */

static void load(int fd, const char *set, uint32_t n)
{
    enum { AT_ONCE = 1 << 16 };
    static double xy[2 * AT_ONCE];
    char head[64], reply[256];
    uint64_t state = 1;
    put(fd, head, (size_t)snprintf(head, sizeof head, "LOADB %s %" PRIu32 "\n", set, n));
    for (uint32_t at = 0; at < n; at += AT_ONCE) {
        uint32_t part = n - at < AT_ONCE ? n - at : AT_ONCE;
        for (uint32_t i = 0; i < 2 * part; i++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            xy[i] = (double)(state >> 11) * 0x1p-53;
        }
        put(fd, xy, (size_t)part * 16);
    }
    do
        line(fd, reply, sizeof reply);
    while (reply[0] == '#');
    if (strncmp(reply, "OK", 2) != 0)
        die(reply);
}

static void build(const char *port, uint32_t points, const char *label)
{
    int fd = dial(port);
    load(fd, "small", 1000);
    ask(fd, "TRIANGULATE small\n");
    double start = now(CLOCK_MONOTONIC);
    load(fd, "large", points);
    double loaded = now(CLOCK_MONOTONIC);
    ask(fd, "TRIANGULATE large\n");
    double end = now(CLOCK_MONOTONIC);
    printf("%-32s %.2f s (LOADB %.2f s)\n", label, end - start, loaded - start);
}

static void ready(const char *port, const char *label)
{
    double start = strtod(getenv("START_NS"), NULL) * 1e-9;
    int fd = dial(port);
    while (!ask(fd, "NEAREST small 0.5 0.5\n"))
        usleep(2000);
    double small = now(CLOCK_REALTIME);
    while (!ask(fd, "NEAREST large 0.5 0.5\n"))
        usleep(2000);
    printf("%-32s %.2f s (the small set: %.2f s)\n", label, now(CLOCK_REALTIME) - start,
           small - start);
}

static uint64_t peak_kib(const char *pid)
{
    char path[64], text[256];
    uint64_t kib = 0;
    snprintf(path, sizeof path, "/proc/%s/status", pid);
    FILE *f = fopen(path, "r");
    while (f != NULL && fgets(text, sizeof text, f) != NULL)
        sscanf(text, "VmHWM: %" SCNu64, &kib);
    if (f != NULL)
        fclose(f);
    return kib;
}

static double current_kib(const char *pid)
{
    char path[64];
    unsigned long size, resident = 0;
    snprintf(path, sizeof path, "/proc/%s/statm", pid);
    FILE *f = fopen(path, "r");
    if (f != NULL && fscanf(f, "%lu %lu", &size, &resident) != 2)
        resident = 0;
    if (f != NULL)
        fclose(f);
    return (double)resident * 4;
}

static void ping_for(int fd, double seconds)
{
    double start = now(CLOCK_MONOTONIC), t = start;
    while (t - start < seconds) {
        double before = t;
        ask(fd, "PING\n");
        t = now(CLOCK_MONOTONIC);
        note(t - before);
        usleep(200);
    }
}

/* Three of four edits move a point, one in eight deletes one, one in eight adds one; in bursts, until
 * killed. */
static void edit(const char *port, uint32_t points, volatile uint64_t *edits)
{
    enum { BURST = 64 };
    int fd = dial(port);
    uint64_t state = 7;
    char text[BURST * 128], reply[256];
    for (;; *edits += BURST) {
        size_t n = 0;
        for (int i = 0; i < BURST; i++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            uint32_t id = (uint32_t)((state >> 32) * points >> 32);
            double x = (double)(state >> 20 & 0xfffff) * 0x1p-20, y = (double)id / points;
            char *to = text + n;
            if (i % 8 == 0)
                n += (size_t)snprintf(to, 128, "DEL large %" PRIu32 "\n", id);
            else if (i % 8 == 1)
                n += (size_t)snprintf(to, 128, "ADD large %.9f %.9f\n", x, y);
            else
                n += (size_t)snprintf(to, 128, "MOVE large %" PRIu32 " %.9f %.9f\n", id, x, y);
        }
        put(fd, text, n);
        for (int i = 0; i < BURST; i++)
            line(fd, reply, sizeof reply);
    }
}

static pid_t begin_edits(const char *port, uint32_t points, volatile uint64_t *edits)
{
    pid_t pid = points == 0 ? 0 : fork();
    if (points > 0 && pid == 0)
        edit(port, points, edits);
    return pid;
}

/* points: 0 for no edits. */
static void snapshot(const char *port, const char *pid, uint32_t points, const char *label)
{
    int fd = dial(port);
    volatile uint64_t *edits =
        mmap(NULL, sizeof *edits, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (points >
        0) { /* so that the snapshot does not include what the first search and the first edit build */
        ask(fd, "NEAREST large 0.5 0.5\n");
        ask(fd, "ADD large 0.5 0.5\n");
    }
    ping_for(fd, 1);
    qsort(sample, samples, sizeof *sample, by_value);
    double idle = percentile(0.99), before = current_kib(pid), start = now(CLOCK_MONOTONIC);
    char path[64];
    snprintf(path, sizeof path, "/proc/%s/clear_refs", pid);
    FILE *f = fopen(path, "w"); /* from here on VmHWM is the peak during the snapshot */
    if (f != NULL) {
        fputs("5", f);
        fclose(f);
    }
    samples = 0;
    ask(fd, "SNAPSHOT\n");
    pid_t editor = begin_edits(port, points, edits);
    while (info(fd, "snapshot_running") != 0)
        ping_for(fd, 0.1);
    double took = now(CLOCK_MONOTONIC) - start;
    uint64_t edited = *edits;
    if (editor > 0) {
        kill(editor, SIGKILL);
        waitpid(editor, NULL, 0);
    }
    qsort(sample, samples, sizeof *sample, by_value);
    printf("%-32s p99 %.2f ms, worst %.2f ms (idle p99 %.2f ms); it took %.2f s; memory +%.1f %%",
           label, percentile(0.99), percentile(1), idle, took,
           ((double)peak_kib(pid) / before - 1) * 100);
    if (points > 0)
        printf("; %.0f edits a second", (double)edited / took);
    printf("\n");
}

int main(int argc, char **argv)
{
    const char *what = argc < 4 ? "" : argv[1];
    if (argc == 6 && (strcmp(what, "add") == 0 || strcmp(what, "set") == 0)) {
        single(what[0] == 's', argv[2], atoi(argv[3]), atof(argv[4]), argv[5]);
    } else if (argc == 5 && strcmp(what, "load") == 0) {
        double start = now(CLOCK_MONOTONIC);
        load(dial(argv[2]), "t", (uint32_t)strtoul(argv[3], NULL, 10));
        printf("%-32s %.3f s\n", argv[4], now(CLOCK_MONOTONIC) - start);
    } else if (argc == 5 && strcmp(what, "build") == 0) {
        build(argv[2], (uint32_t)strtoul(argv[3], NULL, 10), argv[4]);
    } else if (argc == 4 && strcmp(what, "ready") == 0) {
        ready(argv[2], argv[3]);
    } else if (argc == 5 && strcmp(what, "snapshot") == 0) {
        snapshot(argv[2], argv[3], 0, argv[4]);
    } else if (argc == 6 && strcmp(what, "edited") == 0) {
        snapshot(argv[2], argv[3], (uint32_t)strtoul(argv[4], NULL, 10), argv[5]);
    } else {
        return 2;
    }
    return 0;
}
