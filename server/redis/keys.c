/* keys.c - see handlers.h. Sets as keys. */
#include "server/redis/handlers.h"

#include "proto/number.h"
#include "proto/resp.h"
#include "server/jobs/durable.h"
#include "server/jobs/expire.h"
#include "server/ops/glob.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char type_name[] = "pointset"; /* as modules of Redis have types of their own */

/* At the start there are no sets until the data directory has been read. Replies about sets show all changes. */
bool redis_sees_sets(struct server *s, struct answer *a)
{
    struct buf *out = a->out;
    a->out = &a->reactor->lines; /* of the error, which is converted to RESP */
    if (!durable_loaded(s, a))
        return false;
    a->out = out;
    a->shown = durable_last_lsn(s);
    return true;
}

struct dataset *redis_find(struct server *s, const struct word *name)
{
    struct dataset *set = registry_find(&s->sets, name);
    if (set != NULL && expire_drop_if_due(s, set))
        return NULL;
    return set != NULL && set->born ? set : NULL;
}

void redis_dbsize(struct server *s, const struct request *q, struct answer *a)
{
    redis_integer(a, (int64_t)s->sets.sets);
}

void redis_exists(struct server *s, const struct request *q, struct answer *a)
{
    int64_t n = 0;
    for (size_t i = 1; i < q->n; i++)
        n += redis_find(s, &q->word[i]) != NULL;
    redis_integer(a, n);
}

void redis_type(struct server *s, const struct request *q, struct answer *a)
{
    char text[32];
    snprintf(text, sizeof text, "+%s", redis_find(s, &q->word[1]) != NULL ? type_name : "none");
    redis_simple(a, text);
}

void redis_memory(struct server *s, const struct request *q, struct answer *a)
{
    bool samples = q->n == 5 && word_is(&q->word[3], "SAMPLES");
    if ((q->n != 3 && !samples) || !word_is(&q->word[1], "USAGE")) {
        redis_usage(a, "MEMORY USAGE set");
        return;
    }
    if (!redis_sees_sets(s, a))
        return;
    const struct dataset *set = redis_find(s, &q->word[2]);
    if (set != NULL)
        redis_integer(a, (int64_t)set->current->sum.memory);
    else
        redis_null(a);
}

void redis_object(struct server *s, const struct request *q, struct answer *a)
{
    if (redis_find(s, &q->word[2]) == NULL)
        redis_null(a);
    else if (word_is(&q->word[1], "ENCODING"))
        redis_bulk_text(a, type_name);
    else
        redis_integer(a, word_is(&q->word[1], "REFCOUNT"));
}

/* ---- deleting ---- */

/* Drops the set. False: it has been answered with an error, or waits. */
static bool drop(struct server *s, const struct word *name, struct answer *a)
{
    struct word words[] = {{"DROP", 4}, *name};
    return redis_run(s, &(struct request){.word = words, .n = 2}, a);
}

/* A set that has a writer or readers now is dropped first. So only the first DROP may have to wait, and a request that is carried
 * out again after waiting counts every set. */
void redis_unlink(struct server *s, const struct request *q, struct answer *a)
{
    int64_t n = 0;
    for (size_t i = 1; i < q->n; i++) {
        const struct dataset *set = redis_find(s, &q->word[i]);
        if (set == NULL || dataset_admits(set, true, a->turn))
            continue;
        if (!drop(s, &q->word[i], a))
            return;
        n++;
    }
    for (size_t i = 1; i < q->n; i++) {
        if (redis_find(s, &q->word[i]) == NULL)
            continue;
        if (!drop(s, &q->word[i], a))
            return;
        n++;
    }
    redis_integer(a, n);
}

bool redis_del_is_misused(const struct request *q)
{
    uint32_t id;
    bool ids = q->n > 2;
    size_t n = q->n > 3 && word_is(&q->word[q->n - 1], "CASCADE") ? q->n - 1 : q->n;
    for (size_t i = 2; i < n && ids; i++)
        ids = proto_read_u32(q->word[i].text, q->word[i].len, &id);
    return !ids && q->n > 1;
}

/* ---- names ---- */

static bool good_pattern(struct answer *a, const struct word *pattern)
{
    char text[64];
    if (pattern->len <= GLOB_LIMIT)
        return true;
    snprintf(text, sizeof text, "SYNTAX a pattern has at most %d bytes", GLOB_LIMIT);
    redis_error(a, text);
    return false;
}

