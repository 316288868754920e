/* repair_test.c - --repair of a log with damaged segment headers or missing segments: everything
 * before the damage is kept unchanged, the old files are in damaged.*, and no data is ever
 * wrong. */
#include "server/disk/recover.h"
#include "server/repair/repair.h"
#include "tests/server/digest.h"
#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* One run of a daemon each, so that each gets its own segment; one change per line. */
static const char *const lives[] = {
    "ADD t 0 0  4 0  4 4  0 4  2 2\nTRIANGULATE t\nCREATE a TOL 0.5\n",
    "ADD a 0 0  0.25 0\nDEL t 1\nADD gone 1 1\nDROP gone\n", "MOVE t 0 1 2\nADD new 7 7\n"};

enum { LIVES = sizeof lives / sizeof lives[0] };

struct sample {
    struct directory dir;
    unsigned before;       /* number of runs in a snapshot, whose log is deleted */
    unsigned n;            /* segments: one for each other life */
    char path[LIVES][128]; /* of the segments */
    char *bytes[LIVES];    /* own */
    size_t size[LIVES];
    uint64_t last[LIVES], digest[LIVES]; /* after each life */
};

struct outcome {
    enum recovery_result result;
    uint64_t last, digest;
    char why[512];
};

static struct outcome look(const struct sample *s)
{
    struct datadir dir;
    struct recovery r;
    CHECK(datadir_open(&dir, s->dir.path, false));
    recovery_init(&r, &dir);
    recovery_run(&r);
    struct outcome o = {.result = r.result, .last = r.last, .digest = digest_sets(&r.replay.sets)};
    memcpy(o.why, r.why, sizeof o.why);
    recovery_clear(&r);
    datadir_close(&dir);
    return o;
}

static struct sample make_sample(bool snapshot)
{
    struct sample s = {.dir = directory_quick(), .before = snapshot};
    for (unsigned i = 0; i < LIVES; i++) {
        struct daemon d = directory_daemon(&s.dir, NULL);
        carry_out(&d, lives[i]);
        if (i == 0 && snapshot) {
            carry_out(&d, "SNAPSHOT\n");
            await_info(&d, "snapshots", 1);
        }
        daemon_stop(&d, SIGKILL);
        struct outcome o = look(&s);
        CHECK_MSG(o.result == RECOVERY_OK, "%s", o.why);
        s.last[i] = o.last;
        s.digest[i] = o.digest;
    }
    for (; directory_file(&s.dir, "log.", s.n, s.path[s.n]); s.n++)
        s.bytes[s.n] = file_read(s.path[s.n], &s.size[s.n]);
    CHECK(s.n == LIVES - s.before);
    return s;
}

/* The directory as it was, as far as `bytes` still are; without one of the segments. */
static void lay_out(const struct sample *s, unsigned without)
{
    char path[128];
    while (directory_file(&s->dir, "damaged.", 0, path) || directory_file(&s->dir, "log.", 0, path))
        CHECK(unlink(path) == 0);
    for (unsigned i = 0; i < s->n; i++)
        if (i != without)
            file_write(s->path[i], s->bytes[i], s->size[i]);
}

static void free_sample(struct sample *s)
{
    for (unsigned i = 0; i < s->n; i++)
        free(s->bytes[i]);
    directory_remove(&s->dir);
}

/* Whether the state is that after this number of runs. */
static bool is_kept(const struct sample *s, unsigned life)
{
    struct outcome o = look(s);
    return o.result == RECOVERY_OK && o.last == (life == 0 ? 0 : s->last[life - 1]) &&
           o.digest == (life == 0 ? 0 : s->digest[life - 1]);
}

/* The daemon refuses the directory and suggests --repair; that keeps the given number of runs, and
 * then the daemon starts. */
