/* power_change.c - see power_change.h. */
#include "tests/server/power/power_change.h"

#include "core/delaunay_constraints.h"
#include "core/delaunay_fields.h"
#include "tests/server/digest.h"
#include "tests/test.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

/* ---- requests ---- */

void request_change_clear(struct request_change *c)
{
    free(c->points);
    c->points = NULL;
}

__attribute__((format(printf, 2, 3))) static void put(struct buf *to, const char *format, ...)
{
    char text[200];
    va_list ap;
    va_start(ap, format);
    int n = vsnprintf(text, sizeof text, format, ap);
    va_end(ap);
    CHECK(n >= 0 && (size_t)n < sizeof text);
    buf_append(to, text, (size_t)n);
}

static const char *const field_name[CHANGE_FIELDS] = {"t", "z"};

/* The value of an added point; some are missing. */
static double value_of(struct dt_point p, uint32_t field)
{
    return fmod(p.x + field, 4) == 3 ? (double)NAN : 100 * field + 10 * p.x - p.y;
}

static void put_points(struct buf *to, const struct request_change *c, const char *before,
                       const char *after)
{
    for (uint32_t i = 0; i < c->n; i++) {
        put(to, "%s%.17g %.17g", before, c->points[i].x, c->points[i].y);
        for (uint32_t f = 0; f < c->fields; f++)
            put(to, " %.17g", value_of(c->points[i], f));
        put(to, "%s", after);
    }
}

static void put_bytes(struct buf *to, const struct request_change *c)
{
    for (uint32_t i = 0; i < c->n; i++) {
        buf_append(to, &c->points[i], sizeof c->points[i]);
        for (uint32_t f = 0; f < c->fields; f++) {
            double v = value_of(c->points[i], f);
            buf_append(to, &v, sizeof v);
        }
    }
}

static void put_set_and_fields(struct buf *to, const char *command, const char *set,
                               const struct request_change *c)
{
    put(to, "%s %s", command, set);
    if (c->kind == REQUEST_LOAD || c->kind == REQUEST_LOADB)
        put(to, " %" PRIu32, c->n);
    for (uint32_t f = 0; f < c->fields; f++)
        put(to, "%s%s", f == 0 ? " FIELDS " : ",", field_name[f]);
}

static void put_values(struct buf *to, const char *set, const struct request_change *c,
                       const uint32_t *ids)
{
    if (c->kind == REQUEST_FSETB)
        put(to, "FSETB %s %s %" PRIu32 " %" PRIu32, set, field_name[c->field], ids[0], c->n);
    else
        put(to, "FSET %s %s", set, field_name[c->field]);
    for (uint32_t i = 0; c->kind == REQUEST_FSET && i < c->n; i++)
        put(to, " %" PRIu32 " %.17g", ids[i], c->points[i].x);
    put(to, "\n");
    for (uint32_t i = 0; c->kind == REQUEST_FSETB && i < c->n; i++)
        buf_append(to, &c->points[i].x, sizeof c->points[i].x);
}

static void put_constraints(struct buf *to, const char *set, const struct request_change *c,
                            const uint32_t *ids)
{
    if (c->kind == REQUEST_CONSTRAIN || c->kind == REQUEST_SPLIT)
        put(to, "CONSTRAIN %s OF %" PRIu32 "%s PATH", set, c->field,
            c->kind == REQUEST_SPLIT ? " SPLIT" : "");
    else if (c->kind == REQUEST_RELEASE && c->n == 0)
        put(to, "RELEASE %s ALL", set);
    else if (c->kind == REQUEST_RELEASE)
        put(to, "RELEASE %s OF %" PRIu32, set, c->field);
    else
        put(to, "%s %s", c->kind == REQUEST_MOVES ? "MOVE" : "DEL", set);
    for (uint32_t i = 0; i < c->n; i++) {
        put(to, " %" PRIu32, ids[i]);
        if (c->kind == REQUEST_MOVES)
            put(to, " %.17g %.17g", c->points[i].x, c->points[i].y);
    }
    put(to, "%s", c->kind == REQUEST_CASCADE ? " CASCADE\n" : "\n");
}