static void add_name(struct dataset *set, void *ctx)
{
    struct listing_rows *rows = ctx;
    if (expire_is_due(set) ||
        !glob_matches(rows->pattern, rows->pattern_len, set->name, set->name_len, GLOB_CASED))
        return;
    resp_bulk(&rows->text, set->name, set->name_len);
    rows->n++;
}

static bool list_names(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows)
{
    enum { BUCKETS_A_PIECE = 512 };
    int left = BUCKETS_A_PIECE;
    do
        *at = registry_scan(&s->sets, (size_t)*at, add_name, rows);
    while (*at != 0 && --left > 0);
    rows->shown = durable_last_lsn(s);
    return *at != 0;
}

void redis_keys(struct server *s, const struct request *q, struct answer *a)
{
    enum { ROW_BYTES = 80 };
    if (good_pattern(a, &q->word[1]) && redis_sees_sets(s, a))
        listing_answer(s, a,
                       &(struct listing_plan){.piece = list_names,
                                              .frame = LISTING_ARRAY,
                                              .pattern = &q->word[1],
                                              .bytes = s->sets.sets * ROW_BYTES});
}

/* SCAN cursor [MATCH pattern] [COUNT n] [TYPE type] */
struct scan {
    uint64_t cursor;
    uint32_t count; /* names to be looked at, about */
    bool other;     /* another type than that of sets is asked for */
    struct listing_rows rows;
};

static bool read_option(struct answer *a, const struct word *w, struct scan *scan)
{
    if (word_is(&w[0], "MATCH")) {
        scan->rows.pattern = w[1].text;
        scan->rows.pattern_len = w[1].len;
        return good_pattern(a, &w[1]);
    }
    if (word_is(&w[0], "COUNT") && proto_read_u32(w[1].text, w[1].len, &scan->count) &&
        scan->count > 0)
        return true;
    if (word_is(&w[0], "TYPE")) {
        scan->other = !word_is(&w[1], "POINTSET");
        return true;
    }
    redis_error(a, "SYNTAX SCAN takes MATCH pattern, COUNT n with n from 1 on, TYPE type");
    return false;
}

static bool read_scan(struct answer *a, const struct request *q, struct scan *scan)
{
    enum { USUAL = 10 };
    *scan = (struct scan){.count = USUAL, .rows = {.pattern = "*", .pattern_len = 1}};
    if (q->n < 2 || q->n % 2 != 0) {
        redis_usage(a, "SCAN cursor [MATCH pattern] [COUNT n] [TYPE type]");
        return false;
    }
    if (!proto_read_u64(q->word[1].text, q->word[1].len, &scan->cursor)) {
        redis_error(a, "NUMBER that is not a cursor of SCAN");
        return false;
    }
    for (size_t i = 2; i < q->n; i += 2)
        if (!read_option(a, &q->word[i], scan))
            return false;
    return true;
}

/* Visits buckets until they had about `count` sets, or many were empty. COUNT is a hint [Redis, SCAN]. */
static void scan_some(const struct server *s, struct scan *scan)
{
    enum { MOST = 256, EMPTY = 10 };
    uint32_t count = scan->count < MOST ? scan->count : MOST, visits = count * EMPTY;
    do
        scan->cursor = registry_scan(&s->sets, (size_t)scan->cursor, add_name, &scan->rows);
    while (scan->cursor != 0 && scan->rows.n < count && --visits > 0);
}

void redis_scan(struct server *s, const struct request *q, struct answer *a)
{
    struct scan scan;
    char cursor[24];
    if (!read_scan(a, q, &scan) || !redis_sees_sets(s, a))
        return;
    scan_some(s, &scan);
    snprintf(cursor, sizeof cursor, "%" PRIu64, scan.cursor);
    resp_array(a->out, 2);
    redis_bulk_text(a, cursor);
    resp_array(a->out, scan.other ? 0 : scan.rows.n);
    if (!scan.other && scan.rows.n > 0)
        buf_append(a->out, buf_head(&scan.rows.text), buf_len(&scan.rows.text));
    a->out->failed |= scan.rows.text.failed;
    buf_free(&scan.rows.text);
}
