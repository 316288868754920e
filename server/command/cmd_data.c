/* cmd_data.c - the commands about sets and their points. */
#include "server/command/command.h"
#include "server/jobs/expire.h"

#include "server/clients/clients.h"
#include "server/jobs/durable.h"
#include "server/jobs/submit.h"
#include "server/replies/listing.h"
#include "server/rows/answer_rows.h"
#include "server/sets/skip_copy.h"

#include <stdlib.h>
#include <string.h>

/* ---- sets ---- */

enum { SETS_A_PIECE = 256, ROW_BYTES = 96 };

static void add_row(struct dataset *set, void *ctx)
{
    struct listing_rows *rows = ctx;
    if (expire_is_due(set))
        return;
    const struct dt_summary *sum = &set->current->sum;
    bool triangulated = sum->triangulated || set->loading;
    buf_append(&rows->text, set->name, set->name_len);
    reply_key_u64(&rows->text, "points", sum->points);
    reply_key_text(&rows->text, "triangulated", triangulated ? "yes" : "no");
    reply_end(&rows->text);
    rows->n++;
}

static bool list_sets(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows)
{
    uint64_t most = rows->n + SETS_A_PIECE;
    do
        *at = registry_scan(&s->sets, (size_t)*at, add_row, rows);
    while (*at != 0 && rows->n < most);
    rows->shown = durable_last_lsn(s);
    return *at != 0;
}

void cmd_sets(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    listing_answer(s, a,
                   &(struct listing_plan){
                       .piece = list_sets, .sorted = true, .bytes = s->sets.sets * ROW_BYTES});
}

static bool read_making(struct server *s, struct answer *a, const struct request *q,
                        struct submission *x)
{
    struct session *who = s->clients != NULL ? clients_find(s->clients, a->owner) : NULL;
    for (size_t i = 2; i < q->n; i++) {
        if (word_is(&q->word[i], "TEMPORARY")) {
            x->temporary = who != NULL ? &who->temporary : NULL;
        } else if (word_is(&q->word[i], "TOL") && i + 1 < q->n) {
            if (!read_length(a, &q->word[++i], "tolerance", &x->change.a))
                return false;
        } else
            return answer_usage(a);
    }
    return true;
}

void cmd_create(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct submission *x = submission_new(s, a, CHANGE_CREATE, &q->word[1]);
    bool good = x != NULL && read_making(s, a, q, x);
    if (good && set == NULL) {
        submit(s, a, NULL, x);
        return;
    }
    if (good)
        answer_err(a, ERR_EXISTS, "the set %s already exists", set->name);
    if (x != NULL)
        job_free(s, &x->job);
}

void cmd_stat(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct dt_summary *sum = &set->current->sum;
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "points", sum->points);
    reply_key_u64(a->out, "coincident", sum->coincident);
    reply_key_text(a->out, "triangulated", sum->triangulated ? "yes" : "no");
    reply_key_u64(a->out, "triangles", sum->triangles);
    reply_key_u64(a->out, "edges", sum->edges);
    reply_key_u64(a->out, "hull", sum->hull);
    reply_key_u64(a->out, "memory", sum->memory);
    if (set->skip_copies != NULL)
        reply_key_u64(a->out, "copies", skip_copy_memory(set));
    reply_key_double(a->out, "tol", dt_tolerance(set->current->dt));
    if (sum->fields > 0)
        reply_key_u64(a->out, "fields", sum->fields);
    if (set->temporary)
        reply_key_text(a->out, "temporary", "yes");
    if (set->expires_ms != 0)
        reply_key_double(a->out, "ttl", expire_seconds_left(set));
    answer_version(a, set->version);
}

bool read_expiry(struct server *s, const struct dataset *set, const struct request *q,
                 struct answer *a, struct change *c)
{
    const struct word *w = &q->word[2];
    double seconds;
    if (!read_number(a, w, &seconds))
        return false;
    if (seconds > EXPIRE_MOST_S)
        return answer_err(a, ERR_RANGE, "a set is dropped within %d seconds, or never",
                          EXPIRE_MOST_S);
    c->a = (double)(expire_now_ms() + (seconds > 0 ? (int64_t)(seconds * 1000) : 0));
    return true;
}

void cmd_ttl(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    reply_ok(a->out, 0);
    if (set->expires_ms != 0)
        reply_key_double(a->out, "ttl", expire_seconds_left(set));
    reply_end(a->out);
}

void cmd_persist(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    bool changed = set->expires_ms != 0;
    if (changed)
        expire_never(s, set);
    a->lsn = durable_lsn(s, set);
    a->count = changed;
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "changed", changed);
    answer_version(a, set->version);
}

/* ---- points ---- */

