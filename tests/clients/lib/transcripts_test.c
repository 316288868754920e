/* transcripts_test.c - proto/PROTOCOL.md is correct: its transcripts are replayed with a real daemon, and it
 * leaves out no command and no error. Its section 9 describes the format of the transcripts. */
#include <ctype.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "proto/reply.h"
#include "proto/reply_read.h"
#include "tests/daemon.h"
#include "tests/test.h"

static char *read_document(void)
{
    FILE *f = fopen("proto/PROTOCOL.md", "r");
    CHECK_MSG(f != NULL, "tests run in the root of the repository");
    char *text = calloc(1, 1 << 20);
    CHECK(fread(text, 1, (1 << 20) - 1, f) > 0);
    fclose(f);
    return text;
}

/* ---- the document, line by line ---- */

struct script {
    char *text, *next; /* owns text, a copy of the document */
    int number;        /* of the line that was read last */
};

/* The next line, NULL at the end. */
static char *next_line(struct script *s)
{
    char *line = s->next;
    if (line == NULL || *line == 0)
        return NULL;
    char *lf = strchr(line, '\n');
    if (lf != NULL)
        *lf = 0;
    s->next = lf != NULL ? lf + 1 : NULL;
    s->number++;
    return line;
}

/* ---- the conversation ---- */

struct talk {
    int fd;
    struct reply_reader reader;
    char in[1 << 16];
    size_t have;
    bool mid_reply; /* rows of the last reply are still to be read */
};

/* Converts a text of hexadecimal digits and blanks to bytes; returns how many. */
static size_t from_hex(const char *hex, unsigned char *bytes, size_t room)
{
    size_t n = 0;
    unsigned byte;
    for (; *hex != 0; hex += 2) {
        while (*hex == ' ')
            hex++;
        CHECK_MSG(n < room && sscanf(hex, "%2x", &byte) == 1 && hex[1] != 0, "not hexadecimal: %s",
                  hex);
        bytes[n++] = (unsigned char)byte;
    }
    return n;
}

/* Appends the bytes that a line `>...` sends to out. */
static size_t compose(const char *line, char *out, size_t room)
{
    if (line[1] == 'x')
        return from_hex(line + 2, (unsigned char *)out, room);
    int n = snprintf(out, room, "%s\n", line[1] == ' ' ? line + 2 : line + 1);
    CHECK(n > 0 && (size_t)n < room);
    return (size_t)n;
}

/* Reads the next part of a reply, comments left out; false if the server has closed the
 * connection. */
static bool hear(struct talk *t, struct reply_part *part, char *text, size_t room)
{
    for (;;) {
        ptrdiff_t used = reply_read(&t->reader, t->in, t->have, part);
        CHECK_MSG(used >= 0, "%s", t->reader.fault);
        if (used > 0) {
            CHECK(part->len < room);
            memcpy(text, part->text, part->len);
            text[part->len] = 0;
            memmove(t->in, t->in + used, t->have - (size_t)used);
            t->have -= (size_t)used;
            part->text = text;
            if (part->kind == REPLY_COMMENT)
                continue;
            t->mid_reply = !part->last;
            return true;
        }
        struct pollfd p = {t->fd, POLLIN, 0};
        CHECK_MSG(poll(&p, 1, 5000) == 1, "no answer");
        ssize_t n = read(t->fd, t->in + t->have, sizeof t->in - t->have);
        if (n <= 0)
            return false;
        t->have += (size_t)n;
    }
}

/* Whether text matches the pattern, in which '*' stands for any characters except blanks. */
static bool matches(const char *pattern, const char *text)
{
    for (; *pattern != '*'; pattern++, text++) {
        if (*pattern != *text)
            return false;
        if (*pattern == 0)
            return true;
    }
    for (;; text++) {
        if (matches(pattern + 1, text))
            return true;
        if (*text == 0 || *text == ' ')
            return false;
    }
}

static void expect_bytes(struct talk *t, const char *hex, int number)
{
    unsigned char want[4096];
    char got[1 << 16];
    struct reply_part part;
    size_t n = from_hex(hex, want, sizeof want), have = 0;
    while (have < n) {
        CHECK_MSG(hear(t, &part, got, sizeof got), "PROTOCOL.md:%d: the connection was closed",
                  number);
        CHECK_MSG(part.kind == REPLY_BYTES, "PROTOCOL.md:%d: got %s", number, got);
        /* the bytes that belong to the next line of the transcript are kept */
        size_t take = part.len < n - have ? part.len : n - have, rest = part.len - take;
        memmove(t->in + rest, t->in, t->have);
        memcpy(t->in, got + take, rest);
        t->have += rest;
        t->reader.bytes_left += rest;
        t->mid_reply = t->reader.bytes_left > 0;
        CHECK_MSG(memcmp(got, want + have, take) == 0, "PROTOCOL.md:%d: other bytes", number);
        have += take;
    }
}

static void expect_line(struct talk *t, const char *pattern, int number)
{
    char got[1 << 16];
    struct reply_part part;
    CHECK_MSG(hear(t, &part, got, sizeof got), "PROTOCOL.md:%d: the connection was closed", number);
    if (strstr(pattern, " version=") == NULL)
        test_drop_versions(got);
    CHECK_MSG(part.kind != REPLY_BYTES && matches(pattern, got),
              "PROTOCOL.md:%d: got\n    %s\nnot %s", number, got, pattern);
}

