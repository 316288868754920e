/* cmd_query.c - the commands that read a triangulation. */
#include "server/command.h"

#include "server/query.h"
#include "server/stream.h"

#include <stdlib.h>

enum {
    IDS_AT_ONCE = 200,     /* points that LISTS sorts on the I/O thread */
    HULL_AT_ONCE = 20000,  /* points of a hull that LISTS may have to walk there */
    NEAREST_AT_ONCE = 100, /* points that NEAREST finds there */
    WITHIN_AT_ONCE =
        50000 /* points of a set in which WITHIN searches there: it may find all of them */
};

/* The options that end a request, and what stands before them. */
struct tail {
    size_t n; /* words without the options */
    bool cw, binary;
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
    return t;
}

/* Whether n words and these options make sense for the command; else the error has been told. */
static bool check_tail(struct answer *a, const struct request *q, const struct tail *t, size_t most)
{
    if (t->n <= most && (!t->binary || t->n == 2))
        return true;
    reply_err(a->out, ERR_SYNTAX, "usage: %s", command_find(&q->word[0])->usage);
    return false;
}

/* Takes the server's scratch, empty. */
static struct dt_ids take_scratch(struct server *s)
{
    struct dt_ids ids = s->scratch;
    ids.n = 0;
    s->scratch = (struct dt_ids){0};
    return ids;
}

/* Answers with rows of `width` ids, or with the error; gives the scratch back. */
static void answer_ids(struct server *s, struct answer *a, struct dataset *set,
                       enum dt_status status, struct dt_ids *ids, size_t width)
{
    if (status != DT_OK) {
        answer_status(a, status);
    } else {
        struct rows rows = {.version = set->current, .form = ROW_IDS, .width = width};
        reply_ok(a->out, ids->n / width);
        reply_end(a->out);
        stream_answer(a, &rows, ids);
    }
    s->scratch = *ids;
}

/* ---- LISTS ---- */

static void lists_of_points(struct server *s, struct dataset *set, const struct request *q,
                            const struct tail *t, struct answer *a)
{
    struct query query = {.kind = QUERY_LISTS, .cw = t->cw};
    uint32_t rep;
    size_t n = t->n - 2;
    query.ids = (struct dt_ids){read_ids(a, &q->word[2], n), n, n};
    if (query.ids.v == NULL)
        return;
    for (size_t i = 0; i < n; i++) {
        if (dt_representative(set->current->dt, query.ids.v[i], &rep) != DT_OK) {
            reply_err(a->out, ERR_NOPOINT, "there is no point %u", query.ids.v[i]);
            free(query.ids.v);
            return;
        }
    }
    query_answer(s, a, set, &query,
                 n > IDS_AT_ONCE || (n > 1 && set->current->sum.hull > HULL_AT_ONCE));
}

void cmd_lists(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct tail t = read_tail(q);
    if (!check_tail(a, q, &t, SIZE_MAX))
        return;
    if (t.n == 2)
        stream_answer_table(a, set->current, DT_LISTS, t.cw, t.binary);
    else
        lists_of_points(s, set, q, &t, a);
}

/* ---- TRIANGLES, EDGES, HULL ---- */

void cmd_triangles(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct tail t = read_tail(q);
    uint32_t id[3] = {0};
    if (!check_tail(a, q, &t, 5))
        return;
    if (t.n == 2) {
        stream_answer_table(a, set->current, DT_TRIANGLES, t.cw, t.binary);
        return;
    }
    for (size_t i = 2; i < t.n; i++)
        if (!read_id(a, &q->word[i], &id[i - 2]))
            return;
    const struct dt *dt = set->current->dt;
    struct dt_ids ids = take_scratch(s);
    enum dt_status status = t.n == 3 ? dt_triangles_at_point(dt, id[0], t.cw, &ids)
                            : t.n == 4
                                ? dt_triangles_at_edge(dt, id[0], id[1], t.cw, &ids)
                                : dt_triangles_at_triangle(dt, id[0], id[1], id[2], t.cw, &ids);
    answer_ids(s, a, set, status, &ids, 3);
}

