/* info.c - see info.h. Facts are in sections, rows `key:value`. */
#include "server/info.h"

#include "proto/version.h"
#include "server/clients/clients.h"
#include "server/follow/cmd_follow.h"
#include "server/jobs/durable.h"
#include "server/jobs/job.h"
#include "server/system/loop.h"
#include "server/system/machine.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- sections ---- */

static void add_server(const struct server *s, struct facts *f)
{
    facts_add_text(f, "version", DELAUNAY_VERSION);
    facts_add(f, "protocol", PROTOCOL_VERSION);
    facts_add(f, "pid", (uint64_t)getpid());
    facts_add(f, "uptime_s", (uint64_t)(clock_ms() - s->started_ms) / 1000);
    facts_add(f, "threads", s->config->threads);
    facts_add(f, "reactors", s->reactors);
}

static void add_clients(const struct server *s, struct facts *f)
{
    facts_add(f, "clients", s->clients != NULL ? s->clients->n : 0);
    facts_add(f, "max_clients", s->config->max_clients);
    facts_add(f, "connections", s->count.connections);
    facts_add(f, "refused", s->count.refused);
    facts_add(f, "killed", s->count.killed);
    facts_add(f, "wrong_tokens", s->count.wrong_tokens);
    facts_add(f, "delayed_tokens", s->count.delayed_tokens);
    facts_add(f, "watchers", s->count.watchers);
    facts_add(f, "events", s->count.events);
}

static void add_memory(const struct server *s, struct facts *f)
{
    struct dt_pages_summary pages;
    dt_pages_summary(s->pages, &pages);
    const struct budget *b = &s->budget;
    facts_add(f, "memory", budget_of(b, BUDGET_SETS));
    facts_add(f, "memory_copies", budget_of(b, BUDGET_COPIES));
    facts_add(f, "memory_builds", budget_of(b, BUDGET_BUILDS));
    facts_add(f, "memory_edits", budget_of(b, BUDGET_EDITS));
    facts_add(f, "loading", budget_of(b, BUDGET_LOADS));
    facts_add(f, "memory_log", budget_of(b, BUDGET_LOG));
    facts_add(f, "memory_replies", budget_of(b, BUDGET_REPLIES));
    facts_add(f, "memory_clients", budget_of(b, BUDGET_CLIENTS));
    facts_add(f, "memory_used", budget_used(b));
    facts_add(f, "memory_peak", b->peak);
    facts_add(f, "memory_kept", pages.kept);
    facts_add(f, "max_memory", s->config->max_memory);
    facts_add(f, "resident", machine_resident());
}

static void add_stats(const struct server *s, struct facts *f)
{
    uint64_t running = 0;
    for (const struct job *j = job_first(s); j != NULL; j = job_next(s, j))
        running++;
    struct request_counts requests = server_requests(s);
    facts_add(f, "commands", requests.commands);
    facts_add(f, "errors", requests.errors);
    facts_add(f, "jobs", s->count.jobs);
    facts_add(f, "jobs_running", running);
    facts_add(f, "jobs_waiting", s->workers != NULL ? workers_backlog(s->workers) : 0);
    facts_add(f, "jobs_shared", s->count.shared);
    facts_add(f, "slow", requests.slow);
}

static void add_sets(const struct server *s, struct facts *f)
{
    uint64_t edited = 0;
    for (const struct job *j = job_first(s); j != NULL; j = job_next(s, j))
        edited += j->set != NULL;
    facts_add(f, "sets", s->sets.sets);
    facts_add(f, "sets_edited", edited);
    facts_add(f, "max_points", s->config->max_points);
}

/* Appends quantiles in microseconds: `,<prefix>p50_us=` and so on. */
static void add_quantiles(char *text, size_t size, const char *prefix, const struct histogram *h)
{
    size_t at = strlen(text);
    snprintf(text + at, size - at, ",%sp50_us=%.3f,%sp99_us=%.3f,%smax_us=%.3f", prefix,
             (double)histogram_quantile(h, 0.5) / 1000, prefix,
             (double)histogram_quantile(h, 0.99) / 1000, prefix, (double)h->max / 1000);
}

static void add_command(struct facts *f, const char *name, const struct command_stats *of)
{
    char key[32], value[320];
    if (of->calls == 0)
        return;
    snprintf(key, sizeof key, "command_%s", name);
    snprintf(value, sizeof value, "calls=%" PRIu64 ",errors=%" PRIu64, of->calls, of->errors);
    add_quantiles(value, sizeof value, "", &of->work);
    size_t at = strlen(value);
    snprintf(value + at, sizeof value - at, ",waits=%" PRIu64, of->wait.total);
    add_quantiles(value, sizeof value, "wait_", &of->wait);
    facts_add_text(f, key, value);
}

static void add_commands(const struct server *s, struct facts *f)
{
    struct command_stats sum;
    for (size_t i = 0; i < s->command_count; i++)
        add_command(f, s->commands[i].name, server_stats(s, i, &sum));
    add_command(f, "OTHER", server_stats(s, STATS_OTHER, &sum));
}

static const struct section {
    const char *name;
    void (*add)(const struct server *s, struct facts *f);
} sections[] = {
    {"SERVER", add_server},        {"CLIENTS", add_clients},   {"MEMORY", add_memory},
    {"STATS", add_stats},          {"SETS", add_sets},         {"DURABILITY", durable_facts},
    {"REPLICATION", follow_facts}, {"COMMANDS", add_commands},
};

enum { SECTIONS = sizeof sections / sizeof sections[0] };

void info_section(const struct server *s, const char *name, struct facts *f)
{
    for (size_t i = 0; i < SECTIONS; i++)
        if (strcmp(name, sections[i].name) == 0)
            sections[i].add(s, f);
}

/* ---- the command ---- */

/* Adds the sections of that name, or all (name NULL), unless the reply has them already: added[i]. False: there is none. */
static bool add_sections(const struct server *s, struct facts *f, bool *added,
                         const struct word *name)
{
    bool known = false;
    for (size_t i = 0; i < SECTIONS; i++) {
        if (name != NULL && !word_is(name, "ALL") && !word_is(name, sections[i].name))
            continue;
        if (!added[i])
            sections[i].add(s, f);
        known = added[i] = true;
    }
    return known;
}

void cmd_info(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct facts f = {0};
    bool known = true, added[SECTIONS] = {false};
    if (q->n == 1)
        add_sections(s, &f, added, NULL);
    for (size_t i = 1; i < q->n && known; i++) {
        known = add_sections(s, &f, added, &q->word[i]);
        if (!known)
            answer_err(a, ERR_SYNTAX,
                       "INFO has no section %.*s; it has server clients memory stats sets "
                       "durability replication commands all",
                       QUOTED(&q->word[i]));
    }
    if (known) {
        reply_ok(a->out, f.n);
        reply_end(a->out);
        buf_append(a->out, buf_head(&f.text), buf_len(&f.text));
    }
    if (f.text.failed)
        answer_out_of_memory(a);
    buf_free(&f.text);
}
