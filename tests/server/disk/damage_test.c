/* damage_test.c - data directories that were truncated, changed or mixed up: read correctly, or
 * refused with a reason; never wrong data. In one process, so that thousands of cases take no
 * time. */
#include "server/disk/recover.h"
#include "tests/server/digest.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* One change a line, so that each is synced before the next. */
static const char *const changes[] = {"CREATE a TOL 0.5",  "ADD a 0 0  0.25 0  4 0  4 0.25  0 4",
                                      "DEL a 0",           "ADD t 1 1",
                                      "ADD t 0 0 4 0 4 4", "TRIANGULATE t",
                                      "MOVE t 0 1 2",      "ADD gone 5 5",
                                      "DROP gone",         "DEL t 3"};

enum { CHANGES = sizeof changes / sizeof changes[0], LOG_LIMIT = 4096 };

/* ---- what a directory holds ---- */

struct outcome {
    enum recovery_result result;
    bool torn, lost;
    uint64_t last, digest;
    char why[512];
};

static struct outcome look(const char *path)
{
    struct outcome o = {0};
    struct datadir dir;
    struct recovery r;
    CHECK(datadir_open(&dir, path, false));
    recovery_init(&r, &dir);
    recovery_run(&r);
    o = (struct outcome){.result = r.result, .torn = r.torn, .lost = r.lost, .last = r.last};
    memcpy(o.why, r.why, sizeof o.why);
    if (r.result == RECOVERY_OK)
        o.digest = digest_sets(&r.replay.sets);
    recovery_clear(&r);
    datadir_close(&dir);
    return o;
}

/* ---- a log of some changes ---- */

struct sample {
    struct directory dir;
    char path[128]; /* of its one segment */
    char *bytes;    /* owns */
    size_t n;
    size_t end[CHANGES + 1];      /* of each record; end[0]: of the header */
    uint64_t digest[CHANGES + 1]; /* after so many changes */
};

static struct sample make_sample(int sig)
{
    struct sample s = {.dir = directory_new()};
    struct daemon d = directory_daemon(&s.dir, NULL);
    int fd = daemon_connect(&d);
    for (size_t i = 0; i < CHANGES; i++) {
        say(fd, changes[i]);
        say(fd, "\n");
        CHECK(strncmp(hear_line(fd), "OK", 2) == 0);
    }
    close(fd);
    daemon_stop(&d, sig);
    CHECK(directory_file(&s.dir, "log.", 0, s.path));
    s.bytes = file_read(s.path, &s.n);
    s.end[0] = SEGMENT_HEADER;
    for (size_t i = 0; i < CHANGES; i++) {
        struct record r;
        ptrdiff_t took = record_read(s.bytes + s.end[i], s.n - s.end[i], &r);
        CHECK(took > 0 && r.lsn == i + 1 && r.synced >= i);
        s.end[i + 1] = s.end[i] + (size_t)took;
    }
    for (size_t i = 0; i <= CHANGES; i++) {
        file_write(s.path, s.bytes, s.end[i]);
        struct outcome o = look(s.dir.path);
        CHECK_MSG(o.result == RECOVERY_OK && !o.torn && o.last == i, "%s", o.why);
        s.digest[i] = o.digest;
    }
    return s;
}

static void free_sample(struct sample *s)
{
    free(s->bytes);
    directory_remove(&s->dir);
}

/* ---- tests ---- */

TEST(log_cut_anywhere_is_a_torn_end)
{
    struct sample s = make_sample(SIGKILL);
    size_t whole = 0;
    for (size_t n = SEGMENT_HEADER; n < s.n; n++) {
        while (whole < CHANGES && s.end[whole + 1] <= n)
            whole++;
        file_write(s.path, s.bytes, n);
        struct outcome o = look(s.dir.path);
        CHECK_MSG(o.result == RECOVERY_OK && o.last == whole && o.digest == s.digest[whole],
                  "cut at %zu: %s", n, o.why);
        CHECK_MSG(o.torn == (n != s.end[whole]) && !o.lost, "cut at %zu", n);
    }
    free_sample(&s);
}

/* A segment gets its name when its header is durable. */
TEST(log_cut_within_its_header_is_refused)
{
    struct sample s = make_sample(SIGKILL);
    for (size_t n = 0; n < SEGMENT_HEADER; n++) {
        file_write(s.path, s.bytes, n);
        struct outcome o = look(s.dir.path);
        CHECK_MSG(o.result == RECOVERY_REFUSED && strstr(o.why, "--repair") != NULL,
                  "cut at %zu: %s", n, o.why);
    }
    free_sample(&s);
}

