/* power_life.c - see power_life.h. A story's directory contains
 *
 *     root/data    the daemon's data directory; root/ is watched
 *     ops          the daemon's operations on it
 *     said         its standard error
 *     crash/data   what a power cut may have left of it */
#include "tests/server/power/power_life.h"

#include "proto/records/record.h"
#include "server/disk/recover.h"
#include "tests/faults/power_cut_random.h"
#include "tests/server/directory.h"
#include "tests/server/power/power_agree.h"
#include "tests/server/power/power_disk.h"
#include "tests/test.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_BYTES = 100 };

static const char *path_in(const struct story *s, const char *name, char path[PATH_BYTES])
{
    snprintf(path, PATH_BYTES, "%s/%s", s->dir, name);
    return path;
}

void story_begin(struct story *s)
{
    struct directory dir = directory_quick();
    *s = (struct story){.tally = s->tally};
    snprintf(s->dir, sizeof s->dir, "%s", dir.path);
    history_init(&s->history);
    s->work.history = &s->history;
}

void story_end(struct story *s)
{
    history_clear(&s->history);
    tree_free(&s->before);
    tree_remove(s->dir);
}

/* ---- the daemon ---- */

/* In the child, whose environment is its own. */
static void load_disk(const struct story *s, const struct circumstances *c, unsigned crash)
{
    char root[PATH_BYTES], ops[PATH_BYTES];
    power_disk_load(&(struct power_disk){.root = path_in(s, "root", root),
                                         .ops = path_in(s, "ops", ops),
                                         .first = s->first,
                                         .crash = crash,
                                         .sync_fails = c->sync_fails,
                                         .write_fails = c->write_fails,
                                         .stall_us = c->stall_us,
                                         .space = c->space,
                                         .seed = test_random()});
}

static void run_daemon(const struct story *s, const struct circumstances *c, const char *data)
{
    char path[PATH_BYTES], threads[8];
    int said = open(path_in(s, "said", path), O_WRONLY | O_CREAT | O_APPEND, 0600);
    dup2(said, STDERR_FILENO);
    snprintf(threads, sizeof threads, "%u", 1 + test_below(3));
    execl(getenv("DELAUNAYD"), "delaunayd", "--port", "0", "--data", path_in(s, data, path),
          "--fsync", c->policy, "--threads", threads, "--compact-at",
          c->compact_at == NULL ? "1g" : c->compact_at, (char *)NULL);
    _exit(127);
}

/* Starts the daemon; false: it was not ready, and ends by itself. */
static bool start(const struct story *s, const struct circumstances *c, const char *data,
                  unsigned crash, struct daemon *d)
{
    int out[2];
    char line[128];
    CHECK(pipe2(out, O_CLOEXEC) == 0);
    test_random(); /* otherwise each child would draw the same numbers */
    d->pid = fork();
    CHECK(d->pid >= 0);
    if (d->pid == 0) {
        dup2(out[1], STDOUT_FILENO);
        if (strncmp(data, "root", 4) == 0)
            load_disk(s, c, crash);
        run_daemon(s, c, data);
    }
    close(out[1]);
    FILE *f = fdopen(out[0], "r");
    CHECK(f != NULL);
    bool ready =
        fgets(line, sizeof line, f) != NULL && sscanf(line, "ready on 127.0.0.1:%u", &d->port) == 1;
    fclose(f);
    return ready;
}

/* Lets the daemon run for at most ms milliseconds; returns its status. */
static int await_end(const struct daemon *d, unsigned ms, bool ready)
{
    int status;
    for (unsigned waited = 0; waitpid(d->pid, &status, WNOHANG) == 0; waited++) {
        if (waited == ms && ready)
            kill(d->pid, test_below(4) == 0 ? SIGTERM : SIGKILL);
        pause_ms(1);
    }
    return status;
}

/* Runs a daemon from its start to its end; true if it ended between two operations, so that all are
 * recorded. */
static bool run(struct story *s, const struct circumstances *c)
{
    static const unsigned most[] = {20, 100, 500, 2000, 10000};
    struct daemon d;
    bool ready = start(s, c, "root/data", 1 + test_below(most[test_below(5)]), &d);
    s->work.port = d.port;
    s->work.large = c->large;
    s->work.stop = false;
    for (int i = 0; ready && i < CLIENTS; i++)
        client_start(&s->client[i], &s->work, test_random());
    int status = await_end(&d, 1 + test_below(c->ms), ready);
    s->work.stop = true;
    for (int i = 0; ready && i < CLIENTS; i++)
        client_join(&s->client[i]);
    return WIFEXITED(status) && (WEXITSTATUS(status) == POWER_CRASHED || WEXITSTATUS(status) == 0);
}

