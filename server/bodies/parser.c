/* parser.c - see parser.h. */
#include "server/bodies/parser.h"

#include "server/jobs/job.h"

#include <stdlib.h>
#include <string.h>

enum {
    BLOCKS = 8,            /* filling, in work, or parsed */
    RECEIVED = 128 * 1024, /* at a time: it is more than the longest line */
    FED = 32 * 1024        /* at a time, of a block with a fault */
};

struct block {
    char *text;    /* owns */
    double *array; /* owns: of the points, `bytes` long */
    size_t bytes;
    size_t n, whole; /* bytes received; of them, in whole lines */
    uint64_t lines;
    size_t fed;                /* bytes of whole lines that have been fed to the body */
    struct body body;          /* its lines; the points are in the array */
    struct reservation memory; /* of text and array */
    bool in_work;              /* a worker has it */
};

struct parser {
    struct server *server; /* borrows */
    struct body *body;     /* borrows; not used once it is abandoned */
    void (*ready)(void *ctx);
    void *ctx;
    size_t size;                /* of a block, about */
    struct block block[BLOCKS]; /* a ring */
    unsigned most;              /* blocks that are used */
    unsigned head, filling;     /* counts blocks: the first one that is not in the body; the last */
    bool begun, full;           /* the last one has text; it is to be submitted */
    uint64_t left;              /* lines that are not the last one of the body */
    bool ended;                 /* there is no more text */
    bool abandoned;             /* freed while workers have blocks */
    unsigned jobs;              /* of workers */
};

static struct block *block_at(struct parser *p, unsigned i)
{
    return &p->block[i % p->most];
}

/* ---- life ---- */

struct parser *parser_new(struct server *s, struct body *b, size_t bytes, void (*ready)(void *ctx),
                          void *ctx)
{
    struct parser *p = calloc(1, sizeof *p);
    if (p == NULL)
        return NULL;
    p->server = s;
    p->body = b;
    p->ready = ready;
    p->ctx = ctx;
    p->most = workers_pool(s->workers)->threads + 2;
    p->most = p->most < BLOCKS ? p->most : BLOCKS;
    p->size = bytes < PARSER_LEAST ? PARSER_LEAST : bytes < PARSER_MOST ? bytes : PARSER_MOST;
    p->left = b->form == BODY_LINES ? b->left - 1 : UINT64_MAX;
    for (unsigned i = 0; i < BLOCKS; i++)
        p->block[i].memory = server_reservation(s, BUDGET_LOADS);
    return p;
}

void parser_free(struct parser *p)
{
    p->abandoned = true;
    if (p->jobs > 0)
        return;
    for (unsigned i = 0; i < BLOCKS; i++) {
        free(p->block[i].text);
        free(p->block[i].array);
        reservation_set(&p->block[i].memory, 0);
    }
    server_memory_freed(p->server);
    free(p);
}

/* ---- work ---- */

struct parse {
    struct job job;
    struct parser *parser; /* borrows: not freed before the job ends */
    struct block *block;
};

static void run_parse(struct job *j)
{
    struct block *k = ((struct parse *)j)->block;
    body_feed(&k->body, k->text, k->whole, false);
}

/* The job is never refused. */
static void end_parse(struct server *s, struct job *j, struct answer *a)
{
    struct parser *p = ((struct parse *)j)->parser;
    ((struct parse *)j)->block->in_work = false;
    p->jobs--;
    if (p->abandoned)
        parser_free(p);
    else
        p->ready(p->ctx);
}

/* The array is large enough for all lines. */
static void *give_array(void *ctx, void *old, size_t used, size_t bytes)
{
    struct block *k = ctx;
    return bytes <= k->bytes ? k->array : NULL;
}

static void keep_array(void *array)
{
    /* it is the block's */
}

/* Makes room for the points of all lines. */
static bool make_array(const struct parser *p, struct block *k)
{
    size_t bytes = k->lines * p->body->width * sizeof *k->array;
    if (bytes <= k->bytes)
        return true;
    if (!reservation_resize(&k->memory, p->size + RECEIVED + bytes))
        return false;
    free(k->array);
    k->array = malloc(bytes);
    k->bytes = k->array == NULL ? 0 : bytes;
    reservation_set(&k->memory, p->size + RECEIVED + k->bytes);
    return k->array != NULL;
}

