/* mirror.c - see mirror.h. */
#include "tests/server/watch/mirror.h"

#include "core/delaunay_constraints.h"
#include "tests/test.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { ROW = 8192 };

uint64_t version_in(const char *line)
{
    const char *at = strstr(line, " version=");
    CHECK_MSG(at != NULL, "%s", line);
    return strtoull(at + 9, NULL, 10);
}

uint64_t ask_version(int fd, const char *line)
{
    say(fd, line);
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, "OK", 2) == 0, "%s -> %s", line, got);
    return version_in(got);
}

/* ---- rows ---- */

static void set_row(char **at, const char *row)
{
    free(*at);
    *at = row == NULL ? NULL : strdup(row);
    CHECK(row == NULL || *at != NULL);
}

/* An event names a place once, and a ring once. */
static void name_once(unsigned *last, unsigned event)
{
    CHECK(*last != event);
    *last = event;
}

/* Returns the place of the constraint of `row`, or a free place; the words `a b kind k` identify it. */
static char **place_of(char **rows, const char *row)
{
    char **free_place = NULL;
    size_t key = 0;
    for (int words = 0; row[key] != '\0' && words < 4; key++)
        words += row[key + 1] == ' ' || row[key + 1] == '\0';
    for (unsigned i = 0; i < MIRROR_CONSTRAINTS; i++) {
        const char *at = rows[i];
        if (at == NULL)
            free_place = free_place == NULL ? &rows[i] : free_place;
        else if (strncmp(at, row, key) == 0 && (at[key] == ' ' || at[key] == '\0'))
            return &rows[i];
    }
    CHECK(free_place != NULL);
    return free_place;
}

static void take_row(struct mirror *m, const char *row)
{
    char kind[8], side = 0;
    uint32_t id;
    int after = 0;
    m->rows++;
    if (strncmp(row, "constraint ", 11) == 0 || strncmp(row, "released ", 9) == 0) {
        const char *what = strchr(row, ' ') + 1;
        CHECK(m->options.constraints);
        set_row(place_of(m->constraint, what), row[0] == 'c' ? what : NULL);
        return;
    }
    CHECK(sscanf(row, "%7s %" SCNu32 "%n", kind, &id, &after) == 2 && id < MIRROR_IDS);
    if (strcmp(kind, "list") == 0) {
        char text[ROW];
        CHECK(sscanf(row + after, " %c%n", &side, &after) == 1 && (side == 'i' || side == 'b'));
        const char *ring = strchr(strchr(row + 5, ' ') + 1, ' ');
        snprintf(text, sizeof text, "%" PRIu32 "%s", id, ring == NULL ? "" : ring);
        CHECK(m->point[id] != NULL);
        name_once(&m->ring_event[id], m->events);
        set_row(&m->list[id], text);
        return;
    }
    bool point = strcmp(kind, "point") == 0;
    CHECK_MSG(point || strcmp(kind, "gone") == 0, "%s", row);
    name_once(&m->place_event[id], m->events);
    set_row(&m->point[id], point ? row + strlen("point ") : NULL);
    set_row(&m->list[id], NULL);
}

/* ---- events in RESP 3, as lines ---- */

static const char *hear_resp(int fd)
{
    static char line[ROW];
    snprintf(line, sizeof line, "%s", hear_line(fd));
    line[strcspn(line, "\r")] = '\0';
    return line;
}

static void append(char *text, const char *more, const char *between)
{
    size_t at = strlen(text);
    snprintf(text + at, ROW - at, "%s%s", at > 0 ? between : "", more);
}

/* Reads a value that is no aggregate; `true` adds nothing. */
static void take_word(int fd, char *text, const char *between)
{
    char first;
    CHECK(recv(fd, &first, 1, MSG_PEEK) == 1);
    if (first == '#') {
        expect(fd, "#t\r\n");
        return;
    }
    const char *line = hear_resp(fd);
    line = first == '$' ? hear_resp(fd) : line + 1;
    append(text, first == '_' ? "nan" : line, between);
}

/* Reads the header of an aggregate. */
static unsigned long take_header(int fd, char type)
{
    const char *line = hear_resp(fd);
    CHECK_MSG(line[0] == type, "%s", line);
    return strtoul(line + 1, NULL, 10);
}

/* The first line; returns the number of rows. */
static unsigned long take_push(int fd, char *head)
{
    unsigned long rows = take_header(fd, '>') - 2;
    head[0] = '\0';
    take_word(fd, head, "");
    for (unsigned long n = take_header(fd, '%'); n > 0; n--) {
        take_word(fd, head, " ");
        take_word(fd, head, "=");
    }
    return rows;
}

