/* redis_info.c - see handlers.h. INFO. A section is a line `# Name`, Redis's facts, and ours as INFO in lines has them. Programs take the
 * sections apart by these lines, and facts by their names; so two facts of ours that mean something else in Redis have other names. */
#include "server/redis/handlers.h"

#include "proto/resp.h"
#include "server/clients/clients.h"
#include "server/follow/cmd_follow.h"
#include "server/jobs/durable.h"
#include "server/ops/facts.h"
#include "server/system/loop.h"
#include "server/system/machine.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* ---- Redis's facts ---- */

static void add_text(struct buf *out, const char *key, const char *value)
{
    buf_append_text(out, key);
    buf_append_char(out, ':');
    buf_append_text(out, value);
    buf_append(out, "\r\n", 2);
}

static void add(struct buf *out, const char *key, uint64_t value)
{
    char text[24];
    snprintf(text, sizeof text, "%" PRIu64, value);
    add_text(out, key, text);
}

static void add_server(struct server *s, struct buf *out)
{
    uint64_t up = (uint64_t)(clock_ms() - s->started_ms) / 1000;
    add_text(out, "redis_version", REDIS_VERSION);
    add_text(out, "redis_mode", "standalone");
    add(out, "arch_bits", 8 * sizeof(void *));
    add(out, "process_id", (uint64_t)getpid());
    add(out, "uptime_in_seconds", up);
    add(out, "uptime_in_days", up / 86400);
}

static void add_clients(struct server *s, struct buf *out)
{
    add(out, "connected_clients", s->clients != NULL ? s->clients->n : 0);
    add(out, "maxclients", s->config->max_clients);
    add(out, "blocked_clients", 0);
}

static void add_memory(struct server *s, struct buf *out)
{
    add(out, "used_memory", budget_used(&s->budget));
    add(out, "used_memory_rss", machine_resident());
    add(out, "used_memory_peak", s->budget.peak);
    add(out, "maxmemory", s->config->max_memory);
    add_text(out, "maxmemory_policy", "noeviction");
}

static void add_persistence(struct server *s, struct buf *out)
{
    const struct saver *v = durable_saver(s);
    add(out, "loading", !durable_is_complete(s));
    add(out, "rdb_bgsave_in_progress", v->snapshot != NULL);
    add_text(out, "rdb_last_bgsave_status", saver_failures(v) == 0 ? "ok" : "err");
    add(out, "aof_enabled", s->config->data != NULL);
    add_text(out, "aof_last_write_status", v->status.state == LOG_FAILED ? "err" : "ok");
}

static void add_stats(struct server *s, struct buf *out)
{
    struct request_counts requests = server_requests(s);
    add(out, "total_connections_received", s->count.connections);
    add(out, "total_commands_processed", requests.commands);
    add(out, "rejected_connections", s->count.refused);
    add(out, "total_error_replies", requests.errors);
}

/* The two halves of the leader's address. */
static void add_leader(const struct follow_place *p, struct buf *out)
{
    char text[sizeof p->leader];
    memcpy(text, p->leader, sizeof text);
    char *colon = strrchr(text, ':');
    if (colon != NULL)
        *colon = '\0';
    add_text(out, "master_host", text);
    add_text(out, "master_port", colon != NULL ? colon + 1 : "0");
    add_text(out, "master_link_status", p->receiving ? "up" : "down");
    add(out, "slave_read_only", 1);
    add(out, "slave_repl_offset", p->lsn);
}

static void add_replication(struct server *s, struct buf *out)
{
    struct follow_place p = follow_place(s);
    add_text(out, "role", s->follows ? "slave" : "master");
    if (s->follows)
        add_leader(&p, out);
    add(out, "connected_slaves", p.followers);
    add(out, "master_repl_offset", p.lsn);
}

static void add_seconds(struct buf *out, const char *key, const struct timeval *t)
{
    char text[40];
    snprintf(text, sizeof text, "%" PRId64 ".%06ld", (int64_t)t->tv_sec, (long)t->tv_usec);
    add_text(out, key, text);
}

static void add_cpu(struct server *s, struct buf *out)
{
    struct rusage used;
    (void)s;
    getrusage(RUSAGE_SELF, &used);
    add_seconds(out, "used_cpu_sys", &used.ru_stime);
    add_seconds(out, "used_cpu_user", &used.ru_utime);
}

