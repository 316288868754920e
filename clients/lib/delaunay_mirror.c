/* delaunay_mirror.c - a mirror's connection: it is made again when it is lost, and WATCH ... SINCE continues where the copy is.
 *
 * Attempts to connect follow at growing intervals, until an event has arrived. An event of which a part is missing when the
 * connection is lost is forgotten: SINCE names the last whole one. */
#include "clients/lib/delaunay_mirror.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#include "clients/lib/mirror_copy.h"
#include "proto/request.h"

#define REPLY_MS 10000 /* to connect, and for the replies to AUTH and WATCH */
#define FIRST_DELAY_MS 50
#define LONGEST_DELAY_MS 5000
#define WORDS_MAX 4400 /* bytes of WITHIN and FIELDS */

struct delaunay_mirror {
    char *host, *port, *set, *token; /* own */
    char words[WORDS_MAX];           /* after the version in WATCH */
    struct delaunay_client *c;       /* owns; NULL: no connection */
    enum delaunay_result why;        /* why not */
    int64_t next_try;                /* ms of the monotonic clock */
    int delay_ms;                    /* after the next failure */
    struct copy copy;
    uint64_t version; /* of the copy */
    /* The event that is being read: */
    uint64_t event_version;
    bool more, begun; /* begun: its first part has been read */
    bool dropped;
};

static int64_t now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

/* ---- connecting ---- */

static void lose(struct delaunay_mirror *m, enum delaunay_result why)
{
    delaunay_close(m->c);
    m->c = NULL;
    m->why = why;
    m->begun = false;
    copy_forget(&m->copy);
    m->next_try = now_ms() + m->delay_ms;
    m->delay_ms = m->delay_ms == 0 ? FIRST_DELAY_MS : 2 * m->delay_ms;
    if (m->delay_ms > LONGEST_DELAY_MS)
        m->delay_ms = LONGEST_DELAY_MS;
}

static enum delaunay_result watch(struct delaunay_mirror *m, struct delaunay_client *c)
{
    char line[WORDS_MAX + 200];
    enum delaunay_result r = m->token != NULL ? delaunay_authenticate(c, m->token) : DELAUNAY_OK;
    int len = snprintf(line, sizeof line, "WATCH %s", m->set);
    if (m->version > 0)
        len += snprintf(line + len, sizeof line - (size_t)len, " SINCE %llu",
                        (unsigned long long)m->version);
    snprintf(line + len, sizeof line - (size_t)len, "%s CONSTRAINTS", m->words);
    delaunay_expect_events(c);
    if (r == DELAUNAY_OK)
        r = delaunay_request(c, line, NULL, NULL);
    return r == DELAUNAY_TIMEOUT ? DELAUNAY_LOST : r;
}

/* Why the last request failed. */
static void explain(const struct delaunay_client *c, enum delaunay_result r, char *why, size_t room)
{
    const struct delaunay_part *status = delaunay_status(c);
    if (r == DELAUNAY_REFUSED)
        snprintf(why, room, "%.*s", (int)status->len, status->text);
    else
        snprintf(why, room, "%s", delaunay_result_text(r));
}

/* Connects and asks for events; sets m->c, or m->why and a sentence in why[room]. */
static void begin(struct delaunay_mirror *m, char *why, size_t room)
{
    struct delaunay_client *c = delaunay_connect_within(m->host, m->port, REPLY_MS, why, room);
    if (c == NULL) {
        lose(m, DELAUNAY_LOST);
        return;
    }
    enum delaunay_result r = watch(m, c);
    if (r == DELAUNAY_OK) {
        m->c = c;
        m->why = r;
        setsockopt(delaunay_descriptor(c), SOL_SOCKET, SO_KEEPALIVE, &(int){1}, sizeof(int));
        return;
    }
    explain(c, r, why, room);
    if (r == DELAUNAY_REFUSED && strncmp(delaunay_status(c)->text, "ERR NOSET ", 10) == 0)
        m->dropped = true;
    delaunay_close(c);
    lose(m, r);
}

