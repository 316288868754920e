/* power_repair_test.c - power cuts while --repair runs. A directory is damaged at random, and an
 * uninterrupted repair determines what can be kept. The power is cut during the repair, and again during
 * the repair of the result. The last repair must keep as much as the uninterrupted one. All earlier
 * content must still exist, in damaged.* if not under its own name. */
#include "proto/records/record.h"
#include "server/disk/recover.h"
#include "tests/faults/power_cut_random.h"
#include "tests/server/digest.h"
#include "tests/server/directory.h"
#include "tests/server/power/power_disk.h"
#include "tests/test.h"

#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_BYTES = 100, NAMES_LIMIT = 16, FILE_LIMIT = 4096, ROUNDS = 32 };

struct bench {
    char root[PATH_BYTES], data[PATH_BYTES], ops[PATH_BYTES], said[PATH_BYTES], dir[64];
};

static struct bench bench_new(void)
{
    struct bench b;
    struct directory dir = directory_quick();
    snprintf(b.dir, sizeof b.dir, "%s", dir.path);
    snprintf(b.root, PATH_BYTES, "%s/root", dir.path);
    snprintf(b.data, PATH_BYTES, "%s/root/data", dir.path);
    snprintf(b.ops, PATH_BYTES, "%s/ops", dir.path);
    snprintf(b.said, PATH_BYTES, "%s/said", dir.path);
    return b;
}

/* ---- directories to be damaged ---- */

/* Runs a daemon, which gets these requests, is killed, and leaves a segment of its own. */
static void live(const struct bench *b, const char *requests)
{
    struct directory dir;
    snprintf(dir.path, sizeof dir.path, "%.*s", (int)sizeof dir.path - 1, b->data);
    struct daemon d = directory_daemon(&dir, NULL);
    carry_out(&d, requests);
    if (strcmp(requests, "SNAPSHOT\n") == 0) {
        await_info(&d, "snapshots", 1);
        carry_out(&d, "ADD t 8 8\nMOVE t 0 9 9\nADD late 1 1\n");
    }
    daemon_stop(&d, SIGKILL);
}

enum sample_kind { ONLY_LOG, WITH_SNAPSHOT, WITH_SNAPSHOT_AND_WHOLE_LOG, SAMPLE_KINDS };

static struct tree make_sample(const struct bench *b, enum sample_kind kind)
{
    struct tree t = {0}, log;
    char reserve[PATH_BYTES + 10];
    snprintf(reserve, sizeof reserve, "%s/reserve", b->data);
    tree_write(&t, b->root);
    live(b, "ADD t 0 0  4 0  4 4  0 4  2 2\nTRIANGULATE t\nCREATE a TOL 0.5\nADD a 0 0  0.25 0\n");
    live(b, "ADD a 3 3\nDEL t 1\nCREATE empty\nADD gone 1 1\nDROP gone\n");
    log = tree_read(b->root);
    if (kind != ONLY_LOG)
        live(b, "SNAPSHOT\n");
    live(b, "ADD t 1 7  2 9\nADD new 7 7\nTRIANGULATE new\n");
    CHECK(unlink(reserve) == 0);
    t = tree_read(b->root);
    for (size_t i = 0; kind == WITH_SNAPSHOT_AND_WHOLE_LOG && i < log.names; i++) {
        const struct tree_name *name = &log.name[i];
        if (strncmp(name->path, "data/log.", 9) == 0 && tree_find(&t, name->path) == NULL)
            tree_add_name(&t, name->path, tree_add_file(&t, &log.file[name->file]));
    }
    tree_free(&log);
    return t;
}

static struct tree copy(const struct tree *t)
{
    struct tree c = {0};
    for (size_t i = 0; i < t->files; i++)
        tree_add_file(&c, &t->file[i]);
    for (size_t i = 0; i < t->names; i++)
        tree_add_name(&c, t->name[i].path, t->name[i].file);
    return c;
}

static bool is_ours(const char *path)
{
    return strncmp(path, "data/log.", 9) == 0 || strncmp(path, "data/snapshot.", 14) == 0;
}

