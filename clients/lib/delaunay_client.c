/* delaunay_client.c - the client library: one socket, a queue each way, and poll to serve both.
 *
 * The socket does not block; pump() waits until it can send or receive anything and does so. So a server that
 * stops reading because its replies are not read causes no deadlock: while requests wait to be sent, replies
 * are received into a queue.
 *
 * When sending fails, the server has disconnected, but its last replies may still be readable: the queue is
 * discarded and reading continues until the end of the input. */
#include "clients/lib/delaunay_client.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clients/lib/bytes.h"
#include "clients/lib/connect.h"
#include "proto/buf.h"
#include "proto/reply_read.h"
#include "proto/request.h"

#define SEND_AT (64 * 1024)    /* queued bytes that are worth a system call */
#define READ_ROOM (256 * 1024) /* bytes asked for at once */
#define FIELD_LIST_MAX 4200    /* 64 names of 64 bytes */
#define POINTS_AT_ONCE 4096

struct delaunay_client {
    int fd;
    int timeout_ms;     /* the longest time without any progress; -1: no limit */
    bool mute, ended;   /* the server takes, or sends, nothing more */
    struct buf out, in; /* own; requests not yet sent, replies not yet taken */
    struct reply_reader reader;
    struct buf status_text; /* owns the last status line */
    struct delaunay_part status;
};

const char *delaunay_result_text(enum delaunay_result r)
{
    static const char *const text[] = {
        "done",
        "the server refused the request",
        "a set's name is 1 to 64 of the characters A-Z a-z 0-9 _ . : -",
        "the connection was lost",
        "the server's answer is not of this protocol",
        "out of memory",
        "stopped",
        "nothing has arrived in time",
        "the set has been dropped",
        "a request is one line, not blank, not a comment, and without a body; nothing was sent",
    };
    size_t i = (size_t)r; /* a caller may have any number in an enum */
    return i < sizeof text / sizeof text[0] ? text[i] : "not a result of this library";
}

/* ---- connecting ---- */

/* Copies a text that fits; otherwise false, with a sentence in why[room]. */
static bool take_text(char *to, size_t limit, const char *from, char *why, size_t room)
{
    bool fits = strlen(from) < limit;
    snprintf(to, limit, "%s", fits ? from : "");
    if (!fits)
        snprintf(why, room, "too long: %s", from);
    return fits;
}

static bool read_where(const char *host, const char *port, struct url *where, char *why,
                       size_t room)
{
    if (!url_is(host)) {
        *where = (struct url){.host = ""};
        return take_text(where->host, sizeof where->host, host, why, room) &&
               (strchr(host, '/') != NULL || /* the path of a socket, which has no port */
                take_text(where->port, sizeof where->port, port, why, room));
    }
    if (url_read(host, where))
        return true;
    snprintf(why, room, "not delaunay://[:token@]host[:port] or unix://[:token@]/path: %s", host);
    return false;
}

static struct delaunay_client *client_new(int fd, int timeout_ms)
{
    struct delaunay_client *c = calloc(1, sizeof *c);
    if (c == NULL) {
        close(fd);
        return NULL;
    }
    c->fd = fd;
    c->timeout_ms = timeout_ms;
    c->status.text = "";
    return c;
}

struct delaunay_client *delaunay_connect_within(const char *host, const char *port, int timeout_ms,
                                                char *why, size_t room)
{
    struct url where;
    int fd = read_where(host, port, &where, why, room)
                 ? connect_socket(&where, timeout_ms, why, room)
                 : -1;
    if (fd < 0)
        return NULL;
    struct delaunay_client *c = client_new(fd, timeout_ms);
    enum delaunay_result r = c == NULL                ? DELAUNAY_NOMEM
                             : where.token[0] == '\0' ? DELAUNAY_OK
                                                      : delaunay_authenticate(c, where.token);
    if (r == DELAUNAY_OK)
        return c;
    snprintf(why, room, "%s", r == DELAUNAY_REFUSED ? c->status.text : delaunay_result_text(r));
    delaunay_close(c);
    return NULL;
}

struct delaunay_client *delaunay_connect(const char *host, const char *port, char *why, size_t room)
{
    return delaunay_connect_within(host, port, -1, why, room);
}

void delaunay_set_timeout(struct delaunay_client *c, int timeout_ms)
{
    c->timeout_ms = timeout_ms;
}

