/* power_client.c - see power_client.h. */
#include "tests/server/power/power_client.h"

#include "tests/server/daemon.h"
#include "tests/test.h"

#include <arpa/inet.h>
#include <math.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { LARGE = 33000, GROUND = 9 };

/* ---- changes ---- */

static uint32_t below(struct client *c, uint32_t n)
{
    return chance_below(&c->chance, n);
}

static struct dt_point *places(struct client *c, uint32_t n)
{
    struct dt_point *p = malloc(n * sizeof *p);
    CHECK(p != NULL);
    uint32_t side = n < 100 ? GROUND : 50;
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){below(c, side), below(c, side) + 0.5 * below(c, 2)};
    return p;
}

static struct request_change addition(struct client *c, uint32_t kind)
{
    if (kind < 40)
        return (struct request_change){.kind = REQUEST_ADD, .n = 1 + below(c, 5)};
    if (kind < 44)
        return (struct request_change){.kind = REQUEST_ADD, .n = 100 + below(c, 300)};
    if (kind == 44 && c->work->large)
        return (struct request_change){.kind = REQUEST_LOADB, .n = LARGE + below(c, LARGE)};
    static const enum request_kind load[] = {REQUEST_LOAD, REQUEST_LOAD_TO_DOT, REQUEST_LOADB};
    return (struct request_change){.kind = load[below(c, 3)], .n = 1 + below(c, 60)};
}

static struct request_change change_of_values(struct client *c, const struct stream *s)
{
    uint32_t kind = below(c, 10), field = below(c, CHANGE_FIELDS);
    if (kind == 0)
        return (struct request_change){.kind = REQUEST_FDROP, .field = field};
    bool run = kind < 4;
    struct request_change change = {.kind = run ? REQUEST_FSETB : REQUEST_FSET, .field = field};
    change.n = run ? 1 + below(c, s->ids / 2 + 1) : 1 + below(c, 4);
    for (uint32_t i = 0; i < CHANGE_IDS; i++)
        change.id[i] = below(c, s->ids + 1);
    if (run)
        change.id[0] = below(c, s->ids / 2 + 1);
    change.points = places(c, change.n);
    for (uint32_t i = 0; i < change.n; i++)
        if (below(c, 5) == 0)
            change.points[i].x = (double)NAN;
    return change;
}

/* Short lines, which seldom cross, except lines that are to be split; many are refused. */
static struct request_change change_of_constraints(struct client *c, const struct stream *s)
{
    static const enum request_kind kinds[] = {
        REQUEST_CONSTRAIN, REQUEST_CONSTRAIN, REQUEST_CONSTRAIN, REQUEST_RELEASE,
        REQUEST_CASCADE,   REQUEST_MOVES,     REQUEST_SPLIT};
    struct request_change change = {.kind = kinds[below(c, 7)], .n = 2, .field = below(c, 2)};
    change.id[0] = below(c, s->ids + 1);
    change.id[1] = change.id[0] + 1 + below(c, 3);
    change.id[2] = below(c, s->ids + 1);
    if (change.kind == REQUEST_SPLIT)
        change.id[1] = below(c, s->ids + 1);
    if (change.kind == REQUEST_CONSTRAIN || change.kind == REQUEST_SPLIT)
        change.n += below(c, 2);
    else if (change.kind == REQUEST_RELEASE && below(c, 6) == 0)
        change.n = 0;
    else if (change.kind == REQUEST_MOVES)
        change.points = places(c, change.n);
    return change;
}

