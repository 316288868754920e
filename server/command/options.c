/* options.c - see options.h. */
#include "server/command/options.h"

size_t option_find(const struct option *table, size_t n, const struct word *w)
{
    size_t i = 0;
    while (i < n && !word_is(w, table[i].name))
        i++;
    return i;
}

static unsigned words_of(enum option_kind kind)
{
    return kind == OPTION_FLAG || kind == OPTION_INSIDE ? 0 : kind == OPTION_BOX ? 4 : 1;
}

static bool read_choice(struct answer *a, const struct option *o, const struct word *w,
                        unsigned *out)
{
    unsigned i = 0;
    while (o->names[i] != NULL && !word_is(w, o->names[i]))
        i++;
    *out = o->first + i;
    return o->names[i] != NULL || answer_usage(a);
}

static bool read_option(struct answer *a, const struct request *q, size_t *at,
                        const struct dataset *set, const struct option *o, void *to)
{
    const struct word *w = &q->word[*at];
    struct dt_point *corner = to;
    unsigned i = 0;
    bool good = true;
    switch (o->kind) {
    case OPTION_FLAG:
        *(bool *)to = true;
        return true;
    case OPTION_CHOICE:
        return read_choice(a, o, w, to);
    case OPTION_EITHER:
        good = read_choice(a, o, w, &i);
        *(bool *)to = i == 1;
        return good;
    case OPTION_FINITE:
        return read_finite(a, w, o->what, to);
    case OPTION_LENGTH:
        return read_length(a, w, o->what, to);
    case OPTION_COUNT:
        return read_count(a, w, o->what, to);
    case OPTION_WORD:
        *(const struct word **)to = w;
        return true;
    case OPTION_FIELD:
        return (*(const struct dt_field **)to = find_field(a, set, w)) != NULL;
    case OPTION_INSIDE:
        return read_inside(a, q, at, to);
    case OPTION_BOX:
        return read_box(a, w, &corner[0], &corner[1]);
    }
    return good;
}

bool options_read(struct answer *a, const struct request *q, size_t at, const struct dataset *set,
                  const struct option *table, size_t n, unsigned allowed, void *out)
{
    while (at < q->n) {
        const size_t i = option_find(table, n, &q->word[at++]);
        const struct option *o = &table[i];
        if (i == n || (allowed >> i & 1) == 0 || q->n - at < words_of(o->kind))
            return answer_usage(a);
        allowed &= ~(1u << i | o->bars);
        void *to = (char *)out + o->offset;
        const struct word *w = &q->word[at];
        if (!read_option(a, q, &at, set, o, to) || (o->check != NULL && !o->check(a, w, to)))
            return false;
        at += words_of(o->kind);
    }
    return true;
}