enum delaunay_result delaunay_authenticate(struct delaunay_client *c, const char *token)
{
    char line[300];
    if (token[0] == '\0' || strpbrk(token, " \t\r\n") != NULL ||
        (size_t)snprintf(line, sizeof line, "AUTH %s", token) >= sizeof line)
        return DELAUNAY_BADREQUEST;
    return delaunay_request(c, line, NULL, NULL);
}

void delaunay_close(struct delaunay_client *c)
{
    if (c == NULL)
        return;
    close(c->fd);
    buf_free(&c->out);
    buf_free(&c->in);
    buf_free(&c->status_text);
    free(c);
}

/* ---- moving bytes ---- */

static bool would_block(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

static void send_some(struct delaunay_client *c)
{
    ssize_t n = send(c->fd, buf_head(&c->out), buf_len(&c->out), MSG_NOSIGNAL);
    if (n >= 0) {
        buf_consume(&c->out, (size_t)n);
    } else if (!would_block()) {
        c->mute = true;
        buf_consume(&c->out, buf_len(&c->out));
    }
}

static void receive_some(struct delaunay_client *c)
{
    char *room = buf_reserve(&c->in, READ_ROOM);
    if (room == NULL)
        return;
    ssize_t n = recv(c->fd, room, READ_ROOM, 0);
    if (n > 0)
        buf_commit(&c->in, (size_t)n);
    else if (n == 0 || !would_block())
        c->ended = true;
}

/* Waits until something can be sent or received, and does it; at most timeout_ms, -1: no limit. */
static enum delaunay_result pump(struct delaunay_client *c, int timeout_ms)
{
    bool sending = buf_len(&c->out) > 0;
    struct pollfd p = {c->fd, (short)((c->ended ? 0 : POLLIN) | (sending ? POLLOUT : 0)), 0};
    int ready = poll(&p, 1, timeout_ms);
    if (ready < 0 && errno != EINTR)
        return DELAUNAY_LOST;
    if (ready == 0)
        return DELAUNAY_TIMEOUT;
    if (!c->ended && (p.revents & (POLLIN | POLLHUP | POLLERR)) != 0)
        receive_some(c);
    if (sending && (p.revents & (POLLOUT | POLLHUP | POLLERR)) != 0)
        send_some(c);
    return c->in.failed ? DELAUNAY_NOMEM : DELAUNAY_OK;
}

/* Sends until at most `left` bytes are queued. */
static enum delaunay_result drain(struct delaunay_client *c, size_t left)
{
    enum delaunay_result r = c->out.failed ? DELAUNAY_NOMEM : DELAUNAY_OK;
    while (r == DELAUNAY_OK && buf_len(&c->out) > left)
        r = pump(c, c->timeout_ms);
    return r;
}

/* ---- requests ---- */

/* Appends to the queue, unless the server has disconnected. */
static void queue(struct delaunay_client *c, const void *bytes, size_t n)
{
    if (!c->mute)
        buf_append(&c->out, bytes, n);
}

/* Words of `size` bytes, which travel little-endian. */
static void queue_words(struct delaunay_client *c, const void *words, size_t n, size_t size)
{
    const char *word = words;
    char turned[sizeof(double)];
    if (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__) {
        queue(c, words, n * size);
        return;
    }
    for (const char *end = word + n * size; word < end; word += size) {
        for (size_t i = 0; i < size; i++)
            turned[i] = word[size - 1 - i];
        queue(c, turned, size);
    }
}

static void queue_doubles(struct delaunay_client *c, const double *v, size_t n)
{
    queue_words(c, v, n, sizeof *v);
}

static void queue_ids(struct delaunay_client *c, const uint32_t *v, size_t n)
{
    queue_words(c, v, n, sizeof *v);
}

/* The length without the line's own end. */
static size_t without_end(const char *line, size_t len)
{
    len -= len > 0 && line[len - 1] == '\n';
    return len - (len > 0 && line[len - 1] == '\r');
}

enum delaunay_result delaunay_send(struct delaunay_client *c, const char *line, size_t len)
{
    len = without_end(line, len);
    if (memchr(line, '\n', len) != NULL || memchr(line, '\0', len) != NULL)
        return DELAUNAY_BADREQUEST;
    queue(c, line, len);
    queue(c, "\n", 1);
    return drain(c, SEND_AT);
}

/* The bytes after a request line: the points, and k values for each of them; then constraints, each as long as a point. Or pairs of ids. */
struct body {
    const double *xy, *value; /* borrow 2 n, k n */
    size_t n, k;
    const uint32_t *constraint; /* borrows 4 m */
    size_t m;
    const uint32_t *pair; /* borrows 2 n */
};

static void queue_rows(struct delaunay_client *c, const struct body *b, size_t from, size_t n)
{
    if (b->k == 0)
        queue_doubles(c, b->xy + 2 * from, 2 * n);
    for (size_t i = from; b->k > 0 && i < from + n; i++) {
        queue_doubles(c, b->xy + 2 * i, 2);
        queue_doubles(c, b->value + b->k * i, b->k);
    }
}

static void queue_constraints(struct delaunay_client *c, const struct body *b, size_t from,
                              size_t n)
{
    const double none = 0;
    if (b->k == 0)
        queue_ids(c, b->constraint + 4 * from, 4 * n);
    for (size_t i = from; b->k > 0 && i < from + n; i++) {
        queue_ids(c, b->constraint + 4 * i, 4);
        for (size_t k = 0; k < b->k; k++)
            queue_doubles(c, &none, 1);
    }
}

static void queue_pairs(struct delaunay_client *c, const struct body *b, size_t from, size_t n)
{
    queue_ids(c, b->pair + 2 * from, 2 * n);
}

/* Rows of a body that follow each other: points, constraints, or pairs. */
typedef void queue_rows_fn(struct delaunay_client *c, const struct body *b, size_t from, size_t n);

/* A request or reply of which only a part has passed cannot be continued: the connection ends. */
static enum delaunay_result give_up(struct delaunay_client *c, enum delaunay_result r)
{
    c->mute = c->ended = true;
    buf_consume(&c->out, buf_len(&c->out));
    buf_consume(&c->in, buf_len(&c->in));
    return r;
}

static enum delaunay_result send_rows(struct delaunay_client *c, const struct body *b,
                                      queue_rows_fn *queue_some, size_t n,
                                      delaunay_progress_fn *progress, void *ctx)
{
    enum delaunay_result r = DELAUNAY_OK;
    for (size_t done = 0; r == DELAUNAY_OK && done < n && !c->mute;) {
        size_t some = n - done < POINTS_AT_ONCE ? n - done : POINTS_AT_ONCE;
        queue_some(c, b, done, some);
        r = drain(c, SEND_AT);
        done += some;
        if (progress != NULL)
            progress(ctx, done, n);
    }
    return r;
}

/* Sends `command set n rest`, and the rows after it. */
static enum delaunay_result send_body(struct delaunay_client *c, const char *command,
                                      const char *set, const char *rest, const struct body *b,
                                      delaunay_progress_fn *progress, void *ctx)
{
    char head[FIELD_LIST_MAX + 128];
    if (!word_is_set_name(
            &(struct word){set, strlen(set)})) /* else the points could be read as requests */
        return DELAUNAY_BADNAME;
    int len = snprintf(head, sizeof head, "%s %s %zu%s", command, set, b->n, rest);
    enum delaunay_result r = delaunay_send(c, head, (size_t)len);
    if (r == DELAUNAY_OK)
        r = send_rows(c, b, queue_rows, b->n, progress, ctx);
    if (r == DELAUNAY_OK)
        r = send_rows(c, b, queue_constraints, b->m, NULL, NULL);
    return r == DELAUNAY_OK ? r : give_up(c, r);
}

/* The number of names in a list with commas between; 0 if one is not the name of a field, or the list is too long. */
static size_t count_fields(const char *list)
{
    size_t n = 0;
    if (strlen(list) > FIELD_LIST_MAX)
        return 0;
    for (const char *at = list;; n++) {
        struct word name = {at, strcspn(at, ",")};
        if (!word_is_field_name(&name))
            return 0;
        at += name.len;
        if (*at++ == '\0')
            return n + 1;
    }
}

/* Sends LOADB with these words, and the fields, if there are any. */
static enum delaunay_result load(struct delaunay_client *c, const char *set, const char *words,
                                 const char *fields, struct body *b, delaunay_progress_fn *progress,
                                 void *ctx)
{
    char rest[FIELD_LIST_MAX + 64];
    bool values = fields != NULL && fields[0] != '\0';
    if (values && (b->k = count_fields(fields)) == 0)
        return DELAUNAY_BADNAME;
    snprintf(rest, sizeof rest, "%s%s%s", words, values ? " FIELDS " : "", values ? fields : "");
    return send_body(c, "LOADB", set, rest, b, progress, ctx);
}

enum delaunay_result delaunay_send_points(struct delaunay_client *c, const char *set,
                                          const double *xy, size_t n,
                                          delaunay_progress_fn *progress, void *ctx)
{
    return load(c, set, "", NULL, &(struct body){.xy = xy, .n = n}, progress, ctx);
}

enum delaunay_result delaunay_send_values(struct delaunay_client *c, const char *set,
                                          const char *fields, const double *xy, const double *value,
                                          size_t n, delaunay_progress_fn *progress, void *ctx)
{
    struct body body = {.xy = xy, .value = value, .n = n};
    return load(c, set, "", fields, &body, progress, ctx);
}

enum delaunay_result delaunay_send_drawing(struct delaunay_client *c, const char *set,
                                           const char *fields, const double *xy,
                                           const double *value, size_t n,
                                           const uint32_t *constraint, size_t m, bool split,
                                           delaunay_progress_fn *progress, void *ctx)
{
    char words[60];
    struct body body = {.xy = xy, .value = value, .n = n, .constraint = constraint, .m = m};
    snprintf(words, sizeof words, " CONSTRAINTS %zu%s", m, split ? " SPLIT" : "");
    return load(c, set, words, fields, &body, progress, ctx);
}

/* The head of a request without points; the pairs follow it. */
enum delaunay_result delaunay_send_constraints(struct delaunay_client *c, const char *set,
                                               const struct delaunay_constraint *what,
                                               const uint32_t *pair, size_t n)
{
    char head[200];
    if (!word_is_set_name(&(struct word){set, strlen(set)}))
        return DELAUNAY_BADNAME;
    int len = snprintf(head, sizeof head, "CONSTRAINB %s%s OF %u%s %zu", set,
                       what->border ? " BORDER" : "", (unsigned)what->number,
                       what->split ? " SPLIT" : "", n);
    enum delaunay_result r = delaunay_send(c, head, (size_t)len);
    if (r == DELAUNAY_OK)
        r = send_rows(c, &(struct body){.pair = pair}, queue_pairs, n, NULL, NULL);
    return r == DELAUNAY_OK ? r : give_up(c, r);
}

/* ---- replies ---- */

static enum delaunay_result keep_status(struct delaunay_client *c, const struct delaunay_part *part)
{
    buf_rewind(&c->status_text, 0);
    buf_append(&c->status_text, part->text, part->len);
    buf_append_char(&c->status_text, '\0');
    if (c->status_text.failed)
        return DELAUNAY_NOMEM;
    c->status = *part;
    c->status.text = buf_head(&c->status_text);
    return DELAUNAY_OK;
}

static const enum delaunay_part_kind kind_of[] = {
    [REPLY_OK] = DELAUNAY_PART_OK,           [REPLY_ERR] = DELAUNAY_PART_ERR,
    [REPLY_ROW] = DELAUNAY_PART_ROW,         [REPLY_BYTES] = DELAUNAY_PART_BYTES,
    [REPLY_COMMENT] = DELAUNAY_PART_COMMENT, [REPLY_EVENT] = DELAUNAY_PART_EVENT,
};

enum delaunay_result delaunay_receive_part(struct delaunay_client *c, int timeout_ms,
                                           delaunay_part_fn *fn, void *ctx, bool *last)
{
    struct reply_part read;
    ptrdiff_t used =
        buf_len(&c->in) == 0 ? 0 : reply_read(&c->reader, buf_head(&c->in), buf_len(&c->in), &read);
    if (used < 0)
        return DELAUNAY_BROKEN;
    if (used == 0)
        return c->ended ? DELAUNAY_LOST : pump(c, timeout_ms);
    enum delaunay_result r = DELAUNAY_OK;
    struct delaunay_part part = {kind_of[read.kind], read.text, read.len, read.last};
    if (part.kind == DELAUNAY_PART_OK || part.kind == DELAUNAY_PART_ERR)
        r = keep_status(c, &part);
    if (r == DELAUNAY_OK && fn != NULL && !fn(ctx, &part))
        r = DELAUNAY_STOPPED;
    *last = part.last;
    buf_consume(&c->in, (size_t)used);
    return r;
}

void delaunay_expect_events(struct delaunay_client *c)
{
    c->reader.events = true;
}

int delaunay_descriptor(const struct delaunay_client *c)
{
    return c->fd;
}

enum delaunay_result delaunay_receive(struct delaunay_client *c, delaunay_part_fn *part, void *ctx)
{
    bool last = false;
    while (!last) {
        enum delaunay_result r = delaunay_receive_part(c, c->timeout_ms, part, ctx, &last);
        if (r != DELAUNAY_OK)
            return r;
    }
    return c->status.kind == DELAUNAY_PART_OK ? DELAUNAY_OK : DELAUNAY_REFUSED;
}

struct gathering {
    char *bytes;
    uint64_t n, at;
    bool failed;
};

static bool gather(void *ctx, const struct delaunay_part *part)
{
    struct gathering *g = ctx;
    if (part->kind == DELAUNAY_PART_OK && delaunay_key_number(part, "bytes", &g->n)) {
        g->bytes = g->n < SIZE_MAX ? malloc((size_t)g->n + 1) : NULL;
        g->failed = g->bytes == NULL;
    } else if (part->kind == DELAUNAY_PART_BYTES) {
        memcpy(g->bytes + g->at, part->text, part->len); /* no more than announced: reply_read */
        g->at += part->len;
    }
    return !g->failed;
}

enum delaunay_result delaunay_receive_bytes(struct delaunay_client *c, void **bytes, size_t *n)
{
    struct gathering g = {0};
    enum delaunay_result r = delaunay_receive(c, gather, &g);
    if (r == DELAUNAY_STOPPED && g.failed)
        r = DELAUNAY_NOMEM;
    if (r != DELAUNAY_OK) {
        bool cut = r == DELAUNAY_TIMEOUT && g.bytes != NULL;
        free(g.bytes);
        g = (struct gathering){0};
        r = cut ? give_up(c, r) : r;
    }
    *bytes = g.bytes;
    *n = (size_t)g.n;
    return r;
}

/* Receives n words, if r, of sending, is DELAUNAY_OK. */
static enum delaunay_result receive_words(struct delaunay_client *c, enum delaunay_result r,
                                          uint32_t *words, size_t n)
{
    void *bytes = NULL;
    size_t got = 0;
    if (r == DELAUNAY_OK)
        r = delaunay_receive_bytes(c, &bytes, &got);
    if (r == DELAUNAY_OK && got != n * sizeof *words)
        r = DELAUNAY_BROKEN;
    for (size_t i = 0; r == DELAUNAY_OK && i < n; i++)
        words[i] = bytes_u32((const char *)bytes + i * sizeof *words);
    free(bytes);
    return r;
}

enum delaunay_result delaunay_locate_places(struct delaunay_client *c, const char *set,
                                            const double *xy, size_t n, uint32_t *triangle)
{
    enum delaunay_result r =
        send_body(c, "LOCATEB", set, "", &(struct body){.xy = xy, .n = n}, NULL, NULL);
    return receive_words(c, r, triangle, 3 * n);
}

enum delaunay_result delaunay_nearest_places(struct delaunay_client *c, const char *set,
                                             const double *xy, size_t n, uint32_t k, uint32_t *id)
{
    char rest[16];
    snprintf(rest, sizeof rest, " %" PRIu32, k);
    enum delaunay_result r =
        send_body(c, "NEARESTB", set, rest, &(struct body){.xy = xy, .n = n}, NULL, NULL);
    return receive_words(c, r, id, k * n);
}

enum delaunay_result delaunay_request(struct delaunay_client *c, const char *line,
                                      delaunay_part_fn *part, void *ctx)
{
    size_t len = without_end(line, strlen(line));
    if (!line_is_whole_request(line, len))
        return DELAUNAY_BADREQUEST;
    enum delaunay_result r = delaunay_send(c, line, len);
    return r == DELAUNAY_OK ? delaunay_receive(c, part, ctx) : r;
}

const struct delaunay_part *delaunay_status(const struct delaunay_client *c)
{
    return &c->status;
}

/* As in proto/; readers of a status line ignore the kind. */
static struct reply_part in_proto(const struct delaunay_part *status)
{
    return (struct reply_part){
        .kind = status->kind == DELAUNAY_PART_OK ? REPLY_OK : REPLY_ERR,
        .text = status->text,
        .len = status->len,
    };
}

bool delaunay_key(const struct delaunay_part *status, const char *key, const char **value,
                  size_t *len)
{
    struct reply_part part = in_proto(status);
    return reply_key(&part, key, value, len);
}

bool delaunay_key_number(const struct delaunay_part *status, const char *key, uint64_t *value)
{
    struct reply_part part = in_proto(status);
    return reply_key_number(&part, key, value);
}

uint64_t delaunay_rows(const struct delaunay_part *status)
{
    struct reply_part part = in_proto(status);
    return reply_rows(&part);
}