/* Sometimes runs one daemon after the other before the power is cut: the second sees what the first has
 * written and not synced, provided that it is recorded. */
static struct power_log live(struct story *s, const struct circumstances *c, bool *exact)
{
    char path[PATH_BYTES];
    unsigned more = test_below(3) == 0 ? test_below(3) : 0;
    tree_write(&s->before, path_in(s, "root", path));
    s->first = 0;
    *exact = run(s, c);
    struct power_log log = power_log_read(path_in(s, "ops", path));
    for (; more > 0 && *exact; more--) {
        for (int i = 0; i < CLIENTS; i++)
            client_leave_sets(&s->client[i]);
        s->first = log.n;
        *exact = run(s, c);
        power_log_free(&log);
        log = power_log_read(path_in(s, "ops", path));
    }
    return log;
}

/* ---- the moment ---- */

struct moment {
    struct story *story;
    const struct circumstances *given;
    const struct power_log *log;
    struct power_cut *crash;
    size_t cut;
    struct random_fate fate;
    struct tree after;
};

__attribute__((format(printf, 2, 3), noreturn)) static void fail(const struct moment *m,
                                                                 const char *format, ...)
{
    const struct story *s = m->story;
    char what[600], path[PATH_BYTES];
    va_list ap;
    va_start(ap, format);
    vsnprintf(what, sizeof what, format, ap);
    va_end(ap);
    tree_write(&s->before, path_in(s, "before", path));
    tree_write(&m->after, path_in(s, "crash", path));
    test_fail(__FILE__, __LINE__,
              "life %u, --fsync %s, power cut after %zu of %zu operations: %s\nlost: %s\n%s has "
              "before/, the operations (ops) and what was left of them (crash/)",
              s->tally.lives, m->given->policy, m->cut, m->log->n, what, m->fate.recipe, s->dir);
}

static bool is_rare(enum power_kind k)
{
    return k == POWER_RENAME || k == POWER_UNLINK || k == POWER_SIZE || k == POWER_MKDIR ||
           k == POWER_LINK;
}

/* Anywhere; at the end; before a sync, where most operations are not yet durable; or beside a rare
 * operation. */
static size_t choose_cut(const struct power_log *log)
{
    size_t n = log->n, cut = test_below((uint32_t)n + 1);
    switch (test_below(5)) {
    case 0:
        return n;
    case 1:
    case 2:
        while (cut < n && log->op[cut].kind != POWER_SYNC)
            cut++;
        return cut;
    case 3:
        while (cut < n && !is_rare(log->op[cut].kind))
            cut++;
        return cut + test_below(n - cut < 4 ? (uint32_t)(n - cut) + 1 : 5);
    default:
        return cut;
    }
}

static bool is_segment(const char *name)
{
    return strncmp(name, "data/log.", 9) == 0;
}

/* The newest segment of the log after n operations; "" if there is none. */
static const char *newest_segment(const struct moment *m, size_t n)
{
    const struct tree *before = &m->story->before;
    const char *newest = "";
    for (size_t i = 0; i < before->names; i++)
        if (is_segment(before->name[i].path) && strcmp(before->name[i].path, newest) > 0)
            newest = before->name[i].path;
    for (size_t i = 0; i < n; i++)
        if (is_segment(m->log->op[i].name) && strcmp(m->log->op[i].name, newest) > 0)
            newest = m->log->op[i].name;
    return newest;
}

/* The operations that had been done when the last sync of the log began: a change that was acknowledged
 * before that sync is on the disk under every policy. */
static size_t synced_at(const struct moment *m)
{
    for (size_t i = m->cut; i > 0; i--) {
        const struct power_op *op = &m->log->op[i - 1];
        const char *name = power_cut_subject(m->crash, i - 1);
        if (op->kind == POWER_SYNC && op->error == 0 && is_segment(name) &&
            strcmp(name, newest_segment(m, i - 1)) == 0)
            return (size_t)op->a;
    }
    return 0;
}

static void look(struct moment *m)
{
    struct states *h = &m->story->history;
    m->cut = choose_cut(m->log);
    random_fate_init(&m->fate, test_random(), m->crash, m->log);
    m->after = power_cut_state(m->crash, m->cut, &m->fate.fate);
    bool always = strcmp(m->given->policy, "always") == 0;
    history_look(h, m->log, always ? m->cut : synced_at(m), always && m->cut == m->log->n);
}

