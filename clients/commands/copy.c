/* copy.c - `delaunay copy SET URL URL`: a set from one daemon to another, with its ids, fields, constraints and time of expiry.
 *
 * A load gives out ids without gaps. The copy gets a filler for each id that the original does not have, and deletes it
 * afterwards; so every point has the same id in the copy. A filler is at the place of the point before the gap: every coordinate
 * is possible there, and the filler becomes an alias. Constraints come in one request with all points. Until it is complete, the copy has
 * an expiry, which drops it if this program ends. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"
#include "clients/lib/url.h"
#include "clients/meshes/model.h"
#include "proto/buf.h"
#include "proto/number.h"

enum {
    LINE_ROOM = 60000,
    RANGE = 1 << 24, /* ids that are loaded at a time, without constraints */
    EXPIRY_S = 86400
};

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

/* Four numbers for each constraint, as LOADB has them. */
static void fill_constraints(const struct model *m, uint32_t *row)
{
    for (size_t i = 0; i < m->constraints; i++) {
        const uint32_t *c = m->constraint + 3 * i;
        memcpy(row + 4 * i, (const uint32_t[]){m->id[c[0]], m->id[c[1]], c[2] % 2, c[2] / 2},
               4 * sizeof row[0]);
    }
}

static enum delaunay_result send_rows(struct copy *y, size_t first, size_t n)
{
    char names[MODEL_MOST_FIELDS * (MODEL_NAME + 1)];
    const size_t constraints = y->m.constraints;
    double *xy = malloc((n + 1) * 2 * sizeof *xy);
    double *value = malloc((n * y->m.fields + 1) * sizeof *value);
    uint32_t *row = malloc((4 * constraints + 1) * sizeof row[0]);
    enum delaunay_result r = DELAUNAY_NOMEM;
    list_fields(y, names);
    if (xy != NULL && value != NULL && row != NULL) {
        fill_rows(y, first, n, xy, value);
        fill_constraints(&y->m, row);
        r = constraints == 0 ? delaunay_send_values(y->c[1], y->to, names, xy, value, n, NULL, NULL)
                             : delaunay_send_drawing(y->c[1], y->to, names, xy, value, n, row,
                                                     constraints, false, NULL, NULL);
    }
    free(xy);
    free(value);
    free(row);
    return r == DELAUNAY_OK ? delaunay_receive(y->c[1], request_show_comment, NULL) : r;
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
    size_t end = y->m.n > 0 ? (size_t)y->m.id[y->m.n - 1] + 1 : 0,
           range = y->m.constraints > 0 ? end : RANGE;
    enum delaunay_result r = end == 0 ? send_rows(y, 0, 0) : DELAUNAY_OK;
    for (size_t first = 0; first < end && r == DELAUNAY_OK; first += range) {
        size_t n = end - first < range ? end - first : range;
        r = send_rows(y, first, n);
        if (r == DELAUNAY_OK)
            r = delete_fillers(y, first, first + n);
    }
    return r;
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
        r = model_fetch(y->c[0], y->from, MODEL_FIELDS | MODEL_CONSTRAINTS, &y->m);
    if (r != DELAUNAY_STOPPED)
        return request_outcome(y->c[0], r);
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
        r = delaunay_request(y->c[1], line, request_show_comment, NULL);
    if (r == DELAUNAY_OK)
        r = compare_aliases(y, equal);
    bool expires = y->ttl[0] != '\0';
    snprintf(line, sizeof line, "%s %s%s%s", expires ? "EXPIRE" : "PERSIST", y->to,
             expires ? " " : "", y->ttl);
    if (r == DELAUNAY_OK && *equal)
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
        return request_outcome(y->c[1], r);
    snprintf(line, sizeof line, "EXPIRE %s %d", y->to, EXPIRY_S);
    r = delaunay_request(y->c[1], line, NULL, NULL);
    if (r == DELAUNAY_OK)
        r = send_all(y);
    if (r == DELAUNAY_OK)
        r = finish(y, &equal);
    if (r == DELAUNAY_OK && equal)
        report(y);
    else if (r == DELAUNAY_OK)
        message_print("%s: which points coincide depends on deleted points; nothing was copied",
                      y->from);
    int status = equal ? request_outcome(y->c[1], r) : EXIT_REFUSED;
    if (status != EXIT_DONE)
        abandon(y);
    return status;
}

static int connect_both(struct copy *y)
{
    char why[256];
    for (int i = 0; i < 2; i++) {
        y->c[i] = request_connect(&y->url[i], why, sizeof why);
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
    if (argc != 4)
        return options_wrong(argv[0], "copy takes a set and two URLs");
    if (!word_is_set_name(&(struct word){y.from, strlen(y.from)}))
        return options_wrong(argv[0], "%s: " URL_SET_NAMES, y.from);
    for (int i = 0; i < 2; i++)
        if (!url_read(argv[2 + i], &y.url[i]))
            return options_wrong(argv[0], "%s is not " URL_FORM, argv[2 + i]);
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
