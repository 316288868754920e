/* promises_test.c - the keys of INFO, the limits, the words of requests, and what a token for reading may not use are those that
 * proto/PROTOCOL.md documents. */
#include "core/delaunay.h"
#include "core/delaunay_constraints.h"
#include "core/delaunay_fields.h"
#include "proto/line.h"
#include "proto/request.h"
#include "proto/resp.h"
#include "server/commands.h"
#include "server/disk/backup.h"
#include "server/ops/config.h"
#include "server/ops/limits.h"
#include "tests/server/daemon.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { DOCUMENT = 1 << 18 };

/* The part of the document from the line that begins with `from` to the line that begins with `to`;
 * the caller frees it. */
static char *part_of_document(const char *from, const char *to)
{
    char line[2048];
    size_t n = 0;
    bool within = false;
    char *part = calloc(1, DOCUMENT);
    FILE *f = fopen("proto/PROTOCOL.md", "r");
    CHECK_MSG(f != NULL && part != NULL, "tests run in the root of the repository");
    while (fgets(line, sizeof line, f) != NULL) {
        within =
            within ? strncmp(line, to, strlen(to)) != 0 : strncmp(line, from, strlen(from)) == 0;
        if (within && n + strlen(line) < DOCUMENT)
            n += strlen(strcpy(part + n, line));
    }
    fclose(f);
    CHECK_MSG(n > 0, "PROTOCOL.md has no line `%s`", from);
    return part;
}

/* ---- INFO ---- */

/* Whether the text contains the word between backticks. */
static bool names(const char *text, const char *word)
{
    char quoted[100];
    snprintf(quoted, sizeof quoted, "`%.90s`", word);
    return strstr(text, quoted) != NULL;
}

/* Whether INFO prints a line `key:`. */
static bool prints(const char *info, const char *key)
{
    char line[100];
    snprintf(line, sizeof line, "\n%.90s:", key);
    return strstr(info, line) != NULL;
}

static void expect_keys_in_document(const char *info, const char *document)
{
    char key[100];
    int keys = 0;
    for (const char *at = strchr(info, '\n'); at != NULL && at[1] != '\0';
         at = strchr(at + 1, '\n')) {
        CHECK(sscanf(at, "\n%99[^:]:", key) == 1);
        CHECK_MSG(strncmp(key, "command_", 8) == 0 || names(document, key),
                  "PROTOCOL.md does not name the key %s of INFO", key);
        keys++;
    }
    CHECK(keys > 40);
}

/* Checks the words between backticks in one cell of a table. */
static void expect_cell_in_info(const char *cell, size_t len, const char *info)
{
    char key[100];
    const char *end = cell + len;
    for (const char *at = cell; (at = memchr(at, '`', (size_t)(end - at))) != NULL;) {
        int n = 0;
        CHECK(sscanf(at, "`%99[^`]`%n", key, &n) == 1 && n > 0);
        CHECK_MSG(prints(info, key), "INFO has no key %s, which PROTOCOL.md names", key);
        at += n;
    }
}

TEST(keys_of_info_are_those_of_the_document)
{
    size_t n;
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "INFO\nQUIT\n");
    char *info = hear_all(fd, &n);
    *strstr(info, "OK 0\n") = '\0';
    char *document = part_of_document("### INFO", "```");
    expect_keys_in_document(info, document);
    bool durability = false;
    for (char *row = strtok(document, "\n"); row != NULL; row = strtok(NULL, "\n")) {
        durability |= strncmp(row, "| key of `durability`", 21) == 0;
        if (strncmp(row, "| `", 3) != 0)
            continue;
        const char *first = row + 1, *second = strchr(first, '|') + 1;
        bool keys = !durability && strncmp(row, "| `commands`", 12) != 0;
        if (durability)
            expect_cell_in_info(first, (size_t)(second - first), info);
        else if (keys)
            expect_cell_in_info(second, strlen(second), info);
    }
    CHECK(durability);
    free(document);
    free(info);
}

/* ---- limits ---- */

