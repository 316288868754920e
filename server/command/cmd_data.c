/* cmd_data.c - the commands about sets and their points. */
#include "server/command/command.h"
#include "server/command/expire.h"

#include "proto/number.h"
#include "server/clients/clients.h"
#include "server/jobs/edit.h"
#include "server/jobs/journal.h"
#include "server/jobs/listing.h"
#include "server/jobs/stream.h"

#include <stdio.h>
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
    (void)end;
    do
        *at = registry_scan(&s->sets, (size_t)*at, add_row, rows);
    while (*at != 0 && rows->n < most);
    rows->shown = journal_of_all(s);
    return *at != 0;
}

void cmd_sets(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)set, (void)q;
    listing_answer(s, a, list_sets, true, 0, 0, s->sets.sets * ROW_BYTES);
}

/* How a set is to be created. */
struct making {
    double tolerance;
    bool temporary;
};

static bool read_making(struct answer *a, const struct request *q, struct making *m)
{
    *m = (struct making){0};
    for (size_t i = 2; i < q->n; i++) {
        if (word_is(&q->word[i], "TEMPORARY")) {
            m->temporary = true;
        } else if (word_is(&q->word[i], "TOL") && i + 1 < q->n) {
            if (!read_length(a, &q->word[++i], "tolerance", &m->tolerance))
                return false;
        } else {
            answer_usage(a, q);
            return false;
        }
    }
    return true;
}

void cmd_create(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct making m;
    struct session *who = s->clients != NULL ? clients_find(s->clients, a->owner) : NULL;
    if (!read_making(a, q, &m))
        return;
    if (set != NULL) {
        reply_err(a->out, ERR_EXISTS, "the set %s already exists", set->name);
        return;
    }
    set = edit_create(s, a, &q->word[1], m.tolerance);
    if (set == NULL)
        return;
    if (m.temporary && who != NULL && !dataset_make_temporary(set, &who->temporary)) {
        registry_drop(&s->sets, set);
        answer_out_of_memory(a);
        return;
    }
    set->born = true;
    journal_create(s, set, m.tolerance);
    a->lsn = journal_of(s, set);
    answer_changed(a, set->version);
}

void cmd_drop(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)q;
    journal_drop(s, set);
    a->lsn = journal_of(s, NULL);
    registry_drop(&s->sets, set);
    answer_ok(a);
}

void cmd_stat(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct dt_summary *sum = &set->current->sum;
    (void)s, (void)q;
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "points", sum->points);
    reply_key_u64(a->out, "coincident", sum->coincident);
    reply_key_text(a->out, "triangulated", sum->triangulated ? "yes" : "no");
    reply_key_u64(a->out, "triangles", sum->triangles);
    reply_key_u64(a->out, "edges", sum->edges);
    reply_key_u64(a->out, "hull", sum->hull);
    reply_key_u64(a->out, "memory", sum->memory);
    reply_key_double(a->out, "tol", dt_tolerance(set->current->dt));
    if (sum->fields > 0)
        reply_key_u64(a->out, "fields", sum->fields);
    if (set->temporary)
        reply_key_text(a->out, "temporary", "yes");
    if (set->expires_ms != 0)
        reply_key_double(a->out, "ttl", expire_seconds_left(set));
    answer_version(a, set->version);
}

void cmd_expire(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct word *w = &q->word[2];
    double seconds;
    if (!proto_read_double(w->text, w->len, &seconds)) {
        reply_err(a->out, ERR_NUMBER, "%.*s is not a number", QUOTED(w));
    } else if (seconds > EXPIRE_MOST_S) {
        reply_err(a->out, ERR_RANGE, "a set is dropped within %d seconds, or never", EXPIRE_MOST_S);
    } else {
        expire_after(s, set, seconds);
        a->lsn = journal_of(s, set);
        answer_changed(a, set->version);
    }
}

void cmd_ttl(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    (void)s, (void)q;
    reply_ok(a->out, 0);
    if (set->expires_ms != 0)
        reply_key_double(a->out, "ttl", expire_seconds_left(set));
    reply_end(a->out);
}

void cmd_persist(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    bool changed = set->expires_ms != 0;
    (void)q;
    if (changed)
        expire_never(s, set);
    a->lsn = journal_of(s, set);
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

static void add(struct server *s, struct dataset *set, const struct request *q, struct answer *a,
                size_t at, struct arrival *points)
{
    size_t columns = points->values == NULL ? 0 : points->values->count;
    size_t width = 2 + columns;
    points->n = (q->n - at) / width;
    if ((q->n - at) % width != 0 || points->n == 0)
        reply_err(a->out, ERR_SYNTAX,
                  columns == 0 ? "odd number of coordinates" : "a point without all of its values");
    else if ((points->rows = read_rows(s, a, q, at, points->n, width)) == NULL)
        ;
    else if (edit_may_add(s, a, set, points->n, columns, &points->memory)) {
        edit_add(s, a, &q->word[1], points);
        return;
    }
    dt_pages_release(points->rows);
    columns_free(points->values);
}

void cmd_add(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct arrival points = {.n = 0};
    bool fields = word_is(&q->word[2], "FIELDS");
    if (fields && (points.values = read_field_names(a, set, &q->word[3])) == NULL)
        return;
    add(s, set, q, a, fields ? 4 : 2, &points);
}

void cmd_del(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    uint32_t *ids = read_ids(a, &q->word[2], q->n - 2);
    if (ids != NULL)
        edit_delete(s, a, set, ids, q->n - 2);
}

void cmd_move(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    uint32_t id;
    struct dt_point to;
    if (read_id(a, &q->word[2], &id) && read_point(a, &q->word[3], &to))
        edit_move(s, a, set, id, to);
}

void cmd_get(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct dt_point p;
    (void)s;
    size_t n = q->n - 2;
    struct dt_ids ids = {read_ids(a, &q->word[2], n), n, n};
    if (ids.v == NULL)
        return;
    for (size_t i = 0; i < n; i++) {
        if (dt_get(set->current->dt, ids.v[i], &p) != DT_OK) {
            reply_err(a->out, ERR_NOPOINT, "there is no point %u", ids.v[i]);
            free(ids.v);
            return;
        }
    }
    reply_ok(a->out, n);
    reply_end(a->out);
    struct rows rows = {.version = set->current, .form = ROW_POINT, .width = 1};
    stream_answer(s, a, &rows, &ids);
    free(ids.v);
}

void cmd_points(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    bool binary = word_is(&q->word[q->n - 1], "BINARY") && q->n % 2 == 1;
    bool names = q->n > 3 && word_is(&q->word[2], "FIELDS");
    const struct dt_field **field = NULL;
    size_t fields = 0;
    if (q->n != (names ? 4u : 2u) + binary)
        answer_usage(a, q);
    else if (!names || (field = find_fields(a, set, &q->word[3], &fields)) != NULL)
        stream_answer_points(s, a, set->current, binary, field, fields);
}

void cmd_coincident(struct server *s, struct dataset *set, const struct request *q,
                    struct answer *a)
{
    (void)s, (void)q;
    stream_answer_table(s, a, set->current, DT_COINCIDENT, false, false);
}
