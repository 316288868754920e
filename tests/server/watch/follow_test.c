/* follow_test.c - WATCH: what clients that follow a set are sent, and that it is all they need. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <inttypes.h>
#include <string.h>
#include <unistd.h>

/* ---- a mirror: the rows of a set, by id ---- */

enum { IDS = 4096, ROW = 4096 };

struct mirror {
    int fd;
    uint64_t version;
    unsigned resets;
    bool whole, dropped;
    char *point[IDS], *list[IDS]; /* own: rows as in POINTS and LISTS */
};

static void set_row(char **at, const char *row)
{
    free(*at);
    *at = row == NULL ? NULL : strdup(row);
    CHECK(row == NULL || *at != NULL);
}

static void take_row(struct mirror *m, const char *row)
{
    char kind[8], side = 0;
    uint32_t id;
    int after = 0;
    CHECK(sscanf(row, "%7s %" SCNu32 "%n", kind, &id, &after) == 2 && id < IDS);
    if (strcmp(kind, "list") == 0) {
        char text[ROW];
        CHECK(sscanf(row + after, " %c%n", &side, &after) == 1 && (side == 'i' || side == 'b'));
        const char *ring = strchr(strchr(row + 5, ' ') + 1, ' ');
        snprintf(text, sizeof text, "%" PRIu32 "%s", id, ring == NULL ? "" : ring);
        set_row(&m->list[id], text);
        return;
    }
    bool point = strcmp(kind, "point") == 0;
    CHECK_MSG(point || strcmp(kind, "gone") == 0, "%s", row);
    set_row(&m->point[id], point ? row + strlen("point ") : NULL);
    set_row(&m->list[id], NULL);
}

static void take_event(struct mirror *m)
{
    char head[200];
    snprintf(head, sizeof head, "%s", hear_line(m->fd));
    CHECK_MSG(strncmp(head, "EVENT ", 6) == 0, "%s", head);
    const char *version = strstr(head, " version=");
    m->dropped = strstr(head, " dropped") != NULL;
    m->whole = strstr(head, " more") == NULL;
    m->version = version == NULL ? 0 : strtoull(version + 9, NULL, 10);
    bool reset = strstr(head, " reset") != NULL;
    m->resets += reset;
    for (unsigned i = 0; reset && i < IDS; i++) {
        set_row(&m->point[i], NULL);
        set_row(&m->list[i], NULL);
    }
    for (unsigned long n = strtoul(head + 6, NULL, 10); n > 0; n--)
        take_row(m, hear_line(m->fd));
}

static uint64_t version_in(const char *line)
{
    const char *at = strstr(line, " version=");
    CHECK_MSG(at != NULL, "%s", line);
    return strtoull(at + 9, NULL, 10);
}

static void watch(struct mirror *m, const struct daemon *d, const char *set)
{
    char line[100];
    m->fd = daemon_connect(d);
    snprintf(line, sizeof line, "WATCH %s\n", set);
    say(m->fd, line);
    version_in(hear_line(m->fd));
}

static void catch_up(struct mirror *m, uint64_t version)
{
    while (!m->whole || m->version < version)
        take_event(m);
    CHECK(m->version == version);
}

static void leave(struct mirror *m)
{
    for (unsigned i = 0; i < IDS; i++) {
        free(m->point[i]);
        free(m->list[i]);
    }
    close(m->fd);
}

/* Compares the rows of a reply with the mirror's; every one of them must be in it. */
static void compare(int fd, const char *command, char *const *row)
{
    char line[100];
    unsigned have = 0;
    snprintf(line, sizeof line, "%s\n", command);
    say(fd, line);
    const char *head = hear_line(fd);
    CHECK_MSG(strncmp(head, "OK ", 3) == 0, "%s", head);
    unsigned long n = strtoul(head + 3, NULL, 10);
    for (unsigned long i = 0; i < n; i++) {
        const char *got = hear_line(fd);
        unsigned long id = strtoul(got, NULL, 10);
        CHECK(id < IDS && row[id] != NULL);
        CHECK_STR(row[id], got);
    }
    for (unsigned i = 0; i < IDS; i++)
        have += row[i] != NULL;
    CHECK(have == n);
}

static uint64_t ask_version(int fd, const char *line)
{
    say(fd, line);
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, "OK", 2) == 0, "%s -> %s", line, got);
    return version_in(got);
}

static void check_mirror(struct mirror *m, int fd, bool triangulated)
{
    if (triangulated)
        compare(fd, "LISTS t", m->list);
    else
        for (unsigned i = 0; i < IDS; i++)
            CHECK(m->list[i] == NULL);
    compare(fd, "POINTS t", m->point);
}

/* ---- random edits ---- */

