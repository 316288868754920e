/* load.c - the load generator: prepares a set if requested, runs one mix, prints one row of a table.
 *
 *     load --port 6374 --mix nearest=9,add=1 --points 1000000 --connections 50 --pipeline 16
 */
#include "tests/load/driver.h"
#include "tests/load/plot.h"

#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static const char usage[] =
    "usage: load --port N [flags]\n"
    "  --mix KIND[=WEIGHT],...  what to ask (ping)\n"
    "  --connections N          (50)\n"
    "  --pipeline N             requests on their way per connection (1)\n"
    "  --rate R                 open loop: requests a second, latencies from when they were due\n"
    "  --together               all connections send at the same moment, when all are answered\n"
    "  --seconds S, --count N   whichever comes first ends it (5 seconds)\n"
    "  --set NAME               (load)\n"
    "  --points N               first loads so many points and triangulates them\n"
    "  --held N                 the set holds so many points already\n"
    "  --raw                    with --points: without triangulating\n"
    "  --resp                   in the second framing, as Redis's clients speak\n"
    "  --svg FILE               draws the latencies\n"
    "  --title TEXT             of the row (the mix)\n"
    "  --head                   prints the table's head and does nothing else\n"
    "kinds: ";

struct options {
    struct plan plan;
    struct mix mix;
    const char *mix_text, *svg, *title;
    uint32_t points; /* to be loaded */
    bool raw;
};

/* ---- preparation ---- */

static bool send_all(int fd, const void *bytes, size_t n)
{
    for (const char *p = bytes; n > 0;) {
        ssize_t sent = send(fd, p, n, MSG_NOSIGNAL);
        if (sent <= 0)
            return false;
        p += sent;
        n -= (size_t)sent;
    }
    return true;
}

/* Reads one status line; true if it is OK. */
static bool hear_ok(int fd)
{
    char line[512];
    size_t n = 0;
    while (n < sizeof line - 1 && recv(fd, &line[n], 1, 0) == 1 && line[n] != '\n')
        n++;
    line[n] = '\0';
    if (line[0] == '#')
        return hear_ok(fd);
    if (strncmp(line, "OK ", 3) == 0)
        return true;
    fprintf(stderr, "load: %s\n", line);
    return false;
}

static bool send_points(int fd, struct mix *m, uint32_t n)
{
    enum { PIECE = 4096 };
    static double xy[2 * PIECE];
    for (uint32_t left = n; left > 0;) {
        uint32_t k = left < PIECE ? left : PIECE;
        for (uint32_t i = 0; i < 2 * k; i++)
            xy[i] = mix_random(m, MIX_SPAN) + mix_random(m, 1 << 30) / (double)(1 << 30);
        if (!send_all(fd, xy, 16 * (size_t)k))
            return false;
        left -= k;
    }
    return true;
}

static bool prepare(struct options *o)
{
    char line[200];
    int fd = driver_connect(o->plan.port);
    if (fd < 0)
        return false;
    int n = snprintf(line, sizeof line, "LOADB %s %" PRIu32 "\n", o->mix.set, o->points);
    bool good = send_all(fd, line, (size_t)n) && send_points(fd, &o->mix, o->points) && hear_ok(fd);
    n = snprintf(line, sizeof line, "TRIANGULATE %s\n", o->mix.set);
    if (good && !o->raw)
        good = send_all(fd, line, (size_t)n) && hear_ok(fd);
    close(fd);
    return good;
}

/* ---- flags ---- */

static bool bad(const char *what)
{
    fprintf(stderr, "load: %s\n%s%s\n", what, usage, mix_names());
    return false;
}

static void print_head(void)
{
    printf("| %-28s | %11s | %9s | %9s | %9s | %9s | %6s |\n", "scenario", "replies/s", "p50 ms",
           "p99 ms", "p99.9 ms", "max ms", "errors");
    printf("|:-----------------------------|------------:|----------:|----------:|----------:|-----"
           "-----:|-------:|\n");
}

enum {
    PORT = 1,
    MIX,
    CONNECTIONS,
    PIPELINE,
    RATE,
    TOGETHER,
    SECONDS,
    COUNT,
    SET,
    POINTS,
    HELD,
    RAW,
    RESP,
    SVG,
    TITLE,
    HEAD
};

