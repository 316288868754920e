/* load.c - see load.h. */
#include "server/bodies/load.h"

#include "core/delaunay_constraints.h"
#include "core/delaunay_fields.h"
#include "proto/number.h"
#include "server/jobs/page_cache.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(struct dt_point) == 2 * sizeof(double), "a body's x, y pairs are points");

enum {
    PARSED_FROM = 256 * 1024, /* bytes of a text that are fed before workers parse it */
    MANY = 1 << 17,           /* points from which on pages are prefaulted */
    /* for adding them (50) and for what their mesh (68) takes beyond what is then released */
    BYTES_PER_POINT = 80,
    BYTES_WHILE_ADDING = 28 /* of these, what adding leaves */
};

static void *grow_points(void *ctx, void *p, size_t used, size_t bytes)
{
    struct load *l = ctx;
    struct server *s = l->server;
    size_t before = l->memory.bytes;
    if (!reservation_resize(&l->memory, bytes)) {
        l->shortage = budget_could_fit(&s->budget, bytes) ? ERR_BUSY : ERR_NOMEM;
        return NULL;
    }
    void *larger = dt_pages_grow(s->pages, p, used, bytes);
    if (larger == NULL)
        reservation_set(&l->memory, before);
    server_limit_pages(s);
    return larger;
}

/* NULL: out of memory. */
static struct load *new_load(struct server *s, const struct request *q, bool adds)
{
    struct load *l = calloc(1, sizeof *l);
    if (l == NULL)
        return NULL;
    for (size_t i = 0; i < q->n; i++) {
        buf_append(&l->line, q->word[i].text, q->word[i].len);
        buf_append_char(&l->line, ' ');
    }
    if (l->line.failed) {
        buf_free(&l->line);
        free(l);
        return NULL;
    }
    l->server = s;
    l->memory = server_reservation(s, BUDGET_LOADS);
    l->shortage = ERR_NOMEM;
    l->parsed_from = PARSED_FROM;
    l->adds = adds;
    return l;
}

static void find_constraints(const struct request *q, size_t at, struct load_words *w)
{
    if (q->n < at + 2 || !word_is(&q->word[at], "CONSTRAINTS"))
        return;
    const struct word *n = &q->word[at + 1];
    bool good = proto_read_u32(n->text, n->len, &w->constraints.n);
    w->constraints.bad = !good || w->constraints.n > DT_MAX_CONSTRAINTS;
    w->constraints.splits = at + 2 < q->n && word_is(&q->word[at + 2], "SPLIT");
    w->constraints.end = at + 2 + w->constraints.splits;
}

struct load_words load_words_of(const struct load_shape *shape, const struct request *q)
{
    struct load_words w = {.end = q->n};
    if (shape->fields && q->n > 3 && word_is(&q->word[q->n - 2], "FIELDS"))
        w.names = q->word[q->n - 1];
    if (w.names.len > 0)
        w.end -= 2;
    for (size_t i = shape->count + 1; shape->paths && i >= shape->count; i--)
        if (i < w.end && word_is(&q->word[i], "PATHS"))
            w.paths = i;
    if (shape->constraints)
        find_constraints(q, shape->count + 1, &w);
    return w;
}

static size_t count_names(const struct word *w)
{
    size_t n = w->len > 0;
    for (size_t i = 0; i < w->len; i++)
        n += w->text[i] == ',';
    return n;
}

/* The facts about a body that the line of its request gives. */
struct announced {
    struct load_words words;
    enum body_form form;
    uint32_t count;
    size_t values; /* of a row, besides its coordinates */
};

/* The index of the word that counts the rows. */
static size_t count_at(const struct load_shape *shape, const struct request *q)
{
    return shape->rows == LOAD_PAIRS ? q->n - 1 : shape->count;
}

/* False: the line does not say how long the body is. */
static bool read_line(const struct load_shape *shape, const struct request *q, struct announced *b)
{
    *b = (struct announced){.words = load_words_of(shape, q)};
    const struct load_words *w = &b->words;
    bool counted = count_at(shape, q) < (w->paths > 0 ? w->paths : w->end);
    const struct word *n = &q->word[count_at(shape, q)];
    b->form = !shape->lines ? BODY_BINARY : counted ? BODY_LINES : BODY_DOT;
    b->values = shape->rows == LOAD_VALUES ? 1 : count_names(&w->names);
    return b->form == BODY_DOT ||
           (counted && !w->constraints.bad && proto_read_u32(n->text, n->len, &b->count));
}

