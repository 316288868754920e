/* power_change.c - see power_change.h. */
#include "tests/server/power/power_change.h"

#include "tests/server/digest.h"
#include "tests/test.h"

#include <inttypes.h>
#include <stdarg.h>

/* ---- requests ---- */

void change_clear(struct change *c)
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

static void put_points(struct buf *to, const struct change *c, const char *before,
                       const char *after)
{
    for (uint32_t i = 0; i < c->n; i++)
        put(to, "%s%.17g %.17g%s", before, c->points[i].x, c->points[i].y, after);
}

void change_write(struct buf *to, const char *set, const struct change *c, const uint32_t *ids)
{
    ids = ids == NULL ? c->id : ids;
    switch (c->kind) {
    case CHANGE_ADD:
        put(to, "ADD %s", set);
        put_points(to, c, " ", "");
        put(to, "\n");
        break;
    case CHANGE_LOAD:
        put(to, "LOAD %s %" PRIu32 "\n", set, c->n);
        put_points(to, c, "", "\n");
        break;
    case CHANGE_LOAD_TO_DOT:
        put(to, "LOAD %s\n# points\n", set);
        put_points(to, c, "", "\n");
        put(to, ".\n");
        break;
    case CHANGE_LOADB:
        put(to, "LOADB %s %" PRIu32 "\n", set, c->n);
        buf_append(to, c->points, c->n * sizeof *c->points);
        break;
    case CHANGE_DELETE:
        put(to, "DEL %s", set);
        for (uint32_t i = 0; i < c->n; i++)
            put(to, " %" PRIu32, ids[i]);
        put(to, "\n");
        break;
    case CHANGE_MOVE:
        put(to, "MOVE %s %" PRIu32 " %.17g %.17g\n", set, ids[0], c->points[0].x, c->points[0].y);
        break;
    case CHANGE_CREATE:
        put(to, "CREATE %s TOL %.17g\n", set, c->tolerance);
        break;
    case CHANGE_DROP:
        put(to, "DROP %s\n", set);
        break;
    case CHANGE_TRIANGULATE:
        put(to, "TRIANGULATE %s\n", set);
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

static void add(struct model *m, const struct change *c, char reply[REPLY_BYTES])
{
    struct dt_added added;
    if (m->dt == NULL)
        create(m, 0);
    CHECK(dt_add(m->dt, c->points, c->n, &added) == DT_OK);
    snprintf(reply, REPLY_BYTES, "OK 0 first=%" PRIu32 " added=%" PRIu32 " coincident=%" PRIu32,
             added.first, added.added, added.coincident);
}

static void change_points(struct model *m, const struct change *c, char reply[REPLY_BYTES])
{
    uint32_t deleted, missing;
    enum dt_status status;
    if (c->kind == CHANGE_MOVE)
        status = dt_move(m->dt, c->id[0], c->points[0]);
    else
        status = dt_delete(m->dt, c->id, c->n, &deleted, &missing);
    CHECK(status == DT_OK || status == DT_NOPOINT);
    if (status == DT_NOPOINT)
        snprintf(reply, REPLY_BYTES, "ERR NOPOINT");
    else if (c->kind == CHANGE_DELETE)
        snprintf(reply, REPLY_BYTES, "OK 0 deleted=%" PRIu32, deleted);
}

void model_apply(struct model *m, const struct change *c, char reply[REPLY_BYTES])
{
    snprintf(reply, REPLY_BYTES, "OK 0");
    if (c->kind <= CHANGE_LOADB) {
        add(m, c, reply);
    } else if (c->kind == CHANGE_CREATE) {
        if (m->dt == NULL)
            create(m, c->tolerance);
        else
            snprintf(reply, REPLY_BYTES, "ERR EXISTS");
    } else if (m->dt == NULL) {
        snprintf(reply, REPLY_BYTES, "ERR NOSET");
    } else if (c->kind == CHANGE_DROP) {
        model_clear(m);
    } else if (c->kind == CHANGE_TRIANGULATE) {
        m->triangulated = true;
    } else {
        change_points(m, c, reply);
    }
}

uint64_t model_digest(const struct model *m)
{
    return m->dt == NULL ? 0 : digest_dt(m->dt, m->triangulated);
}
