/* valued.c - see valued.h. */
#include "server/sets/valued.h"

#include "server/system/loop.h"

#include <stdlib.h>
#include <string.h>

static struct valued_moment moment_of(const struct dataset *set, const struct dt_field *f)
{
    return (struct valued_moment){.edits = dt_edits(set->current->dt),
                                  .field_edits = dt_field_edits(f),
                                  .field = dt_field_number(f)};
}

/* Whether the set is at that moment as it is now. */
static bool is_now(const struct dataset *set, const struct dt_field *f,
                   const struct valued_moment *m)
{
    struct valued_moment now = moment_of(set, f);
    return m->at_ns != 0 && m->edits == now.edits && m->field_edits == now.field_edits &&
           m->field == now.field;
}

/* Whether requests wait for it. */
static bool is_wanted(const struct valued *c)
{
    return c->queue.called != NULL || !list_is_empty(&c->queue.waiting);
}

struct valued *valued_find(const struct dataset *set, const struct dt_field *f)
{
    struct valued *c = set->valued;
    while (c != NULL && strcmp(c->field, dt_field_name(f)) != 0)
        c = c->next;
    return c;
}

bool valued_serves(const struct valued *c, const struct dt_field *f, int64_t since_ns)
{
    bool lasts = c->status == DT_OK || c->status == DT_CROSSES;
    return (lasts && is_now(c->set, f, &c->of)) || (since_ns != 0 && c->of.at_ns >= since_ns);
}

/* ---- life ---- */

static void drop_result(struct registry *r, struct valued *c)
{
    if (c->version != NULL)
        version_unpin(r, c->version);
    c->version = NULL;
    c->of = (struct valued_moment){0};
}

/* Takes it out of its set, and frees it as soon as no build refers to it. */
static void leave_set(struct registry *r, struct valued *c)
{
    struct valued **at = &c->set->valued;
    while (*at != c)
        at = &(*at)->next;
    *at = c->next;
    c->set = NULL;
    list_remove(&c->link);
    drop_result(r, c);
    queue_wake_all(&c->queue);
    if (c->build.at_ns != 0)
        *c->cancel = true;
    else
        free(c);
}

void valued_forget(struct registry *r, struct dataset *set)
{
    while (set->valued != NULL)
        leave_set(r, set->valued);
}

static struct valued *enter_set(struct registry *r, struct dataset *set, const struct dt_field *f)
{
    struct valued *c = valued_find(set, f);
    if (c != NULL || (c = calloc(1, sizeof *c)) == NULL)
        return c;
    strcpy(c->field, dt_field_name(f));
    c->set = set;
    c->next = set->valued;
    set->valued = c;
    list_append(&r->valued, &c->link);
    return c;
}

/* ---- builds ---- */

struct valued *valued_begin(struct registry *r, struct dataset *set, const struct dt_field *f,
                            atomic_bool *cancel)
{
    struct valued *c = enter_set(r, set, f);
    if (c == NULL)
        return NULL;
    c->build = moment_of(set, f);
    c->build.at_ns = clock_ns();
    c->cancel = cancel;
    return c;
}

/* NULL: out of memory. */
static struct version *copy_version(struct registry *r, struct dt *dt)
{
    struct version *v = version_new(r, dt);
    if (v == NULL)
        return NULL;
    v->memory = (struct reservation){.budget = r->budget, .kind = BUDGET_COPIES};
    version_update(r, v);
    return v;
}

static void keep_outcome(struct registry *r, struct valued *c, enum dt_status status, struct dt *dt,
                         const struct dt_crossed *crossed)
{
    drop_result(r, c);
    c->of = c->build;
    c->crossed = *crossed;
    if (status == DT_OK && (c->version = copy_version(r, dt)) == NULL)
        status = DT_NOMEM;
    c->status = status;
}

void valued_end(struct registry *r, struct valued *c, enum dt_status status, struct dt *dt,
                const struct dt_crossed *crossed)
{
    if (c->set != NULL && (dt != NULL || status != DT_OK))
        keep_outcome(r, c, status, dt, crossed);
    if (dt != NULL && c->version == NULL)
        r->discard(r->discard_ctx, dt);
    c->build = (struct valued_moment){0};
    if (c->set == NULL)
        free(c);
    else
        queue_call(&c->queue);
}

/* ---- memory ---- */

static bool is_idle(const struct valued *c)
{
    return c->build.at_ns == 0 && !is_wanted(c) && (c->version == NULL || c->version->refs == 1);
}

bool valued_release(struct registry *r)
{
    bool any = false;
    for (struct valued *c = list_first(&r->valued), *next; c != NULL; c = next) {
        next = list_next(&r->valued, c);
        if (!is_idle(c))
            continue;
        leave_set(r, c);
        any = true;
    }
    return any;
}

/* A set that is being edited in place cannot be read. */
static bool is_outdated(const struct valued *c)
{
    if (c->set->exclusive)
        return false;
    const struct dt_field *f = dt_field_find(c->set->current->dt, c->field, strlen(c->field));
    return f == NULL || !is_now(c->set, f, &c->of);
}

void valued_tidy(struct registry *r)
{
    if (r->budget != NULL && atomic_exchange(&r->budget->short_of, false))
        valued_release(r);
    for (struct valued *c = list_first(&r->valued), *next; c != NULL; c = next) {
        next = list_next(&r->valued, c);
        bool builds = c->build.at_ns != 0;
        if (!is_wanted(c) && (builds || is_outdated(c)))
            leave_set(r, c);
    }
}

size_t valued_memory(const struct dataset *set)
{
    size_t bytes = 0;
    for (const struct valued *c = set->valued; c != NULL; c = c->next)
        bytes += c->version != NULL ? c->version->sum.memory : 0;
    return bytes;
}
