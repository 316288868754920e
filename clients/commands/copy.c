/* copy.c - `delaunay copy SET URL URL`: a set from one daemon to another, with its ids, fields, constraints and time of expiry.
 *
 * A load gives out ids without gaps. The copy gets a filler for each id that the original does not have, and deletes it
 * afterwards; so every point has the same id in the copy. A filler is at the place of the point before the gap: every coordinate
 * is possible there, and the filler becomes an alias. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "clients/cli/options.h"
#include "clients/lib/url.h"
#include "clients/meshes/model.h"
#include "proto/buf.h"
#include "proto/number.h"

enum { LINE_ROOM = 60000, RANGE = 1 << 24 /* ids that are loaded at a time */ };

struct copy {
    struct url url[2];
    struct delaunay_client *c[2]; /* own: from, to */
    const char *from, *to;        /* names */
    struct model m;
    char tol[40], ttl[40]; /* ttl "": no expiry */
    bool triangulated;
    size_t at; /* the points before that one have been sent */
};

static bool read_stat(struct copy *y)
{
    const struct delaunay_part *status = delaunay_status(y->c[0]);
    const char *value;
    size_t len;
    if (!delaunay_key(status, "tol", &value, &len) || len >= sizeof y->tol)
        return false;
    snprintf(y->tol, sizeof y->tol, "%.*s", (int)len, value);
    y->triangulated = delaunay_key(status, "triangulated", &value, &len) && len == 3;
    return true;
}

static void read_ttl(struct copy *y)
{
    const char *value;
    size_t len;
    if (delaunay_key(delaunay_status(y->c[0]), "ttl", &value, &len) && len < sizeof y->ttl)
        snprintf(y->ttl, sizeof y->ttl, "%.*s", (int)len, value);
}

/* A row for each of the ids first..first+n-1: its point and values, or a filler without values. */
static void fill_rows(const struct copy *y, size_t first, size_t n, double *xy, double *value)
{
    size_t k = y->m.fields, i = y->at;
    for (size_t row = 0; row < n; row++) {
        bool there = y->m.id[i] == first + row;
        const double *from = &y->m.xy[2 * (there || i == 0 ? i : i - 1)];
        memcpy(xy + 2 * row, from, 2 * sizeof *xy);
        for (size_t f = 0; f < k; f++)
            value[k * row + f] = there ? y->m.value[k * i + f] : (double)NAN;
        i += there;
    }
}

static void list_fields(const struct copy *y, char names[MODEL_MOST_FIELDS * (MODEL_NAME + 1)])
{
    names[0] = '\0';
    for (size_t f = 0, at = 0; f < y->m.fields; f++)
        at += (size_t)sprintf(names + at, "%s%s", f > 0 ? "," : "", y->m.field[f]);
}

static enum delaunay_result send_rows(struct copy *y, size_t first, size_t n)
{
    char names[MODEL_MOST_FIELDS * (MODEL_NAME + 1)];
    double *xy = malloc((n + 1) * 2 * sizeof *xy);
    double *value = malloc((n * y->m.fields + 1) * sizeof *value);
    enum delaunay_result r = DELAUNAY_NOMEM;
    list_fields(y, names);
    if (xy != NULL && value != NULL) {
        fill_rows(y, first, n, xy, value);
        r = delaunay_send_values(y->c[1], y->to, names, xy, value, n, NULL, NULL);
    }
    free(xy);
    free(value);
    return r == DELAUNAY_OK ? delaunay_receive(y->c[1], command_show_comment, NULL) : r;
}

static enum delaunay_result send_line(struct copy *y, struct buf *line)
{
    if (line->failed)
        return DELAUNAY_NOMEM;
    enum delaunay_result r = delaunay_send(y->c[1], buf_head(line), buf_len(line));
    buf_rewind(line, 0);
    return r == DELAUNAY_OK ? delaunay_receive(y->c[1], NULL, NULL) : r;
}

static void append_id(struct copy *y, struct buf *line, uint32_t id)
{
    char word[16] = " ";
    if (buf_len(line) == 0) {
        buf_append_text(line, "DEL ");
        buf_append_text(line, y->to);
    }
    buf_append(line, word, 1 + proto_write_u32(word + 1, id));
}