/* ---- opening and closing ---- */

static bool is_word(const char *text)
{
    return text[0] != '\0' && strpbrk(text, " \t\r\n") == NULL;
}

static bool write_options(struct delaunay_mirror *m, const struct delaunay_mirror_options *o)
{
    int len = 0;
    if (o->within != NULL)
        len = snprintf(m->words, WORDS_MAX, " WITHIN %.17g %.17g %.17g %.17g", o->within[0],
                       o->within[1], o->within[2], o->within[3]);
    if (o->token != NULL && (!is_word(o->token) || (m->token = strdup(o->token)) == NULL))
        return false;
    if (o->fields == NULL || o->fields[0] == '\0')
        return true;
    m->copy.fields = 1;
    for (const char *p = o->fields; *p != '\0'; p++)
        m->copy.fields += *p == ',';
    size_t room = WORDS_MAX - (size_t)len;
    return is_word(o->fields) &&
           (size_t)snprintf(m->words + len, room, " FIELDS %s", o->fields) < room;
}

static struct delaunay_mirror *make(const char *host, const char *port, const char *set,
                                    const struct delaunay_mirror_options *options)
{
    struct delaunay_mirror *m = calloc(1, sizeof *m);
    if (m == NULL)
        return NULL;
    m->host = strdup(host);
    m->port = strdup(port != NULL ? port : "");
    m->set = strdup(set);
    if (m->host != NULL && m->port != NULL && m->set != NULL &&
        (options == NULL || write_options(m, options)))
        return m;
    delaunay_mirror_close(m);
    return NULL;
}

struct delaunay_mirror *delaunay_mirror_open(const char *host, const char *port, const char *set,
                                             const struct delaunay_mirror_options *options,
                                             char *why, size_t room)
{
    if (!word_is_set_name(&(struct word){set, strlen(set)})) {
        snprintf(why, room, "%s", delaunay_result_text(DELAUNAY_BADNAME));
        return NULL;
    }
    struct delaunay_mirror *m = make(host, port, set, options);
    if (m == NULL) {
        snprintf(why, room, "not a token, not names of fields, or out of memory");
        return NULL;
    }
    begin(m, why, room);
    if (m->c != NULL)
        return m;
    delaunay_mirror_close(m);
    return NULL;
}

void delaunay_mirror_close(struct delaunay_mirror *m)
{
    if (m == NULL)
        return;
    delaunay_close(m->c);
    copy_free(&m->copy);
    free(m->host);
    free(m->port);
    free(m->set);
    free(m->token);
    free(m);
}

/* ---- events ---- */

/* Whether a word of an event's first line is this. */
static bool has_word(const struct delaunay_part *part, const char *word)
{
    size_t n = strlen(word);
    for (size_t i = 1; i + n <= part->len; i++) {
        if (part->text[i - 1] == ' ' && memcmp(part->text + i, word, n) == 0 &&
            (i + n == part->len || part->text[i + n] == ' '))
            return true;
    }
    return false;
}

static enum delaunay_result read_event(struct delaunay_mirror *m, const struct delaunay_part *part)
{
    m->dropped = has_word(part, "dropped");
    m->more = has_word(part, "more");
    m->begun = true;
    if (has_word(part, "reset"))
        copy_reset(&m->copy);
    if (m->dropped || delaunay_key_number(part, "version", &m->event_version))
        return DELAUNAY_OK;
    return DELAUNAY_BROKEN;
}

/* Called with every part of an event. */
static bool take(void *ctx, const struct delaunay_part *part)
{
    struct delaunay_mirror *m = ctx;
    if (part->kind == DELAUNAY_PART_EVENT)
        m->why = read_event(m, part);
    else if (part->kind == DELAUNAY_PART_ROW && m->begun)
        m->why = copy_row(&m->copy, part->text, part->len);
    else
        m->why = DELAUNAY_BROKEN;
    return m->why == DELAUNAY_OK;
}

