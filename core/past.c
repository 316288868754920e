/* past.c - see past.h.
 *
 * Invariant while at < end: an unread id that is not in `kept` has the row now that it had then,
 * but for the representative of an alias whose group is in `families`. For an alias that is not
 * kept has never left its group, so the group's number means the same family all the time. */
#include "core/past.h"

#include "core/memory.h"
#include "core/points.h"

uint32_t dt_points_past_begin(struct dt_points *p)
{
    dt_points_past_end(p);
    p->past.end = p->next_id;
    return dt_points_live(p);
}

void dt_points_past_end(struct dt_points *p)
{
    dt_array_free(p->past.row);
    dt_idmap_clear(&p->past.kept);
    dt_idmap_clear(&p->past.families);
    p->past = (struct dt_past){0};
}

size_t dt_past_memory(const struct dt_past *past)
{
    return past->cap * sizeof *past->row + dt_idmap_memory(&past->kept) +
           dt_idmap_memory(&past->families);
}

/* The row that an id had which is not kept and stands for `value` now. */
static struct dt_row row_then(const struct dt_points *p, uint32_t id, uint32_t value)
{
    if (!(value & DT_ALIAS_BIT))
        return (struct dt_row){id, id, p->xy[value]};
    const struct dt_alias *a = &p->aliases.alias[value & ~DT_ALIAS_BIT];
    uint32_t then = dt_idmap_get(&p->past.families, a->group);
    return (struct dt_row){id, then != DT_NONE ? then : p->aliases.group[a->group].representative,
                           a->xy};
}

/* ---- keeping ---- */

static bool grow(struct dt_past *past)
{
    if (past->n < past->cap)
        return true;
    size_t cap = dt_array_room(past->cap, (size_t)past->n + 1, DT_NONE);
    struct dt_row *row = dt_array_grow(past->row, past->n, cap, sizeof *row);
    if (row == NULL)
        return false;
    past->row = row;
    past->cap = (uint32_t)cap;
    return true;
}

void dt_past_keep(struct dt_points *p, uint32_t id)
{
    struct dt_past *past = &p->past;
    if (id < past->at || id >= past->end || past->failed ||
        dt_idmap_get(&past->kept, id) != DT_NONE)
        return;
    past->failed = !grow(past) || dt_idmap_reserve(&past->kept, id, 1) != DT_OK;
    if (past->failed)
        return;
    past->row[past->n] = row_then(p, id, dt_idmap_get(&p->value, id));
    dt_idmap_set(&past->kept, id, past->n++);
}

void dt_past_rename(struct dt_points *p, uint32_t representative)
{
    struct dt_past *past = &p->past;
    if (past->at == past->end || past->failed)
        return;
    uint32_t group = dt_idmap_get(&p->aliases.group_of, representative);
    if (group == DT_NONE || dt_idmap_get(&past->families, group) != DT_NONE)
        return;
    past->failed = dt_idmap_reserve(&past->families, group, 1) != DT_OK;
    if (!past->failed)
        dt_idmap_set(&past->families, group, representative);
}

/* ---- reading ---- */

enum { AHEAD = 64 }; /* rows whose places are fetched together: they lie anywhere */

/* Lists the next ids that were there, up to n: with what each stands for now as its representative,
 * DT_NONE if its row was kept. *kept is the next kept one. Returns how many. */
static size_t list(struct dt_points *p, struct dt_row *row, size_t n, uint32_t *kept)
{
    struct dt_past *past = &p->past;
    size_t i = 0;
    while (i < n && past->at < past->end) {
        uint32_t live = dt_points_next_live(p, past->at), id = live < *kept ? live : *kept;
        if (id >= past->end) {
            past->at = past->end;
            break;
        }
        row[i] = (struct dt_row){.id = id, .representative = DT_NONE};
        if (id == *kept) {
            *kept = dt_idmap_next(&past->kept, id + 1);
        } else {
            uint32_t value = dt_idmap_get(&p->value, id);
            if (!(value & DT_ALIAS_BIT))
                dt_fetch(&p->xy[value]);
            row[i].representative = value;
        }
        past->at = id + 1;
        i++;
    }
    return i;
}

enum dt_status dt_points_past_read(struct dt_points *p, struct dt_row *row, size_t room, size_t *n)
{
    struct dt_past *past = &p->past;
    if (past->failed)
        return DT_NOMEM;
    *n = 0;
    uint32_t kept = dt_idmap_next(&past->kept, past->at);
    for (size_t listed = 1; listed > 0 && *n < room; *n += listed) {
        struct dt_row *r = row + *n;
        listed = list(p, r, room - *n < AHEAD ? room - *n : AHEAD, &kept);
        for (size_t i = 0; i < listed; i++) {
            uint32_t value = r[i].representative;
            r[i] = value == DT_NONE ? past->row[dt_idmap_get(&past->kept, r[i].id)]
                                    : row_then(p, r[i].id, value);
        }
    }
    return DT_OK;
}