/* Deletes the fillers among the ids from..end-1. */
static enum delaunay_result delete_fillers(struct copy *y, size_t from, size_t end)
{
    struct buf line = {0};
    enum delaunay_result r = DELAUNAY_OK;
    for (size_t id = from; id < end && r == DELAUNAY_OK; id++) {
        if (y->m.id[y->at] == id)
            y->at++;
        else
            append_id(y, &line, (uint32_t)id);
        if (buf_len(&line) >= LINE_ROOM)
            r = send_line(y, &line);
    }
    if (r == DELAUNAY_OK && buf_len(&line) > 0)
        r = send_line(y, &line);
    buf_free(&line);
    return r;
}

static enum delaunay_result send_all(struct copy *y)
{
    size_t end = y->m.n > 0 ? (size_t)y->m.id[y->m.n - 1] + 1 : 0;
    enum delaunay_result r = end == 0 ? send_rows(y, 0, 0) : DELAUNAY_OK;
    for (size_t first = 0; first < end && r == DELAUNAY_OK; first += RANGE) {
        size_t n = end - first < RANGE ? end - first : RANGE;
        r = send_rows(y, first, n);
        if (r == DELAUNAY_OK)
            r = delete_fillers(y, first, first + n);
    }
    return r;
}

/* ---- constraints ---- */

/* The line of a request that is sent when it is long, or the next constraint has another kind or number. */
struct constraint_line {
    struct copy *y;
    struct buf text;
    char head[120];
    enum delaunay_result result;
};

static void send_constraints(struct constraint_line *l)
{
    if (l->result == DELAUNAY_OK && buf_len(&l->text) > 0)
        l->result = send_line(l->y, &l->text);
}

/* A row `a b line|border k`. */
static bool add_constraint(void *ctx, const struct delaunay_part *part)
{
    struct constraint_line *l = ctx;
    char row[64], kind[8], head[sizeof l->head], ends[32];
    unsigned a, b, k;
    if (part->kind != DELAUNAY_PART_ROW)
        return true;
    snprintf(row, sizeof row, "%.*s", (int)part->len, part->text);
    if (sscanf(row, "%u %u %7s %u", &a, &b, kind, &k) != 4) {
        l->result = DELAUNAY_BROKEN;
        return false;
    }
    bool border = strcmp(kind, "border") == 0;
    snprintf(head, sizeof head, "CONSTRAIN %s%s OF %u", l->y->to, border ? " BORDER" : "", k);
    if (strcmp(head, l->head) != 0 || buf_len(&l->text) >= LINE_ROOM)
        send_constraints(l);
    if (buf_len(&l->text) == 0)
        buf_append_text(&l->text, head);
    memcpy(l->head, head, sizeof head);
    snprintf(ends, sizeof ends, " %u %u", a, b);
    buf_append_text(&l->text, ends);
    return l->result == DELAUNAY_OK;
}

static enum delaunay_result copy_constraints(struct copy *y)
{
    struct constraint_line l = {.y = y, .result = DELAUNAY_OK};
    char line[100];
    snprintf(line, sizeof line, "CONSTRAINTS %s", y->from);
    enum delaunay_result r = delaunay_request(y->c[0], line, add_constraint, &l);
    bool older =
        r == DELAUNAY_REFUSED && strncmp(delaunay_status(y->c[0])->text, "ERR UNKNOWN ", 12) == 0;
    send_constraints(&l);
    buf_free(&l.text);
    return l.result != DELAUNAY_OK || older ? l.result : r;
}

/* ---- what a load may not give ---- */

/* A sum over the rows of a reply. */
static bool add_row(void *ctx, const struct delaunay_part *part)
{
    uint64_t *sum = ctx;
    for (size_t i = 0; part->kind == DELAUNAY_PART_ROW && i < part->len; i++)
        *sum = (*sum ^ (unsigned char)part->text[i]) * 0x100000001b3u;
    return true;
}

static enum delaunay_result sum_aliases(struct copy *y, int of, uint64_t *sum)
{
    char line[100];
    snprintf(line, sizeof line, "COINCIDENT %s", of == 0 ? y->from : y->to);
    *sum = 0xcbf29ce484222325u;
    return delaunay_request(y->c[of], line, add_row, sum);
}

/* With a tolerance, which points are aliases can depend on points that have been deleted since. */
static enum delaunay_result compare_aliases(struct copy *y, bool *equal)
{
    uint64_t sum[2] = {0, 0};
    enum delaunay_result r = DELAUNAY_OK;
    for (int i = 0; i < 2 && r == DELAUNAY_OK && strcmp(y->tol, "0") != 0; i++)
        r = sum_aliases(y, i, &sum[i]);
    *equal = sum[0] == sum[1];
    return r;
}

