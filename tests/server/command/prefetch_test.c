/* prefetch_test.c - a pipeline that is prefetched gets the same replies as its requests one by one. */
#include "server/command/prefetch.h"
#include "tests/server/daemon.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { REQUESTS = 400, ROOM = 1 << 16 };

/* Requests in lines, and a few in RESP. */
struct script {
    char text[ROOM];
    size_t start[REQUESTS + 1], n; /* request i: start[i] .. start[i + 1] - 1 */
};

__attribute__((format(printf, 3, 4))) static void add(struct script *s, bool resp,
                                                      const char *format, ...)
{
    char line[256], *word, *rest = line;
    va_list ap;
    va_start(ap, format);
    vsnprintf(line, sizeof line, format, ap);
    va_end(ap);
    char *to = s->text + s->start[s->n];
    unsigned words = 1;
    for (const char *p = line; *p != '\0'; p++)
        words += *p == ' ';
    if (!resp)
        to += sprintf(to, "%s\n", line);
    else
        to += sprintf(to, "*%u\r\n", words);
    while (resp && (word = strsep(&rest, " ")) != NULL)
        to += sprintf(to, "$%zu\r\n%s\r\n", strlen(word), word);
    s->start[++s->n] = (size_t)(to - s->text);
    CHECK(s->start[s->n] < ROOM - 512);
}

/* Queries of two sets, with edits, a set that comes and goes, loads and nonsense between them. */
static void write_script(struct script *s)
{
    s->n = 0;
    while (s->n < REQUESTS - 4) {
        bool resp = test_below(3) == 0;
        const char *set = test_below(4) == 0 ? "b" : "a";
        double x = test_uniform() * 1.2 - 0.1, y = test_uniform() * 1.2 - 0.1;
        switch (test_below(18)) {
        case 0:
            add(s, resp, "ADD %s %.3f %.3f", set, x, y);
            break;
        case 1:
            add(s, resp, "DEL %s %u", set, test_below(3000));
            break;
        case 2:
            add(s, false, "LOAD %s 2\n%.2f %.2f\nNEAREST a", set, x, y);
            break;
        case 3: /* the points of a load are no requests, whatever comes before the load */
            add(s, false, "TIMEOUT 9 LOAD %s 2\n%.2f %.2f\n%s", set, x, y,
                test_below(2) ? "PING" : "0.5 0.5");
            break;
        case 4:
            add(s, resp, "LISTS %s %u 1 2 3 4 5 6", set, test_below(3100));
            break;
        case 5:
            add(s, resp, "%s u%s", test_below(2) ? "DROP" : "CREATE", test_below(2) ? "" : " TOL");
            break;
        case 6:
            add(s, resp, "LOCATE %s 1e300 %.2f", set, y);
            break;
        case 7:
            add(s, resp, "GET %s %u", set, test_below(4000));
            break;
        case 8:
        case 9:
        case 10:
            add(s, resp, "LISTS %s %u", set, test_below(3100));
            break;
        case 11:
        case 12:
            add(s, resp, "LOCATE %s %.3f %.3f", set, x, y);
            break;
        default:
            add(s, resp, "NEAREST %s %.3f %.3f", set, x, y);
        }
    }
}

/* A daemon with the sets a, 2000 points, and b, 50 points; the same every time. */
static struct daemon start_with_sets(void)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char line[64];
    uint32_t seed = 1;
    for (int set = 0; set < 2; set++) {
        int n = set == 0 ? 2000 : 50;
        say(fd, line + (snprintf(line, sizeof line, "LOAD %c %d\n", 'a' + set, n) < 0));
        for (int i = 0; i < n; i++) {
            seed = seed * 1664525 + 1013904223;
            snprintf(line, sizeof line, "0.%u 0.%u\n", seed >> 16, seed & 0xffff);
            say(fd, line);
        }
        hear_line(fd);
        say(fd, line + (snprintf(line, sizeof line, "TRIANGULATE %c\n", 'a' + set) < 0));
        hear_line(fd);
    }
    close(fd);
    return d;
}

/* All replies when the script is sent in pieces of this number of requests. */
static char *play(const struct script *s, size_t piece, size_t *n)
{
    struct daemon d = start_with_sets();
    int fd = daemon_connect(&d);
    for (size_t i = 0; i < s->n; i += piece) {
        size_t end = i + piece < s->n ? i + piece : s->n;
        say_bytes(fd, s->text + s->start[i], s->start[end] - s->start[i]);
        if (piece == 1)
            pause_ms(1); /* so that it is alone in the daemon's input */
    }
    shutdown(fd, SHUT_WR);
    char *text = hear_all(fd, n);
    close(fd);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    return text;
}

TEST(pipeline_gets_the_replies_that_its_requests_get_one_by_one)
{
    static struct script s;
    size_t n, m;
    write_script(&s);
    char *want = play(&s, 1, &n);
    CHECK(n > 5000);
    for (size_t piece = 3; piece <= REQUESTS; piece *= 11) {
        char *got = play(&s, piece, &m);
        CHECK_UNVERSIONED(got, want);
        CHECK(m == n);
        free(got);
    }
    free(want);
}

/* Whether the place of the first of some NEAREST is prefetched now, which reads the set's
 * arrays. */
static bool looks_ahead(struct local *l)
{
    static const char requests[] = "NEAREST t 1 1\nNEAREST t 2 2\nNEAREST t 3 3\nNEAREST t 4 4\n";
    prefetch_forget(l->server.reactor->prefetch);
    CHECK(prefetch_take(&l->server, l->server.reactor, requests, sizeof requests - 1) > 0);
    return l->server.reactor->prefetch->place != NULL;
}

TEST(set_that_is_being_edited_is_not_looked_at_ahead)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, "ADD t 0 0  9 0  9 9  0 9\nTRIANGULATE t\nNEAREST t 1 1\n");
    struct dataset *set = local_set(&l, "t");
    CHECK(set != NULL && looks_ahead(&l));
    set->exclusive = true;
    CHECK(!looks_ahead(&l));
    set->exclusive = false;
    CHECK(looks_ahead(&l));
    local_stop(&l);
}