static unsigned long take_head(const struct mirror *m, char *head)
{
    if (m->options.resp)
        return take_push(m->fd, head);
    snprintf(head, ROW, "%s", hear_line(m->fd));
    CHECK_MSG(strncmp(head, "EVENT ", 6) == 0, "%s", head);
    return strtoul(head + 6, NULL, 10);
}

static void take_row_of(struct mirror *m, char *text)
{
    text[0] = '\0';
    if (!m->options.resp)
        snprintf(text, ROW, "%s", hear_line(m->fd));
    for (unsigned long n = m->options.resp ? take_header(m->fd, '*') : 0; n > 0; n--)
        take_word(m->fd, text, " ");
    take_row(m, text);
}

void mirror_take(struct mirror *m)
{
    static char text[ROW];
    unsigned long n = take_head(m, text);
    const char *version = strstr(text, " version=");
    m->dropped = strstr(text, " dropped") != NULL;
    m->whole = strstr(text, " more") == NULL;
    m->version = version == NULL ? 0 : strtoull(version + 9, NULL, 10);
    bool reset = strstr(text, " reset") != NULL;
    m->resets += reset;
    m->events++;
    for (unsigned i = 0; reset && i < MIRROR_IDS; i++) {
        set_row(&m->point[i], NULL);
        set_row(&m->list[i], NULL);
    }
    for (unsigned i = 0; reset && i < MIRROR_CONSTRAINTS; i++)
        set_row(&m->constraint[i], NULL);
    for (; n > 0; n--)
        take_row_of(m, text);
}

void mirror_catch_up(struct mirror *m, uint64_t version)
{
    while (!m->whole || m->version < version)
        mirror_take(m);
    CHECK(m->version == version);
}

/* ---- connections ---- */

/* Sends the words of the line as RESP. */
static void say_resp(int fd, const char *line)
{
    char text[ROW] = "", words[ROW], *rest = words, *word;
    unsigned n = 0;
    snprintf(words, sizeof words, "%s", line);
    for (; (word = strtok_r(rest, " \n", &rest)) != NULL; n++) {
        size_t at = strlen(text);
        snprintf(text + at, sizeof text - at, "$%zu\r\n%s\r\n", strlen(word), word);
    }
    char request[ROW + 16]; /* sent at once: a second packet would wait for an acknowledgement */
    snprintf(request, sizeof request, "*%u\r\n%s", n, text);
    say(fd, request);
}

void mirror_watch(struct mirror *m, const struct daemon *d, bool since)
{
    const struct mirror_options *o = &m->options;
    char line[ROW] = "WATCH t";
    if (since)
        snprintf(line, sizeof line, "WATCH t SINCE %" PRIu64, m->version);
    if (o->box != NULL) {
        append(line, "WITHIN ", " ");
        append(line, o->box, "");
    }
    if (o->fields != NULL) {
        append(line, "FIELDS ", " ");
        append(line, o->fields, "");
    }
    if (o->constraints)
        append(line, "CONSTRAINTS", " ");
    append(line, "\n", "");
    m->fd = daemon_connect(d);
    m->whole = since;
    if (!o->resp) {
        ask_version(m->fd, line);
        return;
    }
    say_resp(m->fd, "HELLO 3\n");
    while (strcmp(hear_resp(m->fd), "modules") != 0)
        continue;
    CHECK(take_header(m->fd, '*') == 0);
    say_resp(m->fd, line);
    CHECK(take_header(m->fd, '%') == 1);
    for (int i = 0; i < 3; i++)
        hear_line(m->fd);
}

void mirror_disconnect(struct mirror *m)
{
    close(m->fd);
    m->fd = -1;
}

void mirror_free(struct mirror *m)
{
    for (unsigned i = 0; i < MIRROR_IDS; i++) {
        free(m->point[i]);
        free(m->list[i]);
    }
    for (unsigned i = 0; i < MIRROR_CONSTRAINTS; i++)
        free(m->constraint[i]);
    if (m->fd >= 0)
        close(m->fd);
}

/* ---- comparison ---- */

/* The rows of a reply by id; false: there is no such field. */
static bool ask_rows(int fd, const char *command, char **row)
{
    char line[ROW];
    snprintf(line, sizeof line, "%s\n", command);
    say(fd, line);
    const char *head = hear_line(fd);
    if (strncmp(head, "ERR NOFIELD", 11) == 0)
        return false;
    CHECK_MSG(strncmp(head, "OK ", 3) == 0, "%s -> %s", command, head);
    for (unsigned long n = strtoul(head + 3, NULL, 10); n > 0; n--) {
        const char *got = hear_line(fd);
        unsigned long id = strtoul(got, NULL, 10);
        CHECK(id < MIRROR_IDS);
        set_row(&row[id], got);
    }
    return true;
}

