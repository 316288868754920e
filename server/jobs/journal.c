/* journal.c - see journal.h. */
#include "server/jobs/journal.h"

#include "server/jobs/durable.h"

/* Where the set's changes go; NULL: nowhere. */
static struct log *log_of(const struct server *s, const struct dataset *set)
{
    return set->temporary ? NULL : durable_log(s);
}

/* The lsn of the record; 0 if there is none. */
static uint64_t append(struct server *s, const struct dataset *set, struct record r)
{
    struct log *log = log_of(s, set);
    if (log == NULL)
        return 0;
    r.name = set->name;
    r.name_len = set->name_len;
    uint64_t lsn = log_append(log, &r);
    reservation_set(&s->queued, log_queued(log));
    return lsn;
}

/* The set has a new version; lsn: of the record, 0 if there is none. */
static void changed(struct server *s, struct dataset *set, uint64_t lsn)
{
    set->current->lsn = lsn;
    registry_set_version(&s->sets, set, registry_version(&s->sets, lsn));
}

void journal_create(struct server *s, struct dataset *set, double tolerance)
{
    struct record r = {.type = RECORD_CREATE, .a = tolerance};
    changed(s, set, append(s, set, r));
}

void journal_drop(struct server *s, struct dataset *set)
{
    /* Not the set's own: a snapshot that pins the set now does not have this change. */
    if (!set->temporary)
        s->dropped = append(s, set, (struct record){.type = RECORD_DROP});
}

void journal_add(struct server *s, struct dataset *set, uint32_t first, struct dt_point *p,
                 size_t n)
{
    struct log *log = log_of(s, set);
    struct record r = {.first = first, .n = (uint32_t)n};
    if (log == NULL) {
        dt_pages_release(p);
        changed(s, set, 0);
        return;
    }
    r.name = set->name;
    r.name_len = set->name_len;
    changed(s, set, log_append_points(log, &r, (double *)p));
    reservation_set(&s->queued, log_queued(log));
}

void journal_delete(struct server *s, struct dataset *set, const uint32_t *ids, size_t n)
{
    struct record r = {.type = RECORD_DELETE, .n = (uint32_t)n, .items = ids};
    changed(s, set, append(s, set, r));
}

void journal_move(struct server *s, struct dataset *set, uint32_t id, struct dt_point to)
{
    struct record r = {.type = RECORD_MOVE, .first = id, .a = to.x, .b = to.y};
    changed(s, set, append(s, set, r));
}

void journal_expire(struct server *s, struct dataset *set)
{
    struct record r = {.type = RECORD_EXPIRE, .a = (double)set->expires_ms};
    changed(s, set, append(s, set, r));
}

void journal_set_values(struct server *s, struct dataset *set, const struct word *field,
                        const struct record_value *v, size_t n)
{
    struct record r = {.type = RECORD_FSET,
                       .n = (uint32_t)n,
                       .field = field->text,
                       .field_len = field->len,
                       .items = v};
    changed(s, set, append(s, set, r));
}

void journal_set_run(struct server *s, struct dataset *set, struct columns *v)
{
    struct record r = {.type = RECORD_VALUES,
                       .first = v->first,
                       .n = v->n,
                       .field = v->field[0].text,
                       .field_len = v->field[0].len,
                       .items = v->v};
    if (v->n > RECORD_MOST_VALUES) {
        journal_add_values(s, set, dt_next_id(set->current->dt), NULL, 0, v);
        return;
    }
    changed(s, set, append(s, set, r));
    columns_free(v);
}

void journal_add_values(struct server *s, struct dataset *set, uint32_t first, struct dt_point *p,
                        size_t n, struct columns *v)
{
    struct log *log = log_of(s, set);
    struct record r = {.first = first, .n = (uint32_t)n};
    if (log == NULL) {
        dt_pages_release(p);
        columns_free(v);
        changed(s, set, 0);
        return;
    }
    r.name = set->name;
    r.name_len = set->name_len;
    changed(s, set, log_append_values(log, &r, (double *)p, v));
    reservation_set(&s->queued, log_queued(log));
}

void journal_drop_field(struct server *s, struct dataset *set, const struct word *field)
{
    struct record r = {.type = RECORD_FDROP, .field = field->text, .field_len = field->len};
    changed(s, set, append(s, set, r));
}

void journal_triangulate(struct server *s, struct dataset *set)
{
    if (set->triangulated)
        return;
    set->triangulated = true;
    changed(s, set, append(s, set, (struct record){.type = RECORD_TRIANGULATE}));
}

uint64_t journal_of(const struct server *s, const struct dataset *set)
{
    return set != NULL ? set->current->lsn : s->dropped;
}

uint64_t journal_of_all(const struct server *s)
{
    const struct log *log = durable_log(s);
    return log != NULL ? log_last(log) : 0;
}