bool parser_is_full(const struct parser *p)
{
    return p->full;
}

/* Without memory for that they are fed to the body when it is their turn. */
void parser_submit(struct parser *p)
{
    p->begun = p->full = false;
    struct block *k = block_at(p, p->filling++);
    struct parse *x = make_array(p, k) ? job_new(sizeof *x, run_parse, end_parse) : NULL;
    k->fed = 0;
    body_init(&k->body, BODY_LINES, k->lines, k->lines, p->body->coordinates_ok);
    body_columns_of(&k->body, p->body);
    k->body.memory = (struct body_memory){give_array, keep_array, k};
    if (x == NULL) {
        p->ready(p->ctx);
        return;
    }
    x->parser = p;
    x->block = k;
    k->in_work = true;
    p->jobs++;
    job_aside(p->server, NULL, &x->job, JOB_SHORT);
}

/* ---- receiving ---- */

/* Begins the next block with the bytes behind the whole lines of the last one. */
static bool begin_block(struct parser *p, struct block *k)
{
    size_t bytes = p->size + RECEIVED;
    if (k->text == NULL) {
        if (!reservation_resize(&k->memory, bytes))
            return false;
        k->text = malloc(bytes);
    }
    if (k->text == NULL)
        return false;
    const struct block *last = block_at(p, p->filling - 1);
    k->n = p->filling > 0 ? last->n - last->whole : 0;
    if (k->n > 0)
        memcpy(k->text, last->text + last->whole, k->n);
    k->whole = k->lines = 0;
    return true;
}

char *parser_room(struct parser *p, size_t *n)
{
    struct block *k = block_at(p, p->filling);
    if (p->ended || p->full || p->filling - p->head == p->most)
        return NULL;
    if (!p->begun && !(p->begun = begin_block(p, k))) {
        p->ended = true;
        return NULL;
    }
    *n = RECEIVED;
    return k->text + k->n;
}

void parser_received(struct parser *p, size_t n)
{
    struct block *k = block_at(p, p->filling);
    uint64_t lines;
    k->n += n;
    k->whole += body_scan(p->body, k->text + k->whole, k->n - k->whole, p->left, &lines, &p->ended);
    k->lines += lines;
    p->left -= lines;
    size_t rest = k->n - k->whole;
    if (rest > LINE_LIMIT || memchr(k->text + k->whole, '\0', rest) != NULL)
        p->ended = true; /* the body finds the fault, or the end of the line */
    p->full = k->lines > 0 && (p->ended || k->n >= p->size);
}

void parser_end(struct parser *p)
{
    p->ended = true;
    p->full = p->begun && block_at(p, p->filling)->lines > 0;
}

const char *parser_rest(const struct parser *p, size_t *n)
{
    const struct block *k = &p->block[(p->begun ? p->filling : p->filling - 1) % p->most];
    *n = k->n - k->whole;
    return k->text == NULL ? "" : k->text + k->whole;
}

/* ---- appending ---- */

/* False: the framing is broken. */
static bool feed_piece(struct body *b, struct block *k)
{
    size_t rest = k->whole - k->fed, n = rest < FED ? rest : FED;
    ptrdiff_t took = body_feed(b, k->text + k->fed, n, false);
    if (took == 0) /* a line that is longer */
        took = body_feed(b, k->text + k->fed, rest, false);
    k->fed += took > 0 ? (size_t)took : 0;
    return took > 0;
}

enum parser_step parser_step(struct parser *p)
{
    struct block *k = block_at(p, p->head);
    if (p->head == p->filling || k->in_work)
        return PARSER_WAITS;
    if (k->fed == 0 && body_join(p->body, &k->body))
        k->fed = k->whole;
    else if (!feed_piece(p->body, k))
        return PARSER_BROKEN;
    p->head += k->fed == k->whole;
    return PARSER_MOVED;
}

bool parser_is_done(const struct parser *p)
{
    return p->ended && !p->full && p->head == p->filling;
}

bool parser_is_busy(const struct parser *p)
{
    return p->head != p->filling && (p->ended || p->filling - p->head == p->most);
}
