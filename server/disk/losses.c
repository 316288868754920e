/* losses.c - see losses.h. */
#include "server/disk/losses.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

void losses_clear(struct losses *l)
{
    free(l->v);
    *l = (struct losses){.n = 0};
}

static struct loss *find(const struct losses *l, const char *name, size_t len)
{
    for (size_t i = 0; i < l->n; i++)
        if (l->v[i].name_len == len && memcmp(l->v[i].name, name, len) == 0)
            return &l->v[i];
    return NULL;
}

static struct loss *append(struct losses *l, const char *name, size_t len)
{
    if (l->n == l->cap) {
        size_t cap = l->cap > 0 ? 2 * l->cap : 16;
        struct loss *v = realloc(l->v, cap * sizeof *v);
        if (v == NULL) {
            l->failed = true;
            return NULL;
        }
        l->v = v;
        l->cap = cap;
    }
    struct loss *loss = &l->v[l->n++];
    *loss = (struct loss){.name_len = len};
    memcpy(loss->name, name, len);
    return loss;
}

void losses_add(struct losses *l, const char *name, size_t name_len, uint32_t points)
{
    struct loss *loss = append(l, name, name_len);
    if (loss == NULL)
        return;
    loss->points = points;
    loss->known = true;
}

/* Whether the name of a set is lost. */
static bool some_are_nameless(const struct losses *l)
{
    return l->announced > l->sets;
}

/* Whether the record may create a set. An ADD of the first point does, unless the set was an empty one whose
 * name is lost. */
static bool may_create(const struct losses *l, const struct record *r)
{
    return r->type == RECORD_CREATE || r->type == RECORD_CLOSE ||
           ((r->type == RECORD_ADD || r->type == RECORD_LOAD) && r->first == 0 &&
            !(l->empty && some_are_nameless(l)));
}

bool losses_take(struct losses *l, const struct record *r)
{
    struct loss *loss = find(l, r->name, r->name_len);
    if (r->type == RECORD_DROP) {
        bool lost = loss != NULL || some_are_nameless(l);
        if (lost && (loss == NULL || !loss->known) && l->announced != SIZE_MAX)
            l->announced--; /* it was one of those without a name */
        if (loss != NULL)
            *loss = l->v[--l->n];
        return lost;
    }
    if (loss == NULL && (may_create(l, r) || !some_are_nameless(l)))
        return false;
    if (loss == NULL)
        loss = append(l, r->name, r->name_len);
    if (loss != NULL)
        loss->changes++;
    return true;
}

void losses_print(const struct losses *l, FILE *out)
{
    size_t unknown = 0;
    for (size_t i = 0; i < l->n; i++) {
        const struct loss *loss = &l->v[i];
        unknown += !loss->known;
        fprintf(out, "lost: the set %s", loss->name);
        if (loss->known)
            fprintf(out, " of %" PRIu32 " points", loss->points);
        if (loss->changes > 0)
            fprintf(out, ", %" PRIu64 " later changes to it", loss->changes);
        fputs("\n", out);
    }
    if (!some_are_nameless(l))
        return;
    if (l->announced == SIZE_MAX)
        fputs("lost: possibly more sets, whose names cannot be read", out);
    else
        fprintf(out, "lost: %zu sets whose names cannot be read", l->announced - l->sets);
    fputs(unknown > 0 ? "; those above without a number of points may be among them\n" : "\n", out);
}
