/* cmd_simplify.c - SIMPLIFY: a new set of few points. */
#include "server/command/command.h"

#include "server/command/simplify.h"
#include "server/jobs/durable.h"

#include <math.h>

static bool read_error(struct answer *a, const struct word *w, double *error)
{
    if (!read_number(a, w, error))
        return false;
    *error += 0.0; /* -0 becomes 0 */
    bool good = *error >= 0 && !isinf(*error);
    if (!good)
        answer_err(a, ERR_RANGE, "an error is finite and not negative");
    return good;
}

static bool read_other(struct answer *a, const struct word *w, struct name *other)
{
    if (!word_is_set_name(w)) {
        answer_err(a, ERR_SYNTAX, "a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -");
        return false;
    }
    *other = name_of(w->text, w->len);
    return true;
}

static bool read_ids_name(struct answer *a, const struct word *w, struct name *ids)
{
    if (!read_field_name(a, w))
        return false;
    *ids = name_of(w->text, w->len);
    return true;
}

/* Reads the options, words 3 to the last one, in this order. */
static bool read_options(struct answer *a, const struct request *q, struct simplify *x)
{
    const struct word *w = &q->word[3], *end = q->word + q->n;
    if (!word_is(w, "ERROR")) {
        answer_usage(a);
        return false;
    }
    if (!read_error(a, &w[1], &x->error))
        return false;
    w += 2;
    if (w + 2 < end && word_is(w, "POINTS")) {
        if (!read_count(a, &w[1], "a number of points", &x->most))
            return false;
        w += 2;
    }
    if (w + 2 < end && word_is(w, "IDS")) {
        if (!read_ids_name(a, &w[1], &x->ids))
            return false;
        w += 2;
    }
    if (w + 2 != end || !word_is(w, "INTO")) {
        answer_usage(a);
        return false;
    }
    return read_other(a, &w[1], &x->other);
}

/* command.c checks whether changes can be saved, unless the set is temporary. The new set is saved in any case. */
void cmd_simplify(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct simplify x = {.field = find_field(a, set, &q->word[2]), .most = UINT32_MAX};
    if (x.field != NULL && read_options(a, q, &x) && simplify_is_new(s, a, &x.other) &&
        durable_admits_change(s, a, false))
        simplify_answer(s, a, set, &x);
}
