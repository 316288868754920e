/* answer.c - see answer.h. */
#include "server/jobs/answer.h"

#include "server/jobs/reactor.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

bool answer_shares(const struct answer *a)
{
    return a->reactor != NULL && loop_is_sharing(&a->reactor->loop);
}

bool world_alone(struct answer *a)
{
    return !answer_shares(a) || answer_again(a);
}

bool answer_err(struct answer *a, enum reply_code code, const char *format, ...)
{
    va_list ap;
    va_start(ap, format);
    reply_err(a->out, code, format, ap);
    va_end(ap);
    a->refused = true;
    a->code = code;
    return false;
}

/* A constraint, by its number in the request if it has one. */
static void name_constraint(char *text, size_t size, const struct dt_constraint *c, const char *row,
                            uint64_t number)
{
    if (number > 0)
        snprintf(text, size, "%s %" PRIu64, row, number);
    else
        snprintf(text, size, "%u %u", c->a, c->b);
}

void answer_crosses(struct answer *a, const struct dt_crossed *c, const char *row,
                    const uint64_t *number)
{
    char one[40], other[40];
    name_constraint(one, sizeof one, &c->one, row, number == NULL ? 0 : number[0]);
    name_constraint(other, sizeof other, &c->other, row, number == NULL ? 0 : number[1]);
    answer_err(a, ERR_CROSSES, "%s crosses %s", one, other);
}

/* The ERR lines of statuses that need no more than a text. */
static const struct {
    enum reply_code code;
    const char *text;
} lines[] = {
    [DT_RANGE] = {ERR_RANGE, "a coordinate is 0 or has a magnitude from 2^-142 to 2^201"},
    [DT_NOPOINT] = {ERR_NOPOINT, "no such point"},
    [DT_NOEDGE] = {ERR_NOEDGE, "these points are not joined by an edge"},
    [DT_NOTRIANGLE] = {ERR_NOTRIANGLE, "these points are not a triangle of the triangulation"},
    [DT_NOFIELD] = {ERR_NOFIELD, "no such field"},
    [DT_UNTRIANGULATED] = {ERR_UNTRIANGULATED, "TRIANGULATE the set first"},
    [DT_NOTDELAUNAY] =
        {ERR_NOTDELAUNAY,
         "the set has constraints; what needs every edge to be Delaunay is not defined: "
         "METHOD linear and nearest, CONTOUR, LOCATE, NEAREST and WITHIN are"},
    /* Of the next five the caller usually says more. */
    [DT_CROSSES] = {ERR_CROSSES, "constraints cross"},
    [DT_CONSTRAINED] = {ERR_CONSTRAINED, "a point is an end of a constraint"},
    [DT_NOCONSTRAINT] = {ERR_NOCONSTRAINT, "no such constraint"},
    [DT_NOREGION] = {ERR_NOREGION, "no such border"},
    [DT_OPEN] = {ERR_OPEN, "the border is open"},
    [DT_UNSURVEYED] = {ERR_CORRUPT, "the triangulation is inconsistent"}, /* does not happen */
    [DT_CORRUPT] = {ERR_CORRUPT, "the triangulation is inconsistent"},
};

_Static_assert(sizeof lines / sizeof *lines == DT_OPEN + 1,
               "every status has a line, or a case below");

bool answer_region(struct answer *a, enum dt_status status, uint32_t number)
{
    if (status == DT_NOREGION)
        return answer_err(a, ERR_NOREGION, "there is no border of number %u", number);
    if (status != DT_OPEN)
        return answer_status(a, status);
    if (number == DT_NONE)
        return answer_err(a, ERR_OPEN, "all borders are open");
    return answer_err(a, ERR_OPEN, "the border of number %u is open", number);
}

bool answer_status(struct answer *a, enum dt_status status)
{
    switch (status) {
    case DT_OK:
        return true;
    case DT_NOMEM:
    case DT_TOOSMALL: /* buffers are large enough, so this does not happen */
        return answer_out_of_memory(a);
    case DT_TOOBIG:
        return answer_err(a, ERR_TOOBIG, "a set holds at most %u points", DT_MAX_POINTS);
    case DT_CANCELLED:
    case DT_TOOLONG: /* only if there is a limit */
        if (a->timed_out)
            return answer_err(a, ERR_TIMEOUT, "the request took too long; nothing has changed");
        return answer_err(a, ERR_CANCELLED, "cancelled; nothing has changed");
    default:
        return answer_err(a, lines[status].code, "%s", lines[status].text);
    }
}