/* Every bit, or with a sanitizer one or two of each byte: only bytes that no record reports as synced may be treated as a torn end. */
static void flip_everything(int sig, uint64_t provable)
{
    struct sample s = make_sample(sig);
    for (size_t i = 0; i < 8 * s.n; i += test_is_sanitized() ? 7 : 1) {
        s.bytes[i / 8] ^= (char)(1 << i % 8);
        file_write(s.path, s.bytes, s.n);
        s.bytes[i / 8] ^= (char)(1 << i % 8);
        struct outcome o = look(s.dir.path);
        bool right = o.result == RECOVERY_OK && o.last >= provable && o.last <= CHANGES &&
                     o.digest == s.digest[o.last] && i / 8 >= s.end[o.last];
        bool refused =
            (o.result == RECOVERY_CORRUPT || o.result == RECOVERY_REFUSED) && o.why[0] != '\0';
        CHECK_MSG(right || refused, "bit %zu: %d, %" PRIu64 " changes: %s", i, (int)o.result,
                  o.last, o.why);
        CHECK_MSG(refused || o.lost, "bit %zu is lost without a word", i);
    }
    free_sample(&s);
}

TEST_TIMEOUT(log_flipped_anywhere_is_refused_but_for_its_last_change, 120)
{
    flip_everything(SIGKILL, CHANGES - 1);
}

TEST_TIMEOUT(log_of_a_good_stop_flipped_anywhere_loses_nothing, 120)
{
    flip_everything(SIGTERM, CHANGES);
}

TEST(log_followed_by_garbage_is_a_torn_end)
{
    struct sample s = make_sample(SIGKILL);
    for (int round = 0; round < 200; round++) {
        char bytes[LOG_LIMIT];
        size_t n = 1 + test_below(500);
        memcpy(bytes, s.bytes, s.n);
        for (size_t i = 0; i < n; i++)
            bytes[s.n + i] = round % 2 == 0 ? 0 : (char)test_random();
        file_write(s.path, bytes, s.n + n);
        struct outcome o = look(s.dir.path);
        CHECK(o.result == RECOVERY_OK && o.torn && o.digest == s.digest[CHANGES]);
    }
    free_sample(&s);
}

/* Pages of the last batch reach the disk in any order: a hole before a record that was written
 * with it, and that reports nothing later as synced, is not corruption. */
TEST(log_with_a_hole_in_its_last_batch_is_a_torn_end)
{
    struct sample s = make_sample(SIGKILL);
    struct record r;
    struct buf b = {0};
    record_read(s.bytes + s.end[CHANGES - 1], s.n - s.end[CHANGES - 1], &r);
    r.synced = CHANGES - 2; /* as if the last two had come together */
    record_write(&b, &r);
    memcpy(s.bytes + s.end[CHANGES - 1], buf_head(&b), buf_len(&b));
    s.bytes[s.end[CHANGES - 2] + 9] ^= 1;
    file_write(s.path, s.bytes, s.n);
    struct outcome o = look(s.dir.path);
    CHECK_MSG(o.result == RECOVERY_OK && o.torn && o.last == CHANGES - 2, "%s", o.why);
    CHECK(o.digest == s.digest[CHANGES - 2]);
    buf_free(&b);
    free_sample(&s);
}

/* A LOAD that takes several records, cut off right behind one of them. */
TEST(log_that_ends_between_the_records_of_a_load_is_a_torn_end)
{
    double xy[4] = {1, 1, 2, 2};
    struct sample s = make_sample(SIGKILL);
    struct buf b = {0};
    buf_append(&b, s.bytes, s.n);
    struct record r = {.lsn = CHANGES + 1, .synced = CHANGES, .type = RECORD_LOAD, .first = 4};
    r.name = "t";
    r.name_len = 1;
    record_write(&b, &r);
    for (int chunks = 0; chunks <= 2; chunks++) {
        file_write(s.path, buf_head(&b), buf_len(&b));
        struct outcome o = look(s.dir.path);
        CHECK_MSG(o.result == RECOVERY_OK && o.torn && o.last == CHANGES, "%s", o.why);
        CHECK(o.digest == s.digest[CHANGES]);
        r.lsn++;
        r = (struct record){.lsn = r.lsn, .type = RECORD_CHUNK, .n = 2, .items = xy};
        record_write(&b, &r);
    }
    buf_free(&b);
    free_sample(&s);
}

TEST(damaged_log_keeps_the_daemon_from_starting_until_it_is_repaired)
{
    char text[2000], path[128];
    struct sample s = make_sample(SIGKILL);
    s.bytes[s.end[4] + 60] ^= 1;
    file_write(s.path, s.bytes, s.n);
    CHECK(directory_run(&s.dir, "--data", text, sizeof text) == 1);
    CHECK_MSG(strstr(text, "is damaged") != NULL && strstr(text, "--repair") != NULL, "%s", text);
    CHECK(strstr(text, "all changes up to 4 ") != NULL);
    CHECK(directory_run(&s.dir, "--check", text, sizeof text) == 1 && strstr(text, "not good"));
    CHECK(directory_run(&s.dir, "--repair", text, sizeof text) == 0);
    CHECK_MSG(strstr(text, "4 changes\ngood\n") != NULL, "%s", text);
    CHECK(directory_file(&s.dir, "damaged.", 0, path));
    struct outcome o = look(s.dir.path);
    CHECK(o.result == RECOVERY_OK && o.digest == s.digest[4]);
    struct daemon d = directory_daemon(&s.dir, NULL);
    converse(&d, "POINTS t\n", "OK 1\n0 1 1\n");
    daemon_stop(&d, SIGTERM);
    free_sample(&s);
}

