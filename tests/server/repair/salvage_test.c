/* salvage_test.c - --repair of a damaged snapshot: intact sets are kept unchanged, lost ones are
 * named, and no data is ever wrong, whichever byte is damaged and wherever the repair is
 * interrupted. */
#include "server/disk/recover.h"
#include "server/repair/salvage.h"
#include "tests/server/digest.h"
#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* Before the snapshot, and after it. `e` and `f` are empty in it; `new` is only in the log. */
static const char before[] = "CREATE a TOL 0.5\nADD a 0 0  0.25 0  4 0  4 0.25  0 4\nDEL a 0\n"
                             "CREATE e TOL 0.25\nADD t 1 1  0 0  4 0  4 4\nTRIANGULATE t\n"
                             "CREATE f\nADD gone 5 5\n";
static const char after[] = "ADD a 9 9\nADD e 5 5  5.1 5\nDEL t 3\nDROP gone\nADD new 1 2  3 4\n"
                            "MOVE t 0 1 2\nTRIANGULATE new\nCREATE later TOL 2\n";

static const char *const names[] = {"a", "e", "f", "t", "new", "later", "gone"};

enum { SETS = sizeof names / sizeof names[0], FILE_LIMIT = 4096 };

/* ---- what a directory holds ---- */

/* 0 if there is no such set. */
static uint64_t digest(const struct registry *sets, const char *name)
{
    struct word w = {name, strlen(name)};
    const struct dataset *set = registry_find(sets, &w);
    return set == NULL ? 0 : digest_set(set);
}

struct state {
    enum recovery_result result;
    uint64_t last, set[SETS];
    size_t sets;
};

static struct state look(const char *path)
{
    struct datadir dir;
    struct recovery r;
    CHECK(datadir_open(&dir, path, false));
    recovery_init(&r, &dir);
    recovery_run(&r);
    struct state s = {.result = r.result, .last = r.last, .sets = r.replay.sets.sets};
    for (size_t i = 0; i < SETS && r.result == RECOVERY_OK; i++)
        s.set[i] = digest(&r.replay.sets, names[i]);
    recovery_clear(&r);
    datadir_close(&dir);
    return s;
}

/* ---- a directory with a snapshot, which can be copied any number of times ---- */

struct sample {
    struct directory dir;
    char snapshot[128], log[128]; /* paths */
    char *bytes, *log_bytes, *first_log;
    size_t n, log_n, first_n;
    struct state whole;
};

static void forget(const struct sample *s)
{
    DIR *d = opendir(s->dir.path);
    CHECK(d != NULL);
    for (struct dirent *e; (e = readdir(d)) != NULL;)
        if (e->d_name[0] != '.')
            CHECK(unlinkat(dirfd(d), e->d_name, 0) == 0);
    closedir(d);
}

static struct sample make_sample(void)
{
    char path[128];
    struct sample s = {.dir = directory_quick()};
    struct daemon d = directory_daemon(&s.dir, NULL);
    carry_out(&d, before);
    CHECK(directory_file(&s.dir, "log.", 0, path));
    s.first_log = file_read(path, &s.first_n);
    carry_out(&d, "SNAPSHOT\n");
    await_info(&d, "snapshots", 1);
    carry_out(&d, after);
    daemon_stop(&d, SIGKILL);
    CHECK(directory_file(&s.dir, "snapshot.", 0, s.snapshot));
    CHECK(directory_file(&s.dir, "log.", 0, s.log) && !directory_file(&s.dir, "log.", 1, path));
    s.bytes = file_read(s.snapshot, &s.n);
    s.log_bytes = file_read(s.log, &s.log_n);
    s.whole = look(s.dir.path);
    CHECK(s.whole.result == RECOVERY_OK && s.whole.sets == SETS - 1 && s.n < FILE_LIMIT);
    return s;
}

/* The directory with a snapshot of these bytes. */
static void lay_out(const struct sample *s, const char *bytes, size_t n)
{
    forget(s);
    file_write(s->snapshot, bytes, n);
    file_write(s->log, s->log_bytes, s->log_n);
}

static void free_sample(struct sample *s)
{
    free(s->bytes);
    free(s->log_bytes);
    free(s->first_log);
    directory_remove(&s->dir);
}

/* ---- repairs ---- */

static bool is_named(const char *text, const char *name)
{
    char line[100];
    snprintf(line, sizeof line, "lost: the set %s", name);
    const char *at = strstr(text, line);
    return at != NULL && strchr("\n ,", at[strlen(line)]) != NULL;
}