static int fetch(struct copy *y)
{
    char line[160];
    snprintf(line, sizeof line, "STAT %s", y->from);
    enum delaunay_result r = delaunay_request(y->c[0], line, NULL, NULL);
    if (r == DELAUNAY_OK && !read_stat(y))
        r = DELAUNAY_BROKEN;
    snprintf(line, sizeof line, "TTL %s", y->from);
    if (r == DELAUNAY_OK)
        r = delaunay_request(y->c[0], line, NULL, NULL);
    if (r == DELAUNAY_OK)
        read_ttl(y);
    if (r == DELAUNAY_OK)
        r = model_fetch(y->c[0], y->from, MODEL_FIELDS, &y->m);
    if (r != DELAUNAY_STOPPED)
        return command_outcome(y->c[0], r);
    message_print("%s", y->m.fault);
    return EXIT_REFUSED;
}

static void report(const struct copy *y)
{
    if (!json_chosen()) {
        printf("%s: %zu points copied to %s:%s as %s\n", y->from, y->m.n, y->url[1].host,
               y->url[1].port, y->to);
        return;
    }
    json_begin(true);
    json_text("from", y->from);
    json_text("to", y->to);
    json_number("points", y->m.n);
    json_finish();
}

static enum delaunay_result finish(struct copy *y, bool *equal)
{
    char line[200];
    enum delaunay_result r = DELAUNAY_OK;
    snprintf(line, sizeof line, "TRIANGULATE %s", y->to);
    if (y->triangulated)
        r = delaunay_request(y->c[1], line, command_show_comment, NULL);
    if (r == DELAUNAY_OK)
        r = compare_aliases(y, equal);
    snprintf(line, sizeof line, "EXPIRE %s %s", y->to, y->ttl);
    if (r == DELAUNAY_OK && *equal && y->ttl[0] != '\0')
        r = delaunay_request(y->c[1], line, NULL, NULL);
    return r;
}

/* Removes an incomplete copy. */
static void abandon(struct copy *y)
{
    char line[100];
    snprintf(line, sizeof line, "DROP %s", y->to);
    delaunay_request(y->c[1], line, NULL, NULL);
}

static int store(struct copy *y)
{
    char line[200];
    bool equal = true;
    int n = snprintf(line, sizeof line, "CREATE %s", y->to);
    if (strcmp(y->tol, "0") != 0)
        snprintf(line + n, sizeof line - (size_t)n, " TOL %s", y->tol);
    enum delaunay_result r = delaunay_request(y->c[1], line, NULL, NULL);
    if (r != DELAUNAY_OK)
        return command_outcome(y->c[1], r);
    r = send_all(y);
    if (r == DELAUNAY_OK)
        r = copy_constraints(y);
    if (r == DELAUNAY_OK)
        r = finish(y, &equal);
    if (r == DELAUNAY_OK && equal)
        report(y);
    else if (r == DELAUNAY_OK)
        message_print("%s: which points coincide depends on deleted points; nothing was copied",
                      y->from);
    int status = equal ? command_outcome(y->c[1], r) : EXIT_REFUSED;
    if (status != EXIT_DONE)
        abandon(y);
    return status;
}

static int connect_both(struct copy *y)
{
    char why[256];
    for (int i = 0; i < 2; i++) {
        y->c[i] = command_connect(&y->url[i], why, sizeof why);
        if (y->c[i] == NULL) {
            message_print("%s", why);
            return EXIT_NO_CONNECTION;
        }
    }
    return EXIT_DONE;
}

int command_copy(struct delaunay_client *c, int argc, char **argv)
{
    struct copy y = {.from = argc == 4 ? argv[1] : "", .to = ""};
    (void)c;
    if (argc != 4 || !url_read(argv[2], &y.url[0]) || !url_read(argv[3], &y.url[1]) ||
        !word_is_set_name(&(struct word){y.from, strlen(y.from)}))
        return options_wrong(argv[0], "copy takes a set and two URLs");
    y.to = y.url[1].set[0] != '\0' ? y.url[1].set : y.from;
    int status = connect_both(&y);
    if (status == EXIT_DONE)
        status = fetch(&y);
    if (status == EXIT_DONE)
        status = store(&y);
    delaunay_close(y.c[0]);
    delaunay_close(y.c[1]);
    model_free(&y.m);
    return status;
}