/* Flips some bits of a file, cuts it short, or removes it. */
static void damage(struct tree *t)
{
    size_t i;
    do
        i = test_below((uint32_t)t->names);
    while (!is_ours(t->name[i].path));
    struct tree_file *f = &t->file[t->name[i].file];
    unsigned kind = test_below(10);
    for (unsigned k = 0; kind < 8 && f->n > 0 && k <= kind / 3; k++)
        f->bytes[test_below((uint32_t)f->n)] ^= (char)(1 << test_below(8));
    if (kind == 8)
        f->size = f->n = test_below((uint32_t)f->n + 1);
    if (kind == 9) {
        free(t->name[i].path);
        t->name[i] = t->name[--t->names];
    }
}

/* ---- repairs ---- */

/* Runs --repair on the files in root/, on this disk; NULL: a good one. Returns its exit status. */
static int repair(const struct bench *b, const struct power_disk *disk)
{
    int status;
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        int said = open(b->said, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(said, STDOUT_FILENO);
        dup2(said, STDERR_FILENO);
        if (disk != NULL)
            power_disk_load(disk);
        execl(getenv("DELAUNAYD"), "delaunayd", "--repair", b->data, (char *)NULL);
        _exit(127);
    }
    CHECK(waitpid(pid, &status, 0) == pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

struct outcome {
    bool good;
    uint64_t last, digest;
};

static struct outcome look(const struct bench *b)
{
    struct datadir dir;
    struct recovery *r = calloc(1, sizeof *r);
    CHECK(r != NULL && datadir_open(&dir, b->data, false));
    recovery_init(r, &dir);
    recovery_run(r);
    struct outcome o = {r->result == RECOVERY_OK, r->last, digest_sets(&r->replay.sets)};
    recovery_clear(r);
    free(r);
    datadir_close(&dir);
    return o;
}

/* ---- the content before the repair ---- */

/* Whether the first n bytes of a file still exist: under its name, in a file that was set aside, or in
 * parts; repairs may have moved pieces of its end. A header alone contains no more than the name. */
static bool is_kept(const struct tree *t, const char *path, const struct tree_file *f, uint64_t n)
{
    char aside[PATH_BYTES];
    const struct tree_file *own = tree_find(t, path);
    if (n <= SEGMENT_HEADER || (own != NULL && tree_bytes_equal(f, 0, own, 0, n)))
        return true;
    snprintf(aside, sizeof aside, "data/damaged.%s", path + strlen("data/"));
    for (size_t i = 0; i < t->names; i++) {
        const struct tree_file *piece = &t->file[t->name[i].file];
        if (strncmp(t->name[i].path, aside, strlen(aside)) == 0 && piece->size > 0 &&
            piece->size <= n && tree_bytes_equal(f, n - piece->size, piece, 0, piece->size) &&
            is_kept(t, path, f, n - piece->size))
            return true;
    }
    return false;
}

/* ---- rounds ---- */

struct round {
    const struct bench *bench;
    const struct tree *damaged;
    struct outcome whole; /* of an uninterrupted repair */
    uint64_t kept
        [NAMES_LIMIT]; /* how many bytes of each file it keeps, without an end that a crash tore off */
};

/* The length of a file without half a record at its end, which a crash may have torn off. */
static uint64_t whole_bytes(const struct tree_file *f)
{
    char bytes[FILE_LIMIT] = {0};
    struct record record;
    ptrdiff_t n = 1;
    size_t at = SEGMENT_HEADER, size = (size_t)f->size;
    CHECK(size <= FILE_LIMIT);
    memcpy(bytes, f->bytes, f->n);
    while (at < size && (n = record_read(bytes + at, size - at, &record)) > 0)
        at += (size_t)n;
    return n == 0 ? at : size;
}

static void note_kept(struct round *r, const struct tree *after)
{
    for (size_t i = 0; i < r->damaged->names; i++) {
        const struct tree_name *name = &r->damaged->name[i];
        const struct tree_file *f = &r->damaged->file[name->file];
        CHECK(i < NAMES_LIMIT);
        for (r->kept[i] = is_ours(name->path) ? whole_bytes(f) : 0;
             !is_kept(after, name->path, f, r->kept[i]);)
            r->kept[i]--;
    }
}

/* The first file that lacks something; NULL: none. */
static const char *find_lost(const struct round *r, const struct tree *after)
{
    for (size_t i = 0; i < r->damaged->names; i++) {
        const struct tree_name *name = &r->damaged->name[i];
        if (is_ours(name->path) &&
            !is_kept(after, name->path, &r->damaged->file[name->file], r->kept[i]))
            return name->path;
    }
    return NULL;
}

__attribute__((format(printf, 3, 4), noreturn)) static void
fail(const struct round *r, const struct random_fate *fate, const char *format, ...)
{
    char what[300];
    va_list ap;
    va_start(ap, format);
    vsnprintf(what, sizeof what, format, ap);
    va_end(ap);
    tree_write(r->damaged, r->bench->root);
    test_fail(__FILE__, __LINE__, "%s; lost: %s; %s has the damage", what, fate->recipe,
              r->bench->dir);
}

static void check_kept(const struct round *r, const struct tree *t, const struct random_fate *fate,
                       const char *when)
{
    const char *lost = find_lost(r, t);
    if (lost != NULL)
        fail(r, fate, "%s %s is neither there nor in damaged.*", when, lost);
}

/* Cuts the power during the repair of t; t becomes what is left. */
static void interrupt(const struct round *r, struct tree *t, unsigned sync_fails)
{
    struct random_fate fate;
    const struct bench *b = r->bench;
    struct power_disk disk = {
        .root = b->root, .ops = b->ops, .seed = test_random(), .sync_fails = sync_fails};
    tree_write(t, b->root);
    repair(b, &disk);
    struct power_log log = power_log_read(b->ops);
    struct power_cut *crash = power_cut_new(t, &log);
    random_fate_init(&fate, test_random(), crash, &log);
    struct tree left = power_cut_state(crash, test_below((uint32_t)log.n + 1), &fate.fate);
    check_kept(r, &left, &fate, "after a power cut");
    tree_write(&left, b->root);
    int status = repair(b, NULL);
    struct outcome o = look(b);
    struct tree after = tree_read(b->root);
    check_kept(r, &after, &fate, "after another repair");
    if (status != 0 || o.digest != r->whole.digest || o.last != r->whole.last)
        fail(r, &fate, "another repair (status %d) keeps other changes", status);
    tree_free(&after);
    tree_free(t);
    *t = left;
    power_cut_free(crash);
    power_log_free(&log);
}

/* Whether there was something to repair. */
static bool run_round(const struct bench *b, const struct tree *sample)
{
    enum { CHAIN = 4 };
    struct tree damaged = copy(sample);
    for (unsigned i = 0, n = 1 + test_below(2); i < n; i++)
        damage(&damaged);
    struct round r = {.bench = b, .damaged = &damaged};
    tree_write(&damaged, b->root);
    bool ok = repair(b, NULL) == 0;
    if (ok) {
        struct tree whole = tree_read(b->root), t = copy(&damaged);
        r.whole = look(b);
        note_kept(&r, &whole);
        for (int i = 0; i < CHAIN; i++)
            interrupt(&r, &t, test_below(4) == 0 ? 200 : 0);
        tree_free(&whole);
        tree_free(&t);
    }
    tree_free(&damaged);
    return ok;
}

TEST_TIMEOUT(power_cut_during_a_repair_loses_nothing, 300)
{
    const char *text = getenv("POWER_LIVES");
    unsigned usual = test_is_sanitized() ? ROUNDS / 4 : ROUNDS;
    unsigned n = text == NULL ? usual : ROUNDS * (unsigned)strtoul(text, NULL, 10), repaired = 0;
    struct bench b = bench_new();
    struct tree sample[SAMPLE_KINDS];
    for (int i = 0; i < SAMPLE_KINDS; i++)
        sample[i] = make_sample(&b, (enum sample_kind)i);
    for (unsigned tries = 0; repaired < n; tries++) {
        CHECK(tries < 4 * n);
        repaired += run_round(&b, &sample[test_below(SAMPLE_KINDS)]);
    }
    for (int i = 0; i < SAMPLE_KINDS; i++)
        tree_free(&sample[i]);
    tree_remove(b.dir);
}