static void random_place(char *text, size_t size, bool lattice)
{
    if (lattice)
        snprintf(text, size, "%u %u", (unsigned)test_below(5), (unsigned)test_below(5));
    else
        snprintf(text, size, "%g %g", test_uniform(), test_uniform());
}

/* An edit of a set that has had `ids` ids; some name an id that is gone, and fail. */
static void random_edit(char *line, size_t size, uint32_t ids, bool lattice)
{
    char place[64];
    size_t at;
    random_place(place, sizeof place, lattice);
    uint32_t id = ids == 0 ? 0 : test_below(ids);
    switch (test_below(8)) {
    case 0:
    case 1:
        snprintf(line, size, "ADD t %s\n", place);
        break;
    case 2:
        at = (size_t)snprintf(line, size, "ADD t");
        for (uint32_t n = 1 + test_below(30); n > 0; n--) {
            random_place(place, sizeof place, lattice);
            at += (size_t)snprintf(line + at, size - at, " %s", place);
        }
        snprintf(line + at, size - at, "\n");
        break;
    case 3:
        snprintf(line, size, test_below(4) > 0 ? "DEL t %u %u\n" : "TRIANGULATE t\n", (unsigned)id,
                 (unsigned)(id / 2));
        break;
    case 4:
        snprintf(line, size, "DEL t %u\n", (unsigned)id);
        break;
    default:
        snprintf(line, size, "MOVE t %u %s\n", (unsigned)id, place);
    }
}

static void follow_history(const struct daemon *d, bool lattice, bool triangulated)
{
    enum { EDITS = 60 };
    char line[4000];
    struct mirror m = {.whole = false}, later = {.whole = false};
    int fd = daemon_connect(d);
    uint64_t version =
        ask_version(fd, lattice && test_below(2) == 0 ? "CREATE t TOL 1\n" : "CREATE t\n");
    uint32_t ids = 0;
    watch(&m, d, "t");
    if (triangulated)
        version = ask_version(fd, "TRIANGULATE t\n");
    for (int i = 0; i < EDITS; i++) {
        random_edit(line, sizeof line, ids, lattice);
        say(fd, line);
        const char *got = hear_line(fd);
        if (strncmp(got, "OK", 2) == 0)
            version = version_in(got);
        unsigned first, added;
        if (sscanf(got, "OK 0 first=%u added=%u", &first, &added) == 2)
            ids = first + added;
        triangulated = triangulated || strncmp(line, "TRI", 3) == 0;
        if (i == EDITS / 2)
            watch(&later, d, "t");
        if (test_below(3) > 0)
            continue;
        catch_up(&m, version);
        check_mirror(&m, fd, triangulated);
    }
    catch_up(&m, version);
    catch_up(&later, version);
    check_mirror(&m, fd, triangulated);
    check_mirror(&later, fd, triangulated);
    say(fd, "DROP t\n");
    expect(fd, "OK 0\n");
    take_event(&m);
    CHECK(m.dropped);
    leave(&m);
    leave(&later);
    close(fd);
}

TEST_TIMEOUT(mirror_has_what_points_and_lists_say_after_any_edits, 120)
{
    struct daemon d = daemon_start(NULL);
    for (int i = 0; i < 24; i++)
        follow_history(&d, i % 2 == 1, i % 3 > 0);
    daemon_end(&d);
}

/* ---- one by one ---- */

#define SQUARE "ADD t 0 0  4 0  4 4  0 4\nTRIANGULATE t\n"

TEST(watcher_is_sent_everything_and_then_what_changes)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    say(fd, "ADD t 0 0  4 0  0 4\nWATCH t\n");
    expect(fd, "OK 0 first=0 added=3 coincident=0\nOK 0\n");
    CHECK(strstr(hear_line(fd), " reset") != NULL);
    expect(fd, "point 0 0 0\npoint 1 4 0\npoint 2 0 4\n");
    say(other, "MOVE t 1 5 0\nDEL t 2\n");
    expect(other, "OK 0\nOK 0 deleted=1\n");
    struct mirror m = {.fd = fd};
    while (m.point[1] == NULL || strcmp(m.point[1], "1 5 0") != 0)
        take_event(&m);
    say(fd, "UNWATCH t\nUNWATCH t\n");
    const char *line;
    while (strncmp(line = hear_line(fd), "OK", 2) != 0)
        continue;
    CHECK_STR(line, "OK 0 watched=1");
    expect(fd, "OK 0 watched=0\n");
    say(other, "MOVE t 1 6 0\n");
    expect(other, "OK 0\n");
    say(fd, "PING\n");
    expect(fd, "OK 0\n");
    close(other);
    leave(&m);
    daemon_end(&d);
}

