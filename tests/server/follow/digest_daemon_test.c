/* digest_daemon_test.c - DIGEST of daemons: after kills and snapshots, of copies of the data, beside edits, in each
 * framing. */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

struct reply {
    uint64_t digest, version;
};

static struct reply reply_of(const char *line)
{
    struct reply r;
    CHECK_MSG(sscanf(line, "OK 0 digest=%16" SCNx64 " points=%*u version=%" SCNu64, &r.digest,
                     &r.version) == 2,
              "%s", line);
    return r;
}

/* The reply to DIGEST of the set. */
static struct reply digest_of(const struct daemon *d, const char *set)
{
    char line[100];
    int fd = daemon_connect(d);
    snprintf(line, sizeof line, "DIGEST %s\n", set);
    say(fd, line);
    struct reply r = reply_of(hear_line(fd));
    close(fd);
    return r;
}

static void expect_same(const struct daemon *d, const char *set, struct reply want)
{
    struct reply r = digest_of(d, set);
    CHECK_MSG(r.digest == want.digest && r.version == want.version, "%s", set);
}

/* Some edits of the points below 50 and new points; the point `gone` goes. */
static void edit_at_random(const struct daemon *d, const char *set, int gone)
{
    char text[8000], *to = text;
    for (int i = 0; i < 60; i++) {
        unsigned id = test_below(50), x = test_below(6), y = test_below(6);
        switch (test_below(5)) {
        case 0:
            to += sprintf(to, "ADD %s FIELDS z,w %u %u 1 nan\n", set, x, y);
            break;
        case 1:
            to += sprintf(to, "FSET %s z %u nan\n", set, id);
            break;
        case 2:
            to += sprintf(to, "FSET %s w %u %u\n", set, id, x);
            break;
        default:
            to += sprintf(to, "MOVE %s %u %u %u\n", set, id, x, y);
        }
    }
    sprintf(to, "DEL %s %d\nADD %s 9 9\n", set, gone, set);
    carry_out(d, text);
}

static void make_sets(const struct daemon *d)
{
    char text[5000], *to = text;
    to += sprintf(to, "CREATE b TOL 0.5\nCREATE empty\nCREATE c TOL 1\nEXPIRE c 100000\nADD a");
    for (int i = 0; i < 80; i++)
        to += sprintf(to, " %d %d", i, i % 7);
    to += sprintf(to, "\nADD b");
    for (int i = 0; i < 80; i++)
        to += sprintf(to, " 0.%d %d", i, i % 5);
    sprintf(to, "\nTRIANGULATE a\nTRIANGULATE empty\n");
    carry_out(d, text);
}

static const char *const sets[] = {"a", "b", "c", "empty"};
enum { SETS = sizeof sets / sizeof sets[0] };

TEST_TIMEOUT(digests_survive_kills_and_snapshots, 60)
{
    struct directory dir = directory_quick();
    struct daemon d = directory_daemon(&dir, NULL);
    make_sets(&d);
    for (int i = 0; i < 6; i++) {
        struct reply r[SETS];
        edit_at_random(&d, "a", 50 + i);
        edit_at_random(&d, "b", 50 + i);
        if (i % 3 == 1) {
            carry_out(&d, "SNAPSHOT\n");
            await_info(&d, "snapshots", 1);
        }
        if (i % 3 == 2)
            edit_at_random(&d, "b", 60 + i);
        for (int k = 0; k < SETS; k++)
            r[k] = digest_of(&d, sets[k]);
        daemon_stop(&d, i == 4 ? SIGTERM : SIGKILL);
        d = directory_daemon(&dir, NULL);
        for (int k = 0; k < SETS; k++)
            expect_same(&d, sets[k], r[k]);
    }
    daemon_end(&d);
    directory_remove(&dir);
}

/* One from the log, the other from a snapshot and the log after it. */
TEST(daemons_with_the_same_log_have_the_same_digests)
{
    struct directory dir[2] = {directory_quick(), directory_quick()};
    struct daemon d[2] = {directory_daemon(&dir[0], NULL)};
    char path[128];
    size_t n;
    make_sets(&d[0]);
    edit_at_random(&d[0], "a", 50);
    CHECK(directory_file(&dir[0], "log.", 0, path));
    char *log = file_read(path, &n), to[192];
    snprintf(to, sizeof to, "%s%s", dir[1].path, strrchr(path, '/'));
    file_write(to, log, n);
    free(log);
    carry_out(&d[0], "SNAPSHOT\n");
    await_info(&d[0], "snapshots", 1);
    struct reply before[SETS];
    for (int k = 0; k < SETS; k++)
        before[k] = digest_of(&d[0], sets[k]);
    daemon_stop(&d[0], SIGKILL);
    for (int i = 0; i < 2; i++)
        d[i] = directory_daemon(&dir[i], NULL);
    for (int k = 0; k < SETS; k++)
        for (int i = 0; i < 2; i++)
            expect_same(&d[i], sets[k], before[k]);
    carry_out(&d[1], "MOVE a 1 0.25 0.25\n");
    CHECK(digest_of(&d[1], "a").digest != before[0].digest);
    for (int i = 0; i < 2; i++) {
        daemon_end(&d[i]);
        directory_remove(&dir[i]);
    }
}

