/* sending.c - see sending.h. Points and lines are one request, LOADB ... CONSTRAINTS. A set that is not triangulated shows only later where
 * lines cross, and a .poly file which faces it has. So a new set gets an expiry first, which drops it if this program ends meanwhile. */
#include "clients/cli/sending.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "clients/cli/request.h"
#include "clients/files/progress.h"
#include "clients/meshes/faces.h"
#include "clients/points/clean_paths.h"

enum { NOT_INSIDE = -1, AT_ONCE = 256, IDS_IN_A_LINE = 4000, EXPIRY_S = 86400 };

struct sending {
    struct file_options *r;
    struct delaunay_client *c;
    const char *set;
    bool is_new;
    uint64_t first;          /* the id of the first point */
    struct segment *segment; /* owns; the constraints of the file's lines */
    size_t segments;
    bool sent; /* the set has the points and the lines */
    char *status, refusal[SENDING_STATUS];
};

/* ---- requests ---- */

static enum delaunay_result ask(struct sending *s, const char *command, const char *rest)
{
    char line[200];
    snprintf(line, sizeof line, "%s %.100s%s", command, s->set, rest);
    return delaunay_request(s->c, line, request_show_comment, NULL);
}

static bool is_refused_with(const struct sending *s, enum delaunay_result r, const char *code)
{
    size_t n = strlen(code);
    const char *text = delaunay_status(s->c)->text;
    return r == DELAUNAY_REFUSED && strncmp(text, "ERR ", 4) == 0 &&
           strncmp(text + 4, code, n) == 0 && text[4 + n] == ' ';
}

static void show_sending(void *ctx, size_t done, size_t total)
{
    progress_update(ctx, done, total, done);
}

/* Four numbers for each segment, as LOADB has them. NULL: out of memory. */
static uint32_t *constraints_of(const struct sending *s)
{
    uint32_t *row = malloc((4 * s->segments + 1) * sizeof row[0]);
    for (size_t i = 0; row != NULL && i < s->segments; i++) {
        const struct segment *g = &s->segment[i];
        memcpy(row + 4 * i, (const uint32_t[]){g->a, g->b, g->what % 2, g->what / 2},
               4 * sizeof row[0]);
    }
    return row;
}

static enum delaunay_result send_request(struct sending *s, const char *names, struct progress *bar)
{
    const struct points_file *f = &s->r->file;
    if (f->paths.n == 0)
        return delaunay_send_values(s->c, s->set, names, f->xy, f->value, f->n, show_sending, bar);
    s->segment = paths_segments(&f->paths, &s->segments);
    uint32_t *row = s->segment == NULL ? NULL : constraints_of(s);
    enum delaunay_result r =
        row == NULL ? DELAUNAY_NOMEM
                    : delaunay_send_drawing(s->c, s->set, names, f->xy, f->value, f->n, row,
                                            s->segments, s->r->split, show_sending, bar);
    free(row);
    return r;
}

/* The points where lines crossed were added, too. */
static void note_crossings(struct sending *s)
{
    uint64_t added = 0;
    size_t n = strlen(s->status);
    delaunay_key_number(delaunay_status(s->c), "added", &added);
    snprintf(s->status + n, SENDING_STATUS - n, " crossings=%ju",
             (uintmax_t)(added - s->r->file.n));
}

static enum delaunay_result send_file(struct sending *s)
{
    const struct table_fields *t = &s->r->from.table.fields;
    const struct points_file *f = &s->r->file;
    char names[FIELDS_MOST * (FIELDS_NAME + 1)] = "";
    struct progress bar;
    for (size_t i = 0, n = 0; i < f->fields; i++)
        n += (size_t)snprintf(names + n, sizeof names - n, "%s%s", i > 0 ? "," : "", t->name[i]);
    progress_start(&bar, "sending");
    enum delaunay_result result = send_request(s, names, &bar);
    progress_end(&bar);
    if (result == DELAUNAY_OK)
        result = delaunay_receive(s->c, request_show_comment, NULL);
    if (result == DELAUNAY_REFUSED)
        snprintf(s->refusal, sizeof s->refusal, "%s", delaunay_status(s->c)->text);
    if (result != DELAUNAY_OK)
        return result;
    delaunay_key_number(delaunay_status(s->c), "first", &s->first);
    snprintf(s->status, SENDING_STATUS, "%s", delaunay_status(s->c)->text);
    if (s->r->split && f->paths.n > 0)
        note_crossings(s);
    if (strstr(s->status, "coincident=0") == NULL)
        file_options_note_coincident(s->r);
    return DELAUNAY_OK;
}

/* ---- lines ---- */