/* Few places, so that points coincide; ids mostly of existing points. */
static struct request_change change_own(struct client *c, const struct stream *s)
{
    struct request_change change = {.kind = REQUEST_DROP};
    uint32_t kind = below(c, 100);
    if (below(c, 5) == 0)
        return change_of_values(c, s);
    if (below(c, 5) == 0)
        return change_of_constraints(c, s);
    if (s->ids > LARGE)
        kind += 42; /* a large set is dropped soon */
    if (kind < 54) {
        change = addition(c, kind);
        change.points = places(c, change.n);
        change.fields = below(c, 3) == 0 ? 1 + below(c, CHANGE_FIELDS) : 0;
    } else if (kind < 72) {
        change = (struct request_change){.kind = REQUEST_DELETE, .n = 1 + below(c, 3)};
        for (uint32_t i = 0; i < change.n; i++)
            change.id[i] = below(c, s->ids + 1);
    } else if (kind < 90) {
        change = (struct request_change){.kind = REQUEST_MOVE, .n = 1, .points = places(c, 1)};
        change.id[0] = below(c, s->ids + 2);
    } else if (kind < 95) {
        change = (struct request_change){.kind = REQUEST_TRIANGULATE};
    } else if (kind < 98) {
        change = (struct request_change){.kind = REQUEST_CREATE, .tolerance = 0.75 * below(c, 2)};
    }
    return change;
}

/* Chooses points of the stream whose ids it knows. */
static bool choose_known(struct client *c, const struct stream *s, uint32_t *id)
{
    if (s->known == 0)
        return false;
    *id = below(c, s->known);
    return s->id[*id] != DT_NONE;
}

/* Each point at a place of its own. */
static struct request_change change_shared(struct client *c, const struct stream *s)
{
    struct request_change change = {.kind = REQUEST_TRIANGULATE};
    uint32_t kind = below(c, 100), id = 0;
    if (kind >= 95)
        return change;
    bool known = choose_known(c, s, &id);
    if (known && kind < 20)
        return (struct request_change){.kind = REQUEST_DELETE, .n = 1, .id = {id}};
    bool move = known && kind < 40;
    change = (struct request_change){.kind = move        ? REQUEST_MOVE
                                             : kind < 50 ? REQUEST_LOAD
                                                         : REQUEST_ADD,
                                     .n = move ? 1 : 1 + below(c, 4),
                                     .id = {id}};
    change.points = malloc(change.n * sizeof *change.points);
    CHECK(change.points != NULL);
    for (uint32_t i = 0; i < change.n; i++)
        change.points[i] = (struct dt_point){s->number, ++c->places};
    return change;
}

/* ---- one connection ---- */

/* A socket that is connected to the daemon, and its own port; -1: the daemon has ended. */
static int reach(const struct workload *w, unsigned *port)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_port = htons((in_port_t)w->port)};
    socklen_t n = sizeof at;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    CHECK(fd >= 0);
    if (w->stop || connect(fd, (struct sockaddr *)&at, sizeof at) != 0) {
        close(fd);
        return -1;
    }
    CHECK(getsockname(fd, (struct sockaddr *)&at, &n) == 0);
    *port = ntohs(at.sin_port);
    return fd;
}

static bool client_connect(struct client *c)
{
    unsigned port;
    c->connection = NULL;
    while (c->connection == NULL) {
        c->fd = reach(c->work, &port);
        if (c->fd < 0)
            return false;
        c->connection = history_new_connection(c->work->history, port);
        if (c->connection == NULL)
            close(c->fd);
    }
    c->heard = 0;
    c->from = c->to = 0;
    return true;
}

/* Reads a line; false if the connection is closed. */
static bool hear(struct client *c, char line[REPLY_BYTES])
{
    for (size_t n = 0;;) {
        if (c->from == c->to) {
            ssize_t got = recv(c->fd, c->in, sizeof c->in, 0);
            if (got <= 0)
                return false;
            c->from = 0;
            c->to = (size_t)got;
        }
        char byte = c->in[c->from++];
        c->heard++;
        if (byte == '\n' && n > 0 && line[0] == '#') {
            n = 0; /* a comment */
        } else if (byte == '\n') {
            line[n] = '\0';
            return true;
        } else if (n + 1 < REPLY_BYTES) {
            line[n++] = byte;
        }
    }
}

enum asked_kind { ASKED_CHANGE, ASKED_SNAPSHOT, ASKED_POINT };

struct asked {
    enum asked_kind kind;
    struct stream *stream;
    int index;
};

static void name_shared(struct client *c, char name[32])
{
    snprintf(name, 32, "shared%u", (unsigned)c->work->shared);
}

