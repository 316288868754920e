/* redis_info.c - see handlers.h. INFO. A section is a line `# Name`, Redis's facts, and ours as INFO in lines has them. Programs take the
 * sections apart by these lines, and facts by their names; so two facts of ours that mean something else in Redis have other names. */
#include "server/redis/handlers.h"

#include "proto/resp.h"
#include "server/clients/clients.h"
#include "server/follow/follower.h"
#include "server/follow/leader.h"
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

static void add_server(struct server *s, struct facts *f)
{
    uint64_t up = (uint64_t)(clock_ms() - s->started_ms) / 1000;
    facts_add_text(f, "redis_version", REDIS_VERSION);
    facts_add_text(f, "redis_mode", "standalone");
    facts_add(f, "arch_bits", 8 * sizeof(void *));
    facts_add(f, "process_id", (uint64_t)getpid());
    facts_add(f, "uptime_in_seconds", up);
    facts_add(f, "uptime_in_days", up / 86400);
}

static void add_clients(struct server *s, struct facts *f)
{
    facts_add(f, "connected_clients", s->clients != NULL ? s->clients->n : 0);
    facts_add(f, "maxclients", s->config->max_clients);
    facts_add(f, "blocked_clients", 0);
}

static void add_memory(struct server *s, struct facts *f)
{
    facts_add(f, "used_memory", budget_used(&s->budget));
    facts_add(f, "used_memory_rss", machine_resident());
    facts_add(f, "used_memory_peak", s->budget.peak);
    facts_add(f, "maxmemory", s->config->max_memory);
    facts_add_text(f, "maxmemory_policy", "noeviction");
}

static void add_persistence(struct server *s, struct facts *f)
{
    const struct saver *v = durable_saver(s);
    facts_add(f, "loading", !durable_is_complete(s));
    facts_add(f, "rdb_bgsave_in_progress", v->snapshot != NULL);
    facts_add_text(f, "rdb_last_bgsave_status", saver_failures(v) == 0 ? "ok" : "err");
    facts_add(f, "aof_enabled", s->config->data != NULL);
    facts_add_text(f, "aof_last_write_status", v->status.state == LOG_FAILED ? "err" : "ok");
}

static void add_stats(struct server *s, struct facts *f)
{
    struct request_counts requests = server_requests(s);
    facts_add(f, "total_connections_received", s->count.connections);
    facts_add(f, "total_commands_processed", requests.commands);
    facts_add(f, "rejected_connections", s->count.refused);
    facts_add(f, "total_error_replies", requests.errors);
}

static void add_leader(const struct server *s, const struct follower_facts *own, struct facts *f)
{
    char address[ROLE_TEXT];
    size_t host;
    const char *port = redis_split_address(own->leader, &host);
    snprintf(address, sizeof address, "%.*s", (int)host, own->leader);
    facts_add_text(f, "master_host", address);
    facts_add_text(f, "master_port", port);
    facts_add_text(f, "master_link_status", strcmp(own->state, "receiving") == 0 ? "up" : "down");
    facts_add(f, "slave_read_only", 1);
    facts_add(f, "slave_repl_offset", durable_last_lsn(s));
}

static void add_replication(struct server *s, struct facts *f)
{
    struct follower_facts own;
    follower_facts(s, &own);
    facts_add_text(f, "role", s->follows ? "slave" : "master");
    if (s->follows)
        add_leader(s, &own, f);
    facts_add(f, "connected_slaves", leader_followers(s));
    facts_add(f, "master_repl_offset", durable_last_lsn(s));
}

static void add_seconds(struct facts *f, const char *key, const struct timeval *t)
{
    char text[40];
    snprintf(text, sizeof text, "%" PRId64 ".%06ld", (int64_t)t->tv_sec, (long)t->tv_usec);
    facts_add_text(f, key, text);
}

static void add_cpu(struct server *s, struct facts *f)
{
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    add_seconds(f, "used_cpu_sys", &used.ru_stime);
    add_seconds(f, "used_cpu_user", &used.ru_utime);
}

static void add_calls(struct facts *f, const char *name, const struct command_stats *of)
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
    facts_add_text(f, key, value);
}

static void add_commandstats(struct server *s, struct facts *f)
{
    struct command_stats sum;
    for (size_t i = 0; i < s->command_count; i++) {
        const struct command_stats *of = server_stats(s, i, &sum);
        if (of->calls > 0)
            add_calls(f, s->commands[i].name, of);
    }
}

static void add_cluster(struct server *s, struct facts *f)
{
    facts_add(f, "cluster_enabled", 0);
}

static void add_keyspace(struct server *s, struct facts *f)
{
    char text[80];
    snprintf(text, sizeof text, "keys=%zu,expires=%zu,avg_ttl=0", s->sets.sets, s->sets.expiring);
    facts_add_text(f, "db0", text);
}

/* ---- sections ---- */

static const struct section {
    const char *name, *asked;    /* as it is shown, and in capitals */
    const char *ours, *or_asked; /* our section, and another name that asks for it; NULL: none */
    void (*add)(struct server *s, struct facts *f);
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

/* Appends the facts. Of ours, `loading` and `role`, which mean something else in Redis, get longer names. */
static void append(struct buf *out, struct facts *f, bool ours)
{
    const char *at = buf_head(&f->text);
    for (uint64_t i = 0; i < f->n && !f->text.failed; i++) {
        size_t n = strcspn(at, "\n");
        if (ours && (strncmp(at, "loading:", 8) == 0 || strncmp(at, "role:", 5) == 0))
            buf_append_text(out, "delaunayd_");
        buf_append(out, at, n);
        buf_append(out, "\r\n", 2);
        at += n + 1;
    }
    out->failed |= f->text.failed;
    buf_free(&f->text);
}

static void add_section(struct server *s, const struct section *which, struct buf *out)
{
    struct facts redis = {0}, ours = {0};
    if (buf_len(out) > 0)
        buf_append(out, "\r\n", 2);
    buf_append(out, "# ", 2);
    buf_append_text(out, which->name);
    buf_append(out, "\r\n", 2);
    if (which->add != NULL)
        which->add(s, &redis);
    if (which->ours != NULL)
        s->info(s, which->ours, &ours);
    append(out, &redis, false);
    append(out, &ours, true);
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
