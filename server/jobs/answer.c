/* answer.c - see answer.h. */
#include "server/jobs/answer.h"

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
        reply_err(a->out, ERR_TOOBIG, "a set holds at most %u points", DT_MAX_POINTS);
        break;
    case DT_RANGE:
        reply_err(a->out, ERR_RANGE, "a coordinate is 0 or has a magnitude from 2^-142 to 2^201");
        break;
    case DT_NOPOINT:
        reply_err(a->out, ERR_NOPOINT, "no such point");
        break;
    case DT_NOEDGE:
        reply_err(a->out, ERR_NOEDGE, "these points are not joined by an edge");
        break;
    case DT_NOTRIANGLE:
        reply_err(a->out, ERR_NOTRIANGLE, "these points are not a triangle of the triangulation");
        break;
    case DT_NOFIELD:
        reply_err(a->out, ERR_NOFIELD, "no such field");
        break;
    case DT_UNTRIANGULATED:
        reply_err(a->out, ERR_UNTRIANGULATED, "TRIANGULATE the set first");
        break;
    case DT_CANCELLED:
    case DT_TOOLONG: /* only if there is a limit */
        if (a->timed_out)
            reply_err(a->out, ERR_TIMEOUT, "the request took too long; nothing has changed");
        else
            reply_err(a->out, ERR_CANCELLED, "cancelled; nothing has changed");
        break;
    case DT_CORRUPT:
        reply_err(a->out, ERR_CORRUPT, "the triangulation is inconsistent");
        break;
    }
}
