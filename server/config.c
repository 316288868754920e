/* config.c - see config.h. */
#include "server/config.h"

#include "core/delaunay.h"
#include "proto/number.h"
#include "server/machine.h"

#include <arpa/inet.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DESCRIPTORS_APART = 32, MOST_CLIENTS = 10000, MOST_THREADS = 256 };

static const char usage[] =
    "usage: delaunayd [flags]\n"
    "A daemon that keeps sets of points of the plane and their Delaunay triangulations.\n"
    "\n"
    "  --bind ADDR         numeric address to listen on (default 127.0.0.1)\n"
    "  --port N            TCP port, 0 for any free one (default 6374)\n"
    "  --unix PATH         listen on this Unix socket too\n"
    "  --data DIR          keep everything in this directory, too, so that it survives\n"
    "  --fsync WHEN        always: a change is acknowledged when it is on the disk (default);\n"
    "                      everysec: when it is written, synced once a second; no: never synced\n"
    "  --compact-at BYTES  log after which a snapshot replaces it (default 64m; more for large "
    "sets)\n"
    "  --check DIR         tell whether a data directory is good, and leave\n"
    "  --repair DIR        put what is damaged in it aside, and leave\n"
    "  --auth-file FILE    lines `ro TOKEN` and `rw TOKEN`: clients must AUTH with one of these\n"
    "  --insecure          allow an address beyond loopback without --auth-file\n"
    "  --threads N         threads that work on heavy requests (default: one per processor)\n"
    "  --max-clients N     connections at once (default 10000, or what descriptors allow)\n"
    "  --idle-timeout S    drop clients that have sent nothing for so many seconds (default: "
    "never)\n"
    "  --max-points N      points of one set (default 268435455)\n"
    "  --max-memory BYTES  memory of all sets, with k, m or g behind it (default: 80 % of the "
    "machine's)\n"
    "  --slowlog-us N      requests that take N microseconds go into the slow log, 0: none do "
    "(default 10000)\n"
    "  --slowlog-len N     requests that the slow log keeps (default 128)\n"
    "  --log-level LEVEL   what is told on standard error: error, warning, info (default) or "
    "debug\n"
    "  --version           say which version this is\n"
    "  --help              say this\n";

static unsigned threads_here(void)
{
    unsigned n = machine_processors();
    return n < MOST_THREADS ? n : MOST_THREADS;
}

static unsigned affordable_clients(void)
{
    unsigned n = machine_descriptors();
    return n <= DESCRIPTORS_APART                  ? 1
           : n - DESCRIPTORS_APART >= MOST_CLIENTS ? MOST_CLIENTS
                                                   : n - DESCRIPTORS_APART;
}

void config_init(struct config *c)
{
    *c = (struct config){
        .bind_address = "127.0.0.1",
        .port = DEFAULT_PORT,
        .threads = threads_here(),
        .max_clients = affordable_clients(),
        .max_points = DT_MAX_POINTS,
        .max_memory = machine_memory() / 5 * 4,
        .compact_at = (size_t)64 << 20,
        .slowlog_us = 10000,
        .slowlog_len = 128,
        .log_level = NOTICE_INFO,
    };
}

/* ---- values ---- */

static bool parse_number(const char *text, uint32_t least, uint32_t most, uint32_t *v)
{
    return proto_read_u32(text, strlen(text), v) && *v >= least && *v <= most;
}

static bool parse_bytes(const char *text, size_t *bytes)
{
    char *end;
    if (*text < '0' || *text > '9')
        return false;
    unsigned long long v = strtoull(text, &end, 10);
    unsigned shift = *end == 'k' ? 10 : *end == 'm' ? 20 : *end == 'g' ? 30 : 0;
    if (end[shift != 0] != '\0' || v == 0 || v > (SIZE_MAX >> shift))
        return false;
    *bytes = (size_t)v << shift;
    return true;
}

static bool parse_policy(const char *text, enum log_policy *policy)
{
    static const char *const name[] = {"always", "everysec", "no"};
    for (int i = LOG_ALWAYS; i <= LOG_NO; i++) {
        if (strcmp(text, name[i]) == 0) {
            *policy = (enum log_policy)i;
            return true;
        }
    }
    return false;
}

static bool is_loopback(const char *address, bool *loopback)
{
    struct in_addr v4;
    struct in6_addr v6;
    if (inet_pton(AF_INET, address, &v4) == 1)
        *loopback = (ntohl(v4.s_addr) >> 24) == 127;
    else if (inet_pton(AF_INET6, address, &v6) == 1)
        *loopback = IN6_IS_ADDR_LOOPBACK(&v6);
    else
        return false;
    return true;
}

/* ---- flags ---- */

enum flag {
    FLAG_BIND = 256,
    FLAG_PORT,
    FLAG_UNIX,
    FLAG_AUTH_FILE,
    FLAG_INSECURE,
    FLAG_THREADS,
    FLAG_MAX_CLIENTS,
    FLAG_IDLE_TIMEOUT,
    FLAG_MAX_POINTS,
    FLAG_MAX_MEMORY,
    FLAG_DATA,
    FLAG_FSYNC,
    FLAG_COMPACT_AT,
    FLAG_CHECK,
    FLAG_REPAIR,
    FLAG_SLOWLOG_US,
    FLAG_SLOWLOG_LEN,
    FLAG_LOG_LEVEL,
    FLAG_VERSION,
    FLAG_HELP
};

