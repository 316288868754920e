/* steps.c - rows become steps; see steps.h. */
#include "clients/pictures/steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lib/array.h"
#include "clients/lib/words.h"

/* The number of points that each kind names. */
static const struct {
    const char *name;
    unsigned points;
} kinds[] = {
    [STEP_GRID] = {"grid", 0},     [STEP_START] = {"start", 2}, [STEP_SEARCH] = {"search", 2},
    [STEP_FIRST] = {"first", 3},   [STEP_POINT] = {"point", 3}, [STEP_RIGHT] = {"right", 3},
    [STEP_LEFT] = {"left", 3},     [STEP_CAVE] = {"cave", 3},   [STEP_BORDER] = {"border", 2},
    [STEP_REMOVE] = {"remove", 1}, [STEP_HULL] = {"hull", 1},
};

/* Three numbers: a corner and a side, or a centre and a radius. */
static bool read_numbers(struct words *w, struct step *s)
{
    return words_next_double(w, &s->x) && words_next_double(w, &s->y) &&
           words_next_double(w, &s->size);
}

/* The words after the points. */
static bool read_rest(struct words *w, struct step *s)
{
    s->size = HUGE_VAL;
    if (s->kind == STEP_GRID)
        return read_numbers(w, s) && words_next_u32(w, &s->v[0]) && words_next_u32(w, &s->v[1]);
    return s->kind != STEP_SEARCH || w->s == w->end || read_numbers(w, s);
}

static bool read_step(const struct model *m, const char *row, size_t len, struct step *s)
{
    struct words w = {row, row + len};
    const char *word;
    size_t n = words_next(&w, &word), kind = 0;
    while (kind <= STEP_HULL &&
           (strlen(kinds[kind].name) != n || memcmp(word, kinds[kind].name, n) != 0))
        kind++;
    if (kind > STEP_HULL)
        return false;
    *s = (struct step){.kind = (enum step_kind)kind};
    for (unsigned i = 0; i < kinds[kind].points; i++) {
        uint32_t id;
        if (!words_next_u32(&w, &id) || !model_find(m, id, &s->v[i]))
            return false;
    }
    return read_rest(&w, s) && w.s == w.end;
}

bool steps_take(struct steps *t, const char *row, size_t len)
{
    if (!array_reserve((void **)&t->step, &t->cap, t->n + 1, sizeof *t->step)) {
        t->fault = "out of memory";
        return false;
    }
    t->fault = "a row is not a step, or the set was edited meanwhile";
    return read_step(t->m, row, len, &t->step[t->n]) && ++t->n > 0;
}

void steps_free(struct steps *t)
{
    free(t->step);
    *t = (struct steps){.n = 0};
}
