/* mixup_test.c - data directories damaged at random, in several places at once: what is read from
 * them, before or after a repair, is an earlier state, never anything else.
 *
 * A few fixed cases; MIX_ROUNDS=100000 tries that many others. */
#include "server/disk/recover.h"
#include "server/disk/segment_reader.h"
#include "server/repair/repair.h"
#include "tests/server/digest.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

enum { FILES = 8, SIZE_LIMIT = 4096, CHANGES = 80, SETS = 4 };

static const char *const names[SETS] = {"a", "b", "t", "u"};

struct file {
    char name[64];
    char bytes[2 * SIZE_LIMIT];
    size_t n;
};

struct sample {
    struct directory dir;
    struct file file[FILES];
    unsigned n;
    uint64_t first, last;
    uint64_t set[CHANGES][SETS]; /* digests after the change with that lsn */
};

static uint64_t state = 1;

static uint32_t below(uint32_t n)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((state >> 32) * n >> 32);
}

static void note(struct sample *s, const struct registry *sets, uint64_t lsn)
{
    CHECK(lsn < CHANGES);
    for (unsigned i = 0; i < SETS; i++) {
        struct word w = {names[i], strlen(names[i])};
        const struct dataset *set = registry_find(sets, &w);
        s->set[lsn][i] = set == NULL ? 0 : digest_set(set);
    }
    s->last = lsn;
}

static unsigned place(void)
{
    return below(4);
}

static void change(char *to, size_t size)
{
    const char *set = names[below(SETS)];
    unsigned kind = below(12), id = below(5);
    if (kind < 6)
        snprintf(to, size, "ADD %s %u %u  %u %u\n", set, place(), place(), place(), place());
    else if (kind < 8)
        snprintf(to, size, "DEL %s %u\n", set, id);
    else if (kind < 10)
        snprintf(to, size, "MOVE %s %u %u %u\n", set, id, place(), place());
    else if (kind < 11)
        snprintf(to, size, "TRIANGULATE %s\n", set);
    else
        snprintf(to, size, "DROP %s\nCREATE %s TOL 1\n", set, set);
}

/* Reads it as recovery does, with a note after every change. */
static void note_history(struct sample *s)
{
    struct datadir dir;
    struct datafiles files;
    struct replay p;
    struct record r;
    struct segment header;
    struct segment_reader in;
    replay_init(&p);
    CHECK(datadir_open(&dir, s->dir.path, false) && datadir_list(&dir, &files));
    for (size_t i = 0; i < files.n; i++) {
        CHECK(reader_open(&in, &dir, &files.v[i], &header) == READER_OK);
        while (reader_next(&in, &r) == READER_OK) {
            bool snapshot = files.v[i].kind == DATAFILE_SNAPSHOT;
            const char *fault = snapshot ? replay_snapshot(&p, &r) : replay_log(&p, &r);
            CHECK_MSG(fault == NULL, "%s", fault);
            if (!snapshot)
                note(s, &p.sets, r.lsn);
        }
        if (files.v[i].kind == DATAFILE_SNAPSHOT) {
            p.snapshot = s->first = files.v[i].lsn;
            note(s, &p.sets, p.snapshot);
        }
        reader_close(&in);
    }
    datafiles_free(&files);
    datadir_close(&dir);
    replay_clear(&p);
}

static void make_sample(struct sample *s, bool snapshot)
{
    char line[128], path[128];
    *s = (struct sample){.dir = directory_quick()};
    for (unsigned life = 0; life < 4; life++) {
        struct daemon d = directory_daemon(&s->dir, NULL);
        int fd = daemon_connect(&d);
        for (unsigned i = 0; i < 14; i++) {
            change(line, sizeof line);
            say(fd, line);
            hear_line(fd);
            if (strchr(line, '\n')[1] != '\0')
                hear_line(fd);
        }
        close(fd);
        if (life == 1 && snapshot) {
            carry_out(&d, "SNAPSHOT\n");
            await_info(&d, "snapshots", 1);
        }
        daemon_stop(&d, below(3) == 0 ? SIGTERM : SIGKILL);
    }
    static const char *const prefix[] = {"snapshot.", "log."};
    for (unsigned k = 0; k < 2; k++)
        for (unsigned i = 0; directory_file(&s->dir, prefix[k], i, path); i++) {
            struct file *f = &s->file[s->n++];
            char *bytes = file_read(path, &f->n);
            CHECK(f->n < SIZE_LIMIT && s->n < FILES);
            memcpy(f->bytes, bytes, f->n);
            snprintf(f->name, sizeof f->name, "%.60s", strrchr(path, '/') + 1);
            free(bytes);
        }
    note_history(s);
}

/* Describes the damage, for the message of a test that fails. */
static char said[600];

