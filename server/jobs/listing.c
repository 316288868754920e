/* listing.c - see listing.h. */
#include "server/jobs/listing.h"

#include "proto/resp.h"
#include "server/jobs/job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEND = 64 * 1024 };

enum phase { MAKING, SORTING, SENDING };

struct listing {
    listing_piece *piece;
    uint64_t at, end;
    struct listing_rows rows;
    bool sorted; /* the rows are sorted by their first words */
    enum listing_frame frame;
    char pattern[LISTING_PATTERN]; /* that of the rows, if they have one */
    enum phase phase;
    bool begun;                /* the first byte has been appended */
    struct reservation memory; /* for the rows */
    void (*ready)(void *ctx);
    void *ctx;
    struct job *job; /* borrows: sorts the rows; NULL: none */
    bool abandoned;  /* freed while the job runs */
};

void listing_free(struct listing *l)
{
    l->abandoned = true;
    if (l->job != NULL)
        return;
    buf_free(&l->rows.text);
    reservation_set(&l->memory, 0);
    free(l);
}

void listing_notify(struct listing *l, void (*ready)(void *ctx), void *ctx)
{
    l->ready = ready;
    l->ctx = ctx;
}

static void call_ready(struct listing *l)
{
    if (l->ready != NULL)
        l->ready(l->ctx);
}

enum listing_frame listing_frame(const struct listing *l)
{
    return l->frame;
}

bool listing_has_begun(const struct listing *l)
{
    return l->begun;
}

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
    (void)s, (void)a;
    l->rows = it->rows;
    l->rows.text.failed |= j->status != DT_OK;
    l->job = NULL;
    l->phase = SENDING;
    if (l->abandoned)
        listing_free(l);
    else
        call_ready(l);
}

static void begin_sorting(struct server *s, struct listing *l)
{
    struct sorting *it = job_new(sizeof *it, run_sorting, end_sorting);
    if (it == NULL) {
        l->rows.text.failed = true;
        l->phase = SENDING;
        call_ready(l);
        return;
    }
    it->listing = l;
    it->rows = l->rows;
    l->rows.text = (struct buf){0};
    l->phase = SORTING;
    l->job = &it->job;
    job_aside(s, NULL, &it->job, JOB_SHORT);
}

/* ---- sending ---- */

static void append_head(const struct listing *l, struct buf *out)
{
    char head[32];
    switch (l->frame) {
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
    if (l->frame == LISTING_LINES)
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
    const char *end = l->frame == LISTING_LINES ? memrchr(text, '\n', SEND) : NULL;
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
    if (!l->begun) {
        append_head(l, out);
        a->shown = l->rows.shown;
    }
    l->begun = true;
    size_t n = next_bytes(l);
    buf_append(out, buf_head(&l->rows.text), n);
    buf_consume(&l->rows.text, n);
    if (buf_len(&l->rows.text) > 0)
        return false;
    if (l->frame == LISTING_BULK)
        buf_append(out, "\r\n", 2);
    return true;
}

/* ---- pieces ---- */

void listing_refill(struct server *s, struct answer *a)
{
    struct listing *l = a->listing;
    if (l->phase == MAKING && l->piece(s, &l->at, l->end, &l->rows)) {
        call_ready(l);
        return;
    }
    if (l->phase == MAKING) {
        reservation_set(&l->memory, l->rows.text.cap * (l->sorted ? 2 : 1));
        l->phase = SENDING;
        if (l->sorted)
            begin_sorting(s, l);
    }
    if (l->phase != SENDING || !send_rows(l, a))
        return;
    a->next = ANSWER_DONE;
    a->broken = a->out->failed;
    listing_free(l);
}

/* All rows have been made: they are few. */
static void answer_at_once(struct answer *a, struct listing *l)
{
    if (l->sorted && !sort(&l->rows))
        l->rows.text.failed = true;
    while (!send_rows(l, a))
        ;
    listing_free(l);
}

static void begin(struct server *s, struct answer *a, const struct listing *what, size_t bytes)
{
    struct listing *l = malloc(sizeof *l);
    if (l == NULL) {
        answer_out_of_memory(a);
        return;
    }
    *l = *what;
    if (l->rows.pattern != NULL)
        l->rows.pattern = memcpy(l->pattern, l->rows.pattern, l->rows.pattern_len);
    l->memory = server_reservation(s, BUDGET_REPLIES);
    if (!l->piece(s, &l->at, l->end, &l->rows)) {
        answer_at_once(a, l);
        return;
    }
    if (!reservation_resize(&l->memory, l->sorted ? 2 * bytes : bytes)) {
        if (l->frame == LISTING_LINES)
            server_refuse(s, a, bytes);
        else
            buf_append_text(a->out, "-BUSY not enough free memory at the moment; try again\r\n");
        a->refused = true;
        listing_free(l);
        return;
    }
    a->next = ANSWER_LISTING;
    a->listing = l;
}

void listing_answer(struct server *s, struct answer *a, listing_piece *piece, bool sorted,
                    uint64_t at, uint64_t end, size_t bytes)
{
    begin(s, a, &(struct listing){.piece = piece, .sorted = sorted, .at = at, .end = end}, bytes);
}

void listing_answer_framed(struct server *s, struct answer *a, listing_piece *piece,
                           enum listing_frame frame, uint64_t at, uint64_t end, size_t bytes)
{
    begin(s, a, &(struct listing){.piece = piece, .frame = frame, .at = at, .end = end}, bytes);
}

void listing_answer_matching(struct server *s, struct answer *a, listing_piece *piece,
                             enum listing_frame frame, const struct word *pattern, size_t bytes)
{
    struct listing_rows rows = {.pattern = pattern->text, .pattern_len = pattern->len};
    begin(s, a, &(struct listing){.piece = piece, .frame = frame, .rows = rows}, bytes);
}