static const struct option flags[] = {
    {"port", required_argument, NULL, PORT},
    {"mix", required_argument, NULL, MIX},
    {"connections", required_argument, NULL, CONNECTIONS},
    {"pipeline", required_argument, NULL, PIPELINE},
    {"rate", required_argument, NULL, RATE},
    {"together", no_argument, NULL, TOGETHER},
    {"seconds", required_argument, NULL, SECONDS},
    {"count", required_argument, NULL, COUNT},
    {"set", required_argument, NULL, SET},
    {"points", required_argument, NULL, POINTS},
    {"held", required_argument, NULL, HELD},
    {"raw", no_argument, NULL, RAW},
    {"resp", no_argument, NULL, RESP},
    {"svg", required_argument, NULL, SVG},
    {"title", required_argument, NULL, TITLE},
    {"head", no_argument, NULL, HEAD},
    {0},
};

static void set_option(struct options *o, int flag, const char *value)
{
    double number = value != NULL ? strtod(value, NULL) : 0;
    number = number > 0 && number < 1e9 ? number : 0;
    switch (flag) {
    case PORT:
        o->plan.port = (unsigned)number;
        break;
    case MIX:
        o->mix_text = value;
        break;
    case CONNECTIONS:
        o->plan.connections = (unsigned)number;
        break;
    case PIPELINE:
        o->plan.pipeline = (unsigned)number;
        break;
    case RATE:
        o->plan.rate = number;
        break;
    case TOGETHER:
        o->plan.together = true;
        break;
    case SECONDS:
        o->plan.seconds = number;
        break;
    case COUNT:
        o->plan.count = (uint64_t)number;
        break;
    case SET:
        o->mix.set = value;
        break;
    case POINTS:
        o->points = (uint32_t)number;
        break;
    case HELD:
        o->mix.points = (uint32_t)number;
        break;
    case RAW:
        o->raw = true;
        break;
    case RESP:
        o->mix.resp = true;
        break;
    case SVG:
        o->svg = value;
        break;
    case TITLE:
        o->title = value;
        break;
    case HEAD:
        print_head();
        exit(0);
    default:
        break;
    }
}

static bool read_flags(struct options *o, int argc, char **argv)
{
    int flag;
    while ((flag = getopt_long(argc, argv, "", flags, NULL)) != -1) {
        if (flag == '?')
            return bad("no such flag");
        set_option(o, flag, optarg);
    }
    if (o->plan.port == 0 || o->plan.port > 65535)
        return bad("--port 1 to 65535");
    if (o->plan.connections == 0 || o->plan.connections > 100000 || o->plan.pipeline == 0 ||
        o->plan.pipeline > 1000000)
        return bad("--connections and --pipeline are numbers from 1");
    if (!mix_read(&o->mix, o->mix_text) || (o->mix.resp && o->mix.lines > 0))
        return bad("--mix names no kinds, or unlike ones; --resp is for our own");
    return true;
}

static void print_row(const struct options *o, const struct outcome *got)
{
    const struct histogram *h = &got->latency;
    printf("| %-28s | %11.0f | %9.3f | %9.3f | %9.3f | %9.3f | %6" PRIu64 " |\n",
           o->title != NULL ? o->title : o->mix_text, (double)got->replies / got->seconds,
           (double)histogram_quantile(h, 0.5) * 1e-6, (double)histogram_quantile(h, 0.99) * 1e-6,
           (double)histogram_quantile(h, 0.999) * 1e-6, (double)h->max * 1e-6, got->errors);
}

int main(int argc, char **argv)
{
    static struct outcome got;
    struct options o = {.plan = {.connections = 50, .pipeline = 1, .seconds = 5},
                        .mix = {.set = "load", .state = 1},
                        .mix_text = "ping"};
    o.plan.count = UINT64_MAX;
    if (!read_flags(&o, argc, argv))
        return 2;
    if (o.points > 0) {
        o.mix.points = o.points;
        if (!prepare(&o))
            return 1;
    }
    if (!driver_run(&o.plan, &o.mix, &got))
        return 1;
    print_row(&o, &got);
    return o.svg == NULL ||
                   plot_latency(o.svg, o.title != NULL ? o.title : o.mix_text, &got.latency)
               ? 0
               : 1;
}