void request_change_write(struct buf *to, const char *set, const struct request_change *c,
                          const uint32_t *ids)
{
    ids = ids == NULL ? c->id : ids;
    switch (c->kind) {
    case REQUEST_ADD:
        put_set_and_fields(to, "ADD", set, c);
        put_points(to, c, " ", "");
        put(to, "\n");
        break;
    case REQUEST_LOAD:
        put_set_and_fields(to, "LOAD", set, c);
        put(to, "\n");
        put_points(to, c, "", "\n");
        break;
    case REQUEST_LOAD_TO_DOT:
        put_set_and_fields(to, "LOAD", set, c);
        put(to, "\n# points\n");
        put_points(to, c, "", "\n");
        put(to, ".\n");
        break;
    case REQUEST_LOADB:
        put_set_and_fields(to, "LOADB", set, c);
        put(to, "\n");
        put_bytes(to, c);
        break;
    case REQUEST_DELETE:
        put(to, "DEL %s", set);
        for (uint32_t i = 0; i < c->n; i++)
            put(to, " %" PRIu32, ids[i]);
        put(to, "\n");
        break;
    case REQUEST_MOVE:
        put(to, "MOVE %s %" PRIu32 " %.17g %.17g\n", set, ids[0], c->points[0].x, c->points[0].y);
        break;
    case REQUEST_CREATE:
        put(to, "CREATE %s TOL %.17g\n", set, c->tolerance);
        break;
    case REQUEST_DROP:
        put(to, "DROP %s\n", set);
        break;
    case REQUEST_TRIANGULATE:
        put(to, "TRIANGULATE %s\n", set);
        break;
    case REQUEST_FSET:
    case REQUEST_FSETB:
        put_values(to, set, c, ids);
        break;
    case REQUEST_FDROP:
        put(to, "FDROP %s %s\n", set, field_name[c->field]);
        break;
    case REQUEST_CONSTRAIN:
    case REQUEST_RELEASE:
    case REQUEST_CASCADE:
    case REQUEST_MOVES:
    case REQUEST_SPLIT:
        put_constraints(to, set, c, ids);
        break;
    }
    CHECK(!to->failed);
}

/* ---- the model ---- */

void model_clear(struct model *m)
{
    if (m->dt != NULL)
        dt_free(m->dt);
    *m = (struct model){0};
}

static void create(struct model *m, double tolerance)
{
    m->dt = dt_new(tolerance);
    CHECK(m->dt != NULL);
}

static void add(struct model *m, const struct request_change *c, char reply[REPLY_BYTES])
{
    struct dt_added added;
    struct dt_values_of column[CHANGE_FIELDS];
    double *v = malloc((c->n * CHANGE_FIELDS + 1) * sizeof *v);
    CHECK(v != NULL);
    for (uint32_t f = 0; f < c->fields; f++) {
        column[f] = (struct dt_values_of){field_name[f], strlen(field_name[f]), v + f * c->n};
        for (uint32_t i = 0; i < c->n; i++)
            v[f * c->n + i] = value_of(c->points[i], f);
    }
    if (m->dt == NULL)
        create(m, 0);
    CHECK(dt_add_values(m->dt, c->points, c->n, column, c->fields, NULL, &added) == DT_OK);
    free(v);
    snprintf(reply, REPLY_BYTES, "OK 0 first=%" PRIu32 " added=%" PRIu32 " coincident=%" PRIu32,
             added.first, added.added, added.coincident);
}