static enum delaunay_result triangulate(struct sending *s)
{
    const char *value;
    size_t len;
    enum delaunay_result r = ask(s, "STAT", "");
    if (r != DELAUNAY_OK || (delaunay_key(delaunay_status(s->c), "triangulated", &value, &len) &&
                             len == 3 && memcmp(value, "yes", 3) == 0))
        return r;
    r = ask(s, "TRIANGULATE", "");
    if (r == DELAUNAY_REFUSED)
        snprintf(s->refusal, sizeof s->refusal, "%s", delaunay_status(s->c)->text);
    return r;
}

/* ---- faces of a .poly file ---- */

/* Finds the number of the border of each face; NOT_INSIDE for the others. A face that lines enclose is inside, unless it has a hole's
 * seed; a region's seed gives its number. */
static enum delaunay_result number_faces(struct sending *s, const struct model *m,
                                         const struct sides *sides, const struct faces *f,
                                         int64_t *number)
{
    const struct paths *p = &s->r->file.paths;
    double *xy = malloc((2 * p->seeds + 1) * sizeof xy[0]);
    uint32_t *triangle = malloc((3 * p->seeds + 1) * sizeof triangle[0]), place[2];
    enum delaunay_result r = xy != NULL && triangle != NULL ? DELAUNAY_OK : DELAUNAY_NOMEM;
    size_t outside = 0;
    for (size_t i = 0; i < f->n; i++)
        number[i] = f->enclosed[i] ? (int64_t)s->r->from.first_number : NOT_INSIDE;
    for (size_t i = 0; r == DELAUNAY_OK && i < p->seeds; i++)
        memcpy(xy + 2 * i, p->seed[i].xy, 2 * sizeof xy[0]);
    if (r == DELAUNAY_OK && p->seeds > 0)
        r = delaunay_locate_places(s->c, s->set, xy, p->seeds, triangle);
    for (size_t i = 0; r == DELAUNAY_OK && i < p->seeds; i++) {
        const uint32_t *v = triangle + 3 * i;
        int64_t t = v[0] != DELAUNAY_NONE && model_find(m, v[0], &place[0]) &&
                            model_find(m, v[1], &place[1])
                        ? sides_find(sides, place[0], place[1])
                        : NO_TRIANGLE;
        bool used = t != NO_TRIANGLE && f->enclosed[f->face[t]];
        outside += !used;
        if (used)
            number[f->face[t]] = p->seed[i].hole ? NOT_INSIDE : (int64_t)p->seed[i].number;
    }
    if (outside > 0)
        message_print("%s: %zu holes and regions are not enclosed by segments and are not used",
                      source_name(&s->r->from), outside);
    free(xy);
    free(triangle);
    return r;
}

/* A border of number k is each edge with a face of that number on one side only. */
static size_t find_borders(const struct model *m, const struct sides *sides, const struct faces *f,
                           const int64_t *number, struct segment *to)
{
    size_t n = 0;
    for (size_t i = 0; i < 3 * m->triangles; i++) {
        uint32_t a = m->triangle[i], b = m->triangle[i % 3 == 2 ? i - 2 : i + 1];
        int64_t other = sides_find(sides, b, a), k = number[f->face[i / 3]];
        if (k == NOT_INSIDE || (other != NO_TRIANGLE && number[f->face[other]] == k))
            continue;
        uint32_t low = m->id[a < b ? a : b], high = m->id[a < b ? b : a];
        to[n++] = (struct segment){2 * (uint32_t)k + 1, low, high};
    }
    segments_sort(to, n);
    return n;
}

/* The replies to n requests. The first refusal counts; the others are received, too. */
static enum delaunay_result receive_declared(struct sending *s, size_t n)
{
    enum delaunay_result result = DELAUNAY_OK;
    for (size_t i = 0; i < n; i++) {
        enum delaunay_result r = delaunay_receive(s->c, request_show_comment, NULL);
        if (r != DELAUNAY_OK && r != DELAUNAY_REFUSED)
            return r;
        if (r == DELAUNAY_REFUSED && result == DELAUNAY_OK)
            snprintf(s->refusal, sizeof s->refusal, "%s", delaunay_status(s->c)->text);
        if (r != DELAUNAY_OK)
            result = r;
    }
    return result;
}

/* A request for each number, many at once. */
static enum delaunay_result declare(struct sending *s, const struct segment *segment, size_t n)
{
    enum delaunay_result r = DELAUNAY_OK;
    uint32_t *pair = malloc((2 * n + 1) * sizeof pair[0]);
    size_t sent = 0, same;
    if (pair == NULL)
        return DELAUNAY_NOMEM;
    for (size_t i = 0; i < n; i++) {
        pair[2 * i] = (uint32_t)s->first + segment[i].a;
        pair[2 * i + 1] = (uint32_t)s->first + segment[i].b;
    }
    for (size_t i = 0; i < n && r == DELAUNAY_OK; i += same) {
        for (same = 1; i + same < n && segment[i + same].what == segment[i].what;)
            same++;
        const struct delaunay_constraint name = {segment[i].what / 2, true, false};
        r = delaunay_send_constraints(s->c, s->set, &name, pair + 2 * i, same);
        if (r == DELAUNAY_OK && ++sent == AT_ONCE) {
            r = receive_declared(s, sent);
            sent = 0;
        }
    }
    if (r == DELAUNAY_OK)
        r = receive_declared(s, sent);
    free(pair);
    return r;
}