static void check_repair(const struct sample *s, unsigned life)
{
    char text[4000];
    struct outcome o = look(s);
    CHECK_MSG(o.result == RECOVERY_REFUSED && strstr(o.why, "--repair") != NULL, "%s", o.why);
    CHECK_MSG(directory_run(&s->dir, "--repair", text, sizeof text) == 0, "%s", text);
    CHECK_MSG(is_kept(s, life), "%s", text);
    CHECK_MSG(strstr(text, "in damaged.*") != NULL || strstr(text, "as damaged.*") != NULL ||
                  strstr(text, "missing") != NULL,
              "%s", text);
    struct daemon d = directory_daemon(&s->dir, NULL);
    carry_out(&d, "ADD later 1 1\n");
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&s->dir, NULL);
    converse(&d, "GET later 0\n", "OK 1\n0 1 1\n");
    daemon_stop(&d, SIGKILL);
}

/* Whether some damaged.* is the segment as it was. */
static bool is_aside(const struct sample *s, unsigned segment)
{
    char path[128], name[64];
    size_t n;
    snprintf(name, sizeof name, "damaged.%s", strrchr(s->path[segment], '/') + 1);
    if (!directory_file(&s->dir, name, 0, path))
        return false;
    char *bytes = file_read(path, &n);
    bool same = n == s->size[segment] && memcmp(bytes, s->bytes[segment], n) == 0;
    free(bytes);
    return same;
}

/* ---- headers ---- */

TEST_TIMEOUT(repair_writes_a_damaged_header_again_whichever_byte_it_is, 60)
{
    char text[4000];
    struct sample s = make_sample(false);
    for (unsigned i = 0; i < SEGMENT_HEADER; i++) {
        unsigned segment = i % LIVES;
        char was = s.bytes[segment][i];
        s.bytes[segment][i] ^= (char)(1 << test_below(8));
        lay_out(&s, LIVES);
        struct outcome o = look(&s);
        CHECK_MSG(o.result == RECOVERY_REFUSED && strstr(o.why, "--repair") != NULL, "%s", o.why);
        CHECK(directory_run(&s.dir, "--repair", text, sizeof text) == 0);
        CHECK_MSG(is_kept(&s, LIVES) && strstr(text, "header was written again") != NULL,
                  "byte %u: %s", i, text);
        CHECK(is_aside(&s, segment));
        s.bytes[segment][i] = was;
    }
    free_sample(&s);
}

TEST(repair_writes_headers_again_and_cuts_the_log_where_a_record_is_damaged)
{
    struct sample s = make_sample(false);
    s.bytes[0][3] ^= 1;
    s.bytes[2][30] ^= 1;
    s.bytes[1][SEGMENT_HEADER + RECORD_HEADER + 1] ^= 1;
    lay_out(&s, LIVES);
    check_repair(&s, 1);
    CHECK(is_aside(&s, 0) && is_aside(&s, 2));
    free_sample(&s);
}

TEST(repair_keeps_what_is_before_a_segment_that_ends_within_its_header)
{
    struct sample s = make_sample(false);
    s.size[1] = 10;
    lay_out(&s, LIVES);
    check_repair(&s, 1);
    CHECK(is_aside(&s, 1) && is_aside(&s, 2));
    free_sample(&s);
}

/* Its own header is good, but it is another's. */
TEST(repair_keeps_what_is_before_a_segment_with_another_ones_records)
{
    struct sample s = make_sample(false);
    s.size[1] = s.size[2];
    memcpy(s.bytes[1], s.bytes[2], s.size[2]);
    lay_out(&s, LIVES);
    check_repair(&s, 1);
    free_sample(&s);
}

/* ---- missing segments ---- */

TEST(repair_keeps_what_is_before_a_segment_that_is_missing)
{
    for (int snapshot = 0; snapshot < 2; snapshot++) {
        struct sample s = make_sample(snapshot);
        for (unsigned i = 0; i + 1 < s.n; i++) {
            lay_out(&s, i);
            check_repair(&s, s.before + i);
            for (unsigned later = i + 1; later < s.n; later++)
                CHECK(is_aside(&s, later));
        }
        free_sample(&s);
    }
}

TEST(repair_keeps_a_snapshot_whose_log_is_missing)
{
    struct sample s = make_sample(true);
    s.n = 0;
    lay_out(&s, 0);
    check_repair(&s, 1);
    s.n = 2;
    free_sample(&s);
}

/* ---- records ---- */

