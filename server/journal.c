/* journal.c - see journal.h. */
#include "server/journal.h"

#include "server/durable.h"

static uint64_t append(struct server *s, struct dataset *set, struct record r)
{
    struct log *log = durable_log(s);
    if (log == NULL)
        return 0;
    r.name = set->name;
    r.name_len = set->name_len;
    set->lsn = log_append(log, &r);
    return set->lsn;
}

uint64_t journal_create(struct server *s, struct dataset *set, double tolerance)
{
    return append(s, set, (struct record){.type = RECORD_CREATE, .a = tolerance});
}

uint64_t journal_drop(struct server *s, struct dataset *set)
{
    return append(s, set, (struct record){.type = RECORD_DROP});
}

uint64_t journal_add(struct server *s, struct dataset *set, uint32_t first, struct dt_point *p,
                     size_t n)
{
    struct log *log = durable_log(s);
    struct record r = {.first = first, .n = (uint32_t)n};
    if (log == NULL) {
        dt_pages_release(p);
        return 0;
    }
    r.name = set->name;
    r.name_len = set->name_len;
    set->lsn = log_append_points(log, &r, (double *)p);
    return set->lsn;
}

uint64_t journal_delete(struct server *s, struct dataset *set, const uint32_t *ids, size_t n)
{
    return append(s, set, (struct record){.type = RECORD_DELETE, .n = (uint32_t)n, .items = ids});
}

uint64_t journal_move(struct server *s, struct dataset *set, uint32_t id, struct dt_point to)
{
    return append(s, set, (struct record){.type = RECORD_MOVE, .first = id, .a = to.x, .b = to.y});
}

uint64_t journal_triangulate(struct server *s, struct dataset *set)
{
    if (set->triangulated)
        return 0;
    set->triangulated = true;
    return append(s, set, (struct record){.type = RECORD_TRIANGULATE});
}