static void expect(struct talk *t, const char *line, int number)
{
    char got[1 << 16];
    struct reply_part part;
    if (strncmp(line, "<x", 2) == 0)
        expect_bytes(t, line + 2, number);
    else if (strcmp(line, "...") != 0)
        expect_line(t, line, number);
    else
        while (t->mid_reply)
            CHECK(hear(t, &part, got, sizeof got));
}

/* Sends; the server may have closed its end already, as after QUIT. */
static void say(struct talk *t, const char *bytes, size_t n)
{
    if (n > 0)
        CHECK(send(t->fd, bytes, n, MSG_NOSIGNAL) == (ssize_t)n);
}

/* Replays the transcript that starts at the next line of s. */
static void replay(struct script *s)
{
    static struct talk t;
    char out[1 << 16], *line;
    size_t queued = 0;
    struct reply_part part;
    struct daemon d = daemon_start(NULL);
    t = (struct talk){.fd = daemon_connect(&d), .reader.events = true};
    while ((line = next_line(s)) != NULL && strcmp(line, "```") != 0) {
        if (line[0] == '>') {
            CHECK_MSG(!t.mid_reply, "PROTOCOL.md:%d: the reply before has more lines", s->number);
            queued += compose(line, out + queued, sizeof out - queued);
            continue;
        }
        say(&t, out, queued);
        queued = 0;
        expect(&t, line, s->number);
    }
    CHECK_MSG(queued == 0 && !t.mid_reply, "PROTOCOL.md:%d: the transcript ends too early",
              s->number);
    shutdown(t.fd, SHUT_WR);
    CHECK_MSG(!hear(&t, &part, out, sizeof out) && t.have == 0, "PROTOCOL.md:%d: more comes: %s",
              s->number, out);
    close(t.fd);
    daemon_end(&d);
}

TEST_TIMEOUT(protocol_transcripts_match_a_real_daemon, 60)
{
    char *document = read_document(), *line;
    struct script s = {document, document, 0};
    int replayed = 0;
    while ((line = next_line(&s)) != NULL)
        if (strcmp(line, "```transcript") == 0) {
            replay(&s);
            replayed++;
        }
    CHECK(replayed > 30);
    free(document);
}

/* ---- completeness ---- */

/* Where the section `### COMMAND...` of a command starts, from `from` on; NULL if there is none. */
static const char *find_section(const char *from, const char *command)
{
    char heading[100];
    size_t n = (size_t)snprintf(heading, sizeof heading, "\n### %s", command);
    while ((from = strstr(from, heading)) != NULL && isalnum((unsigned char)from[n]))
        from++;
    return from;
}

/* Whether some section of the command, or one that follows it without a transcript between, shows
 * the command. */
static bool has_transcript(const char *document, const char *command)
{
    char request[100];
    snprintf(request, sizeof request, "\n> %s", command);
    const char *start = find_section(document, command);
    const char *block = start != NULL ? strstr(start, "\n```transcript") : NULL;
    const char *end = block != NULL ? strstr(block, "\n```\n") : NULL;
    const char *shown = block != NULL ? strstr(block, request) : NULL;
    return shown != NULL && shown < end;
}

TEST(protocol_has_a_section_and_a_transcript_for_every_command)
{
    char *document = read_document(), row[4096], command[32];
    struct daemon d = daemon_start(NULL);
    static struct talk t;
    struct reply_part part;
    int commands = 0;
    t = (struct talk){.fd = daemon_connect(&d)};
    say(&t, "HELP\n", 5);
    CHECK(hear(&t, &part, row, sizeof row) && part.kind == REPLY_OK);
    while (t.mid_reply) {
        CHECK(hear(&t, &part, row, sizeof row) && sscanf(row, "%31s", command) == 1);
        CHECK_MSG(find_section(document, command) != NULL, "no section about %s", command);
        CHECK_MSG(has_transcript(document, command), "no transcript of %s", command);
        commands++;
    }
    CHECK(commands >= 25);
    close(t.fd);
    daemon_end(&d);
    free(document);
}

/* The reverse: every described command exists. */
TEST(protocol_describes_no_command_that_does_not_exist)
{
    char *document = read_document(), request[64], command[32], got[4096];
    struct daemon d = daemon_start(NULL);
    static struct talk t;
    struct reply_part part;
    t = (struct talk){.fd = daemon_connect(&d)};
    for (const char *p = document; (p = strstr(p, "\n### ")) != NULL; p++) {
        CHECK(sscanf(p, "\n### %31s", command) == 1);
        if (!isupper((unsigned char)command[0]))
            continue;
        say(&t, request, (size_t)snprintf(request, sizeof request, "HELP %s\n", command));
        CHECK(hear(&t, &part, got, sizeof got));
        CHECK_MSG(part.kind == REPLY_OK, "%s: %s", command, got);
        CHECK(hear(&t, &part, got, sizeof got) && part.last);
    }
    close(t.fd);
    daemon_end(&d);
    free(document);
}

TEST(protocol_explains_every_error_code)
{
    char *document = read_document(), cell[64];
    for (enum reply_code code = ERR_SYNTAX; code <= ERR_CORRUPT; code++) {
        snprintf(cell, sizeof cell, "\n| `%s` |", reply_code_name(code));
        CHECK_MSG(strstr(document, cell) != NULL, "%s is not explained", reply_code_name(code));
    }
    free(document);
}
