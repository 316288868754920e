/* deflate.c - see deflate.h. Strings are found by a hash of three bytes and a chain of earlier places [RFC 1951, section 4]. */
#include "clients/pictures/deflate.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum {
    WINDOW = 32768,
    BLOCK = 65536,
    SHORTEST = 3,
    LONGEST = 258,
    HASHES = 1 << 15,
    CHAIN = 24,
    NONE = -1,
    LITERALS = 286,
    END = 256, /* of a block */
    DISTANCES = 30,
    LENGTHS = 19 /* the alphabet of code lengths */
};

struct code {
    uint32_t count[LITERALS];
    uint8_t length[LITERALS]; /* in bits; 0: not used */
    uint16_t bits[LITERALS];  /* reversed, as they are written */
};

struct deflate {
    deflate_output_fn *output;
    void *ctx;
    unsigned char data[WINDOW + BLOCK]; /* the window, then the block */
    size_t from, n;                     /* where the block begins and ends */
    int32_t head[HASHES], earlier[WINDOW + BLOCK];
    uint32_t token[BLOCK]; /* a byte, or MATCH with a length and a distance */
    size_t tokens;
    struct code literal, distance, lengths;
    uint64_t pending; /* bits that are not a byte yet */
    unsigned pending_n;
    unsigned char out[4096];
    size_t out_n;
    uint32_t a, b; /* Adler's checksum */
};

#define MATCH 0x80000000u

/* ---- bits ---- */

static void put_byte(struct deflate *d, unsigned v)
{
    d->out[d->out_n++] = (unsigned char)v;
    if (d->out_n == sizeof d->out) {
        d->output(d->ctx, d->out, d->out_n);
        d->out_n = 0;
    }
}

static void put_bits(struct deflate *d, uint32_t v, unsigned n)
{
    d->pending |= (uint64_t)v << d->pending_n;
    for (d->pending_n += n; d->pending_n >= 8; d->pending_n -= 8) {
        put_byte(d, (unsigned)(d->pending & 255));
        d->pending >>= 8;
    }
}

static void put_code(struct deflate *d, const struct code *c, size_t symbol)
{
    put_bits(d, c->bits[symbol], c->length[symbol]);
}

/* ---- Huffman codes ---- */

/* Joins the two rarest trees until one is left; lengths are depths. Returns the greatest. */
static unsigned find_depths(const uint32_t *weight, size_t n, uint8_t *length)
{
    uint32_t tree[2 * LITERALS];
    uint16_t parent[2 * LITERALS] = {0};
    size_t trees = n;
    unsigned deepest = 0;
    memcpy(tree, weight, n * sizeof tree[0]);
    for (;;) {
        size_t least[2], found = 0; /* the rarest, and the second */
        for (size_t i = 0; i < trees; i++) {
            if (tree[i] == 0)
                continue;
            if (found == 0 || tree[i] < tree[least[0]]) {
                least[1] = found > 0 ? least[0] : i;
                least[0] = i;
            } else if (found == 1 || tree[i] < tree[least[1]]) {
                least[1] = i;
            }
            found++;
        }
        if (found < 2)
            break;
        tree[trees] = tree[least[0]] + tree[least[1]];
        tree[least[0]] = tree[least[1]] = 0;
        parent[least[0]] = parent[least[1]] = (uint16_t)trees++;
    }
    for (size_t i = 0; i < n; i++) {
        unsigned depth = 0;
        for (size_t k = i; parent[k] != 0; k = parent[k])
            depth++;
        length[i] = (uint8_t)depth;
        deepest = depth > deepest ? depth : deepest;
    }
    return deepest;
}

/* Makes a code from c->count. At least two symbols are used, since a code of one would be a special case. Counts are made more equal
 * until no code is longer than the limit. */
static void make_code(struct code *c, size_t n, unsigned limit)
{
    size_t used = 0;
    for (size_t i = 0; i < n; i++)
        used += c->count[i] > 0;
    for (size_t i = 0; used < 2; i++)
        if (c->count[i] == 0) {
            c->count[i] = 1;
            used++;
        }
    while (find_depths(c->count, n, c->length) > limit)
        for (size_t i = 0; i < n; i++)
            c->count[i] = (c->count[i] + 1) / 2;
    uint32_t next = 0;
    for (unsigned length = 1; length <= limit; length++, next <<= 1)
        for (size_t i = 0; i < n; i++) {
            if (c->length[i] != length)
                continue;
            uint32_t reversed = 0;
            for (unsigned k = 0; k < length; k++)
                reversed |= (next >> k & 1) << (length - 1 - k);
            c->bits[i] = (uint16_t)reversed;
            next++;
        }
}

