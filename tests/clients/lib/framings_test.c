/* framings_test.c - every transcript of proto/PROTOCOL.md in both framings: the same requests in lines
 * and in RESP must have the same replies, in the two formats. */
#include <ctype.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "proto/reply_read.h"
#include "tests/daemon.h"
#include "tests/test.h"

enum { ROOM = 1 << 16 };

struct bytes {
    char v[ROOM];
    size_t n;
};

static void append(struct bytes *b, const void *v, size_t n)
{
    CHECK(b->n + n < ROOM);
    memcpy(b->v + b->n, v, n);
    b->n += n;
}

/* ---- what a transcript sends, in both framings ---- */

struct requests {
    struct bytes lines, resp;
    char name[256][32]; /* the commands, in capitals */
    size_t n;
    long body; /* lines of a body to come, -1: up to a dot */
};

static void append_hex(struct requests *r, const char *hex)
{
    unsigned byte;
    for (; *hex != 0; hex += 2) {
        while (*hex == ' ')
            hex++;
        CHECK(sscanf(hex, "%2x", &byte) == 1);
        append(&r->lines, &(char){(char)byte}, 1);
        append(&r->resp, &(char){(char)byte}, 1);
    }
}

static void append_raw(struct requests *r, const char *line)
{
    append(&r->lines, line, strlen(line));
    append(&r->lines, "\n", 1);
    append(&r->resp, line, strlen(line));
    append(&r->resp, "\n", 1);
}

static void begin_body(struct requests *r, const char *name, char *const *word, int words)
{
    if (strcmp(name, "LOAD") == 0)
        r->body = words > 2 && isdigit((unsigned char)word[2][0]) ? strtol(word[2], NULL, 10) : -1;
}

static void append_request(struct requests *r, const char *line)
{
    char copy[1024], header[32], *word[256];
    int words = 0;
    snprintf(copy, sizeof copy, "%s", line);
    for (char *w = strtok(copy, " \t"); w != NULL; w = strtok(NULL, " \t"))
        word[words++] = w;
    if (words == 0) {
        append_raw(r, line);
        return;
    }
    append(&r->lines, line, strlen(line));
    append(&r->lines, "\r\n", 2);
    append(&r->resp, header, (size_t)sprintf(header, "*%d\r\n", words));
    for (int i = 0; i < words; i++) {
        append(&r->resp, header, (size_t)sprintf(header, "$%zu\r\n", strlen(word[i])));
        append(&r->resp, word[i], strlen(word[i]));
        append(&r->resp, "\r\n", 2);
    }
    char *name = r->name[r->n++];
    snprintf(name, 32, "%s", word[0]);
    for (char *c = name; *c != 0; c++)
        *c = (char)toupper((unsigned char)*c);
    begin_body(r, name, word, words);
}

static void append_sent(struct requests *r, const char *line)
{
    const char *text = line[1] == ' ' ? line + 2 : line + 1;
    if (line[1] == 'x') {
        append_hex(r, line + 2);
    } else if (r->body != 0) {
        append_raw(r, text);
        if (r->body > 0)
            r->body--;
        else if (strcmp(text, ".") == 0)
            r->body = 0;
    } else {
        append_request(r, text);
    }
}

/* ---- replies ---- */

static void converse(const struct bytes *said, struct bytes *heard)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    ssize_t n;
    CHECK(send(fd, said->v, said->n, MSG_NOSIGNAL) == (ssize_t)said->n);
    shutdown(fd, SHUT_WR);
    heard->n = 0;
    while ((n = recv(fd, heard->v + heard->n, ROOM - 1 - heard->n, 0)) > 0)
        heard->n += (size_t)n;
    heard->v[heard->n] = 0;
    close(fd);
    daemon_end(&d);
}

/* Removes times and sizes, which differ from run to run, from a text. */
static void mask(char *text, const char *key)
{
    char *at = strstr(text, key);
    if (at == NULL)
        return;
    at += strlen(key);
    memmove(at, at + strcspn(at, " \r\n"), strlen(at + strcspn(at, " \r\n")) + 1);
}

static bool same(const char *a, size_t a_len, const char *b, size_t b_len)
{
    char x[4096], y[4096];
    snprintf(x, sizeof x, "%.*s", (int)a_len, a);
    snprintf(y, sizeof y, "%.*s", (int)b_len, b);
    static const char *const vary[] = {" ms=", " memory=", " version=", " digest="};
    for (size_t i = 0; i < sizeof vary / sizeof vary[0]; i++) {
        mask(x, vary[i]);
        mask(y, vary[i]);
    }
    return strcmp(x, y) == 0;
}

/* The RESP line at *at without its end; moves *at behind it. */
static const char *take_line(const struct bytes *b, size_t *at, size_t *len)
{
    const char *line = b->v + *at, *cr = strstr(line, "\r\n");
    CHECK_MSG(cr != NULL, "the reply in RESP ends too early");
    *len = (size_t)(cr - line);
    *at += *len + 2;
    return line;
}

static const char *take_bulk(const struct bytes *b, size_t *at, size_t *len)
{
    size_t header_len;
    const char *header = take_line(b, at, &header_len);
    CHECK(*header == '$');
    *len = strtoul(header + 1, NULL, 10);
    const char *text = b->v + *at;
    *at += *len + 2;
    CHECK(*at <= b->n && memcmp(text + *len, "\r\n", 2) == 0);
    return text;
}

