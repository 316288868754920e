/* paths.c - see paths.h. */
#include "clients/points/paths.h"

#include <stdlib.h>
#include <string.h>

#include "clients/lib/array.h"
#include "proto/number.h"

bool paths_begin(struct paths *p, bool border, uint32_t number, uint64_t line, uint64_t feature)
{
    bool ok = array_reserve((void **)&p->path, &p->cap, p->n + 1, sizeof p->path[0]);
    if (ok)
        p->path[p->n++] = (struct path){.first = p->corners,
                                        .border = border || p->lines_border,
                                        .number = number,
                                        .line = line,
                                        .feature = feature};
    return ok;
}

bool paths_corner(struct paths *p, size_t place)
{
    bool ok =
        array_reserve((void **)&p->corner, &p->corners_cap, p->corners + 1, sizeof p->corner[0]);
    if (ok)
        p->corner[p->corners++] = (uint32_t)place;
    return ok;
}

bool paths_number(struct paths *p, uint32_t *number)
{
    *number = p->number;
    return p->number++ <= PATHS_MOST_NUMBER;
}

bool paths_seed(struct paths *p, struct seed seed)
{
    bool ok = array_reserve((void **)&p->seed, &p->seeds_cap, p->seeds + 1, sizeof p->seed[0]);
    if (ok)
        p->seed[p->seeds++] = seed;
    return ok;
}

bool paths_read_name(const char *text, size_t len, bool *border, uint32_t *number)
{
    *border = len > 7 && memcmp(text, "border", 6) == 0;
    size_t word = *border ? 6 : 4;
    if (!*border && !(len > 5 && memcmp(text, "line", 4) == 0))
        return false;
    return (text[word] == ' ' || text[word] == '_') &&
           proto_read_u32(text + word + 1, len - word - 1, number) && *number <= PATHS_MOST_NUMBER;
}

void paths_free(struct paths *p)
{
    free(p->path);
    free(p->corner);
    free(p->seed);
    *p = (struct paths){.n = 0};
}