TEST(second_repair_leaves_alone_what_the_first_put_aside)
{
    char text[2000], path[128];
    size_t n, later;
    struct sample s = make_sample(SIGKILL);
    s.bytes[s.end[4] + 60] ^= 1;
    file_write(s.path, s.bytes, s.n);
    CHECK(directory_run(&s.dir, "--repair", text, sizeof text) == 0);
    CHECK(directory_file(&s.dir, "damaged.", 0, path));
    char *first = file_read(path, &n);
    s.bytes[s.end[2] + 60] ^= 1;
    file_write(s.path, s.bytes, s.n);
    CHECK_MSG(directory_run(&s.dir, "--repair", text, sizeof text) == 0, "%s", text);
    char *still = file_read(path, &later);
    CHECK(later == n && memcmp(still, first, n) == 0);
    CHECK(directory_file(&s.dir, "damaged.", 1, path));
    free(first);
    free(still);
    free_sample(&s);
}

TEST(log_of_a_later_version_is_refused_and_left_alone)
{
    char text[2000];
    struct directory dir = directory_new();
    struct segment later = {.version = RECORD_VERSION + 1, .kind = SEGMENT_LOG, .lsn = 1};
    char bytes[SEGMENT_HEADER], path[128];
    size_t n;
    segment_write(bytes, &later);
    snprintf(path, sizeof path, "%s/log.%016x", dir.path, 1);
    file_write(path, bytes, sizeof bytes);
    CHECK(directory_run(&dir, "--data", text, sizeof text) == 1);
    CHECK_MSG(strstr(text, "later version") != NULL, "%s", text);
    CHECK(directory_run(&dir, "--repair", text, sizeof text) == 1);
    char *after = file_read(path, &n);
    CHECK(n == sizeof bytes && memcmp(after, bytes, n) == 0);
    free(after);
    directory_remove(&dir);
}

TEST(missing_segment_is_noticed)
{
    char path[128];
    struct sample s = make_sample(SIGKILL);
    struct daemon d = directory_daemon(&s.dir, NULL);
    carry_out(&d, "ADD z 1 1\n");
    daemon_stop(&d, SIGKILL);
    CHECK(directory_file(&s.dir, "log.", 1, path));
    struct outcome o = look(s.dir.path);
    CHECK(o.result == RECOVERY_OK && o.last == CHANGES + 1);
    CHECK(unlink(s.path) == 0);
    o = look(s.dir.path);
    CHECK(o.result == RECOVERY_REFUSED && strstr(o.why, "missing") != NULL);
    free_sample(&s);
}

TEST(snapshot_cut_or_flipped_anywhere_is_refused)
{
    char path[128];
    size_t n;
    struct sample s = make_sample(SIGKILL);
    struct daemon d = directory_daemon(&s.dir, NULL);
    carry_out(&d, "SNAPSHOT\n");
    while (daemon_info(&d, "snapshots") == 0)
        pause_ms(5);
    daemon_stop(&d, SIGKILL);
    CHECK(directory_file(&s.dir, "snapshot.", 0, path));
    char *bytes = file_read(path, &n);
    CHECK(look(s.dir.path).digest == s.digest[CHANGES]);
    for (size_t i = 0; i < n; i++) {
        file_write(path, bytes, i);
        struct outcome o = look(s.dir.path);
        CHECK_MSG(o.result == RECOVERY_REFUSED && o.why[0] != '\0', "cut at %zu", i);
    }
    for (size_t i = 0; i < 8 * n; i++) {
        bytes[i / 8] ^= (char)(1 << i % 8);
        file_write(path, bytes, n);
        bytes[i / 8] ^= (char)(1 << i % 8);
        struct outcome o = look(s.dir.path);
        CHECK_MSG(o.result == RECOVERY_REFUSED && o.why[0] != '\0', "bit %zu", i);
    }
    free(bytes);
    free_sample(&s);
}

/* After a crash at any point of a snapshot the files are read as if it had not begun. */
TEST(unfinished_snapshot_is_ignored_and_removed)
{
    char path[200];
    struct sample s = make_sample(SIGKILL);
    snprintf(path, sizeof path, "%s/snapshot.%016x.tmp", s.dir.path, 7);
    file_write(path, "half of", 7);
    CHECK(look(s.dir.path).digest == s.digest[CHANGES]);
    struct daemon d = directory_daemon(&s.dir, NULL);
    CHECK(access(path, F_OK) != 0);
    daemon_stop(&d, SIGTERM);
    free_sample(&s);
}
