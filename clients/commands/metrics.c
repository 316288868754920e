/* metrics.c - `delaunay metrics`: INFO in the text format of Prometheus
 * (https://prometheus.io/docs/instrumenting/exposition_formats/).
 *
 *     log_bytes:64                            delaunayd_log_bytes 64
 *     durability:good                         delaunayd_durability_info{durability="good"} 1
 *     command_ADD:calls=3,p50_us=66           delaunayd_command_calls_total{command="ADD"} 3
 *                                             delaunayd_command_p50_seconds{command="ADD"} 6.6e-05
 *
 * The table has types and descriptions. A line that is not in it is converted by the same rules, so what a later daemon
 * reports appears as well. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"
#include "proto/number.h"

/* LEFT_OUT: text that changes all the time; as a label each value of it would be a time series of its own. */
enum kind { UNTYPED, GAUGE, BYTES, COUNTER, TEXT, LEFT_OUT };

/* The key of a line, or of a part of one as in `command_calls`. */
struct description {
    const char *key;
    enum kind kind;
    const char *help;
};

static const struct description descriptions[] = {
    {"version", TEXT, "Version of the daemon."},
    {"protocol", GAUGE, "Version of the protocol."},
    {"pid", GAUGE, "Process id."},
    {"uptime_s", GAUGE, "Time since the start."},
    {"threads", GAUGE, "Threads for long requests."},
    {"reactors", GAUGE, "Threads that serve connections."},
    {"clients", GAUGE, "Connections."},
    {"max_clients", GAUGE, "Most connections at once."},
    {"connections", COUNTER, "Connections that were accepted."},
    {"refused", COUNTER, "Connections that were refused."},
    {"killed", COUNTER, "Connections that CLIENT KILL has closed."},
    {"wrong_tokens", COUNTER, "Wrong tokens."},
    {"delayed_tokens", COUNTER, "Tokens whose check was delayed."},
    {"watchers", GAUGE, "Sets that connections watch."},
    {"events", COUNTER, "Events that watchers were sent."},
    {"memory", BYTES, "Memory of all sets."},
    {"memory_copies", BYTES, "Memory of copies without missing values (MISSING skip)."},
    {"memory_builds", BYTES, "Memory of triangulations that are being made."},
    {"memory_edits", BYTES,
     "Memory of batches, of copies of sets, and of sets that are being freed."},
    {"loading", BYTES, "Memory of points that are being received."},
    {"memory_log", BYTES, "Memory of changes that are not written yet."},
    {"memory_replies", BYTES, "Memory of results and rows that are being sent."},
    {"memory_clients", BYTES, "Memory of connections and their buffers."},
    {"memory_used", BYTES, "Memory that counts against the limit."},
    {"memory_peak", BYTES, "The most memory that has been used."},
    {"memory_kept", BYTES, "Free pages that are kept for reuse."},
    {"max_memory", BYTES, "The limit of memory."},
    {"resident", BYTES, "Memory of the process, as the system reports it."},
    {"commands", COUNTER, "Requests."},
    {"errors", COUNTER, "Requests with an ERR reply."},
    {"jobs", COUNTER, "Jobs for workers."},
    {"jobs_running", GAUGE, "Jobs of the workers now."},
    {"jobs_waiting", GAUGE, "Jobs among them that wait for a worker."},
    {"jobs_shared", COUNTER, "Requests that got the result of another one's job."},
    {"slow", COUNTER, "Slow requests."},
    {"sets", GAUGE, "Sets."},
    {"sets_edited", GAUGE, "Sets that a job edits now."},
    {"max_points", GAUGE, "Most points of a set."},
    {"durability", TEXT, "Whether changes can be saved: off, loading, good, full or readonly."},
    {"data_directory", TEXT, "Whether it is in its place: off, good, gone or replaced."},
    {"loaded_percent", GAUGE, "Part of the data directory that has been read."},
    {"log_lsn", GAUGE, "Changes so far."},
    {"log_durable_lsn", GAUGE, "Changes that are acknowledged or may be."},
    {"log_synced_lsn", GAUGE, "Changes that are on the disk."},
    {"log_bytes", BYTES, "Length of the log since the last snapshot."},
    {"log_syncs", COUNTER, "Syncs of the log."},
    {"log_failures", COUNTER, "Writes and syncs of the log that have failed."},
    {"snapshot_lsn", GAUGE, "Changes in the last snapshot."},
    {"snapshot_bytes", BYTES, "Length of the last snapshot."},
    {"snapshots", COUNTER, "Snapshots that were written."},
    {"snapshot_running", GAUGE, "1 while a snapshot is being written."},
    {"snapshot_failures", GAUGE, "Attempts in a row that have failed."},
    {"snapshot_retry_s", GAUGE, "Time until the next attempt."},
    {"backups", COUNTER, "Backups that were written."},
    {"backup_lsn", GAUGE, "Changes in the last backup."},
    {"backup_timestamp_s", GAUGE, "When the last backup was complete, since 1970; 0: none was."},
    {"role", TEXT, "Whether the daemon is a leader, a follower, or fenced by a newer history."},
    {"history", TEXT, "The history that the changes are part of."},
    {"lsn", GAUGE, "Changes so far, also those that are not in the log yet."},
    {"durable_lsn", GAUGE, "Changes that may be acknowledged, or sent to followers."},
    {"log_digest", LEFT_OUT, NULL},
    {"leader", TEXT, "The daemon that this one follows."},
    {"link", TEXT, "Connection to the leader: connecting, receiving, loading or refused."},
    {"link_error", TEXT, "Why there is none."},
    {"uninformed_leader", TEXT, "The former leader, until it is known to refuse changes."},
    {"daemon", LEFT_OUT, NULL},
    {"settled", GAUGE,
     "1 if it leads, and no promoted follower that can reach it has replaced it."},
    {"generation", GAUGE, "Of the history: grows with each promotion."},
    {"link_lag_records", GAUGE, "Changes of the leader that have not arrived."},
    {"followers", GAUGE, "Followers that are connected."},
    {"min_followers", GAUGE, "Followers that must have a change before it is acknowledged."},
    {"follower", TEXT, "Followers, by number: starting, snapshot, log or ended."},
    {"follower_lsn", GAUGE, "Changes that the follower has on its disk."},
    {"follower_lag_records", GAUGE, "Changes that it does not have."},
    {"follower_lag_bytes", GAUGE, "What it was sent and has not acknowledged."},
    {"follower_lag_s", GAUGE, "Time since it last had everything."},
    {"follower_silent_s", GAUGE, "Time since it last acknowledged something of what it was sent."},
    {"command_calls", COUNTER, "Requests, by command."},
    {"command_errors", COUNTER, "Requests with an ERR reply, by command."},
    {"command_p50_us", GAUGE, "Median of the time of a request since the start."},
    {"command_p99_us", GAUGE, "99 per cent of all requests since the start took no longer."},
    {"command_max_us", GAUGE, "The longest time of a request since the start."},
    {"command_waits", COUNTER, "Requests that had to wait for a set or a worker."},
    {"command_wait_p50_us", GAUGE, "Median of their time of waiting."},
    {"command_wait_p99_us", GAUGE, "99 per cent of them waited no longer."},
    {"command_wait_max_us", GAUGE, "The longest time of waiting."},
};