/* The rows of q's words from `at` on, n of `width` numbers; NULL: the ERR line has been written. */
static double *read_rows(struct server *s, struct answer *a, const struct request *q, size_t at,
                         size_t n, size_t width)
{
    double *rows = dt_pages_grow(s->pages, NULL, 0, n * width * sizeof *rows);
    if (rows == NULL) {
        answer_out_of_memory(a);
        return NULL;
    }
    const struct word *w = &q->word[at];
    bool good = true;
    for (size_t i = 0; i < n * width && good; i++)
        good = i % width < 2 ? read_coordinate(a, &w[i], &rows[i]) : read_value(a, &w[i], &rows[i]);
    if (good)
        return rows;
    dt_pages_release(rows);
    return NULL;
}

/* Points, and the values of fields that are named before them. */
bool read_new_points(struct server *s, const struct dataset *set, const struct request *q,
                     struct answer *a, struct change *c)
{
    bool fields = word_is(&q->word[2], "FIELDS");
    if (fields && (c->columns = read_field_names(a, set, &q->word[3])) == NULL)
        return false;
    size_t at = fields ? 4 : 2, width = 2 + (fields ? c->columns->count : 0);
    c->first = CHANGE_ANY;
    c->n = (uint32_t)((q->n - at) / width);
    if ((q->n - at) % width != 0 || c->n == 0)
        return answer_err(a, ERR_SYNTAX,
                          fields ? "a point without all of its values"
                                 : "odd number of coordinates");
    double *rows = read_rows(s, a, q, at, c->n, width);
    if (rows != NULL)
        change_set_rows(c, rows);
    return rows != NULL;
}

bool read_ids_to_delete(struct server *s, const struct dataset *set, const struct request *q,
                        struct answer *a, struct change *c)
{
    bool cascade = q->n > 3 && word_is(&q->word[q->n - 1], "CASCADE");
    if (cascade && dt_constraints_count(set->current->dt) > 0)
        c->kind = &change_kinds[CHANGE_CASCADE];
    c->n = (uint32_t)(q->n - 2 - cascade);
    c->ids = read_ids(a, &q->word[2], c->n);
    return c->ids != NULL;
}

static bool read_moves(struct answer *a, const struct request *q, struct change *c)
{
    struct dt_point to = {0, 0};
    if (q->n % 3 != 2)
        return answer_usage(a);
    c->kind = &change_kinds[CHANGE_MOVES];
    c->n = (uint32_t)(q->n - 2) / 3;
    c->moves = malloc(c->n * sizeof *c->moves);
    if (c->moves == NULL)
        answer_out_of_memory(a);
    bool good = c->moves != NULL;
    for (uint32_t i = 0; good && i < c->n; i++) {
        const struct word *w = &q->word[2 + 3 * i];
        good = read_id(a, w, &c->moves[i].id) && read_point(a, w + 1, &to);
        c->moves[i].x = to.x;
        c->moves[i].y = to.y;
    }
    return good;
}

bool read_move(struct server *s, const struct dataset *set, const struct request *q,
               struct answer *a, struct change *c)
{
    struct dt_point to;
    if (q->n != 5)
        return read_moves(a, q, c);
    if (!read_id(a, &q->word[2], &c->first) || !read_point(a, &q->word[3], &to))
        return false;
    c->a = to.x;
    c->b = to.y;
    return true;
}

void cmd_get(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct dt_point p;
    size_t n = q->n - 2;
    struct dt_ids ids = {read_ids(a, &q->word[2], n), n, n};
    if (ids.v == NULL)
        return;
    for (size_t i = 0; i < n; i++) {
        if (dt_get(set->current->dt, ids.v[i], &p) != DT_OK) {
            answer_err(a, ERR_NOPOINT, "there is no point %u", ids.v[i]);
            free(ids.v);
            return;
        }
    }
    reply_ok(a->out, n);
    reply_end(a->out);
    struct rows rows = {.version = set->current, .form = ROW_POINT, .width = 1};
    answer_rows(s, a, &rows, &ids);
    free(ids.v);
}

void cmd_points(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    bool binary = word_is(&q->word[q->n - 1], "BINARY") && q->n % 2 == 1;
    bool names = q->n > 3 && word_is(&q->word[2], "FIELDS");
    const struct dt_field **field = NULL;
    size_t fields = 0;
    if (q->n != (names ? 4u : 2u) + binary)
        answer_usage(a);
    else if (!names || (field = find_fields(a, set, &q->word[3], &fields)) != NULL)
        answer_points(s, a, set->current, binary, field, fields);
}

void cmd_coincident(struct server *s, struct dataset *set, const struct request *q,
                    struct answer *a)
{
    answer_table(s, a, set->current, DT_COINCIDENT, false, false);
}
