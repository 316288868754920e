/* faces.c - see faces.h. */
#include "clients/meshes/faces.h"

#include <stdlib.h>
#include <string.h>

enum { NO_FACE = UINT32_MAX };

/* Whether a-b is a constrained edge. */
static bool is_fixed(const struct model *m, uint32_t a, uint32_t b)
{
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    size_t from = 0, to = m->fixed_n;
    while (from < to) {
        size_t mid = from + (to - from) / 2;
        const uint32_t *e = m->fixed + 2 * mid;
        if (e[0] < low || (e[0] == low && e[1] < high))
            from = mid + 1;
        else
            to = mid;
    }
    return from < m->fixed_n && m->fixed[2 * from] == low && m->fixed[2 * from + 1] == high;
}

/* Gives the face of a triangle to all that no constrained edge separates from it. */
static void flood(struct faces *f, const struct model *m, const struct sides *sides,
                  uint32_t triangle, uint32_t *stack)
{
    const uint32_t face = (uint32_t)f->n;
    size_t n = 0;
    f->enclosed[face] = true;
    f->face[triangle] = face;
    stack[n++] = triangle;
    while (n > 0) {
        const uint32_t *v = m->triangle + 3 * (size_t)stack[--n];
        for (size_t k = 0; k < 3; k++) {
            uint32_t a = v[k], b = v[(k + 1) % 3];
            if (is_fixed(m, a, b))
                continue;
            int64_t next = sides_find(sides, b, a);
            if (next == NO_TRIANGLE) {
                f->enclosed[face] = false;
            } else if (f->face[next] == NO_FACE) {
                f->face[next] = face;
                stack[n++] = (uint32_t)next;
            }
        }
    }
}

bool faces_init(struct faces *f, const struct model *m, const struct sides *sides)
{
    uint32_t *stack = malloc((m->triangles + 1) * sizeof stack[0]);
    *f = (struct faces){0};
    f->face = malloc((m->triangles + 1) * sizeof f->face[0]);
    f->enclosed = malloc((m->triangles + 1) * sizeof f->enclosed[0]);
    bool ok = stack != NULL && f->face != NULL && f->enclosed != NULL;
    if (ok)
        memset(f->face, 0xFF, m->triangles * sizeof f->face[0]);
    for (size_t t = 0; ok && t < m->triangles; t++)
        if (f->face[t] == NO_FACE) {
            flood(f, m, sides, (uint32_t)t, stack);
            f->n++;
        }
    free(stack);
    return ok;
}

void faces_free(struct faces *f)
{
    free(f->face);
    free(f->enclosed);
    *f = (struct faces){0};
}