/* Existing sets are correct; missing ones are named or counted. Returns how many. */
static unsigned check_kept(const struct sample *s, const char *text, const char *what, size_t at)
{
    struct state is = look(s->dir.path);
    unsigned lost = 0, nameless = 0, counted;
    const char *count = strstr(text, " sets whose names cannot be read");
    CHECK_MSG(is.result == RECOVERY_OK && is.last == s->whole.last, "%s %zu: %s", what, at, text);
    for (size_t i = 0; i < SETS; i++) {
        bool gone = is.set[i] != s->whole.set[i], named = is_named(text, names[i]);
        CHECK_MSG(!gone || is.set[i] == 0, "%s %zu: %s is wrong: %s", what, at, names[i], text);
        CHECK_MSG(gone || !named, "%s %zu: %s is there: %s", what, at, names[i], text);
        lost += gone;
        nameless += gone && !named;
    }
    CHECK_MSG(nameless == 0 || strstr(text, "names cannot be read") != NULL, "%s %zu: %s", what, at,
              text);
    while (count != NULL && count > text && count[-1] != ' ')
        count--;
    CHECK_MSG(count == NULL || (sscanf(count, "%u", &counted) == 1 && counted >= nameless),
              "%s %zu: %s", what, at, text);
    return lost;
}

/* ---- tests ---- */

TEST_TIMEOUT(repair_of_a_snapshot_with_any_byte_flipped_keeps_the_other_sets, 120)
{
    char text[FILE_LIMIT];
    struct sample s = make_sample();
    unsigned bit = test_below(8), most = 0;
    for (size_t i = 0; i < s.n; i++, bit = (bit + 1) % 8) {
        s.bytes[i] ^= (char)(1 << bit);
        lay_out(&s, s.bytes, s.n);
        s.bytes[i] ^= (char)(1 << bit);
        CHECK_MSG(directory_repair(&s.dir, text, sizeof text) == 0, "byte %zu: %s", i, text);
        unsigned lost = check_kept(&s, text, "byte", i);
        /* One name of a set of the snapshot, and possibly a second name that the damaged bytes spell. */
        CHECK_MSG(lost <= 2, "byte %zu: %u sets lost: %s", i, lost, text);
        CHECK_MSG(i >= SEGMENT_HEADER || lost == 0, "byte %zu: %s", i, text);
        CHECK_MSG(i < s.n - RECORD_HEADER || lost == 0, "byte %zu: %s", i, text);
        most = lost > most ? lost : most;
    }
    CHECK(most > 0);
    free_sample(&s);
}

TEST_TIMEOUT(repair_of_a_snapshot_cut_anywhere_keeps_what_is_before, 120)
{
    char text[FILE_LIMIT];
    struct sample s = make_sample();
    unsigned before_that = SETS;
    for (size_t n = 0; n < s.n; n += 3) {
        lay_out(&s, s.bytes, n);
        CHECK_MSG(directory_repair(&s.dir, text, sizeof text) == 0, "cut at %zu: %s", n, text);
        unsigned lost = check_kept(&s, text, "cut at", n);
        CHECK_MSG(lost <= before_that, "cut at %zu: %s", n, text);
        before_that = lost;
    }
    free_sample(&s);
}

/* Returns the offset of the snapshot's record of that set. */
static size_t record_of(const struct sample *s, const char *name)
{
    struct record r;
    size_t at = SEGMENT_HEADER;
    for (ptrdiff_t n; (n = record_read(s->bytes + at, s->n - at, &r)) > 0; at += (size_t)n)
        if (r.type == RECORD_SET && r.name_len == strlen(name) &&
            memcmp(r.name, name, r.name_len) == 0)
            return at;
    test_fail(__FILE__, __LINE__, "no set %s", name);
}