TEST(watch_since_the_version_of_the_set_sends_only_what_comes_later)
{
    char line[100];
    struct daemon d = daemon_start(NULL);
    struct mirror m = {.whole = false};
    int fd = daemon_connect(&d);
    say(fd, SQUARE);
    hear_line(fd);
    uint64_t v = version_in(hear_line(fd));
    m.fd = daemon_connect(&d);
    snprintf(line, sizeof line, "WATCH t SINCE %" PRIu64 "\n", v);
    CHECK(ask_version(m.fd, line) == v);
    uint64_t now = ask_version(fd, "ADD t 2 1\n");
    catch_up(&m, now);
    CHECK(m.resets == 0);
    CHECK_STR(m.list[4], "4 0 1 2 3");
    ask_version(m.fd, line); /* the set has changed since */
    m.whole = false;
    catch_up(&m, now);
    CHECK(m.resets == 1);
    check_mirror(&m, fd, true);
    leave(&m);
    close(fd);
    daemon_end(&d);
}

/* Its output is full; what it gets when it reads again is the state of then. */
TEST_TIMEOUT(watcher_that_does_not_read_is_sent_one_state_later, 60)
{
    enum { POINTS = 3000, EDITS = 20000, BURST = 200 };
    struct daemon d = daemon_start(NULL);
    struct mirror m = {.whole = false};
    static char text[BURST * 64];
    int fd = daemon_connect(&d);
    load_random(fd, "t", POINTS);
    ask_version(fd, "TRIANGULATE t\n");
    watch(&m, &d, "t");
    uint64_t version = 0;
    for (int i = 0; i < EDITS; i += BURST) {
        size_t at = 0;
        for (int k = 0; k < BURST; k++)
            at += (size_t)snprintf(text + at, sizeof text - at, "MOVE t %u %g %g\n",
                                   (unsigned)test_below(POINTS), test_uniform(), test_uniform());
        say(fd, text);
        for (int k = 0; k < BURST; k++)
            version = version_in(hear_line(fd));
    }
    say(fd, "DEL t 5\nADD t 0.5 0.5\n");
    hear_line(fd);
    version = version_in(hear_line(fd));
    catch_up(&m, version);
    check_mirror(&m, fd, true);
    leave(&m);
    close(fd);
    daemon_end(&d);
}

TEST(events_are_pushes_in_resp_3_and_refused_in_resp_2)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 1 2\n*2\r\n$5\r\nWATCH\r\n$1\r\nt\r\n");
    expect(fd, "OK 0 first=0 added=1 coincident=0\n-UNKNOWN ");
    hear_line(fd);
    say(fd, "*2\r\n$5\r\nHELLO\r\n$1\r\n3\r\n");
    while (strcmp(hear_line(fd), "modules\r") != 0)
        continue;
    expect(fd, "*0\r\n");
    say(fd, "*2\r\n$5\r\nWATCH\r\n$1\r\nt\r\n");
    expect(fd, "%1\r\n$7\r\nversion\r\n:");
    hear_line(fd);
    expect(fd, ">3\r\n$5\r\nevent\r\n%3\r\n$3\r\nset\r\n$1\r\nt\r\n$7\r\nversion\r\n:");
    hear_line(fd);
    expect(fd, "$5\r\nreset\r\n#t\r\n*4\r\n$5\r\npoint\r\n:0\r\n,1\r\n,2\r\n");
    say(fd, "*2\r\n$4\r\nDROP\r\n$1\r\nt\r\n");
    expect(fd, "+OK\r\n>2\r\n$5\r\nevent\r\n%2\r\n$3\r\nset\r\n$1\r\nt\r\n$7\r\ndropped\r\n#t\r\n");
    close(fd);
    daemon_end(&d);
}

TEST(connection_watches_so_many_sets_and_no_more)
{
    enum { MOST = 64 };
    char line[100];
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    for (int i = 0; i <= MOST; i++) {
        snprintf(line, sizeof line, "CREATE s%d\n", i);
        ask_version(other, line);
        snprintf(line, sizeof line, "WATCH s%d\n", i);
        say(fd, line);
        const char *got = hear_line(fd);
        while (strncmp(got, "EVENT 0", 7) == 0)
            got = hear_line(fd);
        CHECK_MSG(strncmp(got, i < MOST ? "OK 0 version=" : "ERR TOOBIG", 10) == 0, "%s", got);
    }
    converse(&d, "WATCH none\nWATCH s1 SINCE x\nWATCH s1 SINCE\n",
             "ERR NOSET there is no set none\nERR NUMBER x is not a version\n"
             "ERR SYNTAX usage: WATCH set [SINCE version]\n");
    close(fd);
    close(other);
    daemon_end(&d);
}