static void begin(struct server *s, const struct load_shape *shape, const struct request *q,
                  struct answer *a, bool adds, const struct announced *b)
{
    struct load *l = new_load(s, q, adds);
    if (l == NULL) {
        answer_out_of_memory(a);
        a->closes = true; /* the body could not be distinguished from requests */
        return;
    }
    l->shape = shape;
    size_t most = l->adds ? s->config->max_points : DT_MAX_POINTS;
    uint32_t constraints = b->words.constraints.n;
    body_init(&l->body, b->form, (uint64_t)b->count + constraints, most + constraints,
              dt_coordinates_ok);
    if (shape->rows == LOAD_PAIRS)
        body_words(&l->body);
    else
        body_columns(&l->body, shape->rows == LOAD_VALUES ? 0 : 2, b->values);
    if (b->words.paths > 0)
        body_paths(&l->body);
    body_records(&l->body, b->count);
    l->body.memory = (struct body_memory){grow_points, dt_pages_release, l};
    a->next = ANSWER_BODY;
    a->load = l;
}

void load_start(struct server *s, const struct load_shape *shape, const struct request *q,
                struct answer *a)
{
    struct announced b;
    if (!read_line(shape, q, &b)) {
        bool constraints = b.words.constraints.bad;
        const struct word *w = &q->word[count_at(shape, q) + (constraints ? 2 : 0)];
        answer_err(a, ERR_NUMBER, "%.*s is not a number of %s", (int)(w->len < 32 ? w->len : 32),
                   w->text, constraints ? "constraints" : "points");
        a->closes = true;
    } else if (b.values > DT_MAX_FIELDS) {
        answer_err(a, ERR_TOOBIG, "a set has at most %d fields", DT_MAX_FIELDS);
        load_skip(s, shape, q, a);
    } else {
        begin(s, shape, q, a, shape->rows == LOAD_POINTS, &b);
    }
}

void load_skip(struct server *s, const struct load_shape *shape, const struct request *q,
               struct answer *a)
{
    struct announced b;
    /* Those who have shown no token may not keep the server reading. */
    if (a->client.role == ROLE_NONE || !read_line(shape, q, &b)) {
        a->closes = true;
        return;
    }
    begin(s, shape, q, a, false, &b);
    if (a->next != ANSWER_BODY)
        return;
    a->load->refused = true;
    body_fail(&a->load->body, BODY_SYNTAX); /* so that no point is kept */
}

/* Returns the name of a row of the body. */
static const char *row_name(const struct load *l)
{
    if (l->body.form != BODY_BINARY)
        return "line";
    static const char *const name[] = {[LOAD_POINTS] = "point",
                                       [LOAD_PLACES] = "place",
                                       [LOAD_VALUES] = "value",
                                       [LOAD_PAIRS] = "pair"};
    return name[l->shape->rows];
}

static const char *outcome(const struct load *l)
{
    static const char *const text[] = {[LOAD_POINTS] = "; nothing was loaded",
                                       [LOAD_PLACES] = "",
                                       [LOAD_VALUES] = "; no value was set",
                                       [LOAD_PAIRS] = "; nothing has changed"};
    return text[l->shape->rows];
}

static void say(struct answer *a, const struct load *l, enum reply_code code, const char *what)
{
    answer_err(a, code, "%s %llu: %s%s", row_name(l), (unsigned long long)l->body.fault_line, what,
               outcome(l));
}

static void say_too_big(struct server *s, struct answer *a, const struct load *l)
{
    char what[80];
    if (l->adds)
        snprintf(what, sizeof what, "a set holds at most %u points (--max-points)",
                 s->config->max_points);
    else
        snprintf(what, sizeof what, "a request has at most %u %ss", DT_MAX_POINTS, row_name(l));
    say(a, l, ERR_TOOBIG, what);
}

bool load_refuse(struct server *s, const struct load *l, struct answer *a)
{
    const struct body *b = &l->body;
    switch (b->fault) {
    case BODY_GOOD:
        return false;
    case BODY_SYNTAX:
        say(a, l, ERR_SYNTAX, body_numbers(b) > 2 ? "not `x y` and its values" : "not `x y`");
        break;
    case BODY_ENDED:
        say(a, l, ERR_SYNTAX, "the input ended too early");
        break;
    case BODY_LONGER:
        answer_err(a, ERR_SYNTAX, "more than %llu %ss%s", (unsigned long long)b->fault_line,
                   row_name(l), outcome(l));
        break;
    case BODY_NUMBER:
        say(a, l, ERR_NUMBER, "not a number");
        break;
    case BODY_RANGE:
        say(a, l, ERR_RANGE, "a coordinate is 0 or has a magnitude from 2^-142 to 2^201");
        break;
    case BODY_VALUE:
        say(a, l, ERR_RANGE, "a value is a finite number, or nan");
        break;
    case BODY_TOOBIG:
        say_too_big(s, a, l);
        break;
    case BODY_NOMEM:
        say(a, l, l->shortage, "out of memory");
        break;
    }
    return true;
}