TEST(repair_names_what_is_lost_and_keeps_the_damaged_files)
{
    char text[FILE_LIMIT], path[128], name[64];
    size_t n;
    struct sample s = make_sample();
    /* A byte in the last row of the set a, whose record follows its RECORD_SET. */
    size_t at = record_of(&s, "a") + RECORD_HEADER + 1 + RECORD_HEADER + 40;
    s.bytes[at] ^= 4;
    lay_out(&s, s.bytes, s.n);
    CHECK(directory_run(&s.dir, "--data", text, sizeof text) == 1);
    CHECK_MSG(strstr(text, "--repair DIR would keep every intact set") != NULL, "%s", text);
    CHECK(directory_run(&s.dir, "--repair", text, sizeof text) == 0);
    CHECK_MSG(strstr(text, "\nlost: the set a of 4 points, 1 later changes to it\n") != NULL &&
                  strstr(text, "\n5 sets, 7 points, ") != NULL && strstr(text, "\ngood\n") != NULL,
              "%s", text);
    snprintf(name, sizeof name, "damaged.%s", strrchr(s.snapshot, '/') + 1);
    CHECK(directory_file(&s.dir, name, 0, path));
    char *kept = file_read(path, &n);
    CHECK(n == s.n && memcmp(kept, s.bytes, n) == 0);
    CHECK(directory_file(&s.dir, "damaged.log.", 0, path));
    struct daemon d = directory_daemon(&s.dir, NULL);
    converse(&d, "SETS\nPOINTS e\nSTAT a\n",
             "OK 5\ne points=2 triangulated=no\nf points=0 triangulated=no\n"
             "later points=0 triangulated=no\nnew points=2 triangulated=yes\n"
             "t points=3 triangulated=yes\nOK 2\n0 5 5\n1 5.1 5\nERR NOSET there is no set a\n");
    carry_out(&d, "ADD a 1 1\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    d = directory_daemon(&s.dir, NULL);
    converse(&d, "POINTS a\n", "OK 1\n0 1 1\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    free(kept);
    free_sample(&s);
}

TEST(repair_keeps_the_changes_behind_a_log_that_is_damaged_at_its_start)
{
    char text[FILE_LIMIT], path[128];
    size_t n;
    struct sample s = make_sample();
    s.bytes[s.n / 2] ^= 4;
    s.log_bytes[SEGMENT_HEADER + RECORD_HEADER + 1] ^= 4;
    lay_out(&s, s.bytes, s.n);
    CHECK(directory_run(&s.dir, "--repair", text, sizeof text) == 0);
    CHECK(directory_file(&s.dir, "damaged.log.", 0, path));
    char *kept = file_read(path, &n);
    CHECK_MSG(n == s.log_n && memcmp(kept, s.log_bytes, n) == 0, "%s", text);
    free(kept);
    free_sample(&s);
}

TEST(repair_of_a_snapshot_passes_a_damaged_header_of_the_log)
{
    char text[FILE_LIMIT];
    struct sample s = make_sample();
    size_t at = record_of(&s, "a") + RECORD_HEADER + 1 + RECORD_HEADER + 40;
    s.bytes[at] ^= 4;
    s.log_bytes[3] ^= 4;
    lay_out(&s, s.bytes, s.n);
    CHECK_MSG(directory_repair(&s.dir, text, sizeof text) == 0, "%s", text);
    CHECK(check_kept(&s, text, "byte", at) == 1);
    free_sample(&s);
}

TEST(repair_of_a_snapshot_believes_its_header_more_than_its_name)
{
    char text[FILE_LIMIT], path[128];
    struct sample s = make_sample();
    lay_out(&s, s.bytes, s.n);
    snprintf(path, sizeof path, "%s/snapshot.%016x", s.dir.path, 12); /* not 8 */
    CHECK(rename(s.snapshot, path) == 0);
    CHECK_MSG(directory_repair(&s.dir, text, sizeof text) == 0, "%s", text);
    CHECK(check_kept(&s, text, "name", 12) == 0);
    free_sample(&s);
}

/* The one record that names the set t, and the one that counts the sets. */
TEST(repair_of_a_snapshot_counts_on_no_end_that_is_damaged_as_well)
{
    char text[FILE_LIMIT];
    struct sample s = make_sample();
    size_t at = record_of(&s, "t");
    memset(s.bytes + at, 0, RECORD_HEADER + 1);
    s.bytes[s.n - RECORD_HEADER + 8] ^= 1;
    lay_out(&s, s.bytes, s.n);
    CHECK_MSG(directory_repair(&s.dir, text, sizeof text) == 0, "%s", text);
    CHECK(check_kept(&s, text, "byte", at) > 0);
    free_sample(&s);
}

/* A log that was closed without a change is as long as a snapshot's end, and says nothing as
 * well. */
TEST(repair_takes_a_log_in_place_of_a_snapshot_for_no_empty_snapshot)
{
    char text[FILE_LIMIT];
    struct sample s = make_sample();
    struct segment log = {.version = RECORD_VERSION, .kind = SEGMENT_LOG, .lsn = 9};
    struct record close = {.lsn = 9, .synced = 8, .type = RECORD_CLOSE};
    struct buf b = {0};
    segment_write(buf_reserve(&b, SEGMENT_HEADER), &log);
    buf_commit(&b, SEGMENT_HEADER);
    record_write(&b, &close);
    lay_out(&s, buf_head(&b), buf_len(&b));
    CHECK_MSG(directory_repair(&s.dir, text, sizeof text) == 0, "%s", text);
    CHECK(check_kept(&s, text, "all", 0) > 0);
    buf_free(&b);
    free_sample(&s);
}

TEST(record_that_is_refused_changes_nothing)
{
    const double xy[] = {1, 1, 2, 2};
    struct replay p;
    struct buf b = {0};
    struct record r = {.lsn = 1, .type = RECORD_ADD, .first = 14, .n = 2, .items = xy};
    r.name = "t";
    r.name_len = 1;
    record_write(&b, &r);
    replay_init(&p);
    CHECK(record_read(buf_head(&b), buf_len(&b), &r) > 0 && replay_log(&p, &r) != NULL);
    CHECK(p.sets.sets == 0 && !p.out_of_memory);
    r.first = 0;
    CHECK(replay_log(&p, &r) == NULL && p.sets.sets == 1);
    r.lsn = 2; /* again, with ids that are taken */
    CHECK(replay_log(&p, &r) != NULL);
    struct word name = {"t", 1};
    const struct dataset *set = registry_find(&p.sets, &name);
    CHECK(set->current->lsn == 1 && dt_next_id(set->current->dt) == 2);
    replay_clear(&p);
    buf_free(&b);
}

/* ---- files older than the snapshot still exist ---- */

static struct sample make_dispensable(void)
{
    char path[128];
    struct sample s = make_sample();
    s.bytes[s.n / 2] ^= 1;
    lay_out(&s, s.bytes, s.n);
    snprintf(path, sizeof path, "%s/log.%016x", s.dir.path, 1);
    file_write(path, s.first_log, s.first_n);
    calls_watch(s.dir.path);
    return s;
}

TEST(repair_loses_nothing_where_the_log_from_the_beginning_is_there)
{
    char text[FILE_LIMIT], path[128];
    struct sample s = make_dispensable();
    CHECK(directory_repair(&s.dir, text, sizeof text) == 0);
    CHECK_MSG(strstr(text, "nothing is lost") != NULL, "%s", text);
    CHECK(check_kept(&s, text, "log", 1) == 0);
    CHECK(directory_file(&s.dir, "damaged.snapshot.", 0, path));
    free_sample(&s);
}

/* A second sync of the same name might report a success that is not one. */
TEST(repair_that_could_not_put_a_snapshot_aside_loses_no_set_and_begins_again)
{
    char text[FILE_LIMIT];
    struct sample s = make_dispensable();
    calls_fail("sync .", 1, 1, EIO);
    CHECK(directory_repair(&s.dir, text, sizeof text) == 1);
    CHECK_MSG(test_names_error(text, "cannot put the damaged snapshot aside", EIO), "%s", text);
    CHECK(directory_repair(&s.dir, text, sizeof text) == 0);
    CHECK_MSG(calls_end("remove damaged.snapshot.8\nlink snapshot.8 damaged.snapshot.8\nsync .\n"
                        "remove snapshot.8\nsync .\n"),
              "%s", calls_text());
    CHECK(check_kept(&s, text, "log", 1) == 0);
    free_sample(&s);
}

TEST(repair_leaves_a_snapshot_of_a_later_version_alone)
{
    char text[FILE_LIMIT], bytes[SEGMENT_HEADER];
    size_t n;
    struct sample s = make_sample();
    struct segment later = {.version = RECORD_VERSION + 1, .kind = SEGMENT_SNAPSHOT, .lsn = 8};
    segment_write(bytes, &later);
    memcpy(s.bytes, bytes, sizeof bytes);
    lay_out(&s, s.bytes, s.n);
    CHECK(directory_repair(&s.dir, text, sizeof text) == 1);
    CHECK_MSG(strstr(text, "later version") != NULL, "%s", text);
    char *kept = file_read(s.snapshot, &n);
    CHECK(n == s.n && memcmp(kept, s.bytes, n) == 0);
    free(kept);
    free_sample(&s);
}

/* The repair itself is interrupted: a second one finds the directory unchanged or repaired. */
TEST_TIMEOUT(repair_that_fails_anywhere_can_be_repeated, 120)
{
    static const char *const op[] = {"write", "sync", "rename", "open"};
    char text[FILE_LIMIT];
    struct sample s = make_sample();
    unsigned fired = 0;
    size_t at = record_of(&s, "a") + RECORD_HEADER + 1 + RECORD_HEADER + 40;
    s.bytes[at] ^= 4;
    for (unsigned k = 0; k < 4; k++)
        for (unsigned i = 1; i < 50; i++) {
            lay_out(&s, s.bytes, s.n);
            if (!directory_repair_badly(&s.dir, op[k], i))
                break;
            fired++;
            directory_repair(&s.dir, text, sizeof text);
            struct state is = look(s.dir.path);
            CHECK_MSG(is.result == RECOVERY_OK && is.last == s.whole.last, "%s %u: %s", op[k], i,
                      text);
            for (size_t j = 0; j < SETS; j++)
                CHECK_MSG(is.set[j] == (strcmp(names[j], "a") == 0 ? 0 : s.whole.set[j]),
                          "%s %u: %s", op[k], i, names[j]);
        }
    CHECK_MSG(fired >= 8, "%u", fired);
    free_sample(&s);
}