/* Turns the ring of a point into the edges to its neighbours, a < b each. */
static enum dt_status edges_at(const struct dt *dt, uint32_t id, bool cw, struct dt_ids *ids)
{
    uint32_t rep;
    bool boundary;
    enum dt_status status = dt_ring(dt, id, cw, ids, &rep, &boundary);
    if (status != DT_OK)
        return status;
    size_t n = ids->n;
    uint32_t *v = realloc(ids->v, (2 * n + 1) * sizeof *v);
    if (v == NULL)
        return DT_NOMEM;
    for (size_t i = n;
         i-- > 0;) { /* from the end: an edge is written where no neighbour is read any more */
        uint32_t other = v[i];
        v[2 * i] = rep < other ? rep : other;
        v[2 * i + 1] = rep < other ? other : rep;
    }
    *ids = (struct dt_ids){v, 2 * n, 2 * n + 1};
    return DT_OK;
}

void cmd_edges(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct tail t = read_tail(q);
    uint32_t id;
    if (!check_tail(a, q, &t, 3))
        return;
    if (t.n == 2) {
        stream_answer_table(a, set->current, DT_EDGES, t.cw, t.binary);
    } else if (read_id(a, &q->word[2], &id)) {
        struct dt_ids ids = take_scratch(s);
        enum dt_status status = edges_at(set->current->dt, id, t.cw, &ids);
        answer_ids(s, a, set, status, &ids, 2);
    }
}

void cmd_hull(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct tail t = read_tail(q);
    (void)s;
    if (t.n > 2 || t.binary)
        reply_err(a->out, ERR_SYNTAX, "usage: %s", command_find(&q->word[0])->usage);
    else
        stream_answer_table(a, set->current, DT_HULL, t.cw, false);
}

/* ---- LOCATE, NEAREST, WITHIN ---- */

void cmd_locate(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    static const char *const where[] = {[DT_OUTSIDE] = "outside",
                                        [DT_ON_VERTEX] = "vertex",
                                        [DT_ON_EDGE] = "edge",
                                        [DT_INSIDE] = "inside"};
    static const size_t ids[] = {
        [DT_OUTSIDE] = 0, [DT_ON_VERTEX] = 1, [DT_ON_EDGE] = 2, [DT_INSIDE] = 3};
    struct dt_location at;
    struct dt_place p;
    if (!read_place(s, a, q, &p))
        return;
    enum dt_status status = dt_locate_place(set->current->dt, &p, &at);
    if (status != DT_OK) {
        answer_status(a, status);
        return;
    }
    reply_ok(a->out, at.where != DT_OUTSIDE);
    reply_key_text(a->out, "where", where[at.where]);
    reply_end(a->out);
    if (at.where != DT_OUTSIDE)
        reply_row_ids(a->out, at.id, ids[at.where]);
}

void cmd_nearest(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct query query = {.kind = QUERY_NEAREST, .k = 1};
    if (!read_place(s, a, q, &query.place))
        return;
    if (q->n == 5 && !read_count(a, &q->word[4], "a number of points", &query.k))
        return;
    query_answer(s, a, set, &query, query.k > NEAREST_AT_ONCE);
}

static void put_in_order(double *a, double *b)
{
    double t = *a;
    if (*a > *b) {
        *a = *b;
        *b = t;
    }
}

void cmd_within(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct query query = {.kind = q->n == 6 ? QUERY_BOX : QUERY_DISC};
    if (!read_point(a, &q->word[2], &query.place.at))
        return;
    if (query.kind == QUERY_BOX) {
        if (!read_point(a, &q->word[4], &query.hi))
            return;
        put_in_order(&query.place.at.x, &query.hi.x);
        put_in_order(&query.place.at.y, &query.hi.y);
    } else if (!read_length(a, &q->word[4], "radius", &query.radius)) {
        return;
    }
    query_answer(s, a, set, &query, set->current->sum.points > WITHIN_AT_ONCE);
}