TEST(limits_are_those_of_the_document)
{
    struct config c;
    config_init(&c);
    const struct {
        const char *what;
        uint64_t limit;
    } limits[] = {
        {"bytes of a line", LINE_LIMIT},
        {"bytes of a request in RESP", RESP_LIMIT},
        {"bytes of a body in RESP", RESP_BODY_LIMIT},
        {"bytes of a set's name", SET_NAME_LIMIT},
        {"bytes of a field's name", DT_FIELD_NAME},
        {"bytes of a backup's name", BACKUP_NAME_LIMIT},
        {"bytes of a client's name", LIMIT_CLIENT_NAME},
        {"bytes of a token", LIMIT_TOKEN},
        {"sets", LIMIT_SETS},
        {"points of a set", DT_MAX_POINTS},
        {"fields of a set", DT_MAX_FIELDS},
        {"constraints of a set", DT_MAX_CONSTRAINTS},
        {"points of a set for TRACE", LIMIT_TRACE_POINTS},
        {"points for each place of NEARESTB", LIMIT_NEAREST_MANY},
        {"columns and rows of a RASTER", LIMIT_RASTER_SIDE},
        {"cells of a RASTER", LIMIT_RASTER_CELLS},
        {"levels of a CONTOUR", LIMIT_LEVELS},
        {"clients", 10000},
        {"long requests that wait for a worker", LIMIT_QUEUED_JOBS},
        {"seconds for TIMEOUT", LIMIT_TIMEOUT_S},
        {"slow requests that are kept", c.slowlog_len},
        {"seconds in which a client takes nothing of a reply", LIMIT_STALL_S},
        {"seconds before AUTH", LIMIT_STRANGER_S},
        {"bytes of a request before AUTH", LIMIT_STRANGER_BYTES},
        {"words of a request before AUTH", LIMIT_STRANGER_WORDS},
    };
    enum { LIMITS = sizeof limits / sizeof limits[0] };
    char *table = part_of_document("| what | limit", "- ");
    size_t rows = 0;
    strtok(table, "\n");
    strtok(NULL, "\n");
    for (char *row; (row = strtok(NULL, "\n")) != NULL; rows++) {
        char what[100];
        unsigned long long limit;
        CHECK(sscanf(row, "| %99[^|]| %llu |", what, &limit) == 2 && rows < LIMITS);
        what[strlen(what) - 1] = '\0';
        CHECK_STR(what, limits[rows].what);
        CHECK_MSG(limit == limits[rows].limit, "%s: %llu", what, limit);
    }
    CHECK(rows == LIMITS);
    free(table);
}

/* ---- tokens ---- */

/* Whether the text contains the word, between characters that are no capitals. */
static bool has_word(const char *text, const char *word)
{
    size_t n = strlen(word);
    for (const char *at = text; (at = strstr(at, word)) != NULL; at++)
        if (at > text && !isupper((unsigned char)at[-1]) && !isupper((unsigned char)at[n]))
            return true;
    return false;
}

/* CLIENT and CONFIG, whose second word decides, have no flag in the table. */
TEST(commands_that_a_token_for_reading_may_not_use_are_those_of_the_document)
{
    char *document = part_of_document("With `--auth-file` a client must", "## 9");
    char *from = strstr(document, "may not use"), *to = from != NULL ? strchr(from, '.') : NULL;
    CHECK(to != NULL);
    *to = '\0';
    for (size_t i = 0; i < command_count; i++) {
        const struct command *c = &commands[i];
        bool refused = (c->flags & (CMD_WRITE | CMD_ADMIN)) != 0;
        if (strcmp(c->name, "CLIENT") != 0 && strcmp(c->name, "CONFIG") != 0)
            CHECK_MSG(has_word(from, c->name) == refused, "PROTOCOL.md, section 8: %s", c->name);
    }
    free(document);
}

/* ---- usage ---- */

/* Whether the list, words between blanks, contains the word. */
static bool lists(const char *list, const char *word)
{
    char padded[100];
    snprintf(padded, sizeof padded, " %.90s ", word);
    return strstr(list, padded) != NULL;
}