/* The ms until a time, as poll() expects them; -1: no limit. */
static int left(int64_t deadline)
{
    int64_t ms = deadline < 0 ? -1 : deadline - now_ms();
    return deadline >= 0 && ms < 0 ? 0 : ms > INT32_MAX ? INT32_MAX : (int)ms;
}

/* Waits for the next attempt to connect, and makes it; false if the deadline comes first. */
static bool reconnect(struct delaunay_mirror *m, int64_t deadline)
{
    char why[200];
    int64_t wait = m->next_try - now_ms();
    int limit = left(deadline);
    if (wait > 0 && limit >= 0 && wait > limit) {
        poll(NULL, 0, limit);
        return false;
    }
    if (wait > 0)
        poll(NULL, 0, (int)wait);
    begin(m, why, sizeof why);
    return m->c != NULL || m->dropped || left(deadline) != 0;
}

/* The event is whole. */
static enum delaunay_result finish(struct delaunay_mirror *m, struct delaunay_change *change)
{
    enum delaunay_result r = copy_commit(&m->copy, change);
    if (r != DELAUNAY_OK) {
        lose(m, r);
        return r;
    }
    m->begun = false;
    m->delay_ms = 0;
    m->version = change->version = m->event_version;
    return DELAUNAY_OK;
}

enum delaunay_result delaunay_mirror_next(struct delaunay_mirror *m, int timeout_ms,
                                          struct delaunay_change *change)
{
    int64_t deadline = timeout_ms < 0 ? -1 : now_ms() + timeout_ms;
    for (;;) {
        bool last = false;
        if (m->dropped)
            return DELAUNAY_DROPPED;
        if (m->c == NULL && !reconnect(m, deadline))
            return m->why;
        if (m->c == NULL)
            continue;
        enum delaunay_result r = delaunay_receive_part(m->c, left(deadline), take, m, &last);
        if (r == DELAUNAY_TIMEOUT)
            return r;
        if (r == DELAUNAY_OK && last && !m->more && !m->dropped)
            return finish(m, change);
        if (r != DELAUNAY_OK)
            lose(m, r == DELAUNAY_STOPPED ? m->why : r);
        if (m->why == DELAUNAY_NOMEM)
            return DELAUNAY_NOMEM;
    }
}

/* ---- the copy ---- */

int delaunay_mirror_descriptor(const struct delaunay_mirror *m)
{
    return m->c != NULL ? delaunay_descriptor(m->c) : -1;
}

uint64_t delaunay_mirror_version(const struct delaunay_mirror *m)
{
    return m->version;
}

size_t delaunay_mirror_points(const struct delaunay_mirror *m)
{
    return m->copy.points;
}

uint32_t delaunay_mirror_ids(const struct delaunay_mirror *m)
{
    return m->copy.ids;
}

bool delaunay_mirror_point(const struct delaunay_mirror *m, uint32_t id, double *xy, double *value)
{
    const struct copy_place *p = copy_place(&m->copy, id);
    if (p == NULL)
        return false;
    xy[0] = p->x;
    xy[1] = p->y;
    for (unsigned k = 0; value != NULL && k < m->copy.fields; k++)
        value[k] = m->copy.value[(size_t)id * m->copy.fields + k];
    return true;
}

size_t delaunay_mirror_ring(const struct delaunay_mirror *m, uint32_t id, const uint32_t **ring,
                            bool *interior)
{
    const struct copy_place *p = copy_place(&m->copy, id);
    if (p == NULL || !p->ringed)
        return 0;
    *ring = m->copy.rings.at + p->ring;
    *interior = p->inner;
    return p->len;
}

enum delaunay_result delaunay_mirror_constraints(struct delaunay_mirror *m,
                                                 const struct delaunay_segment **rows, size_t *n)
{
    constraints_sort(&m->copy.constraints);
    *rows = m->copy.constraints.rows.at;
    *n = m->copy.constraints.rows.n;
    return DELAUNAY_OK;
}
