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
    if (!answer_shares(a))
        return true;
    answer_again(a);
    return false;
}

void answer_err(struct answer *a, enum reply_code code, const char *format, ...)
{
    va_list ap;
    va_start(ap, format);
    reply_err(a->out, code, format, ap);
    va_end(ap);
    a->refused = true;
    a->code = code;
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

void answer_status(struct answer *a, enum dt_status status)
{
    switch (status) {
    case DT_OK:
        break;
    case DT_NOMEM:
    case DT_TOOSMALL: /* buffers are large enough, so this does not happen */
        answer_out_of_memory(a);
        break;
    case DT_TOOBIG:
        answer_err(a, ERR_TOOBIG, "a set holds at most %u points", DT_MAX_POINTS);
        break;
    case DT_RANGE:
        answer_err(a, ERR_RANGE, "a coordinate is 0 or has a magnitude from 2^-142 to 2^201");
        break;
    case DT_NOPOINT:
        answer_err(a, ERR_NOPOINT, "no such point");
        break;
    case DT_NOEDGE:
        answer_err(a, ERR_NOEDGE, "these points are not joined by an edge");
        break;
    case DT_NOTRIANGLE:
        answer_err(a, ERR_NOTRIANGLE, "these points are not a triangle of the triangulation");
        break;
    case DT_NOFIELD:
        answer_err(a, ERR_NOFIELD, "no such field");
        break;
    case DT_UNTRIANGULATED:
        answer_err(a, ERR_UNTRIANGULATED, "TRIANGULATE the set first");
        break;
    case DT_CANCELLED:
    case DT_TOOLONG: /* only if there is a limit */
        if (a->timed_out)
            answer_err(a, ERR_TIMEOUT, "the request took too long; nothing has changed");
        else
            answer_err(a, ERR_CANCELLED, "cancelled; nothing has changed");
        break;
    case DT_NOTDELAUNAY:
        answer_err(a, ERR_NOTDELAUNAY,
                   "the set has constraints; what needs every edge to be Delaunay is not defined: "
                   "METHOD linear and nearest, CONTOUR, LOCATE, NEAREST and WITHIN are");
        break;
    case DT_CROSSES: /* of these three the caller says more */
        answer_err(a, ERR_CROSSES, "constraints cross");
        break;
    case DT_CONSTRAINED:
        answer_err(a, ERR_CONSTRAINED, "a point is an end of a constraint");
        break;
    case DT_NOCONSTRAINT:
        answer_err(a, ERR_NOCONSTRAINT, "no such constraint");
        break;
    case DT_NOREGION: /* of these two the caller says more */
        answer_err(a, ERR_NOREGION, "no such border");
        break;
    case DT_OPEN:
        answer_err(a, ERR_OPEN, "the border is open");
        break;
    case DT_UNSURVEYED: /* does not happen */
    case DT_CORRUPT:
        answer_err(a, ERR_CORRUPT, "the triangulation is inconsistent");
        break;
    }
}