static struct stream *choose_stream(struct client *c)
{
    char name[32];
    name_shared(c, name);
    if (c->own == NULL)
        c->own = history_new_stream(c->work->history, NULL);
    if (c->shared == NULL)
        c->shared = history_new_stream(c->work->history, name);
    return below(c, 4) == 0 ? c->shared : c->own;
}

static struct asked compose(struct client *c, struct buf *to)
{
    struct asked r = {.kind = ASKED_SNAPSHOT};
    uint32_t ids[CHANGE_IDS], kind = below(c, 60);
    char name[32], text[64];
    if (kind == 0) {
        buf_append_text(to, "SNAPSHOT\n");
        return r;
    }
    if (kind < 8) {
        name_shared(c, name);
        snprintf(text, sizeof text, "GET %s %u\n", name, below(c, 20));
        buf_append_text(to, text);
        r.kind = ASKED_POINT;
        return r;
    }
    r.kind = ASKED_CHANGE;
    r.stream = choose_stream(c);
    struct request_change change =
        r.stream->shared ? change_shared(c, r.stream) : change_own(c, r.stream);
    r.index = stream_add(r.stream, &change);
    for (uint32_t i = 0; r.stream->shared && change.kind >= REQUEST_DELETE && i < change.n; i++)
        ids[i] = r.stream->id[change.id[i]];
    request_change_write(to, r.stream->set, &change, r.stream->shared ? ids : NULL);
    return r;
}

static bool send_all(int fd, const struct buf *b)
{
    const char *bytes = buf_head(b);
    size_t n = buf_len(b);
    while (n > 0) {
        ssize_t sent = send(fd, bytes, n, MSG_NOSIGNAL);
        if (sent <= 0)
            return false;
        bytes += sent;
        n -= (size_t)sent;
    }
    return true;
}

/* Reads the reply; false: the outcome of the request is unknown. */
static bool take_reply(struct client *c, const struct asked *r, bool *refused)
{
    char line[REPLY_BYTES];
    struct dt_point p;
    if (!hear(c, line) || strncmp(line, "ERR IO", 6) == 0)
        return false;
    if (r->kind == ASKED_CHANGE) {
        connection_hear(c->connection, r->stream, r->index, c->heard, line);
        *refused |= r->stream->sent[r->index].refused;
    } else if (r->kind == ASKED_POINT && strcmp(line, "OK 1") == 0) {
        if (!hear(c, line))
            return false;
        CHECK(sscanf(line, "%*u %lf %lf", &p.x, &p.y) == 2);
        connection_see(c->connection, p, c->heard);
    }
    return true;
}

/* Sends several requests and reads their replies. False: the connection cannot be used any more. */
static bool exchange(struct client *c, bool *refused)
{
    struct asked r[BURST];
    struct buf out = {0};
    uint32_t n = 1 + below(c, BURST);
    for (uint32_t i = 0; i < n; i++)
        r[i] = compose(c, &out);
    bool ok = send_all(c->fd, &out);
    buf_free(&out);
    for (uint32_t i = 0; ok && i < n; i++)
        ok = take_reply(c, &r[i], refused);
    return ok;
}

void client_leave_sets(struct client *c)
{
    c->own = c->shared = NULL;
}

static void *talk(void *arg)
{
    struct client *c = arg;
    for (; client_connect(c); client_leave_sets(c)) {
        bool refused = false;
        while (exchange(c, &refused)) {
            if (below(c, 40) == 0)
                c->work->shared++;
            if (refused || below(c, 20) == 0)
                c->shared = NULL; /* a new one; after a refusal points would have other ids */
            pause_ms(refused ? 5 : below(c, 8) == 0);
            refused = false;
        }
        close(c->fd);
    }
    return NULL;
}

void client_start(struct client *c, struct workload *w, uint64_t seed)
{
    c->work = w;
    c->chance = (struct chance){seed};
    CHECK(pthread_create(&c->thread, NULL, talk, c) == 0);
}

void client_join(struct client *c)
{
    CHECK(pthread_join(c->thread, NULL) == 0);
}
