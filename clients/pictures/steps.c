/* steps.c - rows become steps; see steps.h. */
#include "clients/pictures/steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lib/array.h"
#include "proto/number.h"

enum { MOST_WORDS = 6 };

struct row_word {
    const char *text;
    size_t len;
};

static size_t split(const char *row, size_t len, struct row_word *word)
{
    size_t n = 0;
    for (size_t at = 0; at < len && n < MOST_WORDS; n++) {
        const char *space = memchr(row + at, ' ', len - at);
        size_t end = space != NULL ? (size_t)(space - row) : len;
        word[n] = (struct row_word){row + at, end - at};
        at = end + 1;
    }
    return n;
}

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

static bool is_word(struct row_word w, const char *text)
{
    return w.len == strlen(text) && memcmp(w.text, text, w.len) == 0;
}

static bool read_id(struct row_word w, uint32_t *v)
{
    return proto_read_u32(w.text, w.len, v);
}

/* Three numbers: a corner and a side, or a centre and a radius. */
static bool read_numbers(const struct row_word *w, struct step *s)
{
    return proto_read_double(w[0].text, w[0].len, &s->x) &&
           proto_read_double(w[1].text, w[1].len, &s->y) &&
           proto_read_double(w[2].text, w[2].len, &s->size);
}

/* The words after the points. */
static bool read_rest(const struct row_word *w, size_t n, struct step *s)
{
    if (s->kind == STEP_GRID)
        return n == 5 && read_numbers(w, s) && read_id(w[3], &s->v[0]) && read_id(w[4], &s->v[1]);
    s->size = HUGE_VAL;
    return n == 0 || (s->kind == STEP_SEARCH && n == 3 && read_numbers(w, s));
}

static bool read_step(const struct model *m, const char *row, size_t len, struct step *s)
{
    struct row_word word[MOST_WORDS];
    size_t n = split(row, len, word), kind = 0;
    while (n > 0 && kind <= STEP_HULL && !is_word(word[0], kinds[kind].name))
        kind++;
    if (n == 0 || kind > STEP_HULL || n < 1 + kinds[kind].points)
        return false;
    *s = (struct step){.kind = (enum step_kind)kind};
    for (unsigned i = 0; i < kinds[kind].points; i++) {
        uint32_t id;
        if (!read_id(word[1 + i], &id) || !model_find(m, id, &s->v[i]))
            return false;
    }
    return read_rest(word + 1 + kinds[kind].points, n - 1 - kinds[kind].points, s);
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
