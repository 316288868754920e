/* listing.c - see listing.h. */
#include "server/replies/listing.h"

#include "proto/resp.h"
#include "server/jobs/job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEND = 64 * 1024 };

enum phase { MAKING, SORTING, SENDING };

struct listing {
    struct stream stream; /* first */
    struct listing_plan plan;
    struct listing_rows rows;
    char pattern[LISTING_PATTERN]; /* that of the rows, if they have one */
    enum phase phase;
};

/* ---- sorting ---- */

/* The first words of rows are different, and the blank after them is smaller than any letter, so rows differ
 * before either of them ends. */
static int compare_rows(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static size_t length_of(const char *row)
{
    return strcspn(row, "\n") + 1;
}

static void list_rows(const char *text, const char **row, size_t n)
{
    for (size_t i = 0; i < n; i++, text += length_of(text))
        row[i] = text;
}

/* Sorts the rows. False when out of memory. */
static bool sort(struct listing_rows *rows)
{
    struct buf sorted = {0};
    size_t n = (size_t)rows->n, bytes = buf_len(&rows->text);
    const char **row = calloc(n + 1, sizeof *row);
    buf_append_char(&rows->text, '\0');
    bool good = row != NULL && !rows->text.failed && buf_reserve(&sorted, bytes + 1) != NULL;
    if (good) {
        list_rows(buf_head(&rows->text), row, n);
        qsort(row, n, sizeof *row, compare_rows);
        for (size_t i = 0; i < n; i++)
            buf_append(&sorted, row[i], length_of(row[i]));
    }
    free(row);
    buf_free(&rows->text);
    rows->text = sorted;
    return good;
}

struct sorting {
    struct job job;
    struct listing *listing;  /* borrows: not freed before the job ends */
    struct listing_rows rows; /* of the listing, which has none meanwhile */
};

static void run_sorting(struct job *j)
{
    struct sorting *it = (struct sorting *)j;
    it->job.status = sort(&it->rows) ? DT_OK : DT_NOMEM;
}

static void end_sorting(struct server *s, struct job *j, struct answer *a)
{
    struct sorting *it = (struct sorting *)j;
    struct listing *l = it->listing;
    l->rows = it->rows;
    l->rows.text.failed |= j->status != DT_OK;
    l->phase = SENDING;
    stream_job_ended(s, &l->stream);
}

static void begin_sorting(struct server *s, struct listing *l)
{
    struct sorting *it = job_new(sizeof *it, run_sorting, end_sorting);
    if (it == NULL) {
        l->rows.text.failed = true;
        l->phase = SENDING;
        return;
    }
    it->listing = l;
    it->rows = l->rows;
    l->rows.text = (struct buf){0};
    l->phase = SORTING;
    l->stream.jobs++;
    job_aside(s, NULL, &it->job, JOB_SHORT);
}

/* ---- sending ---- */

static void append_head(const struct listing *l, struct buf *out)
{
    char head[32];
    switch (l->plan.frame) {
    case LISTING_LINES:
        reply_ok(out, l->rows.n);
        reply_end(out);
        break;
    case LISTING_BULK:
        snprintf(head, sizeof head, "$%zu\r\n", buf_len(&l->rows.text));
        buf_append_text(out, head);
        break;
    case LISTING_ARRAY:
        resp_array(out, (size_t)l->rows.n);
        break;
    }
}

static void append_error(const struct listing *l, struct answer *a)
{
    if (l->plan.frame == LISTING_LINES)
        answer_err(a, ERR_NOMEM, "out of memory; nothing has changed");
    else
        buf_append_text(a->out, "-NOMEM out of memory; nothing has changed\r\n");
    a->refused = true;
}

/* The number of bytes to send next: whole rows, unless they are framed. */
static size_t next_bytes(const struct listing *l)
{
    const char *text = buf_head(&l->rows.text);
    size_t n = buf_len(&l->rows.text);
    if (n <= SEND)
        return n;
    const char *end = l->plan.frame == LISTING_LINES ? memrchr(text, '\n', SEND) : NULL;
    return end != NULL ? (size_t)(end - text) + 1 : SEND;
}

/* True: the listing is complete. */
static bool send_rows(struct listing *l, struct answer *a)
{
    struct buf *out = a->out;
    if (l->rows.text.failed) { /* before anything has been appended */
        append_error(l, a);
        return true;
    }
    if (!l->stream.begun) {
        append_head(l, out);
        a->shown = l->rows.shown;
    }
    l->stream.begun = true;
    size_t n = next_bytes(l);
    buf_append(out, buf_head(&l->rows.text), n);
    buf_consume(&l->rows.text, n);
    if (buf_len(&l->rows.text) > 0)
        return false;
    if (l->plan.frame == LISTING_BULK)
        buf_append(out, "\r\n", 2);
    return true;
}

/* ---- pieces ---- */

static bool make_piece(struct server *s, struct listing *l)
{
    return l->plan.piece(s, &l->plan.at, l->plan.end, &l->rows);
}

static bool refill(struct server *s, struct stream *st, struct answer *a)
{
    struct listing *l = (struct listing *)st;
    if (l->phase == MAKING && make_piece(s, l)) {
        stream_wake(st);
        return true;
    }
    if (l->phase == MAKING) {
        reservation_set(&st->memory, l->rows.text.cap * (l->plan.sorted ? 2 : 1));
        l->phase = SENDING;
        if (l->plan.sorted)
            begin_sorting(s, l);
    }
    if (l->phase != SENDING || !send_rows(l, a))
        return true;
    a->broken = a->out->failed;
    return false;
}

static void clear(struct server *s, struct stream *st)
{
    buf_free(&((struct listing *)st)->rows.text);
}

/* All rows have been made: they are few. */
static void answer_at_once(struct answer *a, struct listing *l)
{
    if (l->plan.sorted && !sort(&l->rows))
        l->rows.text.failed = true;
    while (!send_rows(l, a))
        ;
}

static void refuse(struct server *s, struct answer *a, const struct listing_plan *plan)
{
    if (plan->frame == LISTING_LINES)
        server_refuse(s, a, plan->bytes);
    else
        buf_append_text(a->out, "-BUSY not enough free memory at the moment; try again\r\n");
    a->refused = true;
}

static struct listing *new_listing(struct server *s, const struct listing_plan *plan)
{
    static const struct stream_kind kind = {.refill = refill, .clear = clear};
    struct listing *l = calloc(1, sizeof *l);
    if (l == NULL)
        return NULL;
    l->plan = *plan;
    l->stream.kind = &kind;
    l->stream.framed = plan->frame != LISTING_LINES;
    l->stream.memory = server_reservation(s, BUDGET_REPLIES);
    if (plan->pattern != NULL) {
        l->rows.pattern = memcpy(l->pattern, plan->pattern->text, plan->pattern->len);
        l->rows.pattern_len = plan->pattern->len;
        l->plan.pattern = NULL; /* it is the request's */
    }
    return l;
}

void listing_answer(struct server *s, struct answer *a, const struct listing_plan *plan)
{
    struct listing *l = new_listing(s, plan);
    if (l == NULL) {
        answer_out_of_memory(a);
        return;
    }
    if (!make_piece(s, l)) {
        answer_at_once(a, l);
    } else if (!reservation_resize(&l->stream.memory, plan->bytes * (plan->sorted ? 2 : 1))) {
        refuse(s, a, plan);
    } else {
        a->next = ANSWER_STREAM;
        a->stream = &l->stream;
        return;
    }
    stream_free(s, &l->stream);
}