/* Skips a whole reply in RESP of any type. */
static void skip_resp(const struct bytes *b, size_t *at)
{
    size_t len, bulk = *at;
    const char *line = take_line(b, at, &len);
    if (*line == '$' && line[1] != '-')
        take_bulk(b, &bulk, &len);
    if (*line == '$' && line[1] != '-')
        *at = bulk;
    for (unsigned long n = *line == '*' ? strtoul(line + 1, NULL, 10) : 0; n > 0; n--)
        skip_resp(b, at);
}

/* Whether the command is for Redis's tools, which expect replies of their own format. */
static bool is_redis_own(const char *name)
{
    static const char *const own[] = {"AUTH",   "CLIENT", "SLOWLOG", "CONFIG",
                                      "EXPIRE", "TTL",    "PERSIST"};
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++)
        if (strcmp(name, own[i]) == 0)
            return true;
    return false;
}

/* Reads one reply of each kind and compares them. */
static void compare_reply(const char *name, const struct bytes *lines, size_t *at,
                          const struct bytes *resp, size_t *resp_at)
{
    struct reply_reader reader = {0};
    struct reply_part part;
    const char *text = "";
    size_t len, total = 0;
    do {
        ptrdiff_t took = reply_read(&reader, lines->v + *at, lines->n - *at, &part);
        CHECK_MSG(took > 0, "%s: no reply in lines", name);
        *at += (size_t)took;
        bool told_apart =
            strcmp(name, "INFO") == 0 || strcmp(name, "HELLO") == 0 || is_redis_own(name);
        if (part.kind == REPLY_ERR && strcmp(name, "INFO") == 0) {
            skip_resp(resp, resp_at); /* Redis knows no wrong section */
        } else if (part.kind == REPLY_ERR) {
            text = take_line(resp, resp_at, &len);
            size_t code = strcspn(part.text + 4, " ");
            /* Redis's libraries look for the words of Redis (PROTOCOL.md, 2.5). */
            bool of_redis = (strncmp(part.text, "ERR UNKNOWN ", 12) == 0 &&
                             strncmp(text, "-ERR unknown command ", 21) == 0) ||
                            (strcmp(name, "HELLO") == 0 && strncmp(text, "-NOPROTO ", 9) == 0) ||
                            (strcmp(name, "AUTH") == 0 && strncmp(text, "-WRONGPASS ", 11) == 0);
            CHECK_MSG(of_redis || (*text == '-' && strncmp(text + 1, part.text + 4, code + 1) == 0),
                      "%s: %.*s", name, (int)len, text);
        } else if (part.kind == REPLY_OK && strcmp(name, "INFO") == 0) {
            text = take_bulk(resp, resp_at, &len);
            CHECK(len > 20 && memchr(text, ':', len) != NULL);
        } else if (part.kind == REPLY_OK && is_redis_own(name)) {
            CHECK_MSG(resp->v[*resp_at] != '-', "%s: %.80s", name, resp->v + *resp_at);
            skip_resp(resp, resp_at);
        } else if (part.kind == REPLY_OK && reader.bytes_left > 0) {
            text = take_bulk(resp, resp_at, &len);
            CHECK(len == reader.bytes_left);
        } else if (part.kind == REPLY_OK) {
            text = take_line(resp, resp_at, &len);
            if (strcmp(name, "PING") == 0)
                CHECK(strncmp(text, "+PONG\r\n", 7) == 0);
            else if (reader.rows_left > 0)
                CHECK(*text == '*' && strtoul(text + 1, NULL, 10) == reader.rows_left);
            else
                CHECK_MSG(strncmp(text, "+OK", 3) == 0 &&
                              same(text + 3, len - 3, part.text + 4, part.len - 4),
                          "%s: %.*s", name, (int)len, text);
        } else if (part.kind == REPLY_ROW && !told_apart) {
            text = take_bulk(resp, resp_at, &len);
            CHECK_MSG(same(text, len, part.text, part.len), "%s: %.*s", name, (int)len, text);
        } else if (part.kind == REPLY_BYTES) {
            CHECK(memcmp(text + total, part.text, part.len) == 0);
            total += part.len;
        }
    } while (!part.last);
}

static void compare_transcript(struct requests *r, int number)
{
    static struct bytes lines, resp;
    size_t at = 0, resp_at = 0;
    for (size_t i = 0; i < r->n; i++)
        if (strstr(r->name[i], "WATCH") != NULL || /* RESP 2 has no events, */
            strcmp(r->name[i], "WAIT") == 0)       /* and its WAIT takes milliseconds */
            return;
    converse(&r->lines, &lines);
    converse(&r->resp, &resp);
    for (size_t i = 0; i < r->n && at < lines.n; i++)
        compare_reply(r->name[i], &lines, &at, &resp, &resp_at);
    CHECK_MSG(at == lines.n && resp_at == resp.n, "PROTOCOL.md:%d: more comes in one framing: %s",
              number, resp.v + resp_at);
}

TEST_TIMEOUT(both_framings_say_the_same, 60)
{
    static struct requests r;
    char line[1024];
    int number = 0, compared = 0;
    bool within = false;
    FILE *f = fopen("proto/PROTOCOL.md", "r");
    CHECK_MSG(f != NULL, "tests run in the root of the repository");
    while (fgets(line, sizeof line, f) != NULL) {
        number++;
        line[strcspn(line, "\n")] = 0;
        if (strcmp(line, "```transcript") == 0) {
            memset(&r, 0, sizeof r);
            within = true;
        } else if (within && strcmp(line, "```") == 0) {
            compare_transcript(&r, number);
            compared++;
            within = false;
        } else if (within && line[0] == '>') {
            append_sent(&r, line);
        }
    }
    fclose(f);
    CHECK(compared > 30);
}