/* ---- lengths and distances [RFC 1951, section 3.2.5] ---- */

struct range {
    unsigned symbol, extra; /* bits that follow the symbol */
    uint32_t rest;          /* and their value */
};

static struct range length_range(unsigned length)
{
    unsigned v = length - SHORTEST, extra = 0;
    if (length == LONGEST)
        return (struct range){285, 0, 0};
    while (v >> extra >= 8)
        extra++;
    return (struct range){257 + 4 * extra + (v >> extra), extra, v & ((1u << extra) - 1)};
}

static struct range distance_range(unsigned distance)
{
    unsigned v = distance - 1, extra = 0;
    while (v >> extra >= 4)
        extra++;
    return (struct range){2 * extra + (v >> extra), extra, v & ((1u << extra) - 1)};
}

static unsigned token_length(uint32_t token)
{
    return (token >> 16 & 255) + SHORTEST;
}

static unsigned token_distance(uint32_t token)
{
    return (token & 0xFFFF) + 1;
}

/* ---- strings ---- */

static size_t hash(const unsigned char *s)
{
    return (((uint32_t)s[0] << 16 | (uint32_t)s[1] << 8 | s[2]) * 2654435761u) >> 17;
}

static void remember(struct deflate *d, size_t at)
{
    if (at + SHORTEST > d->n)
        return;
    size_t h = hash(d->data + at);
    d->earlier[at] = d->head[h];
    d->head[h] = (int32_t)at;
}

/* The longest string of those tried that begins earlier and is repeated at `at`; 0: none. */
static unsigned find_match(const struct deflate *d, size_t at, unsigned *distance)
{
    unsigned best = 0, most = d->n - at < LONGEST ? (unsigned)(d->n - at) : LONGEST;
    if (most < SHORTEST)
        return 0;
    int32_t from = d->head[hash(d->data + at)];
    for (int i = 0; i < CHAIN && from != NONE && at - (size_t)from <= WINDOW; i++) {
        unsigned length = 0;
        while (length < most && d->data[(size_t)from + length] == d->data[at + length])
            length++;
        if (length > best) {
            best = length;
            *distance = (unsigned)(at - (size_t)from);
        }
        from = d->earlier[from];
    }
    return best >= SHORTEST ? best : 0;
}

static void find_tokens(struct deflate *d)
{
    memset(d->literal.count, 0, sizeof d->literal.count);
    memset(d->distance.count, 0, sizeof d->distance.count);
    d->tokens = 0;
    for (size_t at = d->from; at < d->n;) {
        unsigned distance = 0, length = find_match(d, at, &distance);
        if (length == 0) {
            d->literal.count[d->data[at]]++;
            d->token[d->tokens++] = d->data[at];
        } else {
            d->literal.count[length_range(length).symbol]++;
            d->distance.count[distance_range(distance).symbol]++;
            d->token[d->tokens++] = MATCH | (length - SHORTEST) << 16 | (distance - 1);
        }
        for (size_t end = at + (length > 0 ? length : 1); at < end; at++)
            remember(d, at);
    }
    d->literal.count[END]++;
}

/* ---- blocks ---- */

/* The run of equal lengths that begins at `at`, as a symbol of the alphabet of lengths [section 3.2.7]. */
static size_t next_run(const uint8_t *length, size_t n, size_t at, struct range *r)
{
    size_t run = 1;
    while (at + run < n && length[at + run] == length[at] && run < 138)
        run++;
    if (length[at] == 0 && run >= 11)
        *r = (struct range){18, 7, (uint32_t)run - 11};
    else if (length[at] == 0 && run >= 3)
        *r = (struct range){17, 3, (uint32_t)run - 3};
    else if (at > 0 && length[at] == length[at - 1] && run >= 3)
        *r = (struct range){16, 2, (uint32_t)(run = run < 6 ? run : 6) - 3};
    else
        *r = (struct range){length[at], 0, 0}, run = 1;
    return run;
}