/* ---- what was left ---- */

/* Reads the directory as the daemon would. */
static struct recovery *read_back(const struct moment *m, struct datadir *dir)
{
    char path[PATH_BYTES];
    struct recovery *r = calloc(1, sizeof *r);
    CHECK(r != NULL);
    dir->fd = -1;
    recovery_init(r, dir);
    if (tree_find(&m->after, "data") == NULL)
        return r;
    CHECK(datadir_open(dir, path_in(m->story, "crash/data", path), false));
    recovery_run(r);
    if (r->result != RECOVERY_OK)
        fail(m, "the daemon would not start: %s", r->why);
    return r;
}

/* Checks that the daemon itself has the same sets. */
static void ask_daemon(const struct moment *m, const struct recovery *r)
{
    char why[WHY_BYTES];
    struct daemon d;
    if (!start(m->story, m->given, "crash/data", 0, &d))
        fail(m, "the daemon did not start");
    bool agrees = power_agrees(&d, &r->replay.sets, why);
    daemon_stop(&d, SIGKILL);
    if (!agrees)
        fail(m, "%s", why);
}

/* Checks one state; true if the next life should begin with it. A torn end is preferred, as the case that
 * is hardest to get right. */
static bool check(const struct moment *m, bool last)
{
    struct tally *t = &m->story->tally;
    char path[PATH_BYTES], why[WHY_BYTES];
    struct datadir dir;
    tree_write(&m->after, path_in(m->story, "crash", path));
    struct recovery *r = read_back(m, &dir);
    if (!history_allows(&m->story->history, &r->replay.sets, why))
        fail(m, "%s", why);
    datadir_close(&dir);
    t->cuts++;
    t->torn += r->torn;
    bool chosen = last || (r->torn && test_below(8) == 0);
    if (chosen) {
        ask_daemon(m, r);
        history_settle(&m->story->history, &r->replay.sets);
    }
    recovery_clear(r);
    free(r);
    return chosen;
}

/* ---- a life ---- */

/* Checks that the recorded operations lead to the files that exist. */
static void check_log(const struct moment *m)
{
    char path[PATH_BYTES];
    struct tree is = tree_read(path_in(m->story, "root", path));
    struct tree recorded = power_cut_none(m->crash, m->log->n);
    const char *name = tree_difference(&recorded, &is);
    CHECK_MSG(name == NULL, "%s is not what the log of operations says (%s)", name, m->story->dir);
    tree_free(&is);
    tree_free(&recorded);
}

static void count_changes(const struct stream *s, struct tally *t)
{
    for (int i = 0; i < s->n; i++) {
        const struct sent_change *sent = &s->sent[i];
        bool done = sent->reply[0] != '\0' && !sent->refused;
        t->acknowledged += done;
        t->refused += sent->refused;
        t->unknown += sent->reply[0] == '\0';
        t->loads += done && sent->change.n > RECORD_POINTS;
    }
}

static void count(struct story *s, const struct power_log *log)
{
    struct tally *t = &s->tally;
    t->lives++;
    t->operations += (unsigned)log->n;
    for (size_t i = 0; i < log->n; i++) {
        t->snapshots += log->op[i].kind == POWER_RENAME;
        t->removals += log->op[i].kind == POWER_UNLINK;
        t->failed_syncs += log->op[i].kind == POWER_SYNC && log->op[i].error != 0;
    }
    for (int i = 0; i < s->history.streams; i++)
        count_changes(s->history.stream[i], t);
}

void story_live(struct story *s, const struct circumstances *c)
{
    bool exact;
    struct power_log log = live(s, c, &exact);
    struct moment m = {.story = s, .given = c, .log = &log};
    m.crash = power_cut_new(&s->before, &log);
    if (exact)
        check_log(&m);
    history_close(&s->history);
    s->history.disk_is_full =
        c->space > 0 || c->write_fails > 0; /* some fail because the disk is full */
    s->history.shows_unsaved = c->sync_fails + c->write_fails > 0 || c->space > 0;
    count(s, &log);
    look(&m);
    for (unsigned i = 1; !check(&m, i == c->states); i++) {
        tree_free(&m.after);
        look(&m);
    }
    tree_free(&s->before);
    s->before = m.after;
    power_cut_free(m.crash);
    power_log_free(&log);
}