/* Appends the words of the text to the list. */
static void add_words(char *list, size_t room, const char *text)
{
    size_t at = strlen(list), len;
    for (; *(text += strspn(text, " |[],;.")) != '\0'; text += len) {
        len = strcspn(text, " |[];.");
        while (len > 0 && text[len - 1] == ',')
            len--;
        at += (size_t)snprintf(list + at, room - at, "%.*s ", (int)len, text);
        CHECK(at < room);
    }
}

/* Appends the words of all headings that begin with the name of the command. */
static void add_headings(char *list, size_t room, const char *document, const char *name)
{
    char start[64], heading[256];
    size_t n = (size_t)snprintf(start, sizeof start, "### %s", name);
    for (const char *at = document; (at = strstr(at, start)) != NULL; at += n)
        if (!isupper((unsigned char)at[n]) && sscanf(at + 4, "%255[^\n]", heading) == 1)
            add_words(list, room, heading);
}

/* Every word of `words` is in `list`, or is a command. */
static void expect_listed(const char *name, char *words, const char *list)
{
    for (char *word = strtok(words, " "); word != NULL; word = strtok(NULL, " ")) {
        bool found = lists(list, word);
        for (size_t i = 0; i < command_count && !found; i++)
            found = strcmp(commands[i].name, word) == 0;
        CHECK_MSG(found, "%s: only one of usage and PROTOCOL.md has the word %s", name, word);
    }
}

TEST(words_of_usages_are_those_of_the_headings_of_the_document)
{
    char *document = part_of_document("# ", "## 9");
    for (size_t i = 0; i < command_count; i++) {
        char usage[512] = " ", headings[512] = " ", words[512];
        add_words(usage, sizeof usage, commands[i].usage);
        add_headings(headings, sizeof headings, document, commands[i].name);
        expect_listed(commands[i].name, strcpy(words, usage), headings);
        expect_listed(commands[i].name, strcpy(words, headings), usage);
    }
    free(document);
}

TEST_TIMEOUT(server_holds_as_many_sets_as_documented_and_no_more, 60)
{
    struct local l;
    char line[80];
    local_start(&l, 0);
    for (unsigned i = 0; i < LIMIT_SETS; i++) {
        snprintf(line, sizeof line, "CREATE s%u\n", i);
        CHECK_STR(local_ask(&l, line), "OK 0\n");
    }
    static const char refused[] = "ERR TOOBIG a server holds at most 65536 sets\n";
    CHECK_STR(local_ask(&l, "CREATE more\n"), refused);
    CHECK_STR(local_ask(&l, "ADD more 1 1\n"), refused);
    CHECK_STR(local_ask(&l, "LOAD more 1\n1 1\n"), refused);
    CHECK_STR(local_ask(&l, "DROP s7\n"), "OK 0\n");
    CHECK_STR(local_ask(&l, "ADD more 1 1\n"), "OK 0 first=0 added=1 coincident=0\n");
    local_stop(&l);
}

TEST(token_has_at_most_128_bytes)
{
    char path[] = "/tmp/delaunayd-test-XXXXXX", token[140], request[160];
    const char *arguments[] = {"--auth-file", path, NULL};
    CHECK(close(mkstemp(path)) == 0);
    memset(token, 'x', sizeof token);
    token[LIMIT_TOKEN] = '\0';
    FILE *f = fopen(path, "w");
    CHECK(f != NULL && fprintf(f, "rw %s\n", token) > 0 && fclose(f) == 0);
    struct daemon d = daemon_start(arguments);
    snprintf(request, sizeof request, "AUTH %s\n", token);
    converse(&d, request, "OK 0 role=rw\n");
    snprintf(request, sizeof request, "AUTH %sx\n", token);
    converse(&d, request, "ERR DENIED no such token\n");
    f = fopen(path, "w");
    CHECK(f != NULL && fprintf(f, "rw %sx\n", token) > 0 && fclose(f) == 0);
    snprintf(request, sizeof request, "AUTH %s\nCONFIG RELOAD\n", token);
    converse(
        &d, request,
        "OK 0 role=rw\nERR IO the token file is not valid; the old tokens stay: see the log\n");
    unlink(path);
}