enum { ROOM = 96, LABELS = 512, SAMPLES = 4096 };

struct sample {
    char key[ROOM]; /* of the description */
    char name[ROOM];
    char labels[LABELS]; /* with their braces, or empty */
    char value[32];
    enum kind kind;
    const char *help;
    bool printed;
};

struct metrics {
    struct sample *sample; /* owns, SAMPLES of them */
    size_t n;
};

/* ---- names and values ---- */

static bool ends(const char *text, const char *suffix)
{
    size_t n = strlen(text), m = strlen(suffix);
    return n > m && strcmp(text + n - m, suffix) == 0;
}

static const struct description *describe(const char *key)
{
    static const struct description unknown = {NULL, UNTYPED, NULL};
    for (size_t i = 0; i < sizeof descriptions / sizeof descriptions[0]; i++)
        if (strcmp(descriptions[i].key, key) == 0)
            return &descriptions[i];
    return &unknown;
}

/* Prometheus's units are seconds and bytes. Returns the factor of the values. */
static double name_metric(struct sample *s)
{
    static const struct {
        const char *suffix;
        double factor;
    } units[] = {{"_us", 1e-6}, {"_ms", 1e-3}, {"_s", 1}};
    double factor = 1;
    int len = (int)strlen(s->key);
    const char *unit = s->kind == BYTES && !ends(s->key, "_bytes") ? "_bytes" : "";
    for (size_t i = 0; i < sizeof units / sizeof units[0] && *unit == '\0'; i++) {
        if (ends(s->key, units[i].suffix)) {
            len -= (int)strlen(units[i].suffix);
            factor = units[i].factor;
            unit = "_seconds";
        }
    }
    snprintf(s->name, sizeof s->name, "delaunayd_%.*s%s%s", len, s->key, unit,
             s->kind == COUNTER ? "_total"
             : s->kind == TEXT  ? "_info"
                                : "");
    for (char *at = s->name; *at != '\0'; at++)
        if (strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", *at) == NULL)
            *at = '_';
    return factor;
}

/* Appends `name="value"` within the braces. */
static void add_label(struct sample *s, const char *name, const char *value)
{
    size_t at = strlen(s->labels);
    if (at + strlen(name) + 2 * strlen(value) + 6 > sizeof s->labels)
        return;
    char *to = s->labels + at;
    if (at > 0)
        to[-1] = ',';
    else
        *to++ = '{';
    to += sprintf(to, "%s=\"", name);
    for (; *value != '\0'; value++) {
        if (*value == '\\' || *value == '"')
            *to++ = '\\';
        *to++ = *value;
    }
    memcpy(to, "\"}", 3);
}

/* ---- lines of INFO ---- */

static struct sample *add(struct metrics *m, const char *key)
{
    if (m->n == SAMPLES)
        return NULL;
    struct sample *s = &m->sample[m->n++];
    const struct description *d = describe(key);
    *s = (struct sample){.kind = d->kind, .help = d->help};
    snprintf(s->key, sizeof s->key, "%s", key);
    return s;
}

/* A value of its own. `label`: a label of that name has the value `of`; NULL: none. */
static void add_value(struct metrics *m, const char *key, const char *value, const char *label,
                      const char *of)
{
    struct sample *s = add(m, key);
    if (s == NULL)
        return;
    if (!proto_is_number(value, strlen(value)))
        s->kind = TEXT;
    double factor = name_metric(s);
    if (label != NULL)
        add_label(s, label, of);
    if (s->kind == TEXT)
        add_label(s, key, value);
    if (s->kind == TEXT)
        snprintf(s->value, sizeof s->value, "1");
    else if (factor == 1)
        snprintf(s->value, sizeof s->value, "%.31s", value);
    else
        snprintf(s->value, sizeof s->value, "%.9g", strtod(value, NULL) * factor);
}

/* `command_ADD:calls=1,errors=0`: the label is `command`, its value what follows the first `_`, or the number at the
 * end. Values that are text become labels of one more metric. */
static void add_group(struct metrics *m, const char *key, char *values)
{
    char label[ROOM], name[2 * ROOM];
    size_t n = strcspn(key, "_0123456789");
    const char *of = key[n] == '_' ? key + n + 1 : key + n;
    snprintf(label, sizeof label, "%.*s", (int)n, key);
    struct sample *texts = NULL;
    for (char *word = strtok(values, ","); word != NULL; word = strtok(NULL, ",")) {
        char *value = strchr(word, '=');
        if (value == NULL)
            continue;
        *value++ = '\0';
        if (proto_is_number(value, strlen(value))) {
            snprintf(name, sizeof name, "%s_%.80s", label, word);
            add_value(m, name, value, label, of);
            continue;
        }
        if (texts == NULL && (texts = add(m, label)) != NULL) {
            texts->kind = TEXT;
            name_metric(texts);
            snprintf(texts->value, sizeof texts->value, "1");
            add_label(texts, label, of);
        }
        if (texts != NULL)
            add_label(texts, word, value);
    }
}

static bool take_line(void *ctx, const struct delaunay_part *part)
{
    char line[1024];
    if (part->kind != DELAUNAY_PART_ROW)
        return true;
    snprintf(line, sizeof line, "%.*s", (int)part->len, part->text);
    char *value = strchr(line, ':');
    if (value == NULL)
        return true;
    *value++ = '\0';
    enum kind kind = describe(line)->kind;
    if (kind == LEFT_OUT)
        return true;
    if (kind != TEXT && strchr(value, '=') != NULL)
        add_group(ctx, line, value);
    else
        add_value(ctx, line, value, NULL, NULL);
    return true;
}

/* ---- printing ---- */

/* All samples of a metric are printed together, as the format requires. */
static void print_from(struct metrics *m, size_t first)
{
    static const char *const type[] = {"untyped", "gauge", "gauge", "counter", "gauge", NULL};
    const struct sample *s = &m->sample[first];
    if (s->help != NULL)
        printf("# HELP %s %s\n", s->name, s->help);
    else
        printf("# HELP %s The value %s of INFO.\n", s->name, s->key);
    printf("# TYPE %s %s\n", s->name, type[s->kind]);
    for (size_t i = first; i < m->n; i++) {
        struct sample *t = &m->sample[i];
        if (t->printed || strcmp(t->name, s->name) != 0)
            continue;
        printf("%s%s %s\n", t->name, t->labels, t->value);
        t->printed = true;
    }
}

int command_metrics(struct delaunay_client *c, int argc, char **argv)
{
    if (argc > 1)
        return options_wrong(argv[0], "metrics takes no arguments");
    struct metrics m = {.sample = calloc(SAMPLES, sizeof *m.sample)};
    if (m.sample == NULL) {
        fputs("delaunay: out of memory\n", stderr);
        return EXIT_REFUSED;
    }
    enum delaunay_result r = delaunay_request(c, "INFO", take_line, &m);
    for (size_t i = 0; r == DELAUNAY_OK && i < m.n; i++)
        if (!m.sample[i].printed)
            print_from(&m, i);
    free(m.sample);
    return request_outcome(c, r);
}