static void damage(struct file *f, unsigned n)
{
    struct file *x = &f[below(n)], *y = &f[below(n)], z;
    size_t at = x->n == 0 ? 0 : below((uint32_t)x->n), m;
    unsigned op = below(9);
    snprintf(said + strlen(said), sizeof said - strlen(said), "op %u on %.60s at %zu, %.60s; ", op,
             x->name, at, y->name);
    switch (op) {
    case 0:
    case 1:
        if (x->n > 0)
            x->bytes[at] ^= (char)(1 << below(8));
        break;
    case 2:
        x->n = at;
        break;
    case 3:
        x->name[0] = '\0'; /* gone */
        break;
    case 4:
        z = *x;
        memcpy(x->bytes, y->bytes, x->n = y->n);
        memcpy(y->bytes, z.bytes, y->n = z.n);
        break;
    case 5:
        memcpy(x->bytes, y->bytes, x->n = y->n);
        break;
    case 6: /* a hole */
        m = x->n - at < 64 ? x->n - at : 64;
        memset(x->bytes + at, 0, m);
        break;
    case 7: /* another one's end behind it */
        if (x->n < SIZE_LIMIT && y->n > SEGMENT_HEADER) {
            m = SEGMENT_HEADER + below((uint32_t)y->n - SEGMENT_HEADER);
            m = y->n - m < SIZE_LIMIT / 2 ? m : y->n - SIZE_LIMIT / 2;
            memmove(x->bytes + x->n, y->bytes + m, y->n - m);
            x->n += y->n - m;
            if (x->n > SIZE_LIMIT)
                x->n = SIZE_LIMIT;
        }
        break;
    default: /* a wrong number in its name */
        m = strlen(x->name);
        if (m > 0)
            x->name[m - 1] = "0123456789abcdef"[below(16)];
    }
}

/* Neither the name nor the header of a snapshot describes its content. */
static bool is_hopeless(const struct sample *s, const struct file *f)
{
    bool hopeless = false;
    for (unsigned i = 0; i < s->n; i++)
        hopeless |= f[i].name[0] == 's' && strcmp(f[i].name, s->file[i].name) != 0 &&
                    memcmp(f[i].bytes, s->file[i].bytes, SEGMENT_HEADER) != 0;
    return hopeless;
}

static void lay_out(const struct sample *s, const struct file *f)
{
    char path[200];
    while (directory_file(&s->dir, "", 0, path))
        CHECK(unlink(path) == 0);
    for (unsigned i = 0; i < s->n; i++) {
        if (f[i].name[0] == '\0')
            continue;
        snprintf(path, sizeof path, "%s/%s", s->dir.path, f[i].name);
        file_write(path, f[i].bytes, f[i].n);
    }
}

/* Checks each recovered set against its digest at the recovered lsn. With `all` no set may be missing;
 * without it, sets may be lost. */
static enum recovery_result look(const struct sample *s, bool all, unsigned round)
{
    struct datadir dir;
    struct recovery r;
    CHECK(datadir_open(&dir, s->dir.path, false));
    recovery_init(&r, &dir);
    recovery_run(&r);
    enum recovery_result result = r.result;
    CHECK_MSG(result == RECOVERY_OK || r.why[0] != '\0', "round %u", round);
    CHECK(result != RECOVERY_ERROR);
    for (unsigned i = 0; result == RECOVERY_OK && i < SETS; i++) {
        struct word w = {names[i], strlen(names[i])};
        const struct dataset *set = registry_find(&r.replay.sets, &w);
        uint64_t is = set == NULL ? 0 : digest_set(set);
        bool known = r.last <= s->last && (r.last >= s->first || r.last == 0);
        CHECK_MSG(known || is == 0,
                  "round %u: %s, change %" PRIu64 " is unknown of %" PRIu64 " to %" PRIu64
                  ", all %d: %s",
                  round, names[i], r.last, s->first, s->last, all, said);
        CHECK_MSG(!known || is == (r.last == 0 ? 0 : s->set[r.last][i]) || (is == 0 && !all),
                  "round %u: %s is wrong after %" PRIu64 " of %" PRIu64 " to %" PRIu64
                  ", all %d: %s",
                  round, names[i], r.last, s->first, s->last, all, said);
    }
    recovery_clear(&r);
    datadir_close(&dir);
    return result;
}

static void quietly_repair(const char *path)
{
    fflush(stdout);
    int was = dup(STDOUT_FILENO), null = open("/dev/null", O_WRONLY);
    CHECK(was >= 0 && null >= 0 && dup2(null, STDOUT_FILENO) >= 0);
    repair_run(path);
    fflush(stdout);
    dup2(was, STDOUT_FILENO);
    close(was);
    close(null);
}

TEST_TIMEOUT(directory_mixed_up_at_random_never_has_wrong_data, 6000)
{
    static struct sample s;
    static struct file f[FILES];
    const char *text = getenv("MIX_ROUNDS");
    unsigned rounds = text == NULL ? 150 : (unsigned)atoi(text), good = 0, repaired = 0;
    if (text != NULL)
        state = test_random();
    for (unsigned i = 0; i < rounds; i++) {
        if (i % 75 == 0) {
            if (i > 0)
                directory_remove(&s.dir);
            make_sample(&s, i / 75 % 2 == 0);
        }
        memcpy(f, s.file, sizeof f);
        said[0] = 0;
        for (unsigned n = 1 + below(3); n > 0; n--)
            damage(f, s.n);
        if (is_hopeless(&s, f))
            continue;
        lay_out(&s, f);
        if (look(&s, true, i) == RECOVERY_OK) {
            good++;
            continue;
        }
        quietly_repair(s.dir.path);
        repaired += look(&s, false, i) == RECOVERY_OK;
    }
    if (text != NULL)
        printf("%u rounds: %u were good, %u could be repaired\n", rounds, good, repaired);
    CHECK(good > 0 && repaired > good);
    directory_remove(&s.dir);
}