/* The editor knows the digest at every version, because nobody else edits. */
TEST_TIMEOUT(digest_beside_edits_is_that_of_its_version, 60)
{
    enum { EDITS = 150, POINTS = 30000, ASKED = 4 };
    struct daemon d = daemon_start(NULL);
    int editor = daemon_connect(&d), reader = daemon_connect(&d);
    struct reply at[EDITS + 1], seen;
    char line[100];
    unsigned asked = 0, found = 0;
    load_random(editor, "t", POINTS);
    say(editor, "TRIANGULATE t\n");
    hear_line(editor);
    at[0] = digest_of(&d, "t");
    for (int i = 1; i <= EDITS; i++) {
        for (; asked < found + ASKED; asked++)
            say(reader, "DIGEST t\n");
        snprintf(line, sizeof line, i % 3 == 0 ? "FSET t z %u %u\n" : "MOVE t %u 0.%u 0.5\n",
                 (unsigned)test_below(POINTS), (unsigned)test_below(1000));
        say(editor, line);
        say(editor, "DIGEST t\n");
        hear_line(editor);
        at[i] = reply_of(hear_line(editor));
        CHECK(at[i].version > at[i - 1].version && at[i].digest != at[i - 1].digest);
        for (unsigned k = 0; k < ASKED / 2; k++, found++) {
            seen = reply_of(hear_line(reader));
            int which = i;
            while (which > 0 && at[which].version != seen.version)
                which--;
            CHECK(at[which].version == seen.version && at[which].digest == seen.digest);
        }
    }
    close(editor);
    close(reader);
    daemon_end(&d);
}

TEST(digest_in_every_framing)
{
    struct daemon d = daemon_start(NULL);
    char want[200];
    int fd = daemon_connect(&d);
    carry_out(&d, "ADD t 0 0 1 1\n");
    say(fd, "DIGEST t\n*2\r\n$6\r\ndigest\r\n$1\r\nt\r\n*2\r\n$5\r\nHELLO\r\n$1\r\n3\r\n");
    struct reply r = reply_of(hear_line(fd));
    snprintf(want, sizeof want, "+OK digest=%016" PRIx64 " points=2 version=%" PRIu64, r.digest,
             r.version);
    const char *text = hear_line(fd);
    CHECK_MSG(strncmp(text, want, strlen(want)) == 0, "%s", text);
    while (strncmp(hear_line(fd), "*0", 2) != 0) /* the modules: the end of HELLO's reply */
        ;
    say(fd, "*2\r\n$6\r\nDIGEST\r\n$1\r\nt\r\n*2\r\n$6\r\nDIGEST\r\n$1\r\nu\r\n");
    snprintf(want, sizeof want,
             "%%3\r\n$6\r\ndigest\r\n$16\r\n%016" PRIx64 "\r\n$6\r\npoints\r\n:2\r\n$7\r\nversion"
             "\r\n:%" PRIu64 "\r\n-NOSET there is no set u\r\n",
             r.digest, r.version);
    expect(fd, want);
    close(fd);
    daemon_end(&d);
}

TEST(digest_that_exceeds_its_time_limit_is_cancelled)
{
    const char *one_worker[] = {"--threads", "1", NULL};
    struct daemon d = daemon_start(one_worker);
    int builder = daemon_connect(&d), fd = daemon_connect(&d);
    load_random(fd, "t", 30000);
    load_random(fd, "u", 200000);
    say(builder, "TRIANGULATE u METHOD shelling\n"); /* much longer than the limit */
    await_info(&d, "jobs_running", 1);
    say(fd, "TIMEOUT 0.02 DIGEST t\nTIMEOUT 60 DIGEST t\n");
    CHECK_MSG(strncmp(hear_line(fd), "ERR TIMEOUT", 11) == 0, "it waited for no worker");
    reply_of(hear_line(fd));
    close(builder);
    close(fd);
    daemon_end(&d);
}