static enum delaunay_result declare_faces(struct sending *s)
{
    struct model m = {0};
    struct sides sides = {0};
    struct faces f = {0};
    enum delaunay_result r = model_fetch(s->c, s->set, MODEL_TRIANGLES | MODEL_FIXED, &m);
    if (r == DELAUNAY_STOPPED)
        snprintf(s->refusal, sizeof s->refusal, "%s", m.fault);
    bool ok = r != DELAUNAY_OK || (sides_init(&sides, &m) && faces_init(&f, &m, &sides));
    int64_t *number = malloc((f.n + 1) * sizeof number[0]);
    struct segment *border = malloc((3 * m.triangles + 1) * sizeof border[0]);
    if (!ok || number == NULL || border == NULL)
        r = DELAUNAY_NOMEM;
    if (r == DELAUNAY_OK)
        r = number_faces(s, &m, &sides, &f, number);
    if (r == DELAUNAY_OK)
        r = declare(s, border, find_borders(&m, &sides, &f, number, border));
    free(number);
    free(border);
    faces_free(&f);
    sides_free(&sides);
    model_free(&m);
    return r;
}

/* ---- where lines cross ---- */

struct side {
    bool ours;               /* of the file; else of the set, where a and b are ids */
    uint32_t a, b;           /* places in the file */
    const struct path *path; /* NULL: not of the file */
};

/* A number of a constraint of LOADB, or ids; *at moves behind it. */
static bool read_side(const struct sending *s, const char **at, struct side *side)
{
    size_t i;
    int len = 0;
    *side = (struct side){.ours = sscanf(*at, "constraint %zu%n", &i, &len) == 1};
    if (side->ours && i - 1 < s->segments) {
        side->a = s->segment[i - 1].a;
        side->b = s->segment[i - 1].b;
    } else if (side->ours || sscanf(*at, "%u %u%n", &side->a, &side->b, &len) != 2) {
        return false;
    } else if (s->sent && side->a - s->first < s->r->file.n && side->b - s->first < s->r->file.n) {
        side->ours = true;
        side->a -= (uint32_t)s->first;
        side->b -= (uint32_t)s->first;
    }
    *at += len;
    return true;
}

static bool read_crossing(const struct sending *s, struct side *v, struct side *w)
{
    static const char head[] = "ERR CROSSES ", between[] = " crosses ";
    const char *at = s->refusal + sizeof head - 1;
    if (strncmp(s->refusal, head, sizeof head - 1) != 0 || !read_side(s, &at, v) ||
        strncmp(at, between, sizeof between - 1) != 0)
        return false;
    at += sizeof between - 1;
    return read_side(s, &at, w);
}

static void find_path(const struct sending *s, struct side *side)
{
    const struct paths *p = &s->r->file.paths;
    for (size_t i = 0; side->ours && i < p->n && side->path == NULL; i++)
        for (size_t k = 0; k < paths_steps(&p->path[i]); k++) {
            uint32_t end[2];
            paths_step(p, &p->path[i], k, end);
            if ((end[0] == side->a && end[1] == side->b) ||
                (end[1] == side->a && end[0] == side->b))
                side->path = &p->path[i];
        }
}

/* About where they cross, for people. */
static void crossing(const struct sending *s, const struct side *v, const struct side *w,
                     double place[2])
{
    const double *xy = s->r->file.xy;
    const double *a = xy + 2 * (size_t)v->a, *b = xy + 2 * (size_t)v->b, *c = xy + 2 * (size_t)w->a,
                 *d = xy + 2 * (size_t)w->b;
    double ux = b[0] - a[0], uy = b[1] - a[1], vx = d[0] - c[0], vy = d[1] - c[1];
    double det = ux * vy - uy * vx,
           t = det != 0 ? ((c[0] - a[0]) * vy - (c[1] - a[1]) * vx) / det : 0.5;
    place[0] = a[0] + t * ux;
    place[1] = a[1] + t * uy;
}

static void name_side(const struct side *v, char *to, size_t room)
{
    const struct path *p = v->path;
    if (p == NULL)
        snprintf(to, room, "the constraint %u %u of the set", v->a, v->b);
    else if (p->feature > 0)
        snprintf(to, room, "%s %u of feature %ju in line %ju", p->border ? "border" : "line",
                 (unsigned)p->number, (uintmax_t)p->feature, (uintmax_t)p->line);
    else
        snprintf(to, room, "%s %u of line %ju", p->border ? "border" : "line", (unsigned)p->number,
                 (uintmax_t)p->line);
}

