/* cmd_query.c - the commands that read a triangulation. */
#include "server/command/command.h"

#include "server/bodies/load.h"
#include "server/command/prefetch.h"
#include "server/ops/limits.h"
#include "server/replies/query.h"
#include "server/replies/regions.h"
#include "server/rows/answer_rows.h"

#include <stdlib.h>

/* The options at the end of a request. */
struct tail {
    size_t n; /* words without the options */
    bool cw, binary;
    bool within; /* WITHIN and four numbers are all of those, */
    bool inside; /* or INSIDE and perhaps a number */
};

static struct tail read_tail(const struct request *q)
{
    struct tail t = {.n = q->n};
    for (; t.n > 2; t.n--) {
        if (!t.cw && word_is(&q->word[t.n - 1], "CW"))
            t.cw = true;
        else if (!t.binary && word_is(&q->word[t.n - 1], "BINARY"))
            t.binary = true;
        else
            break;
    }
    t.within = t.n == 7 && word_is(&q->word[2], "WITHIN");
    t.inside = t.n > 2 && word_is(&q->word[2], "INSIDE");
    return t;
}

/* Whether the number of words and the options are valid for the command; else the ERR line has been written. */
static bool check_tail(struct answer *a, const struct tail *t, size_t most)
{
    if (t->n <= most && (!t->binary || t->n == 2 || t->within || t->inside))
        return true;
    return answer_usage(a);
}

/* Answers with the rows of a table that are in a box. */
static void answer_within(struct server *s, struct dataset *set, const struct request *q,
                          const struct tail *t, enum query_kind kind, struct answer *a)
{
    struct query query = {.kind = kind, .cw = t->cw, .binary = t->binary, .within = true};
    if (read_box(a, &q->word[3], &query.place.at, &query.hi))
        query_answer(s, a, set, &query);
}

/* Answers with the rows of a table that are inside a border. */
static void answer_inside(struct server *s, struct dataset *set, const struct request *q,
                          const struct tail *t, enum dt_table table, struct answer *a)
{
    struct regions_query query = {
        .kind = REGIONS_TABLE, .table = table, .cw = t->cw, .binary = t->binary};
    size_t at = 3;
    if (!read_inside(a, q, &at, &query.inside))
        return;
    if (at != t->n)
        answer_usage(a);
    else if (regions_ready(s, a, set, query.inside))
        regions_answer(s, a, set, &query);
}

/* ---- LISTS ---- */

static void lists_of_points(struct server *s, struct dataset *set, const struct request *q,
                            const struct tail *t, struct answer *a)
{
    struct query query = {.kind = QUERY_LISTS, .cw = t->cw};
    if (read_points(a, set->current->dt, &q->word[2], t->n - 2, &query.ids))
        query_answer(s, a, set, &query);
}

void cmd_lists(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct tail t = read_tail(q);
    if (!check_tail(a, &t, SIZE_MAX))
        return;
    if (t.n == 2)
        answer_table(s, a, set->current, DT_LISTS, t.cw, t.binary);
    else if (t.within)
        answer_within(s, set, q, &t, QUERY_LISTS, a);
    else
        lists_of_points(s, set, q, &t, a);
}

/* ---- TRIANGLES, EDGES, HULL ---- */

void cmd_triangles(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct tail t = read_tail(q);
    struct query query = {.kind = QUERY_TRIANGLES, .cw = t.cw};
    if (!check_tail(a, &t, t.within ? 7 : 5))
        return;
    if (t.within) {
        answer_within(s, set, q, &t, QUERY_TRIANGLES, a);
        return;
    }
    if (t.inside) {
        answer_inside(s, set, q, &t, DT_TRIANGLES, a);
        return;
    }
    if (t.n == 2) {
        answer_table(s, a, set->current, DT_TRIANGLES, t.cw, t.binary);
        return;
    }
    for (size_t i = 2; i < t.n; i++)
        if (!read_id(a, &q->word[i], &query.corner[query.corners++]))
            return;
    query_answer(s, a, set, &query);
}

void cmd_edges(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct tail t = read_tail(q);
    struct query query = {.kind = QUERY_EDGES, .corners = 1, .cw = t.cw};
    if (t.n == 3 && !t.cw && word_is(&q->word[2], "CONSTRAINED")) {
        query = (struct query){.kind = QUERY_CONSTRAINED, .binary = t.binary};
        query_answer(s, a, set, &query);
        return;
    }
    if (!check_tail(a, &t, t.inside ? 4 : 3))
        return;
    if (t.n == 2)
        answer_table(s, a, set->current, DT_EDGES, t.cw, t.binary);
    else if (t.inside)
        answer_inside(s, set, q, &t, DT_EDGES, a);
    else if (read_id(a, &q->word[2], &query.corner[0]))
        query_answer(s, a, set, &query);
}

void cmd_hull(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct tail t = read_tail(q);
    if (t.n > 2 || t.binary)
        answer_usage(a);
    else
        answer_table(s, a, set->current, DT_HULL, t.cw, false);
}

/* ---- LOCATE, NEAREST, WITHIN ---- */

void cmd_locate(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct dt_place p;
    if (read_place(a, q, &p))
        regions_locate(s, a, set, &p);
}

void cmd_nearest(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct query query = {.kind = QUERY_NEAREST, .k = 1};
    if (read_place(a, q, &query.place) &&
        (q->n == 4 || read_count(a, &q->word[4], "a number of points", &query.k)))
        query_answer(s, a, set, &query);
}

void cmd_within(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct query query = {.kind = q->n == 6 ? QUERY_BOX : QUERY_DISC};
    bool read = query.kind == QUERY_BOX ? read_box(a, &q->word[2], &query.place.at, &query.hi)
                                        : read_point(a, &q->word[2], &query.place.at) &&
                                              read_length(a, &q->word[4], "radius", &query.radius);
    if (read)
        query_answer(s, a, set, &query);
}

/* ---- LOCATEB, NEARESTB ---- */

/* Answers with a row of `width` ids for each place of the body. */
static void answer_body(struct server *s, struct dataset *set, enum row_form form, size_t width,
                        struct answer *a)
{
    struct rows rows = {
        .version = set->current, .heavy = true, .binary = true, .form = form, .width = width};
    struct places places = {.n = a->body->body.n};
    places.p = (struct dt_point *)(void *)load_take(a->body, &places.memory);
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "rows", places.n);
    reply_key_u64(a->out, "bytes", (uint64_t)places.n * width * sizeof(uint32_t));
    reply_end(a->out);
    answer_places(s, a, &rows, &places);
}

void cmd_locateb(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    answer_body(s, set, ROW_TRIANGLE, 3, a);
}

void cmd_nearestb(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    uint32_t k = 1;
    if (q->n == 4 && !read_count(a, &q->word[3], "a number of points", &k))
        return;
    if (k > LIMIT_NEAREST_MANY)
        answer_err(a, ERR_RANGE, "at most %d points for each place", LIMIT_NEAREST_MANY);
    else
        answer_body(s, set, ROW_NEAREST, k, a);
}