static void add_calls(struct buf *out, const char *name, const struct command_stats *of)
{
    char key[40] = "cmdstat_", value[160];
    uint64_t us = histogram_sum(&of->work) / 1000;
    size_t at = strlen(key);
    for (; *name != '\0' && at + 1 < sizeof key; name++)
        key[at++] = (char)(*name | 0x20);
    key[at] = '\0';
    snprintf(value, sizeof value,
             "calls=%" PRIu64 ",usec=%" PRIu64
             ",usec_per_call=%.2f,rejected_calls=0,failed_calls=%" PRIu64,
             of->calls, us, (double)us / (double)of->calls, of->errors);
    add_text(out, key, value);
}

static void add_commandstats(struct server *s, struct buf *out)
{
    struct command_stats sum;
    for (size_t i = 0; i < s->command_count; i++) {
        const struct command_stats *of = server_stats(s, i, &sum);
        if (of->calls > 0)
            add_calls(out, s->commands[i].name, of);
    }
}

static void add_cluster(struct server *s, struct buf *out)
{
    (void)s;
    add(out, "cluster_enabled", 0);
}

static void add_keyspace(struct server *s, struct buf *out)
{
    char text[80];
    snprintf(text, sizeof text, "keys=%zu,expires=%zu,avg_ttl=0", s->sets.sets, s->sets.expiring);
    add_text(out, "db0", text);
}

/* ---- sections ---- */

static const struct section {
    const char *name, *asked;    /* as it is shown, and in capitals */
    const char *ours, *or_asked; /* our section, and another name that asks for it; NULL: none */
    void (*add)(struct server *s, struct buf *out);
} sections[] = {
    {"Server", "SERVER", "SERVER", NULL, add_server},
    {"Clients", "CLIENTS", "CLIENTS", NULL, add_clients},
    {"Memory", "MEMORY", "MEMORY", NULL, add_memory},
    {"Persistence", "PERSISTENCE", NULL, NULL, add_persistence},
    {"Durability", "DURABILITY", "DURABILITY", "PERSISTENCE", NULL},
    {"Stats", "STATS", "STATS", NULL, add_stats},
    {"Replication", "REPLICATION", "REPLICATION", NULL, add_replication},
    {"CPU", "CPU", NULL, NULL, add_cpu},
    {"Commandstats", "COMMANDSTATS", NULL, NULL, add_commandstats},
    {"Commands", "COMMANDS", "COMMANDS", "LATENCYSTATS", NULL},
    {"Sets", "SETS", "SETS", NULL, NULL},
    {"Cluster", "CLUSTER", NULL, NULL, add_cluster},
    {"Keyspace", "KEYSPACE", NULL, NULL, add_keyspace},
};

static bool asks_for(const struct request *q, const struct section *which)
{
    bool asked = q->n == 1;
    for (size_t i = 1; i < q->n; i++) {
        const struct word *w = &q->word[i];
        asked |= word_is(w, which->asked) ||
                 (which->or_asked != NULL && word_is(w, which->or_asked)) || word_is(w, "ALL") ||
                 word_is(w, "DEFAULT") || word_is(w, "EVERYTHING");
    }
    return asked;
}

/* Copies our facts; `loading` and `role`, which mean something else in Redis, get longer names. */
static void copy_facts(const struct facts *f, struct buf *out)
{
    const char *at = buf_head(&f->text);
    for (uint64_t i = 0; i < f->n && !f->text.failed; i++) {
        size_t n = strcspn(at, "\n");
        if (strncmp(at, "loading:", 8) == 0 || strncmp(at, "role:", 5) == 0)
            buf_append_text(out, "delaunayd_");
        buf_append(out, at, n);
        buf_append(out, "\r\n", 2);
        at += n + 1;
    }
}

static void add_section(struct server *s, const struct section *which, struct buf *out)
{
    struct facts ours = {0};
    if (buf_len(out) > 0)
        buf_append(out, "\r\n", 2);
    buf_append(out, "# ", 2);
    buf_append_text(out, which->name);
    buf_append(out, "\r\n", 2);
    if (which->add != NULL)
        which->add(s, out);
    if (which->ours != NULL)
        s->info(s, which->ours, &ours);
    copy_facts(&ours, out);
    out->failed |= ours.text.failed;
    buf_free(&ours.text);
}

/* Of a section that does not exist there are no facts, as in Redis. */
void redis_info(struct server *s, const struct request *q, struct answer *a)
{
    struct buf out = {0};
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++)
        if (asks_for(q, &sections[i]))
            add_section(s, &sections[i], &out);
    if (out.failed)
        answer_out_of_memory(a);
    else
        resp_bulk(a->out, buf_head(&out), buf_len(&out));
    buf_free(&out);
}
