/* copy.c - `delaunay copy SET URL URL`: a set from one daemon to another, with its ids and fields.
 *
 * A load gives out ids without gaps. Where the original has gaps the copy gets fillers, points far
 * from all others, that are deleted at the end; so every point has the same id in the copy. */
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

enum { LINE_ROOM = 60000 };

struct copy {
    struct url url[2];
    struct delaunay_client *c[2]; /* own: from, to */
    const char *from, *to;        /* names */
    struct model m;
    char tol[40];
    bool triangulated;
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

/* A place that coincides with no point: to the right of all points, farther than any tolerance. */
static double filler_x(const struct copy *y)
{
    double x = 0, tol = strtod(y->tol, NULL);
    for (size_t i = 0; i < y->m.n; i++)
        x = fmax(x, fabs(y->m.xy[2 * i]));
    return 2 * x + 4 * tol + 1;
}

/* A row for each id below n: its point and values, or a filler at x without values. */
static void fill_rows(const struct copy *y, size_t n, double x, double *xy, double *value)
{
    size_t k = y->m.fields;
    for (size_t id = 0, i = 0; id < n; id++) {
        bool there = y->m.id[i] == id;
        xy[2 * id] = there ? y->m.xy[2 * i] : x;
        xy[2 * id + 1] = there ? y->m.xy[2 * i + 1] : 0;
        for (size_t f = 0; f < k; f++)
            value[k * id + f] = there ? y->m.value[k * i + f] : (double)NAN;
        i += there;
    }
}

static enum delaunay_result send_all(struct copy *y)
{
    char names[MODEL_MOST_FIELDS * (MODEL_NAME + 1)] = "";
    for (size_t f = 0, at = 0; f < y->m.fields; f++)
        at += (size_t)snprintf(names + at, sizeof names - at, "%s%s", f > 0 ? "," : "",
                               y->m.field[f]);
    size_t n = y->m.n > 0 ? (size_t)y->m.id[y->m.n - 1] + 1 : 0;
    double *xy = malloc((n + 1) * 2 * sizeof *xy), x = filler_x(y);
    double *value = malloc((n * y->m.fields + 1) * sizeof *value);
    enum delaunay_result r = DELAUNAY_NOMEM;
    if (xy != NULL && value != NULL) {
        fill_rows(y, n, x, xy, value);
        r = delaunay_send_values(y->c[1], y->to, names, xy, value, n, NULL, NULL);
    }
    free(xy);
    free(value);
    return r == DELAUNAY_OK ? delaunay_receive(y->c[1], command_show_comment, NULL) : r;
}

static enum delaunay_result delete_fillers(struct copy *y)
{
    struct buf line = {0};
    enum delaunay_result r = DELAUNAY_OK;
    uint32_t id = 0;
    for (size_t i = 0; i < y->m.n && r == DELAUNAY_OK; id = y->m.id[i++] + 1) {
        for (; id < y->m.id[i] && r == DELAUNAY_OK; id++) {
            char word[16] = " ";
            if (buf_len(&line) == 0) {
                buf_append_text(&line, "DEL ");
                buf_append_text(&line, y->to);
            }
            buf_append(&line, word, 1 + proto_write_u32(word + 1, id));
            if (buf_len(&line) < LINE_ROOM)
                continue;
            r = line.failed ? DELAUNAY_NOMEM
                            : delaunay_send(y->c[1], buf_head(&line), buf_len(&line));
            buf_rewind(&line, 0);
            if (r == DELAUNAY_OK)
                r = delaunay_receive(y->c[1], NULL, NULL);
        }
    }
    if (r == DELAUNAY_OK && buf_len(&line) > 0) {
        r = line.failed ? DELAUNAY_NOMEM : delaunay_send(y->c[1], buf_head(&line), buf_len(&line));
        if (r == DELAUNAY_OK)
            r = delaunay_receive(y->c[1], NULL, NULL);
    }
    buf_free(&line);
    return r;
}

static int fetch(struct copy *y)
{
    char line[160];
    snprintf(line, sizeof line, "STAT %s", y->from);
    enum delaunay_result r = delaunay_request(y->c[0], line, NULL, NULL);
    if (r == DELAUNAY_OK && !read_stat(y))
        r = DELAUNAY_BROKEN;
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

static int store(struct copy *y)
{
    char line[200];
    int n = snprintf(line, sizeof line, "CREATE %s", y->to);
    if (strcmp(y->tol, "0") != 0)
        snprintf(line + n, sizeof line - (size_t)n, " TOL %s", y->tol);
    enum delaunay_result r = delaunay_request(y->c[1], line, NULL, NULL);
    if (r == DELAUNAY_OK)
        r = send_all(y);
    if (r == DELAUNAY_OK)
        r = delete_fillers(y);
    snprintf(line, sizeof line, "TRIANGULATE %s", y->to);
    if (r == DELAUNAY_OK && y->triangulated)
        r = delaunay_request(y->c[1], line, command_show_comment, NULL);
    if (r == DELAUNAY_OK)
        report(y);
    return command_outcome(y->c[1], r);
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