/* The memory that adding and triangulating the received points will take, beside that of the points as they were
 * received. */
static size_t bytes_to_expect(const struct load *l)
{
    return l->body.n < MANY || !l->adds ? 0 : l->body.n * BYTES_PER_POINT;
}

bool load_has_changed(const struct load *l)
{
    enum { SHARE = 8 };
    size_t bytes = bytes_to_expect(l);
    bool parsed = l->parser != NULL && (parser_is_full(l->parser) || parser_is_done(l->parser));
    return parsed || bytes < l->expected || bytes > l->expected + l->expected / SHARE;
}

void load_settle(struct load *l)
{
    if (l->parser != NULL && parser_is_full(l->parser))
        parser_submit(l->parser);
    size_t expected = bytes_to_expect(l);
    page_cache_expect(l->server, expected, l->expected);
    l->expected = expected;
}

/* n bytes of the body have been parsed. */
static void advance(struct load *l, size_t n)
{
    l->came += n;
    if (l->body.fault != BODY_GOOD)
        reservation_set(&l->memory, 0);
}

ptrdiff_t load_feed(struct load *l, const char *bytes, size_t n, bool last)
{
    ptrdiff_t took = body_feed(&l->body, bytes, n, last);
    advance(l, took > 0 ? (size_t)took : 0);
    return took;
}

void load_notify(struct load *l, void (*ready)(void *ctx), void *ctx)
{
    l->ready = ready;
    l->ctx = ctx;
}

/* Workers parse a text once enough of it has come that it may become long. */
static bool begins_parser(const struct load *l)
{
    const struct body *b = &l->body;
    return l->parser == NULL && l->ready != NULL && l->came >= l->parsed_from &&
           b->form != BODY_BINARY && b->fault == BODY_GOOD && !b->complete &&
           l->server->workers != NULL;
}

char *load_room(struct load *l, size_t *n)
{
    if (begins_parser(l))
        l->parser = parser_new(l->server, &l->body, (size_t)l->came, l->ready, l->ctx);
    return l->parser != NULL ? parser_room(l->parser, n) : body_room(&l->body, n);
}

void load_received(struct load *l, size_t n)
{
    if (l->parser != NULL)
        parser_received(l->parser, n);
    else
        body_wrote(&l->body, n);
    advance(l, n);
}

void load_moved(struct load *l)
{
    advance(l, 0);
}

size_t load_end_parser(struct load *l, struct buf *in)
{
    size_t n;
    const char *rest = parser_rest(l->parser, &n);
    struct buf all = {0};
    buf_append(&all, rest, n);
    buf_append(&all, buf_head(in), buf_len(in));
    buf_free(in);
    *in = all;
    l->came -= n;
    l->parsed_from = l->came + PARSED_FROM;
    parser_free(l->parser);
    l->parser = NULL;
    return n;
}

bool load_stalls(struct load *l, int64_t now_ms)
{
    /* of its memory has to come: a client cannot hold much by sending little */
    enum { SHARE = 1024 };
    int64_t limit_ms = (int64_t)l->server->config->load_timeout_s * 1000;
    bool busy = l->parser != NULL && parser_is_busy(l->parser);
    if (busy || l->seen_ms == 0 || l->came - l->seen > l->memory.bytes / SHARE) {
        l->seen = l->came;
        l->seen_ms = now_ms;
    }
    return limit_ms > 0 && now_ms - l->seen_ms >= limit_ms;
}

void load_free(struct server *s, struct load *l)
{
    bool reserved = l->memory.bytes > 0;
    page_cache_expect(s, 0, l->expected);
    if (l->parser != NULL)
        parser_free(l->parser);
    body_free(&l->body);
    reservation_set(&l->memory, 0);
    if (reserved)
        server_memory_freed(s);
    buf_free(&l->line);
    free(l);
}

double *load_take(struct load *l, struct reservation *memory)
{
    double *p = l->body.xy;
    l->body.xy = NULL;
    if (memory->budget == NULL)
        *memory = (struct reservation){l->memory.budget, l->memory.kind, 0};
    reservation_move(memory, &l->memory);
    return p;
}

double *load_copy(const struct load *l)
{
    size_t bytes = l->body.n * l->body.width * sizeof(double);
    double *p = bytes == 0 ? NULL : dt_pages_grow(l->server->pages, NULL, 0, bytes);
    if (p != NULL)
        memcpy(p, l->body.xy, bytes);
    return p;
}

size_t load_hand_on_expected(struct server *s, struct load *l)
{
    size_t rest = l->expected / BYTES_PER_POINT * BYTES_WHILE_ADDING;
    page_cache_expect(s, rest, l->expected);
    l->expected = 0;
    return rest;
}