/* Intact, but it deletes a point that was never added. */
TEST(repair_keeps_what_is_before_a_record_that_cannot_be)
{
    char text[4000];
    const uint32_t id = 5;
    struct sample s = make_sample(false);
    struct buf b = {0};
    struct record r = {.lsn = s.last[1] + 1, .synced = s.last[1], .type = RECORD_DELETE, .n = 1};
    r.items = &id;
    r.name = "nobody";
    r.name_len = 6;
    buf_append(&b, s.bytes[2], SEGMENT_HEADER);
    record_write(&b, &r);
    lay_out(&s, LIVES);
    file_write(s.path[2], buf_head(&b), buf_len(&b));
    CHECK(look(&s).result == RECOVERY_REFUSED);
    CHECK(directory_run(&s.dir, "--repair", text, sizeof text) == 0);
    CHECK_MSG(is_kept(&s, 2) && strstr(text, "cut off at byte 64") != NULL, "%s", text);
    buf_free(&b);
    free_sample(&s);
}

/* ---- an interrupted repair ---- */

/* A segment that ends within a record is damaged where others follow, and torn where none does. */
TEST(repair_that_breaks_off_keeps_the_damaged_record)
{
    char path[128], text[4000];
    struct sample s = make_sample(false);
    s.size[0] -= 10;
    lay_out(&s, LIVES);
    calls_watch(s.dir.path);
    calls_fail("create damaged.log.1", 1, 1, EIO);
    fflush(stdout);
    CHECK(repair_run(s.dir.path) == 1);
    CHECK(directory_run(&s.dir, "--repair", text, sizeof text) == 0);
    CHECK_MSG(directory_file(&s.dir, "damaged.log.0000000000000001", 0, path), "%s", text);
    CHECK(is_aside(&s, 1) && is_aside(&s, 2));
    free_sample(&s);
}

TEST_TIMEOUT(repair_of_a_log_that_fails_anywhere_can_be_repeated, 60)
{
    static const char *const op[] = {"write", "sync", "open"};
    char text[4000];
    unsigned fired = 0;
    struct sample s = make_sample(false);
    s.bytes[0][3] ^= 1;
    for (unsigned k = 0; k < 3; k++)
        for (unsigned i = 1; i < 50; i++) {
            lay_out(&s, 1); /* a bad header, and a gap behind it */
            if (!directory_repair_badly(&s.dir, op[k], i))
                break;
            fired++;
            directory_run(&s.dir, "--repair", text, sizeof text);
            CHECK_MSG(is_kept(&s, 1), "%s %u: %s", op[k], i, text);
        }
    CHECK_MSG(fired >= 8, "%u", fired);
    free_sample(&s);
}

/* ---- the order of its calls ---- */

/* A segment of changes that each say that those before were synced; a bit of its byte `flip` is
 * flipped, unless that is 0. */
static void write_segment(const struct directory *d, uint64_t first, uint64_t last, size_t flip)
{
    struct segment header = {.version = RECORD_VERSION, .kind = SEGMENT_LOG, .lsn = first};
    char path[128];
    struct buf b = {0};
    segment_write(buf_reserve(&b, SEGMENT_HEADER), &header);
    buf_commit(&b, SEGMENT_HEADER);
    for (uint64_t lsn = first; lsn <= last; lsn++) {
        struct record r = {.lsn = lsn, .synced = lsn - 1, .type = RECORD_CLOSE};
        record_write(&b, &r);
    }
    buf_head(&b)[flip] ^= flip > 0;
    snprintf(path, sizeof path, "%s/log.%016" PRIx64, d->path, first);
    file_write(path, buf_head(&b), buf_len(&b));
    buf_free(&b);
}

TEST(repair_of_a_log_has_a_copy_on_the_disk_before_anything_is_cut_off)
{
    struct directory d = directory_quick();
    write_segment(&d, 1, 3, SEGMENT_HEADER + RECORD_HEADER + 9);
    write_segment(&d, 4, 4, SEGMENT_HEADER + 3);
    calls_watch(d.path);
    CHECK(repair_run(d.path) == 0);
    CHECK_STR(calls_text(),
              "create damaged.log.1\nwrite damaged.log.1\nsync damaged.log.1\nsync .\n"
              "cut log.1\nsync log.1\n"
              "link log.4 damaged.log.4\nsync .\nremove log.4\nsync .\n");
    directory_remove(&d);
}

