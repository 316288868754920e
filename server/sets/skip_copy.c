/* skip_copy.c - see skip_copy.h. */
#include "server/sets/skip_copy.h"

#include "server/system/loop.h"

#include <stdlib.h>
#include <string.h>

static struct skip_copy_moment moment_of(const struct dataset *set, const struct dt_field *f)
{
    return (struct skip_copy_moment){.edits = dt_edits(set->current->dt),
                                     .field_edits = dt_field_edits(f),
                                     .field = dt_field_number(f)};
}

/* Whether the set is at that moment as it is now. */
static bool is_now(const struct dataset *set, const struct dt_field *f,
                   const struct skip_copy_moment *m)
{
    struct skip_copy_moment now = moment_of(set, f);
    return m->at_ns != 0 && m->edits == now.edits && m->field_edits == now.field_edits &&
           m->field == now.field;
}

/* Whether requests wait for it. */
static bool is_wanted(const struct skip_copy *c)
{
    return c->queue.called != NULL || !list_is_empty(&c->queue.waiting);
}

struct skip_copy *skip_copy_find(const struct dataset *set, const struct dt_field *f)
{
    struct skip_copy *c = set->skip_copies;
    while (c != NULL && strcmp(c->field, dt_field_name(f)) != 0)
        c = c->next;
    return c;
}

bool skip_copy_serves(const struct skip_copy *c, const struct dt_field *f, int64_t since_ns)
{
    bool lasts = c->status == DT_OK || c->status == DT_CROSSES;
    return (lasts && is_now(c->set, f, &c->of)) || (since_ns != 0 && c->of.at_ns >= since_ns);
}

/* ---- life ---- */

static void drop_result(struct registry *r, struct skip_copy *c)
{
    if (c->version != NULL)
        version_unpin(r, c->version);
    c->version = NULL;
    c->of = (struct skip_copy_moment){0};
}

/* Takes it out of its set, and frees it as soon as no build refers to it. */
static void leave_set(struct registry *r, struct skip_copy *c)
{
    struct skip_copy **at = &c->set->skip_copies;
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

void skip_copy_forget(struct registry *r, struct dataset *set)
{
    while (set->skip_copies != NULL)
        leave_set(r, set->skip_copies);
}

static struct skip_copy *enter_set(struct registry *r, struct dataset *set,
                                   const struct dt_field *f)
{
    struct skip_copy *c = skip_copy_find(set, f);
    if (c != NULL || (c = calloc(1, sizeof *c)) == NULL)
        return c;
    strcpy(c->field, dt_field_name(f));
    c->set = set;
    c->next = set->skip_copies;
    set->skip_copies = c;
    list_append(&r->skip_copies, &c->link);
    return c;
}

/* ---- builds ---- */

struct skip_copy *skip_copy_begin(struct registry *r, struct dataset *set, const struct dt_field *f,
                                  atomic_bool *cancel)
{
    struct skip_copy *c = enter_set(r, set, f);
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

static void keep_outcome(struct registry *r, struct skip_copy *c, enum dt_status status,
                         struct dt *dt, const struct dt_crossed *crossed)
{
    drop_result(r, c);
    c->of = c->build;
    c->crossed = *crossed;
    if (status == DT_OK && (c->version = copy_version(r, dt)) == NULL)
        status = DT_NOMEM;
    c->status = status;
}

void skip_copy_end(struct registry *r, struct skip_copy *c, enum dt_status status, struct dt *dt,
                   const struct dt_crossed *crossed)
{
    if (c->set != NULL && (dt != NULL || status != DT_OK))
        keep_outcome(r, c, status, dt, crossed);
    if (dt != NULL && c->version == NULL)
        r->discard(r->discard_ctx, dt);
    c->build = (struct skip_copy_moment){0};
    if (c->set == NULL)
        free(c);
    else
        queue_call(&c->queue);
}

/* ---- memory ---- */

static bool is_idle(const struct skip_copy *c)
{
    return c->build.at_ns == 0 && !is_wanted(c) && (c->version == NULL || c->version->refs == 1);
}

bool skip_copy_release(struct registry *r)
{
    bool any = false;
    for (struct skip_copy *c = list_first(&r->skip_copies), *next; c != NULL; c = next) {
        next = list_next(&r->skip_copies, c);
        if (!is_idle(c))
            continue;
        leave_set(r, c);
        any = true;
    }
    return any;
}

/* A set that is being edited in place cannot be read. */
static bool is_outdated(const struct skip_copy *c)
{
    if (c->set->exclusive)
        return false;
    const struct dt_field *f = dt_field_find(c->set->current->dt, c->field, strlen(c->field));
    return f == NULL || !is_now(c->set, f, &c->of);
}

void skip_copy_tidy(struct registry *r)
{
    if (r->budget != NULL && atomic_exchange(&r->budget->short_of, false))
        skip_copy_release(r);
    for (struct skip_copy *c = list_first(&r->skip_copies), *next; c != NULL; c = next) {
        next = list_next(&r->skip_copies, c);
        bool builds = c->build.at_ns != 0;
        if (!is_wanted(c) && (builds || is_outdated(c)))
            leave_set(r, c);
    }
}

size_t skip_copy_memory(const struct dataset *set)
{
    size_t bytes = 0;
    for (const struct skip_copy *c = set->skip_copies; c != NULL; c = c->next)
        bytes += c->version != NULL ? c->version->sum.memory : 0;
    return bytes;
}
