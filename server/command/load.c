/* load.c - see load.h. */
#include "server/command/load.h"

#include "proto/number.h"
#include "server/jobs/keep.h"

#include <stdlib.h>
#include <string.h>

enum {
    MANY = 1 << 17,        /* points for which pages are made ready as they arrive */
    BYTES_PER_POINT = 120, /* what they take until they are triangulated, at the peak */
    BYTES_WHEN_ADDED = 84  /* of these, when they have been added */
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

void load_start(struct server *s, struct answer *a, const struct word *name, enum body_form form,
                uint32_t count)
{
    struct load *l = calloc(1, sizeof *l);
    if (l == NULL) {
        answer_out_of_memory(a);
        a->next = ANSWER_CLOSING; /* what follows could not be told from requests */
        return;
    }
    body_init(&l->body, form, count, s->config->max_points, dt_coordinate_ok);
    l->body.memory = (struct body_memory){grow_points, dt_pages_release, l};
    l->server = s;
    l->memory = server_reservation(s, BUDGET_LOADS);
    l->shortage = ERR_NOMEM;
    if (name != NULL) {
        l->name_len = name->len;
        memcpy(l->name, name->text, name->len);
    }
    a->next = ANSWER_BODY;
    a->load = l;
}

void load_skip(struct server *s, const struct request *q, struct answer *a)
{
    bool binary = word_is(&q->word[0], "LOADB"), dot = !binary && q->n == 2;
    uint32_t count = 0;
    /* Those who have shown no token may not keep the server reading. */
    if (a->role == ROLE_NONE || (!dot && q->n != 3) ||
        (!dot && !proto_read_u32(q->word[2].text, q->word[2].len, &count))) {
        a->next = ANSWER_CLOSING;
        return;
    }
    load_start(s, a, NULL, binary ? BODY_BINARY : dot ? BODY_DOT : BODY_LINES, count);
    if (a->next != ANSWER_BODY)
        return;
    a->load->refused = true;
    body_fail(&a->load->body, BODY_SYNTAX); /* so that no point is kept */
}

/* Tells what the points that have come will take when they are added and triangulated. */
static void expect(struct server *s, struct load *l)
{
    size_t expected = l->body.n < MANY ? 0 : l->body.n * BYTES_PER_POINT;
    if (expected == l->expected)
        return;
    keep_expect(s, expected, l->expected);
    l->expected = expected;
}

ptrdiff_t load_feed(struct server *s, struct load *l, const char *bytes, size_t n, bool last)
{
    ptrdiff_t took = body_feed(&l->body, bytes, n, last);
    l->came += took > 0 ? (uint64_t)took : 0;
    if (l->body.fault != BODY_GOOD)
        reservation_set(&l->memory, 0);
    expect(s, l);
    return took;
}

bool load_stalls(struct load *l, int64_t now_ms)
{
    enum {
        SHARE = 1024
    }; /* of its memory has to come: a client cannot hold much by sending little */
    int64_t limit_ms = (int64_t)l->server->config->load_timeout_s * 1000;
    if (l->seen_ms == 0 || l->came - l->seen > l->memory.bytes / SHARE) {
        l->seen = l->came;
        l->seen_ms = now_ms;
    }
    return limit_ms > 0 && now_ms - l->seen_ms >= limit_ms;
}

void load_free(struct server *s, struct load *l)
{
    bool reserved = l->memory.bytes > 0;
    keep_expect(s, 0, l->expected);
    body_free(&l->body);
    reservation_set(&l->memory, 0);
    if (reserved)
        server_reserved_less(s);
    free(l);
}

size_t load_hand_on_expected(struct server *s, struct load *l)
{
    size_t rest = l->expected / BYTES_PER_POINT * BYTES_WHEN_ADDED;
    keep_expect(s, rest, l->expected);
    l->expected = 0;
    return rest;
}