/* Compares with the mirror's rows, and frees them. */
static void compare(char **want, char *const *have)
{
    for (unsigned i = 0; i < MIRROR_IDS; i++) {
        CHECK_MSG((want[i] == NULL) == (have[i] == NULL), "%u: %s, not %s", i,
                  have[i] == NULL ? "nothing" : have[i], want[i] == NULL ? "nothing" : want[i]);
        if (want[i] != NULL)
            CHECK_STR(have[i], want[i]);
        set_row(&want[i], NULL);
    }
}

/* Without the field every value is nan. */
static void ask_points(const struct mirror *m, int fd, char **row)
{
    char line[ROW] = "POINTS t";
    if (m->options.fields != NULL) {
        append(line, "FIELDS ", " ");
        append(line, m->options.fields, "");
    }
    if (ask_rows(fd, line, row))
        return;
    CHECK(strchr(m->options.fields, ',') == NULL);
    ask_rows(fd, "POINTS t", row);
    for (unsigned i = 0; i < MIRROR_IDS; i++) {
        if (row[i] == NULL)
            continue;
        snprintf(line, sizeof line, "%s nan", row[i]);
        set_row(&row[i], line);
    }
}

/* Appends the place of an id, as POINTS says it. */
static struct dt_point append_place(char *row, char *const *point, uint32_t id)
{
    struct dt_point p;
    CHECK(point[id] != NULL && sscanf(point[id], "%*u %lf %lf", &p.x, &p.y) == 2);
    append(row, strchr(point[id], ' ') + 1, " ");
    return p;
}

/* Whether the constraint of the row meets the box; appends the places of its ends. */
static bool meets_box(const struct mirror *m, char *const *point, char *row)
{
    struct dt_point lo, hi, at[2];
    uint32_t a, b;
    CHECK(sscanf(m->options.box, "%lf %lf %lf %lf", &lo.x, &lo.y, &hi.x, &hi.y) == 4);
    CHECK(sscanf(row, "%" SCNu32 " %" SCNu32, &a, &b) == 2);
    at[0] = append_place(row, point, a);
    at[1] = append_place(row, point, b);
    struct dt_point low = {lo.x < hi.x ? lo.x : hi.x, lo.y < hi.y ? lo.y : hi.y};
    struct dt_point high = {lo.x < hi.x ? hi.x : lo.x, lo.y < hi.y ? hi.y : lo.y};
    return dt_segment_meets_box(at[0], at[1], low, high);
}

static void check_constraints(struct mirror *m, int fd)
{
    static char *point[MIRROR_IDS];
    char text[ROW];
    unsigned have = 0, want = 0;
    if (m->options.box != NULL)
        ask_rows(fd, "POINTS t", point);
    say(fd, "CONSTRAINTS t\n");
    const char *head = hear_line(fd);
    CHECK_MSG(strncmp(head, "OK ", 3) == 0, "%s", head);
    for (unsigned long n = strtoul(head + 3, NULL, 10); n > 0; n--) {
        snprintf(text, sizeof text, "%s", hear_line(fd));
        if (m->options.box != NULL && !meets_box(m, point, text))
            continue;
        const char *got = *place_of(m->constraint, text);
        CHECK_MSG(got != NULL && strcmp(got, text) == 0, "%s, not %s",
                  got == NULL ? "nothing" : got, text);
        want++;
    }
    for (unsigned i = 0; i < MIRROR_CONSTRAINTS; i++)
        have += m->constraint[i] != NULL;
    CHECK_MSG(have == want, "%u constraints, not %u", have, want);
    for (unsigned i = 0; i < MIRROR_IDS; i++)
        set_row(&point[i], NULL);
}

void mirror_check(struct mirror *m, int fd, bool triangulated)
{
    static char *row[MIRROR_IDS], *within[MIRROR_IDS];
    char line[ROW] = "WITHIN t";
    ask_points(m, fd, row);
    if (m->options.box != NULL) {
        append(line, m->options.box, " ");
        ask_rows(fd, line, within);
        for (unsigned i = 0; i < MIRROR_IDS; i++) {
            if (within[i] == NULL)
                set_row(&row[i], NULL);
            set_row(&within[i], NULL);
        }
    }
    compare(row, m->point);
    snprintf(line, sizeof line, "LISTS t");
    if (m->options.box != NULL) {
        append(line, "WITHIN ", " ");
        append(line, m->options.box, "");
    }
    if (triangulated)
        ask_rows(fd, line, row);
    compare(row, m->list);
    if (m->options.constraints)
        check_constraints(m, fd);
}
