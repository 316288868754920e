/* scope.c - see scope.h. */
#include "server/watch/scope.h"

#include <stdlib.h>
#include <string.h>

void scope_clear(struct scope *s)
{
    free(s->names);
    *s = (struct scope){.names = NULL};
}

bool scope_equal(const struct scope *a, const struct scope *b)
{
    if ((a->names == NULL) != (b->names == NULL) || a->boxed != b->boxed ||
        a->constraints != b->constraints)
        return false;
    if (a->names != NULL && strcmp(a->names, b->names) != 0)
        return false;
    return !a->boxed ||
           (a->lo.x == b->lo.x && a->lo.y == b->lo.y && a->hi.x == b->hi.x && a->hi.y == b->hi.y);
}

void scope_find(struct scope *s, const struct dt *dt)
{
    uint32_t n = 0;
    for (const char *at = s->names; at != NULL && n < DT_MAX_FIELDS; n++) {
        size_t len = strcspn(at, ",");
        const struct dt_field *f = dt_field_find(dt, at, len);
        s->field[n] = f;
        s->number[n] = f == NULL ? DT_NONE : dt_field_number(f);
        at = at[len] == '\0' ? NULL : at + len + 1;
    }
    s->fields = n;
}

bool scope_has_value(const struct scope *s, uint64_t key)
{
    uint32_t number = (uint32_t)key - DT_TOUCHED_VALUE;
    for (uint32_t i = 0; i < s->fields; i++)
        if (s->number[i] == number)
            return true;
    return false;
}

bool scope_has_point(const struct scope *s, const struct dt *dt, uint32_t id, struct dt_point *p)
{
    uint32_t representative;
    if (dt_get(dt, id, p) != DT_OK)
        return false;
    return !s->boxed ||
           (p->x >= s->lo.x && p->x <= s->hi.x && p->y >= s->lo.y && p->y <= s->hi.y &&
            dt_representative(dt, id, &representative) == DT_OK && representative == id);
}