static const struct option flags[] = {
    {"bind", required_argument, NULL, FLAG_BIND},
    {"port", required_argument, NULL, FLAG_PORT},
    {"unix", required_argument, NULL, FLAG_UNIX},
    {"auth-file", required_argument, NULL, FLAG_AUTH_FILE},
    {"insecure", no_argument, NULL, FLAG_INSECURE},
    {"threads", required_argument, NULL, FLAG_THREADS},
    {"max-clients", required_argument, NULL, FLAG_MAX_CLIENTS},
    {"idle-timeout", required_argument, NULL, FLAG_IDLE_TIMEOUT},
    {"max-points", required_argument, NULL, FLAG_MAX_POINTS},
    {"max-memory", required_argument, NULL, FLAG_MAX_MEMORY},
    {"data", required_argument, NULL, FLAG_DATA},
    {"fsync", required_argument, NULL, FLAG_FSYNC},
    {"compact-at", required_argument, NULL, FLAG_COMPACT_AT},
    {"check", required_argument, NULL, FLAG_CHECK},
    {"repair", required_argument, NULL, FLAG_REPAIR},
    {"slowlog-us", required_argument, NULL, FLAG_SLOWLOG_US},
    {"slowlog-len", required_argument, NULL, FLAG_SLOWLOG_LEN},
    {"log-level", required_argument, NULL, FLAG_LOG_LEVEL},
    {"version", no_argument, NULL, FLAG_VERSION},
    {"help", no_argument, NULL, FLAG_HELP},
    {0},
};

static bool complain(const char *flag, const char *value, const char *wanted)
{
    fprintf(stderr, "delaunayd: --%s %s: %s\n", flag, value, wanted);
    return false;
}

/* A flag whose value is text, taken as it is. */
static const char **text_of(struct config *c, int flag)
{
    switch (flag) {
    case FLAG_BIND:
        return &c->bind_address;
    case FLAG_UNIX:
        return &c->unix_path;
    case FLAG_AUTH_FILE:
        return &c->auth_file;
    case FLAG_DATA:
        return &c->data;
    case FLAG_CHECK:
        return &c->check;
    case FLAG_REPAIR:
        return &c->repair;
    default:
        return NULL;
    }
}

/* A flag whose value is a whole number: where it goes, its bounds, what to tell who misses them. */
struct number_flag {
    uint32_t *v;
    uint32_t least, most;
    const char *wanted;
};

static struct number_flag number_of(struct config *c, int flag)
{
    switch (flag) {
    case FLAG_PORT:
        return (struct number_flag){&c->port, 0, 65535, "a port is 0 to 65535"};
    case FLAG_THREADS:
        return (struct number_flag){&c->threads, 1, MOST_THREADS, "from 1 to 256"};
    case FLAG_MAX_CLIENTS:
        return (struct number_flag){&c->max_clients, 1, 1000000, "from 1 to 1000000"};
    case FLAG_IDLE_TIMEOUT:
        return (struct number_flag){&c->idle_timeout_s, 0, 1000000, "seconds, 0 to 1000000"};
    case FLAG_MAX_POINTS:
        return (struct number_flag){&c->max_points, 1, DT_MAX_POINTS, "from 1 to 268435455"};
    case FLAG_SLOWLOG_US:
        return (struct number_flag){&c->slowlog_us, 0, UINT32_MAX,
                                    "microseconds, up to 4294967295"};
    case FLAG_SLOWLOG_LEN:
        return (struct number_flag){&c->slowlog_len, 0, 1000000, "from 0 to 1000000"};
    default:
        return (struct number_flag){0};
    }
}

/* Sets one flag that takes a value, named for the complaint. */
static bool set_value(struct config *c, int flag, const char *name, const char *value)
{
    const char **text = text_of(c, flag);
    struct number_flag number = number_of(c, flag);
    if (text != NULL)
        *text = value;
    else if (number.v != NULL)
        return parse_number(value, number.least, number.most, number.v) ||
               complain(name, value, number.wanted);
    else if (flag == FLAG_MAX_MEMORY)
        return parse_bytes(value, &c->max_memory) ||
               complain(name, value, "bytes, as in 4096m or 2g");
    else if (flag == FLAG_COMPACT_AT)
        return parse_bytes(value, &c->compact_at) ||
               complain(name, value, "bytes, as in 64m or 1g");
    else if (flag == FLAG_FSYNC)
        return parse_policy(value, &c->fsync) || complain(name, value, "always, everysec or no");
    else if (flag == FLAG_LOG_LEVEL)
        return notice_parse_level(value, &c->log_level) ||
               complain(name, value, "error, warning, info or debug");
    return true;
}

static bool safe_to_bind(const struct config *c)
{
    bool loopback;
    if (!is_loopback(c->bind_address, &loopback))
        return complain("bind", c->bind_address, "not a numeric IPv4 or IPv6 address");
    if (!loopback && c->auth_file == NULL && !c->insecure)
        return complain(
            "bind", c->bind_address,
            "others could reach this address: give --auth-file, or --insecure if you mean it");
    return true;
}

enum config_result config_parse(struct config *c, int argc, char **argv)
{
    int flag, index = 0;
    while ((flag = getopt_long(argc, argv, "", flags, &index)) != -1) {
        if (flag == FLAG_HELP || flag == FLAG_VERSION) {
            fputs(flag == FLAG_HELP ? usage : "delaunayd " DELAUNAYD_VERSION "\n", stdout);
            return CONFIG_EXIT;
        }
        if (flag == FLAG_INSECURE)
            c->insecure = true;
        else if (flag == '?' || !set_value(c, flag, flags[index].name, optarg))
            return CONFIG_BAD;
    }
    if (optind < argc) {
        fprintf(stderr, "delaunayd: %s: not a flag; see --help\n", argv[optind]);
        return CONFIG_BAD;
    }
    return safe_to_bind(c) ? CONFIG_RUN : CONFIG_BAD;
}