/* Whether the change has failed, for a reason that a request can have. */
static bool refuse(enum dt_status status, char reply[REPLY_BYTES])
{
    static const char *const code[] = {[DT_NOPOINT] = "NOPOINT",
                                       [DT_NOEDGE] = "SYNTAX",
                                       [DT_CROSSES] = "CROSSES",
                                       [DT_CONSTRAINED] = "CONSTRAINED",
                                       [DT_NOCONSTRAINT] = "NOCONSTRAINT"};
    if (status == DT_OK)
        return false;
    CHECK(status < sizeof code / sizeof code[0] && code[status] != NULL);
    snprintf(reply, REPLY_BYTES, "ERR %s", code[status]);
    return true;
}

static void change_points(struct model *m, const struct request_change *c, char reply[REPLY_BYTES])
{
    uint32_t deleted, missing;
    enum dt_status status;
    if (c->kind == REQUEST_MOVE)
        status = dt_move(m->dt, c->id[0], c->points[0]);
    else
        status = dt_delete(m->dt, c->id, c->n, &deleted, &missing);
    if (!refuse(status, reply) && c->kind == REQUEST_DELETE)
        snprintf(reply, REPLY_BYTES, "OK 0 deleted=%" PRIu32, deleted);
}

/* The constraints along the path of the ids. */
static enum dt_status list_path(const struct request_change *c, struct dt_constraint *v)
{
    enum dt_status status = DT_OK;
    for (size_t i = 0; i + 1 < c->n; i++) {
        v[i] = (struct dt_constraint){c->id[i], c->id[i + 1], false, c->field};
        if (v[i].a == v[i].b)
            status = DT_NOEDGE;
    }
    return status;
}

static void split(struct model *m, const struct request_change *c, char reply[REPLY_BYTES])
{
    struct dt_constraint v[CHANGE_IDS];
    struct dt_split s = {0};
    struct dt_added added = {.first = dt_next_id(m->dt)};
    size_t done, at;
    uint32_t missing;
    enum dt_status status = list_path(c, v);
    if (status == DT_OK)
        status = dt_plan_split(m->dt, v, c->n - 1, SIZE_MAX, NULL, &s, &missing);
    if (!refuse(status, reply)) {
        if (s.n_points > 0)
            CHECK(dt_add_values(m->dt, s.point, s.n_points, s.column, s.columns, NULL, &added) ==
                  DT_OK);
        CHECK(dt_release(m->dt, s.released, s.n_released, NULL, &done, &at) == DT_OK);
        CHECK(dt_constrain(m->dt, s.added, s.n_added, NULL, &done, &missing) == DT_OK);
        snprintf(reply, REPLY_BYTES,
                 "OK 0 first=%" PRIu32 " added=%zu split=%zu deviation=", added.first, s.n_points,
                 s.split);
    }
    dt_split_clear(&s);
}

static void constrain(struct model *m, const struct request_change *c, char reply[REPLY_BYTES])
{
    struct dt_constraint v[CHANGE_IDS];
    size_t done, missing, n = c->n - 1;
    uint32_t id;
    enum dt_status status = list_path(c, v);
    if (status == DT_OK)
        status = c->kind == REQUEST_CONSTRAIN ? dt_constrain(m->dt, v, n, NULL, &done, &id)
                                              : dt_release(m->dt, v, n, NULL, &done, &missing);
    if (!refuse(status, reply))
        snprintf(reply, REPLY_BYTES, "OK 0 %s=%zu",
                 c->kind == REQUEST_CONSTRAIN ? "added" : "released", done);
}

static void release_all(struct model *m, char reply[REPLY_BYTES])
{
    struct dt_constraint *v;
    size_t n, done, missing;
    CHECK(dt_constraints(m->dt, NULL, DT_NONE, &v, &n) == DT_OK);
    CHECK(dt_release(m->dt, v, n, NULL, &done, &missing) == DT_OK);
    free(v);
    snprintf(reply, REPLY_BYTES, "OK 0 released=%zu", done);
}

