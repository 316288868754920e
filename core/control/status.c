/* status.c - a sentence for every status. */
#include "core/delaunay.h"

const char *dt_status_text(enum dt_status status)
{
    static const char *const text[] = {
        [DT_OK] = "done",
        [DT_NOMEM] = "out of memory",
        [DT_TOOBIG] = "too many points, or no ids are left",
        [DT_RANGE] = "a coordinate is outside the range in which the predicates are exact",
        [DT_NOPOINT] = "there is no point with this id",
        [DT_NOEDGE] = "no edge joins the two points",
        [DT_NOTRIANGLE] = "the three points are not a triangle of the triangulation",
        [DT_NOFIELD] = "there is no such field",
        [DT_UNTRIANGULATED] = "the set has not been triangulated",
        [DT_CANCELLED] = "cancelled",
        [DT_CORRUPT] = "the check found a fault in the triangulation",
        [DT_TOOSMALL] = "the buffer does not hold one row",
        [DT_CROSSES] = "constraints would cross where no point is",
        [DT_CONSTRAINED] = "the point is the end of a constraint",
        [DT_NOCONSTRAINT] = "there is no such constraint",
        [DT_NOTDELAUNAY] = "not defined in a set with constraints",
        [DT_UNSURVEYED] = "borders have changed since regions were found",
        [DT_NOREGION] = "there is no border of this number",
        [DT_OPEN] = "the border of this number is open",
        [DT_TOOLONG] = "more steps are needed than the caller allows",
    };
    size_t i = (size_t)status; /* a caller may have any number in an enum */
    return i < sizeof text / sizeof text[0] ? text[i] : "not a status of this library";
}