static void put_codes(struct deflate *d)
{
    static const uint8_t order[LENGTHS] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                           11, 4,  12, 3, 13, 2, 14, 1, 15};
    uint8_t length[LITERALS + DISTANCES];
    struct range r;
    memcpy(length, d->literal.length, LITERALS);
    memcpy(length + LITERALS, d->distance.length, DISTANCES);
    memset(d->lengths.count, 0, sizeof d->lengths.count);
    for (size_t at = 0; at < sizeof length; d->lengths.count[r.symbol]++)
        at += next_run(length, sizeof length, at, &r);
    make_code(&d->lengths, LENGTHS, 7);
    put_bits(d, LITERALS - 257, 5);
    put_bits(d, DISTANCES - 1, 5);
    put_bits(d, LENGTHS - 4, 4);
    for (size_t i = 0; i < LENGTHS; i++)
        put_bits(d, d->lengths.length[order[i]], 3);
    for (size_t at = 0; at < sizeof length;) {
        at += next_run(length, sizeof length, at, &r);
        put_code(d, &d->lengths, r.symbol);
        put_bits(d, r.rest, r.extra);
    }
}

static void put_token(struct deflate *d, uint32_t token)
{
    if ((token & MATCH) == 0) {
        put_code(d, &d->literal, token);
        return;
    }
    struct range r = length_range(token_length(token));
    put_code(d, &d->literal, r.symbol);
    put_bits(d, r.rest, r.extra);
    r = distance_range(token_distance(token));
    put_code(d, &d->distance, r.symbol);
    put_bits(d, r.rest, r.extra);
}

/* Keeps the last WINDOW bytes before the next block. */
static void slide(struct deflate *d)
{
    size_t away = d->n > WINDOW ? d->n - WINDOW : 0;
    memmove(d->data, d->data + away, d->n - away);
    d->n -= away;
    d->from = d->n;
    for (size_t i = 0; i < HASHES; i++)
        d->head[i] = d->head[i] >= (int32_t)away ? d->head[i] - (int32_t)away : NONE;
    for (size_t i = 0; i < d->n; i++)
        d->earlier[i] =
            d->earlier[i + away] >= (int32_t)away ? d->earlier[i + away] - (int32_t)away : NONE;
}

static void put_block(struct deflate *d, bool last)
{
    find_tokens(d);
    make_code(&d->literal, LITERALS, 15);
    make_code(&d->distance, DISTANCES, 15);
    put_bits(d, last, 1);
    put_bits(d, 2, 2);
    put_codes(d);
    for (size_t i = 0; i < d->tokens; i++)
        put_token(d, d->token[i]);
    put_code(d, &d->literal, END);
    slide(d);
}

/* ---- the stream ---- */

struct deflate *deflate_new(deflate_output_fn *output, void *ctx)
{
    struct deflate *d = calloc(1, sizeof *d);
    if (d == NULL)
        return NULL;
    d->output = output;
    d->ctx = ctx;
    d->a = 1;
    memset(d->head, 0xFF, sizeof d->head);
    memset(d->earlier, 0xFF, sizeof d->earlier);
    put_byte(d, 0x78); /* a window of 32 KiB */
    put_byte(d, 0x9C);
    return d;
}

void deflate_put(struct deflate *d, const unsigned char *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        d->a = (d->a + bytes[i]) % 65521;
        d->b = (d->b + d->a) % 65521;
    }
    while (n > 0) {
        size_t room = d->from + BLOCK - d->n, some = n < room ? n : room;
        memcpy(d->data + d->n, bytes, some);
        d->n += some;
        bytes += some;
        n -= some;
        if (some == room)
            put_block(d, false);
    }
}

void deflate_end(struct deflate *d)
{
    put_block(d, true);
    put_bits(d, 0, (8 - d->pending_n) & 7);
    for (int i = 0; i < 2; i++)
        for (int k = 8; k >= 0; k -= 8)
            put_byte(d, (i == 0 ? d->b : d->a) >> k & 255);
    d->output(d->ctx, d->out, d->out_n);
    free(d);
}