static void change_constraints(struct model *m, const struct request_change *c,
                               char reply[REPLY_BYTES])
{
    uint32_t deleted, missing;
    if (c->kind == REQUEST_RELEASE && c->n == 0)
        release_all(m, reply);
    else if (c->kind == REQUEST_CONSTRAIN || c->kind == REQUEST_RELEASE)
        constrain(m, c, reply);
    else if (c->kind == REQUEST_SPLIT)
        split(m, c, reply);
    else if (c->kind == REQUEST_MOVES)
        refuse(dt_move_many(m->dt, c->id, c->points, c->n, NULL, &missing), reply);
    else if (!refuse(dt_delete_cascade(m->dt, c->id, c->n, NULL, &deleted, &missing), reply))
        snprintf(reply, REPLY_BYTES, "OK 0 deleted=%" PRIu32, deleted);
}

/* Gives the model the triangulation, too, where constraints may cross. False: they cross, so there is none. */
static bool make_live(struct model *m, const struct request_change *c)
{
    bool live = m->triangulated || c->kind == REQUEST_TRIANGULATE;
    bool declares = c->kind == REQUEST_CONSTRAIN || c->kind == REQUEST_SPLIT;
    if (!live || (dt_constraints_count(m->dt) == 0 && !declares))
        return true;
    enum dt_status status = dt_triangulate(m->dt, NULL);
    if (status == DT_OK)
        status = dt_refresh(m->dt, NULL);
    CHECK(status == DT_OK || (status == DT_CROSSES && !m->triangulated));
    return status == DT_OK;
}

static void change_values(struct model *m, const struct request_change *c, char reply[REPLY_BYTES])
{
    const char *name = field_name[c->field];
    double *v = malloc(c->n * sizeof *v);
    uint32_t missing;
    enum dt_status status;
    CHECK(v != NULL);
    for (uint32_t i = 0; i < c->n; i++)
        v[i] = c->points[i].x;
    if (c->kind == REQUEST_FSET)
        status = dt_field_set(m->dt, name, strlen(name), c->id, v, c->n, NULL, &missing);
    else
        status = dt_field_set_run(m->dt, name, strlen(name), c->id[0], v, c->n, NULL, &missing);
    CHECK(status == DT_OK || status == DT_NOPOINT);
    if (status == DT_NOPOINT)
        snprintf(reply, REPLY_BYTES, "ERR NOPOINT");
    free(v);
}

static void drop_field(struct model *m, const struct request_change *c, char reply[REPLY_BYTES])
{
    const char *name = field_name[c->field];
    if (dt_field_drop(m->dt, name, strlen(name)) == DT_NOFIELD)
        snprintf(reply, REPLY_BYTES, "ERR NOFIELD");
}

void model_apply(struct model *m, const struct request_change *c, char reply[REPLY_BYTES])
{
    snprintf(reply, REPLY_BYTES, "OK 0");
    if (c->kind <= REQUEST_LOADB) {
        add(m, c, reply);
    } else if (c->kind == REQUEST_CREATE) {
        if (m->dt == NULL)
            create(m, c->tolerance);
        else
            snprintf(reply, REPLY_BYTES, "ERR EXISTS");
    } else if (m->dt == NULL) {
        snprintf(reply, REPLY_BYTES, "ERR NOSET");
    } else if (!make_live(m, c)) {
        snprintf(reply, REPLY_BYTES, "ERR CROSSES");
    } else if (c->kind == REQUEST_DROP) {
        model_clear(m);
    } else if (c->kind == REQUEST_TRIANGULATE) {
        m->triangulated = true;
    } else if (c->kind == REQUEST_FSET || c->kind == REQUEST_FSETB) {
        change_values(m, c, reply);
    } else if (c->kind == REQUEST_FDROP) {
        drop_field(m, c, reply);
    } else if (c->kind >= REQUEST_CONSTRAIN) {
        change_constraints(m, c, reply);
    } else {
        change_points(m, c, reply);
    }
}

uint64_t model_digest(const struct model *m)
{
    return m->dt == NULL ? 0 : digest_dt(m->dt, m->triangulated);
}