/* In place of `ERR CROSSES constraint 3 crosses a b`, whose numbers the user does not know. False if it is another error. */
static bool explain_crossing(const struct sending *s, char *to, size_t room)
{
    struct side v, w;
    char first[120], second[120], where[80] = "";
    const char *name = source_name(&s->r->from);
    if (!read_crossing(s, &v, &w))
        return false;
    find_path(s, &v);
    find_path(s, &w);
    name_side(&v, first, sizeof first);
    name_side(&w, second, sizeof second);
    if (v.ours && w.ours) {
        double place[2];
        crossing(s, &v, &w, place);
        snprintf(where, sizeof where, " at about %.9g %.9g", place[0], place[1]);
    }
    snprintf(to, room, "%s: %s crosses %s%s; nothing was loaded%s", name, first,
             v.path != NULL && v.path == w.path ? "itself" : second, where,
             s->r->split || s->r->file.paths.faces ? ""
                                                   : " (--split adds points where lines cross)");
    return true;
}

/* ---- all or nothing ---- */

/* Deletes the points with their constraints, or the set if it is new. */
static bool undo(struct sending *s)
{
    char line[IDS_IN_A_LINE * 11 + 200];
    uint64_t id = s->first, end = s->first + s->r->file.n;
    if (s->is_new)
        return ask(s, "DROP", "") == DELAUNAY_OK;
    while (id < end) {
        size_t n = (size_t)snprintf(line, sizeof line, "DEL %.100s", s->set);
        for (size_t i = 0; i < IDS_IN_A_LINE && id < end; i++)
            n += (size_t)snprintf(line + n, sizeof line - n, " %ju", (uintmax_t)id++);
        snprintf(line + n, sizeof line - n, " CASCADE");
        if (delaunay_request(s->c, line, request_show_comment, NULL) != DELAUNAY_OK)
            return false;
    }
    return true;
}

/* Says what is wrong; returns the exit status. */
static int fail(struct sending *s, enum delaunay_result r)
{
    char text[600];
    int status = r == DELAUNAY_LOST || r == DELAUNAY_BROKEN ? EXIT_NO_CONNECTION : EXIT_REFUSED;
    bool crosses = r == DELAUNAY_REFUSED && explain_crossing(s, text, sizeof text);
    if (!crosses)
        snprintf(text, sizeof text, "%s",
                 r == DELAUNAY_REFUSED ? s->refusal : delaunay_result_text(r));
    message_print("%s", text);
    if (json_chosen() && r == DELAUNAY_REFUSED) {
        json_begin(false);
        json_text("error", crosses ? "CROSSES" : "REFUSED");
        json_text("message", text);
        json_finish();
    }
    return status;
}

static enum delaunay_result begin(struct sending *s)
{
    char rest[40];
    enum delaunay_result r = ask(s, "CREATE", "");
    s->is_new = r == DELAUNAY_OK;
    if (r != DELAUNAY_OK)
        return is_refused_with(s, r, "EXISTS") ? DELAUNAY_OK : r;
    snprintf(rest, sizeof rest, " %d", EXPIRY_S);
    return ask(s, "EXPIRE", rest);
}

static int send_lines(struct sending *s)
{
    const bool faces = s->r->file.paths.faces;
    enum delaunay_result r = begin(s);
    if (r == DELAUNAY_OK && !s->is_new && faces) {
        message_print("a .poly file makes a new set, and there is a set %s", s->set);
        return EXIT_REFUSED;
    }
    if (r == DELAUNAY_OK)
        r = send_file(s);
    s->sent = r == DELAUNAY_OK;
    if (r == DELAUNAY_OK)
        r = triangulate(s);
    if (r == DELAUNAY_OK && faces)
        r = declare_faces(s);
    if (r == DELAUNAY_OK && s->is_new)
        r = ask(s, "PERSIST", "");
    if (r == DELAUNAY_OK)
        return EXIT_DONE;
    int status = s->refusal[0] != '\0' ? fail(s, r) : request_outcome(s->c, r);
    if (r == DELAUNAY_REFUSED && (s->sent || s->is_new) && !undo(s))
        message_print("the points could not be taken back: %s", delaunay_status(s->c)->text);
    return status;
}

int sending_send(struct file_options *r, struct delaunay_client *c, const char *set,
                 char status[SENDING_STATUS])
{
    struct sending s = {.r = r, .c = c, .set = set, .status = status};
    status[0] = '\0';
    int result = r->file.paths.n > 0 ? send_lines(&s) : request_outcome(c, send_file(&s));
    free(s.segment);
    return result;
}