TEST(repair_of_a_header_has_a_copy_on_the_disk_before_it_is_made_again)
{
    struct directory d = directory_quick();
    write_segment(&d, 1, 3, 9);
    calls_watch(d.path);
    CHECK(repair_run(d.path) == 0);
    CHECK(strstr(calls_text(),
                 "create damaged.log.1\nwrite damaged.log.1\nsync damaged.log.1\nsync .\n"
                 "write log.1\nsync log.1\n") != NULL);
    CHECK(calls_end("write log.1\nsync log.1\n"));
    directory_remove(&d);
}

TEST(repair_that_puts_a_segment_aside_syncs_that_it_has_gone)
{
    struct directory d = directory_quick();
    write_segment(&d, 1, 2, 0);
    write_segment(&d, 5, 5, 0);
    calls_watch(d.path);
    CHECK(repair_run(d.path) == 0);
    CHECK(calls_end("remove log.5\nsync .\n"));
    directory_remove(&d);
}

TEST(repair_that_only_puts_segments_aside_needs_no_space)
{
    struct directory d = directory_quick();
    write_segment(&d, 1, 2, 0);
    write_segment(&d, 5, 5, 0);
    write_segment(&d, 6, 6, 0);
    calls_watch(d.path);
    calls_limit_space(0);
    CHECK(repair_run(d.path) == 0);
    CHECK_STR(calls_text(), "link log.5 damaged.log.5\nsync .\nremove log.5\n"
                            "link log.6 damaged.log.6\nsync .\nremove log.6\nsync .\n");
    directory_remove(&d);
}

/* ---- calls that fail ---- */

/* Repairs in this process while the n-th such call fails; what it prints goes to text. */
static void repair_while(const struct directory *d, const char *call, unsigned n, char *text,
                         size_t size)
{
    calls_watch(d->path);
    calls_fail(call, n, 1, EIO);
    CHECK(directory_repair(d, text, size) == 1 && calls_failed() == 1);
}

TEST(repair_stops_at_a_later_segment_that_cannot_be_put_aside)
{
    char text[4000];
    struct directory d = directory_quick();
    write_segment(&d, 1, 3, SEGMENT_HEADER + RECORD_HEADER + 9);
    write_segment(&d, 4, 4, 0);
    write_segment(&d, 5, 5, 0);
    repair_while(&d, "link log.4 damaged.log.4", 1, text, sizeof text);
    CHECK_MSG(test_names_error(text, "cannot put the damaged part aside", EIO) &&
                  strstr(text, "in damaged.*") == NULL,
              "%s", text);
    CHECK(calls_count("remove log.5") == 0);
    directory_remove(&d);
}

/* The repair first writes the bytes that it has read to the same file again. */
TEST(repair_leaves_a_header_of_which_there_is_no_copy)
{
    char text[4000];
    struct directory d = directory_quick();
    write_segment(&d, 1, 3, 9);
    repair_while(&d, "create damaged.log.1", 1, text, sizeof text);
    CHECK_MSG(test_names_error(text, "cannot repair the log", EIO), "%s", text);
    CHECK_STR(calls_text(), "write log.1\nsync log.1\n");
    directory_remove(&d);
}

TEST(repair_that_cannot_write_a_header_says_so)
{
    char text[4000];
    struct directory d = directory_quick();
    write_segment(&d, 1, 3, 9);
    repair_while(&d, "write log.1", 2, text, sizeof text);
    CHECK_MSG(test_names_error(text, "cannot repair the log", EIO) &&
                  strstr(text, "was written again") == NULL,
              "%s", text);
    directory_remove(&d);
}

TEST(repair_that_cannot_begin_a_log_says_so)
{
    char text[4000];
    struct sample s = make_sample(true);
    s.n = 0;
    lay_out(&s, 0);
    repair_while(&s.dir, "write snapshot.4.tmp", 1, text, sizeof text);
    CHECK_MSG(test_names_error(text, "cannot repair the log", EIO), "%s", text);
    s.n = 2;
    free_sample(&s);
}
