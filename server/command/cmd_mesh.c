/* cmd_mesh.c - REFINE: the request becomes a drawing that is planned as a split is (changes/drawing.h). */
#include "server/command/command.h"

#include "server/rows/surface_rows.h"

enum { ANGLE_UNASKED = 25, POINTS_EACH = 16 }; /* without limits; and that may be added for each */

enum { HAS_ANGLE = 1, HAS_AREA = 2, HAS_LENGTH = 4, HAS_INSIDE = 8, HAS_KEEP = 16, HAS_LIMIT = 32 };

/* A limit, which is more than 0. */
static bool read_limit(struct answer *a, const struct word *w, double *v)
{
    if (!read_length(a, w, "limit", v))
        return false;
    if (*v == 0)
        answer_err(a, ERR_RANGE, "a limit is more than 0");
    return *v > 0;
}

static bool read_angle(struct answer *a, const struct word *w, double *v)
{
    if (!read_limit(a, w, v))
        return false;
    if (*v >= 60)
        answer_err(a, ERR_RANGE, "no triangle has all angles above 60 degrees; this is %.*s",
                   QUOTED(w));
    return *v < 60;
}

/* The option that the word is, as its bit; 0: none, or without its argument. */
static unsigned option_at(const struct request *q, size_t at)
{
    static const char *const name[] = {"ANGLE", "AREA", "LENGTH", "INSIDE", "KEEP", "LIMIT"};
    for (unsigned i = 0; i < 6; i++) {
        unsigned bit = 1u << i;
        bool takes_one = (bit & (HAS_INSIDE | HAS_KEEP)) == 0;
        if (word_is(&q->word[at], name[i]) && (!takes_one || at + 1 < q->n))
            return bit;
    }
    return 0;
}

/* Reads the option; *at moves behind it. */
static bool read_option(struct answer *a, const struct request *q, unsigned option, size_t *at,
                        struct dt_quality *out)
{
    const struct word *value = &q->word[*at + 1];
    struct inside inside;
    uint32_t most = 0;
    bool good = true;
    *at += (option & (HAS_INSIDE | HAS_KEEP)) == 0 ? 2 : 1;
    switch (option) {
    case HAS_ANGLE:
        return read_angle(a, value, &out->angle);
    case HAS_AREA:
        return read_limit(a, value, &out->area);
    case HAS_LENGTH:
        return read_limit(a, value, &out->length);
    case HAS_INSIDE:
        good = read_inside(a, q, at, &inside);
        out->number = inside.number;
        return good;
    case HAS_KEEP:
        out->keep = true;
        return true;
    default:
        good = read_count(a, value, "a number of points", &most);
        out->most = most;
        return good;
    }
}

static bool read_quality(struct answer *a, const struct request *q, struct dt_quality *out)
{
    unsigned seen = 0;
    for (size_t at = 2; at < q->n;) {
        unsigned option = option_at(q, at);
        if (option == 0 || (seen & option) != 0) {
            answer_usage(a);
            return false;
        }
        seen |= option;
        if (!read_option(a, q, option, &at, out))
            return false;
    }
    if ((seen & (HAS_ANGLE | HAS_AREA | HAS_LENGTH)) == 0)
        out->angle = ANGLE_UNASKED;
    return true;
}

bool read_refinement(struct server *s, const struct dataset *set, const struct request *q,
                     struct answer *a, struct change *c)
{
    (void)s;
    c->drawing = drawing_new();
    if (c->drawing == NULL) {
        answer_out_of_memory(a);
        return false;
    }
    c->first = CHANGE_ANY;
    c->drawing->refines = c->drawing->splits = true;
    c->drawing->quality.number = DT_NONE;
    c->drawing->quality.most = (size_t)POINTS_EACH * set->current->sum.points;
    return read_quality(a, q, &c->drawing->quality);
}
